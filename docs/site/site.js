// The search: sections that have all words, those first that have them in their title.
const input = document.querySelector("input[type=search]");
const found = document.getElementById("found");
const root = input.dataset.root;
let loading;

// The data are a script of their own, which is loaded when somebody searches.
function load() {
  loading ??= new Promise((done) => {
    const script = document.createElement("script");
    script.src = `${root}search_data.js`;
    script.onload = () => done(window.searchData);
    document.head.append(script);
  });
  return loading;
}

function score(entry, words) {
  const title = entry.title.toLowerCase(), page = entry.page.toLowerCase(), text = entry.text.toLowerCase();
  let sum = 0;
  for (const word of words) {
    if (title.includes(word)) sum += title === word ? 20 : 10;
    else if (page.includes(word)) sum += 4;
    else if (text.includes(word)) sum += 1;
    else return 0;
  }
  return sum;
}

function excerpt(entry, words) {
  const at = Math.max(0, entry.text.toLowerCase().indexOf(words[0]));
  const from = Math.max(0, at - 60);
  return (from ? "… " : "") + entry.text.slice(from, at + 140).trim();
}

async function search() {
  const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
  found.hidden = words.length === 0;
  if (found.hidden) return;
  const data = await load();
  const best = data.map((entry) => [score(entry, words), entry]).filter(([points]) => points)
    .sort(([a], [b]) => b - a);
  found.replaceChildren();
  const count = document.createElement("p");
  count.textContent = best.length === 0 ? "Nothing has all of these words." : `${best.length} found`;
  found.append(count);
  for (const [, entry] of best.slice(0, 20)) {
    const item = document.createElement("a");
    item.href = root + entry.url;
    const title = document.createElement("b"), where = document.createElement("span"), text = document.createElement("small");
    title.textContent = entry.title;
    where.textContent = entry.page === entry.title ? "" : ` in ${entry.page}`;
    text.textContent = excerpt(entry, words);
    item.append(title, where, text);
    found.append(item);
  }
}

input.addEventListener("input", search);
input.form.addEventListener("submit", (event) => {
  event.preventDefault();
  found.querySelector("a")?.click();
});
addEventListener("keydown", ({ key, target }) => {
  if (key === "/" && target === document.body) {
    input.focus();
    input.select();
  }
});
addEventListener("keyup", ({ key }) => {
  if (key === "Escape") {
    input.value = "";
    found.hidden = true;
  }
});
// A narrow window shows the page first.
document.querySelector("details.pages").open = matchMedia("(min-width: 62rem)").matches;
// An address that ends with ?search=WORDS shows what they find.
const asked = new URLSearchParams(location.search).get("search");
if (asked) {
  input.value = asked;
  search();
}
