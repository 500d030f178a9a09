#include "comparisons/report/mesh_page.h"

#include <cmath>
#include <sstream>
#include <string>

#include "comparisons/prediction/answer_json.h"
#include "comparisons/report/embedded.h"
#include "comparisons/report/html.h"
#include "comparisons/report/page.h"
#include "comparisons/report/surface_data.h"
#include "softfinger/input/constants.h"

namespace softfinger::report {
namespace {

constexpr std::size_t kMostDrawn = 60000;

/// Rounds to `step`: 0.001 mm, 0.0001 of a unit vector.
Html vector_cells(const Eigen::Vector3d& vector, double step) {
  Html cells;
  for (const double value : vector)
    cells += html("<td>{}</td>", plain(std::round(value / step) * step + 0.0));
  return cells;
}

Html radius_cell(double radius_m) {
  return std::isfinite(radius_m) ? html("<td>{}</td>", significant(1e3 * radius_m))
                                 : Html("<td>flat</td>");
}

/// "usable, ± 4 %; a sharp edge lies in the region"
std::string words_of(const MeshPoint& point) {
  return point.verdict + (point.verdict.empty() || point.doubt.empty() ? "" : "; ") + point.doubt;
}

Html point_table(const std::vector<MeshPoint>& points) {
  Html rows;
  for (const MeshPoint& point : points) {
    rows += html("<tr><th scope=\"row\">{}</th>", point.name) +
            vector_cells(1e3 * point.point_m, 1e-3) + vector_cells(point.normal, 1e-4);
    if (point.fit)
      rows += radius_cell(point.fit->principal.radii_m[0]) +
              radius_cell(point.fit->principal.radii_m[1]) +
              html("<td>{}</td><td>{}</td>", significant(1e3 * point.fit->region_radius_m, 3),
                   significant(1e3 * point.fit->residual_rms_m, 2));
    else
      rows += "<td>–</td><td>–</td><td>–</td><td>–</td>";
    rows += html("<td class=\"words\">{}</td></tr>\n", words_of(point));
  }
  return scrolling_table(
      column_heading("point") + column_heading("x", "mm") + column_heading("y", "mm") +
          column_heading("z", "mm") + column_heading("normal x") + column_heading("y") +
          column_heading("z") + column_heading("radius", "mm") + column_heading("radius", "mm") +
          column_heading("region", "mm") + column_heading("residual", "mm") +
          "<th scope=\"col\" class=\"words\">pressed, and doubts</th>",
      rows);
}

/// The first thing to read: the prediction, a line for each load, or what the mesh is.
Html header(const MeshPage& content) {
  if (!content.prediction)
    return html("<h1>{}</h1>\n<p class=\"lead\">{}</p>\n", content.mesh, content.facts);
  Html lines;
  std::istringstream text(content.prediction->answers);
  for (std::string line; std::getline(text, line);)
    lines += html("<p class=\"{}\">{}</p>\n", line.rfind(' ', 0) == 0 ? "facts" : "lead", line);
  return html("<h1>{}</h1>\n", content.prediction->case_id) + lines +
         html("<p class=\"facts\">{}: {}</p>\n", content.mesh, content.facts);
}

/// Viewer that only a script can fill; hidden without one (mesh.css).
Html viewer() {
  return "<section class=\"viewer\">\n<div class=\"view\"><canvas aria-label=\"The surface in "
         "3-D\">"
         "</canvas><p class=\"scale\" id=\"scale\"></p></div>\n"
         "<div class=\"chosen\"><div class=\"points\" id=\"points\"></div>\n"
         "<h2 id=\"name\"></h2>\n<p class=\"facts\" id=\"facts\"></p>\n"
         "<p><label>region <input id=\"radius\" type=\"range\" min=\"0\" max=\"100\"> "
         "<output id=\"radius_mm\"></output></label></p>\n"
         "<p>For [geometry] of a case:</p>\n<pre id=\"lines\"></pre>\n"
         "<p>The local radii there:</p>\n<pre id=\"command\"></pre>\n"
         "<p class=\"buttons\"><button id=\"copy\" type=\"button\">Copy the line</button> "
         "<button id=\"picture\" type=\"button\">Save the picture (PNG)</button> "
         "<button id=\"reset\" type=\"button\">Reset the view</button></p></div>\n</section>\n";
}

}  // namespace

std::string mesh_page(const TriangleSurface& surface, const MeshPage& content) {
  Html doubts, lines;
  for (const std::string& doubt : content.doubts)
    doubts += html("<p class=\"doubt\">{}</p>\n", doubt);
  Json points = Json::array();
  for (const MeshPoint& point : content.points) {
    if (!point.toml.empty()) lines += html("{}\n", point.toml);
    const auto vector = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
    points.push_back({{"name", point.name},
                      {"point_m", vector(point.point_m)},
                      {"normal", vector(point.normal)},
                      {"toml", point.toml},
                      {"doubt", words_of(point)},
                      {"fit", point.fit ? prediction::to_json(*point.fit) : Json()}});
  }
  const bool is_coarsened = surface.triangles.size() > kMostDrawn;
  const Html body =
      "<header>" + header(content) + doubts + "</header>\n" + viewer() +
      (content.prediction ? html("<h2 id=\"prediction\">The prediction by each model</h2>\n"
                                 "<pre>{}</pre>\n",
                                 content.prediction->numbers)
                          : Html()) +
      (is_coarsened ? html("<p>Drawn coarser than it is, with at most {} triangles; the numbers of "
                           "the table are those of the surface itself.</p>\n",
                           kMostDrawn)
                    : Html()) +
      "<h2 id=\"table\">Points</h2>\n<p>Radii of the quadric that was fitted to the region around "
      "each point, negative where the surface is hollow. A contact of another size has another "
      "region, and other radii: <code>predict</code> fits the region of each load.</p>\n" +
      point_table(content.points) + html("<pre>{}</pre>\n", lines) +
      html(
          "<h2 id=\"provenance\">Where this comes from</h2>\n<dl class=\"provenance\"><dt>version"
          "</dt><dd>{}</dd></dl>\n<p>To repeat it:</p>\n<pre>{}</pre>\n"
          "<details><summary>Licences of the libraries in this file</summary>\n"
          "<pre>three.js\n\n{}</pre></details>\n",
          content.version, content.command, embedded::three_licence);
  return render_page({escape(content.prediction ? content.prediction->case_id : content.mesh),
                      {embedded::report_css, embedded::mesh_css},
                      body,
                      {{"mesh", content.mesh},
                       {"mesh_entries", content.mesh_entries},
                       {"mesh_options", content.mesh_options},
                       {"metres_per_unit", content.metres_per_unit},
                       {"surface", surface_json(split_at_edges(coarsened(surface, kMostDrawn)))},
                       {"points", points}},
                      {embedded::mesh_js}});
}

}  // namespace softfinger::report
