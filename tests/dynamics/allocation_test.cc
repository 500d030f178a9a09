// A solver that has been sized is used in every step of a simulation: it must not touch the heap.
// Eigen takes its memory from malloc, past operator new. The linker therefore calls the functions
// below wherever the program or a library in it calls malloc (see CMakeLists.txt);
// allocation_counter.cc brings operator new into the program, so that it is counted too.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "softfinger/dynamics/facets/lemke.h"
#include "softfinger/dynamics/step/eccentricity_law.h"
#include "tests/dynamics/random_scene.h"
#include "tests/dynamics/simple_contacts.h"

namespace {
std::atomic<std::size_t> heap_calls{0};
}

extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* memory, std::size_t size);

void* __wrap_malloc(std::size_t size) {
  ++heap_calls;
  return __real_malloc(size);
}
void* __wrap_calloc(std::size_t count, std::size_t size) {
  ++heap_calls;
  return __real_calloc(count, size);
}
void* __wrap_realloc(void* memory, std::size_t size) {
  ++heap_calls;
  return __real_realloc(memory, size);
}
}

namespace softfinger {
namespace {

class NoAllocation {
 public:
  NoAllocation() : before_(heap_calls) {}
  ~NoAllocation() { EXPECT_EQ(heap_calls, before_); }

 private:
  std::size_t before_;
};

TEST(LcpAllocation, WhatEigenAndOperatorNewTakeIsCounted) {
  std::size_t before = heap_calls;
  LemkeSolver solver(40);
  EXPECT_GT(heap_calls, before);
  before = heap_calls;
  const Eigen::VectorXd z = Eigen::VectorXd::Random(40);
  EXPECT_EQ(heap_calls, before + 1);
  before = heap_calls;
  const std::vector<double> numbers(z.begin(), z.end());
  EXPECT_EQ(heap_calls, before + 1);
  EXPECT_EQ(numbers.back(), z[39]);
}

TEST(LcpAllocation, LemkeDoesNotAllocateOnceSized) {
  std::srand(6);
  constexpr int kSize = 40;
  LemkeSolver solver(kSize);
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(kSize, kSize);
  const Eigen::MatrixXd definite = root.transpose() * root, zero = 0 * root;
  const Eigen::VectorXd constant = Eigen::VectorXd::Random(kSize);
  Eigen::VectorXd z(kSize);
  LcpResult solved, infeasible;
  {
    const NoAllocation watch;
    solved = solver.solve(definite, constant, z);
    infeasible = solver.solve(zero, constant, z);
  }
  EXPECT_EQ(solved.status, LcpStatus::solved);
  EXPECT_EQ(infeasible.proof, RayProof::infeasible);
}

TEST(LcpAllocation, ContactLcpDoesNotAllocateOnceSized) {
  tests::RandomScenes scenes(15);
  ContactLcpSolver solver(20, 32);
  for (int trial = 0; trial < 60; ++trial) {
    const ContactLcp problem = scenes.next(1 + trial % 20, 32);
    ContactSolution solution;
    solution.resize(problem.contacts());
    LcpResult result;
    {
      const NoAllocation watch;
      result = solver.solve(problem, solution);
    }
    EXPECT_EQ(result.status, LcpStatus::solved) << trial;
  }
}

TEST(LcpAllocation, ExactFrictionAndWarmStartsDoNotAllocateOnceSized) {
  tests::RandomScenes scenes(16);
  const SixPatchShape shape(0.5, 0.5);
  ContactLcpSolver solver(20, 16);
  for (const FrictionRule rule :
       {FrictionRule::facets, FrictionRule::ellipsoid, FrictionRule::limit_surface})
    for (int trial = 0; trial < 20; ++trial) {
      ContactLcp problem = scenes.next(1 + trial, 16);
      problem.friction_rule = rule;
      problem.shapes.assign(std::size_t(problem.contacts()), &shape);
      std::vector<int> continued(std::size_t(problem.contacts()), -1);
      for (int i = 0; i < problem.contacts(); ++i) continued[std::size_t(i)] = i;
      ContactSolution solution;
      solution.resize(problem.contacts());
      for (int step = 0; step < 4; ++step) {
        LcpResult result;
        {
          const NoAllocation watch;
          result = solver.solve(problem, solution, step > 0 ? &continued : nullptr);
        }
        EXPECT_EQ(result.status, LcpStatus::solved) << trial;
        scenes.step(problem, solution, 0.05);
      }
    }
}

TEST(LcpAllocation, ConsistentEccentricityDoesNotAllocateOnceSized) {
  tests::RandomScenes scenes(17);
  const PowerEccentricity law(0.002, 1.0 / 3);
  ContactLcp problem = tests::separate_contacts(scenes, 6);
  problem.friction_rule = FrictionRule::ellipsoid;
  const std::vector<const EccentricityLaw*> laws(6, &law);
  ConsistentContactSolver solver(6, 16);
  ContactSolution solution;
  solution.resize(6);
  ConsistentResult result;
  {
    const NoAllocation watch;
    result = solver.solve(problem, laws, 1e-3, solution, {});
  }
  EXPECT_EQ(result.lcp.status, LcpStatus::solved);
  EXPECT_LE(result.inconsistency, 1e-9);
}

TEST(StepAllocation, OfFreeBodiesWithTheContactsOfTheLastStepDoesNotAllocate) {
  // Two boxes at rest, one that slides, and a ball that spins by the e_n of its load.
  const Eigen::Vector3d size(0.1, 0.06, 0.02);
  std::vector<BodyDescription> descriptions = {tests::ground()};
  tests::SimpleContacts contacts;
  for (int b = 1; b <= 3; ++b) {
    descriptions.push_back(
        tests::box("box " + std::to_string(b), size, 0.3, Eigen::Vector3d(0.2 * b, 0, 0.01)));
    tests::SimpleContacts::Pair pair{tests::SimpleContacts::Pair::Kind::corners_on_plane, 0, b};
    pair.size_m = size;
    pair.friction_coefficient = 0.5;
    contacts.pairs.push_back(pair);
  }
  descriptions[3].velocity_m_per_s.x() = 1;
  descriptions.push_back(tests::ball("ball", 0.01, 0.05, Eigen::Vector3d(0, 0, 0.01)));
  descriptions[4].angular_velocity_rad_per_s.z() = 10;
  const PowerEccentricity law(0.002, 1.0 / 3);
  tests::SimpleContacts::Pair spinning{tests::SimpleContacts::Pair::Kind::ball_on_plane, 0, 4};
  spinning.radius_b_m = 0.01;
  spinning.friction_coefficient = 0.5;
  spinning.law = &law;
  contacts.pairs.push_back(spinning);
  TimeStepper::Options options;
  options.friction_rule = FrictionRule::ellipsoid;
  options.gravity_m_per_s2 = Eigen::Vector3d(0, 0, -9.81);
  TimeStepper stepper(Multibody(descriptions, {}), {}, options);
  for (int step = 0; step < 5; ++step) ASSERT_TRUE(stepper.step(contacts).done());
  for (int step = 0; step < 20; ++step) {
    StepResult result;
    {
      const NoAllocation watch;
      result = stepper.step(contacts);
    }
    ASSERT_TRUE(result.done()) << step;
    EXPECT_EQ(result.contacts, 13);
  }
  EXPECT_GT(stepper.bodies().velocity_at(3, Eigen::Vector3d::Zero()).x(), 0.5);
}

}  // namespace
}  // namespace softfinger
