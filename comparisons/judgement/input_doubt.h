#pragma once

#include <cstddef>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/quantity.h"

/// Effect of a case's uncertain numbers: how far the answer moves when they do.
namespace softfinger::judgement {

/// "E x 2: -16 %, h + 10 %: +2.6 %, mu + 10 %: +10 %": changes of the largest torque, each by the
/// answer's own model at the changed number. Twice the modulus is a usual difference between a data
/// sheet and a fingertip. Empty without an answer, and for models slower than the hot path.
std::string cost_of_inputs(const prediction::ModelAnswer& answer, prediction::TorqueRule rule);

/// Relative change of an answer by the doubts of a case's numbers, at 95 %.
struct InputDoubt {
  prediction::QuantityErrors relative{};  ///< the larger one of both sides
  double eccentricity = 0;                ///< of e_n
  /// Relative changes of the largest torque, down and up: -0.5 and 1 for a factor of 2 either way.
  double torque_down = 0, torque_up = 0;
};

/// The case with each of its doubted numbers at either bound, and the geometry of each.
class DoubtedCases {
 public:
  /// @param known  the resolver of the case itself, whose meshes are not read again
  DoubtedCases(const input::Case& contact_case, const prediction::GeometryResolver& known);

  /// The root of the sum of squares over the doubted numbers; of each the larger change of both
  /// bounds, or of the one that the case allows. The two sides of the torque are sums of squares of
  /// logarithms, since a factor stays one. Nothing where no number is doubted, where there is
  /// no answer, and for models slower than the hot path. Unknown (NaN) where the model has no
  /// answer at a bound.
  /// A load of the case moves with its own doubt, another load stays.
  std::optional<InputDoubt> move(const prediction::ModelAnswer& answer,
                                 prediction::TorqueRule rule) const;

 private:
  struct Varied {
    std::size_t doubt;
    std::unique_ptr<const input::Case> contact_case;  ///< the resolver points into it
    std::unique_ptr<const prediction::GeometryResolver> geometry;
  };
  double load_N(const Varied& varied, double asked_N) const;

  std::vector<double> loads_N_;  ///< of the case
  std::vector<Varied> varied_;
  std::size_t doubts_ = 0;
};

/// {"a", .., "max_torque", "eccentricity"}: relative; null without a doubt.
nlohmann::json to_json(const std::optional<InputDoubt>& doubt);

}  // namespace softfinger::judgement
