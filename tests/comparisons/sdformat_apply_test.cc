// Output of `softfinger apply`, read by libsdformat, Gazebo's reader of SDF and URDF.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sdf/sdf.hh>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace {

using nlohmann::json;

constexpr const char* kSdf =
    "<sdf version='1.9'><model name='gripper'><link name='base'/>"
    "<link name='left'><collision name='pad'><geometry><sphere><radius>0.012</radius></sphere>"
    "</geometry></collision></link>"
    "<link name='right'><collision name='pad'><geometry><sphere><radius>0.012</radius></sphere>"
    "</geometry><surface><friction><ode><mu>1</mu></ode></friction></surface></collision></link>"
    "<joint name='l' type='fixed'><parent>base</parent><child>left</child></joint>"
    "<joint name='r' type='fixed'><parent>base</parent><child>right</child></joint>"
    "</model></sdf>";

const std::string kInertia =
    "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
    "</inertial>";
const std::string kUrdf =
    "<robot name='r'><link name='base'>" + kInertia + "</link><link name='tip'>" + kInertia +
    "<collision><geometry><sphere radius='0.01'/></geometry></collision></link>"
    "<joint name='j' type='revolute'><parent link='base'/><child link='tip'/><axis xyz='0 0 1'/>"
    "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";

class SdformatApply : public testing::Test {
 protected:
  TemporaryFolder folder;
  json report;

  /// The model in the written file.
  sdf::Root applied(const std::string& text, const std::string& finger, const std::string& to) {
    folder.write("model", text);
    const ProgramRun run = run_softfinger({folder.path(), {}, -1, ""},
                                          {"apply", "model", "silicone_pad_2mm", "--finger", finger,
                                           "--to", to, "-o", "soft", "--json"});
    EXPECT_EQ(run.status, 0) << run.err;
    if (run.status == 0) report = json::parse(run.out);
    sdf::Root root;
    const sdf::Errors errors = root.Load((folder.path() / "soft").string());
    for (const auto& error : errors) ADD_FAILURE() << error.Message();
    return root;
  }

  void expect_friction(const sdf::Collision& collision) const {
    const sdf::ElementPtr surface = collision.Element()->GetElement("surface");
    const sdf::ElementPtr friction = surface->GetElement("friction");
    const double six_digits = 5e-6, mu = report["friction_coefficient"];
    EXPECT_NEAR(friction->GetElement("ode")->Get<double>("mu") / mu, 1, six_digits);
    EXPECT_NEAR(friction->GetElement("ode")->Get<double>("mu2") / mu, 1, six_digits);
    const sdf::ElementPtr torsional = friction->GetElement("torsional");
    EXPECT_TRUE(torsional->Get<bool>("use_patch_radius"));
    EXPECT_NEAR(torsional->Get<double>("coefficient") / mu, 1, six_digits);
    // 16 e_n/(3 pi).
    EXPECT_NEAR(torsional->Get<double>("patch_radius") * 3 * 3.14159265358979 / 16 /
                    report["eccentricity_m"].get<double>(),
                1, six_digits);
  }
};

TEST_F(SdformatApply, ReadsTheSurfacesOfSdf) {
  const sdf::Root root = applied(kSdf, "right", "gazebo");
  const sdf::Model* const model = root.Model();
  ASSERT_TRUE(model);
  EXPECT_EQ(model->LinkCount(), 3u);
  expect_friction(*model->LinkByName("right")->CollisionByIndex(0));
  EXPECT_FALSE(model->LinkByName("left")->CollisionByIndex(0)->Element()->HasElement("surface"));
}

TEST_F(SdformatApply, ReadsTheSurfacesOfUrdf) {
  const sdf::Root root = applied(kUrdf, "tip", "gazebo");
  ASSERT_TRUE(root.Model());
  expect_friction(*root.Model()->LinkByName("tip")->CollisionByIndex(0));
}

TEST_F(SdformatApply, KeepsDrakesElements) {
  const sdf::Root root = applied(kSdf, "left::pad", "drake");
  const sdf::ElementPtr element = root.Model()->LinkByName("left")->CollisionByIndex(0)->Element();
  ASSERT_TRUE(element->HasElement("drake:proximity_properties"));
  const sdf::ElementPtr properties = element->GetElement("drake:proximity_properties");
  EXPECT_TRUE(properties->HasElement("drake:compliant_hydroelastic"));
  EXPECT_GT(
      std::stod(
          properties->GetElement("drake:hydroelastic_modulus")->GetValue()
              ? properties->GetElement("drake:hydroelastic_modulus")->GetValue()->GetAsString()
              : "0"),
      0);
}

}  // namespace
}  // namespace softfinger::tests
