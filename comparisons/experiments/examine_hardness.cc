#include <fmt/format.h>

#include "comparisons/experiments/examine.h"
#include "comparisons/experiments/hardness_relations.h"

namespace softfinger::experiments {

void examine_hardness(const Hardness& hardness, Examined& examined) {
  const bool is_a = hardness.scale == Hardness::Scale::a;
  const auto shore = [&](double modulus_Pa) {
    return is_a ? shore_a_of_modulus(modulus_Pa)
                : shore_oo_of_modulus(modulus_Pa, hardness.poisson_ratio);
  };
  const double E_Pa = hardness.youngs_modulus_Pa;
  Finding finding;
  finding.test = is_a ? "hardness, Shore A" : "hardness, Shore 00";
  finding.model = is_a ? "Gent 1958" : "Hertz under the durometer's sphere";
  finding.measured = hardness.value;
  finding.uncertainty = hardness.uncertainty;
  finding.predicted = {shore(E_Pa), shore(E_Pa / kHardnessModulusFactor),
                       shore(E_Pa * kHardnessModulusFactor)};
  finding.verdict = compared(finding);
  const double of_hardness_Pa =
      is_a ? modulus_of_shore_a_Pa(hardness.value)
           : modulus_of_shore_oo_Pa(hardness.value, hardness.poisson_ratio);
  finding.reason = fmt::format(
      "The hardness says E = {:.3g} kPa, {:.2g} times the stated {:.3g} kPa; the relation is "
      "supposed to hold within a factor of {:g}.",
      of_hardness_Pa * 1e-3, of_hardness_Pa / E_Pa, E_Pa * 1e-3, kHardnessModulusFactor);
  if (hardness.value < 100)
    examined.inferred.push_back({"youngs_modulus",
                                 "Pa",
                                 "of the hardness",
                                 {of_hardness_Pa, of_hardness_Pa / kHardnessModulusFactor,
                                  of_hardness_Pa * kHardnessModulusFactor}});
  examined.sentence = fmt::format(
      "E = {:.3g} kPa would be Shore {} {:.0f} ({:.0f} to {:.0f}), "
      "stated is {:g}.",
      E_Pa * 1e-3, is_a ? "A" : "00", finding.predicted.value, finding.predicted.low,
      finding.predicted.high, hardness.value);
  examined.findings.push_back(finding);
}

}  // namespace softfinger::experiments
