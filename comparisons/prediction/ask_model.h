#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/quantity.h"
#include "softfinger/accuracy/error_bound.h"
#include "softfinger/friction/shear_limit.h"
#include "softfinger/geometry/relative_curvature.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::prediction {

/// `exact` integrates the friction over the ellipse. `paper` is the rule of Ciocarlie et al.
/// (2007), which is exact for circles only.
enum class TorqueRule { exact, paper };

/// Further results for a contact whose gap was sampled from meshes.
struct SampledGapResult {
  /// Centre of the ellipse, from the contact point, along the finger's x and y.
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double region_area_m2 = 0;  ///< area of the contact region, which need not be an ellipse
  double edge_deviation = 0;  ///< largest relative distance of the contact's edge from the ellipse
  double spacing_m = 0;       ///< of the samples
  /// Relative changes of the answer when the facets are replaced by the smooth surface of the
  /// mesh's own normals: an estimate of the mesh's error. NaN when that surface has no answer.
  struct Changes {
    double a = 0, b = 0, indentation = 0, torque = 0, peak = 0;
  };
  Changes changes_by_rounding;
};

/// Distance of an answer from the finger itself, as `judgement::assess` finds it.
struct Assessment {
  bool usable = false;      ///< the demanded quantities are within the tolerance, geometry included
  bool determined = false;  ///< what the geometry leaves open of them is
  std::optional<QuantityErrors> bound;     ///< of |relative error| against the full reference
  std::optional<QuantityErrors> geometry;  ///< what the fit of the radii adds, NaN: not known
  std::string evidence;                    ///< for the bound, or why there is none
  /// Parts of the bound's expected error, signed, by `ErrorCause`; with a bound only.
  std::array<QuantityErrors, kErrorCauses> causes{};

  /// Both together, of one quantity; NaN where one is not known.
  double total(Quantity quantity) const {
    const auto q = std::size_t(quantity);
    return bound && geometry ? (*bound)[q] + (*geometry)[q]
                             : std::numeric_limits<double>::quiet_NaN();
  }
  QuantityErrors totals() const {
    QuantityErrors all;
    for (std::size_t q = 0; q < kQuantities; ++q) all[q] = total(Quantity(q));
    return all;
  }
  /// Whether both are known, of every quantity.
  bool known() const {
    for (std::size_t q = 0; q < kQuantities; ++q)
      if (!std::isfinite(total(Quantity(q)))) return false;
    return true;
  }
};

/// The answer of one model at one load, and the time that it takes.
struct ModelAnswer {
  const PressureModel* model = nullptr;
  ContactProblem problem;
  ShearLaw shear_law;     ///< of the case; Coulomb's with the problem's coefficient without one
  Prediction prediction;  ///< of frictionless pressing, which the largest torque is that of
  PressingFriction pressing = PressingFriction::none;
  /// The contact as it is pressed with friction, where the case asks for that and the model knows.
  std::optional<Prediction> rubbed;
  double cost_ns = 0;  ///< median of repeated calls; slow models are called once
  /// Standard deviations that follow from the uncertainty of the fitted radii. Set for meshes and
  /// models that are fast enough to be asked repeatedly.
  struct Deviations {
    double a_m = 0, b_m = 0, indentation_m = 0, area_m2 = 0, peak_pressure_Pa = 0;
    double torque_exact_Nm = 0, torque_paper_Nm = 0;  ///< of the largest torque, by rule
  };
  std::optional<Deviations> deviations;
  std::optional<SampledGapResult> sampled;  ///< set when the gap was not the quadric
  std::optional<Assessment> assessment;     ///< where it was asked for

  /// Whether the answer is usable, where it was assessed; else whether no assumption of the model
  /// fails.
  bool valid() const { return assessment ? assessment->usable : prediction.valid(); }

  const Prediction& pressed() const { return rubbed ? *rubbed : prediction; }

  double eccentricity_m(TorqueRule rule) const {
    return rule == TorqueRule::exact ? prediction.torque_arm_exact_m
                                     : prediction.torque_arm_paper_m;
  }
  /// The contact ellipse with the pressure of the form p ~ (1 - s²)^n that has the model's torque;
  /// by the paper's rule the circle of the same area. Only with an answer.
  PressedEllipse pressed_ellipse(TorqueRule rule) const;
  /// Largest force and torque by the shear law. Under Coulomb's the eccentricity is the model's
  /// own.
  FrictionEllipsoid friction_ellipsoid(TorqueRule rule) const;
};

/// "all" (the models that take microseconds), "everything", one name, or several separated by
/// commas.
/// @throws InputError naming the nearest model for an unknown name.
std::vector<const PressureModel*> models_by_name(const std::string& names);

/// Names of the models that "all" leaves out because they take longer than microseconds.
std::vector<std::string> slow_models();

/// @param time_budget_ns  time for repeated calls that measure the cost; none: it is not measured.
///   Slow models are called once, however long that takes.
ModelAnswer ask_model(const PressureModel& model, const ContactProblem& problem,
                      std::optional<double> time_budget_ns = std::nullopt);

/// Asks a model about a contact of a case. Adds a check that no model makes itself: whether the
/// layer is homogeneous.
ModelAnswer ask_model(const PressureModel& model, const input::Case& contact_case,
                      const LocalGeometry& geometry, double load_N,
                      std::optional<double> time_budget_ns = std::nullopt);

/// Copy of a contact with other radii of the gap. The finger keeps its share of the curvature,
/// because both follow from the same surface.
ContactProblem with_radii(ContactProblem problem, const RelativeRadii& radii);

/// A check that fails if the case has several sublayers.
void check_homogeneity(const input::Case& contact_case, Validity& validity);

/// Adds a check that fails if the case's layer has another energy than those that models of finite
/// strain were fitted to.
void check_energy(const input::Case& contact_case, Validity& validity);

/// Sets `deviations` for a fast model that has an answer: to first order, from the covariance of
/// the fitted R' and R'' (propagated_std). NaN if a neighbouring problem has no answer. Costs
/// five predictions.
void propagate_radii_uncertainty(const RelativeCurvature& relative, ModelAnswer& answer);

}  // namespace softfinger::prediction
