#include "comparisons/input/recorded_contacts.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>

#include "comparisons/system/files.h"
#include "softfinger/dynamics/step/contact_lcp_solver.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

const std::string kGoodContacts =
    "softlcp 1\nnote of a block on a floor\nnc 1\nu 4\nnb 1\nmu 1 0.7\nen 1 0.002\n"
    "V 12 1 0 0 -1 0 0 0 1 0 0 -1 0\nminv 6 5 5 5 1e4 1e4 2e4\n"
    "J 5\n0 2 1\n1 0 1\n2 1 1\n3 5 1\n3 0 0.5\nq4 4 -0.05 0.01 0 0\n";

std::string with_contacts_replaced(const std::string& old_text, const std::string& new_text) {
  std::string text = kGoodContacts;
  const std::size_t position = text.find(old_text);
  EXPECT_NE(position, std::string::npos) << old_text;
  return text.replace(position, old_text.size(), new_text);
}

void expect_refusal(const std::string& text, const std::string& words) {
  try {
    input::parse_recorded_contacts(text, "step.txt");
    ADD_FAILURE() << "not refused: " << words;
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind("step.txt", 0), 0u) << message;
    EXPECT_NE(message.find(words), std::string::npos) << message << "\ninstead of\n" << words;
    EXPECT_LT(message.size(), 300u);
  }
}

}  // namespace

TEST(RecordedContacts, MakeTheirMatrixFromJacobianAndMasses) {
  const ContactLcp problem = input::parse_recorded_contacts(kGoodContacts, "step.txt");
  Eigen::Matrix4d delassus;
  delassus << 5, 0, 0, 0, 0, 5, 0, 2.5, 0, 0, 5, 0, 0, 2.5, 0, 20001.25;
  EXPECT_EQ(problem.delassus, delassus);
  EXPECT_EQ(problem.vertices.cols(), 4);
  EXPECT_EQ(problem.vertices(0, 1), -1);
  EXPECT_EQ(problem.free_velocity, Eigen::Vector4d(-0.05, 0.01, 0, 0));
  EXPECT_EQ(problem.friction_coefficient[0], 0.7);
  EXPECT_EQ(problem.eccentricity_m[0], 0.002);
}

TEST(RecordedContacts, MayEndWithoutALineBreakAndHoldBlanks) {
  const std::string text =
      "softlcp 1\r\n\n nc\t1\nu 0\nnb 1\nmu 1 0\nen 1 0\nV 0\nminv 6 1 1 1 1 1 1 \n"
      "q4 4 0 0 0 0\nJ 1\n0 2 1";
  EXPECT_EQ(input::parse_recorded_contacts(text, "step.txt").delassus(0, 0), 1);
}

TEST(RecordedContacts, HaveEachKeyOnce) {
  const std::string once = "one line with this key";
  for (const char* key : {"nc 1", "u 4", "nb 1", "mu 1 0.7", "en 1 0.002", "J 1\n0 2 1"}) {
    expect_refusal(kGoodContacts + key + "\n", once);
    expect_refusal(kGoodContacts + key, once);
  }
  // The matrices have been sized by the first one.
  expect_refusal(kGoodContacts + "nb 100000\nminv 0\n", "step.txt:17: nb: allowed: " + once);
  expect_refusal(with_contacts_replaced("q4 ", "nc 1000\nq4 "), once);
}

TEST(RecordedContacts, HaveNothingBehindTheirNumbers) {
  const std::string said = "nothing behind them";
  for (const char* line : {"nc 1", "u 4", "nb 1", "J 5"})
    expect_refusal(with_contacts_replaced(line, std::string(line) + " rest"), said);
  expect_refusal(with_contacts_replaced("softlcp 1", "softlcp 2"), "no other version");
}

TEST(RecordedContacts, ReserveNoMoreThanTheFileHolds) {
  const std::string large = "softlcp 1\nnc 1000\nu 16\nnb 100000\n";
  expect_refusal(large + "J 2400000000\n0 0 1\n", "J = 2400000000");
  expect_refusal(large + "J 0\n", "minv: allowed: a line");
  expect_refusal(large + "minv 600000 1 1\n", "minv = 600000");
  expect_refusal("softlcp 1\nnc 2000\nnb 100000\nJ 0", "nc = 2000: allowed: a whole number from 1");
  expect_refusal(with_contacts_replaced("u 4", "u 1e9"), "u = 1000000000");
  expect_refusal(with_contacts_replaced("mu 1", "mu 1e300"), "mu = 1e+300");
  expect_refusal(with_contacts_replaced("mu 1", "mu -1"), "mu = -1");
  expect_refusal(with_contacts_replaced("J 5", "J 1.5"), "J = 1.5");
  expect_refusal(with_contacts_replaced("J 5", "J 6"), "J row");
  expect_refusal("softlcp 1\n" + std::string(65 << 20, ' '), "at most 64 MiB");
}

TEST(RecordedContacts, HaveEachEntryOnceAndInside) {
  expect_refusal(with_contacts_replaced("3 0 0.5", "3 5 0.5"),
                 "J: allowed: each row and column once");
  expect_refusal(with_contacts_replaced("3 0 0.5", "4 0 0.5"), "step.txt:15: J row = 4");
  expect_refusal(with_contacts_replaced("3 0 0.5", "3 6 0.5"), "J column = 6");
  expect_refusal(with_contacts_replaced("3 0 0.5", "3 0"), "more numbers");
  expect_refusal(with_contacts_replaced("nc 1\n", ""), "nc and nb before it");
  expect_refusal(with_contacts_replaced("3 0 0.5", "3 0 1" + std::string(500, '0')),
                 "finite numbers");
  expect_refusal(std::string(100000, 'x'), "first line");
}

TEST(RecordedContacts, AreReadAsTheyWereWritten) {
  std::string name = (std::filesystem::temp_directory_path() / "softfinger-lcp-XXXXXX").string();
  const std::filesystem::path folder = mkdtemp(name.data());
  const ContactLcp problem = input::parse_recorded_contacts(kGoodContacts, "step.txt");
  input::write_recorded_contacts(problem, problem.vertices, "a note", folder / "step.txt");
  const ContactLcp again = input::read_recorded_contacts(folder / "step.txt");
  EXPECT_TRUE(again.delassus.isApprox(problem.delassus, 1e-14));
  EXPECT_EQ(again.vertices, problem.vertices);
  EXPECT_EQ(again.free_velocity, problem.free_velocity);
  std::filesystem::remove_all(folder);
}

TEST(RecordedContacts, OfHostileNumbersAreSolvedByNumbersOrNotAtAll) {
  int solved = 0;
  for (const char* place : {"-0.05", "5 5 5", "5 1\n", "0.7", "0.002", "0.5"})
    for (const char* number : {"1e300", "-1e300", "1e154", "1e-300", "5e-324", "0", "1e-160"})
      for (const FrictionRule rule : {FrictionRule::facets, FrictionRule::ellipsoid}) {
        const std::string after = std::string(place) == "5 5 5"   ? " 5 5"
                                  : std::string(place) == "5 1\n" ? "\n"
                                                                  : "";
        const std::string text = with_contacts_replaced(place, number + after);
        try {
          ContactLcp problem = input::parse_recorded_contacts(text, "step.txt");
          problem.friction_rule = rule;
          ContactLcpSolver solver(1, 4);
          ContactSolution solution;
          const LcpResult result = solver.solve(problem, solution);
          EXPECT_FALSE(std::isnan(result.residual)) << text;
          if (result.status != LcpStatus::solved) continue;
          ++solved;
          EXPECT_TRUE(solution.impulse.allFinite() && solution.velocity.allFinite()) << text;
        } catch (const InputError&) {
        }
      }
  EXPECT_GT(solved, 20);
}

}  // namespace softfinger
