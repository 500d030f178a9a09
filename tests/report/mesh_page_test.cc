#include "comparisons/report/mesh_page.h"

#include <gtest/gtest.h>

#include <cmath>

#include "comparisons/report/surface_data.h"
#include "from_base64.h"
#include "page_text.h"
#include "sample_mesh.h"

namespace softfinger::report {
namespace {

using tests::contains;
using tests::without_scripts;

TEST(MeshPage, SaysWithoutScriptsWhatItsPointsAre) {
  const std::string text =
      without_scripts(mesh_page(tests::sample_surface(), tests::sample_mesh_page()));
  for (const char* part :
       {"<h1>tip &lt;1&gt;.stl</h1>", "Closed.", "24 mm wide", "<th scope=\"row\">-y</th>",
        "<td>-7</td>", "no quadric: too few vertices",
        "finger = { mesh = &quot;tip &lt;1&gt;.stl&quot;, point_mm = [0, -7, 0]",
        "softfinger mesh tip.stl --page tip.html", "three.js"})
    EXPECT_TRUE(contains(text, part)) << part;
  EXPECT_FALSE(contains(text, "<1>"));
}

TEST(MeshPage, OfAPredictionBeginsWithIt) {
  MeshPage content = tests::sample_mesh_page();
  content.prediction = {"my_finger", "2 N: torque 2.98 mN·m ± 3 %\n  mu + 10 %: +10 %\n",
                        "  usable  2a mm\n"};
  const std::string text = without_scripts(mesh_page(tests::sample_surface(), content));
  for (const char* part : {"<h1>my_finger</h1>\n<p class=\"lead\">2 N: torque 2.98 mN·m ± 3 %</p>",
                           "<p class=\"facts\">  mu + 10 %: +10 %</p>",
                           "<pre>  usable  2a mm\n</pre>", "tip &lt;1&gt;.stl: Closed."})
    EXPECT_TRUE(contains(text, part)) << part;
}

TEST(MeshPage, DrawsALargeSurfaceCoarser) {
  // 4 * 128² triangles and more.
  const TriangleSurface fine =
      meshes::triangulated_ellipsoid({12e-3, 7e-3, 14e-3}, Eigen::Vector3d::Zero(), 256);
  ASSERT_GT(fine.triangles.size(), 60000u);
  const std::string page = mesh_page(fine, tests::sample_mesh_page());
  EXPECT_TRUE(contains(page, "Drawn coarser"));
  EXPECT_FALSE(
      contains(mesh_page(tests::sample_surface(), tests::sample_mesh_page()), "Drawn coarser"));
  const TriangleSurface drawn = coarsened(fine, 60000);
  EXPECT_LE(drawn.triangles.size(), 60000u);
  EXPECT_GT(drawn.triangles.size(), 10000u);
  // The mean of the vertices in a cell lies inside of the ellipsoid by less than the cell, which is
  // 28 mm / sqrt(60000) = 0.11 mm wide, or half as many again where that was too fine; the shortest
  // semi-axis has 7 mm.
  for (const Eigen::Vector3d& vertex : drawn.vertices_m) {
    const double level =
        std::sqrt(std::pow(vertex.x() / 12e-3, 2) + std::pow(vertex.y() / 7e-3, 2) +
                  std::pow(vertex.z() / 14e-3, 2));
    EXPECT_NEAR(level, 1, 0.02);
  }
}

}  // namespace
}  // namespace softfinger::report
