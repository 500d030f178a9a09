// Contacts of a half-space. The finite elements have a layer, 20 times thicker than the contact is
// wide; what its base takes from the approach is added from the layer's kernel, to first order:
//   d = d_Hertz - P D / (pi E* h),  D = int_0^inf (1 - w(x)) dx,
//   w(x) = [2 kappa sinh 2x - 4x] / [2 kappa cosh 2x + 4x² + 1 + kappa²],  kappa = 3 - 4 nu
// (Johnson, Contact Mechanics, 5.8). a, p and torque change in the third order of a/h only.
#include <cmath>

#include "fem/verification/contact_on_layer.h"
#include "fem/verification/groups.h"

namespace softfinger::fem::verification {
namespace {

const char* const hertz_group = "Hertz";

double missing_compliance(double nu) {
  const double kappa = 3 - 4 * nu;
  constexpr int intervals = 4000;
  constexpr double end = 20, step = end / intervals;  // 1 - w falls as exp(-2x)
  double sum = 0;
  for (int i = 0; i <= intervals; ++i) {
    const double x = i * step, weight = i == 0 || i == intervals ? 1 : i % 2 ? 4 : 2;
    const double w = (2 * kappa * std::sinh(2 * x) - 4 * x) /
                     (2 * kappa * std::cosh(2 * x) + 4 * x * x + 1 + kappa * kappa);
    sum += weight * step / 3 * (1 - w);
  }
  return sum;
}

/// An exact Hertz contact under a rigid quadric, E* = E/(1 - nu²).
struct Hertz {
  const char* name;
  double major_m, minor_m, modulus_Pa, load_N;
  double a_m, b_m, approach_m, peak_Pa;
};

Checks check(const Hertz& hertz, double nu) {
  constexpr double mu = 0.1, thinness = 0.05;  // a/h
  const double h = hertz.a_m / thinness;
  Problem problem;
  problem.contact = {{hertz.major_m, hertz.minor_m, 0},
                     {h, hertz.modulus_Pa * (1 - nu * nu), nu},
                     {hertz.load_N, mu}};
  Expected expected;
  expected.a_m = hertz.a_m;
  expected.b_m = hertz.b_m;
  expected.indentation_m =
      hertz.approach_m - hertz.load_N * missing_compliance(nu) / (M_PI * hertz.modulus_Pa * h);
  expected.peak_pressure_Pa = hertz.peak_Pa;
  const double modulus = std::sqrt(1 - std::pow(hertz.b_m / hertz.a_m, 2));
  expected.max_torque_Nm = 3.0 / 8 * mu * hertz.load_N * hertz.a_m * std::comp_ellint_2(modulus);
  expected.reference_error = expected.edge_reference_error = std::pow(thinness, 3);
  expected.reference = "(a/h)³ of the base";
  char name[96];
  std::snprintf(name, sizeof name, "%s, nu %.4g", hertz.name, nu);
  return compare(hertz_group, name, problem, expected);
}

Hertz circular(const char* name, double radius_m, double modulus_Pa, double load_N) {
  const double a = std::cbrt(0.75 * load_N * radius_m / modulus_Pa);
  return {name,       radius_m,         radius_m,
          modulus_Pa, load_N,           a,
          a,          a * a / radius_m, 1.5 * load_N / (M_PI * a * a)};
}

}  // namespace

Checks check_hertz(bool quick) {
  // Elliptic integrals to 25 digits.
  const Hertz ellipse_2{"ellipse, R'/R'' 2",
                        0.02,
                        0.01,
                        1e6,
                        5,
                        0.004700164007183389510,
                        0.002963903218936917367,
                        0.0009915246569217864563,
                        171369.8276069103247};
  const Hertz ellipse_10{"ellipse, R'/R'' 10",
                         0.1,
                         0.01,
                         1e6,
                         5,
                         0.009765815292923087373,
                         0.002170447753899552756,
                         0.0007123979142978329104,
                         112629.8611231355454};
  Checks checks;
  const auto add = [&](const Checks& more) {
    checks.insert(checks.end(), more.begin(), more.end());
  };
  add(check(circular("circle", 0.02, 2.5e5, 0.1), 0.3));
  if (quick) return checks;
  add(check(circular("circle", 0.02, 2.5e5, 0.1), 0.5));
  add(check(ellipse_2, 0.3));
  add(check(ellipse_10, 0.3));
  // Two like hemispheres, R = 50 mm, E = 20 GPa, approaching by 4 mm: a = 10 mm, p0 = 2798.3 MPa.
  // Each is as a rigid plane sees it: relative radius 25 mm, E* = 20 GPa / (2 (1 - nu²)).
  const double ssnv104_modulus = 20e9 / (2 * (1 - 0.3 * 0.3));
  add(check(circular("Code_Aster SSNV104", 0.025, ssnv104_modulus,
                     4.0 / 3 * ssnv104_modulus * std::pow(0.01, 3) / 0.025),
            0.3));
  // R = 1, E* = 7.5e6, F = 1e4: a = 0.1, d = 0.01.
  add(check(circular("MOOSE spherical Hertz", 1, 7.5e6, 1e4), 0.25));
  return checks;
}

}  // namespace softfinger::fem::verification
