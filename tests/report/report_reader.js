// What a reader of a report does: choose every load and setting, move the slider, search, touch every
// chart. After each: page_checks.js. Then the marks of the pictures, against the data beside them.
"use strict";

async function read(page) {
  const checks = pageChecks(page);
  const {all, axisOf, expectPlace, pointsOf} = checks;
  const report = JSON.parse(page.querySelector("#data").textContent);
  const present = (value) => value !== null && value !== undefined;
  const figures = (kind, root = page) => all(`figure[data-chart="${kind}"]`, root);
  const marks = (figure, label, element) => all(`g[aria-label="${label}"] ${element}`, figure);
  const attribute = (element, name) => Number(element.getAttribute(name));
  const strokeOf = (element) => element.getAttribute("stroke") ?? element.closest("g[stroke]")?.getAttribute("stroke");
  const fillOf = (element) => element.getAttribute("fill") ?? element.closest("g[fill]")?.getAttribute("fill");
  const colourOf = (name) => (name === "fem" ? "var(--fem)" : name === "fem_coarse" ? "var(--muted)" : report.styles[name].colour);
  const labelOf = (name) => (name === "fem" ? "FEM" : report.styles[name].label);
  const seenThere = (what, list, wanted) => {
    const near = list.map((at) => [Math.hypot(at[0] - wanted[0], at[1] - wanted[1]), at]).sort((a, b) => a[0] - b[0]);
    expectPlace(what, near[0]?.[1] ?? [], wanted);
  };
  const centres = (circles) => circles.map((circle) => [attribute(circle, "cx"), attribute(circle, "cy")]);

  // Cost and error of each model over the atlas: the large mark is the error of 95 %.
  function lookAtSpeed() {
    for (const figure of figures("speed")) {
      const x = axisOf(figure, "x", {log: true}), y = axisOf(figure, "y", {log: true});
      for (const model of report.atlas.models) {
        const circles = marks(figure, "dot", "circle").filter((c) => fillOf(c) === colourOf(model.model));
        seenThere(`95 % of ${model.model}`, centres(circles.filter((c) => attribute(c, "r") === 5.5)), [x.place(model.cost_ns), y.place(model.quantiles.max_torque.p95)]);
        seenThere(`median of ${model.model}`, centres(circles.filter((c) => attribute(c, "r") === 3.5)), [x.place(model.cost_ns), y.place(model.quantiles.max_torque.median)]);
      }
    }
    for (const figure of figures("friction")) {
      const x = axisOf(figure, "x", {log: true}), y = axisOf(figure, "y", {log: true});
      for (const law of report.atlas.friction_laws)
        seenThere(law.name, centres(marks(figure, "dot", "circle")), [x.place(law.cost_ns), y.place(Math.max(1e-4, law.error.worst))]);
    }
  }

  // Every prediction's own cost and error.
  function lookAtCost() {
    for (const figure of figures("cost")) {
      const x = axisOf(figure, "x", {log: true}), y = axisOf(figure, "y", {log: true});
      const small = centres(marks(figure, "dot", "circle").filter((c) => attribute(c, "r") === 3));
      for (const {loads} of report.cases)
        for (const load of loads)
          for (const model of load.models)
            if (model.has_answer && present(model.relative_error?.max_torque) && model.cost_ns > 0)
              seenThere(`${model.model} at ${load.load_N} N`, small, [x.place(model.cost_ns), y.place(Math.max(1e-5, Math.abs(model.relative_error.max_torque)))]);
    }
  }

  // A load's contact size and Poisson's ratio.
  function lookAtMap() {
    for (const figure of figures("map")) {
      const x = axisOf(figure, "x", {log: true});
      const rows = new Map(all('text[dy=".32em"]', figure).map((text) => [text.textContent, attribute(text, "y")]));
      for (const c of report.cases)
        for (const load of c.loads)
          if (load.s > 0 && load.models.some((m) => present(m.score)))
            seenThere(`${c.id} at ${load.load_N} N`, centres(marks(figure, "dot", "circle")), [x.place(load.s), rows.get(String(c.poisson_ratio))]);
    }
  }

  const chosenLoad = (figure) => {
    const section = figure.closest("[data-case]");
    const button = section.querySelector('button[data-load][aria-pressed="true"]');
    const data = [...report.cases, ...(report.pads ?? [])][all("[data-case]").indexOf(section)];
    return {data, load: data.loads[button ? Number(button.dataset.load) : 0]};
  };
  const answers = (load) => [...(load.fem ? [{...load.fem, model: "fem"}] : []), ...load.models.filter((m) => m.has_answer)];
  const curvesOf = (figure, name) => marks(figure, "line", "path").filter((path) => strokeOf(path) === colourOf(name));

  // Semi-axes in pixels; a millimetre is as long upwards as sideways.
  function lookAtEllipse(figure) {
    const {load} = chosenLoad(figure), drawn = answers(load).filter((answer) => answer.a_m > 0);
    if (!drawn.length) return;
    const x = axisOf(figure, "x"), y = axisOf(figure, "y");
    expectPlace("a millimetre upwards", [-y.per], [x.per], 0.001 * x.per);
    for (const answer of drawn) {
      if (Math.abs((answer.axis_rad ?? 0) - (load.axis_rad ?? 0)) > 1e-6) continue;
      const box = curvesOf(figure, answer.model)[0].getBBox();
      expectPlace(`semi-axes of ${answer.model} at ${load.load_N} N`, [box.width / 2, box.height / 2], [1e3 * answer.a_m * x.per, -1e3 * answer.b_m * y.per]);
      expectPlace(`centre of ${answer.model} at ${load.load_N} N`, [box.x + box.width / 2, box.y + box.height / 2], [x.place(0), y.place(0)]);
    }
  }

  // Where each profile begins and ends.
  function lookAtPressure(figure) {
    const {load} = chosenLoad(figure);
    all("svg", figure).filter((svg) => !svg.parentElement.closest("svg")).forEach((svg, k) => {
      const x = axisOf(svg, "x"), y = axisOf(svg, "y");
      for (const answer of answers(load)) {
        const profile = answer[`profile_${"xy"[k]}`];
        if (answer.model === "fem" || !profile?.x.length) continue;
        const points = pointsOf(curvesOf(svg, answer.model)[0]);
        for (const i of [0, -1])
          expectPlace(`pressure of ${answer.model} at ${load.load_N} N, ${i ? "end" : "centre"}`, points.at(i), [x.place(1e3 * profile.x.at(i)), y.place(1e-3 * profile.p.at(i))]);
      }
    });
  }

  // Bars from zero to the torque.
  function lookAtTorque(figure) {
    const {load} = chosenLoad(figure);
    const drawn = answers(load).filter((answer) => present(answer.max_torque_Nm));
    if (!drawn.length) return;
    const x = axisOf(figure, "x");
    const rows = new Map(all('text[dy=".32em"]', figure).map((text) => [text.textContent, attribute(text, "y")]));
    for (const answer of drawn) {
      const bar = marks(figure, "bar", "rect").find((rect) => fillOf(rect) === colourOf(answer.model));
      const [left, width, top, height] = ["x", "width", "y", "height"].map((name) => attribute(bar, name));
      expectPlace(`bar of ${answer.model} at ${load.load_N} N`, [left, left + width, top + height / 2],
        [x.place(0), x.place(1e3 * answer.max_torque_Nm), rows.get(labelOf(answer.model))]);
    }
  }

  // From the largest torque without a force to the largest force without a torque.
  function lookAtEllipsoid(figure) {
    const {load, data} = chosenLoad(figure);
    const drawn = answers(load).filter((answer) => present(answer.max_torque_Nm));
    if (!drawn.length || !(data.friction_coefficient > 0)) return;
    const x = axisOf(figure, "x"), y = axisOf(figure, "y");
    for (const answer of drawn) {
      const points = pointsOf(curvesOf(figure, answer.model)[0]);
      expectPlace(`torque of ${answer.model} without a force`, points[0], [x.place(0), y.place(1e3 * answer.max_torque_Nm)]);
      expectPlace(`force of ${answer.model} without a torque`, points.at(-1), [x.place(data.friction_coefficient * load.load_N), y.place(0)]);
    }
  }

  // Corners of the outlines; a millimetre is as long upwards as sideways.
  function lookAtPadMap(figure) {
    const {data} = chosenLoad(figure), x = axisOf(figure, "x"), y = axisOf(figure, "y");
    expectPlace("a millimetre upwards", [-y.per], [x.per], 0.001 * x.per);
    const paths = marks(figure, "line", "path");
    [data.pad_outline, data.outline].forEach((outline, k) => {
      const points = pointsOf(paths[k]);
      outline.forEach(([right, up], i) => expectPlace(`corner ${i} of ${data.id}`, points[i], [x.place(1e3 * right), y.place(1e3 * up)]));
    });
  }

  function lookAtCases(root = page) {
    for (const [kind, look] of [["padmap", lookAtPadMap], ["padpressure", lookAtPressure], ["ellipse", lookAtEllipse], ["pressure", lookAtPressure], ["torque", lookAtTorque], ["ellipsoid", lookAtEllipsoid]])
      figures(kind, root).filter((figure) => figure.querySelector("svg")).forEach(look);
  }

  // Contacts and bands of error over s and Poisson's ratio; d3 draws these axes.
  function lookAtValidity() {
    const {grid} = report.atlas ?? {};
    const pressed = (setting) => page.querySelector(`[data-setting="${setting}"] [aria-pressed="true"]`)?.dataset.value;
    const shape = Number(pressed("ratio")), quantity = pressed("quantity");
    for (const figure of figures("validity")) {
      const ticks = all(".tick", figure).map((tick) => ({
        value: Number(tick.textContent), at: tick.getAttribute("transform").match(/-?[\d.]+/g).map(Number),
      }));
      const [across, up] = [ticks.filter((t) => t.at[0] !== 0), ticks.filter((t) => t.at[0] === 0)];
      const between = (list, k, along) => {
        const [one, other] = [list[0], list.at(-1)];
        return (value) => one.at[k] + (other.at[k] - one.at[k]) * (along(value) - along(one.value)) / (along(other.value) - along(one.value));
      };
      const x = between(across, 0, Math.log), y = between(up, 1, (nu) => -Math.log(0.501 - nu));
      const model = report.atlas.models.find((m) => m.model === figure.dataset.model);
      const area = figure.querySelector("g[clip-path]");
      const [width, height] = ["width", "height"].map((name) => attribute(area.querySelector("rect"), name));
      const spots = all("path[transform]", area).map((path) => path.getAttribute("transform").match(/-?[\d.]+/g).map(Number));
      const inside = ([low, high], v) => Math.min(high, Math.max(low, v));
      for (const mark of report.atlas.marks)
        seenThere(`mark ${mark.id} on the map of ${model.model}`, spots, [inside([5, width - 5], x(mark.s)), inside([5, height - 5], y(mark.poisson_ratio))]);
      // At a run of the atlas its own error decides the colour; runs near a band's limit are left out.
      const bands = [0.01, 0.05, 0.1, 0.25], paths = all("path[fill^='var(--map-']", area);
      grid.poisson_ratio.forEach((nu, i) => grid.s.forEach((s, j) => {
        const error = model.grid[quantity][(i * grid.radii_ratio.length + shape) * grid.s.length + j];
        if (!present(error)) return;
        const spot = paths[0].ownerSVGElement.createSVGPoint();
        // A pixel inside the frame: what lies on a line is neither in nor out.
        [spot.x, spot.y] = [inside([1, width - 1], x(s)), inside([1, height - 1], y(nu))];
        bands.forEach((limit, k) => {
          if (Math.abs(Math.abs(error) / limit - 1) < 0.3) return;
          const wanted = Math.abs(error) > limit;
          expectPlace(`band ${k + 1} of ${model.model} at s ${s}, ν ${nu}`, [Number(paths[k].isPointInFill(spot))], [Number(wanted)], 0);
        });
      }));
    }
  }

  // Stated errors of the models over the load (the page of a selection).
  function lookAtSweep() {
    for (const figure of figures("sweep")) {
      const x = axisOf(figure, "x", {log: true}), y = axisOf(figure, "y", {log: true});
      for (const {model, worst} of report.curves.models) {
        const points = pointsOf(curvesOf(figure, model)[0]);
        worst.forEach((error, i) => present(error) && seenThere(`${model} at ${report.curves.load_N[i]} N`, points, [x.place(report.curves.load_N[i]), y.place(error)]));
      }
    }
  }

  function lookAtFit() {
    for (const figure of figures("fit")) {
      const x = axisOf(figure, "x", {log: true}), y = axisOf(figure, "y", {log: true});
      const quantity = report.quantities.find((q) => q.name === figure.dataset.quantity);
      for (const point of quantity.points.filter((p) => !p.outlier))
        seenThere(`${quantity.name} at ${point.load} N`, centres(marks(figure, "dot", "circle")), [x.place(point.load), y.place(point.measured)]);
      const line = pointsOf(marks(figure, "line", "path")[0] ?? figure.querySelector('g[aria-label="line"] path'));
      for (const i of [0, -1])
        seenThere(`the fit of ${quantity.name}`, [line.at(i)], [x.place(quantity.curve.at(i).load), y.place(quantity.curve.at(i).value)]);
    }
    for (const figure of figures("residuals")) {
      const x = axisOf(figure, "x", {log: true}), y = axisOf(figure, "y");
      for (const quantity of report.quantities)
        for (const point of quantity.points.filter((p) => !p.outlier))
          seenThere(`residual of ${quantity.name} at ${point.load} N`, centres(marks(figure, "dot", "circle")), [x.place(point.load), y.place(point.sigma)]);
    }
    for (const figure of figures("confidence")) {
      const {x: across, y: up} = report.ellipses[Number(figure.dataset.ellipse)];
      const x = axisOf(figure, "x", {log: across.logarithmic}), y = axisOf(figure, "y", {log: up.logarithmic});
      seenThere("the best values", centres(marks(figure, "dot", "circle")), [x.place(across.value), y.place(up.value)]);
    }
  }

  checks.lookAtLabels("opening");
  lookAtFit();
  lookAtSpeed();
  lookAtCost();
  lookAtMap();
  lookAtCases();
  lookAtValidity();
  lookAtSweep();
  for (const button of all(".loads button")) {
    button.click();
    if (button.dataset.load !== undefined) lookAtCases(button.closest("[data-case]"));
    if (button.closest('[data-setting="ratio"], [data-setting="quantity"]')) lookAtValidity();
  }
  checks.lookAtLabels("all buttons");
  for (const input of all("input")) {
    input.value = input.type === "range" ? "1" : "seed";
    input.dispatchEvent(new Event("input", {bubbles: true}));
    if (input.type === "search") {
      input.value = "";
      input.dispatchEvent(new Event("input", {bubbles: true}));
    }
  }
  for (const details of all("details")) details.open = true;
  checks.lookAtLabels("opening the details");
  checks.lookAtColours();
  checks.touchCharts();
  checks.state();
}
