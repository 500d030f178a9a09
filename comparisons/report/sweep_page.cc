#include "comparisons/report/sweep_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "comparisons/judgement/median.h"
#include "comparisons/report/atlas_sections.h"
#include "comparisons/report/embedded.h"
#include "comparisons/report/page.h"
#include "comparisons/report/style.h"
#include "comparisons/text/base64.h"

namespace softfinger::report {
namespace {

constexpr char kSpace[] = "\u00a0";
constexpr std::size_t kRowsOfTable = 50, kReasons = 10;

struct Quantity {
  const char* name;
  const char* column;  ///< of results.csv, after the model's name
  const char* words;
  const char* unit;
  double factor;         ///< from SI
  int interest;          ///< place in the sentence about a model
  bool decides = false;  ///< models are compared by it
};
/// All that curved contacts and flat pads have; a page shows those that its rows have.
constexpr std::array<Quantity, 12> kKnownQuantities{
    {{"a", "a_m", "a", "mm", 1e3, 1},
     {"b", "b_m", "b", "mm", 1e3, 2},
     {"indentation", "indentation_m", "indentation", "mm", 1e3, 4},
     {"normal_stiffness", "normal_stiffness_N_per_m", "stiffness", "N/mm", 1e-3, 6},
     {"peak_pressure", "peak_pressure_Pa", "peak pressure", "kPa", 1e-3, 5},
     {"area", "area_m2", "area", "mm²", 1e6, 3, true},
     {"pressure_arm", "pressure_arm_m", "arm as pressed", "mm", 1e3, 7},
     {"max_torque", "max_torque_Nm", "largest torque", "mN·m", 1e3, 0, true},
     {"tilt_stiffness_x", "tilt_stiffness_x_Nm_per_rad", "tilt stiffness about x", "N·m/rad", 1, 8},
     {"tilt_stiffness_y", "tilt_stiffness_y_Nm_per_rad", "tilt stiffness about y", "N·m/rad", 1, 9},
     {"tilt_limit_x", "tilt_limit_x_Nm", "lift-off about x", "mN·m", 1e3, 10},
     {"tilt_limit_y", "tilt_limit_y_Nm", "lift-off about y", "mN·m", 1e3, 11}}};

Html with_unit(const Html& number, const std::string& unit) {
  return unit.empty() ? number : html("{}{}{}", number, kSpace, unit);
}

/// "1 to 3 mm", or "1 mm" where nothing varies.
Html range_text(double least, double largest, const std::string& unit) {
  const Html from = significant(least, 3), to = significant(largest, 3);
  return with_unit(from == to ? from : from + " to " + to, unit);
}

Html listed(const std::vector<Html>& parts) {
  Html out;
  for (std::size_t i = 0; i < parts.size(); ++i)
    out += (i == 0 ? Html("") : i + 1 == parts.size() ? Html(" and ") : ", ") + parts[i];
  return out;
}

std::string grouped(double count) {
  std::string digits = fmt::format("{:.0f}", count);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, ",");
  return digits;
}

std::string count_text(double count, const char* one, const char* many) {
  return grouped(count) + kSpace + (count == 1 ? one : many);
}

/// A swept key in words, not escaped: `layer.thickness_mm` -> thickness, mm.
struct KeyName {
  std::string words, unit;
};
KeyName key_name(const std::string& key) {
  static const std::map<std::string, KeyName> kKnown{
      {"relative_radii_mm[0]", {"R′", "mm"}},
      {"relative_radii_mm[1]", {"R″", "mm"}},
      {"youngs_modulus_kPa", {"Young’s modulus", "kPa"}},
      {"poisson_ratio", {"Poisson’s ratio", ""}},
      {"pad_mm[0]", {"side along x", "mm"}},
      {"pad_mm[1]", {"side along y", "mm"}},
      {"offset_mm[0]", {"offset along x", "mm"}},
      {"offset_mm[1]", {"offset along y", "mm"}},
      {"load_at_mm[0]", {"load’s place along x", "mm"}},
      {"load_at_mm[1]", {"load’s place along y", "mm"}},
      {"angle_deg", {"angle", "°"}}};
  static const std::array<const char*, 8> kUnits{"mm", "kPa", "MPa", "N", "m", "Pa", "deg", "rad"};
  std::string words = key.substr(key.rfind('.') + 1);
  if (const auto known = kKnown.find(words); known != kKnown.end()) return known->second;
  std::string index, unit;
  if (const std::size_t bracket = words.find('['); bracket != std::string::npos) {
    index = " " + words.substr(bracket);
    words.resize(bracket);
  }
  const std::size_t last = words.rfind('_');
  if (last != std::string::npos &&
      std::find(kUnits.begin(), kUnits.end(), words.substr(last + 1)) != kUnits.end()) {
    unit = words.substr(last + 1);
    words.resize(last);
  }
  std::replace(words.begin(), words.end(), '_', ' ');
  return {words + index, unit};
}

/// The rows by column, numbers that are missing as NaN.
class Columns {
 public:
  explicit Columns(const Json& sweep) : rows_(child(sweep, "rows")) {
    for (const Json& name : child(sweep, "columns"))
      names_.push_back(name.is_string() ? name.get<std::string>() : std::string());
  }

  std::size_t rows() const { return rows_.size(); }

  bool has(const std::string& name) const { return index(name) < names_.size(); }

  std::vector<double> numbers(const std::string& name) const {
    std::vector<double> values(rows(), NAN);
    const std::size_t column = index(name);
    for (std::size_t row = 0; row < rows(); ++row)
      values[row] = element(rows_[row], column).value_or(NAN);
    return values;
  }

  std::vector<std::string> texts(const std::string& name) const {
    std::vector<std::string> values(rows());
    const std::size_t column = index(name);
    for (std::size_t row = 0; row < rows(); ++row)
      if (rows_[row].is_array() && column < rows_[row].size() && rows_[row][column].is_string())
        values[row] = rows_[row][column].get<std::string>();
    return values;
  }

 private:
  std::size_t index(const std::string& name) const {
    return std::find(names_.begin(), names_.end(), name) - names_.begin();
  }

  const Json& rows_;
  std::vector<std::string> names_;
};

/// Variable that an axis of the picture can show: a swept key, or the load.
struct Variable {
  std::string key, words, unit;  ///< not escaped
  bool log = false;
  double count = 0, least = NAN, largest = NAN;
  std::vector<double> values;  ///< of each row
};

/// A model's answers, or the finite elements', by quantity and row, in the quantities' units.
struct Source {
  std::string name, title;
  std::vector<std::vector<double>> values;
  std::vector<std::vector<double>> errors;  ///< relative; of finite elements only
  std::vector<std::uint8_t> valid;

  bool answers(std::size_t row) const {
    for (const std::vector<double>& quantity : values)
      if (std::isfinite(quantity[row])) return true;
    return false;
  }
};

/// Data of the page, read from a sweep.
struct Table {
  std::vector<Quantity> quantities;
  std::vector<Variable> variables;
  std::vector<Source> models;
  std::vector<Source> fem;  ///< one or none
  std::vector<double> points, loads_N;
  std::vector<double> friction_coefficient;  ///< empty where it is not known
  std::vector<std::string> failures;
  std::size_t rows = 0;
  std::string leading_model;
  std::string usable;  ///< what usable answers are: "within 10 %"
};

/// The known quantities that some source of the rows has.
std::vector<Quantity> quantities_of(const Columns& columns, const Json& sweep) {
  std::vector<Quantity> found;
  for (const Quantity& quantity : kKnownQuantities) {
    bool is_there = columns.has(std::string("fem_") + quantity.column);
    for (const Json& model : child(sweep, "models"))
      is_there = is_there || columns.has(text(model, "name") + "_" + quantity.column);
    if (is_there) found.push_back(quantity);
  }
  return found;
}

Source source_of(const Columns& columns, const std::vector<Quantity>& quantities,
                 const std::string& name) {
  Source source;
  source.name = name;
  for (const Quantity& quantity : quantities) {
    source.values.push_back(columns.numbers(name + "_" + quantity.column));
    for (double& value : source.values.back()) value *= quantity.factor;
  }
  for (const std::string& word : columns.texts(name + "_usable"))
    source.valid.push_back(word == "yes");
  return source;
}

/// Then the load of a row is the key's value, not one of a list beside it.
bool sweeps_load(const Json& sweep) {
  for (const Json& key : child(sweep, "keys"))
    if (text(key, "key").rfind("contact.load_N", 0) == 0) return true;
  return false;
}

Table table_of(const Json& sweep) {
  const Columns columns(sweep);
  Table table;
  table.rows = columns.rows();
  table.quantities = quantities_of(columns, sweep);
  table.points = columns.numbers("point");
  table.failures = columns.texts("failure");
  std::map<std::string, int> uses;
  for (const Json& key : child(sweep, "keys")) {
    Variable variable;
    variable.key = text(key, "key");
    const KeyName name = key_name(variable.key);
    variable.words = name.words;
    variable.unit = name.unit;
    variable.log = flag(key, "log");
    variable.count = number(key, "count").value_or(0);
    variable.least = number(key, "least").value_or(NAN);
    variable.largest = number(key, "largest").value_or(NAN);
    variable.values = columns.numbers(variable.key);
    ++uses[variable.words];
    table.variables.push_back(std::move(variable));
  }
  // "radii" of the finger and of the object: only the whole key tells them apart.
  for (Variable& variable : table.variables)
    if (uses[variable.words] > 1) variable.words = variable.key;
  table.loads_N = columns.numbers("load_N");
  if (!sweeps_load(sweep)) {
    Variable load;
    load.key = "load_N";
    load.words = "load";
    load.unit = "N";
    load.values = table.loads_N;
    table.variables.push_back(std::move(load));
  }
  table.leading_model = text(sweep, "leading_model");
  table.usable = text(sweep, "usable");
  for (const Json& model : child(sweep, "models")) {
    const std::string name = text(model, "name");
    if (name.empty()) continue;
    table.models.push_back(source_of(columns, table.quantities, name));
    table.models.back().title = text(model, "title");
  }
  if (flag(sweep, "fem")) {
    Source fem = source_of(columns, table.quantities, "fem");
    for (const Quantity& quantity : table.quantities)
      fem.errors.push_back(columns.numbers(std::string("fem_error_") + quantity.name));
    table.fem.push_back(std::move(fem));
  }
  if (columns.has("contact.friction_coefficient"))
    table.friction_coefficient = columns.numbers("contact.friction_coefficient");
  else if (const auto friction = number(sweep, "friction_coefficient"))
    table.friction_coefficient.assign(table.rows, *friction);
  return table;
}

/// The model that the sweep names, else the first with any answer.
const Source* leading_model(const Table& table) {
  for (const Source& model : table.models)
    if (model.name == table.leading_model) return &model;
  for (const Source& model : table.models)
    for (std::size_t row = 0; row < table.rows; ++row)
      if (model.answers(row)) return &model;
  return nullptr;
}

struct Range {
  double least = INFINITY, largest = -INFINITY;
  std::size_t count = 0;
};
Range range_of(const std::vector<double>& values) {
  Range range;
  for (const double value : values)
    if (std::isfinite(value)) {
      range.least = std::min(range.least, value);
      range.largest = std::max(range.largest, value);
      ++range.count;
    }
  return range;
}

/// |model - FEM| / FEM of one row; NaN where one of them has no answer.
double deviation(const Table& table, const Source& model, std::size_t quantity, std::size_t row) {
  const double reference = table.fem[0].values[quantity][row];
  return std::abs(model.values[quantity][row] / reference - 1);
}

struct Deviations {
  double median = NAN, worst = NAN;
  std::size_t count = 0;
};
Deviations deviations_of(std::vector<double> errors) {
  Deviations out;
  errors.erase(std::remove_if(errors.begin(), errors.end(), [](double e) { return std::isnan(e); }),
               errors.end());
  out.count = errors.size();
  if (errors.empty()) return out;
  out.worst = *std::max_element(errors.begin(), errors.end());
  out.median = judgement::median(std::move(errors));
  return out;
}

/// The largest of the errors by which models are compared in all reports: of area and torque; a
/// pad's area is its own.
double score_of(const Table& table, const Source& model, std::size_t row) {
  double largest = 0;
  for (std::size_t i = 0; i < table.quantities.size(); ++i) {
    if (!table.quantities[i].decides) continue;
    const double error = deviation(table, model, i, row);
    if (std::isnan(error)) return NAN;
    largest = std::max(largest, error);
  }
  return largest;
}

std::size_t rows_with_fem(const Table& table) {
  std::size_t count = 0;
  for (std::size_t row = 0; row < table.rows; ++row) {
    bool is_whole = true;
    for (std::size_t i = 0; i < table.quantities.size(); ++i)
      is_whole =
          is_whole && (!table.quantities[i].decides || std::isfinite(table.fem[0].values[i][row]));
    count += is_whole;
  }
  return count;
}

/// "area and torque are", or "torque is".
Html decisive_words(const Table& table) {
  const bool has_area =
      std::any_of(table.quantities.begin(), table.quantities.end(),
                  [](const Quantity& q) { return q.name == std::string_view("area"); });
  if (has_area) return "area and torque are";
  return "torque is";
}

bool is_load(const Variable& variable) {
  return variable.key == "load_N" || variable.key.rfind("contact.load_N", 0) == 0;
}

/// Values on a logarithmic axis have many digits, of which a sentence needs four.
Html brief(double value) { return html("{:.4g}", value); }

/// "thickness 1 mm and load 20 N": the row's values of what varies.
Html row_words(const Table& table, std::size_t row, bool has_load = true) {
  std::vector<Html> parts;
  for (const Variable& variable : table.variables) {
    if (is_load(variable) && !has_load) continue;
    const auto [least, largest] =
        std::minmax_element(variable.values.begin(), variable.values.end());
    if (least == variable.values.end() || *least == *largest) continue;
    parts.push_back(
        html("{} {}", variable.words, with_unit(brief(variable.values[row]), variable.unit)));
  }
  return listed(parts);
}

/// Says how far the second of two models is from the first or the finite elements.
Html finding_of_other(const Table& table, const Source& first) {
  if (table.models.size() != 2) return "";
  const Source& other = &first == &table.models[0] ? table.models[1] : table.models[0];
  const Source& reference = table.fem.empty() ? first : table.fem[0];
  for (std::size_t i = 0; i < table.quantities.size(); ++i) {
    if (table.quantities[i].name != std::string_view("max_torque")) continue;
    double worst = 0;
    std::size_t where = table.rows;
    for (std::size_t row = 0; row < table.rows; ++row) {
      const double apart = other.values[i][row] / reference.values[i][row] - 1;
      if (!(std::abs(apart) > std::abs(worst))) continue;
      worst = apart;
      where = row;
    }
    if (where == table.rows) return "";
    const Html at = row_words(table, where);
    return html(" {}’s torque is up to {} {} than that of {}{}{}.", label(other.name),
                percent(std::abs(worst)), worst < 0 ? "smaller" : "larger",
                table.fem.empty() ? Html(escape(label(first.name))) : "the elements",
                at.empty() ? Html("") : " at ", at);
  }
  return "";
}

Html finding_with_fem(const Table& table) {
  const std::size_t compared = rows_with_fem(table);
  const Source* best = nullptr;
  Deviations of_best;
  double least = INFINITY;
  for (const Source& model : table.models) {
    std::vector<double> errors;
    for (std::size_t row = 0; row < table.rows; ++row)
      errors.push_back(score_of(table, model, row));
    const Deviations found = deviations_of(errors);
    if (found.count == 0) continue;
    // A row without an answer is infinitely far off: who answers little must not look best.
    errors.erase(
        std::remove_if(errors.begin(), errors.end(), [](double e) { return std::isnan(e); }),
        errors.end());
    errors.resize(compared, INFINITY);
    const double median = deviations_of(errors).median;
    if (best && median >= least) continue;
    best = &model;
    of_best = found;
    least = median;
  }
  if (!best) return "";
  return html(
             "Closest to the finite elements is {}: {} off by {} in the median and {} at "
             "worst (over {} of the {} with finite elements).",
             label(best->name), decisive_words(table), percent(of_best.median),
             percent(of_best.worst), grouped(double(of_best.count)),
             count_text(double(compared), "row", "rows")) +
         finding_of_other(table, *best);
}

/// The ranges over the rows in which the model is usable; over all its answers where it never is.
Html finding_of_models(const Table& table) {
  const Source* model = leading_model(table);
  if (!model) return "No model has an answer.";
  std::size_t answered = 0, usable = 0;
  for (std::size_t row = 0; row < table.rows; ++row)
    if (model->answers(row)) {
      ++answered;
      usable += model->valid[row];
    }
  constexpr std::size_t kMostNamed = 6;
  std::map<int, Html> parts;  // by interest
  for (std::size_t i = 0; i < table.quantities.size(); ++i) {
    const Quantity& quantity = table.quantities[i];
    std::vector<double> values = model->values[i];
    if (usable > 0)
      for (std::size_t row = 0; row < table.rows; ++row)
        if (!model->valid[row]) values[row] = NAN;
    if (const Range range = range_of(values); range.count > 0)
      parts[quantity.interest] =
          html("{} {}", quantity.words, range_text(range.least, range.largest, quantity.unit));
  }
  std::vector<Html> named;
  for (const auto& [interest, words] : parts)
    if (named.size() < kMostNamed) named.push_back(words);
  return html("By {}, usable ({}) in {} of {}: {}.", label(model->name), table.usable,
              grouped(double(usable)), count_text(double(answered), "row", "rows"), listed(named)) +
         finding_of_other(table, *model);
}

/// The rows of one load with the least and the largest torque.
struct TorqueSpan {
  std::size_t least, largest;
};

Html torque_text(double torque_mNm) { return with_unit(significant(torque_mNm, 1, 3), "mN·m"); }

/// Values of the only other number that varies at which the model is usable at every load.
Html usable_at_every_load(const Table& table, const Source& model) {
  const Variable* varied = nullptr;
  for (const Variable& variable : table.variables) {
    const Range range = range_of(variable.values);
    if (is_load(variable) || !(range.least < range.largest)) continue;
    if (varied) return "";
    varied = &variable;
  }
  if (!varied) return "";
  std::map<double, bool> holds;
  for (std::size_t row = 0; row < table.rows; ++row)
    if (std::isfinite(varied->values[row]))
      holds.try_emplace(varied->values[row], true).first->second &= bool(model.valid[row]);
  std::vector<std::pair<double, double>> stretches;
  bool goes_on = false;
  for (const auto& [value, is_usable] : holds) {
    if (is_usable && goes_on)
      stretches.back().second = value;
    else if (is_usable)
      stretches.push_back({value, value});
    goes_on = is_usable;
  }
  // Everywhere is said already, and many pieces are a picture's task.
  if (stretches.size() != 1 ||
      stretches[0] == std::pair(holds.begin()->first, holds.rbegin()->first))
    return "";
  const auto [from, to] = stretches[0];
  return html(" Usable at every load: {} {}.", varied->words,
              with_unit(from == to ? brief(from) : brief(from) + " to " + brief(to), varied->unit));
}

/// The answer to most sweeps: with which values the torque is largest, each load by itself, since
/// a larger load always gives more. Only usable answers count, where there are any.
Html torque_answer(const Table& table) {
  const Source* model = leading_model(table);
  const auto torque = std::find_if(
      table.quantities.begin(), table.quantities.end(),
      [](const Quantity& quantity) { return quantity.name == std::string_view("max_torque"); });
  if (!model || torque == table.quantities.end()) return "";
  const std::vector<double>& values = model->values[std::size_t(torque - table.quantities.begin())];
  const bool has_usable = std::any_of(model->valid.begin(), model->valid.end(),
                                      [](std::uint8_t is_usable) { return is_usable; });
  std::map<double, TorqueSpan> loads;
  for (std::size_t row = 0; row < table.rows; ++row) {
    if (!std::isfinite(values[row]) || (has_usable && !model->valid[row])) continue;
    TorqueSpan& span = loads.try_emplace(table.loads_N[row], TorqueSpan{row, row}).first->second;
    if (values[row] < values[span.least]) span.least = row;
    if (values[row] > values[span.largest]) span.largest = row;
  }
  if (loads.empty()) return "";
  std::map<std::string, std::vector<TorqueSpan>> winners;  // by their values in words
  for (const auto& [load_N, span] : loads)
    if (values[span.least] < values[span.largest])
      winners[row_words(table, span.largest, false).markup()].push_back(span);
  if (winners.empty()) {
    const std::size_t first = loads.begin()->second.largest, last = loads.rbegin()->second.largest;
    const Html at = row_words(table, last);
    return html("<b>The largest torque is {}{}{}</b>{}.", torque_text(values[last]),
                at.empty() ? Html("") : " at ", at,
                first == last
                    ? Html("")
                    : html(", and {} at {}", torque_text(values[first]), row_words(table, first)));
  }
  const auto winner = std::max_element(
      winners.begin(), winners.end(),
      [](const auto& one, const auto& other) { return one.second.size() < other.second.size(); });
  const TorqueSpan& span = winner->second.back();
  return html("<b>The largest torque is held with {}</b>{}: {} at {}, {} times that with {}.{}",
              row_words(table, span.largest, false),
              loads.size() == 1 ? Html("")
              : winner->second.size() == loads.size()
                  ? Html(" at every load")
                  : html(" at {} of {} loads", winner->second.size(), loads.size()),
              torque_text(values[span.largest]), with_unit(brief(table.loads_N[span.largest]), "N"),
              significant(values[span.largest] / values[span.least], 1, 2),
              row_words(table, span.least, false), usable_at_every_load(table, *model));
}

Html loads_text(const Json& sweep) {
  const Json& loads = child(sweep, "loads_N");
  std::vector<double> known;
  for (std::size_t i = 0; i < loads.size(); ++i)
    if (const auto load = element(loads, i)) known.push_back(*load);
  if (known.empty() || sweeps_load(sweep)) return "";
  if (known.size() > 5) {
    const auto [least, largest] = std::minmax_element(known.begin(), known.end());
    return html(" at {} loads from {} to {}", known.size(), plain(*least), newton(*largest));
  }
  std::vector<Html> parts;
  for (const double load : known) parts.push_back(escape(plain(load)));
  return " at " + listed(parts) + kSpace + "N";
}

Html sweep_lead(const Json& sweep, const Table& table) {
  std::vector<Html> swept;
  const double points = number(sweep, "points").value_or(0);
  const bool single = child(sweep, "keys").size() == 1;
  for (const Variable& variable : table.variables) {
    if (variable.key == "load_N") continue;
    Html part = escape(variable.words);
    if (std::isfinite(variable.least) && std::isfinite(variable.largest)) {
      const std::string least = plain(variable.least), largest = plain(variable.largest);
      part += " " +
              with_unit(escape(least == largest ? least : least + " to " + largest), variable.unit);
    }
    // Keys that change together or at random have a different value at every point. Their number of
    // values is that of the points and is left out.
    if (variable.count > 1 && (single || variable.count != points))
      part += html(" ({}{})", count_text(variable.count, "value", "values"),
                   variable.log ? ", log" : "");
    swept.push_back(part);
  }
  const double all = number(sweep, "all_rows").value_or(double(table.rows));
  const double failed = number(sweep, "failed").value_or(0);
  const Html against_fem = table.fem.empty() ? "" : finding_with_fem(table);
  const Html torque = torque_answer(table);
  const Html of_models = against_fem.empty() ? finding_of_models(table) : Html("");
  // A sweep with finite elements asks first how far the models are from them.
  Html out = "<p class=\"lead\">" +
             joined(against_fem.empty() ? std::vector<Html>{torque.empty() ? of_models : torque}
                                        : std::vector<Html>{against_fem, torque},
                    " ") +
             "</p>\n";
  if (!torque.empty() && !of_models.empty()) out += "<p>" + of_models + "</p>\n";
  out += html(
      "<p class=\"facts\"><span class=\"badge {}\">{}</span> {} {}{}: {}, {}; {} {} an answer, "
      "{} failed.</p>\n",
      failed > 0 ? "mixed" : "good",
      failed > 0 ? count_text(failed, "row failed", "rows failed") : "✓ no row failed",
      swept.empty() ? "Nothing was swept" : "Swept were", listed(swept), loads_text(sweep),
      count_text(points, "point", "points"), count_text(all, "row", "rows"),
      count_text(std::max(0., all - failed), "row", "rows"), all - failed == 1 ? "has" : "have",
      grouped(failed));
  if (double(table.rows) < all)
    out += html(
        "<p class=\"facts\">{} of {}, evenly spaced, are drawn; all are in "
        "<code>results.csv</code>. The sentences above and the tables use only those drawn.</p>\n",
        grouped(double(table.rows)), count_text(all, "row", "rows"));
  return out;
}

Html head_cell(const Quantity& quantity, const std::string& source = "") {
  return html("<th scope=\"col\">{}<span class=\"unit\">{}</span>{}</th>", quantity.words,
              quantity.unit, source.empty() ? "" : html("<small>{}</small>", source));
}

Html scrolled(const Html& head, const Html& rows) {
  return "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr>" + head +
         "</tr></thead>\n<tbody>" + rows + "</tbody></table></div>\n";
}

Html name_cell(const Source& source) {
  const std::string name = label(source.name);
  return html("<th scope=\"row\">{}{}</th>", name,
              source.title.empty() || source.title == name
                  ? ""
                  : html("<small class=\"about\">{}</small>", source.title));
}

Html ranges_section(const Table& table) {
  Html head =
      "<th scope=\"col\">model</th><th scope=\"col\">rows with an answer</th><th "
      "scope=\"col\">of these usable</th>";
  for (const Quantity& quantity : table.quantities) head += head_cell(quantity);
  Html rows;
  const auto add = [&](const Source& source, bool is_fem) {
    std::size_t answered = 0, valid = 0;
    for (std::size_t row = 0; row < table.rows; ++row)
      if (source.answers(row)) {
        ++answered;
        valid += source.valid[row];
      }
    rows += (is_fem ? Html("<tr class=\"fem\">") : "<tr>") + name_cell(source) +
            html("<td>{}</td><td>{}</td>", grouped(double(answered)),
                 is_fem ? "" : grouped(double(valid)));
    for (const std::vector<double>& values : source.values) {
      const Range range = range_of(values);
      rows += html("<td>{}</td>",
                   range.count == 0 ? "–" : range_text(range.least, range.largest, std::string()));
    }
    rows += "</tr>\n";
  };
  for (const Source& fem : table.fem) add(fem, true);
  for (const Source& model : table.models) add(model, false);
  return "<h2 id=\"ranges\">How far each quantity varies</h2>\n" + scrolled(head, rows);
}

Html deviations_table(const Table& table, bool where_valid) {
  Html head = "<th scope=\"col\">model</th><th scope=\"col\">rows compared</th>";
  for (const Quantity& quantity : table.quantities)
    head += html("<th scope=\"col\">{}</th>", quantity.words);
  Html rows;
  for (const Source& model : table.models) {
    std::size_t compared = 0;
    Html cells;
    for (std::size_t i = 0; i < table.quantities.size(); ++i) {
      std::vector<double> errors;
      for (std::size_t row = 0; row < table.rows; ++row)
        if (!where_valid || model.valid[row]) errors.push_back(deviation(table, model, i, row));
      const Deviations found = deviations_of(std::move(errors));
      compared = std::max(compared, found.count);
      cells += found.count == 0 ? "<td>–</td>"
                                : html("<td>{}<small>{}</small></td>", percent(found.median),
                                       percent(found.worst));
    }
    rows += "<tr>" + name_cell(model) + html("<td>{}</td>", grouped(double(compared))) + cells +
            "</tr>\n";
  }
  return scrolled(head, rows);
}

Html deviations_section(const Table& table) {
  if (table.fem.empty()) return "";
  return "<h2 id=\"deviations\">How far the models are from the finite elements</h2>\n"
         "<p class=\"facts\">|model − FEM| / FEM over the rows: the median, below it the "
         "worst.</p>\n<h4>Where a model’s assumptions hold</h4>\n" +
         deviations_table(table, true) + "<h4>Wherever it has an answer</h4>\n" +
         deviations_table(table, false);
}

Html failures_section(const Table& table) {
  std::map<std::string, int> counts;
  for (const std::string& failure : table.failures)
    if (!failure.empty()) ++counts[failure];
  if (counts.empty()) return "";
  std::vector<std::pair<std::string, int>> reasons(counts.begin(), counts.end());
  std::stable_sort(reasons.begin(), reasons.end(),
                   [](const auto& one, const auto& other) { return one.second > other.second; });
  Html items;
  for (std::size_t i = 0; i < std::min(kReasons, reasons.size()); ++i)
    items +=
        html("<li>{}: {}</li>\n", count_text(reasons[i].second, "row", "rows"), reasons[i].first);
  if (reasons.size() > kReasons)
    items += html("<li>and {} other reasons, in <code>results.csv</code></li>\n",
                  reasons.size() - kReasons);
  return "<h2 id=\"failures\">Why rows failed</h2>\n<ul>" + items + "</ul>\n";
}

Html rows_section(const Table& table) {
  const std::size_t shown = std::min(kRowsOfTable, table.rows);
  const bool any_failure =
      std::any_of(table.failures.begin(), table.failures.begin() + std::ptrdiff_t(shown),
                  [](const std::string& failure) { return !failure.empty(); });
  std::vector<const Source*> sources;
  for (const Source& fem : table.fem) sources.push_back(&fem);
  for (const Source& model : table.models) sources.push_back(&model);
  Html head = "<th scope=\"col\">point</th>", rows;
  for (const Variable& variable : table.variables)
    head += html("<th scope=\"col\">{}<span class=\"unit\">{}</span></th>", variable.words,
                 variable.unit);
  for (const Source* source : sources) {
    const std::string name = label(source->name);
    for (const Quantity& quantity : table.quantities) head += head_cell(quantity, name);
    head += html("<th scope=\"col\">usable<small>{}</small></th>", name);
  }
  if (any_failure) head += "<th scope=\"col\" class=\"words\">failure</th>";
  for (std::size_t row = 0; row < shown; ++row) {
    rows += html("<tr><th scope=\"row\">{}</th>",
                 std::isfinite(table.points[row]) ? fmt::format("{:.0f}", table.points[row]) : "–");
    for (const Variable& variable : table.variables)
      rows += html("<td>{}</td>",
                   std::isfinite(variable.values[row]) ? plain(variable.values[row]) : "–");
    for (const Source* source : sources) {
      for (const std::vector<double>& values : source->values)
        rows += "<td>" + significant(values[row]) + "</td>";
      rows += html("<td>{}</td>", !source->answers(row) ? "–" : source->valid[row] ? "yes" : "no");
    }
    if (any_failure) rows += html("<td class=\"words\">{}</td>", table.failures[row]);
    rows += "</tr>\n";
  }
  return html("<h2 id=\"rows\">{}</h2>\n",
              shown < table.rows ? fmt::format("The first {} rows", shown) : "The rows") +
         scrolled(head, rows);
}

std::string floats(const std::vector<double>& values) {
  return text::base64(text::bytes_of(std::vector<float>(values.begin(), values.end())));
}

Json source_data(const Source& source, const Table& table) {
  Json values = Json::object(), errors = Json::object();
  for (std::size_t i = 0; i < table.quantities.size(); ++i) {
    values[table.quantities[i].name] = floats(source.values[i]);
    if (!source.errors.empty()) errors[table.quantities[i].name] = floats(source.errors[i]);
  }
  if (!table.friction_coefficient.empty() && values.contains("max_torque")) {
    const auto torque = std::size_t(
        std::find_if(table.quantities.begin(), table.quantities.end(),
                     [](const Quantity& q) { return q.name == std::string_view("max_torque"); }) -
        table.quantities.begin());
    std::vector<double> eccentricities_mm(table.rows);
    for (std::size_t row = 0; row < table.rows; ++row)
      eccentricities_mm[row] =
          source.values[torque][row] / (table.friction_coefficient[row] * table.loads_N[row]);
    values["eccentricity"] = floats(eccentricities_mm);
    if (errors.contains("max_torque")) errors["eccentricity"] = errors["max_torque"];
  }
  return {{"name", source.name},
          {"values", values},
          {"errors", errors},
          {"valid", text::base64(text::bytes_of(source.valid))}};
}

/// Data that sweep.js draws: columns as base64 of little-endian float32, in the page's units, NaN
/// where there is none.
Json sweep_chart_data(const Json& sweep, const Table& table) {
  Json variables = Json::array(), quantities = Json::array(), sources = Json::array();
  for (const Variable& variable : table.variables)
    variables.push_back({{"key", variable.key},
                         {"label", variable.words},
                         {"unit", variable.unit},
                         {"log", variable.log},
                         {"values", floats(variable.values)}});
  for (const Quantity& quantity : table.quantities)
    quantities.push_back(
        {{"name", quantity.name}, {"label", quantity.words}, {"unit", quantity.unit}});
  if (!table.friction_coefficient.empty())
    quantities.push_back(
        {{"name", "eccentricity"}, {"label", "eccentricity eₙ = torque/(μP)"}, {"unit", "mm"}});
  for (const Source& model : table.models) sources.push_back(source_data(model, table));
  for (const Source& fem : table.fem) sources.push_back(source_data(fem, table));
  const Source* first = leading_model(table);
  return {
      {"styles", chart_styles(sweep)}, {"rows", table.rows}, {"variables", variables},
      {"quantities", quantities},      {"sources", sources}, {"first", first ? first->name : ""}};
}

Html sweep_body(const Json& sweep, const Table& table) {
  const Html failures = failures_section(table);
  Html out =
      html("<header><h1>{}</h1>\n<p class=\"subtitle\">{}</p>\n", text(sweep, "id"),
           text(sweep, "question")) +
      sweep_lead(sweep, table) +
      "<nav><a href=\"#picture\">Picture</a> <a href=\"#ranges\">Ranges</a> " +
      (table.fem.empty() ? Html("") : "<a href=\"#deviations\">Against FEM</a> ") +
      (failures.empty() ? Html("") : "<a href=\"#failures\">Failures</a> ") +
      "<a href=\"#rows\">Rows</a> <a href=\"#file\">Sweep file</a> <a "
      "href=\"#provenance\">Provenance</a></nav></header>\n"
      "<h2 id=\"picture\">The picture</h2>\n<noscript><p class=\"facts\">The picture "
      "needs JavaScript; the numbers are below.</p></noscript>\n"
      "<div id=\"controls\"></div>\n"
      "<figure data-chart=\"sweep\"><figcaption id=\"said\"></figcaption><div "
      "class=\"plot\"></div></figure>\n" +
      ranges_section(table) + deviations_section(table) + failures + rows_section(table) +
      html("<h2 id=\"file\">The sweep file</h2>\n<pre>{}</pre>\n", text(sweep, "sweep_toml"));
  Html facts;
  if (const std::string version = text(sweep, "version"); !version.empty())
    facts = html("<dt>version</dt><dd>{}</dd>", version);
  return out + provenance_section(facts, text(sweep, "command"),
                                  "<p>All rows in full precision are in <code>results.csv</code> "
                                  "beside this page, in SI units.</p>\n");
}

}  // namespace

std::string render_sweep(const nlohmann::json& sweep) {
  if (!child(sweep, "rows").is_array())
    throw std::invalid_argument("sweep: no array \"rows\"; see comparisons/report/README.md");
  const Table table = table_of(sweep);
  return render_page(
      {escape(text(sweep, "id")),
       {embedded::report_css},
       sweep_body(sweep, table),
       sweep_chart_data(sweep, table),
       {embedded::d3_js, embedded::plot_js, embedded::charts_js, embedded::sweep_js}});
}

}  // namespace softfinger::report
