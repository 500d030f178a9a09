// Meshes in DAE, GLB, glTF, PLY and 3MF: one surface has the same radii in each, parts lie in their
// places, and what is not to be read is refused.

#include "tests/meshes/mesh_formats.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "comparisons/robots/foreign_mesh.h"
#include "meshes/io/read_surface.h"
#include "softfinger/input/errors.h"
#include "tests/comparisons/run_program.h"
#include "tests/geometry/sample_surfaces.h"

namespace softfinger::tests {
namespace {

namespace fs = std::filesystem;
using Eigen::Affine3d;
using Eigen::Vector3d;
using nlohmann::json;

/// An ellipsoidal cap on z = 0, 12 mm wide, in a unit of so many metres: radii 20 and 10 mm.
TriangleSurface cap(double metres_per_unit) {
  TriangleSurface surface = samples::quadric(6e-3, 24, 20e-3, 10e-3);
  for (Vector3d& vertex : surface.vertices_m)
    vertex = (vertex / metres_per_unit).cast<float>().cast<double>();
  return surface;
}

/// The numbers of a file in millimetres as metres.
TriangleSurface in_metres(TriangleSurface surface_mm) {
  for (Vector3d& vertex : surface_mm.vertices_m) vertex *= 1e-3;
  return surface_mm;
}

/// A turn by 90 degrees about x and a displacement, in a unit of so many metres.
Affine3d placed(double metres_per_unit) {
  Affine3d place = Affine3d::Identity();
  place.matrix().topRows<3>() << 1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0;
  place.translation() = Vector3d(0.5, 0.25, -0.125) * 64e-3 / metres_per_unit;
  return place;
}

/// The part whose surface lies where `surface` does, by a transform.
FilePart moved(const std::string& name, TriangleSurface surface, const Affine3d& place) {
  const Affine3d back = place.inverse();
  for (Vector3d& vertex : surface.vertices_m) vertex = back * vertex;
  return {name, surface, place};
}

class MeshFormats : public testing::Test {
 protected:
  void SetUp() override {
#ifndef SOFTFINGER_HAS_ASSIMP
    GTEST_SKIP() << "built without Assimp";
#endif
  }

  std::string write(const std::string& name, const std::string& bytes) {
    return folder.write(name, bytes).string();
  }
  meshes::SurfaceFile read(const std::string& name, const std::string& bytes,
                           const std::string& part = "") {
    return read_file(write(name, bytes), part);
  }
  static meshes::SurfaceFile read_file(const std::string& path, const std::string& part = "") {
    return meshes::parse_converted_surface(robots::convert_mesh(path, part), path, std::nullopt);
  }
  static std::string refusal_of(const std::string& path, const std::string& part = "") {
    try {
      robots::convert_mesh(path, part);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  void expect_refusal(const std::string& name, const std::string& bytes, const std::string& words) {
    const std::string said = refusal_of(write(name, bytes));
    EXPECT_NE(said.find(words), std::string::npos) << name << ": " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
  static double top_m(const meshes::SurfaceFile& file, int axis = 2) {
    double top = -std::numeric_limits<double>::infinity();
    for (const Vector3d& vertex : file.surface.vertices_m) top = std::max(top, vertex[axis]);
    return top;
  }
  ProgramRun run(const std::vector<std::string>& arguments) {
    return run_softfinger(start, arguments);
  }
  json answer_of(const std::vector<std::string>& arguments) {
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.status == 0 ? json::parse(result.out) : json();
  }

  TemporaryFolder folder;
  Start start{folder.path(), {}, -1, "", ""};
};

TEST_F(MeshFormats, HaveTheSameRadiiAsStl) {
  meshes::write_stl_mm(in_metres(cap(1e-3)), write("cap.stl", ""));
  const TriangleSurface mm = cap(1e-3), m = cap(1), inch = cap(25.4e-3);
  const std::vector<FilePart> in_mm = {{"cap", mm}}, in_m = {{"cap", m}}, in_inch = {{"cap", inch}};
  const Gltf gltf = gltf_of(in_m, "cap.bin");
  write("cap.bin", gltf.buffer);
  write("mm.dae", dae_of(in_mm, "0.001", "Z_UP"));
  write("m.dae", dae_of(in_m, "", ""));
  write("inch.dae", dae_of(in_inch, "0.0254", "Y_UP"));
  write("cap.glb", glb_of(in_m));
  write("cap.gltf", gltf.json);
  write("cap.ply", ply_of(mm, false));
  write("binary.PLY", ply_of(mm, true));
  write("cap.3mf", threemf_of(in_mm, ""));
  write("inch.3mf", threemf_of(in_inch, "inch", true));
  write("turned.dae", dae_of({moved("cap", mm, placed(1e-3))}, "0.001", "Z_UP"));
  write("turned.glb", glb_of({moved("cap", m, placed(1))}));
  write("turned.3mf", threemf_of({moved("cap", mm, placed(1e-3))}, "millimeter"));
  const auto fit = [&](const std::string& file) {
    return answer_of(
        {"fit", file, "--point", "0,0,0", "--normal", "0,0,1", "--radius-mm", "4", "--json"});
  };
  const json expected = fit("cap.stl");
  // Numbers in millimetres are the very numbers of the STL. Others are rounded elsewhere: 3e-8 of
  // the 8 mm to the edge of the cap, which lies 0.4 mm below its top, twice.
  const double same = 1e-9, rounded = 5e-6;
  for (const auto& [file, tolerance] : {std::pair("mm.dae", same),
                                        {"cap.ply", same},
                                        {"binary.PLY", same},
                                        {"cap.3mf", same},
                                        {"m.dae", rounded},
                                        {"inch.dae", rounded},
                                        {"cap.glb", rounded},
                                        {"cap.gltf", rounded},
                                        {"inch.3mf", rounded},
                                        {"turned.dae", rounded},
                                        {"turned.glb", rounded},
                                        {"turned.3mf", rounded}}) {
    const json found = fit(file);
    ASSERT_TRUE(found.contains("radii_m")) << file;
    for (int i = 0; i < 2; ++i)
      EXPECT_NEAR(found["radii_m"][i].get<double>() / expected["radii_m"][i].get<double>(), 1,
                  tolerance)
          << file;
    EXPECT_EQ(found["points"], expected["points"]) << file;
  }
}

TEST_F(MeshFormats, ASweepNoticesAnotherBufferOfTheSameGltf) {
  const auto buffer_of = [](double scale) {
    TriangleSurface surface = cap(1);
    for (Vector3d& vertex : surface.vertices_m) vertex *= scale;
    return gltf_of({{"cap", surface}}, "cap.bin");
  };
  // The least and largest coordinates of the JSON are for viewers.
  write("cap.gltf", buffer_of(1).json);
  write("cap.bin", buffer_of(1).buffer);
  write("sweep.toml",
        "id = \"stale\"\n[geometry]\nfinger = { mesh = \"cap.gltf\", along = \"+z\" }\n"
        "object = { radii_mm = [inf, inf] }\n[layer]\nthickness_mm = 1\n"
        "youngs_modulus_kPa = 300\npoisson_ratio = 0.45\n[contact]\nload_N = 0.2\n"
        "friction_coefficient = 0.8\n[sweep]\n\"contact.load_N\" = [0.1, 0.2]\nmodels = "
        "[\"bonded_layer\"]\n");
  const auto sweep = [&] {
    const ProgramRun done = run({"sweep", "sweep.toml", "--output", "out"});
    EXPECT_EQ(done.status, 0) << done.err;
    return done.err.find("reused") != std::string::npos;
  };
  EXPECT_FALSE(sweep());
  EXPECT_TRUE(sweep());
  const std::string before = file_text(folder.path() / "out" / "results.csv");
  write("cap.bin", buffer_of(1.5).buffer);
  EXPECT_FALSE(sweep()) << "rows of another surface";
  EXPECT_NE(file_text(folder.path() / "out" / "results.csv"), before);
}

TEST_F(MeshFormats, SayTheirUnitAndATypedOneCounts) {
  write("cap.dae", dae_of({{"cap", cap(1e-2)}}, "0.01", "Z_UP"));
  const json own = answer_of({"mesh", "cap.dae", "--along", "+z", "--json"});
  EXPECT_EQ(own["unit"], "cm");
  EXPECT_EQ(own["metres_per_unit"], 0.01);
  EXPECT_FALSE(own["unit_guessed"].get<bool>());
  const std::string line = own["points"][0]["toml"];
  EXPECT_EQ(line.rfind("finger = { mesh = \"cap.dae\", point_mm", 0), 0u) << line;
  // Coordinates on the command line are in the file's unit.
  const json near = answer_of({"mesh", "cap.dae", "--near", "0.3,0,0", "--json"});
  EXPECT_NEAR(near["points"][0]["point_m"][0].get<double>(), 3e-3, 1e-4);
  const ProgramRun typed = run({"mesh", "cap.dae", "--unit", "mm", "--along", "+z", "--json"});
  ASSERT_EQ(typed.status, 0) << typed.err;
  EXPECT_NEAR(json::parse(typed.out)["bounds_m"][1][0].get<double>(), 0.6e-3, 1e-9);
  EXPECT_NE(typed.err.find("the file says that its unit is cm; --unit mm counts"),
            std::string::npos)
      << typed.err;
  const std::string case_text =
      "[geometry]\nfinger = {{ mesh = \"cap.dae\", {}along = \"+z\" }}\nobject = {{ radii_mm = "
      "[inf, "
      "inf] }}\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\npoisson_ratio = "
      "0.49\n[contact]\nload_N = 0.5\nfriction_coefficient = 0.8\n";
  write("own.toml", fmt::format(case_text, ""));
  write("typed.toml", fmt::format(case_text, "unit = \"mm\", "));
  const ProgramRun predicted = run({"predict", "own.toml", "--json"});
  EXPECT_EQ(predicted.status, 0) << predicted.err;
  EXPECT_EQ(predicted.err.find("unit"), std::string::npos) << predicted.err;
  const ProgramRun other = run({"predict", "typed.toml", "--json"});
  EXPECT_NE(other.err.find("the file says that its unit is cm; unit = \"mm\" counts"),
            std::string::npos)
      << other.err;
  const std::string made =
      answer_of({"init", "made.toml", "--mesh", "cap.dae", "--along", "+z", "--json"})["text"];
  EXPECT_NE(made.find("finger = { mesh = \"cap.dae\", along = \"+z\" }"), std::string::npos)
      << made;
}

TEST_F(MeshFormats, PutPartsInTheirPlacesAndTakeOne) {
  // Two caps, the second one 40 mm higher.
  const auto parts = [](double unit) {
    Affine3d up = Affine3d::Identity();
    up.translation().z() = 40e-3 / unit;
    return std::vector<FilePart>{{"low", cap(unit)}, {"high", cap(unit), up}};
  };
  const std::size_t one = cap(1).triangles.size();
  const double rounding_m = 1e-8;
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>("two.dae", dae_of(parts(1), "1", "Z_UP")),
        {"two.glb", glb_of(parts(1))},
        {"two.3mf", threemf_of(parts(1e-3), "")}}) {
    const meshes::SurfaceFile both = read(name, bytes);
    EXPECT_EQ(both.surface.triangles.size(), 2 * one) << name;
    EXPECT_NEAR(top_m(both), 40e-3, rounding_m) << name;
    const std::string file = (folder.path() / name).string();
    EXPECT_NEAR(top_m(read_file(file, "low")), 0, rounding_m) << name;
    const meshes::SurfaceFile high = read_file(file, "high");
    EXPECT_EQ(high.surface.triangles.size(), one) << name;
    EXPECT_NEAR(top_m(high), 40e-3, rounding_m) << name;
    const std::string said = refusal_of(file, "middle");
    EXPECT_NE(said.find("part = \"middle\": allowed: \"low\", \"high\""), std::string::npos)
        << said;
  }
  write("case.toml",
        "[geometry]\nfinger = { mesh = \"two.glb\", part = \"high\", along = \"+z\" }\nobject = { "
        "radii_mm = [inf, inf] }\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = "
        "300\npoisson_ratio = 0.49\n[contact]\nload_N = 0.5\nfriction_coefficient = 0.8\n");
  EXPECT_FALSE(answer_of({"predict", "case.toml", "--json"})["results"].empty());
  const json low = answer_of({"mesh", "two.glb", "--part", "low", "--along", "+z", "--json"});
  EXPECT_EQ(low["triangles"], one);
  EXPECT_EQ(low["part"], "low");
  const std::string line = low["points"][0]["toml"];
  EXPECT_NE(line.find("mesh = \"two.glb\", part = \"low\", point_mm"), std::string::npos) << line;
  const ProgramRun unknown = run({"fit", "two.dae", "--part", "x", "--point", "0,0,0"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(lines(unknown.err).size(), 1u) << unknown.err;
  EXPECT_NE(unknown.err.find("two.dae: part = \"x\": allowed: \"low\", \"high\""),
            std::string::npos)
      << unknown.err;
}

TEST_F(MeshFormats, ListADozenPartsAtMost) {
  std::vector<FilePart> many;
  for (int i = 0; i < 20; ++i) many.push_back({fmt::format("part_{}", i), cap(1)});
  const std::string said = refusal_of(write("many.glb", glb_of(many)), "x");
  EXPECT_NE(said.find("\"part_11\" and 8 more"), std::string::npos) << said;
}

TEST_F(MeshFormats, RefuseAPartWhereThereAreNone) {
  write("cap.ply", ply_of(cap(1e-3), true));
  meshes::write_stl_mm(in_metres(cap(1e-3)), write("cap.stl", ""));
  for (const char* file : {"cap.ply", "cap.stl"}) {
    const ProgramRun result = run({"mesh", file, "--part", "low"});
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_NE(result.err.find("part = \"low\""), std::string::npos) << result.err;
  }
}

TEST_F(MeshFormats, ReadTheBuffersOfTheirOwnFolderAlone) {
  const std::vector<FilePart> parts = {{"cap", cap(1)}};
  const std::string buffer = gltf_of(parts, "x").buffer;
  fs::create_directories(folder.path() / "model" / "inside");
  write("outside.bin", buffer);
  write("model/inside/own.bin", buffer);
  write("model/own file.bin", buffer);
  fs::create_symlink("../outside.bin", folder.path() / "model" / "link.bin");
  const auto model = [&](const std::string& uri) {
    return write("model/cap.gltf", gltf_of(parts, uri).json);
  };
  const std::size_t triangles = cap(1).triangles.size();
  for (const char* uri :
       {"inside/own.bin", "own%20file.bin", "own file.bin", "inside/../inside/own.bin"})
    EXPECT_EQ(read_file(model(uri)).surface.triangles.size(), triangles) << uri;
  for (const std::string& uri :
       {std::string("../outside.bin"), (folder.path() / "outside.bin").string(),
        std::string("link.bin"), std::string("https://example.org/own.bin"),
        std::string("file:///etc/hostname"), std::string("inside/../../outside.bin"),
        std::string("%2E%2E/outside.bin")}) {
    const std::string said = refusal_of(model(uri));
    EXPECT_NE(said.find(uri), std::string::npos) << said;
    EXPECT_NE(said.find("in the folder of the mesh or below it"), std::string::npos) << said;
  }
  const std::string missing = refusal_of(model("missing.bin"));
  EXPECT_NE(missing.find("\"missing.bin\": allowed: a file that is there"), std::string::npos)
      << missing;
}

TEST_F(MeshFormats, ReadArchivesOfSeveralModels) {
  const std::string inner = model_of({{"cap", cap(1e-3)}}, "millimeter");
  const std::string outer =
      "<model "
      "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\"><resources>"
      "<object id=\"2\"><components><component p:path=\"/3D/Objects/one.model\" objectid=\"1\" "
      "transform=\"1 0 0 0 1 0 0 0 1 0 0 5\"/></components></object></resources><build><item "
      "objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 0 0 1\"/></build></model>";
  const meshes::SurfaceFile file =
      read("two.3mf", zip_of({{"3D/3dmodel.model", outer}, {"3D/Objects/one.model", inner}}, true));
  EXPECT_NEAR(top_m(file), 6e-3, 1e-9);
  // An object that holds itself would never end.
  std::string ring = outer;
  ring.replace(ring.find(" p:path=\"/3D/Objects/one.model\" objectid=\"1\""), 44,
               " objectid=\"2\"");
  expect_refusal("ring.3mf", zip_of({{"3D/3dmodel.model", ring}}), "none of which holds itself");
  expect_refusal("none.3mf", zip_of({{"3D/3dmodel.model", outer}}), "3D/Objects/one.model");
}

TEST_F(MeshFormats, RefuseTruncatedFiles) {
  const std::vector<FilePart> in_mm = {{"cap", cap(1e-3)}}, in_m = {{"cap", cap(1)}};
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>("a.dae", dae_of(in_mm, "0.001", "Z_UP")),
        {"a.glb", glb_of(in_m)},
        {"a.gltf", gltf_of(in_m, "cap.bin").json},
        {"ascii.ply", ply_of(cap(1e-3), false)},
        {"binary.ply", ply_of(cap(1e-3), true)},
        {"stored.3mf", threemf_of(in_mm, "")},
        {"deflated.3mf", threemf_of(in_mm, "", true)}})
    for (const double share : {0., 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99}) {
      const auto size = std::size_t(share * double(bytes.size()));
      EXPECT_NE(refusal_of(write(name, bytes.substr(0, size))), "") << name << " of " << size;
    }
}

TEST_F(MeshFormats, RefuseNumbersThatAreNone) {
  TriangleSurface broken = cap(1e-3);
  broken.vertices_m[30].z() = std::numeric_limits<double>::quiet_NaN();
  expect_refusal("a.ply", ply_of(broken, true), "vertex 30");
  expect_refusal("a.glb", glb_of({{"cap", broken}}), "finite");
  expect_refusal("a.3mf", threemf_of({{"cap", broken}}, ""), "z = a finite number");
  TriangleSurface astray = cap(1e-3);
  astray.triangles[5][1] = 1'000'000;
  expect_refusal("b.ply", ply_of(astray, true), "");
  expect_refusal("b.3mf", threemf_of({{"cap", astray}}, ""), "v2 = the number of a vertex");
  // Assimp would never end.
  std::string letter = dae_of({{"cap", cap(1e-3)}}, "", "");
  letter[letter.find("<p>") + 4] = 'n';
  expect_refusal("letter.dae", letter, "<p> = \"n\": allowed: whole numbers");
  expect_refusal("c.dae", dae_of({{"cap", cap(1e-3)}}, "-1", ""), "unit");
  expect_refusal("c.3mf", threemf_of({{"cap", cap(1e-3)}}, "parsec"), "micron, millimeter");
}

TEST_F(MeshFormats, RefuseWhatIsNoneOfThem) {
  for (const char* name : {"a.dae", "a.glb", "a.gltf", "a.ply", "a.3mf"})
    for (const std::string& bytes : {std::string(), std::string("no mesh"), std::string(5000, '\0'),
                                     std::string("solid a\nendsolid a\n")})
      EXPECT_NE(refusal_of(write(name, bytes)), "") << name << ": " << bytes.substr(0, 9);
  expect_refusal("points.ply",
                 "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                 "property float z\nend_header\n0 0 0\n1 0 0\n",
                 "triangles");
  // Assimp would count to this number.
  std::string endless = ply_of(cap(1e-3), false);
  endless.replace(endless.find("vertex ") + 7, 3, "99999999999999999999");
  expect_refusal("endless.ply", endless, "\"vertex\"");
  expect_refusal("headless.ply", "ply\nformat ascii 1.0\nelement vertex 4\n", "end_header");
  EXPECT_NE(refusal_of((folder.path() / "absent.dae").string()).find("missing"), std::string::npos);
  fs::create_directory(folder.path() / "folder.glb");
  EXPECT_NE(refusal_of((folder.path() / "folder.glb").string()).find("a folder"),
            std::string::npos);
  // Zeros pack a thousand to one: three megabytes that would fill three gigabytes.
  std::string bomb = zip_of({{"3D/3dmodel.model", std::string(2'000'000, '0')}}, true);
  const std::string size = {char(0x80), char(0x84), char(0x1E), 0};  // 2,000,000 as it is written
  for (std::size_t at; (at = bomb.find(size)) != std::string::npos;)
    bomb.replace(at, 4, std::string("\xFF\xFF\xFF\x7F", 4));
  expect_refusal("bomb.3mf", bomb, "at most 1000000000 bytes unpacked");
}

TEST_F(MeshFormats, SayWhatToDoWithoutTheirProgram) {
  write("cap.ply", ply_of(cap(1e-3), true));
  fs::create_directories(folder.path() / "bin");
  const fs::path program = folder.path() / "bin" / "softfinger";
  fs::copy_file(SOFTFINGER_PROGRAM, program);
  const std::string command = "cd " + folder.path().string() +
                              " && bin/softfinger mesh cap.ply >out 2>err; echo $? >status";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::string said = file_text(folder.path() / "err");
  EXPECT_EQ(file_text(folder.path() / "status"), "2\n") << said;
  EXPECT_EQ(lines(said).size(), 1u) << said;
  EXPECT_NE(said.find("install the package softfinger-robot"), std::string::npos) << said;
  EXPECT_NE(said.find("convert the file to STL"), std::string::npos) << said;
}

TEST_F(MeshFormats, AreTheFingersOfRobots) {
  // A ball of 8 mm whose lowest point the pad is.
  TriangleSurface ball = samples::quadric(4e-3, 40, 8e-3, 8e-3);
  write("tip.dae", dae_of({{"tip", ball}}, "", "Y_UP"));
  write("tip.glb", glb_of({{"tip", ball}}));
  for (Vector3d& vertex : ball.vertices_m) vertex *= 1e3;
  write("tip.3mf", threemf_of({{"tip", ball}}, ""));
  meshes::write_stl_mm(samples::quadric(4e-3, 40, 8e-3, 8e-3), write("tip.stl", ""));
  const auto radius_mm = [&](const std::string& mesh, const std::string& scale) {
    write("robot.urdf", "<robot name='r'><link name='tip'><collision><geometry><mesh filename='" +
                            mesh + "'" + scale + "/></geometry></collision></link></robot>");
    const json report =
        answer_of({"apply", "robot.urdf", "--finger", "tip", "--pad", "+z", "--layer", "2,300,0.45",
                   "--load", "0.5", "--friction", "0.8", "--to", "bullet", "--force", "--json"});
    return report.contains("fingers")
               ? 1e3 * report["fingers"][0]["relative_radii_m"][0].get<double>()
               : 0;
  };
  const double expected = radius_mm("tip.stl", " scale='.001 .001 .001'");
  EXPECT_NEAR(expected, 8, 0.1);
  const double rounded = 1e-5;
  for (const char* mesh : {"tip.dae", "tip.glb", "tip.3mf"})
    EXPECT_NEAR(radius_mm(mesh, "") / expected, 1, rounded) << mesh;
  EXPECT_NEAR(radius_mm("tip.glb", " scale='2 2 2'") / expected, 2, 0.02);
  // This robot is a scene, too; its only link is fixed.
  const ProgramRun simulated = run({"simulate", "robot.urdf", "--write-scene", "scene.toml",
                                    "--set", "simulation.duration_s=0.01", "--json"});
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  EXPECT_TRUE(fs::exists(folder.path() / "robot_mesh_0.stl"));
}

TEST_F(MeshFormats, MayBeTheShapesOfAScene) {
  write("cap.glb", glb_of({{"floor", cap(1)}, {"other", cap(1)}}));
  write("scene.toml",
        "[simulation]\ntime_step_ms = 1\nduration_s = 0.01\n[[body]]\nname = \"floor\"\nfixed = "
        "true\nshapes = [{ mesh = \"cap.glb\", part = \"floor\" }]\n[[body]]\nname = "
        "\"ball\"\nmass_g = 10\nshapes = [{ sphere_radius_mm = 5 }]\nposition_mm = [0, 0, 8]\n"
        "[[contact]]\nbodies = [\"floor\", \"ball\"]\nfriction_coefficient = 0.5\n");
  const ProgramRun result = run({"simulate", "scene.toml", "--json"});
  EXPECT_EQ(result.status, 0) << result.err;
}

#ifdef SOFTFINGER_FEM
TEST_F(MeshFormats, GoToTheFiniteElementsAsTheSameSurface) {
  meshes::write_stl_mm(in_metres(cap(1e-3)), write("cap.stl", ""));
  write("cap.3mf", threemf_of({{"cap", cap(1e-3)}}, ""));
  start.environment = {"SOFTFINGER_FEM_PROGRAM=" SOFTFINGER_FEM};
  const auto area_m2 = [&](const std::string& mesh) {
    write("case.toml",
          "id = \"cap\"\n[geometry]\nfinger = { mesh = \"" + mesh +
              "\", along = \"+z\" }\nobject = { radii_mm = [inf, inf] }\n[layer]\nthickness_mm = "
              "1\nyoungs_modulus_kPa = 300\npoisson_ratio = 0.3\n[contact]\nload_N = "
              "0.05\nfriction_coefficient = 0.8\n[fem]\ngeometry = \"curved\"\nkinematics = "
              "\"linear\"\n");
    const json answer = answer_of({"fem", "case.toml", "--level", "1", "--json"});
    return answer.contains("results") ? answer["results"][0]["area_m2"].get<double>() : 0;
  };
  const double expected = area_m2("cap.stl");
  EXPECT_GT(expected, 0);
  EXPECT_EQ(area_m2("cap.3mf"), expected);
}
#endif

}  // namespace
}  // namespace softfinger::tests
