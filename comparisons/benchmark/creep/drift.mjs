// The drift of a held body: how fast it moves and turns in the frame that holds it, relative to the middle of its pads.
//
// A pose is {p: [x, y, z], q: [w, x, y, z]}.

import {weightRises_s} from './scenes.mjs';

const conjugate = ([w, x, y, z]) => [w, -x, -y, -z];
const product = ([a, b, c, d], [w, x, y, z]) =>
  [a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w];
const rotated = (q, v) => product(product(q, [0, ...v]), conjugate(q)).slice(1);
const minus = (a, b) => a.map((x, i) => x - b[i]);

/** The pose of a body in the frame of another one. */
const relative = (frame, body) =>
  ({p: rotated(conjugate(frame.q), minus(body.p, frame.p)), q: product(conjugate(frame.q), body.q)});

const moved_m = (a, b) => Math.hypot(...minus(a.p, b.p));
function turned_rad(a, b) {
  const [w, ...v] = product(conjugate(a.q), b.q);
  return 2 * Math.atan2(Math.hypot(...v), Math.abs(w));
}

/** So far from its start a body's contacts have changed, and its drift is not the one of the hold. */
const isFar = (start, pose) => moved_m(start, pose) > 5e-3 || turned_rad(start, pose) > 0.5;

/** A body that is farther than this from its start in the end has been dropped. */
const dropped_m = 0.05;

/**
 * Mean speeds along the path within a watch, until its end or until the body is too far from where it started.
 *
 * samples: [{time_s, pose}], evenly spaced, from the start on; the spacing is that of the path
 */
function driftWithin(samples, [from_s, to_s]) {
  const start = samples[0].pose;
  const far = samples.findIndex(({pose}) => isFar(start, pose));
  const index = time_s => samples.findIndex(sample => sample.time_s > time_s - 1e-9);
  const begin = index(from_s), end = far < 0 ? index(to_s) : Math.min(far, index(to_s));
  if (end <= begin) return {um_per_s: null, mrad_per_s: null, watched_s: 0};
  let path_m = 0, path_rad = 0;
  for (let i = begin; i < end; ++i) {
    path_m += moved_m(samples[i].pose, samples[i + 1].pose);
    path_rad += turned_rad(samples[i].pose, samples[i + 1].pose);
  }
  const watched_s = samples[end].time_s - samples[begin].time_s;
  return {um_per_s: 1e6 * path_m / watched_s, mrad_per_s: 1e3 * path_rad / watched_s, watched_s};
}

/** Collects poses of a scene's bodies, {p, q} each in the order of the scene, and tells the drift of the tracked one. */
export class Watch {
  constructor(scene) {
    this.scene = scene;
    this.samples = [];
    const index = name => scene.bodies.findIndex(body => body.name === name);
    this.tracked = index(scene.tracked);
    this.frame = scene.relativeTo ? index(scene.relativeTo) : -1;
    this.presser = index(scene.presser);
    this.every = Math.round(0.1 / scene.timeStep_s);
  }

  isDue(step) { return step % this.every === 0; }

  add(step, poses) {
    const held = index => this.frame < 0 ? poses[index] : relative(poses[this.frame], poses[index]), pose = held(this.tracked);
    // Pads that press with forces may float along their line together, and what they hold with them.
    const {bodies, timeStep_s} = this.scene, pads = bodies.flatMap(({joint}, i) => joint?.kind === 'slide' ? [i] : []);
    for (const pad of pads) pose.p = minus(pose.p, minus(held(pad).p, bodies[pad].position_m).map(x => x / pads.length));
    this.samples.push({time_s: step * timeStep_s, pose});
    // Before the weight acts, the way of what presses is what the contact gives way by.
    if (this.samples.at(-1).time_s < weightRises_s[0] + 1e-9) {
      const {position_m, joint, push_N} = bodies[this.presser];
      const along = joint ? joint.axis : push_N.map(x => x / Math.hypot(...push_N));
      this.sunk_m = minus(poses[this.presser].p, position_m).reduce((sum, x, i) => sum + x * along[i], 0);
    }
  }

  /** One result for each of the scene's watches. */
  results() {
    const {samples, scene, sunk_m} = this;
    const start = samples[0].pose, far = samples.find(({pose}) => isFar(start, pose));
    const isLost = far && (far.time_s <= scene.watches_s[0][0] || moved_m(start, samples.at(-1).pose) > dropped_m);
    return scene.watches_s.map(watch_s => ({
      watch_s, ...driftWithin(samples, watch_s), sunk_mm: 1e3 * sunk_m, lost_at_s: isLost ? far.time_s : null,
    }));
  }
}
