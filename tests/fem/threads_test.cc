#include "fem/threads.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace softfinger::fem {
namespace {

TEST(Threads, SideBySideCallsBoth) {
  int one = 0, other = 0;
  side_by_side([&] { one = 1; }, [&] { other = 2; });
  EXPECT_EQ(one, 1);
  EXPECT_EQ(other, 2);
}

/// What is thrown, and whether the one that does not fail has ended.
std::string thrown(bool by_one, bool by_other) {
  bool one_ends = by_one, other_ends = by_other;
  const auto call = [](bool fails, const char* name, bool& ends) {
    if (fails) throw std::runtime_error(name);
    ends = true;
  };
  std::string what = "nothing";
  try {
    side_by_side([&] { call(by_one, "one", one_ends); },
                 [&] { call(by_other, "other", other_ends); });
  } catch (const std::runtime_error& error) {
    what = error.what();
  }
  return one_ends && other_ends ? what : "before both had ended: " + what;
}

TEST(Threads, WhatOneOfThemThrowsComesBackWhenBothHaveEnded) {
  EXPECT_EQ(thrown(false, false), "nothing");
  EXPECT_EQ(thrown(true, false), "one");
  EXPECT_EQ(thrown(false, true), "other");
  EXPECT_EQ(thrown(true, true), "one");
}

TEST(Threads, ThereIsAtLeastOne) { EXPECT_GE(thread_count(), 1); }

}  // namespace
}  // namespace softfinger::fem
