#include "framed_page.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

namespace softfinger::tests {
namespace {

std::string script(const std::string& name) {
  std::ifstream file(std::string(SCRIPT_FOLDER) + "/" + name);
  if (!file) throw std::runtime_error("cannot read " + name);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

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
  // srcdoc keeps the frame in the wrapper's origin: its state can be copied out. Where no encoding
  // is stated Chromium guesses one from the bytes that have come so far, and the scripts' minus
  // sign is then at times another character than the page's.
  return "<!doctype html><html><meta charset=\"utf-8\"><body style=\"margin:0\"><iframe "
         "style=\"width:" +
         std::to_string(width) + "px;height:" + std::to_string(height) + "px;border:0\" srcdoc=\"" +
         quoted + "\"></iframe><script>" + script("page_checks.js") + script(reader) +
         "document.querySelector('iframe').addEventListener('load', async (event) => {"
         "const page = event.target.contentDocument.documentElement;"
         "if (location.search === '?full') event.target.style.height = page.scrollHeight + 'px';"
         "else await read(page).catch((error) => {"
         "page.dataset.scriptErrors = `the reader: ${error.stack}`.replaceAll('\"', "
         "'').replaceAll('<', '');"
         "});"
         "Object.assign(document.documentElement.dataset, page.dataset,"
         "{width: String(page.clientWidth)});"
         "});</script></body></html>";
}

void write_page(const std::string& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content;
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

void write_framed(const std::string& folder, const std::string& name, const std::string& page,
                  const std::string& reader) {
  const std::string path = folder + "/" + name;
  write_page(path + ".html", page);
  write_page(path + "_desktop.html", framed_page(page, 1280, 900, reader));
  write_page(path + "_phone.html", framed_page(page, 390, 844, reader));
}

}  // namespace softfinger::tests
