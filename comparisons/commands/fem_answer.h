#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "comparisons/input/case.h"
#include "comparisons/judgement/reference_bound.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/reference/reference_result.h"
#include "softfinger/pressure/pressure_model.h"

/// Text of `softfinger fem` about the loads that it has solved.
namespace softfinger::commands {

struct FemAnswerText {
  const input::Case& contact_case;  ///< as it was solved
  const prediction::LocalGeometry& geometry;
  const reference::ReferenceResult& result;
  Validity validity;  ///< of the theory
  judgement::ReferenceBound bound;
  std::optional<double> approach_m;  ///< where that was given in place of the load
  std::optional<double> time_s;      ///< of a layer that relaxes; infinite: at rest
};

/// "the finger itself (curved, R 20 and 12 mm), finite strain, neo-Hookean, Q2/P1 elements of level
/// 2, pressed without friction".
std::string describe_reference(const input::Case& contact_case, int level);

/// "max torque 4.49 mN m ± 0.4 %, contact 5.1 x 3.7 mm, e_n 1.87 mm, at 3 N: finite elements of the
/// finger itself at finite strain".
std::string answer_line(const FemAnswerText& answer);

/// All numbers with their errors, and friction's where it was asked for.
std::string evidence_text(const FemAnswerText& answer);

/// Writes the keys that `predict` has, so that one reader serves both.
nlohmann::json to_json(const FemAnswerText& answer);

}  // namespace softfinger::commands
