#include "comparisons/judgement/pad_comparison.h"

#include <gtest/gtest.h>

#include <utility>

namespace softfinger {
namespace {

constexpr double kPadTolerance = 0.1;

input::Case pad_to_compare(const std::string& load_N = "20") {
  return input::parse_case(
      "id = \"pad\"\n[geometry]\nfinger = { pad_mm = [22, 37.5] }\nobject = { flat = true }\n"
      "[layer]\nthickness_mm = 3\nyoungs_modulus_kPa = 800\npoisson_ratio = 0.49\n[contact]\n"
      "load_N = " +
          load_N + "\nfriction_coefficient = 0.9\n",
      "pad.toml", {}, input::FlatPads::taken);
}

/// Elements whose numbers are pad_layer's, but for the given factors.
reference::PadSolution elements_like_pad_layer(const input::Case& contact_case, double load_N,
                                               double torque_factor = 1,
                                               double stiffness_factor = 1) {
  const PadShape shape(std::get<input::PadPair>(contact_case.geometry).contact);
  const PadPrediction p =
      prediction::ask_pad_model(*find_pad_model("pad_layer"), contact_case, shape, load_N, {}, 0)
          .prediction;
  reference::PadElements elements;
  elements.load_N = load_N;
  elements.indentation_m = p.indentation_m / stiffness_factor;
  elements.normal_stiffness_N_per_m = p.normal_stiffness_N_per_m * stiffness_factor;
  elements.area_m2 = shape.outline().area_m2();
  elements.peak_pressure_Pa = p.peak_pressure_Pa;
  elements.pressure_arm_m = p.pressure_arm_m;
  elements.eccentricity_m = p.eccentricity_m * torque_factor;
  elements.max_torque_Nm = 0.9 * load_N * elements.eccentricity_m;
  elements.tilt_stiffness_Nm_per_rad = p.tilt_stiffness_Nm_per_rad;
  elements.error.indentation = elements.error.max_torque = 1e-3;
  // Nodes on both lines through the middle, and one beside them.
  elements.pressure = {
      {-0.011, 0.0, 0.011, 0.0, 0.005}, {0.0, 0.0, 0.0, 0.018, 0.005}, {1, 2, 3, 4, 5}};
  return {elements, "", 0};
}

}  // namespace

TEST(PadComparison, HasTheErrorsOfTheModelsAgainstTheElements) {
  const input::Case contact_case = pad_to_compare();
  const judgement::PadCaseComparison compared = judgement::compare_pad(
      contact_case, {elements_like_pad_layer(contact_case, 20, 1 / 1.02, 1 / 0.99)}, kPadTolerance);
  const judgement::PadComparison& load = compared.loads[0];
  const judgement::PadModelErrors& errors = *load.models[0].errors;
  EXPECT_NEAR(errors.max_torque, 0.02, 1e-12);
  EXPECT_NEAR(errors.normal_stiffness, -0.01, 1e-12);
  EXPECT_NEAR(errors.indentation, 1 / 0.99 - 1, 1e-12);
  EXPECT_NEAR(errors.pressure_arm, 0, 1e-12);
  EXPECT_NEAR(errors.tilt_stiffness, 0, 1e-12);
  EXPECT_EQ(load.models[0].judgement, judgement::Judgement::usable);
  EXPECT_EQ(load.models[1].judgement, judgement::Judgement::off) << "uniform: 17 % too much";
  EXPECT_EQ(load.along_x.position_m, (std::vector<double>{-0.011, 0, 0.011}));
  EXPECT_EQ(load.along_x.pressure_Pa, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(load.along_y.pressure_Pa, (std::vector<double>{2, 4}));
  // Profiles go from edge to edge, and are symmetric.
  const reference::PressureProfile& profile = *load.models[0].along_x;
  EXPECT_NEAR(profile.position_m.front(), -0.011, 1e-6);
  EXPECT_NEAR(profile.position_m.back(), 0.011, 1e-6);
  EXPECT_NEAR(profile.pressure_Pa.front() / profile.pressure_Pa.back(), 1, 1e-6);
  EXPECT_EQ(compared.verdict.verdict_class, judgement::VerdictClass::good);
  EXPECT_EQ(compared.verdict.sentence.rfind("Use the default, Pad layer (torque within 2 %, "
                                            "pressing and tilting within 1 %; ",
                                            0),
            0u)
      << compared.verdict.sentence;
  EXPECT_NE(compared.verdict.sentence.find("; Pad uniform is off by +20 % in torque, +"),
            std::string::npos)
      << compared.verdict.sentence;
}

/// Elements state the approach where the load acts: d + tilt times its distance from the middle.
TEST(PadComparison, ComparesTheApproachWhereTheLoadActs) {
  input::Case contact_case = pad_to_compare();
  auto& pair = std::get<input::PadPair>(contact_case.geometry);
  pair.load_at_m = Eigen::Vector2d(1e-3, 2e-3);
  const PadShape shape(pair.contact);
  const prediction::PadAnswer answer =
      prediction::ask_pad_model(*find_pad_model("pad_layer"), contact_case, shape, 20, {}, 0);
  EXPECT_GT(indentation_at_load_m(answer), answer.prediction.indentation_m);
  // Work: a load off the middle goes down by the compliance of the approach and of both tilts.
  const double tilts = 20 * (2e-3 * 2e-3 / answer.prediction.tilt_stiffness_Nm_per_rad[0] +
                             1e-3 * 1e-3 / answer.prediction.tilt_stiffness_Nm_per_rad[1]);
  EXPECT_NEAR(indentation_at_load_m(answer),
              20 / answer.prediction.normal_stiffness_N_per_m + tilts,
              1e-4 * indentation_at_load_m(answer));
}

TEST(PadVerdict, SaysAtWhichLoadsNoModelHolds) {
  // 1800 N compress the pad by more than a tenth: no bound is known there.
  const input::Case contact_case = pad_to_compare("[20, 1800, 2000]");
  reference::PadSolution failed;
  failed.failure = "out of memory";
  const judgement::Verdict verdict =
      judgement::compare_pad(contact_case,
                             {elements_like_pad_layer(contact_case, 20),
                              elements_like_pad_layer(contact_case, 1800), std::move(failed)},
                             kPadTolerance)
          .verdict;
  EXPECT_EQ(verdict.verdict_class, judgement::VerdictClass::mixed);
  for (const char* words :
       {"Use the default, Pad layer (torque within 0.1 %",
        ") at 20 N; no model can be relied on at "
        "1800 N: nearest is Pad layer, off by ",
        "which states no bound there; ask the finite elements there; FEM failed at 2000 N."})
    EXPECT_NE(verdict.sentence.find(words), std::string::npos) << verdict.sentence;
}

TEST(PadVerdict, NamesASecondModelThatWillDo) {
  input::Case foam = pad_to_compare();
  foam.layer.poisson_ratio = 0;
  const judgement::Verdict verdict =
      judgement::compare_pad(foam, {elements_like_pad_layer(foam, 20)}, kPadTolerance).verdict;
  EXPECT_NE(verdict.sentence.find("; Pad uniform will do, too (torque within 0.1 %"),
            std::string::npos)
      << verdict.sentence;
}

TEST(PadVerdict, IsBadWhereTheTorqueIsOff) {
  const input::Case contact_case = pad_to_compare();
  const auto verdict_of = [&](double factor) {
    return judgement::compare_pad(contact_case, {elements_like_pad_layer(contact_case, 20, factor)},
                                  kPadTolerance)
        .verdict;
  };
  EXPECT_EQ(verdict_of(0.7).verdict_class, judgement::VerdictClass::bad);
  EXPECT_EQ(verdict_of(0.7).sentence.rfind("No model can be relied on at 20 N: ", 0), 0u);
  // pad_uniform's torque, by accident the better one here.
  EXPECT_NE(verdict_of(1.17).sentence.find("Use Pad uniform ("), std::string::npos)
      << verdict_of(1.17).sentence;
}

TEST(PadVerdict, NamesElementsThatCannotBeTrusted) {
  const input::Case contact_case = pad_to_compare();
  reference::PadSolution coarse = elements_like_pad_layer(contact_case, 20);
  coarse.elements->error.max_torque = 0.05;
  const judgement::PadCaseComparison compared =
      judgement::compare_pad(contact_case, {coarse}, kPadTolerance);
  EXPECT_NE(compared.verdict.sentence.find("the FEM's own error is too large at 20 N"),
            std::string::npos)
      << compared.verdict.sentence;
}

TEST(PadElementsReader, BelievesNoResultThatLacksANumber) {
  EXPECT_FALSE(reference::read_pad_elements(nullptr).elements);
  EXPECT_EQ(reference::read_pad_elements({{"load_N", 1}}).flaw,
            "indentation_m is not a finite number");
  EXPECT_EQ(reference::read_pad_elements({{"load_N", -1}}).flaw, "load_N is not positive");
}

}  // namespace softfinger
