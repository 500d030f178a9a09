// The cost and the accuracy of the finite-element reference: CPU seconds, peak memory, unknowns,
// and the signed true error of each quantity beside the stated one. Each case is solved in a
// process of its own, so that its memory is measured alone.
//   fem_bench           all cases
//   fem_bench WORD...   those whose name contains one of the words
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "fem/program/reference_solver.h"
#include "fem/verification/torsion_reference.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "meshes/generation/surfaces.h"
#include "meshes/placement/placed_surface.h"
#include "softfinger/layer/circular_contact.h"
#include "tests/bench/calculix_job.h"

namespace softfinger {
namespace {

using fem::verification::TwistCurve;

const fem::Progress quiet = [](const std::string&) {};

/// Cost and outcome of a case, as the parent process learns them from the system.
struct Cost {
  double cpu_s = 0, peak_MB = 0;
  bool succeeded = false;
  std::string report;  ///< what the work returned, or why it failed
};

Cost run_in_child(const std::function<std::string()>& work) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe to a child");
  std::cout.flush();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no child process");
  if (child == 0) {
    close(ends[0]);
    std::string report;
    int status = 0;
    try {
      report = work();
    } catch (const std::exception& error) {
      report = std::string("failed: ") + error.what();
      status = 1;
    }
    const ssize_t written = write(ends[1], report.data(), report.size());
    _exit(written == static_cast<ssize_t>(report.size()) ? status : 1);
  }
  close(ends[1]);
  std::string report;
  char buffer[4096];
  for (ssize_t size; (size = read(ends[0], buffer, sizeof buffer)) > 0;)
    report.append(buffer, static_cast<std::size_t>(size));
  close(ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {seconds(usage.ru_utime) + seconds(usage.ru_stime),
          static_cast<double>(usage.ru_maxrss) / 1024,
          WIFEXITED(status) && WEXITSTATUS(status) == 0, report};
}

/// Prints what the work returns after what it cost.
Cost run_case(const std::string& name, const std::function<std::string()>& work) {
  Cost cost = run_in_child(work);
  std::printf("%-34s %7.2f %6.0f  %s\n", name.c_str(), cost.cpu_s, cost.peak_MB,
              cost.report.c_str());
  std::fflush(stdout);
  return cost;
}

std::string text(const char* format, double first, double second) {
  char buffer[80];
  std::snprintf(buffer, sizeof buffer, format, first, second);
  return buffer;
}

/// "true / stated" in percent.
std::string errors(double value, double truth, double stated) {
  return text(" %+8.4f /%7.4f", 100 * (value / truth - 1), 100 * stated);
}

struct Truth {
  double a_m = 0, b_m = 0, indentation_m = 0, max_torque_Nm = 0;
  double area_m2 = 0;  ///< of the deformed surface; 0: not known
};

std::string compare(const fem::Result& result, const Truth& truth) {
  char unknowns[16];
  std::snprintf(unknowns, sizeof unknowns, "%8ld", result.finest.unknowns);
  return unknowns +
         errors(result.finest.indentation_m, truth.indentation_m, result.error.indentation) +
         errors(result.finest.max_torque_Nm, truth.max_torque_Nm, result.error.max_torque) +
         errors(result.finest.a_m, truth.a_m, result.error.a) +
         errors(result.finest.b_m, truth.b_m, result.error.b) +
         (truth.area_m2 > 0 ? errors(result.finest.area_m2, truth.area_m2, result.error.area) : "");
}

/// Returns a finer level's answer, to serve as the truth; none, after a line that says why, where
/// the level fails.
std::optional<Truth> found_on_level(int level, const std::string& name, fem::Problem problem) {
  problem.level = level;
  const Cost cost = run_in_child([&] {
    const fem::LevelResult found = fem::solve(problem, quiet).finest;
    char report[160];
    std::snprintf(report, sizeof report, "%.17g %.17g %.17g %.17g %.17g", found.a_m, found.b_m,
                  found.indentation_m, found.max_torque_Nm, found.area_m2);
    return std::string(report);
  });
  if (!cost.succeeded) {
    std::printf("%-34s level %d %s\n", name.c_str(), level, cost.report.c_str());
    return std::nullopt;
  }
  Truth truth;
  std::istringstream(cost.report) >> truth.a_m >> truth.b_m >> truth.indentation_m >>
      truth.max_torque_Nm >> truth.area_m2;
  return truth;
}

constexpr double thickness_m = 2e-3, youngs_modulus_Pa = 3e5, friction_coefficient = 0.7;

/// A paraboloid pressed until the contact's radius is `s` thicknesses, by the integral equation of
/// the circular layer (relative 1e-10).
std::pair<fem::Problem, Truth> circular(double s, double nu) {
  const double a = s * thickness_m, R = 60 * a;
  const double modulus = youngs_modulus_Pa / (1 - nu * nu);
  const CircularLayerContact contact =
      circular_layer_contact(a, R, {{LayerKernel(nu), thickness_m, 1}});
  const double load = contact.load_over_modulus_m2 * modulus;
  fem::Problem problem;
  problem.contact = {{R, R, 0}, {thickness_m, youngs_modulus_Pa, nu}, {load, friction_coefficient}};
  return {problem,
          {a, a, contact.indentation_m, friction_coefficient * load * contact.torque_arm_m}};
}

/// Rows of the spectral solution of the bonded layer, R'/R'' = 5, relative 1e-5 (a, b 2e-5). Units:
/// h = E* = sqrt(R'R'') = mu = 1.
struct EllipticLayer {
  double nu, load, approach, a, b, torque;
};
constexpr EllipticLayer elliptic_layers[] = {
    {0.3, 7.085952539084279, 1.3470837151797446, 2.317539048781546, 0.948360340848445,
     6.911504668711859},
    {0.49, 0.1901065714715745, 0.1753970628018543, 0.813087169965468, 0.2989093959050494,
     0.06541525116423813},
    {0.4999, 0.06287671185125823, 0.09393335341886448, 0.5790825369737644, 0.20630110619423694,
     0.015361121512378024},
};

std::pair<fem::Problem, Truth> elliptic(const EllipticLayer& layer) {
  const double h = thickness_m, R = 60 * layer.a * h;
  const double modulus = youngs_modulus_Pa / (1 - layer.nu * layer.nu);
  fem::Problem problem;
  problem.contact = {{R * std::sqrt(5), R / std::sqrt(5), 0},
                     {h, youngs_modulus_Pa, layer.nu},
                     {layer.load * modulus * h * h * h / R, friction_coefficient}};
  return {problem,
          {layer.a * h, layer.b * h, layer.approach * h * h / R,
           layer.torque * friction_coefficient * modulus * std::pow(h, 4) / R}};
}

/// Measures the cost that friction adds to a circular contact, and the errors of the twist.
bool run_friction(const std::string& name, double s, double nu, const TwistCurve& curve) {
  const auto [plain, truth] = circular(s, nu);
  const Cost normal = run_case(name + ", pressing", [&plain = plain, &truth = truth] {
    return compare(fem::solve(plain, quiet), truth);
  });
  fem::Problem with_friction = plain;
  with_friction.friction.torsion = true;
  with_friction.friction.increments = 20;
  with_friction.friction.limit_surface = 24;
  const Cost friction = run_case(name + ", friction", [&, &truth = truth] {
    const fem::Result result = fem::solve(with_friction, quiet);
    const fem::Torsion& torsion = *result.torsion;
    const double shear = with_friction.contact.layer.shear_modulus_Pa();
    const double load = with_friction.contact.load.normal_force_N, a = truth.a_m;
    const double force = friction_coefficient * load;
    double worst = 0;
    for (const auto& increment : torsion.increments) {
      const double expected = force * a * curve.torque(shear * a * a * increment.angle_rad / force);
      const double difference = increment.wrench.torque_Nm - expected;
      if (std::abs(difference) > std::abs(worst)) worst = difference;
    }
    const double stiffness = 16.0 / 3 * shear * a * a * a * curve.stiffness_ratio();
    return "T(angle), of the full torque" +
           text(" %+8.4f /%7.4f", 100 * worst / truth.max_torque_Nm, 100 * torsion.curve_error) +
           "; full slip" +
           errors(torsion.full_slip_Nm, truth.max_torque_Nm, torsion.full_slip_error) +
           "; stiffness" + errors(torsion.stiffness_Nm_per_rad, stiffness, torsion.stiffness_error);
  });
  std::printf("%-34s %7.2f CPU s\n", (name + ", on top").c_str(), friction.cpu_s - normal.cpu_s);
  return normal.succeeded && friction.succeeded;
}

/// A generated fingertip with its facets, where it protrudes most, on a plane.
fem::Problem fingertip(double load_N, double nu, bool is_finite) {
  TriangleSurface pad = meshes::fingertip_pad({});
  const Eigen::Vector3d front = *std::min_element(
      pad.vertices_m.begin(), pad.vertices_m.end(),
      [](const Eigen::Vector3d& one, const Eigen::Vector3d& other) { return one.y() < other.y(); });
  fem::Problem problem;
  problem.contact = {
      {12e-3, 8e-3, 0}, {thickness_m, youngs_modulus_Pa, nu}, {load_N, friction_coefficient}};
  problem.fingertip.scan = std::make_shared<const TriangleSurface>(
      meshes::PlacedSurface(pad, {front, -Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX(), 0},
                            meshes::PlacedSurface::Body::below)
          .in_contact_frame());
  problem.fingertip.object = meshes::plane_object();
  if (is_finite) problem.finite_strain = fem::MaterialChoice();
  return problem;
}

/// A whole fingertip without symmetry: level 2 against level 3 on the same surface, then what
/// friction adds. Nothing exact is known of it.
bool run_fingertip(const std::string& name, double load_N, double nu, bool is_finite) {
  const fem::Problem problem = fingertip(load_N, nu, is_finite);
  const std::optional<Truth> truth = found_on_level(3, name, problem);
  if (!truth) return false;
  const Cost pressing = run_case(name, [&] { return compare(fem::solve(problem, quiet), *truth); });
  const Cost friction = run_case(name + ", friction", [&] {
    fem::Problem with_friction = problem;
    with_friction.friction.torsion = true;
    with_friction.friction.increments = 20;
    with_friction.friction.limit_surface = 24;
    const fem::Result result = fem::solve(with_friction, quiet);
    return "stated: T(angle)" +
           text(" %.3f %%, stiffness %.3f %%", 100 * result.torsion->curve_error,
                100 * result.torsion->stiffness_error) +
           text(", full slip %.3f %%, limit surface %.3f %%", 100 * result.torsion->full_slip_error,
                100 * result.limit_surface_error);
  });
  std::printf("%-34s %7.2f CPU s\n", (name + ", on top").c_str(), friction.cpu_s - pressing.cpu_s);
  return pressing.succeeded && friction.succeeded;
}

/// An object turned about the load, on a flat layer or a sphere's: no quarter stands for the whole
/// of it, yet the quarter of the same contact, not turned, has the same answer.
struct TurnedContact {
  double nu, finger_radius_m, major_m, minor_m, turn_rad;  ///< radii of the object
  double load_N, finite_load_N;                            ///< d/h up to 0.15, and 0.2
};
constexpr double straight = std::numeric_limits<double>::infinity();
constexpr TurnedContact turned_contacts[] = {
    {0.46, straight, 31e-3, 13.4e-3, 1.34, 1.4, 3},
    {0.3, straight, 51e-3, 23e-3, 2.64, 0.3, 2},
    {0.49, 20e-3, 20e-3, 10.8e-3, 0.72, 0.8, 2},
    {0.4, 25e-3, 34e-3, 14e-3, 0.5, 0.5, 1.5},
};

fem::Problem turned_problem(const TurnedContact& contact, bool is_finite, double turn_rad) {
  const double major = 1 / (1 / contact.major_m + 1 / contact.finger_radius_m),
               minor = 1 / (1 / contact.minor_m + 1 / contact.finger_radius_m);
  fem::Problem problem;
  problem.contact = {{major, minor, 0},
                     {thickness_m, youngs_modulus_Pa, contact.nu},
                     {is_finite ? contact.finite_load_N : contact.load_N, friction_coefficient}};
  if (contact.finger_radius_m < straight)
    problem.fingertip.pad = meshes::sphere_pad(contact.finger_radius_m);
  else
    problem.fingertip.pad = meshes::paraboloid_pad(straight, straight);
  problem.fingertip.object = meshes::quadric_object(contact.major_m, contact.minor_m, turn_rad);
  problem.fingertip.symmetric_object = turn_rad == 0;
  if (is_finite) problem.finite_strain = fem::MaterialChoice();
  return problem;
}

/// The whole against the quarter on level 4, at finite strain on level 3: four takes minutes there.
bool run_turned(const std::string& name, const TurnedContact& contact, bool is_finite) {
  const std::optional<Truth> truth =
      found_on_level(is_finite ? 3 : 4, name, turned_problem(contact, is_finite, 0));
  if (!truth) return false;
  const fem::Problem whole = turned_problem(contact, is_finite, contact.turn_rad);
  return run_case(name, [&] { return compare(fem::solve(whole, quiet), *truth); }).succeeded;
}

/// A bonded neo-Hookean layer with h/R = 0.2 under a sphere, or on a sphere that is pressed on a
/// plane. From an axisymmetric finite-element solution, not ours, with a node of the mesh at the
/// contact's edge; precision of the load 2e-4, of the others 1e-4. Load in E* h², torque in mu P h.
struct AxisymmetricContact {
  bool is_finger;
  double nu, load, approach, a, torque, area;
};
constexpr AxisymmetricContact axisymmetric_contacts[] = {
    {false, 0.3, 0.842718591367, 0.199999979973, 1.25693001115, 0.73138585399, 5.04431178425},
    {false, 0.49, 6.23922758292, 0.399999999428, 2.05143939025, 1.18119403646, 13.8299098006},
    {true, 0.49, 1.08092453353, 0.199999958103, 1.36160082317, 0.778485672805, 5.82437706816},
};

bool run_axisymmetric(const std::string& name, const AxisymmetricContact& contact, bool is_whole) {
  const double h = thickness_m, R = 5 * h;
  const double load = contact.load * youngs_modulus_Pa / (1 - contact.nu * contact.nu) * h * h;
  fem::Problem problem;
  problem.contact = {{R, R, 0}, {h, youngs_modulus_Pa, contact.nu}, {load, friction_coefficient}};
  problem.finite_strain = fem::MaterialChoice();
  if (contact.is_finger) {
    problem.fingertip.pad = meshes::sphere_pad(R);
    problem.fingertip.object = meshes::plane_object();
  } else {
    problem.fingertip.pad = meshes::paraboloid_pad(straight, straight);
    problem.fingertip.object = meshes::sphere_object(R);
  }
  problem.fingertip.symmetric_object = !is_whole;
  const Truth truth{contact.a * h, contact.a * h, contact.approach * h,
                    contact.torque * friction_coefficient * load * h, contact.area * h * h};
  return run_case(name, [&] { return compare(fem::solve(problem, quiet), truth); }).succeeded;
}

/// Runs the contact a/h = 1, nu = 0.3 in CalculiX at the true approach. The error of the load is
/// given as that of the approach at the true load: P ~ d^1.9 there.
bool run_calculix(double contact_stiffness) {
  char name[48];
  std::snprintf(name, sizeof name, "ccx a/h 1, nu 0.3, stiffness %g", contact_stiffness);
  bench::CalculixContact contact;
  contact.contact_stiffness = contact_stiffness;
  const CircularLayerContact truth = circular_layer_contact(
      contact.a, contact.radius, {{LayerKernel(contact.poisson_ratio), 1, 1}});
  contact.approach = truth.indentation_m;
  const double load =
      truth.load_over_modulus_m2 / (1 - contact.poisson_ratio * contact.poisson_ratio);
  constexpr double exponent = 1.9;
  const auto folder =
      std::filesystem::temp_directory_path() / ("softfinger_fem_bench_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const Cost cost = run_case(name, [&] {
    const double found = bench::load_by_calculix(contact, folder);
    char report[64];
    std::snprintf(report, sizeof report, "%8ld %+9.4f /      -", bench::unknowns_of(contact),
                  -100 * (found / load - 1) / exponent);
    return std::string(report);
  });
  std::filesystem::remove_all(folder);
  return cost.succeeded;
}

int run(const std::vector<std::string>& words) {
  const auto wanted = [&](const std::string& name) {
    return words.empty() || std::any_of(words.begin(), words.end(), [&](const std::string& word) {
             return name.find(word) != std::string::npos;
           });
  };
  bool succeeded = true;
  const auto run_plain = [&](const std::string& name, const std::pair<fem::Problem, Truth>& job) {
    if (!wanted(name)) return;
    succeeded &=
        run_case(name, [&] { return compare(fem::solve(job.first, quiet), job.second); }).succeeded;
  };
  std::printf("%-34s %7s %6s  %8s %17s %17s %17s %17s %17s\n", "case (errors: true / stated, %)",
              "CPU s", "MB", "unknowns", "d", "torque", "a", "b", "area");
  char name[80];
  for (const double s : {0.1, 0.5, 1.0, 2.0, 5.0})
    for (const double nu : {0.0, 0.3, 0.45, 0.49, 0.4999}) {
      std::snprintf(name, sizeof name, "circular a/h %.3g, nu %.4g", s, nu);
      run_plain(name, circular(s, nu));
    }
  for (const EllipticLayer& layer : elliptic_layers) {
    std::snprintf(name, sizeof name, "elliptic R'/R'' 5, nu %.4g", layer.nu);
    run_plain(name, elliptic(layer));
  }
  if (wanted("twist half-space"))
    succeeded &= run_friction("twist half-space", 0.05, 0.3, TwistCurve());
  for (const auto& layer : fem::verification::layer_twists()) {
    std::snprintf(name, sizeof name, "twist a/h %.3g, nu %.4g", layer.s, layer.nu);
    if (layer.s <= 1 && wanted(name))
      succeeded &= run_friction(name, layer.s, layer.nu, TwistCurve(layer));
  }
  for (const bool is_finite : {false, true})
    for (const TurnedContact& contact : turned_contacts) {
      std::snprintf(name, sizeof name, "turned%s, nu %g, %s", is_finite ? ", finite" : "",
                    contact.nu, contact.finger_radius_m < straight ? "bent" : "flat");
      if (wanted(name)) succeeded &= run_turned(name, contact, is_finite);
    }
  for (const bool is_whole : {false, true})
    for (const AxisymmetricContact& contact : axisymmetric_contacts) {
      std::snprintf(name, sizeof name, "axisymmetric, finite%s, nu %g, d/h %.2g",
                    is_whole ? ", whole" : "", contact.nu, contact.approach);
      if (wanted(name)) succeeded &= run_axisymmetric(name, contact, is_whole);
    }
  for (const bool is_finite : {false, true})
    for (const double load_N : {1.0, 5.0})
      for (const double nu : {0.45, 0.49}) {
        std::snprintf(name, sizeof name, "finger%s, %g N, nu %g", is_finite ? ", finite" : "",
                      load_N, nu);
        if (wanted(name)) succeeded &= run_fingertip(name, load_N, nu, is_finite);
      }
  {
    auto large = elliptic(elliptic_layers[0]);
    large.first.level = 4;  // 300,000 unknowns
    run_plain("large: level 4, R'/R'' 5, nu 0.3", large);
  }
  if (wanted("ccx")) {
    if (bench::calculix_is_there())
      for (const double stiffness : {100.0, 1000.0}) succeeded &= run_calculix(stiffness);
    else
      std::printf("CalculiX: skipped, there is no ccx on the PATH\n");
  }
  return succeeded ? 0 : 1;
}

}  // namespace
}  // namespace softfinger

int main(int argument_count, char** arguments) {
  // As in softfinger-fem: what is measured is what a user gets.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  return softfinger::run({arguments + 1, arguments + argument_count});
}
