#include "softfinger/pads/pad_error.h"

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/pads/pad_law.h"

namespace softfinger {
namespace {

/// Bounds of pad_layer. On 180 finite-element runs that nothing was fitted to (discs, and
/// rectangles to 8 : 1, nu 0.3 to 0.49) 95 % of the errors are below 2.8 % (torque), 1.9 % (arm as
/// pressed), 2 % (stiffness) and 3.6 % (tilt). The largest, of thick pads of 8 : 1,
/// are 4.0, 2.4, 3.1 and 6.5 %. The halves of discs, rectangles and polygons that were left out of
/// the fit (nu 0.1 to 0.4999) say the same. The peak is within 16 % on discs, tangential and
/// torsional stiffness within 9 %.
PadErrors layer_pad_bound(double poisson_ratio, double slenderness) noexcept {
  if (poisson_ratio == 0) return {0, 0, 0, 0, 0, 0.1, 0.1};  // exactly uniform
  // A disc has 1, a square 0.89, a rectangle of 2.5 : 1 0.8, an equilateral triangle 0.78. The
  // largest error of a triangle's torque is 3.9 %.
  constexpr double kSlender = 0.8;
  if (slenderness < kSlender) return {0.04, 0.25, 0.04, 0.045, 0.06, 0.1, 0.1};
  return {0.03, 0.2, 0.025, 0.025, 0.04, 0.1, 0.1};
}

/// Share of the face that has lifted off, beyond which no bound is stated.
constexpr double kMostLiftedOfBound = 0.5;

/// Adds what a lifted rim leaves open. Made from 270 frictionless finite-element runs of eccentric
/// loads (discs, and rectangles to 4 : 1, nu 0.3 to 0.49). Of 61 others (polygons too, nu 0.1 to
/// 0.4995) the torque is inside on all, indentation and area on 60. Of stuck faces only the torque
/// is known, which is the same.
void widen_by_lift_off(double lifted_share, PadPressing pressing, PadErrors& bound) noexcept {
  if (!(lifted_share > 0)) return;
  bound.max_torque += 0.06 * lifted_share;
  bound.pressure_arm += 0.06 * lifted_share;
  bound.indentation += 0.04 * lifted_share;
  bound.area = 0.05 + 0.1 * lifted_share;
  if (pressing == PadPressing::stuck)
    bound.indentation = bound.peak_pressure = bound.pressure_arm = kNaN;
}

/// Bounds of line_layer. On 23 finite-element runs that nothing was fitted to, within its validity
/// but for the strain (nu 0.1 to 0.4995, b/h 0.08 to 5.5), the largest errors are 0.44 % (d), 1.0 %
/// (stiffness), 0.56 % (arm), 1.9 % (tilt stiffness) and 3.3 % (peak); on the 24 runs of the fit
/// 0.55, 1.9, 0.85, 3.2 and 8 %. A side wall at two thicknesses takes up to 3.4 % of the stiffness
/// and 0.3 % of the arm; the nearest allowed, at three, about a quarter of that.
PadErrors line_bound() noexcept { return {0.03, 0.1, 0.015, 0.015, 0.04, kNaN, kNaN}; }

}  // namespace

std::optional<PadErrors> pad_error_bound(const PadModel& model,
                                         const PadProblem& problem) noexcept {
  if (&model == &line_layer()) {
    if (!model.predict(problem).valid()) return std::nullopt;
    return line_bound();
  }
  const PadModel& layer = *find_pad_model("pad_layer");
  const PadPrediction reference = layer.predict(problem);
  const double width = problem.shape->size_m() / problem.layer.thickness_m;
  const double slenderness =
      problem.shape->size_m() / std::sqrt(problem.shape->outline().area_m2() / kPi);
  if (!reference.valid() || width > pads::kLargestWidth ||
      reference.lifted_share > kMostLiftedOfBound)
    return std::nullopt;
  PadErrors bound = layer_pad_bound(problem.layer.poisson_ratio, slenderness);
  widen_by_lift_off(reference.lifted_share, problem.pressing, bound);
  if (&model == &layer) return bound;
  const PadPrediction other = model.predict(problem);
  if (!other.has_answer) return std::nullopt;
  const auto add = [](double& error, double number, double known) {
    error += std::abs(number / known - 1);
  };
  add(bound.indentation, other.indentation_m, reference.indentation_m);
  add(bound.peak_pressure, other.peak_pressure_Pa, reference.peak_pressure_Pa);
  add(bound.pressure_arm, other.pressure_arm_m, reference.pressure_arm_m);
  add(bound.max_torque, other.eccentricity_m, reference.eccentricity_m);
  add(bound.tilt_stiffness, other.tilt_stiffness_Nm_per_rad[0],
      reference.tilt_stiffness_Nm_per_rad[0]);
  return bound;
}

double friction_that_sticks(double poisson_ratio) noexcept {
  return std::max(0.2, 0.33 + 2.85 * (poisson_ratio - 0.3));
}

}  // namespace softfinger
