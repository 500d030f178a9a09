#include "comparisons/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "comparisons/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

/// A value as the user wrote it: 0.6 and not the 0.59999999999999998 of a binary fraction.
std::string typed_value(const toml::node& node) {
  if (node.is_string()) return "\"" + node.value<std::string>().value() + "\"";
  if (node.is_floating_point()) return fmt::format("{}", node.value<double>().value());
  if (const toml::array* list = node.as_array()) {
    std::vector<std::string> entries;
    for (const toml::node& entry : *list) entries.push_back(typed_value(entry));
    return "[" + joined(entries) + "]";
  }
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  return text.str();
}

}  // namespace

toml::table parse_toml(const std::string& text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    std::string reason(error.description());
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    throw InputError(fmt::format("{}:{}", file, error.source().begin.line),
                     "not a TOML file: " + reason, "", "");
  }
}

std::string as_typed(const toml::node& node) {
  std::string line = typed_value(node);
  if (node.is_string()) return line;
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line.size() > 60 ? line.substr(0, 57) + "..." : line;
}
std::string TomlReader::where(const toml::node& node) const {
  return fmt::format("{}:{}", file_, node.source().begin.line);
}

void TomlReader::refuse(const toml::node& node, const std::string& field,
                        const std::string& allowed) const {
  throw InputError(where(node), field, as_typed(node), allowed);
}

void TomlReader::say(const toml::node& node, const std::string& sentence) const {
  throw InputError(where(node), sentence, "", "");
}

void TomlReader::check_keys(const toml::table& table, const std::string& name,
                            const std::vector<std::string>& known) const {
  for (const auto& [key, value] : table) {
    const std::string typed(key.str());
    if (std::find(known.begin(), known.end(), typed) != known.end()) continue;
    throw InputError(fmt::format("{}:{}", file_, key.source().begin.line),
                     fmt::format("unknown key \"{}\"{}, did you mean \"{}\"?", typed,
                                 name.empty() ? "" : " in " + name, nearest_name(typed, known)),
                     "", joined(known));
  }
}

const toml::node& TomlReader::required(const toml::table& table, const std::string& name,
                                       std::string_view key) const {
  if (const toml::node* node = table.get(key)) return *node;
  say(table, fmt::format("{} has no {}", name, key));
}

const toml::table& TomlReader::required_table(const toml::table& parent,
                                              std::string_view key) const {
  const toml::node* node = parent.get(key);
  if (!node) throw InputError(file_, fmt::format("the table [{}] is missing", key), "", "");
  if (!node->is_table()) refuse(*node, std::string(key), "a table");
  return *node->as_table();
}

double TomlReader::number(const toml::node& node, const std::string& field,
                          const std::string& allowed, bool infinity_allowed) const {
  if (!node.is_number()) refuse(node, field, allowed);
  const double value = node.value<double>().value();
  if (std::isnan(value) || (std::isinf(value) && !infinity_allowed)) refuse(node, field, allowed);
  return value;
}

double TomlReader::positive(const toml::node& node, const std::string& field,
                            double si_per_unit) const {
  const std::string allowed = "a finite number > 0";
  const double value = number(node, field, allowed) * si_per_unit;
  if (!(value > 0) || !std::isfinite(value)) refuse(node, field, allowed);
  return value;
}

std::string TomlReader::text(const toml::node& node, const std::string& field) const {
  if (!node.is_string()) refuse(node, field, "a text in quotes");
  return node.value<std::string>().value();
}

std::string TomlReader::choice(const toml::node& node, const std::string& field,
                               const std::vector<std::string>& choices) const {
  if (node.is_string()) {
    const std::string typed = node.value<std::string>().value();
    if (std::find(choices.begin(), choices.end(), typed) != choices.end()) return typed;
  }
  refuse(node, field, "\"" + joined(choices, "\" or \"") + "\"");
}

std::vector<double> TomlReader::numbers(const toml::node& node, const std::string& field,
                                        std::size_t count, const std::string& allowed,
                                        bool infinity_allowed) const {
  if (!node.is_array() || node.as_array()->size() != count) refuse(node, field, allowed);
  std::vector<double> values;
  for (const toml::node& entry : *node.as_array()) {
    if (!entry.is_number()) refuse(node, field, allowed);
    values.push_back(number(entry, field, allowed, infinity_allowed));
  }
  return values;
}

std::string TomlReader::id(const toml::table& root) const {
  const toml::node* node = root.get("id");
  if (!node) throw InputError(file_, "id is missing", "", "id = \"a_name\" before the tables");
  const std::string id = text(*node, "id");
  const std::string letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  if (id.empty() || id.size() > 64 || id[0] == '.' ||
      id.find_first_not_of(letters) != std::string::npos)
    refuse(*node, "id", "1 to 64 letters, digits, \"_\", \"-\" and \".\", not starting with \".\"");
  return id;
}

ElasticLayer TomlReader::elastic_layer(const toml::table& table, const std::string& name) const {
  ElasticLayer layer;
  layer.thickness_m = positive(required(table, name, "thickness_mm"), "thickness_mm", kMillimetre);
  layer.youngs_modulus_Pa =
      positive(required(table, name, "youngs_modulus_kPa"), "youngs_modulus_kPa", 1e3);
  const toml::node& poisson = required(table, name, "poisson_ratio");
  const std::string allowed = "a number from 0 to 0.5";
  layer.poisson_ratio = number(poisson, "poisson_ratio", allowed);
  if (layer.poisson_ratio < 0 || layer.poisson_ratio > 0.5)
    refuse(poisson, "poisson_ratio", allowed);
  return layer;
}

}  // namespace softfinger
