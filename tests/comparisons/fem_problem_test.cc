#include "comparisons/reference/fem_problem.h"

#include <gtest/gtest.h>

#include <cmath>

#include "comparisons/reference/size_hint.h"

namespace softfinger {
namespace {

constexpr char kPad[] = R"(
id = "pad"
[geometry]
finger = { radii_mm = [20.0, 10.0] }
object = { radii_mm = [inf, inf] }
[layer]
thickness_mm = 2.0
youngs_modulus_kPa = 300.0
poisson_ratio = 0.45
[contact]
load_N = [3.0]
friction_coefficient = 0.7
)";

nlohmann::json problem(const std::string& more) {
  const input::Case contact_case = input::parse_case(kPad + more, "pad.toml");
  const prediction::GeometryResolver resolver(contact_case);
  return to_json(reference::fem_problem(contact_case, resolver.resolve(3), 3, 1));
}

}  // namespace

TEST(FemProblem, HasTheCasesNumbersUnderTheirKeys) {
  const nlohmann::json linear = problem("");
  EXPECT_EQ(linear["name"], "pad");
  EXPECT_EQ(linear["friction_coefficient"], 0.7);
  EXPECT_EQ(linear["load_N"], 3);
  EXPECT_EQ(linear["level"], 1);
  EXPECT_EQ(linear["layer"]["thickness_m"], 2e-3);
  EXPECT_TRUE(linear["sphere_radius_m"].is_null());
  for (const char* key : {"kinematics", "fingertip", "friction", "approach_m", "layer_mesh"})
    EXPECT_FALSE(linear.contains(key)) << key;
}

TEST(FemProblem, SaysThatStrainIsFiniteAndOfWhichMaterial) {
  const nlohmann::json finite = problem("[fem]\nkinematics = \"finite\"\n");
  EXPECT_EQ(finite["kinematics"], "finite");
  EXPECT_EQ(finite["layer"]["material"], "neo_hookean");
  EXPECT_EQ(finite["layer"]["volumetric"], "quadratic");
}

TEST(FemProblem, HasBothBodiesWhereTheFingerIsCurved) {
  const nlohmann::json curved = problem("[fem]\ngeometry = \"curved\"\n");
  const nlohmann::json& pad = curved["fingertip"]["pad"];
  EXPECT_EQ(pad["radii_m"], (nlohmann::json{0.02, 0.01}));
  EXPECT_EQ(pad["turn_rad"], 0);
  EXPECT_EQ(curved["fingertip"]["object"]["radii_m"], (nlohmann::json{nullptr, nullptr}));
}

TEST(FemProblem, SaysOfAScanWhichPartOfItsRegionNobodyAskedFor) {
  input::Case contact_case =
      input::parse_case(std::string(kPad) + "[fem]\ngeometry = \"curved\"\n", "pad.toml");
  input::MeshBody scan;
  scan.path = "scan.stl";
  std::get<input::BodyPair>(contact_case.geometry).finger = scan;
  prediction::LocalGeometry geometry;
  geometry.radii = {0.02, 0.01, 0};
  ContactPatch& patch = geometry.patch.emplace();
  patch.finger_fit.emplace();
  const auto excess = [&](bool agrees, double predicted_mm2, double region_mm2) {
    patch.agrees = agrees;
    patch.predicted_area_m2 = 1e-6 * predicted_mm2;
    patch.region_area_m2 = 1e-6 * region_mm2;
    const nlohmann::json object = to_json(reference::fem_problem(contact_case, geometry, 3, 1));
    return object["fingertip"]["pad"].value("region_excess", 0.);
  };
  // The region that is asked for is twice the contact.
  EXPECT_DOUBLE_EQ(excess(false, 10, 80), 0.75);
  EXPECT_EQ(excess(true, 10, 20.1), 0) << "they agree";
  EXPECT_EQ(excess(false, 80, 10), 0) << "too small, as where a surface ends";
  EXPECT_EQ(excess(false, 0, 0), 0) << "no region, as at an edge";
}

TEST(FemProblem, HasFrictionFilesAndApproachOnlyWhereTheyAreAskedFor) {
  reference::FemProblem asked;
  asked.friction.emplace().torsion = true;
  asked.friction->twist_axis_m = Eigen::Vector2d(1e-3, -2e-3);
  asked.approach_m = 1e-4;
  asked.output_directory = "out";
  const nlohmann::json object = to_json(asked);
  EXPECT_EQ(object["friction"]["torsion"], true);
  EXPECT_EQ(object["friction"]["twist_axis_m"], (nlohmann::json{1e-3, -2e-3}));
  EXPECT_EQ(object["approach_m"], 1e-4);
  EXPECT_EQ(object["output_directory"], "out");
  EXPECT_FALSE(object.contains("compliance_file"));
}

TEST(FemProblem, ExpectsTheSizeOfTheContactThatHertzTellsOnAThickLayer) {
  reference::FemProblem thick;
  thick.radii = {0.02, 0.02, 0};
  thick.layer = {1.0, 1e6, 0.3};
  thick.load_N = 2;
  const auto size_m = reference::size_hint_m(thick);
  ASSERT_TRUE(size_m);
  const double hertz_m = std::cbrt(0.75 * 2 * 0.02 * (1 - 0.3 * 0.3) / 1e6);
  EXPECT_NEAR((*size_m)[0], hertz_m, 0.01 * hertz_m);
  EXPECT_NEAR((*size_m)[1], hertz_m, 0.01 * hertz_m);
  EXPECT_FALSE(to_json(thick).contains("size_hint_m")) << "a finished result outlives the model";
}

TEST(FemProblem, ExpectsNoSizeWhereNoModelTellsOne) {
  reference::FemProblem problem;
  problem.radii = {0.02, 0.02, 0};
  problem.layer = {2e-3, 1e6, 0.3};
  problem.load_N = 2;
  ASSERT_TRUE(reference::size_hint_m(problem));
  reference::FemProblem layered = problem, pressed = problem, tapered = problem;
  layered.sublayers.resize(2);
  EXPECT_FALSE(reference::size_hint_m(layered));
  pressed.approach_m = 1e-4;
  EXPECT_FALSE(reference::size_hint_m(pressed));
  tapered.bodies.emplace().pad.body =
      input::QuadricBody{0.02, 0.01, input::FingerShape::tapered, 30};
  EXPECT_FALSE(reference::size_hint_m(tapered));
}

}  // namespace softfinger
