#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

/// Building blocks of the page: escaping, numbers as text, and reading of a report in which any
/// value may be null. Everything that reaches the page passes through here.
namespace softfinger::report {

using Json = nlohmann::json;

/// Text for element content and attribute values.
std::string escape(std::string_view text);

/// A page's skeleton with every {{key}} replaced by its part. What is inserted is never searched
/// for keys. @throws std::out_of_range for a key without a part.
std::string filled(std::string_view skeleton,
                   const std::map<std::string_view, std::string_view>& parts);

/// `digits` significant digits in plain decimal notation (`0.001706`, `12.30`, `48213`), powers of
/// ten only outside 1e-4 to 1e7, a true minus sign. Not finite: a dash.
std::string significant(double value, int digits = 4);

/// The same for a value times `factor` (a change of unit); an absent value is a dash.
std::string significant(std::optional<double> value, double factor = 1, int digits = 4);

/// A ratio in percent with two to three digits: `+4.21 %`, `−0.30 %`; units follow a no-break
/// space.
std::string signed_percent(double ratio);
std::string percent(double ratio);

/// Seconds in the unit that suits them: `85 ns`, `1.2 µs`, `14 s`, `3.1 min`.
std::string duration(double seconds);

/// Inputs as people typed them, without trailing zeros: `0.49`, `300`, `2`.
std::string plain(std::optional<double> value, double factor = 1);
std::string newton(double load_N);

/// The number under `key`; nothing when the key is missing, null or not a finite number.
std::optional<double> number(const Json& object, std::string_view key);
/// The text under `key`, a number or boolean as text, empty when missing or null.
std::string text(const Json& object, std::string_view key);
bool flag(const Json& object, std::string_view key);
/// The object or array under `key`, or a null value: chains of look-ups need no checks.
const Json& child(const Json& value, std::string_view key);
/// The i-th number of an array, with the same leniency.
std::optional<double> element(const Json& array, std::size_t index);

}  // namespace softfinger::report
