#include "meshes/generation/fingertip_layer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLargestTurn = 75 * kPi / 180;
constexpr double kCosLargestSlope = 0.5;  // 60 degrees between surface and reference
constexpr double kThickest = 0.9;         // in smallest radii
constexpr double kSmallestRatio = 0.05;   // of the reference layer's smallest volume ratio
constexpr double kLargestStretch = 3;     // of a step between neighbours, over its derivative
constexpr double kFarthest = 200;         // reach along straight directions, in thicknesses
constexpr double kFarthestRadii = 30;     // the same, in smaller radii
constexpr int kReachSteps = 48, kMostReachSteps = 200;  // along the shorter limit

std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

std::string place(double x, double y) { return "(" + text(x) + ", " + text(y) + ")"; }

/// The point after the arc length s on a circle that touches the axis at 0: its distance along the
/// axis, its drop from it, and the sine and cosine of the angle.
struct Arc {
  Arc(double s, double radius)
      : sine(std::sin(s / radius)),
        cosine(std::cos(s / radius)),
        along(std::isinf(radius) ? s : radius * sine) {
    const double half = std::sin(s / radius / 2);
    drop = std::isinf(radius) ? 0 : 2 * radius * half * half;
  }
  double sine, cosine, along, drop = 0;
};

/// Point and normal of the reference torus, a tube along the first direction. The second radius,
/// that of the tube, must be the smaller one: otherwise the torus would intersect itself at its
/// axis.
SurfaceHit tube(double along, double across, double radius_along, double radius_across) {
  const Arc section(across, radius_across), line(along, radius_along);
  return {{line.along - section.drop * line.sine, section.along,
           -line.drop - section.drop * line.cosine},
          {line.sine * section.cosine, section.sine, line.cosine * section.cosine}};
}

}  // namespace

struct FingertipLayer::Sample {
  SurfaceHit top;
  Vector3d top_x, top_y, normal_x, normal_y;
};

struct FingertipLayer::Finding {
  double ratio = 0;               ///< smallest volume ratio in z
  double z = 0;                   ///< where
  const char* trouble = nullptr;  ///< null: regular
};

FingertipLayer::FingertipLayer(std::shared_ptr<const PadSurface> pad, double thickness)
    : pad_(std::move(pad)), thickness_(thickness) {
  if (!(thickness > 0 && std::isfinite(thickness)))
    throw InputError("fingertip layer", "thickness", thickness, "> 0 and finite");
  const double smallest = pad_->smallest_radius();
  if (!(thickness < kThickest * smallest)) {
    throw InputError("fingertip layer", "thickness", thickness,
                     "less than " + text(kThickest) + " times the fingertip's smallest radius, " +
                         text(smallest) + ": a core must be left");
  }
  difference_ = 1e-5 * (std::isinf(smallest) ? thickness : smallest);
  smallest_ratio_ =
      kSmallestRatio * (1 - thickness / pad_->radius_x()) * (1 - thickness / pad_->radius_y());
  const Finding pole = examine(0, 0, difference_, difference_);
  if (pole.trouble)
    throw InputError("fingertip layer", "map at the contact point", pole.trouble, "a regular map");
  find_facets();
  find_reach();
}

SurfaceHit FingertipLayer::reference(double x, double y) const {
  if (pad_->radius_x() >= pad_->radius_y()) return tube(x, y, pad_->radius_x(), pad_->radius_y());
  SurfaceHit turned = tube(y, x, pad_->radius_y(), pad_->radius_x());
  std::swap(turned.point.x(), turned.point.y());
  std::swap(turned.normal.x(), turned.normal.y());
  return turned;
}

/// The inverse: the (x, y) whose reference normal passes through the point.
Eigen::Vector2d FingertipLayer::coordinates(const Vector3d& point) const {
  const bool along_x = pad_->radius_x() >= pad_->radius_y();
  const double along = std::max(pad_->radius_x(), pad_->radius_y()),
               across = std::min(pad_->radius_x(), pad_->radius_y());
  double s = along_x ? point.x() : point.y(), t = along_x ? point.y() : point.x(),
         above = point.z();  // the pole of the section
  if (std::isfinite(along)) {
    above = std::hypot(s, above + along) - along;
    s = along * std::atan2(s, point.z() + along);
  }
  if (std::isfinite(across)) t = across * std::atan2(t, above + across);
  return along_x ? Eigen::Vector2d(s, t) : Eigen::Vector2d(t, s);
}

std::optional<SurfaceHit> FingertipLayer::meet(double x, double y) const {
  const SurfaceHit from = reference(x, y);
  return pad_->meet(from.point, from.normal);
}

SurfaceHit FingertipLayer::require(double x, double y) const {
  const auto hit = meet(x, y);
  if (!hit) {
    throw InputError(
        "fingertip layer", "(x, y)", place(x, y),
        "a place over the fingertip's surface: this normal of the reference meets none");
  }
  return *hit;
}

Vector3d FingertipLayer::position(double x, double y, double z) const {
  const SurfaceHit top = require(x, y);
  return top.point + z * thickness_ * top.normal;
}

Vector3d FingertipLayer::normal(double x, double y) const { return require(x, y).normal; }

std::optional<FingertipLayer::Sample> FingertipLayer::sample(double x, double y) const {
  const auto top = meet(x, y), right = meet(x + difference_, y), left = meet(x - difference_, y),
             back = meet(x, y + difference_), front = meet(x, y - difference_);
  if (!top || !right || !left || !back || !front) return std::nullopt;
  const double scale = 1 / (2 * difference_);
  return Sample{*top, scale * (right->point - left->point), scale * (back->point - front->point),
                scale * (right->normal - left->normal), scale * (back->normal - front->normal)};
}

Matrix3d FingertipLayer::gradient(double x, double y, double z) const {
  const auto at = sample(x, y);
  if (!at) {
    require(x, y);
    throw InputError("fingertip layer", "(x, y)", place(x, y), "a place inside the surface's edge");
  }
  Matrix3d result;
  result << at->top_x + z * thickness_ * at->normal_x, at->top_y + z * thickness_ * at->normal_y,
      at->top.normal;
  return result;
}

/// Tests one point of the map against its neighbours one step nearer to the pole.
FingertipLayer::Finding FingertipLayer::examine(double x, double y, double step_x,
                                                double step_y) const {
  Finding finding;
  const auto at = sample(x, y);
  if (!at) {
    finding.trouble = "the surface is not met";
    return finding;
  }
  // det [T_x + z h n_x, T_y + z h n_y, n] is a parabola in z, so that its minimum is known exactly.
  const Vector3d& n = at->top.normal;
  const double h = thickness_;
  const double constant = at->top_x.cross(at->top_y).dot(n),
               linear = h * (at->top_x.cross(at->normal_y) + at->normal_x.cross(at->top_y)).dot(n),
               square = h * h * at->normal_x.cross(at->normal_y).dot(n);
  finding.ratio = constant;
  const double turning = square > 0 ? std::clamp(-linear / (2 * square), -1.0, 0.0) : -1.0;
  for (const double z : {-1.0, turning}) {
    const double ratio = constant + z * (linear + z * square);
    if (ratio < finding.ratio) {
      finding.ratio = ratio;
      finding.z = z;
    }
  }
  if (!(finding.ratio > smallest_ratio_)) {
    finding.trouble = "inverted";
  } else if (!(n.dot(reference(x, y).normal) >= kCosLargestSlope)) {
    finding.trouble = "too steep against the reference surface";
  } else {
    const auto jumps = [&](const std::optional<SurfaceHit>& neighbour, double step,
                           const Vector3d& derivative) {
      return !neighbour || (at->top.point - neighbour->point).norm() >
                               kLargestStretch * step * std::max(1.0, derivative.norm());
    };
    if (jumps(meet(x - std::copysign(step_x, x), y), step_x, at->top_x) ||
        jumps(meet(x, y - std::copysign(step_y, y)), step_y, at->top_y))
      finding.trouble = "torn: neighbours lie on different parts of the surface";
  }
  return finding;
}

void FingertipLayer::find_facets() {
  for (const Vector3d& point : pad_->facet_points()) {
    const Eigen::Vector2d at = coordinates(point);
    if (!(std::abs(at.x()) <= kLargestTurn * pad_->radius_x() &&
          std::abs(at.y()) <= kLargestTurn * pad_->radius_y()))
      continue;
    // The line through the point may leave the finger at another place, on its back for instance.
    const auto top = meet(at.x(), at.y());
    if (top && (top->point - point).norm() < difference_) facets_.push_back(at);
  }
}

void FingertipLayer::find_reach() {
  const double radii[] = {pad_->radius_x(), pad_->radius_y()};
  const double smaller = std::min(radii[0], radii[1]);
  const double farthest = std::min(kFarthest * thickness_, kFarthestRadii * smaller);
  double limit[2], step[2];
  for (int i : {0, 1}) {
    limit[i] = std::min(kLargestTurn * radii[i], farthest);
    double widest = 0;  // a triangulated finger's own size: the lattice resolves it
    for (const auto& at : facets_) widest = std::max(widest, std::abs(at[i]));
    if (widest > 0) limit[i] = std::min(limit[i], widest);
  }
  int nodes[2], count[2] = {0, 0};
  const double shorter = std::min(limit[0], limit[1]);
  const double wanted =
      std::min(shorter / kReachSteps, std::max(thickness_ / 2, shorter / kMostReachSteps));
  for (int i : {0, 1}) {
    nodes[i] = static_cast<int>(std::ceil(limit[i] / wanted - 1e-9));
    step[i] = limit[i] / nodes[i];
  }

  std::vector<Eigen::Vector2d> irregular;
  for (const auto& at : facets_)
    if (examine(at.x(), at.y(), difference_, difference_).trouble)
      irregular.push_back(at.cwiseAbs());

  const bool one_sided[] = {symmetric_x(), symmetric_y()};
  const auto regular = [&](int i, int j) {
    for (const int sign_x : {1, -1})
      for (const int sign_y : {1, -1}) {
        if ((sign_x < 0 && (one_sided[0] || i == 0)) || (sign_y < 0 && (one_sided[1] || j == 0)))
          continue;
        if (examine(sign_x * i * step[0], sign_y * j * step[1], step[0], step[1]).trouble)
          return false;
      }
    return true;
  };
  const auto next_is_regular = [&](int direction) {
    const int other = 1 - direction, next = count[direction] + 1;
    for (int k = 0; k <= count[other]; ++k)
      if (!(direction == 0 ? regular(next, k) : regular(k, next))) return false;
    const double x = step[0] * (direction == 0 ? next : count[0]),
                 y = step[1] * (direction == 1 ? next : count[1]);
    return std::none_of(irregular.begin(), irregular.end(),
                        [&](const auto& at) { return at.x() <= x && at.y() <= y; });
  };
  bool open[2] = {true, true}, failed[2] = {false, false};
  while (open[0] || open[1]) {
    const int direction = !open[1] || (open[0] && count[0] * step[0] <= count[1] * step[1]) ? 0 : 1;
    if (next_is_regular(direction)) {
      open[direction] = ++count[direction] < nodes[direction];
    } else {
      open[direction] = false;
      failed[direction] = true;
    }
  }
  for (int i : {0, 1}) count[i] = std::max(0, count[i] - failed[i]);
  reach_x_ = count[0] == nodes[0] ? limit[0] : count[0] * step[0];
  reach_y_ = count[1] == nodes[1] ? limit[1] : count[1] * step[1];
}

double FingertipLayer::verify(double half_x, double half_y, int steps) const {
  if (!(half_x > 0 && half_y > 0 && std::isfinite(half_x) && std::isfinite(half_y)))
    throw InputError("fingertip layer", "half lengths", place(half_x, half_y), "> 0 and finite");
  if (steps < 1) throw InputError("fingertip layer", "steps", std::to_string(steps), ">= 1");
  double smallest = std::numeric_limits<double>::infinity();
  const auto look = [&](double x, double y, double step_x, double step_y) {
    const Finding finding = examine(x, y, step_x, step_y);
    if (finding.trouble) {
      throw InputError(
          "fingertip layer", "map at (x, y) = " + place(x, y),
          std::string(finding.trouble) + " (volume ratio " + text(finding.ratio) +
              " at z = " + text(finding.z) + ")",
          "|x| <= " + text(reach_x_) + ", |y| <= " + text(reach_y_) + ", or a thinner layer");
    }
    smallest = std::min(smallest, finding.ratio);
  };
  for (int i = symmetric_x() ? 0 : -steps; i <= steps; ++i)
    for (int j = symmetric_y() ? 0 : -steps; j <= steps; ++j)
      look(half_x * i / steps, half_y * j / steps, half_x / steps, half_y / steps);
  for (const auto& at : facets_)
    if (std::abs(at.x()) <= half_x && std::abs(at.y()) <= half_y)
      look(at.x(), at.y(), difference_, difference_);
  return smallest;
}

}  // namespace softfinger::meshes
