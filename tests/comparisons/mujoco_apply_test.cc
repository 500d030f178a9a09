// Output of `softfinger apply`, run in the real MuJoCo.

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace {

using nlohmann::json;

class MujocoApply : public testing::Test {
 protected:
  using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
  using Data = std::unique_ptr<mjData, decltype(&mj_deleteData)>;
  TemporaryFolder folder;

  json apply(const std::string& model, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"apply", model, "silicone_pad_2mm", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun run = run_softfinger({folder.path(), {}, -1, ""}, arguments);
    EXPECT_EQ(run.status, 0) << run.err;
    return run.status == 0 ? json::parse(run.out) : json::object();
  }
  Model load(const std::string& name) {
    char error[1000] = "";
    Model model(mj_loadXML((folder.path() / name).c_str(), nullptr, error, sizeof error),
                mj_deleteModel);
    EXPECT_TRUE(model) << error;
    return model;
  }
};

TEST_F(MujocoApply, IsReadWithTheExportedFrictionOnTheNamedGeomsOnly) {
  folder.write("hand.xml", file_text(SOFTFINGER_HAND));
  const json report = apply("hand.xml", {"--finger", "tip_1", "--finger", "tip_3", "--to", "mujoco",
                                         "--plugin", "-o", "soft.xml"});
  const Model before = load("hand.xml"), after = load("soft.xml");
  ASSERT_TRUE(before && after);
  ASSERT_EQ(after->ngeom, before->ngeom);
  EXPECT_EQ(after->nnumeric, before->nnumeric);
  EXPECT_EQ(after->opt.cone, mjCONE_ELLIPTIC);
  const double friction = report["friction_coefficient"];
  const double six_digits = 5e-6;
  for (int geom = 0; geom < after->ngeom; ++geom) {
    const char* const text = mj_id2name(after.get(), mjOBJ_GEOM, geom);
    const std::string name = text ? text : "";
    const mjtNum* const now = after->geom_friction + 3 * geom;
    if (name == "tip_1" || name == "tip_3") {
      EXPECT_EQ(after->geom_condim[geom], 4);
      EXPECT_GT(after->geom_priority[geom], before->geom_priority[geom]);
      EXPECT_NEAR(now[0] / friction, 1, six_digits);
      EXPECT_NEAR(now[1] / (friction * report["eccentricity_m"].get<double>()), 1, six_digits);
      continue;
    }
    for (int i = 0; i < 3; ++i) EXPECT_EQ(now[i], before->geom_friction[3 * geom + i]) << name;
    EXPECT_EQ(after->geom_priority[geom], before->geom_priority[geom]);
  }
  for (int i = 0; i < after->nbody; ++i) EXPECT_EQ(after->body_mass[i], before->body_mass[i]);
}

// With --effective-mass-g the contact has the model's normal stiffness at the nominal load.
TEST_F(MujocoApply, GivesTheContactTheModelsNormalStiffness) {
  folder.write("ball.xml",
               "<mujoco><option gravity='0 0 0' timestep='0.001'/><worldbody>"
               "<geom type='box' size='1 1 .1' pos='0 0 -.1'/><body pos='0 0 .02'>"
               "<freejoint/><geom name='tip' size='.02' mass='.05'/>"
               "</body></worldbody></mujoco>");
  const json report = apply("ball.xml", {"--finger", "tip", "--to", "mujoco", "-o", "soft.xml",
                                         "--effective-mass-g", "50"});
  const Model model = load("soft.xml");
  ASSERT_TRUE(model);
  const auto height_m = [&](double load_N) {
    const Data data(mj_makeData(model.get()), mj_deleteData);
    data->qfrc_applied[2] = -load_N;
    for (int i = 0; i < 3000; ++i) mj_step(model.get(), data.get());
    return data->qpos[2];
  };
  const double load_N = report["load_N"], step_N = 0.1 * load_N;
  const double stiffness = 2 * step_N / (height_m(load_N - step_N) - height_m(load_N + step_N));
  // The six digits of solref.
  EXPECT_NEAR(stiffness / report["normal_stiffness_N_per_m"].get<double>(), 1, 1e-4);
}

TEST_F(MujocoApply, ReadsACopyOfAModelThatIncludesItsFinger) {
  folder.write("hand.xml",
               "<mujoco><include file='common.xml'/><worldbody><geom type='plane' size='1 1 1'/>"
               "<body name='palm'><include file='finger.xml'/></body></worldbody></mujoco>");
  folder.write("common.xml",
               "<mujoco><default><geom type='capsule' size='.006 .01'/></default>"
               "<option timestep='.001'/></mujoco>");
  folder.write("finger.xml",
               "<mujocoinclude><body name='finger' pos='0 0 .1'><joint axis='0 1 0'/>"
               "<geom name='tip'/><geom name='other' pos='0 .05 0'/></body></mujocoinclude>");
  const ProgramRun run = run_softfinger(
      {folder.path(), {}, -1, ""},
      {"apply", "hand.xml", "--finger", "tip", "--pad", "-z", "--layer", "2,300,0.45", "--load",
       "2", "--friction", "0.8", "--to", "mujoco", "-o", "copy/", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json finger = json::parse(run.out)["fingers"][0];
  const Model model = load("copy/hand.xml");
  ASSERT_TRUE(model);
  EXPECT_EQ(model->opt.cone, mjCONE_ELLIPTIC);
  EXPECT_EQ(model->opt.timestep, 0.001);
  const int tip = mj_name2id(model.get(), mjOBJ_GEOM, "tip");
  const int other = mj_name2id(model.get(), mjOBJ_GEOM, "other");
  EXPECT_EQ(model->geom_condim[tip], 4);
  EXPECT_EQ(model->geom_condim[other], 3);
  const double six_digits = 5e-6, radius_m = model->geom_size[3 * tip];
  EXPECT_NEAR(model->geom_friction[3 * tip + 1] / (0.8 * finger["eccentricity_m"].get<double>()), 1,
              six_digits);
  EXPECT_NEAR(finger["relative_radii_m"][1].get<double>(), radius_m, 1e-12);
  // The end of the capsule, which lies along z.
  EXPECT_NEAR(finger["pad_in_body_m"][2].get<double>(), -model->geom_size[3 * tip + 1] - radius_m,
              1e-12);
}

TEST_F(MujocoApply, ChangedUrdfIsStillRead) {
  const std::string inertia =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
      "</inertial>";
  folder.write("robot.urdf",
               "<robot name='r'><link name='base'>" + inertia + "</link><link name='tip'>" +
                   inertia +
                   "<collision><geometry><sphere radius='0.01'/></geometry></collision></link>"
                   "<joint name='j' type='revolute'><parent link='base'/><child link='tip'/>"
                   "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/>"
                   "</joint></robot>");
  const Model before = load("robot.urdf");
  for (const std::string to : {"gazebo", "drake", "bullet"}) {
    apply("robot.urdf", {"--finger", "tip", "--to", to, "-o", "soft.urdf"});
    const Model after = load("soft.urdf");
    ASSERT_TRUE(before && after) << to;
    EXPECT_EQ(after->nbody, before->nbody);
    EXPECT_EQ(after->ngeom, before->ngeom);
    EXPECT_EQ(after->njnt, before->njnt);
  }
}

}  // namespace
}  // namespace softfinger::tests
