#include "softfinger/pressure/equivalent_exponent.h"

#include <algorithm>
#include <cmath>

#include "softfinger/friction/max_torque.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/arm_exponent.h"

namespace softfinger {

double equivalent_exponent(const Prediction& prediction) {
  if (!prediction.has_answer) return NAN;
  // The arm of a circle of radius one is (n+1) B(3/2, n+1), which decreases with n. For an ellipse
  // it is multiplied by a (2/pi) E(m), for every n.
  const double ellipse_m = torque_arm_exact_m(prediction.a_m, prediction.b_m, 0) / (2.0 / 3);
  const double arm = prediction.torque_arm_exact_m / ellipse_m;
  for (const double named : {0.5, 1.0, 2.0})
    if (std::abs(arm / torque_arm_exact_m(1, 1, named) - 1) < 1e-14) return named;
  // 1/arm² is nearly a straight line in n, of slope 4/pi: each correction by the slope of its first
  // two terms leaves less than a hundredth of the error.
  const double wanted = kPi / 4 / (arm * arm), slope = 1 + 1 / (32 * wanted * wanted);
  double exponent = std::clamp(exponent_plus_one(arm) - 1, -0.99, 1000.);
  for (int i = 0; i < 30; ++i) {
    const double found = torque_arm_exact_m(1, 1, exponent);
    const double step = slope * (wanted - kPi / 4 / (found * found));
    exponent = std::clamp(exponent + step, -0.99, 1000.);
    if (std::abs(step) < 1e-14 * (exponent + 2)) break;
  }
  return exponent;
}

}  // namespace softfinger
