// node explorer_points.mjs WASM WRITER: the page's explorer.wasm against the library, at the points of
// write_explorer_points.cc.
import {readFileSync} from "node:fs";
import {execFileSync} from "node:child_process";

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

let points = 0, compared = 0, texts = 0, bounds = 0, curves = 0;
const wrong = [], worst = {};
function expect(holds, what, at) {
  if (!holds) wrong.push(`${what} at ${JSON.stringify(at)}`);
}
// `scale`: what the value is a difference of; a bound and a deviation are differences of numbers near 1.
function near(seen, wanted, what, at, {kind = "numbers", scale = 0, tolerance = TOLERANCE} = {}) {
  ++compared;
  const error = seen === wanted ? 0 : Math.abs(seen - wanted) / Math.max(Math.abs(wanted), scale);
  worst[kind] = Math.max(worst[kind] ?? 0, error);
  expect(error <= tolerance, `${what}: ${seen}, not ${wanted}`, at);
}
// Curves end on an axis, where a number is what rounding leaves of zero: relative to the curve's largest one.
function nearCurve(seen, wanted, what, at) {
  const scale = Math.max(...wanted.map(Math.abs));
  expect(seen.length === wanted.length && scale > 0, `${what}: ${seen.length} points, not ${wanted.length}`, at);
  wanted.forEach((value, i) => near(seen[i], value, `${what}[${i}]`, at, {kind: "curves", scale}));
  ++curves;
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
    model.bound?.forEach((bound, q) => near(seen.bound[q], bound, `${name}.bound[${q}]`, at, {kind: "bounds", scale: 1}));
    bounds += model.bound !== null;
    expect(seen.objections.length === model.failing, `${name}: the checks that fail`, at);
    expect(seen.usable === (model.bound !== null && Math.max(...[0, 1, 3, 5].map((q) => model.bound[q])) <= at[7]), `${name}: usable`, at);
  });
  if (!wanted.limit) continue;
  for (const key of ["exponent", "max_force_N", "max_torque_Nm"])
    near(answer.limit[key], wanted.limit[key], key, at, {kind: key});
  for (const key of ["lowest", "highest"]) near(answer.limit[key], wanted.limit[key], key, at, {kind: key, scale: 1});
  for (const curve of ["along_long", "along_short"])
    for (const [i, axis] of ["force", "torque"].entries())
      nearCurve(answer.limit[curve].map((point) => point[i]), wanted.limit[curve].map((point) => point[i]), `${axis} ${curve}`, at);
  for (const curve of ["long_Pa", "short_Pa"]) nearCurve(answer.profile[curve], wanted.profile[curve], curve, at);
  for (const {name, text: lines_} of answer.simulators) {
    ++texts;
    expect(lines_ === wanted.simulators[name], `${name}:\n${lines_}\nnot\n${wanted.simulators[name]}`, at);
  }
}
// A comparison of nothing would agree.
expect(points === 10000 && texts > 2500 && bounds > 10000 && curves > 3000, `only ${points} points, ${texts} texts, ${bounds} bounds, ${curves} curves`, []);
console.log(`${points} points, ${compared} numbers, ${bounds} bounds known, ${curves} curves, ${texts} texts; worst relative differences:`,
  Object.entries(worst).map(([kind, error]) => `${kind} ${error.toExponential(1)}`).join(", "));
if (wrong.length) {
  console.error(`${wrong.length} differ:\n${wrong.slice(0, 5).join("\n")}`);
  process.exit(1);
}
