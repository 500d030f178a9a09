#include "comparisons/reference/theory_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/layer/layer_kernel.h"
#include "softfinger/layer/stack_kernel.h"

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

/// The compression d/h of a layer and the largest that linear elasticity bears.
struct Compression {
  double strain, limit;

  bool is_nearer_to_limit_than(const Compression& other) const {
    return strain * other.limit > other.strain * limit;
  }
};

Compression compression(const ElasticLayer& layer, double indentation_m) {
  return {indentation_m / layer.thickness_m, largest_linear_strain(layer.poisson_ratio)};
}

/// Displacement of a layer's surface under a pressure that varies over the contact's size, in that
/// size.
double compliance_per_Pa(const ElasticLayer& layer, double size_m) {
  return StackKernel(layer).compliance(layer.thickness_m / size_m) /
         layer.plane_strain_modulus_Pa();
}

/// Two layers share the indentation as their compliances.
Compression larger_compression(const input::Case& contact_case, const ReferenceResult& result) {
  const ElasticLayer &layer = contact_case.layer, &other = contact_case.object_layer;
  if (!(other.thickness_m > 0)) return compression(layer, result.indentation_m);
  const double size_m = std::sqrt(result.a_m * result.b_m);
  const double own = compliance_per_Pa(layer, size_m), object = compliance_per_Pa(other, size_m);
  const Compression of_finger = compression(layer, result.indentation_m * own / (own + object)),
                    of_object = compression(other, result.indentation_m * object / (own + object));
  return of_object.is_nearer_to_limit_than(of_finger) ? of_object : of_finger;
}

}  // namespace

Validity theory_limits(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                       const ReferenceResult& result) {
  Validity validity;
  if (contact_case.fem_finite) return validity;
  const Compression larger = larger_compression(contact_case, result);
  validity.add({"small_strain", larger.strain, larger.limit, true,
                "a layer is compressed so much that linear elasticity is off by more than 5 % in "
                "area or torque and 10 % in the peak pressure, whatever error the elements state: "
                "take finite strain, or less load"});
  // Bodies without an ellipse have no radii to compare with.
  if (geometry.no_ellipse.empty())
    validity.add(
        {"small_slope",
         std::max(result.a_m / geometry.radii.major_m, result.b_m / geometry.radii.minor_m), 0.3,
         true,
         "the surfaces are steep at the contact's edge: at a slope of 0.3 their inclined "
         "area is 4.5 % more than linear theory's, the torque 2 %: take finite strain, or less "
         "load"});
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
