// The holds in PhysX 5.
import {Watch} from './drift.mjs';
import {duration_s, eased, gravity_m_per_s2, gripRises_s, risen, weightRises_s} from './scenes.mjs';

/** The solver, and iterations over positions and velocities (4 and 1 are PhysX's defaults). */
export const settings = [
  {name: 'PGS', solver: 'ePGS', iterations: [4, 1]},
  {name: 'TGS', solver: 'eTGS', iterations: [4, 1]},
  {name: 'TGS, 32 iterations', solver: 'eTGS', iterations: [32, 1]},
];

export class Physx {
  constructor(PhysX) {
    this.PhysX = PhysX;
    this.version = [24, 16, 8].map(bits => PhysX.PHYSICS_VERSION >> bits & 255).join('.');
    const foundation = PhysX.CreateFoundation(PhysX.PHYSICS_VERSION, new PhysX.PxDefaultAllocator(), new PhysX.PxDefaultErrorCallback());
    this.scale = new PhysX.PxTolerancesScale();
    this.physics = PhysX.CreatePhysics(PhysX.PHYSICS_VERSION, foundation, this.scale);
  }

  made(scene, {shape, fixed, position_m, mass_kg, centre_m, inertia_kgm2, joint}, iterations) {
    const {PhysX, physics} = this, vector = v => new PhysX.PxVec3(...v);
    const at = p => new PhysX.PxTransform(vector(p), new PhysX.PxQuat(0, 0, 0, 1));
    const body = fixed ? physics.createRigidStatic(at(position_m)) : physics.createRigidDynamic(at(position_m));
    const material = physics.createMaterial(scene.friction, scene.friction, 0);
    const geometry = shape.half_m ? new PhysX.PxBoxGeometry(...shape.half_m) : new PhysX.PxCapsuleGeometry(shape.radius_m, shape.halfLength_m);
    const solid = physics.createShape(geometry, material, true, new PhysX.PxShapeFlags(PhysX.PxShapeFlagEnum.eSIMULATION_SHAPE));
    solid.setSimulationFilterData(new PhysX.PxFilterData(1, 1, 0, 0));
    solid.setContactOffset(1e-3);
    if (shape.centre_m) solid.setLocalPose(at(shape.centre_m));
    body.attachShape(solid);
    if (fixed) return body;
    body.setMass(mass_kg);
    body.setMassSpaceInertiaTensor(vector(inertia_kgm2));
    body.setCMassLocalPose(at(centre_m));
    body.setSleepThreshold(0);
    body.setAngularDamping(0);
    body.setSolverIterationCounts(...iterations);
    const locks = joint ? ['ANGULAR_X', 'ANGULAR_Y', 'ANGULAR_Z', ...['X', 'Y', 'Z'].filter((_, i) => joint.axis[i] === 0).map(axis => `LINEAR_${axis}`)] : [];
    for (const lock of locks) body.setRigidDynamicLockFlag(PhysX.PxRigidDynamicLockFlagEnum[`eLOCK_${lock}`], true);
    return body;
  }

  /** Steps a scene to its end. A claw stands still and the weight turns, since its pads are held by locks, not by joints. */
  run(description, {solver, iterations}) {
    const {PhysX, physics} = this;
    const turning = description.bodies.find(({joint}) => joint?.turn)?.joint;
    const scene = {...description, bodies: description.bodies.filter(({joint}) => !joint?.turn), relativeTo: null};
    const stage = new PhysX.PxSceneDesc(this.scale);
    stage.set_gravity(new PhysX.PxVec3(0, 0, 0));
    stage.set_cpuDispatcher(PhysX.DefaultCpuDispatcherCreate(0));
    stage.set_filterShader(PhysX.DefaultFilterShader());
    stage.set_solverType(PhysX.PxSolverTypeEnum[solver]);
    const world = physics.createScene(stage);
    const bodies = scene.bodies.map(body => this.made(scene, body, iterations));
    bodies.forEach(body => world.addActor(body));
    const poses = () => bodies.map(body => {
      const pose = body.getGlobalPose(), p = pose.get_p(), q = pose.get_q();
      return {p: [p.get_x(), p.get_y(), p.get_z()], q: [q.get_w(), q.get_x(), q.get_y(), q.get_z()]};
    });
    const watch = new Watch(scene), steps = Math.round(duration_s(scene) / scene.timeStep_s);
    watch.add(0, poses());
    for (let step = 1; step <= steps; ++step) {
      const time_s = (step - 1) * scene.timeStep_s, grip = risen(time_s, gripRises_s), angle = turning ? eased(turning.turn, time_s).angle : 0;
      scene.bodies.forEach(({name, fixed, mass_kg, joint, push_N = [0, 0, 0]}, i) => {
        if (fixed) return;
        const force = push_N.map((push, k) => grip * (push + (joint ? joint.axis[k] * joint.force_N : 0)));
        if (name === scene.tracked) {
          const weight_N = mass_kg * gravity_m_per_s2 * risen(time_s, weightRises_s);
          // About x, as the claw turns; in its frame the weight turns back.
          force[1] -= weight_N * Math.sin(angle);
          force[2] -= weight_N * Math.cos(angle);
        }
        bodies[i].addForce(new PhysX.PxVec3(...force));
      });
      world.simulate(scene.timeStep_s);
      world.fetchResults(true);
      if (watch.isDue(step)) watch.add(step, poses());
    }
    bodies.forEach(body => world.removeActor(body));
    world.release();
    return watch.results();
  }
}
