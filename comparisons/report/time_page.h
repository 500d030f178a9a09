#pragma once

#include <string>
#include <vector>

namespace softfinger::report {

/// A contact against time, of one load or one history.
struct TimeSeries {
  std::string title;             ///< "2 N held"
  std::string model;             ///< whose contact it is
  bool is_logarithmic = false;   ///< the time's axis
  double marked_s = 0;           ///< the time that was asked for; not finite or 0: none
  std::vector<double> time_s;    ///< ascending
  std::vector<double> load_N;    ///< at each time, as all of these
  std::vector<double> length_m;  ///< 2a
  std::vector<double> width_m;   ///< 2b
  std::vector<double> indentation_m, max_torque_Nm;
};

struct TimePage {
  std::string case_id;
  std::string facts;    ///< the case in words
  std::string answers;  ///< the lines that the command prints
  std::vector<TimeSeries> series;
  std::string version, command;
};

/// One HTML file: contact, indentation, torque and load against time, as curves and in a table.
/// Needs neither network nor JavaScript.
std::string time_page(const TimePage& content);

}  // namespace softfinger::report
