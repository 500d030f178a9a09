#include "comparisons/simulation/trajectory_files.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "comparisons/simulation/vtu_files.h"
#include "comparisons/system/files.h"
#include "sample_motion.h"
#include "softfinger/input/errors.h"

namespace softfinger::simulation {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class TrajectoryFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("softfinger_trajectory." + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

/// A table by its column names; quoted cells as RFC 4180 has them.
struct Table {
  std::map<std::string, std::size_t> columns;
  std::vector<std::vector<std::string>> rows;

  explicit Table(const std::string& csv) {
    std::vector<std::vector<std::string>> lines(1);
    std::string cell;
    bool is_quoted = false;
    for (std::size_t i = 0; i < csv.size(); ++i) {
      if (csv[i] == '"' && is_quoted && i + 1 < csv.size() && csv[i + 1] == '"') {
        cell += csv[i++];
      } else if (csv[i] == '"') {
        is_quoted = !is_quoted;
      } else if (!is_quoted && (csv[i] == ',' || csv[i] == '\n')) {
        lines.back().push_back(std::move(cell));
        cell.clear();
        if (csv[i] == '\n') lines.emplace_back();
      } else {
        cell += csv[i];
      }
    }
    for (std::size_t i = 0; i < lines.front().size(); ++i) columns[lines.front()[i]] = i;
    // After the last line end stands nothing.
    rows.assign(lines.begin() + 1, lines.end() - 1);
    for (const std::vector<std::string>& row : rows)
      if (row.size() != lines.front().size()) throw std::runtime_error("a row of another length");
  }
  const std::string& text(std::size_t row, const std::string& column) const {
    return rows.at(row).at(columns.at(column));
  }
  double number(std::size_t row, const std::string& column) const {
    return std::stod(text(row, column));
  }
  Eigen::Vector3d vector(std::size_t row, const std::string& before,
                         const std::string& after) const {
    return {number(row, before + "x" + after), number(row, before + "y" + after),
            number(row, before + "z" + after)};
  }
};

/// Rounding of a rotation matrix to a quaternion and back.
constexpr double kTurn = 8 * std::numeric_limits<double>::epsilon();

TEST_F(TrajectoryFiles, CsvGivesEveryPoseAndVelocityBackExactly) {
  const Recording recording = tests::sample_motion(40);
  const Table table(trajectory_csv(recording));
  ASSERT_EQ(table.rows.size(), 41u * 4);
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const Frame& frame = recording.frames[row / 4];
    const std::size_t body = row % 4;
    EXPECT_EQ(table.number(row, "time_s"), frame.time_s);
    EXPECT_EQ(table.text(row, "body"), recording.bodies[body].name);
    EXPECT_EQ(table.vector(row, "position_", "_m"), frame.poses[body].translation());
    EXPECT_EQ(table.vector(row, "velocity_", "_m_per_s"), frame.velocities_m_per_s[body]);
    EXPECT_EQ(table.vector(row, "angular_velocity_", "_rad_per_s"),
              frame.angular_velocities_rad_per_s[body]);
    const Eigen::Quaterniond turn(
        table.number(row, "quaternion_w"), table.number(row, "quaternion_x"),
        table.number(row, "quaternion_y"), table.number(row, "quaternion_z"));
    EXPECT_GE(turn.w(), 0);
    EXPECT_LE((turn.toRotationMatrix() - frame.poses[body].linear()).norm(), kTurn);
  }
}

TEST_F(TrajectoryFiles, CsvGivesEveryContactBackExactly) {
  const Recording recording = tests::sample_motion(40);
  const Table table(contacts_csv(recording));
  std::size_t row = 0;
  for (const Frame& frame : recording.frames)
    for (const RecordedContact& contact : frame.contacts) {
      EXPECT_EQ(table.number(row, "time_s"), frame.time_s);
      EXPECT_EQ(table.text(row, "body_a"), recording.bodies[contact.a].name);
      EXPECT_EQ(table.text(row, "body_b"), recording.bodies[contact.b].name);
      EXPECT_EQ(table.vector(row, "point_", "_m"), contact.point_m);
      EXPECT_EQ(table.vector(row, "normal_", ""), contact.axes.col(2));
      EXPECT_EQ(table.vector(row, "long_axis_", ""), contact.axes.col(0));
      const Eigen::Vector3d force_N = table.vector(row, "tangential_force_", "_N");
      EXPECT_EQ(force_N, contact.tangent_force_1_N * contact.axes.col(0) +
                             contact.tangent_force_2_N * contact.axes.col(1));
      for (const auto& [column, value] : {std::pair{"semi_axis_a_m", contact.semi_axis_a_m},
                                          {"semi_axis_b_m", contact.semi_axis_b_m},
                                          {"normal_force_N", contact.normal_force_N},
                                          {"torque_about_normal_Nm", contact.torque_Nm},
                                          {"friction_coefficient", contact.friction_coefficient},
                                          {"eccentricity_m", contact.eccentricity_m},
                                          {"pressure_exponent", contact.pressure_exponent},
                                          {"utilisation", contact.utilisation}})
        EXPECT_EQ(table.number(row, column), value) << column;
      EXPECT_EQ(table.text(row, "slides"), contact.slides ? "true" : "false");
      EXPECT_EQ(table.text(row, "model"), contact.model);
      EXPECT_EQ(table.text(row, "friction_law"), contact.friction->name);
      ++row;
    }
  EXPECT_EQ(row, table.rows.size());
}

TEST_F(TrajectoryFiles, CsvQuotesNamesThatNeedIt) {
  Recording recording = tests::motion_of_one_frame();
  recording.bodies[0].name = "a \"long\", thin\nfinger";
  EXPECT_EQ(Table(trajectory_csv(recording)).text(0, "body"), recording.bodies[0].name);
  EXPECT_EQ(Table(contacts_csv(recording)).text(0, "body_a"), recording.bodies[0].name);
}

TEST_F(TrajectoryFiles, JsonSaysTheSameAndNamesTheShapes) {
  const Recording recording = tests::sample_motion(40);
  write_trajectory(recording, folder_);
  EXPECT_EQ(system::read_text_file(folder_ / "trajectory.csv"), trajectory_csv(recording));
  EXPECT_EQ(system::read_text_file(folder_ / "contacts.csv"), contacts_csv(recording));
  const json read = json::parse(system::read_text_file(folder_ / "trajectory.json"));
  EXPECT_EQ(system::read_text_file(folder_ / "trajectory.json"), trajectory_json(recording));
  EXPECT_EQ(read["scene"], "box_in_pinch");
  EXPECT_EQ(read["bodies"][0]["shapes"][0]["kind"], "capsule");
  EXPECT_EQ(read["bodies"][2]["shapes"][0]["size_m"], json({0.03, 0.02, 0.07}));
  EXPECT_EQ(read["bodies"][3]["shapes"][0]["kind"], "half_space");
  EXPECT_EQ(read["bodies"][3]["movable"], false);
  ASSERT_EQ(read["frames"].size(), recording.frames.size());
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const Frame& frame = recording.frames[i];
    const json& written = read["frames"][i];
    EXPECT_EQ(written["time_s"], frame.time_s);
    for (std::size_t body = 0; body < 4; ++body)
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(written["position_m"][body][axis], frame.poses[body].translation()[axis]);
        EXPECT_EQ(written["velocity_m_per_s"][body][axis], frame.velocities_m_per_s[body][axis]);
        EXPECT_EQ(written["angular_velocity_rad_per_s"][body][axis],
                  frame.angular_velocities_rad_per_s[body][axis]);
      }
    ASSERT_EQ(written["contacts"].size(), frame.contacts.size());
    for (std::size_t k = 0; k < frame.contacts.size(); ++k) {
      const RecordedContact& contact = frame.contacts[k];
      const auto numbers = [](const Eigen::Vector3d& vector) {
        return std::vector<double>(vector.begin(), vector.end());
      };
      const json expected = {
          {"a", contact.a},
          {"b", contact.b},
          {"point_m", numbers(contact.point_m)},
          {"normal", numbers(contact.axes.col(2))},
          {"long_axis", numbers(contact.axes.col(0))},
          {"semi_axes_m", {contact.semi_axis_a_m, contact.semi_axis_b_m}},
          {"normal_force_N", contact.normal_force_N},
          {"tangential_force_N", numbers(contact.tangent_force_1_N * contact.axes.col(0) +
                                         contact.tangent_force_2_N * contact.axes.col(1))},
          {"torque_about_normal_Nm", contact.torque_Nm},
          {"friction_coefficient", contact.friction_coefficient},
          {"eccentricity_m", contact.eccentricity_m},
          {"pressure_exponent", contact.pressure_exponent},
          {"utilisation", contact.utilisation},
          {"slides", contact.slides},
          {"model", contact.model},
          {"friction_law", std::string(contact.friction->name)}};
      EXPECT_EQ(written["contacts"][k], expected);
    }
  }
}

TEST_F(TrajectoryFiles, JsonOfNamesThatAreNotUtf8IsStillRead) {
  Recording recording = tests::motion_of_one_frame();
  recording.bodies[0].name = "finger \xff\"\n";
  recording.frames[0].contacts[0].model = "own \xff";
  const json read = json::parse(trajectory_json(recording));
  EXPECT_EQ(read["bodies"][0]["name"], "finger \xef\xbf\xbd\"\n");
  EXPECT_EQ(read["frames"][0]["contacts"][0]["model"], "own \xef\xbf\xbd");
}

TEST_F(TrajectoryFiles, EmptyMotionsLeaveHeadersOnly) {
  const Recording nothing = tests::empty_motion();
  EXPECT_TRUE(Table(trajectory_csv(nothing)).rows.empty());
  EXPECT_TRUE(Table(contacts_csv(tests::motion_without_contacts())).rows.empty());
  EXPECT_EQ(json::parse(trajectory_json(nothing))["frames"], json::array());
}

TEST_F(TrajectoryFiles, AContactWithAnUnknownBodyIsRefused) {
  Recording recording = tests::motion_of_one_frame();
  recording.frames[0].contacts[0].a = -1;
  EXPECT_THROW(contacts_csv(recording), std::out_of_range);
}

TEST_F(TrajectoryFiles, AFolderThatDoesNotExistIsNamed) {
  try {
    write_trajectory(tests::motion_of_one_frame(), folder_ / "missing");
    FAIL() << "written to nowhere";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("missing"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

/// The array of that name in a VTU file, as a reader of appended raw data and
/// vtkZLibDataCompressor takes it.
template <typename Number>
std::vector<Number> vtu_array(const std::string& vtu, const std::string& name) {
  if (vtu.find("compressor=\"vtkZLibDataCompressor\"") == std::string::npos)
    throw std::runtime_error("the file names no compressor");
  const std::string type = std::is_same_v<Number, float>          ? "Float32"
                           : std::is_same_v<Number, double>       ? "Float64"
                           : std::is_same_v<Number, std::int32_t> ? "Int32"
                                                                  : "UInt8";
  const std::string start = "<AppendedData encoding=\"raw\">\n_";
  std::size_t at = vtu.find(start);
  const std::string xml = vtu.substr(0, at);
  std::smatch found;
  if (!std::regex_search(xml, found,
                         std::regex("<DataArray type=\"" + type + "\" Name=\"" + name +
                                    "\"[^>]* format=\"appended\" offset=\"([0-9]+)\"/>")))
    throw std::runtime_error("no array " + name + " of " + type);
  at += start.size() + std::stoul(found[1]);
  const auto next = [&] {
    std::uint64_t number = 0;
    std::memcpy(&number, vtu.substr(at, sizeof number).data(), sizeof number);
    at += sizeof number;
    return number;
  };
  const std::uint64_t blocks = next(), size = next(), incomplete = next();
  std::vector<Number> numbers;
  if (blocks == 0) return numbers;
  const std::uint64_t compressed = next();
  const std::string bytes = vtu.substr(at, compressed);
  if (blocks != 1 || incomplete != 0) throw std::runtime_error(name + " has another header");
  numbers.resize(size / sizeof(Number));
  uLongf inflated = size;
  if (uncompress(reinterpret_cast<Bytef*>(numbers.data()), &inflated,
                 reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) != Z_OK ||
      inflated != size)
    throw std::runtime_error(name + " has another size");
  return numbers;
}

std::size_t stated(const std::string& vtu, const std::string& attribute) {
  std::smatch found;
  if (!std::regex_search(vtu, found, std::regex(attribute + "=\"([0-9]+)\"")))
    throw std::runtime_error("no " + attribute);
  return std::stoul(found[1]);
}

template <typename Number>
Eigen::Vector3d third(const std::vector<Number>& numbers, std::size_t i) {
  return {numbers.at(3 * i), numbers.at(3 * i + 1), numbers.at(3 * i + 2)};
}

TEST_F(TrajectoryFiles, VtuHoldsBodiesWhereTheyAre) {
  const Recording recording = tests::sample_motion(40);
  write_vtu(recording, folder_);
  const Frame& frame = recording.frames[30];
  const std::string vtu = system::read_text_file(folder_ / "frames/bodies_000030.vtu");
  const auto points_m = vtu_array<float>(vtu, "points");
  const auto corners = vtu_array<std::int32_t>(vtu, "connectivity");
  const auto offsets = vtu_array<std::int32_t>(vtu, "offsets");
  const auto types = vtu_array<std::uint8_t>(vtu, "types");
  const auto bodies = vtu_array<std::int32_t>(vtu, "body");
  const auto velocities = vtu_array<float>(vtu, "velocity_m_per_s");
  const std::size_t cells = stated(vtu, "NumberOfCells");
  ASSERT_EQ(points_m.size(), 3 * stated(vtu, "NumberOfPoints"));
  ASSERT_EQ(velocities.size(), points_m.size());
  ASSERT_EQ(corners.size(), 3 * cells);
  ASSERT_EQ(offsets.size(), cells);
  ASSERT_EQ(types.size(), cells);
  ASSERT_EQ(bodies.size(), cells);
  const Eigen::Vector3d half(0.015, 0.01, 0.035);
  // Single precision of coordinates below half a metre.
  constexpr double kRounding_m = 0.5 * std::numeric_limits<float>::epsilon();
  int of_box = 0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    EXPECT_EQ(types[cell], 5) << "a triangle";
    EXPECT_EQ(offsets[cell], static_cast<std::int32_t>(3 * (cell + 1)));
    if (bodies[cell] != 2) continue;
    ++of_box;
    for (int corner = 0; corner < 3; ++corner) {
      const Eigen::Vector3d point_m = third(points_m, corners[3 * cell + corner]);
      ASSERT_LT(point_m.norm(), 0.5);
      const Eigen::Vector3d in_box = frame.poses[2].inverse() * point_m;
      EXPECT_LE((in_box.cwiseAbs() - half).norm(), kRounding_m) << in_box.transpose();
      const Eigen::Vector3d velocity =
          frame.velocities_m_per_s[2] +
          frame.angular_velocities_rad_per_s[2].cross(point_m - frame.poses[2].translation());
      EXPECT_LE((third(velocities, corners[3 * cell + corner]) - velocity).norm(),
                std::numeric_limits<float>::epsilon());
    }
  }
  EXPECT_EQ(of_box, 12);
  EXPECT_EQ(std::count(bodies.begin(), bodies.end(), 3), 0) << "the table is in another file";
}

TEST_F(TrajectoryFiles, FixedBodiesAreWrittenOnceAndShownAtAllTimes) {
  const Recording recording = tests::sample_motion(40);
  write_vtu(recording, folder_, 10);
  const std::string vtu = system::read_text_file(folder_ / "frames/fixed.vtu");
  EXPECT_EQ(vtu_array<std::int32_t>(vtu, "body"), std::vector<std::int32_t>({3, 3}));
  const auto velocities = vtu_array<float>(vtu, "velocity_m_per_s");
  EXPECT_EQ(std::count(velocities.begin(), velocities.end(), 0.f), 12);
  const std::string pvd = system::read_text_file(folder_ / "motion.pvd");
  const std::regex entry("part=\"3\" name=\"fixed\" file=\"frames/fixed.vtu\"/>");
  EXPECT_EQ(std::distance(std::sregex_iterator(pvd.begin(), pvd.end(), entry), {}), 5);
}

TEST_F(TrajectoryFiles, UsualVtuFilesStayWithinTheirBytes) {
  const Recording recording = tests::large_motion();
  const auto bytes = [&](std::size_t most_bytes) {
    write_vtu(recording, folder_, usual_vtu_interval(recording, most_bytes));
    std::size_t sum = 0;
    for (const auto& file : fs::directory_iterator(folder_ / "frames"))
      if (file.path().filename().string().find("bodies") == 0) sum += file.file_size();
    fs::remove_all(folder_ / "frames");
    return sum;
  };
  const std::size_t most = std::size_t(4) << 20;
  EXPECT_LE(bytes(most), most);
  EXPECT_GT(bytes(2 * most), most) << "half of what is allowed is used";
  EXPECT_EQ(usual_vtu_interval(recording, std::size_t(1) << 40), 13) << "at most 150 of 1801";
  EXPECT_EQ(usual_vtu_interval(tests::motion_of_one_frame()), 1);
}

TEST_F(TrajectoryFiles, VtuHoldsContactsAndTheirEllipses) {
  const Recording recording = tests::sample_motion(40);
  write_vtu(recording, folder_);
  const Frame& frame = recording.frames.front();
  ASSERT_EQ(frame.contacts.size(), 6u);
  const std::string contacts = system::read_text_file(folder_ / "frames/contacts_000000.vtu");
  EXPECT_EQ(stated(contacts, "NumberOfPoints"), 6u);
  const auto points_m = vtu_array<double>(contacts, "points");
  const auto normal_forces_N = vtu_array<double>(contacts, "normal_force_N");
  const auto bodies = vtu_array<std::int32_t>(contacts, "bodies_a_b");
  for (std::size_t i = 0; i < 6; ++i) {
    const RecordedContact& contact = frame.contacts[i];
    EXPECT_EQ(third(points_m, i), contact.point_m);
    EXPECT_EQ(third(normal_forces_N, i), contact.normal_force_N * contact.axes.col(2));
    EXPECT_EQ(bodies[2 * i], contact.a);
    EXPECT_EQ(bodies[2 * i + 1], contact.b);
  }
  // Four of the six are points.
  const std::string ellipses = system::read_text_file(folder_ / "frames/ellipses_000000.vtu");
  EXPECT_EQ(stated(ellipses, "NumberOfCells"), 2u);
  EXPECT_EQ(vtu_array<double>(ellipses, "utilisation").size(), 2u);
  const auto rim_m = vtu_array<double>(ellipses, "points");
  const RecordedContact& first = frame.contacts[0];
  const auto offsets = vtu_array<std::int32_t>(ellipses, "offsets");
  for (std::int32_t i = 0; i < offsets[0]; ++i) {
    const Eigen::Vector3d local = first.axes.transpose() * (third(rim_m, i) - first.point_m);
    EXPECT_NEAR(std::hypot(local.x() / first.semi_axis_a_m, local.y() / first.semi_axis_b_m), 1,
                1e-12);
    EXPECT_NEAR(local.z(), 0, 1e-17);
  }
}

TEST_F(TrajectoryFiles, PvdNamesEveryNthFrameAndTheLast) {
  const Recording recording = tests::sample_motion(40);
  write_vtu(recording, folder_, 7);
  const std::string pvd = system::read_text_file(folder_ / "motion.pvd");
  const std::regex entry("<DataSet timestep=\"([^\"]+)\" part=\"([0-3])\"[^>]*file=\"([^\"]+)\"/>");
  std::vector<double> times;
  std::size_t files = 0;
  for (std::sregex_iterator it(pvd.begin(), pvd.end(), entry), end; it != end; ++it, ++files) {
    EXPECT_TRUE(fs::exists(folder_ / (*it)[3].str())) << (*it)[3];
    if ((*it)[2] == "0") times.push_back(std::stod((*it)[1]));
  }
  std::vector<double> expected;
  for (const int i : {0, 7, 14, 21, 28, 35, 40}) expected.push_back(recording.frames[i].time_s);
  EXPECT_EQ(times, expected);
  EXPECT_EQ(files, 4 * expected.size());
  EXPECT_THROW(write_vtu(recording, folder_, 0), std::invalid_argument);
}

TEST_F(TrajectoryFiles, VtuOfNothingIsStillAFile) {
  write_vtu(tests::motion_without_contacts(), folder_, 1000);
  const std::string contacts = system::read_text_file(folder_ / "frames/contacts_000000.vtu");
  EXPECT_EQ(stated(contacts, "NumberOfPoints"), 0u);
  EXPECT_TRUE(vtu_array<double>(contacts, "points").empty());
  write_vtu(tests::empty_motion(), folder_ / "empty");
  EXPECT_EQ(system::read_text_file(folder_ / "empty/motion.pvd").find("DataSet"),
            std::string::npos);
}

}  // namespace
}  // namespace softfinger::simulation
