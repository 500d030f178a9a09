// softfinger-fem-relative-radii: how far the relative radii alone decide a contact, the central
// step of the method of Ciocarlie et al. (2007), eq. (8). The same relative radii are realised as a
// flat layer under a curved object and as a curved finger under a flat object, pressed with the
// same load. A real finger's surface is replaced by its quadric as well. Prints the table of
// docs/measurements/finite_elements.md.

#include <fmt/core.h>

#include <cmath>

#include "fem/linear/model_cache.h"
#include "fem/program/reference_solver.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "softfinger/input/errors.h"

namespace {

namespace fem = softfinger::fem;
namespace meshes = softfinger::meshes;

constexpr double thickness_m = 2e-3, youngs_modulus_Pa = 3e5, friction_coefficient = 0.8;

fem::Result solve(const fem::Problem& problem) {
  return fem::solve(problem, [](const std::string&) {});
}

fem::Problem flat(double major_m, double minor_m, double poisson_ratio, double load_N, int level) {
  fem::Problem problem;
  problem.name = "flat layer";
  problem.contact = {{major_m, minor_m, 0},
                     {thickness_m, youngs_modulus_Pa, poisson_ratio},
                     {load_N, friction_coefficient}};
  problem.level = level;
  return problem;
}

/// The load that presses the flat layer by this share of its thickness.
double load_for(double share, double major_m, double minor_m, double poisson_ratio) {
  double load_N =
      0.5 * youngs_modulus_Pa * share * share * thickness_m * std::sqrt(major_m * minor_m);
  double exponent =
      2;  // of the load as a power of the approach: between Hertz's 3/2 and Winkler's 2
  for (int iteration = 0; iteration < 3; ++iteration) {
    const fem::Result result = solve(flat(major_m, minor_m, poisson_ratio, load_N, 1));
    load_N *= std::pow(share * thickness_m / result.finest.indentation_m, exponent);
  }
  return load_N;
}

std::string differences(const fem::Result& flat, const fem::Result& other) {
  const auto cell = [](double from, double to, double error, double other_error) {
    return fmt::format(" {:+.1f} ± {:.1f} |", 100 * (to / from - 1), 100 * (error + other_error));
  };
  return cell(flat.finest.a_m, other.finest.a_m, flat.error.a, other.error.a) +
         cell(flat.finest.b_m, other.finest.b_m, flat.error.b, other.error.b) +
         cell(flat.finest.indentation_m, other.finest.indentation_m, flat.error.indentation,
              other.error.indentation) +
         cell(flat.finest.peak_pressure_Pa, other.finest.peak_pressure_Pa, flat.error.peak_pressure,
              other.error.peak_pressure) +
         cell(flat.finest.max_torque_Nm, other.finest.max_torque_Nm, flat.error.max_torque,
              other.error.max_torque);
}

struct Finger {
  std::string name;
  double major_m, minor_m;
  std::shared_ptr<const meshes::PadSurface> pad;
};

void compare(const Finger& finger, double poisson_ratio, double share) {
  fmt::print("| {} | {:.2f} | {:.2f} | {:.1f} |", finger.name,
             thickness_m / std::sqrt(finger.major_m * finger.minor_m), poisson_ratio, share);
  try {
    const double load_N = load_for(share, finger.major_m, finger.minor_m, poisson_ratio);
    const fem::Problem on_flat = flat(finger.major_m, finger.minor_m, poisson_ratio, load_N, 2);
    fem::Problem curved = on_flat;
    curved.name = finger.name;
    curved.fingertip.pad = finger.pad;
    curved.fingertip.object = meshes::quadric_object(std::numeric_limits<double>::infinity(),
                                                     std::numeric_limits<double>::infinity());
    curved.fingertip.symmetric_object = true;
    const fem::Result reference = solve(on_flat);
    const std::string row = differences(reference, solve(curved));
    fmt::print(" {:.2f} |{}\n", reference.finest.a_m / std::sqrt(finger.major_m * finger.minor_m),
               row);
  } catch (const softfinger::InputError& error) {
    // Layers do not fit on every finger, and their contact does not fit on every layer.
    fmt::print(" | refused | | | | |\n");
    std::fprintf(stderr, "%s\n", error.what());
  }
  std::fflush(stdout);
}

}  // namespace

int main() {
  fmt::print(
      "| finger | h/R | nu | d/h | a/R | a (%) | b (%) | d (%) | peak (%) | torque (%) |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const double ratio : {1.0, 4.0})
    for (const double thickness_per_radius : {0.02, 0.05, 0.1, 0.2, 0.5}) {
      const double R = thickness_m / thickness_per_radius;
      const double major = R * std::sqrt(ratio), minor = R / std::sqrt(ratio);
      const Finger finger{ratio == 1 ? "sphere" : "ellipsoid, R'/R'' = 4", major, minor,
                          ratio == 1 ? meshes::sphere_pad(R) : meshes::ellipsoid_pad(major, minor)};
      for (const double poisson_ratio : {0.3, 0.49})
        for (const double share : {0.1, 0.3}) compare(finger, poisson_ratio, share);
    }
  // A finger like those of robot hands: 6 mm and 12 mm, and narrower by 3 % per millimetre.
  const double major = 12e-3, minor = 6e-3;
  const Finger tapered{"tapered, 30 per m", major, minor, meshes::tapered_pad(major, minor, 30)};
  for (const double share : {0.1, 0.3}) compare(tapered, 0.45, share);
  const Finger straight{"the same without taper", major, minor,
                        meshes::tapered_pad(major, minor, 0)};
  for (const double share : {0.1, 0.3}) compare(straight, 0.45, share);
}
