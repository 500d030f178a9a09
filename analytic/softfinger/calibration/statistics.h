#pragma once

/// The few distributions that intervals and tests of a fit need. Degrees of freedom may be
/// infinite, where Student's distribution is the normal one.
namespace softfinger::statistics {

/// Probability that Student's t exceeds |t| on either side.
/// @param freedom  >= 1; a fraction is rounded down, which is the cautious side
double student_two_sided(double t, double freedom) noexcept;

/// The t that is exceeded on either side with this probability, to 1e-12.
/// @param probability  0 < probability < 1
double student_quantile(double probability, double freedom) noexcept;

/// Probability that chi squared exceeds `value`.
/// @param freedom  a whole number >= 1
double chi_squared_exceeds(double value, int freedom) noexcept;

}  // namespace softfinger::statistics
