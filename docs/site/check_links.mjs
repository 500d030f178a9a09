// Fails where a link of a folder of pages leads nowhere: to a file or a heading that is not there. Addresses
// elsewhere are only read, because a check must not depend on a network.
//
// usage: check_links.mjs FOLDER
import fs from "node:fs";
import path from "node:path";

const folder = path.resolve(process.argv[2]);
const pages = fs.readdirSync(folder, { recursive: true }).filter((name) => name.endsWith(".html"))
  .map((name) => path.join(folder, name));
const isFile = (file) => fs.statSync(file, { throwIfNoEntry: false })?.isFile();
const plain = (text) => text.replace(/&amp;/g, "&").replace(/&quot;/g, '"').replace(/&#39;/g, "'");

const contents = new Map();
/// The tags of a page, without what stands in scripts and comments, and its anchors.
function content(file) {
  if (!contents.has(file)) {
    const html = fs.readFileSync(file, "utf8").replace(/<(script|style)\b([^>]*)>[^]*?<\/\1>/g, "<$1$2>")
      .replace(/<!--[^]*?-->/g, "");
    const anchors = new Set([...html.matchAll(/\s(?:id|name)="([^"]*)"/g)].map(([, id]) => plain(id)));
    const links = [...html.matchAll(/<[^<>]*?\s(?:href|src)="([^"]*)"/g)].map(([, link]) => plain(link));
    contents.set(file, { anchors, links });
  }
  return contents.get(file);
}

/// What is wrong with a link, if anything.
function fault(page, link) {
  if (/^(data|javascript|mailto):/.test(link)) return null;
  if (/^[a-z][a-z+.-]*:/i.test(link)) {
    return URL.canParse(link) && /^https?:$/.test(new URL(link).protocol) ? null : "is no address";
  }
  const [target, fragment] = link.split("#");
  const name = decodeURIComponent(target.split("?")[0]);
  const file = name ? path.resolve(path.dirname(page), name) : page;
  if (!file.startsWith(folder)) return "leaves the site";
  if (!isFile(file)) return "leads to no file";
  if (fragment && file.endsWith(".html") && !content(file).anchors.has(decodeURIComponent(fragment))) return "leads to no heading";
  return null;
}

let links = 0, broken = 0;
for (const page of pages) {
  for (const link of content(page).links) {
    ++links;
    const wrong = fault(page, link);
    if (!wrong) continue;
    ++broken;
    console.error(`${path.relative(folder, page)}: ${link} ${wrong}`);
  }
}
console.log(`${links} links in ${pages.length} pages, ${broken} broken`);
process.exit(broken || pages.length === 0 ? 1 : 0);
