#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "softfinger/input/contact_problem.h"
#include "softfinger/math/pi.h"

namespace softfinger {

/// What a reader must know before using a model.
struct ModelCard {
  std::string_view name;         ///< as typed on the command line
  std::string_view title;        ///< one line
  std::string_view assumptions;  ///< one or two sentences
  std::string_view equations;    ///< plain text
  std::string_view source;       ///< publication and equation numbers
  std::string_view validity;     ///< where it holds, in words
  std::string_view cost;         ///< order of magnitude, e.g. "about 100 ns"
  bool hot_path = true;          ///< fit for a simulator's inner loop: microseconds, no allocation
  bool finite_strain = false;    ///< of large deformation: linear elasticity is not its judge
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

/// Fixed-capacity list, so that a prediction can be made in a simulator's inner loop.
class Validity {
 public:
  void add(const ValidityCheck& check) noexcept {
    if (count_ < checks_.size()) checks_[count_++] = check;
  }
  const ValidityCheck* begin() const { return checks_.data(); }
  const ValidityCheck* end() const { return checks_.data() + count_; }
  bool holds() const {
    for (const auto& check : *this)
      if (!check.holds()) return false;
    return true;
  }

 private:
  std::array<ValidityCheck, 8> checks_{};
  std::size_t count_ = 0;
};

/// Contact ellipse and pressure of one model. All values are finite. When the model has no answer
/// at all (`has_answer` false; e.g. confined Winkler at nu = 1/2) they are zero and `validity` says
/// why.
struct Prediction {
  bool has_answer = false;
  double a_m = 0, b_m = 0;   ///< semi-axes, a >= b, a along RelativeRadii::axis_rad
  double indentation_m = 0;  ///< approach d of the two bodies, first touch = 0
  double peak_pressure_Pa = 0;
  double torque_arm_exact_m =
      0;  ///< (int p r dA) / P: max torque = mu P times this, equals e_n (6)
  double torque_arm_paper_m =
      0;  ///< the seed's rule, arm of the circle of radius sqrt(ab), (9), (10)
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

  /// Never throws, never returns NaN or infinity, never allocates when `card().hot_path`. The
  /// problem must satisfy the ranges in contact_problem.h; assumptions that it violates come back
  /// as `Prediction::validity`.
  virtual Prediction predict(const ContactProblem& problem) const noexcept = 0;

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
