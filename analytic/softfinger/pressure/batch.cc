#include "softfinger/pressure/batch.h"

#include <algorithm>
#include <array>
#include <limits>

#include "softfinger/layer/fingertip_layer_core.h"
#include "softfinger/math/pack.h"
#include "softfinger/math/wide.h"
#include "softfinger/pressure/answer.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/rubbed_core.h"
#include "softfinger/pressure/rubbed_prediction.h"

namespace softfinger {

// Table look-ups handle one contact after the other.
inline LimitShapesOf<Pack> tabulated_limit_shapes(const Pack& log_radii_ratio) noexcept {
  LimitShapesOf<Pack> shapes;
  for (int i = 0; i < Pack::kSize; ++i) {
    const LimitShapes one = tabulated_limit_shapes(log_radii_ratio[i]);
    shapes.log_radii_ratio.set(i, one.log_radii_ratio);
    shapes.log_hertz_aspect.set(i, one.log_hertz_aspect);
    shapes.log_incompressible_aspect.set(i, one.log_incompressible_aspect);
    shapes.log_hertz_depth.set(i, one.log_hertz_depth);
    shapes.log_incompressible_depth.set(i, one.log_incompressible_depth);
    shapes.log_hertz_size_at_unit_load.set(i, one.log_hertz_size_at_unit_load);
    shapes.log_incompressible_size_at_unit_load.set(i, one.log_incompressible_size_at_unit_load);
  }
  return shapes;
}

inline LayerQuantitiesOf<Pack> table_correction(const TableCoordinatesOf<Pack>& at) noexcept {
  LayerQuantitiesOf<Pack> correction;
  for (int i = 0; i < Pack::kSize; ++i) {
    const LayerQuantities one =
        table_correction(TableCoordinates{at.log_size[i], at.compressibility[i], at.elongation[i]});
    for (std::size_t q = 0; q < kLayerQuantities; ++q) correction[q].set(i, one[q]);
  }
  return correction;
}

inline Pack log_ring_arm(const Pack& log_aspect) noexcept {
  Pack arm;
  for (int i = 0; i < Pack::kSize; ++i) arm.set(i, log_ring_arm(log_aspect[i]));
  return arm;
}

namespace {

/// A pack of an array from `first` on; what is beyond its end repeats the last.
inline Pack taken(const double* array, std::size_t first, std::size_t count) noexcept {
  Pack pack;
  if (!array) return pack;
  if (first + Pack::kSize <= count) return Pack::from(array + first);
  for (int i = 0; i < Pack::kSize; ++i) {
    const std::size_t index = first + std::size_t(i);
    pack.set(i, array[index < count ? index : count - 1]);
  }
  return pack;
}

inline void put(double value, double* array, std::size_t index) noexcept {
  if (array) array[index] = value;
}

inline void put(const Pack& values, double* array, std::size_t first) noexcept {
  if (array) values.write(array + first);
}

inline void put(const Prediction& found, const PredictionBatch& predictions,
                std::size_t index) noexcept {
  put(found.a_m, predictions.a_m, index);
  put(found.b_m, predictions.b_m, index);
  put(found.indentation_m, predictions.indentation_m, index);
  put(found.peak_pressure_Pa, predictions.peak_pressure_Pa, index);
  put(found.torque_arm_exact_m, predictions.torque_arm_exact_m, index);
  put(found.torque_arm_paper_m, predictions.torque_arm_paper_m, index);
}

/// Normal and finite.
inline Pack::Mask are_positive(const Pack& numbers) noexcept {
  using Limits = std::numeric_limits<double>;
  return (numbers >= Limits::min()) & (numbers <= Limits::max());
}

inline Pack::Mask are_finite(const Pack& numbers) noexcept {
  using Limits = std::numeric_limits<double>;
  return (numbers >= Limits::lowest()) & (numbers <= Limits::max());
}

/// Whether `predict` would give these numbers: its other answers are left to itself.
inline Pack::Mask are_plain_answers(const ContactInputOf<Pack>& input,
                                    const ContactNumbersOf<Pack>& found) noexcept {
  Pack::Mask plain = (input.poisson_ratio >= 0.) & (input.poisson_ratio <= 0.5) &
                     are_finite(input.finger_xx_per_m) & are_finite(input.finger_yy_per_m) &
                     are_finite(input.finger_xy_per_m) &
                     (input.radius_major_m >= input.radius_minor_m) &
                     are_positive(found.a_m * found.b_m);
  for (const Pack* numbers :
       {&input.normal_force_N, &input.youngs_modulus_Pa, &input.thickness_m, &input.radius_major_m,
        &input.radius_minor_m, &found.a_m, &found.b_m, &found.indentation_m,
        &found.peak_pressure_Pa, &found.torque_arm_exact_m, &found.torque_arm_paper_m})
    plain &= are_positive(*numbers);
  return plain;
}

template <class Numbers>
inline void fill(const PressureModel& model, const ContactBatch& contacts,
                 const PredictionBatch& predictions, const Numbers& numbers_of) noexcept {
  const std::size_t count = contacts.count;
  for (std::size_t first = 0; first < count; first += Pack::kSize) {
    const ContactInputOf<Pack> input = {taken(contacts.normal_force_N, first, count),
                                        taken(contacts.youngs_modulus_Pa, first, count),
                                        taken(contacts.poisson_ratio, first, count),
                                        taken(contacts.thickness_m, first, count),
                                        taken(contacts.radius_major_m, first, count),
                                        taken(contacts.radius_minor_m, first, count),
                                        taken(contacts.finger_xx_per_m, first, count),
                                        taken(contacts.finger_yy_per_m, first, count),
                                        taken(contacts.finger_xy_per_m, first, count)};
    const ContactNumbersOf<Pack> found = numbers_of(input);
    const Pack::Mask plain = are_plain_answers(input, found);
    if (plain[0] && plain[1] && plain[2] && plain[3] && first + Pack::kSize <= count) {
      put(found.a_m, predictions.a_m, first);
      put(found.b_m, predictions.b_m, first);
      put(found.indentation_m, predictions.indentation_m, first);
      put(found.peak_pressure_Pa, predictions.peak_pressure_Pa, first);
      put(found.torque_arm_exact_m, predictions.torque_arm_exact_m, first);
      put(found.torque_arm_paper_m, predictions.torque_arm_paper_m, first);
      continue;
    }
    for (int i = 0; i < Pack::kSize && first + std::size_t(i) < count; ++i)
      put(plain[i]
              ? answer_of(ContactNumbers{found.a_m[i], found.b_m[i], found.indentation_m[i],
                                         found.peak_pressure_Pa[i], found.torque_arm_exact_m[i],
                                         found.torque_arm_paper_m[i]})
              : model.predict(contacts.problem(first + std::size_t(i))),
          predictions, first + std::size_t(i));
  }
}

}  // namespace

void PressureModel::predict_batch(const ContactBatch& contacts,
                                  const PredictionBatch& predictions) const noexcept {
  for (std::size_t index = 0; index < contacts.count; ++index)
    put(predict(contacts.problem(index)), predictions, index);
}

namespace {

/// The contacts `first` to `first + count` of a batch.
ContactBatch part_of(const ContactBatch& contacts, std::size_t first, std::size_t count) noexcept {
  ContactBatch part = contacts;
  part.count = count;
  for (const double* ContactBatch::*array :
       {&ContactBatch::normal_force_N, &ContactBatch::youngs_modulus_Pa,
        &ContactBatch::poisson_ratio, &ContactBatch::thickness_m, &ContactBatch::radius_major_m,
        &ContactBatch::radius_minor_m, &ContactBatch::finger_xx_per_m,
        &ContactBatch::finger_yy_per_m, &ContactBatch::finger_xy_per_m,
        &ContactBatch::pressing_friction_coefficient})
    if (part.*array) part.*array += first;
  return part;
}

/// Numbers of some contacts, in memory.
struct SomeContacts {
  static constexpr std::size_t kMost = 64;
  std::array<double, kMost> a_m{}, b_m{}, indentation_m{}, peak_pressure_Pa{}, exact_m{}, paper_m{};

  PredictionBatch batch() noexcept {
    return {a_m.data(),     b_m.data(),    indentation_m.data(), peak_pressure_Pa.data(),
            exact_m.data(), paper_m.data()};
  }
  ContactNumbersOf<Pack> pack(std::size_t first) const noexcept {
    const auto taken = [first](const auto& array) { return Pack::from(array.data() + first); };
    return {taken(a_m),     taken(b_m),    taken(indentation_m), taken(peak_pressure_Pa),
            taken(exact_m), taken(paper_m)};
  }
};

/// Contacts that are pressed with friction, some of them after each other, because the frictionless
/// answers have to be kept for a moment.
inline void fill_rubbed(const PressureModel& model, const ContactBatch& contacts,
                        const PredictionBatch& predictions) noexcept {
  const bool has_finite_strain = model.card().finite_strain;
  SomeContacts some;
  for (std::size_t first = 0; first < contacts.count; first += SomeContacts::kMost) {
    const ContactBatch part =
        part_of(contacts, first, std::min(SomeContacts::kMost, contacts.count - first));
    model.predict_batch(part, some.batch());
    for (std::size_t start = 0; start < part.count; start += Pack::kSize) {
      const ContactNumbersOf<Pack> frictionless = some.pack(start);
      const Pack mu = taken(part.pressing_friction_coefficient, start, part.count);
      const ContactNumbersOf<Pack> rubbed =
          with_friction<Pack>(frictionless, taken(part.poisson_ratio, start, part.count),
                              taken(part.thickness_m, start, part.count), mu, has_finite_strain);
      for (int i = 0; i < Pack::kSize && start + std::size_t(i) < part.count; ++i) {
        const std::size_t index = first + start + std::size_t(i);
        const bool is_rubbed = frictionless.a_m[i] > 0 && mu[i] > 0;
        const ContactNumbersOf<Pack>& pressed = is_rubbed ? rubbed : frictionless;
        put(pressed.a_m[i], predictions.a_m, index);
        put(pressed.b_m[i], predictions.b_m, index);
        put(pressed.indentation_m[i], predictions.indentation_m, index);
        put(pressed.peak_pressure_Pa[i], predictions.peak_pressure_Pa, index);
        put(pressed.torque_arm_exact_m[i], predictions.pressure_arm_m, index);
        put(frictionless.torque_arm_exact_m[i], predictions.torque_arm_exact_m, index);
        put(frictionless.torque_arm_paper_m[i], predictions.torque_arm_paper_m, index);
        put(frictionless.a_m[i], predictions.frictionless_a_m, index);
        put(frictionless.b_m[i], predictions.frictionless_b_m, index);
      }
    }
  }
}

}  // namespace

void predict_batch(const PressureModel& model, const ContactBatch& contacts,
                   const PredictionBatch& predictions) noexcept {
  if (contacts.pressing_friction_coefficient && knows_pressing_friction(model)) {
    with_best_instructions([&] { fill_rubbed(model, contacts, predictions); });
    return;
  }
  // Without friction two numbers of a contact are one.
  PredictionBatch frictionless = predictions;
  const auto copy_later = [](double*& number, double* twin) {
    const bool has_both = number && twin;
    if (!number) number = twin;
    return has_both;
  };
  const bool copies_arm = copy_later(frictionless.torque_arm_exact_m, predictions.pressure_arm_m);
  const bool copies_a = copy_later(frictionless.a_m, predictions.frictionless_a_m);
  const bool copies_b = copy_later(frictionless.b_m, predictions.frictionless_b_m);
  model.predict_batch(contacts, frictionless);
  const auto copy = [&](bool copies, const double* number, double* twin) {
    if (copies) std::copy_n(number, contacts.count, twin);
  };
  copy(copies_arm, predictions.torque_arm_exact_m, predictions.pressure_arm_m);
  copy(copies_a, predictions.a_m, predictions.frictionless_a_m);
  copy(copies_b, predictions.b_m, predictions.frictionless_b_m);
}

void predict_bonded_layer_batch(const PressureModel& model, const ContactBatch& contacts,
                                const PredictionBatch& predictions) noexcept {
  with_best_instructions([&] {
    fill(model, contacts, predictions,
         [](const ContactInputOf<Pack>& input) { return bonded_layer_numbers(input); });
  });
}

void predict_fingertip_layer_batch(const PressureModel& model, const ContactBatch& contacts,
                                   const PredictionBatch& predictions) noexcept {
  const double sphere = contacts.are_objects_spherical ? 1 : 0;
  with_best_instructions([&] {
    fill(model, contacts, predictions, [sphere](const ContactInputOf<Pack>& input) {
      return fingertip_layer_numbers(input, sphere);
    });
  });
}

}  // namespace softfinger
