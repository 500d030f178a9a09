#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

#include "quadrature.h"
#include "softfinger/friction/ellipsoid_deviation.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/friction/sampled_pressure.h"
#include "softfinger/friction/shear_limit.h"
#include "softfinger/friction/shear_surface.h"
#include "softfinger/input/constants.h"
#include "tests/allocation_counter.h"

namespace softfinger {
namespace {

using Kind = ShearLaw::Kind;
constexpr double kMu = 0.8, kLoad_N = 2;

double peak_Pa(const PressedEllipse& contact) {
  return (contact.exponent + 1) * contact.load_N / (kPi * contact.a_m * contact.b_m);
}

/// `limited` with its strength at this share of mu p_0.
ShearLaw limited_at(double share, const PressedEllipse& contact) {
  return {Kind::limited, kMu, share * kMu * peak_Pa(contact)};
}

/// int_0^1 f(s, w) ds of w = 1 - s², by pieces between the given radii: tanh-sinh in long double.
long double integrate_radii(std::vector<double> breaks,
                            const std::function<long double(long double, long double)>& f) {
  breaks.insert(breaks.begin(), 0.0);
  breaks.push_back(1.0);
  std::sort(breaks.begin(), breaks.end());
  long double sum = 0;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const long double low = breaks[i], length = breaks[i + 1] - low;
    if (!(length > 0)) continue;
    sum += testing::integrate_line(-4.5L, 4.5L, 0.05L, [&](long double t) {
      const long double u = M_PIl / 2 * std::sinh(t);
      const long double x = 1 / (1 + std::exp(-2 * u)), y = 1 / (1 + std::exp(2 * u));
      const long double s = low + length * x;
      const long double w = breaks[i + 1] == 1 ? length * y * (1 + s) : (1 - s) * (1 + s);
      return f(s, w) * length * M_PIl * std::cosh(t) * x * y;
    });
  }
  return sum;
}

/// Force and torque of a law by quadrature over rings: dA = 2 pi a b s ds, mean radius of a ring
/// s a (2/pi) E by quadrature over its angle.
struct Resultants {
  double force_N, torque_Nm;
};
Resultants by_quadrature(const ShearLaw& law, const PressedEllipse& contact,
                         const std::vector<double>& breaks) {
  const long double p0 = peak_Pa(contact), a = contact.a_m, b = contact.b_m;
  const auto stress = [&](long double w) -> long double {
    const long double friction = law.friction_coefficient * p0 * std::pow(w, contact.exponent);
    const long double strength = law.shear_strength_Pa;
    switch (law.kind) {
      case Kind::coulomb:
        return friction;
      case Kind::shear_strength:
        return strength;
      case Kind::limited:
        return std::min(friction, strength);
      case Kind::adhesive_shear:
        return friction + strength;
    }
    return 0;
  };
  const long double mean_radius =
      testing::integrate_quadrant(
          0.18L, 42,
          [&](long double sine, long double cosine) { return std::hypot(a * cosine, b * sine); }) /
      (M_PIl / 2);
  const long double area = 2 * M_PIl * a * b;
  return {double(area * integrate_radii(
                            breaks, [&](long double s, long double w) { return s * stress(w); })),
          double(area * mean_radius * integrate_radii(breaks, [&](long double s, long double w) {
                   return s * s * stress(w);
                 }))};
}

TEST(ShearLaw, ConstantStressOnACircleTurnsWithTwoThirdsPiTauACubed) {
  const ShearLaw law{Kind::shear_strength, 0, 4e4};
  const PressedEllipse contact{3e-3, 3e-3, 0.5, 1};
  EXPECT_NEAR(max_torque_Nm(law, contact) / (2 * kPi / 3 * 4e4 * 27e-9), 1, 1e-14);
  EXPECT_NEAR(max_force_N(law, contact) / (kPi * 9e-6 * 4e4), 1, 1e-14);
}

TEST(ShearLaw, ConstantStressOnAnEllipseEqualsQuadrature) {
  testing::WorstError worst("constant shear stress on ellipses against quadrature");
  for (const double aspect : {1.0, 1.3, 2.0, 10.0, 1e3}) {
    const ShearLaw law{Kind::shear_strength, 0, 4e4};
    const PressedEllipse contact{3e-3, 3e-3 / aspect, 1, kLoad_N};
    const auto torque = testing::integrate_ellipse(
        3e-3L, 3e-3L / aspect,
        [](long double x, long double y) { return 4e4L * std::hypot(x, y); });
    EXPECT_LT(worst.of(max_torque_Nm(law, contact), double(torque)), 1e-13) << aspect;
  }
}

// T = 2 pi [tau_0 c³/3 + mu p_0 int_c^a sqrt(1 - r²/a²) r² dr], the integral by hand.
TEST(ShearLaw, LimitedFrictionOnAHertzCircleHasTheClosedForm) {
  testing::WorstError worst("limited friction on a Hertz circle against its closed form");
  const double a = 2e-3;
  const PressedEllipse contact{a, a, 0.5, kLoad_N};
  for (const double share : {0.01, 0.2, 0.5, 0.9, 0.999, 1.0, 1.5}) {
    const ShearLaw law = limited_at(share, contact);
    const double sine = std::sqrt(1 - std::pow(std::min(share, 1.0), 2)), c = a * sine;
    // r = a cos t: int sin² cos² dt = t/8 - sin(4t)/32, from 0 to acos(c/a)
    const double t = std::asin(std::min(share, 1.0));
    const double rim = a * a * a * (t / 8 - std::sin(4 * t) / 32);
    const double torque =
        2 * kPi * (law.shear_strength_Pa * c * c * c / 3 + kMu * peak_Pa(contact) * rim);
    // t/8 - sin(4t)/32 ~ t³/3: the difference loses 1e-16/t² of the rim's part, t = share.
    EXPECT_LT(worst.of(max_torque_Nm(law, contact), torque), 1e-12) << share;
  }
}

TEST(ShearLaw, EqualsQuadratureForEveryLawExponentAndAspect) {
  testing::WorstError forces("largest force against quadrature");
  testing::WorstError torques("largest torque against quadrature");
  for (const double exponent : {-0.6, -0.1, 0.0, 0.3, 0.5, 1.0, 1.7, 2.0, 6.0, 40.0})
    for (const double aspect : {1.0, 3.0, 100.0})
      for (const double share : {1e-3, 0.3, 0.7, 0.97, 1.2, 4.0})
        for (const Kind kind :
             {Kind::coulomb, Kind::shear_strength, Kind::limited, Kind::adhesive_shear}) {
          const PressedEllipse contact{1e-3 * aspect, 1e-3, exponent, kLoad_N};
          ShearLaw law = limited_at(share, contact);
          law.kind = kind;
          std::vector<double> breaks;
          if (exponent != 0)
            if (const double w = std::pow(share, 1 / exponent); w < 1)
              breaks.push_back(std::sqrt(1 - w));
          const Resultants exact = by_quadrature(law, contact, breaks);
          EXPECT_LT(forces.of(max_force_N(law, contact), exact.force_N), 1e-12)
              << law.name() << " n " << exponent << " share " << share;
          EXPECT_LT(torques.of(max_torque_Nm(law, contact), exact.torque_Nm), 1e-12)
              << law.name() << " n " << exponent << " share " << share;
        }
}

TEST(ShearLaw, LimitedFrictionTendsToCoulombAndToTheStrength) {
  const PressedEllipse contact{3e-3, 2e-3, 0.8, kLoad_N};
  EXPECT_EQ(max_torque_Nm(limited_at(1.01, contact), contact),
            max_torque_Nm(ShearLaw::coulomb(kMu), contact));
  const ShearLaw weak = limited_at(1e-9, contact);
  const ShearLaw strength{Kind::shear_strength, 0, weak.shear_strength_Pa};
  // The deficit at the rim is of the order (tau_0 / mu p_0)^(1/n).
  EXPECT_NEAR(max_torque_Nm(weak, contact) / max_torque_Nm(strength, contact), 1, 1e-10);
}

TEST(ShearLaw, ContactsWithoutSizeOrLoadHaveNoNumberThatIsNotFinite) {
  for (const Kind kind : {Kind::coulomb, Kind::shear_strength, Kind::limited, Kind::adhesive_shear})
    for (const double size : {0.0, 1e-3})
      for (const double load : {0.0, 1.0})
        for (const double exponent : {-0.5, 0.0, 0.5, 2.0})
          for (const double mu : {0.0, 0.5})
            for (const double strength : {0.0, 1e4}) {
              const ShearLaw law{kind, mu, strength};
              const PressedEllipse contact{size, size, exponent, load};
              const FrictionEllipsoid ellipsoid = friction_ellipsoid(law, contact);
              EXPECT_TRUE(std::isfinite(ellipsoid.max_force_N)) << law.name();
              EXPECT_TRUE(std::isfinite(ellipsoid.eccentricity_m)) << law.name();
              const LimitWrench wrench =
                  ShearSurface(law, contact).wrench_for_twist({0.3, 0.2, 1e3});
              EXPECT_TRUE(std::isfinite(wrench.force_x_N + wrench.force_y_N + wrench.torque_Nm));
            }
}

/// Random slips, spread over the scaled space.
class RandomTwist {
 public:
  Twist operator()(double arm_m) {
    const double heading = kPi * uniform_(engine_), exponent = 2 * uniform_(engine_);
    return {std::cos(heading), std::sin(heading), std::pow(10, exponent) / arm_m};
  }

 private:
  std::mt19937 engine_{20070324};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

/// Distance of two wrenches in the scaled space.
double distance(const LimitWrench& one, const LimitWrench& two, const FrictionEllipsoid& limits) {
  return std::hypot(one.force_x_N - two.force_x_N, one.force_y_N - two.force_y_N,
                    (one.torque_Nm - two.torque_Nm) / limits.eccentricity_m) /
         limits.max_force_N;
}

LimitWrench sum(const LimitWrench& one, const LimitWrench& two, double factor = 1) {
  return {one.force_x_N + factor * two.force_x_N, one.force_y_N + factor * two.force_y_N,
          one.torque_Nm + factor * two.torque_Nm};
}

TEST(ShearSurface, OfCoulombsLawIsTheLimitSurface) {
  const PressedEllipse contact{3e-3, 1e-3, 0.7, kLoad_N};
  const ShearSurface surface(ShearLaw::coulomb(kMu), contact);
  const LimitSurface known(3e-3, 1e-3, 0.7, kMu * kLoad_N);
  RandomTwist slip;
  for (int i = 0; i < 50; ++i) {
    const Twist twist = slip(1e-3);
    EXPECT_LT(
        distance(surface.wrench_for_twist(twist), known.wrench_for_twist(twist), known.ellipsoid()),
        1e-14);
  }
}

// min(mu p, tau_0) = mu p - (mu p - tau_0), where the latter is a pressure of the same family on a
// smaller ellipse for n = 1, and a sum of two for n = 2.
TEST(ShearSurface, OfLimitedFrictionEqualsTheDifferenceOfSurfacesForWholeExponents) {
  double worst = 0;
  RandomTwist slip;
  for (const double aspect : {1.0, 1.1, 2.5, 20.0, 300.0})
    for (const double share : {0.02, 0.3, 0.8, 0.99})
      for (const int exponent : {1, 2}) {
        const PressedEllipse contact{1e-3 * aspect, 1e-3, double(exponent), kLoad_N};
        const ShearLaw law = limited_at(share, contact);
        const ShearSurface surface(law, contact);
        // mu p_0 [(d + z)^n - d^n], d = 1 - c², z = c² - s² = c² (1 - s²/c²)
        const double d = std::pow(share, 1.0 / exponent), c2 = 1 - d, c = std::sqrt(c2);
        const auto part = [&](int k, double factor) {
          const double peak = factor * std::pow(c2, k) * kMu * peak_Pa(contact);
          const double area = kPi * contact.a_m * contact.b_m * c2;
          return LimitSurface(c * contact.a_m, c * contact.b_m, k, peak * area / (k + 1));
        };
        const LimitSurface whole(contact.a_m, contact.b_m, exponent, kMu * kLoad_N);
        for (int i = 0; i < 60; ++i) {
          const Twist twist = slip(surface.eccentricity_m());
          LimitWrench exact = whole.wrench_for_twist(twist);
          if (exponent == 1) {
            exact = sum(exact, part(1, 1).wrench_for_twist(twist), -1);
          } else {
            exact = sum(exact, part(1, 2 * d).wrench_for_twist(twist), -1);
            exact = sum(exact, part(2, 1).wrench_for_twist(twist), -1);
          }
          const double error =
              distance(surface.wrench_for_twist(twist), exact, surface.ellipsoid());
          worst = std::max(worst, error);
          // As shear_surface.h states.
          EXPECT_LT(error, 1e-9) << "a/b " << aspect << " share " << share << " n " << exponent;
        }
      }
  std::printf("limited friction against differences of limit surfaces: %.1e\n", worst);
}

/// Samples of a law's stress on a grid of rings, as forces for SampledPressure with mu = 1.
std::vector<PressureSample> samples_of(const ShearLaw& law, const PressedEllipse& contact,
                                       int rings) {
  std::vector<PressureSample> samples;
  for (int ring = 0; ring < rings; ++ring) {
    const double s = (ring + 0.5) / rings;
    const int sectors = 6 * ring + 4;
    const double pressure_Pa = peak_Pa(contact) * std::pow((1 - s) * (1 + s), contact.exponent);
    const double area = kPi * contact.a_m * contact.b_m * (2 * ring + 1) / (rings * rings);
    for (int sector = 0; sector < sectors; ++sector) {
      const double angle = 2 * kPi * (sector + 0.5) / sectors;
      samples.push_back({contact.a_m * s * std::cos(angle), contact.b_m * s * std::sin(angle),
                         law.largest_stress_Pa(pressure_Pa) * area / sectors});
    }
  }
  return samples;
}

TEST(ShearSurface, EqualsSampledStressForEveryLaw) {
  double worst = 0;
  RandomTwist slip;
  for (const double exponent : {0.0, 0.5, 1.4})
    for (const double aspect : {1.0, 3.0})
      for (const Kind kind : {Kind::shear_strength, Kind::limited, Kind::adhesive_shear}) {
        const PressedEllipse contact{1e-3 * aspect, 1e-3, exponent, kLoad_N};
        ShearLaw law = limited_at(0.4, contact);
        law.kind = kind;
        const ShearSurface surface(law, contact);
        SampledPressure sampled(samples_of(law, contact, 150), 1, 0);
        sampled.set_reference(0, 0);
        // Hertz' root at the rim: the midpoint rule's error is of order 1.5 in the ring's width.
        EXPECT_NEAR(sampled.max_force_N() / surface.max_force_N(), 1, 5e-4);
        EXPECT_NEAR(sampled.max_torque_Nm() / surface.max_torque_Nm(), 1, 5e-4);
        for (int i = 0; i < 40; ++i) {
          const Twist twist = slip(surface.eccentricity_m());
          const double error = distance(surface.wrench_for_twist(twist),
                                        sampled.wrench_for_twist(twist), surface.ellipsoid());
          worst = std::max(worst, error);
          // Rings of 1/150 of the radius: the midpoint rule's error is about the square of it, more
          // at the kink and next to the centre of rotation.
          EXPECT_LT(error, 5e-4) << law.name() << " n " << exponent << " a/b " << aspect;
        }
      }
  std::printf("laws' limit surfaces against sampled stress: %.1e\n", worst);
}

TEST(ShearSurface, TouchesItsEllipsoidAtPureForceAndPureTorque) {
  for (const double exponent : {-0.4, 0.5, 1.0, 2.3})
    for (const Kind kind : {Kind::shear_strength, Kind::limited, Kind::adhesive_shear}) {
      const PressedEllipse contact{4e-3, 1e-3, exponent, kLoad_N};
      ShearLaw law = limited_at(exponent < 0 ? 1.7 : 0.4, contact);
      law.kind = kind;
      const ShearSurface surface(law, contact);
      EXPECT_NEAR(surface.wrench_for_twist({0, 0, 1}).torque_Nm / surface.max_torque_Nm(), 1,
                  1e-11);
      EXPECT_NEAR(surface.wrench_for_twist({0, 2, 0}).force_y_N / surface.max_force_N(), 1, 1e-11);
      EXPECT_NEAR(surface.utilisation({0, surface.max_force_N(), 0}), 1, 1e-11);
    }
}

TEST(ShearSurface, PointsOfItHaveUtilisationOneAndTheTwistAsNormal) {
  RandomTwist slip;
  const PressedEllipse contact{3e-3, 1e-3, 0.5, kLoad_N};
  const ShearSurface surface(limited_at(0.4, contact), contact);
  std::vector<LimitWrench> points;
  std::vector<Twist> twists;
  for (int i = 0; i < 12; ++i) {
    twists.push_back(slip(surface.eccentricity_m()));
    points.push_back(surface.wrench_for_twist(twists.back()));
    EXPECT_NEAR(surface.utilisation(points.back()), 1, 1e-10);
    const LimitWrench out = sum(points.back(), points.back());
    EXPECT_NEAR(surface.utilisation(surface.project(out)), 1, 1e-8);
  }
  // Maximum dissipation.
  for (const Twist& twist : twists)
    for (const LimitWrench& point : points)
      EXPECT_LE(point.force_x_N * twist.velocity_x_m_per_s +
                    point.force_y_N * twist.velocity_y_m_per_s +
                    point.torque_Nm * twist.angular_velocity_rad_per_s,
                surface.support(twist) * (1 + 1e-10));
}

TEST(ShearSurface, ItsDerivativesAreDifferencesOfItsWrenches) {
  const PressedEllipse contact{3e-3, 1e-3, 0.5, kLoad_N};
  for (const Kind kind : {Kind::limited, Kind::adhesive_shear}) {
    ShearLaw law = limited_at(0.4, contact);
    law.kind = kind;
    const ShearSurface surface(law, contact);
    for (const Eigen::Vector3d& twist :
         {Eigen::Vector3d(0.2, 0.1, 0.9), Eigen::Vector3d(0.6, -0.5, 0.3)}) {
      Eigen::Matrix3d hessian;
      surface.scaled_wrench(twist, &hessian);
      constexpr double kStep = 1e-4;
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
        const Eigen::Vector3d difference = (surface.scaled_wrench(twist + step, nullptr) -
                                            surface.scaled_wrench(twist - step, nullptr)) /
                                           (2 * kStep);
        // The difference's own error is of second order.
        EXPECT_LT((difference - hessian.col(i)).norm(), 1e-6) << law.name();
      }
    }
  }
}

// The simulation replaces these laws by such a LimitSurface under the rules limit_surface and
// six_patches.
TEST(ShearSurface, IsNearlyTheLimitSurfaceOfTheExponentWithItsArm) {
  double worst = 0;
  for (const Kind kind : {Kind::limited, Kind::adhesive_shear})
    for (const double exponent : {0.5, 2.0})
      for (const double aspect : {1.0, 10.0})
        for (const double share : {0.2, 0.6}) {
          const PressedEllipse contact{1e-3 * aspect, 1e-3, exponent, kLoad_N};
          ShearLaw law = limited_at(share, contact);
          law.kind = kind;
          const ShearSurface exact(law, contact);
          double low = -0.9, high = 10;
          for (int i = 0; i < 60; ++i) {
            const double middle = (low + high) / 2;
            const bool is_long =
                torque_arm_exact_m(contact.a_m, contact.b_m, middle) > exact.eccentricity_m();
            (is_long ? low : high) = middle;
          }
          const LimitSurface simple(contact.a_m, contact.b_m, low, exact.max_force_N());
          RandomTwist slip;
          for (int i = 0; i < 20; ++i)
            worst = std::max(
                worst,
                std::abs(simple.utilisation(exact.wrench_for_twist(slip(exact.eccentricity_m()))) -
                         1));
        }
  std::printf("limit surface of the exponent with the law's arm: within %.4f\n", worst);
  EXPECT_LT(worst, 0.0105);  // as shear_surface.h states, rounded
}

// Under a constant stress, for a circle: closed form of the support function at its worst is not
// known; the numbers are those of LimitSurface with n = 0, which other tests check.
TEST(ShearSurface, EllipsoidsAreAsFarOffUnderConstantStressAsUnderUniformPressure) {
  const PressedEllipse contact{2e-3, 1e-3, 0.5, kLoad_N};
  const ShearSurface surface({Kind::shear_strength, 0, 4e4}, contact);
  const LimitSurface uniform(2e-3, 1e-3, 0, 1);
  EXPECT_NEAR(worst_ellipsoid_deviation(surface, surface.ellipsoid()).lowest,
              worst_ellipsoid_deviation(uniform, uniform.ellipsoid()).lowest, 1e-8);
}

TEST(ShearSurface, AllocatesNothing) {
  const PressedEllipse contact{3e-3, 1e-3, 0.5, kLoad_N};
  const ShearLaw law = limited_at(0.4, contact);
  ShearSurface(law, contact).utilisation({1, 0, 1e-4});
  const std::size_t before = testing::allocations();
  ShearSurface(law, contact).utilisation({1, 0, 1e-4});
  max_torque_Nm(law, contact);
  EXPECT_EQ(testing::allocations(), before);
}

}  // namespace
}  // namespace softfinger
