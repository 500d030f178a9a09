// node explorer_against_program.mjs PROGRAM PAGE: what explorer_reader.js saw on the page of `softfinger
// explore` against `softfinger predict --json`, asked with the command that the page itself shows.
import {readFileSync} from "node:fs";
import {execFileSync} from "node:child_process";

const [program, dump] = process.argv.slice(2);
const states = JSON.parse(decodeURIComponent(/data-states="([^"]*)"/.exec(readFileSync(dump, "utf8"))[1]));

// Column of the table: key of the answer, what it is multiplied with, digits that are shown.
const COLUMNS = {
  a: ["a_m", 1e3, 4], b: ["b_m", 1e3, 4], area: ["area_m2", 1e6, 4], indentation: ["indentation_m", 1e3, 4],
  peak: ["peak_pressure_Pa", 1e-3, 4], torque: ["max_torque_Nm", 1e3, 4], arm: ["eccentricity_m", 1e3, 4],
};
const BOUNDS = {contact_bound: ["a", "b", "area"], torque_bound: ["max_torque"]};

const wrong = [], asked = new Map();
let compared = 0, answered = 0, bounds = 0;
// Half of the last of `digits` digits, and what rounding of the last bits may turn to the other side.
function expectDigits(text, wanted, digits, where) {
  ++compared;
  const half = 0.5 * 10 ** (Math.floor(Math.log10(Math.abs(wanted))) + 1 - digits);
  if (!(Math.abs(Number(text) - wanted) <= half * (1 + 1e-6))) wrong.push(`${where}: ${text}, not ${wanted}`);
}
function expect(seen, wanted, where) {
  ++compared;
  if (seen !== wanted) wrong.push(`${where}: ${seen}, not ${wanted}`);
}
const answerOf = (command) => {
  if (!asked.has(command)) {
    const words = command.split(" ").slice(1);
    asked.set(command, JSON.parse(execFileSync(program, [...words, "--json", "--quiet"], {maxBuffer: 1 << 26})));
  }
  return asked.get(command);
};

// The largest torque of a model where inputs are as far off as the page says, one at a time.
const DOUBTS = [["youngs-modulus-kPa", 2], ["youngs-modulus-kPa", 1 / 2], ["thickness-mm", 1.1], ["thickness-mm", 1 / 1.1], ["friction", 1.1], ["friction", 1 / 1.1]];
function doubtedTorques_mNm(command, model) {
  const commands = [command, ...DOUBTS.map(([option, factor]) =>
    command.replace(new RegExp(`(--${option} )(\\S+)`), (_, name, value) => `${name}${Number(value) * factor}`))];
  return commands.map((words) => 1e3 * answerOf(words).results.find((result) => result.model === model).max_torque_Nm);
}

let doubts = 0;
for (const {after, command, shown, models, verdict, doubt} of states) {
  if (/ to /.test(doubt ?? "")) {
    ++doubts;
    const torques = doubtedTorques_mNm(command, shown), [least, most] = doubt.replace(" mN·m", "").split(" to ");
    expectDigits(least, Math.min(...torques), 4, `the least torque in doubt after ${after} (${command})`);
    expectDigits(most, Math.max(...torques), 4, `the largest torque in doubt after ${after} (${command})`);
  }
  const results = new Map(answerOf(command).results.map((result) => [result.model, result]));
  for (const [name, cells] of Object.entries(models)) {
    const result = results.get(name), where = `${name} after ${after} (${command})`;
    if (!result) {
      wrong.push(`${where}: softfinger predict does not answer`);
      continue;
    }
    const has_answer = result.a_m !== null;
    answered += has_answer;
    for (const [column, [key, factor, digits]] of Object.entries(COLUMNS))
      if (has_answer) expectDigits(cells[column], factor * result[key], digits, `${column} of ${where}`);
      else expect(cells[column], "–", `${column} of ${where}`);
    for (const [column, quantities] of Object.entries(BOUNDS)) {
      const bound = result.error_bound && Math.max(...quantities.map((quantity) => result.error_bound[quantity]));
      bounds += bound !== null;
      if (bound === null) expect(cells[column], "–", `${column} of ${where}`);
      else if (bound >= 10) expect(cells[column], "> 1000 %", `${column} of ${where}`);
      else expectDigits(cells[column].replace(" %", ""), 100 * bound, bound < 0.1 ? 2 : 3, `${column} of ${where}`);
    }
    expect(cells.verdict === "✓ usable", result.usable, `usable of ${where}`);
  }
  if (shown && !verdict.startsWith(`${shown[0].toUpperCase()}${shown.slice(1).replaceAll("_", " ")}:`)) wrong.push(`${shown} is drawn, but the sentence says: ${verdict}`);
}
console.log(`${states.length} states, ${asked.size} contacts, ${compared} values compared, ${answered} answers, ${bounds} bounds`);
if (!compared || !bounds || !doubts) wrong.push("nothing was compared");
if (wrong.length) {
  console.error(`${wrong.length} differ:\n${wrong.slice(0, 8).join("\n")}`);
  process.exit(1);
}
