// node robots_test.mjs SOFTFINGER_ROBOT NPM FOLDER FILE.xml...
// Compares the scenes that softfinger-robot makes of files in MJCF with what MuJoCo 3 makes of them: mass, centre of
// mass, inertia and pose of each body, place and axis, rotor, friction and range of each joint, and the geoms that may
// touch. FOLDER keeps the package from npm.
import {spawnSync} from 'node:child_process';
import {mkdtempSync, readFileSync, readdirSync, rmSync, statSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {basename, dirname, join, relative, resolve} from 'node:path';
import {loadMujoco} from '../../../comparisons/benchmark/mujoco3/load_mujoco.mjs';

const [program, npm, folder, ...files] = process.argv.slice(2);

// The scene's file has the shortest digits that give the same number; angles in degrees, millimetres and the pose of
// a body times that of a shape add a few roundings. Meshes have single precision. MuJoCo 2.2, which reads the geoms that an
// inertia follows from, turns its principal axes until what is beside the diagonal is below the root of a rounding.
const doubles = 1e-9, singles = 2e-6, axesOf2 = 1e-7;

let failures = 0, largest = 0;
function near(is, expected, scale, tolerance, what) {
  const off = Math.max(...expected.map((value, i) => Math.abs(is[i] - value))) / scale;
  if (tolerance !== singles) largest = Math.max(largest, off);
  if (is.length === expected.length && off <= tolerance) return;
  ++failures;
  console.log(`FAILED: ${what}: [${is}], MuJoCo 3 has [${expected}]`);
}
function expect(isTrue, message) {
  if (isTrue) return;
  ++failures;
  console.log(`FAILED: ${message}`);
}

/** The library's binding does not show jnt_limited. A range that a file switches off would be taken for a limit. */
const isLimited = (model, j) => model.jnt_range[2 * j] < model.jnt_range[2 * j + 1];

/** The tables of a scene as softfinger-robot writes it: one key per line, shapes one per line. */
function tablesOf(text) {
  const tables = [];
  let table = {}, shapes = null;
  const value = typed => {
    if (typed === 'true' || typed === 'false') return typed === 'true';
    return JSON.parse(typed.replace(/-inf/g, '-1e999').replace(/inf/g, '1e999'));
  };
  for (const line of text.split('\n')) {
    const head = line.match(/^\[\[?(\w+)\]\]?$/), pair = line.match(/^(\w+) = (.*)$/);
    if (shapes && line === ']') shapes = null;
    else if (shapes) {
      const shape = {};
      for (const [, key, typed] of line.matchAll(/(\w+) = ("(?:[^"\\]|\\.)*"|\[[^\]]*\]|[^,}\s]+)/g)) shape[key] = value(typed);
      shapes.push(shape);
    } else if (head) tables.push(table = {table: head[1]});
    else if (pair && pair[2] === '[') table[pair[1]] = shapes = [];
    else if (pair) table[pair[1]] = value(pair[2]);
  }
  return tables;
}

// Vectors and matrices, row by row.
const times = (m, v) => [0, 1, 2].map(i => m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2]);
const product = (a, b) => [0, 1, 2].flatMap(i => [0, 1, 2].map(j => a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j]));
const transposed = m => [0, 1, 2].flatMap(i => [0, 1, 2].map(j => m[3 * j + i]));
const add = (a, b) => a.map((value, i) => value + b[i]);
const scaled = (v, factor) => v.map(value => value * factor);
function turned(degrees = [0, 0, 0]) {
  const [x, y, z] = degrees.map(angle => angle * Math.PI / 180), c = Math.cos, s = Math.sin;
  const about_x = [1, 0, 0, 0, c(x), -s(x), 0, s(x), c(x)], about_y = [c(y), 0, s(y), 0, 1, 0, -s(y), 0, c(y)];
  return product(product([c(z), -s(z), 0, s(z), c(z), 0, 0, 0, 1], about_y), about_x);
}
function quaternion([w, x, y, z]) {
  return [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z),
    2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
}
const placeOf = table => ({at: scaled(table.position_mm ?? [0, 0, 0], 1e-3), turn: turned(table.rotation_deg)});
const within = (outer, inner) => ({at: add(outer.at, times(outer.turn, inner.at)), turn: product(outer.turn, inner.turn)});

/** The file and all that lie beside it or below, in the simulator's own file system. */
function load(mujoco, file) {
  const root = dirname(resolve(file));
  const known = /\.(xml|mjcf|stl|obj|msh|png)$/i;
  const copy = path => {
    for (const name of readdirSync(path)) {
      const own = join(path, name);
      if (statSync(own).isDirectory()) copy(own);
      else if (known.test(name)) {
        const there = '/robot/' + relative(root, own);
        mujoco.FS.mkdirTree(dirname(there));
        mujoco.FS.writeFile(there, readFileSync(own));
      }
    }
  };
  copy(root);
  return mujoco.MjModel.from_xml_path('/robot/' + basename(file));
}

/** Of a mesh in the world: its corner points. */
function corners(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const point of points)
    for (let i = 0; i < 3; ++i) {
      low[i] = Math.min(low[i], point[i]);
      high[i] = Math.max(high[i], point[i]);
    }
  return [...low, ...high];
}
function stlPoints(path) {
  const bytes = readFileSync(path), count = bytes.readUInt32LE(80), points = [];
  for (let t = 0; t < count; ++t)
    for (let k = 1; k < 4; ++k) points.push([0, 1, 2].map(i => bytes.readFloatLE(84 + 50 * t + 12 * k + 4 * i)));
  return points;
}

function compare(mujoco, file) {
  const before = failures, meshes = mkdtempSync(join(tmpdir(), 'softfinger-robot-'));
  const run = spawnSync(program, [file, meshes, 'robot'], {encoding: 'utf8', maxBuffer: 1e9});
  if (run.status !== 0) {
    console.log(`FAILED: ${file}: ${run.stderr.trim().split('\n').pop()}`);
    ++failures;
    return;
  }
  const tables = tablesOf(run.stdout), all = name => tables.filter(table => table.table === name);
  const model = load(mujoco, file), data = new mujoco.MjData(model);
  if (model.nkey > 0) mujoco.mj_resetDataKeyframe(model, data, 0);
  for (let j = 0; j < model.njnt; ++j) {
    const type = model.jnt_type[j], q = model.jnt_qposadr[j];
    if (isLimited(model, j) && type >= 2)
      data.qpos[q] = Math.min(Math.max(data.qpos[q], model.jnt_range[2 * j]), model.jnt_range[2 * j + 1]);
  }
  mujoco.mj_kinematics(model, data);
  // Of what has no name the binding gives letters that are not one.
  const name = (kind, index) => {
    const text = mujoco.mj_id2name(model, kind, index) ?? '';
    return mujoco.mj_name2id(model, kind, text) === index ? text : '';
  };
  const {mjtObj} = mujoco, kinds = {body: mjtObj.mjOBJ_BODY.value, joint: mjtObj.mjOBJ_JOINT.value};
  const part = (array, i, n) => Array.from(array.slice(n * i, n * i + n));
  const bodies = new Map(all('body').map(table => [table.name, table]));
  // A body whose geoms touch others differently is several, fixed to the first.
  const parts = own => [...bodies.values()].filter(table => table.name === own || table.name.startsWith(own + '_geoms_'));
  let compared = 0, geoms = 0;
  for (let b = 1; b < model.nbody; ++b) {
    const own = name(kinds.body, b) || `body_${b}`, table = bodies.get(own);
    if (!table) {
      expect(false, `${file}: there is no body "${own}"`);
      continue;
    }
    ++compared;
    const size = Math.max(1e-3, ...part(data.xpos, b, 3).map(Math.abs)), place = placeOf(table);
    near(place.at, part(data.xpos, b, 3), size, doubles, `${file}: place of "${own}"`);
    near(place.turn, part(data.xmat, b, 9), 1, doubles, `${file}: orientation of "${own}"`);
    if (table.fixed || table.massless) continue;
    // Where masses follow from meshes, they have their precision.
    const geomsOf = Array.from({length: model.body_geomnum[b]}, (_, i) => model.body_geomadr[b] + i);
    const digits = geomsOf.some(g => model.geom_dataid[g] >= 0) ? singles : doubles;
    const mass = parts(own).reduce((sum, one) => sum + 1e-3 * one.mass_g, 0);
    near([mass], [model.body_mass[b]], model.body_mass[b], digits, `${file}: mass of "${own}"`);
    const centre = part(model.body_ipos, b, 3);
    near(scaled(table.center_of_mass_mm, 1e-3), centre, Math.max(1e-3, ...centre.map(Math.abs)), digits,
      `${file}: centre of mass of "${own}"`);
    const axes = quaternion(part(model.body_iquat, b, 4)), moments = part(model.body_inertia, b, 3);
    const inertia = product(product(axes, [moments[0], 0, 0, 0, moments[1], 0, 0, 0, moments[2]]), transposed(axes));
    const sum = [0, 0, 0, 0, 0, 0];
    for (const one of parts(own)) one.inertia_kg_mm2.forEach((value, i) => sum[i] += 1e-6 * value);
    near(sum, [inertia[0], inertia[4], inertia[8], inertia[1], inertia[2], inertia[5]], Math.max(...moments), Math.max(digits, axesOf2),
      `${file}: inertia of "${own}"`);
  }
  const joints = new Map(all('joint').map(table => [table.name, table]));
  for (let j = 0; j < model.njnt; ++j) {
    const type = model.jnt_type[j];
    if (type === 0) continue;
    const own = name(kinds.joint, j) || `joint_${j}`, table = joints.get(own), what = `${file}: joint "${own}"`;
    if (!table) {
      expect(false, `there is no ${what}`);
      continue;
    }
    const anchor = part(data.xanchor, j, 3);
    if (table.anchor_mm)
      near(scaled(table.anchor_mm, 1e-3), anchor, Math.max(1e-3, ...anchor.map(Math.abs)), doubles, `${what}, anchor`);
    if (type === 1) continue;
    near(table.axis, part(data.xaxis, j, 3), 1, doubles, `${what}, axis`);
    const dof = model.jnt_dofadr[j], turns = type === 3, unit = turns ? Math.PI / 180 : 1e-3;
    const rotor = turns ? 1e-6 * (table.rotor_inertia_kg_mm2 ?? 0) : 1e-3 * (table.rotor_mass_g ?? 0);
    near([rotor], [model.dof_armature[dof]], 1, doubles, `${what}, armature`);
    near([table.dry_friction_Nm ?? table.dry_friction_N ?? 0], [model.dof_frictionloss[dof]], 1, doubles, `${what}, friction`);
    const range = (turns ? table.limits_deg : table.limits_mm) ?? [-Infinity, Infinity];
    const expected = isLimited(model, j) ? part(model.jnt_range, j, 2) : [-Infinity, Infinity];
    if (Number.isFinite(expected[0])) near(scaled(range, unit), expected, 1, doubles, `${what}, range`);
    else expect(!Number.isFinite(range[0]), `${what} has no limits in MuJoCo 3`);
  }
  // Motors: position and velocity actuators of a joint, and its own spring and damping. Newer versions make a damping of a
  // ratio of it.
  const motors = new Map(all('motor').map(table => [table.joint, table]));
  for (let j = 0; j < model.njnt; ++j) {
    if (model.jnt_type[j] < 2) continue;
    const own = name(kinds.joint, j) || `joint_${j}`, dof = model.jnt_dofadr[j], motor = motors.get(own) ?? {};
    let stiffness = model.jnt_stiffness[j], damping = model.dof_damping[dof], isKnown = true;
    for (let a = 0; a < model.nu; ++a) {
      const [, position, speed] = part(model.actuator_biasprm, a, 10), gear = model.actuator_gear[6 * a];
      if (model.actuator_trntype[a] !== 0 || model.actuator_trnid[2 * a] !== j) continue;
      isKnown = isKnown && model.actuator_dyntype[a] === 0 && model.actuator_gaintype[a] === 0 && model.actuator_biastype[a] < 2;
      stiffness += Math.max(0, -position) * gear * gear;
      damping += Math.max(0, -speed) * gear * gear;
    }
    if (!isKnown) continue;
    const what = `${file}: motor of "${own}"`;
    near([motor.stiffness_Nm_per_rad ?? motor.stiffness_N_per_m ?? 0], [stiffness], Math.max(1, stiffness), doubles, `${what}, stiffness`);
    near([motor.damping_Nms_per_rad ?? motor.damping_Ns_per_m ?? 0], [damping], Math.max(1, damping), axesOf2, `${what}, damping`);
  }
  // Geoms that may touch, in the order of the file within a body; groups that touch differently change the order.
  for (let b = 0; b < model.nbody; ++b) {
    const own = b === 0 ? 'ground' : name(kinds.body, b) || `body_${b}`;
    const shapes = parts(own).flatMap(table => (table.shapes ?? []).map(shape => ({shape, ...within(placeOf(table), placeOf(shape))})));
    const expected = [];
    for (let g = model.body_geomadr[b]; g < model.body_geomadr[b] + model.body_geomnum[b]; ++g)
      if (model.geom_contype[g] || model.geom_conaffinity[g]) expected.push(g);
    if (expected.length === 0 && shapes.length === 0) continue;
    expect(shapes.length >= expected.length, `${file}: "${own}" has ${shapes.length} of ${expected.length} geoms`);
    if (parts(own).length > 1 || shapes.length !== expected.length) continue;
    expected.forEach((g, i) => {
      const {shape, at, turn} = shapes[i], what = `${file}: geom ${g} of "${own}"`;
      ++geoms;
      if (shape.mesh) {
        const mesh = model.geom_dataid[g], first = model.mesh_vertadr[mesh], count = model.mesh_vertnum[mesh];
        const place = part(data.geom_xpos, g, 3), axes = part(data.geom_xmat, g, 9), points = [];
        for (let v = first; v < first + count; ++v) points.push(add(place, times(axes, part(model.mesh_vert, v, 3))));
        const ours = stlPoints(join(meshes, shape.mesh)).map(point => add(at, times(turn, point)));
        const box = corners(points);
        near(corners(ours), box, Math.max(...box.map(Math.abs)), singles, `${what}, the mesh's box`);
      } else {
        const size = Math.max(1e-3, ...part(data.geom_xpos, g, 3).map(Math.abs));
        near(at, part(data.geom_xpos, g, 3), size, doubles, `${what}, place`);
        // How capsules and cylinders are turned about their axes is not seen.
        const seen = 'capsule_radius_length_mm' in shape || 'cylinder_radius_length_mm' in shape ? [2, 5, 8] : [0, 1, 2, 3, 4, 5, 6, 7, 8];
        const axes = part(data.geom_xmat, g, 9);
        near(seen.map(k => turn[k]), seen.map(k => axes[k]), 1, doubles, `${what}, orientation`);
      }
    });
  }
  data.delete();
  model.delete();
  rmSync(meshes, {recursive: true});
  console.log(`${failures === before ? 'same' : 'different'}: ${file}: ${compared} bodies, ${joints.size} joints, ${geoms} geoms`);
}

const mujoco = await loadMujoco(npm, folder);
for (const file of files) {
  try {
    compare(mujoco, file);
  } catch (error) {
    ++failures;
    console.log(`FAILED: ${file}: ${error?.message ?? error}`);
  }
}
console.log(`largest difference of numbers in double precision: ${largest.toExponential(1)}`);
process.exit(failures > 0 ? 1 : 0);
