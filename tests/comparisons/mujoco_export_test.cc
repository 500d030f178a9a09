// Output of `softfinger export --to mujoco`, run in the real MuJoCo: a fingertip is pressed on an
// object that sets no friction, pushed and twisted, and must slip where the friction ellipsoid
// says.
//
// MuJoCo's friction is soft, so the criteria are accelerations. Held: the velocity no longer
// changes, and a second after the load came it is far below what the load alone gives. Slipping:
// the acceleration is that of load less friction, (T - T_max)/I, which measures T_max.

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace {

using nlohmann::json;

/// Relative, of the limit: the exported lines carry six digits, and the load settles to 1e-6.
constexpr double kTolerance = 1e-5;
/// Shares of the limit: a hundred times that away from it.
constexpr double kBelow = 0.999, kAbove = 1.001;

constexpr double kMass_kg = 0.02, kRadius_m = 0.02, kTimeStep_s = 1e-3;
constexpr double kInertia_kgm2 = 0.4 * kMass_kg * kRadius_m * kRadius_m;

/// A ball on a block, without gravity; it can move, and turn about z only, so that it neither rolls
/// nor tips. The block keeps MuJoCo's default friction: 1 and 5 mm, more than the fingertip's.
std::string world(const std::string& exported_lines) {
  const std::string radius = std::to_string(kRadius_m);
  return "<mujoco>\n" + exported_lines + "<option gravity=\"0 0 0\" timestep=\"" +
         std::to_string(kTimeStep_s) +
         "\" solver=\"Newton\" iterations=\"200\" tolerance=\"1e-14\"/>\n"
         "<worldbody>\n"
         "  <geom type=\"box\" size=\"1 1 0.1\" pos=\"0 0 -0.1\"/>\n"
         "  <body pos=\"0 0 " +
         radius +
         "\">\n"
         "    <joint type=\"slide\" axis=\"1 0 0\"/>\n"
         "    <joint type=\"slide\" axis=\"0 1 0\"/>\n"
         "    <joint type=\"slide\" axis=\"0 0 1\"/>\n"
         "    <joint type=\"hinge\" axis=\"0 0 1\"/>\n"
         "    <geom class=\"soft_finger\" type=\"sphere\" size=\"" +
         radius + "\" mass=\"" + std::to_string(kMass_kg) +
         "\"/>\n"
         "  </body>\n"
         "</worldbody>\n"
         "</mujoco>\n";
}

/// A second after the load came; the accelerations are means over its second half.
struct Motion {
  double velocity_m_per_s = 0, angular_velocity_rad_per_s = 0;
  double acceleration_m_per_s2 = 0, angular_acceleration_rad_per_s2 = 0;
};

class MujocoExport : public testing::Test {
 protected:
  using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
  using Data = std::unique_ptr<mjData, decltype(&mj_deleteData)>;

  TemporaryFolder folder;
  json exported;
  Model model{nullptr, mj_deleteModel};
  double load_N = 0, friction = 0, max_torque_Nm = 0;

  /// The world with what the program prints; `left_out` is taken from that.
  void load_world(const std::vector<std::string>& options, const std::string& left_out = "") {
    std::vector<std::string> arguments = {"export", "silicone_pad_2mm", "--to", "mujoco", "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramRun run = run_softfinger({folder.path(), {}, -1, ""}, arguments);
    ASSERT_EQ(run.status, 0) << run.err;
    exported = json::parse(run.out);
    load_N = exported["load_N"];
    friction = exported["friction_coefficient"];
    max_torque_Nm = friction * load_N * exported["eccentricity_m"].get<double>();
    std::string pasted = exported["lines"];
    const std::size_t at = pasted.find(left_out);
    ASSERT_NE(at, std::string::npos) << pasted;
    const auto file = folder.write("world.xml", world(pasted.erase(at, left_out.size())));
    char error[1000] = "";
    model.reset(mj_loadXML(file.c_str(), nullptr, error, sizeof error));
    ASSERT_TRUE(model) << error << "\n" << file_text(file);
  }

  void run(mjData* data, double duration_s) const {
    const int steps = static_cast<int>(std::lround(duration_s / kTimeStep_s));
    for (int i = 0; i < steps; ++i) mj_step(model.get(), data);
  }

  /// Pressed for half a second: until the soft contact is at rest.
  Data pressed() const {
    Data data(mj_makeData(model.get()), mj_deleteData);
    data->qfrc_applied[2] = -load_N;
    run(data.get(), 0.5);
    return data;
  }

  /// After pressing, also pushes and twists for a second.
  Motion move(double push_N, double torque_Nm) const {
    const Data data = pressed();
    data->qfrc_applied[0] = push_N;
    data->qfrc_applied[3] = torque_Nm;
    run(data.get(), 0.5);
    const double velocity = data->qvel[0], angular_velocity = data->qvel[3];
    run(data.get(), 0.5);
    return {data->qvel[0], data->qvel[3], (data->qvel[0] - velocity) / 0.5,
            (data->qvel[3] - angular_velocity) / 0.5};
  }

  void expect_slip_at(double torque_Nm) const {
    const double limit = torque_Nm / kInertia_kgm2;
    for (const int sense : {1, -1}) {
      const Motion held = move(0, sense * kBelow * torque_Nm);
      EXPECT_NEAR(held.angular_acceleration_rad_per_s2, 0, kTolerance * limit);
      EXPECT_NEAR(held.angular_velocity_rad_per_s, 0, kTolerance * limit);
      const Motion slipping = move(0, sense * kAbove * torque_Nm);
      EXPECT_NEAR(slipping.angular_acceleration_rad_per_s2, sense * (kAbove - 1) * limit,
                  kTolerance * limit);
    }
  }
};

TEST_F(MujocoExport, GivesTheContactTheExportedFriction) {
  load_world({});
  const Data data = pressed();
  ASSERT_EQ(data->ncon, 1);
  EXPECT_EQ(data->contact[0].dim, 4);
  EXPECT_NEAR(data->contact[0].friction[0] / friction, 1, kTolerance);
  EXPECT_NEAR(data->contact[0].friction[2] / (max_torque_Nm / load_N), 1, kTolerance)
      << "the block's larger default must not count";
}

TEST_F(MujocoExport, SlipsAtThePredictedTorque) {
  for (const char* load : {"0.5", "2", "10"}) {
    SCOPED_TRACE(load);
    load_world({"--load", load});
    expect_slip_at(max_torque_Nm);
  }
}

TEST_F(MujocoExport, HasTheErrorsOfTheTableAtOtherLoads) {
  for (const char* fit : {"nominal", "range"}) {
    load_world({"--fit", fit});
    for (const json& point : exported["loads"]) {
      load_N = point["load_N"];
      SCOPED_TRACE(load_N);
      expect_slip_at(point["max_torque_Nm"].get<double>() *
                     (1 + point["relative_error"].get<double>()));
    }
  }
}

TEST_F(MujocoExport, SlipsOnTheEllipsoidUnderForceAndTorque) {
  load_world({});
  const double limit_N = friction * load_N;
  for (const double share : {0.3, 0.6, 0.9}) {  // of the force that slides without torque
    SCOPED_TRACE(share);
    const double push_N = share * limit_N;
    const double torque_Nm = std::sqrt(1 - share * share) * max_torque_Nm;
    const Motion held = move(kBelow * push_N, kBelow * torque_Nm);
    EXPECT_NEAR(held.acceleration_m_per_s2, 0, kTolerance * limit_N / kMass_kg);
    EXPECT_NEAR(held.angular_acceleration_rad_per_s2, 0,
                kTolerance * max_torque_Nm / kInertia_kgm2);
    const Motion slipping = move(kAbove * push_N, kAbove * torque_Nm);
    const double friction_N = kAbove * push_N - kMass_kg * slipping.acceleration_m_per_s2;
    const double friction_Nm =
        kAbove * torque_Nm - kInertia_kgm2 * slipping.angular_acceleration_rad_per_s2;
    EXPECT_NEAR(std::hypot(friction_N / limit_N, friction_Nm / max_torque_Nm), 1, kTolerance);
  }
}

TEST_F(MujocoExport, WithoutNoslipTurnsAtTheSlidingCreepOverTheEccentricity) {
  load_world({}, " noslip_iterations=\"5\"");
  // Impedance 0.95 and damping b = 2/(0.95 · 20 ms): (1 - 0.95)/(0.95 b) = 0.5 ms, over impratio.
  const double creep_m_per_s = friction * load_N / kMass_kg * 0.5e-3 / 10;
  const double share = 0.5;
  const Motion pushed = move(share * friction * load_N, 0);
  const Motion twisted = move(0, share * max_torque_Nm);
  EXPECT_NEAR(pushed.velocity_m_per_s / (share * creep_m_per_s), 1, 1e-3);
  EXPECT_NEAR(twisted.angular_velocity_rad_per_s * exported["eccentricity_m"].get<double>() /
                  (share * creep_m_per_s),
              1, 1e-3);
  EXPECT_NEAR(twisted.angular_acceleration_rad_per_s2, 0,
              kTolerance * max_torque_Nm / kInertia_kgm2);
}

}  // namespace
}  // namespace softfinger::tests
