// node creep.mjs SOFTFINGER [--benchmark BENCHMARK] [--npm NPM] [--packages FOLDER] [--csv FILE] [--json FILE] [--page FILE]
// How much do held things creep in MuJoCo 3, PhysX 5 and `softfinger simulate`, and what has to be set?
//
// SOFTFINGER is the program; BENCHMARK, softfinger-benchmark, adds Bullet where it has that; FOLDER keeps what comes from npm (default: build/npm). Without a FILE the
// CSV goes to standard output. softfinger-benchmark --creep reads the JSON.
import {spawnSync} from 'node:child_process';
import {writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {parseArgs} from 'node:util';
import {loadMujoco} from '../mujoco3/load_mujoco.mjs';
import {loadPhysx} from '../physx5/load_physx.mjs';
import * as mujocoRuns from './mujoco.mjs';
import {pageText} from './page.mjs';
import * as physxRuns from './physx.mjs';
import {allScenes} from './scenes.mjs';
import * as softfingerRuns from './softfinger.mjs';

const {values, positionals} = parseArgs({allowPositionals: true, options: {
  npm: {type: 'string', default: 'npm'}, packages: {type: 'string', default: 'build/npm'}, benchmark: {type: 'string'}, csv: {type: 'string'}, json: {type: 'string'}, page: {type: 'string'}}});
if (positionals.length !== 1) {
  console.error('usage: node creep.mjs SOFTFINGER [--benchmark BENCHMARK] [--npm NPM] [--packages FOLDER] [--csv FILE] [--json FILE] [--page FILE]');
  process.exit(2);
}
const [softfinger] = positionals;
const mujoco = await loadMujoco(values.npm, join(values.packages, 'mujoco3'));
const physx = new physxRuns.Physx(await loadPhysx(values.npm, join(values.packages, 'physx5')));
const engines = [
  {name: `MuJoCo ${mujoco.mj_versionString()}`, settings: mujocoRuns.settings, run: (...words) => mujocoRuns.run(mujoco, ...words)},
  {name: spawnSync(softfinger, ['--version'], {encoding: 'utf8'}).stdout.trim(), settings: softfingerRuns.settings,
    run: (...words) => softfingerRuns.run(softfinger, ...words)},
  {name: `PhysX ${physx.version}`, settings: physxRuns.settings, run: (...words) => physx.run(...words)},
];

/** The same holds in Bullet, which has a number for each of the watches, in their order. */
function bulletRows(benchmark) {
  const words = ['--engine', 'bullet_exported', '--json', ...['capsule', 'claw', 'wall'].flatMap(name => ['--problem', name])];
  const done = spawnSync(benchmark, words, {encoding: 'utf8'});
  if (done.status !== 0) throw new Error(`${benchmark} ${words.join(' ')} ends with ${done.status}:\n${done.stderr}`);
  const [{title, problems}] = JSON.parse(done.stdout).engines;
  return allScenes().flatMap(scene => scene.watches_s.map(([from_s, to_s]) => {
    const [moves, turns] = problems[scene.name].measured.splice(0, 2).map(({value}) => value);
    return {engine: title.split(',')[0], setting: 'defaults', scene: scene.name, load_N: scene.load_N, time_step_s: scene.timeStep_s, from_s, to_s,
      um_per_s: moves, mrad_per_s: turns, watched_s: null, sunk_mm: null, lost_at_s: null};
  }));
}

const rows = [];
for (const {name: engine, settings, run} of engines)
  for (const setting of settings)
    for (const scene of allScenes()) {
      console.error(`${engine}, ${setting.name}: ${scene.name}, ${scene.load_N} N`);
      for (const {watch_s: [from_s, to_s], ...result} of run(scene, setting))
        rows.push({engine, setting: setting.name, scene: scene.name, load_N: scene.load_N, time_step_s: setting.timeStep_s ?? scene.timeStep_s,
          from_s, to_s, ...result});
    }

if (values.benchmark) rows.push(...bulletRows(values.benchmark));

const columns = Object.keys(rows[0]);
const cell = value => value === null ? '' : typeof value === 'number' ? String(Number(value.toPrecision(4))) : /,/.test(value) ? `"${value}"` : value;
const csv = [columns, ...rows.map(row => columns.map(column => row[column]))].map(line => line.map(cell).join(',')).join('\n') + '\n';
if (values.csv) writeFileSync(values.csv, csv);
if (values.json) writeFileSync(values.json, JSON.stringify({command: ['node', ...process.argv.slice(1)].join(' '), rows}, null, 1) + '\n');
if (values.page) writeFileSync(values.page, pageText(rows));
if (!values.csv && !values.json && !values.page) process.stdout.write(csv);
process.exit(0);
