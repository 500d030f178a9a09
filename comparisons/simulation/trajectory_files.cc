#include "comparisons/simulation/trajectory_files.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "comparisons/simulation/triangulate.h"
#include "comparisons/system/files.h"
#include "comparisons/text/base64.h"
#include "comparisons/text/csv.h"
#include "softfinger/input/constants.h"

namespace softfinger::simulation {
namespace {

using nlohmann::json;

/// q and -q are the same rotation: the one with w >= 0 is written.
Eigen::Vector4d quaternion_wxyz(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  const Eigen::Vector4d wxyz(turn.w(), turn.x(), turn.y(), turn.z());
  return turn.w() < 0 ? Eigen::Vector4d(-wxyz) : wxyz;
}

Eigen::Vector3d tangential_force_N(const RecordedContact& contact) {
  return contact.tangent_force_1_N * contact.axes.col(0) +
         contact.tangent_force_2_N * contact.axes.col(1);
}

/// A row of a table, one cell after the other (RFC 4180).
class CsvRow {
 public:
  explicit CsvRow(std::string& table) : table_(table) {}
  ~CsvRow() { table_ += '\n'; }
  void append(double number) { fmt::format_to(std::back_inserter(cell()), "{}", number); }
  void append(const Eigen::Vector3d& vector) {
    for (const double number : vector) append(number);
  }
  void append(const std::string& text) { cell() += text::csv_cell(text); }

 private:
  std::string& cell() {
    if (!first_) table_ += ',';
    first_ = false;
    return table_;
  }
  std::string& table_;
  bool first_ = true;
};

template <typename Vector>
json numbers(const Vector& vector) {
  return std::vector<double>(vector.begin(), vector.end());
}

json described(const input::Sphere& sphere) {
  return {{"kind", "sphere"}, {"radius_m", sphere.radius_m}};
}
json described(const input::Ellipsoid& ellipsoid) {
  return {{"kind", "ellipsoid"}, {"semi_axes_m", numbers(ellipsoid.semi_axes_m)}};
}
json described(const input::Cylinder& cylinder) {
  return {{"kind", "cylinder"}, {"radius_m", cylinder.radius_m}, {"length_m", cylinder.length_m}};
}
json described(const input::Capsule& capsule) {
  return {{"kind", "capsule"}, {"radius_m", capsule.radius_m}, {"length_m", capsule.length_m}};
}
json described(const input::Box& box) { return {{"kind", "box"}, {"size_m", numbers(box.size_m)}}; }
json described(const input::HalfSpace&) { return {{"kind", "half_space"}}; }
json described(const input::Mesh& mesh) {
  return {{"kind", "mesh"},
          {"vertices", mesh.surface ? mesh.surface->vertices_m.size() : 0},
          {"triangles", mesh.surface ? mesh.surface->triangles.size() : 0}};
}

json described(const RecordedBody& body) {
  json shapes = json::array();
  for (const input::Shape& shape : body.shapes) {
    shapes.push_back(std::visit([](const auto& kind) { return described(kind); }, shape.kind));
    shapes.back()["position_m"] = numbers(shape.pose.translation());
    shapes.back()["quaternion_wxyz"] = numbers(quaternion_wxyz(shape.pose));
  }
  return {{"name", body.name}, {"movable", body.movable}, {"shapes", std::move(shapes)}};
}

json described(const RecordedContact& contact) {
  return {{"a", contact.a},
          {"b", contact.b},
          {"point_m", numbers(contact.point_m)},
          {"normal", numbers(Eigen::Vector3d(contact.axes.col(2)))},
          {"long_axis", numbers(Eigen::Vector3d(contact.axes.col(0)))},
          {"semi_axes_m", {contact.semi_axis_a_m, contact.semi_axis_b_m}},
          {"normal_force_N", contact.normal_force_N},
          {"tangential_force_N", numbers(tangential_force_N(contact))},
          {"torque_about_normal_Nm", contact.torque_Nm},
          {"friction_coefficient", contact.friction_coefficient},
          {"eccentricity_m", contact.eccentricity_m},
          {"pressure_exponent", contact.pressure_exponent},
          {"utilisation", contact.utilisation},
          {"slides", contact.slides},
          {"model", contact.model},
          {"friction_law", std::string(contact.friction->name)}};
}

/// As VTK's vtkZLibDataCompressor has it: a header of the number of blocks, their size, that of an
/// incomplete last one (0: there is none) and their compressed sizes, then the blocks. One block
/// holds the whole array.
/// @param level  of zlib
std::string compressed(std::string_view bytes, int level) {
  std::vector<std::uint64_t> header = {0, 0, 0};
  std::string block;
  if (!bytes.empty()) {
    block.resize(compressBound(static_cast<uLong>(bytes.size())));
    uLongf size = static_cast<uLongf>(block.size());
    if (compress2(reinterpret_cast<Bytef*>(block.data()), &size,
                  reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                  level) != Z_OK)
      throw std::runtime_error("zlib could not compress an array of a VTU file");
    block.resize(size);
    header = {1, bytes.size(), 0, size};
  }
  return text::base64(text::bytes_of(header)) + text::base64(block);
}

/// Points, cells and what they carry, as a VTU file: arrays compressed and in base64, exact and
/// short.
class UnstructuredGrid {
 public:
  void add_point(const Eigen::Vector3d& point_m) {
    coordinates_m_.insert(coordinates_m_.end(), point_m.begin(), point_m.end());
  }
  std::int32_t points() const { return static_cast<std::int32_t>(coordinates_m_.size() / 3); }
  void add_cell(std::uint8_t vtk_type, std::initializer_list<std::int32_t> point_indices) {
    add_cell(vtk_type, std::vector<std::int32_t>(point_indices));
  }
  void add_cell(std::uint8_t vtk_type, const std::vector<std::int32_t>& point_indices) {
    connectivity_.insert(connectivity_.end(), point_indices.begin(), point_indices.end());
    offsets_.push_back(static_cast<std::int32_t>(connectivity_.size()));
    types_.push_back(vtk_type);
  }
  template <typename Number>
  void add_point_data(const char* name, int components, const std::vector<Number>& values) {
    point_data_ += array(name, components, values);
  }
  template <typename Number>
  void add_cell_data(const char* name, int components, const std::vector<Number>& values) {
    cell_data_ += array(name, components, values);
  }

  std::string text() const {
    return fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n"
        "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<PointData>\n{}</PointData>\n"
        "<CellData>\n{}</CellData>\n<Points>\n{}</Points>\n<Cells>\n{}{}{}</Cells>\n"
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
        points(), types_.size(), point_data_, cell_data_, array("points", 3, coordinates_m_),
        array("connectivity", 1, connectivity_), array("offsets", 1, offsets_),
        array("types", 1, types_));
  }

 private:
  static const char* type_name(double) { return "Float64"; }
  static const char* type_name(std::int32_t) { return "Int32"; }
  static const char* type_name(std::uint8_t) { return "UInt8"; }

  template <typename Number>
  static std::string array(const char* name, int components, const std::vector<Number>& values) {
    // Indices shrink by much. The digits of measured numbers hardly repeat: compressing them
    // costs five times as long as all else and saves a few per cent. They are stored as they are.
    const int level = std::is_integral_v<Number> ? Z_BEST_SPEED : Z_NO_COMPRESSION;
    return fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">"
        "{}</DataArray>\n",
        type_name(Number{}), name, components, compressed(text::bytes_of(values), level));
  }

  std::vector<double> coordinates_m_;
  std::vector<std::int32_t> connectivity_, offsets_;
  std::vector<std::uint8_t> types_;
  std::string point_data_, cell_data_;
};

constexpr std::uint8_t kVertex = 1, kTriangle = 5, kPolygon = 7;

void append(std::vector<double>& numbers, const Eigen::Vector3d& vector) {
  numbers.insert(numbers.end(), vector.begin(), vector.end());
}

/// @param surfaces  of every body, in its own frame
std::string bodies_vtu(const Frame& frame,
                       const std::vector<std::vector<TriangleSurface>>& surfaces) {
  UnstructuredGrid grid;
  std::vector<std::int32_t> body_of_cell;
  std::vector<double> velocities;
  for (std::size_t body = 0; body < surfaces.size(); ++body) {
    const Eigen::Isometry3d& pose = frame.poses.at(body);
    for (const TriangleSurface& surface : surfaces[body]) {
      const std::int32_t first = grid.points();
      for (const Eigen::Vector3d& vertex : surface.vertices_m) {
        const Eigen::Vector3d point = pose * vertex;
        grid.add_point(point);
        append(velocities,
               frame.velocities_m_per_s.at(body) +
                   frame.angular_velocities_rad_per_s.at(body).cross(point - pose.translation()));
      }
      for (const auto& [i, j, k] : surface.triangles) {
        grid.add_cell(kTriangle, {first + i, first + j, first + k});
        body_of_cell.push_back(static_cast<std::int32_t>(body));
      }
    }
  }
  grid.add_point_data("velocity_m_per_s", 3, velocities);
  grid.add_cell_data("body", 1, body_of_cell);
  return grid.text();
}

/// The data of each contact, for its point and for its ellipse.
struct ContactColumns {
  std::vector<double> normal_forces_N, tangential_forces_N, torques_Nm, semi_axes_m, utilisations;
  std::vector<std::int32_t> bodies;
  std::vector<std::uint8_t> slides;

  void append(const RecordedContact& contact) {
    simulation::append(normal_forces_N, contact.normal_force_N * contact.axes.col(2));
    simulation::append(tangential_forces_N, tangential_force_N(contact));
    simulation::append(torques_Nm, contact.torque_Nm * contact.axes.col(2));
    semi_axes_m.insert(semi_axes_m.end(), {contact.semi_axis_a_m, contact.semi_axis_b_m});
    utilisations.push_back(contact.utilisation);
    bodies.insert(bodies.end(), {contact.a, contact.b});
    slides.push_back(contact.slides ? 1 : 0);
  }
  template <typename Add>
  void add_to(const Add& add) const {
    add("normal_force_N", 3, normal_forces_N);
    add("tangential_force_N", 3, tangential_forces_N);
    add("torque_about_normal_Nm", 3, torques_Nm);
    add("semi_axes_m", 2, semi_axes_m);
    add("utilisation", 1, utilisations);
    add("bodies_a_b", 2, bodies);
    add("slides", 1, slides);
  }
};

std::string contacts_vtu(const Frame& frame) {
  UnstructuredGrid grid;
  ContactColumns columns;
  for (const RecordedContact& contact : frame.contacts) {
    grid.add_cell(kVertex, {grid.points()});
    grid.add_point(contact.point_m);
    columns.append(contact);
  }
  columns.add_to([&](auto&&... column) { grid.add_point_data(column...); });
  return grid.text();
}

std::string ellipses_vtu(const Frame& frame) {
  constexpr int kCorners = 48;
  UnstructuredGrid grid;
  ContactColumns columns;
  for (const RecordedContact& contact : frame.contacts) {
    if (!(contact.semi_axis_a_m > 0 && contact.semi_axis_b_m > 0)) continue;
    std::vector<std::int32_t> corners;
    for (int i = 0; i < kCorners; ++i) {
      const double angle = 2 * kPi * i / kCorners;
      corners.push_back(grid.points());
      grid.add_point(contact.point_m +
                     contact.semi_axis_a_m * std::cos(angle) * contact.axes.col(0) +
                     contact.semi_axis_b_m * std::sin(angle) * contact.axes.col(1));
    }
    grid.add_cell(kPolygon, corners);
    columns.append(contact);
  }
  columns.add_to([&](auto&&... column) { grid.add_cell_data(column...); });
  return grid.text();
}

}  // namespace

std::string trajectory_csv(const Recording& recording) {
  std::string csv =
      "time_s,body,position_x_m,position_y_m,position_z_m,"
      "quaternion_w,quaternion_x,quaternion_y,quaternion_z,"
      "velocity_x_m_per_s,velocity_y_m_per_s,velocity_z_m_per_s,"
      "angular_velocity_x_rad_per_s,angular_velocity_y_rad_per_s,angular_velocity_z_rad_per_s\n";
  for (const Frame& frame : recording.frames)
    for (std::size_t body = 0; body < recording.bodies.size(); ++body) {
      CsvRow row(csv);
      row.append(frame.time_s);
      row.append(recording.bodies[body].name);
      row.append(frame.poses.at(body).translation());
      for (const double number : quaternion_wxyz(frame.poses.at(body))) row.append(number);
      row.append(frame.velocities_m_per_s.at(body));
      row.append(frame.angular_velocities_rad_per_s.at(body));
    }
  return csv;
}

std::string contacts_csv(const Recording& recording) {
  std::string csv =
      "time_s,body_a,body_b,point_x_m,point_y_m,point_z_m,normal_x,normal_y,normal_z,"
      "semi_axis_a_m,semi_axis_b_m,long_axis_x,long_axis_y,long_axis_z,"
      "normal_force_N,tangential_force_x_N,tangential_force_y_N,tangential_force_z_N,"
      "torque_about_normal_Nm,friction_coefficient,eccentricity_m,pressure_exponent,utilisation,"
      "slides,model,friction_law\n";
  for (const Frame& frame : recording.frames)
    for (const RecordedContact& contact : frame.contacts) {
      CsvRow row(csv);
      row.append(frame.time_s);
      row.append(recording.bodies.at(contact.a).name);
      row.append(recording.bodies.at(contact.b).name);
      row.append(contact.point_m);
      row.append(Eigen::Vector3d(contact.axes.col(2)));
      row.append(contact.semi_axis_a_m);
      row.append(contact.semi_axis_b_m);
      row.append(Eigen::Vector3d(contact.axes.col(0)));
      row.append(contact.normal_force_N);
      row.append(tangential_force_N(contact));
      for (const double number :
           {contact.torque_Nm, contact.friction_coefficient, contact.eccentricity_m,
            contact.pressure_exponent, contact.utilisation})
        row.append(number);
      row.append(std::string(contact.slides ? "true" : "false"));
      row.append(contact.model);
      row.append(std::string(contact.friction->name));
    }
  return csv;
}

json trajectory_json(const Recording& recording) {
  json bodies = json::array(), frames = json::array();
  for (const RecordedBody& body : recording.bodies) bodies.push_back(described(body));
  for (const Frame& frame : recording.frames) {
    json positions = json::array(), quaternions = json::array(), velocities = json::array(),
         angular_velocities = json::array(), contacts = json::array();
    for (const Eigen::Isometry3d& pose : frame.poses) {
      positions.push_back(numbers(pose.translation()));
      quaternions.push_back(numbers(quaternion_wxyz(pose)));
    }
    for (const Eigen::Vector3d& velocity : frame.velocities_m_per_s)
      velocities.push_back(numbers(velocity));
    for (const Eigen::Vector3d& velocity : frame.angular_velocities_rad_per_s)
      angular_velocities.push_back(numbers(velocity));
    for (const RecordedContact& contact : frame.contacts) contacts.push_back(described(contact));
    frames.push_back({{"time_s", frame.time_s},
                      {"position_m", std::move(positions)},
                      {"quaternion_wxyz", std::move(quaternions)},
                      {"velocity_m_per_s", std::move(velocities)},
                      {"angular_velocity_rad_per_s", std::move(angular_velocities)},
                      {"contacts", std::move(contacts)}});
  }
  return {{"scene", recording.scene},
          {"question", recording.question},
          {"time_step_s", recording.time_step_s},
          {"bodies", std::move(bodies)},
          {"frames", std::move(frames)}};
}

void write_trajectory(const Recording& recording, const std::filesystem::path& folder) {
  system::write_files_together(
      {{folder / "trajectory.csv", trajectory_csv(recording)},
       {folder / "contacts.csv", contacts_csv(recording)},
       {folder / "trajectory.json",
        // Names may hold bytes that are not UTF-8: these are replaced.
        trajectory_json(recording).dump(-1, ' ', false, json::error_handler_t::replace) + "\n"}});
}

void write_vtu(const Recording& recording, const std::filesystem::path& folder, int every_nth) {
  if (every_nth < 1) throw std::invalid_argument("write_vtu: every_nth must be at least 1");
  const double width_m = half_space_width_m(recording);
  std::vector<std::vector<TriangleSurface>> surfaces(recording.bodies.size());
  for (std::size_t body = 0; body < surfaces.size(); ++body)
    for (const input::Shape& shape : recording.bodies[body].shapes)
      surfaces[body].push_back(triangulate(shape, width_m));

  system::make_writable_folder(folder / "frames");
  std::string collection;
  const std::size_t count = recording.frames.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (i % every_nth != 0 && i + 1 != count) continue;
    const Frame& frame = recording.frames[i];
    int part = 0;
    for (const auto& [kind, content] :
         {std::pair{"bodies", bodies_vtu(frame, surfaces)},
          std::pair{"contacts", contacts_vtu(frame)}, std::pair{"ellipses", ellipses_vtu(frame)}}) {
      const std::string name = fmt::format("frames/{}_{:06}.vtu", kind, i);
      system::write_file_atomically(folder / name, content);
      collection += fmt::format("<DataSet timestep=\"{}\" part=\"{}\" name=\"{}\" file=\"{}\"/>\n",
                                frame.time_s, part++, kind, name);
    }
  }
  // Written last, so that all files that it names exist.
  system::write_file_atomically(
      folder / "motion.pvd",
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n" +
          collection + "</Collection>\n</VTKFile>\n");
}

}  // namespace softfinger::simulation
