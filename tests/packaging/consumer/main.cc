#include <cmath>
#include <cstdio>

#include "softfinger/dynamics/step/time_stepper.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/pressure/pressure_model.h"

namespace {

struct NoContacts : softfinger::ContactFinder {
  void find(const softfinger::Multibody&, double, std::vector<softfinger::Contact>&) override {}
};

/// A ball that falls for a second, at constant acceleration: v = g t.
bool falls() {
  softfinger::BodyDescription ball;
  ball.name = "ball";
  ball.mass = softfinger::with_mass(
      softfinger::unit_mass_of_ellipsoid(Eigen::Vector3d::Constant(0.01)), 0.1);
  softfinger::TimeStepper stepper(softfinger::Multibody({ball}, {}), {}, {});
  NoContacts nothing;
  for (int step = 0; step < 1000; ++step)
    if (!stepper.step(nothing).done()) return false;
  return std::abs(stepper.bodies().velocity()[2] + 9.81) < 1e-12 * 1000;
}

}  // namespace

int main() {
  if (!falls()) return 2;
  softfinger::ContactProblem problem;
  problem.radii = {0.01, 0.01};
  problem.layer = {0.1, 0.75e6, 0.5};  // E* = 1 MPa
  problem.load = {5, 0.5};
  const auto* model = softfinger::find_pressure_model("hertz");
  if (!model) return 1;
  // a³ = 3 P R / (4 E*) for a sphere; the torque arm of a circle is 3 pi/16 of its radius.
  const double expected_a_m = std::cbrt(3 * 5 * 0.01 / (4 * 1e6));
  const softfinger::Prediction contact = model->predict(problem);
  std::printf("%zu models; a = %.6f mm\n", softfinger::all_pressure_models().size(),
              1e3 * contact.a_m);
  const double arm_m = softfinger::torque_arm_exact_m(contact.a_m, contact.b_m, 0.5);
  const double pi = std::acos(-1.0);
  return std::abs(contact.a_m / expected_a_m - 1) < 1e-12 &&
                 std::abs(arm_m / (3 * pi / 16 * expected_a_m) - 1) < 1e-12
             ? 0
             : 1;
}
