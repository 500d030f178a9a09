#include "comparisons/report/fit_section.h"

#include <algorithm>
#include <cmath>

#include "comparisons/report/style.h"
#include "softfinger/input/constants.h"

namespace softfinger::report {
namespace {

constexpr double kSide = 360, kMiddle = kSide / 2;

/// Colours of facets above the quadric, and below it.
constexpr const char* kAbove = "var(--model-2)";
constexpr const char* kBelow = "var(--model-1)";

double at(const Json& facet, std::size_t i) { return element(facet, i).value_or(0); }

/// Largest distance from the quadric, among facets whose centre is in the region.
double largest_distance_m(const Json& facets, double radius_m) {
  double largest = 0;
  for (const Json& facet : facets) {
    const double x = (at(facet, 0) + at(facet, 2) + at(facet, 4)) / 3,
                 y = (at(facet, 1) + at(facet, 3) + at(facet, 5)) / 3;
    if (std::hypot(x, y) <= radius_m) largest = std::max(largest, std::abs(at(facet, 6)));
  }
  return largest;
}

Html ellipse(const char* style_class, double a, double b, double axis_rad) {
  return html(
      "<ellipse class=\"{}\" rx=\"{:.1f}\" ry=\"{:.1f}\" transform=\"translate({:.0f} {:.0f}) "
      "rotate({:.2f})\"/>",
      style_class, a, b, kMiddle, kMiddle, -axis_rad * 180 / kPi);
}

/// Lines of equal depth of the quadric, four of them within the region.
Html depth_lines(const Json& fit, double radius_m, double pixels_per_m) {
  const auto one = element(child(fit, "radii_m"), 0), other = element(child(fit, "radii_m"), 1);
  const auto axis = number(fit, "axis_rad");
  if (!one || !other || !axis || *one <= 0 || *other <= 0) return "";
  const double deepest_m = radius_m * radius_m / (2 * std::max(*one, *other));
  Html lines;
  for (int i = 1; i <= 4; ++i) {
    const double depth_m = deepest_m * i / 4;
    lines += ellipse("depth", pixels_per_m * std::sqrt(2 * *one * depth_m),
                     pixels_per_m * std::sqrt(2 * *other * depth_m), *axis);
  }
  return lines;
}

Html picture(const Json& load, const Json& patch, const char* body) {
  const Json& drawn = child(child(patch, "pictures"), body);
  const Json& facets = child(drawn, "facets");
  const auto radius_m = number(drawn, "region_radius_m");
  if (!facets.is_array() || facets.empty() || !radius_m || !(*radius_m > 0)) return "";
  const double pixels_per_m = kMiddle / (1.5 * *radius_m);
  const double largest_m = std::max(largest_distance_m(facets, *radius_m), 1e-12);
  Html shapes;
  for (const Json& facet : facets) {
    const double share = at(facet, 6) / largest_m;
    const auto x = [&](std::size_t i) { return kMiddle + pixels_per_m * at(facet, 2 * i); };
    const auto y = [&](std::size_t i) { return kMiddle - pixels_per_m * at(facet, 2 * i + 1); };
    shapes += html(
        "<path style=\"fill:{}\" fill-opacity=\"{:.2f}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} "
        "{:.1f}Z\"/>",
        share > 0 ? kAbove : kBelow, std::min(1., 0.85 * std::abs(share)), x(0), y(0), x(1), y(1),
        x(2), y(2));
  }
  const Json& geometry = child(load, "geometry");
  const auto a_m = number(child(load, "fem"), "a_m"), b_m = number(child(load, "fem"), "b_m");
  const auto axis = number(geometry, "axis_rad");
  const bool is_finger = std::string_view(body) == "finger";
  // The contact's axes are those of the finger.
  const Html contact = is_finger && a_m && b_m && axis
                           ? ellipse("contact", pixels_per_m * *a_m, pixels_per_m * *b_m, *axis)
                           : Html("");
  return html(
             "<figure class=\"fit\"><figcaption><b>The {}’s surface and its quadric.</b> Facets "
             "above the quadric are orange, below it blue, up to {} µm within the region (bold "
             "circle, radius {} mm). Thin: the quadric’s depth lines{}.</figcaption>"
             "<svg viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" role=\"img\" "
             "aria-label=\"Facets, "
             "region and quadric\">",
             body, significant(largest_m, 1e6, 2), significant(*radius_m, 1e3, 3),
             is_finger ? "; dashed: the contact by FEM" : "", kSide, kSide, kSide) +
         shapes + depth_lines(child(patch, body), *radius_m, pixels_per_m) +
         ellipse("region", pixels_per_m * *radius_m, pixels_per_m * *radius_m, 0) + contact +
         "</svg></figure>\n";
}

}  // namespace

Html fit_pictures(const Json& load) {
  const Json& patch = child(child(load, "geometry"), "patch");
  return picture(load, patch, "finger") + picture(load, patch, "object");
}

}  // namespace softfinger::report
