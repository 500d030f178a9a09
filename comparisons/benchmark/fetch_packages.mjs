// Fetches packages from npm by the checksums of a package-lock.json.
import {spawnSync} from 'node:child_process';
import {copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';

const skipped = 77;  // CTest's SKIP_RETURN_CODE

/** Fetches into the folder unless the packages are there at the versions of the lock file in `here`. */
export function fetchPackages(here, npm, folder, name) {
  const lock = readFileSync(join(here, 'package-lock.json'), 'utf8');
  const stamp = join(folder, 'installed');
  if (existsSync(stamp) && readFileSync(stamp, 'utf8') === lock) return;
  mkdirSync(folder, {recursive: true});
  for (const file of ['package.json', 'package-lock.json', '.npmrc'])
    copyFileSync(join(here, file), join(folder, file));
  const words = ['ci', '--ignore-scripts', '--no-audit', '--no-fund', '--prefer-offline', '--fetch-retries=1',
    '--fetch-retry-mintimeout=1000', '--fetch-timeout=60000', '--loglevel=error'];
  const run = spawnSync(npm, words, {cwd: folder, encoding: 'utf8', timeout: 150_000});
  if (run.status !== 0) {
    // A package that is not the one of the lock file is a failure, not a missing network.
    const isChanged = /EINTEGRITY|EUSAGE/.test(run.stderr);
    console.log(`${isChanged ? 'failed' : 'skipped'}: npm cannot fetch ${name}\n${run.stderr}`);
    process.exit(isChanged ? 1 : skipped);
  }
  writeFileSync(stamp, lock);
}
