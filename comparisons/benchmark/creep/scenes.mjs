// Three holds as engine-neutral descriptions: SI units, world axes, z up, all bodies unturned at the start.
//
// A body has one shape or none, a frame at `position_m`, its centre of mass at `centre_m` of that frame, and principal
// moments about it. Joints connect it to `parent` (or the world); a body without one is free unless `fixed`.
// There is no gravity. First the grip rises, `force_N` along a slide or `push_N` on a centre of mass, then the weight of
// the tracked body. A hinge follows `turn` by a spring and a damper. `layer` marks a soft pad. `presser` is the body whose
// way along the grip tells how far a contact gives way. The drift is measured over each of `watches_s`.

export const gravity_m_per_s2 = 9.81;
export const gripRises_s = [0, 0.2], weightRises_s = [0.3, 0.4];

/** From 0 to 1 along a straight line. */
export const risen = (time_s, [from_s, to_s]) => Math.min(1, Math.max(0, (time_s - from_s) / (to_s - from_s)));

/** Angle and rate of a turn from rest to rest, eased as the motors of `softfinger simulate` are. */
export function eased({by_rad, between_s}, time_s) {
  const x = risen(time_s, between_s), span_s = between_s[1] - between_s[0];
  return {angle: by_rad * x ** 3 * (10 + x * (6 * x - 15)), rate: by_rad / span_s * 30 * x ** 2 * (1 - x) ** 2};
}

/** The rubber of soft pads. An engine without a law for it takes the friction coefficient alone. */
export const layer = {thickness_m: 2e-3, youngs_modulus_Pa: 300e3, poisson_ratio: 0.49};

const common = {timeStep_s: 2e-3, friction: 0.8};

function boxInertia(mass, [a, b, c]) {  // half sizes
  return [b * b + c * c, a * a + c * c, a * a + b * b].map(sum => mass * sum / 3);
}

/** Principal moments of a solid capsule along x. */
function capsuleInertia(mass, radius, half) {
  const cylinder = 2 * half / (2 * half + 4 * radius / 3) * mass, ball = mass - cylinder;
  const along = radius ** 2 * (cylinder / 2 + 0.4 * ball);
  const across = cylinder * (radius ** 2 / 4 + half ** 2 / 3) + ball * (0.4 * radius ** 2 + half ** 2 + 0.75 * half * radius);
  return [along, across, across];
}

/** A capsule of 45 g lies level between two flat pads; its centre of mass is 8 mm beside them. */
export function capsule(grip_N) {
  const radius = 0.01, half = 0.03, mass = 0.045, pad_m = [0.01, 0.01, 0.015], pad_kg = 0.1;
  const pad = (name, side) => ({
    name, position_m: [0, side * (radius + pad_m[1]), 0], shape: {half_m: pad_m}, mass_kg: pad_kg, centre_m: [0, 0, 0],
    inertia_kgm2: boxInertia(pad_kg, pad_m),
    joint: {kind: 'slide', axis: [0, -side, 0], force_N: grip_N, damping: 5},
  });
  return {
    ...common, name: 'capsule', load_N: grip_N, tracked: 'capsule', presser: 'right', watches_s: [[1, 4]],
    bodies: [
      {name: 'capsule', position_m: [0, 0, 0], shape: {radius_m: radius, halfLength_m: half}, mass_kg: mass,
        centre_m: [0.008, 0, 0], inertia_kgm2: capsuleInertia(mass, radius, half)},
      pad('left', -1), pad('right', 1)],
  };
}

/**
 * Two soft flat pads hold a bar of 100 g, 20 mm beside its centre of mass. The claw turns by half a turn within 3 s,
 * about the level line through its pads.
 */
export function claw(grip_N) {
  const bar_m = [0.005, 0.01, 0.1], pad_m = [0.01, 0.01, 0.01], mass = 0.1, pad_kg = 0.1;
  const pad = (name, side) => ({
    name, position_m: [side * (bar_m[0] + pad_m[0]), 0, 0], shape: {half_m: pad_m}, mass_kg: pad_kg, centre_m: [0, 0, 0],
    inertia_kgm2: boxInertia(pad_kg, pad_m), layer: true, parent: 'claw',
    joint: {kind: 'slide', axis: [-side, 0, 0], force_N: grip_N, damping: 5},
  });
  return {
    ...common, name: 'claw', load_N: grip_N, tracked: 'bar', relativeTo: 'claw', presser: 'right',
    watches_s: [[1, 4], [4, 6]],
    bodies: [
      {name: 'bar', position_m: [0, 0, 0], shape: {half_m: bar_m, centre_m: [0, 0, -0.02]}, mass_kg: mass, centre_m: [0, 0, -0.02],
        inertia_kgm2: boxInertia(mass, bar_m)},
      {name: 'claw', position_m: [0, 0, 0], mass_kg: 0.5, centre_m: [0, 0, 0], inertia_kgm2: [0.01, 0.01, 0.01],
        joint: {kind: 'hinge', axis: [1, 0, 0], turn: {by_rad: Math.PI, between_s: [1, 4]}, stiffness: 50, damping: 2}},
      pad('left', -1), pad('right', 1)],
  };
}

/** A cube of 100 g and 40 mm is pressed on an upright wall by a level force on its centre. */
export function wall(push_N) {
  const half = 0.02, mass = 0.1;
  return {
    ...common, name: 'wall', load_N: push_N, tracked: 'cube', presser: 'cube', watches_s: [[1, 4]],
    bodies: [
      {name: 'wall', fixed: true, position_m: [0.05, 0, 0], shape: {half_m: [0.05, 0.2, 0.2]}},
      {name: 'cube', position_m: [-half, 0, 0], shape: {half_m: [half, half, half]}, mass_kg: mass, centre_m: [0, 0, 0],
        inertia_kgm2: boxInertia(mass, [half, half, half]), push_N: [push_N, 0, 0]}],
  };
}

export const duration_s = scene => scene.watches_s.at(-1)[1];
export const allScenes = () => [...[12, 24, 36, 60].map(capsule), claw(20), wall(10)];
