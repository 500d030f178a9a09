// The holds in MuJoCo 3.
import {Watch} from './drift.mjs';
import {duration_s, eased, gravity_m_per_s2, gripRises_s, risen, weightRises_s} from './scenes.mjs';

/** The stiffest contact that is stable at steps of 2 ms, and an impedance close to 1. */
const stiff = 'solref="0.004 1" solimp="0.99 0.999 0.001"';

/** Attributes of <option> and of all geoms that are set beside MuJoCo's defaults, or another time step. */
export const settings = [
  {name: 'defaults'},
  {name: 'defaults, step of 0.5 ms', timeStep_s: 5e-4},
  {name: 'impratio 10', option: 'impratio="10"'},
  {name: 'noslip 5', option: 'noslip_iterations="5"'},
  {name: 'elliptic', option: 'cone="elliptic"'},
  {name: 'elliptic, impratio 10', option: 'cone="elliptic" impratio="10"'},
  {name: 'elliptic, impratio 100', option: 'cone="elliptic" impratio="100"'},
  {name: 'elliptic, impratio 10, noslip 5', option: 'cone="elliptic" impratio="10" noslip_iterations="5"'},
  {name: 'elliptic, stiff', option: 'cone="elliptic"', geom: stiff},
  {name: 'elliptic, impratio 10, noslip 5, stiff', option: 'cone="elliptic" impratio="10" noslip_iterations="5"', geom: stiff},
  {name: 'elliptic, impratio 100, stiff', option: 'cone="elliptic" impratio="100"', geom: stiff},
  {name: 'elliptic, impratio 10, noslip 50 to 1e-12, stiff',
    option: 'cone="elliptic" impratio="10" noslip_iterations="50" noslip_tolerance="1e-12"', geom: stiff},
];

const numbers = values => values.join(' ');

function geomText({shape}) {
  if (!shape) return '';
  if (shape.half_m) return `<geom type="box" pos="${numbers(shape.centre_m ?? [0, 0, 0])}" size="${numbers(shape.half_m)}"/>`;
  return `<geom type="capsule" fromto="${-shape.halfLength_m} 0 0 ${shape.halfLength_m} 0 0" size="${shape.radius_m}"/>`;
}

function bodyText(scene, body) {
  const {joint} = body;
  const freedom = body.fixed ? '' : joint
    ? `<joint name="${body.name}" type="${joint.kind}" axis="${numbers(joint.axis)}"${joint.kind === 'slide' ? ` damping="${joint.damping}"` : ''}/>`
    : '<freejoint/>';
  const inertia = body.fixed ? '' :
    `<inertial pos="${numbers(body.centre_m)}" mass="${body.mass_kg}" diaginertia="${numbers(body.inertia_kgm2)}"/>`;
  const children = scene.bodies.filter(({parent}) => parent === body.name).map(child => bodyText(scene, child)).join('');
  return `<body name="${body.name}" pos="${numbers(body.position_m)}">${freedom}${inertia}${geomText(body)}${children}</body>\n`;
}

export function modelText(scene, {option = '', geom = ''}) {
  return `<mujoco><option timestep="${scene.timeStep_s}" gravity="0 0 0" ${option}/>
<default><geom friction="${scene.friction}" ${geom}/></default>
<worldbody>
${scene.bodies.filter(({parent}) => !parent).map(body => bodyText(scene, body)).join('')}</worldbody></mujoco>
`;
}

/** Steps a scene to its end; `atEnd` may look at the model and its data. */
export function run(mujoco, description, setting, atEnd = () => {}) {
  const scene = {...description, timeStep_s: setting.timeStep_s ?? description.timeStep_s};
  const model = mujoco.MjModel.from_xml_string(modelText(scene, setting)), data = new mujoco.MjData(model);
  const named = (type, name) => mujoco.mj_name2id(model, type.value ?? type, name);
  const bodyAt = name => named(mujoco.mjtObj.mjOBJ_BODY, name);
  const at = scene.bodies.map(({name}) => bodyAt(name));
  const joints = scene.bodies.filter(({joint}) => joint).map(({name, joint}) => {
    const id = named(mujoco.mjtObj.mjOBJ_JOINT, name);
    return {...joint, q: model.jnt_qposadr[id], v: model.jnt_dofadr[id]};
  });
  const poses = () => scene.bodies.map((_, i) =>
    ({p: [...data.xpos.slice(3 * at[i], 3 * at[i] + 3)], q: [...data.xquat.slice(4 * at[i], 4 * at[i] + 4)]}));
  const watch = new Watch(scene);
  mujoco.mj_forward(model, data);
  watch.add(0, poses());
  const steps = Math.round(duration_s(scene) / scene.timeStep_s);
  for (let step = 1; step <= steps; ++step) {
    const grip = risen(data.time, gripRises_s), weight = risen(data.time, weightRises_s) * gravity_m_per_s2;
    scene.bodies.forEach(({name, mass_kg, push_N = [0, 0, 0]}, i) => {
      for (let k = 0; k < 3; ++k) data.xfrc_applied[6 * at[i] + k] = grip * push_N[k];
      if (name === scene.tracked) data.xfrc_applied[6 * at[i] + 2] -= weight * mass_kg;
    });
    for (const {kind, q, v, force_N, turn, stiffness, damping} of joints) {
      const {angle, rate} = turn ? eased(turn, data.time) : {};
      data.qfrc_applied[v] = kind === 'slide' ? grip * force_N : stiffness * (angle - data.qpos[q]) + damping * (rate - data.qvel[v]);
    }
    mujoco.mj_step(model, data);
    if (watch.isDue(step)) {
      mujoco.mj_kinematics(model, data);
      watch.add(step, poses());
    }
  }
  atEnd(model, data);
  data.delete();
  model.delete();
  return watch.results();
}
