#include "comparisons/report/page.h"

#include <map>

#include "comparisons/text/base64.h"

namespace softfinger::report {
namespace {

/// A page's skeleton with every {{key}} replaced by its part. What is inserted is never searched
/// for keys. @throws std::out_of_range for a key without a part.
std::string filled(std::string_view skeleton,
                   const std::map<std::string_view, std::string_view>& parts) {
  std::size_t size = skeleton.size();
  for (const auto& part : parts) size += part.second.size();
  std::string page;
  page.reserve(size);
  for (std::size_t open; (open = skeleton.find("{{")) != std::string_view::npos;) {
    const std::size_t close = skeleton.find("}}", open);
    if (close == std::string_view::npos) break;
    page += skeleton.substr(0, open);
    page += parts.at(skeleton.substr(open + 2, close - open - 2));
    skeleton.remove_prefix(close + 2);
  }
  page += skeleton;
  return page;
}

}  // namespace

std::string script_json(const Json& data) {
  // A replaced byte is better than no page when a file name was not UTF-8.
  const std::string plain = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  out.reserve(plain.size());
  for (const char c : plain) {
    // "<" occurs in strings only; escaped, neither </script> nor <!-- can end the element.
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

std::string render_page(const Page& page) {
  std::string styles, scripts, hashes;
  for (const std::string_view style : page.styles) styles.append(style) += "\n";
  const auto element = [&hashes](const embedded::Script& script) {
    hashes += " 'sha256-" + text::base64(script.sha256) + "'";
    return std::string("<script>").append(script.text) + "</script>\n";
  };
  const std::string first_script = element(embedded::page_js);
  for (const embedded::Script& script : page.scripts) scripts += element(script);
  // Charts set styles on their elements.
  const std::string policy = "default-src 'none'; script-src" + hashes +
                             (page.runs_wasm ? " 'wasm-unsafe-eval'" : "") +
                             "; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";
  const std::string data = script_json(page.data);
  return filled(embedded::page_html, {{"title", page.title.markup()},
                                      {"policy", policy},
                                      {"first_script", first_script},
                                      {"css", styles},
                                      {"body", page.body.markup()},
                                      {"data", data},
                                      {"scripts", scripts}});
}

Html provenance_section(const Html& rows, const std::string& command, const Html& remark) {
  Html out = html(
      "<h2 id=\"provenance\">Where this comes from</h2>\n<dl class=\"provenance\">{}</dl>\n", rows);
  if (!command.empty()) out += html("<p>To repeat it:</p>\n<pre>{}</pre>\n", command);
  return out + remark +
         html(
             "<details><summary>Licences of the chart libraries in this file</summary>\n<pre>{}"
             "</pre></details>\n",
             embedded::licences);
}

}  // namespace softfinger::report
