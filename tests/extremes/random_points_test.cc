// Every model at random points of ranges far beyond fingertips: no NaN, no infinity, monotone where
// physics is monotone, the same in all units. Each test prints one line of a table.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>

#include "softfinger/friction/limit_surface.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/pressure/stack_models.h"
#include "tests/analytic/finite_prediction.h"
#include "tests/extremes/extreme_problem.h"

namespace softfinger {
namespace {

using testing::difference;
using testing::ExtremeProblems;
using testing::in_units;
using testing::in_words;
using testing::is_sound;

/// Largest relative change by a change of units: the rounding of the scaled input, as amplified by
/// the model. Layers on both bodies are solved by 5 x 5 Galerkin equations of a condition of some
/// 1e4, and their differences to those of one layer.
double units_tolerance(const PressureModel& model) { return is_for_stacks(model) ? 1e-9 : 1e-12; }

/// Numbers of points, and of those at which a model is asked for more than a first prediction.
struct Effort {
  int points;
  int second_look;  ///< every so many points
  double thinnest;  ///< least thickness over a half-space's contact
};

/// Models that discretise and iterate are asked for seconds only.
Effort effort_for(const PressureModel& model) {
  if (!model.card().hot_path) return {64, 8, 0.2};
  if (is_for_stacks(model)) return {30000, 1, 1e-9};
  return {1000000, 1, 1e-9};
}

/// Whether no table ends before this problem. Beyond its table a model says so, and its answer only
/// has to be finite and continuous.
bool within_tables(const Prediction& prediction) {
  for (const ValidityCheck& check : prediction.validity)
    if (std::string_view(check.check).substr(0, 6) == "table_" && !check.holds()) return false;
  return true;
}

class RandomPoints : public ::testing::TestWithParam<const PressureModel*> {};

TEST_P(RandomPoints, AreFiniteMonotoneAndFreeOfUnits) {
  const PressureModel& model = *GetParam();
  const Effort effort = effort_for(model);
  const double monotone = model.card().accuracy.monotone;
  ExtremeProblems problems(20070322, effort.thinnest);
  int points = 0, answers = 0, valid = 0, failures = 0;
  double worst_scale = 0;
  const auto fail = [&](const char* what, const ContactProblem& problem) {
    ADD_FAILURE() << what << ": " << in_words(problem);
    ++failures;
  };
  for (; points < effort.points && failures < 5; ++points) {
    if (points % 16 == 5) {
      const ContactProblem broken = problems.draw_broken();
      if (!is_sound(model.predict(broken))) fail("not finite", broken);
      continue;
    }
    const ContactProblem problem = problems.draw();
    const Prediction one = model.predict(problem);
    if (!is_sound(one)) fail("not finite", problem);
    answers += one.has_answer;
    valid += one.valid();
    const double pressure_Pa = model.pressure_Pa(problem, one, 0.3 * one.a_m, 0.4 * one.b_m);
    if (!(pressure_Pa >= 0 && std::isfinite(pressure_Pa))) fail("pressure", problem);
    if (points % effort.second_look != 0) continue;

    const double length = problems.log_uniform(1e-3, 1e3), force = problems.log_uniform(1e-3, 1e3);
    const Prediction scaled = model.predict(in_units(problem, length, force));
    if (scaled.has_answer != one.has_answer) fail("answers in some units only", problem);
    if (!one.has_answer || !scaled.has_answer) continue;
    const double scale_error = difference(one, scaled, length, force);
    worst_scale = std::max(worst_scale, scale_error);
    if (!(scale_error <= units_tolerance(model))) fail("depends on the units", problem);

    // More load: a larger contact. Steps below 1e-3 would test rounding instead.
    const double factor = 1 + problems.log_uniform(1e-3, 10);
    ContactProblem other = problem;
    other.load.normal_force_N *= factor;
    const Prediction heavier = model.predict(other);
    if (heavier.has_answer && !(heavier.a_m > one.a_m && heavier.b_m > one.b_m &&
                                heavier.indentation_m > one.indentation_m &&
                                heavier.torque_arm_exact_m > one.torque_arm_exact_m &&
                                heavier.torque_arm_paper_m > one.torque_arm_paper_m))
      fail("shrinks under load", other);

    // Stiffer, or thinner on its rigid base: a smaller contact, or the same where the model does
    // not take notice. Semi-axes only together: as a layer becomes thin a long ellipse becomes
    // rounder.
    const double same = 1 + monotone;
    const auto no_larger = [&](const Prediction& stiffer) {
      if (!within_tables(one) || !within_tables(stiffer)) return true;
      return !stiffer.has_answer || (stiffer.area_m2() <= one.area_m2() * same &&
                                     stiffer.indentation_m <= one.indentation_m * same);
    };
    other = problem;
    other.layer.youngs_modulus_Pa *= factor;
    if (!no_larger(model.predict(other))) fail("grows with Young's modulus", other);
    other = problem;
    other.layer.thickness_m /= factor;
    if (!no_larger(model.predict(other))) fail("grows as the layer becomes thinner", other);
    // Less compressible at the same Young's modulus: stiffer, too. A model that takes any layer for
    // incompressible sees its shear modulus only, which falls.
    other = problem;
    other.layer.poisson_ratio += (0.5 - other.layer.poisson_ratio) * problems.uniform(0, 1);
    // This holds in linear theory only: under large compression a compressible layer stiffens, and
    // finite elements find the contact of a sphere with a/R = 0.6 on a thick layer larger at nu =
    // 0.3 than at 0.16.
    const bool follows_linear_theory = model.card().name != "fingertip_layer";
    if (model.card().name != "thin_incompressible" && follows_linear_theory &&
        !no_larger(model.predict(other)))
      fail("grows with Poisson's ratio", other);
    // A blunter contact is wider and less deep.
    const auto wider = [&](const Prediction& blunter) {
      if (!within_tables(one) || !within_tables(blunter)) return true;
      return !blunter.has_answer || (blunter.area_m2() * same >= one.area_m2() &&
                                     blunter.indentation_m <= one.indentation_m * same);
    };
    other = problem;
    other.radii.minor_m = std::min(problem.radii.minor_m * factor, problem.radii.major_m);
    if (!wider(model.predict(other))) fail("does not widen with R''", other);
    other = problem;
    other.radii.major_m *= factor;
    if (!wider(model.predict(other))) fail("does not widen with R'", other);

    // Friction of any strength on it, for a pressure of any exponent.
    const double n = problems.one_in(4) ? -0.5 : problems.uniform(-0.5, 50);
    const double arm = torque_arm_exact_m(one.a_m, one.b_m, n);
    const double max_force_N = problem.load.friction_coefficient * problem.load.normal_force_N;
    if (!(arm > 0 && arm < one.a_m && std::isfinite(max_force_N * arm)))
      fail("torque arm", problem);
  }
  std::printf("%-20s %8d points, %5.1f %% answered, %5.1f %% valid, units to %.1e\n",
              std::string(model.card().name).c_str(), points, 100.0 * answers / points,
              100.0 * valid / points, worst_scale);
}

/// Limit surfaces of contacts of any size, aspect and exponent: finite, within the cylinder of the
/// largest force and torque, convex, more torque for more turning, the same in all units.
TEST(RandomLimitSurfaces, AreFiniteConvexAndFreeOfUnits) {
  constexpr int kSurfaces = 40000, kSlips = 4;
  ExtremeProblems random(1996);
  int failures = 0;
  double worst_scale = 0, worst_convexity = 0;
  for (int i = 0; i < kSurfaces && failures < 5; ++i) {
    const double b = random.log_uniform(1e-12, 1e3);
    const double ratio = random.one_in(6) ? 1 : random.log_uniform(1, 1e8);
    const double n = random.one_in(3) ? 0.5 : random.uniform(-0.5, 50);
    const double max_force_N = random.log_uniform(1e-24, 1e12);
    const double length = random.log_uniform(1e-3, 1e3), force = random.log_uniform(1e-3, 1e3);
    const LimitSurface surface(b * ratio, b, n, max_force_N);
    const LimitSurface rescaled(length * surface.a_m(), length * b, n, force * max_force_N);
    const double arm = surface.eccentricity_m();
    // The accuracy that limit_surface.h states.
    const double tolerance = std::max(1e-12, 4e-16 * std::min(ratio, 3e6));
    const auto fail = [&](const char* what) {
      ADD_FAILURE() << what << ": " << b * ratio << " " << b << " " << n << " " << max_force_N;
      ++failures;
    };
    // Scaled by the largest force and torque, or (v, e_n omega).
    const auto scaled = [](const LimitSurface& of, const Twist& slip) -> Eigen::Vector3d {
      const LimitWrench wrench = of.wrench_for_twist(slip);
      return Eigen::Vector3d(wrench.force_x_N, wrench.force_y_N,
                             wrench.torque_Nm / of.eccentricity_m()) /
             of.max_force_N();
    };
    std::array<Eigen::Vector3d, kSlips> slips, wrenches;
    for (int k = 0; k < kSlips; ++k) {
      Eigen::Vector3d& slip = slips[k];
      slip = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      if (random.one_in(2)) slip.z() *= random.log_uniform(1e-9, 1e9);
      wrenches[k] = scaled(surface, {slip.x(), slip.y(), slip.z() / arm});
      if (!wrenches[k].allFinite() || wrenches[k].head<2>().norm() > 1 + tolerance ||
          std::abs(wrenches[k].z()) > 1 + tolerance)
        fail("beyond the largest force or torque");
    }
    const Eigen::Vector3d& slip = slips[0];
    const double omega = slip.z() / arm;
    const double units =
        (scaled(rescaled, {slip.x() * length, slip.y() * length, omega}) - wrenches[0]).norm();
    worst_scale = std::max(worst_scale, units);
    if (!(units <= tolerance)) fail("depends on the units");
    const double faster = omega * (1 + random.log_uniform(1e-3, 10));
    const double torque = scaled(surface, {slip.x(), slip.y(), faster}).z();
    if (!(std::abs(torque) >= std::abs(wrenches[0].z()) * (1 - tolerance)))
      fail("less torque for more turning");
    // The set is convex: among all wrenches that can be carried, that of a slip dissipates most in
    // it.
    for (const Eigen::Vector3d& other : wrenches) {
      const double excess = slips[0].dot(other - wrenches[0]) / slips[0].norm();
      worst_convexity = std::max(worst_convexity, excess);
      if (!(excess <= tolerance)) fail("not convex");
    }
  }
  std::printf("%-20s %8d points, units to %.1e, convex to %.1e\n", "limit surface",
              kSurfaces * kSlips, worst_scale, worst_convexity);
}

INSTANTIATE_TEST_SUITE_P(Of, RandomPoints, ::testing::ValuesIn(all_pressure_models()),
                         testing::model_test_name);

}  // namespace
}  // namespace softfinger
