#include "fem/levels/level_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

/// A contact of known size whose every quantity converges with the square of the cells: no mesh is
/// made.
class KnownContact : public ContactPhysics {
 public:
  static constexpr double a = 0.5, b = 0.3, error_of_one_cell = 0.08;

  const ErrorTable& error_table() const override { return linear_elasticity; }
  long predicted_unknowns(const LayerDiscretisation&) const override { return 1000; }
  bool shares_meshes() const override { return shares; }
  bool trial_is_level_0() const override { return trial_serves; }

  std::optional<Obstacle> press(const LayerDiscretisation& mesh, int level) override {
    pressed.push_back(mesh);
    levels.push_back(level);
    if (mesh_outside > 0) pressed.back().elements_per_semi_axis = mesh_outside;
    if (shares) pressed.back().elements_per_semi_axis = level == 1 ? 4 : 8;
    if (mesh.patch > patch_that_folds) return FoldedLayer{{"contact", "room", "none", ""}, 0.5};
    if (mesh.elements_per_semi_axis < elements_for_load)
      return NotReached{{"finite strain", 1, 1, "finer cells"}, a, b};
    return std::nullopt;
  }
  RoughSize size() const override {
    const LayerDiscretisation& mesh = pressed.back();
    const bool is_trial = levels.back() == 0;
    // Reports the outline of a few nodes, too large and too small in turn.
    const double told_a = pressed.size() % 2 == 0 ? a * jump : a / jump;
    // At the rim a contact is found no larger than the patch.
    const bool at_rim =
        b > 1.2 * mesh.b || (!is_trial && (outgrows || mesh.patch < patch_for_contact));
    return {std::min(told_a, 1.2 * mesh.a), std::min(b, 1.2 * mesh.b), 0.1, at_rim, 1000, ""};
  }
  PressOther press_other() override {
    return [this](const ContactTask&, const LayerDiscretisation& mesh)
               -> Outcome<std::unique_ptr<ContactPhysics>, Obstacle> {
      walls_clamped_on.push_back(mesh.elements_per_semi_axis);
      auto other = std::make_unique<KnownContact>();
      other->press(mesh, 0);
      other->is_clamped = mesh.clamped_wall;
      return std::unique_ptr<ContactPhysics>(std::move(other));
    };
  }
  const LayerDiscretisation& discretisation() const override { return pressed.back(); }
  std::optional<FoldedLayer> end_beside() const override { return std::nullopt; }
  Outcome<Measurement, Unmeasured> measure() override {
    if (levels.back() > 0 && pressed.back().patch < patch_for_outline)
      return Unmeasured{true, {"outline of the contact", 1, 1, "it leaves the refined patch"}};
    const int elements = pressed.back().elements_per_semi_axis;
    const double off = 1 + error_of_one_cell / (elements * elements);
    Measurement measurement;
    measurement.block_a = a;
    measurement.block_b = b;
    measurement.centre = centre;
    LevelResult& result = measurement.result;
    result.elements_per_semi_axis = elements;
    result.a_m = a * off;
    result.b_m = b * off;
    result.area_m2 = result.area_projected_m2 = M_PI * result.a_m * result.b_m;
    result.fitted = true;
    result.indentation_m = (is_clamped ? 0.98 : 1) * 0.1 * off;
    result.peak_pressure_Pa = off;
    result.max_torque_Nm = result.torque_arm_m = off;
    result.max_force_N = 1;
    result.load_N = 1;
    result.oversize = oversize;
    return measurement;
  }
  FrictionOfLevel friction(std::optional<FrictionPlan>& plan, bool has_room) override {
    planned.push_back(plan.has_value());
    plan.emplace().edge = edge_with_friction;
    if (has_room && pressed.back().patch < patch_for_friction)
      throw EdgeLeftMargin("size of the frictional contact", 1, 1.2, "a larger patch");
    return {};
  }
  std::vector<PressurePoint> pressures() const override {
    return {{0.2, 0, 0.21, 0, 1},
            {0, 0, 0, 0, 3},
            {0.1, 0, 0.11, 0, 2},
            {0, 0.1, 0, 0.12, 1.5},
            {0.1, 0.1, 0.1, 0.1, 9}};
  }
  OutputFiles write_files() override { return {"v", "p"}; }

  bool is_clamped = false, shares = false, trial_serves = true, outgrows = false;
  int mesh_outside = 0;
  double oversize = 1, edge_with_friction = 1, patch_for_friction = 0, patch_for_contact = 0;
  double patch_for_outline = 0;
  double patch_that_folds = std::numeric_limits<double>::infinity();
  int elements_for_load = 0;  ///< fewer do not reach it
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double jump = 1;            ///< of the size that trial meshes tell
  std::vector<bool> planned;  ///< whether there was a plan, each time that friction was asked for
  std::vector<LayerDiscretisation> pressed;
  std::vector<int> levels, walls_clamped_on;
};

class LevelLoop : public testing::Test {
 protected:
  LevelLoop() {
    problem.contact = {{1, 1, 0}, {1, 1, 0.3}, {0.1, 0.5}};
    problem.level = 2;
    pressing.major = pressing.minor = 1;
    pressing.sphere = std::numeric_limits<double>::infinity();
    pressing.load = 0.1;
  }
  std::optional<Result> solve() {
    Outcome<Result, Unsolved> answer = answered();
    return answer ? std::optional(*answer) : std::nullopt;
  }
  Outcome<Result, Unsolved> answered() {
    const Progress progress = [this](const std::string& line) { lines.push_back(line); };
    const StopRequested stop = [this] { return ++questions >= stop_at_question; };
    return solve_on_levels(contact, {problem, pressing, progress, stop});
  }
  Problem problem;
  Pressing pressing;
  KnownContact contact;
  int questions = 0, stop_at_question = 1000;  ///< whether to stop
  std::vector<std::string> lines;
};

TEST_F(LevelLoop, PressesTrialMeshesUntilTheyFitAndThenTwoLevels) {
  const Result result = *solve();
  ASSERT_GE(contact.pressed.size(), 4u) << "the first guess is a circle";
  const std::size_t trials = contact.pressed.size() - 2;
  for (std::size_t i = 0; i < trials; ++i) EXPECT_EQ(contact.levels[i], 0);
  EXPECT_EQ(contact.levels[trials], 1);
  EXPECT_EQ(contact.levels[trials + 1], 2);
  EXPECT_EQ(contact.pressed[trials].elements_per_semi_axis, 4);
  EXPECT_EQ(contact.pressed[trials + 1].elements_per_semi_axis, 8);
  for (std::size_t i = trials; i < contact.pressed.size(); ++i) {
    // Sizes are rounded to one part in a thousand, so that contacts of one size share a mesh.
    EXPECT_NEAR(contact.pressed[i].a, 0.5, 0.5e-3 * 0.5);
    EXPECT_NEAR(contact.pressed[i].b, 0.3, 0.5e-3 * 0.3);
  }
  ASSERT_EQ(result.levels.size(), 2u);
  EXPECT_EQ(result.levels[0].level, 1);
  EXPECT_EQ(result.finest.level, 2);
  EXPECT_FALSE(result.interrupted);
  EXPECT_GE(lines.size(), contact.pressed.size() + 2);
}

TEST_F(LevelLoop, MakesRoomForTheEdgeThatFrictionMoves) {
  problem.friction.limit_surface = 4;
  ASSERT_TRUE(solve());
  const double usual = contact.pressed.back().patch;
  contact.edge_with_friction = 1.5;
  ASSERT_TRUE(solve());
  // A node that touches in the outermost cells would show that the room is too small.
  EXPECT_NEAR(contact.pressed.back().patch, 1.5 + spare_margin / 8, 1e-12);
  EXPECT_GT(contact.pressed.back().patch, usual);
}

TEST_F(LevelLoop, PressesAgainWithMoreRoomWhereFrictionNeedsIt) {
  problem.friction.torsion = true;
  const double usual = LayerDiscretisation().patch;
  contact.patch_for_friction = 1.5 * usual;
  ASSERT_TRUE(solve());
  // 1.3 times the room does not do, its square does; the second level begins with that.
  EXPECT_NEAR(contact.pressed.back().patch, 1.3 * 1.3 * usual, 1e-12);
  EXPECT_EQ(std::count(contact.levels.begin(), contact.levels.end(), 2), 1);
  // The first level makes a plan each time, the second one follows it.
  EXPECT_EQ(contact.planned, (std::vector<bool>{false, false, false, true}));
}

TEST_F(LevelLoop, TakesWhatFrictionToldWhereThereIsNoMoreRoom) {
  problem.friction.torsion = true;
  contact.patch_for_friction = 100;
  ASSERT_TRUE(solve());
  EXPECT_LE(contact.pressed.back().patch, 2.5 * LayerDiscretisation().patch);
  EXPECT_TRUE(contact.planned.back());
}

TEST_F(LevelLoop, AHintOfTheSizeSavesTrialMeshesAndNothingElse) {
  const Result guessed = *solve();
  const auto meshes = contact.pressed.size();
  contact.pressed.clear();
  contact.levels.clear();
  problem.size_hint_m = {KnownContact::a * pressing.thickness_m,
                         KnownContact::b * pressing.thickness_m};
  const Result hinted = *solve();
  EXPECT_LT(contact.pressed.size(), meshes);
  EXPECT_EQ(contact.pressed.size(), 3u) << "a trial mesh and two levels";
  EXPECT_EQ(hinted.finest.a_m, guessed.finest.a_m);
  EXPECT_EQ(hinted.error.a, guessed.error.a);
}

TEST_F(LevelLoop, AHintForWhichTheLayerHasNoRoomIsNotTaken) {
  const auto b_of_first_trial = [&] {
    contact.pressed.clear();
    contact.levels.clear();
    solve();
    return contact.pressed.front().b;
  };
  pressing.fingertip.pad = std::shared_ptr<const meshes::PadSurface>(
      reinterpret_cast<const meshes::PadSurface*>(&problem), [](auto*) {});  // never looked at
  pressing.bent.reach_x = pressing.bent.reach_y = 10;
  const double guessed = b_of_first_trial();
  problem.size_hint_m = {20 * pressing.thickness_m, 20 * pressing.thickness_m};
  EXPECT_EQ(b_of_first_trial(), guessed);
  problem.size_hint_m = {1.1 * pressing.thickness_m, 1.1 * pressing.thickness_m};
  EXPECT_NE(b_of_first_trial(), guessed);
}

TEST_F(LevelLoop, StatesTheErrorOfItsTwoLevels) {
  const Result result = *solve();
  const RelativeError expected =
      error_of_contact(linear_elasticity, result.levels[0], result.levels[1], [] {
        ErrorSetting setting;
        setting.thickness_m = 1;
        return setting;
      }());
  EXPECT_EQ(result.error.a, expected.a);
  EXPECT_EQ(result.error.indentation, expected.indentation);
  EXPECT_EQ(result.error.load, 0) << "given";
  // The true error of the finer level.
  EXPECT_GT(result.error.indentation, 0.08 / 64);
}

TEST_F(LevelLoop, ReportsProfilesAlongTheAxesAndFiles) {
  problem.contact.layer.thickness_m = pressing.thickness_m = 2;
  problem.contact.layer.youngs_modulus_Pa = 10;
  const Result result = *solve();
  EXPECT_EQ(result.along_x.position_m, (std::vector<double>{0, 0.22, 0.42}));
  EXPECT_EQ(result.along_x.pressure_Pa, (std::vector<double>{30, 20, 10}));
  EXPECT_EQ(result.along_y.position_m, (std::vector<double>{0, 0.24}));
  EXPECT_EQ(result.along_y.pressure_Pa, (std::vector<double>{30, 15}));
  EXPECT_EQ(result.vtu_file, "v");
  EXPECT_EQ(result.pvd_file, "p");
  EXPECT_NEAR(result.pressure_exponent,
              result.finest.area_m2 * result.finest.peak_pressure_Pa / result.finest.load_N - 1, 0);
}

TEST_F(LevelLoop, TrialMeshIsLevelZeroWhereThePhysicsSaysSo) {
  problem.level = 1;
  EXPECT_EQ(solve()->levels.front().elements_per_semi_axis, 3);
  const std::size_t with_trial = contact.pressed.size();
  contact = {};
  contact.trial_serves = false;
  EXPECT_EQ(solve()->levels.front().elements_per_semi_axis, 3);
  EXPECT_EQ(contact.pressed.size(), with_trial + 1);
  EXPECT_NEAR(contact.pressed[with_trial - 1].b, 0.3, 0.5e-3 * 0.3)
      << "level 0 fits what the trial found";
}

TEST_F(LevelLoop, MeshFromOutsideIsHalvedForItsSecondLevel) {
  problem.mesh_name = "mesh";
  problem.mesh = std::shared_ptr<const meshes::LayerMesh>(
      reinterpret_cast<const meshes::LayerMesh*>(&problem), [](auto*) {});  // never looked at
  contact.mesh_outside = 10;  // finer than the four of level 1
  const Result result = *solve();
  EXPECT_EQ(result.levels.front().elements_per_semi_axis, 10);
  EXPECT_EQ(lines[lines.size() - 3].substr(0, 20), "level 2: 20 elements");
  EXPECT_EQ(lines[lines.size() - 2], "level 2: the mesh from outside makes 1000 unknowns");
}

TEST_F(LevelLoop, StoppedAfterItsFirstLevelItAnswersWithTheTrialMeshForTheCoarserOne) {
  solve();
  stop_at_question = std::exchange(questions, 0);  // the last one, between the two levels
  contact = {};
  const Result result = *solve();
  EXPECT_TRUE(result.interrupted);
  ASSERT_EQ(result.levels.size(), 2u);
  EXPECT_EQ(result.levels.front().elements_per_semi_axis, 3);
  EXPECT_EQ(result.finest.elements_per_semi_axis, 4);
  EXPECT_TRUE(std::isfinite(result.error.a));
}

TEST_F(LevelLoop, StoppedBeforeAnyLevelItHasNoAnswer) {
  solve();
  const int before_last = questions - 1;
  ASSERT_GE(before_last, 2) << "between trial meshes, and before the first level";
  for (stop_at_question = 1; stop_at_question <= before_last; ++stop_at_question) {
    contact = {};
    questions = 0;
    EXPECT_THROW(solve(), Interrupted) << stop_at_question;
  }
}

TEST_F(LevelLoop, StoppedAfterLevelZeroItHasNothingToCompareWith) {
  // The trial mesh is level 0 itself: two equal levels would state an error of 0/0.
  problem.level = 1;
  solve();
  stop_at_question = std::exchange(questions, 0);
  contact = {};
  EXPECT_THROW(solve(), Interrupted);
  EXPECT_EQ(contact.levels.back(), 0);
}

TEST_F(LevelLoop, ContactAtTheRimGetsAMeshThatIsLargerThanWhatIsSeenOfIt) {
  pressing.load = 1e-6;  // a first guess that is far too small
  solve();
  ASSERT_GE(contact.pressed.size(), 5u);
  // The fake contact is seen up to 1.2 of its mesh's size; sizes are rounded to 0.1 %.
  EXPECT_NEAR(contact.pressed[1].b / contact.pressed[0].b, 1.3 * 1.2, 2e-3);
}

TEST_F(LevelLoop, SizeThatJumpsWithinThePatchesRoomIsKnownWellEnough) {
  const Result known = *solve();
  contact.pressed.clear();
  contact.levels.clear();
  contact.jump = 1.12;
  const std::optional<Result> result = solve();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->finest.a_m, known.finest.a_m);
  EXPECT_GT(contact.pressed.size(), 2u + 4u) << "an agreement was looked for";
}

TEST_F(LevelLoop, ContactThatOutgrowsItsPatchGetsMoreCellsOfTheSameSize) {
  const double usual = LayerDiscretisation().patch;
  contact.patch_for_contact = 1.2 * usual;
  ASSERT_TRUE(solve());
  EXPECT_GE(contact.pressed.back().patch, contact.patch_for_contact);
  EXPECT_NEAR(contact.pressed.back().a, KnownContact::a, 0.5e-3 * KnownContact::a);
  EXPECT_EQ(contact.pressed.back().elements_per_semi_axis, 8);
  contact.patch_for_contact = 2 * usual;
  EXPECT_THROW(solve(), ConvergenceError);
}

TEST_F(LevelLoop, ContactThatOutgrowsItsPatchIsAnError) {
  contact.outgrows = true;
  EXPECT_THROW(solve(), ConvergenceError);
}

TEST_F(LevelLoop, ContactWhoseOutlineLeavesItsPatchGetsALargerOne) {
  const double usual = LayerDiscretisation().patch;
  contact.patch_for_outline = 1.2 * usual;
  ASSERT_TRUE(solve());
  EXPECT_NEAR(contact.pressed.back().patch, 1.3 * usual, 0.1 * usual);
  contact.patch_for_outline = 2 * usual;
  EXPECT_THROW(solve(), ConvergenceError) << "it grows once";
}

TEST_F(LevelLoop, LayerThatFoldsIsNoAnswerAndNoError) {
  contact.patch_that_folds = 0;
  const Outcome<Result, Unsolved> answer = answered();
  ASSERT_FALSE(answer);
  ASSERT_TRUE(std::holds_alternative<FoldedLayer>(answer.reason()));
  EXPECT_EQ(std::get<FoldedLayer>(answer.reason()).fits, 0.5);
}

TEST_F(LevelLoop, LayerThatFoldsOnlyUnderALargerPatchIsNoAnswerEither) {
  const double usual = LayerDiscretisation().patch;
  contact.patch_for_contact = 1.2 * usual;
  contact.patch_that_folds = 1.2 * usual;
  const Outcome<Result, Unsolved> answer = answered();
  ASSERT_FALSE(answer);
  EXPECT_TRUE(std::holds_alternative<FoldedLayer>(answer.reason()));
}

TEST_F(LevelLoop, LoadThatCoarseCellsDoNotBearGetsFinerOnes) {
  // Trial meshes have three elements, levels four and eight.
  contact.elements_for_load = 6;
  ASSERT_TRUE(solve());
  EXPECT_EQ(contact.pressed.back().elements_per_semi_axis, 16) << "both levels are finer";
  contact.elements_for_load = 100;
  EXPECT_THROW(solve(), ConvergenceError);
}

TEST_F(LevelLoop, FrictionTurnsAboutThePressuresCentre) {
  contact.centre = {0.1, 0.05};
  EXPECT_TRUE(solve()) << "without friction any coordinates do";
  problem.friction.torsion = true;
  pressing.bent.shape = std::shared_ptr<const LayerShape>(
      reinterpret_cast<const LayerShape*>(&problem), [](auto*) {});  // never looked at
  const Outcome<Result, Unsolved> answer = answered();
  ASSERT_FALSE(answer);
  ASSERT_TRUE(std::holds_alternative<OffCentre>(answer.reason()));
  EXPECT_EQ(std::get<OffCentre>(answer.reason()).centre, contact.centre);
  pressing.bent.centre = contact.centre;
  pressing.bent.shape = nullptr;
  EXPECT_TRUE(solve()) << "coordinates that begin elsewhere already are kept";
}

TEST_F(LevelLoop, SharedMeshesThatDoNotServeAreNoAnswer) {
  contact.shares = true;
  contact.oversize = 1.01;
  const std::optional<Result> served = solve();
  ASSERT_TRUE(served);
  EXPECT_EQ(contact.levels, (std::vector<int>{1, 1, 2})) << "no trial mesh";
  contact = {};
  contact.shares = true;
  contact.oversize = 3;  // cells nine times as bad
  EXPECT_FALSE(solve());
  contact = {};
  contact.shares = contact.outgrows = true;
  EXPECT_FALSE(solve()) << "too small for the contact";
}

TEST(ShareThatFits, IsTheLargestToAThousandth) {
  for (const double largest : {0.0, 0.3, 0.9995}) {
    const double share = share_that_fits([&](double tried) { return tried <= largest; });
    EXPECT_LE(share, largest);
    EXPECT_GT(share, largest - 1e-3);
  }
}

// One trial mesh is enough where mesh and contact agree to 8 %.
TEST(FirstGuess, IsNearlyTheRadiusOfARoundContact) {
  constexpr double of_fit = 0.023, of_bisection = 0.01;
  // P R / (E* a³) of a paraboloid on a bonded layer, by its integral equation to 1e-8.
  constexpr struct {
    double nu, s, load;
  } exact[] = {{0, 0.1, 1.3338586323},  {0, 1, 1.5999455780},    {0, 2, 2.2591075523},
               {0, 5, 4.5405413130},    {0.3, 2, 2.5052722713},  {0.45, 1, 1.8017613522},
               {0.45, 2, 3.0344837728}, {0.45, 5, 8.3189606241}, {0.4999, 1, 1.880}};
  for (const auto& contact : exact) {
    Pressing pressing;
    pressing.poisson_ratio = contact.nu;
    pressing.major = pressing.minor = 100;
    pressing.sphere = std::numeric_limits<double>::infinity();
    pressing.load = contact.load * std::pow(contact.s, 3) / 100 / (1 - contact.nu * contact.nu);
    const LayerDiscretisation guess = first_guess(pressing);
    EXPECT_NEAR(guess.a / contact.s, 1, of_fit + of_bisection) << contact.nu << " " << contact.s;
    EXPECT_EQ(guess.a, guess.b);
  }
}

}  // namespace
}  // namespace softfinger::fem
