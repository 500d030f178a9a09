// URDF files as scenes: where meshes lie, what links weigh, what joints do, and what is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "comparisons/input/scene.h"
#include "comparisons/robots/urdf_scene.h"
#include "comparisons/simulation/simulate.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// Numbers pass through text with all their digits; millimetres and degrees add a few roundings.
constexpr double kRounding = 1e-12;

class Urdf : public testing::Test {
 protected:
  input::Scene import(const std::string& inside,
                      const std::vector<robots::FingerLayer>& layers = {},
                      const std::vector<std::string>& package_paths = {}) {
    const fs::path file = folder_.path() / "urdf" / "robot.urdf";
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "<robot name=\"r\">\n" << inside << "</robot>\n";
    const fs::path meshes = folder_.path() / fmt::format("scene_{}", ++scenes_);
    fs::create_directories(meshes);
    const robots::ImportedScene imported =
        robots::import_urdf(file, meshes, "robot", layers, package_paths);
    notes_ = imported.notes;
    text_ = imported.text;
    return input::parse_scene(imported.text, meshes / "robot.toml");
  }
  bool is_noted(const std::string& words) const {
    return std::any_of(notes_.begin(), notes_.end(), [&](const std::string& note) {
      return note.find(words) != std::string::npos;
    });
  }
  std::string refusal(const std::string& inside) {
    try {
      import(inside);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "is not refused: " << inside;
    return "";
  }
  static const BodyDescription& body(const input::Scene& scene, const std::string& name) {
    for (const BodyDescription& one : scene.descriptions)
      if (one.name == name) return one;
    throw std::runtime_error("there is no body " + name);
  }
  static const input::SceneBody& shapes_of(const input::Scene& scene, const std::string& name) {
    for (const input::SceneBody& one : scene.bodies)
      if (one.name == name) return one;
    throw std::runtime_error("there is no body " + name);
  }

  /// A tetrahedron with corners at 0 and at these lengths along the axes, in the file's unit.
  void write_tetrahedron(const fs::path& file, double x, double y, double z) {
    fs::create_directories((folder_.path() / file).parent_path());
    std::ofstream(folder_.path() / file) << fmt::format(
        "v 0 0 0\nv {} 0 0\nv 0 {} 0\nv 0 0 {}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", x, y, z);
  }

  TemporaryFolder folder_;
  std::vector<std::string> notes_;
  std::string text_;
  int scenes_ = 0;
};

std::string link(const std::string& name, const std::string& inside) {
  return fmt::format("<link name=\"{}\">{}</link>\n", name, inside);
}
std::string collision(const std::string& geometry, const std::string& origin = "") {
  return fmt::format("<collision>{}<geometry>{}</geometry></collision>", origin, geometry);
}
std::string inertial(double mass_kg, const Vector3d& moments, const std::string& origin = "") {
  return fmt::format(
      "<inertial>{}<mass value=\"{}\"/><inertia ixx=\"{}\" ixy=\"0\" ixz=\"0\" iyy=\"{}\" "
      "iyz=\"0\" izz=\"{}\"/></inertial>",
      origin, mass_kg, moments.x(), moments.y(), moments.z());
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& more = "") {
  return fmt::format(
      "<joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>{}</joint>\n", name,
      type, parent, child, more);
}
const char* const kBall = "<sphere radius=\"0.01\"/>";
const std::string kMass = inertial(0.1, Vector3d::Constant(1e-5));

TEST_F(Urdf, FindMeshesWhereverTheyLie) {
  write_tetrahedron("meshes/tip.obj", 0.1, 0.2, 0.3);
  write_tetrahedron("hand_description/meshes/tip.obj", 0.1, 0.2, 0.3);
  write_tetrahedron("elsewhere/arm_description/tip.obj", 0.1, 0.2, 0.3);
  write_tetrahedron("named/tip.obj", 0.1, 0.2, 0.3);
  folder_.write("named/package.xml", "<package><name>called_so</name></package>");
  const std::string here = folder_.path().string();
  for (const std::string& name : {std::string("../meshes/tip.obj"), here + "/meshes/tip.obj",
                                  "file://" + here + "/meshes/tip.obj",
                                  std::string("package://hand_description/meshes/tip.obj"),
                                  std::string("model://hand_description/meshes/tip.obj"),
                                  std::string("package://renamed/meshes/tip.obj")}) {
    const input::Scene scene = import(link("base", collision("<mesh filename=\"" + name + "\"/>")));
    EXPECT_EQ(shapes_of(scene, "base").shapes.size(), 1u) << name;
  }
  const std::string package =
      link("base", collision("<mesh filename=\"package://arm_description/tip.obj\"/>"));
  EXPECT_EQ(import(package, {}, {here + "/elsewhere"}).bodies.size(), 1u);
  EXPECT_EQ(import(package, {}, {here + "/elsewhere/arm_description"}).bodies.size(), 1u);
  EXPECT_EQ(import(link("base", collision("<mesh filename=\"package://called_so/tip.obj\"/>")), {},
                   {here + "/named"})
                .bodies.size(),
            1u);
  const std::string missing = refusal(package);
  EXPECT_NE(missing.find("robot.urdf:2: file = \"package://arm_description/tip.obj\""),
            std::string::npos)
      << missing;
  EXPECT_NE(missing.find("--package-path DIR"), std::string::npos) << missing;
  EXPECT_NE(refusal(link("base", collision("<mesh filename=\"https://example.org/tip.obj\"/>")))
                .find("nothing is fetched"),
            std::string::npos);
}

/// A mirrored mesh keeps its outside outside, and has the mass of its size.
TEST_F(Urdf, ScaleAndMirrorMeshes) {
  write_tetrahedron("urdf/tip.obj", 10, 20, 30);
  for (const char* scale :
       {"0.001 0.001 0.001", "-0.001 0.001 0.001", "0.001 -0.002 0.003", "-0.001 -0.001 -0.001"}) {
    const input::Scene scene = import(
        link("base", "") +
        link("tip", collision(fmt::format("<mesh filename=\"tip.obj\" scale=\"{}\"/>", scale))) +
        joint("j", "continuous", "base", "tip"));
    double x, y, z;
    ASSERT_EQ(std::sscanf(scale, "%lf %lf %lf", &x, &y, &z), 3);
    const Vector3d size(10 * x, 20 * y, 30 * z);
    const MassProperties& mass = body(scene, "tip").mass;
    // Meshes are stored in single precision.
    constexpr double kSingle = 1e-6;
    EXPECT_NEAR(mass.mass_kg, 1000 * std::abs(size.prod()) / 6, kSingle * mass.mass_kg) << scale;
    EXPECT_LT((mass.center_m - size / 4).norm(), kSingle * size.norm()) << scale;
    EXPECT_TRUE(is_noted("link \"tip\" has no mass in the file: its shapes weigh"));
  }
  EXPECT_NE(refusal(link("base", collision("<mesh filename=\"tip.obj\" scale=\"0 1 1\"/>")))
                .find("three numbers that are not 0"),
            std::string::npos);
}

/// Links on fixed joints are parts of one body, with the mass, centre and inertia of all.
TEST_F(Urdf, MergeLinksOnFixedJoints) {
  const input::Scene scene = import(
      link("base", "") + link("arm", inertial(0.3, {1e-4, 2e-4, 2.5e-4}) + collision(kBall)) +
      joint("j", "revolute", "base", "arm",
            "<origin xyz=\"0 0 0.5\"/><axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\"/>") +
      link("frame", "") + joint("f", "fixed", "arm", "frame", "<origin xyz=\"0.1 0 0\"/>") +
      link("tip", inertial(0.1, {1e-5, 1e-5, 1e-5}) + collision(kBall)) +
      joint("t", "fixed", "frame", "tip",
            "<origin xyz=\"0 0 0.2\" rpy=\"0 0 1.5707963267948966\"/>"));
  ASSERT_EQ(scene.bodies.size(), 1u);
  const MassProperties& mass = scene.descriptions[0].mass;
  EXPECT_NEAR(mass.mass_kg, 0.4, kRounding);
  EXPECT_LT((mass.center_m - Vector3d(0.025, 0, 0.05)).norm(), kRounding);
  // Two parts 0.1 and 0.2 m apart: the product of masses over the sum, times squares of distances.
  const double reduced_kg = 0.3 * 0.1 / 0.4;
  EXPECT_NEAR(mass.inertia_kg_m2(0, 0), 1.1e-4 + reduced_kg * 0.04, kRounding);
  EXPECT_NEAR(mass.inertia_kg_m2(1, 1), 2.1e-4 + reduced_kg * 0.05, kRounding);
  EXPECT_NEAR(mass.inertia_kg_m2(0, 2), -reduced_kg * 0.02, kRounding);
  EXPECT_EQ(scene.bodies[0].shapes.size(), 2u);
  EXPECT_LT((scene.bodies[0].shapes[1].pose.translation() - Vector3d(0.1, 0, 0.2)).norm(),
            kRounding);
}

/// A box of 1000 kg/m3 where the file does not say what it weighs; impossible inertias are mended.
TEST_F(Urdf, MendMassesThatNoBodyHas) {
  const std::string box = collision("<box size=\"0.1 0.2 0.3\"/>");
  const auto only = [&](const std::string& inside) {
    return import(link("base", "") + link("tip", inside) + joint("j", "continuous", "base", "tip"))
        .descriptions.at(0)
        .mass;
  };
  EXPECT_NEAR(only(box).mass_kg, 6, kRounding);
  EXPECT_NEAR(only(inertial(0, Vector3d::Zero()) + box).mass_kg, 6, kRounding);
  // Zeros, and what an exporter's rounding makes of them.
  for (const Vector3d& none : {Vector3d(0, 0, 0), Vector3d(2.7e-20, 5.4e-20, 1.4e-20)}) {
    const MassProperties scaled = only(inertial(3, none) + box);
    EXPECT_NEAR(scaled.inertia_kg_m2(0, 0), 3. / 12 * (0.04 + 0.09), kRounding);
  }
  EXPECT_TRUE(is_noted("the inertia of link \"tip\" is impossible: it has that of its shapes"));
  const MassProperties raised = only(inertial(1, {1e-3, 1e-3, 5e-3}) + box);
  EXPECT_NEAR(raised.inertia_kg_m2(2, 2), 5e-3, 1e-9);
  EXPECT_NEAR(raised.inertia_kg_m2(0, 0), 2.5e-3, 1e-9);
  EXPECT_TRUE(is_noted("these are raised"));
  const double radius_m = std::cbrt(0.5 / 1000 * 3 / (4 * kPi));
  EXPECT_NEAR(only(inertial(0.5, Vector3d::Zero())).inertia_kg_m2(1, 1),
              0.4 * 0.5 * radius_m * radius_m, kRounding);
  // A joint does not move a link that weighs nothing.
  const input::Scene frame =
      import(link("base", kMass) + link("arm", kMass) + joint("a", "continuous", "base", "arm") +
             link("f", "") + joint("j", "continuous", "arm", "f"));
  EXPECT_EQ(frame.joints.size(), 1u);
  EXPECT_TRUE(is_noted("joint \"j\" moves nothing that weighs: it is fixed"));
}

TEST_F(Urdf, MoveByEachKindOfJoint) {
  const auto scene_with = [&](const std::string& type, const std::string& more) {
    return import(link("base", collision(kBall)) + link("tip", kMass + collision(kBall)) +
                  joint("j", type, "base", "tip", "<origin xyz=\"0 0 0.1\"/>" + more));
  };
  EXPECT_EQ(scene_with("floating", "").joints.size(), 0u);
  const input::Scene planar = scene_with("planar", "<axis xyz=\"0 0 2\"/>");
  ASSERT_EQ(planar.joints.size(), 3u);
  // Turning about z and moving across it, without falling along it.
  input::Scene falls = planar;
  falls.duration_s = 0.01;
  const simulation::Simulation run = simulation::simulate(falls);
  const auto& last = run.recording.frames.back();
  EXPECT_NEAR(last.poses.back().translation().z(), 0.1, kRounding);
  const input::Scene hinge =
      scene_with("revolute",
                 "<axis xyz=\"0 3 4\"/><limit lower=\"0.2\" upper=\"1\" effort=\"5\"/>"
                 "<dynamics damping=\"0.01\" friction=\"0.3\"/>");
  ASSERT_EQ(hinge.joints.size(), 1u);
  EXPECT_NEAR(hinge.joints[0].start, 0.2, kRounding);
  EXPECT_NEAR(hinge.joints[0].dry_friction, 0.3, kRounding);
  EXPECT_LT((hinge.joints[0].axis.normalized() - Vector3d(0, 0.6, 0.8)).norm(), kRounding);
  ASSERT_EQ(hinge.motors.size(), 1u);
  EXPECT_EQ(hinge.motors[0].max_effort, 5);
  EXPECT_EQ(hinge.motors[0].damping, 0.01);
  EXPECT_TRUE(is_noted("joint \"j\" starts at its limit"));
  // At its start the body is turned.
  const Eigen::AngleAxisd turn(0.2, Vector3d(0, 0.6, 0.8));
  EXPECT_TRUE(body(hinge, "tip").pose.linear().isApprox(turn.toRotationMatrix(), kRounding));
}

/// A finger that mimics another one moves as it, from where both start.
TEST_F(Urdf, MimicOtherJoints) {
  const std::string limit = "<axis xyz=\"1 0 0\"/><limit lower=\"0\" upper=\"0.04\" effort=\"5\"/>";
  input::Scene scene = import(link("base", "") + link("a", kMass) + link("b", kMass) +
                              joint("ja", "prismatic", "base", "a", limit) +
                              joint("jb", "prismatic", "base", "b",
                                    "<axis xyz=\"-1 0 0\"/><limit lower=\"0\" upper=\"0.09\"/>"
                                    "<mimic joint=\"ja\" multiplier=\"2\" offset=\"0.01\"/>"));
  ASSERT_EQ(scene.joints.size(), 2u);
  EXPECT_NEAR(scene.joints[1].start, 0.01, kRounding);
  input::Motion push;
  push.motor = 0;
  push.is_effort = true;
  push.table.time_s = {0};
  push.table.values = Eigen::MatrixXd::Constant(1, 1, 0.5);
  scene.motions.push_back(push);
  scene.gravity.values.setZero();
  scene.duration_s = 0.05;
  const simulation::Simulation run = simulation::simulate(scene);
  const auto& last = run.recording.frames.back();
  // 0.1 kg, and 0.1 kg at twice the speed.
  EXPECT_NEAR(last.velocities_m_per_s[0].x(), 0.5 / (0.1 + 4 * 0.1) * 0.05, 1e-9);
  EXPECT_NEAR(last.velocities_m_per_s[1].x(), -2 * last.velocities_m_per_s[0].x(), 1e-9);
  EXPECT_NEAR(last.poses[1].translation().x() + 0.01, -2 * last.poses[0].translation().x(), 1e-9);
  EXPECT_NE(refusal(link("base", "") + link("a", kMass) +
                    joint("ja", "prismatic", "base", "a", limit + "<mimic joint=\"none\"/>"))
                .find("mimic = \"none\": allowed: another joint of the file"),
            std::string::npos);
}

/// Bodies that a joint connects pass through each other; friction is the smaller one of two links.
TEST_F(Urdf, TouchAsTheFileSays) {
  const std::string contact = "<contact><lateral_friction value=\"0.3\"/></contact>";
  const input::Scene scene =
      import(link("base", collision(kBall)) + link("a", kMass + collision(kBall) + contact) +
             link("b", kMass + collision(kBall)) + link("c", kMass + collision(kBall)) +
             joint("ja", "continuous", "base", "a", "<origin xyz=\"0 0 0.1\"/>") +
             joint("jb", "continuous", "a", "b", "<origin xyz=\"0 0 0.1\"/>") +
             joint("jc", "continuous", "b", "c", "<origin xyz=\"0 0 0.1\"/>") +
             "<gazebo reference=\"c\"><mu1>0.2</mu1></gazebo>");
  ASSERT_EQ(scene.bodies.size(), 4u);
  EXPECT_FALSE(scene.rule(0, 1).collide);
  EXPECT_FALSE(scene.rule(1, 2).collide);
  EXPECT_TRUE(scene.rule(0, 2).collide);
  EXPECT_EQ(scene.rule(0, 2).shear_law.friction_coefficient, 1);
  EXPECT_EQ(scene.rule(1, 3).shear_law.friction_coefficient, 0.2);
}

TEST_F(Urdf, LetVisualShapesStandInOnlyWithoutCollisions) {
  const std::string visual = "<visual><geometry><box size=\"0.1 0.1 0.1\"/></geometry></visual>";
  const input::Scene scene =
      import(link("base", visual) + link("a", kMass + visual + collision(kBall)) +
             joint("j", "continuous", "base", "a") +
             link("camera",
                  "<visual><geometry><mesh filename=\"seen.dae\"/>"
                  "</geometry></visual>") +
             joint("c", "fixed", "a", "camera"));
  EXPECT_TRUE(std::holds_alternative<input::Box>(shapes_of(scene, "base").shapes.at(0).kind));
  EXPECT_TRUE(is_noted("link \"base\" has no collision: its visual shapes stand in"));
  ASSERT_EQ(shapes_of(scene, "a").shapes.size(), 1u);
  const input::Scene capsule =
      import(link("base", collision("<capsule radius=\"0.1\" length=\"0.3\"/>")));
  EXPECT_TRUE(std::holds_alternative<input::Capsule>(capsule.bodies[0].shapes[0].kind));
}

TEST_F(Urdf, AreRefusedByLine) {
  const std::string two = link("base", "") + link("tip", kMass);
  const auto expect = [&](const std::string& inside, const std::string& words) {
    const std::string said = refusal(inside);
    EXPECT_NE(said.find(words), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  };
  expect("<xacro:include filename=\"x\"/>", "robot.urdf:2: element = <xacro:include>");
  expect("<xacro:include filename=\"x\"/>", "Type: xacro robot.urdf -o robot.urdf");
  expect(two + joint("j", "hinge", "base", "tip"), "robot.urdf:4: joint \"j\": type = \"hinge\"");
  expect(two + joint("j", "revolute", "base", "tip"), "robot.urdf:4: joint \"j\": limit");
  expect(two + joint("j", "prismatic", "base", "tip", "<limit lower=\"1\" upper=\"0\"/>"),
         "limits = 1 to 0: allowed: lower <= upper");
  expect(two + joint("j", "continuous", "base", "tip", "<axis xyz=\"0 0 0\"/>"), "a direction");
  expect(two + joint("j", "continuous", "base", "tip", "<origin xyz=\"0 nan 0\"/>"),
         "<origin> xyz, line 4 = \"0 nan 0\": allowed: 3 finite numbers");
  expect(two + joint("j", "continuous", "base", "tip", "<origin xyz=\"0 0\"/>"),
         "3 finite numbers");
  expect(two + joint("j", "fixed", "base", "tip") + joint("k", "fixed", "base", "tip"),
         "robot.urdf:5: joint \"k\": child = \"tip\"");
  expect(two + link("tip", ""), "robot.urdf:4: link = \"tip\": allowed: each name once");
  expect(two + joint("j", "fixed", "nobody", "tip"), "urdfdom cannot read it");
  expect(two, "urdfdom cannot read it");  // two roots
  expect("", "urdfdom cannot read it");
  expect(link("base", collision("<cone radius=\"1\"/>")), "box, sphere, cylinder, capsule or mesh");
  expect(link("base",
              "<inertial><mass value=\"-1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" "
              "iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>"),
         "mass = -1");
  // Links and joints in a ring of their own hang on nothing.
  expect(link("base", "") + link("a", kMass) + link("b", kMass) + joint("j", "fixed", "a", "b") +
             joint("k", "fixed", "b", "a"),
         "joint \"k\": parent = \"b\"");
  std::string chain = link("l0", kMass);
  for (int i = 1; i <= 5001; ++i) chain += link("l" + std::to_string(i), "");
  expect(chain, "links: allowed: at most 5000");
}

/// Long chains are read without recursion that could end the program.
TEST_F(Urdf, ReadLongChains) {
  std::string chain = link("l0", "");
  for (int i = 1; i < 3000; ++i)
    chain += link("l" + std::to_string(i), "") + joint("j" + std::to_string(i), "fixed",
                                                       "l" + std::to_string(i - 1),
                                                       "l" + std::to_string(i));
  chain += link("tip", kMass) + joint("j", "continuous", "l2999", "tip");
  EXPECT_EQ(import(chain).joints.size(), 1u);
}

}  // namespace
}  // namespace softfinger::tests
