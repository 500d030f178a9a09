#include "softfinger/geometry/contact_patch.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <sstream>

#include "softfinger/geometry/quadric_fit_internal.h"
#include "softfinger/geometry/surface_region.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

// Two more than a quadric has unknowns, so that the residual means something.
constexpr int kFewestPoints = 8;
// Five strips of a wall, each of two facets, have four kinks.
constexpr int kFewestFacets = 10;
// The search begins where a region has so many points that its radii are not noise. From the
// smallest region of a fine mesh it would end at radii that are.
constexpr int kStartingPoints = 40;
// Ratio of the radii of neighbouring regions.
constexpr double kStep = 1.25;

std::string number(double value) {
  std::ostringstream out;
  out.precision(3);
  out << value;
  return out.str();
}

/// The logarithm of the ratio of the eigenvalues of `to` relative to `from`, two symmetric positive
/// definite matrices.
double log_of_stretches(const Eigen::Matrix2d& from, const Eigen::Matrix2d& to) {
  // The eigenvalues l of from^-1 to have this sum and this product.
  const double half_sum = 0.5 * (from.inverse() * to).trace();
  const double product = to.determinant() / from.determinant();
  const double larger = half_sum + std::sqrt(std::max(0., half_sum * half_sum - product));
  return std::log(larger * larger / product);
}

/// Mean over the region's area of the facets' sagittas: kappa e²/8 of the fitted quadric along each
/// edge e, which is a quarter of its depth there; of a facet the mean of its edges.
/// @param longest_m  longer edges count as so long: a contact sees no more of a facet than itself
double mean_sagitta_m(const internal::SurfaceRegion& region, const QuadricFit& fit,
                      double longest_m) {
  const Eigen::Matrix3d axes = surface_axes(fit.normal);
  double sum = 0;
  for (Eigen::Index i = 0; i < region.corners.cols(); ++i)
    for (int edge = 0; edge < 3; ++edge) {
      const Eigen::Vector3d along =
          axes.transpose() * (region.vertices_m.col(region.corners((edge + 1) % 3, i)) -
                              region.vertices_m.col(region.corners(edge, i)));
      const Quadric& q = fit.quadric;
      const double depth = q.A_per_m * along.x() * along.x() + q.B_per_m * along.y() * along.y() +
                           q.C_per_m * along.x() * along.y();
      const double seen = std::min(1.0, longest_m * longest_m / along.squaredNorm());
      sum += region.weights_m2[i] * seen * std::abs(depth) / (3 * 4);
    }
  return sum / region.weights_m2.sum();
}

/// One body, prepared for fits over several radii.
struct Body {
  std::optional<Quadric> exact;
  std::optional<internal::SurfaceNeighbourhood> mesh;
  /// A tessellation whose vertices determine no quadric near the point: a wall that is straight in
  /// one direction has them at its ends only. Its facets are read as the surface itself.
  bool by_facets = false;

  explicit Body(const ContactBody& body) {
    if (const auto* quadric = std::get_if<Quadric>(&body)) {
      exact = *quadric;
    } else {
      const auto& at = std::get<MeshContactPoint>(body);
      if (!at.surface) throw InputError("surface", "mesh", "none", "a triangulated surface");
      mesh.emplace(*at.surface, at.point_m, at.outward_normal ? &*at.outward_normal : nullptr);
    }
  }

  /// Chooses how the mesh is read. Costs two fits.
  void read_facets_without_vertices() {
    if (mesh) by_facets = !has_vertices() && has_facets();
  }

  QuadricFit fit(double radius_m) const {
    return by_facets ? internal::fit_quadric_to_facets(*mesh, radius_m)
                     : internal::fit_quadric(*mesh, radius_m);
  }

  /// See ContactPatch::facet_doubt_m.
  /// @param radius_m  of a region twice as large as the contact
  double facet_doubt_m(const QuadricFit& fit, double radius_m) const {
    const auto region = mesh->region(std::max(radius_m, mesh->distance_m() * (1 + 1e-9)));
    return mean_sagitta_m(region, fit, std::sqrt(2.0) * radius_m) /
           std::sqrt(std::max(1, region.vertices_within));
  }

  /// The smallest radius with so many vertices; of a tessellation with enough facets to be curved.
  double radius_with(int vertices) const {
    const double radius =
        by_facets ? mesh->radius_with_facets(kFewestFacets) : mesh->radius_with_points(vertices);
    return std::max(radius, mesh->distance_m() * (1 + 1e-9));
  }

 private:
  /// A few vertices may lie on a conic by chance, many do not.
  bool has_vertices() const {
    for (const int count : {kFewestPoints, kStartingPoints}) {
      try {
        internal::fit_quadric(
            *mesh, std::max(mesh->radius_with_points(count), mesh->distance_m() * (1 + 1e-9)));
        return true;
      } catch (const InputError&) {
      } catch (const ConvergenceError&) {
      }
    }
    return false;
  }

  bool has_facets() const {
    try {
      internal::fit_quadric_to_facets(*mesh, std::max(mesh->radius_with_facets(kFewestFacets),
                                                      mesh->distance_m() * (1 + 1e-9)));
      return true;
    } catch (const InputError&) {
    } catch (const ConvergenceError&) {
    }
    return false;
  }
};

/// Both bodies' quadrics over regions of one radius.
struct Fits {
  double radius_m = 0;
  std::optional<QuadricFit> finger, object;
};

QuadricFit between(const QuadricFit& smaller, const QuadricFit& larger, double weight) {
  const auto blend = [weight](const auto& one, const auto& other) {
    return (1 - weight) * one + weight * other;
  };
  QuadricFit fit = weight < 0.5 ? smaller : larger;
  fit.quadric = {blend(smaller.quadric.A_per_m, larger.quadric.A_per_m),
                 blend(smaller.quadric.B_per_m, larger.quadric.B_per_m),
                 blend(smaller.quadric.C_per_m, larger.quadric.C_per_m)};
  // Nested regions have correlated errors, whose variance is at most the mean one.
  if (smaller.covariance_per_m2.allFinite() && larger.covariance_per_m2.allFinite())
    fit.covariance_per_m2 =
        (1 - weight) * smaller.covariance_per_m2 + weight * larger.covariance_per_m2;
  else
    fit.covariance_per_m2.setConstant(kInfinity);
  fit.origin_m = (1 - weight) * smaller.origin_m + weight * larger.origin_m;
  fit.normal = ((1 - weight) * smaller.normal + weight * larger.normal).normalized();
  fit.x_axis = surface_axes(fit.normal).col(0);
  fit.residual_rms_m = blend(smaller.residual_rms_m, larger.residual_rms_m);
  fit.region_radius_m =
      smaller.region_radius_m * std::pow(larger.region_radius_m / smaller.region_radius_m, weight);
  internal::set_principal_radii(fit, fit.region_radius_m);
  fit.area_m2 = smaller.area_m2 * std::pow(larger.area_m2 / smaller.area_m2, weight);
  fit.points = int(std::lround(blend(double(smaller.points), double(larger.points))));
  fit.surface_kind = larger.surface_kind;
  fit.sharpest_kink_rad = larger.sharpest_kink_rad;
  return fit;
}

std::optional<QuadricFit> between(const std::optional<QuadricFit>& smaller,
                                  const std::optional<QuadricFit>& larger, double weight) {
  if (!smaller || !larger) return std::nullopt;
  return between(*smaller, *larger, weight);
}

}  // namespace

/// The regions have radii r0 kStep^x, with integer x for those that are fitted. Between two of them
/// the quadrics are blended, linearly in x: the surface's curvature is one continuous function of
/// x, the same for all loads.
struct ContactSurface::State {
  Body finger, object;
  double angle;
  double smallest_m = 0, largest_m = 0;  ///< radii of regions
  double start_m = 0;                    ///< at x = 0
  int lowest = 0, highest = 0;           ///< x of the two ends
  std::map<int, Fits> fitted;
  std::map<int, std::exception_ptr> failed;
  std::map<int, bool> failed_too_small;
  int fits = 0;

  State(const ContactBody& one, const ContactBody& other, double angle_rad)
      : finger(one), object(other), angle(angle_rad) {
    if (!has_mesh()) return;
    // Most meshes have enough vertices, and their first region is needed anyway.
    try {
      place_regions();
      if (at(0)) return;
    } catch (const InputError&) {  // fewer vertices than a quadric needs
    }
    finger.read_facets_without_vertices();
    object.read_facets_without_vertices();
    failed.clear();
    failed_too_small.clear();
    place_regions();
  }

  void place_regions() {
    largest_m = largest_radius();
    smallest_m = std::min(radius_with_points(kFewestPoints), largest_m);
    try {
      start_m = std::min(radius_with_points(kStartingPoints), largest_m);
    } catch (const InputError&) {
      start_m = std::min(2 * smallest_m, largest_m);  // a coarse mesh: it has fewer altogether
    }
    start_m = std::max(start_m, smallest_m);
    const auto steps = [&](double radius_m) {
      return std::log(radius_m / start_m) / std::log(kStep);
    };
    lowest = int(std::floor(steps(smallest_m) + 1e-9));
    highest = int(std::ceil(steps(largest_m) - 1e-9));
  }

  bool has_mesh() const { return finger.mesh || object.mesh; }

  double radius_of(double x) const {
    return std::clamp(start_m * std::pow(kStep, x), smallest_m, largest_m);
  }

  double radius_with_points(int count) const {
    double radius = 0;
    for (const Body* body : {&finger, &object}) {
      if (!body->mesh) continue;
      radius = std::max(radius, body->radius_with(count));
    }
    return radius;
  }

  /// Radius beyond which no region grows any more.
  double largest_radius() const {
    double radius = kInfinity;
    for (const Body* body : {&finger, &object})
      if (body->mesh) radius = std::min(radius, body->mesh->extent_m());
    return radius;
  }

  int vertices_within(double radius_m) const {
    int count = std::numeric_limits<int>::max();
    for (const Body* body : {&finger, &object})
      if (body->mesh) count = std::min(count, body->mesh->vertices_within(radius_m));
    return count;
  }

  /// Null where no quadric can be fitted: `failed` says why.
  const Fits* at(int x) {
    if (const auto found = fitted.find(x); found != fitted.end()) return &found->second;
    if (failed.count(x)) return nullptr;
    Fits fit;
    fit.radius_m = radius_of(x);
    ++fits;
    try {
      if (finger.mesh) fit.finger = finger.fit(fit.radius_m);
      if (object.mesh) fit.object = object.fit(fit.radius_m);
    } catch (const InputError&) {  // vertices that do not determine a quadric: more are needed
      failed[x] = std::current_exception();
      failed_too_small[x] = true;
      return nullptr;
    } catch (const ConvergenceError&) {  // too strongly curved: less of it
      failed[x] = std::current_exception();
      failed_too_small[x] = false;
      return nullptr;
    }
    if (x != 0)
      if (const Fits* inner = at(x > 0 ? x - 1 : x + 1)) keep_growing(*inner, fit);
    return &fitted.emplace(x, std::move(fit)).first->second;
  }

  /// The relative curvatures as a matrix in the finger's axes; nothing without an ellipse.
  std::optional<Eigen::Matrix2d> curvature(const Fits& fit) const {
    const RelativeCurvature relative = patch_of(fit).relative;
    if (relative.kind != ContactKind::elliptic) return std::nullopt;
    const Eigen::Rotation2Dd turn(relative.radii.axis_rad);
    const Eigen::Vector2d curvatures(1 / relative.radii.major_m, 1 / relative.radii.minor_m);
    return turn.toRotationMatrix() * curvatures.asDiagonal() * turn.toRotationMatrix().transpose();
  }

  /// Contacts of one pair of bodies grow in all directions when the load rises: regions are nested.
  /// With a b = r²/2 both semi-axes grow if ln(a/b) changes by less than 2 ln r to the next
  /// region, where a/b is at most (R'/R'')^(2/3), as of a half-space. Half of that is allowed, for
  /// between the regions it does not change evenly. Where noise changes the curvatures by more, the
  /// quadric is blended with that of the neighbour, which lies nearer to the start.
  void keep_growing(const Fits& neighbour, Fits& fit) const {
    const double most = 1.5 * std::abs(std::log(fit.radius_m / neighbour.radius_m));
    const auto from = curvature(neighbour);
    if (!from || !curvature(fit)) return;
    const auto too_much = [&](const Fits& blended) {
      const auto to = curvature(blended);
      if (!to) return true;
      return !(log_of_stretches(*from, *to) <= most);
    };
    if (!too_much(fit)) return;
    double kept = 0, dropped = 1;
    const auto blend = [&](double weight) {
      return Fits{fit.radius_m, between(neighbour.finger, fit.finger, weight),
                  between(neighbour.object, fit.object, weight)};
    };
    for (int i = 0; i < 30; ++i) {
      const double weight = (kept + dropped) / 2;
      (too_much(blend(weight)) ? dropped : kept) = weight;
    }
    fit = blend(kept);
  }

  /// Interpolates the fits at a place between two radii; nothing where one of them could not be
  /// fitted.
  std::optional<Fits> between_fits(double x) {
    const double rounded = std::round(x);
    if (x == rounded) {
      const Fits* fit = at(int(rounded));
      return fit ? std::optional<Fits>(*fit) : std::nullopt;
    }
    const int below = int(std::floor(x));
    const Fits *const smaller = at(below), *const larger = at(below + 1);
    if (!smaller || !larger) return std::nullopt;
    const double weight = x - below;
    return Fits{smaller->radius_m * std::pow(larger->radius_m / smaller->radius_m, weight),
                between(smaller->finger, larger->finger, weight),
                between(smaller->object, larger->object, weight)};
  }

  double facet_doubt_m(const ContactPatch& patch, double radius_m) const {
    return std::hypot(patch.finger_fit ? finger.facet_doubt_m(*patch.finger_fit, radius_m) : 0,
                      patch.object_fit ? object.facet_doubt_m(*patch.object_fit, radius_m) : 0);
  }

  ContactPatch patch_of(const Fits& fits_there) const {
    ContactPatch patch;
    patch.finger_fit = fits_there.finger;
    patch.object_fit = fits_there.object;
    const auto covariance = [](const std::optional<QuadricFit>& fit) {
      return fit ? fit->covariance_per_m2 : Eigen::Matrix3d(Eigen::Matrix3d::Zero());
    };
    Quadric mirrored = object.exact ? *object.exact : fits_there.object->quadric;
    Eigen::Matrix3d object_covariance = covariance(fits_there.object);
    if (object.mesh) {
      // The object's own frame looks along its own outward normal; the finger sees it in a mirror.
      mirrored.C_per_m = -mirrored.C_per_m;
      object_covariance.row(2) *= -1;
      object_covariance.col(2) *= -1;
    }
    patch.relative =
        relative_curvature(finger.exact ? *finger.exact : fits_there.finger->quadric,
                           covariance(fits_there.finger), mirrored, object_covariance, angle);
    patch.region_area_m2 = kPi * fits_there.radius_m * fits_there.radius_m;
    return patch;
  }
};

namespace {

/// A region and the contact that is predicted with its radii of curvature.
struct Trial {
  double x = 0;
  double radius_m = 0;
  double wanted_m = kInfinity;        ///< radius of the region that the contact asks for; infinite
                                      ///< without an ellipse: a flat or saddle-like middle becomes
                                      ///< elliptic, if at all, in a larger region
  std::optional<ContactPatch> patch;  ///< none where no quadric can be fitted
  bool elliptic() const { return patch && patch->relative.kind == ContactKind::elliptic; }
  bool too_small() const { return wanted_m > radius_m; }
  double area_ratio() const { return radius_m * radius_m / (wanted_m * wanted_m); }
  double mismatch() const { return std::abs(std::log(area_ratio())); }
};

int points_of(const ContactPatch& patch) {
  int count = std::numeric_limits<int>::max();
  for (const auto* fit : {&patch.finger_fit, &patch.object_fit})
    if (*fit) count = std::min(count, (*fit)->points);
  return count;
}

}  // namespace

ContactSurface::ContactSurface(const ContactBody& finger, const ContactBody& object,
                               double angle_rad)
    : state_(std::make_unique<State>(finger, object, angle_rad)) {}
ContactSurface::~ContactSurface() = default;
ContactSurface::ContactSurface(ContactSurface&&) noexcept = default;
ContactSurface& ContactSurface::operator=(ContactSurface&&) noexcept = default;

ContactPatch ContactSurface::patch(
    const std::function<double(const RelativeRadii&)>& predicted_area_m2) {
  State& state = *state_;
  const auto predict = [&](ContactPatch& patch) {
    const double area = predicted_area_m2(patch.relative.radii);
    if (!(area > 0) || !std::isfinite(area))
      throw InputError("contact", "predicted area", number(area) + " m²", "positive and finite");
    patch.predicted_area_m2 = area;
  };
  if (!state.has_mesh()) {
    ContactPatch patch = state.patch_of({});
    patch.region_area_m2 = 0;
    if (patch.relative.kind == ContactKind::elliptic) predict(patch);
    return patch;
  }

  const int fits_before = state.fits;
  std::optional<Trial> best, first;
  const auto trial_at = [&](double x) {
    Trial trial;
    trial.x = x;
    trial.radius_m = state.radius_of(x);
    if (const auto fits = state.between_fits(x)) {
      trial.radius_m = fits->radius_m;
      trial.patch = state.patch_of(*fits);
      if (trial.elliptic()) {
        predict(*trial.patch);
        trial.wanted_m = std::sqrt(2 * trial.patch->predicted_area_m2 / kPi);
        if (!best || trial.mismatch() < best->mismatch()) best = trial;
      }
      if (!first || !first->elliptic()) first = trial;
    } else if (x == std::round(x) && !state.failed_too_small.at(int(x))) {
      trial.wanted_m = 0;
    }
    return trial;
  };

  // Searches outwards from the start to the first region that is large enough, or inwards to the
  // first that is not. As larger loads ask for larger regions, it grows with the load.
  Trial small = trial_at(0), large = small;
  if (small.too_small()) {
    // Beyond the ellipses there may be others, of another part of the surface.
    while (large.too_small() && large.x < state.highest &&
           (large.elliptic() || !small.elliptic())) {
      small = large;
      large = trial_at(large.x + 1);
    }
  } else {
    while (!small.too_small() && small.x > state.lowest) {
      large = small;
      small = trial_at(small.x - 1);
    }
  }
  if (small.elliptic() && large.elliptic() && small.too_small() && !large.too_small()) {
    // Blended quadrics of two ellipses are elliptic, and the mismatch is continuous.
    for (int i = 0; i < 60 && best->mismatch() > 1e-9; ++i) {
      const Trial middle = trial_at((small.x + large.x) / 2);
      (middle.too_small() ? small : large) = middle;
    }
  }
  if (!first) std::rethrow_exception(state.failed.begin()->second);

  const double tolerance = 0.02;
  const Trial& chosen = best ? *best : *first;
  ContactPatch patch = *chosen.patch;
  patch.agrees = best && std::abs(chosen.area_ratio() - 1) <= tolerance;
  if (best) {
    patch.facet_doubt_m = state.facet_doubt_m(patch, chosen.wanted_m);
    for (const double x : {chosen.x - 1, chosen.x + 1})
      if (x >= state.lowest && x <= state.highest)
        if (const auto fits = state.between_fits(x)) {
          const RelativeCurvature there = state.patch_of(*fits).relative;
          if (there.kind == ContactKind::elliptic)
            patch.radii_of_other_regions.push_back(there.radii);
        }
  }
  patch.iterations = state.fits - fits_before;
  for (const auto* fit : {&patch.finger_fit, &patch.object_fit})
    if (*fit) patch.covered = std::min(patch.covered, (*fit)->area_m2 / patch.region_area_m2);
  // Facets cut corners, and a rim just within the region is outside of the contact.
  constexpr double kCovered = 0.9;
  if (patch.agrees) {
    if (patch.covered < kCovered)
      patch.remark = "the surface covers " + number(100 * patch.covered) +
                     " % of the region: it is narrower than the contact, or ends beside it";
    return patch;
  }
  if (!best) {
    patch.remark = "no region from " + internal::millimetres(state.smallest_m) + " to " +
                   internal::millimetres(large.radius_m) + " gives an elliptic contact";
    return patch;
  }
  const std::string ratio = "the region of " + internal::millimetres(chosen.radius_m) + " (" +
                            std::to_string(points_of(patch)) + " vertices) is used, " +
                            number(chosen.area_ratio()) + " times twice the predicted area";
  if (chosen.too_small() && !large.patch) {
    patch.remark = "in larger regions no quadric follows the surface: " + ratio;
  } else if (chosen.too_small() && !large.elliptic()) {
    patch.remark = "in larger regions there is no elliptic contact: " + ratio;
  } else if (chosen.too_small()) {
    patch.remark = "the surface ends within " + internal::millimetres(chosen.wanted_m) +
                   " of the contact point: " + ratio;
  } else if (!small.elliptic() && small.patch) {
    patch.remark = "in smaller regions there is no elliptic contact: " + ratio;
  } else if (state.finger.by_facets || state.object.by_facets) {
    patch.remark = "the tessellation is curved only over several of its facets: " + ratio;
  } else {
    patch.remark = "the mesh has only " + std::to_string(state.vertices_within(chosen.wanted_m)) +
                   " vertices within " + internal::millimetres(chosen.wanted_m) +
                   " of the contact point, " + std::to_string(kFewestPoints) +
                   " are needed: " + ratio;
  }
  return patch;
}

ContactPatch fit_contact_patch(
    const ContactBody& finger, const ContactBody& object, double angle_rad,
    const std::function<double(const RelativeRadii&)>& predicted_area_m2) {
  return ContactSurface(finger, object, angle_rad).patch(predicted_area_m2);
}

}  // namespace softfinger
