// node explorer_pads_against_program.mjs PROGRAM PAGE: what explorer_pads_reader.js saw on the page of
// `softfinger explore` against `softfinger predict --json`, asked with the command that the page itself shows.
import {readFileSync} from "node:fs";
import {execFileSync} from "node:child_process";

const [program, dump] = process.argv.slice(2);
const states = JSON.parse(decodeURIComponent(/data-states="([^"]*)"/.exec(readFileSync(dump, "utf8"))[1]));

// Column of the table: key of the answer, what it is multiplied with. Four digits are shown.
const COLUMNS = {
  torque: ["max_torque_Nm", 1e3], arm: ["eccentricity_m", 1e3], pressed: ["pressure_arm_m", 1e3], indentation: ["indentation_m", 1e3],
  stiffness: ["normal_stiffness_N_per_m", 1e-3], peak: ["peak_pressure_Pa", 1e-3],
};
const BOUNDS = {torque_bound: "max_torque", pressed_bound: "indentation"};

const wrong = [];
let compared = 0, bounds = 0;
// Half of the last digit, and what rounding of the last bits may turn to the other side.
function expectDigits(text, wanted, digits, where) {
  ++compared;
  const half = 0.5 * 10 ** (Math.floor(Math.log10(Math.abs(wanted))) + 1 - digits);
  if (!(Math.abs(Number(text) - wanted) <= half * (1 + 1e-6))) wrong.push(`${where}: ${text}, not ${wanted}`);
}
function expect(seen, wanted, where) {
  ++compared;
  if (seen !== wanted) wrong.push(`${where}: ${seen}, not ${wanted}`);
}

for (const {after, command, models} of states) {
  // The page writes a command for a shell, whose quotes end here.
  const words = command.replaceAll("'", "").split(" ").slice(1);
  const {results} = JSON.parse(execFileSync(program, [...words, "--json", "--quiet"], {maxBuffer: 1 << 26}));
  for (const result of results) {
    const cells = models[result.model], where = `${result.model} after ${after} (${command})`;
    for (const [column, [key, factor]] of Object.entries(COLUMNS)) expectDigits(cells[column], factor * result[key], 4, `${column} of ${where}`);
    for (const [column, key] of Object.entries(BOUNDS)) {
      const bound = result.error_bound?.[key] ?? null;
      bounds += bound !== null;
      if (bound === null) expect(cells[column], "–", `${column} of ${where}`);
      else if (bound >= 10) expect(cells[column], "> 1000 %", `${column} of ${where}`);
      else if (bound > 0) expectDigits(cells[column].replace(" %", ""), 100 * bound, bound < 0.1 ? 2 : 3, `${column} of ${where}`);
    }
    expect(cells.verdict === "✓ usable", result.usable, `usable of ${where}`);
  }
}
console.log(`${states.length} states, ${compared} values compared, ${bounds} bounds`);
if (!compared || !bounds) wrong.push("nothing was compared");
if (wrong.length) {
  console.error(`${wrong.length} differ:\n${wrong.slice(0, 8).join("\n")}`);
  process.exit(1);
}
