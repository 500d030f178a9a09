#include "comparisons/simulation/vtu_files.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "comparisons/simulation/triangulate.h"
#include "comparisons/system/files.h"
#include "softfinger/input/constants.h"

namespace softfinger::simulation {
namespace {

template <typename Number>
std::string_view bytes_of(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

/// Compresses as VTK's vtkZLibDataCompressor does: a header of the number of blocks, their size,
/// that of an incomplete last one (0: there is none) and their compressed sizes, then the blocks.
/// One block holds the whole array.
/// @param level  of zlib
std::string compressed(std::string_view bytes, int level) {
  if (bytes.empty()) return std::string(3 * sizeof(std::uint64_t), '\0');
  constexpr std::size_t kHeader = 4 * sizeof(std::uint64_t);
  std::string result(kHeader + compressBound(static_cast<uLong>(bytes.size())), '\0');
  uLongf size = static_cast<uLongf>(result.size() - kHeader);
  if (compress2(reinterpret_cast<Bytef*>(result.data() + kHeader), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                level) != Z_OK)
    throw std::runtime_error("zlib could not compress an array of a VTU file");
  result.resize(kHeader + size);
  const std::vector<std::uint64_t> header = {1, bytes.size(), 0, size};
  result.replace(0, kHeader, bytes_of(header));
  return result;
}

/// An array as it stands in a file.
struct Array {
  std::string attributes, bytes;
};

const char* type_name(double) { return "Float64"; }
const char* type_name(float) { return "Float32"; }
const char* type_name(std::int32_t) { return "Int32"; }
const char* type_name(std::uint8_t) { return "UInt8"; }

template <typename Number>
Array array(const char* name, int components, const std::vector<Number>& values,
            int level = Z_NO_COMPRESSION) {
  return {fmt::format("type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"", type_name(Number{}),
                      name, components),
          compressed(bytes_of(values), level)};
}

/// Cells by their points, which frames may share.
struct Topology {
  std::size_t cells = 0;
  Array connectivity, offsets, types;
};

class Cells {
 public:
  void add(std::uint8_t vtk_type, const std::vector<std::int32_t>& point_indices) {
    connectivity_.insert(connectivity_.end(), point_indices.begin(), point_indices.end());
    offsets_.push_back(static_cast<std::int32_t>(connectivity_.size()));
    types_.push_back(vtk_type);
  }
  Topology topology(int level) const {
    return {types_.size(), array("connectivity", 1, connectivity_, level),
            array("offsets", 1, offsets_, level), array("types", 1, types_, level)};
  }

 private:
  std::vector<std::int32_t> connectivity_, offsets_;
  std::vector<std::uint8_t> types_;
};

constexpr std::uint8_t kVertex = 1, kTriangle = 5, kPolygon = 7;

/// Points, cells and what they carry as a VTU file.
class VtuText {
 public:
  VtuText(std::size_t points, std::size_t cells) {
    xml_ = fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n"
        "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
        points, cells);
  }
  /// @param arrays  stay where they are until `text`
  void add(const char* section, const std::vector<const Array*>& arrays) {
    xml_ += fmt::format("<{}>\n", section);
    for (const Array* array : arrays) {
      xml_ += fmt::format("<DataArray {} format=\"appended\" offset=\"{}\"/>\n", array->attributes,
                          offset_);
      offset_ += array->bytes.size();
      arrays_.push_back(array);
    }
    xml_ += fmt::format("</{}>\n", section);
  }
  void add(const Topology& cells) {
    add("Cells", {&cells.connectivity, &cells.offsets, &cells.types});
  }
  std::string text() const {
    constexpr std::string_view kBefore =
        "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
    constexpr std::string_view kAfter = "\n</AppendedData>\n</VTKFile>\n";
    std::string result;
    result.reserve(xml_.size() + kBefore.size() + offset_ + kAfter.size());
    result.append(xml_).append(kBefore);
    for (const Array* array : arrays_) result += array->bytes;
    return result.append(kAfter);
  }

 private:
  std::string xml_;
  std::size_t offset_ = 0;
  std::vector<const Array*> arrays_;
};

template <typename Number>
void append(std::vector<Number>& numbers, const Eigen::Vector3d& vector) {
  for (const double number : vector) numbers.push_back(static_cast<Number>(number));
}

/// The triangles of some bodies, which move with these.
class Triangles {
 public:
  /// @param movable  those that can move, or those that are fixed
  Triangles(const Recording& recording, bool movable, double half_space_width_m) {
    Cells cells;
    std::vector<std::int32_t> body_of_cell;
    for (std::size_t body = 0; body < recording.bodies.size(); ++body) {
      if (recording.bodies[body].movable != movable) continue;
      for (const input::Shape& shape : recording.bodies[body].shapes) {
        const TriangleSurface surface = triangulate(shape, half_space_width_m);
        const auto first = static_cast<std::int32_t>(points_);
        for (const auto& [i, j, k] : surface.triangles) {
          cells.add(kTriangle, {first + i, first + j, first + k});
          body_of_cell.push_back(static_cast<std::int32_t>(body));
        }
        points_ += surface.vertices_m.size();
        parts_.push_back({body, surface.vertices_m});
      }
    }
    cells_ = cells.topology(Z_BEST_SPEED);
    body_of_cell_ = array("body", 1, body_of_cell, Z_BEST_SPEED);
  }

  bool empty() const { return cells_.cells == 0; }

  std::string vtu(const Frame& frame) const {
    std::vector<float> points_m, velocities;
    points_m.reserve(3 * points_);
    velocities.reserve(3 * points_);
    for (const Part& part : parts_) {
      const Eigen::Isometry3d& pose = frame.poses.at(part.body);
      const Eigen::Vector3d& velocity = frame.velocities_m_per_s.at(part.body);
      const Eigen::Vector3d& turning = frame.angular_velocities_rad_per_s.at(part.body);
      for (const Eigen::Vector3d& vertex : part.vertices_m) {
        const Eigen::Vector3d arm = pose.linear() * vertex;
        append(points_m, pose.translation() + arm);
        append(velocities, velocity + turning.cross(arm));
      }
    }
    const Array points = array("points", 3, points_m);
    const Array velocity = array("velocity_m_per_s", 3, velocities);
    VtuText file(points_, cells_.cells);
    file.add("PointData", {&velocity});
    file.add("CellData", {&body_of_cell_});
    file.add("Points", {&points});
    file.add(cells_);
    return file.text();
  }

 private:
  struct Part {
    std::size_t body;
    std::vector<Eigen::Vector3d> vertices_m;  ///< in the body's frame
  };
  std::vector<Part> parts_;
  std::size_t points_ = 0;
  Topology cells_;
  Array body_of_cell_;
};

/// The data of each contact, for its point and for its ellipse.
struct ContactColumns {
  std::vector<double> normal_forces_N, tangential_forces_N, torques_Nm, semi_axes_m, utilisations;
  std::vector<std::int32_t> bodies;
  std::vector<std::uint8_t> slides;

  void append(const RecordedContact& contact) {
    simulation::append(normal_forces_N, contact.normal_force_N * contact.axes.col(2));
    simulation::append(tangential_forces_N, contact.tangent_force_1_N * contact.axes.col(0) +
                                                contact.tangent_force_2_N * contact.axes.col(1));
    simulation::append(torques_Nm, contact.torque_Nm * contact.axes.col(2));
    semi_axes_m.insert(semi_axes_m.end(), {contact.semi_axis_a_m, contact.semi_axis_b_m});
    utilisations.push_back(contact.utilisation);
    bodies.insert(bodies.end(), {contact.a, contact.b});
    slides.push_back(contact.slides ? 1 : 0);
  }
  std::vector<Array> arrays() const {
    return {array("normal_force_N", 3, normal_forces_N),
            array("tangential_force_N", 3, tangential_forces_N),
            array("torque_about_normal_Nm", 3, torques_Nm),
            array("semi_axes_m", 2, semi_axes_m),
            array("utilisation", 1, utilisations),
            array("bodies_a_b", 2, bodies),
            array("slides", 1, slides)};
  }
};

std::string contact_vtu(const std::vector<double>& points_m, const Cells& cells,
                        const ContactColumns& columns, bool of_points) {
  const std::vector<Array> arrays = columns.arrays();
  std::vector<const Array*> data;
  for (const Array& one : arrays) data.push_back(&one);
  const Array points = array("points", 3, points_m);
  const Topology topology = cells.topology(Z_NO_COMPRESSION);
  VtuText file(points_m.size() / 3, topology.cells);
  file.add("PointData", of_points ? data : std::vector<const Array*>{});
  file.add("CellData", of_points ? std::vector<const Array*>{} : data);
  file.add("Points", {&points});
  file.add(topology);
  return file.text();
}

std::string contacts_vtu(const Frame& frame) {
  std::vector<double> points_m;
  Cells cells;
  ContactColumns columns;
  for (const RecordedContact& contact : frame.contacts) {
    cells.add(kVertex, {static_cast<std::int32_t>(points_m.size() / 3)});
    append(points_m, contact.point_m);
    columns.append(contact);
  }
  return contact_vtu(points_m, cells, columns, true);
}

std::string ellipses_vtu(const Frame& frame) {
  constexpr int kCorners = 48;
  std::vector<double> points_m;
  Cells cells;
  ContactColumns columns;
  for (const RecordedContact& contact : frame.contacts) {
    if (!(contact.semi_axis_a_m > 0 && contact.semi_axis_b_m > 0)) continue;
    std::vector<std::int32_t> corners;
    for (int i = 0; i < kCorners; ++i) {
      const double angle = 2 * kPi * i / kCorners;
      corners.push_back(static_cast<std::int32_t>(points_m.size() / 3));
      append(points_m, contact.point_m +
                           contact.semi_axis_a_m * std::cos(angle) * contact.axes.col(0) +
                           contact.semi_axis_b_m * std::sin(angle) * contact.axes.col(1));
    }
    cells.add(kPolygon, corners);
    columns.append(contact);
  }
  return contact_vtu(points_m, cells, columns, false);
}

}  // namespace

void write_vtu(const Recording& recording, const std::filesystem::path& folder, int every_nth) {
  if (every_nth < 1) throw std::invalid_argument("write_vtu: every_nth must be at least 1");
  const double width_m = half_space_width_m(recording);
  const Triangles movable(recording, true, width_m), fixed(recording, false, width_m);

  system::make_writable_folder(folder / "frames");
  const std::size_t count = recording.frames.size();
  const bool shows_fixed = count > 0 && !fixed.empty();
  if (shows_fixed)
    system::write_file_atomically(folder / "frames/fixed.vtu", fixed.vtu(recording.frames.front()));
  std::string collection;
  const auto add_data_set = [&](double time_s, int part, std::string_view kind,
                                std::string_view name) {
    collection += fmt::format("<DataSet timestep=\"{}\" part=\"{}\" name=\"{}\" file=\"{}\"/>\n",
                              time_s, part, kind, name);
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (i % std::size_t(every_nth) != 0 && i + 1 != count) continue;
    const Frame& frame = recording.frames[i];
    std::vector<std::pair<std::filesystem::path, std::string>> files;
    const auto add_file = [&](std::string_view kind, std::string content) {
      const std::string name = fmt::format("frames/{}_{:06}.vtu", kind, i);
      add_data_set(frame.time_s, int(files.size()), kind, name);
      files.emplace_back(folder / name, std::move(content));
    };
    add_file("bodies", movable.vtu(frame));
    add_file("contacts", contacts_vtu(frame));
    add_file("ellipses", ellipses_vtu(frame));
    if (shows_fixed) add_data_set(frame.time_s, int(files.size()), "fixed", "frames/fixed.vtu");
    system::write_files_together(files);
  }
  // Written last, so that all files that it names exist.
  system::write_file_atomically(
      folder / "motion.pvd",
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n" +
          collection + "</Collection>\n</VTKFile>\n");
}

int usual_vtu_interval(const Recording& recording, std::size_t most_bytes) {
  constexpr std::size_t kFrames = 150;
  // Bytes in a file; the compressed indices of a triangle's vertices were measured on meshes of
  // scans.
  constexpr std::size_t kPerVertex = 2 * 3 * sizeof(float), kPerTriangle = 6;
  std::size_t bytes = 1;
  for (const RecordedBody& body : recording.bodies)
    if (body.movable)
      for (const input::Shape& shape : body.shapes) {
        const TriangleSurface surface = triangulate(shape, 1);
        bytes += kPerVertex * surface.vertices_m.size() + kPerTriangle * surface.triangles.size();
      }
  // The first and the last frame are always written.
  const std::size_t between = std::clamp<std::size_t>(most_bytes / bytes, 2, kFrames) - 1;
  const std::size_t steps = std::max<std::size_t>(recording.frames.size(), 2) - 1;
  return int((steps + between - 1) / between);
}

}  // namespace softfinger::simulation
