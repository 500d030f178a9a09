#include "fem/surface_series.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "fem/write_file.h"

namespace softfinger::fem {

using Eigen::Index;

namespace {

std::string file_name(std::size_t number) {
  char name[64];
  std::snprintf(name, sizeof name, "twist_%03zu.vtu", number);
  return name;
}

/// A point of the contact or its copy by a half turn.
struct Place {
  Index point;
  double sign;
};

template <class Values>
void data_array(std::ostream& out, const char* name, int components,
                const std::vector<Place>& places, const Values& values) {
  out << "<DataArray type=\"Float64\" Name=\"" << name << "\" NumberOfComponents=\"" << components
      << "\" format=\"ascii\">\n";
  for (const Place& place : places) out << values(place) << '\n';
  out << "</DataArray>\n";
}

std::string vector_text(double x, double y, double z = 0) {
  char text[80];
  std::snprintf(text, sizeof text, "%.9g %.9g %.9g", x, y, z);
  return text;
}

}  // namespace

OnState SurfaceSeries::of(int level) {
  if (level != problem_.level || problem_.output_directory.empty())
    return [](const FrictionalContact&, const FrictionState&) {};
  return [this](const FrictionalContact& contact, const FrictionState& state) {
    write(contact, state);
  };
}

void SurfaceSeries::write(const FrictionalContact& contact, const FrictionState& state) {
  // A twist that is begun anew replaces the one before.
  if (!angles_rad_.empty() && state.motion.turn_rad <= angles_rad_.back()) angles_rad_.clear();
  const SurfaceCompliance& surface = contact.surface();
  const double h = problem_.contact.layer.thickness_m, E = problem_.contact.layer.youngs_modulus_Pa;
  std::vector<Place> places;
  double spacing_x = INFINITY, spacing_y = INFINITY;
  for (Index i = 0; i < surface.size(); ++i) {
    places.push_back({i, 1});
    if (surface.copies == 2 && surface.position.col(i).norm() > 1e-9) places.push_back({i, -1});
    for (auto [component, spacing] : {std::pair{0, &spacing_x}, std::pair{1, &spacing_y}})
      if (const double distance = std::abs(surface.in_block(component, i)); distance > 1e-9)
        *spacing = std::min(*spacing, distance);
  }
  // The nodes lie on a regular lattice: quadrilaterals join four neighbours.
  std::map<std::pair<long, long>, std::size_t> at;
  const auto lattice = [&](const Place& place) {
    const Eigen::Vector2d x = place.sign * surface.in_block.col(place.point);
    return std::pair{std::lround(x.x() / spacing_x), std::lround(x.y() / spacing_y)};
  };
  for (std::size_t i = 0; i < places.size(); ++i) at[lattice(places[i])] = i;
  std::vector<std::array<std::size_t, 4>> cells;
  for (const auto& [corner, first] : at) {
    const auto [i, j] = corner;
    const auto right = at.find({i + 1, j}), across = at.find({i + 1, j + 1}),
               up = at.find({i, j + 1});
    if (right != at.end() && across != at.end() && up != at.end())
      cells.push_back({first, right->second, across->second, up->second});
  }

  const auto pressure = [&](Index i) { return E * contact.normal_force()[i] / surface.area[i]; };
  write_file(
      problem_.output_directory + "/" + file_name(angles_rad_.size()), "VTU file",
      [&](std::ostream& out) {
        out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
               "byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\""
            << places.size() << "\" NumberOfCells=\"" << cells.size() << "\">\n<Points>\n";
        data_array(out, "position_m", 3, places, [&](const Place& p) {
          return vector_text(p.sign * h * surface.position(0, p.point),
                             p.sign * h * surface.position(1, p.point),
                             h * surface.height[p.point]);
        });
        out << "</Points>\n<PointData>\n";
        data_array(out, "contact_pressure_Pa", 1, places,
                   [&](const Place& p) { return pressure(p.point); });
        data_array(out, "contact_shear_Pa", 3, places, [&](const Place& p) {
          const Eigen::Vector2d force = contact.tangential_force().segment<2>(2 * p.point);
          const double scale = p.sign * E / surface.area[p.point];
          return vector_text(scale * force.x(), scale * force.y());
        });
        data_array(out, "slip_m", 3, places, [&](const Place& p) {
          const Eigen::Vector2d slip = p.sign * h * contact.slip().segment<2>(2 * p.point);
          return vector_text(slip.x(), slip.y());
        });
        data_array(out, "state", 1, places, [&](const Place& p) {
          return contact.normal_force()[p.point] <= 0 ? 0 : contact.slips(p.point) ? 2 : 1;
        });
        out << "</PointData>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" "
               "format=\"ascii\">\n";
        for (const auto& cell : cells)
          out << cell[0] << ' ' << cell[1] << ' ' << cell[2] << ' ' << cell[3] << '\n';
        out << "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n";
        for (std::size_t i = 1; i <= cells.size(); ++i) out << 4 * i << '\n';
        out << "</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n";
        constexpr int quadrilateral = 9;
        for (std::size_t i = 0; i < cells.size(); ++i) out << quadrilateral << '\n';
        out << "</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
      });
  angles_rad_.push_back(state.motion.turn_rad);
}

std::string SurfaceSeries::finish() {
  if (angles_rad_.empty()) return {};
  const std::string path = problem_.output_directory + "/twist.pvd";
  write_file(path, "PVD file", [&](std::ostream& out) {
    out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
    for (std::size_t i = 0; i < angles_rad_.size(); ++i)
      out << "<DataSet timestep=\"" << angles_rad_[i] << "\" file=\"" << file_name(i) << "\"/>\n";
    out << "</Collection>\n</VTKFile>\n";
  });
  return path;
}

}  // namespace softfinger::fem
