// What the pages with charts share: helpers, the charts of the error atlas, and the machinery that
// draws each figure and lets the reader choose a load, a quantity, a ratio of radii.
"use strict";

const Charts = (() => {
  const page = document.documentElement;
  const report = JSON.parse(document.getElementById("data").textContent);
  const present = (value) => value !== null && value !== undefined;
  const FEM = {label: "FEM", colour: "var(--fem)", dash: "none"};
  const COARSE = {label: "FEM, coarse mesh", colour: "var(--muted)", dash: "4 3"};
  const styleOf = (name) => (name === "fem" ? FEM : name === "fem_coarse" ? COARSE : report.styles[name]);

  const number = d3.format(".4~r");
  const magnitude = (ratio) => `${Number((100 * ratio).toPrecision(Math.abs(ratio) < 0.1 ? 2 : 3))} %`;
  const percent = (ratio) =>
    `${ratio > 0 ? "+" : ratio < 0 ? "−" : ""}${Math.abs(100 * ratio).toPrecision(Math.abs(ratio) < 0.1 ? 2 : 3)} %`;
  const duration = (ns) => {
    const [unit, name] = [[1, "ns"], [1e3, "µs"], [1e6, "ms"], [1e9, "s"]].filter(([u]) => ns >= 0.9995 * u).pop() ?? [1, "ns"];
    return `${Number((ns / unit).toPrecision(2))} ${name}`;
  };
  // A magnitude from 0 to 1, in the colours of report.css: they follow the reader's light or dark.
  const ramp = (part) => {
    const [from, to, share] = part < 0.5 ? [0, 1, 2 * part] : [1, 2, 2 * part - 1];
    return `color-mix(in oklab, var(--ramp-${to}) ${Math.round(1000 * share) / 10}%, var(--ramp-${from}))`;
  };
  // The largest value rounded up to the next tick, so that axes end on a labelled line.
  const niceTop = (value) => d3.scaleLinear().domain([0, value > 0 ? value : 1]).nice(5).domain()[1];
  const decades = ([low, high]) => d3.range(-15, 16).map((k) => 10 ** k).filter((v) => v >= low && v <= high);

  const base = (width, height) => ({
    width, height, marginLeft: 46, marginRight: 12, marginTop: 22, marginBottom: 38,
    style: {fontSize: "12px", background: "transparent"},
  });
  // Plot's own axes take a third of the time of drawing a picture: they are eight marks, with three elements
  // per tick. These axes are two paths and the labels.
  function drawAxes(options, scales, {width, height, marginLeft, marginRight, marginTop, marginBottom}) {
    const [right, bottom] = [width - marginRight, height - marginBottom];
    // Half a pixel, like Plot's marks: lines are sharp where a pixel is a pixel.
    const group = d3.create("svg:g").attr("transform", devicePixelRatio > 1 ? null : "translate(.5,.5)");
    const path = (d, opacity) => group.append("path").attr("d", d.join("")).attr("stroke", "currentColor").attr("stroke-opacity", opacity);
    const text = (words, x, y, anchor, shift) =>
      group.append("text").attr("x", x).attr("y", y).attr("text-anchor", anchor).attr("dy", shift).text(words);
    const places = {
      x: {line: (at) => `M${at},${marginTop}V${bottom}`, mark: (at) => `M${at},${bottom}v6`,
        label: (at, words) => text(words, at, bottom + 9, "middle", ".71em")},
      y: {line: (at) => `M${marginLeft},${at}H${right}`, mark: (at) => `M${marginLeft},${at}h-6`,
        label: (at, words) => text(words, marginLeft - 9, at, "end", ".32em")},
    };
    const lines = [], marks = [];
    for (const [name, {line, mark, label}] of Object.entries(places)) {
      const scale = scales[name];
      const {ticks, tickFormat, tickSize, grid} = options[name];
      const count = Array.isArray(ticks) ? undefined : ticks;
      const values = Array.isArray(ticks) ? ticks : scale.ticks?.(count) ?? scale.domain();
      const words = typeof tickFormat === "function" ? tickFormat : scale.tickFormat?.(count, tickFormat) ?? String;
      for (const value of values) {
        const at = scale(value) + (scale.bandwidth?.() ?? 0) / 2;
        if (grid !== false) lines.push(line(at));
        if (tickSize !== 0) marks.push(mark(at));
        label(at, words(value));
      }
    }
    path(lines, 0.1);
    path(marks, 1);
    if (options.x.label) text(options.x.label, width - 3, height - 3, "end");
    if (options.y.label) text(options.y.label, 3, 3, "start", ".71em");
    return group.node();
  }
  const plot = (options) => {
    const svg = Plot.plot({
      ...options, axis: null,
      marks: [(_, scales, __, dimensions) => drawAxes(options, scales, dimensions), ...options.marks],
    });
    // The same in every picture, and each would make the browser match the whole page anew: report.css says it once.
    svg.querySelector("style").remove();
    return svg;
  };
  // A point's `title` is a function, asked when the point is touched: most of them never are.
  const tip = (points, {pointer = Plot.pointer, ...options} = {}) => Plot.tip(points, pointer({
    x: "x", y: "y", title: (p) => ({toString: p.title}), fontSize: 12, lineHeight: 1.25, ...options,
  }));

  const legend = (entries) => {
    const list = document.createElement("ul");
    list.className = "legend";
    for (const {label, colour, hollow} of entries) {
      const item = document.createElement("li");
      const swatch = document.createElement("span");
      swatch.style.cssText = `display:inline-block;width:.7em;height:.7em;border-radius:50%;margin-right:.5em;` +
        (hollow ? `border:2px solid ${colour}` : `background:${colour}`);
      item.append(swatch, label);
      list.append(item);
    }
    return list;
  };
  const stacked = (...parts) => {
    const box = document.createElement("div");
    box.append(...parts);
    return box;
  };

  // What the buttons of the atlas's figures are set to.
  const settings = {quantity: "max_torque", ratio: 0, within: "all"};
  const atlas = report.atlas;

  // Room for the words at the ticks: half of the last one's right of an axis, all of them left of it.
  const TICK_AT_END = {marginRight: 20};
  const besideTicks = (largest) => ({marginLeft: Math.max(46, 10 + 7 * d3.format(",.0f")(largest).length)});

  // Axes and marks that both charts of cost against error have.
  const costAxis = (width, domain) => ({
    type: "log", domain, label: "time of one answer →", tickFormat: duration,
    ticks: decades(domain).filter((v) => width > 480 || Math.round(Math.log10(v)) % 3 === 0),
  });
  const errorAxis = (domain, label) => ({
    type: "log", domain, label, tickFormat: (v) => `${Number((100 * v).toPrecision(1))} %`,
    ticks: decades(domain),
  });
  // Those that nothing beats in both, as a staircase to read "what this time buys" from.
  const front = (points) => d3.sort(points, (p) => p.x, (p) => p.y)
    .filter((p, i, sorted) => sorted.slice(0, i).every((other) => other.y > p.y));
  const FLOOR = 1e-5; // a log scale has no zero
  const above = (value) => Math.max(FLOOR, Math.abs(value));

  function drawSpeed(width, {load}) {
    const quantity = settings.quantity;
    const spans = atlas.models.map((m) => {
      const known = (settings.within === "claimed" && m.claimed ? m.claimed : m.quantiles)[quantity];
      if (!known || !(m.cost_ns > 0)) return null;
      const style = styleOf(m.model);
      return {
        x: m.cost_ns, y: above(known.p95), median: above(known.median), worst: above(known.worst), style,
        title: () => `${style.label}, ${duration(m.cost_ns)}\n${known.count} contacts\nmedian ${magnitude(known.median)}\n95 % of them within ${magnitude(known.p95)}\nworst ${magnitude(known.worst)}`,
      };
    }).filter(present);
    if (quantity === "max_torque" && settings.within === "all") {
      for (const m of atlas.models) {
        if (!m.paper_torque || !(m.cost_ns > 0)) continue;
        const style = styleOf(m.model), known = m.paper_torque;
        spans.push({
          x: 1.22 * m.cost_ns, y: above(known.p95), median: above(known.median), worst: above(known.worst), style, paper: true,
          title: () => `${style.label} with the paper’s √(ab) rule, ${duration(m.cost_ns)}\nmedian ${magnitude(known.median)}\n95 % within ${magnitude(known.p95)}\nworst ${magnitude(known.worst)}`,
        });
      }
    }
    const candidates = (load?.candidates ?? []).filter((c) => c.cost_us > 0 && present(c.bound?.[quantity])).map((c) => ({
      x: 1e3 * c.cost_us, y: above(c.bound[quantity]), style: styleOf(c.model), chosen: c.chosen,
      title: () => `${styleOf(c.model).label} in this case, ${number(load.load_N)} N\n${duration(1e3 * c.cost_us)}\nstated error ${magnitude(c.bound[quantity])}${c.chosen ? "\nthe choice" : ""}`,
    }));
    if (!spans.length && !candidates.length) return null;
    const everything = [...spans, ...candidates];
    const domain = [0.4 * d3.min(everything, (p) => p.x), 3 * d3.max(everything, (p) => p.x)];
    const range = [
      0.6 * d3.min(everything, (p) => Math.min(p.y, p.median ?? p.y)),
      1.6 * d3.max(everything, (p) => Math.max(p.y, p.worst ?? p.y)),
    ];
    const colour = (p) => p.style.colour;
    const exact = spans.filter((p) => !p.paper), paper = spans.filter((p) => p.paper);
    const tolerance = report.tolerance;
    const picture = plot({
      ...base(width, 380), ...TICK_AT_END,
      marginLeft: 60,
      x: costAxis(width, domain),
      y: errorAxis(range, "↑ relative error"),
      marks: [
        ...(tolerance ? [
          Plot.ruleY([tolerance], {strokeOpacity: 0.5, strokeDasharray: "3 3"}),
          Plot.text([0], {x: [domain[1]], y: [tolerance], text: [`tolerance ${magnitude(tolerance)}`], textAnchor: "end", dy: -8, dx: -2, fillOpacity: 0.7}),
        ] : []),
        Plot.line(front(exact), {x: "x", y: "y", curve: "step-after", strokeOpacity: 0.35, strokeWidth: 1.5}),
        Plot.link(paper, {x1: "x", x2: "x", y1: "median", y2: "worst", stroke: colour, strokeOpacity: 0.6, strokeDasharray: "2 2"}),
        Plot.dot(paper, {x: "x", y: "y", r: 3.5, stroke: colour, fill: "var(--page)"}),
        Plot.link(exact, {x1: "x", x2: "x", y1: "median", y2: "y", stroke: colour, strokeWidth: 5, strokeOpacity: 0.55}),
        Plot.link(exact, {x1: "x", x2: "x", y1: "y", y2: "worst", stroke: colour, strokeWidth: 1.5}),
        Plot.dot(exact, {x: "x", y: "worst", r: 3, symbol: "times", stroke: colour, strokeWidth: 1.5}),
        Plot.dot(exact, {x: "x", y: "median", r: 3.5, fill: colour}),
        Plot.dot(exact, {x: "x", y: "y", r: 5.5, fill: colour, stroke: "var(--page)", strokeWidth: 1.5}),
        Plot.dot(candidates, {x: "x", y: "y", r: 7, symbol: "diamond", fill: "var(--page)", stroke: colour, strokeWidth: 2.5}),
        Plot.dot(candidates.filter((c) => c.chosen), {x: "x", y: "y", r: 13, stroke: "var(--ink)", strokeWidth: 1.5}),
        tip([...spans, ...spans.map((p) => ({...p, y: p.median})), ...spans.map((p) => ({...p, y: p.worst})), ...candidates]),
      ],
    });
    const shown = d3.groups(exact.concat(candidates), (p) => p.style.label)
      .map(([label, group]) => ({label, colour: group[0].style.colour}));
    return stacked(picture, legend(shown));
  }

  function drawFriction(width) {
    const points = atlas.friction_laws.filter((law) => law.cost_ns > 0 && law.error).map((law) => ({
      x: law.cost_ns, y: Math.max(1e-4, law.error.worst), median: Math.max(1e-4, law.error.median), name: law.name,
      title: () => `${law.name}, ${duration(law.cost_ns)}\nmedian ${magnitude(law.error.median)}\nworst ${magnitude(law.error.worst)}`,
    }));
    if (!points.length) return null;
    const domain = [0.4 * d3.min(points, (p) => p.x), 40 * d3.max(points, (p) => p.x)];
    const range = [0.5 * d3.min(points, (p) => p.median), 1.9 * d3.max(points, (p) => p.y)];
    // Labels of neighbours would lie on each other: each goes at least a line below the last one.
    const pixel = d3.scaleLog().domain(range).range([320, 0]);
    let last = -Infinity;
    for (const point of d3.sort(points, (p) => pixel(p.y))) {
      point.label = pixel.invert(last = Math.max(pixel(point.y), last + 15));
    }
    // A name stands right of its mark, or left of it where the picture ends.
    const across = d3.scaleLog().domain(domain).range([60, width - TICK_AT_END.marginRight]);
    const fits = (p) => across(p.x) + 9 + 7 * p.name.length < width;
    const names = {x: "x", y: "label", text: "name", stroke: "var(--page)", strokeWidth: 4, fill: "var(--ink)"};
    return plot({
      ...base(width, 380), ...TICK_AT_END,
      marginLeft: 60,
      x: costAxis(width, domain),
      y: errorAxis(range, "↑ largest error of the friction limit"),
      marks: [
        Plot.line(front(points), {x: "x", y: "y", curve: "step-after", strokeOpacity: 0.35, strokeWidth: 1.5}),
        Plot.link(points, {x1: "x", x2: "x", y1: "median", y2: "y", stroke: "var(--model-1)", strokeWidth: 4, strokeOpacity: 0.4}),
        Plot.dot(points, {x: "x", y: "y", r: 5, fill: "var(--model-1)"}),
        Plot.text(points.filter(fits), {...names, dx: 9, textAnchor: "start"}),
        Plot.text(points.filter((p) => !fits(p)), {...names, dx: -9, textAnchor: "end"}),
        tip(points),
      ],
    });
  }

  // Maps: error over s and nu, in coordinates in which models change evenly.
  const stiffening = (nu) => -Math.log(0.501 - nu);
  const BANDS = [0.01, 0.05, 0.1, 0.25];

  function drawValidity(width, {load, element}) {
    const model = atlas.models.find((m) => m.model === element.dataset.model);
    const {poisson_ratio: ratios, s: sizes, radii_ratio: shapes} = atlas.grid;
    const shape = Math.min(settings.ratio, shapes.length - 1);
    const nodes = (values) => ratios.map((_, i) => sizes.map((_, j) => values[(i * shapes.length + shape) * sizes.length + j] ?? NaN));
    const errors = nodes(model.grid[settings.quantity]);
    const margin = {left: 40, right: 8, top: 22, bottom: 34};
    const [inner, height] = [width - margin.left - margin.right, 170];
    if (inner < 40 || ratios.length < 2 || sizes.length < 2) return null;
    const x = d3.scaleLog().domain([sizes[0], sizes.at(-1)]).range([0, inner]);
    const y = d3.scaleLinear().domain([stiffening(ratios[0]), stiffening(ratios.at(-1))]).range([height, 0]);
    // The cell of a value among the grid's and how far into it, for both directions.
    const at = (values, target) => {
      const upper = Math.min(values.length - 1, Math.max(1, d3.bisectRight(values, target)));
      return [upper - 1, Math.min(1, Math.max(0, (target - values[upper - 1]) / (values[upper] - values[upper - 1])))];
    };
    const [rows, columns] = [ratios.map(stiffening), sizes.map(Math.log)];
    const between = (a, b, part) => (part === 0 ? a : part === 1 ? b : (1 - part) * a + part * b);
    const value = (table, [i, u], [j, v], mixed = between) => mixed(
      mixed(table[i][j], table[i][j + 1], v), mixed(table[i + 1][j], table[i + 1][j + 1], v), u);
    // The bands go on below what covers the cells without an answer: none of them ends before its edge.
    const goingOn = (a, b, part) => (Number.isNaN(a) ? b : Number.isNaN(b) ? a : between(a, b, part));
    // Finer than the grid of runs: straight lines between them, bent by no one.
    const [wide, high] = [72, 48];
    const spread = (values, count) => d3.range(count).map((k) => at(values, values[0] + (values.at(-1) - values[0]) * k / (count - 1)));
    const [fineRows, fineColumns] = [spread(rows, high), spread(columns, wide)];
    const sampled = (table) => fineRows.flatMap((row) => fineColumns.map((column) => value(table, row, column, goingOn)));
    const contours = d3.contours().size([wide, high]);
    const place = d3.geoTransform({
      point(px, py) { this.stream.point((px - 0.5) / (wide - 1) * inner, height - (py - 0.5) / (high - 1) * height); },
    });
    const path = d3.geoPath(place);
    const tall = height + margin.top + margin.bottom;
    const svg = d3.create("svg").attr("width", width).attr("height", tall).attr("viewBox", `0 0 ${width} ${tall}`)
      .style("font-size", "11.5px");
    const clip = `clip-${element.dataset.model}`;
    svg.append("clipPath").attr("id", clip).append("rect").attr("width", inner).attr("height", height);
    const frame = svg.append("g").attr("transform", `translate(${margin.left},${margin.top})`);
    const area = frame.append("g").attr("clip-path", `url(#${clip})`);
    area.append("rect").attr("width", inner).attr("height", height).attr("fill", "var(--map-0)");
    const absolute = sampled(errors).map((v) => Math.abs(v) || 0);
    BANDS.forEach((limit, k) => area.append("path").attr("d", path(contours.contour(absolute, limit)))
      .attr("fill", `var(--map-${k + 1})`).attr("stroke", "var(--ink)").attr("stroke-opacity", 0.35).attr("stroke-width", 0.7));
    const [places, heights] = [sizes.map((s) => x(s)), ratios.map((nu) => y(stiffening(nu)))];
    area.append("path").attr("class", "unknown").attr("fill", "var(--page)")
      .attr("d", d3.cross(d3.range(ratios.length - 1), d3.range(sizes.length - 1))
        .filter(([i, j]) => [errors[i][j], errors[i][j + 1], errors[i + 1][j], errors[i + 1][j + 1]].some(Number.isNaN))
        .map(([i, j]) => `M${places[j]},${heights[i]}H${places[j + 1]}V${heights[i + 1]}H${places[j]}Z`).join(""));
    if (model.holds)
      area.append("path").attr("d", path(contours.contour(sampled(nodes(model.holds)), 0.5)))
        .attr("fill", "none").attr("stroke", "var(--ink)").attr("stroke-width", 1.8).attr("stroke-dasharray", "5 3");
    const title = frame.append("text").attr("y", -8).attr("fill", "currentColor").attr("font-weight", 600)
      .text(styleOf(model.model).label);
    frame.append("text").attr("x", -8).attr("y", -8).attr("text-anchor", "end").attr("fill", "currentColor").text("ν ↑");
    if (d3.count(errors.flat()) < 2)
      frame.append("text").attr("x", inner / 2).attr("y", 0.75 * height).attr("text-anchor", "middle").attr("fill", "var(--muted)").text("no answers at this R′/R″");
    frame.append("g").attr("transform", `translate(0,${height})`)
      .call(d3.axisBottom(x).tickValues([0.1, 0.3, 1, 3, 10].filter((v) => v >= sizes[0] && v <= sizes.at(-1))).tickFormat(d3.format("~g")).tickSizeOuter(0))
      .style("font-size", "11px").style("font-family", "inherit")
      .append("text").attr("x", inner).attr("y", 31).attr("text-anchor", "end").attr("fill", "currentColor").text("s = √(ab)/h →");
    frame.append("g")
      .call(d3.axisLeft(y).tickValues([0, 0.3, 0.45, 0.49, 0.5].filter((v) => v <= ratios.at(-1)).map(stiffening))
        .tickFormat((v) => d3.format("~r")(Number((0.501 - Math.exp(-v)).toFixed(4)))).tickSizeOuter(0))
      .style("font-size", "11px").style("font-family", "inherit");
    // Contacts of other shapes than this map's are shown, faintly: they belong to another map.
    const inside = ([low, up], v) => Math.min(up, Math.max(low, v));
    for (const mark of d3.sort(atlas.marks, (m) => !m.seed)) {
      if (!present(mark.s) || !present(mark.poisson_ratio)) continue;
      const near = Math.abs(Math.log(mark.radii_ratio / shapes[shape])) < 0.36;
      const current = load && !mark.seed && mark.load_N === load.load_N;
      const spot = area.append("path")
        .attr("d", d3.symbol(mark.seed ? d3.symbolTimes : d3.symbolCircle, mark.seed ? 60 : current ? 90 : 34)())
        .attr("transform", `translate(${inside([5, inner - 5], x(mark.s))},${inside([5, height - 5], y(stiffening(mark.poisson_ratio)))})`)
        .attr("stroke", "#111").attr("stroke-width", mark.seed ? 2 : 1.4)
        .attr("fill", mark.seed ? "none" : current ? "#111" : "#fff").attr("opacity", near ? 1 : 0.3);
      spot.append("title").text(`${mark.id}, ${number(mark.load_N)} N\ns ${number(mark.s)}, ν ${mark.poisson_ratio}, R′/R″ ${number(mark.radii_ratio)}`);
    }
    frame.append("rect").attr("width", inner).attr("height", height).attr("fill", "transparent").lower();
    svg.on("pointermove", (event) => {
      const [px, py] = d3.pointer(event, frame.node());
      if (px < 0 || py < 0 || px > inner || py > height) return title.text(styleOf(model.model).label);
      const found = value(errors, at(rows, y.invert(py)), at(columns, Math.log(x.invert(px))));
      title.text(`s ${number(Number(x.invert(px).toPrecision(2)))}, ν ${number(Number((0.501 - Math.exp(-y.invert(py))).toPrecision(3)))}: ` +
        (Number.isNaN(found) ? "no answer" : model.model.startsWith("fem") ? magnitude(Math.abs(found)) : percent(found)));
    }).on("pointerleave", () => title.text(styleOf(model.model).label));
    return svg.node();
  }

  const shared = {speed: drawSpeed, friction: drawFriction, validity: drawValidity};

  // Whose pictures the setting buttons change.
  const DEPENDENT = {speed: true, validity: true};

  // `cases` belong to the page's [data-case] sections, in this order.
  // Returns what draws all figures anew, for pages with choices of their own.
  function start(drawers, cases) {
    const all = {...shared, ...drawers};
    const sections = [...document.querySelectorAll("[data-case]")];
    const selected = new Map();
    const figures = [...document.querySelectorAll("figure[data-chart]")].map((element) => {
      const section = element.closest("[data-case]");
      return {element, plot: element.querySelector(".plot"), section, data: section && cases[sections.indexOf(section)], width: 0};
    });
    const widthOf = (figure) => Math.floor(figure.plot.clientWidth);

    function draw(figure, width) {
      const kind = figure.element.dataset.chart;
      if (width <= 0) return;
      figure.width = width;
      let content = null;
      try {
        const load = figure.data?.loads[selected.get(figure.data) ?? 0];
        if (!figure.data || load) content = all[kind](width, {load, data: figure.data, element: figure.element});
      } catch (error) {
        // One chart that fails must not take the others with it; the page's test sees the count.
        page.dataset.scriptErrors = String(Number(page.dataset.scriptErrors) + 1);
        console.error(kind, figure.data?.id, error);
        figure.plot.textContent = "This chart could not be drawn; its numbers are in the tables.";
        return;
      }
      if (!content) {
        content = document.createElement("p");
        content.className = "empty";
        content.textContent = "Nothing to draw: no model and no reference has an answer here.";
      }
      figure.plot.replaceChildren(content);
      figure.element.dataset.drawn = "true";
    }

    function choose(section, data, index) {
      selected.set(data, index);
      for (const button of section.querySelectorAll("button[data-load]"))
        button.setAttribute("aria-pressed", String(Number(button.dataset.load) === index));
      for (const slider of section.querySelectorAll("input[data-loads]")) slider.value = index;
      for (const load of section.querySelectorAll(".load")) load.hidden = Number(load.dataset.load) !== index;
      for (const figure of figures) if (figure.section === section && figure.width) draw(figure, figure.width);
    }

    sections.forEach((section, i) => {
      const data = cases[i];
      for (const row of section.querySelectorAll(".loads")) row.removeAttribute("hidden");
      section.addEventListener("click", (event) => {
        const button = event.target.closest("button[data-load]");
        if (button) choose(section, data, Number(button.dataset.load));
      });
      section.addEventListener("input", (event) => {
        if (event.target.matches("input[data-loads]")) choose(section, data, Number(event.target.value));
      });
      // The middle load says most about a case; the others are one click away.
      if (data.loads.length) choose(section, data, Math.floor((data.loads.length - 1) / 2));
    });

    // Buttons that set what the atlas's figures show.
    const numeric = new Set(["ratio"]);
    for (const row of document.querySelectorAll("[data-setting]")) {
      const name = row.dataset.setting;
      row.hidden = false;
      const set = (button) => {
        settings[name] = numeric.has(name) ? Number(button.dataset.value) : button.dataset.value;
        for (const other of document.querySelectorAll(`[data-setting="${name}"] button`))
          other.setAttribute("aria-pressed", String(other.dataset.value === button.dataset.value));
      };
      const pressed = row.querySelector('[aria-pressed="true"]');
      if (pressed) set(pressed);
      row.addEventListener("click", (event) => {
        const button = event.target.closest("button");
        if (!button) return;
        set(button);
        for (const figure of figures)
          if (figure.element.dataset.chart in DEPENDENT && figure.width) draw(figure, figure.width);
      });
    }

    // A filter of the cases by their text.
    const filter = document.querySelector("input[data-filter]");
    filter?.closest("[hidden]")?.removeAttribute("hidden");
    filter?.addEventListener("input", () => {
      const wanted = filter.value.toLowerCase();
      for (const element of document.querySelectorAll("[data-filtered]"))
        element.hidden = !element.dataset.filtered.toLowerCase().includes(wanted);
    });

    page.dataset.chartsDrawn = "0"; // also shows the places of the charts, see report.css
    // Widths are read before anything is drawn: in turns, each reading would lay out the page anew.
    const widths = figures.map(widthOf);
    figures.forEach((figure, i) => draw(figure, widths[i]));
    page.dataset.chartsExpected = String(figures.length);
    page.dataset.chartsDrawn = String(figures.filter((f) => f.element.dataset.drawn).length);
    page.dataset.overflow = String(page.scrollWidth > page.clientWidth);
    page.dataset.readyMs = String(Math.round(performance.now()));

    let pending = 0;
    new ResizeObserver(() => {
      cancelAnimationFrame(pending);
      pending = requestAnimationFrame(() => {
        const current = figures.map(widthOf);
        figures.forEach((figure, i) => current[i] !== figure.width && draw(figure, current[i]));
        page.dataset.overflow = String(page.scrollWidth > page.clientWidth);
      });
    }).observe(document.body);
    return () => figures.forEach((figure) => figure.width && draw(figure, figure.width));
  }

  return {report, settings, styleOf, present, number, magnitude, percent, duration, ramp, niceTop, decades, base, TICK_AT_END, besideTicks, plot, tip, legend, stacked, start};
})();
