// The rungs of the contact solver that solve the recorded problems. A wrong derivative makes upper
// rungs fail: lower ones then hide it, at the price of time.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "comparisons/input/recorded_contacts.h"
#include "comparisons/system/files.h"
#include "softfinger/dynamics/step/contact_lcp_solver.h"

namespace softfinger {
namespace {

std::vector<std::string> recorded_files() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(SOFTFINGER_RECORDED_CONTACTS))
    files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

/// The status that the file states for its problem with facets.
bool is_infeasible(const std::string& file) { return file.find("_infeas_") != std::string::npos; }

TEST(RecordedContacts, AreSolvedByTheFirstStart) {
  std::map<SolvedBy, int> solved_by;
  for (const std::string& file : recorded_files()) {
    ContactLcp problem = input::read_recorded_contacts(file);
    problem.friction_rule = FrictionRule::ellipsoid;
    ContactSolution solution;
    const LcpResult result = ContactLcpSolver(problem.contacts(), 0).solve(problem, solution);
    ++solved_by[result.solved_by];
    if (is_infeasible(file)) {
      EXPECT_EQ(result.proof, RayProof::infeasible) << file;
      continue;
    }
    EXPECT_EQ(result.status, LcpStatus::solved) << file;
    EXPECT_LE(exact_contact_residual(problem, solution), 1e-10) << file;
  }
  // Measured: 50, 1 and 0.
  EXPECT_GE(solved_by[SolvedBy::first_start], 48);
  EXPECT_LE(solved_by[SolvedBy::drawn_start], 3);
  EXPECT_EQ(solved_by[SolvedBy::facets], 0);
}

TEST(RecordedContacts, AreSolvedWithFacets) {
  for (const std::string& file : recorded_files()) {
    const ContactLcp problem = input::read_recorded_contacts(file);
    ContactSolution solution;
    ContactLcpSolver solver(problem.contacts(), int(problem.vertices.cols()));
    const LcpResult result = solver.solve(problem, solution);
    if (is_infeasible(file)) {
      EXPECT_EQ(result.proof, RayProof::infeasible) << file;
      continue;
    }
    EXPECT_EQ(result.status, LcpStatus::solved) << file;
    EXPECT_LE(contact_residual(problem, solution), 1e-10) << file;
  }
}

}  // namespace
}  // namespace softfinger
