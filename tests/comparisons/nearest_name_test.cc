#include "comparisons/text/nearest_name.h"

#include <gtest/gtest.h>

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

TEST(NearestName, LooksAtTheBeginningOfAnEndlessWord) {
  EXPECT_EQ(text::nearest_name("thickness_" + std::string(1 << 24, 'm'),
                               {"poisson_ratio", "thickness_mm"}),
            "thickness_mm");
}

TEST(Shortened, CutsBetweenCharacters) {
  EXPECT_EQ(text::shortened("short"), "short");
  EXPECT_EQ(text::shortened("0123456789", 10), "0123456789");
  EXPECT_EQ(text::shortened("0123456789x", 10), "0123456...");
  EXPECT_EQ(text::shortened("012345\u00b5789x", 10), "012345...")
      << "not inside the two bytes of µ";
}

}  // namespace softfinger
