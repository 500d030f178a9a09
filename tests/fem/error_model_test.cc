#include "fem/levels/error_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "fem/levels/friction_levels.h"

namespace softfinger::fem {
namespace {

/// Every expected value below is written as a formula of literal numbers: a constant that moves in
/// the solver's tables has to be moved here too, with its reason.
constexpr double round_off = 1e-14;

/// Errors of linear elasticity with eight elements: those with four, times 1/2 to the fourth power.
constexpr double coarse_edge = 2e-3 / 16, coarse_area = 4e-3 / 16, coarse_peak = 5e-3 / 16,
                 coarse_integral = 5e-4 / 16;

constexpr double h = 2e-3;

/// A level's result. Its semi-axes are such that the error terms of thin layers and of long
/// contacts are negligible.
LevelResult level(int elements) {
  LevelResult result;
  result.elements_per_semi_axis = elements;
  result.a_m = result.b_m = 1e-3 * h;
  result.area_m2 = M_PI * result.a_m * result.b_m;
  result.indentation_m = 1e-3;
  result.peak_pressure_Pa = 1e4;
  result.load_N = 2;
  result.max_torque_Nm = 3e-3;
  return result;
}

ErrorSetting setting() {
  ErrorSetting result;
  result.thickness_m = h;
  return result;
}

RelativeError of_levels(const ErrorTable& table, const LevelResult& coarse,
                        const LevelResult& fine) {
  return error_of_levels(table, coarse, fine, setting());
}

/// A coarser level with the very same answer.
LevelResult coarser(LevelResult level) {
  level.elements_per_semi_axis /= 2;
  return level;
}

RelativeError of_agreeing_levels(const ErrorTable& table, const LevelResult& fine) {
  return of_levels(table, coarser(fine), fine);
}

TEST(ErrorModel, LevelsThatAgreeStateWhatBothMiss) {
  const RelativeError linear = of_levels(linear_elasticity, level(4), level(8));
  // 0.2 (cell/h)³ h/b of the unresolved edge, b = 1e-3 h.
  const double edge = 0.2 * std::pow(1e-3 / 8, 3) / 1e-3;
  EXPECT_NEAR(linear.a, 1e-3 + coarse_edge + edge, round_off);
  EXPECT_NEAR(linear.b, 1e-3 + coarse_edge + edge, round_off);
  EXPECT_NEAR(linear.area, 1e-3 + coarse_area + 2 * edge, round_off);
  EXPECT_NEAR(linear.peak_pressure, 2e-3 + coarse_peak, round_off);
  EXPECT_NEAR(linear.indentation, 1e-4 + coarse_integral, round_off);
  EXPECT_NEAR(linear.load, 1e-4 + coarse_integral, round_off);
  EXPECT_NEAR(linear.max_torque, 1e-4 + coarse_integral, round_off);
  const RelativeError finite = of_levels(finite_strain, level(4), level(8));
  // The error with eight elements is a quarter of that with four.
  EXPECT_NEAR(finite.a, 1e-3 + 6e-3 / 4, round_off);
  EXPECT_NEAR(finite.b, 1e-3 + 6e-3 / 4, round_off);
  EXPECT_NEAR(finite.area, 2e-3 + 1e-2 / 4, round_off);
  EXPECT_NEAR(finite.peak_pressure, 4e-3, round_off);
  EXPECT_NEAR(finite.indentation, 1e-4 + 2e-4 / 4, round_off);
  EXPECT_NEAR(finite.load, 1e-4 + 2e-4 / 4, round_off);
  EXPECT_NEAR(finite.max_torque, 1e-4 + 2e-4 / 4, round_off);
}

/// A quantity of a level, its error and the order that this is extrapolated with.
struct Order {
  const char* name;
  double LevelResult::*quantity;
  double RelativeError::*error;
  double order;
};
const Order orders[] = {
    {"a", &LevelResult::a_m, &RelativeError::a, 1},
    {"b", &LevelResult::b_m, &RelativeError::b, 1},
    {"area", &LevelResult::area_m2, &RelativeError::area, 1},
    {"peak", &LevelResult::peak_pressure_Pa, &RelativeError::peak_pressure, 1},
    {"d", &LevelResult::indentation_m, &RelativeError::indentation, 1.6},
    {"load", &LevelResult::load_N, &RelativeError::load, 1.6},
    {"torque", &LevelResult::max_torque_Nm, &RelativeError::max_torque, 1.6},
};

TEST(ErrorModel, DifferenceOfTheLevelsIsExtrapolatedWithItsOrder) {
  for (const ErrorTable& table : {linear_elasticity, finite_strain})
    for (const Order& each : orders)
      for (const int coarse_elements : {4, 6}) {
        const RelativeError same = of_levels(table, level(coarse_elements), level(8));
        for (const double off : {-0.01, 0.01}) {
          LevelResult coarse = level(coarse_elements);
          coarse.*each.quantity *= 1 + off;
          const RelativeError error = of_levels(table, coarse, level(8));
          EXPECT_NEAR(error.*each.error - same.*each.error,
                      0.01 / (std::pow(8.0 / coarse_elements, each.order) - 1), round_off)
              << each.name;
          for (const Order& other : orders) {
            if (other.error == each.error) continue;
            EXPECT_EQ(error.*other.error, same.*other.error) << each.name << " in " << other.name;
          }
        }
      }
}

TEST(ErrorModel, LongContactsLoseInTheCellsAwayFromThem) {
  const auto away = [](const ErrorTable& table, double a, double b) {
    LevelResult fine = level(8);
    fine.a_m = a * h;
    fine.b_m = b * h;
    return of_agreeing_levels(table, fine);
  };
  const double small = away(linear_elasticity, 0.08, 0.02).indentation;  // s = 0.04
  const double larger = away(linear_elasticity, 0.8, 0.2).indentation;   // s = 0.4
  EXPECT_NEAR(small, 1e-4 + coarse_integral + 6e-4, round_off);
  EXPECT_NEAR(larger, 1e-4 + coarse_integral + 6e-4 * 0.1 / 0.4, round_off);
  EXPECT_NEAR(away(linear_elasticity, 0.1, 0.1).indentation, 1e-4 + coarse_integral, round_off)
      << "a circle";
  EXPECT_NEAR(away(linear_elasticity, 0.0101, 0.01).indentation, 1e-4 + coarse_integral, round_off)
      << "nearly a circle";
  EXPECT_NEAR(away(linear_elasticity, 0.0103, 0.01).indentation, 7e-4 + coarse_integral, round_off);
  const RelativeError error = away(linear_elasticity, 0.08, 0.02);
  EXPECT_NEAR(error.load, 1e-4 + coarse_integral, round_off);
  EXPECT_NEAR(error.max_torque, 1e-4 + coarse_integral, round_off);
  EXPECT_NEAR(away(finite_strain, 0.08, 0.02).indentation, 1e-4 + 2e-4 / 4, round_off)
      << "not measured there";
}

TEST(ErrorModel, ThinLayersLeaveTheEdgeUnresolved) {
  LevelResult fine = level(24);
  fine.a_m = fine.b_m = 20 * h;
  const double cell = 20.0 / 24, edge = 0.2 * cell * cell * cell / 20;
  EXPECT_GT(edge, 0.003) << "measured at cells of 0.8 h, b = 20 h";
  const RelativeError error = of_agreeing_levels(linear_elasticity, fine);
  const double coarse = std::pow(4.0 / 24, 4);
  EXPECT_NEAR(error.a, 1e-3 + 2e-3 * coarse + edge, round_off);
  EXPECT_NEAR(error.b, 1e-3 + 2e-3 * coarse + edge, round_off);
  EXPECT_NEAR(error.area, 1e-3 + 4e-3 * coarse + 2 * edge, round_off);
  EXPECT_NEAR(error.indentation, 1e-4 + 5e-4 * coarse, round_off);
  EXPECT_NEAR(of_agreeing_levels(finite_strain, fine).a, 1e-3 + 6e-3 / 36, round_off)
      << "not measured there";
  fine.oversize = 1.001;  // of a mesh whose cells are larger by that
  EXPECT_NEAR(of_agreeing_levels(linear_elasticity, fine).a,
              1e-3 + 2e-3 * coarse + edge * std::pow(1.001, 3), round_off);
}

TEST(ErrorModel, EdgeAcrossTheCellsOfALargerContactsMeshCosts) {
  LevelResult fine = level(12);
  fine.oversize = 1.5;
  const double crossed = 1;  // cells of an eighth of the semi-axis: 12 along 1.5 of it
  EXPECT_NEAR(crossed_cells(fine), crossed, round_off);
  const RelativeError own = of_levels(linear_elasticity, level(6), level(12));
  const RelativeError shared = of_levels(linear_elasticity, level(6), fine);
  // The cells are larger, and the edge is resolved less.
  const double resolved = 0.2 * std::pow(1e-3 / 12, 3) / 1e-3;
  const double edge = resolved * (std::pow(1.5, 3) - 1);
  EXPECT_NEAR(shared.a - own.a, 1.5e-3 + edge, round_off);
  EXPECT_NEAR(shared.b - own.b, 1.5e-3 + edge, round_off);
  EXPECT_NEAR(shared.area - own.area, 1.5e-3 + 2 * edge, round_off);
  EXPECT_NEAR(shared.peak_pressure - own.peak_pressure, 2e-3, round_off);
  EXPECT_NEAR(shared.indentation - own.indentation, 2e-4, round_off);
  EXPECT_NEAR(shared.load - own.load, 2e-4, round_off);
  EXPECT_NEAR(shared.max_torque - own.max_torque, 2e-4, round_off);
  fine.elements_per_semi_axis = 6;
  EXPECT_NEAR(crossed_cells(fine), 4, round_off) << "it goes with the cell's square";
}

TEST(ErrorModel, ContactOfTheMeshsOwnSizeHasItsEdgeOnCellEdges) {
  LevelResult fine = level(8);
  for (const double oversize : {1.0, 1.0019, 1 / 1.0019}) {
    fine.oversize = oversize;
    EXPECT_EQ(crossed_cells(fine), 0) << oversize;
  }
  for (const double oversize : {1.0021, 1 / 1.0021}) {
    fine.oversize = oversize;
    EXPECT_GT(crossed_cells(fine), 0) << oversize;
  }
}

/// Returns the amount that a change of the setting adds to each error.
RelativeError added(const ErrorTable& table, const LevelResult& fine,
                    const std::function<void(ErrorSetting&)>& change) {
  ErrorSetting changed = setting();
  change(changed);
  const RelativeError before = error_of_contact(table, coarser(fine), fine, setting());
  RelativeError result = error_of_contact(table, coarser(fine), fine, changed);
  for (const auto error :
       {&RelativeError::a, &RelativeError::b, &RelativeError::area, &RelativeError::indentation,
        &RelativeError::peak_pressure, &RelativeError::max_torque, &RelativeError::load})
    result.*error -= before.*error;
  return result;
}

/// A contact of a/b = 2 with cells of b/6, whose edge is that of the nodes.
LevelResult outlined(int elements) {
  LevelResult result = level(elements);
  result.b_m /= 2;
  result.area_m2 /= 2;
  result.cell_m = result.b_m / (0.75 * elements);
  return result;
}

RelativeError of_outlines(const ErrorTable& table, const LevelResult& coarse,
                          const LevelResult& fine) {
  ErrorSetting whole = setting();
  whole.fitted = false;
  return error_of_contact(table, coarse, fine, whole);
}

TEST(ErrorModel, OutlineOfTheNodesIsKnownToAShareOfACell) {
  const double resolved = 0.2 * std::pow(0.5e-3 / 8, 3) / 0.5e-3;  // as above
  for (const ErrorTable& table : {linear_elasticity, finite_strain}) {
    const double edge = table.unresolved_edge > 0 ? resolved : 0;
    const RelativeError error = of_outlines(table, outlined(4), outlined(8));
    EXPECT_NEAR(error.a, 0.034 / 12 + edge, round_off);
    EXPECT_NEAR(error.b, 0.034 / 6 + edge, round_off);
    EXPECT_NEAR(error.area, 2 * 0.021 / (6 * std::sqrt(2)) + 2 * edge, round_off);
    EXPECT_EQ(error.indentation, of_agreeing_levels(table, outlined(8)).indentation);
    EXPECT_EQ(error.max_torque, of_agreeing_levels(table, outlined(8)).max_torque);
  }
  // On a user's mesh about as many elements lie along b as were asked for.
  LevelResult fine = outlined(8);
  fine.cell_m = 0;
  EXPECT_NEAR(of_outlines(finite_strain, coarser(fine), fine).b, 0.034 / 8, round_off);
}

TEST(ErrorModel, OutlinesThatDifferByTheirScatterSayNothing) {
  const double scatter = 0.034 / 6, of_both = scatter * std::sqrt(5);  // the coarse cell is twice
  const auto b_where_coarse_is_off = [](double off) {
    LevelResult coarse = outlined(4);
    coarse.b_m *= 1 + off;
    coarse.cell_m *= 1 + off;  // its share of b stays
    return of_outlines(finite_strain, coarse, outlined(8)).b;
  };
  for (const double sign : {-1, 1}) {
    EXPECT_NEAR(b_where_coarse_is_off(sign * 0.99 * of_both), scatter, round_off);
    EXPECT_NEAR(b_where_coarse_is_off(sign * (of_both + 0.01)), scatter + 0.01, round_off);
  }
}

TEST(ErrorModel, AShareOfTheSideWallsCorrectionIsStated) {
  const RelativeError error = added(linear_elasticity, level(8), [](ErrorSetting& setting) {
    setting.approach_given = true;  // so that the load has an error
    setting.wall = {0.001, -0.002, 0.003, 0, 0.004, -0.005, 0.006};
  });
  EXPECT_NEAR(error.a, 0.4 * 0.001, round_off);
  EXPECT_NEAR(error.b, 0.4 * 0.002, round_off);
  EXPECT_NEAR(error.area, 0.4 * 0.003, round_off);
  EXPECT_NEAR(error.peak_pressure, 0.4 * 0.004, round_off);
  EXPECT_NEAR(error.max_torque, 0.4 * 0.005, round_off);
  EXPECT_NEAR(error.load, 1e-4 + coarse_integral + 0.4 * 0.006, round_off);
}

TEST(ErrorModel, RoundedEdgesMoveTheApproachAndItsLoadTwiceAsMuch) {
  LevelResult fine = level(8);
  fine.indentation_m = 0.1 * h;
  const auto rounded = [](ErrorSetting& setting) { setting.rounded_edges = true; };
  EXPECT_NEAR(added(finite_strain, fine, rounded).indentation, 5e-4 / 0.1, round_off);
  ErrorSetting by_approach = setting();
  by_approach.approach_given = by_approach.rounded_edges = true;
  const RelativeError error = error_of_contact(finite_strain, coarser(fine), fine, by_approach);
  EXPECT_NEAR(error.load, 1e-4 + 2e-4 / 4 + 2 * 5e-4 / 0.1, round_off);
}

TEST(ErrorModel, WhatIsGivenHasNoError) {
  LevelResult coarse = level(4);
  coarse.load_N *= 1.1;
  coarse.indentation_m *= 1.1;
  ErrorSetting given = setting();
  EXPECT_EQ(error_of_contact(linear_elasticity, coarse, level(8), given).load, 0);
  EXPECT_GT(error_of_contact(linear_elasticity, coarse, level(8), given).indentation, 0.01);
  given.approach_given = true;
  EXPECT_GT(error_of_contact(linear_elasticity, coarse, level(8), given).load, 0.01);
  EXPECT_EQ(error_of_contact(linear_elasticity, coarse, level(8), given).indentation, 0);
}

TEST(ErrorModel, AnswerOnALargerContactsMeshIsUsefulUpToAnEighthOfACell) {
  const double known = 1.0 / (8 * 10);
  RelativeError most;
  most.a = most.b = known;
  most.indentation = most.max_torque = known / 5;
  EXPECT_TRUE(is_useful(most, 10));
  EXPECT_FALSE(is_useful(most, 11));
  for (const auto error : {&RelativeError::a, &RelativeError::b, &RelativeError::indentation,
                           &RelativeError::max_torque}) {
    RelativeError more = most;
    more.*error *= 1.001;
    EXPECT_FALSE(is_useful(more, 10));
  }
}

TEST(ErrorModel, StuckStiffnessIsExtrapolatedAndTheWholeCorrectionStated) {
  const double correction = (3.0 - 3.3) / (std::pow(2, 1.45) - 1);
  const ExtrapolatedStiffness stiffness = extrapolated_stiffness(3.3, 3.0, 2, 8);
  EXPECT_NEAR(stiffness.value, 3 + correction, 3 * round_off);
  // The error with eight elements is a quarter of that of coarse levels.
  EXPECT_NEAR(stiffness.error, -correction / 3 + 1e-3 + 5.2e-2 / 4, round_off);
}

TEST(ErrorModel, StuckEdgeBetweenNodesIsKnownToAQuarterOfACell) {
  const double unknown = 0.75 / 8;
  // The third power of the radius: three times a quarter of a cell.
  const auto linear = [](bool symmetric, bool ours, double misfit) {
    return stuck_edge_error(linear_elasticity, 8, symmetric, ours, misfit);
  };
  EXPECT_EQ(linear(true, true, 0.07), 0) << "the extrapolation's correction covers it";
  EXPECT_EQ(linear(false, true, 0.07), 0);
  EXPECT_EQ(linear(false, false, 0), unknown) << "a user's mesh";
  const auto finite = [](bool symmetric, bool ours, double misfit) {
    return stuck_edge_error(finite_strain, 8, symmetric, ours, misfit);
  };
  EXPECT_EQ(finite(true, true, 1.9e-3), 0);
  EXPECT_EQ(finite(true, true, 2.1e-3), unknown);
  EXPECT_EQ(finite(false, true, 0), unknown);
  EXPECT_EQ(finite(false, false, 0), unknown);
}

class FrictionErrors : public testing::Test {
 protected:
  FrictionErrors() {
    problem.contact = {{0.02, 0.02, 0}, {1, 1, 0.4}, {2, 0.5}};  // mu P = 1, units of the model
    problem.friction.torsion = true;
    result.finest.elements_per_semi_axis = 8;
    result.finest.load_N = 2;
    result.finest.max_torque_Nm = 4;
    result.finest.max_force_N = 1;  // mu P
    for (FrictionOfLevel* of_level : {&coarse, &fine}) {
      of_level->stiffness = 10;
      of_level->full_slip = 4;
      of_level->twist = {{{0, 0, 0.1}, {0, 0, 1}, 0, 1}, {{0, 0, 0.2}, {0, 0, 2}, 0.5, 1}};
      of_level->limit_surface = {{{1, 0, 0}, {1, 0, 0}, 1, 1}, {{0, 0, 1}, {0, 0, 4}, 1, 1}};
    }
  }
  void state() {
    result.limit_surface.clear();
    state_friction(coarse, fine, 2, problem, result);
  }
  Problem problem;
  FrictionOfLevel coarse, fine;
  Result result;
  const double weight = 1 / (std::pow(2, 1.6) - 1), common = 2e-4;
};

TEST_F(FrictionErrors, OfLevelsThatAgreeAreWhatBothMiss) {
  state();
  EXPECT_NEAR(result.torsion->stiffness_error, 1e-3 + 5.2e-2 / 4, round_off);
  EXPECT_NEAR(result.torsion->full_slip_error, common, round_off);
  EXPECT_NEAR(result.torsion->curve_error, common, round_off);
  EXPECT_NEAR(result.limit_surface_error, common, round_off);
}

TEST_F(FrictionErrors, AreTheLargestDifferenceThroughTheTwistAndOverTheLimitSurface) {
  coarse.twist[0].wrench.torque += 0.04;
  coarse.twist[1].wrench.torque -= 0.08;  // 2 % of the torque at full slip
  coarse.full_slip *= 1.01;
  coarse.limit_surface[0].wrench.force_x -= 0.03;  // of mu P = 1
  coarse.limit_surface[1].wrench.force_y += 0.01;
  coarse.limit_surface[1].wrench.torque += 0.08;  // of 4: 2 %
  state();
  EXPECT_NEAR(result.torsion->curve_error, 0.02 * weight + common, round_off);
  EXPECT_NEAR(result.torsion->full_slip_error, 0.01 * weight + common, round_off);
  EXPECT_NEAR(result.limit_surface_error, 0.03 * weight + common, round_off);
  coarse.limit_surface[1].wrench.force_y += 0.04;
  state();
  EXPECT_NEAR(result.limit_surface_error, 0.05 * weight + common, round_off);
  coarse.limit_surface[1].wrench.torque += 0.32;
  state();
  EXPECT_NEAR(result.limit_surface_error, 0.1 * weight + common, round_off);
}

TEST_F(FrictionErrors, ContainWhatThePhysicsNeglects) {
  fine.neglected_of_twist = 0.03;
  fine.neglected_of_full_slip = 0.02;
  fine.neglected_of_slide = 0.05;
  state();
  EXPECT_NEAR(result.torsion->curve_error, common + 0.03, round_off);
  EXPECT_NEAR(result.torsion->full_slip_error, common + 0.02, round_off);
  EXPECT_NEAR(result.torsion->stiffness_error, 1e-3 + 5.2e-2 / 4, round_off)
      << "the start knows nothing of it";
  EXPECT_NEAR(result.limit_surface_error, common + 0.05, round_off);
}

// Linear layers that stick, with nu 0.5 and with 0.4999 (softfinger fem --linear --flat, h 2 mm).
TEST(CompressingError, ContainsTheChangesThatWereMeasured) {
  const struct {
    double s, a, peak, d, torque;
  } measured[] = {{2.386, 2.9e-4, 6.8e-4, 1.17e-3, 1.6e-4},
                  {3.326, 4.6e-4, 1.08e-3, 2.10e-3, 2.4e-4},
                  {4.360, 7.7e-4, 1.75e-3, 3.19e-3, 3.6e-4},
                  {5.900, 1.12e-3, 3.12e-3, 5.31e-3, 5.7e-4}};
  for (const auto& row : measured) {
    LevelResult contact;
    contact.a_m = contact.b_m = 2e-3 * row.s;
    const RelativeError error = error_of_compressing(contact, 2e-3, 1e-4);
    for (const auto& [stated, change] : {std::pair{error.a, row.a},
                                         {error.peak_pressure, row.peak},
                                         {error.indentation, row.d},
                                         {error.max_torque, row.torque}}) {
      EXPECT_GE(stated, change) << row.s;
      EXPECT_LE(stated, 4 * change) << row.s;
    }
  }
}

}  // namespace
}  // namespace softfinger::fem
