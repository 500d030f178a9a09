#include <fmt/format.h>

#include <algorithm>

#include "comparisons/experiments/examine.h"
#include "comparisons/experiments/hardness_relations.h"
#include "comparisons/input/measured_silicones.h"

namespace softfinger::experiments {

void examine_tension(const Tension& tension, Examined& examined) {
  double least = INFINITY, most = 0;
  for (const Tension::Material& material : tension.materials) {
    const input::MeasuredSilicone& silicone = input::find_measured_silicone(material.name);
    const double of_hardness_Pa = modulus_of_shore_a_Pa(material.shore_a);
    const double measured_Pa = 1e3 * silicone.to_30_kPa;
    const double ratio = of_hardness_Pa / measured_Pa;
    least = std::min(least, ratio);
    most = std::max(most, ratio);
    Finding finding;
    finding.test = "modulus of " + std::string(silicone.name);
    finding.model = fmt::format("Gent 1958, Shore A {:g}", material.shore_a);
    finding.unit = "Pa";
    finding.measured = measured_Pa;
    finding.uncertainty = 1e3 * std::max(silicone.high_kPa() - silicone.to_30_kPa,
                                         silicone.to_30_kPa - silicone.low_kPa());
    finding.predicted = {of_hardness_Pa, of_hardness_Pa / kHardnessModulusFactor,
                         of_hardness_Pa * kHardnessModulusFactor};
    finding.verdict = compared(finding);
    finding.reason = fmt::format("The hardness says {:.2g} times the measured modulus.", ratio);
    examined.findings.push_back(finding);
  }
  examined.sentence = fmt::format(
      "Gent's relation of the nominal hardness overestimates the modulus in tension {:.2g} to "
      "{:.2g} times; it is supposed to hold within a factor of {:g}.",
      least, most, kHardnessModulusFactor);
}

}  // namespace softfinger::experiments
