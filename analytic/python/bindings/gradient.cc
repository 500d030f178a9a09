#include "softfinger/pressure/gradient.h"

#include "analytic/python/bindings/contacts.h"
#include "softfinger/pressure/rubbed_prediction.h"

namespace softfinger::python {
namespace {

/// Numbers and variables are in the order of softfinger/_gradient.py.
constexpr std::size_t kNumbers = 12, kVariables = kContactVariables + 1;
constexpr std::array<ContactVariable, kContactVariables> kVariablesInOrder{
    kNormalForce, kYoungsModulus,    kPoissonRatio,     kThickness,        kRadiusMajor,
    kRadiusMinor, kFingerCurvatureX, kFingerCurvatureY, kFingerCurvatureXY};

std::array<const Derivatives*, kNumbers> numbers_of(const PredictionGradient& gradient,
                                                    const PredictionGradient& pressed) {
  return {&pressed.a_m,
          &pressed.b_m,
          &pressed.indentation_m,
          &pressed.area_m2,
          &pressed.peak_pressure_Pa,
          &pressed.torque_arm_exact_m,
          &gradient.torque_arm_exact_m,
          &gradient.torque_arm_paper_m,
          &gradient.max_torque_Nm,
          &pressed.torsional_stiffness_Nm_per_rad,
          &pressed.tangential_stiffness_x_N_per_m,
          &pressed.tangential_stiffness_y_N_per_m};
}

/// Whether derivatives are known, the three stuck stiffnesses (3, n), and derivatives
/// (numbers, variables, n): each derivative is contiguous.
py::tuple gradient(const std::optional<std::string>& name, const py::dict& numbers) {
  const AskedModel model(name);
  const Contacts contacts(numbers);
  const std::size_t count = contacts.count();
  py::array_t<bool> known{py::ssize_t(count)};
  Numbers stiffness({std::size_t(3), count}), derivatives({kNumbers, kVariables, count});
  bool* is_known = known.mutable_data();
  double *stuck = stiffness.mutable_data(), *by = derivatives.mutable_data();
  {
    const py::gil_scoped_release others_may_run;
    for (std::size_t i = 0; i < count; ++i) {
      const ContactProblem problem = contacts.problem(i);
      const PressureModel& one = model.of(problem);
      const PredictionWithGradient frictionless = predict_with_gradient(one, problem);
      const PredictionGradient& of = frictionless.gradient;
      const PredictionWithGradient pressed =
          knows_pressing_friction(one)
              ? rubbed(one, frictionless, problem, contacts.pressing_friction_coefficient(i))
              : frictionless;
      is_known[i] = of.known;
      const StuckStiffness& sticking = pressed.gradient.stuck;
      stuck[i] = sticking.torsional_Nm_per_rad;
      stuck[count + i] = sticking.tangential_x_N_per_m;
      stuck[2 * count + i] = sticking.tangential_y_N_per_m;
      const std::array<const Derivatives*, kNumbers> rows = numbers_of(of, pressed.gradient);
      for (std::size_t number = 0; number < kNumbers; ++number)
        for (std::size_t variable = 0; variable < kVariables; ++variable)
          by[(number * kVariables + variable) * count + i] =
              variable < kContactVariables ? rows[number]->by[kVariablesInOrder[variable]]
                                           : rows[number]->by_friction_coefficient;
    }
  }
  return py::make_tuple(known, stiffness, derivatives);
}

}  // namespace

void bind_gradient(py::module_& module) { module.def("gradient", &gradient); }

}  // namespace softfinger::python
