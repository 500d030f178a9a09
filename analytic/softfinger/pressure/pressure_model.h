#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/pressure/batch.h"
#include "softfinger/pressure/differentiated.h"

namespace softfinger {

/// Accuracy with which a model solves its own equations. Tests of all models take their tolerances
/// from here. The defaults are those of a closed form; any other model states its own, with the
/// reason.
struct NumericalAccuracy {
  /// Relative error of load and torque arm when `pressure_Pa` is integrated over the contact
  /// ellipse, and of `pressure_Pa` at the centre against the peak.
  double pressure = 1e-12;
  /// Part of the semi-axes beyond which, outside the contact ellipse, `pressure_Pa` is zero.
  double edge = 1e-12;
  /// Relative error, not monotone, of a number that theory says must not grow or not shrink.
  double monotone = 1e-12;
  std::string_view reason =
      "closed form: rounding only. Near the edge the pressure is a small difference, with a "
      "relative error up to the root of epsilon, over a strip of relative area epsilon";
};

/// The numbers of a layer that a model's answers depend on. Measurements cannot tell others.
enum class LayerConstants {
  all,                   ///< E, nu and h
  plane_strain_modulus,  ///< E/(1 - nu²) alone
  foundation_modulus,    ///< the stiffness of a column: a modulus over h
  none                   ///< a measured law needs none
};

/// Description of a model: what a reader must know before using it.
struct ModelCard {
  std::string_view name;         ///< as typed on the command line
  std::string_view title;        ///< one line
  std::string_view assumptions;  ///< one or two sentences
  std::string_view equations;    ///< plain text
  std::string_view source;       ///< publication and equation numbers
  std::string_view validity;     ///< where it holds, in words
  std::string_view cost;         ///< order of magnitude, e.g. "about 100 ns"
  bool hot_path = true;          ///< fit for a simulator's inner loop: microseconds, no allocation
  bool finite_strain = false;    ///< of large deformation: not to be compared with linear solutions
  NumericalAccuracy accuracy = {};
  LayerConstants layer_constants = LayerConstants::all;
  bool is_empirical = false;   ///< its constants are measured on one finger and hold for no other
  bool is_calibrated = false;  ///< a calibration fits it to measurements
};

/// One assumption of a model, measured on the problem at hand: it holds while `value` stays
/// below (`holds_below`) or above `limit`. Strings are literals: copying never allocates.
struct ValidityCheck {
  const char* check = "";  ///< snake_case name
  double value = 0;
  double limit = 0;
  bool holds_below = true;
  const char* message = "";  ///< what it means for the user when it fails

  bool holds() const { return holds_below ? value <= limit : value >= limit; }
};

/// The checks of one prediction. The capacity is fixed, so that a prediction can be made in a
/// simulator's inner loop without allocation.
///
/// A check beyond the capacity cannot be stated, which must not look like a check that holds: the
/// last place then says so, in a check "all_checks_stated" that fails. A failing check beyond the
/// capacity takes the place of one that holds.
class Validity {
 public:
  /// Twice what the model with the most checks states (finite_strain_layer: six).
  static constexpr std::size_t kCapacity = 12;

  void add(const ValidityCheck& check) noexcept {
    if (added_++ < kCapacity) {
      checks_[added_ - 1] = check;
      return;
    }
    ValidityCheck& last = checks_.back();
    if (added_ == kCapacity + 1) keep_if_failing(last);
    keep_if_failing(check);
    last = {
        "all_checks_stated", double(added_), double(kCapacity), true,
        "more assumptions were checked than can be listed: which of the others hold is unknown"};
  }
  const ValidityCheck* begin() const { return checks_.data(); }
  const ValidityCheck* end() const { return checks_.data() + std::min(added_, kCapacity); }
  bool holds() const {
    for (const auto& check : *this)
      if (!check.holds()) return false;
    return true;
  }

 private:
  /// Replaces a check that holds by a failing one; never the last check.
  void keep_if_failing(const ValidityCheck& check) noexcept {
    if (check.holds()) return;
    for (std::size_t i = 0; i + 1 < kCapacity; ++i) {
      if (!checks_[i].holds()) continue;
      checks_[i] = check;
      return;
    }
  }

  std::array<ValidityCheck, kCapacity> checks_{};
  std::size_t added_ = 0;
};

/// Contact ellipse and pressure of one model. All values are finite. When the model has no answer
/// at all (`has_answer` false; e.g. confined Winkler at nu = 1/2) they are zero and `validity` says
/// why.
struct Prediction {
  bool has_answer = false;
  double a_m = 0, b_m = 0;   ///< semi-axes, a >= b, a along RelativeRadii::axis_rad
  double indentation_m = 0;  ///< approach d of the two bodies, first touch = 0
  double peak_pressure_Pa = 0;
  /// (int p r dA) / P: the largest torque is mu P times this, and e_n (6) equals it.
  double torque_arm_exact_m = 0;
  /// The rule of Ciocarlie et al. (2007), (9), (10): the arm of the circle of radius sqrt(ab).
  double torque_arm_paper_m = 0;
  Validity validity;

  double area_m2() const { return kPi * a_m * b_m; }
  bool valid() const { return has_answer && validity.holds(); }
};

/// A model of the pressure between a rigid quadric and an elastic layer. One model is one file in
/// `models/`; the build generates the registry from the folder.
class PressureModel {
 public:
  virtual ~PressureModel() = default;
  virtual const ModelCard& card() const noexcept = 0;

  /// Whether `ContactProblem::stack` counts. The others answer for `layer`.
  virtual bool knows_stacks() const noexcept { return false; }

  /// Never throws, never returns NaN or infinity, never allocates when `card().hot_path`. The
  /// problem must satisfy the ranges in contact_problem.h; assumptions that it violates come back
  /// as `Prediction::validity`.
  virtual Prediction predict(const ContactProblem& problem) const noexcept = 0;

  /// The numbers of the prediction with their derivatives, for a model that has them: exact, by
  /// forward differentiation. Only for one layer, and where `predict` has an answer
  /// (`predict_differentiated` sees to both).
  virtual std::optional<DifferentiatedContact> differentiated(
      const ContactProblem&) const noexcept {
    return std::nullopt;
  }

  /// `predict`, and in `contact` the derivatives, which count only where `predict` has an answer.
  /// Overridden where one calculation gives both.
  virtual Prediction predict_differentiated(
      const ContactProblem& problem, std::optional<DifferentiatedContact>* contact) const noexcept {
    Prediction prediction = predict(problem);
    if (prediction.has_answer && !problem.has_object_layer()) *contact = differentiated(problem);
    return prediction;
  }

  /// Many contacts at once (predict_batch, batch.h). The default asks `predict` for each.
  virtual void predict_batch(const ContactBatch& contacts,
                             const PredictionBatch& predictions) const noexcept;

  /// Pressure in Pa at (x, y) in the contact frame (x along the long axis, origin at first touch);
  /// zero outside the contact. `prediction` is what `predict` returned for this problem.
  virtual double pressure_Pa(const ContactProblem& problem, const Prediction& prediction,
                             double x_m, double y_m) const noexcept = 0;
};

/// All models of the folder `models/`, ordered by name. The objects live as long as the program.
const std::vector<const PressureModel*>& all_pressure_models();

/// The model with that name, or nullptr.
const PressureModel* find_pressure_model(std::string_view name);

}  // namespace softfinger
