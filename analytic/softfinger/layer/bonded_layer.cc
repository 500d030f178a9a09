#include "softfinger/layer/bonded_layer.h"

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/layer/bonded_layer_core.h"
#include "softfinger/layer/contact_numbers.h"
#include "softfinger/math/elliptic_integrals.h"
#include "softfinger/math/wide.h"

namespace softfinger {
namespace {

ShapeTable::Values numbers_of(double L) {
  const LimitShapes shapes = limit_shapes(std::exp(L));
  return {shapes.log_hertz_aspect / L,
          shapes.log_incompressible_aspect / L,
          shapes.log_hertz_depth,
          shapes.log_incompressible_depth,
          shapes.log_hertz_size_at_unit_load,
          shapes.log_incompressible_size_at_unit_load};
}

}  // namespace

const ShapeTable& shape_table() noexcept {
  static const ShapeTable table(numbers_of);
  return table;
}

const RingTable& ring_table() noexcept {
  static const RingTable table(
      [](double A) { return RingTable::Values{log_ring_arm_beyond_table(A) / (A * A)}; });
  return table;
}

double log_ring_arm_beyond_table(double log_aspect) noexcept {
  const double inverse = std::exp(-log_aspect);
  return std::log(2 / kPi * elliptic_integrals(inverse * inverse).E()) + 0.5 * log_aspect;
}

LimitShapes limit_slopes_beyond_table(double L) noexcept {
  // All of these functions are nearly straight there.
  constexpr double kDifference = 1e-3;
  const auto above = numbers_of(L + kDifference), below = numbers_of(L - kDifference);
  const auto slope = [&](std::size_t i) { return (above[i] - below[i]) / (2 * kDifference); };
  const auto here = numbers_of(L);
  return {1,       here[0] + L * slope(0), here[1] + L * slope(1), slope(2), slope(3), slope(4),
          slope(5)};
}

BondedLayerContact bonded_layer_contact(const RelativeRadii& radii, const ElasticLayer& layer,
                                        double normal_force_N) noexcept {
  return with_best_instructions(
      [&] { return bonded_layer_numbers(contact_input(radii, layer, normal_force_N)); });
}

BondedLayerSensitivity bonded_layer_sensitivity(const RelativeRadii& radii,
                                                const ElasticLayer& layer,
                                                double normal_force_N) noexcept {
  using Number = Dual<1>;
  const ContactInputOf<double> at = contact_input(radii, layer, normal_force_N);
  const ContactNumbersOf<Number> contact = bonded_layer_numbers<Number>(
      {Number::variable(normal_force_N, 0), at.youngs_modulus_Pa, at.poisson_ratio, at.thickness_m,
       at.radius_major_m, at.radius_minor_m, 0., 0., 0.});
  return {kPi * (contact.a_m * contact.b_m).slope[0], contact.indentation_m.slope[0],
          contact.torque_arm_exact_m.slope[0]};
}

}  // namespace softfinger
