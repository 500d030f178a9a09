// A prediction belongs into a simulator's inner loop: it must not touch the heap.
#include <gtest/gtest.h>

#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/pressure/pressure_model.h"
#include "tests/allocation_counter.h"

namespace softfinger {
namespace {

TEST(Allocation, NoModelOfTheHotPathAllocatesToPredict) {
  for (const PressureModel* model : all_pressure_models()) {
    if (!model->card().hot_path) continue;
    double sum = 0;
    const std::size_t before = testing::allocations();
    for (const double poisson_ratio : {0.0, 0.3, 0.49, 0.5})
      for (const double ratio : {1.0, 3.0, 1e6})
        for (const double load_N : {-1.0, 1e-6, 1.0, 1e6}) {
          ContactProblem problem{
              {0.005 * ratio, 0.005}, {0.002, 3e5, poisson_ratio}, {load_N, 0.8}};
          problem.options.power_law = {0.003, 0.3, 2.5};
          const Prediction prediction = model->predict(problem);
          sum += model->pressure_Pa(problem, prediction, 0, 0);
          sum += FrictionEllipsoid{1, prediction.torque_arm_exact_m}.utilisation(0.1, 0.1, 0);
        }
    EXPECT_EQ(testing::allocations(), before) << model->card().name;
    EXPECT_GT(sum, 0);
  }
}

}  // namespace
}  // namespace softfinger
