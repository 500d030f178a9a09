// Contacts of rubber that relaxes, followed by finite elements with internal variables: against the
// elastic contacts of both moduli, Lee and Radok, and Ting, none of which the elements know.

#include "fem/contact/contact_in_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fem/problem/check_problem.h"
#include "fem/program/reference_solver.h"
#include "softfinger/input/errors.h"
#include "softfinger/time/contact_history.h"

namespace softfinger::fem {
namespace {

const Progress unheard = [](const std::string&) {};
constexpr double forever = std::numeric_limits<double>::infinity();

const Relaxation rubber({{0.15, 0.3}, {0.1, 4}});

Problem elastic(double load_N, double modulus_ratio = 1) {
  Problem problem;
  problem.contact.layer = {2e-3, 3e5 * modulus_ratio, 0.49};
  problem.contact.radii = {0.02, 0.012, 0};
  problem.contact.load = {load_N, 0.8};
  problem.level = 1;
  return problem;
}

Problem relaxing(const std::vector<HistoryPoint>& points, double time_s) {
  PressedInTime pressed;
  for (const RelaxationTerm& term : rubber.terms())
    pressed.terms.push_back({term.share, term.time_s});
  for (const HistoryPoint& point : points) pressed.points.push_back({point.time_s, point.value});
  pressed.time_s = time_s;
  Problem problem = elastic(value_at(pressed, time_s));
  problem.in_time = pressed;
  return problem;
}

/// Size, approach and torque are those of the elastic contact under this load, but for its
/// pressure.
void expect_as_large_as(const Result& result, double effective_load_N, double of_time_steps) {
  const Result same = solve(elastic(effective_load_N), unheard);
  EXPECT_NEAR(result.finest.a_m / same.finest.a_m, 1, of_time_steps);
  EXPECT_NEAR(result.finest.b_m / same.finest.b_m, 1, of_time_steps);
  EXPECT_NEAR(result.finest.indentation_m / same.finest.indentation_m, 1, of_time_steps);
}

TEST(ContactInTime, BeginsAndEndsAsTheElasticContactsOfBothModuli) {
  const double load_N = 3;
  const Result at_once = solve(relaxing({{0, load_N}}, 0), unheard),
               soft = solve(elastic(load_N), unheard);
  // Matrices and load are the same: round-off.
  EXPECT_NEAR(at_once.finest.a_m / soft.finest.a_m, 1, 1e-12);
  EXPECT_NEAR(at_once.finest.indentation_m / soft.finest.indentation_m, 1, 1e-12);
  EXPECT_NEAR(at_once.finest.max_torque_Nm / soft.finest.max_torque_Nm, 1, 1e-12);
  // The first mesh is guessed from the modulus, unless a size is expected.
  Problem rests = relaxing({{0, load_N}}, forever),
          softer = elastic(load_N, rubber.long_time_modulus());
  rests.size_hint_m = softer.size_hint_m = {soft.finest.a_m, soft.finest.b_m};
  const Result at_rest = solve(rests, unheard), of_rest = solve(softer, unheard);
  EXPECT_NEAR(at_rest.finest.a_m / of_rest.finest.a_m, 1, 1e-12);
  EXPECT_NEAR(at_rest.finest.indentation_m / of_rest.finest.indentation_m, 1, 1e-12);
  EXPECT_NEAR(at_rest.finest.peak_pressure_Pa / of_rest.finest.peak_pressure_Pa, 1, 1e-12);
}

TEST(ContactInTime, GrowsAsLeeAndRadokSay) {
  for (const double time_s : {0.05, 1., 10.}) {
    const Result held = solve(relaxing({{0, 3}}, time_s), unheard);
    // Eight steps for each time constant, to the second order. Both meshes are of level 1, for
    // sizes that are rounded to 0.1 %.
    expect_as_large_as(held, 3 * rubber.compliance(time_s), 3e-3);
  }
}

TEST(ContactInTime, OfASphereOnAThickLayerIsTheClosedForm) {
  // E0 J(t) P = 4 E* a³/(3 R): a/h is 0.013, so that the core below changes a by less than that
  // times nu's factor, some 0.3 %.
  Problem problem = relaxing({{0, 0}, {0.1, 0.05}}, 2);
  problem.contact.layer = {0.1, 3e5, 0.3};
  problem.contact.radii = {0.01, 0.01, 0};
  const ContactHistory history(rubber, ContactHistory::Drive::load, {{0, 0}, {0.1, 0.05}});
  const double load_N = history.at(2).size;
  const double radius_m =
      std::cbrt(3 * load_N * 0.01 / (4 * problem.contact.layer.plane_strain_modulus_Pa()));
  const Result result = solve(problem, unheard);
  EXPECT_NEAR(result.finest.a_m / radius_m, 1, result.error.a + 3e-3);
  EXPECT_NEAR(result.finest.indentation_m / (radius_m * radius_m / 0.01), 1, 0.02)
      << "the core below takes some of the approach";
}

TEST(ContactInTime, ShrinksAsTingSays) {
  const std::vector<HistoryPoint> points = {{0, 0}, {0.2, 5}, {4, 5}, {5, 1}};
  const ContactHistory history(rubber, ContactHistory::Drive::load, points);
  for (const double time_s : {4.3, 4.8}) {
    const Result result = solve(relaxing(points, time_s), unheard);
    const Result same = solve(elastic(history.at(time_s).size), unheard);
    // The mesh is that of the largest contact, four elements along its semi-axis: its stated error.
    EXPECT_NEAR(result.finest.a_m / same.finest.a_m, 1, result.error.a + same.error.a);
    EXPECT_NEAR(result.finest.b_m / same.finest.b_m, 1, result.error.b + same.error.b);
    // The approach lags behind the size.
    EXPECT_GT(result.finest.indentation_m, 1.005 * same.finest.indentation_m);
  }
}

TEST(ContactInTime, GrowsBeyondAnEarlierMaximumAsIfItHadNeverShrunk) {
  // Then the integral of a growing contact holds again (G. A. C. Graham, Int. J. Eng. Sci. 5,
  // 1967).
  const std::vector<HistoryPoint> points = {{0, 0},     {0.2, 2}, {1, 2},
                                            {1.2, 0.3}, {3, 0.3}, {3.3, 6}};
  double effective_N = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double slope =
        (points[i].value - points[i - 1].value) / (points[i].time_s - points[i - 1].time_s);
    constexpr int panels = 1000;
    const double width_s = (points[i].time_s - points[i - 1].time_s) / panels;
    for (int k = 0; k < panels; ++k)
      effective_N +=
          slope * width_s * rubber.compliance(3.3 - points[i - 1].time_s - (k + 0.5) * width_s);
  }
  expect_as_large_as(solve(relaxing(points, 3.3), unheard), effective_N, 3e-3);
}

TEST(ContactInTime, OfAnApproachThatIsHeldLosesItsLoad) {
  const double approach_m = 4e-4;
  Problem problem = relaxing({{0, approach_m}}, 1.5), at_once = elastic(1);
  problem.approach_m = at_once.approach_m = approach_m;
  const Result held = solve(problem, unheard), pressed = solve(at_once, unheard);
  EXPECT_NEAR(held.finest.load_N / pressed.finest.load_N, rubber.modulus(1.5), 1e-12)
      << "the size stays, and all forces fall alike: round-off";
  EXPECT_NEAR(held.finest.a_m / pressed.finest.a_m, 1, 1e-12);
}

TEST(ContactInTime, RefusesWhatItDoesNotKnow) {
  const Problem problem = relaxing({{0, 3}}, 1);
  EXPECT_NO_THROW(check_problem(problem));
  Problem other = problem;
  other.pressing = PressingFriction::coulomb;
  EXPECT_THROW(check_problem(other), InputError);
  other = problem;
  other.finite_strain.emplace();
  EXPECT_THROW(check_problem(other), InputError);
  other = problem;
  other.friction.torsion = true;
  EXPECT_THROW(check_problem(other), InputError);
  other = problem;
  other.in_time->terms.push_back({0.8, 1});
  EXPECT_THROW(check_problem(other), InputError) << "nothing is left of the modulus";
  other = problem;
  other.in_time->points.push_back({-1, 2});
  EXPECT_THROW(check_problem(other), InputError) << "times that fall";
  other = problem;
  other.contact.load.normal_force_N = 1e-299;
  EXPECT_THROW(check_problem(other), InputError) << "no contact that a mesh has";
  other = problem;
  other.in_time->time_s = -1;
  EXPECT_THROW(check_problem(other), InputError);
  other = problem;
  other.in_time->points.front().value = std::nan("");
  EXPECT_THROW(check_problem(other), InputError);
}

}  // namespace
}  // namespace softfinger::fem
