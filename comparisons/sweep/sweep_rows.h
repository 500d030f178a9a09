#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/quantity.h"
#include "comparisons/reference/fem_jobs.h"
#include "comparisons/sweep/sweep_file.h"
#include "softfinger/pressure/pressure_model.h"

/// The rows of results.csv: one per point of the sweep and load, SI units in the columns' names.
namespace softfinger::sweep {

/// The models of a sweep: those that it names, else all that take microseconds. Without names,
/// `power_law` is left out if the case gives no law, and models of finite strain if the case is
/// linear.
/// @throws InputError for an unknown name
std::vector<const PressureModel*> sweep_models(const Sweep& sweep);

/// The finite-element jobs of a sweep. Rows of the same problem share one.
struct SweepFemJobs {
  std::vector<reference::FemJob> jobs;
  std::vector<long> job_of_row;  ///< -1: the bodies of that row do not touch
  reference::FemJobOptions settings;
};

/// Makes rows. Each thread has its own; the meshes are shared between them.
class SweepRows {
 public:
  /// @param geometry  of `sweep.base()`, with the meshes that have been read
  /// @param demand    what an answer has to meet to be usable
  SweepRows(const Sweep& sweep, const std::vector<const PressureModel*>& models,
            const prediction::GeometryResolver& geometry, const prediction::Demand& demand);

  /// "point,layer.thickness_mm,...,load_N,radius_major_m,...", with a line break at the end.
  std::string header() const;

  /// Appends the rows of a point, one per load. A row without contact says why in `failure`.
  void append(std::size_t point, std::string& text) { append(point, nullptr, {}, text); }
  /// Appends the rows of a point with the finite elements' results.
  /// @param failures  for each job why it has no result, else empty
  void append(std::size_t point, const SweepFemJobs& fem, const std::vector<std::string>& failures,
              std::string& text) {
    append(point, &fem, failures, text);
  }

  struct FemRequest {
    reference::FemProblem problem;
    double weight = 0;  ///< a rough estimate of the cost
  };
  /// Requests to the finite elements for the case's full reference, one per load; none where the
  /// bodies make no contact.
  std::vector<std::optional<FemRequest>> fem_requests(std::size_t point);

 private:
  void append(std::size_t point, const SweepFemJobs* fem, const std::vector<std::string>& failures,
              std::string& text);

  const Sweep& sweep_;
  std::vector<const PressureModel*> models_;
  const prediction::GeometryResolver& geometry_;
  prediction::Demand demand_;
  Sweep::Cases cases_;
  std::vector<double> values_;
};

/// All finite-element jobs. Their results are kept in `folder` under names made from the problems,
/// so that another sweep with the same contacts finds them.
SweepFemJobs sweep_fem_jobs(const Sweep& sweep, SweepRows& rows,
                            const std::filesystem::path& folder);

}  // namespace softfinger::sweep
