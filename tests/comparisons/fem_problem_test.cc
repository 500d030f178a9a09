#include "comparisons/reference/fem_problem.h"

#include <gtest/gtest.h>

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

}  // namespace softfinger
