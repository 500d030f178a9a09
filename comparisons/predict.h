#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/case.h"
#include "comparisons/local_geometry.h"
#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// `exact` integrates the friction over the ellipse; `paper` is the seed's rule, exact for circles
/// only.
enum class TorqueRule { exact, paper };

/// One model on one load, with what it costs to ask it.
struct ModelAnswer {
  const PressureModel* model = nullptr;
  ContactProblem problem;
  Prediction prediction;
  double cost_ns = 0;  ///< median of repeated calls

  double eccentricity_m(TorqueRule rule) const {
    return rule == TorqueRule::exact ? prediction.torque_arm_exact_m
                                     : prediction.torque_arm_paper_m;
  }
  FrictionEllipsoid friction_ellipsoid(TorqueRule rule) const;
};

/// "all", one name, or several joined by commas.
/// @throws InputError naming the nearest model for an unknown name.
std::vector<const PressureModel*> models_by_name(const std::string& names);

/// @param time_budget_ns  spent on repeating the call to measure its cost
ModelAnswer ask_model(const PressureModel& model, const ContactProblem& problem,
                      double time_budget_ns);

/// The contract's keys for one answer. Numbers that do not exist are null.
nlohmann::json to_json(const ModelAnswer& answer, TorqueRule rule, int limit_surface_points);

/// Validity as data: check, value, limit, holds, message.
nlohmann::json to_json(const Validity& validity);

/// `softfinger fit`'s keys; a flat direction has radius null.
nlohmann::json to_json(const QuadricFit& fit);

/// The patch of report.json, or null when no body is a mesh.
nlohmann::json patch_to_json(const LocalGeometry& geometry);

/// null for NaN and infinity.
nlohmann::json finite_or_null(double value);

/// "x, layer 2 mm, E 300 kPa, nu 0.49, mu 0.8": the checked input, echoed before any result.
std::string describe(const Case& contact_case);

/// "R' 20 mm, R'' 5 mm, axis 0°" and, for meshes, how well the patch agrees.
std::string describe(const LocalGeometry& geometry);

/// The answers for one load as a table in mm, kPa, mN·m, and why models do not hold.
std::string table(const std::vector<ModelAnswer>& answers, TorqueRule rule);

}  // namespace softfinger
