#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/prediction/quantity.h"
#include "comparisons/reference/fem_jobs.h"
#include "comparisons/reference/pad_elements.h"
#include "comparisons/sweep/sweep_file.h"
#include "softfinger/pressure/pressure_model.h"

/// The two kinds of contact that a sweep can be about, curved bodies and flat pads: which columns
/// their rows have, and what is in them.
namespace softfinger::sweep {

/// A problem of curved bodies or of a flat pad, as the finite elements read it.
struct FemRequest {
  std::variant<reference::FemProblem, nlohmann::json> problem;
  double weight = 0;  ///< a rough estimate of the cost
};

/// The finite-element jobs of a sweep. Rows of the same problem share one.
struct SweepFemJobs {
  std::vector<reference::FemJob> jobs;  ///< of curved bodies
  std::vector<reference::PadJob> pads;  ///< of flat pads; one of the two lists is empty
  std::vector<long> job_of_row;         ///< -1: the bodies of that row do not touch
  reference::FemJobOptions settings;

  std::size_t count() const { return jobs.size() + pads.size(); }
};

/// Names of columns, SI units in them.
struct ContactColumns {
  std::vector<std::string> geometry;
  std::vector<std::string> quantities;  ///< of each model and of the finite elements
  std::vector<std::string> errors;      ///< relative, that the finite elements state
};

/// The contact at one point of a sweep.
class ContactAtPoint {
 public:
  virtual ~ContactAtPoint() = default;
  /// Appends the geometry's columns, then of each model its quantities and whether it is usable,
  /// each after a comma.
  /// @throws InputError in words where there is no contact
  virtual void append_answers(double load_N, std::string& text) = 0;
  /// Appends the quantities of a finished result, its errors and whether its theory holds, for the
  /// load of the last answers.
  /// @returns why there is none, else nothing
  virtual std::string append_reference(const SweepFemJobs& fem, std::size_t job,
                                       std::string& text) = 0;
  /// Why there is no job for this point; may be empty.
  virtual std::string without_job() const { return ""; }
  /// @throws InputError where the bodies make no contact
  virtual FemRequest fem_request(double load_N) = 0;
};

/// Shared between threads, with what points have in common: meshes, outlines.
class SweptContact {
 public:
  virtual ~SweptContact() = default;
  virtual const ContactColumns& columns() const = 0;
  virtual const std::vector<const ModelCard*>& models() const = 0;
  /// Name of the model by which `predict` would answer the sweep's own case; empty where that has
  /// no contact.
  virtual std::string recommended() const = 0;
  /// Sentences about the sweep's own case.
  virtual std::vector<std::string> remarks() const { return {}; }
  /// @param contact_case  outlives the result
  /// @throws InputError
  virtual std::unique_ptr<ContactAtPoint> at(const input::Case& contact_case) const = 0;
};

/// The models are those that the sweep names, else all that take microseconds. Without names,
/// `power_law` is left out if the case gives no law.
/// @param demand  what an answer has to meet to be usable
/// @throws InputError for an unknown name
std::unique_ptr<const SweptContact> swept_bodies(const Sweep& sweep,
                                                 const prediction::Demand& demand);
std::unique_ptr<const SweptContact> swept_pad(const Sweep& sweep, const prediction::Demand& demand);

}  // namespace softfinger::sweep
