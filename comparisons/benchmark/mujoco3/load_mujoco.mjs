// MuJoCo 3 as WebAssembly from npm, fetched by the checksum of package-lock.json.
import {dirname, join} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {fetchPackages} from '../fetch_packages.mjs';

/** MuJoCo, fetched into the folder unless it is there at the version of the lock file. */
export async function loadMujoco(npm, folder) {
  fetchPackages(dirname(fileURLToPath(import.meta.url)), npm, folder, '@mujoco/mujoco');
  const path = join(folder, 'node_modules', '@mujoco', 'mujoco', 'mujoco.js');
  return (await import(pathToFileURL(path))).default();
}
