// What a person would see wrong on a page, for the browser tests: words on other words or cut off,
// words too faint to read, marks that are not where the data say. framed_page.cc puts this beside a
// page that a frame shows; `page` is the framed document's element. Nothing of it is in the page.
"use strict";

const pageChecks = (page) => {
  const view = page.ownerDocument.defaultView;
  const found = {overlaps: new Set(), cut: new Set(), unreadable: new Set(), misplaced: new Set()};
  const all = (selector, root = page) => [...root.querySelectorAll(selector)];
  const inTip = (element) => element.closest('[aria-label="tip"]');
  const memo = (make) => {
    const known = new Map();
    return (key) => known.get(key) ?? known.set(key, make(key)).get(key);
  };

  // Words and where they are ------------------------------------------------------------------------

  // The window through which an element is seen: boxes that scroll hide what lies beyond them.
  const intersection = (one, other) => ({
    left: Math.max(one.left, other.left), right: Math.min(one.right, other.right),
    top: Math.max(one.top, other.top), bottom: Math.min(one.bottom, other.bottom),
  });
  const EVERYWHERE = {left: -Infinity, right: Infinity, top: -Infinity, bottom: Infinity};
  const windows = () => {
    const seen = memo((element) => {
      if (!element || element === page) return EVERYWHERE;
      const beyond = seen(element.parentElement);
      const scrolls = view.getComputedStyle(element).overflowX !== "visible" && !(element instanceof view.SVGElement);
      return scrolls ? intersection(beyond, element.getBoundingClientRect()) : beyond;
    });
    return seen;
  };
  // What a closed <details> hides has boxes all the same.
  const hidden = (element) => {
    const details = element.closest("details:not([open])");
    return details && element.closest("summary")?.parentElement !== details;
  };
  function textNodes() {
    const walker = page.ownerDocument.createTreeWalker(page.querySelector("body"), view.NodeFilter.SHOW_TEXT);
    const nodes = [];
    while (walker.nextNode())
      if (walker.currentNode.data.trim() && !walker.currentNode.parentElement.closest("script, style, svg") && !hidden(walker.currentNode.parentElement)) nodes.push(walker.currentNode);
    return nodes;
  }
  function words() {
    const seenThrough = windows();
    const list = [];
    const add = (text, box, element, picture) => {
      const shown = intersection(box, seenThrough(element));
      if (shown.right - shown.left > 1 && shown.bottom - shown.top > 1) list.push({text: text.trim().slice(0, 40), picture, owner: element, ...shown});
    };
    const range = page.ownerDocument.createRange();
    for (const node of textNodes()) {
      range.selectNodeContents(node);
      for (const box of range.getClientRects()) add(node.data, box, node.parentElement, null);
    }
    for (const text of all("svg text"))
      if (text.textContent && !inTip(text) && !hidden(text)) add(text.textContent, text.getBoundingClientRect(), text, text.closest("svg"));
    return list;
  }
  // Boxes of letters are higher than their ink: neighbouring lines may share a few pixels.
  function collide(one, other) {
    const across = Math.min(one.right, other.right) - Math.max(one.left, other.left);
    const down = Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top);
    const height = Math.min(one.bottom - one.top, other.bottom - other.top);
    return across > 1 && down > (one.picture && other.picture ? 2 : Math.max(2, 0.3 * height));
  }
  // `after` says what was pressed before.
  function lookAtLabels(after) {
    const list = words().sort((one, other) => one.top - other.top);
    list.forEach((one, i) => {
      for (let k = i + 1; k < list.length && list[k].top < one.bottom; ++k)
        if (one.owner !== list[k].owner && collide(one, list[k])) found.overlaps.add(`${one.text} on ${list[k].text} after ${after}`);
      const frame = one.picture?.getBoundingClientRect();
      if (one.left < -1 || one.right > page.clientWidth + 1 ||
          (frame && (one.left < frame.left - 1 || one.right > frame.right + 1 || one.top < frame.top - 1 || one.bottom > frame.bottom + 1)))
        found.cut.add(`${one.text} in ${one.owner.closest("figure")?.dataset.chart} after ${after}`);
    });
    if (page.scrollWidth > page.clientWidth) found.cut.add(`the page after ${after}`);
    return list.length;
  }

  // Contrast (WCAG 2.2, 1.4.3 asks for 4.5) ---------------------------------------------------------

  const channels = (colour) => {
    const [r, g, b, alpha = 1] = colour.match(/[\d.]+/g).map(Number);
    return {rgb: [r, g, b], alpha};
  };
  const over = (front, alpha, behind) => front.map((part, i) => alpha * part + (1 - alpha) * behind[i]);
  const luminance = (rgb) => rgb.map((part) => part / 255)
    .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4))
    .reduce((sum, part, i) => sum + [0.2126, 0.7152, 0.0722][i] * part, 0);
  const contrast = (one, other) => {
    const [dark, light] = [luminance(one), luminance(other)].sort((a, b) => a - b);
    return (light + 0.05) / (dark + 0.05);
  };
  const backgrounds = () => {
    const behind = memo((element) => {
      if (!element) return [255, 255, 255];
      const {rgb, alpha} = channels(view.getComputedStyle(element).backgroundColor);
      return alpha === 1 ? rgb : over(rgb, alpha, behind(element.parentElement));
    });
    return behind;
  };
  function lookAtColours() {
    const behind = backgrounds();
    const opacity = memo((element) => (element ? Number(view.getComputedStyle(element).opacity) * opacity(element.parentElement) : 1));
    const owners = new Set([...textNodes().map((node) => node.parentElement), ...all("svg text").filter((text) => text.textContent && !inTip(text))]);
    let looked = 0;
    for (const owner of owners) {
      if (!owner.getClientRects().length || owner.closest(":disabled")) continue;
      const style = view.getComputedStyle(owner), drawn = owner.tagName === "text";
      const {rgb, alpha} = channels(drawn ? style.fill : style.color);
      const seen = over(rgb, alpha * opacity(owner) * (drawn ? Number(style.fillOpacity) : 1), behind(owner));
      const ratio = contrast(seen, behind(owner));
      ++looked;
      if (ratio < 4.5) found.unreadable.add(`${owner.textContent.trim().slice(0, 40)} (${ratio.toFixed(1)})`);
    }
    return looked;
  }
  const isDark = () => luminance(backgrounds()(page.querySelector("body"))) < 0.1;

  // Marks against the data --------------------------------------------------------------------------

  // 1.5 from "1.5", 1000 from "1 µs" (in ns), 0.01 from "1 %".
  const UNITS = {"": 1, "%": 0.01, ns: 1, µs: 1e3, ms: 1e6, s: 1e9};
  const valueOf = (label) => {
    const [, digits, unit] = label.replace("−", "-").replaceAll(",", "").match(/^(-?[\d.]+(?:e[+-]?\d+)?) ?(\D*)$/) ?? [];
    return digits === undefined || !(unit in UNITS) ? NaN : Number(digits) * UNITS[unit];
  };
  // Where a value lies on an axis, in the picture's units, read off the words at its ticks.
  // `plain`: an axis that Plot drew, not charts.js.
  function axisOf(svg, name, {log = false, plain = false} = {}) {
    const [anchor, shift, coordinate] = name === "x" ? ["middle", ".71em", "x"] : ["end", ".32em", "y"];
    const texts = all(plain ? `g[aria-label="${name}-axis tick label"] text` : `text[text-anchor="${anchor}"][dy="${shift}"]`, svg);
    const placeOf = (text) => (plain ? Number(text.getAttribute("transform").match(/-?[\d.]+/g)[name === "x" ? 0 : 1]) : Number(text.getAttribute(coordinate)));
    const ticks = texts.map((text) => ({value: valueOf(text.textContent), at: placeOf(text)})).filter((tick) => Number.isFinite(tick.value));
    const [one, other] = [ticks[0], ticks.at(-1)];
    const along = log ? Math.log : (v) => v;
    const per = ticks.length > 1 ? (other.at - one.at) / (along(other.value) - along(one.value)) : NaN;
    return {per, place: (v) => one.at + per * (along(v) - along(one.value))};
  }
  let placed = 0;
  // `seen` and `wanted` in the picture's units, which are pixels.
  function expectPlace(what, seen, wanted, within = 1) {
    ++placed;
    if (seen.length !== wanted.length || !seen.every((at, i) => Math.abs(at - wanted[i]) <= within))
      found.misplaced.add(`${what} at ${seen.map((at) => at.toFixed(1))} not ${wanted.map((at) => at.toFixed(1))}`);
  }
  const pointsOf = (path) => path.getAttribute("d").match(/-?[\d.]+(?:e-?\d+)?,-?[\d.]+(?:e-?\d+)?/g).map((pair) => pair.split(",").map(Number));

  // Each chart is touched in its middle, which opens a tip.
  function touchCharts() {
    for (const chart of all(".plot svg")) {
      const box = chart.getBoundingClientRect();
      chart.dispatchEvent(new PointerEvent("pointermove", {bubbles: true, pointerType: "mouse",
        clientX: box.x + box.width / 2, clientY: box.y + box.height / 2}));
    }
  }

  function state() {
    const dataset = page.dataset;
    for (const [name, set] of Object.entries(found))
      dataset[name] = [...set].slice(0, 4).join("; ").replaceAll('"', "").replaceAll("<", "") || "none";
    dataset.placed = String(placed);
    dataset.dark = String(isDark());
  }

  return {all, lookAtLabels, lookAtColours, axisOf, expectPlace, pointsOf, touchCharts, state};
};
