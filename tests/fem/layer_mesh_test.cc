// A layer's mesh from a user's file: the answers of our own mesh, or one clear refusal.

#include "meshes/generation/layer_mesh.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "fem/reference_solver.h"
#include "softfinger/input/errors.h"
#include "tests/fem/layer_mesh_file.h"

namespace softfinger::fem {
namespace {

const Progress quiet = [](const std::string&) {};

class UserMesh : public testing::Test {
 protected:
  UserMesh() {
    problem.level = 1;
    problem.contact = {{0.02, 0.015, 0}, {2e-3, 3e5, 0.45}, {0.5, 0.6}};
    // Semi-axes are about 2 mm: cells of 1.25 mm are halved by the solver.
    auto& block = file.block;
    block.inner_x = block.inner_y = 2.5;
    block.cell_x = block.cell_y = 1.25;
    block.length_x = block.length_y = 15;
    block.sublayers = {{2, 2}};
    block.growth = 1.5;
  }
  ~UserMesh() override { std::filesystem::remove(path); }

  std::shared_ptr<const meshes::LayerMesh> read() const {
    file.write(path);
    return std::make_shared<const meshes::LayerMesh>(meshes::read_layer_mesh(path, 1e-3));
  }
  void expect_refusal(const std::string& word) {
    try {
      problem.mesh = read();
      solve(problem, quiet);
      ADD_FAILURE() << "accepted: " << word;
    } catch (const InputError& error) {
      const std::string line = error.what();
      EXPECT_NE(line.find(word), std::string::npos) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
  }

  tests::LayerMeshFile file;
  Problem problem;
  const std::string path = std::filesystem::temp_directory_path() /
                           (std::string("softfinger_") +
                            testing::UnitTest::GetInstance()->current_test_info()->name() + ".msh");
};

TEST_F(UserMesh, IsReadWithItsSurfaces) {
  const auto mesh = read();
  const auto cells = mesh->hexahedra.cells.size();
  EXPECT_EQ(mesh->contact.size(), cells / 2);
  EXPECT_EQ(mesh->core.size(), cells / 2);
  double lowest = 0, highest = -1;
  for (const auto& vertex : mesh->hexahedra.vertices) {
    lowest = std::min(lowest, vertex.z());
    highest = std::max(highest, vertex.z());
  }
  EXPECT_NEAR(lowest, -2e-3, 1e-15);
  EXPECT_NEAR(highest, 0, 1e-15);
}

TEST_F(UserMesh, OfAFlatLayerAnswersLikeTheFlatLayer) {
  Problem flat = problem;
  flat.level = 2;
  const Result expected = solve(flat, quiet);
  problem.mesh = read();
  long predicted = 0;
  const Result result = solve(problem, [&](const std::string& line) {
    std::sscanf(line.c_str(), "level %*d: the mesh from outside makes %ld", &predicted);
  });
  EXPECT_EQ(predicted, result.finest.unknowns) << "told before the work";
  const auto compare = [&](const char* what, double LevelResult::*quantity,
                           double RelativeError::*stated) {
    const double error = result.finest.*quantity / (expected.finest.*quantity) - 1;
    std::printf("  %-8s %+8.4f %%   stated %7.4f and %7.4f %%\n", what, 100 * error,
                100 * result.error.*stated, 100 * expected.error.*stated);
    EXPECT_NEAR(error, 0, result.error.*stated + expected.error.*stated) << what;
  };
  compare("d", &LevelResult::indentation_m, &RelativeError::indentation);
  compare("torque", &LevelResult::max_torque_Nm, &RelativeError::max_torque);
  compare("a", &LevelResult::a_m, &RelativeError::a);
  compare("b", &LevelResult::b_m, &RelativeError::b);
  EXPECT_LT(result.error.indentation, 0.02);
  EXPECT_LT(result.error.max_torque, 0.02);
}

TEST_F(UserMesh, WithoutAGroupIsRefused) {
  file.core = "base";
  expect_refusal("\"core\" is missing");
  file.core = "core";
  file.contact = "top";
  expect_refusal("surface \"top\"");
  file.contact = "contact";
  file.layers = {"rubber"};
  expect_refusal("\"layer\" is missing");
}

TEST_F(UserMesh, ThatIsNotHexahedraIsRefused) {
  file.split = 3;
  expect_refusal("Tetrahedron");
}

TEST_F(UserMesh, WithAnInvertedElementIsRefused) {
  file.inverted = 3;
  expect_refusal("of \"layer\" is inverted");
}

TEST_F(UserMesh, WhoseContactSurfaceEndsInTheContactIsRefused) {
  file.contact_reach_mm = 1.3;
  expect_refusal("covers the contact");
}

TEST_F(UserMesh, ThatCannotBeReadIsRefused) {
  EXPECT_THROW(meshes::read_layer_mesh("/nonexistent/layer.msh", 1e-3), InputError);
  std::ofstream(path) << "no mesh\n";
  EXPECT_THROW(meshes::read_layer_mesh(path, 1e-3), InputError);
}

}  // namespace
}  // namespace softfinger::fem
