// node creep_test.mjs NPM FOLDER
// Runs holds of the benchmark of creep in PhysX 5. FOLDER keeps the package from npm.
import {Physx, settings} from '../../../comparisons/benchmark/creep/physx.mjs';
import {capsule, wall} from '../../../comparisons/benchmark/creep/scenes.mjs';
import {loadPhysx} from '../../../comparisons/benchmark/physx5/load_physx.mjs';

const [npm, folder] = process.argv.slice(2);
const physx = new Physx(await loadPhysx(npm, folder));
let failures = 0;
function expect(isTrue, message) {
  if (!isTrue) console.log(`FAILED: ${message}`);
  failures += !isTrue;
}

const tgs = settings.find(({name}) => name === 'TGS');
for (const scene of [capsule(12), capsule(60), wall(10)]) {
  const [{um_per_s, lost_at_s}] = physx.run(scene, tgs);
  console.log(`${scene.name}, ${scene.load_N} N: ${um_per_s} um/s`);
  // Positions of centimetres in single precision are some nanometres apart, in each of ten samples a second.
  expect(lost_at_s === null && um_per_s < 0.5, `${scene.name} at ${scene.load_N} N moves by ${um_per_s} um/s`);
}

// Without friction the cube falls freely: the measure sees that it is lost.
const [{lost_at_s}] = physx.run({...wall(10), friction: 0}, tgs);
expect(lost_at_s !== null, 'a cube without friction is lost');
process.exit(failures > 0 ? 1 : 0);
