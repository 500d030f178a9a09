#include "page.h"

#include "embedded.h"
#include "html.h"

namespace softfinger::comparisons {

std::string render_page(const Page& page) {
  std::string styles, scripts;
  for (const std::string_view style : page.styles) styles.append(style) += "\n";
  for (const std::string_view script : page.scripts)
    scripts.append("<script>").append(script) += "</script>\n";
  return filled(embedded::page_html, {{"title", page.title},
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

}  // namespace softfinger::comparisons
