// Equations in plain text become MathML with the same meaning, and words stay words.
import assert from "node:assert/strict";
import test from "node:test";
import { typeset } from "../../docs/site/typeset.mjs";

/// MathML in a short notation: {..} is a group of one element, in the order of its parts.
function short(html) {
  return html.replace(/<mspace[^>]*>/g, "").replace(/<(mfrac|msqrt|msup|msub|msubsup)>/g, "$1{").replace(/<\/(mfrac|msqrt|msup|msub|msubsup)>/g, "}")
    .replace(/<math[^>]*>/g, "«").replace(/<\/math>/g, "»").replace(/<mrow>/g, "{").replace(/<\/mrow>/g, "}").replace(/<[^>]*>/g, "");
}
const equations = [
  // A stroke divides the product before it by the one factor behind it.
  ["3 P R'(K - E)/(pi E* m)", "«mfrac{{3P{R′}{({K−E})}}{πmsup{E*}m}}»"],
  ["16/3 G c³", "«{mfrac{163}Gmsup{c3}}»"],
  ["h³/3G", "«mfrac{msup{h3}{3G}}»"],
  ["1 + a/b", "«{1+mfrac{ab}}»"],
  ["(1 - 2 nu)/sqrt(1.1 - 2 nu) d/h", "«{mfrac{{1−2ν}msqrt{{1.1−2ν}}}mfrac{dh}}»"],
  ["w(kh)/(E* k) p_k", "«{mfrac{{w{({kh})}}{msup{E*}k}}msub{pk}}»"],
  ["E/w(x)", "«mfrac{E{w{(x)}}}»"],
  ["d ln k/d ln P", "«mfrac{{d{lnk}}{d{lnP}}}»"],
  ["mu p v/|v|", "«mfrac{{μpv}{|v|}}»"],
  // Roots, powers, bounds of an integral.
  ["p0 sqrt(1 - x²/a²)", "«{msub{p0}msqrt{{1−mfrac{msup{x2}msup{a2}}}}}»"],
  ["(a/b)²", "«msup{{(mfrac{ab})}2}»"],
  ["x^(1/k)", "«msup{x{1/k}}»"],
  ["int_c^a p dr", "«{msubsup{∫ca}p{dr}}»"],
  ["1 - sum g_i", "«{1−∑msub{gi}}»"],
  // Words, articles and units are none.
  ["gap = x, the sum of two", "gap = «x», the sum of two"],
  ["a blend of two, a and b", "a blend of two, a and «b»"],
  ["e.g. T = E", "e.g. «{T=E}»"],
  ["u >= d", "«{u≥d}»"],
];
for (const [plain, expected] of equations) {
  test(plain, () => assert.equal(short(typeset(plain, true)), expected));
}

const prose = [
  ["is right for foam (nu = 0).", "is right for foam («{ν=0}»)."],
  ["s = sqrt(ab)/h is the size", "«{s={msqrt{{ab}}/h}}» is the size"],
  ["at 1000 kg/m³, 0.2 mm² & more", "at 1000 kg/m³, 0.2 mm² &amp; more"],
  ["a finger of 2 N, version 0.1.0, 1e-10 or less", "a finger of 2 N, version 0.1.0, 1e-10 or less"],
  ["and/or a/b", "and/or a/b"],
  ["sticks from mu of 0.33 (nu = 0.3) on", "sticks from mu of 0.33 («{ν=0.3}») on"],
  ["1 & 2 <of> 3", "1 &amp; 2 &lt;of&gt; 3"],
];
for (const [plain, expected] of prose) {
  test(plain, () => assert.equal(short(typeset(plain)), expected));
}
