// Every model at random points of ranges far beyond fingertips: no NaN, no infinity, monotone where
// physics is monotone, the same in all units. Each test prints one line of a table.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>

#include "softfinger/friction/limit_surface.h"
#include "softfinger/friction/max_torque.h"
#include "tests/analytic/finite_prediction.h"
#include "tests/extremes/extreme_problem.h"

namespace softfinger {
namespace {

using testing::difference;
using testing::ExtremeProblems;
using testing::in_units;
using testing::in_words;
using testing::is_sound;

/// How many points, how often they ask a model beyond the first prediction, and how exactly.
struct Effort {
  int points;
  int second_look;         ///< every so many points
  double budget_s;         ///< of wall time
  double thinnest;         ///< least thickness over a half-space's contact
  double scale_tolerance;  ///< relative, under a change of units
  double slack;  ///< relative, in what must not grow as the layer becomes stiffer or thinner
};

/// Closed forms and tables lose a few roundings; the scaled input itself is rounded, too. A table's
/// own error, not monotone, is left over where the thickness does not matter any more. Models that
/// discretise and iterate are as exact as they state, and are asked for seconds only.
Effort effort_for(const PressureModel& model) {
  if (!model.card().hot_path) return {400, 8, 3, 0.2, 1e-5, 3e-3};
  const bool tabulated = model.card().name == "bonded_layer";
  return {1000000, 1, 1e9, 1e-9, 1e-12, tabulated ? 1e-4 : 1e-12};
}

/// Whether no table ends before this problem; beyond, a model says so and promises no more than a
/// finite and continuous answer.
bool within_tables(const Prediction& prediction) {
  for (const ValidityCheck& check : prediction.validity)
    if (std::string_view(check.check).substr(0, 6) == "table_" && !check.holds()) return false;
  return true;
}

class RandomPoints : public ::testing::TestWithParam<const PressureModel*> {};

TEST_P(RandomPoints, AreFiniteMonotoneAndFreeOfUnits) {
  const PressureModel& model = *GetParam();
  const Effort effort = effort_for(model);
  ExtremeProblems problems(20070322, effort.thinnest);
  int points = 0, answers = 0, valid = 0, failures = 0;
  double worst_scale = 0;
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const auto fail = [&](const char* what, const ContactProblem& problem) {
    ADD_FAILURE() << what << ": " << in_words(problem);
    ++failures;
  };
  for (; points < effort.points && failures < 5 && seconds() < effort.budget_s; ++points) {
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
    if (!(scale_error <= effort.scale_tolerance)) fail("depends on the units", problem);

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
    const double same = 1 + effort.slack;
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
    // A blunter contact is wider and less deep.
    other = problem;
    other.radii.minor_m = std::min(problem.radii.minor_m * factor, problem.radii.major_m);
    const Prediction blunter = model.predict(other);
    if (blunter.has_answer && within_tables(one) && within_tables(blunter) &&
        !(blunter.area_m2() * same >= one.area_m2() &&
          blunter.indentation_m <= one.indentation_m * same))
      fail("does not widen with R''", other);

    // Friction of any strength on it, for a pressure of any exponent.
    const double n = problems.one_in(4) ? -0.5 : problems.uniform(-0.5, 50);
    const double arm = torque_arm_exact_m(one.a_m, one.b_m, n);
    const double max_force_N = problem.load.friction_coefficient * problem.load.normal_force_N;
    if (!(arm > 0 && arm < one.a_m && std::isfinite(max_force_N * arm)))
      fail("torque arm", problem);
    if (points % 256 == 0) {
      const LimitSurface surface(one.a_m, one.b_m, n, max_force_N);
      const LimitWrench wrench =
          surface.wrench_for_twist({problems.uniform(-1, 1) * one.a_m,
                                    problems.uniform(-1, 1) * one.a_m, problems.uniform(-1, 1)});
      if (!(std::isfinite(wrench.force_x_N) && std::isfinite(wrench.force_y_N) &&
            std::isfinite(wrench.torque_Nm)))
        fail("limit surface", problem);
    }
  }
  std::printf("%-20s %8d points, %5.1f %% answered, %5.1f %% valid, units to %.1e, %.1f s\n",
              std::string(model.card().name).c_str(), points, 100.0 * answers / points,
              100.0 * valid / points, worst_scale, seconds());
}

INSTANTIATE_TEST_SUITE_P(Of, RandomPoints, ::testing::ValuesIn(all_pressure_models()),
                         testing::model_test_name);

}  // namespace
}  // namespace softfinger
