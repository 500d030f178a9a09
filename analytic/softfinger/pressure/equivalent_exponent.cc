#include "softfinger/pressure/equivalent_exponent.h"

#include <cmath>

#include "softfinger/friction/max_torque.h"

namespace softfinger {

double equivalent_exponent(const Prediction& prediction) {
  if (!prediction.has_answer) return NAN;
  // The arm of a circle of radius one is (n+1) B(3/2, n+1), which decreases with n. For an ellipse
  // it is multiplied by a (2/pi) E(m), for every n.
  const double ellipse_m = torque_arm_exact_m(prediction.a_m, prediction.b_m, 0) / (2.0 / 3);
  const double arm = prediction.torque_arm_exact_m / ellipse_m;
  for (const double named : {0.5, 1.0, 2.0})
    if (std::abs(arm / torque_arm_exact_m(1, 1, named) - 1) < 1e-14) return named;
  double low = -0.99, high = 1000;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (torque_arm_exact_m(1, 1, middle) > arm ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace softfinger
