// Meshes with flat and curved parts at rest: their own surface touches, nothing beside it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "comparisons/simulation/simulate.h"
#include "softfinger/input/errors.h"
#include "tests/meshes/test_surfaces.h"
#include "tests/meshes/triangulated_ellipsoid.h"

namespace softfinger::simulation {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct RestingMesh {
  const char* name;
  TriangleSurface surface;
  bool rolls = false;
};

std::vector<RestingMesh> resting_meshes() {
  using namespace meshes;
  const std::vector<Vector2d> standing = {{0, 0}, {0.015, 0}, {0.015, 0.04}, {0, 0.04}};
  const std::vector<Vector2d> cone = {{0, 0}, {0.02, 0}, {0.008, 0.03}, {0, 0.03}};
  // A foot that is hollow by a tenth of a millimetre stands on its ring.
  const std::vector<Vector2d> bowl = {{0, 1e-4},    {0.012, 1e-4}, {0.013, 0},     {0.016, 0},
                                      {0.03, 0.02}, {0.028, 0.02}, {0.014, 0.002}, {0, 0.002}};
  std::vector<Vector2d> torus = arc({0.02, 0.006}, 0.006, 0, 2 * kPi, 24);
  torus.pop_back();
  std::vector<Vector2d> dome = arc({0, 0}, 0.02, 0, kPi / 2, 12);
  dome.back().x() = 0;
  dome.insert(dome.begin(), Vector2d(0, 0));
  TriangleSurface lying = revolved_surface(standing, 64);
  for (Vector3d& v : lying.vertices_m) v = Vector3d(v.z() - 0.02, v.x(), -v.y());
  return {{"glass", glass_surface(0.025, 0.035, 0.1, 96)},
          {"rounded box", rounded_box_surface(Vector3d(0.03, 0.03, 0.03), 0.005, 12)},
          {"flat rounded box", rounded_box_surface(Vector3d(0.04, 0.06, 0.01), 0.002, 16)},
          {"box", rounded_box_surface(Vector3d(0.03, 0.02, 0.02), 0, 6)},
          {"standing cylinder", revolved_surface(standing, 48)},
          {"lying cylinder", lying, true},
          {"cone", revolved_surface(cone, 40)},
          {"bowl", revolved_surface(bowl, 60)},
          {"ring", revolved_surface(torus, 60)},
          {"dome", revolved_surface(dome, 40)},
          {"ellipsoid", triangulated_ellipsoid(Vector3d(0.03, 0.03, 0.01), Vector3d::Zero(), 30),
           true}};
}

struct MeshScene {
  explicit MeshScene(const TriangleSurface& surface)
      : folder(fs::temp_directory_path() / fmt::format("softfinger_mesh_rest_{}", getpid())) {
    fs::create_directories(folder);
    std::ofstream file(folder / "body.obj");
    file.precision(17);
    for (const Vector3d& v : surface.vertices_m)
      file << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
    for (const auto& t : surface.triangles)
      file << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  }
  ~MeshScene() { fs::remove_all(folder); }
  input::Scene on_table(double height_m, double duration_s) const {
    return input::parse_scene(
        fmt::format("id = \"rest\"\n[simulation]\ntime_step_ms = 2\nduration_s = {}\n"
                    "[[body]]\nname = \"table\"\nfixed = true\nshapes = [{{ half_space = true }}]\n"
                    "[[body]]\nname = \"mesh\"\nposition_mm = [0, 0, {}]\n"
                    "shapes = [{{ mesh = \"body.obj\", unit = \"m\" }}]\n"
                    "density_kg_per_m3 = 1000\n"
                    "[[contact]]\nbodies = [\"*\", \"*\"]\nfriction_coefficient = 0.5\n",
                    duration_s, 1e3 * height_m),
        folder / "scene.toml");
  }
  fs::path folder;
};

double lowest_m(const TriangleSurface& surface, const Eigen::Isometry3d& pose) {
  double least_m = kInfinity;
  for (const Vector3d& vertex : surface.vertices_m)
    least_m = std::min(least_m, (pose * vertex).z());
  return least_m;
}

class RestOfAMesh : public testing::TestWithParam<int> {
 protected:
  const RestingMesh mesh = resting_meshes()[std::size_t(GetParam())];
};

TEST_P(RestOfAMesh, IsItsOwnHeight) {
  const MeshScene files(mesh.surface);
  const double height_m = -lowest_m(mesh.surface, Eigen::Isometry3d::Identity());
  // Placed at its resting height nothing overlaps; from a little above it falls down.
  for (const double above_m : {0., 5e-4}) {
    SCOPED_TRACE(fmt::format("{} from {} m", mesh.name, above_m));
    const Simulation run = simulate(files.on_table(height_m + above_m, 0.4));
    ASSERT_EQ(run.failure, "");
    const Frame& last = run.recording.frames.back();
    EXPECT_NEAR(lowest_m(mesh.surface, last.poses[1]), 0, 1e-6);
    double force_N = 0;
    for (const RecordedContact& contact : last.contacts) force_N += contact.normal_force_N;
    EXPECT_GT(force_N, 0) << "the table carries it";
  }
}

class RestOnAFlatSide : public RestOfAMesh {};

TEST_P(RestOnAFlatSide, IsStill) {
  const MeshScene files(mesh.surface);
  const double height_m = -lowest_m(mesh.surface, Eigen::Isometry3d::Identity());
  const Simulation run = simulate(files.on_table(height_m, 2));
  ASSERT_EQ(run.failure, "");
  const Frame& last = run.recording.frames.back();
  EXPECT_LE((last.poses[1].translation() - Vector3d(0, 0, height_m)).norm(), 1e-6);
  EXPECT_LE(last.angular_velocities_rad_per_s[1].norm(), 1e-6);
  EXPECT_GE(last.contacts.size(), 3u) << "the corners of its flat side carry it";
}

std::vector<int> numbers(bool also_round) {
  std::vector<int> found;
  const std::vector<RestingMesh> all = resting_meshes();
  for (int i = 0; i < int(all.size()); ++i)
    if (also_round || !all[std::size_t(i)].rolls) found.push_back(i);
  return found;
}

std::string name_of(const testing::TestParamInfo<int>& number) {
  std::string name = resting_meshes()[std::size_t(number.param)].name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Meshes, RestOfAMesh, testing::ValuesIn(numbers(true)), name_of);
INSTANTIATE_TEST_SUITE_P(Meshes, RestOnAFlatSide, testing::ValuesIn(numbers(false)), name_of);

TEST(MeshPlate, HoldsABoxByItsCorners) {
  // The box's corners lie in the middle of the plate's two large triangles.
  const TriangleSurface plate = meshes::rounded_box_surface(Vector3d(0.2, 0.2, 0.02), 0, 1);
  const MeshScene files(plate);
  const input::Scene scene = input::parse_scene(
      "id = \"plate\"\n[simulation]\ntime_step_ms = 2\nduration_s = 1\n"
      "[[body]]\nname = \"plate\"\nfixed = true\nshapes = [{ mesh = \"body.obj\", unit = \"m\" }]\n"
      "[[body]]\nname = \"box\"\nposition_mm = [5, 3, 20.2]\n"
      "shapes = [{ box_size_mm = [30, 40, 20] }]\ndensity_kg_per_m3 = 1000\n"
      "[[contact]]\nbodies = [\"*\", \"*\"]\nfriction_coefficient = 0.5\n",
      files.folder / "scene.toml");
  const Simulation run = simulate(scene);
  ASSERT_EQ(run.failure, "");
  const Frame& last = run.recording.frames.back();
  EXPECT_LE((last.poses[1].translation() - Vector3d(0.005, 0.003, 0.02)).norm(), 1e-6);
  EXPECT_GE(last.contacts.size(), 3u);
  EXPECT_LE(last.angular_velocities_rad_per_s[1].norm(), 1e-6);
}

}  // namespace
}  // namespace softfinger::simulation
