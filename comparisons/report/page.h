#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "comparisons/report/embedded.h"

namespace softfinger::report {

/// What fills the skeleton page.html that all pages share. Everything is taken as it is: texts must
/// have been escaped, `data` come from `script_json`. Should a text have slipped through, the
/// page's policy (Content-Security-Policy) lets nothing run but `scripts`, which it knows by their
/// hashes, and nothing be loaded from anywhere.
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
