// Bonded layers of any thickness: against the integral equation of the circular contact, the
// spectral solution of the elliptic one, and the limits that these have.
#include <cmath>
#include <cstdio>

#include "fem/verification/contact_on_layer.h"
#include "fem/verification/groups.h"

namespace softfinger::fem::verification {
namespace {

const char* const layer_group = "layer";

std::string named(const char* format, double first, double second) {
  char buffer[80];
  std::snprintf(buffer, sizeof buffer, format, first, second);
  return buffer;
}

/// A quadric on a bonded layer by a spectral solution: units h = E* = sqrt(R'R'') = mu = 1.
struct EllipticLayer {
  double nu, ratio, load, approach, a, b, torque, peak;
};
const EllipticLayer elliptic_layers[] = {
    {0.3, 2.0, 1.6883503210488924, 0.647622319927407, 1.2212494760454247, 0.8142889116775841,
     1.0117336696278172, 0.8415215058671539},
    {0.3, 5.0, 7.085952539084279, 1.3470837151797446, 2.317539048781546, 0.948360340848445,
     6.911504668711859, 1.6675806765144725},
    {0.45, 2.0, 0.0013490628323070634, 0.009318076618134639, 0.12554126368847873,
     0.07919173130949865, 8.239266516201877e-05, 0.0647900577161959},
    {0.45, 10.0, 23.43229106193621, 2.0395224783018886, 3.5316080195323623, 1.0806861699132428,
     32.232826992502815, 3.365851243373332},
    {0.49, 5.0, 0.1901065714715745, 0.1753970628018543, 0.813087169965468, 0.2989093959050494,
     0.06541525116423813, 0.37606185273721565},
    {0.49, 10.0, 453.454937242854, 6.48941764539096, 6.5956890417439675, 2.3020513760142425,
     1133.6465720774522, 18.99192768221148},
    {0.4999, 5.0, 0.06287671185125823, 0.09393335341886448, 0.5790825369737644, 0.20630110619423694,
     0.015361121512378024, 0.2517574326483083},
    {0.5, 2.0, 0.0108638326772662, 0.03425257669248251, 0.2508582259897134, 0.1586306735082294,
     0.0013268573352308785, 0.13036126898446906},
    {0.5, 10.0, 134.25612262669745, 3.667306143884491, 4.9551739129249155, 1.6976429667359754,
     254.91735061957047, 9.709726458636839},
    {0.0, 2.0, 2092.1797683817103, 25.794676349890963, 8.357894461486248, 5.85572721170499,
     8191.9928565664695, 25.795765344065313},
    {0.0, 10.0, 0.5541741079532991, 0.3569715565245599, 1.3843913363380316, 0.33509038142323627,
     0.30544772836931333, 0.5766759652299884},
    {0.4, 5.0, 13488.663378914096, 49.50853288948862, 14.895616311673825, 6.705436514460537,
     80639.51686740966, 86.06451488267554},
};

struct EllipticContact {
  Problem problem;
  Expected expected;
  std::string name;
};

EllipticContact elliptic_contact(const EllipticLayer& layer) {
  const double h = 2e-3, E = 3e5, mu = 0.1, R = 60 * layer.a * h;
  const double modulus = E / (1 - layer.nu * layer.nu);
  Problem problem;
  problem.contact = {{R * std::sqrt(layer.ratio), R / std::sqrt(layer.ratio), 0},
                     {h, E, layer.nu},
                     {layer.load * modulus * h * h * h / R, mu}};
  Expected expected;
  expected.a_m = layer.a * h;
  expected.b_m = layer.b * h;
  expected.indentation_m = layer.approach * h * h / R;
  expected.max_torque_Nm = layer.torque * mu * modulus * std::pow(h, 4) / R;
  expected.peak_pressure_Pa = layer.peak * modulus * h / R;
  expected.reference_error = 1e-5;
  expected.edge_reference_error = layer.a > 5 || layer.ratio > 5 ? 2.3e-4 : 2e-5;
  expected.reference = "the spectral solution's";
  return {problem, expected, named("elliptic, nu %.4g, R'/R'' %.3g", layer.nu, layer.ratio)};
}

/// Contacts on the meshes of larger ones, as they come in a run of several loads: cells up to 1.6
/// times as large, and the contact's edge anywhere among them.
Checks check_reused(bool quick) {
  Checks checks;
  const double larger_loads[] = {1.3, 2.2, 3.5};
  int contacts = 0, served = 0;
  const auto add = [&](const std::string& name, const Problem& problem, const Expected& expected) {
    const Checks more =
        compare_reused(layer_group, name, problem, expected, larger_loads[contacts++ % 3]);
    served += !more.empty();
    checks.insert(checks.end(), more.begin(), more.end());
  };
  for (const CircularLayer& layer : circular_layers()) {
    if (layer.nu == 0.45 || layer.s < 0.1 || layer.s == 0.2 || layer.s > 5) continue;
    if (quick && !(layer.nu == 0.3 && layer.s == 1)) continue;
    add(named("circular, nu %.4g, a/h %.3g", layer.nu, layer.s), circular_problem(layer),
        expected_of(layer));
  }
  for (const EllipticLayer& layer : elliptic_layers) {
    if (quick || layer.ratio > 5 || layer.a > 5) continue;
    const EllipticContact contact = elliptic_contact(layer);
    add(contact.name, contact.problem, contact.expected);
  }
  Check share{layer_group,
              "meshes of " + std::to_string(contacts) + " larger contacts, loads 1.3 to 3.5 times",
              "share of the contacts that they serve", 0.5, static_cast<double>(served) / contacts};
  share.relation = Relation::at_least;
  share.reason = "one factorisation serves many loads";
  checks.push_back(share);
  return checks;
}

/// At given load a nearly incompressible layer approaches the incompressible one linearly.
Check nearly_incompressible() {
  // From the rows nu = 0.45 and 1/2 at a/h = 1, brought to the same P R/(E h³).
  const CircularLayer &compressible = circular_layer(0.45, 1), &limit = circular_layer(0.5, 1);
  const double load_ratio = (limit.load / (1 - 0.25)) / (compressible.load / (1 - 0.45 * 0.45));
  // a grows as the load to about 1/3.5 there, d as a to about 1.6.
  const double slope =
      (compressible.approach * std::pow(load_ratio, 1.6 / 3.5) / limit.approach - 1) / 0.1;
  Problem problem = circular_problem(limit);
  const double incompressible = solve_quietly(problem).finest.indentation_m;
  problem.contact.layer.poisson_ratio = 0.4999;
  const Result nearly = solve_quietly(problem);
  Check check{layer_group, "nu 0.4999 against 1/2, a/h 1", "ratio of d", 1 + slope * 2e-4,
              nearly.finest.indentation_m / incompressible};
  check.tolerance = 0.5 * slope * 2e-4;
  check.reason = "half the difference itself: its slope is taken over 0.1 in 1 - 2 nu";
  return check;
}

/// d R/a² -> 1/4 as a/h grows, very slowly: with h/a. Extrapolated from a/h of about 10 and 20;
/// thinner layers leave a, at the elements of level 2, to one or two cells per thickness.
Check thin_incompressible() {
  Problem problem = circular_problem(circular_layer(0.5, 20));
  struct Measured {
    double s, ratio, stated;
  };
  const auto measure = [&] {
    const Result result = solve_quietly(problem);
    const double a = result.finest.a_m;
    return Measured{a / problem.contact.layer.thickness_m,
                    result.finest.indentation_m * problem.contact.radii.major_m / (a * a),
                    result.error.indentation + 2 * result.error.a};
  };
  const Measured thin = measure();
  problem.contact.load.normal_force_N /= 45;  // P grows with a^5.5 there
  const Measured thick = measure();
  const double distance = thin.s - thick.s, limit = 0.25;
  Check check{layer_group, "thin incompressible, a/h 10 and 20", "d R/a², extrapolated in h/a",
              limit, (thin.s * thin.ratio - thick.s * thick.ratio) / distance};
  const double first_order = thin.ratio / limit - 1;
  check.tolerance =
      first_order * first_order * thin.s / thick.s +
      (thin.s * thin.ratio * thin.stated + thick.s * thick.ratio * thick.stated) / distance / limit;
  check.reason = "next order, the first one's square; stated errors of d and a², extrapolated";
  return check;
}

}  // namespace

Checks check_layer(bool quick) {
  Checks checks;
  const auto add = [&](const Checks& more) {
    checks.insert(checks.end(), more.begin(), more.end());
  };
  for (const CircularLayer& layer : circular_layers()) {
    // 0.05 and 0.2 lie between half-space and layer like 0.1.
    const bool skipped = layer.s == 0.05 || layer.s == 0.2;
    const bool chosen = layer.s == 1 && (layer.nu == 0.3 || layer.nu == 0.5);
    if (quick ? chosen : !skipped)
      add(compare(layer_group, named("circular, nu %.4g, a/h %.3g", layer.nu, layer.s),
                  circular_problem(layer), expected_of(layer)));
  }
  for (const EllipticLayer& layer : elliptic_layers) {
    if (quick && !(layer.nu == 0.3 && layer.ratio == 2)) continue;
    const EllipticContact contact = elliptic_contact(layer);
    add(compare(layer_group, contact.name, contact.problem, contact.expected));
  }
  add(check_reused(quick));
  if (quick) return checks;
  add({nearly_incompressible()});
  add({thin_incompressible()});
  return checks;
}

}  // namespace softfinger::fem::verification
