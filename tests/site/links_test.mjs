// The check of links finds each kind of broken one, and accepts the others.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import test from "node:test";

const check = path.resolve(import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname), "../../docs/site/check_links.mjs");

function checked(page) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "links-"));
  fs.mkdirSync(path.join(folder, "folder"));
  fs.writeFileSync(path.join(folder, "folder", "other.html"), '<h1 id="there">Other</h1>');
  fs.writeFileSync(path.join(folder, "page.html"), page);
  const { status, stderr } = spawnSync(process.execPath, [check, folder], { encoding: "utf8" });
  fs.rmSync(folder, { recursive: true });
  return { status, stderr };
}

test("links that lead somewhere are accepted", () => {
  const { status, stderr } = checked(`<h2 id="here">Here</h2><a href="#here">1</a> <a href="folder/other.html#there">2</a>
    <a href="https://example.org/a?b=c">3</a> <script>const html = '<a href="nowhere">';</script>
    <img src="data:image/png;base64,AA=="> <a href="folder/other.html?search=x">4</a>`);
  assert.equal(stderr, "");
  assert.equal(status, 0);
});

for (const [link, fault] of [
  ["nowhere.html", "leads to no file"],
  ["folder", "leads to no file"],
  ["Folder/other.html", "leads to no file"],
  ["../page.html", "leaves the site"],
  ["#nothing", "leads to no heading"],
  ["folder/other.html#nothing", "leads to no heading"],
  ["https://", "is no address"],
  ["htp://example.org", "is no address"],
]) {
  test(`${link} ${fault}`, () => {
    const { status, stderr } = checked(`<a class="x" href="${link}">link</a>`);
    assert.equal(status, 1);
    assert.equal(stderr, `page.html: ${link} ${fault}\n`);
  });
}
