#include "fem/layer/layer_model.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <filesystem>
#include <fstream>

#include "fem/output/write_vtu.h"
#include "meshes/generation/layer_block.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

LayerDiscretisation coarse() {
  LayerDiscretisation discretisation;
  discretisation.a = 1;
  discretisation.b = 0.5;
  discretisation.elements_per_semi_axis = 4;
  discretisation.patch = 1.3;
  return discretisation;
}

TEST(LayerModel, HasASymmetricPositiveCompliance) {
  const LayerModel model(coarse(), 0.45);
  const Eigen::MatrixXd& compliance = model.compliance();
  EXPECT_EQ(compliance, compliance.transpose());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(compliance).eigenvalues().minCoeff(), 0);
}

TEST(LayerModel, CondensedToAllDisplacementsServesPressingAndFriction) {
  LayerDiscretisation discretisation = coarse();
  discretisation.elements_per_semi_axis = 3;
  const std::vector<ElasticConstants> layer{{1, 0.45}};
  const LayerModel all(discretisation, layer, nullptr, no_plane, all_rub);
  const LayerModel normals(discretisation, layer, nullptr, no_plane);
  // Round-off of another order of elimination.
  constexpr double round_off = 1e-10;
  EXPECT_LT((all.compliance() - normals.compliance()).norm(),
            round_off * normals.compliance().norm());
  const std::vector<int> nodes{1, 4, 7, 20};
  const Eigen::MatrixXd expected = normals.vector_compliance({}, nodes);
  EXPECT_LT((all.vector_compliance({}, nodes) - expected).norm(), round_off * expected.norm());
  EXPECT_NEAR(expected(5, 11), normals.compliance()(4, 20), round_off * expected(5, 5));
  EXPECT_EQ(normals.vector_compliance({}, nodes), expected) << "asked for once more";
}

TEST(LayerModel, MayBeCondensedToAllDisplacementsOfSomeNodes) {
  LayerDiscretisation discretisation = coarse();
  discretisation.elements_per_semi_axis = 3;
  const std::vector<ElasticConstants> layer{{1, 0.45}};
  const auto rubs = [](const SurfaceNode& node) { return node.x > 0; };
  const LayerModel some(discretisation, layer, nullptr, no_plane, rubs);
  const LayerModel normals(discretisation, layer, nullptr, no_plane);
  constexpr double round_off = 1e-10;
  EXPECT_LT((some.compliance() - normals.compliance()).norm(),
            round_off * normals.compliance().norm());
  std::vector<int> nodes, others;
  for (int i = 0; i < static_cast<int>(some.nodes().size()); ++i)
    (rubs(some.nodes()[static_cast<std::size_t>(i)]) ? nodes : others).push_back(i);
  for (const std::vector<int>& asked : {nodes, others}) {
    const Eigen::MatrixXd expected = normals.vector_compliance({}, asked);
    EXPECT_LT((some.vector_compliance({}, asked) - expected).norm(), round_off * expected.norm());
  }
}

/// A scan's layer that is flat after all.
class FlatShape : public LayerShape {
 public:
  Eigen::Vector3d position(double x, double y, double z) const override { return {x, y, z}; }
  Eigen::Vector3d normal(double, double) const override { return Eigen::Vector3d::UnitZ(); }
  double area_ratio(double, double) const override { return 1; }
  MirrorPlanes planes() const override { return both_planes; }
};

TEST(LayerModel, SpendsFewerCellsUnderTheFlatOnesOfAScan) {
  // Cells twice as long as deep, as a contact that is longest along y has them.
  LayerDiscretisation discretisation;
  discretisation.a = 0.9;
  discretisation.b = 1.7;
  discretisation.elements_per_semi_axis = 4;
  discretisation.extent = 0.5;
  const long usual = LayerModel(discretisation, 0.45, std::make_shared<FlatShape>()).unknowns();
  discretisation.is_scan = true;
  const LayerModel scan(discretisation, 0.45, std::make_shared<FlatShape>());
  EXPECT_LT(static_cast<double>(scan.unknowns()), 0.75 * static_cast<double>(usual));
}

/// The flat layer, counted along x by steps that are short and long in turn from x = 3 on: a
/// quadratic cell between a few of its points folds there, though the map does not.
class UnevenlyCountedShape : public FlatShape {
 public:
  /// @param from  depth where it becomes uneven, at the core it is; negative: everywhere
  explicit UnevenlyCountedShape(double from = -1) : from_(from) {}

  Eigen::Vector3d position(double x, double y, double z) const override {
    const double share = from_ < 0 ? 1 : std::max(0.0, (-z - from_) / (1 - from_));
    return {x + share * (std::copysign(counted(std::abs(x)), x) - x), y, z};
  }

 private:
  static double counted(double x) {
    constexpr double even = 3, slow = 0.06, period = 1.3;
    if (x < even) return x;
    const double share = std::fmod(x - even, period) / period;
    return x - period * (1 - slow) * std::min(share, 1 - share);
  }

  double from_;
};

TEST(LayerModel, LeavesOutCellsThatFold) {
  LayerDiscretisation discretisation;
  discretisation.a = discretisation.b = 1;
  discretisation.elements_per_semi_axis = 3;
  discretisation.is_scan = true;
  const LayerModel even(discretisation, 0.45, std::make_shared<FlatShape>(), no_plane),
      uneven(discretisation, 0.45, std::make_shared<UnevenlyCountedShape>(), no_plane);
  EXPECT_LT(uneven.unknowns(), even.unknowns());
  ASSERT_EQ(uneven.nodes().size(), even.nodes().size());
  // The rest of the layer extends two thicknesses beyond the contact. A free side wall there
  // changes the mean deflection under an even pressure by 1.9 %.
  EXPECT_LT((uneven.compliance() - even.compliance()).cwiseAbs().maxCoeff(),
            0.02 * even.compliance().cwiseAbs().maxCoeff());
}

TEST(LayerModel, LeavesNoHoleUnderTheSurfaceWhereDeepCellsFold) {
  LayerDiscretisation discretisation;
  discretisation.a = discretisation.b = 1;
  discretisation.elements_per_semi_axis = 4;
  discretisation.is_scan = true;
  discretisation.interfaces = {0.5};
  const std::vector<ElasticConstants> sublayers{{1, 0.45}, {1, 0.45}};
  const auto unknowns = [&](std::shared_ptr<const LayerShape> shape) {
    return LayerModel(discretisation, sublayers, std::move(shape), no_plane).unknowns();
  };
  // The deep cells that fold are those that fold where all of the layer is uneven.
  EXPECT_EQ(unknowns(std::make_shared<UnevenlyCountedShape>(0.5)),
            unknowns(std::make_shared<UnevenlyCountedShape>()));
}

TEST(LayerModel, WeighsFacesWithPositiveNodes) {
  const LayerModel model(coarse(), 0.3);
  for (const auto& node : model.nodes()) EXPECT_GT(node.weight, 0);
  double inside = 0;
  for (const auto& face : model.faces())
    for (int k = 0; k < 9; ++k) inside += face.node[static_cast<std::size_t>(k)] >= 0;
  EXPECT_GT(inside, model.nodes().size());
}

TEST(LayerModel, YieldsAtLeastAsMuchUnderAPointAsBesideIt) {
  const LayerModel model(coarse(), 0.3);
  const Eigen::MatrixXd& compliance = model.compliance();
  for (Eigen::Index i = 0; i < compliance.rows(); ++i)
    for (Eigen::Index j = 0; j < compliance.cols(); ++j)
      EXPECT_LE(compliance(i, j) * compliance(i, j),
                compliance(i, i) * compliance(j, j) * (1 + 1e-12));
}

void expect_written_by(const LayerModel& model) {
  const auto folder = std::filesystem::temp_directory_path() / "softfinger_layer_model_test";
  const auto path = folder / "solution.vtu";
  std::filesystem::remove_all(folder);
  write_vtu(path, model, Eigen::VectorXd::Ones(static_cast<Eigen::Index>(model.nodes().size())),
            2e-3, 3e5);
  std::ifstream file(path);
  const std::string content(std::istreambuf_iterator<char>(file), {});
  for (const char* field : {"displacement_m", "stress_Pa", "contact_pressure_Pa"})
    EXPECT_NE(content.find(field), std::string::npos) << field;
  EXPECT_NE(content.find("</VTKFile>"), std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(LayerModel, WritesAFileForParaView) { expect_written_by(LayerModel(coarse(), 0.3)); }

TEST(LayerModel, WritesAFileWhenItsFactorIsNoLongerKept) {
  LayerDiscretisation discretisation = coarse();
  discretisation.elements_per_semi_axis = 3;
  expect_written_by(LayerModel(discretisation, std::vector<ElasticConstants>{{1, 0.3}}, nullptr,
                               no_plane, all_rub));
}

TEST(LayerModel, RefusesAFolderThatCannotBeWritten) {
  const LayerModel model(coarse(), 0.3);
  EXPECT_THROW(
      write_vtu("/dev/null/solution.vtu", model,
                Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.nodes().size())), 2e-3, 3e5),
      InputError);
}

TEST(LayerBlock, IsFilledByHexahedraOfPositiveVolume) {
  meshes::LayerBlock block;
  block.sublayers = {{1, 3}};
  const auto mesh = meshes::mesh_layer_block(block);
  double volume = 0;
  for (const auto& cell : mesh.cells) {
    const auto corner = [&](int i) {
      return mesh.vertices[static_cast<std::size_t>(cell[static_cast<std::size_t>(i)])];
    };
    // The block's cells are boxes: one corner's triple product is the volume.
    const double box =
        (corner(1) - corner(0)).cross(corner(3) - corner(0)).dot(corner(4) - corner(0));
    EXPECT_GT(box, 0);
    volume += box;
  }
  EXPECT_NEAR(volume, block.length_x * block.length_y * block.sublayers[0].thickness,
              1e-9 * volume);
}

TEST(LayerBlock, GrowsNoFasterThanAsked) {
  meshes::LayerBlock block;
  block.growth = 1.3;
  const auto mesh = meshes::mesh_layer_block(block);
  std::vector<double> x;
  for (const auto& vertex : mesh.vertices)
    if (std::abs(vertex.y()) < 1e-9 && std::abs(vertex.z()) < 1e-9) x.push_back(vertex.x());
  std::sort(x.begin(), x.end());
  for (std::size_t i = 2; i < x.size(); ++i)
    EXPECT_LE((x[i] - x[i - 1]) / (x[i - 1] - x[i - 2]), block.growth * (1 + 1e-9));
  EXPECT_DOUBLE_EQ(x.back(), block.length_x);
}

TEST(LayerBlock, RefusesLengthsThatAreNotNested) {
  meshes::LayerBlock block;
  block.inner_x = 7;
  EXPECT_THROW(meshes::mesh_layer_block(block), InputError);
  block.inner_x = -1;
  EXPECT_THROW(meshes::mesh_layer_block(block), InputError);
}

}  // namespace
}  // namespace softfinger::fem
