#include "comparisons/report/style.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

namespace softfinger::report {

std::vector<std::string> model_names(const Json& report) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  };
  for (const Json& model : child(report, "models")) add(text(model, "name"));
  for (const Json& report_case : child(report, "cases"))
    for (const Json& load : child(report_case, "loads"))
      for (const Json& model : child(load, "models")) add(text(model, "model"));
  for (const Json& model : child(child(report, "atlas"), "models"))
    if (const std::string name = text(model, "model"); name.rfind("fem", 0) != 0) add(name);
  return names;
}

std::string with_labels_of(const std::vector<std::string>& models, std::string words) {
  const auto is_of_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
  };
  const auto is_typed = [&](std::size_t at) {
    const std::size_t option = words.rfind("--model", at), space = words.find(' ', option);
    return option != std::string::npos && space < at &&
           words.find_first_of(" ;.:", space + 1) >= at;
  };
  for (const std::string& name : models) {
    std::size_t at = 0;
    while (!name.empty() && (at = words.find(name, at)) != std::string::npos) {
      const std::size_t end = at + name.size();
      const bool is_whole = (at == 0 || !is_of_name(words[at - 1])) &&
                            (end == words.size() || !is_of_name(words[end]));
      const std::string shown = is_whole && !is_typed(at) ? label(name) : name;
      words.replace(at, name.size(), shown);
      at += shown.size();
    }
  }
  return words;
}

std::string with_labels(const Json& report, std::string words) {
  std::vector<std::string> names;
  for (const Json& model : child(report, "models")) names.push_back(text(model, "name"));
  return with_labels_of(names, std::move(words));
}

Style style_of_place(std::size_t place) {
  // Colour and dash pattern differ together, so that curves differ in grey print too.
  static constexpr std::array<const char*, 8> kDashes{"none", "7 3",       "2 2.5", "9 3 2 3",
                                                      "12 3", "5 2 1.5 2", "4 4",   "1.5 4"};
  const char* dash = kDashes[place % kDashes.size()];
  // The first eight colours are chosen by hand (report.css).
  if (place < kDashes.size()) return {fmt::format("var(--model-{})", place + 1), dash};
  // Steps of the golden angle never come back to a hue, and stay far from the last few.
  constexpr double kGoldenAngle_deg = 137.50776405;
  const double hue_deg = std::fmod(kGoldenAngle_deg * double(place), 360);
  return {fmt::format("hsl({:.1f} 60% var(--further-model-lightness))", hue_deg), dash};
}

Style style(const Json& report, const std::string& model) {
  if (model == "fem") return {"var(--fem)", "none"};
  if (model == "fem_coarse") return {"var(--muted)", "4 3"};
  const auto names = model_names(report);
  return style_of_place(
      static_cast<std::size_t>(std::find(names.begin(), names.end(), model) - names.begin()));
}

}  // namespace softfinger::report
