// What a reader of the explorer's flat pad does: moves every slider, chooses shapes, pressings and models,
// looks at the curved fingertip in between. After each move: page_checks.js, and do outline and curves lie
// where the table says? What the page shows then is left in data-states, for explorer_pads_against_program.mjs.
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
  const shapeOf = () => page.querySelector('input[name="pad_shape"]:checked').value;

  function lookAtPictures(after) {
    const cells = cellsOf(page.querySelector("tr[data-pad-shown]"));
    const map = page.querySelector('[data-chart="pad_map"] svg'), [x, y] = ["x", "y"].map((name) => axisOf(map, name));
    const corners = pointsOf(map.querySelector('path[data-path="outline"]'));
    const reach = (k) => [Math.min, Math.max].map((pick) => pick(...corners.map((corner) => corner[k])));
    if (shapeOf() === "rectangle") {
      const [half_x, half_y] = ["L", "W"].map((key) => Number(the(`pad_${key}_typed`).value) / 2);
      expectPlace(`the outline after ${after}`, [...reach(0), ...reach(1)], [x.place(-half_x), x.place(half_x), y.place(half_y), y.place(-half_y)]);
    }
    expectPlace(`one scale for both directions after ${after}`, [100 * x.per / -y.per], [100]);
    const arm = map.querySelector('path[data-path="arm"]').getAttribute("d").match(/-?[\d.]+(?:e-?\d+)?/g).map(Number);
    expectPlace(`e_n after ${after}`, [arm[2]], [x.place(Number(cells.arm)) - x.place(0)]);
    if (all("pre[data-pad-simulator]").some((pre) => !pre.textContent.trim())) throw new Error(`no lines for a simulator after ${after}`);
  }
  function look(after) {
    checks.lookAtLabels(after);
    lookAtPictures(after);
    states.push({
      after, command: the("pad_command").textContent, verdict: the("pad_verdict").textContent,
      models: Object.fromEntries(all("tr[data-pad-model]").map((row) => [row.dataset.padModel, cellsOf(row)])),
    });
  }
  // As a hand does: many inputs, then the change.
  function slide(key, position) {
    const range = the(`pad_${key}`);
    for (const type of ["input", "change"]) {
      range.value = String(position);
      range.dispatchEvent(new Event(type, {bubbles: true}));
    }
    look(`${key} at ${position}`);
  }
  function pick(name, value) {
    page.querySelector(`input[name="pad_${name}"][value="${value}"]`).click();
    look(`${name} ${value}`);
  }

  // The library is compiled by other threads, for which the browser's virtual time does not wait: it stands
  // still as long as messages come.
  const {port1, port2} = new MessageChannel();
  const message = () => new Promise((resolve) => {
    port1.onmessage = resolve;
    port2.postMessage(null);
  });
  for (let i = 0; i < 1e6 && page.dataset.chartsDrawn !== "2"; ++i) await message();
  port1.close();
  for (let i = 0; i < 20 && !page.dataset.timed; ++i) await rest(50);
  look("opening");
  for (const key of ["L", "W", "c", "h", "E", "nu", "P", "mu", "within"])
    for (const position of [370, 700]) slide(key, position);
  // Corners are never rounder than half of the shorter side.
  slide("c", 1000);
  page.dataset.cornersFit = String(Number(the("pad_c_typed").value) === Math.min(...["L", "W"].map((key) => Number(the(`pad_${key}_typed`).value))) / 2);
  the("pad_reset").click();
  pick("pressing", "frictionless");
  pick("shown", "1");
  pick("shape", "disc");
  slide("D", 600);
  the("choose_curved").click();
  checks.lookAtLabels("the curved fingertip");
  page.dataset.curvedDrawn = String(the("pad").hidden && page.querySelector('[data-chart="ellipse"] path[data-path]') !== null);
  the("choose_pad").click();
  look("back from the curved fingertip");
  page.dataset.states = encodeURIComponent(JSON.stringify(states));
  page.dataset.stateCount = String(states.length);
  checks.lookAtColours();
  checks.state();
}
