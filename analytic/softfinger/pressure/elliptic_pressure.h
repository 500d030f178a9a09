#pragma once

#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// 1 - x²/a² - y²/b² at a point of the contact frame; 0 outside the ellipse and when the model had
/// no answer. The pressures of Hertz, Winkler and the thin incompressible layer are its powers.
inline double ellipse_depth(const Prediction& prediction, double x_m, double y_m) noexcept {
  if (!prediction.has_answer) return 0;
  const double u = x_m / prediction.a_m, v = y_m / prediction.b_m;
  const double depth = 1 - u * u - v * v;
  return depth > 0 ? depth : 0;
}

}  // namespace softfinger
