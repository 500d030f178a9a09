// The page of docs/measurements: what was measured, and what to set.
import {residualVelocity_m_per_s} from './residual_velocity.mjs';
import {gravity_m_per_s2, wall} from './scenes.mjs';

const shown = value => value === 0 ? '0' : value < 1e-3 ? value.toExponential(0) : value < 10 ? String(Number(value.toPrecision(2))) : value.toFixed(0);
const range = values => [Math.min(...values), Math.max(...values)].map(shown).join(' to ');

/** The columns of the table: a scene at a load, in a watch. */
const columns = [
  ...[12, 24, 36, 60].map(load_N => ({head: `capsule, ${load_N} N`, scene: 'capsule', load_N, from_s: 1})),
  {head: 'bar, claw turns', scene: 'claw', load_N: 20, from_s: 1}, {head: 'bar, claw has turned', scene: 'claw', load_N: 20, from_s: 4},
  {head: 'cube on a wall', scene: 'wall', load_N: 10, from_s: 1}];

const at = (rows, engine, setting, column) => rows.find(row => row.engine === engine && row.setting === setting &&
  ['scene', 'load_N', 'from_s'].every(key => row[key] === column[key]));

function cell(row) {
  if (row.lost_at_s !== null) return `lost at ${shown(row.lost_at_s)} s`;
  return row.um_per_s !== null ? `${shown(row.um_per_s)}; ${shown(row.mrad_per_s)}` : 'lost before';
}

export function pageText(rows) {
  const engines = [...new Set(rows.map(({engine}) => engine))], [mujoco, ours, physx, bullet] = engines;
  const of = (engine, setting) => columns.map(column => at(rows, engine, setting, column));
  const held = (engine, setting) => of(engine, setting).filter(row => row.lost_at_s === null && row.watched_s > 0).map(row => row.um_per_s);
  const told = 'elliptic, impratio 100, stiff', exact = 'elliptic, impratio 10, noslip 50 to 1e-12, stiff';
  const capsuleAt = (setting, load_N) => rows.find(row => row.setting === setting && row.scene === 'capsule' && row.load_N === load_N);
  const [, , , , turning, , ] = of(ours, 'defaults'), still = of(ours, 'defaults').filter(row => row !== turning);
  const lostAt_N = of(mujoco, 'defaults').filter(row => row.scene === 'capsule' && row.lost_at_s !== null).map(row => row.load_N);
  const byFormula = (setting, words) => {
    const {um_per_s, sunk_mm} = at(rows, mujoco, setting, columns.at(-1)), cube = wall(10).bodies[1];
    const formula = 1e6 * residualVelocity_m_per_s({force_N: cube.mass_kg * gravity_m_per_s2 / 4, inverseMass_per_kg: 1 / cube.mass_kg,
      penetration_m: 1e-3 * sunk_mm, ...words});
    return `| ${setting} | ${formula.toPrecision(4)} | ${um_per_s.toPrecision(4)} |`;
  };
  const table = engines.flatMap(engine => [...new Set(rows.filter(row => row.engine === engine).map(({setting}) => setting))]
    .map(setting => `| ${engine}, ${setting} | ${of(engine, setting).map(cell).join(' | ')} |`));
  return `# How much does a held thing creep?

At its defaults ${mujoco} lets what it holds slide by ${range(held(mujoco, 'defaults'))} µm/s and loses a capsule that is
pinched by ${lostAt_N.join(' and ')} N; told \`cone="elliptic" impratio="100"\` and \`solref="0.004 1" solimp="0.99 0.999 0.001"\`, by at most
${shown(Math.max(...held(mujoco, told)))} µm/s; ${physx} with the TGS solver by at most ${shown(Math.max(...held(physx, 'TGS')))} µm/s; \`softfinger simulate\` by at most ${shown(Math.max(...still.map(row => row.um_per_s)))} µm/s
with nothing set, and by ${shown(turning.um_per_s)} µm/s while a claw turns, which is an error of its time step.

\`\`\`xml
<option cone="elliptic" impratio="100"/>
<default><geom solref="0.004 1" solimp="0.99 0.999 0.001"/></default>   <!-- solref: two time steps -->
\`\`\`

\`impratio="10" noslip_iterations="50" noslip_tolerance="1e-12"\` with that solref and solimp comes to at most ${shown(Math.max(...held(mujoco, exact)))} µm/s. What
\`softfinger export --to mujoco\` prints, \`impratio="10" noslip_iterations="5"\`, needs them, too.

This page is generated; from the checkout:

<!-- not run: a minute, and MuJoCo and PhysX from npm -->
\`\`\`sh
node comparisons/benchmark/creep/creep.mjs build/release/bin/softfinger --benchmark build/release/bin/softfinger-benchmark \\
  --csv docs/measurements/creep.csv --page docs/measurements/creep.md
\`\`\`

Drift in µm/s; mrad/s, in the frame that holds and relative to the middle of the pads, over 3 s (2 s after the claw has turned); steps of 2 ms unless stated. "Stiff" are the
\`solref\` and \`solimp\` above, "noslip" are \`noslip_iterations\`. The watch ends early where a body has moved by 5 mm or turned by
0.5 rad. A hold is lost where that is so before the watch begins, or where the body is 50 mm away in the end.

| engine, setting | ${columns.map(({head}) => head).join(' | ')} |
|---|${columns.map(() => '---|').join('')}
${table.join('\n')}

- **A capsule** of 45 g, 20 mm thick and 80 mm long, lies level between two flat pads of 20 mm, of 100 g each, that press with 12 to 60 N. Its centre of mass is
  8 mm beside them. It touches each pad at two points, the ends of a line.
- **A bar** of 100 g is held by two pads of 20 x 20 mm with 20 N, 20 mm beside its centre of mass. The claw turns by half a turn within 3 s about
  the level line through the pads. In \`softfinger simulate\` the pads are soft (2 mm, 300 kPa); in PhysX and Bullet the
  weight turns, not the claw.
- **A cube** of 100 g and 40 mm is pressed on an upright wall with 10 N. The friction coefficient is 0.8 everywhere, and all holds are well below their limits.

## What stands behind it

- **More grip does not help.** Friction at rest obeys R f = -b v in MuJoCo: a force f slides a point at v = R f/b, whatever presses it. R is
  (1 - d)/d times the bodies' inverse masses over impratio, 1 + mu² times that in a pyramidal cone; d is solimp's impedance, 0.9 to 0.95; b is
  2/(0.95 solref), 105/s. So the step does not matter either. For the cube, µm/s:

| setting | formula | measured |
|---|---|---|
${byFormula('defaults', {friction: 0.8})}
${byFormula('impratio 10', {friction: 0.8, impratio: 10})}
${byFormula('elliptic', {})}
${byFormula('elliptic, impratio 100', {impratio: 100})}
${byFormula(told, {impratio: 100, timeConstant_s: 0.004, solimp: [0.99, 0.999, 1e-3]})}

- **More grip may lose the object.** R also gives way to the grip: with the defaults each pad and the capsule overlap by ${shown(capsuleAt('defaults', 12).sunk_mm)} mm
  at 12 N and by ${shown(capsuleAt('defaults', 36).sunk_mm)} mm at 36 N, with elliptic cones by ${shown(capsuleAt('elliptic', 12).sunk_mm)} and ${shown(capsuleAt('elliptic', 36).sunk_mm)} mm. Beyond its radius of 10 mm
  it is squeezed out, or hangs between pads that overlap. Stiff: ${shown(capsuleAt('elliptic, stiff', 60).sunk_mm)} mm at 60 N.
- **noslip_iterations alone do not do**: five of them beside the defaults hold the cube, but leave the other holds at tens of µm/s, and do nothing
  against sinking in. With stiff contacts they help, the more of them the more.
- **Ours** has no residual velocity. While the claw turns, the bar moves by ${shown(turning.um_per_s)} µm/s: its centre of mass r = 20 mm from the axis moves along the tangent in
  each step, r omega² dt/2 outwards; ${shown(of(ours, 'defaults, step of 0.5 ms')[4].um_per_s)} µm/s with steps of 0.5 ms. It stops with the turn.
- **${physx}** computes in single precision. With PGS the bar moves by ${shown(at(rows, physx, 'PGS', columns[4]).um_per_s)} µm/s
  while the claw turns; TGS is the one to set.
${bullet ? `- **${bullet}** lets the cube slide by ${shown(at(rows, bullet, 'defaults', columns.at(-1)).um_per_s)} µm/s. Its contact of a capsule with a face has no torque: the capsule turns freely
  about the line through the pads. The bar turns out of its pads. There the capsule's weight
  acts with a torque at its centre.
` : ''}
MuJoCo is npm's \`@mujoco/mujoco\`; its solver is Newton's by default. PhysX is \`physx-js-webidl\`, with 4 iterations unless stated. What else is set, and the scenes, stand in
\`comparisons/benchmark/creep\`. More digits: [creep.csv](creep.csv).
`;
}
