#pragma once

#include "softfinger/pressure/pressure_model.h"

namespace softfinger::prediction {

/// The exponent n of p ~ (1 - x²/a² - y²/b²)^n whose torque arm for this ellipse is the
/// prediction's own, so that the limit surface for n meets the true one at pure torque and at pure
/// force. The named models' exponents (1/2, 1, 2) come out exactly. Between -0.99 and 1000; NaN
/// without an answer. About 10 microseconds.
double equivalent_exponent(const Prediction& prediction);

}  // namespace softfinger::prediction
