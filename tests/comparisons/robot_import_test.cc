// Robots' files as scenes, against MuJoCo itself: mass matrix, free motion, and what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <sys/stat.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>

#include "comparisons/input/scene.h"
#include "comparisons/robots/mujoco_contacts.h"
#include "comparisons/robots/mujoco_scene.h"
#include "comparisons/robots/urdf_scene.h"
#include "comparisons/simulation/simulate.h"
#include "softfinger/dynamics/step/time_stepper.h"
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
    const fs::path file = folder_.write(name, text);
    const robots::ImportedScene imported =
        file.extension() == ".urdf" ? robots::import_urdf(file, folder_.path(), "robot", layers)
                                    : robots::import_robot(file, folder_.path(), "robot", layers);
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

/// The imported file in MuJoCo: as it is, or without contacts and with steps by RK4.
struct Mujoco {
  explicit Mujoco(const fs::path& file, bool as_it_is = false) {
    char error[1000] = "";
    model.reset(mj_loadXML(file.c_str(), nullptr, error, sizeof error));
    EXPECT_TRUE(model) << error;
    if (!as_it_is) {
      model->opt.disableflags |= mjDSBL_CONTACT;
      model->opt.integrator = mjINT_RK4;
    }
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

/// A random model whose geoms all overlap: bodies in and beside each other, some with a joint.
std::string crowded_model(std::mt19937& random) {
  const auto any = [&](int most) { return int(random() % unsigned(most + 1)); };
  std::string text = "<mujoco><size nconmax='500' njmax='1'/><option collision='" +
                     std::string(std::vector<const char*>{"all", "all", "predefined",
                                                          "dynamic"}[std::size_t(any(3))]) +
                     "'><flag filterparent='" + (any(3) ? "enable" : "disable") + "' contact='" +
                     (any(7) ? "enable" : "disable") + "'/></option><worldbody>";
  int geoms = 0, bodies = 0;
  const auto add_geoms = [&] {
    for (int i = any(2); i >= 0; --i)
      text += "<geom name='g" + std::to_string(geoms++) + "' size='1' pos='0." +
              std::to_string(any(9)) + " 0 0' contype='" + std::to_string(any(3)) +
              "' conaffinity='" + std::to_string(any(3)) + "' priority='" +
              std::to_string(any(2) / 2) + "' condim='" +
              std::vector<const char*>{"1", "3", "4", "6"}[std::size_t(any(3))] + "' friction='0." +
              std::to_string(1 + any(8)) + " 0 0'/>";
  };
  add_geoms();
  int open = 0;
  while (bodies < 6) {
    text += "<body name='b" + std::to_string(bodies++) + "'>";
    if (any(2)) text += "<joint/>";
    add_geoms();
    ++open;
    while (open > 0 && any(1)) {
      text += "</body>";
      --open;
    }
  }
  for (; open > 0; --open) text += "</body>";
  text += "</worldbody><contact><exclude body1='b0' body2='b4'/>";
  for (int i = 0; i < 2; ++i) {
    // MuJoCo has no pairs within a body.
    text += "<pair geom1='g0' geom2='g" + std::to_string(geoms - 1 - i) + "' condim='" +
            (any(1) ? "1" : "3") + "' friction='0.95 0.95 0 0 0'/>";
    if (any(1)) break;
  }
  return text + "</contact></mujoco>";
}

TEST_F(Robots, OfMjcfTouchAsInMujoco) {
  std::mt19937 random(1);
  std::size_t touching = 0;
  for (int n = 0; n < 300; ++n) {
    const std::string text = crowded_model(random);
    char error[1000] = "";
    const std::unique_ptr<mjModel, void (*)(mjModel*)> model(
        mj_loadXML(folder_.write("crowd.xml", text).c_str(), nullptr, error, sizeof error),
        mj_deleteModel);
    ASSERT_TRUE(model) << error << text;
    const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(model.get()), mj_deleteData);
    mj_kinematics(model.get(), data.get());
    mj_collision(model.get(), data.get());
    std::map<std::pair<int, int>, double> expected, found;
    for (int i = 0; i < data->ncon; ++i) {
      const mjContact& contact = data->contact[i];
      expected[std::minmax(contact.geom1, contact.geom2)] =
          contact.dim == 1 ? 0 : contact.friction[0];
    }
    const robots::MujocoContacts contacts(*model);
    for (int g = 0; g < model->ngeom; ++g)
      for (int h = g + 1; h < model->ngeom; ++h)
        if (const auto friction = contacts.friction_coefficient(g, h)) found[{g, h}] = *friction;
    ASSERT_EQ(found, expected) << text;
    touching += expected.size();
  }
  EXPECT_GT(touching, 5000u) << "the models show something";
}

/// A box of 0.1 kg on a plane, in gravity that pulls it along the plane, too.
std::string sled(const std::string& option, const std::string& floor, const std::string& box) {
  return "<mujoco><option gravity='4 0 -9.81'" + option +
         "</option><worldbody><geom name='floor' type='plane' size='1 1 1' " + floor +
         "/><body name='box' pos='0 0 .02'><freejoint/><geom name='g' type='box' "
         "size='.04 .04 .01' mass='.1' pos='0 0 -.01' " +
         box + "/></body></worldbody></mujoco>";
}

/// Returns the displacement (m) of body `b` of a scene along an axis within the scene's second.
double way_m(const input::Scene& scene, std::size_t b, int axis) {
  const simulation::Simulation run = simulation::simulate(scene);
  EXPECT_EQ(run.failure, "");
  return run.recording.frames.back().poses[b].translation()(axis) -
         run.recording.frames.front().poses[b].translation()(axis);
}

/// Returns the displacement (m) of MuJoCo's body `b`, counted with the world as 0, within a second.
double mujoco_way_m(const fs::path& file, int b, int axis) {
  Mujoco reference(file, true);
  const double start = reference.data->xpos[3 * b + axis];
  while (reference.data->time < 1 - 1e-9) mj_step(reference.model.get(), reference.data.get());
  return reference.data->xpos[3 * b + axis] - start;
}

TEST_F(Robots, OfMjcfSlideWithThePrioritysFriction) {
  // Newton: a box that slides accelerates by g_x - mu g_z.
  const auto way = [](double friction) { return 0.5 * std::max(0., 4 - friction * 9.81); };
  struct Sled {
    const char *floor, *box;
    double friction;
  };
  for (const Sled& one :
       {Sled{"friction='1 0 0'", "friction='.3 0 0' priority='1'", 0.3},
        Sled{"friction='.2 0 0' priority='2'", "friction='.3 0 0' priority='1'", 0.2},
        Sled{"friction='.1 0 0'", "friction='.3 0 0'", 0.3}, Sled{"condim='1'", "condim='1'", 0},
        Sled{"condim='1'", "condim='3'", 1}}) {
    const std::string text = sled(">", one.floor, one.box);
    const input::Scene scene = import("sled.xml", text);
    EXPECT_EQ(scene.rule(0, 1).shear_law.friction_coefficient, one.friction) << text;
    const double ours = way_m(scene, 1, 0),
                 theirs = mujoco_way_m(folder_.path() / "sled.xml", 1, 0);
    std::printf("sled: %.4f m, MuJoCo %.4f m, Newton %.4f m\n", ours, theirs, way(one.friction));
    // A step of 2 ms late or early at 4 m/s.
    EXPECT_NEAR(ours, way(one.friction), 8e-3) << text;
    // MuJoCo's friction creeps and its contacts are soft.
    EXPECT_NEAR(theirs, way(one.friction), 3e-2) << text;
  }
}

TEST_F(Robots, OfMjcfKnowWhatTheFileSwitchesOff) {
  const double fall_m = 0.5 * 9.81;
  import("off.xml", sled("><flag gravity='disable'/>", "", ""));
  EXPECT_TRUE(is_noted("switches off, and so does the scene: gravity"));
  EXPECT_EQ(input::parse_scene(text_, "off.toml").gravity.value(0), Eigen::Vector3d::Zero());
  for (const char* option : {"><flag contact='disable'/>", "><flag constraint='disable'/>",
                             " collision='predefined'>"}) {
    const input::Scene scene = import("off.xml", sled(option, "", ""));
    // The first step of two falls by g dt^2.
    EXPECT_NEAR(way_m(scene, 1, 2), -fall_m, 9.81 * 2e-3) << option;
    EXPECT_NEAR(mujoco_way_m(folder_.path() / "off.xml", 1, 2), -fall_m, 9.81 * 2e-3) << option;
  }
  const char* const limited = R"(<mujoco><option gravity='0 0 -1'><flag limit='disable'
    passive='disable' actuation='disable' equality='disable'/></option><worldbody><body name='a'>
    <joint name='j' type='slide' axis='0 0 1' range='-.1 .1' limited='true' damping='1'
    stiffness='9'/><geom size='.1'/></body></worldbody>
    <equality><connect body1='a' body2='world' anchor='0 0 0'/></equality>
    <actuator><position joint='j' kp='10'/></actuator></mujoco>)";
  const input::Scene scene = import("limited.xml", limited);
  EXPECT_EQ(scene.loops.size() + scene.motors.size(), 0u);
  EXPECT_NEAR(way_m(scene, 0, 2), -0.5, 2e-3);
  EXPECT_NEAR(mujoco_way_m(folder_.path() / "limited.xml", 1, 2), -0.5, 2e-3);
}

TEST_F(Robots, OfMjcfKeepGeomsApartThatTouchDifferently) {
  // A second geom of the body that touches nothing here, but has another friction or group.
  for (const char* other :
       {"size='.01 .01 .01' friction='1 0 0'", "size='.2 .2 .2' contype='2' conaffinity='2'"}) {
    std::string text = sled(">", "friction='.1 0 0'", "friction='.1 0 0'");
    const std::string end = "</body>";
    text.insert(text.find(end),
                std::string("<geom type='box' pos='.01 0 .01' mass='.02' ") + other + "/>");
    const input::Scene scene = import("two.xml", text, {{"box", 2, 300, 0.49}});
    ASSERT_EQ(scene.bodies.size(), 3u);
    EXPECT_TRUE(scene.bodies[1].layer && scene.bodies[2].layer) << "one finger still";
    EXPECT_TRUE(is_noted("the geoms of body \"box\" touch others in 2 ways"));
    // Together they weigh what the body does.
    const Mujoco reference(folder_.path() / "two.xml", true);
    const MassProperties &first = scene.descriptions[1].mass, &second = scene.descriptions[2].mass;
    const double mass_kg = reference.model->body_mass[1];
    EXPECT_NEAR(first.mass_kg + second.mass_kg, mass_kg, 1e-15);
    EXPECT_EQ(first.center_m, second.center_m);
    const double* const inertia = reference.model->body_inertia + 3;
    EXPECT_NEAR((first.inertia_kg_m2 + second.inertia_kg_m2).trace(),
                inertia[0] + inertia[1] + inertia[2], 1e-15);
    const input::Scene rigid = import("two.xml", text);
    EXPECT_NEAR(way_m(rigid, 1, 0), 0.5 * (4 - 0.981), 8e-3);
    EXPECT_NEAR(way_m(rigid, 1, 2), 0, 1e-4);
    EXPECT_NEAR(mujoco_way_m(folder_.path() / "two.xml", 1, 0), 0.5 * (4 - 0.981), 3e-2);
  }
}

TEST_F(Robots, OfMjcfStartWithTheKeyframesVelocity) {
  const std::string text = R"(<mujoco><option gravity='0 0 0' integrator='RK4'/><worldbody>
    <body name='ball' pos='0 0 .5' euler='0 0 90'><freejoint/>
      <geom type='box' size='.01 .02 .03' mass='.1' pos='.1 0 0'/></body>
    <body name='arm' pos='1 0 0'><joint name='h' axis='0 1 0'/><geom size='.01'/></body></worldbody>
    <keyframe><key name='home' qpos='0 0 .5 .6 0 0 .8 0' qvel='1 .2 0 0.3 0 2 0'/></keyframe>
    </mujoco>)";
  const input::Scene scene = import("key.xml", text);
  Mujoco reference(folder_.path() / "key.xml");
  mj_resetDataKeyframe(reference.model.get(), reference.data.get(), 0);
  while (reference.data->time < 1 - 1e-9) mj_step(reference.model.get(), reference.data.get());
  const simulation::Simulation run = simulation::simulate(scene);
  const Eigen::Vector3d end = run.recording.frames.back().poses[0].translation(),
                        expected(reference.data->xpos[3], reference.data->xpos[4],
                                 reference.data->xpos[5]);
  std::printf("free body of a keyframe: off by %.1e m\n", (end - expected).norm());
  // It spins by 2 rad/s about a centre 0.1 m away; the error is of second order in steps of 2 ms.
  EXPECT_LE((end - expected).norm(), 1e-5);
}

TEST_F(Robots, OfMjcfStartWithTheVelocitiesOfTheirJoints) {
  // Two hinges on a body, a slide and a ball after them, beside a free body; one joint is at rest.
  const std::string text = R"(<mujoco><option gravity='0 0 -9.81'/><worldbody>
    <body name='ball' pos='0 0 5'><freejoint/><geom size='.02' mass='.1' pos='.1 0 0'/></body>
    <body name='upper' pos='.1 .2 .3' euler='10 20 30'>
      <joint name='shoulder' axis='0 1 .2' pos='.01 0 .02'/><joint name='twist' axis='1 0 0'/>
      <geom type='box' size='.2 .03 .02' pos='.2 0 0' mass='1'/>
      <body name='lower' pos='.4 0 0'><joint name='rest' axis='0 1 0'/>
        <geom type='box' size='.1 .03 .02' pos='.1 .01 0' mass='.5'/>
        <body name='rod' pos='.2 0 0'><joint name='slide' type='slide' axis='1 0 .3'/>
          <geom type='box' size='.1 .01 .02' pos='.1 0 .02' mass='.3'/>
          <body name='head' pos='.2 0 0'><joint name='neck' type='ball'/>
            <geom type='box' size='.02 .03 .04' pos='.01 .02 .03' mass='.2'/>
    </body></body></body></body></worldbody>
    <keyframe><key name='home' qpos='0 0 5 1 0 0 0 .3 -.2 .4 .05 .8 0 .6 0'
      qvel='1 .2 0 .3 0 2 1.5 -2 0 .4 .7 -.5 .9'/></keyframe></mujoco>)";
  const input::Scene scene = import("key.xml", text);
  Mujoco reference(folder_.path() / "key.xml");
  mj_resetDataKeyframe(reference.model.get(), reference.data.get(), 0);
  Multibody bodies(scene.descriptions, scene.joints, scene.loops);
  ASSERT_EQ(scene.start_velocity.size(), bodies.velocities());
  for (const char* name : {"shoulder", "twist", "rest", "slide"})
    for (int j = 0; j < bodies.joints(); ++j)
      if (bodies.joint(j).name == name) {
        EXPECT_NEAR(scene.start_velocity[bodies.velocity_of_joint(j)],
                    reference.data->qvel[reference.model->jnt_dofadr[reference.joint(name)]], 1e-9)
            << name;
      }
  while (reference.data->time < 0.2 - 1e-9) mj_step(reference.model.get(), reference.data.get());
  mj_kinematics(reference.model.get(), reference.data.get());
  const simulation::Simulation run = simulation::simulate(scene);
  const auto& frames = run.recording.frames;
  const auto frame = std::find_if(frames.begin(), frames.end(),
                                  [](const auto& one) { return one.time_s >= 0.2 - 1e-9; });
  ASSERT_NE(frame, frames.end());
  for (const char* name : {"ball", "upper", "lower", "rod", "head"}) {
    const int b = mj_name2id(reference.model.get(), mjOBJ_BODY, name);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
      if (scene.bodies[i].name == name) {
        // Steps of 2 ms, errors of second order: turns of 2 rad/s with lever arms of 1 m.
        EXPECT_LE((frame->poses[i].translation() -
                   Eigen::Map<const Eigen::Vector3d>(reference.data->xpos + 3 * b))
                      .norm(),
                  2e-4)
            << name;
      }
  }
}

TEST_F(Robots, AddTheLimitsOfActuatorsOnOneJoint) {
  const std::string start = R"(<mujoco><worldbody><body name='a'><joint name='j' type='slide'/>
    <geom size='.01'/></body></worldbody><actuator>
    <position joint='j' kp='100' forcerange='-3 3' forcelimited='true'/>
    <motor joint='j' forcerange='-5 5' forcelimited='true'/>)";
  EXPECT_NEAR(import("two.xml", start + "</actuator></mujoco>").motors[0].max_effort, 8, 1e-12);
  EXPECT_TRUE(is_noted("the actuators of joint \"j\" are one motor with the sum of their limits"));
  EXPECT_TRUE(std::isinf(
      import("three.xml", start + "<motor joint='j'/></actuator></mujoco>").motors[0].max_effort));
}

TEST_F(Robots, LimitMotorsAsTheRangesOfForceAndControlDo) {
  const auto text = [](const char* motor) {
    return fmt::format(R"(<mujoco><worldbody><body name='a'><joint name='j' type='slide'/>
      <geom size='.01'/></body></worldbody><actuator>{}</actuator></mujoco>)",
                       motor);
  };
  for (const char* motor :
       {"<motor joint='j' gear='3' ctrlrange='-2 2' ctrllimited='true'/>",
        "<motor joint='j' gear='-3' ctrlrange='-2 2' ctrllimited='true' forcerange='-1.5 1.5' "
        "forcelimited='true'/>",
        "<general joint='j' gear='3' gainprm='5' ctrlrange='-2 2' ctrllimited='true' "
        "forcerange='-12 12' forcelimited='true'/>"}) {
    const input::Scene scene = import("motor.xml", text(motor));
    Mujoco reference(folder_.path() / "motor.xml", true);
    reference.data->ctrl[0] = 1e3;
    mj_forward(reference.model.get(), reference.data.get());
    EXPECT_NEAR(scene.motors[0].max_effort, std::abs(reference.data->qfrc_actuator[0]), 1e-9)
        << motor;
  }
  // The control range of a position actuator is no limit of its force.
  EXPECT_TRUE(
      std::isinf(import("position.xml",
                        text("<position joint='j' kp='9' ctrlrange='-1 1' ctrllimited='true'/>"))
                     .motors[0]
                     .max_effort));
  EXPECT_TRUE(is_noted("the control range of actuator"));
}

/// A two-finger gripper: its right finger mimics the left, whose tip is a link of its own.
const char* const kGripper = R"(<robot name="gripper">
  <link name="base"><collision><geometry><box size="0.12 0.04 0.02"/></geometry></collision></link>
  <link name="left"><inertial><mass value="0.05"/>
    <inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial></link>
  <link name="left_tip"><inertial><mass value="0.01"/>
    <inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"/></inertial>
    <collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <link name="right"><inertial><mass value="0.05"/>
    <inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial></link>
  <joint name="jl" type="prismatic"><parent link="base"/><child link="left"/>
    <origin xyz="-0.04 0 0.01"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/></joint>
  <joint name="jlt" type="fixed"><parent link="left"/><child link="left_tip"/>
    <origin xyz="0 0 0.06"/></joint>
  <joint name="jr" type="prismatic"><parent link="base"/><child link="right"/>
    <origin xyz="0.04 0 0.01"/><axis xyz="-1 0 0"/><limit lower="-0.5" upper="0.04"/>
    <mimic joint="jl" multiplier="1" offset="0"/></joint>
  <gazebo reference="left"/>
</robot>)";

TEST_F(Robots, OfUrdfSayWhatASceneHasNot) {
  const input::Scene scene = import("grip.urdf", kGripper);
  EXPECT_EQ(scene.bodies.size(), 3u);
  ASSERT_EQ(scene.motors.size(), 1u);
  EXPECT_EQ(scene.motors[0].max_effort, 10);
  ASSERT_EQ(scene.joints.size(), 2u);
  EXPECT_EQ(scene.joints[1].leader, 0);
  EXPECT_EQ(scene.joints[1].ratio, 1);
  for (const char* words : {"1 velocity limits are left out", "1 <gazebo> are left out",
                            "the root link \"base\" stands in the world"})
    EXPECT_TRUE(is_noted(words)) << words;
  for (const char* upper : {"-1", "nan", "x"}) {
    std::string text = kGripper;
    text.replace(text.find("upper=\"0.04\"/>"), 14, std::string("upper=\"") + upper + "\"");
    EXPECT_THROW(import("bad.urdf", text), InputError) << upper;
  }
  std::string locked = kGripper;
  locked.replace(locked.find("-0.5"), 4, "0.04");
  EXPECT_TRUE(std::isinf(import("locked.urdf", locked).joints[1].upper));
  EXPECT_TRUE(is_noted("joint \"jr\" has no limits"));
}

TEST_F(Robots, OfUrdfHaveLayersOnFixedLinks) {
  const input::Scene merged = import("grip.urdf", kGripper);
  const input::Scene scene = import("grip.urdf", kGripper, {{"left_tip", 2, 300, 0.49}});
  ASSERT_EQ(scene.bodies.size(), 4u);
  double mass_kg = 0, merged_mass_kg = 0;
  for (std::size_t b = 0; b < 4; ++b) {
    EXPECT_EQ(scene.bodies[b].layer.has_value(), scene.bodies[b].name == "left_tip");
    EXPECT_EQ(scene.descriptions[b].fixed, scene.bodies[b].name == "base");
    mass_kg += scene.descriptions[b].mass.mass_kg;
    if (b < 3) merged_mass_kg += merged.descriptions[b].mass.mass_kg;
  }
  EXPECT_NEAR(mass_kg, merged_mass_kg, 1e-15);
  EXPECT_EQ(scene.joints.size(), merged.joints.size() + 1);
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

/// A box of 0.1 kg on a ground, in gravity that pulls it along the ground, too.
std::string sdf_world(const std::string& ground, const std::string& box,
                      const std::string& model = "name='box'") {
  const auto collision = [](const std::string& shape, const std::string& surface) {
    return "<collision name='c'><geometry>" + shape + "</geometry><surface>" + surface +
           "</surface></collision>";
  };
  return "<sdf version='1.9'><world name='w'><gravity>12 0 -9.81</gravity><model name='ground'>"
         "<static>true</static><link name='l'>" +
         collision("<plane><normal>0 0 1</normal><size>1 1</size></plane>", ground) +
         "</link></model><model " + model +
         "><pose>0 0 0.01 0 0 0</pose><link name='l'><pose>0 0 0 0 0 0</pose><inertial>"
         "<mass>0.1</mass><inertia><ixx>4e-5</ixx><iyy>4e-5</iyy><izz>4e-5</izz></inertia>"
         "</inertial>" +
         collision("<box><size>.1 .1 .02</size></box>", box) + "</link></model></world></sdf>";
}

std::string ode_friction(const std::string& mu) {
  return "<friction><ode><mu>" + mu + "</mu><mu2>" + mu + "</mu2></ode></friction>";
}

/// Reads SDF through the program: this test itself has no reader of SDF.
class SdfRobots : public Robots {
 protected:
  input::Scene import_sdf(const std::string& text) {
    Start start;
    start.folder = folder_.path();
    const fs::path toml = folder_.path() / "w.toml";
    const ProgramRun run =
        run_softfinger(start, {"simulate", folder_.write("w.sdf", text).string(), "--write-scene",
                               toml.string(), "--set", "simulation.duration_s=1"});
    EXPECT_EQ(run.status, 0) << run.err;
    notes_ = lines(run.err);
    return input::read_scene(toml);
  }
  /// The line that the program refuses the file with.
  std::string refusal(const std::string& text) {
    Start start;
    start.folder = folder_.path();
    const ProgramRun run =
        run_softfinger(start, {"simulate", folder_.write("bad.sdf", text).string()});
    EXPECT_EQ(run.status, 2) << text;
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
    return run.err;
  }
};

TEST_F(SdfRobots, HaveTheSmallerFrictionOfTwoSurfaces) {
  const input::Scene holds = import_sdf(sdf_world(ode_friction("2"), ode_friction("2")));
  EXPECT_EQ(holds.rule(0, 1).shear_law.friction_coefficient, 2);
  EXPECT_NEAR(way_m(holds, 1, 0), 0, 1e-6) << "2 times 9.81 is above 12";
  // A surface without the element has 1.
  EXPECT_EQ(import_sdf(sdf_world(ode_friction("2"), "")).rule(0, 1).shear_law.friction_coefficient,
            1);
  EXPECT_EQ(import_sdf(sdf_world(ode_friction("2"), ode_friction("0.5")))
                .rule(0, 1)
                .shear_law.friction_coefficient,
            0.5);
  EXPECT_FALSE(import_sdf(sdf_world("<contact><collide_bitmask>1</collide_bitmask></contact>",
                                    "<contact><collide_bitmask>2</collide_bitmask></contact>"))
                   .rule(0, 1)
                   .collide);
}

TEST_F(SdfRobots, KeepCollisionsApartThatTouchDifferently) {
  std::string text = sdf_world(ode_friction("0.5"), ode_friction("0.5"));
  text.insert(text.rfind("</link>"),
              "<collision name='d'><pose>0 0 0.02 0 0 0</pose><geometry><sphere><radius>0.01"
              "</radius></sphere></geometry><surface>" +
                  ode_friction("0.1") + "</surface></collision>");
  const input::Scene scene = import_sdf(text);
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_TRUE(is_noted("have 2 surfaces"));
  EXPECT_NEAR(scene.descriptions[1].mass.mass_kg + scene.descriptions[2].mass.mass_kg, 0.1, 1e-15);
  EXPECT_EQ(scene.rule(0, 2).shear_law.friction_coefficient, 0.1);
  // Newton, for the box on its own surface; a step of 1 ms late or early at 7 m/s.
  EXPECT_NEAR(way_m(scene, 1, 0), 0.5 * (12 - 0.5 * 9.81), 7e-3);
}

TEST_F(SdfRobots, WithoutGravityStay) {
  std::string text = sdf_world("", "");
  text.insert(text.rfind("<inertial>"), "<gravity>false</gravity>");
  const input::Scene scene = import_sdf(text);
  EXPECT_TRUE(is_noted("has no gravity"));
  for (const int axis : {0, 2}) EXPECT_NEAR(way_m(scene, 1, axis), 0, 1e-9);
}

TEST_F(SdfRobots, ArePlacedByTheirPlacementFrame) {
  std::string text = sdf_world("", "", "name='box' placement_frame='l'");
  text.replace(text.rfind("<pose>0 0 0 0 0 0"), 17, "<pose>3 0 1 0 0.5 0");
  const input::Scene scene = import_sdf(text);
  EXPECT_TRUE(scene.descriptions[1].pose.isApprox(
      Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.01)), 1e-12))
      << scene.descriptions[1].pose.matrix();
}

TEST_F(SdfRobots, SayOrRefuseWhatASceneCannotHold) {
  const auto changed = [](const std::string& old, const std::string& text) {
    std::string result = kParallelogram;
    return result.replace(result.find(old), old.size(), text);
  };
  import_sdf(changed("<xyz>0 1 0</xyz></axis></joint>\n  <joint name=\"c\"",
                     "<xyz>0 1 0</xyz><mimic joint='a'><multiplier>1</multiplier></mimic>"
                     "<limit><velocity>2</velocity></limit></axis></joint>\n  <joint name=\"c\""));
  EXPECT_TRUE(is_noted("joint \"b\" moves by itself, not as joint \"a\""));
  EXPECT_TRUE(is_noted("the velocity limit of joint \"b\""));
  EXPECT_NE(
      refusal(changed("<upper>2", "<upper>nan")).find("the limits of joint \"a\" = -1 to nan"),
      std::string::npos);
  EXPECT_NE(refusal(changed("<upper>2", "<upper>-3")).find("lower <= upper"), std::string::npos);
  EXPECT_NE(refusal(changed("<damping>0.2", "<damping>nan")).find("joint \"c\""),
            std::string::npos);
  EXPECT_NE(refusal(changed("<mass>0.3</mass>", "<mass>0</mass>")).find("link \"bar\""),
            std::string::npos);
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
  for (const char* words : {"actuator \"g\"", "1 tendons", "1 sensors"})
    EXPECT_TRUE(is_noted(words)) << words;
}

/// Newer elements and attributes are left out where they change no motion, and refused otherwise.
TEST_F(Robots, OfNewerMjcfAreReadOrRefusedByName) {
  const auto body = [](const std::string& inside, const std::string& before = "") {
    return "<mujoco>\n" + before + "<worldbody>\n<body name=\"a\">" + inside +
           "</body></worldbody></mujoco>";
  };
  const std::string hinge = "<joint name=\"j\"/><geom size=\"0.1\"/>";
  import("new.xml", body(hinge + "<site name=\"s\" newer=\"1\"/>",
                         "<option sdf_iterations=\"5\"/><size memory=\"2M\"/>"
                         "<visual><global newest=\"1\"/></visual>"));
  EXPECT_TRUE(is_noted("3 parts of the file are newer than MuJoCo"));
  for (const auto& [text, words] :
       {std::pair(body("<geom size=\"0.1\" magic=\"3\"/>"),
                  "new.xml:3: attribute magic = \"3\" of <geom>"),
        std::pair(body(hinge + "<plugin/>"), "element <plugin> in <body>"),
        std::pair(body(hinge, "<option actuatorgroupdisable=\"1\"/>"), "actuatorgroupdisable"),
        std::pair(body(hinge, "<option><flag damper=\"disable\"/></option>"), "damper"),
        std::pair(body("<flexcomp/>"), "<flexcomp>"),
        std::pair(body("<replicate count=\"-1\"/>"), "count of <replicate> = \"-1\""),
        std::pair(body("<replicate count=\"1e9\"><geom size=\"0.1\"/></replicate>"),
                  "at most 20000 elements"),
        std::pair(body("<replicate count=\"2\">" + hinge + "</replicate>",
                       "<actuator><motor joint=\"j\"/></actuator>"),
                  "<motor> of \"j\", which is in a <replicate>"),
        std::pair(body("<frame><attach model=\"m\" prefix=\"p\"/></frame>"),
                  "compile MODEL.xml WHOLE.xml"),
        std::pair(body(hinge, "<include file=\"none.xml\"/>"), "a file that is there"),
        std::pair(body(hinge, "<include file=\"new.xml\"/>"), "each file once")}) {
    try {
      import("new.xml", text);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
}

TEST_F(Robots, AreBlamedByTheirOwnNames) {
  Start start;
  start.folder = folder_.path();
  const auto refusal = [&](const std::string& file, const std::string& text,
                           const std::vector<std::string>& more = {}) {
    folder_.write(file, text);
    std::vector<std::string> words = {"simulate", file};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun run = run_softfinger(start, words);
    EXPECT_EQ(run.status, 2) << run.err;
    const auto said = lines(run.err);
    return said.empty() ? "" : said.back();
  };
  const auto begins = [](const std::string& line, const std::string& start_of_it) {
    EXPECT_EQ(line.rfind("softfinger: error: " + start_of_it, 0), 0u) << line;
  };
  for (const char* layer : {"left:2,300,0.6", "left:0,300,0.4", "left:2,inf,0.4", "left:2,3,nan"})
    begins(refusal("grip.urdf", kGripper, {"--finger-layer", layer}),
           std::string("command line: --finger-layer = \"") + layer + "\": allowed: ");
  // Names links on fixed joints, too.
  EXPECT_NE(refusal("grip.urdf", kGripper, {"--finger-layer", "tip:2,300,0.4"})
                .find("a body of the robot: base, left, left_tip, right"),
            std::string::npos);
  std::string crossed = kGripper;
  crossed.replace(crossed.find("-0.5"), 4, "0.5");
  begins(refusal("crossed.urdf", crossed), "crossed.urdf:16: joint \"jr\": limits");
  const char* const box = "<freejoint/><geom type='box' size='1 1 1'/></body>";
  begins(refusal("step.xml", "<mujoco><option timestep='0'/></mujoco>"),
         "step.xml: <option> timestep = 0");
  // Longer than the scene.
  begins(refusal("long.xml", "<mujoco><option timestep='5'/><worldbody><body name='a'>" +
                                 std::string(box) + "</worldbody></mujoco>"),
         "long.xml: the scene made of it, which --write-scene SCENE.toml would keep, line ");
  begins(refusal("joint.urdf",
                 "<robot name='r'><link name='base'/><link name='tip'/>\n<joint "
                 "name='j' type='nonsense'><parent link='base'/><child link='tip'/>"
                 "</joint></robot>"),
         "joint.urdf:2: joint \"j\": type = \"nonsense\": allowed: revolute, continuous");
  for (const char* file : {"robot.txt", "robot.toml"})
    EXPECT_NE(refusal(file, kGripper).find(".xml, .mjcf, .urdf or .sdf"), std::string::npos);
}

/// Two boxes that overlap pass through each other, in the scene that is kept, too.
TEST_F(Robots, KeepWhatOverlapsApartAtTheStart) {
  Start start;
  start.folder = folder_.path();
  folder_.write("over.xml",
                "<mujoco><worldbody><body name='a'><freejoint/><geom type='box' size='1 1 1'/>"
                "</body><body name='b' pos='1.5 0 0'><freejoint/><geom type='box' size='1 1 1'/>"
                "</body><body name='c' pos='0 0 2.5'><freejoint/><geom type='box' size='1 1 1'/>"
                "</body></worldbody></mujoco>");
  const ProgramRun run =
      run_softfinger(start, {"simulate", "over.xml", "--set", "simulation.duration_s=0.01",
                             "--write-scene", "over.toml"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("\"a\" and \"b\" overlap by 500 mm at the start"), std::string::npos)
      << run.err;
  const ProgramRun kept =
      run_softfinger(start, {"simulate", "over.toml", "--set", "simulation.duration_s=0.01"});
  EXPECT_EQ(kept.status, 0) << kept.err;
  const input::Scene scene = input::read_scene(folder_.path() / "over.toml");
  EXPECT_FALSE(scene.rule(0, 1).collide);
  EXPECT_TRUE(scene.rule(0, 2).collide);
}

TEST_F(Robots, DoNotWaitForPipes) {
  const auto refusal = [&](const std::string& pipe, const std::string& text) {
    const fs::path path = folder_.path() / pipe;
    EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
    const ProgramRun run = run_softfinger({folder_.path(), {}, -1, ""},
                                          {"simulate", folder_.write("pipe.xml", text).string()});
    fs::remove(path);
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
    return run.err;
  };
  fs::create_directory(folder_.path() / "meshes");
  const std::string mjcf =
      "<mujoco>\n<compiler meshdir='meshes'/><asset>\n<mesh name='m' file='tip.stl'/></asset>"
      "<worldbody><geom type='mesh' mesh='m'/></worldbody></mujoco>";
  const std::string urdf =
      "<robot name='r'>\n<link name='tip'><collision><geometry>\n<mesh "
      "filename='package://hand/meshes/tip.stl'/></geometry></collision></link></robot>";
  fs::create_directories(folder_.path() / "hand" / "meshes");
  for (const std::string& said :
       {refusal("meshes/tip.stl", mjcf), refusal("hand/meshes/tip.stl", urdf),
        refusal("part.xml", "<mujoco>\n\n<include file='part.xml'/></mujoco>")})
    EXPECT_NE(said.find("pipe.xml:3: file = \""), std::string::npos) << said;
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
