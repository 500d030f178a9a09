// Robots' files as scenes, against MuJoCo itself: mass matrix, free motion, and what is refused.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>

#include "comparisons/input/scene.h"
#include "comparisons/robots/mujoco_scene.h"
#include "comparisons/simulation/simulate.h"
#include "softfinger/dynamics/time_stepper.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace {

namespace fs = std::filesystem;

/// Two joints on a body, a rotor, a slide, a welded body, and a shape of each kind that has mass.
const char* const kArm = R"(<mujoco model="arm">
  <option timestep="0.001"/>
  <worldbody>
    <body name="upper" pos="0.1 0.2 0.3" euler="10 20 30">
      <joint name="shoulder" type="hinge" axis="0 1 0.2" pos="0.01 0 0.02" armature="0.01"/>
      <joint name="twist" type="hinge" axis="1 0 0"/>
      <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03" mass="1.2"/>
      <geom type="box" pos="0.2 0.05 0" size=".05 .02 .03" euler="0 40 0" mass=".4"/>
      <body name="lower" pos="0.42 0 0" euler="0 35 0">
        <joint name="elbow" type="hinge" axis="0 1 0" range="-150 150" limited="true"/>
        <geom type="cylinder" fromto="0 0 0 0.3 0 0.02" size="0.025" mass="0.8"/>
        <body name="tip" pos="0.33 0 0.03">
          <joint name="slide" type="slide" axis="1 0 .3" range="-5 5" limited="true"/>
          <geom type="sphere" size="0.04" mass="0.3"/>
          <body name="flap" pos="0 0.05 0">
            <geom type="ellipsoid" size="0.03 0.02 0.01" mass="0.1" pos="0 0.02 0"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>)";

const char* const kPendulum = R"(<robot name="pendulum">
  <link name="base"/>
  <link name="rod">
    <inertial><origin xyz="0.05 0 -0.15" rpy="0.1 0.2 0.3"/><mass value="0.4"/>
      <inertia ixx="0.004" ixy="0.0003" ixz="0" iyy="0.0035" iyz="0.0001" izz="0.0008"/></inertial>
    <collision><origin xyz="0 0 -0.15"/><geometry><cylinder radius="0.01" length="0.3"/></geometry>
    </collision>
  </link>
  <link name="bob">
    <inertial><origin xyz="0 0 -0.15"/><mass value="0.7"/>
      <inertia ixx="0.006" ixy="0" ixz="0" iyy="0.006" iyz="0" izz="0.0007"/></inertial>
  </link>
  <joint name="pin" type="continuous"><parent link="base"/><child link="rod"/>
    <origin xyz="0 0 1"/><axis xyz="0 1 0"/></joint>
  <joint name="knee" type="revolute"><parent link="rod"/><child link="bob"/>
    <origin xyz="0 0 -0.3" rpy="0.2 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
</robot>)";

class Robots : public testing::Test {
 protected:
  input::Scene import(const std::string& name, const std::string& text,
                      const std::vector<robots::FingerLayer>& layers = {}) {
    const robots::ImportedScene imported =
        robots::import_robot(folder_.write(name, text), folder_.path(), "robot", layers);
    notes_ = imported.notes;
    text_ = imported.text;
    return input::parse_scene(imported.text, folder_.path() / "robot.toml");
  }
  bool is_noted(const std::string& words) const {
    for (const std::string& note : notes_)
      if (note.find(words) != std::string::npos) return true;
    return false;
  }

  TemporaryFolder folder_;
  std::vector<std::string> notes_;
  std::string text_;
};

/// The same file in MuJoCo, without contacts, stepped by RK4.
struct Mujoco {
  explicit Mujoco(const fs::path& file) {
    char error[1000] = "";
    model.reset(mj_loadXML(file.c_str(), nullptr, error, sizeof error));
    EXPECT_TRUE(model) << error;
    model->opt.disableflags |= mjDSBL_CONTACT;
    model->opt.integrator = mjINT_RK4;
    data.reset(mj_makeData(model.get()));
    mj_forward(model.get(), data.get());
  }
  Eigen::MatrixXd mass() const {
    // Row-major, but symmetric.
    Eigen::MatrixXd result(model->nv, model->nv);
    mj_fullM(model.get(), result.data(), data->qM);
    return result;
  }
  int joint(const std::string& name) const {
    return mj_name2id(model.get(), mjOBJ_JOINT, name.c_str());
  }
  std::unique_ptr<mjModel, void (*)(mjModel*)> model{nullptr, mj_deleteModel};
  std::unique_ptr<mjData, void (*)(mjData*)> data{nullptr, mj_deleteData};
};

void expect_same_mass(const input::Scene& scene, const Mujoco& reference) {
  const Multibody bodies(scene.descriptions, scene.joints, scene.loops);
  ASSERT_EQ(bodies.velocities(), reference.model->nv);
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(bodies.velocities(), bodies.velocities());
  for (const Multibody::Tree& tree : bodies.trees())
    bodies.mass_matrix(tree, mass.block(tree.first, tree.first, tree.count, tree.count));
  const Eigen::MatrixXd expected = reference.mass();
  double error = 0;
  const auto dof = [&](int j) {
    return reference.model->jnt_dofadr[reference.joint(bodies.joint(j).name)];
  };
  for (int i = 0; i < bodies.joints(); ++i)
    for (int j = 0; j < bodies.joints(); ++j) {
      const int row = bodies.velocity_of_joint(i), column = bodies.velocity_of_joint(j);
      if (row < 0 || column < 0) continue;
      error = std::max(error, std::abs(mass(row, column) - expected(dof(i), dof(j))));
    }
  std::printf("mass matrix: largest difference %.1e of %.2e\n", error,
              expected.cwiseAbs().maxCoeff());
  // Angles and millimetres are written with 17 digits and converted twice.
  EXPECT_LE(error, 1e-10 * expected.cwiseAbs().maxCoeff());
}

/// Largest difference of the joints' positions after a time without contacts.
double distance_after(const input::Scene& scene, const Mujoco& reference, double time_s,
                      double time_step_s) {
  struct None final : ContactFinder {
    void find(const Multibody&, double, std::vector<Contact>&) override {}
  } none;
  TimeStepper::Options options;
  options.time_step_s = time_step_s;
  options.gravity_m_per_s2 = scene.gravity.value(0);
  TimeStepper stepper(Multibody(scene.descriptions, scene.joints, scene.loops), scene.motors,
                      options);
  for (long i = 0; i < std::lround(time_s / time_step_s); ++i)
    EXPECT_TRUE(stepper.step(none).done());
  double result = 0;
  for (int j = 0; j < stepper.bodies().joints(); ++j) {
    if (stepper.bodies().velocity_of_joint(j) < 0) continue;
    const int at = reference.model->jnt_qposadr[reference.joint(stepper.bodies().joint(j).name)];
    result =
        std::max(result, std::abs(stepper.bodies().joint_position(j) - reference.data->qpos[at]));
  }
  return result;
}

void expect_same_motion(const input::Scene& scene, Mujoco& reference) {
  const double time_s = 0.5;
  reference.model->opt.timestep = 1e-4;
  while (reference.data->time < time_s - 1e-9) mj_step(reference.model.get(), reference.data.get());
  const double coarse = distance_after(scene, reference, time_s, 1e-3);
  const double fine = distance_after(scene, reference, time_s, 5e-4);
  std::printf("after %g s: off by %.1e at 1 ms, %.1e at 0.5 ms (rad, m)\n", time_s, coarse, fine);
  EXPECT_LE(coarse, 1e-4);
  // Second order in our time step; that of RK4 at 0.1 ms is far below.
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
}

TEST_F(Robots, OfMjcfHaveMujocosMassMatrixAndFreeMotion) {
  const input::Scene scene = import("arm.xml", kArm);
  Mujoco reference(folder_.path() / "arm.xml");
  expect_same_mass(scene, reference);
  expect_same_motion(scene, reference);
}

TEST_F(Robots, OfUrdfHaveMujocosMassMatrixAndFreeMotion) {
  std::string urdf = kPendulum;
  const input::Scene scene = import("pendulum.urdf", urdf);
  Mujoco reference(folder_.path() / "pendulum.urdf");
  expect_same_mass(scene, reference);
  // From rest: the rod's centre of mass is not below the pin.
  expect_same_motion(scene, reference);
}

TEST_F(Robots, KeepActuatorsLimitsAndLoops) {
  const input::Scene scene = import("gripper.xml", R"(<mujoco>
  <option gravity="0 0 -9.8" timestep="0.002"/>
  <compiler angle="radian"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1" friction="0.7"/>
    <body name="left" pos="-0.1 0 0.2">
      <joint name="l" type="slide" axis="1 0 0" limited="true" range="0.01 0.05" damping="2"/>
      <geom type="box" size=".01 .02 .03" mass=".1" friction="0.9"/>
    </body>
    <body name="right" pos="0.1 0 0.2">
      <joint name="r" type="hinge" axis="0 1 0"/>
      <geom type="capsule" size=".01 .02" mass=".1"/>
      <geom type="sphere" size=".05" contype="0" conaffinity="0" mass="0"/>
    </body>
    <body name="toy" pos="0 0 0.5"><freejoint/><geom type="sphere" size=".02" mass=".05"/></body>
    <body name="ball" pos="0.5 0 0.5"><joint name="b" type="ball"/>
      <geom type="sphere" size=".02" mass=".05" pos="0 0 -.1"/></body>
  </worldbody>
  <contact><exclude body1="left" body2="toy"/></contact>
  <equality><connect name="hook" body1="ball" body2="world" anchor="0.05 0 0"/></equality>
  <actuator>
    <position name="grip" joint="l" kp="300" forcelimited="true" forcerange="-5 5"/>
    <motor name="turn" joint="r" gear="2" forcelimited="true" forcerange="-3 3"/>
  </actuator></mujoco>)",
                                    {{"right", 2, 300, 0.49}});
  EXPECT_EQ(scene.time_step_s, 2e-3);
  EXPECT_EQ(scene.bodies.size(), 5u);
  ASSERT_EQ(scene.joints.size(), 3u);
  EXPECT_NEAR(scene.joints[0].lower, 0.01, 1e-15);
  EXPECT_NEAR(scene.joints[0].start, 0.01, 1e-15) << "0 is beyond the limit";
  EXPECT_TRUE(is_noted("starts at its limit"));
  EXPECT_EQ(scene.joints[2].kind, JointKind::ball);
  ASSERT_EQ(scene.motors.size(), 2u);
  EXPECT_NEAR(scene.motors[0].stiffness, 300, 1e-10);
  EXPECT_NEAR(scene.motors[0].damping, 2, 1e-12);
  EXPECT_NEAR(scene.motors[0].max_effort, 5, 1e-12);
  EXPECT_NEAR(scene.motors[1].max_effort, 6, 1e-12) << "through the gear";
  ASSERT_EQ(scene.loops.size(), 1u);
  EXPECT_LE((scene.loops[0].anchor_m - Eigen::Vector3d(0.55, 0, 0.5)).norm(), 1e-12);
  EXPECT_FALSE(scene.rule(1, 3).collide);
  EXPECT_TRUE(scene.rule(2, 3).collide);
  EXPECT_NEAR(scene.rule(0, 1).shear_law.friction_coefficient, 0.9, 1e-15) << "the larger one";
  EXPECT_TRUE(scene.bodies[2].layer.has_value());
  EXPECT_EQ(scene.bodies[2].shapes.size(), 1u);
  EXPECT_TRUE(is_noted("1 geoms that collide with nothing"));
  const simulation::Simulation run = simulation::simulate(scene);
  EXPECT_EQ(run.failure, "");
  EXPECT_EQ(run.steps, 500);
}

#ifdef SOFTFINGER_HAS_SDFORMAT
/// A parallelogram of two cranks and a coupler, whose last joint closes a ring.
const char* const kParallelogram = R"(<sdf version="1.9"><model name="m">
  <link name="left"><pose>0 0 -0.1 0 0 0</pose><inertial><mass>0.2</mass>
    <inertia><ixx>1e-3</ixx><iyy>1e-3</iyy><izz>1e-4</izz></inertia></inertial></link>
  <link name="bar"><pose>0.15 0 -0.2 0 0 0</pose><inertial><mass>0.3</mass>
    <inertia><ixx>1e-4</ixx><iyy>2e-3</iyy><izz>2e-3</izz></inertia></inertial>
    <collision name="c"><geometry><box><size>0.3 0.01 0.02</size></box></geometry>
      <surface><friction><ode><mu>0.4</mu></ode></friction></surface></collision></link>
  <link name="right"><pose>0.3 0 -0.1 0 0 0</pose><inertial><mass>0.2</mass>
    <inertia><ixx>1e-3</ixx><iyy>1e-3</iyy><izz>1e-4</izz></inertia></inertial></link>
  <joint name="a" type="revolute"><parent>world</parent><child>left</child>
    <pose>0 0 0.1 0 0 0</pose><axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>2</upper></limit>
    </axis></joint>
  <joint name="b" type="continuous"><parent>left</parent><child>bar</child>
    <pose>-0.15 0 0 0 0 0</pose><axis><xyz>0 1 0</xyz></axis></joint>
  <joint name="c" type="continuous"><parent>world</parent><child>right</child>
    <pose>0 0 0.1 0 0 0</pose><axis><xyz>0 1 0</xyz><dynamics><damping>0.2</damping></dynamics>
    </axis></joint>
  <joint name="d" type="continuous"><parent>bar</parent><child>right</child>
    <pose>0 0 -0.1 0 0 0</pose><axis><xyz>0 1 0</xyz></axis></joint>
</model></sdf>)";

TEST_F(Robots, OfSdfMoveAsTheirLinksDo) {
  Start start;
  start.folder = folder_.path();
  const ProgramRun run =
      run_softfinger(start, {"simulate", folder_.write("m.sdf", kParallelogram).string(),
                             "--write-scene", (folder_.path() / "m.toml").string(), "--set",
                             "simulation.gravity_m_per_s2=[3,0,-9]"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("joint \"d\" closes a ring"), std::string::npos) << run.err;
  const input::Scene scene = input::read_scene(folder_.path() / "m.toml");
  ASSERT_EQ(scene.joints.size(), 3u);
  EXPECT_NEAR(scene.joints[0].upper, 2, 1e-12);
  EXPECT_LE((scene.joints[1].anchor_m - Eigen::Vector3d(0, 0, -0.2)).norm(), 1e-12);
  ASSERT_EQ(scene.loops.size(), 1u);
  EXPECT_LE((scene.loops[0].anchor_m - Eigen::Vector3d(0.3, 0, -0.2)).norm(), 1e-12);
  ASSERT_EQ(scene.motors.size(), 1u);
  EXPECT_NEAR(scene.motors[0].damping, 0.2, 1e-12);
  // The bar of a parallelogram does not turn, and its cranks turn by the same angle.
  const simulation::Simulation run_again = simulation::simulate(scene);
  EXPECT_EQ(run_again.failure, "");
  const simulation::Frame& end = run_again.recording.frames.back();
  EXPECT_LE((end.poses[1].linear() - Eigen::Matrix3d::Identity()).norm(), 1e-6);
  EXPECT_LE((end.poses[0].linear() - end.poses[2].linear()).norm(), 1e-6);
}

TEST_F(Robots, OfSdfAreRefusedInOneLine) {
  const auto refusal = [&](const std::string& old, const std::string& changed) {
    std::string text = kParallelogram;
    EXPECT_NE(text.find(old), std::string::npos);
    text.replace(text.find(old), old.size(), changed);
    Start start;
    start.folder = folder_.path();
    const ProgramRun run =
        run_softfinger(start, {"simulate", folder_.write("bad.sdf", text).string()});
    EXPECT_EQ(run.status, 2) << changed;
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
    return run.err;
  };
  EXPECT_NE(refusal("</sdf>", "").find("libsdformat cannot read it"), std::string::npos);
  EXPECT_NE(refusal("\"continuous\"", "\"universal\"").find("joint \"b\""), std::string::npos);
  EXPECT_NE(
      refusal("<box><size>0.3 0.01 0.02</size></box>", "<mesh><uri>model://x.stl</uri></mesh>")
          .find("collision \"c\""),
      std::string::npos);
  EXPECT_NE(refusal("<mass>0.3</mass>", "<mass>-1</mass>"), "");
  EXPECT_NE(refusal("<child>bar</child>", "<child>rab</child>"), "");
}
#endif

TEST_F(Robots, SayWhatTheyLeaveOut) {
  import("left_out.xml", R"(<mujoco><worldbody>
    <body name="a"><joint name="j" type="hinge" axis="0 1 0" frictionloss="0.1"/>
      <geom type="sphere" size="0.1"/><site name="s"/></body></worldbody>
    <tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon>
    <actuator><general name="g" tendon="t"/></actuator>
    <sensor><jointpos joint="j"/></sensor></mujoco>)");
  for (const char* words :
       {"dry friction of joint \"j\"", "actuator \"g\"", "1 tendons", "1 sensors"})
    EXPECT_TRUE(is_noted(words)) << words;
}

TEST_F(Robots, AreRefusedInOneLine) {
  const auto refusal = [&](const std::string& text, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"simulate", folder_.write("bad.xml", text).string()};
    words.insert(words.end(), more.begin(), more.end());
    Start start;
    start.folder = folder_.path();
    const ProgramRun run = run_softfinger(start, words);
    EXPECT_EQ(run.status, 2) << text;
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
    return run.err;
  };
  EXPECT_NE(refusal("<mujoco><worldbody><body>").find("MuJoCo cannot read it"), std::string::npos);
  EXPECT_NE(refusal("").find("MuJoCo cannot read it"), std::string::npos);
  EXPECT_NE(refusal(std::string(1000, '\xff')).find("MuJoCo"), std::string::npos);
  EXPECT_NE(refusal("<mujoco><worldbody><body name='a'><freejoint/><geom size='nan'/></body>"
                    "</worldbody></mujoco>"),
            "");
  // MuJoCo warns of each of them.
  EXPECT_NE(refusal("<mujoco><worldbody><body name='a' pos='nan 0 0'><freejoint/>"
                    "<geom size='nan'/></body></worldbody></mujoco>")
                .find("number = NaN"),
            std::string::npos);
  EXPECT_NE(refusal("<mujoco><worldbody><body name='a'><freejoint/><geom size='1'/></body>"
                    "</worldbody></mujoco>",
                    {"--finger-layer", "b:2,300,0.49"})
                .find("a body of the robot: a"),
            std::string::npos);
  EXPECT_NE(refusal("<mujoco/>", {"--finger-layer", "b:2,300"}).find("BODY:THICKNESS_MM"),
            std::string::npos);
}

}  // namespace
}  // namespace softfinger::tests
