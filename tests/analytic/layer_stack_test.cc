// Layers of several sublayers: the kernel against its limits and against a solution through the
// thickness, contacts against independent numbers.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>

#include "softfinger/layer/circular_contact.h"
#include "softfinger/layer/stack_kernel.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

LayerStack stack_of(std::initializer_list<ElasticLayer> sublayers) {
  LayerStack stack;
  for (const ElasticLayer& one : sublayers) stack.sublayers[stack.count++] = one;
  return stack;
}

/// Surface displacement k under a unit of normal pressure cos kx, by quadratic finite elements
/// through the thickness for displacements U sin kx, W cos kx. Not for nu = 1/2.
double compliance_by_elements(const LayerStack& stack, double k, int elements_per_sublayer) {
  std::vector<double> z = {0};
  std::vector<ElasticLayer> material;
  for (std::size_t i = stack.count; i-- > 0;)
    for (int e = 0; e < elements_per_sublayer; ++e) {
      const double step = stack.sublayers[i].thickness_m / elements_per_sublayer;
      z.push_back(z.back() + step);
      material.push_back(stack.sublayers[i]);
    }
  const int nodes = 2 * int(material.size()) + 1;
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(2 * nodes, 2 * nodes);
  constexpr double kPlace = 0.7745966692414834;
  for (std::size_t e = 0; e < material.size(); ++e) {
    const double size = z[e + 1] - z[e], nu = material[e].poisson_ratio;
    const double G = material[e].shear_modulus_Pa(), lambda = 2 * G * nu / (1 - 2 * nu);
    Eigen::Matrix3d law;
    law << lambda + 2 * G, lambda, 0, lambda, lambda + 2 * G, 0, 0, 0, G;
    for (const double t : {-kPlace, 0., kPlace}) {
      const double weight = (t == 0 ? 8. / 9 : 5. / 9) * size / 2;
      const double n[] = {t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2};
      const double slope[] = {(2 * t - 1) / size, -4 * t / size, (2 * t + 1) / size};
      Eigen::Matrix<double, 3, 6> strain = Eigen::Matrix<double, 3, 6>::Zero();
      for (int i = 0; i < 3; ++i) {
        strain(0, 2 * i) = k * n[i];      // along x, cos kx
        strain(1, 2 * i + 1) = slope[i];  // through the thickness, cos kx
        strain(2, 2 * i) = slope[i];      // shear, sin kx
        strain(2, 2 * i + 1) = -k * n[i];
      }
      stiffness.block<6, 6>(4 * int(e), 4 * int(e)) += weight * strain.transpose() * law * strain;
    }
  }
  // The base is held.
  const int free = 2 * nodes - 2;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(free);
  force(free - 1) = 1;
  return stiffness.bottomRightCorner(free, free).ldlt().solve(force)(free - 1);
}

struct ExactStack {
  LayerStack stack;
  double radius_m, load_N, a_m, indentation_m, torque_arm_m, centre_Pa;
};

/// Exact round contacts, computed independently of this project, with some seven digits.
std::vector<ExactStack> exact_stacks() {
  const LayerStack skin = stack_of({{0.6e-3, 3e5, 0.45}, {2.4e-3, 6e4, 0.49}});
  const LayerStack stiff_below = stack_of({{1.5e-3, 1e5, 0.45}, {1.5e-3, 1e6, 0.45}});
  const LayerStack firm_skin = stack_of({{0.5e-3, 8e5, 0.48}, {2.5e-3, 1e5, 0.49}});
  return {{skin, 0.009, 0.004068129347, 0.00045, 3.09169196e-05, 0.000266576284, 9364.67974},
          {skin, 0.03, 0.02425886586, 0.0015, 6.43567726e-05, 0.000946286339, 3839.75478},
          {skin, 0.06, 0.1036858816, 0.003, 9.2630366e-05, 0.00184972624, 4990.99272},
          {skin, 0.12, 0.7147056315, 0.006, 0.000146870595, 0.00344518741, 11032.6947},
          {stiff_below, 0.009, 0.00171828221, 0.00045, 1.84999656e-05, 0.000265046183, 4053.04346},
          {stiff_below, 0.03, 0.02454897168, 0.0015, 4.59586666e-05, 0.000874279101, 5443.8551},
          {stiff_below, 0.06, 0.1574431834, 0.003, 7.86789062e-05, 0.0016955593, 9774.89493},
          {stiff_below, 0.12, 1.262476043, 0.006, 0.000142588108, 0.00327270067, 21636.6059},
          {firm_skin, 0.009, 0.009223781632, 0.00045, 3.70287744e-05, 0.000268645585, 20517.2671},
          {firm_skin, 0.03, 0.04442560415, 0.0015, 6.73143861e-05, 0.000975064738, 6323.87911},
          {firm_skin, 0.06, 0.18384251, 0.003, 9.42611065e-05, 0.00187822039, 8603.83826},
          {firm_skin, 0.12, 1.260086851, 0.006, 0.000147227254, 0.00346730544, 19252.4037}};
}

ContactProblem problem_of(const ExactStack& row) {
  ContactProblem problem{{row.radius_m, row.radius_m}, {}, {row.load_N, 0.7}};
  // The models that know no stacks would have this one.
  problem.layer = {row.stack.thickness_m(), 1e5, 0.48};
  problem.stack = row.stack;
  return problem;
}

}  // namespace

TEST(StackKernel, OfEqualSublayersIsThatOfOneLayer) {
  for (const double nu : {0.0, 0.3, 0.49, 0.5}) {
    const StackKernel stack(stack_of({{1e-3, 3e5, nu}, {0.5e-3, 3e5, nu}, {1.5e-3, 3e5, nu}}));
    EXPECT_NEAR(stack.depth(), 3, 1e-15);
    for (const double x : {1e-3, 0.1, 0.5, 1., 3., 10., 30.}) {
      EXPECT_NEAR(stack.compliance(x), LayerKernel(nu).compliance(3 * x), 2e-14) << nu << " " << x;
      EXPECT_NEAR(stack.stiffening(x), LayerKernel(nu).stiffening(3 * x), 2e-14) << nu << " " << x;
    }
  }
}

TEST(StackKernel, AgreesWithElementsThroughTheThickness) {
  const LayerStack stack =
      stack_of({{0.5e-3, 8e5, 0.48}, {1e-3, 1e5, 0.45}, {0.3e-3, 3e6, 0.2}, {1.2e-3, 5e4, 0.4}});
  const StackKernel kernel(stack);
  const double modulus_Pa = stack.surface().plane_strain_modulus_Pa();
  for (const double k_per_m : {30., 300., 1000., 3000., 8000.}) {
    const double w = compliance_by_elements(stack, k_per_m, 60) * modulus_Pa * k_per_m / 2;
    // Quadratic elements of a sixtieth of a sublayer: their own error, largest for short waves.
    EXPECT_NEAR(kernel.compliance(k_per_m * 0.5e-3) / w, 1, 2e-5) << k_per_m;
  }
}

TEST(StackKernel, ForgetsWhatLiesBelowARigidOrDeepSublayer) {
  // The lower sublayer yields by 1e-12 of the upper one, times the rounding of their ratio.
  const StackKernel on_rigid(stack_of({{1e-3, 3e5, 0.45}, {2e-3, 3e17, 0.3}}));
  for (const double x : {0.1, 1., 4.})
    EXPECT_NEAR(on_rigid.compliance(x) / LayerKernel(0.45).compliance(x), 1, 1e-9) << x;
  const StackKernel on_soft(stack_of({{1e-3, 3e5, 0.45}, {2e-3, 3e2, 0.3}}));
  EXPECT_GT(on_soft.compliance(0.5), 10);
  EXPECT_NEAR(on_soft.compliance(25), 1, 1e-14);
}

TEST(LayerFredholm, SolvesStacksExactly) {
  for (const ExactStack& row : exact_stacks()) {
    const Prediction p = find_pressure_model("layer_fredholm")->predict(problem_of(row));
    ASSERT_TRUE(p.has_answer);
    EXPECT_NEAR(p.a_m / row.a_m, 1, 1e-6);
    EXPECT_NEAR(p.indentation_m / row.indentation_m, 1, 1e-6);
    EXPECT_NEAR(p.torque_arm_exact_m / row.torque_arm_m, 1, 1e-6);
    EXPECT_NEAR(find_pressure_model("layer_fredholm")->pressure_Pa(problem_of(row), p, 0, 0) /
                    row.centre_Pa,
                1, 1e-5);
  }
}

TEST(LayerFft, SolvesStacksAsTheGridAllows) {
  // The bounds are those that the model's card states of one layer.
  for (const ExactStack& row : exact_stacks()) {
    const Prediction p = find_pressure_model("layer_fft")->predict(problem_of(row));
    ASSERT_TRUE(p.has_answer);
    std::printf("a %+.2e d %+.2e torque %+.2e\n", p.a_m / row.a_m - 1,
                p.indentation_m / row.indentation_m - 1,
                p.torque_arm_exact_m / row.torque_arm_m - 1);
    EXPECT_NEAR(p.a_m / row.a_m, 1, 1e-3);
    EXPECT_NEAR(p.indentation_m / row.indentation_m, 1, 3e-4);
    EXPECT_NEAR(p.torque_arm_exact_m / row.torque_arm_m, 1, 3e-4);
  }
}

TEST(PressureModel, KnowsItsLastStack) {
  // Solutions are kept for the last problem: another stack is another problem.
  const ExactStack row = exact_stacks().front();
  const PressureModel& model = *find_pressure_model("layer_fredholm");
  ContactProblem problem = problem_of(row);
  const double stacked_m = model.predict(problem).indentation_m;
  problem.stack.sublayers[1].youngs_modulus_Pa *= 2;
  EXPECT_LT(model.predict(problem).indentation_m, 0.95 * stacked_m);
  problem.stack = {};
  EXPECT_NE(model.predict(problem).indentation_m, stacked_m);
}

}  // namespace softfinger
