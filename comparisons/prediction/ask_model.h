#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/prediction/quantity.h"
#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/geometry/relative_curvature.h"
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
  /// Bounds of the |relative errors|, or in words why there are none.
  std::optional<QuantityErrors> error_bound;
  std::string no_bound;

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

}  // namespace softfinger::prediction
