#include "comparisons/input/doubted_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace softfinger::input {
namespace {

constexpr double kLargestFactor = 1000;
/// Standard deviations to a bound of 95 %.
constexpr double kStdsTo95 = 2;

const toml::table* doubted_number(const toml::node& node) {
  const toml::table* table = node.as_table();
  const bool is_doubted = table && table->size() == 2 && table->contains("value") &&
                          (table->contains("factor") || table->contains("std"));
  return is_doubted ? table : nullptr;
}

Doubt read_doubt(const TomlReader& reader, const toml::table& table, const std::string& key) {
  Doubt doubt;
  doubt.key = key;
  doubt.value = reader.number(*table.get("value"), key + ".value", "a finite number");
  if (const toml::node* factor = table.get("factor")) {
    const std::string allowed = fmt::format(
        "a number above 1, at most {:g}; the value is a positive number", kLargestFactor);
    const double times = reader.number(*factor, key + ".factor", allowed);
    if (!(times > 1) || times > kLargestFactor || !(doubt.value > 0))
      reader.refuse(*factor, key + ".factor", allowed);
    doubt.lower = doubt.value / times;
    doubt.upper = doubt.value * times;
    return doubt;
  }
  const toml::node& std = *table.get("std");
  const std::string allowed = "a finite number > 0, the standard deviation in the value's unit";
  const double width = kStdsTo95 * reader.number(std, key + ".std", allowed);
  if (!(width > 0) || !std::isfinite(width)) reader.refuse(std, key + ".std", allowed);
  // Elastic and friction constants, thicknesses, radii and loads are positive.
  const bool is_positive = key.rfind("layer.", 0) == 0 || key.rfind("contact.", 0) == 0 ||
                           key.find("radi") != std::string::npos;
  if (is_positive && doubt.value > 0 && !(width < doubt.value))
    reader.refuse(
        std, key + ".std",
        fmt::format("less than {:g}, half of the value, since two standard deviations "
                    "hold 95 %; a larger doubt is a factor: {{ value = {:g}, factor = 2 }}",
                    doubt.value / kStdsTo95, doubt.value));
  doubt.lower = doubt.value - width;
  doubt.upper = doubt.value + width;
  return doubt;
}

/// Whether a table was meant as a number with its doubt, well formed or not.
bool is_meant_as_doubted(const toml::node& node) {
  const toml::table* table = node.as_table();
  return table && (table->contains("value") || table->contains("factor") || table->contains("std"));
}

bool is_or_has_doubted(const toml::node& node) {
  if (is_meant_as_doubted(node)) return true;
  if (const toml::table* table = node.as_table()) return has_doubts(*table);
  const toml::array* array = node.as_array();
  return array && std::any_of(array->begin(), array->end(), is_or_has_doubted);
}

void check_form(const TomlReader& reader, const toml::node& node, const std::string& key) {
  if (is_meant_as_doubted(node) && !doubted_number(node))
    reader.refuse(node, key,
                  "a number, or { value = 300, factor = 2 }, or { value = 0.8, std = 0.1 }");
}

/// Moves the number out of its table to where it stands for all of it. It keeps its line of the
/// file, for messages.
template <class Put>
void put_number(toml::node& doubted, const Put& put) {
  toml::node& number = *doubted.as_table()->get("value");
  if (auto* whole = number.as_integer()) {
    auto moved = std::move(*whole);
    put(std::move(moved));
  } else {
    auto moved = std::move(*number.as_floating_point());
    put(std::move(moved));
  }
}

void settle(const TomlReader& reader, toml::node& node, const std::string& path, Doubts& doubts) {
  if (toml::table* table = node.as_table()) {
    std::vector<std::string> keys;
    for (const auto& [key, entry] : *table) keys.emplace_back(key.str());
    for (const std::string& key : keys) {
      toml::node& entry = *table->get(key);
      const std::string entry_path = path.empty() ? key : path + "." + key;
      const toml::table* doubted = doubted_number(entry);
      if (!doubted) {
        check_form(reader, entry, entry_path);
        settle(reader, entry, entry_path, doubts);
        continue;
      }
      doubts.push_back(read_doubt(reader, *doubted, entry_path));
      put_number(entry, [&](auto&& number) { table->insert_or_assign(key, std::move(number)); });
    }
  } else if (toml::array* array = node.as_array()) {
    for (std::size_t i = 0; i < array->size(); ++i) {
      const std::string entry_path = fmt::format("{}[{}]", path, i);
      const toml::table* doubted = doubted_number((*array)[i]);
      if (!doubted) {
        check_form(reader, (*array)[i], entry_path);
        settle(reader, (*array)[i], entry_path, doubts);
        continue;
      }
      doubts.push_back(read_doubt(reader, *doubted, entry_path));
      put_number((*array)[i], [&](auto&& number) {
        array->replace(array->cbegin() + std::ptrdiff_t(i), std::move(number));
      });
    }
  }
}

}  // namespace

Doubts settle_doubts(const TomlReader& reader, toml::table& root) {
  Doubts doubts;
  settle(reader, root, "", doubts);
  return doubts;
}

bool has_doubts(const toml::table& root) {
  return std::any_of(root.begin(), root.end(),
                     [](const auto& entry) { return is_or_has_doubted(entry.second); });
}

}  // namespace softfinger::input
