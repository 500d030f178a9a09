#include "comparisons/input/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

struct KnownColumn {
  std::string_view name;
  std::optional<MeasuredQuantity> quantity;  ///< none: the load
  double si_per_unit;
  bool is_position = false;  ///< from an unknown zero
};
using Quantity = MeasuredQuantity;
// The first column of each quantity is the one that the program writes.
constexpr std::array<KnownColumn, 14> kColumns{
    {{"load_N", std::nullopt, 1, false},
     {"a_mm", Quantity::a, 1e-3, false},
     {"a_m", Quantity::a, 1, false},
     {"b_mm", Quantity::b, 1e-3, false},
     {"b_m", Quantity::b, 1, false},
     {"area_mm2", Quantity::area, 1e-6, false},
     {"area_m2", Quantity::area, 1, false},
     {"indentation_mm", Quantity::indentation, 1e-3, false},
     {"indentation_m", Quantity::indentation, 1, false},
     {"max_torque_mNm", Quantity::max_torque, 1e-3, false},
     {"max_torque_Nm", Quantity::max_torque, 1, false},
     {"tangential_force_N", Quantity::tangential_force, 1, false},
     {"position_mm", Quantity::indentation, 1e-3, true},
     {"position_m", Quantity::indentation, 1, true}}};
constexpr std::string_view kStdSuffix = "_std";

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

bool ends_in_std(std::string_view name) {
  return name.size() > kStdSuffix.size() &&
         name.substr(name.size() - kStdSuffix.size()) == kStdSuffix;
}

/// Loads of a table and the place of each value's, from the loads of the values.
void set_loads(MeasurementTable& table, const std::vector<double>& value_loads_N) {
  std::vector<double>& loads_N = table.loads_N;
  loads_N = value_loads_N;
  std::sort(loads_N.begin(), loads_N.end());
  loads_N.erase(std::unique(loads_N.begin(), loads_N.end()), loads_N.end());
  for (std::size_t i = 0; i < table.values.size(); ++i)
    table.values[i].contact = std::size_t(
        std::lower_bound(loads_N.begin(), loads_N.end(), value_loads_N[i]) - loads_N.begin());
}

class MeasurementReader {
 public:
  MeasurementReader(const std::string& text, const std::string& file) : rest_(text), file_(file) {}

  MeasurementTable read() {
    table_.file = file_;
    if (rest_.substr(0, 2) == "\xff\xfe" || rest_.substr(0, 2) == "\xfe\xff")
      throw InputError(file_, "the file is in UTF-16", "", "UTF-8, as plain CSV is saved");
    if (rest_.substr(0, 3) == "\xef\xbb\xbf") rest_.remove_prefix(3);
    if (!next_row()) throw InputError(file_, "the file is empty", "", "a line of column names");
    read_header();
    std::size_t rows = 0;
    while (next_row()) {
      if (++rows > kMostMeasuredRows)
        throw InputError(where(), "number of rows", "",
                         fmt::format("at most {}", kMostMeasuredRows));
      read_row();
    }
    if (table_.values.empty())
      throw InputError(file_, "no measured value", "", "at least one row with a load and a value");
    set_loads(table_, row_loads_N_);
    return std::move(table_);
  }

 private:
  struct Column {
    std::string name;
    const KnownColumn* known;
    bool is_std = false;
    std::size_t value = 0;           ///< of a standard deviation: the column that it belongs to
    std::optional<std::size_t> std;  ///< of a value: the column of its standard deviation
  };

  std::string where() const { return fmt::format("{}:{}", file_, line_); }
  [[noreturn]] void refuse(const std::string& field, const std::string& value,
                           const std::string& allowed) const {
    throw InputError(where(), field, value, allowed);
  }
  static std::string quoted(std::string_view text) { return "\"" + text::shortened(text) + "\""; }

  /// The next line that says something, in `cells_`.
  bool next_row() {
    while (!rest_.empty()) {
      const std::size_t end = rest_.find_first_of("\r\n");
      std::string_view line = rest_.substr(0, end);
      ++line_;
      if (end == std::string_view::npos)
        rest_ = {};
      else
        rest_.remove_prefix(end + (rest_.substr(end, 2) == "\r\n" ? 2 : 1));
      line = trimmed(line);
      if (line.empty() || line.front() == '#') continue;
      split(line);
      // A spreadsheet writes rows of nothing but commas behind the last one.
      if (std::all_of(cells_.begin(), cells_.end(), [](auto cell) { return cell.empty(); }))
        continue;
      return true;
    }
    return false;
  }

  void split(std::string_view line) {
    constexpr std::size_t kMostCells = 100;
    cells_.clear();
    for (;;) {
      const std::size_t comma = line.find(',');
      std::string_view cell = trimmed(line.substr(0, comma));
      if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
        cell = trimmed(cell.substr(1, cell.size() - 2));
      cells_.push_back(cell);
      if (comma == std::string_view::npos) return;
      if (cells_.size() == kMostCells)
        refuse("number of columns", "", fmt::format("at most {}", kMostCells));
      line.remove_prefix(comma + 1);
    }
  }

  std::size_t place_of(std::string_view name) const {
    const auto found = std::find_if(columns_.begin(), columns_.end(),
                                    [&](const Column& column) { return column.name == name; });
    return std::size_t(found - columns_.begin());
  }

  [[noreturn]] void refuse_unknown(std::string_view name) const {
    const std::string_view base =
        ends_in_std(name) ? name.substr(0, name.size() - kStdSuffix.size()) : name;
    std::vector<std::string> names, with_unit;
    for (const KnownColumn& column : kColumns) {
      names.emplace_back(column.name);
      if (column.name.substr(0, column.name.rfind('_')) == base)
        with_unit.emplace_back(column.name);
    }
    const std::string allowed = text::joined(names) + ", and each with _std";
    if (cells_.size() == 1 && name.find(';') != std::string_view::npos)
      refuse("columns separated by semicolons", quoted(name), "commas, and points in numbers");
    if (!with_unit.empty())
      refuse("column without a unit", quoted(name), text::joined(with_unit, " or "));
    refuse(fmt::format("unknown column {}{}", quoted(name), text::did_you_mean(name, names)), "",
           allowed);
  }

  void read_header() {
    std::map<MeasuredQuantity, std::string_view> seen;
    for (const std::string_view cell : cells_) {
      const bool is_std = ends_in_std(cell);
      const std::string_view base = is_std ? cell.substr(0, cell.size() - kStdSuffix.size()) : cell;
      const auto known =
          std::find_if(kColumns.begin(), kColumns.end(),
                       [&](const KnownColumn& column) { return column.name == base; });
      if (known == kColumns.end()) refuse_unknown(cell);
      if (place_of(cell) < columns_.size()) refuse("column", quoted(cell), "each column once");
      if (is_std && !known->quantity)
        refuse("column", quoted(cell), "no error of the load: it is taken as exact");
      if (!is_std && known->quantity) {
        const auto [other, is_new] = seen.insert({*known->quantity, cell});
        if (!is_new)
          refuse("column", quoted(cell),
                 fmt::format("each quantity once; it is there as {}", other->second));
      }
      table_.has_unknown_zero = table_.has_unknown_zero || known->is_position;
      columns_.push_back({std::string(cell), &*known, is_std, 0, std::nullopt});
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (!columns_[i].is_std) continue;
      const std::size_t value = place_of(columns_[i].known->name);
      if (value == columns_.size())
        refuse("column", quoted(columns_[i].name),
               fmt::format("an error of a column that is there: {} is missing",
                           columns_[i].known->name));
      columns_[i].value = value;
      columns_[value].std = i;
    }
    load_ = place_of("load_N");
    if (load_ == columns_.size()) refuse("no column", "load_N", "one, the load of each row");
    if (seen.empty()) refuse("no column of a measured quantity", "", "one or more, as a_mm");
  }

  /// A number > 0 of a cell that is not empty, in SI.
  double positive(std::size_t place) const {
    const std::string_view cell = cells_[place];
    const std::string allowed =
        columns_[place].is_std
            ? "a finite standard deviation > 0, or an empty cell where it is not known"
        : place == load_ ? "a finite number > 0"
                         : "a finite number > 0, or an empty cell";
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
      refuse(columns_[place].name, quoted(cell), allowed);
    value *= columns_[place].known->si_per_unit;
    // Far beyond any finger; the square of the least is still a number.
    constexpr double kLeast = 1e-100, kLargest = 1e100;
    if (!(value >= kLeast && value <= kLargest))
      refuse(columns_[place].name, std::string(text::shortened(cell)), allowed);
    return value;
  }

  /// A machine's row before the touch: its load cell reads nothing or less, or it has not moved.
  bool is_before_touch() const {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (i != load_ && !columns_[i].known->is_position) continue;
      const std::string_view cell = cells_[i];
      double value = 1;
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (error == std::errc() && end == cell.data() + cell.size() && value <= 0) return true;
    }
    return false;
  }

  void read_row() {
    if (cells_.size() != columns_.size())
      refuse("number of cells", std::to_string(cells_.size()),
             fmt::format("{}, one for each column (a decimal comma makes two of one)",
                         columns_.size()));
    if (cells_[load_].empty()) refuse("load_N", "\"\"", "a load in each row");
    if (table_.has_unknown_zero && is_before_touch()) return;
    const double load_N = positive(load_);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (i == load_ || columns_[i].is_std) continue;
      const std::optional<std::size_t> std = columns_[i].std;
      if (cells_[i].empty()) {
        if (std && !cells_[*std].empty())
          refuse(columns_[*std].name, quoted(cells_[*std]),
                 fmt::format("an empty cell, as {} is empty", columns_[i].name));
        continue;
      }
      const double value = positive(i);
      table_.values.push_back({*columns_[i].known->quantity, 0, value,
                               std && !cells_[*std].empty() ? positive(*std) : 0});
      table_.lines.push_back(line_);
      row_loads_N_.push_back(load_N);
    }
  }

  std::string_view rest_;
  const std::string& file_;
  int line_ = 0;
  std::vector<std::string_view> cells_;
  std::vector<Column> columns_;
  std::size_t load_ = 0;
  std::vector<double> row_loads_N_;  ///< of each value
  MeasurementTable table_;
};

}  // namespace

MeasurementTable MeasurementTable::only(const std::vector<std::size_t>& places) const {
  MeasurementTable part{file, {}, {}, {}, has_unknown_zero};
  std::vector<double> value_loads_N;
  for (const std::size_t place : places) {
    part.values.push_back(values[place]);
    part.lines.push_back(lines[place]);
    value_loads_N.push_back(loads_N[values[place].contact]);
  }
  set_loads(part, value_loads_N);
  return part;
}

MeasuredColumn measured_column(MeasuredQuantity quantity) {
  for (const KnownColumn& column : kColumns)
    if (column.quantity == quantity) return {std::string(column.name), 1 / column.si_per_unit};
  return {};
}

MeasurementTable parse_measurements(const std::string& text, const std::string& file) {
  return MeasurementReader(text, file).read();
}

MeasurementTable read_measurements(const std::string& typed) {
  if (typed == "-")
    return parse_measurements(system::read_standard_input(kLargestMeasurementFile),
                              "standard input");
  const std::filesystem::path path = system::find_measurement_file(typed);
  return parse_measurements(system::read_text_file(path, kLargestMeasurementFile), path.string());
}

}  // namespace softfinger::input
