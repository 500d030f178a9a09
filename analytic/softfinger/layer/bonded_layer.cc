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

ShapeTable::Values numbers_of(const LimitShapes& shapes) {
  return {shapes.log_hertz_aspect,
          shapes.log_incompressible_aspect,
          shapes.log_hertz_depth,
          shapes.log_incompressible_depth,
          shapes.log_hertz_size_at_unit_load,
          shapes.log_incompressible_size_at_unit_load};
}

LimitShapes shapes_of(double log_radii_ratio, const ShapeTable::Values& v) {
  return {log_radii_ratio, v[0], v[1], v[2], v[3], v[4], v[5]};
}

const ShapeTable& shape_table() {
  static const ShapeTable table([](double L) { return numbers_of(limit_shapes(std::exp(L))); });
  return table;
}

using RingTable = PiecewisePolynomial<1, kPieces, kDegree>;

double exact_log_ring_arm(double log_aspect) {
  const double inverse = std::exp(-log_aspect);
  return std::log(2 / kPi * elliptic_integrals(inverse * inverse).E()) + 0.5 * log_aspect;
}

const RingTable& ring_table() {
  static const RingTable table([](double A) { return RingTable::Values{exact_log_ring_arm(A)}; });
  return table;
}

}  // namespace

LimitShapes tabulated_limit_shapes(double log_radii_ratio) noexcept {
  if (log_radii_ratio > ShapeTable::kEnd) return limit_shapes(std::exp(log_radii_ratio));
  return shapes_of(log_radii_ratio, shape_table().value(log_radii_ratio));
}

LimitShapes tabulated_limit_slopes(double log_radii_ratio) noexcept {
  if (!(log_radii_ratio > ShapeTable::kEnd))
    return shapes_of(1, shape_table().slope(log_radii_ratio));
  // There all of them are nearly straight.
  constexpr double kStep = 1e-3;
  const auto above = numbers_of(limit_shapes(std::exp(log_radii_ratio + kStep)));
  const auto below = numbers_of(limit_shapes(std::exp(log_radii_ratio - kStep)));
  ShapeTable::Values slope;
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = (above[i] - below[i]) / (2 * kStep);
  return shapes_of(1, slope);
}

double log_ring_arm(double log_aspect) noexcept {
  return log_aspect > RingTable::kEnd ? exact_log_ring_arm(log_aspect)
                                      : ring_table().value(log_aspect)[0];
}

double log_ring_arm_slope(double log_aspect) noexcept {
  // E(m) is 1 to 1e-8 beyond.
  return log_aspect > RingTable::kEnd ? 0.5 : ring_table().slope(log_aspect)[0];
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
