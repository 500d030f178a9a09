#include "softfinger/pressure/gradient.h"

#include <cmath>

namespace softfinger {
namespace {

Derivatives derivatives_of(const DifferentiatedNumber& number) noexcept {
  return {number.slope, 0};
}

/// The stiffness of the stuck contact, first by the five numbers that it depends on.
void add_stuck_stiffness(const DifferentiatedContact& contact, const ContactProblem& problem,
                         PredictionGradient& gradient) noexcept {
  using Number = Dual<5>;
  const ElasticLayer& layer = problem.layer;
  const StuckStiffnessOf<Number> stuck = stuck_stiffness<Number>(
      Number::variable(contact.a_m.value, 0), Number::variable(contact.b_m.value, 1),
      Number::variable(layer.thickness_m, 2), Number::variable(layer.youngs_modulus_Pa, 3),
      Number::variable(layer.poisson_ratio, 4));
  const auto chained = [&](const Number& number) {
    Derivatives derivatives;
    for (int i = 0; i < kContactVariables; ++i)
      derivatives.by[std::size_t(i)] = number.slope[0] * contact.a_m.slope[std::size_t(i)] +
                                       number.slope[1] * contact.b_m.slope[std::size_t(i)];
    derivatives.by[kThickness] += number.slope[2];
    derivatives.by[kYoungsModulus] += number.slope[3];
    derivatives.by[kPoissonRatio] += number.slope[4];
    return derivatives;
  };
  gradient.stuck = {stuck.torsional_Nm_per_rad.value, stuck.tangential_x_N_per_m.value,
                    stuck.tangential_y_N_per_m.value};
  gradient.torsional_stiffness_Nm_per_rad = chained(stuck.torsional_Nm_per_rad);
  gradient.tangential_stiffness_x_N_per_m = chained(stuck.tangential_x_N_per_m);
  gradient.tangential_stiffness_y_N_per_m = chained(stuck.tangential_y_N_per_m);
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
  // Where both curvatures are equal any axes are principal ones: the finger's.
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
  PredictionWithGradient result;
  result.prediction = model.predict(problem);
  if (!result.prediction.has_answer || problem.has_object_layer()) return result;
  const std::optional<DifferentiatedContact> contact = model.differentiated(problem);
  if (!contact) return result;
  PredictionGradient& gradient = result.gradient;
  gradient.known = true;
  gradient.a_m = derivatives_of(contact->a_m);
  gradient.b_m = derivatives_of(contact->b_m);
  gradient.indentation_m = derivatives_of(contact->indentation_m);
  gradient.area_m2 = derivatives_of(contact->a_m * contact->b_m * kPi);
  gradient.peak_pressure_Pa = derivatives_of(contact->peak_pressure_Pa);
  gradient.torque_arm_exact_m = derivatives_of(contact->torque_arm_exact_m);
  gradient.torque_arm_paper_m = derivatives_of(contact->torque_arm_paper_m);
  const double P = problem.load.normal_force_N, mu = problem.load.friction_coefficient;
  gradient.max_torque_Nm = derivatives_of(
      mu * (DifferentiatedNumber::variable(P, kNormalForce) * contact->torque_arm_exact_m));
  gradient.max_torque_Nm.by_friction_coefficient = P * result.prediction.torque_arm_exact_m;
  add_stuck_stiffness(*contact, problem, gradient);
  return result;
}

BodyDerivatives by_body_radii(const Derivatives& of, const BodyRadii& bodies) noexcept {
  using Number = Dual<5>;
  const auto curvature = [](double radius_m, int index) {
    // By the radius itself; a flat side has none.
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
