// From a scan to a case: softfinger mesh, along in a case, init --mesh.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "meshes/io/read_surface.h"
#include "tests/comparisons/run_program.h"
#include "tests/meshes/capsule_finger.h"

namespace softfinger::tests {
namespace fs = std::filesystem;
using nlohmann::json;

/// An ellipsoid of 24 x 14 x 28 mm.
class MeshCommand : public testing::Test {
 protected:
  TemporaryFolder folder;
  Start start{folder.path(), {}, -1, "", ""};
  const double a = 12e-3, b = 7e-3, c = 14e-3;

  void SetUp() override { write("tip.stl", 1); }
  /// @param scale  of the numbers in the file, which are millimetres for 1
  void write(const std::string& name, double scale) {
    meshes::write_stl_mm(meshes::triangulated_ellipsoid({scale * a, scale * b, scale * c},
                                                        Eigen::Vector3d::Zero(), 32),
                         (folder.path() / name).string());
  }
  ProgramRun run(const std::vector<std::string>& arguments) {
    return run_softfinger(start, arguments);
  }
  json answer_of(const std::vector<std::string>& arguments) {
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.status == 0 ? json::parse(result.out) : json();
  }
  void expect_refusal(const std::vector<std::string>& arguments, const std::string& word) {
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
    EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
  }
};

TEST_F(MeshCommand, FindsThePolesOfAnEllipsoidAndTheirRadii) {
  const json found = answer_of({"mesh", "tip.stl", "--json"});
  EXPECT_TRUE(found["closed"].get<bool>());
  EXPECT_EQ(found["unit"], "mm");
  EXPECT_TRUE(found["unit_doubt"].is_null());
  // Vertices lie on the ellipsoid; STL stores seven digits.
  EXPECT_NEAR(found["bounds_m"][1][1].get<double>(), b, 1e-6 * b);
  ASSERT_EQ(found["points"].size(), 6u);
  const double axes[] = {a, b, c};
  for (const json& point : found["points"]) {
    const std::string name = point["name"];
    const int axis = name[1] - 'x';
    const double sign = name[0] == '-' ? -1 : 1;
    EXPECT_NEAR(point["point_m"][axis].get<double>(), sign * axes[axis], 1e-6 * axes[axis]);
    EXPECT_GT(sign * point["normal"][axis].get<double>(), 0.999) << point;
    // R = (semi-axis across)² / (semi-axis along) at a pole; the region of forty vertices is wide.
    double radii[] = {std::pow(axes[(axis + 1) % 3], 2) / axes[axis],
                      std::pow(axes[(axis + 2) % 3], 2) / axes[axis]};
    if (radii[0] < radii[1]) std::swap(radii[0], radii[1]);
    for (int i = 0; i < 2; ++i)
      EXPECT_NEAR(point["radii_m"][i].get<double>() / radii[i], 1, 0.15) << point;
  }
  EXPECT_EQ(answer_of({"mesh", "tip.stl", "--along", "-y", "--json"})["points"].size(), 1u);
  const json near = answer_of({"mesh", "tip.stl", "--near", "0.3,-7.1,0.2", "--json"})["points"][0];
  EXPECT_NEAR(near["point_m"][0].get<double>(), 0.3e-3, 0.05e-3);
  EXPECT_LT(near["normal"][1].get<double>(), -0.99);
}

TEST_F(MeshCommand, SaysWhereverAMeshIsReadThatTrianglesWereTurned) {
  // Every fourth triangle, among them some at the point.
  TriangleSurface mixed = meshes::triangulated_ellipsoid({a, b, c}, Eigen::Vector3d::Zero(), 32);
  for (std::size_t t = 0; t < mixed.triangles.size(); t += 4)
    std::swap(mixed.triangles[t][1], mixed.triangles[t][2]);
  meshes::write_stl_mm(mixed, (folder.path() / "mixed.stl").string());
  const std::string note = fmt::format("{} of {} triangles faced the other way",
                                       (mixed.triangles.size() + 3) / 4, mixed.triangles.size());
  enum Output { same, with_times };
  const auto expect_note = [&](Output output, std::vector<std::string> arguments) {
    const ProgramRun good = run(arguments);
    for (std::string& argument : arguments)
      if (argument == "tip.stl" || argument == "tip.toml") argument.replace(0, 3, "mixed");
    const ProgramRun turned = run(arguments);
    EXPECT_EQ(turned.status, 0) << turned.err;
    EXPECT_NE(turned.err.find(note), std::string::npos) << arguments[0] << ": " << turned.err;
    EXPECT_EQ(good.err.find("faced the other way"), std::string::npos) << good.err;
    if (output == same) {
      EXPECT_EQ(turned.out, good.out) << arguments[0];
    }
  };
  expect_note(same, {"fit", "tip.stl", "--point", "0,-7,0", "--radius-mm", "3"});
  ASSERT_EQ(run({"init", "tip.toml", "--mesh", "tip.stl", "--along", "-y"}).status, 0);
  std::ifstream in(folder.path() / "tip.toml");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.replace(text.rfind("tip.stl"), 3, "mixed");
  folder.write("mixed.toml", text);
  expect_note(with_times, {"predict", "tip.toml"});
  expect_note(with_times, {"select", "tip.toml", "--tolerance", "0.5"});
  expect_note(same, {"export", "tip.toml", "--to", "mujoco"});
}

TEST_F(MeshCommand, GivesLinesThatACaseTakes) {
  const std::string rest =
      "object = { radii_mm = [inf, inf] }\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
      "poisson_ratio = 0.45\n[contact]\nload_N = 1\nfriction_coefficient = 0.8\n";
  const auto answer = [&](const std::string& finger) {
    folder.write("case.toml", "id = \"tip\"\n[geometry]\n" + finger + "\n" + rest);
    return answer_of({"predict", "case.toml", "--model", "bonded_layer", "--json"})["results"][0];
  };
  const json pasted =
      answer(answer_of({"mesh", "tip.stl", "--along", "-y", "--json"})["points"][0]["toml"]);
  const json along = answer("finger = { mesh = \"tip.stl\", along = \"-y\" }");
  // The line has four decimals of a millimetre, and the normal that the fit found.
  for (const char* key : {"a_m", "b_m", "max_torque_Nm"})
    EXPECT_NEAR(along[key].get<double>() / pasted[key].get<double>(), 1, 1e-3) << key;
  const auto refuse = [&](const std::string& finger, const std::string& word) {
    folder.write("case.toml", "id = \"tip\"\n[geometry]\n" + finger + "\n" + rest);
    expect_refusal({"predict", "case.toml"}, word);
  };
  refuse("finger = { mesh = \"tip.stl\", along = \"up\" }", "case.toml:3: finger.along");
  refuse("finger = { mesh = \"tip.stl\", along = \"-y\", point_mm = [0, -7, 0] }", "one of them");
  refuse("finger = { mesh = \"tip.stl\" }", "along");
  refuse("finger = { radii_mm = [9, 7], along = \"-y\" }", "belongs to a mesh");
}

TEST_F(MeshCommand, TakesTheFingerThatAlongMeansToTheFiniteElements) {
  ASSERT_EQ(run({"init", "case.toml", "--mesh", "tip.stl", "--along", "-y"}).status, 0);
  const json along = answer_of(
      {"fem", "case.toml", "--json", "--set", "fem.geometry=curved", "--set", "contact.load_N=1"});
  EXPECT_EQ(along["results"].size(), 1u);
}

TEST_F(MeshCommand, GuessesTheUnit) {
  write("metres.stl", 1e-3);
  const json metres = answer_of({"mesh", "metres.stl", "--json"});
  EXPECT_EQ(metres["unit"], "m");
  EXPECT_TRUE(metres["unit_doubt"].is_null());
  EXPECT_NEAR(metres["bounds_m"][1][2].get<double>(), c, 1e-6 * c);
  EXPECT_NE(metres["points"][0]["toml"].get<std::string>().find("unit = \"m\""), std::string::npos);
  const auto doubt = [&](double scale, std::vector<std::string> more) {
    write("other.stl", scale);
    std::vector<std::string> arguments = {"mesh", "other.stl"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments).err;
  };
  write("other.stl", 1 / 25.4);
  expect_refusal({"mesh", "other.stl"}, "in inches it would be 24 mm: scale it by 25.4 to mm?");
  EXPECT_NE(doubt(0.1, {}).find("in cm it would be 24 mm"), std::string::npos);
  EXPECT_NE(doubt(1e-3, {"--unit", "mm"}).find("--unit m?"), std::string::npos);
  EXPECT_NE(doubt(2, {}).find("whole of a finger"), std::string::npos);
  // A surface far larger than a finger is an object, and needs not be one.
  EXPECT_EQ(doubt(7, {}), "");
  EXPECT_EQ(doubt(1, {}), "");
}

TEST_F(MeshCommand, ProposesThePadFirst) {
  const ProgramRun shown = run({"mesh", "tip.stl"});
  EXPECT_EQ(shown.out.rfind("best pad: ", 0), 0u) << shown.out;
  const json found = answer_of({"mesh", "tip.stl", "--json"});
  // A slow machine or build ends the search before it has seen all places.
  const bool is_complete = shown.out.find("the search ended") == std::string::npos;
  if (is_complete) {
    EXPECT_EQ(found["answer"], lines(shown.out)[0]);
  }
  EXPECT_EQ(found["role"], "finger");
  const json& pads = found["pads"];
  EXPECT_GE(pads.size(), is_complete ? 30u : 7u);
  std::size_t usable = 0;
  for (std::size_t i = 0; i < pads.size(); ++i) {
    usable += pads[i]["usable"].get<bool>();
    EXPECT_EQ(pads[i]["usable"].get<bool>(), i < found["usable_pads"].get<std::size_t>());
    // The point lies on the ellipsoid, and its radii are those of the ellipsoid there.
    const auto& at = pads[i]["point_m"];
    const Eigen::Vector3d p(at[0], at[1], at[2]), axes(a, b, c);
    const Eigen::Vector3d scaled = p.cwiseQuotient(axes);
    EXPECT_NEAR(scaled.norm(), 1, 0.02);
    if (!pads[i]["usable"].get<bool>()) continue;
    // Gauss: 1 / (R' R'') = 1 / (a b c S)², S² = sum x²/a⁴.
    const double product =
        std::pow(axes.prod(), 2) * std::pow(scaled.cwiseQuotient(axes).squaredNorm(), 2);
    const double radii = pads[i]["radii_m"][0].get<double>() * pads[i]["radii_m"][1].get<double>();
    EXPECT_NEAR(std::sqrt(radii / product), 1, 2 * pads[i]["error_bound"].get<double>());
  }
  EXPECT_EQ(usable, found["usable_pads"].get<std::size_t>());
  ASSERT_GT(usable, 5u);
  // predict finds the same contact.
  const std::string line = pads[0]["toml"];
  folder.write("best.toml",
               "[geometry]\n" + line +
                   "\nobject = { radii_mm = [inf, inf] }\n[layer]\nthickness_mm = 2\n"
                   "youngs_modulus_kPa = 300\npoisson_ratio = 0.49\n[contact]\nload_N = 1\n"
                   "friction_coefficient = 0.8\n");
  const json predicted = answer_of({"predict", "best.toml", "--json"});
  for (const json& result : predicted["results"])
    if (result["recommended"].get<bool>()) {
      EXPECT_TRUE(result["usable"].get<bool>());
      EXPECT_NEAR(result["max_torque_Nm"].get<double>() / pads[0]["max_torque_Nm"].get<double>(), 1,
                  1e-3);
    }
  // Another layer, another answer; a single point is judged alone.
  const json stiff = answer_of({"mesh", "tip.stl", "--json", "--layer", "2,600,0.49"});
  EXPECT_LT(stiff["pads"][0]["max_torque_Nm"], pads[0]["max_torque_Nm"]);
  EXPECT_EQ(answer_of({"mesh", "tip.stl", "--along", "-y", "--json"})["pads"].size(), 1u);
  for (const char* layer : {"2,300", "0,300,0.4", "2,300,0.6", "2,x,0.4"})
    expect_refusal({"mesh", "tip.stl", "--layer", layer}, "--layer");
  expect_refusal({"mesh", "tip.stl", "--load", "0"}, "--load");
  expect_refusal({"mesh", "tip.stl", "--friction", "-1"}, "--friction");
  // A case starts there, too.
  ASSERT_EQ(run({"init", "started.toml", "--mesh", "tip.stl"}).status, 0);
  EXPECT_NE(file_text(folder.path() / "started.toml").find("\n" + line), std::string::npos);
}

/// An open box of 22 x 37 x 9 mm as OBJ, in facets as large as its sides.
std::string brick() {
  std::string text;
  for (const double z : {0., 9.})
    for (const double y : {0., 37.})
      for (const double x : {0., 22.}) text += fmt::format("v {} {} {}\n", x, y, z);
  return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

TEST_F(MeshCommand, KnowsAFlatFaceAsAPad) {
  folder.write("brick.obj", brick());
  const std::string words = "flat, 22 x 37 mm: a pad";
  const ProgramRun shown = run({"mesh", "brick.obj"});
  EXPECT_EQ(shown.out.rfind(words, 0), 0u) << shown.out << shown.err;
  const json found = answer_of({"mesh", "brick.obj", "--json"});
  ASSERT_EQ(found["flat_faces"].size(), 6u);
  EXPECT_NEAR(found["flat_faces"][0]["size_m"][0].get<double>(), 37e-3, 1e-8);
  EXPECT_NEAR(found["flat_faces"][0]["size_m"][1].get<double>(), 22e-3, 1e-8);
  EXPECT_NEAR(found["flat_faces"][0]["point_m"][0].get<double>(), 11e-3, 1e-8);
  expect_refusal({"fit", "brick.obj", "--point", "11,18,9"}, words);
  folder.write("case.toml",
               "[geometry]\nfinger = { mesh = \"brick.obj\", along = \"+z\" }\nobject = { radii_mm "
               "= [inf, inf] }\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
               "poisson_ratio = 0.45\n[contact]\nload_N = 1\nfriction_coefficient = 0.8\n");
  expect_refusal({"predict", "case.toml"}, words);
}

TEST_F(MeshCommand, OffersTheWallAndTheBaseOfAnObject) {
  // A tin of 60 mm, 90 mm high.
  constexpr int strips = 90;
  std::string tin = "v 0 0 0\nv 0 0 90\n", facets;
  for (int i = 0; i < strips; ++i) {
    const double angle = 2 * M_PI * i / strips;
    for (int j = 0; j <= 30; ++j)
      tin += fmt::format("v {} {} {}\n", 30 * std::cos(angle), 30 * std::sin(angle), 3 * j);
    const int here = 3 + 31 * i, next = 3 + 31 * ((i + 1) % strips);
    facets += fmt::format("f 1 {} {}\nf 2 {} {}\n", next, here, here + 30, next + 30);
    for (int j = 0; j < 30; ++j)
      facets += fmt::format("f {} {} {} {}\n", here + j, next + j, next + j + 1, here + j + 1);
  }
  folder.write("tin.obj", tin + facets);
  const ProgramRun shown = run({"mesh", "tin.obj"});
  EXPECT_EQ(shown.status, 0);
  EXPECT_EQ(shown.err, "") << "whether it is a finger is not asked";
  EXPECT_EQ(shown.out.rfind("an object, 60 mm wide: wall [", 0), 0u) << shown.out;
  const json found = answer_of({"mesh", "tin.obj", "--json"});
  EXPECT_EQ(found["role"], "object");
  bool has_base = false, has_wall = false;
  for (const json& pad : found["pads"]) {
    has_base = has_base || pad["kind"] == "base";
    if (pad["kind"] != "wall" || !pad["usable"].get<bool>()) continue;
    has_wall = true;
    EXPECT_EQ(pad["toml"].get<std::string>().rfind("object = {", 0), 0u);
    EXPECT_NEAR(pad["radii_m"][1].get<double>(), 30e-3, 0.5e-3);
  }
  EXPECT_TRUE(has_base && has_wall) << shown.out;
}

TEST_F(MeshCommand, ReadsTheWallOfACadFileByItsStrips) {
  // Strips of 75 mm, 1.05 and 2.1 mm wide: straight along, chords of the circle across.
  constexpr double radius = 15, length = 75;
  for (const int strips : {90, 45}) {
    std::string wall = "v 0 0 0\nv 0 0 75\n", facets;
    for (int i = 0; i < strips; ++i) {
      const double angle = 2 * M_PI * i / strips;
      for (const double z : {0., length})
        wall += fmt::format("v {} {} {}\n", radius * std::cos(angle), radius * std::sin(angle), z);
      const int here = 3 + 2 * i, next = 3 + 2 * ((i + 1) % strips);
      facets += fmt::format("f 1 {} {}\nf 2 {} {}\nf {} {} {} {}\n", next, here, here + 1, next + 1,
                            here, next, next + 1, here + 1);
    }
    folder.write("wall.obj", wall + facets);
    const json fit = answer_of({"fit", "wall.obj", "--point", "15,0,40", "--unit", "mm", "--json"});
    EXPECT_TRUE(fit["radii_m"][0].is_null()) << "flat along";
    const double error_m = std::abs(fit["radii_m"][1].get<double>() - 1e-3 * radius);
    EXPECT_LE(error_m, 2 * fit["radii_std_m"][1].get<double>()) << strips;
    EXPECT_LT(error_m, 0.01e-3 * radius) << strips;
  }
}

TEST_F(MeshCommand, SaysWithOneVoiceWhichUnitIsTaken) {
  write("metres.stl", 1e-3);
  const std::string words = "0.024 mm or 24 mm wide: taken as m";
  const std::string rest =
      "object = { radii_mm = [inf, inf] }\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
      "poisson_ratio = 0.45\n[contact]\nload_N = 1\nfriction_coefficient = 0.8\n";
  const auto case_of = [&](const std::string& mesh, const std::string& more = "") {
    return folder
        .write("case.toml", "[geometry]\nfinger = { mesh = \"" + mesh + "\", along = \"-y\"" +
                                more + " }\n" + rest)
        .string();
  };
  const std::vector<std::vector<std::string>> commands = {
      {"mesh", "metres.stl"},
      {"fit", "metres.stl", "--point", "0,-0.007,0"},
      {"init", "metres.toml", "--mesh", "metres.stl"},
      {"predict", case_of("metres.stl")},
      {"export", case_of("metres.stl"), "--to", "mujoco"},
      {"fem", case_of("metres.stl")}};
  for (const std::vector<std::string>& command : commands) {
    const ProgramRun result = run(command);
    EXPECT_EQ(result.status, 0) << command[0] << ": " << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << command[0] << ": " << result.err;
  }
  EXPECT_NE(file_text(folder.path() / "metres.toml").find("unit = \"m\""), std::string::npos);
  // The finger is the same whatever its file's unit, and no note appears where the unit is evident
  // or typed.
  const auto a_m = [&](const std::string& file) {
    return answer_of({"predict", file, "--model", "bonded_layer", "--json"})["results"][0]["a_m"]
        .get<double>();
  };
  const double guessed = a_m(case_of("metres.stl"));
  const double in_millimetres = a_m(case_of("tip.stl"));
  EXPECT_NEAR(guessed / in_millimetres, 1, 1e-6) << "seven digits of the file";
  EXPECT_EQ(run({"predict", case_of("tip.stl"), "--model", "hertz"}).err.find("taken as"),
            std::string::npos);
  EXPECT_EQ(run({"predict", case_of("metres.stl", ", unit = \"m\""), "--model", "hertz"})
                .err.find("wide"),
            std::string::npos);
  // Neither unit makes a finger of it.
  for (const double scale : {0.03, 100.}) {
    write("neither.stl", scale);
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
             {"mesh", "neither.stl"},
             {"fit", "neither.stl", "--point", "0,0,0"},
             {"init", "neither.toml", "--mesh", "neither.stl"},
             {"predict", case_of("neither.stl")},
             {"export", case_of("neither.stl"), "--to", "mujoco"}})
      expect_refusal(command, "1 mm to 1 m wide");
    EXPECT_EQ(run({"mesh", "neither.stl", "--unit", "mm"}).status, 0);
    EXPECT_EQ(run({"predict", case_of("neither.stl", ", unit = \"mm\""), "--set",
                   fmt::format("layer.thickness_mm={}", 2 * scale), "--set",
                   fmt::format("contact.load_N={}", scale * scale)})
                  .status,
              0);
  }
}

TEST_F(MeshCommand, GuessesTheUnitInScenes) {
  write("metres.stl", 1e-3);
  const auto simulate = [&](const std::string& mesh) {
    folder.write("scene.toml",
                 "[simulation]\ntime_step_ms = 1\nduration_s = 0.01\n[[layer]]\nname = \"rubber\"\n"
                 "thickness_mm = 2\nyoungs_modulus_kPa = 300\npoisson_ratio = 0.45\n[[body]]\n"
                 "name = \"tip\"\ndensity_kg_per_m3 = 1000\nlayer = \"rubber\"\n"
                 "shapes = [{ mesh = \"" +
                     mesh + "\" }]\n");
    return run({"simulate", "scene.toml", "--json"});
  };
  const ProgramRun metres = simulate("metres.stl"), millimetres = simulate("tip.stl");
  ASSERT_EQ(metres.status, 0) << metres.err;
  EXPECT_NE(metres.err.find("0.024 mm or 24 mm wide: taken as m"), std::string::npos) << metres.err;
  EXPECT_EQ(millimetres.err, "");
  write("neither.stl", 0.03);
  const ProgramRun neither = simulate("neither.stl");
  EXPECT_EQ(neither.status, 2) << neither.err;
  EXPECT_NE(neither.err.find("1 mm to 1 m wide"), std::string::npos) << neither.err;
}

TEST_F(MeshCommand, IsTouchedAtTheNearestPointInACase) {
  const std::string rest =
      "[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\npoisson_ratio = 0.45\n[contact]\n"
      "load_N = 1\nfriction_coefficient = 0.8\n";
  const auto answer = [&](const std::string& finger, const std::string& object) {
    folder.write("case.toml",
                 "[geometry]\nfinger = " + finger + "\nobject = " + object + "\n" + rest);
    return answer_of({"predict", "case.toml", "--model", "bonded_layer", "--json"})["results"][0];
  };
  const std::string plane = "{ radii_mm = [inf, inf] }";
  const json near = answer("{ mesh = \"tip.stl\", near_mm = [0.3, -7.2, 0.2] }", plane);
  const json found =
      answer_of({"mesh", "tip.stl", "--near", "0.3,-7.2,0.2", "--json"})["points"][0];
  const std::string line = found["toml"];
  const json pasted = answer(line.substr(line.find('{')), plane);
  EXPECT_NEAR(near["a_m"].get<double>() / pasted["a_m"].get<double>(), 1, 1e-3);
  const json object =
      answer("{ radii_mm = [inf, inf] }", "{ mesh = \"tip.stl\", near_mm = [0.3, -7.2, 0.2] }");
  EXPECT_NEAR(object["a_m"].get<double>() / near["a_m"].get<double>(), 1, 1e-6)
      << "of rigid bodies it makes no difference which is the mesh";
  folder.write("case.toml",
               "[geometry]\nfinger = { mesh = \"tip.stl\", near_mm = [0, 0, 0] }\n"
               "object = " +
                   plane + "\n" + rest);
  expect_refusal({"predict", "case.toml"}, "near_mm");
}

TEST_F(MeshCommand, SaysTheNextStepWhereAPointCannotBePressed) {
  // A cylinder in a hollow object has a saddle for a gap; its round ends have none.
  meshes::write_stl_mm(meshes::capsule_finger(), (folder.path() / "capsule.stl").string());
  folder.write(
      "case.toml",
      "[geometry]\nfinger = { mesh = \"capsule.stl\", along = \"-y\" }\nobject = { radii_mm = "
      "[-40, -40] }\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\npoisson_ratio = "
      "0.45\n[contact]\nload_N = 1\nfriction_coefficient = 0.8\n");
  const ProgramRun refused = run({"export", "case.toml", "--to", "mujoco"});
  EXPECT_EQ(refused.status, 2) << refused.out;
  EXPECT_EQ(lines(refused.err).size(), 1u) << refused.err;
  const std::size_t at = refused.err.find("finger = {");
  ASSERT_NE(at, std::string::npos) << refused.err;
  const std::string line = refused.err.substr(at, refused.err.find('}', at) + 1 - at);
  std::string text = file_text(folder.path() / "case.toml");
  const std::size_t finger = text.find("finger");
  text.replace(finger, text.find('}') + 1 - finger, line);
  folder.write("case.toml", text);
  const json answers =
      answer_of({"predict", "case.toml", "--model", "fingertip_layer,bonded_layer", "--json"});
  EXPECT_TRUE(answers["results"][0]["usable"].get<bool>() ||
              answers["results"][1]["usable"].get<bool>())
      << line;
}

TEST_F(MeshCommand, SaysWhereASurfaceIsOpen) {
  folder.write("open.obj", "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nf 1 2 3\nf 1 3 4\n");
  const json open = answer_of({"mesh", "open.obj", "--json", "--along", "+z"});
  EXPECT_FALSE(open["closed"].get<bool>());
  EXPECT_EQ(open["open_edges"], 4);
  // A facet as a whole lies farthest: its middle is meant. No quadric has four vertices.
  EXPECT_NEAR(open["points"][0]["point_m"][0].get<double>(), 5e-3, 1e-9);
  EXPECT_NEAR(open["points"][0]["point_m"][1].get<double>(), 5e-3, 1e-9);
  EXPECT_TRUE(open["points"][0]["radii_m"].is_null());
  EXPECT_FALSE(open["points"][0]["doubt"].is_null());
}

TEST_F(MeshCommand, OffersNoLineWhereTheSurfaceFacesAway) {
  // A sheet whose facets all face +z: nothing of it faces -z.
  std::string sheet;
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 10; ++i)
      sheet += fmt::format("v {} {} {}\n", i, j, (i - 5) * (i - 5) * -0.02);
  for (int j = 0; j < 9; ++j)
    for (int i = 1; i < 10; ++i)
      sheet += fmt::format("f {} {} {} {}\n", i + 10 * j, i + 1 + 10 * j, i + 11 + 10 * j,
                           i + 10 + 10 * j);
  folder.write("sheet.obj", sheet);
  const json found =
      answer_of({"mesh", "sheet.obj", "--unit", "mm", "--along", "-z", "--json"})["points"][0];
  EXPECT_TRUE(found["toml"].is_null()) << found;
  EXPECT_NE(found["doubt"].get<std::string>().find("surface ends here"), std::string::npos);
  const ProgramRun all = run({"mesh", "sheet.obj", "--unit", "mm"});
  EXPECT_EQ(all.out.find("normal = [0, 0, 0]"), std::string::npos) << all.out;
}

TEST_F(MeshCommand, DoubtsRadiiThatTheFitDoesNotKnow) {
  // A plate with bumps of 0.1 mm, up and down in turns of three: noise has all of its curvature.
  std::string plate;
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < 12; ++i)
      plate += fmt::format("v {} {} {}\n", i, j, (5 * i + 7 * j + i * j) % 3 == 0 ? 0.1 : -0.1);
  for (int j = 0; j < 11; ++j)
    for (int i = 1; i < 12; ++i)
      plate += fmt::format("f {} {} {} {}\n", i + 12 * j, i + 1 + 12 * j, i + 13 + 12 * j,
                           i + 12 + 12 * j);
  folder.write("plate.obj", plate);
  const json point = answer_of(
      {"mesh", "plate.obj", "--unit", "mm", "--near", "5.5,5.5,0", "--json"})["points"][0];
  EXPECT_GT(point["radii_std_m"][1].get<double>(),
            0.5 * std::abs(point["radii_m"][1].get<double>()));
  EXPECT_NE(point["doubt"].dump().find("the fit knows the smaller radius"), std::string::npos)
      << point;
  EXPECT_TRUE(
      answer_of({"mesh", "tip.stl", "--along", "-y", "--json"})["points"][0]["doubt"].is_null());
}

TEST_F(MeshCommand, SaysThatARegionTakesInTheWholeFinger) {
  const ProgramRun whole = run({"fit", "tip.stl", "--point", "0,-7,0", "--radius-mm", "300"});
  EXPECT_EQ(whole.status, 0) << whole.err;
  EXPECT_NE(whole.err.find("takes in the whole surface"), std::string::npos) << whole.err;
  EXPECT_NE(whole.out.find("how much they depend on the region is not known"), std::string::npos)
      << whole.out;
  const json answer =
      answer_of({"fit", "tip.stl", "--point", "0,-7,0", "--radius-mm", "300", "--json"});
  EXPECT_TRUE(answer["region_is_whole_surface"].get<bool>());
  EXPECT_TRUE(answer["radii_region_change_m"][0].is_null());
  const ProgramRun part = run({"fit", "tip.stl", "--point", "0,-7,0", "--radius-mm", "3"});
  EXPECT_EQ(part.err.find("whole surface"), std::string::npos) << part.err;
  EXPECT_NE(part.out.find("they change by up to"), std::string::npos) << part.out;
}

TEST_F(MeshCommand, WritesAPageWithThePointsAndTheFit) {
  const json found =
      answer_of({"mesh", "tip.stl", "--page", "tip.html", "--picture", "tip.png", "--json"});
  EXPECT_EQ(found["page"], "tip.html");
  EXPECT_EQ(found["picture"], "tip.png");
  EXPECT_EQ(file_text(folder.path() / "tip.png").substr(1, 3), "PNG");
  const std::string page = file_text(folder.path() / "tip.html");
  for (const json& point : found["points"]) {
    std::string line = point["toml"];
    for (std::size_t at = 0; (at = line.find('"', at)) != std::string::npos; at += 6)
      line.replace(at, 1, "&quot;");
    EXPECT_NE(page.find(line), std::string::npos) << line;
  }
  ASSERT_EQ(
      run({"fit", "tip.stl", "--point", "0,-7,0", "--radius-mm", "3", "--page", "fit.html"}).status,
      0);
  EXPECT_NE(file_text(folder.path() / "fit.html").find("fitted at 0,-7,0"), std::string::npos);
  // The region of each load.
  folder.write("tip.toml", R"(
id = "tip"
[geometry]
finger = { mesh = "tip.stl", along = "-y" }
object = { sphere_radius_mm = 20 }
[layer]
thickness_mm = 2
youngs_modulus_kPa = 300
poisson_ratio = 0.45
[contact]
load_N = [1, 5]
friction_coefficient = 1
)");
  ASSERT_EQ(run({"predict", "tip.toml", "--page", "loads.html"}).status, 0);
  const std::string loads = file_text(folder.path() / "loads.html");
  for (const char* load : {"1 N", "5 N"})
    EXPECT_NE(loads.find(std::string("<th scope=\"row\">") + load), std::string::npos) << load;
  EXPECT_LT(loads.find("<p class=\"lead\">1 N: torque "), loads.find("<canvas"));
  EXPECT_NE(loads.find("The prediction by each model"), std::string::npos);
  folder.write("radii.toml", case_text());
  expect_refusal({"predict", "radii.toml", "--page", "loads.html"}, "is a mesh");
}

TEST_F(MeshCommand, ReadsStandardInput) {
  const json read = answer_of({"mesh", "tip.stl", "--along", "-y", "--json"})["points"][0];
  start.input = (folder.path() / "tip.stl").string();
  const json piped = answer_of({"mesh", "-", "--along", "-y", "--json"})["points"][0];
  EXPECT_EQ(read["radii_m"], piped["radii_m"]);
  EXPECT_NE(piped["toml"].get<std::string>().find("\"FILE.stl\""), std::string::npos);
  EXPECT_EQ(run({"fit", "-", "--point", "0,-7,0", "--radius-mm", "3"}).status, 0);
  start.input = "";
  expect_refusal({"mesh", "-"}, "standard input");
}

TEST_F(MeshCommand, RefusesInOneLine) {
  expect_refusal({"mesh", "tip.stl", "--along", "up"}, "+x, -x");
  expect_refusal({"mesh", "tip.stl", "--near", "1,2"}, "--near");
  expect_refusal({"mesh", "tip.stl", "--near", "0,0,0"}, "a point on the surface");
  expect_refusal({"mesh", "tip.stl", "--near", "0,-7,0", "--along", "-y"}, "--along");
  expect_refusal({"mesh", "tip.stl", "--page", ""}, "--page");
  expect_refusal({"mesh", "tip.stl", "--picture", ""}, "--picture");
  expect_refusal({"mesh", "no.stl"}, "no.stl");
  folder.write("no.stl", "no mesh");
  expect_refusal({"mesh", "no.stl"}, "no.stl");
}

TEST_F(MeshCommand, IsNamedWhereAMeshIsGivenForACase) {
  expect_refusal({"predict", "tip.stl"}, "softfinger mesh FILE");
}

TEST_F(MeshCommand, LeadsFromAScanToANumberForMujocoInThreeCommands) {
  ASSERT_EQ(run({"mesh", "tip.stl", "--page", "tip.html"}).status, 0);
  ASSERT_EQ(run({"init", "tip.toml", "--mesh", "tip.stl", "--near", "0.3,-7.1,0.2"}).status, 0);
  const json exported = answer_of(
      {"export", "tip.toml", "--to", "mujoco", "--set", "layer.thickness_mm=3", "--json"});
  EXPECT_NE(exported["lines"].get<std::string>().find("condim=\"4\""), std::string::npos);
  EXPECT_GT(exported["eccentricity_m"].get<double>(), 0);
}

TEST_F(MeshCommand, ListsTheBuiltinMeshes) {
  if (!fs::exists(fs::path(SOFTFINGER_SHARE) / "meshes" / "sphere.stl"))
    GTEST_SKIP() << "the built-in meshes need gmsh, which this build leaves out";
  const json meshes = answer_of({"list", "meshes", "--json"})["meshes"];
  EXPECT_GE(meshes.size(), 6u);
  // The ending may be left out.
  for (const json& mesh : meshes)
    EXPECT_EQ(run({"mesh", mesh["name"].get<std::string>(), "--along", "+z"}).status, 0) << mesh;
  EXPECT_EQ(run({"fit", "sphere", "--point", "0,0,20", "--radius-mm", "3"}).status, 0);
}

}  // namespace softfinger::tests
