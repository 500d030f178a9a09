#include "fem/levels/scan_readings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fem/algebra/cholesky.h"
#include "fem/base/threads.h"

namespace softfinger::fem {
namespace {

/// A contact of size 1 that a perturbed scan (`Reading`) changes by the share `change`: no mesh is
/// made.
class ReadContact : public ContactPhysics {
 public:
  explicit ReadContact(double change, LayerDiscretisation mesh) : change_(change), mesh_(mesh) {}

  const ErrorTable& error_table() const override { return linear_elasticity; }
  long predicted_unknowns(const LayerDiscretisation&) const override { return 0; }
  bool trial_is_level_0() const override { return true; }
  std::optional<Obstacle> press(const LayerDiscretisation& mesh, int) override {
    mesh_ = mesh;
    return std::nullopt;
  }
  RoughSize size() const override { return {1 + change_, 1 + change_, 0.1, false, 0, ""}; }
  std::optional<FoldedLayer> end_beside() const override { return std::nullopt; }
  PressOther press_other() override { return {}; }
  const LayerDiscretisation& discretisation() const override { return mesh_; }
  Outcome<Measurement, Unmeasured> measure() override {
    if (size().a > 1.1 * mesh_.a)
      return Unmeasured{true, {"outline of the contact", 1, 1, "it leaves the refined patch"}};
    Measurement measurement;
    LevelResult& result = measurement.result;
    // The sign of a change says nothing.
    result.a_m = 1 + change_;
    result.b_m = 1 - change_;
    result.area_projected_m2 = 1 + 2 * change_;
    result.indentation_m = result.peak_pressure_Pa = result.max_torque_Nm = 1 + change_;
    result.load_N = 1;
    return measurement;
  }
  FrictionOfLevel friction(std::optional<FrictionPlan>&, bool) override { return {}; }
  std::vector<PressurePoint> pressures() const override { return {}; }
  OutputFiles write_files() override { return {}; }

 private:
  double change_;
  LayerDiscretisation mesh_;
};

/// Effect of one kind of perturbed scan at its full perturbation.
struct Effect {
  double change = 0;    ///< of the contact, in proportion to the part of the perturbation
  double folds_at = 2;  ///< part of the perturbation from which on the layer folds
};

class ScanReadings : public testing::Test {
 protected:
  ScanReadings() {
    pressing.bent.own_normal = Eigen::Vector3d(0.1, 0, 1).normalized();
    best.a_m = best.b_m = best.area_projected_m2 = best.indentation_m = best.peak_pressure_Pa = 1;
    best.max_torque_Nm = best.load_N = 1;
  }

  /// Returns the effect of a perturbed scan, and the part of its full perturbation that it has.
  std::pair<Effect, double> effect_of(const Reading& reading, CoreWays ways) const {
    if (reading.doubt > 0) return {moved.at(reading.pattern - 1), reading.doubt};
    if (reading.smoothing > 1) return {smoother, (reading.smoothing - 1) / 0.5};
    if (reading.normal) return {held, 1};
    return {of_ways[static_cast<std::size_t>(ways)], 1};
  }

  ReadingStart start() {
    ReadingStart start{{},
                       {},
                       best,
                       OrderedProgress([this](const std::string& line) { lines.push_back(line); }),
                       {}};
    start.mesh.a = start.mesh.b = 1;
    start.shape = [this](const Reading& reading, CoreWays ways) {
      read.push_back(reading);
      ways_read.push_back(ways);
      const auto [effect, part] = effect_of(reading, ways);
      FingertipShape shape;
      // The reaches carry the effect of the perturbed scan to the fake contact.
      shape.reach_x = part * effect.change;
      shape.reach_y = part >= effect.folds_at ? 1 : 0;
      return shape;
    };
    start.press = [this](const ContactTask& task, const LayerDiscretisation& mesh)
        -> Outcome<std::unique_ptr<ContactPhysics>, Obstacle> {
      if (is_out_of_memory) throw NotEnoughMemory("factor", "memory", "", "");
      const FingertipShape& shape = task.pressing.bent;
      if (shape.reach_y > 0)
        return Obstacle(FoldedLayer{InputError("contact", "room", "none", "less")});
      return std::unique_ptr<ContactPhysics>(std::make_unique<ReadContact>(shape.reach_x, mesh));
    };
    return start;
  }
  std::optional<RelativeError> geometry() {
    return geometry_error(start(), {problem, pressing, quiet, stop});
  }
  Outcome<RelativeError, FoldedLayer> core() {
    return core_error(start(), {problem, pressing, quiet, stop});
  }

  const ThreadLimit one_thread{1};  ///< what is read is recorded
  const Progress quiet = [](const std::string&) {};
  const StopRequested stop = [this] { return is_stopped; };
  Problem problem;
  Pressing pressing;
  LevelResult best;
  std::vector<Effect> moved{{1e-3, 2}, {2e-3, 2}, {3e-3, 2}, {4e-3, 2}};  ///< by pattern
  Effect smoother, held;
  Effect of_ways[4];
  bool is_out_of_memory = false, is_stopped = false;
  std::vector<Reading> read;
  std::vector<CoreWays> ways_read;
  std::vector<std::string> lines;
};

RelativeError change_of(double share) {
  RelativeError change;
  change.a = share;
  return change;
}

TEST(LeftOpen, IsStudentsIntervalOfTheKnownSamples) {
  const auto stated = [](const Changes& random) { return left_open(random, {})->a; };
  EXPECT_NEAR(stated({change_of(0.01)}), 12.706 * 0.01, 1e-12);
  EXPECT_NEAR(stated({change_of(0.03), change_of(0.04)}), 4.303 * 0.05 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(stated({change_of(0.03), std::nullopt, change_of(0.04)}), 4.303 * 0.05 / std::sqrt(2),
              1e-12)
      << "a sample that is not known does not count";
  EXPECT_NEAR(stated({change_of(1), change_of(1), change_of(1), change_of(1)}), 2.776, 1e-12);
}

TEST(LeftOpen, AddsTheNormOfSystematicChanges) {
  const RelativeError stated = *left_open({change_of(0)}, {change_of(0.3), change_of(0.4)});
  EXPECT_NEAR(stated.a, 0.5, 1e-12);
  EXPECT_EQ(stated.b, 0);
}

TEST(LeftOpen, IsNotKnownWithoutASample) {
  EXPECT_FALSE(left_open({}, {change_of(0.1)}));
  EXPECT_FALSE(left_open({std::nullopt, std::nullopt}, {change_of(0.1)}));
}

TEST_F(ScanReadings, MoveVerticesInTwoPatternsWhereTheyTellLittle) {
  const RelativeError stated = *geometry();
  const double random = 4.303 * std::hypot(1e-3, 2e-3) / std::sqrt(2);
  EXPECT_NEAR(stated.a, random, 1e-12);
  EXPECT_NEAR(stated.b, random, 1e-12) << "a change counts whatever its sign";
  EXPECT_NEAR(stated.area, 2 * random, 1e-12);
  ASSERT_EQ(read.size(), 3u) << "two patterns, and once smoother";
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].pattern, i + 1);
    EXPECT_EQ(read[i].doubt, 1);
    ASSERT_TRUE(read[i].normal);
    EXPECT_EQ(*read[i].normal, pressing.bent.own_normal) << "which moved vertices would turn";
  }
  EXPECT_EQ(read[2].smoothing, 1.5);
  EXPECT_EQ(read[2].doubt, 0);
}

TEST_F(ScanReadings, MoveThemInTwoMorePatternsWhereTheyTellMuch) {
  for (Effect& effect : moved) effect.change *= 10;
  const RelativeError stated = *geometry();
  const double norm = std::sqrt(1 + 4 + 9 + 16.) * 1e-2;
  EXPECT_NEAR(stated.a, 2.776 * norm / 2, 1e-12);
  ASSERT_EQ(read.size(), 5u);
  EXPECT_EQ(read[3].pattern, 3u);
  EXPECT_EQ(read[4].pattern, 4u);
}

TEST_F(ScanReadings, ThatAreSmootherAreStatedWhole) {
  smoother.change = 5e-3;
  EXPECT_NEAR(geometry()->a, 4.303 * std::hypot(1e-3, 2e-3) / std::sqrt(2) + 5e-3, 1e-12);
}

TEST_F(ScanReadings, TurnTheFrameByTheShareThatTheContactDidNotAskFor) {
  problem.fingertip.region_excess = 1;
  held.change = 4e-3;
  smoother.change = 3e-3;
  const RelativeError stated = *geometry();
  EXPECT_NEAR(stated.a, 4.303 * std::hypot(1e-3, 2e-3) / std::sqrt(2) + 5e-3, 1e-12);
  ASSERT_EQ(read.size(), 4u);
  ASSERT_TRUE(read[3].normal);
  // All of the area: held by the frame's own normal.
  EXPECT_NEAR((*read[3].normal - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-12);
}

TEST_F(ScanReadings, WhoseLayerFoldsMakeLessOfTheirChange) {
  const double whole = geometry()->a;
  read.clear();
  moved[0].folds_at = 0.6;
  const RelativeError stated = *geometry();
  EXPECT_NEAR(stated.a, whole, 1e-12) << "half of the change counts twice";
  EXPECT_EQ(read[1].doubt, 0.5);
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(),
                          [](const std::string& line) {
                            return line.find("cannot be pressed") != std::string::npos;
                          }),
            1);
}

TEST_F(ScanReadings, OfAllVerticesThatFoldLeaveTheOthersToTell) {
  moved[0].folds_at = 0;
  moved[1].change = 4e-3;  // 12.7 times that is more than 3 %
  EXPECT_NEAR(geometry()->a, 3.182 * std::sqrt(16 + 9 + 16.) * 1e-3 / std::sqrt(3.), 1e-12)
      << "one sample's factor is so large that two more are taken: three are known";
}

TEST_F(ScanReadings, StateNothingWhereASystematicChangeIsNotKnown) {
  smoother.folds_at = 0;
  EXPECT_FALSE(geometry());
  EXPECT_EQ(std::count_if(read.begin(), read.end(),
                          [](const Reading& reading) { return reading.pattern > 2; }),
            0)
      << "more random samples would not replace it";
}

TEST_F(ScanReadings, StateNothingWhereAllFold) {
  for (Effect& effect : moved) effect.folds_at = 0;
  EXPECT_FALSE(geometry());
}

TEST_F(ScanReadings, BesideThePatchGetALargerMesh) {
  moved[0].change = 0.3;
  EXPECT_TRUE(geometry()) << "1.3 times the size does not fit on a mesh for 1";
}

TEST_F(ScanReadings, ThatTakeTooMuchMemoryEndTheContact) {
  is_out_of_memory = true;
  EXPECT_THROW(geometry(), NotEnoughMemory);
}

TEST_F(ScanReadings, AreNotMadeOnceTheWorkIsStopped) {
  is_stopped = true;
  EXPECT_FALSE(geometry());
  EXPECT_TRUE(read.empty());
}

TEST_F(ScanReadings, OfACoreWithoutARidgeAreNotMade) {
  EXPECT_EQ(core()->a, 0);
  EXPECT_TRUE(read.empty());
}

TEST_F(ScanReadings, OfACoreWithARidgeStateTheLargestChange) {
  pressing.bent.ways = CoreWays::eroded;
  of_ways[static_cast<std::size_t>(CoreWays::eroded_nearer)].change = 0.02;
  of_ways[static_cast<std::size_t>(CoreWays::eroded_smoother)].change = 0.05;
  of_ways[static_cast<std::size_t>(CoreWays::smoothed)].folds_at = 0;
  EXPECT_NEAR(core()->a, 0.05, 1e-12);
  EXPECT_EQ(ways_read, (std::vector<CoreWays>{CoreWays::eroded_nearer, CoreWays::eroded_smoother,
                                              CoreWays::smoothed}));
}

TEST_F(ScanReadings, OfACoreThatNoOtherWaysBearAreAReasonToRefuse) {
  pressing.bent.ways = CoreWays::eroded;
  for (Effect& effect : of_ways) effect.folds_at = 0;
  EXPECT_FALSE(core());
  is_stopped = true;
  EXPECT_TRUE(core()) << "they were not tried";
}

}  // namespace
}  // namespace softfinger::fem
