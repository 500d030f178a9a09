#include "comparisons/input/held_forces.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "comparisons/input/measurements.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

std::string without_blanks(const std::string& text) {
  const char* const kBlanks = " \t\r\"";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

/// Cells of the lines that say something, with the line's number.
struct NumberedRow {
  int line;
  std::vector<std::string> cells;
};
std::vector<NumberedRow> rows_of(const std::string& text) {
  std::vector<NumberedRow> rows;
  std::istringstream lines(text.compare(0, 3, "\xef\xbb\xbf") == 0 ? text.substr(3) : text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    line = without_blanks(line);
    if (line.empty() || line[0] == '#') continue;
    NumberedRow row{number, {}};
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');)
      row.cells.push_back(without_blanks(cell));
    if (line.back() == ',') row.cells.emplace_back();
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

bool has_times(const std::string& text) {
  const std::vector<NumberedRow> rows = rows_of(text);
  if (rows.empty()) return false;
  for (const std::string& cell : rows[0].cells)
    if (cell == "time_s") return true;
  return false;
}

std::vector<HeldForce> parse_held_forces(const std::string& text, const std::string& file) {
  const std::vector<NumberedRow> rows = rows_of(text);
  std::optional<std::size_t> time, load;
  const auto where = [&](const NumberedRow& row) { return fmt::format("{}:{}", file, row.line); };
  const std::vector<std::string> known = {"time_s", "load_N"};
  for (std::size_t i = 0; i < rows[0].cells.size(); ++i) {
    const std::string& name = rows[0].cells[i];
    std::optional<std::size_t>& column = name == "time_s" ? time : load;
    if (name != "time_s" && name != "load_N")
      throw InputError(where(rows[0]),
                       "column \"" + text::shortened(name) + "\" beside time_s" +
                           text::did_you_mean(name, known),
                       "", "time_s and load_N, the force while the approach stands still");
    if (column) throw InputError(where(rows[0]), "column", name, "each column once");
    column = i;
  }
  if (!load) throw InputError(where(rows[0]), "no column", "load_N", "one beside time_s");
  if (rows.size() > kMostMeasuredRows + 1)
    throw InputError(file, "number of rows", std::to_string(rows.size() - 1),
                     fmt::format("at most {}", kMostMeasuredRows));
  std::vector<HeldForce> forces;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const NumberedRow& row = rows[k];
    if (row.cells.size() != rows[0].cells.size())
      throw InputError(where(row), "number of cells", std::to_string(row.cells.size()),
                       fmt::format("{}, one for each column", rows[0].cells.size()));
    const auto number = [&](std::size_t place, bool zero_allowed, const char* allowed) {
      const std::string& cell = row.cells[place];
      double value = 0;
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      const bool is_number = error == std::errc() && end == cell.data() + cell.size();
      if (!is_number || !std::isfinite(value) || value < 0 || (value == 0 && !zero_allowed))
        throw InputError(where(row), rows[0].cells[place], "\"" + text::shortened(cell) + "\"",
                         allowed);
      return value;
    };
    forces.push_back(
        {number(*time, true, "a finite number >= 0, seconds since the approach stopped"),
         number(*load, false, "a finite number > 0")});
  }
  return forces;
}

}  // namespace softfinger::input
