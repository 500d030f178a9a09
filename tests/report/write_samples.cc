// write_samples FOLDER: renders the sample reports for the browser test, each as the page itself
// and inside a frame as narrow as a phone (headless Chromium's window cannot be made that narrow).
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <utility>

#include "comparisons/report/report_page.h"
#include "sample_report.h"

namespace {

void write(const std::string& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content;
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

/// srcdoc keeps the frame in the wrapper's origin: its state can be copied out for --dump-dom.
std::string phone_frame(const std::string& page) {
  std::string quoted;
  quoted.reserve(page.size() + page.size() / 10);
  for (const char c : page) {
    if (c == '&')
      quoted += "&amp;";
    else if (c == '"')
      quoted += "&quot;";
    else
      quoted += c;
  }
  return "<!doctype html><html><body style=\"margin:0\">"
         "<iframe style=\"width:390px;height:844px;border:0\" srcdoc=\"" +
         quoted +
         "\"></iframe><script>"
         "document.querySelector('iframe').addEventListener('load', (event) => {"
         "const inner = event.target.contentDocument.documentElement;"
         "if (location.search === '?full') event.target.style.height = inner.scrollHeight + 'px';"
         // What a reader does: choose every load, then touch every chart.
         "else {"
         "inner.querySelectorAll('.loads button').forEach((button) => button.click());"
         "inner.querySelectorAll('.plot svg').forEach((chart) => {"
         "const box = chart.getBoundingClientRect();"
         "chart.dispatchEvent(new PointerEvent('pointermove', {bubbles: true, pointerType: 'mouse',"
         "clientX: box.x + box.width / 2, clientY: box.y + box.height / 2}));});"
         "}"
         "Object.assign(document.documentElement.dataset, inner.dataset,"
         "{width: String(inner.clientWidth)});"
         "});</script></body></html>";
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::cerr << "usage: write_samples FOLDER\n";
    return 2;
  }
  const std::string folder = argv[1];
  for (const auto& [name, report] : {std::pair{"sample", softfinger::tests::sample_report()},
                                     std::pair{"large", softfinger::tests::large_report(20)}}) {
    const std::string page = softfinger::comparisons::render_report(report);
    write(folder + "/" + name + "_desktop.html", page);
    write(folder + "/" + name + "_phone.html", phone_frame(page));
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "write_samples: " << error.what() << '\n';
  return 1;
}
