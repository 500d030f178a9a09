#include "comparisons/reference/theory_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace softfinger::reference {
namespace {

/// The compression d/h at which linear finite elements are off by 5 % in a, b, area or torque at a
/// given load, and by about 10 % in the peak pressure, against the same at finite strain. From the
/// atlas (finite_strain.csv): nu 0: 4.0 % at d/h 0.062 and 6.4 % at 0.089; 0.3: 3.9 % at 0.17 and
/// 7.1 % at 0.22; 0.45: 5.3 % at 0.36 with slopes of 0.2; 0.49: 3.1 % at 0.22 and 7.5 % at 0.39.
double largest_linear_strain(double poisson_ratio) {
  constexpr std::array<double, 4> kPoissonRatio{0, 0.3, 0.45, 0.5};
  constexpr std::array<double, 4> kStrain{0.075, 0.18, 0.3, 0.3};
  std::size_t i = 1;
  while (i + 1 < kPoissonRatio.size() && poisson_ratio > kPoissonRatio[i]) ++i;
  const double part =
      (poisson_ratio - kPoissonRatio[i - 1]) / (kPoissonRatio[i] - kPoissonRatio[i - 1]);
  return kStrain[i - 1] + part * (kStrain[i] - kStrain[i - 1]);
}

}  // namespace

Validity theory_limits(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                       const ReferenceResult& result) {
  Validity validity;
  if (contact_case.fem_finite) return validity;
  const ElasticLayer& layer = contact_case.layer;
  validity.add({"small_strain", result.indentation_m / layer.thickness_m,
                largest_linear_strain(layer.poisson_ratio), true,
                "the layer is compressed so much that linear elasticity is off by more than 5 % in "
                "area or torque and 10 % in the peak pressure, whatever error the elements state: "
                "take finite strain"});
  // Bodies without an ellipse have no radii to compare with.
  if (geometry.no_ellipse.empty())
    validity.add(
        {"small_slope",
         std::max(result.a_m / geometry.radii.major_m, result.b_m / geometry.radii.minor_m), 0.3,
         true,
         "the surfaces are steep at the contact's edge: at a slope of 0.3 their inclined "
         "area is 4.5 % more than linear theory's, the torque 2 %: take finite strain"});
  return validity;
}

std::string beyond_limits_in_words(const Validity& validity) {
  std::string words;
  for (const ValidityCheck& check : validity)
    if (!check.holds())
      words += fmt::format("{}{} {:.2g}, holds below {:.2g}",
                           words.empty() ? "beyond linear theory: " : "; ", check.check,
                           check.value, check.limit);
  return words;
}

}  // namespace softfinger::reference
