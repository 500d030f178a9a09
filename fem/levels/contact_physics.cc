#include "fem/levels/contact_physics.h"

namespace softfinger::fem {

std::string message_of(const Obstacle& obstacle) {
  if (const auto* last = std::get_if<NotReached>(&obstacle)) return last->error.what();
  return std::get<FoldedLayer>(obstacle).refusal.what();
}

void set_shape(const ContactShape& shape, double thickness_m, double youngs_modulus_Pa,
               LevelResult& result) {
  const double h = thickness_m, E = youngs_modulus_Pa;
  result.a_m = shape.a * h;
  result.b_m = shape.b * h;
  result.turn_rad = shape.turn_rad;
  result.area_projected_m2 = shape.projected_area * h * h;
  result.ellipse_departure = shape.departure;
  for (const Eigen::Matrix2Xd& outline : shape.outlines) result.outlines_m.push_back(h * outline);
  result.peak_pressure_Pa = shape.peak * E;
  result.centre_pressure_Pa = shape.centre_pressure * E;
  result.cell_m = shape.cell * h;
  result.fitted = shape.fit.has_value();
  result.fit_ambiguity = shape.fit ? shape.fit->ambiguity : 0;
  result.fit_residual = shape.fit ? shape.fit->residual : 0;
}

}  // namespace softfinger::fem
