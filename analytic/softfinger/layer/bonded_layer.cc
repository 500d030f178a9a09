#include "softfinger/layer/bonded_layer.h"

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/layer/bonded_layer_core.h"
#include "softfinger/layer/bonded_layer_spline.h"
#include "softfinger/layer/contact_numbers.h"
#include "softfinger/math/elliptic_integrals.h"
#include "softfinger/math/piecewise_polynomial.h"

namespace softfinger {
namespace {

constexpr int kPieces = 40, kDegree = 8;  // to ln(R'/R'') = 10

using ShapeTable = PiecewisePolynomial<6, kPieces, kDegree>;

/// The aspects over L, so that they vanish with it to the last digit.
ShapeTable::Values numbers_of(double L) {
  const LimitShapes shapes = limit_shapes(std::exp(L));
  return {shapes.log_hertz_aspect / L,
          shapes.log_incompressible_aspect / L,
          shapes.log_hertz_depth,
          shapes.log_incompressible_depth,
          shapes.log_hertz_size_at_unit_load,
          shapes.log_incompressible_size_at_unit_load};
}

const ShapeTable& shape_table() {
  static const ShapeTable table(numbers_of);
  return table;
}

using RingTable = PiecewisePolynomial<1, kPieces, kDegree>;

double exact_log_ring_arm(double log_aspect) {
  const double inverse = std::exp(-log_aspect);
  return std::log(2 / kPi * elliptic_integrals(inverse * inverse).E()) + 0.5 * log_aspect;
}

/// Over the square of ln(a/b), with which it vanishes.
const RingTable& ring_table() {
  static const RingTable table(
      [](double A) { return RingTable::Values{exact_log_ring_arm(A) / (A * A)}; });
  return table;
}

}  // namespace

LimitShapes tabulated_limit_shapes(double L) noexcept {
  if (L > ShapeTable::kEnd) return limit_shapes(std::exp(L));
  const ShapeTable::Values v = shape_table().value(L);
  return {L, v[0] * L, v[1] * L, v[2], v[3], v[4], v[5]};
}

LimitShapes tabulated_limit_slopes(double L) noexcept {
  if (!(L > ShapeTable::kEnd)) {
    const ShapeTable::Values v = shape_table().value(L), slope = shape_table().slope(L);
    return {1, v[0] + L * slope[0], v[1] + L * slope[1], slope[2], slope[3], slope[4], slope[5]};
  }
  // There all of them are nearly straight.
  constexpr double kStep = 1e-3;
  const auto above = numbers_of(L + kStep), below = numbers_of(L - kStep);
  const auto slope = [&](std::size_t i) { return (above[i] - below[i]) / (2 * kStep); };
  const auto here = numbers_of(L);
  return {1,       here[0] + L * slope(0), here[1] + L * slope(1), slope(2), slope(3), slope(4),
          slope(5)};
}

double log_ring_arm(double log_aspect) noexcept {
  return log_aspect > RingTable::kEnd ? exact_log_ring_arm(log_aspect)
                                      : log_aspect * log_aspect * ring_table().value(log_aspect)[0];
}

double log_ring_arm_slope(double log_aspect) noexcept {
  // E(m) is 1 to 1e-8 beyond.
  if (log_aspect > RingTable::kEnd) return 0.5;
  return log_aspect *
         (2 * ring_table().value(log_aspect)[0] + log_aspect * ring_table().slope(log_aspect)[0]);
}

LayerQuantities table_correction(const TableCoordinates& at) noexcept {
  return bonded_layer_spline<false>(at, nullptr);
}

LayerQuantities table_correction(const TableCoordinates& at,
                                 std::array<LayerQuantities, 3>* slopes) noexcept {
  return bonded_layer_spline<true>(at, slopes);
}

BondedLayerContact bonded_layer_contact(const RelativeRadii& radii, const ElasticLayer& layer,
                                        double normal_force_N) noexcept {
  return bonded_layer_numbers(contact_input(radii, layer, normal_force_N));
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
