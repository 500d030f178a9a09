#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "softfinger/pressure/pressure_model.h"

/// Checks that several models share. Limits without a source in the message come from comparing the
/// models with the exact solution for a bonded layer under a sphere: inside them, contact area and
/// torque at a given load are within 10 %.
namespace softfinger {

/// s = sqrt(ab) / h: the size of the contact against the thickness of the layer.
inline double contact_to_thickness(const Prediction& prediction,
                                   const ElasticLayer& layer) noexcept {
  return std::sqrt(prediction.a_m) * std::sqrt(prediction.b_m) / layer.thickness_m;
}

/// Whether the layer acts as a half-space, within 10 % in area and torque. `name` distinguishes the
/// object's layer from the finger's.
inline ValidityCheck thick_layer_check(const Prediction& prediction, const ElasticLayer& layer,
                                       const char* name = "thick_layer") noexcept {
  constexpr std::array<double, 5> kPoissonRatio{0, 0.3, 0.45, 0.49, 0.5};
  constexpr std::array<double, 5> kLimit{0.88, 0.78, 0.69, 0.66, 0.65};
  std::size_t i = 1;
  while (i + 1 < kPoissonRatio.size() && layer.poisson_ratio > kPoissonRatio[i]) ++i;
  const double t =
      (layer.poisson_ratio - kPoissonRatio[i - 1]) / (kPoissonRatio[i] - kPoissonRatio[i - 1]);
  return {name, contact_to_thickness(prediction, layer),
          kLimit[i - 1] + t * (kLimit[i] - kLimit[i - 1]), true,
          "the layer is too thin for a half-space: the rigid core stiffens it, so that the contact "
          "area, the indentation and the torque are overestimated"};
}

/// Whether the layer is thin against the contact, so that each column of it carries its own load,
/// within 10 % in area and torque.
///
/// Near nu = 1/2 the layer would rather flow sideways than shrink, and the limit grows as
/// 1/(1 - 2 nu): the samples at nu = 0, 0.3, 0.45 and 0.49 are joined by straight lines in that
/// variable, and the last two, which have the same product to 4 %, continue to nu -> 1/2, where the
/// limit is a finite number that no contact reaches.
inline ValidityCheck thin_layer_check(const Prediction& prediction, const ElasticLayer& layer,
                                      const char* name = "thin_layer") noexcept {
  constexpr std::array<double, 4> kInverseCompressibility{1, 2.5, 10, 50};
  constexpr std::array<double, 4> kLimit{3.8, 2.7, 10, 52};
  constexpr double kLeast = std::numeric_limits<double>::epsilon() / 2;  // of 1 - 2 nu, but for 0
  const double c = 1 / std::max(1 - 2 * layer.poisson_ratio, kLeast);
  double limit = kLimit.back() / kInverseCompressibility.back() * c;
  if (c < kInverseCompressibility.back()) {
    std::size_t i = 1;
    while (c > kInverseCompressibility[i]) ++i;
    const double t = (c - kInverseCompressibility[i - 1]) /
                     (kInverseCompressibility[i] - kInverseCompressibility[i - 1]);
    limit = kLimit[i - 1] + t * (kLimit[i] - kLimit[i - 1]);
  }
  return {name, contact_to_thickness(prediction, layer), limit, false,
          "the layer is not thin enough for independent columns: material beside the contact takes "
          "part (and, near nu = 1/2, flows there), so that area and torque are off by more than 10 "
          "%"};
}

/// Whether the surfaces are shallow inside the contact, as a quadric gap and vertical pressure
/// assume: the larger of a/R' and b/R''.
inline ValidityCheck small_slope_check(const Prediction& prediction,
                                       const RelativeRadii& radii) noexcept {
  return {
      "small_slope", std::max(prediction.a_m / radii.major_m, prediction.b_m / radii.minor_m), 0.3,
      true,
      "the contact is large against the radii of curvature: the surfaces are steep at its edge, "
      "where neither the quadric gap nor a vertical pressure describes them; the torque is "
      "underestimated"};
}

/// Whether linear elasticity may be used: the compression of a layer over its thickness.
inline ValidityCheck small_strain_check(double strain) noexcept {
  return {
      "small_strain", strain, 0.3, true,
      "the layer is compressed by more than 30 % of its thickness: linear elasticity can be off "
      "by more than 10 %, less so when nearly incompressible"};
}

/// Check of the strain d/h of a layer that takes the whole indentation.
inline ValidityCheck small_strain_check(const Prediction& prediction,
                                        const ElasticLayer& layer) noexcept {
  return small_strain_check(prediction.indentation_m / layer.thickness_m);
}

/// Check of the larger strain of two layers in series, whose compliances (indentation per load, in
/// one unit) share the indentation. A rigid object counts as no layer.
inline ValidityCheck small_strain_check(const Prediction& prediction, const ContactProblem& problem,
                                        double compliance, double object_compliance) noexcept {
  double strain = prediction.indentation_m / problem.layer.thickness_m;
  if (problem.has_object_layer()) {
    const double share = compliance / (compliance + object_compliance);
    strain = std::max(share * strain,
                      (1 - share) * prediction.indentation_m / problem.object_layer.thickness_m);
  }
  return small_strain_check(strain);
}

/// A prediction without an answer, and why.
inline Prediction no_answer(const ValidityCheck& reason) noexcept {
  Prediction prediction;
  prediction.validity.add(reason);
  return prediction;
}

/// The first requirement of contact_problem.h that the problem violates, as a check that fails;
/// a check with an empty name when there is none. Not a substitute for reading input with care: it
/// keeps NaN out of a simulator.
inline ValidityCheck first_range_violation(const ContactProblem& problem) noexcept {
  constexpr double kLargest = std::numeric_limits<double>::max();
  struct Range {
    const char* name;
    double value;
    const char* message;
  };
  // The messages say what is allowed; NaN, which JSON has not, is reported as 0.
  const Range positive[] = {
      {"radius_in_range", problem.radii.minor_m, "no answer: R'' must be positive and finite"},
      {"radius_in_range", problem.radii.major_m, "no answer: R' must be positive and finite"},
      {"thickness_in_range", problem.layer.thickness_m,
       "no answer: the layer's thickness must be positive and finite"},
      {"youngs_modulus_in_range", problem.layer.youngs_modulus_Pa,
       "no answer: Young's modulus must be positive and finite"},
      {"load_in_range", problem.load.normal_force_N,
       "no answer: the normal force must be positive and finite; without load there is no contact"},
  };
  for (const Range& range : positive) {
    if (range.value > 0 && range.value <= kLargest) continue;
    if (range.value > kLargest) return {range.name, kLargest, 0, true, range.message};
    return {range.name, range.value < 0 ? std::max(range.value, -kLargest) : 0,
            std::numeric_limits<double>::min(), false, range.message};
  }
  const auto poisson_ratio_in_range = [&](double nu) -> ValidityCheck {
    if (nu >= 0 && nu <= 0.5) return {};
    return {"poisson_ratio_in_range",
            nu > 0.5 ? std::min(nu, kLargest) : (nu < 0 ? std::max(nu, -kLargest) : -1),
            nu > 0.5 ? 0.5 : 0.0, nu > 0.5,
            "no answer: Poisson's ratio must lie between 0 and 1/2"};
  };
  if (const auto violation = poisson_ratio_in_range(problem.layer.poisson_ratio); *violation.check)
    return violation;
  const SurfaceCurvature& finger = problem.finger_curvature;
  for (const double curvature : {finger.xx_per_m, finger.yy_per_m, finger.xy_per_m})
    if (!(std::abs(curvature) <= kLargest))
      return {"finger_curvature_in_range", 0, 1, false,
              "no answer: the finger's curvature must be finite"};
  const ElasticLayer& object = problem.object_layer;
  if (object.thickness_m != 0) {  // NaN is no rigid object either
    const auto positive_and_finite = [&](double value) { return value > 0 && value <= kLargest; };
    if (!positive_and_finite(object.thickness_m) || !positive_and_finite(object.youngs_modulus_Pa))
      return {"object_layer_in_range", 0, 1, false,
              "no answer: thickness and Young's modulus of the object's layer must be positive and "
              "finite (thickness 0: a rigid object)"};
    if (const auto violation = poisson_ratio_in_range(object.poisson_ratio); *violation.check)
      return violation;
  }
  // Without friction there is no torque, which is an answer too.
  const double mu = problem.load.friction_coefficient;
  if (!(mu >= 0 && mu <= kLargest))
    return {"friction_in_range", mu > kLargest ? kLargest : (mu < 0 ? std::max(mu, -kLargest) : -1),
            0, mu > kLargest,
            "no answer: the friction coefficient must be finite and not negative"};
  if (problem.radii.major_m < problem.radii.minor_m)
    return {"radii_ordered", std::min(problem.radii.minor_m / problem.radii.major_m, kLargest), 1,
            true, "no answer: R' must not be smaller than R''; x lies along the longer axis"};
  return {};
}

/// Reason why a model whose theory knows one layer has no answer for two.
inline ValidityCheck one_layer_only(const ContactProblem& problem) noexcept {
  if (!problem.has_object_layer()) return {};
  return {"rigid_object", 1, 0, true,
          "no answer: this model is for a rigid object; hertz (both layers thick), winkler (both "
          "thin) and thin_incompressible take a compliant object"};
}

inline ValidityCheck not_representable() noexcept {
  return {"representable", 0, 1, false,
          "no answer: the result is too large or too small for a double; check the units of the "
          "input"};
}

/// `prediction` as it is if every number in it can be trusted, and the largest friction force and
/// torque that follow from it with the problem's load; otherwise no answer: a result that
/// overflowed, underflowed or lost digits to subnormal numbers is not passed on.
inline Prediction finite_or_no_answer(const Prediction& prediction,
                                      const ContactProblem& problem) noexcept {
  // An area is larger by 1e6 in mm².
  constexpr double kLargest = 1e-6 * std::numeric_limits<double>::max();
  const auto normal = [](double value) {
    return value >= std::numeric_limits<double>::min() && value <= kLargest;
  };
  bool representable =
      normal(prediction.a_m) && normal(prediction.b_m) && normal(prediction.area_m2()) &&
      normal(prediction.indentation_m) && normal(prediction.peak_pressure_Pa) &&
      normal(prediction.torque_arm_exact_m) && normal(prediction.torque_arm_paper_m);
  if (problem.load.friction_coefficient > 0) {
    const double max_force_N = problem.load.friction_coefficient * problem.load.normal_force_N;
    representable = representable && normal(max_force_N) &&
                    normal(max_force_N * prediction.torque_arm_exact_m) &&
                    normal(max_force_N * prediction.torque_arm_paper_m);
  }
  for (const ValidityCheck& check : prediction.validity)
    representable = representable && std::isfinite(check.value) && std::isfinite(check.limit);
  return representable ? prediction : no_answer(not_representable());
}

}  // namespace softfinger
