// The holds in `softfinger simulate`.
import {spawnSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {Watch} from './drift.mjs';
import {duration_s, gravity_m_per_s2, gripRises_s, layer, weightRises_s} from './scenes.mjs';

const list = (values, unit = 1) => `[${values.map(value => value * unit).join(', ')}]`;

function shapeText({half_m, centre_m = [0, 0, 0], radius_m, halfLength_m}) {
  if (half_m) return `{ box_size_mm = ${list(half_m, 2e3)}, position_mm = ${list(centre_m, 1e3)} }`;
  return `{ capsule_radius_length_mm = ${list([radius_m, 2 * halfLength_m], 1e3)}, rotation_deg = [0, 90, 0] }`;
}

function motorText(name, joint) {
  const {turn, force_N, stiffness, damping} = joint;
  const values = turn
    ? `stiffness_Nm_per_rad = ${stiffness}\ndamping_Nms_per_rad = ${damping}\ntime_s = ${list(turn.between_s)}\n` +
      `position_deg = ${list([0, turn.by_rad], 180 / Math.PI)}`
    : `damping_Ns_per_m = ${damping}\ntime_s = ${list(gripRises_s)}\neffort_N = ${list([0, force_N])}`;
  return `[[motor]]\njoint = "${name}"\n${values}\n`;
}

function bodyText(body) {
  let text = `[[body]]\nname = "${body.name}"\nposition_mm = ${list(body.position_m, 1e3)}\n`;
  if (body.shape) text += `shapes = [${shapeText(body.shape)}]\n`;
  text += body.fixed ? 'fixed = true\n' : `mass_g = ${1e3 * body.mass_kg}\ncenter_of_mass_mm = ${list(body.centre_m, 1e3)}\n` +
    `inertia_kg_mm2 = ${list(body.inertia_kgm2, 1e6)}\n`;
  return body.layer ? text + 'layer = "rubber"\n' : text;
}

function forceText(name, times_s, force_N) {
  return `[[force]]\nbody = "${name}"\ntime_s = ${list(times_s)}\nforce_N = [[0, 0, 0], ${list(force_N)}]\n`;
}

export function sceneText(scene) {
  const {bodies} = scene;
  const joints = bodies.filter(({joint}) => joint).map(({name, parent = 'world', position_m, joint}) =>
    `[[joint]]\nname = "${name}"\nkind = "${joint.kind === 'hinge' ? 'revolute' : 'prismatic'}"\nparent = "${parent}"\n` +
    `child = "${name}"\naxis = ${list(joint.axis)}\n` +
    `${joint.kind === 'hinge' ? `anchor_mm = ${list(position_m, 1e3)}\n` : ''}${motorText(name, joint)}`);
  const forces = bodies.flatMap(({name, mass_kg, push_N}) => [
    push_N ? forceText(name, gripRises_s, push_N) : '',
    name === scene.tracked ? forceText(name, weightRises_s, [0, 0, -mass_kg * gravity_m_per_s2]) : '']);
  const rubber = bodies.some(body => body.layer) ? `[[layer]]\nname = "rubber"\nthickness_mm = ${1e3 * layer.thickness_m}\n` +
    `youngs_modulus_kPa = ${1e-3 * layer.youngs_modulus_Pa}\npoisson_ratio = ${layer.poisson_ratio}\n` : '';
  return `id = "${scene.name}"
[simulation]
time_step_ms = ${1e3 * scene.timeStep_s}
duration_s = ${duration_s(scene)}
gravity_m_per_s2 = [0, 0, 0]
${rubber}${bodies.map(bodyText).join('')}${joints.join('')}${forces.join('')}[[contact]]
bodies = ["*", "*"]
friction_coefficient = ${scene.friction}
`;
}

export const settings = [{name: 'defaults'}, {name: 'defaults, step of 0.5 ms', timeStep_s: 5e-4}];

/** Simulates a scene with the program. */
export function run(softfinger, description, setting) {
  const scene = {...description, timeStep_s: setting.timeStep_s ?? description.timeStep_s};
  const folder = mkdtempSync(join(tmpdir(), 'softfinger-creep-'));
  try {
    const file = join(folder, 'scene.toml'), output = join(folder, 'motion');
    writeFileSync(file, sceneText(scene));
    const done = spawnSync(softfinger, ['simulate', file, '--output', output, '--json'], {encoding: 'utf8', maxBuffer: 1e8});
    if (done.status !== 0) throw new Error(`softfinger simulate ends with ${done.status} on ${scene.name}:\n${done.stderr}`);
    const [heading, ...rows] = readFileSync(join(output, 'trajectory.csv'), 'utf8').trim().split('\n').map(line => line.split(','));
    const column = name => heading.indexOf(name);
    const p = ['x', 'y', 'z'].map(axis => column(`position_${axis}_m`)), q = ['w', 'x', 'y', 'z'].map(axis => column(`quaternion_${axis}`));
    const watch = new Watch(scene), count = scene.bodies.length;
    for (let step = 0; step * count < rows.length; ++step) {
      if (!watch.isDue(step)) continue;
      const frame = rows.slice(step * count, (step + 1) * count);
      watch.add(step, scene.bodies.map(({name}) => {
        const row = frame.find(cells => cells[column('body')] === name);
        return {p: p.map(i => Number(row[i])), q: q.map(i => Number(row[i]))};
      }));
    }
    return watch.results();
  } finally {
    rmSync(folder, {recursive: true});
  }
}
