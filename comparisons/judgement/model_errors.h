#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "comparisons/prediction/quantity.h"
#include "comparisons/reference/reference_result.h"

/// The errors of a comparison, which verdicts, scores and pages need, without cases and answers.
namespace softfinger::judgement {

/// A model against the finite elements at one load: signed relative errors, NaN where there is
/// none.
struct ModelError {
  std::string model;
  bool has_answer = false;
  /// No assumption of the model fails but such that the reference does without: what those cost is
  /// in the errors.
  bool sound = false;
  double contact = 0;  ///< the largest of a, b and area
  double max_torque = 0;
  bool hot_path = true;    ///< microseconds; a slower model is named only when no such one will do
  bool applicable = true;  ///< false: it was given nothing to answer with, and is not mentioned
  prediction::Quantity contact_quantity = prediction::Quantity::area;  ///< which one that is

  /// The larger of the two without sign; NaN when one is missing.
  double larger() const;
  /// Sets `contact` and `contact_quantity`; NaN when one is missing.
  void set_contact(double a, double b, double area);
};

/// All models at one load.
struct LoadErrors {
  double load_N = 0;
  bool fem_finished = false;
  bool fem_trusted = false;
  std::string fem_failure;
  std::vector<ModelError> models;   ///< the same models in the same order for every load of a case
  std::optional<double> size = {};  ///< sqrt(a b)/h of the reference
  /// The largest of what the geometry leaves open in a, b, area and torque; 0 for exact bodies.
  double geometry_error = 0;
  reference::ReferenceErrors stated = {};
  /// `reference::largest_geometry_error` of what the finite elements state themselves.
  double fem_geometry_error = 0;
};

/// All loads of one case.
struct CaseErrors {
  std::string id;
  std::optional<double> poisson_ratio;
  std::vector<LoadErrors> loads;
};

inline double ModelError::larger() const {
  // std::max drops a NaN on its right.
  return std::isnan(max_torque) ? max_torque : std::max(std::abs(contact), std::abs(max_torque));
}

inline void ModelError::set_contact(double a, double b, double area) {
  using prediction::Quantity;
  contact = area;
  contact_quantity = Quantity::area;
  for (const auto& [error, quantity] : {std::pair(a, Quantity::a), std::pair(b, Quantity::b)})
    if (std::isnan(error) || std::abs(error) > std::abs(contact)) {
      contact = error;
      contact_quantity = quantity;
    }
}

}  // namespace softfinger::judgement
