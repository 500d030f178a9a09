#include "comparisons/system/terminal.h"

#include <gtest/gtest.h>

namespace softfinger {
namespace {

TEST(Terminal, LongLinesAreBrokenAtSpacesAndIndented) {
  EXPECT_EQ(system::within_columns("torque 2.94 mN·m by a model; contact\n  short\n", 20),
            "torque 2.94 mN·m by\n    a model; contact\n  short\n");
  // A word longer than the terminal stays whole, and what fits stays as it is.
  EXPECT_EQ(system::within_columns("see https://example.org/a/long/name now", 20),
            "see\n    https://example.org/a/long/name\n    now");
  EXPECT_EQ(system::within_columns("exactly twenty chars\n\n", 20), "exactly twenty chars\n\n");
}

}  // namespace
}  // namespace softfinger
