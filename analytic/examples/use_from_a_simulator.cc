// The numbers that a simulator needs for torsional friction at a soft fingertip: a 2 mm silicone
// pad on a fingertip that touches an object with relative radii of 20 and 5 mm.
#include <cstdio>

#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/pressure/pressure_model.h"

int main() {
  softfinger::ContactProblem problem;
  problem.radii = {0.020, 0.005};        // R', R'' in m
  problem.layer = {0.002, 300e3, 0.45};  // thickness in m, Young's modulus in Pa, Poisson's ratio
  problem.load.friction_coefficient = 0.8;
  const softfinger::PressureModel* model = softfinger::find_pressure_model("hertz");
  for (const double normal_force_N : {0.02, 0.1, 0.5}) {
    problem.load.normal_force_N = normal_force_N;
    const softfinger::Prediction contact = model->predict(problem);  // no exception, no allocation
    if (!contact.has_answer) continue;
    const softfinger::FrictionEllipsoid limit{problem.load.friction_coefficient * normal_force_N,
                                              contact.torque_arm_exact_m};
    std::printf("P = %.2f N: a = %.3f mm, b = %.3f mm, e_n = %.4f mm, max torque = %.4f mN m%s\n",
                normal_force_N, 1e3 * contact.a_m, 1e3 * contact.b_m, 1e3 * limit.eccentricity_m,
                1e3 * limit.max_torque_Nm(), contact.valid() ? "" : " (outside its validity)");
    for (const softfinger::ValidityCheck& check : contact.validity)
      if (!check.holds()) std::printf("    %s\n", check.message);
  }
}
