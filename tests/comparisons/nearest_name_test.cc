#include "comparisons/text/nearest_name.h"

#include <gtest/gtest.h>

#include <utility>

namespace softfinger {

TEST(NearestName, CountsSingleLetterChanges) {
  EXPECT_EQ(text::edit_distance("", ""), 0);
  EXPECT_EQ(text::edit_distance("load", "load"), 0);
  EXPECT_EQ(text::edit_distance("", "load"), 4);
  EXPECT_EQ(text::edit_distance("thicknes_mm", "thickness_mm"), 1);
  EXPECT_EQ(text::edit_distance("thickness_m", "thickness_mm"), 1);
  EXPECT_EQ(text::edit_distance("laod", "load"), 1) << "swapped neighbours are one slip";
  EXPECT_EQ(text::edit_distance("kitten", "sitting"), 3);
}

TEST(NearestName, FindsTheKeyThatWasMeant) {
  const std::vector<std::string> known = {"thickness_mm", "youngs_modulus_kPa", "poisson_ratio"};
  EXPECT_EQ(text::nearest_name("thickness", known), "thickness_mm");
  EXPECT_EQ(text::nearest_name("young_modulus_kpa", known), "youngs_modulus_kPa");
  EXPECT_EQ(text::nearest_name("poissons_ratio", known), "poisson_ratio");
}

TEST(NearestName, KnowsAKeyWithoutItsUnit) {
  EXPECT_EQ(text::nearest_name("point", {"unit", "point_mm"}), "point_mm");
  EXPECT_EQ(text::nearest_name("load", {"loads", "load_N"}), "loads") << "the nearer of the two";
}

TEST(NearestName, KnowsGoodTyposFromAnotherWord) {
  // At most a third of the letters are wrong; swapped neighbours are one slip.
  const std::vector<std::string> cases = {"all",       "a_m",   "curved_fingertip", "foam_pad",
                                          "pad_glass", "hertz", "seed_thumb",       "fem"};
  for (const auto& [typed, meant] : {std::pair("foampad", "foam_pad"),
                                     {"faom_pad", "foam_pad"},
                                     {"seed_tumb", "seed_thumb"},
                                     {"sede_thubm", "seed_thumb"},
                                     {"hetrz", "hertz"},
                                     {"herz", "hertz"},
                                     {"al", "all"},
                                     {"curved_finger", "curved_fingertip"},
                                     {"fme", "fem"}})
    EXPECT_EQ(text::nearest_name(typed, cases), meant) << typed;
  for (const char* nonsense : {"nofile", "foo", "bar", "x", "f", "", "my_finger", "thumb_drive",
                               "tip", "no_such_case", "0"})
    EXPECT_EQ(text::nearest_name(nonsense, cases), std::nullopt) << nonsense;
  EXPECT_EQ(text::nearest_name("anything", {}), std::nullopt);
}

TEST(NearestName, SaysSoOrNothing) {
  EXPECT_EQ(text::did_you_mean("hetrz", {"hertz"}), ", did you mean \"hertz\"?");
  EXPECT_EQ(text::did_you_mean("hetrz", {"hertz"}, "; "), "; did you mean \"hertz\"?");
  EXPECT_EQ(text::did_you_mean("nofile", {"foam_pad"}), "");
}

TEST(NearestName, LooksAtTheBeginningOfAnEndlessWord) {
  // Only the first 200 of sixteen million letters count: else the comparison would take minutes.
  EXPECT_EQ(text::nearest_name("thickness_" + std::string(1 << 24, 'm'),
                               {"poisson_ratio", "thickness_mm"}),
            std::nullopt);
}

TEST(Shortened, CutsBetweenCharacters) {
  EXPECT_EQ(text::shortened("short"), "short");
  EXPECT_EQ(text::shortened("0123456789", 10), "0123456789");
  EXPECT_EQ(text::shortened("0123456789x", 10), "0123456...");
  EXPECT_EQ(text::shortened("012345\u00b5789x", 10), "012345...")
      << "not inside the two bytes of µ";
}

}  // namespace softfinger
