#pragma once

#include <Eigen/Core>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/prediction/local_geometry.h"
#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::prediction {

/// `exact` integrates the friction over the ellipse. `paper` is the rule of Ciocarlie et al.
/// (2007), which is exact for circles only.
enum class TorqueRule { exact, paper };

/// What is known of a contact whose gap was sampled from meshes, beside its prediction.
struct SampledGapResult {
  /// Of the ellipse, from the contact point, in the finger's x and y.
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double region_area_m2 = 0;  ///< of the contact, which need not be an ellipse
  double edge_deviation = 0;  ///< largest, of the contact's edge from the ellipse, relative
  double spacing_m = 0;       ///< of the samples
  /// Relative changes of the answer when the facets are rounded by the mesh's own normals: what the
  /// mesh leaves open. NaN when the rounded bodies have no answer.
  struct Changes {
    double a = 0, b = 0, indentation = 0, torque = 0, peak = 0;
  };
  Changes changes_by_rounding;
};

/// One model on one load, with what it costs to ask it.
struct ModelAnswer {
  const PressureModel* model = nullptr;
  ContactProblem problem;
  Prediction prediction;
  double cost_ns = 0;  ///< median of repeated calls; of one call for models outside the hot path
  /// Standard deviations of a, b and the arm of the torque (exact, paper) that the uncertainty of
  /// fitted radii leaves; set for mesh cases and models that are fast enough to be asked again.
  struct Deviations {
    double a_m = 0, b_m = 0, arm_exact_m = 0, arm_paper_m = 0;
  };
  std::optional<Deviations> deviations;
  std::optional<SampledGapResult> sampled;  ///< set when the gap was not the quadric
  /// Bounds of the relative errors as the contract writes them, or null, and why there are none.
  nlohmann::json error_estimate;
  std::string no_estimate;

  double eccentricity_m(TorqueRule rule) const {
    return rule == TorqueRule::exact ? prediction.torque_arm_exact_m
                                     : prediction.torque_arm_paper_m;
  }
  FrictionEllipsoid friction_ellipsoid(TorqueRule rule) const;
};

/// "all" (those of the hot path), "everything", one name, or several joined by commas.
/// @throws InputError naming the nearest model for an unknown name.
std::vector<const PressureModel*> models_by_name(const std::string& names);

/// Names of the models that "all" leaves out because they take longer than microseconds.
std::vector<std::string> slow_models();

/// @param time_budget_ns  spent on repeating the call to measure its cost; models outside the hot
///   path are called once, whatever that takes
ModelAnswer ask_model(const PressureModel& model, const ContactProblem& problem,
                      double time_budget_ns);

/// The same of a case, with a check of what no model knows: whether its layer is homogeneous.
ModelAnswer ask_model(const PressureModel& model, const input::Case& contact_case,
                      const RelativeRadii& radii, double load_N, double time_budget_ns);

/// Fails where a case has several sublayers.
void check_homogeneity(const input::Case& contact_case, Validity& validity);

/// Fills `deviations` of a model of the hot path that has an answer: first order, with the
/// covariance of the fitted R' and R'' (propagated_std). NaN where a neighbouring problem has no
/// answer. Twenty more predictions.
void propagate_radii_uncertainty(const RelativeCurvature& relative, ModelAnswer& answer);

/// The exponent n of p ~ (1 - x²/a² - y²/b²)^n whose torque arm for this ellipse is the
/// prediction's own, so that the limit surface for n meets the true one at pure torque and at pure
/// force. The named models' exponents (1/2, 1, 2) come out exactly. Between -0.99 and 1000; NaN
/// without an answer. About 10 microseconds.
double equivalent_exponent(const Prediction& prediction);

/// The contract's keys for one answer. Numbers that do not exist are null. With
/// `limit_surface_points` > 0, that many points all over the limit surface, in the contact frame (x
/// along the long axis): the exact surface for the equivalent exponent, or with TorqueRule::paper
/// the ellipsoid of Ciocarlie et al. (2007).
nlohmann::json to_json(const ModelAnswer& answer, TorqueRule rule, int limit_surface_points);

/// Validity as data: check, value, limit, holds, message.
nlohmann::json to_json(const Validity& validity);

/// `softfinger fit`'s keys; a flat direction has radius null.
nlohmann::json to_json(const QuadricFit& fit);

/// The patch of report.json, or null when no body is a mesh.
nlohmann::json patch_to_json(const LocalGeometry& geometry);

/// The law that was fitted to a case's data and how well; null without data.
nlohmann::json to_json(const std::optional<PowerLawFit>& fit);

/// What to tell about that fit: its parameters and scatter, and loads outside the data's range.
std::vector<std::string> power_law_remarks(const input::Case& contact_case);

/// thickness_m, youngs_modulus_Pa, poisson_ratio.
nlohmann::json layer_json(const ElasticLayer& layer);

/// "20 mm"; "flat" for an infinite radius.
std::string millimetres(double length_m);

/// "x, layer 2 mm, E 300 kPa, nu 0.49, mu 0.8": the checked input, echoed before any result.
std::string describe(const input::Case& contact_case);

/// "R' 20 mm, R'' 5 mm, axis 0°" and, for meshes, how well the patch agrees.
std::string describe(const LocalGeometry& geometry);

/// The answers for one load as a table in mm, kPa, mN·m, and why models do not hold.
std::string table(const std::vector<ModelAnswer>& answers, TorqueRule rule);

}  // namespace softfinger::prediction
