#include "fem/contact/contact_edge.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <map>

#include "fem/contact/touching_outline.h"

namespace softfinger::fem {
namespace {

Eigen::Matrix2Xd ellipse(double a, double b, double turn, const Eigen::Vector2d& centre,
                         Eigen::Index points) {
  ContactEdge edge;
  edge.a = a;
  edge.b = b;
  return (Eigen::Rotation2Dd(turn).toRotationMatrix() * edge.outline(points)).colwise() + centre;
}

/// An inscribed polygon of n corners has (2 pi/n)²/6 less area than its ellipse.
constexpr double of_512_corners = 2.6e-5;

TEST(OutlineShape, OfATurnedEllipseIsThatEllipse) {
  for (const double turn : {0.0, 0.3, -1.2, 1.5}) {
    const OutlineShape shape = shape_of({ellipse(3, 1.5, turn, {0.4, -2}, 512)});
    EXPECT_NEAR(shape.a / 3, 1, of_512_corners);
    EXPECT_NEAR(shape.b / 1.5, 1, of_512_corners);
    EXPECT_NEAR(shape.area / (M_PI * 4.5), 1, of_512_corners);
    EXPECT_NEAR(shape.turn_rad, turn, 1e-12);
    EXPECT_NEAR((shape.centre - Eigen::Vector2d(0.4, -2)).norm(), 0, 1e-12);
    EXPECT_NEAR(shape.departure, 0, of_512_corners);
  }
}

TEST(OutlineShape, HolesAreTakenOff) {
  const Eigen::Matrix2Xd outer = ellipse(2, 2, 0, {0, 0}, 512),
                         hole = ellipse(1, 1, 0, {0, 0}, 512);
  const OutlineShape shape = shape_of({outer, hole.rowwise().reverse()});
  EXPECT_NEAR(shape.area / (3 * M_PI), 1, of_512_corners);
}

TEST(OutlineShape, SaysHowFarItIsFromAnEllipse) {
  ContactEdge edge;
  edge.cosine = Eigen::VectorXd::Zero(4);
  edge.cosine[3] = 0.05;
  EXPECT_NEAR(shape_of({edge.outline(512)}).departure, 0.05, 0.003);  // of second order
}

TEST(SmoothEdge, FollowsARoughOutline) {
  ContactEdge true_edge;
  true_edge.a = 2;
  true_edge.centre = {0.1, 0.2};
  true_edge.sine = Eigen::VectorXd::Zero(4);
  true_edge.sine[3] = 0.03;
  Eigen::Matrix2Xd rough = true_edge.outline(200);
  for (Eigen::Index i = 0; i < rough.cols(); ++i)
    rough.col(i) += (i % 2 ? 0.01 : -0.01) * rough.col(i).normalized();
  const auto smooth = smooth_edge(rough, 6, 0.02);
  ASSERT_TRUE(smooth);
  const OutlineShape expected = shape_of({true_edge.outline(512)});
  const OutlineShape found = shape_of({smooth->outline(512)});
  EXPECT_NEAR(found.area / expected.area, 1, 1e-3);  // noise of 1 % on 200 points
  EXPECT_NEAR(found.a / expected.a, 1, 1e-3);
  EXPECT_FALSE(smooth_edge(rough, 6, 0.005)) << "rougher than the tolerance";
}

TEST(MovedLeft, MakesAnEllipseNarrowerByAsMuchAsShorter) {
  ContactEdge ellipse;
  ellipse.a = 3;
  const Eigen::Matrix2Xd inside = moved_left(ellipse.outline(512), 0.01);
  EXPECT_NEAR(inside.row(0).maxCoeff(), 3 - 0.01, 1e-12);
  EXPECT_NEAR(inside.row(1).maxCoeff(), 1 - 0.01, 1e-12);
  const Eigen::Matrix2Xd hole = ellipse.outline(512).rowwise().reverse();
  EXPECT_NEAR(moved_left(hole, 0.01).row(0).maxCoeff(), 3 + 0.01, 1e-12) << "of a hole";
}

/// A regular grid of biquadratic faces with nodes that touch inside a circle as at the edge of a
/// Hertz contact.
struct HertzGrid {
  MirrorPlanes planes;  ///< the grid ends there
  std::vector<SurfaceNode> nodes;
  std::vector<SurfaceFace> faces;
  Eigen::Matrix2Xd position;
  Eigen::VectorXd pressure, clearance;

  /// p = (2 E* / (pi R)) sqrt(a² - r²), gap of the half-space outside (K. L. Johnson, 1985, eq.
  /// 3.42a for the displacement).
  /// @param cells  from the origin to the extent
  HertzGrid(double a, const Eigen::Vector2d& centre, double extent, int cells, MirrorPlanes about)
      : planes(about) {
    std::map<std::pair<int, int>, int> index;
    const double size = extent / cells;
    for (int j = planes.y ? 0 : -cells; j < cells; ++j)
      for (int i = planes.x ? 0 : -cells; i < cells; ++i) {
        SurfaceFace face{i * size, j * size, size, size, {}};
        for (int k = 0; k < 9; ++k) {
          const std::pair<int, int> at(2 * i + k % 3, 2 * j + k / 3);
          const auto [entry, is_new] = index.emplace(at, static_cast<int>(nodes.size()));
          if (is_new) nodes.push_back({at.first * size / 2, at.second * size / 2, 1});
          face.node[static_cast<std::size_t>(k)] = entry->second;
        }
        faces.push_back(face);
      }
    const auto count = static_cast<Eigen::Index>(nodes.size());
    position.resize(2, count);
    pressure = clearance = Eigen::VectorXd::Zero(count);
    for (Eigen::Index n = 0; n < count; ++n) {
      const SurfaceNode& node = nodes[static_cast<std::size_t>(n)];
      position.col(n) << node.x, node.y;
      const double r = (position.col(n) - centre).norm();
      if (r < a) {
        pressure[n] = 2 / M_PI * std::sqrt(a * a - r * r);
      } else {
        const double sunk =
            ((2 * a * a - r * r) * std::asin(a / r) + a * std::sqrt(r * r - a * a)) / M_PI;
        clearance[n] = r * r / 2 - a * a + sunk;
      }
    }
  }

  std::vector<Eigen::Matrix2Xd> outlines() const {
    return *touching_outlines({nodes, faces, position, pressure, clearance, 1, planes});
  }
  OutlineShape shape() const { return shape_of(outlines()); }
};

TEST(TouchingOutline, FindsTheEdgeBetweenNodes) {
  // Nodes are half a cell apart. The edge's law is exact near the edge only: the next term is of
  // the relative order of their distance over the radius.
  constexpr double cells = 8, a = 1, of_law = 0.5 / cells * 0.5 / cells;
  for (const MirrorPlanes planes :
       {no_plane, MirrorPlanes{false, true}, MirrorPlanes{true, false}, both_planes})
    for (const double shift : {0.0, 0.03, 0.06}) {
      const Eigen::Vector2d centre = planes.middle({shift, -shift});
      const HertzGrid grid(a, centre, 1.3, static_cast<int>(1.3 * cells), planes);
      ASSERT_EQ(grid.outlines().size(), 1u) << "the images join";
      const OutlineShape shape = grid.shape();
      EXPECT_NEAR(shape.area / M_PI, 1, 2 * of_law) << shift;
      EXPECT_NEAR((shape.centre - centre).norm(), 0, std::sqrt(2) * of_law);
      EXPECT_LT(shape.departure, 4 * of_law);
    }
}

TEST(TouchingOutline, OfARingHasAHole) {
  HertzGrid grid(1, {0, 0}, 1.3, 10, no_plane);
  for (Eigen::Index n = 0; n < grid.pressure.size(); ++n)
    if (grid.position.col(n).norm() < 0.4) {
      grid.pressure[n] = 0;
      grid.clearance[n] = 1e-9;  // open, and as good as touching
    }
  EXPECT_EQ(grid.outlines().size(), 2u);
  EXPECT_LT(grid.shape().area, M_PI * (1 - 0.3 * 0.3));
}

}  // namespace
}  // namespace softfinger::fem
