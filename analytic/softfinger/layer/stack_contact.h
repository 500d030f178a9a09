#pragma once

#include "softfinger/input/contact_problem.h"
#include "softfinger/layer/contact_numbers.h"

namespace softfinger {

/// Contact of a rigid quadric with sublayers that are bonded to each other and to a rigid base, in
/// linear elasticity without friction, as that of a homogeneous layer times small corrections.
struct StackContact {
  bool is_solved = true;  ///< false: Newton's method did not find the size, the numbers are rough
  ContactNumbers numbers{};
  /// The homogeneous layer that `bonded_layer` would need for a contact of this size at this load.
  /// Thickness and Poisson's ratio are those of `large_contact_layer`; E follows the contact.
  ElasticLayer equivalent{};
  /// `numbers` in units of that layer, without units (LayerQuantity).
  LayerQuantities logarithms{};
  /// d ln P/d ln a of the round contact: 3 of a half-space, 4 of columns, 6 of a layer that flows;
  /// below 3 where the contact grows into softer sublayers.
  double load_exponent = 0;
  /// Numbers that its error grows with; all 0 for a homogeneous layer.
  double exponent_change = 0;  ///< `load_exponent` less the homogeneous layer's
  double log_contrast = 0;     ///< ln of the largest E* of a sublayer over the smallest
  double log_softening = 0;    ///< ln of the surface's E* over the smallest
};

/// The homogeneous layer that a contact much larger than the stack cannot tell from it. Three
/// integrals over the depth z decide there: int dz/M (columns in series), int dz/G (shear) and
/// int z² dz/G (flow of nearly incompressible layers under a frictionless surface). A layer has
/// h/M, h/G and h³/(3 G); solved for h, G and M. One sublayer is its own equivalent. The integrals
/// of two stacks that face each other add, each with z from its own surface.
/// @param object  on the object; none: it is rigid
ElasticLayer large_contact_layer(const LayerStack& stack, const LayerStack& object = {}) noexcept;

/// Solves for the pressure p = sum of c_n (1 - x²/a² - y²/b²)^(n - 1/2), n = 1 to 5, of the round
/// contact by Galerkin's method for the Fredholm equation of circular_contact.h, and takes the
/// homogeneous layer's own solution by the same method as the unit: what both miss cancels, so that
/// equal sublayers have the answer of `bonded_layer`. The stack's kernel is evaluated at 20 wave
/// numbers between 0.003/a and 60/a and interpolated by a polynomial, whose integrals with the
/// pressures' transforms are known.
///
/// R'/R'' > 1: the homogeneous layer has the ellipse's shape; sqrt(ab) stands for the radius, and
/// a/b changes with the exponent d ln P/d ln a as between the limits of one layer (3, 4, 6). Where
/// Newton's method takes one step more, a and b may jump by 3e-4 (round ones by 1e-6).
///
/// Each sublayer must lie in the ranges of contact_problem.h, `stack.count` >= 1. Results that do
/// not fit into a double come out as zero, infinity or no number. Some microseconds (see
/// tests/bench/analytic_bench.cc), no allocation.
///
/// Two stacks that face each other are one whose kernel is the sum of theirs.
/// @param object  on the object; none: it is rigid. `exponent_change`, `log_contrast` and
/// `log_softening`, by which the error of a stack is known, are then the finger's: no error is
/// known
StackContact stack_contact(const RelativeRadii& radii, const LayerStack& stack,
                           double normal_force_N, const LayerStack& object = {}) noexcept;

/// The problem with `StackContact::equivalent` in place of its sublayers; as it is without any.
ContactProblem with_equivalent_layer(ContactProblem problem) noexcept;

}  // namespace softfinger
