// What a reader of a sweep does: press every button, choose every axis, move every slider, touch
// every picture. After each: page_checks.js, and does a point lie nowhere?
"use strict";

async function read(page) {
  const state = page.dataset;
  const checks = pageChecks(page);
  const {all, axisOf, expectPlace, pointsOf} = checks;
  const astray = new Set();
  const look = (after) => {
    checks.lookAtLabels(after);
    for (const path of all(".plot svg path.cells, .plot svg path.points"))
      if (/NaN|Infinity/.test(path.getAttribute("d"))) astray.add(after);
  };

  // The first line of the first picture: 2 mN m (h/mm)^(1/2) P/N is a straight line from 1.414 to 4.472 on
  // logarithmic axes.
  const svg = page.querySelector(".plot svg"), dots = svg?.querySelector("path.points");
  if (state.picture === "curves" && dots) {
    const x = axisOf(svg, "x", {log: true}), y = axisOf(svg, "y", {log: true});
    const points = dots.getAttribute("d").match(/[-\d.]+,[-\d.]+/g).map((pair) => pair.split(",").map(Number));
    const near = (a, b) => Math.abs(a - b) < 1;
    state.marksOnLine = String(points.length > 1 && points.every(([px, py], i) => {
      const thickness = 0.5 * 10 ** (i / (points.length - 1));
      return near(px, x.place(thickness)) && near(py, y.place(2 * Math.sqrt(thickness)));
    }));
  }

  // Columns of the data are float32 in base64.
  const data = JSON.parse(page.querySelector("#data").textContent);
  const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  // Each cell of the first map lies where its row's values are, and has the colour of its deviation.
  if (state.picture === "map" && svg?.querySelector("path.cells")) {
    const [across, up] = data.variables, load = data.variables.find((v) => v.key === "load_N");
    const [first, second, loads] = [across, up, load].map((v) => floats(v.values));
    const levels = [...new Set(loads)].sort((a, b) => a - b), held = levels[Math.floor((levels.length - 1) / 2)];
    // A negative value turns a logarithmic axis into a linear one.
    const isLog = (variable, values) => variable.log && values.every((value) => !(value <= 0));
    const x = axisOf(svg, "x", {log: isLog(across, first)}), y = axisOf(svg, "y", {log: isLog(up, second)});
    const [model, fem] = [data.first, "fem"].map((name) => data.sources.find((s) => s.name === name))
      .map((source) => source && floats(source.values.max_torque));
    const deviates = fem && all("#controls button").some((b) => b.dataset.name === "Show deviation from FEM" && b.getAttribute("aria-pressed") === "true");
    const cells = all("path.cells", svg).flatMap((path) => path.getAttribute("d").match(/[-\d.]+/g).map(Number)
      .reduce((rows, number, i) => (i % 5 ? rows.at(-1).push(number) : rows.push([number]), rows), [])
      .map(([left, top, right, bottom]) => ({left, top, right, bottom, colour: path.getAttribute("fill")})));
    // Cells meet halfway between neighbouring values; the outer ones are as far out as in.
    const sides = (axis, values) => {
      const places = [...new Set(values.filter(Number.isFinite))].map(axis.place).sort((one, other) => one - other);
      const between = places.slice(1).map((at, i) => (at + places[i]) / 2);
      const edges = [2 * places[0] - between[0], ...between, 2 * places.at(-1) - between.at(-1)];
      return (value) => edges.slice(places.indexOf(axis.place(value)), places.indexOf(axis.place(value)) + 2);
    };
    const [sidesOf, endsOf] = [sides(x, first), sides(y, second)];
    loads.forEach((value, row) => {
      if (value !== held || !Number.isFinite(first[row] + second[row] + model[row]) || (deviates && !Number.isFinite(fem[row]))) return;
      const [px, py] = [x.place(first[row]), y.place(second[row])];
      const cell = cells.find(({left, right, top, bottom}) => left < px && px < right && top < py && py < bottom);
      expectPlace(`the cell of row ${row}`, cell ? [cell.left, cell.right, cell.top, cell.bottom] : [], [...sidesOf(first[row]), ...endsOf(second[row])]);
      if (!deviates) return;
      const error = Math.abs(model[row] / fem[row] - 1), band = [0.01, 0.05, 0.1, 0.25].filter((limit) => limit <= error).length;
      expectPlace(`the colour of row ${row}`, [Number(cell?.colour === `var(--map-${band})`)], [1], 0);
    });
  }
  checks.lookAtColours();
  state.firstPicture = state.picture;
  state.firstMarks = state.marks;
  look("opening");
  const press = () => all("#controls button").map((button) => button.dataset.name);
  const find = (name) => all("#controls button, #controls select").find((control) => control.dataset.name === name);
  // Twice: what the one takes away, the other brings back.
  for (const name of [...press(), ...press()]) {
    find(name)?.click();
    look(name);
    for (const label of all("#controls select").map((select) => select.dataset.name))
      for (const {value} of [...(find(label)?.options ?? [])]) {
        const select = find(label);
        if (!select || select.value === value) continue;
        select.value = value;
        select.dispatchEvent(new Event("change", {bubbles: true}));
        look(`${label} ${value}`);
        if (Number(state.marks) > 5000) break;
      }
    if (performance.now() > 60000) break;
  }
  for (const input of all("#controls input"))
    for (const value of [input.max, input.min]) {
      input.value = value;
      input.dispatchEvent(new Event("input", {bubbles: true}));
      look("a slider");
    }
  checks.lookAtColours();
  checks.touchCharts();
  state.astray = [...astray].slice(0, 4).join("; ").replaceAll('"', "") || "none";
  checks.state();
}
