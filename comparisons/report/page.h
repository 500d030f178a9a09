#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "comparisons/report/embedded.h"

namespace softfinger::report {

/// The parts that are filled into page.html, the skeleton of all pages. They are inserted
/// unchanged: texts must have been escaped, and `data` must come from `script_json`. As a second
/// line of defence, the page's Content-Security-Policy lets only `scripts` run, by their hashes,
/// and allows nothing to be loaded.
struct Page {
  std::string title;
  std::vector<std::string_view> styles;
  std::string body;
  std::string data;  ///< for the scripts: document.getElementById("data")
  std::vector<embedded::Script> scripts;
};
std::string render_page(const Page& page);

/// Heading, facts, command to repeat it and licences of the libraries: the end of every page.
/// @param rows  `<dt>..</dt><dd>..</dd>`, escaped
/// @param command  as typed, not escaped; may be empty
std::string provenance_section(const std::string& rows, const std::string& command,
                               const std::string& remark);

}  // namespace softfinger::report
