#include "fem/layer/layer_discretisation.h"

#include <algorithm>
#include <cmath>

namespace softfinger::fem {
namespace {

/// Cells along a semi-axis, which may be the longer one. They are at most three times as long as
/// those across it.
int elements_along(double semi_axis, double other, int elements_per_semi_axis) {
  constexpr double longest_cell = 3;
  return std::max(
      elements_per_semi_axis,
      static_cast<int>(std::ceil(elements_per_semi_axis * semi_axis / (other * longest_cell))));
}

}  // namespace

int LayerDiscretisation::elements_along_a() const {
  return elements_along(a, b, elements_per_semi_axis);
}

int LayerDiscretisation::elements_along_b() const {
  return elements_along(b, a, elements_per_semi_axis);
}

Eigen::Vector2d LayerDiscretisation::needed_reach() const {
  return {patch * a + a / elements_along_a(), patch * b + b / elements_along_b()};
}

bool LayerDiscretisation::is_within_reach() const {
  const Eigen::Vector2d needed = needed_reach();
  return needed.x() < usable_reach * reach_x && needed.y() < usable_reach * reach_y;
}

}  // namespace softfinger::fem
