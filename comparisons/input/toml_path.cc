#include "comparisons/input/toml_path.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>
#include <optional>
#include <utility>

#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

/// A text that needs no quotes on a command line: it begins with a letter and is a name or a path.
bool is_bare_word(const std::string& value) {
  const auto is_letter = [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c >= 0x80;
  };
  return !value.empty() && std::all_of(value.begin(), value.end(), [&](char c) {
    return is_letter(static_cast<unsigned char>(c)) || (c >= '0' && c <= '9') || c == '-' ||
           c == '.' || c == '/';
  });
}

/// Numbers as other programs write them, ".5" and "5.", with the digit that TOML wants there.
std::string with_digits(const std::string& value) {
  const auto is_digit = [&](std::size_t place) {
    return place < value.size() && std::isdigit(static_cast<unsigned char>(value[place]));
  };
  std::string result;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const bool is_point = value[i] == '.';
    if (is_point && is_digit(i + 1) && (i == 0 || !is_digit(i - 1))) result += '0';
    result += value[i];
    if (is_point && i > 0 && is_digit(i - 1) && !is_digit(i + 1)) result += '0';
  }
  return result;
}

/// The value as the only entry, "value", of a table; nothing where the text is no value.
std::optional<toml::table> parsed(const std::string& value, const std::string& where) {
  try {
    toml::table table = parse_toml("value = " + value, where);
    if (table.size() == 1 && table.contains("value")) return table;
  } catch (const InputError&) {
    // Refused by the caller, in other words.
  }
  return std::nullopt;
}

toml::table parse_value(const Setting& setting) {
  for (const std::string& value : {setting.value, with_digits(setting.value)})
    if (auto table = parsed(value, setting.where)) return std::move(*table);
  if (is_bare_word(setting.value))
    return parse_toml("value = \"" + setting.value + "\"", setting.where);
  throw InputError(setting.where, "value", text::shortened(setting.value),
                   "a number, a list [1, 2], true, false or a text in quotes, as in a file");
}

/// Puts `value` under the name or index `step`, in place of what is there.
void put(const Setting& setting, toml::node& parent, const std::string& step, toml::node&& value) {
  if (toml::table* table = parent.as_table()) {
    const toml::key key(step, toml::source_region(value.source()));
    std::move(value).visit(
        [&](auto&& entry) { table->insert_or_assign(key, std::forward<decltype(entry)>(entry)); });
    return;
  }
  toml::array* array = parent.as_array();
  if (!array)
    throw InputError(setting.where, "\"" + setting.key + "\" leads into a value that has no entry",
                     "\"" + step + "\"", "");
  const std::size_t place = place_of(step);
  if (place >= array->size())
    throw InputError(
        setting.where, "index in \"" + setting.key + "\"", step,
        array->empty() ? "none: the list is empty" : "0 to " + std::to_string(array->size() - 1));
  std::move(value).visit([&](auto&& entry) {
    array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(place),
                   std::forward<decltype(entry)>(entry));
  });
}

}  // namespace

std::vector<std::string> steps_of(const std::string& path) {
  std::vector<std::string> steps;
  for (std::size_t start = 0; start < path.size();) {
    const char closing = path[start] == '[' ? ']' : path[start] == '"' ? '"' : '\0';
    const bool enclosed = closing != '\0';
    const std::size_t end = std::min(
        enclosed ? path.find(closing, start + 1) : path.find_first_of(".[", start), path.size());
    steps.push_back(path.substr(start + enclosed, end - start - enclosed));
    if (steps.back().empty() || (enclosed && end == path.size())) return {};
    start = end + enclosed;
    if (start < path.size() && path[start] == '.') ++start;
  }
  return steps;
}

std::size_t place_of(const std::string& step) {
  std::size_t place = 0;
  const char* const last = step.data() + step.size();
  const auto read = std::from_chars(step.data(), last, place);
  return read.ec == std::errc() && read.ptr == last ? place
                                                    : std::numeric_limits<std::size_t>::max();
}

toml::node* find_entry(toml::node& node, const std::string& step) {
  if (toml::table* table = node.as_table()) return table->get(step);
  if (toml::array* array = node.as_array()) return array->get(place_of(step));
  return nullptr;
}

void apply_setting(const Setting& setting, toml::table& root) {
  const std::vector<std::string> steps = steps_of(setting.key);
  if (steps.empty() || steps.size() >= std::size_t(kDeepestNesting))
    throw InputError(setting.where, "key", "\"" + text::shortened(setting.key) + "\"",
                     "names with dots between them, as layer.thickness_mm, and [0] in lists");
  toml::table value = parse_value(setting);
  toml::node* parent = &root;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    if (!find_entry(*parent, steps[i])) {
      toml::table made = parse_toml("value = {}", setting.where);
      put(setting, *parent, steps[i], std::move(*made.get("value")));
    }
    parent = find_entry(*parent, steps[i]);
  }
  put(setting, *parent, steps.back(), std::move(*value.get("value")));
}

}  // namespace softfinger::input
