#include "comparisons/input/case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

const char* const kGoodCase = R"(id = "example"
question = "Does it?"
[geometry]
relative_radii_mm = [20.0, 5.0]
[layer]
thickness_mm = 2.0
youngs_modulus_kPa = 300.0
poisson_ratio = 0.49
[contact]
load_N = [1.0, 2]
friction_coefficient = 0.8
[fem]
level = 3
geometry = "flat"
kinematics = "linear"
)";

std::string replaced(const std::string& old_text, const std::string& new_text) {
  std::string text = kGoodCase;
  const std::size_t position = text.find(old_text);
  EXPECT_NE(position, std::string::npos) << old_text;
  return text.replace(position, old_text.size(), new_text);
}

const std::string kGeometry = "relative_radii_mm = [20.0, 5.0]";

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

}  // namespace

TEST(Case, ReadsShearLawsInSiUnits) {
  const auto law = [](const std::string& keys) {
    return input::parse_case(replaced("friction_coefficient = 0.8", keys), "example.toml")
        .shear_law;
  };
  EXPECT_EQ(law("friction_coefficient = 0.8").kind, ShearLaw::Kind::coulomb);
  const ShearLaw strength = law("shear_law = \"shear_strength\"\nshear_strength_kPa = 40");
  EXPECT_EQ(strength.kind, ShearLaw::Kind::shear_strength);
  EXPECT_DOUBLE_EQ(strength.shear_strength_Pa, 4e4);
  const ShearLaw adhesive =
      law("shear_law = \"adhesive_shear\"\nshear_strength_kPa = 4\nfriction_coefficient = 1.5");
  EXPECT_EQ(adhesive.kind, ShearLaw::Kind::adhesive_shear);
  EXPECT_EQ(adhesive.friction_coefficient, 1.5);
  for (const char* name : kShearLawNames)
    EXPECT_STREQ(law(std::string("shear_law = \"") + name + "\"\n" +
                     (std::string(name) == "shear_strength" ? "" : "friction_coefficient = 0.5\n") +
                     (std::string(name) == "coulomb" ? "" : "shear_strength_kPa = 4\n"))
                     .name(),
                 name);
}

TEST(Case, SaysHowItIsPressed) {
  const auto with = [](const std::string& keys) {
    return input::parse_case(replaced("friction_coefficient = 0.8", keys), "example.toml");
  };
  EXPECT_EQ(with("friction_coefficient = 0.8").pressing, PressingFriction::coulomb);
  EXPECT_EQ(with("friction_coefficient = 0.8\npressing = \"frictionless\"").pressing,
            PressingFriction::none);
  EXPECT_EQ(with("shear_law = \"shear_strength\"\nshear_strength_kPa = 9").pressing,
            PressingFriction::none);
  const input::Case coulomb = with("friction_coefficient = 0.8\npressing = \"coulomb\"");
  EXPECT_EQ(coulomb.pressing, PressingFriction::coulomb);
  EXPECT_EQ(coulomb.pressing_friction_coefficient(), 0.8);
  const input::Case stuck = with("friction_coefficient = 0.8\npressing = \"stuck\"");
  EXPECT_TRUE(std::isinf(stuck.pressing_friction_coefficient()));
  EXPECT_THROW(with("friction_coefficient = 0.8\npressing = \"sticky\""), InputError);
  EXPECT_THROW(with("shear_law = \"shear_strength\"\nshear_strength_kPa = 9\n"
                    "pressing = \"stuck\""),
               InputError)
      << "another law";
}

TEST(Case, PressesWithFrictionAtFiniteStrainToo) {
  std::string text = replaced("kinematics = \"linear\"", "kinematics = \"finite\"");
  const std::string friction = "friction_coefficient = 0.8\n";
  text.replace(text.find(friction), friction.size(), friction + "pressing = \"coulomb\"\n");
  const input::Case read = input::parse_case(text, "example.toml");
  EXPECT_EQ(read.pressing, PressingFriction::coulomb);
  EXPECT_TRUE(read.fem_finite);
}

TEST(Case, ReadsRelaxationAndHistory) {
  const auto read = [](const std::string& text) {
    return input::parse_case(text, "example.toml", {}, input::FlatPads::refused,
                             input::Times::taken);
  };
  EXPECT_FALSE(read(kGoodCase).times.are_given());
  const std::string nu = "poisson_ratio = 0.49";
  const std::string terms =
      "\nrelaxation = [{ share = 0.12, time_s = 0.5 }, { share = 0.06, time_s = 5 }]";
  const input::Case creeps = read(replaced(nu, nu + terms));
  ASSERT_EQ(creeps.times.relaxation.terms().size(), 2u);
  EXPECT_EQ(creeps.times.relaxation.terms()[1].share, 0.12);
  EXPECT_EQ(creeps.times.where, "example.toml:9");
  EXPECT_TRUE(creeps.times.history.empty());
  const input::Case law =
      read(replaced(nu, nu + "\nrelaxation = { exponent = 0.05, time_s = 0.01, until_s = 1e4 }"));
  EXPECT_NEAR(law.times.relaxation.modulus(100), std::pow(1e4, -0.05), 1e-3);

  const std::string load = "load_N = [1.0, 2]";
  const input::Case loaded = read(replaced(load,
                                           "history = [{ time_s = 0, load_N = 0 }, { time_s = 2, "
                                           "load_N = 3 }, { time_s = 5, load_N = 1 }]"));
  ASSERT_EQ(loaded.times.history.size(), 3u);
  EXPECT_EQ(loaded.times.history[1].value, 3);
  EXPECT_EQ(loaded.loads_N, std::vector<double>{1});
  const input::Case pressed = read(replaced(load, "history = [{ time_s = 0, approach_mm = 0.4 }]"));
  EXPECT_EQ(pressed.times.drive, ContactHistory::Drive::approach);
  EXPECT_NEAR(pressed.times.history[0].value, 4e-4, 1e-18);
  EXPECT_TRUE(pressed.loads_N.empty());
  // Read again by a command that does not know time.
  EXPECT_THROW(input::parse_case(replaced(nu, nu + terms), "example.toml"), InputError);
}

TEST(Case, RefusesRelaxationAndHistoriesThatMakeNoSense) {
  const auto said = [](const std::string& old_text, const std::string& new_text) -> std::string {
    try {
      input::parse_case(replaced(old_text, new_text), "example.toml", {}, input::FlatPads::taken,
                        input::Times::taken);
      return "nothing";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  const auto holds = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  const std::string nu = "poisson_ratio = 0.49", relaxation = nu + "\nrelaxation = ";
  holds(said(nu, relaxation + "0.1"), "example.toml:9: relaxation = 0.1");
  holds(said(nu, relaxation + "[]"), "example.toml:9: relaxation");
  holds(said(nu, relaxation + "[{ share = 1.2, time_s = 1 }]"), "relaxation.share = 1.2");
  holds(said(nu, relaxation + "[{ share = 0.1 }]"), "relaxation has no time_s");
  holds(said(nu, relaxation + "[{ shares = 0.1, time_s = 1 }]"), "did you mean \"share\"");
  holds(said(nu, relaxation + "[{ share = 0.6, time_s = 1 }, { share = 0.5, time_s = 2 }]"),
        "sum of shares = 1.1");
  holds(said(nu, relaxation + "{ exponent = 0.7, time_s = 1, until_s = 9 }"), "exponent = 0.7");
  holds(said("friction_coefficient = 0.8", "friction_coefficient = 0.8\nhistory = []"),
        "one of them");
  const std::string load = "load_N = [1.0, 2]";
  holds(said(load, "history = []"), "example.toml:10: history");
  holds(said(load, "history = [{ time_s = 0, load_N = -1 }]"), "history.load_N = -1");
  holds(said(load, "history = [{ time_s = 0 }]"), "one of load_N, approach_mm");
  holds(said(load, "history = [{ time_s = 0, load_N = 1 }, { time_s = 1, approach_mm = 1 }]"),
        "in all entries");
  holds(said(load, "history = [{ time_s = 1, load_N = 1 }, { time_s = 0, load_N = 1 }]"),
        "not before the last one");
  holds(said(load, "history = [{ time_s = 0, load = 1 }]"), "did you mean");
  holds(said("[layer]\n",
             "[object_layer]\nthickness_mm = 1\nyoungs_modulus_kPa = 9\n"
             "poisson_ratio = 0.3\n[layer]\nrelaxation = [{ share = 0.1, time_s = 1 }]\n"),
        "two layers");
  holds(said("[layer]\n", "[[layer]]\nrelaxation = [{ share = 0.1, time_s = 1 }]\n"), "sublayers");
}

TEST(Case, TakesItsFilesNameAsIdWithoutOne) {
  const std::string text = replaced("id = \"example\"\n", "");
  EXPECT_EQ(input::parse_case(text, "folder/my finger.toml").id, "my_finger");
  EXPECT_EQ(input::parse_case(text, "standard input").id, "standard_input");
  EXPECT_EQ(input::parse_case(text, ".toml").id, "_toml");
  EXPECT_EQ(input::parse_case(text, std::string(300, 'a') + ".toml").id, std::string(64, 'a'));
  EXPECT_EQ(input::parse_case(kGoodCase, "other.toml").id, "example");
}

TEST(Case, DoubtsValuesThatNoFingerHas) {
  const auto said = [](const std::string& old_text, const std::string& new_text) {
    const auto remarks = input::parse_case(replaced(old_text, new_text), "example.toml").remarks;
    return remarks.size() == 1 ? remarks.front() : std::to_string(remarks.size()) + " remarks";
  };
  EXPECT_EQ(said("= 2.0", "= 2.5"), "0 remarks");
  EXPECT_NE(said("= 2.0", "= 2000").find("thickness_mm = 2000: usual is 0.01 to 100 mm"),
            std::string::npos);
  EXPECT_NE(said("= 300.0", "= 0.3").find("youngs_modulus_kPa = 0.3"), std::string::npos);
  EXPECT_NE(said("= 0.8", "= 1e6").find("friction_coefficient = 1e+06: usual is 0.01 to 10"),
            std::string::npos);
  EXPECT_NE(said("[1.0, 2]", "1e5").find("load_N"), std::string::npos);
  EXPECT_NE(said("[20.0, 5.0]", "[20.0, 5e-3]").find("relative_radii_mm = 0.005"),
            std::string::npos);
  const std::string ball = "finger = { radii_mm = [8, 8] }\nobject = { radii_mm = [inf, inf] }\n";
  EXPECT_EQ(said(kGeometry, ball), "0 remarks");
  std::string thick = replaced(kGeometry, ball);
  thick.replace(thick.find("= 2.0"), 5, "= 28");
  ASSERT_EQ(input::parse_case(thick, "example.toml").remarks.size(), 1u);
  EXPECT_NE(input::parse_case(thick, "example.toml").remarks[0].find("no core is left"),
            std::string::npos);
}

// Reports keep this text, so that a reader gets the same numbers from it.
TEST(Case, KeepsATextThatGivesTheReplacedValuesAgain) {
  input::Settings settings;
  for (const char* setting :
       {"layer.thickness_mm=3", "geometry.relative_radii_mm[1] = 0.1", "contact.load_N=[0.3, 4]",
        "layer.winkler_modulus=youngs", "question=\"a \\\"b\\\" \\\\ c\""})
    settings.push_back(input::parse_setting(setting));
  const input::Case replaced_case = input::parse_case(kGoodCase, "example.toml", settings);
  EXPECT_DOUBLE_EQ(replaced_case.layer.thickness_m, 3e-3);
  EXPECT_EQ(replaced_case.question, "a \"b\" \\ c");
  EXPECT_EQ(replaced_case.options.winkler_modulus, WinklerModulus::youngs);
  const input::Case again = input::parse_case(replaced_case.text, "again.toml");
  EXPECT_EQ(again.layer.thickness_m, replaced_case.layer.thickness_m);
  EXPECT_EQ(again.loads_N, replaced_case.loads_N);
  EXPECT_EQ(again.question, replaced_case.question);
  EXPECT_EQ(std::get<RelativeRadii>(again.geometry).minor_m, 0.1 * 1e-3);
  EXPECT_EQ(input::parse_case(kGoodCase, "example.toml").text, kGoodCase);
}

TEST(Case, ReadsTheDirectionOfAMesh) {
  const auto direction = [](const char* text) { return input::axis_direction(text); };
  EXPECT_EQ(*direction("-y"), Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(*direction("+x"), *direction("x"));
  for (const char* wrong : {"", "-", "+-x", "w", "-w", "-xy", "*x", "--x"})
    EXPECT_FALSE(direction(wrong)) << wrong;
}

TEST(Case, IsReadInSiUnits) {
  const input::Case result = input::parse_case(kGoodCase, "folder/example.toml");
  EXPECT_EQ(result.id, "example");
  EXPECT_EQ(result.question, "Does it?");
  const auto& radii = std::get<RelativeRadii>(result.geometry);
  EXPECT_DOUBLE_EQ(radii.major_m, 0.02);
  EXPECT_DOUBLE_EQ(radii.minor_m, 0.005);
  EXPECT_EQ(radii.axis_rad, 0);
  EXPECT_DOUBLE_EQ(result.layer.thickness_m, 0.002);
  EXPECT_DOUBLE_EQ(result.layer.youngs_modulus_Pa, 3e5);
  EXPECT_EQ(result.layer.poisson_ratio, 0.49);
  EXPECT_EQ(result.loads_N, (std::vector<double>{1, 2}));
  EXPECT_EQ(result.shear_law.friction_coefficient, 0.8);
  EXPECT_EQ(result.fem_level, 3);
}

TEST(Case, HasAThousandLoadsAndAHundredSublayersAtMost) {
  std::string loads, sublayers;
  for (int i = 0; i < 1000; ++i) loads += std::to_string(1000 - i) + ",";
  EXPECT_EQ(input::parse_case(replaced("1.0, 2", loads), "x.toml").loads_N.size(), 1000u);

  const std::string layer =
      "[layer]\nthickness_mm = 2.0\nyoungs_modulus_kPa = 300.0\n"
      "poisson_ratio = 0.49\n";
  const std::string one = "[" + layer.substr(0, 7) + "]" + layer.substr(7);
  EXPECT_EQ(input::parse_case(replaced(layer, repeated(one, 100)), "x.toml").sublayers.size(),
            100u);
  try {
    input::parse_case(replaced(layer, repeated(one, 101)), "x.toml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.field() + " " + error.value() + " " + error.allowed(),
              "[[layer]] 101 entries at most 100");
  }
}

std::string finite_case(const std::string& layer_keys,
                        const std::string& geometry = "relative_radii_mm = [20.0, 5.0]",
                        const std::string& shape = "flat") {
  return "id = \"x\"\n[geometry]\n" + geometry +
         "\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\npoisson_ratio = 0.49\n" +
         layer_keys + "\n[contact]\nload_N = 1\nfriction_coefficient = 0.5\n[fem]\ngeometry = \"" +
         shape + "\"\nkinematics = \"finite\"\n";
}

TEST(Case, TakesAHyperelasticMaterial) {
  EXPECT_FALSE(input::parse_case(kGoodCase, "x.toml").fem_finite.has_value());
  const auto plain = input::parse_case(finite_case(""), "x.toml").fem_finite;
  ASSERT_TRUE(plain.has_value());
  EXPECT_EQ(plain->material, "neo_hookean");
  EXPECT_EQ(plain->volumetric, "quadratic");
  const auto yeoh =
      input::parse_case(finite_case("material = \"yeoh\"\nvolumetric = \"logarithmic\"\n"
                                    "yeoh_ratios = [-0.02, 0.003]"),
                        "x.toml")
          .fem_finite;
  EXPECT_EQ(yeoh->material, "yeoh");
  EXPECT_EQ(yeoh->volumetric, "logarithmic");
  EXPECT_EQ(yeoh->yeoh_ratios, (std::vector<double>{-0.02, 0.003}));
}

TEST(Case, RefusesParametersOfAnotherMaterial) {
  const auto message = [](const std::string& keys) -> std::string {
    try {
      input::parse_case(finite_case(keys), "x.toml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message("yeoh_ratios = [0, 0]").find("material = \"yeoh\""), std::string::npos);
  EXPECT_NE(message("material = \"yeoh\"").find("yeoh_ratios"), std::string::npos);
  EXPECT_NE(message("material = \"ogden\"").find("mooney_rivlin"), std::string::npos);
  EXPECT_NE(message("volumetric = \"cubic\"").find("logarithmic"), std::string::npos);
}

std::string sublayer_case(const std::string& layers, const std::string& fem = "") {
  return "id = \"x\"\n[geometry]\nrelative_radii_mm = [20.0, 5.0]\n" + layers +
         "[contact]\nload_N = 1\nfriction_coefficient = 0.5\n" + fem;
}

const std::string kSkin =
    "[[layer]]\nname = \"skin\"\nthickness_mm = 1\nyoungs_modulus_kPa = 600\n"
    "poisson_ratio = 0.4\n";
const std::string kPulp =
    "[[layer]]\nname = \"pulp\"\nthickness_mm = 3\nyoungs_modulus_kPa = 200\n"
    "poisson_ratio = 0.48\n";

TEST(Case, TakesSublayersFromTheSurfaceInwards) {
  const input::Case result = input::parse_case(sublayer_case(kSkin + kPulp), "x.toml");
  ASSERT_EQ(result.sublayers.size(), 2u);
  EXPECT_EQ(result.sublayers[0].name, "skin");
  EXPECT_DOUBLE_EQ(result.sublayers[1].layer.thickness_m, 3e-3);
  // In series: 4 mm over 1 mm/600 kPa + 3 mm/200 kPa.
  EXPECT_DOUBLE_EQ(result.layer.thickness_m, 4e-3);
  EXPECT_DOUBLE_EQ(result.layer.youngs_modulus_Pa, 240e3);
  EXPECT_DOUBLE_EQ(result.layer.poisson_ratio, 0.46);
}

TEST(Case, GivesEachSublayerItsMaterial) {
  const input::Case result = input::parse_case(
      sublayer_case(kSkin + "material = \"yeoh\"\nyeoh_ratios = [0.1, 0.01]\n" + kPulp,
                    "[fem]\nkinematics = \"finite\"\n"),
      "x.toml");
  EXPECT_EQ(result.sublayers[0].material.material, "yeoh");
  EXPECT_EQ(result.sublayers[1].material.material, "neo_hookean");
}

TEST(Case, TakesOneTableOfAListAsTheLayer) {
  const input::Case result = input::parse_case(
      sublayer_case(kPulp + "volumetric = \"logarithmic\"\n", "[fem]\nkinematics = \"finite\"\n"),
      "x.toml");
  EXPECT_TRUE(result.sublayers.empty());
  EXPECT_DOUBLE_EQ(result.layer.youngs_modulus_Pa, 200e3);
  EXPECT_EQ(result.fem_finite->volumetric, "logarithmic");
}

TEST(Case, RefusesSublayersThatMakeNoSense) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      input::parse_case(text, "x.toml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "no refusal";
  };
  EXPECT_NE(message(sublayer_case(kSkin + kSkin)).find("each name once"), std::string::npos);
  EXPECT_NE(message(sublayer_case(kSkin + "[[layer]]\nthickness_mm = 1\n"))
                .find("[[layer]] has no youngs_modulus_kPa"),
            std::string::npos)
      << message(sublayer_case(kSkin + "[[layer]]\nthickness_mm = 1\n"));
  EXPECT_NE(message(sublayer_case(kSkin + kPulp + "material = \"yeoh\"\n")).find("material"),
            std::string::npos);
  EXPECT_NE(message(sublayer_case(kSkin + kPulp + "winkler_modulus = \"youngs\"\n"))
                .find("winkler_modulus"),
            std::string::npos);
  const std::string nameless =
      "[[layer]]\nthickness_mm = 1\nyoungs_modulus_kPa = 600\npoisson_ratio = 0.4\n";
  EXPECT_NE(message(sublayer_case(kSkin + nameless, "[fem]\nmesh = \"layer.msh\"\n")).find("name"),
            std::string::npos);
}

TEST(Case, WrapsALayerAtFiniteStrainAroundABodyThatCloses) {
  const auto shape = [](const std::string& keys) {
    const input::Case result = input::parse_case(
        finite_case(
            "", "finger = { radii_mm = [9, 9]" + keys + " }\nobject = { radii_mm = [inf, inf] }",
            "curved"),
        "x.toml");
    return std::get<input::QuadricBody>(std::get<input::BodyPair>(result.geometry).finger).shape;
  };
  EXPECT_EQ(shape(""), input::FingerShape::ellipsoid);
  EXPECT_EQ(shape(", shape = \"paraboloid\""), input::FingerShape::paraboloid);
}

TEST(Case, PutsTheLongAxisAlongTheLargerRadius) {
  const input::Case result = input::parse_case(replaced("[20.0, 5.0]", "[5, 20]"), "x.toml");
  const auto& radii = std::get<RelativeRadii>(result.geometry);
  EXPECT_DOUBLE_EQ(radii.major_m, 0.02);
  EXPECT_DOUBLE_EQ(radii.axis_rad, std::acos(0.0));
}

TEST(Case, TakesTwoBodies) {
  const input::Case result =
      input::parse_case(replaced(kGeometry,
                                 "finger = { radii_mm = [9.0, 7] }\nobject = { radii_mm = "
                                 "[-30.0, inf] }\nangle_deg = 90"),
                        "x.toml");
  const auto& pair = std::get<input::BodyPair>(result.geometry);
  EXPECT_DOUBLE_EQ(std::get<input::QuadricBody>(pair.finger).radius_x_m, 9e-3);
  EXPECT_DOUBLE_EQ(std::get<input::QuadricBody>(pair.object).radius_x_m, -30e-3);
  EXPECT_TRUE(std::isinf(std::get<input::QuadricBody>(pair.object).radius_y_m));
  EXPECT_DOUBLE_EQ(pair.angle_rad, std::acos(0.0));
}

TEST(Case, TakesAnExactSphere) {
  const input::Case result = input::parse_case(
      replaced(kGeometry, "finger = { radii_mm = [inf, inf] }\nobject = { sphere_radius_mm = 10 }"),
      "x.toml");
  EXPECT_DOUBLE_EQ(
      std::get<input::SphereBody>(std::get<input::BodyPair>(result.geometry).object).radius_m,
      0.01);
}

TEST(Case, TakesPoissonRatiosOfBothLimitsAndOneLoad) {
  for (const char* nu : {"0", "0.0", "0.5"})
    EXPECT_NO_THROW(input::parse_case(replaced("= 0.49", std::string("= ") + nu), "x.toml")) << nu;
  EXPECT_EQ(input::parse_case(replaced("[1.0, 2]", "3"), "x.toml").loads_N, std::vector<double>{3});
}

TEST(Case, TakesTheWinklerModulusByName) {
  const auto modulus = [](const std::string& line) {
    return input::parse_case(replaced("thickness_mm = 2.0", "thickness_mm = 2.0\n" + line),
                             "x.toml")
        .options.winkler_modulus;
  };
  EXPECT_EQ(modulus(""), WinklerModulus::oedometric);
  EXPECT_EQ(modulus("winkler_modulus = \"oedometric\""), WinklerModulus::oedometric);
  EXPECT_EQ(modulus("winkler_modulus = \"youngs\""), WinklerModulus::youngs);
}

TEST(Case, TakesACompliantObject) {
  const std::string object =
      "[object_layer]\nthickness_mm = 1.5\nyoungs_modulus_kPa = 50\npoisson_ratio = 0\n[contact]";
  const input::Case both = input::parse_case(replaced("[contact]", object), "x.toml");
  EXPECT_FALSE(both.layer_on_object);
  EXPECT_DOUBLE_EQ(both.layer.thickness_m, 0.002);
  EXPECT_DOUBLE_EQ(both.object_layer.thickness_m, 0.0015);
  EXPECT_TRUE(both.problem({0.02, 0.01}, 1).has_object_layer());

  // A rigid finger on a compliant object is the problem of one layer.
  std::string text = replaced("[contact]", object);
  const std::size_t begin = text.find("[layer]"), end = text.find("[object_layer]");
  text.erase(begin, end - begin);
  const input::Case swapped = input::parse_case(text, "x.toml");
  EXPECT_TRUE(swapped.layer_on_object);
  EXPECT_DOUBLE_EQ(swapped.layer.thickness_m, 0.0015);
  EXPECT_FALSE(swapped.problem({0.02, 0.01}, 1).has_object_layer());
}

TEST(Case, TakesAPowerLawOrTheDataToFitOne) {
  const input::Case given = input::parse_case(
      replaced("[contact]",
               "[power_law]\nradius_coefficient_mm = 3.1\nradius_exponent = 0.27\n[contact]"),
      "x.toml");
  EXPECT_DOUBLE_EQ(given.options.power_law.radius_coefficient, 0.0031);
  EXPECT_EQ(given.options.power_law.radius_exponent, 0.27);
  EXPECT_EQ(given.options.power_law.pressure_exponent, 2);
  EXPECT_FALSE(given.power_law_fit);

  const input::Case fitted =
      input::parse_case(replaced("[contact]",
                                 "[power_law]\npressure_exponent = 3\ndata = [[1, 2.0], [8.0, 4]]\n"
                                 "[contact]"),
                        "x.toml");
  ASSERT_TRUE(fitted.power_law_fit);
  EXPECT_NEAR(fitted.options.power_law.radius_exponent, 1.0 / 3, 1e-15);
  EXPECT_NEAR(fitted.options.power_law.radius_coefficient, 0.002, 1e-17);
  EXPECT_EQ(fitted.problem({0.02, 0.01}, 1).options.power_law.pressure_exponent, 3);
  EXPECT_EQ(input::parse_case(kGoodCase, "x.toml").options.power_law.radius_coefficient, 0)
      << "none given";
}

struct BadCase {
  const char *name, *old_text;
  std::string new_text;
  int line;  ///< 0: the whole file
  std::vector<std::string> words;
};

void PrintTo(const BadCase& bad, std::ostream* stream) { *stream << bad.name; }

class BadCaseFile : public testing::TestWithParam<BadCase> {};

TEST_P(BadCaseFile, IsRefusedWithFileLineFieldAndWhatIsAllowed) {
  const BadCase& bad = GetParam();
  try {
    input::parse_case(replaced(bad.old_text, bad.new_text), "bad.toml");
    FAIL() << bad.new_text;
  } catch (const InputError& error) {
    EXPECT_EQ(error.where(), bad.line ? "bad.toml:" + std::to_string(bad.line) : "bad.toml");
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    for (const std::string& word : bad.words)
      EXPECT_NE(what.find(word), std::string::npos) << what << "\n  should say: " << word;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each, BadCaseFile,
    testing::Values(
        BadCase{
            "UnknownKey", "thickness_mm", "thicknes_mm", 6, {"thicknes_mm", "\"thickness_mm\""}},
        BadCase{"WrongUnitSuffix",
                "youngs_modulus_kPa",
                "youngs_modulus_MPa",
                7,
                {"youngs_modulus_kPa"}},
        BadCase{"UnknownTable", "[contact]", "[contacts]", 9, {"contacts", "\"contact\""}},
        BadCase{"UnknownBodyKey",
                "relative_radii_mm = [20.0, 5.0]",
                "finger = { radius_mm = [1, 1] }\nobject = { radii_mm = [1, 1] }",
                4,
                {"radius_mm", "radii_mm"}},
        BadCase{"IdThatIsAPath", "\"example\"", "\"../example\"", 1, {"id", "letters"}},
        BadCase{"MissingTable",
                "[contact]\nload_N = [1.0, 2]\nfriction_coefficient = 0.8\n",
                "",
                0,
                {"[contact]"}},
        BadCase{"MissingKey", "thickness_mm = 2.0\n", "", 5, {"[layer]", "thickness_mm"}},
        BadCase{"NumberAsText", "= 2.0", "= \"2.0\"", 6, {"thickness_mm", "\"2.0\"", "number"}},
        BadCase{"NotANumber", "= 300.0", "= nan", 7, {"youngs_modulus_kPa", "nan"}},
        BadCase{"Infinite", "= 300.0", "= inf", 7, {"youngs_modulus_kPa", "inf"}},
        BadCase{"ZeroModulus", "= 300.0", "= 0", 7, {"youngs_modulus_kPa", "> 0"}},
        BadCase{"NegativeThickness", "= 2.0", "= -2", 6, {"thickness_mm", "-2", "> 0"}},
        BadCase{"ThicknessBelowTheSmallestNumber", "= 2.0", "= 4e-324", 6, {"thickness_mm"}},
        BadCase{"HugeModulus", "= 300.0", "= 1e308", 7, {"youngs_modulus_kPa"}},
        BadCase{"PoissonAboveHalf", "= 0.49", "= 0.51", 8, {"poisson_ratio", "0 to 0.5"}},
        BadCase{"PoissonAsTyped", "= 0.49", "= 0.6", 8, {"poisson_ratio = 0.6:"}},
        BadCase{"PoissonNegative", "= 0.49", "= -0.1", 8, {"poisson_ratio"}},
        BadCase{"LoadZero", "[1.0, 2]", "[1.0, 0]", 10, {"load_N"}},
        BadCase{"LoadTwice", "[1.0, 2]", "[2.0, 2]", 10, {"load_N", "once"}},
        BadCase{"NoLoads", "[1.0, 2]", "[]", 10, {"load_N"}},
        BadCase{"LoadAsText", "[1.0, 2]", "[1.0, \"five\"]", 10, {"load_N", "five"}},
        BadCase{"NoFriction", "= 0.8", "= 0.0", 11, {"friction_coefficient", "> 0"}},
        BadCase{"UnknownShearLaw",
                "friction_coefficient = 0.8",
                "shear_law = \"limted\"",
                11,
                {"shear_law", "limted", "\"limited\""}},
        BadCase{"CoulombWithShearStrength",
                "friction_coefficient = 0.8",
                "friction_coefficient = 0.8\nshear_strength_kPa = 40",
                12,
                {"shear_strength_kPa = 40", "\"adhesive_shear\""}},
        BadCase{"ShearStrengthWithFriction",
                "friction_coefficient = 0.8",
                "shear_law = \"shear_strength\"\nshear_strength_kPa = 40\n"
                "friction_coefficient = 0.8",
                13,
                {"friction_coefficient", "pressure does not matter"}},
        BadCase{"LimitedWithoutStrength",
                "friction_coefficient = 0.8",
                "shear_law = \"limited\"\nfriction_coefficient = 0.8",
                9,
                {"[contact]", "shear_strength_kPa"}},
        BadCase{"LimitedWithoutFriction",
                "friction_coefficient = 0.8",
                "shear_law = \"limited\"\nshear_strength_kPa = 40",
                9,
                {"[contact]", "friction_coefficient"}},
        BadCase{"NegativeStrength",
                "friction_coefficient = 0.8",
                "shear_law = \"shear_strength\"\nshear_strength_kPa = -1",
                12,
                {"shear_strength_kPa", "-1", "> 0"}},
        BadCase{"LevelOutOfRange", "level = 3", "level = 4", 13, {"level", "1, 2 or 3"}},
        BadCase{"LevelNotWhole", "level = 3", "level = 2.5", 13, {"level"}},
        BadCase{"CurvedLayer",
                "\"flat\"",
                "\"curved\"",
                14,
                {"geometry", "\"flat\"", "needs finger and object"}},
        BadCase{"Material",
                "thickness_mm = 2.0",
                "thickness_mm = 2.0\nmaterial = \"neo_hookean\"",
                7,
                {"material", "needs [fem] kinematics = \"finite\""}},
        BadCase{
            "UnknownKinematics", "\"linear\"", "\"nonlinear\"", 15, {"kinematics", "\"linear\""}},
        BadCase{"TwoForms",
                "relative_radii_mm = [20.0, 5.0]",
                "relative_radii_mm = [20.0, 5.0]\nfinger = { radii_mm = [1, 1] }",
                3,
                {"exactly one"}},
        BadCase{"NoForm", "relative_radii_mm = [20.0, 5.0]\n", "", 3, {"exactly one"}},
        BadCase{"LoneFinger",
                "relative_radii_mm = [20.0, 5.0]",
                "finger = { radii_mm = [1, 1] }",
                3,
                {"object"}},
        BadCase{"AngleWithoutBodies",
                "relative_radii_mm = [20.0, 5.0]",
                "relative_radii_mm = [20.0, 5.0]\nangle_deg = 3",
                5,
                {"angle_deg"}},
        BadCase{"LineContact", "[20.0, 5.0]", "[inf, 5.0]", 4, {"no contact ellipse", "line"}},
        BadCase{
            "SaddleContact", "[20.0, 5.0]", "[20.0, -5.0]", 4, {"no contact ellipse", "saddle"}},
        BadCase{"TwoNegativeRadii",
                "[20.0, 5.0]",
                "[-20.0, -5.0]",
                4,
                {"no contact ellipse", "opens nowhere", "[-20, -5]"}},
        BadCase{"RadiusZero", "[20.0, 5.0]", "[0, 5.0]", 4, {"relative_radii_mm"}},
        BadCase{"ThreeRadii", "[20.0, 5.0]", "[20.0, 5.0, 1.0]", 4, {"two radii"}},
        BadCase{"WrongMeshUnit",
                "relative_radii_mm = [20.0, 5.0]",
                "finger = { mesh = \"/dev/null\", unit = \"inch\", point_mm = [0, 0, 0] }\nobject "
                "= { radii_mm = [1, 1] }",
                4,
                {"unit", "inch", "\"mm\" or \"m\""}},
        BadCase{"MeshWithoutPoint",
                "relative_radii_mm = [20.0, 5.0]",
                "finger = { mesh = \"/dev/null\" }\nobject = { radii_mm = [1, 1] }",
                4,
                {"point_mm"}},
        BadCase{"NearAndPoint",
                "relative_radii_mm = [20.0, 5.0]",
                "finger = { mesh = \"/dev/null\", near_mm = [0, 0, 0], point_mm = [0, 0, 0] }\n"
                "object = { radii_mm = [1, 1] }",
                4,
                {"point_mm", "near_mm", "one of them"}},
        BadCase{"NearAndAlong",
                "relative_radii_mm = [20.0, 5.0]",
                "finger = { mesh = \"/dev/null\", near_mm = [0, 0, 0], along = \"-y\" }\n"
                "object = { radii_mm = [1, 1] }",
                4,
                {"near_mm", "along", "one of them"}},
        BadCase{"NearOfTwoNumbers",
                "relative_radii_mm = [20.0, 5.0]",
                "finger = { mesh = \"/dev/null\", near_mm = [0, 0] }\nobject = { radii_mm = [1, 1] "
                "}",
                4,
                {"finger.near_mm", "three finite numbers"}},
        BadCase{
            "CoreOfAnObject",
            "relative_radii_mm = [20.0, 5.0]",
            "finger = { radii_mm = [1, 1] }\nobject = { mesh = \"/dev/null\", point_mm = [0, 0, "
            "0], core = { mesh = \"/dev/null\" } }",
            5,
            {"no core"}},
        BadCase{"CoreUnderAFlatLayer",
                "relative_radii_mm = [20.0, 5.0]",
                "finger = { mesh = \"/dev/null\", point_mm = [0, 0, 0], core = { mesh = "
                "\"/dev/null\" } }\nobject = { radii_mm = [1, 1] }",
                4,
                {"core", "\"curved\""}},
        BadCase{"NormalWithoutDirection",
                "relative_radii_mm = [20.0, 5.0]",
                "finger = { mesh = \"/dev/null\", point_mm = [0, 0, 0], normal = [0, 0, 0] "
                "}\nobject = { radii_mm = [1, 1] }",
                4,
                {"normal"}},
        BadCase{
            "PointWithoutMesh",
            "relative_radii_mm = [20.0, 5.0]",
            "finger = { radii_mm = [1, 1], point_mm = [0, 0, 0] }\nobject = { radii_mm = [1, 1] }",
            4,
            {"point_mm", "mesh"}},
        BadCase{
            "BodyWithTwoForms",
            "relative_radii_mm = [20.0, 5.0]",
            "finger = { radii_mm = [1, 1] }\nobject = { radii_mm = [1, 1], sphere_radius_mm = 2 }",
            5,
            {"exactly one"}},
        BadCase{"SphereAsFinger",
                "relative_radii_mm = [20.0, 5.0]",
                "finger = { sphere_radius_mm = 2 }\nobject = { radii_mm = [1, 1] }",
                4,
                {"for the object"}},
        BadCase{"WinklerModulus",
                "thickness_mm = 2.0",
                "thickness_mm = 2.0\nwinkler_modulus = \"young\"",
                7,
                {"winkler_modulus", "\"oedometric\" or \"youngs\""}},
        BadCase{"ObjectLayerKey",
                "[contact]",
                "[object_layer]\nthicknes_mm = 1\n[contact]",
                10,
                {"[object_layer]", "\"thickness_mm\""}},
        BadCase{"ObjectLayerWithoutModulus",
                "[contact]",
                "[object_layer]\nthickness_mm = 1\n[contact]",
                9,
                {"[object_layer]", "youngs_modulus_kPa"}},
        BadCase{"ObjectLayerPoisson",
                "[contact]",
                "[object_layer]\nthickness_mm = 1\nyoungs_modulus_kPa = 1\npoisson_ratio = "
                "0.6\n[contact]",
                12,
                {"poisson_ratio", "0 to 0.5"}},
        BadCase{"PowerLawKey",
                "[contact]",
                "[power_law]\nradius_coefficient = 1\n[contact]",
                10,
                {"[power_law]", "\"radius_coefficient_mm\""}},
        BadCase{"PowerLawWithoutExponent",
                "[contact]",
                "[power_law]\nradius_coefficient_mm = 1\n[contact]",
                9,
                {"[power_law]", "radius_exponent"}},
        BadCase{"PowerLawExponent",
                "[contact]",
                "[power_law]\nradius_coefficient_mm = 1\nradius_exponent = 1\n[contact]",
                11,
                {"radius_exponent", "between 0 and 1"}},
        BadCase{"PowerLawPressureExponent",
                "[contact]",
                "[power_law]\npressure_exponent = 0.5\n[contact]",
                10,
                {"pressure_exponent", ">= 1"}},
        BadCase{"PowerLawGivenAndFitted",
                "[contact]",
                "[power_law]\nradius_exponent = 0.3\ndata = [[1, 2], [2, 3]]\n[contact]",
                10,
                {"radius_exponent", "data"}},
        BadCase{"PowerLawDataOfThreeColumns",
                "[contact]",
                "[power_law]\ndata = [[1, 2, 3], [2, 3, 4]]\n[contact]",
                10,
                {"data", "[load_N, radius_mm]"}},
        BadCase{"PowerLawDataNegative",
                "[contact]",
                "[power_law]\ndata = [[1, 2], [-2, 3]]\n[contact]",
                10,
                {"data", "> 0"}},
        BadCase{"PowerLawDataOfOneLoad",
                "[contact]",
                "[power_law]\ndata = [[1, 2], [1, 3]]\n[contact]",
                10,
                {"data", "two different loads"}},
        BadCase{"TooManyMeasuredRadii",
                "[contact]",
                "[power_law]\ndata = [" + repeated("[1, 2],", 1001) + "]\n[contact]",
                10,
                {"data = 1001 entries", "at most 1000"}},
        BadCase{"TooManyLoads",
                "load_N = [1.0, 2]",
                "load_N = [" + repeated("1,", 1001) + "]",
                10,
                {"load_N = 1001 entries", "at most 1000"}},
        BadCase{"LoadGivenTwice", "load_N = [1.0, 2]", "load_N = [1.0, 2, 1]", 10, {"once"}},
        BadCase{"LongQuestion",
                "Does it?",
                repeated("Does it? ", 500),
                2,
                {"question", "at most 4096 bytes"}},
        BadCase{"WholeNumberThatIsNoDouble",
                "load_N = [1.0, 2]",
                "load_N = 9007199254740993",
                10,
                {"load_N = 9007199254740993", "up to 2^53", "1e17"}},
        BadCase{"LevelOfManyDigits", "level = 3", "level = 9223372036854775807", 13, {"1, 2 or 3"}},
        BadCase{"NotToml", "[layer]", "[layer", 5, {"TOML"}}),
    [](const auto& information) { return information.param.name; });

}  // namespace softfinger
