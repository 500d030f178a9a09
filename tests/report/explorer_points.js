// node explorer_points.js WASM WRITER: the page's explorer.wasm against the library, at the points of
// write_explorer_points.cc.
"use strict";
const {readFileSync} = require("node:fs");
const {execFileSync} = require("node:child_process");

// The same sources, the same order of operations and no fused ones: what differs is the C library's log,
// exp, pow and cbrt, by an ulp of 2e-16. The models pass it on some ten to a hundred times.
const TOLERANCE = 1e-12;

const [wasm, writer] = process.argv.slice(2);
const module_ = new WebAssembly.Module(readFileSync(wasm));
const imports = {};
for (const {module, name} of WebAssembly.Module.imports(module_))
  (imports[module] ??= {})[name] = () => { throw new Error(`the library called ${name}`); };
const {exports} = new WebAssembly.Instance(module_, imports);
exports._initialize();

function ask(numbers) {
  new Float64Array(exports.memory.buffer, exports.question(), numbers.length).set(numbers);
  const start = exports.answer(), bytes = new Uint8Array(exports.memory.buffer, start);
  return JSON.parse(new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0))));
}

let points = 0, compared = 0, texts = 0, bounds = 0, worst = 0;
const wrong = [];
function expect(holds, what, at) {
  if (!holds) wrong.push(`${what} at ${JSON.stringify(at)}`);
}
// `scale`: what the value is a difference of; a bound and a deviation are differences of numbers near 1.
function near(seen, wanted, what, at, scale = 0) {
  ++compared;
  const error = Math.abs(seen - wanted) / Math.max(Math.abs(wanted), scale);
  worst = Math.max(worst, error);
  expect(error <= TOLERANCE, `${what}: ${seen}, not ${wanted}`, at);
}

const lines = execFileSync(writer, {maxBuffer: 1 << 28}).toString().trimEnd().split("\n");
for (const text of lines) {
  const wanted = JSON.parse(text), at = wanted.numbers, answer = ask(at);
  ++points;
  expect(answer.models.length === wanted.models.length, "the number of models", at);
  wanted.models.forEach((model, i) => {
    const seen = answer.models[i], name = model.name;
    expect(seen.name === name && seen.has_answer === model.has_answer, `${name}: the answer`, at);
    if (!model.has_answer) {
      expect(seen.a_m === null && seen.bound === null && seen.objections.length > 0, `${name}: no answer`, at);
      return;
    }
    for (const key of ["a_m", "b_m", "indentation_m", "area_m2", "peak_pressure_Pa", "max_torque_Nm", "eccentricity_m"])
      near(seen[key], model[key], `${name}.${key}`, at);
    expect((seen.bound === null) === (model.bound === null), `${name}: whether a bound is known`, at);
    model.bound?.forEach((bound, q) => near(seen.bound[q], bound, `${name}.bound[${q}]`, at, 1));
    bounds += model.bound !== null;
    expect(seen.objections.length === model.failing, `${name}: the checks that fail`, at);
    expect(seen.usable === (model.bound !== null && Math.max(model.bound[3], model.bound[5]) <= at[7]), `${name}: usable`, at);
  });
  if (!wanted.limit) continue;
  for (const key of ["exponent", "lowest", "highest"]) {
    // Found by searches, which stop within 1e-13 (exponent) and 1e-8 (deviation) of the end.
    const within = key === "exponent" ? 1e-9 : 1e-7;
    expect(Math.abs(answer.limit[key] - wanted.limit[key]) <= within * (1 + Math.abs(wanted.limit[key])), `${key}: ${answer.limit[key]}, not ${wanted.limit[key]}`, at);
  }
  for (const {name, text: lines_} of answer.simulators) {
    ++texts;
    expect(lines_ === wanted.simulators[name], `${name}:\n${lines_}\nnot\n${wanted.simulators[name]}`, at);
  }
}
// A comparison of nothing would agree.
expect(points === 10000 && texts > 500 && bounds > 10000, `only ${points} points, ${texts} texts, ${bounds} bounds`, []);
console.log(`${points} points, ${compared} numbers, ${bounds} bounds known, ${texts} texts; worst relative difference ${worst.toExponential(2)}`);
if (wrong.length) {
  console.error(`${wrong.length} differ:\n${wrong.slice(0, 5).join("\n")}`);
  process.exit(1);
}
