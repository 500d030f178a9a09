#pragma once

#include "softfinger/math/wide.h"

namespace softfinger {

/// `friction_excess` of the unit ball for four contacts at once, each in its own lane.
struct BallExcesses {
  FourConditions slides;  ///< excess > 0
  Four length;            ///< |nu|
  Four boundary[3];       ///< grad h(nu)
};

/// The same bits as `friction_excess` of each. False where the square of a length leaves the range
/// of doubles: then that function must be asked.
/// @param target, metric  a component of all four after another
inline bool find_excesses(const Four (&target)[3], const Four& limit, const Four (&metric)[3],
                          BallExcesses& result) {
  constexpr int kMostIterations = 60;
  constexpr double kSmall = 1e-8;  // of the length: the next step is its square
  constexpr double kLeast = 1e-200, kMost = 1e200;
  const auto square_of = [](const Four(&vector)[3], Four& sum) {
    sum = vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2];
  };
  const auto is_outside = [](const Four& square, FourConditions& outside) {
    outside = ~((square > kLeast) & (square < kMost));
  };
  const Four none = {};
  FourConditions outside;
  Four squares, reach, radii[3], ratio[3], gauge;
  square_of(target, squares);
  const FourConditions is_limited = limit > 0, is_there = squares > 0;
  for (int k = 0; k < 3; ++k) {
    radii[k] = limit * metric[k];
    ratio[k] = target[k] / radii[k];
  }
  is_outside(squares, outside);
  FourConditions fails = is_there & outside;
  square_of(ratio, gauge);
  is_outside(gauge, outside);
  fails |= is_there & is_limited & outside;
  if (has_any(fails)) return false;
  take_root(squares, reach);
  take_root(gauge, gauge);
  const FourConditions is_beyond = is_there & ~(is_limited & (gauge <= 1));
  result = BallExcesses{};
  if (!has_any(is_beyond)) return true;
  FourConditions goes_on = is_beyond & is_limited;

  // As `excess_length` of friction_shape.cc.
  for (int k = 0; k < 3; ++k) {
    const Four part = target[k] / reach;
    ratio[k] = part * part * radii[k];
  }
  const Four start = reach - (ratio[0] + ratio[1] + ratio[2]);
  Four length = is_limited ? (start > 0 ? start : none) : reach;
  for (int iteration = 0; iteration < kMostIterations && has_any(goes_on); ++iteration) {
    Four inverse[3], sum, root, slope[3];
    for (int k = 0; k < 3; ++k) {
      inverse[k] = 1 / (radii[k] + length);
      ratio[k] = target[k] * inverse[k];
      slope[k] = ratio[k] * ratio[k] * inverse[k];
    }
    square_of(ratio, sum);
    is_outside(sum, outside);
    if (has_any(goes_on & outside)) return false;
    take_root(sum, root);
    const Four step = (root - 1) * root * root / (slope[0] + slope[1] + slope[2]);
    goes_on &= step > 0;
    length = goes_on ? length + step : length;
    goes_on &= step > kSmall * length;
  }

  result.slides = is_beyond & (length > 0);
  result.length = result.slides ? length : none;
  for (int k = 0; k < 3; ++k) ratio[k] = target[k] / (radii[k] + length);
  square_of(ratio, squares);
  is_outside(squares, outside);
  if (has_any(result.slides & outside)) return false;
  take_root(squares, reach);
  const Four inverse = 1 / reach;
  for (int k = 0; k < 3; ++k) result.boundary[k] = result.slides ? ratio[k] * inverse : none;
  return true;
}

}  // namespace softfinger
