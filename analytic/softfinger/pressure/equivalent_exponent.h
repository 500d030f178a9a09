#pragma once

#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// The exponent n for which a pressure p ~ (1 - x²/a² - y²/b²)^n on the predicted ellipse has the
/// predicted torque arm. The limit surface for this n equals the true one at pure torque and at
/// pure force. Gives the exponents 1/2, 1 and 2 of the models that have this form exactly. Between
/// -0.99 and 1000; NaN without an answer. About half a microsecond.
double equivalent_exponent(const Prediction& prediction);

}  // namespace softfinger
