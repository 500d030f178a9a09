// Cells that follow a finger's sharp edges.
#include "fem/layer/edge_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace softfinger::fem {
namespace {

/// A plate with a corner: it ends at x + 0.1 y = 1.1 and at y - 0.2 x = 1.05.
class Corner : public LayerShape {
 public:
  Eigen::Vector3d position(double x, double y, double z) const override { return {x, y, z}; }
  Eigen::Vector3d normal(double /*x*/, double /*y*/) const override {
    return Eigen::Vector3d::UnitZ();
  }
  double area_ratio(double /*x*/, double /*y*/) const override { return 1; }
  MirrorPlanes planes() const override { return {}; }
  Cover covers(double /*low_x*/, double /*high_x*/, double /*low_y*/,
               double /*high_y*/) const override {
    return Cover::whole;
  }
  bool has_edges() const override { return true; }
  double beyond_edge(double x, double y) const override {
    return std::max((x + 0.1 * y - 1.1) / std::hypot(1, 0.1),
                    (y - 0.2 * x - 1.05) / std::hypot(1, 0.2));
  }
};

const std::vector<double> kLines{-2, -1.5, -1, -0.5, 0, 0.5, 1, 1.5, 2};

EdgeShape fitted() { return {std::make_shared<const Corner>(), kLines, kLines, {0.4, 0.4}}; }

TEST(EdgeShape, LeadsALineAlongEachEdgeUpToTheirCorner) {
  const EdgeShape shape = fitted();
  for (double along = -0.5; along <= 1; along += 0.05) {
    EXPECT_NEAR(shape.beyond_edge(1, along), 0, fitted_to_edge) << "x edge at " << along;
    EXPECT_NEAR(shape.beyond_edge(along, 1), 0, fitted_to_edge) << "y edge at " << along;
  }
}

TEST(EdgeShape, CoversNothingBeyondAnEdge) {
  const EdgeShape shape = fitted();
  const Corner corner;
  for (double x = -2; x <= 2; x += 0.05)
    for (double y = -2; y <= 2; y += 0.05) {
      const Eigen::Vector2d at = shape.place(x, y);
      const double beyond = corner.beyond_edge(at.x(), at.y());
      if (shape.covers(x, x, y, y) == LayerShape::Cover::whole)
        EXPECT_LE(beyond, fitted_to_edge) << x << " " << y;
      else
        EXPECT_GT(beyond, -fitted_to_edge) << x << " " << y;
    }
}

TEST(EdgeShape, HasTheAreaOfItsPlaces) {
  const EdgeShape shape = fitted();
  constexpr double side = 1e-3;
  for (const Eigen::Vector2d& at : {Eigen::Vector2d(0.7, 0.6), Eigen::Vector2d(0.8, -0.7)}) {
    const Eigen::Vector2d low = shape.place(at.x(), at.y()),
                          by_x = shape.place(at.x() + side, at.y()) - low,
                          by_y = shape.place(at.x(), at.y() + side) - low;
    const double area = by_x.x() * by_y.y() - by_x.y() * by_y.x();
    // The ratio holds to the first order in the square's side.
    EXPECT_NEAR(shape.area_ratio(at.x(), at.y()), area / (side * side), 2 * side);
  }
}

}  // namespace
}  // namespace softfinger::fem
