#include "fem/output/surface_series.h"

#include <deal.II/base/data_out_base.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "fem/base/formatted.h"
#include "fem/base/write_file.h"

namespace softfinger::fem {

using Eigen::Index;

namespace {

std::string file_name(std::size_t number) { return formatted("twist_%03zu.vtu", number); }

/// A point of the contact or its copy by a half turn.
struct Place {
  Index point;
  double sign;
};

template <class Values>
void data_array(std::ostream& out, const char* name, int components, const RubbedSurface& surface,
                const Values& values) {
  out << "<DataArray type=\"Float64\" Name=\"" << name << "\" NumberOfComponents=\"" << components
      << "\" format=\"ascii\">\n";
  for (const RubbedSurface::Point& point : surface.points) out << values(point) << '\n';
  out << "</DataArray>\n";
}

std::string text_of(const Eigen::Vector3d& vector) {
  return formatted("%.9g %.9g %.9g", vector.x(), vector.y(), vector.z());
}

/// The contact's points and, of half a contact, their copies by a half turn.
std::vector<Place> places_of(const SurfaceCompliance& surface) {
  constexpr double at_centre = 1e-9;
  std::vector<Place> places;
  for (Index i = 0; i < surface.size(); ++i) {
    places.push_back({i, 1});
    if (surface.copies == 2 && surface.position.col(i).norm() > at_centre)
      places.push_back({i, -1});
  }
  return places;
}

/// Smallest distance of a point from the centre line of each direction.
Eigen::Vector2d spacing_of(const SurfaceCompliance& surface) {
  constexpr double on_line = 1e-9;
  Eigen::Vector2d spacing(INFINITY, INFINITY);
  for (Index i = 0; i < surface.size(); ++i)
    for (const Index c : {0, 1})
      if (const double distance = std::abs(surface.in_block(c, i)); distance > on_line)
        spacing[c] = std::min(spacing[c], distance);
  return spacing;
}

using Quadrilateral = std::array<std::size_t, 4>;

/// The nodes lie on a regular lattice: quadrilaterals join four neighbours.
std::vector<Quadrilateral> quadrilaterals(const SurfaceCompliance& surface,
                                          const std::vector<Place>& places) {
  const Eigen::Vector2d spacing = spacing_of(surface);
  std::map<std::pair<long, long>, std::size_t> at;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector2d x = places[i].sign * surface.in_block.col(places[i].point);
    at[{std::lround(x.x() / spacing.x()), std::lround(x.y() / spacing.y())}] = i;
  }
  std::vector<Quadrilateral> cells;
  for (const auto& [corner, first] : at) {
    const auto [i, j] = corner;
    const auto right = at.find({i + 1, j}), across = at.find({i + 1, j + 1}),
               up = at.find({i, j + 1});
    if (right != at.end() && across != at.end() && up != at.end())
      cells.push_back({first, right->second, across->second, up->second});
  }
  return cells;
}

RubbedSurface rubbed(const FrictionalContact& contact) {
  const SurfaceCompliance& surface = contact.surface();
  const std::vector<Place> places = places_of(surface);
  RubbedSurface result;
  for (const auto& [i, sign] : places) {
    const double area = surface.area[i];
    const auto along = [at = i, turn = sign](const Eigen::VectorXd& field) {
      return Eigen::Vector3d(turn * field[2 * at], turn * field[2 * at + 1], 0);
    };
    RubbedSurface::Point& point = result.points.emplace_back();
    point.position = {sign * surface.position(0, i), sign * surface.position(1, i),
                      surface.height[i]};
    point.pressure = contact.normal_force()[i] / area;
    point.shear = along(contact.tangential_force()) / area;
    point.slip = along(contact.slip());
    if (contact.normal_force()[i] > 0)
      point.state = contact.slips(i) ? RubbedSurface::slips : RubbedSurface::sticks;
  }
  result.quadrilaterals = quadrilaterals(surface, places);
  return result;
}

void write_points(const RubbedSurface& surface, double h, std::ostream& out) {
  using Point = RubbedSurface::Point;
  out << "<Points>\n";
  data_array(out, "position_m", 3, surface,
             [&](const Point& point) { return text_of(h * point.position); });
  out << "</Points>\n";
}

void write_point_data(const RubbedSurface& surface, double h, double E, std::ostream& out) {
  using Point = RubbedSurface::Point;
  out << "<PointData>\n";
  data_array(out, "contact_pressure_Pa", 1, surface,
             [&](const Point& point) { return E * point.pressure; });
  data_array(out, "contact_shear_Pa", 3, surface,
             [&](const Point& point) { return text_of(E * point.shear); });
  data_array(out, "slip_m", 3, surface,
             [&](const Point& point) { return text_of(h * point.slip); });
  data_array(out, "state", 1, surface,
             [](const Point& point) { return static_cast<int>(point.state); });
  out << "</PointData>\n";
}

void write_cells(const std::vector<Quadrilateral>& cells, std::ostream& out) {
  out << "<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n";
  for (const Quadrilateral& cell : cells)
    out << cell[0] << ' ' << cell[1] << ' ' << cell[2] << ' ' << cell[3] << '\n';
  out << "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n";
  for (std::size_t i = 1; i <= cells.size(); ++i) out << 4 * i << '\n';
  out << "</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n";
  constexpr int quadrilateral = 9;  // VTK's number of this kind of cell
  for (std::size_t i = 0; i < cells.size(); ++i) out << quadrilateral << '\n';
  out << "</DataArray>\n</Cells>\n";
}

/// Writes the file by hand: deal.II writes fields of its own meshes only, and this surface has
/// none.
void write_surface(const RubbedSurface& surface, double thickness_m, double youngs_modulus_Pa,
                   std::ostream& out) {
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
         "byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\""
      << surface.points.size() << "\" NumberOfCells=\"" << surface.quadrilaterals.size() << "\">\n";
  write_points(surface, thickness_m, out);
  write_point_data(surface, thickness_m, youngs_modulus_Pa, out);
  write_cells(surface.quadrilaterals, out);
  out << "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

}  // namespace

OnState SurfaceSeries::of(int level) {
  if (level != problem_.level || problem_.output_directory.empty())
    return [](const FrictionalContact&, const FrictionState&) {};
  return [this](const FrictionalContact& contact, const FrictionState& state) {
    add(state.motion.turn_rad, rubbed(contact));
  };
}

void SurfaceSeries::add(double turn_rad, const RubbedSurface& surface) {
  if (problem_.output_directory.empty()) return;
  if (!angles_rad_.empty() && turn_rad <= angles_rad_.back()) angles_rad_.clear();
  const ElasticLayer& layer = problem_.contact.layer;
  write_file(problem_.output_directory + "/" + file_name(angles_rad_.size()), "VTU file",
             [&](std::ostream& out) {
               write_surface(surface, layer.thickness_m, layer.youngs_modulus_Pa, out);
             });
  angles_rad_.push_back(turn_rad);
}

std::string SurfaceSeries::finish() {
  if (angles_rad_.empty()) return {};
  const std::string path = problem_.output_directory + "/twist.pvd";
  std::vector<std::pair<double, std::string>> files;
  for (std::size_t i = 0; i < angles_rad_.size(); ++i)
    files.emplace_back(angles_rad_[i], file_name(i));
  write_file(path, "PVD file",
             [&](std::ostream& out) { dealii::DataOutBase::write_pvd_record(out, files); });
  return path;
}

}  // namespace softfinger::fem
