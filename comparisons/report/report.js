// Draws the charts and lets the reader choose a load. Everything else on the page is HTML already.
"use strict";

(() => {
  const {report, styleOf, present, number, percent, duration, ramp, niceTop, base, TICK_AT_END, besideTicks, plot, tip, legend, stacked} = Charts;
  const FEM = styleOf("fem");

  // The reference first and broad, models on top and thin: a model that agrees hides neither.
  const entries = (load) => [
    ...(load.fem ? [{...load.fem, model: "fem", sound: true, style: FEM}] : []),
    ...load.models.filter((m) => m.has_answer).map((m) => ({...m, style: styleOf(m.model)})),
  ];
  // Of curves that coincide, the one below is seen on both sides of the one above.
  const lineOptions = (entry, place = 0, count = 1) => ({
    stroke: entry.style.colour,
    strokeWidth: entry.model === "fem" ? 2 + 0.35 * count : 1.5 + 0.35 * (count - 1 - place),
    strokeDasharray: entry.style.dash,
    x: "x", y: "y", curve: "linear",
  });

  // All dots of a curve in one path, as strokes without length: an element for each is slow to lay out.
  const DOTS = {
    strokeLinecap: "round",
    curve: (context) => ({
      lineStart() {}, lineEnd() {},
      point(x, y) { context.moveTo(x, y); context.lineTo(x, y); },
    }),
  };

  function drawEllipse(width, {load}) {
    const drawn = entries(load).filter((e) => e.a_m > 0 && e.b_m > 0);
    if (!drawn.length) return null;
    const frame = load.axis_rad ?? 0;
    const outline = (e, scale = 0) => {
      const turn = (e.axis_rad ?? frame) - frame;
      const a = 1e3 * e.a_m * (1 + scale * (e.error?.a ?? 0));
      const b = 1e3 * e.b_m * (1 + scale * (e.error?.b ?? 0));
      return d3.range(0, 97).map((i) => {
        const t = (2 * Math.PI * i) / 96;
        const [x, y] = [a * Math.cos(t), b * Math.sin(t)];
        return {
          x: x * Math.cos(turn) - y * Math.sin(turn), y: x * Math.sin(turn) + y * Math.cos(turn),
          title: () => `${e.style.label}\na ${number(1e3 * e.a_m)} mm\nb ${number(1e3 * e.b_m)} mm`,
        };
      });
    };
    const outlines = drawn.map((e) => outline(e));
    const frameOptions = base(width, Math.min(340, Math.max(250, 0.62 * width)));
    const inner = [
      width - frameOptions.marginLeft - frameOptions.marginRight,
      frameOptions.height - frameOptions.marginTop - frameOptions.marginBottom,
    ];
    const all = outlines.flat();
    const reach = [d3.max(all, (p) => Math.abs(p.x)), d3.max(all, (p) => Math.abs(p.y))];
    const pixelsPerMm = 0.93 * Math.min(inner[0] / (2 * reach[0]), inner[1] / (2 * reach[1]));
    const half = inner.map((pixels) => pixels / (2 * pixelsPerMm));
    const reference = drawn.find((e) => e.model === "fem");
    return plot({
      ...frameOptions,
      x: {domain: [-half[0], half[0]], label: "x along the long axis, mm →", ticks: width < 480 ? 5 : 7},
      y: {domain: [-half[1], half[1]], label: "↑ y, mm", ticks: 5},
      marks: [
        Plot.ruleX([0], {strokeOpacity: 0.25}), Plot.ruleY([0], {strokeOpacity: 0.25}),
        ...(reference
          ? [Plot.line([...outline(reference, 1), ...outline(reference, -1).reverse()],
              {x: "x", y: "y", curve: "linear", stroke: "none", fill: "var(--band)", fillOpacity: 0.22})]
          : []),
        ...drawn.map((e, i) => Plot.line(outlines[i], lineOptions(e, i, drawn.length))),
        tip(all.filter((_, i) => i % 4 === 0)), // the words are the same all around
      ],
    });
  }

  function drawPressure(width, {load}) {
    const drawn = entries(load).filter((e) => e.profile_x || e.profile_y);
    if (!drawn.length) return null;
    const points = (e, axis) => {
      const profile = e[`profile_${axis}`];
      return (profile?.x ?? []).map((x, i) => ({
        x: 1e3 * x, y: 1e-3 * profile.p[i],
        title: () => `${e.style.label}\n${axis} ${number(1e3 * x)} mm\n${number(1e-3 * profile.p[i])} kPa`,
      }));
    };
    const profiles = {x: drawn.map((e) => points(e, "x")), y: drawn.map((e) => points(e, "y"))};
    const highest = (wanted) =>
      d3.max([...profiles.x.filter(wanted), ...profiles.y.filter(wanted)].flat(), (p) => p.y);
    // A model that is off by a multiple may leave the picture, it must not flatten all the others.
    const reference = highest((_, i) => drawn[i].model === "fem");
    const top = 1.04 * Math.min(highest(() => true), reference > 0 ? 2.5 * reference : Infinity);
    const panel = (axis, panelWidth) => {
      const curves = profiles[axis];
      const loaded = curves.flat().filter((p) => p.y > 0);
      const end = 1.06 * (d3.max(loaded, (p) => p.x) ?? 1);
      return plot({
        ...base(panelWidth, 290), ...besideTicks(top),
        x: {domain: [0, end], label: `${axis === "x" ? "long axis x" : "short axis y"}, mm →`, ticks: panelWidth < 240 ? 3 : 5},
        y: {domain: [0, top], label: axis === "x" ? "↑ pressure, kPa" : null, ticks: 5},
        marks: [
          Plot.ruleY([0], {strokeOpacity: 0.4}),
          ...drawn.map((e, i) => e.model === "fem" ? null : Plot.line(curves[i], {...lineOptions(e, i, drawn.length), clip: true})),
          ...drawn.map((e, i) => e.model === "fem" ? Plot.line(curves[i], {...DOTS, x: "x", y: "y", stroke: e.style.colour, strokeWidth: 4.6, clip: true}) : null),
          tip(curves.flat().filter((p) => p.x <= end && p.y <= top)),
        ],
      });
    };
    const pair = document.createElement("div");
    pair.className = "pair";
    pair.append(panel("x", width / 2), panel("y", width / 2));
    return pair;
  }

  function drawTorque(width, {load}) {
    const reference = load.fem && present(load.fem.max_torque_Nm) ? load.fem : null;
    const rows = [
      ...(load.fem ? [{...load.fem, model: "fem", style: FEM, has_answer: true}] : []),
      ...load.models.map((m) => ({...m, style: styleOf(m.model)})),
    ];
    const values = rows.flatMap((r) => [r.max_torque_Nm, r.max_torque_paper_Nm]).filter(present).map((v) => 1e3 * v);
    if (!values.length) return null;
    const stated = reference?.error?.max_torque ?? 0;
    const label = (r) => r.style.label;
    const bars = rows.filter((r) => r.has_answer && present(r.max_torque_Nm)).map((r) => ({
      ...r, row: label(r), x: 1e3 * r.max_torque_Nm, paper: present(r.max_torque_paper_Nm) ? 1e3 * r.max_torque_paper_Nm : null,
      note: r.model === "fem" ? `${number(1e3 * r.max_torque_Nm)} ± ${(1e3 * r.max_torque_Nm * stated).toPrecision(2)}`
        : present(r.relative_error?.max_torque) ? percent(r.relative_error.max_torque) : number(1e3 * r.max_torque_Nm),
      title: () => [label(r), `exact rule ${number(1e3 * r.max_torque_Nm)} mN·m`,
        ...(present(r.max_torque_paper_Nm) ? [`paper rule ${number(1e3 * r.max_torque_paper_Nm)} mN·m` +
          (present(r.relative_error?.max_torque_paper) ? ` (${percent(r.relative_error.max_torque_paper)})` : "")] : []),
      ].map((line) => r.model === "fem" ? line.replace("exact rule ", "") : line).join("\n"),
    }));
    const domain = rows.map(label);
    const longest = d3.max(domain, (text) => text.length);
    const reachOf = (b) => Math.max(b.x, b.paper ?? 0);
    // Room for the note behind the longest bar, in units of the scale.
    const inner = width - Math.min(150, 14 + 7 * longest) - 12;
    const top = d3.max(bars, reachOf) * inner / Math.max(80, inner - 92);
    const fem = reference && 1e3 * reference.max_torque_Nm;
    return plot({
      ...base(width, Math.max(290, 60 + 34 * rows.length)),
      marginLeft: Math.min(150, 14 + 7 * longest),
      x: {domain: [0, top], label: "largest torque, mN·m →", ticks: 5},
      y: {domain, label: null, grid: false, tickSize: 0, padding: Math.max(0.35, 1 - rows.length / 7)},
      marks: [
        ...(fem ? [
          Plot.rect([0], {x1: fem * (1 - stated), x2: fem * (1 + stated), fill: "var(--band)", fillOpacity: 0.2}),
          Plot.ruleX([fem], {stroke: "var(--fem)", strokeOpacity: 0.45, strokeDasharray: "2 3"}),
        ] : []),
        ...bars.map((b) => Plot.barX([b], {x: "x", y: "row", fill: b.style.colour, fillOpacity: b.model === "fem" ? 0.4 : 0.75})),
        ...(fem ? [
          Plot.link([0], {x1: fem * (1 - stated), x2: fem * (1 + stated), y1: "FEM", y2: "FEM", stroke: "var(--fem)", strokeWidth: 2}),
          Plot.tickX([fem * (1 - stated), fem * (1 + stated)], {x: (x) => x, y: () => "FEM", stroke: "var(--fem)", strokeWidth: 2, insetTop: 4, insetBottom: 4}),
        ] : []),
        Plot.dot(bars.filter((b) => b.paper !== null), {x: "paper", y: "row", r: 5, fill: "var(--page)", stroke: (b) => b.style.colour, strokeWidth: 2}),
        Plot.text(bars, {x: reachOf, y: "row", text: "note", dx: 10, textAnchor: "start"}),
        Plot.text(rows.filter((r) => !r.has_answer), {x: 0, y: label, text: () => "no answer", dx: 6, textAnchor: "start", fillOpacity: 0.6}),
        Plot.ruleX([0], {strokeOpacity: 0.5}),
        tip(bars, {y: "row", anchor: "bottom", pointer: Plot.pointerY}),
      ],
    });
  }

  function drawEllipsoid(width, {load, data}) {
    const drawn = entries(load).filter((e) => present(e.max_torque_Nm));
    const sliding = data.friction_coefficient * load.load_N;
    if (!drawn.length || !(sliding > 0)) return null;
    const curve = (e, scale = 0) => d3.range(0, 41).map((i) => {
      const t = (Math.PI * i) / 80;
      const torque = 1e3 * e.max_torque_Nm * (1 + scale * (e.error?.max_torque ?? 0));
      const [x, y] = [sliding * Math.sin(t), torque * Math.cos(t)];
      return {x, y, title: () => `${e.style.label}\nforce ${number(x)} N\ntorque ${number(y)} mN·m`};
    });
    const curves = drawn.map((e) => curve(e));
    const reference = drawn.find((e) => e.model === "fem");
    const highest = niceTop(d3.max(curves.flat(), (p) => p.y));
    return plot({
      ...base(width, 290), ...besideTicks(highest),
      x: {domain: [0, 1.04 * sliding], label: "tangential force, N →", ticks: width < 480 ? 5 : 8},
      y: {domain: [0, highest], label: "↑ torque, mN·m", ticks: 5},
      marks: [
        Plot.ruleY([0], {strokeOpacity: 0.4}), Plot.ruleX([0], {strokeOpacity: 0.4}),
        ...(reference ? [Plot.line([...curve(reference, 1), ...curve(reference, -1).reverse()],
          {x: "x", y: "y", curve: "linear", stroke: "none", fill: "var(--band)", fillOpacity: 0.22})] : []),
        ...drawn.map((e, i) => Plot.line(curves[i], lineOptions(e, i, drawn.length))),
        tip(curves.flat()),
      ],
    });
  }

  // The pressure of a flat pad's elements, in bands; the last one holds what is singular at the rim.
  function drawPadMap(width, {load, data}) {
    const pressure = load.fem?.pressure;
    if (!pressure?.x.length || !data.outline?.length) return null;
    const points = pressure.x.map((x, i) => ({x: 1e3 * x, y: 1e3 * pressure.y[i], p: 1e-3 * pressure.p[i]}));
    const closed = (outline) => [...outline, outline[0]].map(([x, y]) => ({x: 1e3 * x, y: 1e3 * y}));
    const outline = closed(data.outline), pad = closed(data.pad_outline);
    const frameOptions = base(width, Math.min(360, Math.max(260, 0.66 * width)));
    const [low, high] = ["x", "y"].map((axis) => d3.extent(pad, (p) => p[axis])).reduce(([l, h], [a, b]) => [[...l, a], [...h, b]], [[], []]);
    const inner = [
      width - frameOptions.marginLeft - frameOptions.marginRight,
      frameOptions.height - frameOptions.marginTop - frameOptions.marginBottom,
    ];
    const pixelsPerMm = 0.94 * Math.min(inner[0] / (high[0] - low[0]), inner[1] / (high[1] - low[1]));
    const domain = [0, 1].map((k) => {
      const middle = (low[k] + high[k]) / 2, half = inner[k] / (2 * pixelsPerMm);
      return [middle - half, middle + half];
    });
    const centre = d3.polygonCentroid(outline.map((p) => [p.x, p.y]));
    const bands = d3.ticks(0, 1e-3 * load.fem.peak_pressure_Pa, 6);
    const colour = (k) => ramp(k / Math.max(1, bands.length - 1));
    const across = (k) => d3.extent(outline, (p) => p["xy"[k]]);
    const picture = plot({
      ...frameOptions,
      x: {domain: domain[0], label: "x, mm →", ticks: width < 480 ? 5 : 7},
      y: {domain: domain[1], label: "↑ y, mm", ticks: 5},
      color: {type: "threshold", domain: bands.slice(1), range: bands.map((_, k) => colour(k))},
      marks: [
        Plot.contour(points, {x: "x", y: "y", fill: "p", interpolate: "barycentric", thresholds: bands, pixelSize: 2, stroke: "none"}),
        // The bands go on beyond the outline: what lies outside is covered.
        (_, scales, __, dimensions) => {
          const ring = (corners) => `M${corners.map((p) => `${scales.x(p.x)},${scales.y(p.y)}`).join("L")}Z`;
          const {width: w, height: h, marginLeft: l, marginRight: r, marginTop: t, marginBottom: b} = dimensions;
          return d3.create("svg:path").attr("class", "outside").attr("fill", "var(--page)").attr("fill-rule", "evenodd")
            .attr("d", `M${l - 1},${t - 1}H${w - r + 2}V${h - b + 2}H${l - 1}Z${ring(outline)}`).node();
        },
        Plot.line(pad, {x: "x", y: "y", curve: "linear", stroke: "var(--muted)", strokeWidth: 1}),
        Plot.line(outline, {x: "x", y: "y", curve: "linear", stroke: "var(--fem)", strokeWidth: 2}),
        Plot.link([0], {x1: across(0)[0], x2: across(0)[1], y1: centre[1], y2: centre[1], stroke: "#888", strokeDasharray: "4 3"}),
        Plot.link([0], {x1: centre[0], x2: centre[0], y1: across(1)[0], y2: across(1)[1], stroke: "#888", strokeDasharray: "4 3"}),
        tip(points.map((p) => ({...p, title: () => `x ${number(p.x)} mm\ny ${number(p.y)} mm\n${number(p.p)} kPa`}))),
      ],
    });
    return stacked(picture, legend(bands.map((from, k) => ({
      label: k + 1 < bands.length ? `${number(from)} to ${number(bands[k + 1])} kPa` : `more than ${number(from)} kPa`, colour: colour(k),
    }))));
  }

  function drawPadPressure(width, {load}) {
    const drawn = entries(load).filter((e) => e.profile_x?.x.length || e.profile_y?.x.length);
    if (!drawn.length) return null;
    const points = (e, axis) => (e[`profile_${axis}`]?.x ?? []).map((x, i) => ({
      x: 1e3 * x, y: 1e-3 * e[`profile_${axis}`].p[i],
      title: () => `${e.style.label}\n${axis} ${number(1e3 * x)} mm from the middle\n${number(1e-3 * e[`profile_${axis}`].p[i])} kPa`,
    }));
    const top = 1.25e-3 * d3.max(drawn, (e) => e.peak_pressure_Pa);
    const panel = (axis, panelWidth) => {
      const curves = drawn.map((e) => points(e, axis));
      const [from, to] = d3.extent(curves.flat(), (p) => p.x);
      const room = 0.04 * (to - from);
      return plot({
        ...base(panelWidth, 320), ...besideTicks(top),
        x: {domain: [from - room, to + room], label: `along ${axis}, mm →`, ticks: panelWidth < 240 ? 3 : 5},
        y: {domain: [0, top], label: axis === "x" ? "↑ pressure, kPa" : null, ticks: 5},
        marks: [
          Plot.ruleY([0], {strokeOpacity: 0.4}),
          ...drawn.map((e, i) => e.model === "fem" ? null : Plot.line(curves[i], {...lineOptions(e, i, drawn.length), clip: true})),
          ...drawn.map((e, i) => e.model === "fem" ? Plot.line(curves[i], {...DOTS, x: "x", y: "y", stroke: e.style.colour, strokeWidth: 4.6, clip: true}) : null),
          tip(curves.flat().filter((p) => p.y >= 0 && p.y <= top)),
        ],
      });
    };
    const pair = document.createElement("div");
    pair.className = "pair";
    pair.append(panel("x", width / 2), panel("y", width / 2));
    return pair;
  }

  // Every prediction that can be compared, once for both charts of the overview.
  const predictions = report.cases.flatMap((c) => c.loads.flatMap((load) =>
    entries(load).map((e) => ({case: c, load, entry: e}))));
  const FLOOR = 1e-5; // a log scale has no zero

  function drawCost(width) {
    const points = predictions.map(({case: c, load, entry: e}) => {
      const isFem = e.model === "fem";
      const error = isFem ? e.error?.max_torque : e.relative_error?.max_torque;
      const cost = isFem ? (present(e.wall_s) ? 1e9 * e.wall_s : null) : e.cost_ns;
      if (!present(error) || !(cost > 0)) return null;
      return {
        x: cost, y: Math.max(FLOOR, Math.abs(error)), model: e.model, style: e.style, sound: e.sound,
        title: () => `${e.style.label}\n${c.id}, ${number(load.load_N)} N\ntorque ${isFem ? "± " + (100 * error).toPrecision(2) + " %" : percent(error)}\n${duration(cost)}`,
      };
    }).filter(present);
    if (!points.length) return null;
    const medians = d3.groups(points, (p) => p.model).map(([model, group]) => ({
      model, style: group[0].style, x: d3.median(group, (p) => p.x), y: d3.median(group, (p) => p.y),
    }));
    const front = d3.sort(medians, (m) => m.x).filter((m, i, sorted) => sorted.slice(0, i).every((other) => other.y > m.y));
    const domain = [0.4 * d3.min(points, (p) => p.x), 4 * d3.max(points, (p) => p.x)];
    const range = [0.6 * d3.min(points, (p) => p.y), 1.6 * d3.max(points, (p) => p.y)];
    const decades = ([low, high]) => d3.range(-9, 15).map((k) => 10 ** k).filter((v) => v >= low && v <= high);
    const picture = plot({
      ...base(width, 330), ...TICK_AT_END,
      marginLeft: 60,
      x: {type: "log", domain, label: "time of one answer →", tickFormat: duration,
        ticks: decades(domain).filter((v) => width > 480 || Math.round(Math.log10(v)) % 3 === 0)},
      y: {type: "log", domain: range, ticks: decades(range), label: "↑ error of the largest torque",
        tickFormat: (v) => `${Number((100 * v).toPrecision(1))} %`},
      marks: [
        Plot.ruleY([report.tolerance], {strokeOpacity: 0.5, strokeDasharray: "3 3"}),
        Plot.text([0], {x: [domain[1]], y: [report.tolerance], text: [`tolerance ${Number((100 * report.tolerance).toPrecision(3))} %`], textAnchor: "end", dy: -8, dx: -2, fillOpacity: 0.7}),
        Plot.line(front, {x: "x", y: "y", strokeOpacity: 0.5, strokeWidth: 1.5}),
        Plot.dot(points, {x: "x", y: "y", r: 3, stroke: (p) => p.style.colour, fill: (p) => (p.sound ? p.style.colour : "none"), strokeOpacity: 0.55, fillOpacity: 0.4}),
        Plot.dot(medians, {x: "x", y: "y", r: 6.5, fill: (m) => m.style.colour, stroke: "var(--page)", strokeWidth: 1.5}),
        tip(points),
      ],
    });
    // Names beside the marks would lie on each other where models are alike.
    return stacked(picture, legend(d3.sort(medians, (m) => m.x).map((m) => m.style)));
  }

  function drawMap(width) {
    const points = report.cases.flatMap((c) => c.loads.map((load) => {
      const ranked = d3.sort(load.models.filter((m) => present(m.score)), (m) => !m.usable, (m) => m.usable && !m.hot_path, (m) => m.score);
      if (!ranked.length || !(load.s > 0) || !present(c.poisson_ratio)) return null;
      const best = ranked.find((m) => m.model === load.recommended) ?? ranked[0];
      // A mean over sublayers has all the digits of a double.
      const poissonRatio = String(Number(c.poisson_ratio.toPrecision(4)));
      return {
        x: load.s, y: poissonRatio, colour: styleOf(best.model).colour, label: styleOf(best.model).label,
        usable: best.usable,
        title: () => [`${c.id}, ${number(load.load_N)} N`, `s ${number(load.s)}, ν ${poissonRatio}`,
          ...ranked.map((m) => `${styleOf(m.model).label}: off by ${percent(m.score).replace("+", "")}${m.sound ? "" : ", outside its range"}`)].join("\n"),
      };
    })).filter(present);
    if (!points.length) return null;
    const labels = d3.groups(points, (p) => p.label).map(([label, group]) => ({label, colour: group[0].colour}));
    const rows = d3.sort(new Set(points.map((p) => p.y)), Number).reverse();
    const picture = plot({
      ...base(width, Math.max(220, Math.min(330, 110 + 52 * rows.length))),
      marginLeft: 58,
      x: {type: "log", nice: true, label: "contact size s = √(ab)/h →", tickFormat: "~g", ticks: 6},
      y: {type: "point", domain: rows, label: "↑ Poisson ratio ν", padding: 0.7, tickSize: 0},
      marks: [
        Plot.dot(points, {x: "x", y: "y", r: 6, stroke: "colour", strokeWidth: 2, fill: (p) => (p.usable ? p.colour : "var(--page)"), fillOpacity: (p) => (p.usable ? 0.8 : 1)}),
        tip(points),
      ],
    });
    return stacked(picture, legend(labels));
  }

  Charts.start({cost: drawCost, map: drawMap, ellipse: drawEllipse, pressure: drawPressure, torque: drawTorque, ellipsoid: drawEllipsoid, padmap: drawPadMap, padpressure: drawPadPressure},
    [...report.cases, ...report.pads]);
})();
