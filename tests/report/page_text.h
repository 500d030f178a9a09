#pragma once

#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <string>
#include <utility>

/// Functions with which tests read a page of comparisons/report.
namespace softfinger::tests {

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++count;
  return count;
}

/// The page as a browser without JavaScript has it.
inline std::string without_scripts(std::string page) {
  for (const std::string element : {"script", "style"})
    for (std::size_t from; (from = page.find("<" + element)) != std::string::npos;) {
      const std::size_t to = page.find("</" + element + ">", from);
      if (to == std::string::npos) throw std::runtime_error("unclosed " + element);
      page.erase(from, to + element.size() + 3 - from);
    }
  return page;
}

/// Returns the readable text of markup without scripts: tags and no-break spaces as spaces, a true
/// minus sign as a hyphen, nothing escaped.
inline std::string visible_text(const std::string& markup) {
  std::string text;
  bool inside_tag = false;
  for (const char c : markup) {
    if (c == '<') {
      inside_tag = true;
      text += ' ';
    } else if (c == '>' && inside_tag) {
      inside_tag = false;
    } else if (!inside_tag) {
      text += c;
    }
  }
  // "&amp;" comes last: "&amp;lt;" reads "&lt;".
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"\u00a0", " "},
                                 {"−", "-"},
                                 {"&#39;", "'"},
                                 {"&quot;", "\""},
                                 {"&lt;", "<"},
                                 {"&gt;", ">"},
                                 {"&amp;", "&"}})
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  return text;
}

/// Lines and indentation of the markup as single spaces.
inline std::string in_one_line(const std::string& text) {
  return std::regex_replace(text, std::regex("\\s+"), " ");
}

/// Returns the data that the page hands to its scripts.
inline nlohmann::json chart_data_of(const std::string& page) {
  const std::string open = "id=\"data\">";
  const std::size_t from = page.find(open) + open.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

}  // namespace softfinger::tests
