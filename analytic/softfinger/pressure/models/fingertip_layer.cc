#include "softfinger/layer/fingertip_layer.h"

#include <algorithm>
#include <cmath>

#include "softfinger/layer/fingertip_layer_core.h"
#include "softfinger/math/wide.h"
#include "softfinger/pressure/answer.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/soundness.h"
#include "softfinger/pressure/validity.h"

namespace softfinger::models {

const PressureModel& bonded_layer_model();

namespace {

class FingertipLayer final : public PressureModel {
 public:
  const ModelCard& card() const noexcept override {
    static const ModelCard card{
        "fingertip_layer",
        "Elastic layer on a curved finger, pressed far",
        "A layer of even thickness, bonded to the rigid core of a curved finger (ellipsoid), of "
        "neo-Hookean material at finite strain; the object is a quadric or a sphere, flat, convex "
        "or hollow, turned against the finger. One layer; no friction in the normal problem.",
        "bonded_layer's values times exp of 48 (a b, d, peak, torque) or 28 (a/b) terms: strain "
        "d/h, slopes (a/R')² and (b/R'')², the finger's curvature times h, and their products, "
        "each times a polynomial in nu and s/(1 + s), s = sqrt(ab)/h; all vanish with h/R and d/h",
        "this project: fitted to finite-element runs of whole fingers "
        "(comparisons/judgement/atlas/fingers.csv, finite_strain.csv), tested on others",
        "h/R of the finger to 0.6, R'/R'' to 20, nu 0 to 1/2, d/h to 0.42, slopes to 0.6, s to 20; "
        "neo-Hookean with quadratic volume energy",
        "below 1 microsecond",
        true,
        true,
        {1e-12, 1e-12, 0.02,
         "a fit that follows the finite elements within 2 %: by so much it may depart from what "
         "theory says of thinner, stiffer or blunter contacts; it grows with the load everywhere"},
        LayerConstants::all,
        /*is_empirical=*/false,
        /*is_calibrated=*/true};
    return card;
  }

  Prediction predict(const ContactProblem& problem) const noexcept override {
    if (const ValidityCheck reason = why_unanswered(problem); *reason.check)
      return no_answer(reason);
    Prediction prediction = answer_of(fingertip_layer_contact(problem));
    add_checks(problem, prediction);
    return finite_or_no_answer(prediction, problem);
  }

  Prediction predict_differentiated(
      const ContactProblem& problem,
      std::optional<DifferentiatedContact>* contact) const noexcept override {
    if (const ValidityCheck reason = why_unanswered(problem); *reason.check)
      return no_answer(reason);
    with_best_instructions([&] {
      contact->emplace(DifferentiatedContact{fingertip_layer_numbers(
          differentiated_input(problem), problem.is_object_spherical ? 1. : 0.)});
    });
    Prediction prediction = answer_of(**contact);
    add_checks(problem, prediction);
    return finite_or_no_answer(prediction, problem);
  }

  void predict_batch(const ContactBatch& contacts,
                     const PredictionBatch& predictions) const noexcept override {
    predict_fingertip_layer_batch(*this, contacts, predictions);
  }

  double pressure_Pa(const ContactProblem& problem, const Prediction& prediction, double x_m,
                     double y_m) const noexcept override {
    return bonded_layer_model().pressure_Pa(problem, prediction, x_m, y_m);
  }

 private:
  static ValidityCheck why_unanswered(const ContactProblem& problem) noexcept {
    const ValidityCheck violation = first_range_violation(problem);
    if (*violation.check || !problem.has_object_layer()) return violation;
    return {"single_layer", 0, 1, false, "no answer: the corrections were fitted to one layer"};
  }

  /// Whether the contact lies within the runs that the corrections were fitted to.
  static void add_checks(const ContactProblem& problem, Prediction& prediction) noexcept {
    const double h = problem.layer.thickness_m;
    const RelativeRadii& radii = problem.radii;
    const SurfaceCurvature& finger = problem.finger_curvature;
    const double mean_per_m = 0.5 * (finger.xx_per_m + finger.yy_per_m);
    const double spread_per_m =
        std::hypot(0.5 * (finger.xx_per_m - finger.yy_per_m), finger.xy_per_m);
    prediction.validity.add({"table_indentation", prediction.indentation_m / h,
                             kFingertipRange.largest_strain, true,
                             "d/h is beyond the runs that the corrections were fitted to"});
    prediction.validity.add(
        {"table_slope", std::max(prediction.a_m / radii.major_m, prediction.b_m / radii.minor_m),
         kFingertipRange.largest_slope, true,
         "a/R is beyond the runs that the corrections were fitted to"});
    prediction.validity.add({"table_curvature", h * (mean_per_m + spread_per_m),
                             kFingertipRange.largest_bend, true,
                             "the layer is thicker against the finger's radius than in the runs "
                             "that the corrections were fitted to"});
    prediction.validity.add({"convex_finger", h * (mean_per_m - spread_per_m), -1e-9, false,
                             "the finger is hollow, unlike those that were fitted to"});
    prediction.validity.add(
        {"object_of_its_own_shape",
         std::min(1e300, fit_of_object(contact_input(radii, problem.layer,
                                                     problem.load.normal_force_N, finger),
                                       prediction.a_m, prediction.b_m)),
         kFingertipRange.largest_fit, true,
         "the hollow object nearly fits the finger: their shapes decide, not their radii"});
    prediction.validity.add(
        {"table_thickness",
         std::min(1e300, h / (std::sqrt(radii.major_m) * std::sqrt(radii.minor_m))),
         kFingertipRange.largest_flat_thickness, true,
         "the layer is thicker against the gap's radius than those that were fitted to"});
    prediction.validity.add({"table_size", contact_to_thickness(prediction, problem.layer),
                             kFingertipRange.largest_size, true,
                             "the contact is larger than those that were fitted to"});
    prediction.validity.add({"table_radii_ratio", std::min(radii.major_m / radii.minor_m, 1e300),
                             kFingertipRange.largest_radii_ratio * (1 + 1e-9), true,
                             "R'/R'' is beyond the runs that the corrections were fitted to"});
  }
};

}  // namespace

const PressureModel& fingertip_layer_model() {
  static const FingertipLayer model;
  return model;
}

}  // namespace softfinger::models
