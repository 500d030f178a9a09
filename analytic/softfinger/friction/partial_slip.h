#pragma once

#include <vector>

/// Partial slip, the state of a contact between sticking and sliding: force over displacement and
/// torque over rotation under a constant load. All quantities are dimensionless:
///   x = k theta/T_max and y = T/T_max for a twist about the normal,
///   x = k u/(mu P) and y = F/(mu P) for a shift along the surface,
/// k the stiffness of the stuck contact (stuck_stiffness.h). Each curve starts with the slope 1 and
/// tends to 1.
namespace softfinger {

/// Torque over rotation of a contact on a layer.
///
/// Circle, any layer thickness, the base rigid: what a growing twist adds is what it would add to
/// the disc r < c that still sticks, dT = k(c) dtheta, since the shear beyond it is mu p already.
/// On a half-space (Lubkin 1951 for Hertz; Jaeger, Arch. Appl. Mech. 65 (1995) for any pressure)
///   theta(c) = mu/(2 G) int_c^a p/sqrt(r² - c²) dr,
///   T(c) = 8 mu/3 int_c^a p [c³/sqrt(r² - c²) + 3/2 (r² acos(c/r) + c sqrt(r² - c²))] dr;
/// on a layer theta(c) and k(c) by the integral equation of a disc in torsion (partial_slip.cc).
/// The pressure has terms (1 - r²)^(1/2) and (1 - r²)^(3/2), such that T_max is the given one.
/// The ends of an ellipse slip earlier than a circle does. By how much is taken from a thin layer,
/// of which each point is sheared by itself: T = int min(G theta r/h, mu p) r dA over the same
/// integral of the circle.
///
/// Off by, in parts of T_max: 4e-6 for Lubkin's circle; at most 0.2 % for circles on layers to
/// a/h = 5 (integral equation under the pressure of their own contact); with ellipse, k, T_max and
/// n of `bonded_layer` at most 0.8 % against finite elements of eleven layers to a/b = 3, and 1.5 %
/// of one at a/b = 6 (partial_slip_test.cc prints them).
class TwistCurve {
 public:
  /// @param exponent  n of the pressure (1 - x²/a² - y²/b²)^n with the same T_max, 0.5 to 50.
  ///   equivalent_exponent gives that of a prediction.
  /// @param aspect    b/a, 1e-3 to 1
  /// @param size      a/h, 0 (a half-space) to 30
  /// Others are taken for the nearest of these. Allocates; 0.5 ms, 1.3 ms for an ellipse.
  explicit TwistCurve(double exponent, double aspect = 1, double size = 0);

  /// y of x; odd. No allocation, a binary search.
  double operator()(double x) const noexcept;

 private:
  struct Knot {
    double x, y, slope;
  };
  std::vector<Knot> knots_;
};

/// Force over displacement. What a growing shift adds is what it would add to a smaller contact
/// that sticks, that under the load P (1 - y) (Cattaneo 1938, Mindlin 1949; Ciavarella, J. Appl.
/// Mech. 65 (1998), Jaeger for any shape): dy/dx = k(P (1 - y))/k(P). With k ~ P^q near the load,
///   y = 1 - (1 - (1 - q) x)^(1/(1 - q)),   sliding from x = 1/(1 - q) on.
/// Exact with q = 1/3 for Hertz, where it is 1 - (1 - 2 x/3)^(3/2), and with q = 1/2 for a thin
/// layer without lateral contraction.
class ShiftCurve {
 public:
  /// @param stiffness_growth  q = d ln k/d ln P at constant geometry, 0 to 0.9; others are taken
  /// for
  ///   the nearest of these.
  explicit ShiftCurve(double stiffness_growth) noexcept;

  double operator()(double x) const noexcept;  ///< y of x; odd

 private:
  double growth_;
};

/// A curve followed to and fro by Masing's rules: from each reversal on at twice its scale,
///   y = y_r + 2 f((x - x_r)/2),
/// until the branch before is met again, which then goes on as if nothing had been (return-point
/// memory). Equal to slip in the contact: what has slipped forwards sticks until it is turned by
/// twice its limit (Mindlin, Deresiewicz 1953). No closed loop gives work away.
///
/// `Curve` is odd, concave for x > 0, a copy is kept. Memory grows with the nesting of reversals.
template <class Curve>
class MasingPath {
 public:
  explicit MasingPath(Curve curve) : curve_(std::move(curve)) {}

  double x() const noexcept { return x_; }
  double y() const noexcept { return y_; }
  /// Number of reversals that are remembered.
  std::size_t memory() const noexcept { return reversals_.size(); }

  /// Goes straight to `x`. @returns y there
  double go_to(double x) {
    const int direction = (x > x_) - (x < x_);
    if (direction == 0) return y_;
    if (last_direction_ != 0 && direction != last_direction_) reversals_.push_back({x_, y_});
    last_direction_ = direction;
    // Past where the loop closes, the branch before it goes on.
    while (reversals_.size() > 1 && direction * (x - reversals_[reversals_.size() - 2].x) >= 0) {
      reversals_.pop_back();
      reversals_.pop_back();
    }
    if (reversals_.size() == 1 && direction * (x + reversals_.front().x) >= 0) reversals_.clear();
    x_ = x;
    if (reversals_.empty())
      y_ = curve_(x);
    else
      y_ = reversals_.back().y + 2 * curve_((x - reversals_.back().x) / 2);
    return y_;
  }

 private:
  struct Point {
    double x, y;
  };
  Curve curve_;
  double x_ = 0, y_ = 0;
  int last_direction_ = 0;
  std::vector<Point> reversals_;
};

}  // namespace softfinger
