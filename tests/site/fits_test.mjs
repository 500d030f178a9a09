// Draws all pages of a site in frames as wide as a phone and as a screen, by a browser. None may be wider than its frame.
//
// usage: fits_test.mjs FOLDER
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";

const folder = path.resolve(process.argv[2]);
const names = fs.readdirSync(folder, { recursive: true })
  .filter((name) => name.endsWith(".html") && !/^(reference|gallery)\//.test(name) && name !== "index.html");
const work = fs.mkdtempSync(path.join(os.tmpdir(), "fits-"));
// One frame at a time: the next page is loaded when the last one was measured.
fs.writeFileSync(path.join(work, "frames.html"), `<!doctype html><iframe style="border: 0; height: 900px"></iframe><script>
const frame = document.querySelector("iframe"), wide = [], pages = ${JSON.stringify(names)};
const jobs = [390, 1280].flatMap((width) => pages.map((page) => [width, page]));
let at = -1;
frame.onload = () => {
  if (at >= 0) {
    const [width, page] = jobs[at], { scrollWidth } = frame.contentDocument.documentElement;
    if (scrollWidth > width) wide.push(page + " is " + scrollWidth + " wide in " + width);
  }
  if (++at === jobs.length) {
    document.title = wide.join("; ") || at + " fit";
    return;
  }
  frame.style.width = jobs[at][0] + "px";
  frame.src = "file://${folder}/" + jobs[at][1];
};
frame.src = "about:blank";
</script>`);
const browser = ["chromium", "chromium-browser", "google-chrome"].find((name) => spawnSync(name, ["--version"]).status === 0);
const { stdout } = spawnSync(browser ?? "chromium", [
  "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update",
  "--disable-sync", "--allow-file-access-from-files", `--user-data-dir=${work}/profile`, "--virtual-time-budget=100000",
  "--dump-dom", `file://${work}/frames.html`,
], { encoding: "utf8" });
fs.rmSync(work, { recursive: true });
const said = /<title>([^<]*)</.exec(stdout ?? "")?.[1] ?? "the browser drew nothing";
console.log(said.replaceAll("; ", "\n"));
process.exit(names.length && said === `${2 * names.length} fit` ? 0 : 1);
