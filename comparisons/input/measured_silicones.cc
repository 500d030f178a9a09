#include "comparisons/input/measured_silicones.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = char(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

}  // namespace

double MeasuredSilicone::low_kPa() const {
  return std::min({secant_10_kPa, to_30_kPa, to_100_kPa});
}
double MeasuredSilicone::high_kPa() const {
  return std::max({secant_10_kPa, to_30_kPa, to_100_kPa});
}

const std::vector<MeasuredSilicone>& measured_silicones() {
  static const std::vector<MeasuredSilicone> table = {
      {"BodyDouble SILK", 283, 353, 451},
      {"Dragon Skin 10 MEDIUM", 111, 147, 201},
      {"Dragon Skin 20", 287, 394, 579},
      {"Dragon Skin 30", 457, 587, 769},
      {"Dragon Skin FX Pro Slacker", 10, 8, 8},
      {"Dragon Skin FX Pro", 72, 99, 112},
      {"Ecoflex 00-10", 21, 29, 27},
      {"Ecoflex 00-30", 36, 51, 52},
      {"Ecoflex 00-35 FAST", 66, 87, 98},
      {"Ecoflex 00-50", 49, 74, 74},
      {"Mold Star 16 FAST", 218, 272, 321},
      {"Mold Star 20T", 287, 303, 403},
      {"PlatSil Gel 10", 134, 183, 261},
      {"Psycho Paint", 311, 335, 426},
      {"RTV615", 877, 1073, 1376},
      {"Rebound 25", 251, 320, 406},
      {"SOLOPLAST 150318", 168, 169, 244},
      {"SortaClear 40", 746, 878, 973},
      {"WAGNERSIL 20 NF", 293, 329, 540},
  };
  return table;
}

const MeasuredSilicone& find_measured_silicone(const std::string& typed) {
  const std::string wanted = lower_case(typed);
  std::vector<std::string> names;
  const MeasuredSilicone* begins = nullptr;
  int beginning = 0;
  for (const MeasuredSilicone& one : measured_silicones()) {
    names.emplace_back(one.name);
    const std::string name = lower_case(one.name);
    if (name == wanted) return one;
    if (wanted.empty() || name.rfind(wanted, 0) != 0) continue;
    begins = &one;
    ++beginning;
  }
  if (beginning == 1) return *begins;
  throw InputError("command line",
                   "--material: unknown material \"" + text::shortened(typed) + "\"" +
                       text::did_you_mean(typed, names),
                   "", text::joined(names));
}

std::vector<const MeasuredSilicone*> silicones_like(double youngs_modulus_Pa) {
  const double modulus_kPa = 1e-3 * youngs_modulus_Pa;
  std::vector<const MeasuredSilicone*> found;
  for (const MeasuredSilicone& one : measured_silicones())
    if (one.low_kPa() <= modulus_kPa && modulus_kPa <= one.high_kPa()) found.push_back(&one);
  std::stable_sort(found.begin(), found.end(),
                   [&](const MeasuredSilicone* one, const MeasuredSilicone* other) {
                     return std::abs(std::log(one->to_30_kPa / modulus_kPa)) <
                            std::abs(std::log(other->to_30_kPa / modulus_kPa));
                   });
  return found;
}

}  // namespace softfinger::input
