// One thread and several find the same, to the last digit, and report it in the same order.

#include <gtest/gtest.h>

#include <memory>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "fem/base/threads.h"
#include "fem/program/reference_solver.h"
#include "fem/program/result_json.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/surfaces.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

struct Answer {
  std::string json;
  std::vector<std::string> lines;
};

/// Answer without the parts that depend on the machine.
Answer answer(const Problem& problem, int threads) {
  const ThreadLimit limit(threads);
  Answer result;
  const std::regex of_machine_in_line(R"([0-9.e+]+ (s\b|MB))");
  const Progress progress = [&](const std::string& line) {
    result.lines.push_back(std::regex_replace(line, of_machine_in_line, "-"));
  };
  try {
    nlohmann::json json = to_json(problem, solve(problem, progress));
    for (const char* of_machine : {"wall_s", "cpu_s", "peak_memory_MB"}) json.erase(of_machine);
    for (auto& level : json.at("levels"))
      for (const char* of_machine : {"wall_s", "cpu_s"}) level.erase(of_machine);
    result.json = json.dump();
  } catch (const InputError& error) {
    result.json = error.what();
  }
  return result;
}

void expect_same(const Problem& problem) {
  const Answer one = answer(problem, 1), several = answer(problem, 4);
  EXPECT_EQ(one.json, several.json);
  EXPECT_EQ(one.lines, several.lines);
}

/// A sphere's facets with the contact point at the origin.
Problem scan() {
  constexpr double radius_m = 10e-3, edge = 0.1;
  TriangleSurface surface = meshes::sphere(radius_m, edge * radius_m);
  for (Eigen::Vector3d& vertex : surface.vertices_m) vertex.z() -= radius_m;
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.1, 0.1, 0}, {2e-3, 1e5, 0.45}, {0.3, 0.5}};
  problem.fingertip.scan = std::make_shared<const TriangleSurface>(std::move(surface));
  problem.fingertip.object = meshes::plane_object();
  return problem;
}

Problem quarter() {
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.1, 0.06, 0}, {2e-3, 3e5, 0.45}, {0.3, 0.5}};
  return problem;
}

Problem with_friction(Problem problem) {
  problem.friction.torsion = true;
  problem.friction.increments = 5;
  problem.friction.limit_surface = 4;
  problem.friction.increments_to_slip = 2;
  return problem;
}

Problem at_finite_strain(Problem problem) {
  problem.finite_strain = MaterialChoice();
  return problem;
}

TEST(ThreadCount, DoesNotChangeAScansContact) { expect_same(scan()); }
TEST(ThreadCount, DoesNotChangeAScansFriction) { expect_same(with_friction(scan())); }
TEST(ThreadCount, DoesNotChangeAQuarter) {
  Problem problem = quarter();
  problem.level = 2;  // large enough for blocks of columns
  expect_same(problem);
}
TEST(ThreadCount, DoesNotChangeAQuartersFriction) { expect_same(with_friction(quarter())); }
TEST(ThreadCount, DoesNotChangePressingAtFiniteStrain) { expect_same(at_finite_strain(scan())); }
TEST(ThreadCount, DoesNotChangeFrictionAtFiniteStrain) {
  Problem problem = at_finite_strain(quarter());
  problem.friction.torsion = true;
  problem.friction.increments = 3;
  expect_same(problem);
}

TEST(ThreadCount, DoesNotChangeARefusal) {
  Problem problem = scan();
  problem.contact.load.normal_force_N = 30;
  const Answer one = answer(problem, 1);
  EXPECT_NE(one.json.find("allowed"), std::string::npos) << one.json;
  EXPECT_EQ(one.json, answer(problem, 4).json);
}

}  // namespace
}  // namespace softfinger::fem
