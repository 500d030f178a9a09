#include "fem/program/json_entry.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using nlohmann::json;

constexpr std::size_t kLongestText = 4096;

/// A value as far as a message can show it.
std::string as_text(const json& value) {
  if (value.is_structured()) return value.is_array() ? "[...]" : "{...}";
  constexpr std::size_t most = 60;
  std::string text = value.dump();
  if (text.size() <= most) return text;
  // No letter of several bytes is cut in two.
  std::size_t end = most - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end) + "...";
}

}  // namespace

void Entry::refuse(const std::string& allowed) const {
  throw InputError(problem_, key_.empty() ? "problem" : key_, as_text(*value_), allowed);
}

std::optional<Entry> Entry::find(const char* key) const {
  if (!value_->is_object()) refuse("an object { }");
  const auto found = value_->find(key);
  if (found == value_->end() || found->is_null()) return std::nullopt;
  return Entry(*found, key_.empty() ? key : key_ + "." + key, problem_);
}

Entry Entry::at(const char* key) const {
  if (std::optional<Entry> entry = find(key)) return *entry;
  throw InputError(problem_, (key_.empty() ? key : key_ + "." + key) + " is missing", "", "");
}

std::vector<Entry> Entry::list(std::size_t fewest, std::size_t most) const {
  if (!value_->is_array() || value_->size() < fewest || value_->size() > most)
    refuse("a list of " +
           (fewest == most ? std::to_string(most) : "at most " + std::to_string(most)));
  std::vector<Entry> entries;
  for (const json& value : *value_)
    entries.emplace_back(value, key_ + "[" + std::to_string(entries.size()) + "]", problem_);
  return entries;
}

double Entry::number(double least, double largest, const char* allowed) const {
  if (!value_->is_number()) refuse(allowed);
  const double value = value_->get<double>();
  if (!(value >= least && value <= largest)) refuse(allowed);
  return value;
}

double Entry::finite() const {
  constexpr double largest = std::numeric_limits<double>::max();
  return number(-largest, largest, "a finite number");
}

double Entry::positive() const {
  // A denormal number would lose its digits in the solver's units.
  constexpr double least = std::numeric_limits<double>::min();
  return number(least, std::numeric_limits<double>::max(), "a finite number > 0");
}

int Entry::whole(int least, int largest) const {
  const std::string allowed =
      "a whole number from " + std::to_string(least) + " to " + std::to_string(largest);
  const double value = number(least, largest, allowed.c_str());
  if (value != std::floor(value)) refuse(allowed);
  return static_cast<int>(value);
}

bool Entry::flag() const {
  if (!value_->is_boolean()) refuse("true or false");
  return value_->get<bool>();
}

std::string Entry::text() const {
  if (value_->is_string()) {
    const auto& text = value_->get_ref<const std::string&>();
    // A file's name ends at a zero: the rest would be lost.
    if (text.size() <= kLongestText && text.find('\0') == std::string::npos) return text;
  }
  refuse("a text of at most " + std::to_string(kLongestText) + " bytes, without zeros");
}

std::string Entry::choice(const std::vector<const char*>& choices) const {
  std::string allowed;
  for (const char* choice : choices) {
    if (value_->is_string() && *value_ == choice) return choice;
    allowed += (allowed.empty() ? "\"" : " or \"") + std::string(choice) + "\"";
  }
  refuse(allowed);
}

double Entry::radius() const {
  if (value_->is_null()) return kInfinity;
  const double radius = finite();
  if (radius == 0) refuse("a finite number other than 0, or null for a straight direction");
  return radius;
}

Eigen::Vector3d Entry::vector() const {
  const std::vector<Entry> entries = list(3, 3);
  return {entries[0].finite(), entries[1].finite(), entries[2].finite()};
}

Eigen::Vector3d Entry::direction() const {
  const Eigen::Vector3d direction = vector();
  // The squares of its components have to be there.
  const double length = direction.norm();
  if (!(length > 0) || !std::isfinite(length)) refuse("three finite numbers, not all 0");
  return direction;
}

std::string Entry::dump() const { return value_->dump(); }

std::string Entry::dump_without(const char* key) const {
  json rest = *value_;
  rest.erase(key);
  return rest.dump();
}

}  // namespace softfinger::fem
