#pragma once

#include "softfinger/layer/contact_numbers.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// An answer with these numbers, as yet without checks.
inline Prediction answer_of(const ContactNumbers& contact) noexcept {
  Prediction prediction;
  prediction.has_answer = true;
  prediction.a_m = contact.a_m;
  prediction.b_m = contact.b_m;
  prediction.indentation_m = contact.indentation_m;
  prediction.peak_pressure_Pa = contact.peak_pressure_Pa;
  prediction.torque_arm_exact_m = contact.torque_arm_exact_m;
  prediction.torque_arm_paper_m = contact.torque_arm_paper_m;
  return prediction;
}

inline Prediction answer_of(const DifferentiatedContact& contact) noexcept {
  const auto& numbers = contact.numbers;
  return answer_of(ContactNumbers{numbers.a_m.value, numbers.b_m.value, numbers.indentation_m.value,
                                  numbers.peak_pressure_Pa.value, numbers.torque_arm_exact_m.value,
                                  numbers.torque_arm_paper_m.value});
}

}  // namespace softfinger
