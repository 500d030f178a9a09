#include "comparisons/input/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "comparisons/input/toml_path.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

/// A value as the user wrote it: 0.6 and not the 0.59999999999999998 of a binary fraction.
std::string typed_value(const toml::node& node) {
  constexpr std::size_t kMostShown = 20;
  if (const auto* typed = node.as_string()) return "\"" + typed->get() + "\"";
  if (const auto* typed = node.as_floating_point()) return fmt::format("{}", typed->get());
  if (const toml::array* list = node.as_array()) {
    std::vector<std::string> entries;
    for (const toml::node& entry : *list) {
      if (entries.size() == kMostShown) {
        entries.push_back("...");
        break;
      }
      entries.push_back(typed_value(entry));
    }
    return "[" + text::joined(entries) + "]";
  }
  if (const toml::table* table = node.as_table()) {
    std::vector<std::string> entries;
    for (const auto& [key, entry] : *table) {
      if (entries.size() == kMostShown) {
        entries.push_back("...");
        break;
      }
      entries.push_back(std::string(key.str()) + " = " + typed_value(entry));
    }
    return "{ " + text::joined(entries) + " }";
  }
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  return text.str();
}

/// The last byte of the string that begins at `at`; of one that is not closed, the last byte before
/// the line's or the file's end.
std::size_t end_of_string(std::string_view text, std::size_t at, int& line) {
  const char quote = text[at];
  const bool has_escapes = quote == '"';
  const auto is_triple = [&](std::size_t i) {
    return i + 2 < text.size() && text[i] == quote && text[i + 1] == quote && text[i + 2] == quote;
  };
  const bool of_many_lines = is_triple(at);
  for (at += of_many_lines ? 3 : 1; at < text.size(); ++at) {
    if (text[at] == '\n') {
      if (!of_many_lines) return at - 1;
      ++line;
    } else if (text[at] == '\\' && has_escapes) {
      if (at + 1 < text.size() && text[at + 1] != '\n') ++at;
    } else if (of_many_lines && is_triple(at)) {
      at += 2;
      // One or two quotes directly before the closing ones belong to the string.
      for (int i = 0; i < 2 && at + 1 < text.size() && text[at + 1] == quote; ++i) ++at;
      return at;
    } else if (text[at] == quote && !of_many_lines) {
      return at;
    }
  }
  return text.size() - 1;
}

/// Refuses deep nesting before parsing. The parser is recursive in nested brackets, and the
/// destruction of its tables in the parts of a dotted key: some ten thousand levels overflow the
/// stack. Other mistakes are found by the parser.
void require_shallow(std::string_view text, const std::string& file) {
  int line = 1, brackets = 0, dots = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    switch (text[at]) {
      case '"':
      case '\'':
        at = end_of_string(text, at, line);
        break;
      case '#':
        at = std::min(text.find('\n', at), text.size()) - 1;
        break;
      case '[':
      case '{':
        ++brackets;
        dots = 0;
        break;
      case ']':
      case '}':
        brackets = std::max(0, brackets - 1);
        dots = 0;
        break;
      case '.':
        ++dots;
        break;
      case '\n':
        ++line;
        [[fallthrough]];
      case '=':
      case ',':
        dots = 0;
        break;
      default:
        break;
    }
    if (brackets > kDeepestNesting)
      throw InputError(fmt::format("{}:{}", file, line), "brackets in brackets", "",
                       fmt::format("at most {} levels", kDeepestNesting));
    if (dots >= kDeepestNesting)
      throw InputError(fmt::format("{}:{}", file, line), "dotted key", "",
                       fmt::format("at most {} parts", kDeepestNesting));
  }
}

}  // namespace

toml::table parse_toml(const std::string& text, const std::string& file) {
  constexpr std::size_t kLongestReason = 300;  // limited, because it repeats what was typed
  if (const std::size_t first = text.find_first_not_of(" \t\r\n");
      first != std::string::npos && text[first] == '<')
    throw InputError(file, "not a TOML file: it begins as XML does", "",
                     "TOML; robots' files are for simulate, with the suffix .xml, .mjcf, .urdf or "
                     ".sdf");
  require_shallow(text, file);
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    std::string reason(error.description());
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    reason = text::shortened(reason, kLongestReason);
    throw InputError(fmt::format("{}:{}", file, error.source().begin.line),
                     "not a TOML file: " + reason, "", "");
  }
}

toml::table parse_toml(const std::string& text, const std::string& file, const Settings& settings) {
  toml::table root = parse_toml(text, file);
  for (const Setting& setting : settings) apply_setting(setting, root);
  return root;
}

std::string text_of(const toml::table& root, const std::string& text, const Settings& settings) {
  if (settings.empty()) return text;
  std::ostringstream written;
  for (const Setting& setting : settings) written << "# " << setting.where << "\n";
  written << root << "\n";
  return written.str();
}

std::string as_typed(const toml::node& node) {
  std::string line = typed_value(node);
  if (node.is_string()) return text::shortened(line, 200);
  std::replace(line.begin(), line.end(), '\n', ' ');
  return text::shortened(line);
}
std::string TomlReader::where(const toml::source_region& source) const {
  if (source.path && *source.path != file_) return *source.path;
  return source.begin.line == 0 ? file_ : fmt::format("{}:{}", file_, source.begin.line);
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
    throw InputError(
        where(key.source()),
        fmt::format("unknown key \"{}\"{}{}", text::shortened(typed),
                    name.empty() ? "" : " in " + name, text::did_you_mean(typed, known)),
        "", text::joined(known));
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

const toml::array& TomlReader::list(const toml::node& node, const std::string& field,
                                    std::size_t most, const std::string& allowed) const {
  const toml::array* entries = node.as_array();
  if (!entries) refuse(node, field, allowed);
  if (entries->size() > most)
    throw InputError(where(node), field, fmt::format("{} entries", entries->size()),
                     fmt::format("at most {}", most));
  return *entries;
}

int TomlReader::integer(const toml::node& node, const std::string& field, int least, int largest,
                        const std::string& allowed) const {
  const auto* typed = node.as_integer();
  if (!typed || typed->get() < least || typed->get() > largest) refuse(node, field, allowed);
  return static_cast<int>(typed->get());
}

bool TomlReader::boolean(const toml::node& node, const std::string& field,
                         const std::string& allowed) const {
  const auto* typed = node.as_boolean();
  if (!typed) refuse(node, field, allowed);
  return typed->get();
}

double TomlReader::number(const toml::node& node, const std::string& field,
                          const std::string& allowed, bool infinity_allowed) const {
  if (!node.is_number()) refuse(node, field, allowed);
  const std::optional<double> value = node.value<double>();
  if (!value)
    refuse(node, field, "whole numbers up to 2^53 = 9007199254740992; larger ones as 1e17");
  if (std::isnan(*value) || (std::isinf(*value) && !infinity_allowed)) refuse(node, field, allowed);
  return *value;
}

double TomlReader::positive(const toml::node& node, const std::string& field,
                            double si_per_unit) const {
  const std::string allowed = "a finite number > 0";
  const double value = number(node, field, allowed) * si_per_unit;
  if (!(value > 0) || !std::isfinite(value)) refuse(node, field, allowed);
  return value;
}

std::string TomlReader::text(const toml::node& node, const std::string& field) const {
  const auto* typed = node.as_string();
  if (!typed) refuse(node, field, "a text in quotes");
  if (typed->get().size() > kLongestText)
    refuse(node, field, fmt::format("at most {} bytes", kLongestText));
  return typed->get();
}

std::string TomlReader::name(const toml::node& node, const std::string& field) const {
  const std::string typed = text(node, field);
  const auto is_control = [](unsigned char letter) { return letter < 0x20 || letter == 0x7f; };
  if (typed.empty() || typed.size() > kLongestName ||
      std::any_of(typed.begin(), typed.end(), is_control))
    refuse(node, field,
           fmt::format("a name of 1 to {} bytes without control characters", kLongestName));
  return typed;
}

std::string TomlReader::choice(const toml::node& node, const std::string& field,
                               const std::vector<std::string>& choices) const {
  if (const auto* typed = node.as_string())
    if (std::find(choices.begin(), choices.end(), typed->get()) != choices.end())
      return typed->get();
  refuse(node, field, "\"" + text::joined(choices, "\" or \"") + "\"");
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
  if (!node) {
    const std::string name = id_of(file_);
    if (name.empty())
      throw InputError(file_, "id is missing", "", "id = \"a_name\" before the tables");
    return name;
  }
  const std::string id = text(*node, "id");
  if (!is_id(id))
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

ShearLaw TomlReader::shear_law(const toml::table& table, const std::string& name,
                               std::optional<double> coefficient) const {
  ShearLaw law;
  if (const toml::node* node = table.get("shear_law")) {
    const std::vector<std::string> names(kShearLawNames.begin(), kShearLawNames.end());
    const std::string typed = choice(*node, "shear_law", names);
    law.kind = ShearLaw::Kind(std::find(names.begin(), names.end(), typed) - names.begin());
  }
  const toml::node* friction = table.get("friction_coefficient");
  const toml::node* strength = table.get("shear_strength_kPa");
  if (coefficient) {
    const std::string allowed = "a finite number >= 0";
    law.friction_coefficient =
        friction ? number(*friction, "friction_coefficient", allowed) : *coefficient;
    if (law.friction_coefficient < 0) refuse(*friction, "friction_coefficient", allowed);
  } else if (law.has_friction_coefficient()) {
    // Above this a torque could become too large for a number in mN m.
    constexpr double kLargest = 1e9;
    const toml::node& typed = required(table, name, "friction_coefficient");
    law.friction_coefficient = positive(typed, "friction_coefficient", 1);
    if (law.friction_coefficient > kLargest)
      refuse(typed, "friction_coefficient", "a finite number > 0, at most 1e9");
  } else if (friction) {
    refuse(*friction, "friction_coefficient",
           "nothing here: under shear_law = \"shear_strength\" the pressure does not matter");
  }
  if (law.has_shear_strength()) {
    law.shear_strength_Pa =
        positive(required(table, name, "shear_strength_kPa"), "shear_strength_kPa", 1e3);
  } else if (strength) {
    refuse(*strength, "shear_strength_kPa",
           "nothing here: it needs shear_law = \"shear_strength\", \"limited\" or "
           "\"adhesive_shear\"");
  }
  return law;
}

}  // namespace softfinger::input
