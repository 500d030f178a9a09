#include "fem/contact/rigid_object.h"

#include <cmath>
#include <map>
#include <utility>

namespace softfinger::fem {
namespace {

class Quadric : public RigidObject {
 public:
  Quadric(double major, double minor) : curvature_(1 / major, 1 / minor) {}
  std::optional<ObjectHeight> over(double x, double y) const override {
    const Eigen::Vector2d at(x, y);
    const Eigen::Vector2d slope = curvature_.cwiseProduct(at);
    return ObjectHeight{0.5 * slope.dot(at), slope, curvature_.asDiagonal()};
  }

 private:
  Eigen::Vector2d curvature_;
};

class Sphere : public RigidObject {
 public:
  explicit Sphere(double radius) : radius_(radius) {}
  std::optional<ObjectHeight> over(double x, double y) const override {
    const Eigen::Vector2d at(x, y);
    const double square = radius_ * radius_ - at.squaredNorm();
    // Steeper than 84 degrees it is as good as out of reach, and its slope has no bound.
    if (square < 0.01 * radius_ * radius_) return std::nullopt;
    const double root = std::sqrt(square);
    const Eigen::Vector2d slope = at / root;
    return ObjectHeight{at.squaredNorm() / (radius_ + root), slope,
                        (Eigen::Matrix2d::Identity() + slope * slope.transpose()) / root};
  }

 private:
  double radius_;
};

class Sampled : public RigidObject {
 public:
  Sampled(std::function<std::optional<double>(double, double)> height, double step)
      : height_(std::move(height)), step_(step) {}

  std::optional<ObjectHeight> over(double x, double y) const override {
    double around[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const auto height = height_(x + (i - 1) * step_, y + (j - 1) * step_);
        if (!height) return std::nullopt;
        around[i][j] = *height;
      }
    ObjectHeight result;
    result.height = around[1][1];
    result.slope = {(around[2][1] - around[0][1]) / (2 * step_),
                    (around[1][2] - around[1][0]) / (2 * step_)};
    const double square = step_ * step_;
    result.curvature(0, 0) = (around[2][1] - 2 * around[1][1] + around[0][1]) / square;
    result.curvature(1, 1) = (around[1][2] - 2 * around[1][1] + around[1][0]) / square;
    result.curvature(0, 1) = result.curvature(1, 0) =
        (around[2][2] - around[2][0] - around[0][2] + around[0][0]) / (4 * square);
    return result;
  }

 private:
  std::function<std::optional<double>(double, double)> height_;
  double step_;
};

/// Weights of the four control points around the interval's point t, 0 to 1: rows are value, slope
/// and curvature of the uniform cubic B-spline.
Eigen::Matrix<double, 3, 4> spline_weights(double t) {
  const double s = 1 - t;
  Eigen::Matrix<double, 3, 4> result;
  result << s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6,
      t * t * t / 6,                                                             //
      -s * s / 2, (-4 * t + 3 * t * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2,  //
      s, 3 * t - 2, 3 * s - 2, t;
  return result;
}

class Smoothed : public RigidObject {
 public:
  Smoothed(std::function<std::optional<double>(double, double)> height, double spacing)
      : height_(std::move(height)), spacing_(spacing) {}

  std::optional<ObjectHeight> over(double x, double y) const override {
    const double column = std::floor(x / spacing_), row = std::floor(y / spacing_);
    Eigen::Matrix4d control;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const auto height = at(static_cast<int>(column) + i - 1, static_cast<int>(row) + j - 1);
        if (!height) return std::nullopt;
        control(i, j) = *height;
      }
    const Eigen::Matrix3d derivatives = spline_weights(x / spacing_ - column) * control *
                                        spline_weights(y / spacing_ - row).transpose();
    ObjectHeight result;
    result.height = derivatives(0, 0);
    result.slope = Eigen::Vector2d(derivatives(1, 0), derivatives(0, 1)) / spacing_;
    result.curvature(0, 0) = derivatives(2, 0);
    result.curvature(1, 1) = derivatives(0, 2);
    result.curvature(0, 1) = result.curvature(1, 0) = derivatives(1, 1);
    result.curvature /= spacing_ * spacing_;
    return result;
  }

 private:
  std::optional<double> at(int column, int row) const {
    const auto [entry, is_new] = heights_.try_emplace({column, row});
    if (is_new) entry->second = height_(column * spacing_, row * spacing_);
    return entry->second;
  }

  std::function<std::optional<double>(double, double)> height_;
  double spacing_;
  /// Heights at those points of the lattice that were needed so far. Each costs a search among all
  /// facets.
  mutable std::map<std::pair<int, int>, std::optional<double>> heights_;
};

}  // namespace

std::unique_ptr<const RigidObject> quadric(double major, double minor) {
  return std::make_unique<Quadric>(major, minor);
}

std::unique_ptr<const RigidObject> sphere(double radius) {
  return std::make_unique<Sphere>(radius);
}

std::unique_ptr<const RigidObject> sampled(
    std::function<std::optional<double>(double x, double y)> height, double step) {
  return std::make_unique<Sampled>(std::move(height), step);
}

std::unique_ptr<const RigidObject> smoothed(
    std::function<std::optional<double>(double x, double y)> height, double spacing) {
  return std::make_unique<Smoothed>(std::move(height), spacing);
}

}  // namespace softfinger::fem
