// Finds the equations that pages write in plain text ("p0 sqrt(1 - x²/a²)") and gives them as MathML, which
// browsers draw by themselves. A page stays readable where nobody typesets it, in an editor or in a terminal.
const GREEK = {
  alpha: "α", beta: "β", gamma: "γ", delta: "δ", theta: "θ", kappa: "κ", lambda: "λ", mu: "μ", nu: "ν", pi: "π",
  rho: "ρ", sigma: "σ", tau: "τ", phi: "φ", psi: "ψ", omega: "ω",
};
// Products that the pages write without a space. Other words of two letters are words.
const PRODUCTS = new Set(["ab", "kh", "kt", "ks"]);
const FUNCTIONS = new Set(["exp", "ln", "sin", "cos", "sinh", "cosh", "tanh", "min", "max", "sum", "sqrt"]);
// These act on what follows them without brackets.
const PREFIXES = { int: "∫", lap: "∇²", grad: "∇" };
const RELATIONS = { "=": "=", "<=": "≤", ">=": "≥", "<": "<", ">": ">", "~": "∼" };
const CLOSING = { "(": ")", "[": "]", "|": "|" };
const SUPERSCRIPTS = { "²": "2", "³": "3", "⁻¹": "−1" };

export const escapeHtml = (text) =>
  text.replace(/[&<>"]/g, (sign) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[sign]);

const TOKEN = new RegExp(
  [
    String.raw`(?<space>\s+)`,
    String.raw`(?<number>\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\d,.]*\d|%))`,
    String.raw`(?<symbol>(?!e\.g\.|i\.e\.)(?:(?<![\p{L}\d])d)?(?:${Object.keys(GREEK).join("|")}|[A-Za-z])(?![\p{L}-]*\p{L})` +
      String.raw`(?<index>\d+|_(?:\d+|[a-z]+))?(?<star>\*)?(?<primes>'{1,2}(?![a-z']))?)`,
    String.raw`(?<word>(?:e\.g\.|i\.e\.)|\p{L}[\p{L}\d_]*(?:[-'’]\p{L}+)*'?)`,
    String.raw`(?<relation><=|>=|[=<>~])`,
    String.raw`(?<dots>\.\.+)`,
    String.raw`(?<operator>[-+/])`,
    String.raw`(?<power>²|³|⁻¹|\^)`,
    String.raw`(?<bracket>[()[\]|])`,
    String.raw`(?<comma>,)`,
    String.raw`(?<other>[^])`,
  ].join("|"),
  "uy",
);

function tokens(text) {
  const found = [];
  for (TOKEN.lastIndex = 0; TOKEN.lastIndex < text.length; ) {
    const at = TOKEN.lastIndex;
    const { groups } = TOKEN.exec(text);
    const kind = Object.keys(groups).find((name) => groups[name] !== undefined);
    found.push({ kind, text: text.slice(at, TOKEN.lastIndex), at, ...groups });
  }
  found.push({ kind: "end", text: "", at: text.length });
  return found;
}

const identifier = (name) => `<mi>${GREEK[name] ?? escapeHtml(name)}</mi>`;
const GAP = '<mspace width="0.17em"/>';
const row = (parts) => (parts.length === 1 ? parts[0] : `<mrow>${parts.join("")}</mrow>`);

function symbol({ text, index, star, primes }) {
  const name = text.slice(0, text.length - [index, star, primes].join("").length);
  const isDifferential = name.length > 1 && !GREEK[name];
  const base = isDifferential ? row([GAP, identifier("d"), identifier(name.slice(1))]) : identifier(name);
  const prime = primes ? `<mo lspace="0" rspace="0">${primes.length > 1 ? "″" : "′"}</mo>` : "";
  const below = index?.replace("_", "");
  const low = below && (/\d/.test(below) ? `<mn>${below}</mn>` : `<mi>${GREEK[below] ?? below}</mi>`);
  const marked = low ? `<msub>${base}${low}</msub>` : base;
  return star ? `<msup>${marked}<mo>*</mo></msup>` : prime ? row([marked, prime]) : marked;
}

/// Reads equations from a list of tokens, by recursive descent. A part of one is { kind, markup }; what cannot be read is
/// null, and `at` is then where it was.
class Reader {
  constructor(list, stacked) {
    Object.assign(this, { list, stacked });
  }

  skipSpace() {
    while (this.list[this.at].kind === "space") ++this.at;
  }

  /// A bracket with what it encloses, which has to be mathematics alone. A relation in round brackets is a remark.
  group() {
    const open = this.list[this.at].text;
    const { at, strong, hasSymbol } = this;
    if (this.list[at].kind !== "bracket" || !CLOSING[open]) return null;
    ++this.at;
    const inside = this.expression(CLOSING[open]);
    const isRemark = open === "(" && inside?.some((part) => part.kind === "relation");
    if (!inside || inside.length === 0 || isRemark) {
      Object.assign(this, { at, strong, hasSymbol });
      return null;
    }
    const inner = row(inside.map((part) => part.markup));
    const fence = (sign) => `<mo stretchy="true" fence="true">${sign}</mo>`;
    const markup = row([fence(open), inner, fence(CLOSING[open])]);
    return { kind: "atom", markup, inner, bare: open === "|" ? markup : inner };
  }

  /// The part with the power behind it, if there is one.
  raised(part) {
    const { kind, text } = this.list[this.at];
    if (kind !== "power") return part;
    ++this.at;
    let high = SUPERSCRIPTS[text] && `<mn>${SUPERSCRIPTS[text]}</mn>`;
    if (!high) {
      // A fraction in an exponent would be too small to read.
      const { stacked } = this;
      this.stacked = false;
      const bracket = this.group();
      this.stacked = stacked;
      const next = this.list[this.at];
      high = bracket?.inner;
      if (!high && (next.kind === "symbol" || next.kind === "number")) {
        ++this.at;
        high = next.kind === "symbol" ? symbol(next) : `<mn>${next.text}</mn>`;
      }
      if (!high) {
        --this.at;
        return part;
      }
    }
    this.strong = true;
    return { kind: part.kind, markup: `<msup>${part.markup}${high}</msup>` };
  }

  /// One factor of a product.
  atom() {
    const token = this.list[this.at];
    if (token.kind === "number" || token.kind === "symbol") {
      ++this.at;
      if (token.kind === "symbol") this.hasSymbol = true;
      return this.raised({
        kind: "atom", token, markup: token.kind === "symbol" ? symbol(token) : `<mn>${token.text}</mn>`,
      });
    }
    if (token.kind === "word") return this.named(token);
    const bracket = this.group();
    return bracket && this.raised(bracket);
  }

  /// A factor that begins with a word: a function, a root, an integral.
  named(token) {
    const start = this.at++;
    const [, name, low] = /^([a-z]+)(?:_(\w+))?$/.exec(token.text) ?? [];
    if (PRODUCTS.has(token.text)) {
      this.hasSymbol = true;
      return this.raised({ kind: "atom", markup: row([...token.text].map(identifier)) });
    }
    if (PREFIXES[name] && this.list[this.at].kind !== "end") {
      let sign = `<mo>${PREFIXES[name]}</mo>`;
      const bound = low && this.list[this.at].text === "^" && this.list[this.at + 1];
      if (bound) {
        sign = `<msubsup>${sign}${identifier(low)}${symbol(bound)}</msubsup>`;
        this.at += 2;
      }
      this.strong = true;
      return { kind: name === "int" ? "operator" : "atom", markup: sign };
    }
    if (FUNCTIONS.has(token.text)) {
      const head = this.raised({ kind: "atom", markup: `<mi>${token.text}</mi>` });
      const close = this.at;
      this.skipSpace();
      const next = this.list[this.at];
      const bracket = this.group();
      if (token.text === "sqrt" && bracket) {
        this.strong = true;
        return this.raised({ kind: "atom", markup: `<msqrt>${bracket.inner}</msqrt>` });
      }
      if (token.text === "sum" && bracket) return { kind: "atom", markup: row(["<mo>∑</mo>", bracket.markup]) };
      if (bracket) return { kind: "atom", markup: row([GAP, head.markup, bracket.markup]) };
      const takesSymbol = token.text !== "sum" && token.text !== "sqrt";
      if (token.text === "sum" && /operator|number|relation|bracket/.test(this.tokenBefore(start)?.kind)) {
        this.at = close;
        return { kind: "operator", markup: "<mo>∑</mo>" };
      }
      if (takesSymbol && (next.kind === "symbol" || next.kind === "number" || PRODUCTS.has(next.text))) {
        const argument = this.atom();
        return { kind: "atom", markup: row([GAP, head.markup, GAP, argument.markup]) };
      }
      this.at = close;
    }
    this.at = start;
    return null;
  }

  /// All of the product before the stroke over the one factor behind it, as everywhere in mathematics.
  fraction(parts) {
    ++this.at;
    this.skipSpace();
    let below = this.atom();
    if (!below) return false;
    const next = this.list[this.at];
    // "1/3G", "f/g(x)" and "d ln k/d ln P".
    if (below.token?.kind === "number" && next.kind === "symbol") {
      below = { kind: "atom", markup: row([below.markup, this.atom().markup]) };
    } else if (below.token?.text === "d") {
      this.skipSpace();
      if (this.list[this.at].kind === "word") {
        const argument = this.atom();
        if (argument) below = { kind: "atom", markup: row([below.markup, argument.markup]) };
      }
    } else if (below.token?.kind === "symbol" && below.token.text[0] !== "d" && next.text === "(") {
      const argument = this.group();
      if (argument) below = { kind: "atom", markup: row([below.markup, argument.markup]) };
    }
    const above = [];
    while (parts.at(-1)?.kind === "atom") above.unshift(parts.pop());
    if (above.length === 0) return false;
    const plain = (part) => part.bare ?? part.markup;
    const markup = this.stacked
      ? `<mfrac>${above.length === 1 ? plain(above[0]) : row(above.map((part) => part.markup))}${plain(below)}</mfrac>`
      : row([...above.map((part) => part.markup), "<mo>/</mo>", below.markup]);
    // Another stroke later is about what comes after this one.
    parts.push({ kind: "fraction", markup });
    return true;
  }

  /// The parts up to the bracket `closing` or, without one, up to the first word.
  expression(closing) {
    const parts = [];
    for (;;) {
      const before = this.at;
      this.skipSpace();
      const token = this.list[this.at];
      if (closing && token.text === closing && !(closing === "|" && parts.length === 0)) {
        ++this.at;
        return parts;
      }
      if (token.text === "/") {
        if (!this.fraction(parts)) return this.stop(parts, before, closing);
      } else if (token.kind === "operator") {
        ++this.at;
        parts.push({ kind: "operator", markup: `<mo>${token.text === "-" ? "−" : token.text}</mo>`, at: before });
      } else if (token.kind === "relation") {
        ++this.at;
        this.strong = true;
        parts.push({ kind: "relation", markup: `<mo>${escapeHtml(RELATIONS[token.text])}</mo>`, at: before });
      } else if (token.kind === "dots" && parts.at(-1)?.kind === "operator") {
        ++this.at;
        parts.push({ kind: "atom", markup: "<mo>…</mo>" });
      } else if (token.kind === "comma" && closing) {
        ++this.at;
        parts.push({ kind: "operator", markup: "<mo>,</mo>", at: before });
      } else {
        const atom = this.isArticle() ? null : this.atom();
        if (!atom) return this.stop(parts, before, closing);
        parts.push(atom);
      }
    }
  }

  tokenBefore(at) {
    return this.list[this.list[at - 1]?.kind === "space" ? at - 2 : at - 1];
  }

  /// "a" before a word is the article, unless it ends a product.
  isArticle() {
    if (this.list[this.at].text !== "a") return false;
    if (/symbol|number/.test(this.tokenBefore(this.at)?.kind)) return false;
    const [space, next] = this.list.slice(this.at + 1, this.at + 3);
    return space.kind === "space" && next?.kind === "word" && !PRODUCTS.has(next.text) && !FUNCTIONS.has(next.text);
  }

  stop(parts, at, closing) {
    if (closing) return null;
    // An operator that nothing follows belongs to the words.
    while (parts.length && (parts.at(-1).kind === "operator" || parts.at(-1).kind === "relation")) {
      const last = parts.pop();
      at = last.at ?? at;
    }
    this.at = at;
    return parts;
  }

  /// The equation that starts at a token: its markup and the token behind it, or null.
  equation(start) {
    Object.assign(this, { at: start, strong: false, hasSymbol: false });
    const { kind } = this.list[start];
    const isUnit = this.list[start - 1]?.text === "/";
    const isMinusOfWords = kind === "operator" && this.list[start - 2]?.kind === "word";
    if (["space", "relation", "end"].includes(kind) || isUnit || isMinusOfWords) return null;
    const parts = this.expression();
    if (this.at <= start || parts.length === 0 || !this.hasSymbol) return null;
    if (!this.strong && !this.stacked) return null;
    const style = this.stacked ? ' displaystyle="true"' : "";
    const plain = this.list.slice(start, this.at).map((token) => token.text).join("");
    const markup = `<math${style} alttext="${escapeHtml(plain)}">${row(parts.map((part) => part.markup))}</math>`;
    return { markup, end: this.at };
  }
}

/// HTML of `text` with its equations as MathML. `stacked` is for a text of equations: fractions have a bar, and every
/// symbol is one, too; otherwise only what has a relation, a power, a root or an integral.
export function typeset(text, stacked = false) {
  const list = tokens(text);
  const reader = new Reader(list, stacked);
  let html = "";
  for (let at = 0; list[at].kind !== "end"; ) {
    const equation = reader.equation(at);
    const { text } = list[at];
    html += equation?.markup ?? escapeHtml((stacked && RELATIONS[text]) || text);
    at = equation?.end ?? at + 1;
  }
  return html;
}
