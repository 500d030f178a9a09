// MuJoCo 3 as WebAssembly from npm, fetched by the checksum of package-lock.json.
import {spawnSync} from 'node:child_process';
import {copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const skipped = 77;  // CTest's SKIP_RETURN_CODE

/** MuJoCo, fetched into the folder unless it is there at the version of the lock file. */
export async function loadMujoco(npm, folder) {
  const lock = readFileSync(join(here, 'package-lock.json'), 'utf8');
  const stamp = join(folder, 'installed');
  if (!existsSync(stamp) || readFileSync(stamp, 'utf8') !== lock) {
    mkdirSync(folder, {recursive: true});
    for (const file of ['package.json', 'package-lock.json', '.npmrc'])
      copyFileSync(join(here, file), join(folder, file));
    const words = ['ci', '--ignore-scripts', '--no-audit', '--no-fund', '--prefer-offline', '--fetch-retries=1',
      '--fetch-retry-mintimeout=1000', '--fetch-timeout=60000', '--loglevel=error'];
    const run = spawnSync(npm, words, {cwd: folder, encoding: 'utf8', timeout: 150_000});
    if (run.status !== 0) {
      // A package that is not the one of the lock file is a failure, not a missing network.
      const isChanged = /EINTEGRITY|EUSAGE/.test(run.stderr);
      console.log(`${isChanged ? 'failed' : 'skipped'}: npm cannot fetch @mujoco/mujoco\n${run.stderr}`);
      process.exit(isChanged ? 1 : skipped);
    }
    writeFileSync(stamp, lock);
  }
  const path = join(folder, 'node_modules', '@mujoco', 'mujoco', 'mujoco.js');
  return (await import(pathToFileURL(path))).default();
}
