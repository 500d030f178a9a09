// node mujoco3_test.mjs TEST SOFTFINGER NPM FOLDER
// Pastes what `softfinger export CASE --to mujoco` prints into MuJoCo 3. A fingertip is pressed on an
// object and twisted: does it hold below the torque that `softfinger predict` states, and slip above it?
//
// MuJoCo's friction is soft, so that the criteria are accelerations. The simulator's largest torque is
// what the applied one is less inertia times acceleration. FOLDER keeps the package from npm.
import {spawnSync} from 'node:child_process';
import {loadMujoco} from '../../../comparisons/benchmark/mujoco3/load_mujoco.mjs';

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
  const {contact, max_torque_Nm} = predicted.results[0];
  return {lines: made.lines, load_N: made.load_N, torque_Nm: max_torque_Nm, isPad: contact === 'patch'};
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

const padMass_kg = 0.5, padInertia_kgm2 = 1e-3;

/** A free body whose pad touches the plane, its centre of mass at the contact. */
function padWorld(lines, geom) {
  return `<mujoco>
${lines}<option gravity="0 0 0" timestep="${timeStep_s}" solver="Newton" iterations="200" tolerance="1e-14"/>
<worldbody>
  <geom type="plane" size="1 1 0.1"/>
  <body pos="0 0 0.0015">
    <freejoint/>
    <inertial pos="0 0 -0.0015" mass="${padMass_kg}" diaginertia="${Array(3).fill(padInertia_kgm2).join(' ')}"/>
    ${geom}
  </body>
</worldbody>
</mujoco>`;
}

/** Presses at a place, then raises the torque within 0.1 s: whether it turns or slides 0.1 s later. */
function padTwist(mujoco, xml, load_N, torque_Nm, [x_m, y_m]) {
  const model = mujoco.MjModel.from_xml_string(xml), data = new mujoco.MjData(model);
  const run = (steps, torque) => {
    const wrench = [0, 0, -load_N, -y_m * load_N, x_m * load_N, torque];
    for (let i = 0; i < 6; ++i) data.xfrc_applied[6 + i] = wrench[i];
    for (let step = 0; step < steps; ++step) mujoco.mj_step(model, data);
  };
  run(500, 0);
  for (let share = 1; share <= 50; ++share) run(2, torque_Nm * share / 50);
  run(200, torque_Nm);
  const isSlipping = Math.abs(data.qvel[5]) > 0.1 || Math.hypot(data.qvel[0], data.qvel[1]) > 0.01;
  data.delete();
  model.delete();
  return isSlipping;
}

/** The torque without a force at which four points (+-a, +-b) slip: the least of sum mu N_i |r_i - c| over c. */
function staticTorque_Nm(load_N, friction, a, b, [x_m, y_m]) {
  const points = [[a, b], [-a, b], [a, -b], [-a, -b]].map(([x, y]) => [x, y, load_N / 4 * (1 + x_m / x + y_m / y)]);
  let least = Infinity;
  for (let i = -100; i <= 100; ++i)
    for (let j = -100; j <= 100; ++j)
      least = Math.min(least, points.reduce((sum, [x, y, N]) => sum + friction * N * Math.hypot(x - a * i / 100, y - b * j / 100), 0));
  return least;
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
      if (name === 'roller') continue;  // a line contact, which export refuses
      const {lines, load_N, torque_Nm, isPad} = exported(name);
      if (isPad) continue;  // a pad's torque would spin this ball away: see APadHoldsByABoxOrByOnePoint
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

  // A flat pad as one contact point, and as a box whose corners lie at e_n: both hold 0.97 of the stated torque and
  // slip at 1.03. Beside its middle the box still holds, as statics tell.
  APadHoldsByABoxOrByOnePoint(mujoco) {
    const numbers = ['--pad-mm', '22,37.5', '--thickness-mm', '3', '--youngs-modulus-kPa', '800', '--poisson-ratio', '0.49',
      '--load', '20', '--friction', '0.9'];
    const made = JSON.parse(ask('export', ...numbers, '--to', 'mujoco', '--json'));
    const predicted = JSON.parse(ask('predict', ...numbers, '--json')).results[0];
    const load_N = 20, friction = 0.9, torque_Nm = predicted.max_torque_Nm;
    const point = '<geom class="soft_finger" type="sphere" size="0.0015" solref="-20000 -300"/>';
    const box = '<geom class="soft_pad" solref="-20000 -300"/>';
    const ownFace = '<geom class="soft_pad" size="0.011 0.01875 0.0015" solref="-20000 -300"/>';
    const slips = (lines, geom, torque, at = [0, 0]) => padTwist(mujoco, padWorld(lines, geom), load_N, torque, at);
    const limit = (lines, geom, at) => {
      let low = 0, high = 4;
      for (let i = 0; i < 12; ++i) {
        const middle = (low + high) / 2;
        if (slips(lines, geom, middle * torque_Nm, at)) high = middle; else low = middle;
      }
      return low;
    };
    for (const [name, lines, geom] of [['one point', made.lines, point], ['the box', made.box_lines, box]]) {
      console.log(`${name}: slips at ${limit(lines, geom, [0, 0]).toFixed(3)} of the stated torque`);
      expect(!slips(lines, geom, 0.97 * torque_Nm), `${name} does not hold at 0.97`);
      expect(slips(lines, geom, 1.03 * torque_Nm), `${name} does not slip at 1.03`);
    }
    const {box_half_length_x_m: a, box_half_length_y_m: b} = made.box_values;
    for (const at of [[2e-3, 0], [0, 3.4e-3], [4e-3, 0]]) {
      const expected = staticTorque_Nm(load_N, friction, a, b, at) / torque_Nm, measured = limit(made.box_lines, box, at);
      console.log(`the box, load at ${at.map(x => 1e3 * x)} mm: slips at ${measured.toFixed(3)}, by statics ${expected.toFixed(3)}`);
      expect(Math.abs(measured / expected - 1) < 0.02, `a load at ${at} slips at ${measured} of the torque`);
    }
    const tooStrong = limit(made.box_lines, ownFace, [0, 0]);
    console.log(`the pad's own face as a box: slips at ${tooStrong.toFixed(3)}`);
    expect(Math.abs(tooStrong / (Math.hypot(11e-3, 18.75e-3) / predicted.eccentricity_m) - 1) < 0.02,
      'the corners of the own face carry the load at their distance');
  },
};

const mujoco = await loadMujoco(npm, folder);
tests[test](mujoco);
process.exit(failures > 0 ? 1 : 0);
