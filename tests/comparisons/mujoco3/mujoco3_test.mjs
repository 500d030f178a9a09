// node mujoco3_test.mjs TEST SOFTFINGER NPM FOLDER
// Pastes what `softfinger export CASE --to mujoco` prints into MuJoCo 3. A fingertip is pressed on an
// object and twisted: does it hold below the torque that `softfinger predict` states, and slip above it?
//
// MuJoCo's friction is soft, so that the criteria are accelerations. The simulator's largest torque is
// what the applied one is less inertia times acceleration. FOLDER keeps the package from npm.
import {spawnSync} from 'node:child_process';
import {loadMujoco} from './load_mujoco.mjs';

const [test, softfinger, npm, folder] = process.argv.slice(2);

/** What the program prints. An answer that is not usable (status 1) is an answer, too. */
function ask(...words) {
  const run = spawnSync(softfinger, words, {encoding: 'utf8', maxBuffer: 1e8});
  if (run.status === 0 || run.status === 1) return run.stdout;
  console.log(`softfinger ${words.join(' ')} ends with ${run.status}\n${run.stderr}`);
  process.exit(1);
}

/** The exported lines of a case, and the largest torque by the same model at the same load. */
function exported(name) {
  // What nobody vouches for is printed when one insists.
  const made = JSON.parse(ask('export', name, '--to', 'mujoco', '--json', '--force'));
  const predicted = JSON.parse(
    ask('predict', name, '--model', made.model, '--set', `contact.load_N=${made.load_N}`, '--json'));
  return {lines: made.lines, load_N: made.load_N, torque_Nm: predicted.results[0].max_torque_Nm};
}

const mass_kg = 0.02, radius_m = 0.02, timeStep_s = 1e-3;
const inertia_kgm2 = 0.4 * mass_kg * radius_m ** 2;
const sideways = [['slide', '1 0 0'], ['slide', '0 1 0']], upAndRound = [['slide', '0 0 1'], ['hinge', '0 0 1']];

/** A ball on a plane without gravity. The plane keeps MuJoCo's default friction, 1 and 5 mm. */
function world(lines, joints) {
  return `<mujoco>
${lines}<option gravity="0 0 0" timestep="${timeStep_s}" solver="Newton" iterations="200" tolerance="1e-14"/>
<worldbody>
  <geom type="plane" size="1 1 0.1"/>
  <body pos="0 0 ${radius_m}">
    ${joints.map(([type, axis]) => `<joint type="${type}" axis="${axis}"/>`).join('')}
    <geom class="soft_finger" type="sphere" size="${radius_m}" mass="${mass_kg}"/>
  </body>
</worldbody>
</mujoco>`;
}

/** Presses for half a second, then twists for another one; means over that one's second half. */
function twist(mujoco, xml, load_N, torque_Nm) {
  const model = mujoco.MjModel.from_xml_string(xml), data = new mujoco.MjData(model);
  const hinge = model.nv - 1, slide = model.nv - 2;
  const run = duration_s => {
    for (let step = 0; step < Math.round(duration_s / timeStep_s); ++step) mujoco.mj_step(model, data);
  };
  data.qfrc_applied[slide] = -load_N;
  run(0.5);
  data.qfrc_applied[hinge] = torque_Nm;
  run(0.5);
  const before = data.qvel[hinge];
  run(0.5);
  const velocity_rad_per_s = data.qvel[hinge];
  data.delete();
  model.delete();
  const acceleration = (velocity_rad_per_s - before) / 0.5;
  return {velocity_rad_per_s, friction_Nm: torque_Nm - inertia_kgm2 * acceleration};
}

let failures = 0;
function expect(isTrue, message) {
  if (!isTrue) console.log(`FAILED: ${message}`);
  failures += !isTrue;
}

const tests = {
  EveryCaseHoldsBelowThePredictedTorqueAndSlipsAboveIt(mujoco) {
    const cases = ask('list', 'cases').match(/^ *[a-z0-9_]+(?= )/gm).map(name => name.trim());
    expect(cases.length >= 20, `softfinger list cases names ${cases.length} cases`);
    for (const name of cases) {
      const {lines, load_N, torque_Nm} = exported(name);
      const xml = world(lines, [...sideways, ...upAndRound]);
      const held = twist(mujoco, xml, load_N, 0.97 * torque_Nm), slipping = twist(mujoco, xml, load_N, 1.03 * torque_Nm);
      // Without friction it would turn at torque/inertia times a second.
      const free_rad_per_s = torque_Nm / inertia_kgm2;
      const largest = slipping.friction_Nm / torque_Nm;
      console.log(`${name}: ${load_N} N, ${(1e3 * torque_Nm).toPrecision(5)} mN·m; at 0.97 it turns at ` +
        `${held.velocity_rad_per_s.toExponential(1)} rad/s, at 1.03 it slips against ${largest.toFixed(6)} of the torque`);
      expect(Math.abs(held.velocity_rad_per_s) < 1e-6 * free_rad_per_s, `${name} does not hold at 0.97`);
      // The exported numbers have six digits; MuJoCo's soft friction differs from the limit by up to 4e-4.
      expect(Math.abs(largest - 1) < 1e-3, `${name} slips at ${largest} of the predicted torque`);
    }
  },

  // One of the traps that `softfinger export --to mujoco` prints.
  NoslipIterationsDoNothingWhereNothingMovesSideways(mujoco) {
    const {lines, load_N, torque_Nm} = exported('silicone_pad_2mm');
    expect(lines.includes(' noslip_iterations="5"'), 'the exported lines set noslip_iterations');
    const without = lines.replace(' noslip_iterations="5"', '');
    const creep = (some, joints) => twist(mujoco, world(some, joints), load_N, 0.5 * torque_Nm).velocity_rad_per_s;
    const free = [...sideways, ...upAndRound], stiff = [['slide', '1 0 0" stiffness="1e6'], ...upAndRound];
    console.log(`creep: free ${creep(without, free)} rad/s, with noslip ${creep(lines, free)}; on a hinge and a ` +
      `slide ${creep(without, upAndRound)}, with noslip ${creep(lines, upAndRound)}`);
    expect(creep(without, free) > 0.1, 'without noslip_iterations a held contact creeps');
    expect(Math.abs(creep(lines, free)) < 1e-9, 'with them it does not');
    expect(creep(without, upAndRound) > 0.1, 'nor does it hold on a hinge and a slide without them');
    expect(Math.abs(creep(lines, upAndRound) / creep(without, upAndRound) - 1) < 1e-6,
      'they make no difference on a hinge and a slide');
    expect(Math.abs(creep(lines, stiff)) < 1e-9, 'with a stiff joint across the normal they hold');
    expect(ask('export', 'silicone_pad_2mm', '--to', 'mujoco').includes('noslip_iterations does nothing'),
      'export --to mujoco states the trap');
  },
};

const mujoco = await loadMujoco(npm, folder);
tests[test](mujoco);
process.exit(failures > 0 ? 1 : 0);
