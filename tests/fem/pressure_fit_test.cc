#include "fem/contact/pressure_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

namespace softfinger::fem {
namespace {

/// A regular surface of biquadratic faces, and the moments of a pressure with its shape functions,
/// by brute force in Cartesian coordinates.
struct Surface {
  std::vector<SurfaceNode> nodes;
  std::vector<SurfaceFace> faces;
  Eigen::VectorXd force;
  PressureFit fit(double a, double b) const {
    ContactEdge edge;
    edge.a = a;
    edge.b = b;
    return fit_pressure({nodes, faces, force, false, nullptr}, edge).value();
  }

  Surface(double extent_x, double extent_y, int cells,
          const std::function<double(double, double)>& pressure) {
    std::map<std::pair<int, int>, int> index;
    const double size_x = extent_x / cells, size_y = extent_y / cells;
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i) {
        SurfaceFace face{i * size_x, j * size_y, size_x, size_y, {}};
        for (int k = 0; k < 9; ++k) {
          const std::pair<int, int> place(2 * i + k % 3, 2 * j + k / 3);
          const auto [entry, is_new] = index.emplace(place, static_cast<int>(nodes.size()));
          if (is_new) nodes.push_back({place.first * size_x / 2, place.second * size_y / 2, 0});
          face.node[static_cast<std::size_t>(k)] = entry->second;
        }
        faces.push_back(face);
      }
    force = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nodes.size()));
    constexpr int points = 60;
    for (const auto& face : faces)
      for (int p = 0; p < points * points; ++p) {
        const double xi = (p % points + 0.5) / points, eta = (p / points + 0.5) / points;
        const double area = face.size_x * face.size_y / (points * points);
        const double value = pressure(face.x + xi * face.size_x, face.y + eta * face.size_y) * area;
        const double along_x[] = {(1 - xi) * (1 - 2 * xi), 4 * xi * (1 - xi), xi * (2 * xi - 1)};
        const double along_y[] = {(1 - eta) * (1 - 2 * eta), 4 * eta * (1 - eta),
                                  eta * (2 * eta - 1)};
        for (int k = 0; k < 9; ++k) {
          const int node = face.node[static_cast<std::size_t>(k)];
          force[node] += value * along_x[k % 3] * along_y[k / 3];
          nodes[static_cast<std::size_t>(node)].weight += area * along_x[k % 3] * along_y[k / 3];
        }
      }
  }
};

// Midpoint sampling with 60 points per face and 8 faces per semi-axis: the edge is blurred by
// 1/480.
constexpr double sampling = 0.5 / 480;

TEST(PressureFit, RecoversAHertzianPressure) {
  const double a = 2.2, b = 0.7;
  const Surface surface(1.25 * a, 1.25 * b, 10, [&](double x, double y) {
    return 3 * std::sqrt(std::max(0.0, 1 - x * x / (a * a) - y * y / (b * b)));
  });
  const auto ellipse = surface.fit(1.1 * a, 0.9 * b);
  EXPECT_NEAR(ellipse.edge.a / a, 1, sampling);
  EXPECT_NEAR(ellipse.edge.b / b, 1, sampling);
  EXPECT_NEAR(ellipse.centre_pressure / 3, 1, 2 * sampling);
  EXPECT_NEAR(ellipse.edge.cosine[4], 0, sampling);
}

TEST(PressureFit, RecoversAPressureThatIsNoFunctionOfTheRadiusAlone) {
  const double a = 1, b = 0.4;
  const Surface surface(1.25 * a, 1.25 * b, 10, [&](double x, double y) {
    const double X = x * x / (a * a), Y = y * y / (b * b);
    return X + Y < 1 ? std::sqrt(1 - X - Y) * (1 + 0.5 * X - 0.3 * Y + 0.2 * X * Y) : 0.0;
  });
  const auto ellipse = surface.fit(a, b);
  EXPECT_NEAR(ellipse.edge.a / a, 1, sampling);
  EXPECT_NEAR(ellipse.edge.b / b, 1, sampling);
  EXPECT_NEAR(ellipse.centre_pressure, 1, 2 * sampling);
}

TEST(PressureFit, SeesADiamondShapedEdge) {
  const double a = 1.5, b = 1, diamond = 0.01;
  const Surface surface(1.3 * a, 1.3 * b, 10, [&](double x, double y) {
    const double r = std::hypot(x / a, y / b), v = std::atan2(y / b, x / a);
    const double scaled = r / (1 + diamond * std::cos(4 * v));
    return scaled < 1 ? std::sqrt(1 - scaled * scaled) : 0.0;
  });
  const auto ellipse = surface.fit(a, b);
  EXPECT_NEAR(ellipse.edge.cosine[4], diamond, 0.1 * diamond);
  EXPECT_NEAR(ellipse.edge.a / a, 1, 2 * sampling);
  EXPECT_NEAR(ellipse.edge.b / b, 1, 2 * sampling);
}

// Steps that leave out how the polynomial follows the edge are too short: they ended 2e-5 apart
// here, 1e-4 on contacts.
TEST(PressureFit, EndsAtTheSameEdgeFromAnyStart) {
  const double a = 1.3, b = 1;
  const Surface surface(1.3 * a, 1.3 * b, 10, [&](double x, double y) {
    const double r2 = x * x / (a * a) + y * y / (b * b);
    return r2 < 1 ? std::sqrt(1 - r2) * std::exp(r2) : 0.0;
  });
  const ContactEdge small = surface.fit(0.9 * a, 0.9 * b).edge,
                    large = surface.fit(1.08 * a, 1.08 * b).edge;
  // The last step is below 1e-5.
  EXPECT_NEAR(small.a / large.a, 1, 1e-5);
  EXPECT_NEAR(small.b / large.b, 1, 1e-5);
  EXPECT_NEAR(small.cosine[4], large.cosine[4], 1e-5);
}

}  // namespace
}  // namespace softfinger::fem
