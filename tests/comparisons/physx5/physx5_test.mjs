// node physx5_test.mjs TEST SOFTFINGER NPM FOLDER
// Presses a fingertip with the numbers of `softfinger export --to physx`, sapien and isaac on an object in PhysX 5 and
// twists it: does it hold below the torque that `softfinger predict` states, and slip above it?
//
// The largest torque and force of friction are the applied ones less inertia and mass times acceleration. FOLDER keeps
// the package from npm.
import {spawnSync} from 'node:child_process';
import {loadPhysx} from '../../../comparisons/benchmark/physx5/load_physx.mjs';

const [test, softfinger, npm, folder] = process.argv.slice(2);

/** What the program prints as JSON. */
function ask(...words) {
  const run = spawnSync(softfinger, [...words, '--json'], {encoding: 'utf8', maxBuffer: 1e8});
  if (run.status === 0) return JSON.parse(run.stdout);
  console.log(`softfinger ${words.join(' ')} ends with ${run.status}\n${run.stderr}`);
  process.exit(1);
}

const timeStep_s = 1e-3, finger = {mass_kg: 0.02, radius_m: 0.02};
const fingerInertia_kgm2 = 0.4 * finger.mass_kg * finger.radius_m ** 2;

const PhysX = await loadPhysx(npm, folder);
const foundation = PhysX.CreateFoundation(PhysX.PHYSICS_VERSION, new PhysX.PxDefaultAllocator(), new PhysX.PxDefaultErrorCallback());
const scale = new PhysX.PxTolerancesScale(), physics = PhysX.CreatePhysics(PhysX.PHYSICS_VERSION, foundation, scale);
const vector = (x, y, z) => new PhysX.PxVec3(x, y, z);
const upright = z_m => new PhysX.PxTransform(vector(0, 0, z_m), new PhysX.PxQuat(0, 0, 0, 1));

/**
 * A body on a block, without gravity: pressed for half a second, then also pushed and twisted for 0.4 s; the friction is
 * that of the last 0.2 s.
 *
 * numbers: friction, object_friction, least_radius_m, radius_m; stiffness_N_per_m: of a compliant contact;
 * combine: "eMIN", or null for PhysX's mean
 */
function friction_of(numbers, {load_N, push_N = 0, torque_Nm = 0, solver = 'eTGS', correlation_m = 0, box_m = null}) {
  const description = new PhysX.PxSceneDesc(scale);
  description.set_gravity(vector(0, 0, 0));
  description.set_cpuDispatcher(PhysX.DefaultCpuDispatcherCreate(0));
  description.set_filterShader(PhysX.DefaultFilterShader());
  description.set_solverType(PhysX.PxSolverTypeEnum[solver]);
  if (correlation_m) description.set_frictionCorrelationDistance(correlation_m);
  const scene = physics.createScene(description);
  const material = physics.createMaterial(numbers.friction, numbers.friction, 0);
  const object = physics.createMaterial(numbers.object_friction, numbers.object_friction, 0);
  if (numbers.combine) material.setFrictionCombineMode(PhysX.PxCombineModeEnum[numbers.combine]);
  if (numbers.stiffness_N_per_m) material.setRestitution(-numbers.stiffness_N_per_m);
  const flags = new PhysX.PxShapeFlags(PhysX.PxShapeFlagEnum.eSIMULATION_SHAPE);
  const shape_of = (geometry, ofMaterial) => {
    const shape = physics.createShape(geometry, ofMaterial, true, flags);
    shape.setSimulationFilterData(new PhysX.PxFilterData(1, 1, 0, 0));
    shape.setContactOffset(1e-3);
    return shape;
  };
  const block = physics.createRigidStatic(upright(-0.1));
  block.attachShape(shape_of(new PhysX.PxBoxGeometry(1, 1, 0.1), object));
  const mass_kg = box_m ? 0.5 : finger.mass_kg, inertia_kgm2 = box_m ? 1e-3 : fingerInertia_kgm2;
  const body = physics.createRigidDynamic(upright(box_m ? box_m[2] : finger.radius_m));
  const shape = shape_of(box_m ? new PhysX.PxBoxGeometry(...box_m) : new PhysX.PxSphereGeometry(finger.radius_m), material);
  shape.setMinTorsionalPatchRadius(numbers.least_radius_m);
  shape.setTorsionalPatchRadius(numbers.radius_m);
  body.attachShape(shape);
  body.setMass(mass_kg);
  body.setMassSpaceInertiaTensor(vector(inertia_kgm2, inertia_kgm2, inertia_kgm2));
  body.setSleepThreshold(0);
  body.setAngularDamping(0);
  body.setMaxAngularVelocity(1e6);
  body.setSolverIterationCounts(16, 1);
  if (!box_m)  // the ball cannot roll
    for (const axis of ['eLOCK_ANGULAR_X', 'eLOCK_ANGULAR_Y'])
      body.setRigidDynamicLockFlag(PhysX.PxRigidDynamicLockFlagEnum[axis], true);
  scene.addActor(block);
  scene.addActor(body);
  const run = (force_N, twist_Nm, steps) => {
    for (let step = 0; step < steps; ++step) {
      body.addForce(vector(force_N, 0, -load_N));
      body.addTorque(vector(0, 0, twist_Nm));
      scene.simulate(timeStep_s);
      scene.fetchResults(true);
    }
    return [body.getLinearVelocity().get_x(), body.getAngularVelocity().get_z()];
  };
  run(0, 0, 500);
  const half = run(push_N, torque_Nm, 200), full = run(push_N, torque_Nm, 200);
  const penetration_m = (box_m ? box_m[2] : finger.radius_m) - body.getGlobalPose().get_p().get_z();
  scene.removeActor(body);
  scene.removeActor(block);
  scene.release();
  const [along, about] = [0, 1].map(i => (full[i] - half[i]) / (200 * timeStep_s));
  return {force_N: push_N - mass_kg * along, torque_Nm: torque_Nm - inertia_kgm2 * about, turning_rad_per_s: full[1], penetration_m};
}

let failures = 0;
function expect(isTrue, message) {
  if (!isTrue) console.log(`FAILED: ${message}`);
  failures += !isTrue;
}

/** Single precision, and rows that are solved one after the other. */
const tolerance = 2e-3;

function expectHoldsAndSlips(name, numbers, load_N, torque_Nm, scene) {
  for (const push of [0, 0.6])
    for (const share of [0.97, 1.03]) {
      const push_N = push * numbers.friction * load_N;
      const felt = friction_of(numbers, {load_N, push_N, torque_Nm: share * torque_Nm, ...scene}).torque_Nm / torque_Nm;
      console.log(`${name}: pushed by ${push} mu P and twisted by ${share} of the stated torque: friction ${felt.toFixed(5)} of it`);
      expect(Math.abs(felt - Math.min(share, 1)) < tolerance, `${name} at ${share} feels ${felt}`);
    }
}

function exported(to) {
  const made = ask('export', 'silicone_pad_2mm', '--to', to), values = made.values;
  const predicted = ask('predict', 'silicone_pad_2mm', '--model', made.model, '--set', `contact.load_N=${made.load_N}`);
  return {
    load_N: made.load_N, torque_Nm: predicted.results[0].max_torque_Nm,
    numbers: {
      friction: values.sliding_friction, object_friction: values.object_sliding_friction ?? 1,
      least_radius_m: values.min_torsional_patch_radius_m, radius_m: values.torsional_patch_radius_m,
      stiffness_N_per_m: values.compliant_contact_stiffness_N_per_m ?? 0, combine: to === 'sapien' ? null : 'eMIN',
    },
    correlation_m: values.friction_correlation_distance_m ?? 0,
  };
}

const tests = {
  HoldsBelowThePredictedTorqueAndSlipsAboveIt() {
    for (const to of ['physx', 'sapien', 'isaac']) {
      const {load_N, torque_Nm, numbers, correlation_m} = exported(to);
      expectHoldsAndSlips(to, numbers, load_N, torque_Nm, {correlation_m});
      if (!numbers.stiffness_N_per_m) continue;
      const {penetration_m} = friction_of(numbers, {load_N, correlation_m});
      const spring = penetration_m * numbers.stiffness_N_per_m / load_N;
      console.log(`${to}: the penetration is ${spring.toFixed(3)} of load over stiffness`);
      // PhysX's implicit spring, without damping, at this time step.
      expect(Math.abs(spring - 1) < 0.1, `the contact is as stiff as exported: ${spring}`);
    }
  },

  // Traps that the exports state.
  HasNoTorqueWithPgsNorWhereACompliantContactSinksIn() {
    const {load_N, torque_Nm, numbers, correlation_m} = exported('isaac');
    const rigid = {...numbers, stiffness_N_per_m: 0}, twist = {load_N, torque_Nm: 0.5 * torque_Nm};
    const felt = (of, scene) => friction_of(of, {...twist, ...scene}).torque_Nm / torque_Nm;
    expect(Math.abs(felt(rigid, {solver: 'ePGS'})) < tolerance, 'PGS has no torsional friction');
    const soft = {...numbers, stiffness_N_per_m: 2000};
    expect(Math.abs(felt(soft, {})) < tolerance, 'a contact that has moved by a millimetre has none by default');
    expect(Math.abs(felt(soft, {correlation_m}) - 0.5) < tolerance, 'with the exported correlation distance it has');
    const mean = friction_of({...rigid, combine: null, object_friction: 0.3}, {load_N, torque_Nm: 5 * torque_Nm}).torque_Nm / torque_Nm;
    expect(Math.abs(mean - (numbers.friction + 0.3) / 2 / numbers.friction) < tolerance, `friction is averaged: ${mean}`);
  },

  APadHoldsByABox() {
    const words = ['--pad-mm', '22,37.5', '--thickness-mm', '3', '--youngs-modulus-kPa', '800', '--poisson-ratio', '0.49',
      '--load', '20', '--friction', '0.9'];
    const torque_Nm = ask('predict', ...words).results[0].max_torque_Nm;
    for (const to of ['physx', 'sapien', 'isaac']) {
      const values = ask('export', ...words, '--to', to).box_values;
      const numbers = {friction: values.sliding_friction, object_friction: values.object_sliding_friction ?? 1,
        least_radius_m: 0, radius_m: 0, combine: to === 'sapien' ? null : 'eMIN',
        stiffness_N_per_m: values.compliant_contact_stiffness_N_per_m ?? 0};
      const box_m = [values.box_half_length_x_m, values.box_half_length_y_m, 1.5e-3];
      for (const share of [0.97, 1.03]) {
        const felt = friction_of(numbers, {load_N: 20, torque_Nm: share * torque_Nm, box_m}).torque_Nm / torque_Nm;
        console.log(`${to}: a box twisted by ${share} of the stated torque: friction ${felt.toFixed(5)} of it`);
        expect(Math.abs(felt - Math.min(share, 1)) < 0.02, `${to}'s box at ${share} feels ${felt}`);
      }
    }
  },
};

tests[test]();
process.exit(failures > 0 ? 1 : 0);
