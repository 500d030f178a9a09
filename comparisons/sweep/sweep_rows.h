#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/sweep/sweep_file.h"
#include "comparisons/sweep/swept_contact.h"

/// The rows of results.csv: one per point of the sweep and load, SI units in the columns' names.
namespace softfinger::sweep {

/// Makes rows. Each thread has its own; the contact is shared between them.
class SweepRows {
 public:
  SweepRows(const Sweep& sweep, const SweptContact& contact);

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

  /// Requests to the finite elements for the case's full reference, one per load; none where the
  /// bodies make no contact, and where the elements would refuse it.
  std::vector<std::optional<FemRequest>> fem_requests(std::size_t point);

 private:
  void append(std::size_t point, const SweepFemJobs* fem, const std::vector<std::string>& failures,
              std::string& text);

  const Sweep& sweep_;
  const SweptContact& contact_;
  Sweep::Cases cases_;
  std::vector<double> values_;
};

/// All finite-element jobs. Their results are kept in `folder` under names made from the problems,
/// so that another sweep with the same contacts finds them.
SweepFemJobs sweep_fem_jobs(const Sweep& sweep, SweepRows& rows,
                            const std::filesystem::path& folder);

}  // namespace softfinger::sweep
