// node creep_test.mjs TEST SOFTFINGER NPM FOLDER
// Runs holds of the benchmark of creep in MuJoCo 3, and in `softfinger simulate`. FOLDER keeps the package from npm.
import {loadMujoco} from '../../../comparisons/benchmark/mujoco3/load_mujoco.mjs';
import * as mujocoRuns from '../../../comparisons/benchmark/creep/mujoco.mjs';
import {residualVelocity_m_per_s} from '../../../comparisons/benchmark/creep/residual_velocity.mjs';
import {capsule, gravity_m_per_s2, wall} from '../../../comparisons/benchmark/creep/scenes.mjs';
import * as softfingerRuns from '../../../comparisons/benchmark/creep/softfinger.mjs';

const [test, softfinger, npm, folder] = process.argv.slice(2);

let failures = 0;
function expect(isTrue, message) {
  if (!isTrue) console.log(`FAILED: ${message}`);
  failures += !isTrue;
}

const setting = name => mujocoRuns.settings.find(one => one.name === name);

const tests = {
  // The formula is that of MuJoCo's documentation. It takes the four corners to be pressed alike; the weight presses the
  // lower ones more, which moves the sum of 1/R by some 0.1 %.
  ACubeOnAWallSlidesByTheResidualVelocityOfTheDocumentation(mujoco) {
    const scene = wall(10), {mass_kg} = scene.bodies[1];
    const told = {
      'defaults': {friction: scene.friction},
      'defaults, step of 0.5 ms': {friction: scene.friction},
      'impratio 10': {friction: scene.friction, impratio: 10},
      'elliptic': {},
      'elliptic, impratio 10': {impratio: 10},
      'elliptic, impratio 100': {impratio: 100},
      'elliptic, impratio 100, stiff': {impratio: 100, timeConstant_s: 0.004, solimp: [0.99, 0.999, 1e-3]},
    };
    for (const [name, words] of Object.entries(told)) {
      const [{um_per_s, sunk_mm}] = mujocoRuns.run(mujoco, scene, setting(name));
      const formula = 1e6 * residualVelocity_m_per_s({force_N: mass_kg * gravity_m_per_s2 / 4, inverseMass_per_kg: 1 / mass_kg,
        penetration_m: 1e-3 * sunk_mm, ...words});
      console.log(`${name}: slides at ${um_per_s.toPrecision(5)} um/s, by the formula at ${formula.toPrecision(5)}`);
      expect(Math.abs(um_per_s / formula - 1) < 5e-3, `${name}: ${um_per_s} um/s instead of ${formula}`);
    }
    const [{um_per_s}] = softfingerRuns.run(softfinger, scene, {});
    console.log(`softfinger simulate: ${um_per_s.toExponential(1)} um/s`);
    // Round-off of a step's free velocity of 20 mm/s is 4e-12 um/s; the solver's residual leaves some 1e-9.
    expect(um_per_s < 1e-6, `softfinger simulate lets the cube slide at ${um_per_s} um/s`);
  },

  APinchedCapsuleCreepsAtTheDefaultsWhateverTheGrip(mujoco) {
    const drift = (grip_N, name) => {
      const [result] = mujocoRuns.run(mujoco, capsule(grip_N), setting(name));
      console.log(`${grip_N} N, ${name}: ${result.um_per_s.toPrecision(4)} um/s, ${result.mrad_per_s.toPrecision(4)} mrad/s`);
      expect(result.lost_at_s === null, `${grip_N} N, ${name}: the capsule is lost`);
      return result;
    };
    const least = drift(12, 'defaults'), more = drift(24, 'defaults');
    expect(least.um_per_s > 1000 && least.mrad_per_s > 100, 'MuJoCo creeps at its defaults');
    // Both grips sink in by more than solimp's width, so that R is the same; how far the capsule has turned differs a little.
    expect(Math.abs(more.um_per_s / least.um_per_s - 1) < 0.05, 'twice the grip creeps as fast');
    const stiff = drift(12, 'elliptic, stiff'), told = drift(12, 'elliptic, impratio 100, stiff');
    expect(Math.abs(stiff.um_per_s / told.um_per_s / 100 - 1) < 0.05, 'impratio divides the creep');
    expect(told.um_per_s < 1, 'what the page says to set holds');
    // Each of the four points bears a quarter of the weight.
    const {bodies: [{mass_kg}, {mass_kg: pad_kg}]} = capsule(12), {um_per_s, sunk_mm} = drift(12, 'elliptic, impratio 100');
    const formula = 1e6 * residualVelocity_m_per_s({force_N: mass_kg * gravity_m_per_s2 / 4, inverseMass_per_kg: 1 / mass_kg + 1 / pad_kg,
      penetration_m: 1e-3 * sunk_mm, impratio: 100});
    expect(Math.abs(um_per_s / formula - 1) < 5e-3, `the capsule slides at ${um_per_s} um/s instead of ${formula}`);
    const [ours] = softfingerRuns.run(softfinger, capsule(12), {});
    console.log(`softfinger simulate: ${ours.um_per_s.toExponential(1)} um/s, ${ours.mrad_per_s.toExponential(1)} mrad/s`);
    expect(ours.um_per_s < 1e-6 && ours.mrad_per_s < 1e-6, 'softfinger simulate does not creep');
  },
};

const mujoco = await loadMujoco(npm, folder);
tests[test](mujoco);
process.exit(failures > 0 ? 1 : 0);
