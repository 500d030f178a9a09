// write_explorer_points: random contacts and what the library says of them, one JSON object a line
// on standard output, for explorer_points.mjs. Every `kDetailed`-th has the limit surface and the
// lines for simulators too.
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "comparisons/explorer/explorer.h"
#include "comparisons/exporting/contact_curve.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/input/case.h"
#include "comparisons/text/json_text.h"
#include "softfinger/accuracy/pressing_error.h"
#include "softfinger/friction/ellipsoid_deviation.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/pressure/equivalent_exponent.h"
#include "softfinger/pressure/rubbed_prediction.h"

namespace softfinger {
namespace {

using nlohmann::json;

constexpr int kPoints = 10000, kDetailed = 10;
constexpr double kTolerance = 0.1;
/// Numbers of points that the page draws.
constexpr int kSectionPoints = 41, kProfilePoints = 49;

/// The contact as it is pressed with friction, where the model knows it.
Prediction pressed_by(const PressureModel& model, const ContactProblem& problem) {
  const Prediction frictionless = model.predict(problem);
  return frictionless.has_answer && knows_pressing_friction(model)
             ? rubbed(model, frictionless, problem, problem.load.friction_coefficient)
             : frictionless;
}

json numbers_of(const PressureModel& model, const ContactProblem& problem) {
  Prediction prediction = model.predict(problem);
  if (!prediction.has_answer) return {{"name", model.card().name}, {"has_answer", false}};
  const double mu = problem.load.friction_coefficient;
  const ErrorBound bound = error_bound(model, problem, mu);
  if (!knows_pressing_friction(model))
    prediction.validity.add(check_frictionless_pressing(model, prediction, problem, mu));
  int failing = 0;
  for (const ValidityCheck& check : prediction.validity) failing += !check.holds();
  const Prediction pressed = pressed_by(model, problem);
  return {{"name", model.card().name},
          {"has_answer", true},
          {"a_m", pressed.a_m},
          {"b_m", pressed.b_m},
          {"indentation_m", pressed.indentation_m},
          {"area_m2", pressed.area_m2()},
          {"peak_pressure_Pa", pressed.peak_pressure_Pa},
          {"max_torque_Nm", problem.load.friction_coefficient * problem.load.normal_force_N *
                                prediction.torque_arm_exact_m},
          {"eccentricity_m", prediction.torque_arm_exact_m},
          {"bound", bound.known ? json(bound.bound) : json()},
          {"failing", failing}};
}

/// Section along one axis of the ellipse, from pure force to pure torque.
json section_of(const LimitSurface& surface, const Eigen::Vector2d& axis, double eccentricity_m,
                int points) {
  json section = json::array();
  for (int i = 0; i < points; ++i) {
    const double angle_rad = kPi / 2 * i / (points - 1);
    const bool turns_only = i + 1 == points;
    const Eigen::Vector2d slide = (turns_only ? 0 : std::cos(angle_rad)) * axis;
    const LimitWrench wrench =
        surface.wrench_for_twist({slide.x(), slide.y(), std::sin(angle_rad) / eccentricity_m});
    section.push_back(
        {Eigen::Vector2d(wrench.force_x_N, wrench.force_y_N).dot(axis), wrench.torque_Nm});
  }
  return section;
}

json limit_of(const PressureModel& model, const ContactProblem& problem) {
  const Prediction prediction = model.predict(problem);
  const double max_force_N = problem.load.friction_coefficient * problem.load.normal_force_N;
  const FrictionEllipsoid ellipsoid{max_force_N, prediction.torque_arm_exact_m};
  const double exponent = equivalent_exponent(prediction);
  const LimitSurface surface(prediction.a_m, prediction.b_m, exponent, max_force_N);
  const EllipsoidDeviation deviation = worst_ellipsoid_deviation(surface, ellipsoid);
  const double e_n = prediction.torque_arm_exact_m;
  return {{"exponent", exponent},
          {"max_force_N", max_force_N},
          {"max_torque_Nm", ellipsoid.max_torque_Nm()},
          {"lowest", deviation.lowest},
          {"highest", deviation.highest},
          {"along_long", section_of(surface, {1, 0}, e_n, kSectionPoints)},
          {"along_short", section_of(surface, {0, 1}, e_n, kSectionPoints)}};
}

json profile_of(const PressureModel& model, const ContactProblem& problem) {
  const Prediction prediction = pressed_by(model, problem);
  json along_long = json::array(), along_short = json::array();
  for (int i = 0; i < kProfilePoints; ++i) {
    const double part = std::sin(kPi / 2 * i / (kProfilePoints - 1));
    along_long.push_back(model.pressure_Pa(problem, prediction, part * prediction.a_m, 0));
    along_short.push_back(model.pressure_Pa(problem, prediction, 0, part * prediction.b_m));
  }
  return {{"long_Pa", along_long}, {"short_Pa", along_short}};
}

/// Settings of the simulators, as `softfinger export` writes them.
json simulators_of(const PressureModel& model, const ContactProblem& problem) {
  input::Case contact_case;
  contact_case.id = "explorer";
  contact_case.geometry = problem.radii;
  contact_case.layer = problem.layer;
  contact_case.loads_N = {problem.load.normal_force_N};
  contact_case.shear_law = ShearLaw::coulomb(problem.load.friction_coefficient);
  contact_case.pressing = PressingFriction::coulomb;
  const prediction::GeometryResolver resolver(contact_case);
  prediction::Demand demand;
  demand.tolerance = kTolerance;
  const exporting::ContactCurve curve = exporting::ask_contact_curve(
      contact_case, resolver, &model, exporting::choose_loads(contact_case.loads_N, {}), demand);
  json texts = json::object();
  for (const exporting::Simulator& simulator : exporting::all_simulators())
    texts[std::string(simulator.name)] =
        point_lines(simulator, soft_contact(curve, simulator, exporting::Fit::nominal)).text;
  return texts;
}

}  // namespace
}  // namespace softfinger

int main() try {
  using namespace softfinger;
  std::mt19937_64 random(20261125);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, uniform(random));
  };
  for (int i = 0; i < kPoints; ++i) {
    ContactProblem problem;
    // The ranges of the sliders. A tenth of the points has exactly nu = 1/2, a tenth equal radii.
    problem.radii.minor_m = between(1e-3, 1);
    problem.radii.major_m =
        i % 10 == 1 ? problem.radii.minor_m : problem.radii.minor_m * between(1, 30);
    problem.layer.thickness_m = between(1e-4, 5e-2);
    problem.layer.youngs_modulus_Pa = between(1e3, 1e7);
    problem.layer.poisson_ratio = i % 10 == 2 ? 0.5 : 0.5 * uniform(random);
    problem.load.normal_force_N = between(1e-2, 1e3);
    problem.load.friction_coefficient = between(0.05, 3);
    const int shown = i % kDetailed == 0 ? i / kDetailed % int(explorer::models().size()) : -2;
    nlohmann::json point = {
        {"numbers",
         {problem.radii.major_m, problem.radii.minor_m, problem.layer.thickness_m,
          problem.layer.youngs_modulus_Pa, problem.layer.poisson_ratio, problem.load.normal_force_N,
          problem.load.friction_coefficient, kTolerance, shown}}};
    point["models"] = nlohmann::json::array();
    for (const PressureModel* model : explorer::models())
      point["models"].push_back(numbers_of(*model, problem));
    if (shown >= 0 && point["models"][std::size_t(shown)]["has_answer"]) {
      const PressureModel& model = *explorer::models()[std::size_t(shown)];
      point["limit"] = limit_of(model, problem);
      point["profile"] = profile_of(model, problem);
      point["simulators"] = simulators_of(model, problem);
    }
    std::cout << point << '\n';
  }
  return std::cout.flush() ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << "write_explorer_points: " << error.what() << '\n';
  return 1;
}
