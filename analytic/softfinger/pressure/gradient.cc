#include "softfinger/pressure/gradient.h"

#include <algorithm>
#include <cmath>

#include "softfinger/math/wide.h"

namespace softfinger {
namespace {

/// Adds the derivative with respect to E, of contacts of one problem.
struct Expansion {
  double load_N, modulus_Pa;
  double elastic;  ///< 1 where the contact's lengths depend on P/E, 0 where they depend on P

  /// @param power  of E that the number is proportional to where P/E (elastic), or P, is kept
  Derivatives operator()(const DifferentiatedNumber& number, double power = 0) const noexcept {
    Derivatives derivatives;
    std::copy(number.slope.begin(), number.slope.end(), derivatives.by.begin());
    derivatives.by[kYoungsModulus] =
        (power * number.value - elastic * (load_N * number.slope[kNormalForce])) / modulus_Pa;
    return derivatives;
  }
};

/// The stiffness of the stuck contact, which is proportional to E.
void add_stuck_stiffness(const DifferentiatedContact& contact, const ContactProblem& problem,
                         const Expansion& expanded, PredictionGradient& gradient) noexcept {
  const ElasticLayer& layer = problem.layer;
  const DifferentiatedNumber& a_m = contact.numbers.a_m;
  const DifferentiatedNumber& b_m = contact.numbers.b_m;
  // First by the four numbers that it depends on otherwise.
  using Number = Dual<4>;
  const StuckStiffnessOf<Number> stuck =
      stuck_stiffness<Number>(Number::variable(a_m.value, 0), Number::variable(b_m.value, 1),
                              Number::variable(layer.thickness_m, 2), layer.youngs_modulus_Pa,
                              Number::variable(layer.poisson_ratio, 3));
  const auto add = [&](const Number& number, double& value, Derivatives& derivatives) {
    DifferentiatedNumber chained = number.value;
    for (std::size_t i = 0; i < kYoungsModulus; ++i)
      chained.slope[i] = number.slope[0] * a_m.slope[i] + number.slope[1] * b_m.slope[i];
    chained.slope[kThickness] += number.slope[2];
    chained.slope[kPoissonRatio] += number.slope[3];
    value = number.value;
    derivatives = expanded(chained, 1);
  };
  add(stuck.torsional_Nm_per_rad, gradient.stuck.torsional_Nm_per_rad,
      gradient.torsional_stiffness_Nm_per_rad);
  add(stuck.tangential_x_N_per_m, gradient.stuck.tangential_x_N_per_m,
      gradient.tangential_stiffness_x_N_per_m);
  add(stuck.tangential_y_N_per_m, gradient.stuck.tangential_y_N_per_m,
      gradient.tangential_stiffness_y_N_per_m);
}

void add_gradient(const DifferentiatedContact& contact, const ContactProblem& problem,
                  PredictionGradient& gradient) noexcept {
  const double P = problem.load.normal_force_N, mu = problem.load.friction_coefficient;
  const Expansion expanded = {P, problem.layer.youngs_modulus_Pa, contact.is_elastic ? 1. : 0.};
  const auto& numbers = contact.numbers;
  gradient.known = true;
  gradient.a_m = expanded(numbers.a_m);
  gradient.b_m = expanded(numbers.b_m);
  gradient.indentation_m = expanded(numbers.indentation_m);
  gradient.area_m2 = expanded(numbers.a_m * numbers.b_m * kPi);
  gradient.peak_pressure_Pa = expanded(numbers.peak_pressure_Pa, expanded.elastic);
  gradient.torque_arm_exact_m = expanded(numbers.torque_arm_exact_m);
  gradient.torque_arm_paper_m = expanded(numbers.torque_arm_paper_m);
  for (std::size_t i = 0; i < kContactVariables; ++i)
    gradient.max_torque_Nm.by[i] = mu * P * gradient.torque_arm_exact_m.by[i];
  gradient.max_torque_Nm.by[kNormalForce] += mu * numbers.torque_arm_exact_m.value;
  gradient.max_torque_Nm.by_friction_coefficient = P * numbers.torque_arm_exact_m.value;
  add_stuck_stiffness(contact, problem, expanded, gradient);
}

template <class Real>
struct Gap {
  Real radius_major_m, radius_minor_m;
  Real finger_xx_per_m, finger_yy_per_m, finger_xy_per_m;
  Real cos_2_axis, sin_2_axis;  ///< of twice the angle from the finger's x to the long axis
};

/// Eigenvalues and axes of the sum of both bodies' curvatures.
/// @param curvatures  of the finger along its x and y, of the object along its own
template <class Real>
Gap<Real> gap_of(const std::array<Real, 4>& curvatures, const Real& cos_2_angle,
                 const Real& sin_2_angle, bool* is_elliptic) noexcept {
  using plain::sqrt;
  // Deviators (xx - yy)/2 and xy; the finger's axes are the frame's.
  const Real finger = 0.5 * (curvatures[0] - curvatures[1]);
  const Real object = 0.5 * (curvatures[2] - curvatures[3]);
  const Real mean = 0.5 * (curvatures[0] + curvatures[1] + curvatures[2] + curvatures[3]);
  const Real deviator_x = finger + object * cos_2_angle, deviator_y = object * sin_2_angle;
  const Real squared = deviator_x * deviator_x + deviator_y * deviator_y;
  // With equal curvatures any axes are principal ones: the finger's are taken.
  const bool is_round = !(squared > 1e-24 * (mean * mean));
  const Real deviator = is_round ? Real(0) : sqrt(squared);
  const Real low = mean - deviator, high = mean + deviator;
  *is_elliptic = low > 0.;
  // The long axis lies along the least curvature: cos and sin of twice its angle.
  const Real cos_2 = is_round ? Real(1) : -1. * deviator_x / deviator;
  const Real sin_2 = is_round ? Real(0) : -1. * deviator_y / deviator;
  const Real finger_mean = 0.5 * (curvatures[0] + curvatures[1]);
  return {1. / low,
          1. / high,
          finger_mean + finger * cos_2,
          finger_mean - finger * cos_2,
          -1. * finger * sin_2,
          cos_2,
          sin_2};
}

}  // namespace

PredictionWithGradient predict_with_gradient(const PressureModel& model,
                                             const ContactProblem& problem) noexcept {
  std::optional<DifferentiatedContact> contact;
  PredictionWithGradient result = {model.predict_differentiated(problem, &contact), {}};
  if (result.prediction.has_answer && contact)
    with_best_instructions([&] { add_gradient(*contact, problem, result.gradient); });
  return result;
}

BodyDerivatives by_body_radii(const Derivatives& of, const BodyRadii& bodies) noexcept {
  using Number = Dual<5>;
  const auto curvature = [](double radius_m, int index) {
    // Derivative with respect to the radius itself; zero for a flat side.
    return Number::chain(Number::variable(0, index), 1 / radius_m, -1 / radius_m / radius_m);
  };
  bool is_elliptic = false;
  const double twice = 2 * bodies.angle_rad;
  const Number angle = Number::variable(bodies.angle_rad, 4);
  const Gap<Number> gap =
      gap_of<Number>({curvature(bodies.finger_x_m, 0), curvature(bodies.finger_y_m, 1),
                      curvature(bodies.object_x_m, 2), curvature(bodies.object_y_m, 3)},
                     Number::chain(angle, std::cos(twice), -2 * std::sin(twice)),
                     Number::chain(angle, std::sin(twice), 2 * std::cos(twice)), &is_elliptic);
  Number sum;
  const auto add = [&](ContactVariable variable, const Number& number) {
    sum += of.by[variable] * number;
  };
  add(kRadiusMajor, gap.radius_major_m);
  add(kRadiusMinor, gap.radius_minor_m);
  add(kFingerCurvatureX, gap.finger_xx_per_m);
  add(kFingerCurvatureY, gap.finger_yy_per_m);
  add(kFingerCurvatureXY, gap.finger_xy_per_m);
  return {sum.slope[0], sum.slope[1], sum.slope[2], sum.slope[3], sum.slope[4]};
}

bool set_bodies(const BodyRadii& bodies, ContactProblem& problem) noexcept {
  bool is_elliptic = false;
  const double twice = 2 * bodies.angle_rad;
  const Gap<double> gap = gap_of<double>(
      {1 / bodies.finger_x_m, 1 / bodies.finger_y_m, 1 / bodies.object_x_m, 1 / bodies.object_y_m},
      std::cos(twice), std::sin(twice), &is_elliptic);
  if (!is_elliptic) return false;
  problem.radii = {gap.radius_major_m, gap.radius_minor_m,
                   0.5 * std::atan2(gap.sin_2_axis, gap.cos_2_axis)};
  problem.finger_curvature = {gap.finger_xx_per_m, gap.finger_yy_per_m, gap.finger_xy_per_m};
  return true;
}

}  // namespace softfinger
