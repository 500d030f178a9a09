#pragma once

#include <string>
#include <vector>

#include "softfinger/calibration/measurement.h"

/// Measurements on a finger: a table of comma-separated values.
namespace softfinger::input {

/// Limits of a table. The message that refuses one states the limit.
constexpr std::size_t kLargestMeasurementFile = 1 << 20;  ///< bytes
constexpr std::size_t kMostMeasuredRows = 1000;

struct MeasurementTable {
  std::string file;             ///< as in messages
  std::vector<double> loads_N;  ///< ascending, each once
  /// SI. `contact` is the load's place in `loads_N`; std 0 where none was written.
  std::vector<Measurement> values;
  std::vector<int> lines;  ///< of each value, from 1
  /// The approach was read as position_mm: from a zero that is not that of the first touch.
  bool has_unknown_zero = false;

  /// The table with these values only, by their places, and their loads.
  MeasurementTable only(const std::vector<std::size_t>& places) const;
};

/// "a_mm", the column that a quantity is written in by this program; its values are those in SI
/// times `per_SI`.
struct MeasuredColumn {
  std::string name;
  double per_SI;
};
MeasuredColumn measured_column(MeasuredQuantity quantity);

/// The table's first line names its columns, the unit included: load_N and any of a_mm or a_m, b_mm
/// or b_m, area_mm2 or area_m2, indentation_mm or indentation_m, max_torque_mNm or max_torque_Nm,
/// tangential_force_N, each with its standard deviation under the same name and _std if that is
/// known. In place of the indentation there may be position_mm or position_m, what a machine reads:
/// its zero is not known, and rows with a load or a position of 0 or less, before the touch, are
/// skipped. A cell may be
/// empty. A load may occur in several rows. Lines that are empty or begin with # are skipped; a
/// byte order mark, CRLF and quotes around a cell are understood.
/// @param file  for messages
/// @throws InputError with "file:line", column and value
MeasurementTable parse_measurements(const std::string& text, const std::string& file);

/// @param typed  a path, the name of a built-in table, or - for standard input
MeasurementTable read_measurements(const std::string& typed);

}  // namespace softfinger::input
