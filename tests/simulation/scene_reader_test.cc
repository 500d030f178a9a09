// The reader of scene files, and the program on bad ones: one line with the place, exit status 2;
// steps without solution: exit status 3, everything up to them written.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <sstream>

#include "comparisons/input/scene.h"
#include "comparisons/simulation/control.h"
#include "comparisons/simulation/overlapping_shapes.h"
#include "meshes/io/read_surface.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "tests/comparisons/run_program.h"
#include "tests/meshes/triangulated_ellipsoid.h"

namespace softfinger::tests {
namespace {

using input::Scene;

/// Line numbers below count from here.
const std::string kHead =
    "id = \"test\"\n"                      // 1
    "[simulation]\n"                       // 2
    "time_step_ms = 1\n"                   // 3
    "duration_s = 0.05\n"                  // 4
    "[[body]]\n"                           // 5
    "name = \"floor\"\n"                   // 6
    "fixed = true\n"                       // 7
    "shapes = [{ half_space = true }]\n";  // 8
const std::string kBall =
    "[[body]]\n"                               // 9
    "name = \"ball\"\n"                        // 10
    "mass_g = 100\n"                           // 11
    "position_mm = [0, 0, 10]\n"               // 12
    "shapes = [{ sphere_radius_mm = 10 }]\n";  // 13
const std::string kJoint =
    "[[joint]]\n"             // 14
    "name = \"rail\"\n"       // 15
    "kind = \"prismatic\"\n"  // 16
    "parent = \"world\"\n"    // 17
    "child = \"ball\"\n"      // 18
    "axis = [0, 0, 1]\n";     // 19

std::string with(std::string text, const std::string& old, const std::string& changed) {
  EXPECT_NE(text.find(old), std::string::npos) << old;
  return text.replace(text.find(old), old.size(), changed);
}

class SceneProgram : public testing::Test {
 protected:
  TemporaryFolder folder;
  Start start{folder.path(), {}, -1, ""};

  ProgramRun run(const std::vector<std::string>& arguments) {
    return run_softfinger(start, arguments);
  }

  /// One line on standard error that names the file, the line (0: none can be named) and the words.
  void expect_refusal(const std::string& text, int line, const std::vector<std::string>& words) {
    const std::string file = folder.write("scene.toml", text).string();
    const ProgramRun result = run({"simulate", file});
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
    EXPECT_EQ(result.err.rfind("softfinger: error: ", 0), 0u) << result.err;
    const std::string place = line > 0 ? fmt::format("scene.toml:{}:", line) : "scene.toml:";
    EXPECT_NE(result.err.find(place), std::string::npos) << place << "\n" << result.err;
    for (const std::string& word : words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
  }
};

TEST_F(SceneProgram, RunsAGoodScene) {
  const std::string file = folder.write("scene.toml", kHead + kBall + kJoint).string();
  const ProgramRun result = run({"simulate", file, "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["steps"], 50);
  EXPECT_TRUE(json["failure"].is_null());
  EXPECT_NEAR(json["contacts"][0]["normal_force_N"].get<double>(), 0.981, 1e-9);
}

TEST_F(SceneProgram, RefusesTheInputOfTheIssueWithOneLine) {
  const std::string good = kHead + kBall + kJoint;
  expect_refusal(with(good, "[0, 0, 10]", "[0, 0, 9]"), 0, {"\"floor\"", "\"ball\"", "overlap"});
  expect_refusal(with(good, "mass_g = 100", "mass_g = 0"), 11, {"mass_g", "> 0"});
  expect_refusal(with(good, "mass_g = 100", "mass_g = -5"), 11, {"mass_g = -5", "> 0"});
  expect_refusal(with(good, "mass_g = 100", "density_kg_per_m3 = 0"), 11, {"density_kg_per_m3"});
  expect_refusal(with(good, "mass_g = 100\n", "mass_g = 100\ninertia_kg_mm2 = [1, 1, 3]\n"), 12,
                 {"\"ball\"", "principal moment"});
  expect_refusal(with(good, "mass_g = 100\n", "mass_g = 100\ninertia_kg_mm2 = [1, 1, -1]\n"), 12,
                 {"\"ball\"", "principal moment"});
  expect_refusal(
      with(good, "mass_g = 100\n", "mass_g = 100\ninertia_kg_mm2 = [1, 1, 1, 2, 0, 0]\n"), 12,
      {"\"ball\""});
  expect_refusal(with(good, "child = \"ball\"", "child = \"bal\""), 18, {"child", "\"ball\""});
  expect_refusal(with(good, "parent = \"world\"", "parent = \"wrld\""), 17, {"parent"});
  expect_refusal(with(good, "child = \"ball\"\n", ""), 14, {"child"});
  expect_refusal(with(good, "parent = \"world\"\n", ""), 14, {"parent"});
  expect_refusal(with(good, "parent = \"world\"", "parent = \"ball\""), 14, {"rail", "parent"});
  expect_refusal(with(good, "child = \"ball\"", "child = \"floor\""), 14, {"rail", "child"});
  expect_refusal(good + "[[motor]]\njoint = \"rial\"\n", 21, {"joint", "\"rail\""});
  expect_refusal(kHead + kBall + "[[motor]]\njoint = \"rail\"\n", 15, {"joint"});
  expect_refusal(good + "[[motor]]\neffort_N = [1]\n", 20, {"joint"});
  expect_refusal(with(good, "time_step_ms = 1", "time_step_ms = 0"), 3, {"time_step_ms", "> 0"});
  expect_refusal(with(good, "time_step_ms = 1", "time_step_ms = -1"), 3, {"time_step_ms"});
  expect_refusal(with(good, "mass_g", "mas_g"), 11, {"\"mas_g\"", "did you mean \"mass_g\""});
  expect_refusal(with(good, "duration_s", "durations"), 4, {"did you mean \"duration_s\""});
  expect_refusal(with(good, "sphere_radius_mm", "sphere_radios_mm"), 13,
                 {"did you mean \"sphere_radius_mm\""});
  expect_refusal(good + "[[bodi]]\n", 20, {"did you mean \"body\""});
  expect_refusal(good + "[[contact]]\nbodies = [\"ball\", \"flor\"]\n", 21, {"\"floor\""});
  expect_refusal(good + "[[force]]\nbody = \"bal\"\ntime_s = [0]\nforce_N = [[0, 0, 1]]\n", 21,
                 {"\"ball\""});
}

TEST_F(SceneProgram, RefusesJointsLoopsAndReboundsThatMakeNoSense) {
  const std::string good = kHead + kBall + kJoint;
  const std::string loop =
      "[[loop]]\nname = \"pin\"\nkind = \"ball\"\nbodies = [\"ball\", \"world\"]\n"
      "anchor_mm = [0, 0, 20]\n";
  expect_refusal(with(good, "\"prismatic\"", "\"ball\""), 19, {"every axis"});
  expect_refusal(with(good, "\"prismatic\"", "\"ring\""), 16, {"\"revolute\" or", "\"ball\""});
  expect_refusal(good + with(loop, "\"world\"]", "\"wrld\"]"), 23, {"wrld"});
  expect_refusal(good + with(loop, "\"world\"]", "\"ball\"]"), 20, {"pin", "different"});
  expect_refusal(good + with(loop, "[\"ball\"", "[\"floor\""), 20, {"pin", "move"});
  expect_refusal(good + with(loop, "\"ball\"\nb", "\"hinge\"\nb"), 22, {"kind"});
  expect_refusal(good + loop + "axis = [0, 0, 1]\n", 25, {"axis"});
  expect_refusal(good + "rotor_mass_g = -1\n", 20, {"rotor_mass_g", ">= 0"});
  expect_refusal(good + "rotor_inertia_kg_mm2 = 1\n", 20, {"revolute"});
  expect_refusal(with(good, "mass_g = 100\n", "massless = true\n"), 0, {"ball", "massless"});
  const std::string contact = "[[contact]]\nbodies = [\"ball\", \"floor\"]\n";
  expect_refusal(good + contact + "restitution = 1.1\n", 22, {"restitution = 1.1", "0"});
  const ProgramRun run_with_all = run(
      {"simulate", folder.write("scene.toml", good + contact + "restitution = 0.5\n").string()});
  EXPECT_EQ(run_with_all.status, 0) << run_with_all.err;
}

TEST_F(SceneProgram, RefusesMoreThanASceneMayHold) {
  const std::string good = kHead + kBall + kJoint;
  const auto repeated = [](const std::string& text, int times) {
    std::string all;
    for (int i = 0; i < times; ++i) all += text;
    return all;
  };
  const std::string copies = "copies = { count = [10, 10, 10], spacing_mm = [30, 30, 30] }\n";
  expect_refusal(good + "[[body]]\nname = \"more\"\nmass_g = 1\n" + copies +
                     "shapes = [{ sphere_radius_mm = 1 }]\n",
                 21, {"more", "at most 1000 bodies in a scene, copies counted"});
  expect_refusal(kHead + repeated("[[body]]\nname = \"a\"\n", 1000), 5,
                 {"[[body]] = 1001 entries", "at most 1000"});
  expect_refusal(with(good, "[{ sphere_radius_mm = 10 }]",
                      "[" + repeated("{ sphere_radius_mm = 10 },", 101) + "]"),
                 13, {"shapes = 101 entries", "at most 100"});
  expect_refusal(good + repeated("[[layer]]\n", 101), 20, {"[[layer]] = 101 entries", "100"});
  expect_refusal(good + repeated("[[joint]]\n", 1000), 14, {"[[joint]] = 1001 entries", "1000"});
  expect_refusal(good + repeated("[[motor]]\n", 1001), 20, {"[[motor]] = 1001 entries", "1000"});
  expect_refusal(good + repeated("[[force]]\n", 1001), 20, {"[[force]] = 1001 entries", "1000"});
  expect_refusal(good + repeated("[[contact]]\n", 20001), 20, {"[[contact]] = 20001 entries"});
  const std::string motor = "[[motor]]\njoint = \"rail\"\n";
  expect_refusal(good + motor + "effort_N = [1]\ntime_s = [" + repeated("1,", 10001) + "]\n", 23,
                 {"time_s = 10001 entries", "at most 10000"});
  expect_refusal(with(good, "duration_s = 0.05",
                      "duration_s = 1\ngravity_time_s = [0]\ngravity_m_per_s2 = [" +
                          repeated("[0, 0, 1],", 10001) + "]"),
                 6, {"gravity_m_per_s2 = 10001 entries"});
  expect_refusal(good + "[[contact]]\nbodies = [\"ball\", \"*\"]\nmodel = \"table\"\n" +
                     "eccentricity_table = { loads_N = [1, 2], eccentricity_mm = [" +
                     repeated("1,", 1001) + "] }\n",
                 23, {"eccentricity_mm = 1001 entries", "at most 1000"});
  expect_refusal(with(good, "duration_s = 0.05", "duration_s = 1001"), 4,
                 {"at most 1000000 steps"});
  expect_refusal(with(with(good, "duration_s = 0.05", "duration_s = 1000"), "mass_g = 100\n",
                      "mass_g = 100\ncopies = { count = [5, 1, 1], spacing_mm = [30, 0, 0] }\n"),
                 4, {"steps times bodies of at most 5000000"});
}

TEST_F(SceneProgram, RefusesWhatAStepCannotHold) {
  const std::string good = kHead + kBall + kJoint;
  expect_refusal(with(good, "duration_s = 0.05", "duration_s = 1e-6"), 3, {"at most the duration"});
  expect_refusal(
      with(good, "mass_g = 100\n", "mass_g = 100\nangular_velocity_deg_per_s = [0, 1e9, 0]\n"), 12,
      {"half a turn per time step"});
  expect_refusal(good + "[[force]]\nbody = \"ball\"\ntime_s = [0]\nforce_N = [[0, 0, 1e200]]\n", 23,
                 {"force_N", "each at most 1e+12"});
  expect_refusal(good + "[[force]]\nbody = \"ball\"\ntime_s = [0]\ntorque_Nm = [[0, -1e13, 0]]\n",
                 23, {"torque_Nm", "each at most 1e+12"});
}

TEST_F(SceneProgram, RefusesVelocitiesThatABodyCannotHave) {
  const std::string good = kHead + kBall + kJoint;
  const auto moving = [&](const std::string& line) {
    return with(good, "mass_g = 100\n", "mass_g = 100\n" + line + "\n");
  };
  expect_refusal(moving("velocity_mm_per_s = [1, 0, 3]"), 12,
                 {"velocity_mm_per_s", "\"rail\"", "\"ball\"", "[0, 0, 3]"});
  expect_refusal(moving("angular_velocity_deg_per_s = [0, 0, 3]"), 12,
                 {"angular_velocity_deg_per_s", "\"rail\""});
  expect_refusal(
      with(kHead, "fixed = true\n", "fixed = true\nvelocity_mm_per_s = [1, 0, 0]\n") + kBall, 8,
      {"velocity_mm_per_s", "\"floor\"", "fixed"});
  expect_refusal(good + "[[contact]]\nbodies = [\"ball\", \"ball\"]\n", 21,
                 {"does not touch itself"});
  expect_refusal(
      with(good, "duration_s = 0.05\n", "duration_s = 0.05\ngravity_m_per_s2 = [0, 0, -1e300]\n"),
      5, {"gravity_m_per_s2", "1e+300", "each at most 1e+09"});
}

TEST_F(SceneProgram, RefusesCommandsThatAStepCannotHold) {
  const std::string file =
      folder
          .write("scene.toml",
                 kHead + kBall + kJoint + "[[motor]]\njoint = \"rail\"\nstiffness_N_per_m = 7\n")
          .string();
  const auto refused = [&](const std::string& command) {
    Start controlled = start;
    controlled.input = folder.write("commands", command + "\n").string();
    const ProgramRun result = run_softfinger(controlled, {"simulate", file, "--control"});
    EXPECT_EQ(result.status, 2) << result.err;
    return result.err;
  };
  const auto expect = [&](const std::string& command, const std::vector<std::string>& words) {
    const std::string said = refused(command);
    for (const std::string& word : words) EXPECT_NE(said.find(word), std::string::npos) << said;
  };
  expect(R"({"motors": {"rail": {"target": 1e308}}})", {"motors.rail.target", "1e+308", "1e+12"});
  expect(R"({"gravity_m_per_s2": [0, 0, 1e11]})", {"gravity_m_per_s2", "1e+09"});
  expect(R"({"forces": {"floor": {"force_N": [1, 0, 0]}}})", {"forces.floor", "not fixed"});
  expect("{\"motors\"\xbc{}}", {"invalid UTF-8 byte at index 9", "JSON object on one line"});
  expect("{\"steps\": " + std::string(100'000, '1') + "}", {"steps", "..."});
}

TEST_F(SceneProgram, KeepsNoFramesUnderControl) {
  const input::Scene scene = input::parse_scene(kHead + kBall, "scene.toml");
  std::istringstream commands("{\"steps\": 20}\n{\"steps\": 10}\n");
  std::ostringstream states;
  simulation::Control control(scene, commands, states);
  const simulation::Simulation run = simulation::simulate(scene, control.options());
  EXPECT_EQ(run.steps, 30);
  ASSERT_EQ(run.recording.frames.size(), 1u);
  EXPECT_NEAR(run.recording.frames[0].time_s, 30 * scene.time_step_s, 1e-12);
  EXPECT_EQ(lines(states.str()).size(), 3u);
}

TEST_F(SceneProgram, IsInterruptedWithTheUsualStatus) {
  const std::string file =
      folder.write("scene.toml", with(kHead + kBall, "duration_s = 0.05", "duration_s = 1000"))
          .string();
  const std::string pipe = (folder.path() / "commands").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  // Held open: the program waits for a command that does not come.
  const int writer = open(pipe.c_str(), O_RDWR);
  for (const bool is_controlled : {false, true}) {
    SCOPED_TRACE(is_controlled);
    Start begun = start;
    std::vector<std::string> words = {"simulate", file};
    if (is_controlled) {
      begun.input = pipe;
      words.push_back("--control");
    }
    const pid_t process = start_softfinger(begun, words);
    // Once it catches the signal: until then the default would end it.
    const std::string status = "/proc/" + std::to_string(process) + "/status";
    const auto catches = [&] {
      const std::string text = file_text(status);
      const std::size_t at = text.find("SigCgt:");
      return at != std::string::npos &&
             (std::stoull(text.substr(at + 7), nullptr, 16) >> (SIGINT - 1) & 1) != 0;
    };
    for (int i = 0; i < 1000 && !catches(); ++i) usleep(10000);
    usleep(100000);
    kill(process, SIGINT);
    const ProgramRun run = wait_for(begun, process);
    EXPECT_EQ(run.status, 128 + SIGINT) << run.err;
    EXPECT_NE(run.err.find("interrupted after"), std::string::npos) << run.err;
  }
  close(writer);
}

TEST_F(SceneProgram, RefusesNamesThatAreNoNames) {
  const std::string good = kHead + kBall + kJoint;
  const auto named = [&](const std::string& name) { return with(good, "\"ball\"", name); };
  expect_refusal(named("\"\""), 10, {"name", "1 to 100 bytes"});
  expect_refusal(named("\"" + std::string(101, 'x') + "\""), 10, {"name", "1 to 100 bytes"});
  expect_refusal(named("\"a\\u001b[31mb\""), 10, {"name", "\\x1b", "control characters"});
  expect_refusal(named("\"two\\nlines\""), 10, {"name", "control characters"});
  expect_refusal(with(good, "\"rail\"", "\"\""), 15, {"name", "1 to 100 bytes"});
}

TEST_F(SceneProgram, QuotesNamesInItsTables) {
  std::string text = with(kHead + kBall, "\"ball\"", "\"ball, \\\"red\\\"\"");
  const std::string file = folder.write("scene.toml", text).string();
  ASSERT_EQ(run({"simulate", file, "--output", (folder.path() / "out").string()}).status, 0);
  const auto rows = lines(file_text(folder.path() / "out" / "contacts.csv"));
  ASSERT_GT(rows.size(), 1u);
  EXPECT_NE(rows[1].find(",floor,\"ball, \"\"red\"\"\","), std::string::npos) << rows[1];
}

TEST_F(SceneProgram, RefusesRingsAndSecondParents) {
  const std::string second =
      with(with(kBall, "\"ball\"", "\"other\""), "[0, 0, 10]", "[50, 0, 10]");
  const auto joint = [](const char* name, const char* parent, const char* child) {
    return fmt::format(
        "[[joint]]\nname = \"{}\"\nkind = \"fixed\"\nparent = \"{}\"\nchild = \"{}\"\n", name,
        parent, child);
  };
  expect_refusal(kHead + kBall + second + joint("a", "ball", "other") + joint("b", "other", "ball"),
                 0, {"ring"});
  expect_refusal(
      kHead + kBall + second + joint("a", "world", "other") + joint("b", "ball", "other"), 0,
      {"\"b\"", "another parent"});
}

TEST_F(SceneProgram, RefusesAMeshThatIsNotClosedWhereMassIsDerived) {
  folder.write("open.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  const std::string mesh = with(kHead + kBall, "sphere_radius_mm = 10", "mesh = \"open.obj\"");
  // The refusal names the line of the body's mass or shape.
  const std::string file = folder.write("scene.toml", mesh).string();
  const ProgramRun result = run({"simulate", file});
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
  EXPECT_NE(result.err.find("scene.toml:1"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("closed"), std::string::npos) << result.err;
  // Given mass and inertia, an open surface is enough.
  folder.write("scene.toml",
               with(mesh, "mass_g = 100\n", "mass_g = 100\ninertia_kg_mm2 = [1, 1, 1]\n"));
  EXPECT_EQ(run({"simulate", file}).status, 0) << run({"simulate", file}).err;
  expect_refusal(with(kHead + kBall, "sphere_radius_mm = 10", "mesh = \"missing.obj\""), 13,
                 {"missing.obj"});
}

TEST_F(SceneProgram, SaysThatTrianglesOfAMeshWereTurned) {
  folder.write("mixed.obj",
               "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 4 3\nf 1 4 3\n");
  const std::string mesh = with(kHead + kBall, "sphere_radius_mm = 10", "mesh = \"mixed.obj\"");
  const ProgramRun result = run({"simulate", folder.write("scene.toml", mesh).string()});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("mixed.obj: 1 of 4 triangles faced the other way"), std::string::npos)
      << result.err;
}

TEST_F(SceneProgram, ReportsAStepWithoutSolutionAndWritesEverythingUpToIt) {
  // Wider than the slot between two fixed walls by less than what counts as overlap at the start.
  const std::string text =
      "id = \"wedge\"\n[simulation]\ntime_step_ms = 1\nduration_s = 0.1\n"
      "[[body]]\nname = \"floor\"\nfixed = true\nshapes = [{ half_space = true }]\n"
      "[[body]]\nname = \"left\"\nfixed = true\nposition_mm = [-14.9995, 0, 10]\n"
      "shapes = [{ box_size_mm = [10, 20, 20] }]\n"
      "[[body]]\nname = \"right\"\nfixed = true\nposition_mm = [14.9995, 0, 10]\n"
      "shapes = [{ box_size_mm = [10, 20, 20] }]\n"
      "[[body]]\nname = \"ball\"\nmass_g = 100\nposition_mm = [0, 0, 10]\n"
      "shapes = [{ sphere_radius_mm = 10 }]\n";
  const std::string file = folder.write("wedge.toml", text).string();
  const ProgramRun result = run({"simulate", file, "--json", "--output", "results"});
  EXPECT_EQ(result.status, 3) << result.err << result.out;
  if (result.status != 3) return;
  const auto json = nlohmann::json::parse(result.out);
  const int steps = json["steps"].get<int>();
  EXPECT_EQ(steps, 0);
  const std::string failure = json["failure"].get<std::string>();
  EXPECT_NE(failure.find("step 1 at 0 s"), std::string::npos) << failure;
  EXPECT_NE(failure.find("\"ball\""), std::string::npos) << failure;
  EXPECT_NE(failure.find("\"left\""), std::string::npos) << failure;
  EXPECT_NE(failure.find("\"right\""), std::string::npos) << failure;
  EXPECT_EQ(failure.find("\"floor\""), std::string::npos) << "has no part in it: " << failure;
  EXPECT_NE(result.err.find(failure), std::string::npos) << result.err;
  EXPECT_GE(lines(file_text(folder.path() / "results" / "trajectory.csv")).size(), 2u)
      << "the start";
  for (const char* name : {"trajectory.json", "contacts.csv", "motion.html", "simulation.json"})
    EXPECT_FALSE(file_text(folder.path() / "results" / name).empty()) << name;
}

TEST_F(SceneProgram, RefusesShearLawsThatItCannotUse) {
  const std::string head = "[[contact]]\nbodies = [\"*\", \"*\"]\n";  // lines 20 and 21
  const std::string scene = kHead + kBall + kJoint + head;
  expect_refusal(scene + "shear_law = \"sticky\"\n", 22, {"shear_law", "\"limited\""});
  expect_refusal(scene + "shear_law = \"limited\"\n", 20, {"shear_strength_kPa"});
  expect_refusal(scene + "shear_strength_kPa = 4\n", 22, {"shear_strength_kPa", "\"limited\""});
  expect_refusal(scene + "shear_law = \"limited\"\nshear_strength_kPa = 0\n", 23,
                 {"shear_strength_kPa", "> 0"});
  expect_refusal(scene + "shear_law = \"limited\"\nshear_strength_kPa = 9\nmodel = \"rigid\"\n", 22,
                 {"shear_law", "area"});
}

// --- what is read --------------------------------------------------------------------------------

TEST(Scene, IsReadInSi) {
  const input::Scene scene = input::parse_scene(
      kHead +
          with(kBall, "mass_g = 100\n",
               "mass_g = 100\nvelocity_mm_per_s = [0, 0, 3]\nrotation_deg = [10, 20, 30]\n") +
          with(kJoint, "parent = \"world\"", "parent = \"floor\"") +
          "start_mm = 5\nlimits_mm = [-10, inf]\n[[motor]]\njoint = \"rail\"\n"
          "stiffness_N_per_m = 7\nmax_effort_N = 3\ntime_s = [1, 3]\nposition_mm = [0, 100]\n"
          "[[contact]]\nbodies = [\"*\", \"*\"]\nfriction_coefficient = 0.3\n"
          "[[contact]]\nbodies = [\"fl*\", \"ball\"]\nfriction_coefficient = 0.7\n",
      "scene.toml");
  EXPECT_EQ(scene.time_step_s, 1e-3);
  EXPECT_EQ(scene.steps(), 50);
  ASSERT_EQ(scene.bodies.size(), 2u);
  const BodyDescription& ball = scene.descriptions[1];
  EXPECT_NEAR(ball.mass.mass_kg, 0.1, 1e-16);
  EXPECT_NEAR(ball.mass.inertia_kg_m2(1, 1), 0.4 * 0.1 * 1e-4, 1e-20);
  EXPECT_LE((ball.velocity_m_per_s - Eigen::Vector3d(0, 0, 3e-3)).norm(), 1e-17);
  ASSERT_EQ(scene.start_velocity.size(), 1) << "of the joint";
  EXPECT_NEAR(scene.start_velocity[0], 3e-3, 1e-15) << "along its axis, z";
  const input::Scene free =
      input::parse_scene(kHead + with(kBall, "mass_g = 100\n",
                                      "mass_g = 100\nvelocity_mm_per_s = [1, 2, 3]\n"
                                      "angular_velocity_deg_per_s = [180, 0, 0]\n"),
                         "scene.toml");
  EXPECT_LE((free.descriptions[1].velocity_m_per_s - Eigen::Vector3d(1e-3, 2e-3, 3e-3)).norm(),
            1e-17);
  EXPECT_NEAR(free.descriptions[1].angular_velocity_rad_per_s.x(), kPi, 1e-14);
  const double d = kPi / 180;
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(30 * d, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(20 * d, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(10 * d, Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  EXPECT_LE((ball.pose.linear() - turn).norm(), 1e-14) << "about the fixed x, y, z, in this order";
  EXPECT_EQ(scene.joints[0].parent, 0);
  EXPECT_NEAR(scene.joints[0].start, 5e-3, 1e-18);
  EXPECT_NEAR(scene.joints[0].lower, -10e-3, 1e-17);
  EXPECT_TRUE(std::isinf(scene.joints[0].upper));
  EXPECT_EQ(scene.motors[0].max_effort, 3);
  EXPECT_EQ(scene.rule(0, 1).shear_law.friction_coefficient, 0.7) << "the last one that fits";
  EXPECT_EQ(scene.rule(1, 0).shear_law.friction_coefficient, 0.7);
  EXPECT_EQ(scene.rule(0, 0).shear_law.friction_coefficient, 0.3);
  // Eased: at rest at both ends, half way at half time, at 15/8 of the mean speed.
  const input::TimeTable& table = scene.motions[0].table;
  EXPECT_EQ(table.value(0)[0], 0);
  EXPECT_EQ(table.value(1)[0], 0);
  EXPECT_NEAR(table.value(2)[0], 0.05, 1e-16);
  EXPECT_NEAR(table.rate(2)[0], 0.05 * 15 / 8, 1e-15);
  EXPECT_EQ(table.rate(3)[0], 0);
  EXPECT_NEAR(table.value(4)[0], 0.1, 1e-16);
  const double h = 1e-6;
  for (double t = 1.1; t < 3; t += 0.2)
    EXPECT_NEAR(table.rate(t)[0], (table.value(t + h)[0] - table.value(t - h)[0]) / (2 * h), 1e-9);
}

/// The law of the ball on the floor.
const input::FrictionLaw& law_of(const std::string& simulation, const std::string& contact) {
  const std::string text = with(kHead, "duration_s = 0.05\n", "duration_s = 0.05\n" + simulation) +
                           kBall + "[[contact]]\nbodies = [\"floor\", \"ball\"]\n" + contact;
  return input::parse_scene(text, "scene.toml").friction_law(0, 1);
}

TEST(Scene, NamesEachFrictionLaw) {
  EXPECT_EQ(&law_of("", ""), &input::kEllipsoidLaw);
  for (const input::FrictionLaw* law : input::all_friction_laws()) {
    const std::string named = fmt::format("friction = \"{}\"\n", law->name);
    EXPECT_EQ(&law_of(named, ""), law);
    if (law != &input::kFacetsLaw) {
      EXPECT_EQ(&law_of("friction = \"limit_surface\"\n", named), law) << "of one pair alone";
    }
  }
  EXPECT_EQ(&law_of("", "limit_surface = true\n"), &input::kLimitSurfaceLaw);
  EXPECT_EQ(&law_of("friction = \"six_patches\"\n", "limit_surface = false\n"),
            &input::kEllipsoidLaw);
  EXPECT_EQ(&law_of("friction = \"facets\"\n", "limit_surface = false\n"), &input::kFacetsLaw);
}

TEST_F(SceneProgram, RefusesFrictionLawsThatDoNotGoTogether) {
  const auto scene = [](const std::string& simulation, const std::string& contact) {
    return with(kHead, "duration_s = 0.05\n", "duration_s = 0.05\n" + simulation) + kBall +
           "[[contact]]\nbodies = [\"floor\", \"ball\"]\n" + contact;
  };
  const std::string facets = "friction = \"facets\"\n";
  expect_refusal(scene("friction = \"six_patch\"\n", ""), 5,
                 {"friction", "six_patches", "limit_surface", "facets"});
  expect_refusal(scene("", facets), 16, {"facets", "all contacts"});
  expect_refusal(scene(facets, "friction = \"six_patches\"\n"), 17, {"facets", "all contacts"});
  expect_refusal(scene(facets, "limit_surface = true\n"), 17, {"limit_surface", "facets"});
  expect_refusal(scene("", "limit_surface = true\nfriction = \"ellipsoid\"\n"), 16, {"give one"});
}

TEST(Scene, UnitesTheMassOfSeveralShapes) {
  // A dumb-bell: two balls and a rod; parallel axes.
  const std::string dumb_bell = with(
      kBall, "[{ sphere_radius_mm = 10 }]",
      "[{ sphere_radius_mm = 10, position_mm = [30, 0, 0] }, { sphere_radius_mm = 10, "
      "position_mm = [-30, 0, 0] }, { cylinder_radius_length_mm = [5, 40], rotation_deg = [0, 90, "
      "0] }]");
  const input::Scene scene = input::parse_scene(kHead + dumb_bell, "scene.toml");
  const double ball = 4 * kPi / 3 * 1e-6, rod = kPi * 25e-6 * 0.04, all = 2 * ball + rod;
  const double along = (2 * ball * 0.4e-4 + rod * 12.5e-6) / all;
  const double across = (2 * ball * (0.4e-4 + 9e-4) + rod * (25e-6 / 4 + 0.0016 / 12)) / all;
  const Eigen::Matrix3d inertia = scene.descriptions[1].mass.inertia_kg_m2 / 0.1;
  EXPECT_LE((inertia - Eigen::Matrix3d(Eigen::Vector3d(along, across, across).asDiagonal())).norm(),
            1e-13 * across);
  EXPECT_LE(scene.descriptions[1].mass.center_m.norm(), 1e-17);
}

TEST(Scene, SaysWhatOfABodyWeighsTwice) {
  const auto said = [](const std::string& shapes, const std::string& mass = "mass_g = 100\n") {
    std::string text = with(kBall, "[{ sphere_radius_mm = 10 }]", "[" + shapes + "]");
    text = with(text, "mass_g = 100\n", mass);
    const auto remarks =
        simulation::overlap_remarks(input::parse_scene(kHead + text, "scene.toml"));
    EXPECT_LE(remarks.size(), 1u);
    return remarks.empty() ? "" : remarks.front();
  };
  const std::string ball = "{ sphere_radius_mm = 10 }";
  EXPECT_EQ(said(ball), "");
  // The boxes' volumes add up to 4 cm³, of which 1 cm³ is counted twice.
  const std::string two_boxes =
      "{ box_size_mm = [10, 10, 20] }, { box_size_mm = [10, 10, 20], position_mm = [0, 0, 10] }";
  const std::string twice = said(two_boxes);
  EXPECT_NE(twice.find("body \"ball\": shapes 1 and 2 overlap: about 25 %"), std::string::npos)
      << twice;
  EXPECT_NE(said(two_boxes, "density_kg_per_m3 = 1000\n"), "");
  EXPECT_EQ(said(two_boxes, "mass_g = 100\ninertia_kg_mm2 = [1, 1, 1]\n"), "") << "it is typed";
  // Shapes that only touch do not weigh twice.
  EXPECT_EQ(said("{ box_size_mm = [10, 10, 20] }, { box_size_mm = [10, 10, 20], position_mm = [0, "
                 "0, 20] }"),
            "");
  EXPECT_EQ(said(ball + ", { sphere_radius_mm = 10, position_mm = [20, 0, 0] }"), "");
  EXPECT_NE(said(ball + ", { sphere_radius_mm = 10, position_mm = [15, 0, 0] }"), "");
}

TEST_F(SceneProgram, SaysThatShellsWithinEachOtherWeighTwice) {
  TriangleSurface shells =
      meshes::triangulated_ellipsoid({20e-3, 20e-3, 20e-3}, Eigen::Vector3d::Zero(), 12);
  const TriangleSurface inner =
      meshes::triangulated_ellipsoid({10e-3, 10e-3, 10e-3}, Eigen::Vector3d::Zero(), 12);
  const int before = int(shells.vertices_m.size());
  for (const Eigen::Vector3d& vertex : inner.vertices_m) shells.vertices_m.push_back(vertex);
  for (const auto& triangle : inner.triangles)
    shells.triangles.push_back({triangle[0] + before, triangle[1] + before, triangle[2] + before});
  meshes::write_stl_mm(shells, (folder.path() / "shells.stl").string());
  const std::string ball =
      with(with(kBall, "{ sphere_radius_mm = 10 }", "{ mesh = \"shells.stl\" }"), "[0, 0, 10]",
           "[0, 0, 21]");
  const ProgramRun result =
      run({"simulate", folder.write("scene.toml", kHead + ball).string(), "--json"});
  EXPECT_EQ(result.status, 0) << result.err;
  // The inner ball has an eighth of the volume of the outer one: 1/9 of what is counted.
  EXPECT_NE(result.err.find("shells of shape 1 lie within each other or overlap: about 11 %"),
            std::string::npos)
      << result.err;
}

}  // namespace
}  // namespace softfinger::tests
