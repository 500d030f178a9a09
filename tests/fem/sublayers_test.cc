// Bonded sublayers of different materials.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "fem/contact/normal_contact.h"
#include "fem/finite/deformed_contact.h"
#include "fem/finite/finite_pressing.h"
#include "fem/layer/layer_model.h"
#include "fem/program/reference_solver.h"
#include "meshes/generation/layer_mesh.h"
#include "softfinger/input/errors.h"
#include "tests/fem/layer_mesh_file.h"

namespace softfinger::fem {
namespace {

const Progress silent = [](const std::string&) {};

/// An elastic stack bonded to a rigid base, exactly: displacement of its surface per pressure, both
/// J0(k r). Fields U J1 (radial), W J0 (axial) and tractions T J1, S J0 obey y' = A y,
/// y = (U, W, T, S); its solutions go with e^{kz}, z e^{kz}, e^{-kz}, z e^{-kz}.
class ExactStack {
 public:
  struct Sublayer {
    double thickness;
    ElasticConstants constants;
  };

  explicit ExactStack(std::vector<Sublayer> sublayers) : sublayers_(std::move(sublayers)) {}

  double compliance(double k) const {
    const auto count = static_cast<Eigen::Index>(sublayers_.size());
    Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(4 * count, 4 * count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(4 * count);
    right[1] = -1;  // S of a unit pressure
    for (Eigen::Index i = 0; i < count; ++i) {
      const Sublayer& sublayer = sublayers_[static_cast<std::size_t>(i)];
      const Eigen::Matrix4d top = solutions(sublayer, k, 0),
                            bottom = solutions(sublayer, k, -sublayer.thickness);
      if (i == 0) equations.block(0, 0, 2, 4) = top.bottomRows(2);
      if (i > 0) equations.block(4 * i - 2, 4 * i, 4, 4) = -top;
      if (i + 1 < count)
        equations.block(4 * i + 2, 4 * i, 4, 4) = bottom;
      else
        equations.block(4 * i + 2, 4 * i, 2, 4) = bottom.topRows(2);
    }
    const Eigen::VectorXd coefficients = equations.fullPivLu().solve(right);
    return -solutions(sublayers_[0], k, 0).row(1).dot(coefficients.head<4>());
  }

  /// Displacement under the pressure (1 - r²)² on r < 1, whose Hankel transform is 8 J3(k)/k³.
  double displacement(double r) const {
    // Simpson's rule; beyond the end the integrand is below k^-3.5.
    constexpr int steps = 4000;
    constexpr double end = 120;
    double sum = 0;
    for (int i = 1; i <= steps; ++i) {
      const double k = end * i / steps;
      const double weight = i == steps ? 1 : i % 2 == 1 ? 4 : 2;
      sum += weight * compliance(k) * 8 * std::cyl_bessel_j(3, k) / (k * k) *
             std::cyl_bessel_j(0, k * r);
    }
    return sum * end / steps / 3;
  }

 private:
  /// Columns; none of their entries grows with k beyond a power of it.
  static Eigen::Matrix4d solutions(const Sublayer& sublayer, double k, double z) {
    const double nu = sublayer.constants.poisson_ratio;
    const double shear = sublayer.constants.youngs_ratio / 2 / (1 + nu);
    const double lame = shear * 2 * nu / (1 - 2 * nu), axial = lame + 2 * shear;
    Eigen::Matrix4d rates;
    rates << 0, k, 1 / shear, 0,                                        //
        -lame * k / axial, 0, 0, 1 / axial,                             //
        k * k * (axial - lame * lame / axial), 0, 0, k * lame / axial,  //
        0, 0, -k, 0;
    Eigen::Matrix4d result;
    for (const double s : {k, -k}) {
      const Eigen::Vector4d harmonic(-k, s, -2 * shear * k * s, 2 * shear * k * k);
      const Eigen::Vector4d second =
          (rates - s * Eigen::Matrix4d::Identity()).colPivHouseholderQr().solve(harmonic);
      const double from = s > 0 ? 0 : -sublayer.thickness;
      const double decay = std::exp(s * (z - from));
      const Eigen::Index column = s > 0 ? 0 : 2;
      result.col(column) = decay * harmonic;
      result.col(column + 1) = decay * (second + (z - from) * harmonic);
    }
    return result;
  }

  std::vector<Sublayer> sublayers_;
};

LayerDiscretisation unit_contact(std::vector<double> interfaces, int elements) {
  LayerDiscretisation mesh;
  mesh.a = mesh.b = 1;
  mesh.elements_per_semi_axis = elements;
  mesh.interfaces = std::move(interfaces);
  return mesh;
}

/// Displacement of a surface node under the pressure (1 - r²)².
double displacement(const LayerModel& model, double x) {
  const auto& nodes = model.nodes();
  Eigen::VectorXd force(static_cast<Eigen::Index>(nodes.size()));
  Eigen::Index place = -1;
  for (Eigen::Index i = 0; i < force.size(); ++i) {
    const SurfaceNode& node = nodes[static_cast<std::size_t>(i)];
    const double inside = std::max(0.0, 1 - node.x * node.x - node.y * node.y);
    force[i] = node.weight * inside * inside;
    if (std::abs(node.x - x) < 1e-9 && std::abs(node.y) < 1e-9) place = i;
  }
  return (model.compliance() * force)[place];
}

TEST(ExactStack, OfOneMaterialIsThatOfAHomogeneousLayer) {
  // Thin against the wavelength: confined compression, h/M. Thick: the half-space.
  const ElasticConstants silicone{2, 0.3};
  const double confined = 2 * 0.7 / (1.3 * 0.4);
  EXPECT_NEAR(ExactStack({{1, silicone}}).compliance(1e-3), 1 / confined, 1e-5 / confined);
  EXPECT_NEAR(ExactStack({{0.3, silicone}, {0.7, silicone}}).compliance(40),
              2 * (1 - 0.09) / (2 * 40), 1e-9);
  for (const double k : {0.1, 1.0, 10.0})
    EXPECT_NEAR(ExactStack({{0.3, silicone}, {0.7, silicone}}).compliance(k),
                ExactStack({{1, silicone}}).compliance(k), 1e-10)
        << k;
}

TEST(Sublayers, SinkAsTheExactStackDoes) {
  const ElasticConstants skin{5, 0.45}, pulp{1, 0.49}, lining{0.4, 0.2};
  struct Stack {
    std::vector<double> interfaces;
    std::vector<ElasticConstants> materials;
  };
  for (const Stack& stack : {Stack{{0.25}, {skin, pulp}}, Stack{{0.5}, {pulp, skin}},
                             Stack{{0.2, 0.6}, {skin, pulp, lining}}}) {
    std::vector<ExactStack::Sublayer> sublayers;
    for (std::size_t i = 0; i < stack.materials.size(); ++i) {
      const double top = i == 0 ? 0 : stack.interfaces[i - 1];
      const double bottom = i < stack.interfaces.size() ? stack.interfaces[i] : 1;
      sublayers.push_back({bottom - top, stack.materials[i]});
    }
    const ExactStack exact(sublayers);
    const LayerModel coarse(unit_contact(stack.interfaces, 4), stack.materials);
    const LayerModel fine(unit_contact(stack.interfaces, 8), stack.materials);
    for (const double x : {0.0, 0.5, 1.0}) {
      const double expected = exact.displacement(x), found = displacement(fine, x);
      // At the pressure's rim the nodal forces may be right to the first order only: the remaining
      // error is as large as the difference of the two meshes.
      const double left = std::abs(found - displacement(coarse, x));
      EXPECT_NEAR(found, expected, left + 1e-4 * exact.displacement(0)) << "x " << x;
    }
  }
}

TEST(Sublayers, OfOneMaterialAreAHomogeneousLayer) {
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.02, 0.01, 0}, {2e-3, 3e5, 0.45}, {1, 0.6}};
  const Result one = solve(problem, silent);
  problem.sublayers = {{{0.7e-3, 3e5, 0.45}, {}}, {{1.3e-3, 3e5, 0.45}, {}}};
  const Result two = solve(problem, silent);
  const auto compare = [&](double LevelResult::*quantity, double RelativeError::*error) {
    EXPECT_NEAR(two.finest.*quantity / one.finest.*quantity, 1,
                one.error.*error + two.error.*error);
  };
  compare(&LevelResult::a_m, &RelativeError::a);
  compare(&LevelResult::b_m, &RelativeError::b);
  compare(&LevelResult::indentation_m, &RelativeError::indentation);
  compare(&LevelResult::max_torque_Nm, &RelativeError::max_torque);
  compare(&LevelResult::peak_pressure_Pa, &RelativeError::peak_pressure);
}

// A firm skin over a soft pulp, whose pressure peaks beside the centre: fits of high degrees make
// up for nearly any edge.
TEST(Sublayers, OfASkinOverPulpHaveAnEdgeThatIsKnown) {
  Problem problem;
  const double load_N = 0.10368588163253438, R = 0.06;
  problem.contact = {{R, R, 0}, {3e-3, 3e5, 0.45}, {load_N, 0.7}};
  problem.sublayers = {{{0.6e-3, 3e5, 0.45}, {}}, {{2.4e-3, 6e4, 0.49}, {}}};
  const Result result = solve(problem, silent);
  // Reference: the integral equation of the exact stack, to all digits that are shown.
  EXPECT_NEAR(result.finest.a_m / 3e-3, 1, result.error.a);
  EXPECT_NEAR(result.finest.indentation_m / 9.263036600551442e-05, 1, result.error.indentation);
  EXPECT_LT(result.error.a, 0.03);
}

TEST(Sublayers, LieBetweenTheirMaterials) {
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.01, 0.01, 0}, {2e-3, 3e5, 0.45}, {1, 0.6}};
  problem.friction.torsion = true;
  const auto answer = [&](double skin_Pa, double pulp_Pa) {
    problem.sublayers = {{{0.5e-3, skin_Pa, 0.45}, {}}, {{1.5e-3, pulp_Pa, 0.45}, {}}};
    return solve(problem, silent);
  };
  const Result soft = answer(2e5, 2e5), skinned = answer(8e5, 2e5), hard = answer(8e5, 8e5);
  EXPECT_LT(hard.finest.indentation_m, skinned.finest.indentation_m);
  EXPECT_LT(skinned.finest.indentation_m, soft.finest.indentation_m);
  EXPECT_GT(skinned.torsion->stiffness_Nm_per_rad, soft.torsion->stiffness_Nm_per_rad);
}

TEST(Sublayers, AtFiniteStrainAreThoseOfSmallStrainForSmallLoads) {
  const std::vector<double> interfaces = {0.25};
  const std::vector<ElasticConstants> materials = {{4, 0.45}, {1, 0.3}};
  LayerDiscretisation mesh = unit_contact(interfaces, 4);
  mesh.a = mesh.b = 0.3;
  mesh.patch = 1.6;
  constexpr double radius = 50;
  const auto object = quadric(radius, radius);
  const LayerModel linear(mesh, materials);
  Eigen::VectorXd gap(static_cast<Eigen::Index>(linear.nodes().size()));
  for (Eigen::Index i = 0; i < gap.size(); ++i) {
    const SurfaceNode& node = linear.nodes()[static_cast<std::size_t>(i)];
    gap[i] = (node.x * node.x + node.y * node.y) / (2 * radius);
  }
  std::vector<double> differences;
  for (const double approach : {2e-3, 1e-3}) {
    std::vector<std::shared_ptr<const finite::Material>> of_sublayers;
    for (const auto& [youngs_ratio, poisson_ratio] : materials)
      of_sublayers.push_back(finite::make_material({}, youngs_ratio, poisson_ratio));
    finite::FinitePressing pressing(
        std::make_shared<finite::FiniteLayer>(mesh, nullptr, both_planes, of_sublayers),
        quadric(radius, radius));
    pressing.press({0, approach});
    const NormalContact contact = solve_normal_contact_at(linear.compliance(), gap, approach);
    differences.push_back(pressing.equilibrium().load / (4 * contact.force.sum()) - 1);
    // The effect of finite strain is of the first order in d/h.
    EXPECT_LT(std::abs(differences.back()), 3 * approach);
  }
}

TEST(Sublayers, AreRegionsOfAMeshFromOutside) {
  const std::string path =
      (std::filesystem::temp_directory_path() / "softfinger_sublayers_test.msh").string();
  tests::LayerMeshFile file;
  constexpr double thickness_m = 2e-3;
  file.block.inner_x = file.block.inner_y = 4. / 3 * 2;
  file.block.cell_x = file.block.cell_y = 2. / 3;
  file.block.length_x = file.block.length_y = 14;
  file.block.sublayers = {{0.5, 1}, {1.5, 1}};
  file.block.growth = 1.5;
  file.layers = {"skin", "pulp"};
  file.write(path);
  const std::vector<ElasticConstants> materials = {{4, 0.45}, {1, 0.49}};
  const meshes::LayerMesh mesh = meshes::read_layer_mesh(path, 1e-3, {"skin", "pulp"});
  const LayerModel coarse(unit_contact({}, 3), materials, mesh, thickness_m);
  const LayerModel fine(unit_contact({}, 6), materials, mesh, thickness_m);
  const ExactStack exact({{0.25, materials[0]}, {0.75, materials[1]}});
  const double found = displacement(fine, 0);
  EXPECT_NEAR(found, exact.displacement(0), std::abs(found - displacement(coarse, 0)))
      << "to the first order, as on our own mesh";
  try {
    meshes::read_layer_mesh(path, 1e-3, {"skin", "bone"});
    FAIL() << "no refusal";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("\"bone\" is missing"), std::string::npos)
        << error.what();
  }
  std::filesystem::remove(path);
}

TEST(Sublayers, AreRegionsOfAMeshFromOutsideAtFiniteStrain) {
  const std::string path =
      (std::filesystem::temp_directory_path() / "softfinger_finite_sublayers_test.msh").string();
  tests::LayerMeshFile file;
  constexpr double thickness_m = 2e-3;
  // The contact's radius is 2 mm or so: cells of a quarter of it.
  file.block.inner_x = file.block.inner_y = 2.2;
  file.block.cell_x = file.block.cell_y = 0.55;
  file.block.length_x = file.block.length_y = 12;
  file.block.sublayers = {{0.5, 1}, {1.5, 2}};
  file.block.growth = 1.6;
  file.layers = {"skin", "pulp"};
  file.write(path);
  const std::vector<std::shared_ptr<const finite::Material>> materials = {
      finite::make_material({}, 4, 0.45), finite::make_material({}, 1, 0.48)};
  LayerDiscretisation mesh;
  mesh.a = mesh.b = 0.8;
  mesh.elements_per_semi_axis = 3;
  mesh.patch = 1.5;
  constexpr double radius = 5, approach = 0.12;
  const auto pressed = [&](std::shared_ptr<finite::FiniteLayer> layer) {
    finite::FinitePressing pressing(std::move(layer), sphere(radius));
    pressing.press({0, approach});
    return pressing;
  };
  const finite::FinitePressing outside = pressed(std::make_shared<finite::FiniteLayer>(
      mesh, meshes::read_layer_mesh(path, 1e-3, file.layers), thickness_m, materials));
  std::filesystem::remove(path);
  mesh.interfaces = {0.25};
  const auto own = [&](int elements) {
    mesh.elements_per_semi_axis = elements;
    return pressed(std::make_shared<finite::FiniteLayer>(mesh, nullptr, both_planes, materials));
  };
  const finite::FinitePressing coarse = own(3), fine = own(6);
  const auto compare = [&](double one, double coarse_one, double fine_one, const char* what) {
    // Two coarse meshes of one cell size, each off by what the fine one shows.
    EXPECT_NEAR(one / fine_one, 1, 2 * std::abs(coarse_one / fine_one - 1) + 1e-3) << what;
  };
  compare(outside.equilibrium().load, coarse.equilibrium().load, fine.equilibrium().load, "load");
  compare(outside.equilibrium().energy, coarse.equilibrium().energy, fine.equilibrium().energy,
          "energy");
  const finite::DeformedContact found = *measure(outside, 1), expected = *measure(fine, 1);
  EXPECT_NEAR(found.torque_arm / expected.torque_arm, 1,
              2 * std::abs(measure(coarse, 1)->torque_arm / expected.torque_arm - 1) + 1e-3);
  // As stated for contacts whose area is that of touching nodes: 0.2/n.
  EXPECT_NEAR(found.area / expected.area, 1, 0.2 / 3);
}

TEST(Sublayers, ThatMakeNoLayerAreRefused) {
  Problem problem;
  problem.contact = {{0.02, 0.015, 0}, {2e-3, 3e5, 0.45}, {0.5, 0.6}};
  const auto expect_refusal = [&](double skin_m, double pulp_m, double nu, const char* word) {
    problem.sublayers = {{{skin_m, 8e5, nu}, {}}, {{pulp_m, 2e5, 0.45}, {}}};
    try {
      solve(problem, silent);
      ADD_FAILURE() << "no refusal of " << word;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  expect_refusal(0.5e-3, 1.0e-3, 0.45, "in sum");
  expect_refusal(0, 2e-3, 0.45, "> 0");
  expect_refusal(1e-5, 1.99e-3, 0.45, "at least 2 %");
  expect_refusal(0.5e-3, 1.5e-3, 0.6, "poisson_ratio");
}

}  // namespace
}  // namespace softfinger::fem
