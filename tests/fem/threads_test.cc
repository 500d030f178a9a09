#include "fem/base/threads.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "fem/base/ordered_progress.h"

namespace softfinger::fem {
namespace {

TEST(Threads, EachPartIsCalledOnce) {
  for (const int count : {0, 1, 2, 7}) {
    std::vector<int> calls(static_cast<std::size_t>(count), 0);
    in_parallel(count, [&](int i) { ++calls[static_cast<std::size_t>(i)]; });
    EXPECT_EQ(calls, std::vector<int>(calls.size(), 1));
  }
}

TEST(Threads, PartsMayHaveParts) {
  std::vector<std::vector<int>> product(5, std::vector<int>(6));
  in_parallel(5, [&](int i) {
    in_parallel(6, [&](int k) {
      product[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] = i * k;
    });
  });
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 6; ++k)
      EXPECT_EQ(product[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)], i * k);
}

TEST(Threads, TheFirstOfWhatPartsThrowComesBack) {
  const auto thrown = [](int from) {
    try {
      in_parallel(6, [&](int i) {
        if (i >= from) throw i;
      });
    } catch (int what) {
      return what;
    }
    return -1;
  };
  EXPECT_EQ(thrown(6), -1);
  // Each part before it has begun, whichever thread is faster.
  for (const int from : {0, 1, 5}) EXPECT_EQ(thrown(from), from);
}

TEST(Threads, AddsInOrderWhatIsComputedAtTheSameTime) {
  constexpr int batch = 3;
  for (const int count : {0, 1, 2, 3, 4, 17}) {
    std::vector<int> places(2 * batch), added;
    in_order(
        count, batch, [&](int i) { places[static_cast<std::size_t>(i % (2 * batch))] = i; },
        [&](int i) { added.push_back(places[static_cast<std::size_t>(i % (2 * batch))]); });
    std::vector<int> all(static_cast<std::size_t>(count));
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(added, all);
  }
}

void work() {
  volatile double sum = 0;
  for (int i = 0; i < 2'000'000; ++i) sum = sum + 1;
}

TEST(Threads, WorkIsCountedOnceWhichThreadsEverDoIt) {
  std::vector<double> of_part(6);
  const double begin = work_seconds();
  in_parallel(6, [&](int i) {
    const double part_begin = work_seconds();
    in_parallel(2, [](int) { work(); });
    of_part[static_cast<std::size_t>(i)] = work_seconds() - part_begin;
  });
  const double whole = work_seconds() - begin;
  const double parts = std::accumulate(of_part.begin(), of_part.end(), 0.0);
  for (const double part : of_part) EXPECT_GT(part, 0);
  // The time that threads need to find their work counts for the whole alone.
  EXPECT_GE(whole, parts * (1 - 1e-9));
  EXPECT_LT(whole, 1.5 * parts);
}

TEST(Threads, SideBySideCallsBoth) {
  int one = 0, other = 0;
  side_by_side([&] { one = 1; }, [&] { other = 2; });
  EXPECT_EQ(one, 1);
  EXPECT_EQ(other, 2);
}

std::string thrown(bool by_one, bool by_other) {
  const auto call = [](bool fails, const char* name) {
    if (fails) throw std::runtime_error(name);
  };
  try {
    side_by_side([&] { call(by_one, "one"); }, [&] { call(by_other, "other"); });
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Threads, WhatTheFirstOfBothThrowsComesBack) {
  EXPECT_EQ(thrown(false, false), "nothing");
  EXPECT_EQ(thrown(true, false), "one");
  EXPECT_EQ(thrown(false, true), "other");
  EXPECT_EQ(thrown(true, true), "one");
}

TEST(OrderedProgress, TellsLinesInTheOrderOfTheirPlaces) {
  std::vector<std::string> told;
  const auto all = [&] { return std::accumulate(told.begin(), told.end(), std::string()); };
  const OrderedProgress progress([&](const std::string& line) { told.push_back(line); });
  progress("a");
  const OrderedProgress first = progress.place();
  progress("f");
  const OrderedProgress second = progress.place();
  progress("h");
  second("g");
  EXPECT_EQ(all(), "a") << "the first place may still tell something";
  first("b");
  EXPECT_EQ(all(), "ab") << "lines of the first place do not wait";
  {
    const OrderedProgress within = first.place();
    first("d");
    within("c");
    first("e");
    EXPECT_EQ(all(), "abc");
  }
  EXPECT_EQ(all(), "abcde") << "a place that is gone tells nothing more";
  first.close();
  EXPECT_EQ(all(), "abcdefg");
  second.close();
  EXPECT_EQ(all(), "abcdefgh");
}

TEST(Threads, ThereIsAtLeastOne) { EXPECT_GE(thread_count(), 1); }

}  // namespace
}  // namespace softfinger::fem
