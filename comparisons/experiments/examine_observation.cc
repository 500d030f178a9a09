#include <fmt/format.h>

#include <cmath>

#include "comparisons/experiments/examine.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/layer/circular_contact.h"

namespace softfinger::experiments {
namespace {

constexpr double kRubber = 0.49;

/// a/h at which a layer of rubber has the torque of p ~ (1 - r²/a²)^n; its arm falls with a/h.
double size_of_pressure_exponent(double exponent) {
  const double arm = torque_arm_exact_m(1, 1, exponent);
  double low = 0.05, high = 20;
  for (int i = 0; i < 30; ++i) {
    const double s = std::sqrt(low * high);
    (circular_layer_contact(s, 1, {{LayerKernel(kRubber), 1, 1}}).torque_arm_m / s > arm ? low
                                                                                         : high) =
        s;
  }
  return std::sqrt(low * high);
}

void add(Examined& examined, const Observation& observed, const char* test, const char* model,
         Role role, const Interval& predicted, const std::string& reason) {
  Finding finding;
  finding.test = test;
  finding.model = model;
  finding.role = role;
  finding.measured = observed.value;
  finding.uncertainty = observed.uncertainty;
  finding.predicted = predicted;
  finding.verdict = compared(finding);
  finding.reason = reason;
  examined.findings.push_back(finding);
}

}  // namespace

void examine_observation(const Observation& observed, Examined& examined) {
  switch (observed.quantity) {
    case Observation::Quantity::pressure_exponent: {
      const char* test = "exponent n of the pressure";
      const bool has_size = observed.value > 0.5 && observed.value < 1.9;
      const double size = has_size ? size_of_pressure_exponent(observed.value) : 0;
      add(examined, observed, test, "bonded_layer", Role::theory, {1, 0.5, 2},
          has_size ? fmt::format("A layer of nu {:g} has the torque of this n at a/h = {:.2g}.",
                                 kRubber, size)
                   : "");
      add(examined, observed, test, "hertz", Role::rival, {0.5, 0.5, 0.5}, "");
      add(examined, observed, test, "winkler", Role::rival, {1, 1, 1}, "");
      add(examined, observed, test, "thin_incompressible", Role::rival, {2, 2, 2}, "");
      examined.sentence = fmt::format(
          "n = {:g}, between a thick layer's 1/2 and a thin incompressible one's 2: the pad is no "
          "half-space, but a compressible or a thin layer{}; which of them cannot be told.",
          observed.value, has_size ? fmt::format(" (a/h = {:.2g} at nu {:g})", size, kRubber) : "");
      break;
    }
    case Observation::Quantity::torque_exponent: {
      const char* test = "exponent d ln T/d ln P at slip";
      add(examined, observed, test, "coulomb", Role::theory, {1.25, 1 + 1. / 6, 1 + 1. / 3},
          "T ~ P a ~ P^(1 + gamma), gamma from 1/6 (thin incompressible layer) to 1/3 (Hertz).");
      add(examined, observed, test, "shear_strength", Role::option, {0.75, 0.5, 1},
          "T ~ a³ ~ P^(3 gamma).");
      examined.sentence = fmt::format(
          "Under Coulomb's law no elastic finger has T ~ P^{:g}: the exponent is 1.17 to 1.33. "
          "Constant shear strength has 0.5 to 1, the upper end on a thick pulp.",
          observed.value);
      break;
    }
    case Observation::Quantity::shear_stress_exponent: {
      const char* test = "exponent d ln tau/d ln p at slip";
      add(examined, observed, test, "coulomb", Role::theory, {1, 1, 1}, "tau = mu p.");
      add(examined, observed, test, "shear_strength", Role::option, {0, 0, 0}, "tau = tau_0.");
      add(examined, observed, test, "limited", Role::option, {0, 0, 1},
          "min(mu p, tau_0): 0 where the pressure is high, 1 at the edge.");
      add(examined, observed, test, "adhesive_shear", Role::option, {0.5, 0, 1},
          "tau_0 + mu p: between both.");
      examined.sentence =
          "Coulomb's law, which is taken unless a case names another, is not that of smooth "
          "rubber; "
          "shear_law = \"shear_strength\" is.";
      break;
    }
    case Observation::Quantity::area_change_under_shear: {
      add(examined, observed, "relative change of the area from no shear to sliding",
          "any closed form", Role::theory, {0, 0, 0},
          "The normal contact is computed without friction, so shear does not change it.");
      examined.sentence = fmt::format(
          "Up to {:.0f} % of the area are lost under shear; no closed form knows of it, so areas "
          "at "
          "sliding and what follows from them may be too large by that. Finite elements with "
          "friction at finite strain do (area_ratio of softfinger fem --torsion).",
          -100 * observed.value);
      break;
    }
  }
}

}  // namespace softfinger::experiments
