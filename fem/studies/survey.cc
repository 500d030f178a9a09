// Counts how often finite elements answer on real fingers: presses random points of the pads of
// generated fingers and of the scans that it is given.

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "fem/base/stopwatch.h"
#include "fem/program/reference_solver.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/surfaces.h"
#include "meshes/io/read_surface.h"
#include "meshes/placement/placed_surface.h"
#include "softfinger/input/errors.h"

namespace {

using Eigen::Vector3d;
using softfinger::TriangleSurface;
namespace fem = softfinger::fem;
namespace meshes = softfinger::meshes;

struct Finger {
  std::string name;
  TriangleSurface surface;
  Vector3d pad;  ///< the side that the pad faces
};

/// A unit sphere's mesh, moved point by point.
/// @param edge  of its triangles, in radii
template <class Map>
Finger moved_sphere(const std::string& name, double edge, const Map& map) {
  constexpr double radius_m = 10e-3;
  TriangleSurface surface = meshes::sphere(radius_m, edge * radius_m);
  for (Vector3d& vertex : surface.vertices_m) vertex = map(vertex / radius_m);
  return {name, surface, -Vector3d::UnitY()};
}

/// Ten fingers about as large as a person's, pads to -y, tips to +z.
std::vector<Finger> generated_fingers() {
  std::vector<Finger> fingers;
  const auto ellipsoid = [](double x, double y, double z) {
    return [=](const Vector3d& u) { return Vector3d(x * u.x(), y * u.y(), z * u.z()); };
  };
  fingers.push_back(moved_sphere("ellipsoid 8 7 14", 0.08, ellipsoid(8e-3, 7e-3, 14e-3)));
  fingers.push_back(moved_sphere("ellipsoid 7 9 16, coarse", 0.2, ellipsoid(7e-3, 9e-3, 16e-3)));
  fingers.push_back(moved_sphere("ellipsoid 10 8 12", 0.1, ellipsoid(10e-3, 8e-3, 12e-3)));
  for (const double taper : {0.15, 0.3})
    fingers.push_back(moved_sphere(fmt::format("tapered {}", taper), 0.08, [=](const Vector3d& u) {
      const double width = 1 - taper * u.z();
      return Vector3d(8e-3 * width * u.x(), 7e-3 * width * u.y(), 14e-3 * u.z());
    }));
  // |x/a|^p + |y/b|^p + |z/c|^p = 1 with p above 2: flatter sides, rounder edges between them.
  for (const double power : {2.5, 3.0, 4.0})
    fingers.push_back(
        moved_sphere(fmt::format("superquadric {}", power), 0.06, [=](const Vector3d& u) {
          const double level = std::pow(u.cwiseAbs().array().pow(power).sum(), 1 / power);
          const Vector3d on = u / level;
          return Vector3d(8e-3 * on.x(), 7e-3 * on.y(), 14e-3 * on.z());
        }));
  // A flat pad, with a sharp edge around it.
  fingers.push_back(moved_sphere("ellipsoid with a flat", 0.05, [](const Vector3d& u) {
    return Vector3d(8e-3 * u.x(), std::max(7e-3 * u.y(), -6e-3), 14e-3 * u.z());
  }));
  fingers.push_back({"fingertip pad", meshes::fingertip_pad({}), -Vector3d::UnitY()});
  return fingers;
}

struct PadPoint {
  Vector3d point, normal;
};

/// Draws points of the outer skin whose normals lie within 35 degrees of the pad's direction, by
/// area.
class PadPoints {
 public:
  explicit PadPoints(const Finger& finger) : surface_(finger.surface) {
    double area = 0;
    const double cosine = std::cos(35 * M_PI / 180);
    for (const auto& triangle : surface_.triangles) {
      const Vector3d twice = (corner(triangle, 1) - corner(triangle, 0))
                                 .cross(corner(triangle, 2) - corner(triangle, 0));
      if (twice.dot(finger.pad) > cosine * twice.norm() * finger.pad.norm()) area += twice.norm();
      up_to_.push_back(area);
    }
  }

  PadPoint draw(std::mt19937& engine) const {
    std::uniform_real_distribution<double> unit(0, 1);
    while (true) {
      const auto at = std::upper_bound(up_to_.begin(), up_to_.end(), unit(engine) * up_to_.back());
      const auto& triangle = surface_.triangles[static_cast<std::size_t>(at - up_to_.begin())];
      double u = unit(engine), v = unit(engine);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vector3d a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
      const PadPoint point{a + u * (b - a) + v * (c - a), (b - a).cross(c - a).normalized()};
      if (is_outside(point)) return point;
    }
  }

 private:
  Vector3d corner(const std::array<int, 3>& triangle, std::size_t i) const {
    return surface_.vertices_m[static_cast<std::size_t>(triangle[i])];
  }

  /// Whether a ray along the normal meets nothing (Moeller and Trumbore 1997).
  bool is_outside(const PadPoint& from) const {
    constexpr double beside = 1e-6;
    for (const auto& triangle : surface_.triangles) {
      const Vector3d one = corner(triangle, 1) - corner(triangle, 0),
                     two = corner(triangle, 2) - corner(triangle, 0);
      const Vector3d across = from.normal.cross(two);
      const double determinant = one.dot(across);
      if (std::abs(determinant) < 1e-18) continue;
      const Vector3d start = from.point + beside * from.normal - corner(triangle, 0);
      const double u = start.dot(across) / determinant;
      const Vector3d other = start.cross(one);
      const double v = from.normal.dot(other) / determinant;
      if (u >= 0 && v >= 0 && u + v <= 1 && two.dot(other) / determinant > 0) return false;
    }
    return true;
  }

  const TriangleSurface& surface_;
  std::vector<double> up_to_;
};

struct Object {
  const char* name;
  std::shared_ptr<const meshes::ObjectSurface> surface;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

struct Options {
  int points = 200, level = 2;
  int only = -1;  ///< number of the one point to press and report; all where negative
  bool finite = false;
  std::vector<Finger> fingers;
};

/// @param pad  X,Y,Z
Finger read_finger(const std::string& path, const std::string& pad) {
  std::istringstream text(pad);
  Vector3d side;
  char comma = 0, second = 0;
  if (!(text >> side.x() >> comma >> side.y() >> second >> side.z()) || comma != ',' ||
      second != ',' || !(text >> std::ws).eof() || !(side.norm() > 0))
    throw softfinger::InputError("arguments", "--millimetres", pad,
                                 "X,Y,Z, the side that the pad faces, as in 0,-1,0");
  return {path, meshes::read_surface(path, 1e-3).surface, side};
}

constexpr const char* usage =
    "softfinger-fem-survey [--points N] [--only K] [--level L] [--finite] [--scans-only]\n"
    "                      [--millimetres FILE X,Y,Z]...\n"
    "Presses N random points (200) of the pads of ten generated fingers and of scans,\n"
    "at small strain, and at finite strain where that is refused.\n"
    "  --only K        the one of these to press, and to be told about\n"
    "  --level L       of the mesh, 1 to 4 (2)\n"
    "  --finite        at finite strain only\n"
    "  --scans-only    no generated fingers\n"
    "  --millimetres   a scan and the side that its pad faces\n";

int read_number(const std::string& option, const std::string& text, int least, int largest) {
  int value = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc() || read.ptr != end || value < least || value > largest)
    throw softfinger::InputError("arguments", option, text,
                                 fmt::format("{} to {}", least, largest));
  return value;
}

/// None where only help was asked for.
std::optional<Options> read_options(int count, char** arguments) {
  constexpr int most_points = 1000000, most_level = 4;
  Options options;
  bool scans_only = false;
  const std::vector<std::string> words(arguments + 1, arguments + count);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& option = words[i];
    const auto next = [&] {
      if (++i == words.size())
        throw softfinger::InputError("arguments", option, "", "a value after it");
      return words[i];
    };
    if (option == "--help") {
      fmt::print("{}", usage);
      return std::nullopt;
    }
    if (option == "--finite") {
      options.finite = true;
    } else if (option == "--scans-only") {
      scans_only = true;
    } else if (option == "--points") {
      options.points = read_number(option, next(), 1, most_points);
    } else if (option == "--only") {
      options.only = read_number(option, next(), 0, most_points - 1);
    } else if (option == "--level") {
      options.level = read_number(option, next(), 1, most_level);
    } else if (option == "--millimetres") {
      const std::string path = next();
      options.fingers.push_back(read_finger(path, next()));
    } else {
      throw softfinger::InputError("arguments", "argument", option, "what --help lists");
    }
  }
  if (options.only >= options.points)
    throw softfinger::InputError("arguments", "--only", std::to_string(options.only),
                                 fmt::format("less than --points, {}", options.points));
  if (!scans_only) {
    const std::vector<Finger> generated = generated_fingers();
    options.fingers.insert(options.fingers.begin(), generated.begin(), generated.end());
  }
  if (options.fingers.empty())
    throw softfinger::InputError("arguments", "--scans-only", "",
                                 "--millimetres FILE X,Y,Z beside it");
  return options;
}

/// The measurements of the points that were answered.
struct Answers {
  std::vector<double> a, b, area, d, torque, cpu_s;

  void add(const fem::Result& result) {
    a.push_back(result.error.a);
    b.push_back(result.error.b);
    area.push_back(result.error.area);
    d.push_back(result.error.indentation);
    torque.push_back(result.error.max_torque);
    cpu_s.push_back(result.cpu_s);
  }
};

/// Prints what a contact is, or why it is refused. Whether it is answered.
bool press(const fem::Problem& problem, bool tells, Answers& answers) {
  try {
    const fem::Result result = fem::solve(problem, [&](const std::string& line) {
      if (tells) fmt::print(stderr, "{}\n", line);
    });
    const auto& error = result.error;
    fmt::print(
        "a {:.2f} b {:.2f} mm d/h {:.3f}, stated a {:.1f} b {:.1f} area {:.1f} d {:.2f} "
        "torque {:.2f} %, {:.1f} CPU s\n",
        1e3 * result.finest.a_m, 1e3 * result.finest.b_m,
        result.finest.indentation_m / problem.contact.layer.thickness_m, 100 * error.a,
        100 * error.b, 100 * error.area, 100 * error.indentation, 100 * error.max_torque,
        result.cpu_s);
    answers.add(result);
    return true;
  } catch (const std::exception& error) {
    fmt::print("{}\n", error.what());
    return false;
  }
}

void survey(const Options& options) {
  const std::vector<Object> objects = {{"plane", meshes::plane_object()},
                                       {"cylinder", meshes::cylinder_object(10e-3)},
                                       {"sphere", meshes::sphere_object(15e-3)}};
  std::mt19937 engine(2026);
  int answered = 0, answered_at_finite_strain = 0;
  Answers answers;
  for (int i = 0; i < options.points; ++i) {
    const Finger& finger = options.fingers[static_cast<std::size_t>(i) % options.fingers.size()];
    const PadPoint at = PadPoints(finger).draw(engine);
    const auto any = [&](const auto& list) {
      return list[std::uniform_int_distribution<std::size_t>(0, std::size(list) - 1)(engine)];
    };
    const Object object = any(objects);
    const double load_N = any(std::vector<double>{0.2, 1, 5}),
                 h = any(std::vector<double>{1e-3, 2e-3, 3e-3}),
                 nu = any(std::vector<double>{0.3, 0.45, 0.49});
    if (options.only >= 0 && options.only != i) continue;
    fem::Problem problem;
    problem.contact = {{12e-3, 8e-3, 0}, {h, 1e5, nu}, {load_N, 0.8}};
    problem.level = options.level;
    if (options.finite) problem.finite_strain = fem::MaterialChoice();
    problem.fingertip.scan = std::make_shared<const TriangleSurface>(
        meshes::PlacedSurface(finger.surface, {at.point, at.normal, at.normal.unitOrthogonal(), 0},
                              meshes::PlacedSurface::Body::below)
            .in_contact_frame());
    problem.fingertip.object = object.surface;
    fmt::print("{:3} {:28} {:5.1f} {:5.1f} {:5.1f} mm {:8} {:3} N h {} mm nu {}: ", i, finger.name,
               1e3 * at.point.x(), 1e3 * at.point.y(), 1e3 * at.point.z(), object.name, load_N,
               1e3 * h, nu);
    const bool tells = options.only >= 0;
    if (press(problem, tells, answers)) {
      ++answered;
    } else if (!options.finite) {
      // A contact beyond small strain is pressed once more, at finite strain.
      problem.finite_strain = fem::MaterialChoice();
      fmt::print("    at finite strain: ");
      if (press(problem, tells, answers)) ++answered_at_finite_strain;
    }
    std::fflush(stdout);
  }
  fmt::print("answered {} of {}", answered + answered_at_finite_strain, options.points);
  if (!options.finite) fmt::print(", {} of them at finite strain only", answered_at_finite_strain);
  fmt::print(
      "; stated errors, median: a {:.2f} b {:.2f} area {:.2f} d {:.2f} torque {:.2f} %; {:.1f} "
      "CPU s\n",
      100 * median(answers.a), 100 * median(answers.b), 100 * median(answers.area),
      100 * median(answers.d), 100 * median(answers.torque), median(answers.cpu_s));
}

}  // namespace

int main(int count, char** arguments) {
  try {
    if (const auto options = read_options(count, arguments)) survey(*options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "softfinger-fem-survey: {}\n", error.what());
    return 2;
  }
}
