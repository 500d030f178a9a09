// The plugin in the real MuJoCo: a pressed object is twisted until it slips, at loads from a tenth
// to ten times the nominal one; MuJoCo's own arrays; how far the friction lags.

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "comparisons/exporting/mujoco/eccentricity_table.h"
#include "comparisons/exporting/mujoco/softfinger_mujoco.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::tests {
namespace {

constexpr double kMass_kg = 0.02, kRadius_m = 0.02, kTimeStep_s = 1e-3;
constexpr double kInertia_kgm2 = 0.4 * kMass_kg * kRadius_m * kRadius_m;
constexpr double kFriction = 0.8, kLoad_N = 2;

ContactProblem pad(double load_N) {
  ContactProblem problem;
  problem.radii = {20e-3, 5e-3, 0};
  problem.layer = {2e-3, 300e3, 0.45};
  problem.load = {load_N, kFriction};
  problem.finger_curvature = {50, 200, 0};
  return problem;
}

/// Eccentricity e_n by the model itself.
double eccentricity_m(double load_N) {
  return find_pressure_model("fingertip_layer")->predict(pad(load_N)).torque_arm_exact_m;
}

const char* const kListed =
    "<custom><numeric name=\"softfinger:tip\" data=\"20e-3 5e-3 2e-3 300e3 0.45 50 200 0\"/>"
    "</custom>";

/// A ball on a block, without gravity, that turns about z only, with the constant that is exact at
/// the nominal load.
std::string world(const std::string& custom = kListed, const std::string& option = "",
                  const std::string& geom = "condim=\"4\"") {
  return "<mujoco>" + custom + "<option gravity=\"0 0 0\" timestep=\"" +
         std::to_string(kTimeStep_s) +
         "\" cone=\"elliptic\" impratio=\"10\" noslip_iterations=\"5\" iterations=\"200\" "
         "tolerance=\"1e-14\"/>" +
         option + "<worldbody><geom type=\"box\" size=\"1 1 0.1\" pos=\"0 0 -0.1\"/>" +
         "<body pos=\"0 0 " + std::to_string(kRadius_m) +
         "\"><joint type=\"slide\" axis=\"1 0 0\"/><joint type=\"slide\" axis=\"0 1 0\"/>"
         "<joint type=\"slide\" axis=\"0 0 1\"/><joint type=\"hinge\" axis=\"0 0 1\"/>"
         "<geom name=\"tip\" type=\"sphere\" priority=\"1\" friction=\"" +
         std::to_string(kFriction) + " " + std::to_string(kFriction * eccentricity_m(kLoad_N)) +
         " 0.0001\" size=\"" + std::to_string(kRadius_m) + "\" mass=\"" + std::to_string(kMass_kg) +
         "\" " + geom + "/></body></worldbody></mujoco>";
}

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using Data = std::unique_ptr<mjData, decltype(&mj_deleteData)>;
using Plugin = std::unique_ptr<softfinger_mujoco, decltype(&softfinger_mujoco_free)>;

Model load(const std::string& xml) {
  auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "world.xml", int(xml.size()));
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char error[1000] = "";
  Model model(mj_loadXML("world.xml", files.get(), error, sizeof error), mj_deleteModel);
  mj_deleteVFS(files.get());
  EXPECT_TRUE(model) << error << "\n" << xml;
  return model;
}

Data data_of(const Model& model) { return {mj_makeData(model.get()), mj_deleteData}; }

Plugin plugin_of(const Model& model) {
  char error[1000] = "";
  Plugin plugin(softfinger_mujoco_create(model.get(), error, sizeof error), softfinger_mujoco_free);
  EXPECT_TRUE(plugin) << error;
  return plugin;
}

void run(const Model& model, const Data& data, double duration_s) {
  const int steps = int(std::lround(duration_s / kTimeStep_s));
  for (int i = 0; i < steps; ++i) mj_step(model.get(), data.get());
}

/// The torque from which on the pressed object turns faster and faster: bisected to 1e-4.
double slip_torque_Nm(const Model& model, double load_N) {
  const Data pressed = data_of(model);
  pressed->qfrc_applied[2] = -load_N;
  run(model, pressed, 0.5);
  double held_Nm = 0, slipping_Nm = 4 * kFriction * load_N * eccentricity_m(load_N);
  const Data data = data_of(model);
  while (slipping_Nm - held_Nm > 1e-4 * slipping_Nm) {
    const double torque_Nm = (held_Nm + slipping_Nm) / 2;
    // Afresh, as a copied mjData has no step before it.
    mj_resetData(model.get(), data.get());
    data->qfrc_applied[2] = -load_N;
    run(model, data, 0.3);
    data->qfrc_applied[3] = torque_Nm;
    run(model, data, 0.2);
    const double velocity = data->qvel[3];
    run(model, data, 0.2);
    // A torque 1e-4 above the limit changes the velocity by 1e-4 torque / inertia each second.
    const bool slips = (data->qvel[3] - velocity) / 0.2 > 0.5e-4 * torque_Nm / kInertia_kgm2;
    (slips ? slipping_Nm : held_Nm) = torque_Nm;
  }
  return slipping_Nm;
}

}  // namespace

TEST(MujocoPlugin, TableIsTheModel) {
  const exporting::EccentricityTable table(pad(1));
  ASSERT_TRUE(table.has_answer());
  for (double load_N = 1e-3; load_N < 1e3; load_N *= 1.07)
    EXPECT_NEAR(table.at(load_N) / eccentricity_m(load_N), 1, 1e-4) << load_N;
  for (const double none : {0., -1., double(NAN)}) {
    EXPECT_GT(table.at(none), 0);
    EXPECT_LT(table.at(none), table.at(1e-3));
  }
  EXPECT_TRUE(std::isfinite(table.at(INFINITY)));
}

/// The hand that holds a glass; pressed for two seconds.
Data holding_hand(const Model& model) {
  Data data = data_of(model);
  for (int finger = 0; finger < 4; ++finger) data->ctrl[finger] = 3.0 * 0.09;
  for (int i = 0; i < 1000; ++i) mj_step(model.get(), data.get());
  return data;
}

Model hand() {
  char error[1000] = "";
  Model model(mj_loadXML(SOFTFINGER_HAND, nullptr, error, sizeof error), mj_deleteModel);
  EXPECT_TRUE(model) << error;
  return model;
}

// Within 1 % of the model from P/10 to 10 P; the constant is off by a third at P/3.
TEST(MujocoPlugin, SlipsAtTheModelsTorqueFromATenthToTenTimesTheLoad) {
  const Model model = load(world());
  for (const double share : {0.1, 1. / 3, 1., 3., 10.}) {
    const double load_N = share * kLoad_N;
    const double truth_Nm = kFriction * load_N * eccentricity_m(load_N);
    const double constant = slip_torque_Nm(model, load_N) / truth_Nm - 1;
    const Plugin plugin = plugin_of(model);
    softfinger_mujoco_install(plugin.get());
    const double error = slip_torque_Nm(model, load_N) / truth_Nm - 1;
    RecordProperty("share_" + std::to_string(share),
                   std::to_string(error) + ", constant " + std::to_string(constant));
    std::printf("  at %5.2f P: slip torque %+.3f %%, of the constant %+.1f %%\n", share,
                100 * error, 100 * constant);
    EXPECT_NEAR(error, 0, 1e-2) << share;
    EXPECT_NEAR(constant, eccentricity_m(kLoad_N) / eccentricity_m(load_N) - 1, 1e-3) << share;
  }
}

TEST(MujocoPlugin, WorksWithEveryIntegratorAndSolver) {
  const double load_N = 5 * kLoad_N, truth_Nm = kFriction * load_N * eccentricity_m(load_N);
  for (const int integrator : {mjINT_EULER, mjINT_RK4, mjINT_IMPLICIT})
    for (const int solver : {mjSOL_PGS, mjSOL_CG, mjSOL_NEWTON}) {
      SCOPED_TRACE(std::to_string(integrator) + ", " + std::to_string(solver));
      const Model model = load(world());
      model->opt.integrator = integrator;
      model->opt.solver = solver;
      const Plugin plugin = plugin_of(model);
      softfinger_mujoco_install(plugin.get());
      EXPECT_NEAR(slip_torque_Nm(model, load_N) / truth_Nm, 1, 1e-2);
    }
}

// The plugin writes the values into MuJoCo's arrays that MuJoCo computes for a geom with this
// friction.
TEST(MujocoPlugin, LeavesTheArraysThatMujocoMakesOfTheSameFriction) {
  for (const int solver : {mjSOL_PGS, mjSOL_CG, mjSOL_NEWTON})
    for (const int jacobian : {mjJAC_DENSE, mjJAC_SPARSE})
      for (const int noslip : {0, 5}) {
        SCOPED_TRACE("solver " + std::to_string(solver) + ", jacobian " + std::to_string(jacobian) +
                     ", noslip " + std::to_string(noslip));
        const Model model = load(world());
        model->opt.solver = solver;
        model->opt.jacobian = jacobian;
        model->opt.noslip_iterations = noslip;
        const Plugin plugin = plugin_of(model);
        const Data data = data_of(model), expected = data_of(model);
        data->qfrc_applied[2] = -5 * kLoad_N;
        for (int i = 0; i < 300; ++i) {
          mj_step1(model.get(), data.get());
          softfinger_mujoco_apply(plugin.get(), model.get(), data.get());
          mj_step2(model.get(), data.get());
        }
        mj_step1(model.get(), data.get());
        softfinger_mujoco_apply(plugin.get(), model.get(), data.get());
        ASSERT_EQ(data->ncon, 1);
        const int tip = mj_name2id(model.get(), mjOBJ_GEOM, "tip");
        const double before = model->geom_friction[3 * tip + 1];
        model->geom_friction[3 * tip + 1] = data->contact[0].friction[2];
        EXPECT_GT(data->contact[0].friction[2], 1.2 * before);
        std::copy_n(data->qpos, model->nq, expected->qpos);
        std::copy_n(data->qvel, model->nv, expected->qvel);
        mj_step1(model.get(), expected.get());
        ASSERT_EQ(expected->nefc, data->nefc);
        for (int row = 0; row < data->nefc; ++row) {
          const double rounding = 1e-14;
          EXPECT_NEAR(data->efc_R[row] / expected->efc_R[row], 1, rounding);
          EXPECT_NEAR(data->efc_D[row] / expected->efc_D[row], 1, rounding);
          EXPECT_NEAR(data->efc_diagApprox[row] / expected->efc_diagApprox[row], 1, rounding);
        }
        if (!mj_isDual(model.get())) continue;
        const int elements = jacobian == mjJAC_DENSE ? data->nefc * data->nefc
                                                     : data->efc_AR_rowadr[data->nefc - 1] +
                                                           data->efc_AR_rownnz[data->nefc - 1];
        const double scale = *std::max_element(expected->efc_AR, expected->efc_AR + elements);
        for (int i = 0; i < elements; ++i)
          EXPECT_NEAR(data->efc_AR[i], expected->efc_AR[i], 1e-14 * scale) << i;
      }
}

// The friction is that of the step before. Its error is at most 1/3, the largest exponent of e_n,
// of the change of ln P within a step.
TEST(MujocoPlugin, LagsTheLoadByOneStep) {
  const Model model = load(world());
  const Plugin plugin = plugin_of(model);
  softfinger_mujoco_install(plugin.get());
  const Data data = data_of(model);
  double last_N = 0, worst = 0, worst_change = 0;
  for (int i = 0; i < 1500; ++i) {
    // 1 to 3 N at 5 Hz.
    data->qfrc_applied[2] = -kLoad_N * (1 + 0.5 * std::sin(2 * mjPI * 5 * i * kTimeStep_s));
    mj_step(model.get(), data.get());
    if (data->ncon == 0) continue;  // at the start
    const double load_N = data->efc_force[data->contact[0].efc_address];
    if (i > 500) {
      const double error =
          std::abs(data->contact[0].friction[2] / (kFriction * eccentricity_m(load_N)) - 1);
      const double change = std::abs(std::log(load_N / last_N));
      const double rounding = 1e-4;  // of the table
      EXPECT_LE(error, change / 3 + rounding);
      worst = std::max(worst, error);
      worst_change = std::max(worst_change, change);
    }
    last_N = load_N;
  }
  std::printf(
      "  1 to 3 N at 5 Hz, steps of 1 ms: the load changes by %.2f %% a step at most, e_n "
      "is off by %.2f %%\n",
      100 * worst_change, 100 * worst);
  EXPECT_GT(worst_change, 0.01) << "else nothing was tested";
}

TEST(MujocoPlugin, SharesALoadAmongTheContactPointsOfAPair) {
  // A box has four contact points, whose torques add up to mu e_n(P) P.
  std::string xml = world();
  const std::string sphere = "type=\"sphere\"";
  xml.replace(xml.find(sphere), sphere.size(), "type=\"box\"");
  const std::string size = "size=\"" + std::to_string(kRadius_m) + "\"";
  xml.replace(xml.rfind(size), size.size(), "size=\"0.02 0.02 0.02\"");
  const Model model = load(xml);
  const Plugin plugin = plugin_of(model);
  softfinger_mujoco_install(plugin.get());
  const Data data = data_of(model);
  data->qfrc_applied[2] = -kLoad_N;
  run(model, data, 1);
  ASSERT_EQ(data->ncon, 4);
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(data->contact[i].friction[2] / (kFriction * eccentricity_m(kLoad_N)), 1, 1e-3);
}

TEST(MujocoPlugin, StepsManyDataInThreadsAndAfterAReset) {
  const Model model = load(world());
  const Plugin plugin = plugin_of(model);
  softfinger_mujoco_install(plugin.get());
  std::vector<std::thread> threads;
  std::vector<double> friction(4);
  for (std::size_t i = 0; i < friction.size(); ++i)
    threads.emplace_back([&, i] {
      const Data data = data_of(model);
      for (int repeat = 0; repeat < 2; ++repeat) {
        mj_resetData(model.get(), data.get());
        data->qfrc_applied[2] = -double(i + 1);
        run(model, data, 0.5);
        friction[i] = data->contact[0].friction[2];
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < friction.size(); ++i)
    EXPECT_NEAR(friction[i] / (kFriction * eccentricity_m(double(i + 1))), 1, 1e-3) << i;
}

TEST(MujocoPlugin, LeavesAnotherCallbackAndTakesItselfOut) {
  static int calls;
  calls = 0;
  mjcb_passive = [](const mjModel*, mjData*) { ++calls; };
  const mjfGeneric before = mjcb_passive;
  const Model model = load(world());
  {
    const Plugin plugin = plugin_of(model);
    softfinger_mujoco_install(plugin.get());
    softfinger_mujoco_install(plugin.get());
    const Data data = data_of(model);
    calls = 0;  // MuJoCo's compiler steps, too
    mj_step(model.get(), data.get());
    EXPECT_EQ(calls, 1);
  }
  EXPECT_EQ(mjcb_passive, before);
  mjcb_passive = nullptr;
}

TEST(MujocoPlugin, RefusesWhatItCannotUseInOneLine) {
  const auto refusal = [](const std::string& xml) {
    const Model model = load(xml);
    char error[1000] = "";
    const Plugin plugin(softfinger_mujoco_create(model.get(), error, sizeof error),
                        softfinger_mujoco_free);
    EXPECT_FALSE(plugin) << xml;
    EXPECT_EQ(std::string(error).find('\n'), std::string::npos);
    return std::string(error);
  };
  const auto listed = [](const std::string& name, const std::string& data) {
    return "<custom><numeric name=\"" + name + "\" data=\"" + data + "\"/></custom>";
  };
  const auto expect = [&](const std::string& xml, const std::string& words) {
    EXPECT_NE(refusal(xml).find(words), std::string::npos) << refusal(xml);
  };
  expect(world(""), "lists no geom");
  expect(world(listed("softfinger:tipp", "1 1 1 1 0")),
         "softfinger:tipp: the model has no such geom");
  expect(world(listed("softfinger:tip", "1 1 1")), "3 numbers: allowed: 5");
  expect(world(listed("softfinger:tip", "1 2 1 1 0")), "R' >= R''");
  expect(world(listed("softfinger:tip", "1 1 -1 1 0")), "number 3");
  expect(world(listed("softfinger:tip", "1 1 1 1 0.6")), "Poisson's ratio");
  expect(world(kListed, "", "condim=\"3\""), "condim = 3: allowed: 4 or 6");
  expect(world(kListed, "<option cone=\"pyramidal\"/>"), "elliptic");
}

TEST(MujocoPlugin, HoldsTheGlassInTheHandForAMinute) {
  for (const int noslip : {5, 0}) {
    const Model model = hand();
    model->opt.noslip_iterations = noslip;
    const Plugin plugin = plugin_of(model);
    softfinger_mujoco_install(plugin.get());
    const Data data = holding_hand(model);
    ASSERT_EQ(data->ncon, 4);
    const double height_m = data->qpos[2];
    for (int i = 0; i < 30000; ++i) mj_step(model.get(), data.get());
    const double sunk_m = height_m - data->qpos[2];
    const double load_N = data->efc_force[data->contact[0].efc_address];
    std::printf("  noslip_iterations %d: the glass sinks %.3g mm in 60 s, %.3g N a finger\n",
                noslip, 1e3 * sunk_m, load_N);
    EXPECT_EQ(data->ncon, 4);
    if (noslip > 0) {
      EXPECT_LT(std::abs(sunk_m), 1e-4);
    } else {
      // A friction row at rest has a_ref = -R f, with a_ref = -B v: its contact slides at R f/B.
      const int row = data->contact[0].efc_address + 1;
      const double force_N = std::hypot(data->efc_force[row], data->efc_force[row + 1]);
      const double creep_m_per_s = data->efc_R[row] * force_N / data->efc_KBIP[4 * row + 1];
      EXPECT_NEAR(sunk_m / 60 / creep_m_per_s, 1, 0.05) << "the grip changes while the glass sinks";
    }
  }
}

}  // namespace softfinger::tests
