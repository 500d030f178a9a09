#pragma once

#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

/// Numbers of results.csv, each with the comma before it.
namespace softfinger::suite {

/// A number as JSON writes it, to the last digit; empty where there is none.
inline std::string cell(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? "," + nlohmann::json(*value).dump() : ",";
}

inline std::string cells(std::initializer_list<std::optional<double>> values) {
  std::string text;
  for (const auto& value : values) text += cell(value);
  return text;
}

}  // namespace softfinger::suite
