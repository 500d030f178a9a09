#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include "comparisons/experiments/examine.h"
#include "comparisons/experiments/experiments_report.h"
#include "comparisons/experiments/hardness_relations.h"
#include "comparisons/system/files.h"
#include "softfinger/input/errors.h"

namespace softfinger::experiments {
namespace {

std::string data_set_text(const std::string& name) {
  return system::read_text_file(std::filesystem::path(SOFTFINGER_EXPERIMENTS) / (name + ".toml"));
}

Examined examined(const std::string& name) {
  return examine(parse_experiment(data_set_text(name), name + ".toml"));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  try {
    parse_experiment(text, "set.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

const Inferred& inferred(const Examined& one, const std::string& name, const std::string& condition,
                         const std::string& reading = "") {
  for (const Inferred& number : one.inferred)
    if (number.name == name && number.condition == condition && number.reading == reading)
      return number;
  throw std::out_of_range(name + ", " + condition);
}

const Finding& finding(const Examined& one, const std::string& test, const std::string& model) {
  for (const Finding& found : one.findings)
    if (found.test.rfind(test, 0) == 0 && found.model == model) return found;
  throw std::out_of_range(test + ", " + model);
}

// Values computed independently of this program.
TEST(Experiments, InferTheThicknessAndModulusOfThePad) {
  const Examined pad = examined("suntouch_v3");
  constexpr double kAskedFor = 0.02;
  struct Expected {
    const char *condition, *reading;
    double thickness_m, modulus_Pa;
  };
  for (const Expected& expected :
       {Expected{"matched at 3 N, nu 0.45", "coefficient is the radius", 3.17e-3, 223e3},
        Expected{"matched at 3 N, nu 0.49", "coefficient is the radius", 3.85e-3, 235e3},
        Expected{"matched at 3 N, nu 0.5", "coefficient is the radius", 4.03e-3, 237e3},
        Expected{"matched at 3 N, nu 0.49", "coefficient is from torques", 4.28e-3, 171e3}}) {
    const Inferred& h = inferred(pad, "thickness", expected.condition, expected.reading);
    const Inferred& E = inferred(pad, "youngs_modulus", expected.condition, expected.reading);
    EXPECT_NEAR(h.value.value, expected.thickness_m, kAskedFor * expected.thickness_m)
        << expected.condition;
    EXPECT_NEAR(E.value.value, expected.modulus_Pa, kAskedFor * expected.modulus_Pa)
        << expected.condition;
    EXPECT_LT(E.value.low, E.value.value);
    EXPECT_GT(E.value.high, E.value.value);
  }
  // An exponent of ± 0.005 is said to move h by 12 %, a rounded number.
  const Interval h =
      inferred(pad, "thickness", "matched at 3 N, nu 0.49", "coefficient is the radius").value;
  EXPECT_NEAR(h.high / h.value - 1, 0.12, 0.015);
  EXPECT_NEAR(1 - h.low / h.value, 0.12, 0.015);
}

TEST(Experiments, ReadTheSizeOfTwoFingersFromTheirExponents) {
  // "a/h = 1.4 to 1.5", of the exponents 0.259 and 0.257.
  EXPECT_NEAR(
      inferred(examined("suntouch_v3"), "size_over_thickness", "of the exponent 0.2569, nu 0.49")
          .value.value,
      1.5, 0.01);
  EXPECT_NEAR(
      inferred(examined("xydas_kao_1999"), "size_over_thickness", "of the exponent 0.259, nu 0.49")
          .value.value,
      1.43, 0.01);
}

TEST(Experiments, HaveTheirVerdicts) {
  const std::map<std::string, Verdict> expected = {
      {"suntouch_v3", Verdict::fails},
      {"suntouch_2019_sets", Verdict::cannot_tell},
      {"xydas_kao_1999", Verdict::agrees},
      {"waltersson_2024_in_hand", Verdict::cannot_tell},
      {"gelsight_golf_ball", Verdict::agrees},
      {"gelsight_gel_hardness", Verdict::fails},
      {"pawluk_howe_1999", Verdict::agrees},
      {"kinoshita_1997", Verdict::fails},
      {"trejo_2017", Verdict::fails},
      {"sahli_2018", Verdict::fails},
      {"silicones_tension", Verdict::fails},
      {"bonded_disc_1959", Verdict::cannot_tell},
      {"fingertips_measured", Verdict::cannot_tell}};
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SOFTFINGER_EXPERIMENTS)) {
    if (entry.path().extension() != ".toml") continue;
    ++files;
    const std::string name = entry.path().stem();
    ASSERT_TRUE(expected.count(name)) << name;
    const Examined one = examined(name);
    EXPECT_EQ(one.experiment.id, name);
    EXPECT_EQ(one.verdict, expected.at(name)) << name << ": " << one.sentence;
    EXPECT_FALSE(one.sentence.empty());
    EXPECT_FALSE(one.findings.empty() && one.inferred.empty());
    for (const Finding& found : one.findings) {
      EXPECT_LE(found.predicted.low, found.predicted.value) << name << ": " << found.test;
      EXPECT_GE(found.predicted.high, found.predicted.value) << name << ": " << found.test;
    }
  }
  EXPECT_EQ(files, expected.size());
}

// The ratios were divided by hand: 413, 732, 1142, 1690 kPa of Gent's relation over 147, 394, 587,
// 878.
TEST(Experiments, SayByHowMuchAHardnessOverestimatesSilicone) {
  const Examined tension = examined("silicones_tension");
  ASSERT_EQ(tension.findings.size(), 4u);
  const double ratios[] = {2.81, 1.86, 1.945, 1.925};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(tension.findings[i].predicted.value / *tension.findings[i].measured, ratios[i],
                0.006);
  EXPECT_EQ(tension.findings[0].verdict, Verdict::fails);
  EXPECT_NE(tension.sentence.find("1.9 to 2.8 times"), std::string::npos) << tension.sentence;
}

// Gent and Lindley's own approximation for nu = 1/2: E (1 + 2 S²), S = D/(4 h), good to some 5 %.
TEST(Experiments, InferTheModulusOfTheBondedDiscAsItsAuthorsFormulaDoes) {
  const Examined disc = examined("bonded_disc_1959");
  const Inferred& modulus = inferred(disc, "youngs_modulus", "of the stiffness below the knee",
                                     "machine's give is in the extension");
  // The chord from the first to the fifth point, less the machine of 1930 N/mm.
  const double area_mm2 = 314.16, whole = (0.8652 - 0.0267) / (0.1157 - 0.0086) * area_mm2 / 1.9;
  const double alone = 1 / (1 / whole - 1 / 1930.), shape = 20 / (4 * 1.9);
  const double by_formula_Pa = 1e6 * alone * 1.9 / area_mm2 / (1 + 2 * shape * shape);
  // The chord is not the line of least squares, and the machine's part triples a difference.
  EXPECT_NEAR(modulus.value.low / by_formula_Pa, 1, 0.12);
  EXPECT_LT(modulus.value.low, modulus.value.high);
}

TEST(Experiments, RefuseHollowFingertipsByTheirOwnCurves) {
  const Examined tips = examined("fingertips_measured");
  const auto refused = [&](const std::string& code) {
    for (const Inferred& number : tips.inferred)
      if (number.name == "force_exponent" && number.condition.rfind(code + " (", 0) == 0)
        return true;
    return false;
  };
  for (const char* hollow : {"P2", "N1", "R1"}) EXPECT_TRUE(refused(hollow)) << hollow;
  // The printer's play, read off the curves of stiff fingertips: 0.1 mm.
  for (const char* stiff : {"N1", "F1"})
    EXPECT_NEAR(inferred(tips, "backlash", stiff).value.value, 0.1e-3, 0.02e-3);
  EXPECT_EQ(inferred(tips, "backlash", "G1").value.value, 0);
  // Gelatin gives 13 % less back than it took: trapezoids over the file's own columns.
  EXPECT_NEAR(inferred(tips, "hysteresis", "G1").value.value, 0.130, 0.002);
}

TEST(Experiments, PredictTheUpperHalvesOfMeasuredCurvesWithinTheirBands) {
  int predicted = 0;
  for (const Finding& found : examined("fingertips_measured").findings) {
    if (found.role != Role::theory) continue;
    ++predicted;
    EXPECT_NE(found.verdict, Verdict::fails) << found.test << " " << found.reason;
    const std::size_t of = found.reason.find(" of ");
    EXPECT_EQ(found.reason.substr(0, of),
              found.reason.substr(of + 4, found.reason.find(' ', of + 4) - of - 4))
        << found.test << " " << found.reason;
  }
  EXPECT_EQ(predicted, 9);
}

TEST(Experiments, RefuseCurvesTablesAndDiscsThatAreNone) {
  const std::string disc = data_set_text("bonded_disc_1959");
  EXPECT_NE(refusal(replaced(disc, "0.0173", "0.0001")).find("rising numbers"), std::string::npos);
  EXPECT_NE(refusal(replaced(disc, "0.1066, ", "")).find("as many rising"), std::string::npos);
  const std::string tips = data_set_text("fingertips_measured");
  EXPECT_NE(refusal(replaced(tips, "step_mm = 0.2", "step_mm = 0")).find("step_mm"),
            std::string::npos);
  EXPECT_NE(refusal(replaced(tips, "hollow = true", "hollow = 1")).find("hollow"),
            std::string::npos);
  const std::string tension = data_set_text("silicones_tension");
  EXPECT_NE(refusal(replaced(tension, "shore_a = 10", "shore_a = 100")).find("0 to 99"),
            std::string::npos);
  const Experiment unknown =
      parse_experiment(replaced(tension, "Dragon Skin 20", "Dragon Skim 20"), "set.toml");
  EXPECT_THROW(examine(unknown), InputError);
}

TEST(Experiments, ShowsAFailureAsAFailure) {
  // No bonded layer grows like P^0.4.
  const Examined wrong = examine(parse_experiment(
      replaced(data_set_text("xydas_kao_1999"), "exponent = 0.2590", "exponent = 0.4"),
      "wrong.toml"));
  EXPECT_EQ(wrong.verdict, Verdict::fails);
  EXPECT_EQ(finding(wrong, "exponent", "bonded_layer").verdict, Verdict::fails);
  EXPECT_NE(table({wrong}).find("fails        xydas_kao_1999"), std::string::npos);
  EXPECT_EQ(to_json({wrong})["experiments"][0]["verdict"], "fails");
  // A ball that sinks in by twice the layer's softest answer.
  const Examined deep = examine(parse_experiment(
      replaced(data_set_text("gelsight_golf_ball"), "indentation_mm = 3.2", "indentation_mm = 0.5"),
      "deep.toml"));
  EXPECT_EQ(deep.verdict, Verdict::fails);
}

TEST(Experiments, DoNotAgreeWithoutAnUncertaintyOrATestThatExcludesSomething) {
  std::string text = data_set_text("xydas_kao_1999");
  text = replaced(text, "supposed_exponent_uncertainty = 0.005", "");
  EXPECT_EQ(examine(parse_experiment(text, "set.toml")).verdict, Verdict::cannot_tell);
  // So uncertain that the half-space, columns and an incompressible layer would do as well.
  EXPECT_EQ(examine(parse_experiment(replaced(data_set_text("xydas_kao_1999"),
                                              "uncertainty = 0.005", "uncertainty = 0.2"),
                                     "set.toml"))
                .verdict,
            Verdict::cannot_tell);
}

TEST(Experiments, JudgeTheSimplerTheoriesByTheSameTolerance) {
  const Examined pad = examined("suntouch_v3");
  int compared_loads = 0;
  for (const double load_N : {6., 9., 12.})
    for (const std::string quantity : {"radius", "eccentricity (torque read as measured)"}) {
      const std::string test = quantity + " at " + std::to_string(int(load_N)) + " N";
      const Finding& layer = finding(pad, test, "fingertip_layer");
      for (const char* rival : {"hertz", "winkler"}) {
        const Finding& other = finding(pad, test, rival);
        EXPECT_EQ(other.measured, layer.measured);
        EXPECT_EQ(other.uncertainty, layer.uncertainty);
        EXPECT_NEAR(other.predicted.high / other.predicted.value,
                    layer.predicted.high / layer.predicted.value, 1e-12);
      }
      EXPECT_EQ(finding(pad, test, "hertz").verdict, Verdict::fails);
      ++compared_loads;
    }
  EXPECT_EQ(compared_loads, 6);
}

TEST(Experiments, KnowHowFarTwoFingersDiffer) {
  const Examined fingers = examined("waltersson_2024_in_hand");
  const Interval noise =
      inferred(fingers, "noise_floor", "difference of the two fingers over their mean").value;
  // 26 to 51 %, rounded.
  EXPECT_NEAR(noise.low, 0.26, 0.005);
  EXPECT_NEAR(noise.high, 0.51, 0.005);
  EXPECT_NE(to_json({fingers})["noise_floor"].get<std::string>().find("26 to 51 %"),
            std::string::npos);
}

TEST(Experiments, RefuseWrongFilesInOneLine) {
  const std::string pad = data_set_text("suntouch_v3"), ball = data_set_text("gelsight_golf_ball");
  struct Wrong {
    std::string text, said;
  };
  for (const Wrong& wrong :
       {Wrong{replaced(pad, "id = ", "idd = "), "idd"},
        Wrong{replaced(pad, "exponent = 0.2569", "exponent = 1.5"), "0.01 to 0.99"},
        Wrong{replaced(pad, "exponent = 0.2569", "exponent = nan"), "exponent"},
        Wrong{replaced(pad, "exponent = 0.2569", "exponant = 0.2569"), "exponant"},
        Wrong{replaced(pad, "fit_load_N = [0.5, 3.0]", "fit_load_N = [3.0, 0.5]"),
              "[least, largest]"},
        Wrong{replaced(pad, "[6.0, 9.0, 12.0]", "[2.0]"), "above those of fit_load_N"},
        Wrong{replaced(pad, "main_poisson_ratio = 0.49", "main_poisson_ratio = 0.48"),
              "one of poisson_ratio"},
        Wrong{replaced(pad, "supposed_exponent_uncertainty = 0.005", ""), "needs one law"},
        Wrong{replaced(pad, "radius_mm = 50.0", "radius_mm = -50.0"), "0.001 to 10000"},
        Wrong{replaced(ball, "load_N = 25.0", "load_N = \"25\""), "load_N"},
        Wrong{replaced(ball, "[indentation]", "[indentations]"), "indentation"},
        Wrong{ball + "\n[hardness]\nscale = \"A\"\n", "exactly one of"},
        Wrong{replaced(data_set_text("gelsight_gel_hardness"), "\"00\"", "\"D\""), "\"D\""},
        Wrong{replaced(data_set_text("trejo_2017"), "shear_stress_exponent", "stress"), "stress"},
        Wrong{replaced(data_set_text("waltersson_2024_in_hand"), "[5.72, 3.41]", "[5.72]"),
              "eccentricity_mm"},
        Wrong{"", "what"}}) {
    const std::string said = refusal(wrong.text);
    EXPECT_NE(said, "accepted") << wrong.said;
    EXPECT_NE(said.find(wrong.said), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

// Gent's relation by hand: S = 50: 0.0981 * 437.168 / (0.137505 * 127) = 2.4558 MPa.
TEST(Hardness, FollowsGentAndTheDurometersSphere) {
  EXPECT_NEAR(modulus_of_shore_a_Pa(50), 2.4558e6, 1e2);
  for (const double shore : {5., 30., 60., 90.}) {
    EXPECT_NEAR(shore_a_of_modulus(modulus_of_shore_a_Pa(shore)), shore, 1e-9);
    EXPECT_NEAR(shore_oo_of_modulus(modulus_of_shore_oo_Pa(shore, 0.49), 0.49), shore, 1e-9);
  }
  EXPECT_EQ(shore_a_of_modulus(1), 0);
  // Hertz at H = 50: d = 1.27 mm, F = 0.657 N; E = 0.75 (1 - 0.25)
  // 0.657/(sqrt(1.19e-3) 1.27e-3^1.5).
  EXPECT_NEAR(modulus_of_shore_oo_Pa(50, 0.5),
              0.75 * 0.75 * 0.657 / (std::sqrt(1.19e-3) * std::pow(1.27e-3, 1.5)), 1e-6);
}

}  // namespace
}  // namespace softfinger::experiments
