#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/judgement/judgement.h"
#include "comparisons/judgement/verdict.h"
#include "comparisons/prediction/pad_answer.h"
#include "comparisons/reference/pad_elements.h"
#include "comparisons/reference/reference_result.h"

/// Models of flat pads compared with finite elements of the whole pad. A pad has no ellipse, and
/// its numbers are others than those of curved contacts (comparison.h): statistics do not mix both.
namespace softfinger::judgement {

/// Relative errors of a model compared with the elements: value / reference - 1.
struct PadModelErrors {
  double indentation = 0, normal_stiffness = 0, pressure_arm = 0, max_torque = 0;
  double peak_pressure = 0;   ///< within 0.95 of the outline
  double tilt_stiffness = 0;  ///< about the axis with the larger error

  /// The largest of all but torque and peak, with its name.
  struct Worst {
    double error = 0;
    const char* quantity = "indentation";
  };
  Worst pressed() const;
};

struct PadModelComparison {
  prediction::PadAnswer answer;
  std::optional<PadModelErrors> errors;  ///< absent without an answer or without a reference
  /// Whether the model states a bound here. Without one, agreement is an accident.
  bool is_sound = false;
  /// The torque decides: a pad has no semi-axes, and its area is the case's own.
  Judgement judgement = Judgement::silent;
  /// Along the lines through the contact's centroid, from edge to edge; absent without an answer.
  std::optional<reference::PressureProfile> along_x, along_y;
};

/// One load of a pad.
struct PadComparison {
  double load_N = 0;
  std::optional<reference::PadElements> elements;
  std::string failure;  ///< why there are none
  /// The nodes of the elements that lie on the lines of the models' profiles.
  reference::PressureProfile along_x, along_y;
  std::vector<PadModelComparison> models;  ///< in the order of their worth
};

struct PadCaseComparison {
  const input::Case* contact_case = nullptr;  ///< not owned
  std::unique_ptr<const PadShape> shape;      ///< the answers point to it
  std::vector<PadComparison> loads;
  Verdict verdict;
};

/// @param solutions  of the case's loads, in their order
/// @param tolerance  relative, in the torque
PadCaseComparison compare_pad(const input::Case& contact_case,
                              std::vector<reference::PadSolution> solutions, double tolerance);

/// One sentence that says whether the default closed form can be used, what it costs, and how far
/// the other model is off.
Verdict compose_pad_verdict(const std::vector<PadComparison>& loads, double tolerance);

}  // namespace softfinger::judgement
