#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

/// Building blocks of the pages: markup as a type, numbers as text, and reading of a report in
/// which any value may be null. Everything that reaches a page passes through here.
namespace softfinger::report {

using Json = nlohmann::json;

/// Markup: text in which `<` and `&` have their meaning for a browser. It is made of string
/// literals, which we wrote, of `escape`, of `html`, and of these put together. No other string
/// becomes markup, so a page cannot contain a name from a file that was not escaped: it would not
/// compile.
///
/// C++ turns `condition ? "a" : "bc"` into a pointer, which is no literal any more: write
/// `condition ? Html("a") : "bc"`.
class Html {
 public:
  Html() = default;
  template <std::size_t size>
  Html(const char (&literal)[size]) : markup_(literal, size - 1) {}
  /// A buffer that was filled at run time is no literal.
  template <std::size_t size>
  Html(char (&buffer)[size]) = delete;

  Html& operator+=(const Html& other) {
    markup_ += other.markup_;
    return *this;
  }
  friend Html operator+(Html one, const Html& other) { return one += other; }
  friend bool operator==(const Html& one, const Html& other) {
    return one.markup_ == other.markup_;
  }

  bool empty() const { return markup_.empty(); }
  /// The whole page, for the file that holds it and for tests.
  const std::string& markup() const { return markup_; }

 private:
  explicit Html(std::string markup) : markup_(std::move(markup)) {}
  friend Html escape(std::string_view text);
  friend class HtmlArgument;
  friend Html formatted(std::string_view format, const std::vector<class HtmlArgument>& arguments);

  std::string markup_;
};

/// Text for element content and attribute values, between double or single quotes.
Html escape(std::string_view text);

/// Argument of `html`: markup is inserted as it is, numbers as numbers, any text escaped.
class HtmlArgument {
 public:
  HtmlArgument(const Html& markup) : value_(markup.markup_) {}
  template <typename Text,
            std::enable_if_t<std::is_convertible_v<const Text&, std::string_view>, int> = 0>
  HtmlArgument(const Text& text) : value_(escape(text).markup_) {}
  template <typename Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
  HtmlArgument(Number number) : value_(number_of(number)) {}

 private:
  using Value = std::variant<std::string, bool, long long, unsigned long long, double>;
  template <typename Number>
  static Value number_of(Number number) {
    if constexpr (std::is_same_v<Number, bool>)
      return number;
    else if constexpr (std::is_floating_point_v<Number>)
      return static_cast<double>(number);
    else if constexpr (std::is_signed_v<Number>)
      return static_cast<long long>(number);
    else
      return static_cast<unsigned long long>(number);
  }
  friend Html formatted(std::string_view format, const std::vector<HtmlArgument>& arguments);

  Value value_;
};

Html formatted(std::string_view format, const std::vector<HtmlArgument>& arguments);

/// `html("<td>{}</td>", name)`: a literal in the syntax of fmt::format, its places filled with
/// escaped text, numbers and markup. @throws fmt::format_error for a place without an argument.
template <std::size_t size, typename... Arguments>
Html html(const char (&format)[size], const Arguments&... arguments) {
  // No braced list: GCC 12 destroys elements that it has not made when one of the list throws.
  std::vector<HtmlArgument> list;
  list.reserve(sizeof...(arguments));
  (list.emplace_back(arguments), ...);
  return formatted({format, size - 1}, list);
}

/// The parts with `separator` between them.
Html joined(const std::vector<Html>& parts, const Html& separator);

/// `<details>`, closed at first.
Html details(const Html& summary, const Html& body);
/// A table that scrolls sideways where the window is narrower.
Html scrolling_table(const Html& head, const Html& rows);
/// A heading of such a table, with the unit behind it.
Html column_heading(const HtmlArgument& words, const Html& unit = "");

/// `digits` significant digits in plain decimal notation (`0.001706`, `12.30`, `48213`), powers of
/// ten (`1.2·10<sup>−7</sup>`) only outside 1e-4 to 1e7, a true minus sign. Not finite: a dash.
Html significant(double value, int digits = 4);

/// Significant digits of a value times `factor` (a change of unit); an absent value is a dash.
Html significant(std::optional<double> value, double factor = 1, int digits = 4);

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
