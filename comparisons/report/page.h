#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "comparisons/report/embedded.h"
#include "comparisons/report/html.h"

namespace softfinger::report {

/// The parts that are filled into page.html, the skeleton of all pages. As a second line of
/// defence, the page's Content-Security-Policy lets only `scripts` run, by their hashes, and allows
/// nothing to be loaded.
struct Page {
  Html title;
  std::vector<std::string_view> styles;
  Html body;
  Json data;  ///< for the scripts: document.getElementById("data")
  std::vector<embedded::Script> scripts;
  bool runs_wasm = false;  ///< one of the scripts contains WebAssembly, and may compile it
};
/// The text of the page's file.
std::string render_page(const Page& page);

/// JSON that is safe inside a script element, whatever its strings contain.
std::string script_json(const Json& data);

/// Heading, facts, command to repeat it and licences of the libraries: the end of every page.
/// @param rows  `<dt>..</dt><dd>..</dd>`
/// @param command  as typed; may be empty
Html provenance_section(const Html& rows, const std::string& command, const Html& remark);

}  // namespace softfinger::report
