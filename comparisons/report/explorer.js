// The page of `softfinger explore`: reads the sliders, asks the library (explorer.wasm), shows the answer.
// The contact stands in the address behind #, so that a link repeats it.
import {Picture, all, allowed, copy, duration, listenToSliders, load, number, percent, roundUp, sentence, showSliders, the, write} from "./explorer_parts.js";
import {startPads} from "./explorer_pads.js";

const page = document.documentElement;
const {sliders, models, shape, case: caseName, pad: padData, first} = JSON.parse(document.getElementById("data").textContent);

// The contact ----------------------------------------------------------------------------------------

const state = {shown: -1};
for (const slider of sliders) state[slider.key] = slider.start;
function set(key, value) {
  state[key] = value;
  // R' is the larger one: each takes the other along.
  if (key === "R1" && state.R2 > value) state.R2 = value;
  if (key === "R2" && state.R1 < value) state.R1 = value;
}
function showContact() {
  showSliders(sliders, state);
  for (const radio of all('input[name="shown"]')) radio.checked = Number(radio.value) === state.shown;
}
const addressOf = () => {
  const parts = sliders.map(({key}) => `${key}=${state[key]}`);
  if (state.shown >= 0) parts.push(`model=${models[state.shown].name}`);
  return parts.join("&");
};
// One of two parts is seen: a curved fingertip, or a flat pad.
let pads = null;
const isPad = () => !the("pad").hidden;
function choose(part) {
  for (const name of ["curved", "pad"]) {
    the(name).hidden = name !== part;
    the(`choose_${name}`).setAttribute("aria-pressed", String(name === part));
  }
  page.dataset.chartsExpected = part === "pad" ? "2" : "3";
  if (part === "pad") pads.fit();
  else fit();
  (part === "pad" ? pads.update : update)();
  page.dataset.overflow = String(page.scrollWidth > page.clientWidth);
}

function readAddress() {
  const given = new URLSearchParams(location.hash.slice(1));
  if (given.get("contact") === "pad") {
    pads.readAddress(given);
    return "pad";
  }
  for (const slider of sliders) {
    const value = given.has(slider.key) && given.get(slider.key) !== "" ? Number(given.get(slider.key)) : NaN;
    if (allowed(slider, value)) set(slider.key, value);
  }
  state.shown = models.findIndex(({name}) => name === given.get("model"));
  return location.hash.length > 1 ? "curved" : first;
}
function writeAddress() {
  const address = new URL(location.href);
  address.hash = isPad() ? pads.address() : addressOf();
  try {
    history.replaceState(null, "", address.href);
  } catch {
    // A page inside another one may have no address of its own.
  }
}

// Pictures -------------------------------------------------------------------------------------------

const pictures = {
  ellipse: new Picture("ellipse", {height: 270, left: 46}),
  pressure: new Picture("pressure", {height: 270, left: 58}),
  limit: new Picture("limit", {height: 270, left: 58}),
};

function drawEllipse(answer) {
  const picture = pictures.ellipse, shown = answer.models[answer.shown];
  const {left, right, top, bottom} = picture.margin;
  const [across, up] = [picture.width - left - right, picture.height - top - bottom];
  // One scale for both directions: half the picture's width shows `reach`, or half its height does.
  const [a, b] = [1e3 * shown.a_m, 1e3 * shown.b_m];
  const half = roundUp(Math.max(1.15 * b, 1.15 * a * up / across));
  const reach = half * across / up;
  picture.axes([-reach, reach], [-half, half], "x, mm →", "↑ y, mm");
  const outline = ({a_m, b_m}) => {
    const [rx, ry] = [picture.x(1e3 * a_m) - picture.x(0), picture.y(0) - picture.y(1e3 * b_m)];
    const [x, y] = [picture.x(0), picture.y(0)];
    return `M${x - rx},${y}a${rx},${ry} 0 1,0 ${2 * rx},0a${rx},${ry} 0 1,0 ${-2 * rx},0Z`;
  };
  picture.begin();
  const order = answer.models.map((model, i) => [model, i]);
  for (const [model, i] of [...order.filter(([, i]) => i !== answer.shown), order[answer.shown]]) {
    const isShown = i === answer.shown;
    if (!isShown && !(model.usable && model.a_m < 1e-3 * reach && model.b_m < 1e-3 * half)) continue;
    picture.path(model.name, outline(model), {
      stroke: models[i].colour, "stroke-width": isShown ? 2.5 : 1,
      fill: isShown ? models[i].colour : "none", "fill-opacity": 0.18,
    });
  }
  picture.end();
  picture.describe(`Contact ellipse, semi-axes ${number(a)} and ${number(b)} mm`);
}

function drawPressure(answer) {
  const picture = pictures.pressure, shown = answer.models[answer.shown], {position, long_Pa, short_Pa} = answer.profile;
  const peak = shown.peak_pressure_Pa / 1e3, colour = models[answer.shown].colour;
  picture.axes([0, roundUp(1.02e3 * shown.a_m)], [0, roundUp(Math.max(1.02 * peak, ...[...long_Pa, ...short_Pa].map((p) => p / 1e3)))], "from the centre, mm →", "↑ kPa");
  picture.begin();
  picture.points("long", position.map((s, i) => [1e3 * s * shown.a_m, long_Pa[i] / 1e3]), {stroke: colour, "stroke-width": 2.5});
  picture.points("short", position.map((s, i) => [1e3 * s * shown.b_m, short_Pa[i] / 1e3]), {stroke: colour, "stroke-width": 2, "stroke-dasharray": "6 4"});
  picture.end();
  picture.describe(`Pressure, ${number(peak)} kPa at the centre`);
}

// How far inputs usually are off: E by a factor of 2, thickness and friction by 10 %, one at a time.
const usualDoubts = [["E", 2], ["E", 1 / 2], ["h", 1.1], ["h", 1 / 1.1], ["mu", 1.1], ["mu", 1 / 1.1]];
// Smallest and largest force and torque of the model that is drawn; null where it has no answer for one of them.
function doubtOf(answer) {
  const limits = [answer.limit, ...usualDoubts.map(([key, factor]) =>
    library.ask([...sliders.map((slider) => state[slider.key] * slider.si_per_unit * (slider.key === key ? factor : 1)), answer.shown, ...shape]).limit)];
  if (limits.some((limit) => !limit)) return null;
  const [forces, torques] = ["max_force_N", "max_torque_Nm"].map((key) => limits.map((limit) => limit[key]));
  return {least: [Math.min(...forces), Math.min(...torques)], most: [Math.max(...forces), Math.max(...torques)]};
}

function drawLimit(answer, doubt) {
  const picture = pictures.limit, {along_long, along_short, max_force_N, max_torque_Nm} = answer.limit;
  const colour = models[answer.shown].colour;
  // With room for the band, which comes once a slider rests.
  const room = 1.12;
  picture.axes([0, roundUp(room * max_force_N)], [0, roundUp(1e3 * room * max_torque_Nm)], "force, N →", "↑ torque, mN·m");
  const quarter = along_long.map((_, i) => i / (along_long.length - 1) * Math.PI / 2);
  const milli = ([force, torque]) => [force, 1e3 * torque];
  picture.begin();
  if (doubt) {
    const arc = ([force, torque]) => quarter.map((t) => [force * Math.cos(t), 1e3 * torque * Math.sin(t)]);
    picture.points("doubt", [...arc(doubt.most), ...arc(doubt.least).reverse()], {fill: colour, "fill-opacity": 0.12, stroke: "none"});
  }
  picture.points("ellipsoid", quarter.map((t) => [max_force_N * Math.cos(t), 1e3 * max_torque_Nm * Math.sin(t)]), {stroke: "var(--muted)", "stroke-width": 1.5});
  picture.points("long", along_long.map(milli), {stroke: colour, "stroke-width": 2.5});
  picture.points("short", along_short.map(milli), {stroke: colour, "stroke-width": 2, "stroke-dasharray": "6 4"});
  picture.end();
  picture.describe(`Limit surface, largest force ${number(max_force_N)} N, largest torque ${number(1e3 * max_torque_Nm)} mN·m`);
}

// Words and tables -----------------------------------------------------------------------------------

const [A, B, AREA, TORQUE] = [0, 1, 3, 5];
let times = models.map(() => null);

const rows = all("tr[data-model]").map((row) => ({
  row, cells: Object.fromEntries([...row.querySelectorAll("[data-key]")].map((cell) => [cell.dataset.key, cell])),
}));
function showTable(answer) {
  answer.models.forEach((model, i) => {
    const {row, cells} = rows[i];
    row.toggleAttribute("data-shown", i === answer.shown);
    const scaled = {a: [model.a_m, 1e3], b: [model.b_m, 1e3], area: [model.area_m2, 1e6], indentation: [model.indentation_m, 1e3],
      peak: [model.peak_pressure_Pa, 1e-3], torque: [model.max_torque_Nm, 1e3], arm: [model.eccentricity_m, 1e3]};
    for (const [key, [value, factor]] of Object.entries(scaled)) write(cells[key], value === null ? "–" : number(value * factor));
    for (const [key, quantities] of [["contact_bound", [A, B, AREA]], ["torque_bound", [TORQUE]]]) {
      const worst = model.bound && Math.max(...quantities.map((q) => model.bound[q]));
      write(cells[key], model.bound ? percent(worst) : "–");
      cells[key].className = !model.bound ? "" : 100 * worst <= state.within ? "within" : "beyond";
    }
    write(cells.time, duration(times[i]));
    const [kind, words] = model.usable ? ["good", "✓ usable"] : model.bound ? ["bad", "✕ no"] : ["failed", "? not known"];
    cells.verdict.className = `badge ${kind}`;
    write(cells.verdict, words);
  });
}

// Why a model is not usable, or what speaks against one that is.
function showReasons(answer) {
  const reasons = answer.models.map((model, i) => [models[i].label, [model.bound ? "" : sentence(model.outside), ...model.objections.map(sentence)].filter(Boolean).join(" ")])
    .filter(([, words]) => words);
  const list = the("reasons"), wanted = JSON.stringify(reasons);
  if (list.dataset.holds === wanted) return;
  list.dataset.holds = wanted;
  list.replaceChildren(...reasons.map(([label, words]) => {
    const item = document.createElement("li"), name = document.createElement("b");
    name.textContent = `${label}: `;
    item.append(name, words);
    return item;
  }));
}

function showKeyNumbers(answer, doubt) {
  const list = the("key_numbers"), model = answer.models[answer.shown];
  const range = doubt === undefined ? "…" : doubt ? `${number(1e3 * doubt.least[1])} to ${number(1e3 * doubt.most[1])} mN·m` : "–";
  const rows = model ? [
    ["largest force", `${number(answer.limit.max_force_N)} N`],
    ["largest torque", `${number(1e3 * model.max_torque_Nm)} mN·m`],
    ["with E × 2 or ÷ 2, h and μ ± 10 %", range],
    ["torque / μP, the length eₙ", `${number(1e3 * model.eccentricity_m)} mm`],
    ["size s = √(ab)/h", number(Number((Math.sqrt(model.a_m * model.b_m) / (1e-3 * state.h)).toPrecision(3)))],
    ["indentation / h", percent(model.indentation_m / (1e-3 * state.h))],
  ] : [];
  if (list.children.length !== 2 * rows.length)
    list.replaceChildren(...rows.flatMap(() => ["dt", "dd"].map((name) => document.createElement(name))));
  rows.flat().forEach((words, i) => write(list.children[i], words));
}

function showSimulators(answer) {
  for (const pre of all("pre[data-simulator]"))
    write(pre, answer.simulators.find(({name}) => name === pre.dataset.simulator)?.text ?? "");
}

function verdictOf(answer) {
  if (answer.shown < 0) return "No model has an answer here: the result would be too large or too small for a number.";
  const name = (i) => models[i].label;
  const {max_torque_Nm, a_m, b_m, bound} = answer.models[answer.shown];
  const size = `a contact of ${number(2e3 * a_m)} by ${number(2e3 * b_m)} mm that carries at most ${number(1e3 * max_torque_Nm)} mN·m about the normal`;
  const parts = [`${name(answer.shown)}: ${size}${bound ? `, within ${percent(bound[TORQUE])}` : ", with an error that is not known"}.`];
  if (answer.nearest < 0) parts.push(`${sentence(answer.models[answer.shown].outside)} Compare with finite elements.`);
  else if (answer.recommended !== answer.shown) parts.push(`The recommended model is ${name(answer.recommended)}.`);
  else parts.push("It is the recommended model.");
  if (answer.nearest >= 0 && !answer.models.some((model) => model.usable)) parts.push(`None is known to be within ${state.within} %: ask finite elements.`);
  return parts.join(" ");
}

// With the case's own bodies while the gap is theirs; other relative radii belong to no bodies that a command could name.
const isGapOfCase = () => caseName && ["R1", "R2"].every((key) => state[key] === sliders.find((slider) => slider.key === key).start);
const commandOf = () =>
  `softfinger predict ${isGapOfCase() ? caseName : `--radii-mm ${state.R1},${state.R2}`} --thickness-mm ${state.h} --youngs-modulus-kPa ${state.E} ` +
  `--poisson-ratio ${state.nu} --load ${state.P} --friction ${state.mu} --tolerance ${Number((state.within / 100).toPrecision(12))}` +
  (caseName && !isGapOfCase() ? "   # takes the layer for flat, unlike this page" : "");

// Putting it together --------------------------------------------------------------------------------

let library = null, settled = 0, frame = 0;
const fit = () => Object.values(pictures).forEach((picture) => picture.fit(picture.box.clientWidth));
const widths = () => Object.values(pictures).map((picture) => picture.box.clientWidth);
const numbers = () => [...sliders.map(({key, si_per_unit}) => state[key] * si_per_unit), state.shown, ...shape];

// While a slider moves, parts out of sight wait until they are seen, or until it rests.
const parts = new Map([
  [document.querySelector(".scroll"), showTable],
  [the("reasons"), showReasons],
  [document.querySelector(".simulators"), showSimulators],
]);
const inSight = new Set();
function watchParts() {
  const observer = new IntersectionObserver((changes) => {
    for (const {target, isIntersecting} of changes) inSight[isIntersecting ? "add" : "delete"](target);
    if (changes.some(({isIntersecting}) => isIntersecting)) updateSoon();
  }, {rootMargin: "100px"});
  for (const part of parts.keys()) observer.observe(part);
}

function update({onlyInSight = false} = {}) {
  cancelAnimationFrame(frame);
  frame = 0;
  if (isPad()) return;
  showContact();
  const answer = library.ask(numbers());
  if (answer.shown < 0) {
    for (const picture of Object.values(pictures)) picture.clear();
    write(the("limit_facts"), "");
  } else {
    drawEllipse(answer);
    drawPressure(answer);
    drawLimit(answer);
    const {lowest, highest, exponent} = answer.limit;
    write(the("limit_facts"), `Exact limit surface of a pressure p ~ (1 − x²/a² − y²/b²)ⁿ with n = ${number(Number(exponent.toPrecision(3)))}, ` +
      `which has this model’s torque; the friction ellipsoid lies up to ${percent(Math.max(0, -lowest))} outside of it and ${percent(Math.max(0, Number(highest.toFixed(6))))} inside.`);
  }
  for (const [part, show] of parts) if (!onlyInSight || inSight.has(part)) show(answer);
  showKeyNumbers(answer);
  const verdict = verdictOf(answer);
  write(the("verdict"), verdict);
  write(the("command"), commandOf());
  clearTimeout(settled);
  // Once the slider rests: also the address, and the words for those who listen.
  settled = setTimeout(() => {
    for (const show of parts.values()) show(answer);
    if (answer.shown >= 0) {
      const doubt = doubtOf(answer);
      drawLimit(answer, doubt);
      showKeyNumbers(answer, doubt);
    }
    writeAddress();
    write(the("status"), verdict);
  }, 400);
}
const updateSoon = () => { frame ||= requestAnimationFrame(() => update({onlyInSight: true})); };

function listen() {
  listenToSliders(sliders, {set, soon: updateSoon, settled: () => update()});
  document.querySelector("form.sliders").addEventListener("submit", (event) => event.preventDefault());
  for (const radio of all('input[name="shown"]'))
    radio.addEventListener("change", () => {
      state.shown = Number(radio.value);
      update();
    });
  the("reset").addEventListener("click", () => {
    for (const slider of sliders) state[slider.key] = slider.start;
    state.shown = -1;
    update();
  });
  the("share").addEventListener("click", () => {
    writeAddress();
    copy(the("share"), location.href);
  });
  for (const button of all("button[data-copy]"))
    button.addEventListener("click", () => copy(button, document.querySelector(`pre[data-simulator="${button.dataset.copy}"]`).textContent));
  for (const part of ["curved", "pad"]) the(`choose_${part}`).addEventListener("click", () => choose(part));
  addEventListener("hashchange", () => choose(readAddress()));
  new ResizeObserver(() => {
    const current = widths();
    const hasChanged = isPad() ? pads.fit() : Object.values(pictures).some((picture, i) => picture.width !== current[i]);
    if (!hasChanged) return;
    if (isPad()) pads.soon();
    else {
      fit();
      updateSoon();
    }
    page.dataset.overflow = String(page.scrollWidth > page.clientWidth);
  }).observe(document.body);
}

async function start() {
  page.dataset.chartsExpected = "3";
  page.dataset.chartsDrawn = "0"; // also shows the places of the charts, see report.css
  library = await load();
  pads = startPads(library, padData, writeAddress);
  listen();
  watchParts();
  choose(readAddress());
  page.dataset.chartsDrawn = String(all(".plot svg").filter((svg) => svg.querySelector("path[data-path]")).length);
  page.dataset.overflow = String(page.scrollWidth > page.clientWidth);
  // After the first picture: the clock needs some calls.
  setTimeout(() => {
    times = models.map((_, i) => library.time(numbers(), i));
    page.dataset.timed = "true";
    update();
  }, 50);
}
start().catch((error) => {
  the("failure").hidden = false;
  the("failure").textContent = `This browser cannot run the page’s WebAssembly: ${error.message}`;
  page.dataset.scriptErrors = String(1 + Number(page.dataset.scriptErrors ?? 0));
});
