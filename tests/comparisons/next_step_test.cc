// Advice to a user whose answer is not usable: each remedy is taken and the case asked again.
#include "comparisons/judgement/next_step.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "comparisons/judgement/assessment.h"
#include "meshes/io/read_surface.h"
#include "tests/meshes/capsule_finger.h"

namespace softfinger {
namespace {

const prediction::Demand kDemand = {};  // 10 % of a, b, area and torque

std::string stepped_case_text(const std::string& geometry, const std::string& load = "2",
                              const std::string& rest = "") {
  return "[geometry]\n" + geometry +
         "\n[layer]\nthickness_mm = 2\nyoungs_modulus_kPa = 300\npoisson_ratio = 0.45\n"
         "[contact]\nload_N = " +
         load + "\nfriction_coefficient = 0.5\n" + rest;
}

struct Stepped {
  input::Case contact_case;
  prediction::GeometryResolver resolver;
  prediction::ModelAnswer answer;

  Stepped(const std::string& text, const char* model)
      : contact_case(input::parse_case(text, "case.toml")), resolver(contact_case) {
    const double load_N = contact_case.loads_N[0];
    const prediction::LocalGeometry geometry = resolver.resolve(load_N);
    answer = prediction::ask_model(*find_pressure_model(model), contact_case, geometry, load_N, 0);
    answer.assessment =
        judgement::assess(contact_case, geometry, answer, prediction::TorqueRule::exact, kDemand);
  }
  bool usable() const { return answer.assessment->usable; }
  judgement::NextStep step() const {
    return judgement::next_step(contact_case, resolver, answer, kDemand);
  }
};

std::string word_after(const std::string& text, const std::string& before) {
  const std::size_t at = text.find(before);
  if (at == std::string::npos) return "";
  const std::size_t start = at + before.size();
  return text.substr(start, text.find(' ', start) - start);
}

const std::string kFinger = "finger.radii_mm = [20, 9]\nobject.radii_mm = [inf, inf]";

TEST(NextStep, NamesAnotherModelThatIsUsable) {
  const Stepped asked(stepped_case_text(kFinger), "hertz");
  ASSERT_FALSE(asked.usable());
  const judgement::NextStep step = asked.step();
  const std::string other = word_after(step.step, "--model ");
  ASSERT_NE(find_pressure_model(other), nullptr) << step.in_words();
  EXPECT_TRUE(Stepped(stepped_case_text(kFinger), other.c_str()).usable()) << step.in_words();
  EXPECT_NE(step.reason.find("off in"), std::string::npos) << step.reason;
}

TEST(NextStep, NamesASmallerLoadWhereTheLayerIsCompressedTooMuch) {
  const Stepped asked(stepped_case_text(kFinger, "100"), "fingertip_layer");
  ASSERT_FALSE(asked.usable());
  const std::string step = asked.step().step;
  ASSERT_NE(step.find("a smaller load"), std::string::npos) << asked.step().in_words();
  const std::string load = word_after(step, "usable, ");
  EXPECT_LT(std::strtod(load.c_str(), nullptr), 100);
  EXPECT_TRUE(Stepped(stepped_case_text(kFinger, load), "fingertip_layer").usable() ||
              Stepped(stepped_case_text(kFinger, load), "bonded_layer").usable())
      << step;
}

TEST(NextStep, SaysWhatNoPointAndNoLoadChanges) {
  const auto step = [](const std::string& rest, const char* model = "bonded_layer") {
    const Stepped asked(stepped_case_text(kFinger, "2", rest), model);
    EXPECT_FALSE(asked.usable()) << rest;
    return asked.step().in_words();
  };
  EXPECT_NE(
      step("[object_layer]\nthickness_mm = 1\nyoungs_modulus_kPa = 500\npoisson_ratio = 0.4\n")
          .find("presses both, flat and in linear theory"),
      std::string::npos);
  EXPECT_NE(step("[power_law]\nradius_coefficient_mm = 2\nradius_exponent = 0.3\n", "power_law")
                .find("--model fingertip_layer"),
            std::string::npos);
  std::string yeoh =
      stepped_case_text(kFinger, "2", "[fem]\nkinematics = \"finite\"\ngeometry = \"curved\"\n");
  yeoh.replace(yeoh.find("poisson"), 0, "material = \"yeoh\"\nyeoh_ratios = [0.1, 0.01]\n");
  EXPECT_NE(Stepped(yeoh, "bonded_layer").step().in_words().find("this one is yeoh"),
            std::string::npos);
  std::string stack = stepped_case_text(kFinger);
  stack.replace(stack.find("[layer]"), 7,
                "[[layer]]\nthickness_mm = 1\nyoungs_modulus_kPa = 900\npoisson_ratio = "
                "0.45\n[[layer]]");
  EXPECT_NE(Stepped(stack, "bonded_layer").step().in_words().find("stack_layer"),
            std::string::npos);
}

TEST(NextStep, SaysThatAHollowFingerHasNoBounds) {
  const Stepped hollow(
      stepped_case_text("finger.radii_mm = [-30, -30]\nobject.sphere_radius_mm = 10"),
      "bonded_layer");
  ASSERT_FALSE(hollow.usable());
  EXPECT_NE(hollow.step().reason.find("hollow finger"), std::string::npos) << hollow.step().reason;
  EXPECT_NE(hollow.step().step.find("softfinger compare"), std::string::npos) << hollow.step().step;
}

/// A finger whose side has a saddle for a gap to a hollow object; its round ends have none.
class NextStepOnAMesh : public testing::Test {
 protected:
  std::filesystem::path file;

  void SetUp() override {
    file = std::filesystem::temp_directory_path() /
           (std::string("softfinger_capsule_") +
            testing::UnitTest::GetInstance()->current_test_info()->name() + ".stl");
    meshes::write_stl_mm(meshes::capsule_finger(), file.string());
  }
  void TearDown() override { std::filesystem::remove(file); }
  std::string finger(const std::string& point) const {
    return "finger = { mesh = \"" + file.string() + "\", " + point +
           " }\nobject = { radii_mm = [-40, -40] }";
  }
};

TEST_F(NextStepOnAMesh, NamesTheNearestPointThatIsUsable) {
  const input::Case saddle =
      input::parse_case(stepped_case_text(finger("along = \"-y\"")), "case.toml");
  const prediction::GeometryResolver resolver(saddle);
  try {
    judgement::resolve_or_advise(saddle, resolver, 2);
    FAIL() << "a saddle has no ellipse";
  } catch (const InputError& error) {
    const std::string what = error.what();
    const std::size_t line = what.find("finger = {");
    ASSERT_NE(line, std::string::npos) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos);
    const std::string pasted = what.substr(line, what.find('}', line) + 1 - line);
    const std::string text = stepped_case_text(pasted + "\nobject = { radii_mm = [-40, -40] }");
    EXPECT_TRUE(Stepped(text, "fingertip_layer").usable() || Stepped(text, "bonded_layer").usable())
        << what;
  }
}

}  // namespace
}  // namespace softfinger
