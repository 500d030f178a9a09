// What a reader of the explorer does: moves every slider, types numbers, chooses models. After each
// move: page_checks.js, and do the curves lie where the table says? What the page shows then is left in
// data-states, for explorer_against_program.mjs.
"use strict";

async function read(page) {
  const checks = pageChecks(page), {all, expectPlace, pointsOf} = checks;
  const the = (id) => page.querySelector(`#${id}`);
  const numeral = (text) => Number(text.replace("−", "-").replaceAll(",", ""));
  const rest = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  const states = [];

  // An axis by d3: where a value lies, from the words at its first and last tick.
  function axisOf(svg, name) {
    const ticks = all(`g[text-anchor="${name === "x" ? "middle" : "end"}"] .tick`, svg).map((tick) => ({
      at: Number(tick.getAttribute("transform").match(/-?[\d.]+/g)[name === "x" ? 0 : 1]), value: numeral(tick.textContent),
    }));
    const [one, other] = [ticks[0], ticks.at(-1)], per = (other.at - one.at) / (other.value - one.value);
    return {per, place: (value) => one.at + per * (value - one.value)};
  }
  const cellsOf = (row) => Object.fromEntries(all("[data-key]", row).map((cell) => [cell.dataset.key, cell.textContent]));

  // Curves end where the numbers of the table are, which have four digits: within a pixel.
  function lookAtCurves(after) {
    const row = page.querySelector("tr[data-shown]");
    if (!row) return;
    const cells = cellsOf(row), numbers = Object.fromEntries(Object.entries(cells).map(([key, text]) => [key, Number(text)]));
    const svgOf = (name) => page.querySelector(`[data-chart="${name}"] svg`);
    const ellipse = svgOf("ellipse"), [x, y] = ["x", "y"].map((name) => axisOf(ellipse, name));
    const outline = ellipse.querySelector(`path[data-path="${row.dataset.model}"]`).getAttribute("d");
    const [left, middle, across, up] = outline.match(/-?[\d.]+(?:e-?\d+)?/g).map(Number);
    expectPlace(`the ellipse after ${after}`, [left, middle, left + across, middle - up], [x.place(-numbers.a), y.place(0), x.place(0), y.place(numbers.b)]);
    expectPlace(`one scale for both directions after ${after}`, [100 * x.per / -y.per], [100]);
    const ends = (name, curve) => {
      const points = pointsOf(svgOf(name).querySelector(`path[data-path="${curve}"]`));
      return [points[0], points.at(-1)];
    };
    const pressure = ["x", "y"].map((name) => axisOf(svgOf("pressure"), name));
    for (const [curve, axis] of [["long", numbers.a], ["short", numbers.b]]) {
      const [centre, edge] = ends("pressure", curve);
      expectPlace(`the pressure after ${after}`, [...centre, edge[0]], [pressure[0].place(0), pressure[1].place(numbers.peak), pressure[0].place(axis)]);
    }
    const force = parseFloat(all("#key_numbers dd")[0].textContent), limit = ["x", "y"].map((name) => axisOf(svgOf("limit"), name));
    for (const curve of ["long", "short", "ellipsoid"]) {
      const [slide, twist] = ends("limit", curve);
      expectPlace(`the limit surface after ${after}`, [...slide, ...twist],
        [limit[0].place(force), limit[1].place(0), limit[0].place(0), limit[1].place(numbers.torque)]);
    }
    if (all("pre[data-simulator]").some((pre) => !pre.textContent.trim())) throw new Error(`no lines for a simulator after ${after}`);
  }
  function look(after) {
    checks.lookAtLabels(after);
    lookAtCurves(after);
    states.push({
      after, command: the("command").textContent, verdict: the("verdict").textContent,
      shown: page.querySelector("tr[data-shown]")?.dataset.model ?? null, doubt: all("#key_numbers dd")[2]?.textContent ?? null,
      models: Object.fromEntries(all("tr[data-model]").map((row) => [row.dataset.model, cellsOf(row)])),
    });
  }
  // As a hand does: many inputs, then the change.
  function slide(key, position) {
    const range = the(key);
    for (const type of ["input", "change"]) {
      range.value = String(position);
      range.dispatchEvent(new Event(type, {bubbles: true}));
    }
    look(`${key} at ${position}`);
  }
  function type(key, text) {
    const box = the(`${key}_typed`);
    box.focus();
    box.value = text;
    for (const type of ["input", "change"]) box.dispatchEvent(new Event(type, {bubbles: true}));
    look(`${text} typed for ${key}`);
    const refused = box.getAttribute("aria-invalid") === "true";
    box.blur();
    return refused;
  }

  // The library is compiled by other threads, for which the browser's virtual time does not wait: it stands
  // still as long as messages come.
  const {port1, port2} = new MessageChannel();
  const message = () => new Promise((resolve) => {
    port1.onmessage = resolve;
    port2.postMessage(null);
  });
  for (let i = 0; i < 1e6 && page.dataset.chartsDrawn !== "3"; ++i) await message();
  port1.close();
  for (let i = 0; i < 20 && !page.dataset.timed; ++i) await rest(50);
  // The band of usual doubts comes once nothing has moved for a while.
  await rest(600);
  look("opening");
  if (!page.querySelector('[data-chart="limit"] path[data-path="doubt"]')) throw new Error("no band of usual doubts");
  for (const key of ["R1", "R2", "h", "E", "nu", "P", "mu", "within"])
    for (const position of [0, 370, 1000, 640]) slide(key, position);
  slide("nu", 1000);
  for (const position of [0, 1000]) slide("h", position);
  // R' is the larger one: it takes the other along, and back.
  the("reset").click();
  slide("R2", 900);
  const pushed = the("R1_typed").value === the("R2_typed").value;
  slide("R1", 100);
  page.dataset.radiiOrdered = String(pushed && the("R1_typed").value === the("R2_typed").value);
  the("reset").click();
  for (const radio of all('input[name="shown"]')) {
    radio.click();
    look(`the model ${radio.value}`);
  }
  // More than the sliders reach may be typed, but no nonsense: then the last contact stays.
  const taken = [type("P", "0.0005"), type("E", "123456"), type("h", "3.25"), type("P", "1e9")];
  const refused = [type("nu", "0.6"), type("h", "-1"), type("mu", ""), type("P", "0")];
  page.dataset.typedJudged = String(!taken.some(Boolean) && refused.every(Boolean));
  page.dataset.states = encodeURIComponent(JSON.stringify(states));
  page.dataset.stateCount = String(states.length);
  checks.lookAtColours();
  checks.state();
}
