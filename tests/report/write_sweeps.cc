// write_sweeps FOLDER: renders sample sweeps for the browser test, each in a frame as wide as a
// desk's screen and as narrow as a phone.
#include <iostream>
#include <string>
#include <utility>

#include "comparisons/report/sweep_page.h"
#include "framed_page.h"
#include "sample_sweep.h"

namespace {

/// What a reader does: press every button, choose every axis, move every slider, touch every
/// picture. After each: is a word on another or cut off, does a point lie outside its picture?
constexpr const char* kReader = R"(
const state = page.dataset;
const all = (selector) => [...page.querySelectorAll(selector)];
const problems = {overlaps: new Set(), cut: new Set(), astray: new Set()};
const look = (after) => {
  for (const svg of all('.plot svg')) {
    const frame = svg.getBoundingClientRect();
    const words = [...svg.querySelectorAll('text')].filter((text) => text.textContent && !text.closest('[aria-label="tip"]'))
      .map((text) => ({text: text.textContent, box: text.getBoundingClientRect()}));
    words.forEach(({text, box}, i) => {
      if (box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1)
        problems.cut.add(`${text} after ${after}`);
      for (const other of words.slice(i + 1))
        if (box.left < other.box.right - 1 && other.box.left < box.right - 1 && box.top < other.box.bottom - 2 && other.box.top < box.bottom - 2)
          problems.overlaps.add(`${text} on ${other.text} after ${after}`);
    });
    for (const path of svg.querySelectorAll('path.cells, path.points'))
      if (/NaN|Infinity/.test(path.getAttribute('d'))) problems.astray.add(after);
  }
  if (page.scrollWidth > page.clientWidth) problems.cut.add(`the page after ${after}`);
};

// Where the first line of the first picture lies, read off the axes: 2 mN m (h/mm)^(1/2) P/N is a straight
// line from 1.414 to 4.472 on logarithmic axes.
const tickPlaces = (svg, anchor) => [...svg.querySelectorAll('text')]
  .filter((text) => text.getAttribute('text-anchor') === anchor && /^[\d.]+$/.test(text.textContent))
  .map((text) => ({value: Number(text.textContent), at: Number(text.getAttribute(anchor === 'middle' ? 'x' : 'y'))}));
const placeOf = (ticks, value) => {
  const [one, other] = [ticks[0], ticks.at(-1)];
  return one.at + (other.at - one.at) * Math.log(value / one.value) / Math.log(other.value / one.value);
};
const svg = page.querySelector('.plot svg'), dots = svg?.querySelector('path.points');
if (state.picture === 'curves' && dots) {
  const numbers = dots.getAttribute('d').match(/[-\d.]+,[-\d.]+/g).map((pair) => pair.split(',').map(Number));
  const [x, y] = [tickPlaces(svg, 'middle'), tickPlaces(svg, 'end')];
  const near = (a, b) => Math.abs(a - b) < 1;
  state.marksOnLine = String(numbers.length > 1 && x.length > 1 && y.length > 1 && numbers.every(([px, py], i) => {
    const thickness = 0.5 * 10 ** (i / (numbers.length - 1));
    return near(px, placeOf(x, thickness)) && near(py, placeOf(y, 2 * Math.sqrt(thickness)));
  }));
}
// Words on the page, light or dark: WCAG asks for a contrast of 4.5.
const luminance = (colour) => colour.match(/[\d.]+/g).slice(0, 3).map((part) => part / 255)
  .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4))
  .reduce((sum, part, i) => sum + [0.2126, 0.7152, 0.0722][i] * part, 0);
const styleOf = (element) => page.ownerDocument.defaultView.getComputedStyle(element);
const behind = luminance(styleOf(page.querySelector('body')).backgroundColor);
state.dark = String(behind < 0.1);
state.readable = String(all('.plot text, .plot h4, #controls span, figcaption').every((words) => {
  const style = styleOf(words), before = luminance(words.tagName === 'text' ? style.fill : style.color);
  return (Math.max(before, behind) + 0.05) / (Math.min(before, behind) + 0.05) >= 4.5;
}));
state.firstPicture = state.picture;
state.firstMarks = state.marks;
look('opening');
const press = () => all('#controls button').map((button) => button.dataset.name);
const find = (name) => all('#controls button, #controls select').find((control) => control.dataset.name === name);
// Twice: what the one takes away, the other brings back.
for (const name of [...press(), ...press()]) {
  find(name)?.click();
  look(name);
  for (const label of all('#controls select').map((select) => select.dataset.name))
    for (const {value} of [...(find(label)?.options ?? [])]) {
      const select = find(label);
      if (!select || select.value === value) continue;
      select.value = value;
      select.dispatchEvent(new Event('change', {bubbles: true}));
      look(`${label} ${value}`);
      if (Number(state.marks) > 5000) break;
    }
  if (performance.now() > 60000) break;
}
for (const input of all('#controls input'))
  for (const value of [input.max, input.min]) {
    input.value = value;
    input.dispatchEvent(new Event('input', {bubbles: true}));
    look('a slider');
  }
for (const chart of all('.plot svg')) {
  const box = chart.getBoundingClientRect();
  chart.dispatchEvent(new PointerEvent('pointermove', {bubbles: true, pointerType: 'mouse',
    clientX: box.x + box.width / 2, clientY: box.y + box.height / 2}));
}
for (const [name, found] of Object.entries(problems)) state[name] = [...found].slice(0, 4).join('; ').replaceAll('"', '') || 'none';
)";

}  // namespace

int main(int argc, char** argv) try {
  using namespace softfinger::tests;
  if (argc != 2) {
    std::cerr << "usage: write_sweeps FOLDER\n";
    return 2;
  }
  const std::string folder = argv[1];
  for (const auto& [name, sweep] :
       {std::pair{"one_key", sweep_of_one_key()}, std::pair{"with_fem", sweep_with_fem()},
        std::pair{"one_key_fem", sweep_of_one_key_with_fem()},
        std::pair{"three_keys", sweep_of_three_keys()}, std::pair{"zipped", sweep_of_zipped_keys()},
        std::pair{"awkward", sweep_of_awkward_keys()}, std::pair{"random", sweep_at_random()},
        std::pair{"one_row", sweep_of_one_row()}, std::pair{"nothing", sweep_without_answers()}}) {
    const std::string page = softfinger::report::render_sweep(sweep);
    write_page(folder + "/" + name + ".html", page);
    write_page(folder + "/" + name + "_desktop.html", framed_page(page, 1280, 900, kReader));
    write_page(folder + "/" + name + "_phone.html", framed_page(page, 390, 844, kReader));
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "write_sweeps: " << error.what() << '\n';
  return 1;
}
