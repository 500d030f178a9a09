// What both parts of the page of `softfinger explore` use: the library (explorer.wasm), sliders, numbers, pictures.
import {axisBottom, axisLeft} from "d3-axis";
import {scaleLinear} from "d3-scale";
import {select} from "d3-selection";
import {line} from "d3-shape";
import wasm from "softfinger-explorer";

export const the = (id) => document.getElementById(id);
export const all = (selector) => [...document.querySelectorAll(selector)];

// The library ----------------------------------------------------------------------------------------

// It has no files, no environment and nothing to print: what its C library asks of a system is refused.
export async function load() {
  const refused = new Proxy({}, {get: (_, name) => () => { throw new Error(`the library called ${String(name)}`); }});
  const module = await WebAssembly.compile(wasm);
  const imports = {};
  for (const {module: from, name} of WebAssembly.Module.imports(module)) (imports[from] ??= {})[name] = refused[name];
  const {exports} = await WebAssembly.instantiate(module, imports);
  exports._initialize();
  const pose = (numbers, place = exports.question()) => new Float64Array(exports.memory.buffer, place, numbers.length).set(numbers);
  const words = new TextDecoder();
  const read = (start) => {
    const bytes = new Uint8Array(exports.memory.buffer, start);
    return JSON.parse(words.decode(bytes.subarray(0, bytes.indexOf(0))));
  };
  return {
    ask(numbers) {
      pose(numbers);
      return read(exports.answer());
    },
    askPad(numbers) {
      pose(numbers, exports.pad_question());
      return read(exports.pad_answer());
    },
    // Nanoseconds of one prediction; null where the clock is too coarse to tell.
    time(numbers, model) {
      pose(numbers);
      const calls = 20000;
      const times = [0, 1, 2].map(() => {
        const start = performance.now();
        exports.repeat(model, calls);
        return performance.now() - start;
      });
      const least = Math.min(...times);
      return least > 0 ? 1e6 * least / calls : null;
    },
  };
}

// Sliders --------------------------------------------------------------------------------------------

const three = (value) => Number(value.toPrecision(3));
export const ofSlider = ({low, high, logarithmic}, position) =>
  three(logarithmic ? low * (high / low) ** (position / 1000) : low + (high - low) * position / 1000);
const toSlider = ({low, high, logarithmic}, value) => Math.round(1000 *
  Math.min(1, Math.max(0, logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low))));
export const allowed = ({least, largest, logarithmic}, value) =>
  Number.isFinite(value) && value <= largest && (logarithmic ? value > least : value >= least);

// A number that is being typed is left alone.
export function showSliders(sliders, state, prefix = "") {
  for (const slider of sliders) {
    const value = state[slider.key], typed = the(`${prefix}${slider.key}_typed`), range = the(`${prefix}${slider.key}`);
    if (document.activeElement !== typed) {
      typed.value = String(value);
      typed.removeAttribute("aria-invalid");
    }
    if (document.activeElement !== range || ofSlider(slider, Number(range.value)) !== value) range.value = String(toSlider(slider, value));
    range.setAttribute("aria-valuetext", `${value} ${slider.unit}`.trim());
  }
}
// set(key, value) as a number changes; then soon(), and settled() once it is chosen.
export function listenToSliders(sliders, {set, soon, settled}, prefix = "") {
  for (const slider of sliders) {
    const range = the(`${prefix}${slider.key}`), typed = the(`${prefix}${slider.key}_typed`);
    range.addEventListener("input", () => {
      set(slider.key, ofSlider(slider, Number(range.value)));
      soon();
    });
    range.addEventListener("change", settled);
    typed.addEventListener("input", () => {
      const value = typed.value === "" ? NaN : Number(typed.value), fits = allowed(slider, value);
      typed.setAttribute("aria-invalid", String(!fits));
      if (!fits) return;
      set(slider.key, value);
      soon();
    });
    typed.addEventListener("change", settled);
    typed.addEventListener("blur", soon);
  }
}

// Numbers as people read them --------------------------------------------------------------------------

export const number = (value) => {
  if (value === null || value === undefined) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-4 ? String(Number(value.toPrecision(4)).toExponential()).replace("e+", "e") : String(Number(value.toPrecision(4)));
};
export const percent = (ratio) => {
  if (ratio >= 10) return "> 1000 %";
  return `${Number((100 * ratio).toPrecision(ratio < 0.1 ? 2 : 3))} %`;
};
export const duration = (ns) => (ns === null || ns === undefined ? "–" : ns < 1000 ? `${Number(ns.toPrecision(2))} ns` : `${Number((ns / 1000).toPrecision(2))} µs`);

export const write = (element, text) => {
  if (element.textContent !== text) element.textContent = text;
};
export const sentence = (words) => words && words[0].toUpperCase() + words.slice(1) + ".";

export function copy(button, text) {
  const label = button.dataset.label ??= button.textContent;
  const say = (words) => {
    button.textContent = words;
    setTimeout(() => { button.textContent = label; }, 1500);
  };
  // Pages from files may lack the clipboard.
  (navigator.clipboard?.writeText(text) ?? Promise.reject()).then(() => say("Copied"), () => say("Select and copy by hand"));
}

// Pictures -------------------------------------------------------------------------------------------

export class Picture {
  constructor(name, {height, left}) {
    this.box = document.querySelector(`[data-chart="${name}"] .plot`);
    this.margin = {left, right: 24, top: 24, bottom: 40};
    this.height = height;
    this.svg = select(this.box).append("svg").attr("role", "img").attr("height", height);
    [this.across, this.up, this.marks] = [0, 1, 2].map(() => this.svg.append("g"));
    this.labels = {
      x: this.svg.append("text").attr("text-anchor", "end").attr("y", height - 4),
      y: this.svg.append("text").attr("x", 0).attr("y", 12),
    };
    this.paths = new Map();
  }
  fit(width) {
    this.width = width;
    this.svg.attr("width", width);
    this.labels.x.attr("x", width - 2);
  }
  describe(words) { this.svg.attr("aria-label", words); }
  axes(xDomain, yDomain, xLabel, yLabel) {
    const {left, right, top, bottom} = this.margin, [width, height] = [this.width, this.height];
    this.x = scaleLinear(xDomain, [left, width - right]);
    this.y = scaleLinear(yDomain, [height - bottom, top]);
    const ticks = Math.max(2, Math.min(6, Math.floor((width - left - right) / 60)));
    // Short words even where a number is not: "2e8" for 200,000,000.
    const short = (scale) => (scale.domain()[1] >= 1e4 || scale.domain()[1] < 1e-2 ? (value) => number(Number(value.toPrecision(12))) : null);
    this.across.attr("transform", `translate(0,${height - bottom})`)
      .call(axisBottom(this.x).ticks(ticks).tickFormat(short(this.x)).tickSize(top + bottom - height).tickPadding(8));
    this.up.attr("transform", `translate(${left},0)`)
      .call(axisLeft(this.y).ticks(5).tickFormat(short(this.y)).tickSize(left + right - width).tickPadding(8));
    this.labels.x.text(xLabel);
    this.labels.y.text(yLabel);
  }
  begin() { this.unused = new Set(this.paths.keys()); }
  path(name, d, attributes) {
    if (!this.paths.has(name)) this.paths.set(name, this.marks.append("path").attr("fill", "none").attr("data-path", name));
    const path = this.paths.get(name);
    path.attr("d", d);
    for (const [key, value] of Object.entries(attributes)) path.attr(key, value);
    this.unused.delete(name);
    this.marks.node().append(path.node());  // in the order of drawing
  }
  points(name, list, attributes) {
    this.path(name, line((p) => this.x(p[0]), (p) => this.y(p[1]))(list), attributes);
  }
  end() {
    for (const name of this.unused) {
      this.paths.get(name).remove();
      this.paths.delete(name);
    }
  }
  clear() {
    this.begin();
    this.end();
  }
}
// The smallest of 1, 2, 5, 10 .. that is not below: a picture that grows while a slider moves keeps its scale for a while.
export const roundUp = (value) => {
  const decade = 10 ** Math.floor(Math.log10(value));
  return [1, 1.5, 2, 3, 5, 7, 10].map((m) => m * decade).find((top) => top >= value * (1 - 1e-12)) ?? value;
};
