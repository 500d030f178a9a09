#include "softfinger/geometry/contact_patch.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <sstream>

#include "softfinger/geometry/quadric_fit_internal.h"
#include "softfinger/geometry/surface_region.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

// Two more than a quadric has unknowns, so that the residual means something.
constexpr int kFewestPoints = 8;
// The first region has so many points that its radii are not noise. From the smallest region on a
// fine mesh the iteration could converge to radii that are.
constexpr int kStartingPoints = 40;

std::string number(double value) {
  std::ostringstream out;
  out.precision(3);
  out << value;
  return out.str();
}

/// One body, prepared for fits over several radii.
struct Body {
  std::optional<Quadric> exact;
  std::optional<internal::SurfaceNeighbourhood> mesh;

  explicit Body(const ContactBody& body) {
    if (const auto* quadric = std::get_if<Quadric>(&body)) {
      exact = *quadric;
    } else {
      const auto& at = std::get<MeshContactPoint>(body);
      if (!at.surface) throw InputError("surface", "mesh", "none", "a triangulated surface");
      mesh.emplace(*at.surface, at.point_m, at.outward_normal ? &*at.outward_normal : nullptr);
    }
  }
};

/// A region, the radii of curvature fitted in it, and the region's radius that follows from them.
struct Trial {
  ContactPatch patch;
  double radius_m = 0;
  double wanted_m = kInfinity;  ///< infinite without an ellipse: a flat or saddle-like middle
                                ///< becomes elliptic, if at all, in a larger region
  bool elliptic() const { return patch.relative.kind == ContactKind::elliptic; }
  double area_ratio() const { return radius_m * radius_m / (wanted_m * wanted_m); }
  double mismatch() const { return std::abs(std::log(area_ratio())); }
};

class PatchProblem {
 public:
  PatchProblem(const ContactBody& finger, const ContactBody& object, double angle_rad,
               const std::function<double(const RelativeRadii&)>& predicted_area_m2)
      : finger_(finger), object_(object), angle_(angle_rad), predicted_area_(predicted_area_m2) {}

  bool has_mesh() const { return finger_.mesh || object_.mesh; }

  /// @throws InputError, ConvergenceError from the fits: regions too small, too large.
  Trial fit(double radius_m) const {
    Trial trial;
    trial.radius_m = radius_m;
    auto& patch = trial.patch;
    const auto local = [radius_m](const Body& body, std::optional<QuadricFit>& fit,
                                  Eigen::Matrix3d& covariance) {
      covariance.setZero();
      if (body.exact) return *body.exact;
      fit = internal::fit_quadric(*body.mesh, radius_m);
      covariance = fit->covariance_per_m2;
      return fit->quadric;
    };
    Eigen::Matrix3d finger_covariance, object_covariance;
    const Quadric finger = local(finger_, patch.finger_fit, finger_covariance);
    Quadric object = local(object_, patch.object_fit, object_covariance);
    if (object_.mesh) {
      // The object's own frame looks along its own outward normal; the finger sees it in a mirror.
      object.C_per_m = -object.C_per_m;
      object_covariance.row(2) *= -1;
      object_covariance.col(2) *= -1;
    }
    patch.relative =
        relative_curvature(finger, finger_covariance, object, object_covariance, angle_);
    patch.region_area_m2 = has_mesh() ? kPi * radius_m * radius_m : 0;
    return trial;
  }

  void predict(Trial& trial) const {
    if (!trial.elliptic()) return;
    const double area = predicted_area_(trial.patch.relative.radii);
    if (!(area > 0) || !std::isfinite(area))
      throw InputError("contact", "predicted area", number(area) + " m²", "positive and finite");
    trial.patch.predicted_area_m2 = area;
    trial.wanted_m = std::sqrt(2 * area / kPi);
  }

  double radius_with_points(int count) const {
    double radius = 0;
    for (const Body* body : {&finger_, &object_}) {
      if (!body->mesh) continue;
      radius = std::max(
          {radius, body->mesh->radius_with_points(count), body->mesh->distance_m() * (1 + 1e-9)});
    }
    return radius;
  }

  /// Beyond it no region grows any more.
  double largest_radius() const {
    double radius = kInfinity;
    for (const Body* body : {&finger_, &object_})
      if (body->mesh) radius = std::min(radius, body->mesh->extent_m());
    return radius;
  }

  int points(const Trial& trial) const {
    int count = std::numeric_limits<int>::max();
    for (const auto* fit : {&trial.patch.finger_fit, &trial.patch.object_fit})
      if (*fit) count = std::min(count, (*fit)->points);
    return count;
  }

  int vertices_within(double radius_m) const {
    int count = std::numeric_limits<int>::max();
    for (const Body* body : {&finger_, &object_})
      if (body->mesh) count = std::min(count, body->mesh->vertices_within(radius_m));
    return count;
  }

 private:
  Body finger_, object_;
  double angle_;
  const std::function<double(const RelativeRadii&)>& predicted_area_;
};

}  // namespace

ContactPatch fit_contact_patch(
    const ContactBody& finger, const ContactBody& object, double angle_rad,
    const std::function<double(const RelativeRadii&)>& predicted_area_m2) {
  const PatchProblem problem(finger, object, angle_rad, predicted_area_m2);
  if (!problem.has_mesh()) {
    Trial exact = problem.fit(0);
    problem.predict(exact);
    return exact.patch;
  }

  const double largest = problem.largest_radius();
  const double smallest = std::min(problem.radius_with_points(kFewestPoints), largest);
  double start = smallest;
  try {
    start = std::min(problem.radius_with_points(kStartingPoints), largest);
  } catch (const InputError&) {
    start = std::min(2 * smallest, largest);  // a coarse mesh: it has fewer altogether
  }

  std::optional<Trial> first, best, last;
  double below = 0, above = kInfinity;  // regions known to be too small, too large
  double radius = std::max(start, smallest);
  int iterations = 0;
  const int max_iterations = 60;
  const double tolerance = 0.02;
  bool discrete = false;
  std::exception_ptr failure;
  while (iterations < max_iterations) {
    ++iterations;
    double wanted = kInfinity;
    // Only the fit may fail here; a prediction that throws is the caller's business.
    try {
      last = problem.fit(radius);
    } catch (const InputError&) {  // vertices that do not determine a quadric: more are needed
      last.reset();
      failure = std::current_exception();
    } catch (const ConvergenceError&) {  // too strongly curved: less of it
      last.reset();
      wanted = 0;
      failure = std::current_exception();
    }
    if (last) {
      problem.predict(*last);
      wanted = last->wanted_m;
    }
    if (last && (!first || !first->elliptic())) first = last;
    if (last && last->elliptic() && (!best || last->mismatch() < best->mismatch())) best = last;
    if (best && std::abs(best->area_ratio() - 1) <= tolerance) break;
    (wanted > radius ? below : above) = radius;
    if (below > 0 && above < 1.001 * below) {
      discrete = true;
      break;
    }
    // Damped: the geometric mean of the region's radius and the wanted one. Bisection where that
    // leaves the bracket, and now and then anyway, so that the bracket shrinks from both sides.
    double next = std::isfinite(wanted) ? std::sqrt(radius * wanted) : 2 * radius;
    next = std::clamp(next, radius / 2, radius * 2);
    const bool bracketed = below > 0 && std::isfinite(above);
    if (bracketed && (next <= below || next >= above || iterations % 4 == 0))
      next = std::sqrt(below * above);
    next = std::clamp(next, smallest, largest);
    if (next == radius) break;
    radius = next;
  }
  if (!first) std::rethrow_exception(failure);

  const Trial& chosen = best ? *best : *first;
  ContactPatch patch = chosen.patch;
  patch.iterations = iterations;
  patch.agrees = best && std::abs(best->area_ratio() - 1) <= tolerance;
  if (patch.agrees) return patch;
  if (!best) {
    patch.remark = "no region from " + internal::millimetres(smallest) + " to " +
                   internal::millimetres(std::max(radius, chosen.radius_m)) +
                   " gives an elliptic contact";
    return patch;
  }
  const std::string ratio = "the region of " + internal::millimetres(chosen.radius_m) + " (" +
                            std::to_string(problem.points(chosen)) + " vertices) is used, " +
                            number(chosen.area_ratio()) + " times twice the predicted area";
  if (chosen.wanted_m < smallest && chosen.radius_m <= smallest * 1.001) {
    patch.remark = "the mesh has only " + std::to_string(problem.vertices_within(chosen.wanted_m)) +
                   " vertices within " + internal::millimetres(chosen.wanted_m) +
                   " of the contact point, " + std::to_string(kFewestPoints) +
                   " are needed: " + ratio;
  } else if (chosen.wanted_m > largest && chosen.radius_m >= largest * 0.999) {
    patch.remark = "the surface ends within " + internal::millimetres(chosen.wanted_m) +
                   " of the contact point: " + ratio;
  } else if (discrete) {
    patch.remark =
        "region and contact jump past each other as single vertices enter the region: " + ratio;
  } else {
    patch.remark = "region and contact do not agree: " + ratio;
  }
  return patch;
}

}  // namespace softfinger
