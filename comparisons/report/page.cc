#include "comparisons/report/page.h"

#include "comparisons/report/html.h"
#include "comparisons/text/base64.h"

namespace softfinger::report {

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
                             "; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";
  return filled(embedded::page_html, {{"title", page.title},
                                      {"policy", policy},
                                      {"first_script", first_script},
                                      {"css", styles},
                                      {"body", page.body},
                                      {"data", page.data},
                                      {"scripts", scripts}});
}

std::string provenance_section(const std::string& rows, const std::string& command,
                               const std::string& remark) {
  std::string out = "<h2 id=\"provenance\">Where this comes from</h2>\n<dl class=\"provenance\">" +
                    rows + "</dl>\n";
  if (!command.empty()) out += "<p>To repeat it:</p>\n<pre>" + escape(command) + "</pre>\n";
  return out + remark +
         "<details><summary>Licences of the chart libraries in this file</summary>\n<pre>" +
         escape(embedded::licences) + "</pre></details>\n";
}

}  // namespace softfinger::report
