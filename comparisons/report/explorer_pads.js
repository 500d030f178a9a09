// The flat pad's part of the page of `softfinger explore`.
import {Picture, all, allowed, copy, listenToSliders, number, percent, roundUp, sentence, showSliders, the, write} from "./explorer_parts.js";

const PRESSINGS = ["stuck", "frictionless"], SHADES = 32;
// A pressure from 0 to 1 of its peak, in the colours of report.css, as on the other pages (charts.js).
const shade = (part) => {
  const [from, to, share] = part < 0.5 ? [0, 1, 2 * part] : [1, 2, 2 * part - 1];
  return `color-mix(in oklab, var(--ramp-${to}) ${Math.round(1000 * share) / 10}%, var(--ramp-${from}))`;
};

// @param changed  called once the sliders rest, for the address
export function startPads(library, {sliders, models, start, outline, case: caseName}, changed) {
  const state = {};
  const pictures = {map: new Picture("pad_map", {height: 330, left: 46}), pressure: new Picture("pad_pressure", {height: 330, left: 58})};
  const shapes = outline ? ["rectangle", "disc", "case"] : ["rectangle", "disc"];
  let frame = 0, settled = 0;

  function reset() {
    for (const slider of sliders) state[slider.key] = slider.start;
    Object.assign(state, {shape: start.shape, pressing: start.pressing, shown: 0});
  }
  function set(key, value) {
    state[key] = value;
    // No corner is rounder than half of the shorter side.
    if (state.shape === "rectangle") state.c = Math.min(state.c, state.L / 2, state.W / 2);
  }
  reset();

  function readAddress(given) {
    for (const slider of sliders) {
      const value = given.get(slider.key) ? Number(given.get(slider.key)) : NaN;
      if (allowed(slider, value)) set(slider.key, value);
    }
    if (shapes.includes(given.get("shape"))) state.shape = given.get("shape");
    if (PRESSINGS.includes(given.get("pressing"))) state.pressing = given.get("pressing");
    state.shown = Math.max(0, models.findIndex(({name}) => name === given.get("model")));
    set("c", state.c);
  }
  const address = () => ["contact=pad", `shape=${state.shape}`, `pressing=${state.pressing}`,
    ...sliders.map(({key}) => `${key}=${state[key]}`), `model=${models[state.shown].name}`].join("&");

  const numbers = () => {
    const si = Object.fromEntries(sliders.map(({key, si_per_unit}) => [key, state[key] * si_per_unit]));
    const corners = state.shape === "case" ? outline.corners_m : [];
    return [["rectangle", "disc", "case"].indexOf(state.shape), si.L, si.W, si.c, si.D, si.h, si.E, si.nu, si.P, si.mu,
      PRESSINGS.indexOf(state.pressing), si.within, state.shown, state.shape === "case" && !outline.is_covered ? 0 : 1, corners.length, ...corners.flat()];
  };

  // Pictures -----------------------------------------------------------------------------------------

  function drawMap(answer) {
    const picture = pictures.map, {rim_m, rings, pressure_Pa} = answer.map;
    const {left, right, top, bottom} = picture.margin;
    const [across, up] = [picture.width - left - right, picture.height - top - bottom];
    const [x0, y0] = answer.centre_m.map((at) => 1e3 * at), [wide, high] = answer.extent_m.map((length) => 1e3 * length);
    // One scale for both directions.
    const half = roundUp(Math.max(0.54 * high, 0.54 * wide * up / across)), reach = half * across / up;
    picture.axes([x0 - reach, x0 + reach], [y0 - half, y0 + half], "x, mm →", "↑ y, mm");
    const at = (k, ring) => {
      const [x, y] = rim_m[k % rim_m.length];
      return `${picture.x(x0 + rings[ring] * (1e3 * x - x0)).toFixed(1)},${picture.y(y0 + rings[ring] * (1e3 * y - y0)).toFixed(1)}`;
    };
    // The rim's own pressure has no largest value: the scale ends at the stated peak.
    const peak = answer.models[state.shown].peak_pressure_Pa, least = Math.min(peak, ...pressure_Pa);
    const part = (p) => (peak > least * (1 + 1e-9) ? Math.min(1, Math.max(0, (p - least) / (peak - least))) : 0.5);
    const cells = Array.from({length: SHADES}, () => []), count = rings.length - 1;
    pressure_Pa.forEach((p, cell) => {
      const k = Math.floor(cell / count), ring = cell % count;
      cells[Math.min(SHADES - 1, Math.floor(SHADES * part(p)))].push(`M${at(k, ring)}L${at(k, ring + 1)}L${at(k + 1, ring + 1)}L${at(k + 1, ring)}Z`);
    });
    picture.begin();
    cells.forEach((list, i) => {
      const colour = shade((i + 0.5) / SHADES);
      // The stroke closes the hairlines between cells.
      if (list.length) picture.path(`shade_${i}`, list.join(""), {fill: colour, stroke: colour, "stroke-width": 0.7});
    });
    picture.path("outline", `M${rim_m.map((_, k) => at(k, count)).join("L")}Z`, {stroke: "currentColor", "stroke-width": 1.5});
    const arm = 1e3 * answer.models[state.shown].eccentricity_m, radius = picture.x(arm) - picture.x(0);
    picture.path("arm", `M${picture.x(x0) - radius},${picture.y(y0)}a${radius},${radius} 0 1,0 ${2 * radius},0a${radius},${radius} 0 1,0 ${-2 * radius},0Z`,
      {stroke: "#fff", "stroke-width": 1.5, "stroke-dasharray": "5 4"});
    picture.end();
    write(the("pad_least"), `${number(least / 1e3)} kPa`);
    write(the("pad_peak"), `${number(peak / 1e3)} kPa`);
    picture.describe(`Pressure over the pad, ${number(least / 1e3)} to ${number(peak / 1e3)} kPa; e_n ${number(arm)} mm`);
  }

  function drawPressure(answer) {
    const picture = pictures.pressure, {x_m, along_x_Pa, y_m, along_y_Pa} = answer.profile;
    const curve = (at, pressure) => at.map((s, i) => [1e3 * s, pressure[i] / 1e3]);
    const [along_x, along_y] = [curve(x_m, along_x_Pa), curve(y_m, along_y_Pa)];
    const peak = answer.models[state.shown].peak_pressure_Pa / 1e3;
    const half = roundUp(1.02 * Math.max(...[...along_x, ...along_y].map(([s]) => Math.abs(s))));
    const most = Math.max(peak, ...[...along_x, ...along_y].map(([, p]) => p));
    picture.axes([-half, half], [0, roundUp(1.02 * most)], "from the centre, mm →", "↑ kPa");
    picture.begin();
    picture.points("along_x", along_x, {stroke: models[state.shown].colour, "stroke-width": 2.5});
    picture.points("along_y", along_y, {stroke: models[state.shown].colour, "stroke-width": 2, "stroke-dasharray": "6 4"});
    picture.end();
    picture.describe(`Pressure along x and y, at most ${number(most)} kPa`);
  }

  // Words and tables ---------------------------------------------------------------------------------

  const rows = all("tr[data-pad-model]").map((row) => ({
    row, cells: Object.fromEntries([...row.querySelectorAll("[data-key]")].map((cell) => [cell.dataset.key, cell])),
  }));
  function showTable(answer) {
    answer.models.forEach((model, i) => {
      const {row, cells} = rows[i];
      row.toggleAttribute("data-pad-shown", i === state.shown);
      const scaled = {torque: [model.max_torque_Nm, 1e3], arm: [model.eccentricity_m, 1e3], pressed: [model.pressure_arm_m, 1e3],
        indentation: [model.indentation_m, 1e3], stiffness: [model.normal_stiffness_N_per_m, 1e-3], peak: [model.peak_pressure_Pa, 1e-3]};
      for (const [key, [value, factor]] of Object.entries(scaled)) write(cells[key], value === null ? "–" : number(value * factor));
      for (const [key, name] of [["torque_bound", "max_torque"], ["pressed_bound", "indentation"]]) {
        const bound = model.bound?.[name] ?? null;
        write(cells[key], bound === null ? "–" : percent(bound));
        cells[key].className = bound === null ? "" : 100 * bound <= state.within ? "within" : "beyond";
      }
      const [kind, words] = model.usable ? ["good", "✓ usable"] : model.bound ? ["bad", "✕ no"] : ["failed", "? not known"];
      cells.verdict.className = `badge ${kind}`;
      write(cells.verdict, words);
    });
    write(the("pad_reasons"), [...new Set(answer.models.flatMap(({objections}) => objections))].map(sentence).join(" "));
  }

  function showKeyNumbers(answer) {
    const list = the("pad_key_numbers"), model = answer.models[state.shown];
    const [about_x, about_y] = model.tilt_limit_Nm.map((limit) => limit / state.P);
    const pairs = model.has_answer ? [
      ["largest torque", `${number(1e3 * model.max_torque_Nm)} mN·m`],
      ["torque / μP, the length eₙ", `${number(1e3 * model.eccentricity_m)} mm`],
      ["largest force", `${number(state.mu * state.P)} N`],
      ["indentation", `${number(1e3 * model.indentation_m)} mm, ${percent(model.indentation_m / (1e-3 * state.h))} of h`],
      ["stiffness", `${number(model.normal_stiffness_N_per_m / 1e3)} N/mm`],
      ["area, shape factor", `${number(1e6 * answer.area_m2)} mm², ${number(Number(answer.shape_factor.toPrecision(3)))}`],
      ["tilt stiffness about x, y", `${model.tilt_stiffness_Nm_per_rad.map((k) => number(Number(k.toPrecision(3)))).join(", ")} N·m/rad`],
      ["without lift-off at most", `${model.tilt_limit_Nm.map((limit) => number(Number((1e3 * limit).toPrecision(3)))).join(", ")} mN·m`],
      ["so far off the middle, along x, y", `${[about_y, about_x].map((at) => number(Number((1e3 * at).toPrecision(2)))).join(", ")} mm`],
    ] : [];
    if (list.children.length !== 2 * pairs.length)
      list.replaceChildren(...pairs.flatMap(() => ["dt", "dd"].map((name) => document.createElement(name))));
    pairs.flat().forEach((words, i) => write(list.children[i], words));
  }

  function verdictOf(answer) {
    const model = answer.models[state.shown], other = answer.models[1 - state.shown];
    if (!model.has_answer) return "No answer here: the result would be too large or too small for a number.";
    const [wide, high] = answer.extent_m.map((length) => number(1e3 * length));
    const bound = model.bound?.max_torque ?? null;
    const compared = other.has_answer ? ` ${models[1 - state.shown].label} says ${number(1e3 * other.max_torque_Nm)} mN·m.` : "";
    return `${models[state.shown].label}: a pad of ${state.shape === "disc" ? `${number(state.D)} mm diameter` : `${wide} by ${high} mm`} that holds at most ` +
      `${number(1e3 * model.max_torque_Nm)} mN·m about the normal, ${bound === null ? "with an error that is not known" : `within ${percent(bound)}`}.${compared}`;
  }

  const commandOf = () => {
    // Rounded corners have no flag of their own, but a case takes them.
    const isRounded = state.shape === "rectangle" && state.c > 0;
    const shape = isRounded ? `robotiq_like_pad --set 'geometry.finger.pad_mm=[${state.L},${state.W}]' --set geometry.finger.corner_radius_mm=${state.c}` : {
      rectangle: `--pad-mm ${state.L},${state.W}`, disc: `--pad-diameter-mm ${state.D}`, case: caseName,
    }[state.shape];
    const isDefault = state.pressing === "stuck" && state.shape !== "case";
    return [`softfinger predict ${shape} --thickness-mm ${state.h} --youngs-modulus-kPa ${state.E} --poisson-ratio ${state.nu} --load ${state.P}`,
      `--friction ${state.mu} --tolerance ${Number((state.within / 100).toPrecision(12))}`,
      ...(isDefault ? [] : [`--set 'contact.pressing="${state.pressing}"'`])].join(" ");
  };

  function showChoices() {
    showSliders(sliders, state, "pad_");
    for (const radio of all('input[name="pad_shape"]')) radio.checked = radio.value === state.shape;
    for (const radio of all('input[name="pad_pressing"]')) radio.checked = radio.value === state.pressing;
    for (const radio of all('input[name="pad_shown"]')) radio.checked = Number(radio.value) === state.shown;
    for (const row of all("[data-of-shape]")) row.hidden = row.dataset.ofShape !== state.shape;
  }

  // Putting it together ------------------------------------------------------------------------------

  function update() {
    cancelAnimationFrame(frame);
    frame = 0;
    if (the("pad").hidden) return;
    showChoices();
    const answer = library.askPad(numbers());
    if (answer.map) {
      drawMap(answer);
      drawPressure(answer);
    } else for (const picture of Object.values(pictures)) picture.clear();
    showTable(answer);
    showKeyNumbers(answer);
    for (const pre of all("pre[data-pad-simulator]"))
      write(pre, answer.simulators.find(({name}) => name === pre.dataset.padSimulator)?.text ?? "");
    const verdict = verdictOf(answer);
    write(the("pad_verdict"), verdict);
    write(the("pad_command"), commandOf());
    clearTimeout(settled);
    settled = setTimeout(() => {
      changed();
      write(the("status"), verdict);
    }, 400);
  }
  const soon = () => { frame ||= requestAnimationFrame(update); };
  const fit = () => {
    const widths = Object.values(pictures).map((picture) => picture.box.clientWidth);
    const is_new = Object.values(pictures).some((picture, i) => picture.width !== widths[i]);
    Object.values(pictures).forEach((picture, i) => picture.fit(widths[i]));
    return is_new;
  };

  listenToSliders(sliders, {set, soon, settled: update}, "pad_");
  for (const [name, choose] of [["shape", (value) => { state.shape = value; set("c", state.c); }],
    ["pressing", (value) => { state.pressing = value; }], ["shown", (value) => { state.shown = Number(value); }]])
    for (const radio of all(`input[name="pad_${name}"]`))
      radio.addEventListener("change", () => {
        choose(radio.value);
        update();
      });
  the("pad_form").addEventListener("submit", (event) => event.preventDefault());
  the("pad_reset").addEventListener("click", () => {
    reset();
    update();
  });
  the("pad_share").addEventListener("click", () => {
    changed();
    copy(the("pad_share"), location.href);
  });
  for (const button of all("button[data-pad-copy]"))
    button.addEventListener("click", () => copy(button, document.querySelector(`pre[data-pad-simulator="${button.dataset.padCopy}"]`).textContent));
  return {update, soon, fit, readAddress, address};
}
