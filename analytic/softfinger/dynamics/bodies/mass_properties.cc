#include "softfinger/dynamics/bodies/mass_properties.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

MassProperties diagonal(double xx, double yy, double zz) {
  MassProperties result;
  result.mass_kg = 1;
  result.inertia_kg_m2 = Eigen::Vector3d(xx, yy, zz).asDiagonal();
  return result;
}

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

void require_closed(const TriangleSurface& surface, const std::string& where) {
  // For each edge: the number of triangles in which it runs forwards minus the number in which it
  // runs backwards, and the number of all its triangles.
  std::map<std::pair<int, int>, std::pair<int, int>> edges;
  for (const auto& triangle : surface.triangles)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const int from = triangle[corner], to = triangle[(corner + 1) % 3];
      auto& [balance, count] = edges[std::minmax(from, to)];
      balance += from < to ? 1 : -1;
      ++count;
    }
  int open = 0;
  for (const auto& [edge, use] : edges) open += use.first != 0 || use.second % 2 != 0;
  if (open > 0 || surface.triangles.empty())
    throw InputError(where, "mesh edges that do not join two triangles", std::to_string(open),
                     "0: a closed surface, where mass or inertia are to be derived from it");
}

}  // namespace

MassProperties unit_mass_of_ellipsoid(const Eigen::Vector3d& semi_axes_m) {
  const Eigen::Vector3d s = semi_axes_m.cwiseAbs2() / 5;
  return diagonal(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
}

MassProperties unit_mass_of_box(const Eigen::Vector3d& size_m) {
  const Eigen::Vector3d s = size_m.cwiseAbs2() / 12;
  return diagonal(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
}

MassProperties unit_mass_of_cylinder(double radius_m, double length_m) {
  const double across = radius_m * radius_m / 4 + length_m * length_m / 12;
  return diagonal(across, across, radius_m * radius_m / 2);
}

MassProperties unit_mass_of_capsule(double radius_m, double length_m) {
  const double r = radius_m, tube = kPi * r * r * length_m, ball = 4 * kPi / 3 * r * r * r;
  const double total = tube + ball;
  const MassProperties cylinder = unit_mass_of_cylinder(r, length_m);
  // A half-sphere's centre lies 3/8 r above its base, its moment about that centre is 83/320 m r².
  const double arm = length_m / 2 + 3 * r / 8;
  const double across =
      (tube * cylinder.inertia_kg_m2(0, 0) + ball * (83. / 320 * r * r + arm * arm)) / total;
  const double along = (tube * cylinder.inertia_kg_m2(2, 2) + ball * 2 * r * r / 5) / total;
  return diagonal(across, across, along);
}

MassProperties unit_mass_of_closed_surface(const TriangleSurface& surface, const std::string& where,
                                           double* volume_m3) {
  require_closed(surface, where);
  // Tetrahedra from one of the vertices, so that a body far from the origin loses no digits.
  const Eigen::Vector3d origin = surface.vertices_m.front();
  double volume = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& triangle : surface.triangles) {
    Eigen::Matrix3d corners;
    for (int corner = 0; corner < 3; ++corner)
      corners.col(corner) = surface.vertices_m[std::size_t(triangle[std::size_t(corner)])] - origin;
    const double six_volumes = corners.col(0).dot(corners.col(1).cross(corners.col(2)));
    const Eigen::Vector3d sum = corners.rowwise().sum();
    volume += six_volumes / 6;
    first += six_volumes / 24 * sum;
    second += six_volumes / 120 * (corners * corners.transpose() + sum * sum.transpose());
  }
  if (!(volume > 0) || !std::isfinite(volume))
    throw InputError(where, "volume of the mesh in m3", volume,
                     "> 0: a closed surface whose triangles are counter-clockwise from outside");
  if (volume_m3) *volume_m3 = volume;
  const Eigen::Vector3d center = first / volume;
  const Eigen::Matrix3d spread = second / volume - center * center.transpose();
  MassProperties result;
  result.mass_kg = 1;
  result.center_m = origin + center;
  result.inertia_kg_m2 = spread.trace() * Eigen::Matrix3d::Identity() - spread;
  return result;
}

MassProperties with_mass(MassProperties unit_mass, double mass_kg) {
  unit_mass.inertia_kg_m2 *= mass_kg / unit_mass.mass_kg;
  unit_mass.mass_kg = mass_kg;
  return unit_mass;
}

void require_physical(const MassProperties& mass, const std::string& where) {
  if (!(mass.mass_kg > 0) || !std::isfinite(mass.mass_kg))
    throw InputError(where, "mass in kg", mass.mass_kg, "a finite number > 0");
  const Eigen::Matrix3d& inertia = mass.inertia_kg_m2;
  const double size = inertia.cwiseAbs().maxCoeff();
  if (!mass.center_m.allFinite())
    throw InputError(where, "centre of mass", "not finite", "three finite numbers");
  if (!inertia.allFinite() ||
      !((inertia - inertia.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * size))
    throw InputError(where, "inertia", "", "a symmetric matrix of finite numbers");
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(moments[0] > 0))
    throw InputError(where, "smallest principal moment of inertia in kg m2", moments[0], "> 0");
  if (moments[2] > (moments[0] + moments[1]) * (1 + 1e-9))
    throw InputError(where, "largest principal moment of inertia in kg m2", moments[2],
                     "at most the sum of the other two, " + text(moments[0] + moments[1]) +
                         ": no mass distribution has more");
}

}  // namespace softfinger
