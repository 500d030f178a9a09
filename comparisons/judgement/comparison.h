#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/judgement/ladder.h"
#include "comparisons/judgement/model_errors.h"
#include "comparisons/judgement/verdict.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/fit_picture.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/reference/reference_result.h"

/// All models compared with the finite elements at the loads of a case.
namespace softfinger::judgement {

/// Relative errors of a model compared with the finite elements: value / reference - 1.
struct RelativeErrors {
  double a, b, area, indentation, peak_pressure;
  double max_torque;        ///< exact rule, int mu p r dA over the model's own pressure
  double max_torque_paper;  ///< the paper's rule, against the same reference
  /// int |p - p_FEM| r dr / int p_FEM r dr along both axes, the mean: how far the pressure is off
  /// all over the contact. NaN where a profile is missing.
  double pressure_misfit;
};

struct ModelComparison {
  prediction::ModelAnswer answer;
  /// Absent without an answer or without a reference.
  std::optional<RelativeErrors> errors;
  /// Absent without an answer, and where the model solves its problem anew for each point.
  std::optional<reference::PressureProfile> along_x, along_y;
};

/// One load of a case.
struct Comparison {
  const input::Case* contact_case = nullptr;  ///< not owned
  double load_N = 0;
  prediction::LocalGeometry geometry;
  std::optional<reference::ReferenceResult> reference;
  std::string failure;  ///< why there is no reference
  std::string folder;   ///< of the reference's files, below the report's `fem`
  std::vector<ModelComparison> models;
  /// Pictures of the fits, for bodies that are meshes.
  std::optional<prediction::FitPicture> finger_picture, object_picture;
  std::optional<Ladder> ladder;  ///< of a reference that finished, where it was asked for

  /// sqrt(a b)/h of the reference.
  std::optional<double> size() const;
  /// Relative error left open by the fit of the radii; nothing where no model has an answer.
  std::optional<prediction::QuantityErrors> geometry_error() const;
};

struct CaseComparison {
  const input::Case* contact_case = nullptr;  ///< not owned
  std::vector<Comparison> loads;
  Verdict verdict;
};

/// @param answer  has one
RelativeErrors relative_errors(const prediction::ModelAnswer& answer,
                               const reference::ReferenceResult& reference);

/// Asks all models that a case of its kind can be compared with: those of finite strain only beside
/// finite elements at finite strain.
/// @param reference  absent when the finite elements failed, for the reason in `failure`
Comparison compare(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                   double load_N, std::optional<reference::ReferenceResult> reference,
                   const std::string& failure);

/// Whether no assumption of the model fails but such that the case's reference does without: strain
/// and slope at finite strain, and sublayers. What these cost, the comparison measures.
bool is_sound(const Prediction& prediction, const input::Case& contact_case);

/// Name of the case's reference: "the finger at finite strain".
std::string reference_in_words(const input::Case& contact_case);

/// The errors from which verdicts are made.
LoadErrors errors_of(const Comparison& comparison);

/// @param loads      of the case, at least one
/// @param tolerance  relative, in a, b, area and torque
CaseComparison compare_case(const input::Case& contact_case, std::vector<Comparison> loads,
                            double tolerance);

}  // namespace softfinger::judgement
