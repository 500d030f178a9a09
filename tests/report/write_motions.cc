// write_motions FOLDER: renders the sample motions for the browser test. Each becomes a page, and
// pages that show it in frames as wide as a desktop and as a phone. There a script uses the page as
// a reader would.
#include <iostream>
#include <string>
#include <utility>

#include "comparisons/report/motion_page.h"
#include "framed_page.h"
#include "sample_motion.h"

namespace {

/// Moves the slider, plays for a while, chooses every contact and every setting, clicks the view.
/// The outcome is written on the page, where the test reads it.
constexpr const char* kReader = R"(
if (!page.dataset.frames) return;
const the = (id) => page.querySelector('#' + id);
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const slider = the('time');
slider.value = Math.round(slider.max / 2);
slider.dispatchEvent(new Event('input'));
page.dataset.sliderMoves = String(page.dataset.frame === slider.value);
for (const select of page.querySelectorAll('.player select'))
  for (const option of select.options) {
    select.value = option.value;
    select.dispatchEvent(new Event('change'));
  }
the('see_through').click();
let selected = 0;
page.querySelectorAll('.contact').forEach((button, i) => {
  button.click();
  selected += page.dataset.selected === String(i);
});
page.dataset.contactsSelected = String(selected);
const box = the('view').getBoundingClientRect();
for (const kind of ['pointerdown', 'pointerup'])
  the('view').dispatchEvent(new PointerEvent(kind, {pointerType: 'mouse', pointerId: 1,
    clientX: box.x + box.width / 2, clientY: box.y + box.height / 2}));
the('reset').click();
page.querySelector('[data-chart=use] svg')?.dispatchEvent(new PointerEvent('pointerdown',
  {buttons: 1, clientX: 0}));
page.dataset.chartSeeks = String(page.dataset.frame === '0');
if (slider.max > 0) {
  the('play').click();
  await pause(1500);
}
page.dataset.plays = String(Number(page.dataset.frame) > 0);
)";

}  // namespace

int main(int argc, char** argv) try {
  using namespace softfinger::tests;
  if (argc != 2) {
    std::cerr << "usage: write_motions FOLDER\n";
    return 2;
  }
  const std::string folder = argv[1];
  softfinger::report::MotionPageOptions options;
  options.scene_text = "question = \"...\"\n\n[[body]]\nname = \"box\"\nshape = \"box\"\n";
  options.version = "0.0.0";
  options.command = "softfinger simulate box_in_pinch.toml --output motion";
  for (const auto& [name, recording] :
       {std::pair{"pinch", sample_motion()}, std::pair{"large", large_motion()},
        std::pair{"without_contacts", motion_without_contacts()},
        std::pair{"one_frame", motion_of_one_frame()}, std::pair{"empty", empty_motion()}}) {
    const std::string page = softfinger::report::motion_page(recording, options);
    write_page(folder + "/" + name + ".html", page);
    write_page(folder + "/" + name + "_desktop.html", framed_page(page, 1280, 900, kReader));
    write_page(folder + "/" + name + "_phone.html", framed_page(page, 390, 844, kReader));
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "write_motions: " << error.what() << '\n';
  return 1;
}
