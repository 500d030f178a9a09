// A solver that has been sized is used in every step of a simulation: it must not touch the heap.
// Eigen takes its memory from malloc, past operator new, so that both are watched; the solvers are
// compiled once more here, with Eigen's own check (it aborts).
#include <gtest/gtest.h>

#include "tests/allocation_counter.h"
#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

class NoAllocation {
 public:
  NoAllocation() : before_(testing::allocations()) {
    Eigen::internal::set_is_malloc_allowed(false);
  }
  ~NoAllocation() {
    Eigen::internal::set_is_malloc_allowed(true);
    EXPECT_EQ(testing::allocations(), before_);
  }

 private:
  std::size_t before_;
};

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

}  // namespace
}  // namespace softfinger
