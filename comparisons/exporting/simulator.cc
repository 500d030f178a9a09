#include "comparisons/exporting/simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/exporting/contact_curve.h"

namespace softfinger::exporting {

const Simulator* find_simulator(std::string_view name) {
  std::string wanted(name);
  std::replace(wanted.begin(), wanted.end(), '_', '-');
  for (const Simulator& simulator : all_simulators())
    if (simulator.name == wanted || (!wanted.empty() && simulator.other_name == wanted))
      return &simulator;
  return nullptr;
}

std::string without_double_hyphens(std::string text) {
  for (std::size_t at; (at = text.find("--")) != std::string::npos;) text.replace(at, 2, "-");
  return text;
}

BestConstant best_constant(double least, double largest) {
  return {2 / (1 / least + 1 / largest), (largest - least) / (largest + least)};
}

double eccentricity_in_simulator_m(const Simulator& simulator, const SoftContact& contact,
                                   double load_N) {
  if (!simulator.has_torque) return 0;
  const double told_m =
      contact.eccentricity_m * std::pow(load_N / contact.load_N, simulator.load_exponent);
  return std::max(told_m, simulator.least_torque_per_load_m / contact.friction_coefficient);
}

SoftContact soft_contact(const ContactCurve& curve, const Simulator& simulator, Fit fit) {
  SoftContact contact;
  contact.friction_coefficient = curve.nominal.friction_coefficient;
  contact.load_N = curve.nominal.load_N;
  contact.radii = curve.radii;
  contact.indentation_m = curve.nominal.indentation_m;
  contact.normal_stiffness_N_per_m = curve.normal_stiffness_N_per_m;
  contact.torsional_stiffness_Nm_per_rad = curve.torsional_stiffness_Nm_per_rad;
  contact.eccentricity_m = curve.nominal.eccentricity_m;
  if (fit == Fit::range) {
    const auto best_over_range = [&](const auto& wanted) {
      double least = wanted(curve.nominal), largest = least;
      for (const LoadPoint& point : curve.points) {
        least = std::min(least, wanted(point));
        largest = std::max(largest, wanted(point));
      }
      return best_constant(least, largest).value;
    };
    if (curve.shear_law.has_shear_strength())
      contact.friction_coefficient =
          best_over_range([](const LoadPoint& point) { return point.friction_coefficient; });
    contact.eccentricity_m = best_over_range([&](const LoadPoint& point) {
      return point.friction_coefficient / contact.friction_coefficient * point.eccentricity_m *
             std::pow(contact.load_N / point.load_N, simulator.load_exponent);
    });
  }
  contact.origin = fmt::format("{}, {}, {:.4g} N", curve.case_id, curve.model, contact.load_N);
  if (fit == Fit::range)
    contact.origin += fmt::format(", best for {:g} to {:g} N", curve.points.front().load_N,
                                  curve.points.back().load_N);
  contact.origin = without_double_hyphens(contact.origin);
  return contact;
}

std::vector<double> relative_force_errors(const SoftContact& contact, const ContactCurve& curve) {
  std::vector<double> errors;
  for (const LoadPoint& point : curve.points)
    errors.push_back(contact.friction_coefficient / point.friction_coefficient - 1);
  return errors;
}

std::vector<double> relative_errors(const Simulator& simulator, const SoftContact& contact,
                                    const ContactCurve& curve) {
  std::vector<double> errors;
  for (const LoadPoint& point : curve.points)
    errors.push_back(contact.friction_coefficient / point.friction_coefficient *
                         eccentricity_in_simulator_m(simulator, contact, point.load_N) /
                         point.eccentricity_m -
                     1);
  return errors;
}

}  // namespace softfinger::exporting
