// A layer's mesh from a user's file: the answers of our own mesh, or one clear refusal.

#include "meshes/generation/layer_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "fem/contact/pressing.h"
#include "fem/finite/deformed_contact.h"
#include "fem/finite/finite_pressing.h"
#include "fem/program/reference_solver.h"
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

  /// A block of the flat layer with lines at these places (mm), of which only x and y >= 0 are
  /// given, and its vertices moved.
  static std::shared_ptr<const meshes::LayerMesh> block_of(
      const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z,
      const std::function<void(Eigen::Vector3d&)>& move = [](Eigen::Vector3d&) {}) {
    const auto both_sides = [](const std::vector<double>& half) {
      std::vector<double> lines(half.rbegin(), half.rend() - 1);
      for (double& line : lines) line = -line;
      lines.insert(lines.end(), half.begin(), half.end());
      return lines;
    };
    const std::vector<double> along_x = both_sides(x), along_y = both_sides(y);
    auto mesh = std::make_shared<meshes::LayerMesh>();
    for (const double at_z : z)
      for (const double at_y : along_y)
        for (const double at_x : along_x) {
          Eigen::Vector3d place(at_x, at_y, at_z);
          move(place);
          mesh->hexahedra.vertices.push_back(1e-3 * place);
        }
    const int nx = static_cast<int>(along_x.size()), ny = static_cast<int>(along_y.size()),
              nz = static_cast<int>(z.size());
    const auto vertex = [&](int i, int j, int k) { return i + nx * (j + ny * k); };
    for (int i = 0; i + 1 < nx; ++i)
      for (int j = 0; j + 1 < ny; ++j) {
        const auto face = [&](int k) -> std::array<int, 4> {
          return {vertex(i, j, k), vertex(i + 1, j, k), vertex(i + 1, j + 1, k),
                  vertex(i, j + 1, k)};
        };
        for (int k = 0; k + 1 < nz; ++k) {
          const auto bottom = face(k), top = face(k + 1);
          mesh->hexahedra.cells.push_back(
              {bottom[0], bottom[1], bottom[2], bottom[3], top[0], top[1], top[2], top[3]});
          mesh->hexahedra.region.push_back(0);
        }
        mesh->core.push_back(face(0));
        mesh->contact.push_back(face(nz - 1));
      }
    return mesh;
  }

  /// Compares with the flat layer of the suite's own mesh. @returns the finest level
  LevelResult expect_flat_layers_answer() {
    Problem flat = problem;
    flat.mesh = nullptr;
    flat.level = 2;
    const Result expected = solve(flat, quiet);
    std::vector<long> predicted, solved;
    const Result result = solve(problem, [&](const std::string& line) {
      long unknowns = 0;
      const auto after = line.find(": the mesh from outside makes ");
      if (after != std::string::npos &&
          std::sscanf(line.c_str() + after, ": the mesh from outside makes %ld", &unknowns) == 1)
        predicted.push_back(unknowns);
      const auto told = line.find("unknowns ");
      if (told != std::string::npos &&
          std::sscanf(line.c_str() + told, "unknowns %ld,", &unknowns) == 1)
        solved.push_back(unknowns);
    });
    EXPECT_EQ(predicted.front(), solved.front()) << "told before the work";
    EXPECT_EQ(predicted.back(), solved.back());
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
    compare("area", &LevelResult::area_projected_m2, &RelativeError::area);
    EXPECT_LT(result.error.indentation, 0.02);
    EXPECT_LT(result.error.max_torque, 0.02);
    return result.finest;
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
  problem.mesh = read();
  expect_flat_layers_answer();
}

TEST_F(UserMesh, OfLongCellsIsDividedAlongTheirLengthOnly) {
  problem.mesh = block_of({0, 2.5, 5, 8, 11, 15},
                          {0, 0.5, 1, 1.5, 2, 2.5, 3, 3.6, 4.4, 5.4, 7, 9, 12, 15}, {-2, -1, 0});
  // Halved on all sides until they are short enough, they made 510 000.
  EXPECT_LT(expect_flat_layers_answer().unknowns, 60000);
}

TEST_F(UserMesh, OfUnevenCellsIsRefinedWhereTheyAreLarge) {
  // Across the contact, which is 2 mm wide, the cells of one sheet become four times as long: up to
  // 18 times as long as wanted.
  const auto uneven = block_of(
      {0, 3, 6, 10, 15}, {0, 0.5, 1, 1.5, 2.5, 4, 7, 15}, {-2, -1.2, -0.6, 0},
      [](Eigen::Vector3d& place) {
        constexpr double scaled = 3, end = 15;
        const double scale = std::pow(4, std::clamp(place.y() / 2, -0.5, 0.5));
        const double x = std::abs(place.x());
        const double moved =
            x <= scaled ? scale * x
                        : scale * scaled + (end - scale * scaled) * (x - scaled) / (end - scaled);
        place.x() = std::copysign(moved, place.x());
      });
  LayerDiscretisation mesh;
  mesh.a = mesh.b = 0.5;
  mesh.elements_per_semi_axis = 3;
  mesh.patch = 1.6;
  constexpr double h_m = 2e-3;
  const std::shared_ptr<const finite::Material> material = finite::make_material({}, 1.0, 0.45);
  const std::shared_ptr<const RigidObject> ball = sphere(2);  // in h: its slope is 0.25 at the edge
  finite::FinitePressing on_uneven(
      std::make_shared<finite::FiniteLayer>(mesh, *uneven, h_m, std::vector{material}), ball);
  finite::FinitePressing on_own(
      std::make_shared<finite::FiniteLayer>(mesh, nullptr, no_plane, material), ball);

  const finite::FiniteLayer& layer = on_uneven.layer();
  int hanging = 0;
  double area = 0;
  for (const SurfaceFace& face : layer.faces())
    hanging += std::any_of(face.node.begin(), face.node.end(), [](int node) { return node < 0; }) &&
               std::all_of(face.node.begin(), face.node.end(), [&](int node) {
                 return node < 0 || std::hypot(layer.nodes()[std::size_t(node)].x,
                                               layer.nodes()[std::size_t(node)].y) < mesh.a;
               });
  for (const SurfaceNode& node : layer.nodes()) {
    EXPECT_GT(node.weight, 0);
    if (std::hypot(node.x, node.y) < 1.3 * mesh.a) area += node.weight;
  }
  EXPECT_GT(hanging, 0) << "in the contact";
  EXPECT_NEAR(area, M_PI * 1.3 * 1.3 * mesh.a * mesh.a, 0.1) << "hanging nodes give theirs away";

  for (finite::FinitePressing* pressing : {&on_uneven, &on_own}) pressing->press({0, 0.15});
  const finite::Equilibrium &found = on_uneven.equilibrium(), &expected = on_own.equilibrium();
  std::printf(
      "  finite strain, %d places hang, unknowns %ld and %ld, iterations %d and %d, load %+.3f "
      "%%\n",
      hanging, layer.unknowns(), on_own.layer().unknowns(), on_uneven.history().iterations,
      on_own.history().iterations, 100 * (found.load / expected.load - 1));
  // Error of cells of a third of the contact.
  constexpr double of_cells = 0.005;
  EXPECT_NEAR(found.load / expected.load, 1, of_cells);
  EXPECT_NEAR(found.energy / expected.energy, 1, of_cells);
  EXPECT_LT(found.complementarity_residual, 1e-6);
  EXPECT_LE(on_uneven.history().iterations, on_own.history().iterations + 1)
      << "the tangent is exact: Newton's method converges as on an even mesh";
  const finite::DeformedContact one = *finite::measure(on_uneven, 1),
                                other = *finite::measure(on_own, 1);
  EXPECT_NEAR(one.torque_arm / other.torque_arm, 1, of_cells);
  EXPECT_NEAR(one.area / other.area, 1, 0.03) << "by nodes that touch";

  problem.mesh = uneven;
  problem.contact = {{0.04, 0.04, 0}, {h_m, 3e5, 0.45}, {0.02, 0.6}};
  const Pressing pressing = pressing_of(problem);
  Problem flat = problem;
  flat.mesh = nullptr;
  const Pressing own = pressing_of(flat);
  const Pressed pressed = *press_on(*make_layer(mesh, pressing), pressing),
                pressed_own = *press_on(*make_layer(mesh, own), own);
  EXPECT_NEAR(pressed.contact.approach / pressed_own.contact.approach, 1, of_cells);
  EXPECT_NEAR(pressed.torque_arm() / pressed_own.torque_arm(), 1, of_cells);
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
