#include "framed_page.h"

#include <fstream>
#include <stdexcept>

namespace softfinger::tests {

std::string framed_page(const std::string& page, int width, int height, const std::string& reader) {
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
  // srcdoc keeps the frame in the wrapper's origin: its state can be copied out.
  return "<!doctype html><html><body style=\"margin:0\"><iframe style=\"width:" +
         std::to_string(width) + "px;height:" + std::to_string(height) + "px;border:0\" srcdoc=\"" +
         quoted +
         "\"></iframe><script>"
         "document.querySelector('iframe').addEventListener('load', async (event) => {"
         "const page = event.target.contentDocument.documentElement;"
         "if (location.search === '?full') event.target.style.height = page.scrollHeight + 'px';"
         "else await (async () => {" +
         reader +
         "})();"
         "Object.assign(document.documentElement.dataset, page.dataset,"
         "{width: String(page.clientWidth)});"
         "});</script></body></html>";
}

void write_page(const std::string& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content;
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace softfinger::tests
