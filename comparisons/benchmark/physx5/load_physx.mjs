// PhysX 5 as WebAssembly from npm, fetched by the checksum of package-lock.json.
import {readFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {fetchPackages} from '../fetch_packages.mjs';

/** PhysX, fetched into the folder unless it is there. The package is built for pages: it looks for a window, and for no process. */
export async function loadPhysx(npm, folder) {
  fetchPackages(dirname(fileURLToPath(import.meta.url)), npm, folder, 'physx-js-webidl');
  const path = join(folder, 'node_modules', 'physx-js-webidl');
  const wasmBinary = readFileSync(join(path, 'physx-js-webidl.wasm')), node = globalThis.process;
  globalThis.window = globalThis;
  Object.defineProperty(globalThis, 'process', {value: undefined, configurable: true, writable: true});
  const made = await (await import(pathToFileURL(join(path, 'physx-js-webidl.mjs')))).default({wasmBinary});
  globalThis.process = node;
  return made;
}
