#include "comparisons/report/html.h"

#include <fmt/args.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace softfinger::report {
namespace {

constexpr char kDash[] = "–";
constexpr char kMinus[] = "−";
constexpr char kSpace[] = "\u00a0";  // a number and its unit stay on one line

std::string with_true_minus(std::string digits) {
  if (!digits.empty() && digits.front() == '-') digits.replace(0, 1, kMinus);
  return digits;
}

/// Writes as many decimal places as leave `digits` significant ones after rounding: 9.9996 -> 10.00
/// for four.
std::string fixed(double value, int digits) {
  const std::string scientific = fmt::format("{:.{}e}", std::abs(value), digits - 1);
  const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
  return fmt::format("{:.{}f}", value, std::max(0, digits - 1 - exponent));
}

}  // namespace

Html escape(std::string_view text) {
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return Html(std::move(out));
}

Html formatted(std::string_view format, const std::vector<HtmlArgument>& arguments) {
  fmt::dynamic_format_arg_store<fmt::format_context> store;
  for (const HtmlArgument& argument : arguments)
    std::visit([&](const auto& value) { store.push_back(value); }, argument.value_);
  return Html(fmt::vformat(fmt::string_view(format.data(), format.size()), store));
}

Html joined(const std::vector<Html>& parts, const Html& separator) {
  Html out;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i > 0) out += separator;
    out += parts[i];
  }
  return out;
}

Html details(const Html& summary, const Html& body) {
  return "<details><summary>" + summary + "</summary>\n" + body + "</details>\n";
}

Html scrolling_table(const Html& head, const Html& rows) {
  return "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr>" + head +
         "</tr></thead>\n<tbody>" + rows + "</tbody></table></div>\n";
}

Html column_heading(const HtmlArgument& words, const Html& unit) {
  return html("<th scope=\"col\">{}{}</th>", words,
              unit.empty() ? "" : html(" <span class=\"unit\">{}</span>", unit));
}

Html significant(double value, int digits) {
  if (!std::isfinite(value)) return kDash;
  if (value == 0) return "0";
  const double magnitude = std::abs(value);
  if (magnitude >= 1e-4 && magnitude < 1e7) return escape(with_true_minus(fixed(value, digits)));
  const std::string scientific = fmt::format("{:.{}e}", value, digits - 1);
  const std::size_t mark = scientific.find('e');
  return html("{}·10<sup>{}</sup>", with_true_minus(scientific.substr(0, mark)),
              with_true_minus(std::to_string(std::stoi(scientific.substr(mark + 1)))));
}

Html significant(std::optional<double> value, double factor, int digits) {
  return value ? significant(*value * factor, digits) : kDash;
}

std::string percent(double ratio) {
  if (!std::isfinite(ratio)) return kDash;
  const double value = 100 * ratio;
  const double magnitude = std::abs(value);
  // A stated error of 0.002 % must not read as zero; one of 213.4 % needs no decimals.
  const int places = magnitude == 0     ? 0
                     : magnitude < 0.1  ? 3
                     : magnitude < 9.95 ? 2
                     : magnitude < 99.5 ? 1
                                        : 0;
  return with_true_minus(fmt::format("{:.{}f}", value, places)) + kSpace + "%";
}

std::string signed_percent(double ratio) {
  const std::string plain = percent(ratio);
  return ratio > 0 && std::isfinite(ratio) ? "+" + plain : plain;
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds)) return kDash;
  const auto in = [&](double unit, const char* name) {
    const double value = seconds / unit;
    const int places = value < 9.95 ? 1 : 0;
    return fmt::format("{:.{}f}{}{}", value, places, kSpace, name);
  };
  if (seconds < 0.9995e-6) return in(1e-9, "ns");
  if (seconds < 0.9995e-3) return in(1e-6, "µs");
  if (seconds < 0.9995) return in(1e-3, "ms");
  if (seconds < 120) return in(1, "s");
  return in(60, "min");
}

std::string plain(std::optional<double> value, double factor) {
  return value ? fmt::format("{:g}", *value * factor) : kDash;
}

std::string newton(double load_N) { return plain(load_N) + kSpace + "N"; }

const Json& child(const Json& value, std::string_view key) {
  static const Json null_value;
  if (!value.is_object()) return null_value;
  const auto found = value.find(std::string(key));
  return found == value.end() ? null_value : *found;
}

std::optional<double> number(const Json& object, std::string_view key) {
  const Json& value = child(object, key);
  if (!value.is_number()) return std::nullopt;
  const double result = value.get<double>();
  return std::isfinite(result) ? std::optional<double>(result) : std::nullopt;
}

std::optional<double> element(const Json& array, std::size_t index) {
  if (!array.is_array() || index >= array.size() || !array[index].is_number()) return std::nullopt;
  const double result = array[index].get<double>();
  return std::isfinite(result) ? std::optional<double>(result) : std::nullopt;
}

std::string text(const Json& object, std::string_view key) {
  const Json& value = child(object, key);
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_integer()) return value.dump();
  if (value.is_number()) return fmt::format("{:g}", value.get<double>());
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  return "";
}

bool flag(const Json& object, std::string_view key) {
  const Json& value = child(object, key);
  return value.is_boolean() && value.get<bool>();
}

}  // namespace softfinger::report
