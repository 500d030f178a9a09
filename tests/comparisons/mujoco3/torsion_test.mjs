// node torsion_test.mjs TEST SOFTFINGER NPM FOLDER PIPE
// libsoftfinger_torsion in MuJoCo 3: it sets each step's torsional friction in the memory of the WebAssembly. The lines
// of one load are pasted; a ball of the same numbers then holds what `softfinger predict` states at any load.
import {spawn, spawnSync} from 'node:child_process';
import {createInterface} from 'node:readline';
import {loadMujoco} from '../../../comparisons/benchmark/mujoco3/load_mujoco.mjs';

const [test, softfinger, npm, folder, pipe] = process.argv.slice(2);

const ask = (...words) => {
  const run = spawnSync(softfinger, words, {encoding: 'utf8', maxBuffer: 1e8});
  if (run.status === 0) return JSON.parse(run.stdout);
  console.log(`softfinger ${words.join(' ')} ends with ${run.status}\n${run.stderr}`);
  process.exit(1);
};

// A ball of 20 mm whose skin follows it, on a plane.
const radius_m = 0.02, layer = {thickness_m: 2e-3, youngs_Pa: 3e5, poisson: 0.49}, friction = 0.8;
const typed = load_N => ['--radii-mm', '20', '--thickness-mm', '2', '--youngs-modulus-kPa', '300',
  '--poisson-ratio', '0.49', '--load', String(load_N), '--friction', String(friction)];
const predicted_Nm = load_N =>
  ask('predict', ...typed(load_N), '--model', 'fingertip_layer', '--json').results[0].max_torque_Nm;

const mass_kg = 0.02, inertia_kgm2 = 0.4 * mass_kg * radius_m ** 2, timeStep_s = 1e-3;
const world = lines => `<mujoco>
${lines}<option gravity="0 0 0" timestep="${timeStep_s}" solver="Newton" iterations="200" tolerance="1e-14"/>
<worldbody>
  <geom type="plane" size="1 1 0.1"/>
  <body pos="0 0 ${radius_m}">
    <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
    <joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 0 1"/>
    <geom class="soft_finger" type="sphere" size="${radius_m}" mass="${mass_kg}"/>
  </body>
</worldbody>
</mujoco>`;

/** The library, in a process of its own. */
class Torsion {
  constructor() {
    this.process = spawn(pipe, [radius_m, radius_m, layer.thickness_m, layer.youngs_Pa, layer.poisson].map(String),
      {stdio: ['pipe', 'pipe', 'inherit']});
    this.lines = createInterface({input: this.process.stdout})[Symbol.asyncIterator]();
  }
  async set(numbers) {
    this.process.stdin.write(`${numbers.map(x => x.toPrecision(17)).join(' ')}\n`);
    return (await this.lines.next()).value.split(' ').map(Number);
  }
  end() { this.process.stdin.end(); }
}

/** The row's element of efc_AR: its place, where MuJoCo makes it. */
function diagonalOfAR(mujoco, model, data, row) {
  if (!mujoco.mj_isDual(model)) return -1;
  if (!mujoco.mj_isSparse(model)) return data.nefc * row + row;
  for (let i = data.efc_AR_rowadr[row]; i < data.efc_AR_rowadr[row] + data.efc_AR_rownnz[row]; ++i)
    if (data.efc_AR_colind[i] === row) return i;
  return -1;
}

/**
 * The friction of the first contact in MuJoCo's own memory: `data.contact` is a copy. Contacts begin the arena; distance,
 * place, axes and margin, 14 numbers, come first.
 */
function frictionInPlace(data, contact) {
  const friction = new Float64Array(data.arena.buffer, data.arena.byteOffset + 14 * 8, 5);
  expect([...contact.friction].every((x, i) => x === friction[i]), 'mjContact has its friction elsewhere');
  return friction;
}

/** Presses for half a second, then twists for another one; means over that one's second half. */
async function twist(mujoco, xml, load_N, torque_Nm, torsion) {
  const model = mujoco.MjModel.from_xml_string(xml), data = new mujoco.MjData(model);
  let normal_N = 0;
  const step = async () => {
    mujoco.mj_step1(model, data);
    const contact = data.ncon > 0 ? data.contact.get(0) : null;
    if (torsion && contact && contact.efc_address >= 0) {
      const row = contact.efc_address + 3, place = diagonalOfAR(mujoco, model, data, row);
      const coefficients = frictionInPlace(data, contact);
      const answer = await torsion.set([normal_N, ...coefficients, data.efc_R[row], data.efc_D[row],
        data.efc_diagA[row], place < 0 ? 0 : data.efc_AR[place]]);
      [coefficients[2], data.efc_R[row], data.efc_D[row], data.efc_diagA[row]] = answer;
      if (place >= 0) data.efc_AR[place] = answer[4];
      if (data.nisland > 0) {
        const copy = data.map_efc2iefc[row];
        [data.iefc_R[copy], data.iefc_D[copy]] = [answer[1], answer[2]];
      }
    }
    const torsional = contact ? frictionInPlace(data, data.contact.get(0))[2] : 0;
    mujoco.mj_step2(model, data);
    normal_N = contact && contact.efc_address >= 0 ? data.efc_force[contact.efc_address] : 0;
    return torsional;
  };
  let torsional = 0;
  const run = async duration_s => {
    for (let i = 0; i < Math.round(duration_s / timeStep_s); ++i) torsional = await step();
  };
  data.qfrc_applied[2] = -load_N;
  await run(0.5);
  data.qfrc_applied[3] = torque_Nm;
  await run(0.5);
  const before = data.qvel[3];
  await run(0.5);
  const velocity_rad_per_s = data.qvel[3], acceleration = (velocity_rad_per_s - before) / 0.5;
  data.delete();
  model.delete();
  return {velocity_rad_per_s, friction_Nm: torque_Nm - inertia_kgm2 * acceleration, torsional};
}

let failures = 0;
function expect(isTrue, message) {
  if (!isTrue) console.log(`FAILED: ${message}`);
  failures += !isTrue;
}

const tests = {
  async HoldsAndSlipsAtThePredictedTorqueOfEveryLoad(mujoco) {
    const {lines} = ask('export', ...typed(2), '--to', 'mujoco', '--model', 'fingertip_layer', '--json');
    for (const load_N of [0.2, 2, 10]) {
      const torque_Nm = predicted_Nm(load_N), free_rad_per_s = torque_Nm / inertia_kgm2;
      const twisted = async (share, isSet) => {
        const torsion = isSet ? new Torsion() : null;
        const found = await twist(mujoco, world(lines), load_N, share * torque_Nm, torsion);
        if (torsion) torsion.end();
        return found;
      };
      const held = await twisted(0.97, true), slips = await twisted(1.03, true), asPasted = await twisted(1.5, false);
      const largest = slips.friction_Nm / torque_Nm, pasted = asPasted.friction_Nm / torque_Nm;
      console.log(`${load_N} N: at 0.97 it turns at ${held.velocity_rad_per_s.toExponential(1)} rad/s, at 1.03 it slips against ` +
        `${largest.toFixed(5)} of the torque; with the lines of 2 N alone against ${pasted.toFixed(3)}`);
      // As with the exported lines at their own load; the table adds 1e-4.
      expect(Math.abs(held.velocity_rad_per_s) < 1e-6 * free_rad_per_s, `${load_N} N: does not hold at 0.97`);
      expect(Math.abs(largest - 1) < 2e-3, `${load_N} N: slips at ${largest} of the predicted torque`);
      expect(Math.abs(slips.torsional / (torque_Nm / load_N) - 1) < 2e-3, `${load_N} N: friction[2] ${slips.torsional}`);
      if (load_N !== 2) expect(Math.abs(pasted - 1) > 0.1, 'another load needs another number');
    }
  },
};

const mujoco = await loadMujoco(npm, folder);
await tests[test](mujoco);
process.exit(failures > 0 ? 1 : 0);
