// Models beside a reference whose numbers are set by hand: what is compared with what, and what a
// report says of it.
#include "comparisons/judgement/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "comparisons/judgement/scoring.h"
#include "comparisons/suite/suite_report.h"
#include "softfinger/friction/max_torque.h"

namespace softfinger {
namespace {

using judgement::Comparison;
using judgement::ModelComparison;
using nlohmann::json;
using prediction::TorqueRule;
using reference::ReferenceResult;

/// An elongated contact: the two torque rules differ.
const input::Case& elongated() {
  static const input::Case contact_case = input::parse_case(
      "id = \"long\"\n[geometry]\nrelative_radii_mm = [40, 5]\n"
      "[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\npoisson_ratio = 0.4\n"
      "[contact]\nload_N = [1.0, 2.0]\nfriction_coefficient = 0.8\npressing = \"frictionless\"\n",
      "long.toml");
  return contact_case;
}

/// Each number a model's own, moved by a factor of its own.
constexpr double kInclined = 1.015, kMovedA = 1.01, kMovedB = 1.02, kMovedArea = 1.03,
                 kMovedDepth = 1.04, kMovedPeak = 1.05, kMovedTorque = 1.06;

json document_near(const Prediction& prediction, double load_N) {
  const double torque_Nm = 0.8 * load_N * prediction.torque_arm_exact_m * kMovedTorque;
  const json level = {{"a_m", 1e-3},           {"b_m", 1e-3},
                      {"indentation_m", 1e-4}, {"peak_pressure_Pa", 1e3},
                      {"max_torque_Nm", 1e-3}, {"cpu_s", 1}};
  const json profile = {{"position_m", {0.0, 1e-3}}, {"pressure_Pa", {1.0, nullptr}}};
  return {{"load_N", load_N},
          {"a_m", prediction.a_m * kMovedA},
          {"b_m", prediction.b_m * kMovedB},
          {"axis_rad", 0.1},
          {"indentation_m", prediction.indentation_m * kMovedDepth},
          {"peak_pressure_Pa", prediction.peak_pressure_Pa * kMovedPeak},
          {"area_projected_m2", prediction.area_m2() * kMovedArea},
          {"area_m2", prediction.area_m2() * kMovedArea * kInclined},
          {"max_torque_Nm", torque_Nm},
          {"eccentricity_m", torque_Nm / (0.8 * load_N)},
          {"error",
           {{"a", 0.001},
            {"b", 0.002},
            {"indentation", 0.003},
            {"area", 0.004},
            {"peak_pressure", 0.005},
            {"max_torque", 0.006}}},
          {"levels", json::array({level})},
          {"profile_x", profile},
          {"profile_y", profile},
          {"vtu", "/somewhere/else/solution.vtu"},
          {"wall_s", 1.5},
          {"cpu_s", 2.5},
          {"peak_memory_MB", 100}};
}

ReferenceResult reference_near(const Prediction& prediction, double load_N) {
  return *reference::read_reference_result(document_near(prediction, load_N)).result;
}

prediction::LocalGeometry geometry() {
  return prediction::GeometryResolver(elongated()).resolve(1.0);
}

Prediction bonded_layer(double load_N) {
  return find_pressure_model("bonded_layer")
      ->predict(elongated().problem(geometry().radii, load_N));
}

Comparison compared(double load_N) {
  return judgement::compare(elongated(), geometry(), load_N,
                            reference_near(bonded_layer(load_N), load_N), "");
}

const ModelComparison& model(const Comparison& comparison, const std::string& name) {
  const auto found = std::find_if(
      comparison.models.begin(), comparison.models.end(),
      [&](const ModelComparison& one) { return one.answer.model->card().name == name; });
  EXPECT_NE(found, comparison.models.end()) << name;
  return *found;
}

suite::SuiteComparison suite_of(std::vector<Comparison> loads) {
  suite::SuiteComparison suite;
  suite.tolerance = 0.1;
  suite.command = "test";
  suite.cases.push_back(judgement::compare_case(elongated(), std::move(loads), suite.tolerance));
  return suite;
}

Comparison failed(double load_N) {
  return judgement::compare(elongated(), geometry(), load_N, std::nullopt, "no convergence");
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> found(1);
  for (const char letter : line)
    if (letter == ',')
      found.emplace_back();
    else
      found.back() += letter;
  return found;
}

}  // namespace

TEST(Comparison, MeasuresEachQuantityAgainstItsOwn) {
  const Comparison load = compared(1);
  const auto& errors = model(load, "bonded_layer").errors;
  ASSERT_TRUE(errors);
  // A few roundings of a division and a subtraction.
  EXPECT_NEAR(errors->a, 1 / kMovedA - 1, 1e-14);
  EXPECT_NEAR(errors->b, 1 / kMovedB - 1, 1e-14);
  EXPECT_NEAR(errors->area, 1 / kMovedArea - 1, 1e-14);
  EXPECT_NEAR(errors->indentation, 1 / kMovedDepth - 1, 1e-14);
  EXPECT_NEAR(errors->peak_pressure, 1 / kMovedPeak - 1, 1e-14);
  EXPECT_NEAR(errors->max_torque, 1 / kMovedTorque - 1, 1e-14);
  const double paper_over_exact =
      bonded_layer(1).torque_arm_paper_m / bonded_layer(1).torque_arm_exact_m;
  EXPECT_GT(std::abs(paper_over_exact - 1), 1e-3) << "the rules have to differ for this test";
  EXPECT_NEAR(errors->max_torque_paper, paper_over_exact / kMovedTorque - 1, 1e-14);
}

TEST(Comparison, HasNoErrorsWithoutAReference) {
  const Comparison load = failed(1);
  EXPECT_FALSE(load.size());
  for (const ModelComparison& one : load.models) EXPECT_FALSE(one.errors);
  const judgement::LoadErrors errors = judgement::errors_of(load);
  EXPECT_FALSE(errors.fem_finished);
  EXPECT_FALSE(errors.fem_trusted);
  EXPECT_EQ(errors.fem_failure, "no convergence");
  for (const judgement::ModelError& one : errors.models) EXPECT_TRUE(std::isnan(one.larger()));
}

TEST(Comparison, AsksModelsOfFiniteStrainOnlyBesideFiniteStrain) {
  for (const ModelComparison& one : compared(1).models)
    EXPECT_FALSE(one.answer.model->card().finite_strain);
  EXPECT_GE(compared(1).models.size(), 5u);
}

TEST(Comparison, DrawsPressuresFromTheCentreToTheEdge) {
  const Comparison load = compared(1);
  const ModelComparison& one = model(load, "bonded_layer");
  ASSERT_TRUE(one.along_x && one.along_y);
  EXPECT_EQ(one.along_x->position_m.front(), 0);
  EXPECT_NEAR(one.along_x->position_m.back(), one.answer.prediction.a_m, 1e-15);
  EXPECT_NEAR(one.along_y->position_m.back(), one.answer.prediction.b_m, 1e-15);
  EXPECT_NEAR(one.along_x->pressure_Pa.front() / one.answer.prediction.peak_pressure_Pa, 1, 1e-12);
}

TEST(Comparison, ErrorsCarryWhatVerdictsNeed) {
  const judgement::LoadErrors errors = judgement::errors_of(compared(2));
  EXPECT_EQ(errors.load_N, 2);
  EXPECT_TRUE(errors.fem_finished);
  EXPECT_TRUE(errors.fem_trusted);
  EXPECT_EQ(errors.stated.max_torque, 0.006);
  ASSERT_TRUE(errors.size);
  const Prediction layer = bonded_layer(2);
  EXPECT_NEAR(*errors.size, std::sqrt(layer.a_m * kMovedA * layer.b_m * kMovedB) / 2e-3, 1e-12);
  for (const judgement::ModelError& one : errors.models) {
    if (one.model == "bonded_layer") {
      const double worst = std::max(
          {std::abs(1 / kMovedA - 1), std::abs(1 / kMovedB - 1), std::abs(1 / kMovedArea - 1)});
      EXPECT_NEAR(std::abs(one.contact), worst, 1e-14) << "the largest of a, b and area";
      EXPECT_NEAR(one.max_torque, 1 / kMovedTorque - 1, 1e-14);
      EXPECT_TRUE(one.has_answer && one.hot_path && one.applicable);
      EXPECT_EQ(one.sound, layer.valid()) << "nothing fails that a linear reference measures";
    }
    EXPECT_EQ(one.applicable, one.model != "power_law") << "nobody gave it data";
    EXPECT_EQ(one.hot_path, find_pressure_model(one.model)->card().hot_path);
  }
}

TEST(Comparison, DoesNotTrustAReferenceOfLargeStatedError) {
  Comparison load = compared(2);
  load.reference->error.max_torque = 0.2;
  EXPECT_FALSE(judgement::errors_of(load).fem_trusted);
}

TEST(ReferenceResult, ReadsEachNumberFromItsKey) {
  const Prediction layer = bonded_layer(1);
  const ReferenceResult result = reference_near(layer, 1);
  EXPECT_EQ(result.load_N, 1);
  EXPECT_EQ(result.a_m, layer.a_m * kMovedA);
  EXPECT_EQ(result.b_m, layer.b_m * kMovedB);
  EXPECT_EQ(result.axis_rad, 0.1);
  EXPECT_EQ(result.indentation_m, layer.indentation_m * kMovedDepth);
  EXPECT_EQ(result.peak_pressure_Pa, layer.peak_pressure_Pa * kMovedPeak);
  EXPECT_EQ(result.area_projected_m2, layer.area_m2() * kMovedArea);
  EXPECT_EQ(result.area_m2, layer.area_m2() * kMovedArea * kInclined);
  EXPECT_EQ(result.eccentricity_m, result.max_torque_Nm / 0.8);
  EXPECT_EQ(result.error.a, 0.001);
  EXPECT_EQ(result.error.b, 0.002);
  EXPECT_EQ(result.error.indentation, 0.003);
  EXPECT_EQ(result.error.area, 0.004);
  EXPECT_EQ(result.error.peak_pressure, 0.005);
  EXPECT_EQ(result.error.max_torque, 0.006);
  EXPECT_FALSE(result.error.limit_surface);
  EXPECT_EQ(result.wall_s, 1.5);
  EXPECT_EQ(result.cpu_s, 2.5);
  EXPECT_EQ(result.peak_memory_MB, 100);
  EXPECT_FALSE(result.coarse);
  EXPECT_FALSE(result.twist);
  ASSERT_EQ(result.levels.size(), 1u);
  EXPECT_EQ(result.levels[0].max_torque_Nm, 1e-3);
  EXPECT_TRUE(std::isnan(result.along_x.pressure_Pa[1]));
}

TEST(ReferenceResult, ReadsFrictionWhereItWasAskedFor) {
  json document = document_near(bonded_layer(1), 1);
  document["torsion"] = {{{"angle_rad", 0.1}, {"torque_Nm", 2e-3}, {"slip_fraction", 0.25}}};
  document["torsional_stiffness_Nm_per_rad"] = 0.02;
  document["torque_full_slip_Nm"] = 3e-3;
  document["limit_surface"] = {{{"fx_N", 0.1}, {"fy_N", 0.2}, {"torque_Nm", 4e-3}}};
  document["error"]["torsional_stiffness"] = 0.01;
  document["error"]["torque_full_slip"] = 0.02;
  document["error"]["torsion"] = 0.03;
  document["error"]["limit_surface"] = 0.04;
  document["coarse"] = true;
  const auto read = reference::read_reference_result(document);
  ASSERT_TRUE(read.result) << read.flaw;
  ASSERT_TRUE(read.result->twist);
  EXPECT_EQ(read.result->twist->stiffness_Nm_per_rad, 0.02);
  EXPECT_EQ(read.result->twist->full_slip_torque_Nm, 3e-3);
  ASSERT_EQ(read.result->twist->states.size(), 1u);
  EXPECT_EQ(read.result->twist->states[0].angle_rad, 0.1);
  EXPECT_EQ(read.result->twist->states[0].torque_Nm, 2e-3);
  EXPECT_EQ(read.result->twist->states[0].slip_fraction, 0.25);
  ASSERT_EQ(read.result->limit_surface.size(), 1u);
  EXPECT_EQ(read.result->limit_surface[0].force_y_N, 0.2);
  EXPECT_EQ(read.result->error.torsional_stiffness, 0.01);
  EXPECT_EQ(read.result->error.full_slip_torque, 0.02);
  EXPECT_EQ(read.result->error.torsion_curve, 0.03);
  EXPECT_EQ(read.result->error.limit_surface, 0.04);
  EXPECT_TRUE(read.result->coarse);
}

TEST(ReferenceResult, SaysWhatKeepsItFromBeingBelieved) {
  const json good = document_near(bonded_layer(1), 1);
  const std::vector<std::pair<json, std::string>> damages = {
      {{{"load_N", 0}}, "load_N = 0"},
      {{{"max_torque_Nm", nullptr}}, "max_torque_Nm is missing"},
      {{{"error", {{"max_torque", "small"}}}}, "the error of max_torque is missing"},
      {{{"error", {{"b", -0.5}}}}, "the error of b = -0.5"},
      {{{"error", {{"area", -0.5}}}}, "the error of area = -0.5"},
      {{{"levels", json::array()}}, "levels is missing"},
      {{{"levels", json::array({3})}}, "a level is no JSON object"},
      {{{"profile_y", {{"position_m", {0.0}}}}}, "profile_y is incomplete"},
      {{{"profile_x", 1}}, "profile_x is missing"},
      {{{"limit_surface", json::array({1})}}, "limit_surface is no list of objects"}};
  for (const auto& [damage, flaw] : damages) {
    json damaged = good;
    damaged.merge_patch(damage);
    const auto read = reference::read_reference_result(damaged);
    EXPECT_FALSE(read.result) << flaw;
    EXPECT_EQ(read.flaw, flaw);
  }
  EXPECT_EQ(reference::read_reference_result(json::array()).flaw, "no JSON object");
}

TEST(TrustLimits, BoundEachOfTheFourErrors) {
  const auto is_trusted = [](double a, double b, double indentation, double torque) {
    reference::ReferenceErrors error;
    error.a = a;
    error.b = b;
    error.indentation = indentation;
    error.max_torque = torque;
    return reference::are_elements_trusted(error);
  };
  EXPECT_TRUE(is_trusted(0.02, 0.02, 0.01, 0.01));
  EXPECT_FALSE(is_trusted(0.0201, 0.02, 0.01, 0.01));
  EXPECT_FALSE(is_trusted(0.02, 0.0201, 0.01, 0.01));
  EXPECT_FALSE(is_trusted(0.02, 0.02, 0.0101, 0.01));
  EXPECT_FALSE(is_trusted(0.02, 0.02, 0.01, 0.0101));
  EXPECT_FALSE(is_trusted(0, 0, 0, NAN));
  EXPECT_FALSE(reference::are_elements_trusted({})) << "errors that are not stated";
  EXPECT_EQ(reference::trust_limits_in_words(), "2 % in a and b, 1 % in indentation and torque");
}

TEST(TrustLimits, CountWhatAScanLeavesOpen) {
  reference::ReferenceResult result;
  result.error.a = result.error.b = result.error.indentation = result.error.max_torque = 0.001;
  EXPECT_TRUE(reference::is_trusted(result));
  EXPECT_EQ(reference::largest_geometry_error(result), 0) << "exact bodies";
  reference::ReferenceErrors& open = result.geometry_error.emplace();
  open.a = open.b = open.area = open.max_torque = 0.1;
  EXPECT_TRUE(reference::is_trusted(result));
  open.area = 0.23;
  EXPECT_EQ(reference::largest_geometry_error(result), 0.23);
  EXPECT_FALSE(reference::is_trusted(result));
  EXPECT_TRUE(reference::are_elements_trusted(result.error)) << "finer ones do not help";
  result.geometry_error.reset();
  result.is_geometry_unknown = true;
  EXPECT_FALSE(reference::is_trusted(result));
}

TEST(SuiteReport, PrintsTheExactTorqueAndThePapersBesideIt) {
  const suite::SuiteComparison suite = suite_of({compared(1)});
  const json report = suite::report_json(suite);
  const Prediction layer = bonded_layer(1);
  const json& load = report["cases"][0]["loads"][0];
  for (const json& one : load["models"]) {
    if (one["model"] != "bonded_layer") continue;
    EXPECT_DOUBLE_EQ(one["max_torque_Nm"].get<double>(), 0.8 * layer.torque_arm_exact_m);
    EXPECT_DOUBLE_EQ(one["max_torque_paper_Nm"].get<double>(), 0.8 * layer.torque_arm_paper_m);
    EXPECT_NEAR(one["relative_error"]["max_torque"].get<double>(), 1 / kMovedTorque - 1, 1e-14);
    EXPECT_NE(one["relative_error"]["max_torque_paper"], one["relative_error"]["max_torque"]);
    EXPECT_EQ(one["profile_x"]["position_m"].size(), 61u);
  }
  EXPECT_EQ(load["fem"]["trusted"], true);
  EXPECT_EQ(load["fem"]["vtu"], "fem/long_1N/solution.vtu") << "links are relative to the page";
  EXPECT_DOUBLE_EQ(load["geometry"]["s"], *suite.cases[0].loads[0].size());
  EXPECT_EQ(load["geometry"]["radii_m"], json({40e-3, 5e-3}));
  EXPECT_EQ(report["tolerance"], 0.1);
  EXPECT_EQ(report["provenance"]["peak_memory_MB"], 100);
}

TEST(SuiteReport, SaysWhyAReferenceIsMissing) {
  const suite::SuiteComparison suite = suite_of({compared(1), failed(2)});
  EXPECT_FALSE(suite::is_trusted_everywhere(suite));
  EXPECT_TRUE(suite::is_trusted_everywhere(suite_of({compared(1)})));
  const json load = suite::report_json(suite)["cases"][0]["loads"][1];
  EXPECT_TRUE(load["fem"].is_null());
  EXPECT_EQ(load["fem_failure"], "no convergence");
  EXPECT_TRUE(load["geometry"]["s"].is_null());
}

TEST(SuiteReport, TheTableHasACellForEachColumn) {
  const suite::SuiteComparison suite = suite_of({compared(1), failed(2)});
  std::istringstream csv(suite::results_csv(suite));
  std::string line;
  std::getline(csv, line);
  const std::vector<std::string> head = cells(line);
  const auto column = [&](const std::string& name) {
    return std::size_t(std::find(head.begin(), head.end(), name) - head.begin());
  };
  const Prediction layer = bonded_layer(1);
  std::size_t rows = 0;
  while (std::getline(csv, line)) {
    ++rows;
    const std::vector<std::string> row = cells(line);
    ASSERT_EQ(row.size(), head.size()) << line;
    if (row[column("load_N")] != "1.0") continue;
    const auto number = [&](const char* name) { return std::stod(row[column(name)]); };
    if (row[column("model")] == "fem") {
      EXPECT_EQ(row[column("usable")], "yes");
      EXPECT_DOUBLE_EQ(number("area_projected_m2"), layer.area_m2() * kMovedArea);
      EXPECT_DOUBLE_EQ(number("area_m2"), layer.area_m2() * kMovedArea * kInclined);
      EXPECT_DOUBLE_EQ(number("stated_error_peak_pressure"), 0.005);
      EXPECT_DOUBLE_EQ(number("stated_error_max_torque"), 0.006);
      EXPECT_DOUBLE_EQ(number("wall_s"), 1.5);
      EXPECT_EQ(row[column("relative_error_a")], "");
      EXPECT_EQ(row[column("max_torque_paper_Nm")], "");
    }
    if (row[column("model")] == "bonded_layer") {
      EXPECT_DOUBLE_EQ(number("indentation_m"), layer.indentation_m);
      EXPECT_DOUBLE_EQ(number("max_torque_Nm"), 0.8 * layer.torque_arm_exact_m);
      EXPECT_DOUBLE_EQ(number("max_torque_paper_Nm"), 0.8 * layer.torque_arm_paper_m);
      EXPECT_NEAR(number("relative_error_indentation"), 1 / kMovedDepth - 1, 1e-14);
      EXPECT_NEAR(number("relative_error_max_torque"), 1 / kMovedTorque - 1, 1e-14);
      EXPECT_EQ(row[column("stated_error_a")], "");
      EXPECT_EQ(row[column("wall_s")], "");
      EXPECT_GT(number("cost_ns"), 0);
    }
  }
  EXPECT_EQ(rows, 1 + 2 * compared(1).models.size());
}

TEST(Scoring, TakesTheLargerOfTheTwoErrors) {
  judgement::LoadErrors load;
  load.load_N = 3;
  load.fem_finished = true;
  judgement::ModelError one{"hertz", true, true, -0.04, 0.02};
  EXPECT_DOUBLE_EQ(judgement::score(load, one)->error, 0.04);
  EXPECT_EQ(judgement::score(load, one)->quantity, prediction::Quantity::area);
  EXPECT_EQ(judgement::score(load, one)->load_N, 3);
  one.max_torque = -0.05;
  EXPECT_EQ(judgement::score(load, one)->quantity, prediction::Quantity::max_torque);
  EXPECT_DOUBLE_EQ(one.larger(), 0.05);
  one.set_contact(0.01, -0.07, 0.03);
  EXPECT_EQ(judgement::score(load, one)->quantity, prediction::Quantity::b);
  EXPECT_DOUBLE_EQ(one.larger(), 0.07);
  one.set_contact(0.01, NAN, 0.03);
  EXPECT_TRUE(std::isnan(one.larger()));
  one.contact = 0;
  one.max_torque = NAN;
  EXPECT_TRUE(std::isnan(one.larger()));
  one.has_answer = false;
  EXPECT_FALSE(judgement::score(load, one));
  one.has_answer = true;
  load.fem_finished = false;
  EXPECT_FALSE(judgement::score(load, one));
}

TEST(Scoring, PrefersAModelThatClaimsToHoldOverABetterAccident) {
  judgement::LoadErrors load;
  load.fem_finished = true;
  load.models = {{"accident", true, false, 0.01, 0.01},
                 {"sound", true, true, 0.05, 0.05},
                 {"wrong", true, true, 0.5, 0.5}};
  judgement::CaseErrors errors;
  errors.loads = {load};
  const auto best = judgement::best_model(errors, 0.1);
  ASSERT_TRUE(best);
  EXPECT_EQ(best->model, "sound");
  errors.loads[0].models[1].sound = false;
  EXPECT_EQ(judgement::best_model(errors, 0.1)->model, "accident");
  const auto summary = judgement::reference_summary({errors}, 0.1);
  EXPECT_EQ(summary.solved, 1);
  EXPECT_EQ(summary.trusted, 0);
  EXPECT_EQ(summary.without_usable_model, 1);
}

}  // namespace softfinger
