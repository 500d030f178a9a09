// write_samples FOLDER: renders the sample reports for the browser test, each as the page itself
// and inside a frame as narrow as a phone.
#include <iostream>
#include <string>
#include <utility>

#include "comparisons/report/report_page.h"
#include "framed_page.h"
#include "sample_report.h"

namespace {

/// What a reader does: choose every load, then touch every chart.
constexpr const char* kReader = R"(
page.querySelectorAll('.loads button').forEach((button) => button.click());
page.querySelectorAll('.plot svg').forEach((chart) => {
  const box = chart.getBoundingClientRect();
  chart.dispatchEvent(new PointerEvent('pointermove', {bubbles: true, pointerType: 'mouse',
    clientX: box.x + box.width / 2, clientY: box.y + box.height / 2}));
});
)";

}  // namespace

int main(int argc, char** argv) try {
  using namespace softfinger::tests;
  if (argc != 2) {
    std::cerr << "usage: write_samples FOLDER\n";
    return 2;
  }
  const std::string folder = argv[1];
  for (const auto& [name, report] :
       {std::pair{"sample", sample_report()}, std::pair{"large", large_report(20)}}) {
    const std::string page = softfinger::comparisons::render_report(report);
    write_page(folder + "/" + name + "_desktop.html", page);
    write_page(folder + "/" + name + "_phone.html", framed_page(page, 390, 844, kReader));
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "write_samples: " << error.what() << '\n';
  return 1;
}
