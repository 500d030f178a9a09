#include "comparisons/report/ladder_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace softfinger::report {
namespace {

struct Panel {
  const char* key;
  const char* heading;
};
constexpr std::array<Panel, 3> kPanels = {
    {{"area", "area"}, {"indentation", "indentation"}, {"max_torque", "torque"}}};

// Measures of the picture, in its own units.
constexpr double kRow = 26, kLabels = 210, kPanel = 200, kInner = 128, kTop = 26;

bool is_doubt(const Json& step) {
  const std::string name = text(step, "step");
  return name == "fit" || name == "facets" || name == "elements";
}

std::optional<double> departure(const Json& step, const char* key) {
  return number(child(step, "quantity"), key);
}

/// The bars of one quantity: each from the departure of the step before to its own.
Html panel(const std::vector<const Json*>& steps, const Panel& of, double left) {
  double lowest = 0, highest = 0;
  for (const Json* step : steps) {
    const double here = departure(*step, of.key).value_or(0);
    lowest = std::min(lowest, here), highest = std::max(highest, here);
  }
  const double span = std::max(highest - lowest, 1e-9);
  const auto x = [&](double value) { return left + kInner * (value - lowest) / span; };
  Html out = html(
      "<text class=\"heading\" x=\"{:.1f}\" y=\"14\">{}</text>"
      "<line class=\"truth\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{}\" y2=\"{}\"/>",
      left, of.heading, x(0), x(0), kTop - 4, kTop + kRow * double(steps.size()));
  double before = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto here = departure(*steps[i], of.key);
    if (!here) continue;
    const double y = kTop + kRow * double(i);
    const double from = i == 0 ? 0 : before;
    out += html("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"12\"/>",
                i == 0 ? "start" : "step", std::min(x(from), x(*here)), y,
                std::max(1.5, std::abs(x(*here) - x(from))));
    out += html("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", left + kInner + 8, y + 10,
                i + 1 == steps.size() ? std::string("reference") : signed_percent(*here));
    before = *here;
  }
  return out;
}

Html picture(const std::vector<const Json*>& steps) {
  const double height = kTop + kRow * double(steps.size()) + 4;
  const double width = kLabels + kPanel * double(kPanels.size());
  Html out = html(
      "<svg class=\"ladder\" viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" role=\"img\" "
      "aria-label=\"What each idealisation costs\">",
      width, height, width);
  for (std::size_t i = 0; i < steps.size(); ++i)
    out += html("<text x=\"0\" y=\"{:.1f}\">{}</text>", kTop + kRow * double(i) + 10,
                text(*steps[i], "words"));
  for (std::size_t p = 0; p < kPanels.size(); ++p)
    out += panel(steps, kPanels[p], kLabels + kPanel * double(p));
  return out + "</svg>";
}

Html doubts_line(const std::vector<const Json*>& doubts) {
  std::vector<Html> parts;
  for (const Json* doubt : doubts) {
    std::vector<Html> numbers;
    for (const Panel& of : kPanels)
      if (const auto value = departure(*doubt, of.key))
        numbers.push_back(html("{} {}", of.heading, percent(*value)));
    if (!numbers.empty())
      parts.push_back(html("{}: {}", text(*doubt, "words"), joined(numbers, ", ")));
  }
  if (parts.empty()) return "";
  return html("<p>Beside it the reference’s own uncertainty: {}.</p>\n", joined(parts, "; "));
}

}  // namespace

Html ladder_section(const Json& load) {
  std::vector<const Json*> steps, doubts;
  const Json& ladder = child(load, "ladder");
  for (const Json& step : ladder) (is_doubt(step) ? doubts : steps).push_back(&step);
  if (steps.size() < 2) return "";
  return details(
      html("What each idealisation costs: {}", text(load, "largest_step")),
      "<p>Bars go from one step’s departure from the reference to the next one’s.</p>\n" +
          html("<div class=\"scroll\" tabindex=\"0\">{}</div>\n", picture(steps)) +
          doubts_line(doubts));
}

}  // namespace softfinger::report
