#include "comparisons/simulation/trajectory_files.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "comparisons/system/files.h"
#include "comparisons/text/csv.h"

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

/// Writes the fewest digits that give the number back exactly.
void append_shortest(std::string& text, double number) {
  char digits[32];
  text.append(digits, std::to_chars(std::begin(digits), std::end(digits), number).ptr);
}

/// A row of a table, one cell after the other (RFC 4180).
class CsvRow {
 public:
  explicit CsvRow(std::string& table) : table_(table) {}
  ~CsvRow() { table_ += '\n'; }
  void append(double number) { append_shortest(cell(), number); }
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

/// Names may hold bytes that are not UTF-8: these are replaced.
std::string dumped(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

/// Values as JSON text, without the objects in between: a motion has millions of numbers.
void append(std::string& text, double number) {
  if (std::isfinite(number))
    append_shortest(text, number);
  else
    text += "null";
}
template <typename Append, typename List>
void append_list(std::string& text, const List& list, const Append& append_one) {
  text += '[';
  bool first = true;
  for (const auto& one : list) {
    if (!first) text += ',';
    first = false;
    append_one(one);
  }
  text += ']';
}
template <typename Scalar, int rows>
void append(std::string& text, const Eigen::Matrix<Scalar, rows, 1>& vector) {
  append_list(text, vector, [&](double number) { append(text, number); });
}

void append(std::string& text, const RecordedContact& contact) {
  const auto add = [&](const char* key, const auto& value) {
    text += key;
    append(text, value);
  };
  text += fmt::format("{{\"a\":{},\"b\":{}", contact.a, contact.b);
  add(",\"point_m\":", contact.point_m);
  add(",\"normal\":", Eigen::Vector3d(contact.axes.col(2)));
  add(",\"long_axis\":", Eigen::Vector3d(contact.axes.col(0)));
  add(",\"semi_axes_m\":", Eigen::Vector2d(contact.semi_axis_a_m, contact.semi_axis_b_m));
  add(",\"normal_force_N\":", contact.normal_force_N);
  add(",\"tangential_force_N\":", tangential_force_N(contact));
  add(",\"torque_about_normal_Nm\":", contact.torque_Nm);
  add(",\"friction_coefficient\":", contact.friction_coefficient);
  add(",\"eccentricity_m\":", contact.eccentricity_m);
  add(",\"pressure_exponent\":", contact.pressure_exponent);
  add(",\"utilisation\":", contact.utilisation);
  text += ",\"slides\":" + std::string(contact.slides ? "true" : "false");
  text += ",\"model\":" + dumped(contact.model);
  text += ",\"friction_law\":" + dumped(std::string(contact.friction->name)) + "}";
}

void append(std::string& text, const Frame& frame) {
  const auto append_one = [&](const auto& value) { append(text, value); };
  text += "{\"time_s\":";
  append(text, frame.time_s);
  text += ",\"position_m\":";
  append_list(text, frame.poses, [&](const Eigen::Isometry3d& pose) {
    append(text, Eigen::Vector3d(pose.translation()));
  });
  text += ",\"quaternion_wxyz\":";
  append_list(text, frame.poses,
              [&](const Eigen::Isometry3d& pose) { append(text, quaternion_wxyz(pose)); });
  text += ",\"velocity_m_per_s\":";
  append_list(text, frame.velocities_m_per_s, append_one);
  text += ",\"angular_velocity_rad_per_s\":";
  append_list(text, frame.angular_velocities_rad_per_s, append_one);
  text += ",\"contacts\":";
  append_list(text, frame.contacts, append_one);
  text += '}';
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

std::string trajectory_json(const Recording& recording) {
  json bodies = json::array();
  for (const RecordedBody& body : recording.bodies) bodies.push_back(described(body));
  std::string text = dumped({{"scene", recording.scene},
                             {"question", recording.question},
                             {"time_step_s", recording.time_step_s},
                             {"bodies", std::move(bodies)}});
  text.back() = ',';
  text += "\"frames\":";
  append_list(text, recording.frames, [&](const Frame& frame) { append(text, frame); });
  return text + "}\n";
}

void write_trajectory(const Recording& recording, const std::filesystem::path& folder) {
  system::write_files_together({{folder / "trajectory.csv", trajectory_csv(recording)},
                                {folder / "contacts.csv", contacts_csv(recording)},
                                {folder / "trajectory.json", trajectory_json(recording)}});
}

}  // namespace softfinger::simulation
