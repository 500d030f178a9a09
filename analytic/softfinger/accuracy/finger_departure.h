#pragma once

#include <array>
#include <cstddef>

#include "softfinger/accuracy/error_bound.h"

/// How far `bonded_layer`, a flat layer in linear theory, is from the finger.
namespace softfinger {

constexpr std::size_t kDepartureTerms = 36;

/// What makes a finger differ from a flat layer in linear theory: strain, slopes, curvature of the
/// layer, and products of them with functions of nu and s. Each vanishes with h/R.
/// @param flat  the prediction of `bonded_layer`
std::array<double, kDepartureTerms> departure_terms(const ContactProblem& problem,
                                                    const Prediction& flat,
                                                    const FingerShare& share) noexcept;

/// Which of the four each term belongs to; none to the model itself.
ErrorCause cause_of_term(std::size_t term) noexcept;

/// The size of all of them together: strain, slopes and curvature.
double departure_size(const ContactProblem& problem, const Prediction& flat,
                      const FingerShare& share) noexcept;

/// A fit to finite-element runs of whole fingers, by `softfinger atlas --fit-departure`: per
/// quantity, the coefficients of the terms, and a width that holds 95 % of the residuals:
/// width = least + per_size * departure_size.
struct DepartureFit {
  std::array<double, kDepartureTerms> coefficients;
  double width_least, width_per_size;
};
extern const std::array<DepartureFit, kBoundedQuantities> kDepartureFits;

/// What 95 % of these runs state at most as their own errors.
extern const BoundedErrors kFiniteElementErrors;

/// Where the runs lie. Beyond them nothing is known.
struct DepartureRange {
  double largest_size = 20;           ///< s = sqrt(ab)/h
  double largest_radii_ratio = 20;    ///< R'/R''
  double largest_thickness = 0.6;     ///< h/sqrt(R' R'') of a finger, in which a core is left
  double largest_flat_thickness = 5;  ///< the same of a flat layer under a curved object
  double largest_slope = 0.6;         ///< a/R' and b/R''
  double largest_strain = 0.4;        ///< d/h
};
constexpr DepartureRange kDepartureRange;

}  // namespace softfinger
