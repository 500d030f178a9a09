#include "comparisons/prediction/gap_sampling.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>

#include "meshes/placement/placed_surface.h"
#include "softfinger/fft/sampled_gap.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/layer_fft.h"

namespace softfinger::prediction {
namespace {

using Eigen::ArrayXd;
using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kRings = 128;  // of samples around the middle one
constexpr int kSide = 2 * kRings + 1;
constexpr int kFewestRings = 16;

/// Square lattice around the contact point, stretched to the contact's proportions.
struct Lattice {
  double spacing_x_m, spacing_y_m;
  double x_m(int column) const { return (column - kRings) * spacing_x_m; }
  double y_m(int row) const { return (row - kRings) * spacing_y_m; }
};

/// One body in the frame of the contact: z out of the finger, x along the long axis.
class PlacedBody {
 public:
  /// @param turn_rad  from that x to the body's own
  PlacedBody(const input::CaseBody& body, const std::string& name, bool is_finger,
             const std::optional<QuadricFit>& fit, const GeometryResolver& resolver,
             double turn_rad)
      : body_(body), name_(name), up_(is_finger ? 1 : -1), turn_(turn_rad) {
    const auto* mesh = std::get_if<input::MeshBody>(&body);
    if (!mesh) return;
    where_ = mesh->where;
    surface_ = std::make_unique<meshes::PlacedSurface>(
        resolver.surface(*mesh),
        meshes::SurfacePlacement{resolver.placed(*mesh).point_m, fit->normal, fit->x_axis,
                                 turn_rad},
        is_finger ? meshes::PlacedSurface::Body::below : meshes::PlacedSurface::Body::above);
    const Vector3d z = up_ * fit->normal;
    const Vector3d x = (fit->x_axis - fit->x_axis.dot(z) * z).normalized();
    const Eigen::AngleAxisd back(-turn_rad, z);
    x_axis_ = back * x;
    y_axis_ = back * z.cross(x);
  }

  struct Height {
    double z_m;         ///< NaN where there is no surface
    double rounding_m;  ///< SurfaceHit::rounding: how much farther out the smooth surface lies
  };
  Height height(double x_m, double y_m) const {
    if (surface_) {
      const auto hit = surface_->nearest_exit(Vector3d(x_m, y_m, 0), Vector3d(0, 0, up_));
      if (!hit) return {kNan, 0};
      return {hit->point.z(), hit->rounding};
    }
    if (const auto* sphere = std::get_if<input::SphereBody>(&body_)) {
      const double radius = sphere->radius_m, r2 = x_m * x_m + y_m * y_m;
      return {-up_ * r2 / (radius + std::sqrt(radius * radius - r2)), 0};
    }
    const auto& quadric = std::get<input::QuadricBody>(body_);
    const double c = std::cos(turn_), s = std::sin(turn_);
    const double u = c * x_m + s * y_m, v = c * y_m - s * x_m;
    return {-up_ * 0.5 * (u * u / quadric.radius_x_m + v * v / quadric.radius_y_m), 0};
  }

  /// "the finger's mesh ends, or has a hole or a step, near (1, 2, 3) mm"
  InputError ends_at(double x_m, double y_m, const std::string& consequence) const {
    if (!surface_)
      return InputError(where_, fmt::format("the {}'s sphere ends inside the contact", name_), "",
                        "");
    const Vector3d place = 1e3 * (surface_->contact_point_m() + x_m * x_axis_ + y_m * y_axis_);
    return InputError(where_,
                      fmt::format("the {}'s mesh ends, or has a hole or a step, near ({:.4g}, "
                                  "{:.4g}, {:.4g}) mm, {}",
                                  name_, place.x(), place.y(), place.z(), consequence),
                      "", "");
  }

 private:
  const input::CaseBody& body_;
  std::string name_, where_;
  double up_, turn_;
  std::unique_ptr<meshes::PlacedSurface> surface_;
  Vector3d x_axis_, y_axis_;  ///< the contact's axes in the mesh's coordinates
};

struct Samples {
  ArrayXd gap_m = ArrayXd::Zero(kSide * kSide);       ///< between the facets
  ArrayXd rounding_m = ArrayXd::Zero(kSide * kSide);  ///< by how much less it is between the smooth
                                                      ///< surfaces through the meshes' vertices
  /// The number of square rings of samples around the middle one inside the first place where a
  /// body ends or is too steep. `ending` is that body, (end_x_m, end_y_m) the place.
  int rings = kRings;
  const PlacedBody* ending = nullptr;
  double end_x_m = 0, end_y_m = 0;
};

Samples sample(const std::array<PlacedBody, 2>& bodies, const Lattice& lattice) {
  constexpr double kSteepest = 1.7320508;  // tan 60 degrees
  Samples samples;
  ArrayXd heights(kSide * kSide);
  for (const PlacedBody& body : bodies) {
    for (int i = 0, k = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j, ++k) {
        const auto height = body.height(lattice.x_m(j), lattice.y_m(i));
        heights[k] = height.z_m;
        samples.rounding_m[k] += height.rounding_m;
      }
    // The finger lies below: the gap is the object's height minus the finger's.
    samples.gap_m += (&body == &bodies[0] ? -1 : 1) * heights;
    for (int i = 0, k = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j, ++k) {
        const auto steep = [&](int neighbour, double spacing_m) {
          return !(std::abs(heights[neighbour] - heights[k]) <= kSteepest * spacing_m);
        };
        if (std::isfinite(heights[k]) && !(j + 1 < kSide && steep(k + 1, lattice.spacing_x_m)) &&
            !(i + 1 < kSide && steep(k + kSide, lattice.spacing_y_m)))
          continue;
        const int ring = std::max(std::abs(i - kRings), std::abs(j - kRings));
        if (ring - 1 >= samples.rings) continue;
        samples.rings = std::max(0, ring - 1);
        samples.ending = &body;
        samples.end_x_m = lattice.x_m(j);
        samples.end_y_m = lattice.y_m(i);
      }
  }
  return samples;
}

/// The middle square of the samples as a gap, `rings` around the centre: within it both bodies have
/// a surface without a step. Nothing is smoothed.
SampledGap gap_within(const ArrayXd& samples_m, int rings, const Lattice& lattice) {
  const int first = kRings - rings, side = 2 * rings + 1;
  ArrayXd gap_m(side * side);
  for (int i = 0; i < side; ++i)
    gap_m.segment(i * side, side) = samples_m.segment((first + i) * kSide + first, side);
  return SampledGap({lattice.x_m(first), lattice.y_m(first), lattice.spacing_x_m,
                     lattice.spacing_y_m, side, side},
                    gap_m);
}

/// Relative changes of the answer when the facets are rounded. NaN when the rounded bodies have no
/// answer.
SampledGapResult::Changes changes_by_rounding(const Prediction& facets, const Samples& samples,
                                              const Lattice& lattice,
                                              const ContactProblem& problem) {
  try {
    const SampledGap gap = gap_within(samples.gap_m - samples.rounding_m, samples.rings, lattice);
    const Prediction rounded = predict_layer_fft(gap, gap.window(), problem).prediction;
    const auto change = [&](double Prediction::*quantity) {
      return std::abs(rounded.*quantity / (facets.*quantity) - 1);
    };
    return {change(&Prediction::a_m), change(&Prediction::b_m), change(&Prediction::indentation_m),
            change(&Prediction::torque_arm_exact_m), change(&Prediction::peak_pressure_Pa)};
  } catch (const ConvergenceError&) {
    return {kNan, kNan, kNan, kNan, kNan};
  }
}

ValidityCheck facets_check(const SampledGapResult::Changes& changes) {
  const double largest = std::max({changes.a, changes.b, changes.indentation, changes.torque});
  return {"facets_resolve_contact", std::isfinite(largest) ? largest : 1, 0.1, true,
          "the mesh is coarse against the contact: rounding its facets by the mesh's own normals "
          "changes the answer by that much"};
}

}  // namespace

ModelAnswer ask_sampled_gap(const GeometryResolver& resolver, const LocalGeometry& geometry,
                            const input::Case& contact_case, double load_N) {
  const auto start = std::chrono::steady_clock::now();
  if (!geometry.patch)
    throw InputError(contact_case.geometry_where, "--gap", "sampled",
                     "a finger or an object that is a mesh; this case has none, its gap is a "
                     "quadric");
  const auto& pair = std::get<input::BodyPair>(contact_case.geometry);
  const double axis_rad = geometry.radii.axis_rad;
  const std::array<PlacedBody, 2> bodies{
      PlacedBody(pair.finger, "finger", true, geometry.patch->finger_fit, resolver, -axis_rad),
      PlacedBody(pair.object, "object", false, geometry.patch->object_fit, resolver,
                 pair.angle_rad - axis_rad)};

  ModelAnswer answer;
  answer.model = find_pressure_model("layer_fft");
  answer.problem = contact_problem(contact_case, geometry, load_N);
  answer.shear_law = contact_case.shear_law;
  const Prediction fitted = find_pressure_model(geometry.patch_model)->predict(answer.problem);
  constexpr std::array<double, 2> kReaches{2.5, 6};  // of the fitted ellipse
  for (const double reach : kReaches) {
    const Lattice lattice{reach * fitted.a_m / kRings, reach * fitted.b_m / kRings};
    const Samples samples = sample(bodies, lattice);
    if (samples.rings < kFewestRings)
      throw samples.ending->ends_at(samples.end_x_m, samples.end_y_m, "inside the contact");
    const SampledGap gap = gap_within(samples.gap_m, samples.rings, lattice);
    try {
      const GapPrediction result = predict_layer_fft(gap, gap.window(), answer.problem);
      answer.prediction = result.prediction;
      const fft::ContactEdge& edge = result.contact.edge;
      SampledGapResult sampled;
      sampled.centre_m = Eigen::Rotation2Dd(axis_rad) * edge.centre;
      sampled.region_area_m2 = edge.area;
      sampled.edge_deviation = edge.deviation;
      sampled.spacing_m = std::max(lattice.spacing_x_m, lattice.spacing_y_m);
      sampled.changes_by_rounding =
          changes_by_rounding(answer.prediction, samples, lattice, answer.problem);
      answer.prediction.validity.add(facets_check(sampled.changes_by_rounding));
      if (answer.problem.stack.count == 0)
        check_homogeneity(contact_case, answer.prediction.validity);
      answer.sampled = sampled;
      answer.problem.radii.axis_rad = std::remainder(axis_rad + edge.axis_rad, M_PI);
      break;
    } catch (const ContactReachesBorder&) {
      if (samples.ending)
        throw samples.ending->ends_at(
            samples.end_x_m, samples.end_y_m,
            fmt::format("and the contact at {:g} N reaches that far: the mesh has to cover it",
                        load_N));
      if (reach == kReaches.back()) throw;
    } catch (const ConvergenceError& error) {
      throw ConvergenceError("layer_fft on the gap sampled from the meshes", error.iteration(),
                             error.residual(),
                             "the meshes touch in several places, or are coarse or noisy against "
                             "the contact; --gap quadric smooths them");
    }
  }
  answer.cost_ns =
      std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
  return answer;
}

}  // namespace softfinger::prediction
