// Makes the pages' site: every Markdown page that docs/README.md leads to, with navigation, typeset equations and a
// search, and each file that a page links to. Nothing of it asks for a network.
//
// usage: site.mjs CHECKOUT OUTPUT [PROGRAM] [TAGS]     NODE_PATH holds marked
//   PROGRAM   softfinger: adds the explorer as the first page and, with softfinger-fem beside it, the gallery of reports
//   TAGS      Doxygen's tag file of the headers' pages in OUTPUT/reference
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { escapeHtml, typeset } from "./typeset.mjs";

// From NODE_PATH, which only `require` knows.
const { Marked } = createRequire(import.meta.url)("marked");
const own = path.dirname(fileURLToPath(import.meta.url));
const [checkout, output, program, tags] = process.argv.slice(2);
const read = (file) => fs.readFileSync(path.join(checkout, file), "utf8");
const SIGNS = { amp: "&", lt: "<", gt: ">", quot: '"', "#39": "'" };
const unescape = (html) => html.replace(/&(amp|lt|gt|quot|#39);/g, (_, name) => SIGNS[name]);
const text = (html) => unescape(html.replace(/<math[^>]*alttext="([^"]*)">.*?<\/math>/g, "$1").replace(/<\/(td|th|li|p|tr)>/g, " ").replace(/<[^>]*>/g, "")).replace(/\s+/g, " ");

function fail(message) {
  console.error(`site: ${message}`);
  process.exit(1);
}

/// Where a file of the checkout lies in the site.
function address(file) {
  const visible = file.replace(/^\./, "");
  if (visible === "README.md") return "readme.html";
  if (isPage(file)) return visible.replace(/README\.md$/, "index.md").replace(/\.(md|ipynb)$/, ".html");
  return /\.(png|svg)$/.test(file) ? visible : `${visible}.html`;
}
const isPage = (file) => /\.(md|ipynb)$/.test(file);
const relative = (from, to) => path.posix.relative(path.posix.dirname(from), to);

function write(file, content) {
  const target = path.join(output, file);
  fs.mkdirSync(path.dirname(target), { recursive: true });
  fs.writeFileSync(target, content);
}

/// A notebook as a page: its texts, its code and what that prints.
function notebook(file) {
  const joined = (lines) => [lines ?? ""].flat().join("").trimEnd();
  return JSON.parse(read(file)).cells.map((cell) => {
    if (cell.cell_type === "markdown") return joined(cell.source);
    const printed = (cell.outputs ?? []).map((one) => {
      const picture = one.data?.["image/png"];
      if (picture) return `<img alt="" src="data:image/png;base64,${joined(picture).replace(/\s/g, "")}">`;
      return "```text\n" + joined(one.text ?? one.data?.["text/plain"]) + "\n```";
    });
    return ["```python\n" + joined(cell.source) + "\n```", ...printed].join("\n\n");
  }).join("\n\n");
}

/// The headers' pages by file, and an entry of the search for each name in them.
function readTags() {
  const pages = new Map(), entries = [];
  if (!tags || !fs.existsSync(tags)) return { pages, entries };
  for (const [, kind, body] of fs.readFileSync(tags, "utf8").matchAll(/<compound kind="(\w+)">([^]*?)<\/compound>/g)) {
    const field = (name, from) => new RegExp(`<${name}>([^<]*)</${name}>`).exec(from)?.[1];
    const head = body.split("<member")[0];
    const html = (name) => `reference/${name.replace(/(\.html)?$/, ".html")}`;
    const name = unescape(field("name", head)), url = html(field("filename", head));
    if (kind === "file") pages.set(path.posix.join(field("path", head)?.replace(`${checkout}/`, "") ?? "", name), url);
    if (/file|class|struct|namespace/.test(kind)) entries.push({ url, title: name, page: "headers", text: "" });
    if (!/class|struct|namespace/.test(kind)) continue;
    for (const [, member] of body.matchAll(/<member [^>]*>([^]*?)<\/member>/g)) {
      const file = field("anchorfile", member);
      if (file) {
        const title = `${name}::${unescape(field("name", member))}`;
        entries.push({ url: `${html(file)}#${field("anchor", member)}`, title, page: "headers", text: "" });
      }
    }
  }
  return { pages, entries };
}

const headers = readTags();
const search = [];
const seen = new Set();
const pending = [];

/// The site's address of a link in a page, whose target gets a page, too.
function follow(page, href) {
  if (/^[a-z]+:/.test(href)) return href;
  const [target, fragment] = href.split("#");
  const file = target ? path.posix.normalize(path.posix.join(path.posix.dirname(page), target)).replace(/\/$/, "") : page;
  if (file.startsWith("..") || !fs.existsSync(path.join(checkout, file))) fail(`${page} links to ${href}, which does not exist`);
  const known = headers.pages.get(file);
  if (!known && !seen.has(file)) {
    seen.add(file);
    pending.push(file);
  }
  const url = relative(address(page), known ?? address(file));
  return fragment === undefined ? url : `${target ? url : ""}#${fragment}`;
}

/// As GitHub names headings, which links in the pages rely on.
function slugs() {
  const used = new Map();
  return (heading) => {
    const slug = heading.toLowerCase().replace(/[^\p{L}\p{N}\s_-]/gu, "").replace(/\s/g, "-");
    const count = used.get(slug) ?? 0;
    used.set(slug, count + 1);
    return count ? `${slug}-${count}` : slug;
  };
}

/// HTML of a page, its title, and an entry of the search for each of its sections.
function render(file, markdown) {
  const slug = slugs();
  const sections = [];
  let columns = [], stacked = false, title = path.basename(file);
  const marked = new Marked({
    hooks: {
      // "E\*" comes as two tokens.
      processAllTokens(all) {
        const join = (list) => list.reduce((joined, token) => {
          const last = joined.at(-1);
          const isPlain = (one) => one?.type === "escape" || (one?.type === "text" && !one.tokens);
          if (isPlain(last) && isPlain(token)) joined[joined.length - 1] = { ...last, type: "text", escaped: false, text: last.text + token.text };
          else joined.push(token);
          return joined;
        }, []);
        const walk = (token) => {
          if (token.tokens) (token.tokens = join(token.tokens)).forEach(walk);
          if (token.items) token.items.forEach(walk);
          if (token.rows) [token.header, ...token.rows].flat().forEach(walk);
        };
        all.forEach(walk);
        return all;
      },
    },
    renderer: {
      heading({ tokens, depth, text: raw }) {
        const plain = raw.replace(/\[([^\]]*)\]\([^)]*\)/g, "$1").replace(/[`*\\]/g, "");
        if (depth === 1) title = plain;
        sections.push({ id: slug(plain), title: plain });
        return `<h${depth} id="${sections.at(-1).id}">${this.parser.parseInline(tokens)}</h${depth}>\n`;
      },
      text(token) {
        return token.tokens ? this.parser.parseInline(token.tokens) : typeset(token.text, stacked);
      },
      link({ href, title: hint, tokens }) {
        return `<a href="${escapeHtml(follow(file, href))}"${hint ? ` title="${escapeHtml(hint)}"` : ""}>${this.parser.parseInline(tokens)}</a>`;
      },
      image({ href, text: words }) {
        return `<img src="${escapeHtml(follow(file, href))}" alt="${escapeHtml(words)}">`;
      },
      table({ header, rows }) {
        const line = (cells, tag) => `<tr>${cells.map((cell, column) => {
          stacked = tag === "td" && columns[column] === "equation";
          const html = `<${tag}>${this.parser.parseInline(cell.tokens)}</${tag}>`;
          stacked = false;
          return html;
        }).join("")}</tr>\n`;
        columns = header.map((cell) => cell.text);
        return `<div class="scroll"><table><thead>${line(header, "th")}</thead><tbody>${rows.map((cells) => line(cells, "td")).join("")}</tbody></table></div>\n`;
      },
    },
  });
  const html = marked.parse(markdown);
  const pieces = html.split(/<h[1-6] id=.*<\/h[1-6]>/).slice(1);
  pieces.forEach((piece, at) => search.push({
    url: `${address(file)}#${sections[at].id}`, title: sections[at].title, page: title, text: text(piece),
  }));
  return { html, title };
}

/// Groups of pages with the question that each answers: the tables of docs/README.md.
function navigation() {
  const groups = [];
  const inline = (tokens) => tokens.flatMap((token) => token.type === "link" ? [token] : []);
  for (const token of new Marked().lexer(read("docs/README.md"))) {
    if (token.type === "heading") groups.push({ title: token.text, rows: [] });
    if (token.type === "table") {
      for (const [pages, answers] of token.rows) {
        groups.at(-1).rows.push({
          pages: inline(pages.tokens).map(({ href, text: title }) => ({ title, file: path.posix.normalize(`docs/${href}`) })),
          answers: answers.text.replace(/`/g, ""),
        });
      }
    }
  }
  const listed = new Set(groups.flatMap((group) => group.rows.flatMap((row) => row.pages.map((page) => page.file))));
  for (const name of fs.readdirSync(path.join(checkout, "docs"))) {
    const file = `docs/${name}`;
    if (name.endsWith(".md") && name !== "README.md" && !listed.has(file)) fail(`docs/README.md does not say which question ${file} answers`);
  }
  return groups.filter((group) => group.rows.length);
}

if (program && !fs.existsSync(program)) fail(`${program}: there is no such program`);
const groups = navigation();
// Half of its reports are about finite elements.
const hasGallery = Boolean(program) && fs.existsSync(path.join(path.dirname(program), "softfinger-fem"));

function links(from) {
  const places = [["index.html", "Explore"], ["docs/index.html", "Pages"], ["readme.html", "In ten minutes"]];
  if (hasGallery) places.push(["gallery.html", "Gallery"]);
  places.push(["analytic/index.html", "Theory"]);
  if (headers.pages.size) places.push(["reference/files.html", "Headers"]);
  return places.map(([url, name]) => `<a href="${relative(from, url)}"${url === from ? ' aria-current="page"' : ""}>${name}</a>`).join("\n");
}

function sidebar(from) {
  return groups.map(({ title, rows }) => `<h2>${escapeHtml(title)}</h2>\n<ul>${rows.map(({ pages, answers }) =>
    `<li>${pages.map((page) => {
      const url = address(page.file);
      return `<a href="${relative(from, url)}"${url === from ? ' aria-current="page"' : ""}>${escapeHtml(page.title)}</a>`;
    }).join(", ")}<small>${escapeHtml(answers)}</small></li>`).join("\n")}</ul>`).join("\n");
}

function frame(url, title, body) {
  const root = relative(url, "site.css").replace(/site\.css$/, "");
  return `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>${escapeHtml(title)} · softfinger</title>
<link rel="stylesheet" href="${root}site.css">
</head>
<body>
<header class="site"><a class="name" href="${root}index.html">softfinger</a>
<nav aria-label="Site">${links(url)}</nav>
<form role="search"><input type="search" placeholder="Search all pages" aria-label="Search all pages" data-root="${root}"></form></header>
<div id="found" hidden></div>
<div class="columns">
<details class="pages"><summary>Which question?</summary><nav aria-label="Pages">${sidebar(url)}</nav></details>
<main>
${body}
</main>
</div>
<script src="${root}site.js"></script>
</body>
</html>
`;
}

/// A file that is no page, as it is.
function listing(file) {
  const full = path.join(checkout, file);
  if (fs.statSync(full).isDirectory()) {
    const names = fs.readdirSync(full).filter((name) => fs.statSync(path.join(full, name)).isFile());
    return `<h1>${escapeHtml(file)}</h1>\n<ul>${names.map((name) =>
      `<li><a href="${follow(file, `${path.basename(file)}/${name}`)}">${escapeHtml(name)}</a></li>`).join("")}</ul>`;
  }
  return `<h1>${escapeHtml(file)}</h1>\n<pre>${escapeHtml(read(file))}</pre>`;
}

const run = (words, folder) => spawnSync(program, words, { cwd: folder, stdio: ["ignore", "ignore", "inherit"] });

/// Runs the gallery's commands anew, all of them, where the program or the list is newer than a report.
function gallery() {
  const list = path.join(own, "gallery.json"), folder = path.join(output, "gallery");
  const reports = JSON.parse(fs.readFileSync(list, "utf8"));
  const time = (file) => fs.statSync(file, { throwIfNoEntry: false })?.mtimeMs ?? 0;
  const newest = Math.max(time(program), time(list));
  const isOld = reports.some(({ page }) => time(path.join(folder, page)) < newest);
  if (isOld) {
    fs.rmSync(folder, { recursive: true, force: true });
    fs.mkdirSync(folder);
  }
  const cards = reports.map(({ question, command, page, file }) => {
    if (isOld) {
      console.log(`softfinger ${command}`);
      // A report names the file that it reads: one beside it has no folder of this machine in its name.
      if (file) fs.copyFileSync(path.join(checkout, file), path.join(folder, path.basename(file)));
      // Status 1 is an answer, too: a comparison that fell short.
      const { status } = run(command.split(" "), folder);
      if (![0, 1].includes(status) || !fs.existsSync(path.join(folder, page))) fail(`softfinger ${command} ends with ${status} and without ${page}`);
    }
    return `<article class="card"><a href="gallery/${page}"><div class="preview"><iframe src="gallery/${page}" title="${escapeHtml(question)}" loading="lazy" tabindex="-1" scrolling="no"></iframe></div>
<h2>${escapeHtml(question)}</h2></a><pre>softfinger ${escapeHtml(command)}</pre></article>`;
  });
  write("gallery.html", frame("gallery.html", "Gallery",
    `<h1>Gallery of reports</h1>\n<p>Each page was made by the command below it, from a built-in case, when this site was made.</p>\n<div class="cards">${cards.join("\n")}</div>`));
}

/// The explorer as the first page, with the way to all others.
function explorer() {
  const status = program && run(["explore", "--quiet", "--output", "index.html"], output).status;
  // Status 2: the program was built without the explorer, and has said so.
  if (program && ![0, 2].includes(status)) fail(`softfinger explore ends with ${status}`);
  if (status === 0) {
    const page = fs.readFileSync(path.join(output, "index.html"), "utf8");
    write("index.html", page.replace("<main>", `<main>\n<nav aria-label="Site" style="margin: 0 0 1.4rem">${links("index.html")}</nav>`));
    return;
  }
  write("index.html", '<!doctype html>\n<meta charset="utf-8"><meta http-equiv="refresh" content="0; url=docs/index.html">\n' +
    '<title>softfinger</title>\n<a href="docs/index.html">softfinger</a>\n');
}

/// Gives the headers' pages a way back. Doxygen's link to nested classes leads nowhere where all of them are private.
function finishHeaders() {
  const folder = path.join(output, "reference");
  const bar = `<p class="site">${links("reference/files.html")}</p>`;
  for (const name of fs.readdirSync(folder).filter((file) => file.endsWith(".html"))) {
    const file = path.join(folder, name), html = fs.readFileSync(file, "utf8");
    if (html.includes(bar)) continue;
    const dead = html.includes('name="nested-classes"') ? "" : /<a href="#nested-classes">[^<]*<\/a>(\s*&#124;)?/;
    fs.writeFileSync(file, html.replace(/<body[^>]*>/, `$&${bar}`).replace(dead, ""));
  }
}

for (const name of fs.existsSync(output) ? fs.readdirSync(output) : []) {
  if (name !== "reference" && name !== "gallery") fs.rmSync(path.join(output, name), { recursive: true });
}
fs.mkdirSync(output, { recursive: true });
for (const file of ["docs/README.md", "README.md", "analytic/README.md"]) follow("README.md", file);
for (const file of groups.flatMap((group) => group.rows.flatMap((row) => row.pages.map((page) => page.file)))) follow("README.md", file);
while (pending.length) {
  const file = pending.pop(), url = address(file);
  if (isPage(file)) {
    const { html, title } = render(file, file.endsWith(".md") ? read(file) : notebook(file));
    write(url, frame(url, title, html));
  } else if (url.endsWith(".html")) {
    write(url, frame(url, path.basename(file), listing(file)));
  } else {
    write(url, fs.readFileSync(path.join(checkout, file)));
  }
}
if (hasGallery) gallery();
explorer();
if (headers.pages.size) finishHeaders();
write("site.css", read("comparisons/report/report.css") + fs.readFileSync(path.join(own, "site.css"), "utf8"));
write("site.js", fs.readFileSync(path.join(own, "site.js")));
// A script and no JSON, because pages that are opened as files may not fetch.
write("search_data.js", `searchData = ${JSON.stringify([...search, ...headers.entries])};\n`);
console.log(`site: ${seen.size} pages and files, ${search.length} sections and ${headers.entries.length} names of headers to search`);
