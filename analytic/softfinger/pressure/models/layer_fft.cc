#include "softfinger/pressure/layer_fft.h"

#include <algorithm>
#include <cmath>

#include "softfinger/fft/layer_contact.h"
#include "softfinger/input/constants.h"
#include "softfinger/math/elliptic_integrals.h"
#include "softfinger/pressure/last_solution.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/validity.h"

namespace softfinger::models {
namespace {

constexpr double kLargestRadiiRatio = 100;

/// int f dA over the contact, in polar coordinates in which its edge is a circle: points denser
/// towards the edge (r = sin t), where the pressure is steep.
template <class Function>
double integrate_contact(const fft::ContactEdge& edge, Function f) {
  constexpr int kRadial = 48, kAngular = 96;
  double sum = 0;
  for (int j = 0; j < kAngular; ++j) {
    const double angle = 2 * kPi * (j + 0.5) / kAngular;
    const double x = edge.a * std::cos(angle), y = edge.b * std::sin(angle);
    const double edge_radius = 1 / edge.relative_radius(x, y);
    for (int i = 0; i < kRadial; ++i) {
      const double t = kPi / 2 * (i + 0.5) / kRadial;
      const double r = edge_radius * std::sin(t);
      sum += edge_radius * edge_radius * std::sin(t) * std::cos(t) * f(r * x, r * y);
    }
  }
  return sum * edge.a * edge.b * (kPi / 2 / kRadial) * (2 * kPi / kAngular);
}

/// A solved contact, and the factor (within 1 % of 1) by which its interpolated pressure misses
/// the load.
struct Solution {
  LayerContact contact;
  double normalisation = 1;
};

/// @throws what solve_layer_contact throws
const Solution& solution_of(const ContactProblem& problem) {
  return last_solution<Solution>(problem, [&] {
    Solution solution;
    solution.contact = solve_layer_contact(problem.radii, problem.finger_layers(),
                                           problem.object_layer, problem.load.normal_force_N);
    const double load_N = integrate_contact(solution.contact.edge, [&](double x, double y) {
      return solution.contact.pressure_at_Pa(x, y);
    });
    solution.normalisation = problem.load.normal_force_N / load_N;
    return solution;
  });
}

/// All but the check of the slope, which needs the gap.
Prediction to_prediction(const LayerContact& contact) noexcept {
  Prediction prediction;
  prediction.has_answer = true;
  // On a circle the two differ by rounding.
  prediction.a_m = std::max(contact.edge.a, contact.edge.b);
  prediction.b_m = std::min(contact.edge.a, contact.edge.b);
  prediction.indentation_m = contact.approach_m;
  prediction.peak_pressure_Pa = contact.peak_pressure_Pa;
  prediction.torque_arm_exact_m = contact.torque_arm_m;
  const double aspect = prediction.b_m / prediction.a_m;
  prediction.torque_arm_paper_m = contact.torque_arm_m * std::sqrt(aspect) * (kPi / 2) /
                                  elliptic_integrals(aspect * aspect).E();
  prediction.validity.add(
      {"grid_resolves_layer", contact.cells_per_thickness, 2, false,
       "the layer is thinner than two cells of the grid: the deformation at the contact's edge "
       "is not resolved, and indentation and torque are off by more than 0.1 %"});
  return prediction;
}

ValidityCheck strain_check(const LayerContact& contact, const ContactProblem& problem) noexcept {
  double strain = contact.layer_displacement_m / problem.layer.thickness_m;
  if (problem.has_object_layer())
    strain = std::max(strain, contact.object_displacement_m / problem.object_layer.thickness_m);
  return small_strain_check(strain);
}

/// Steepest gap at the contact's edge, by differences over a cell towards the inside, where the gap
/// is known.
double steepest_slope(const GapFunction& gap_m, const LayerContact& contact) {
  const double step_x = contact.grid.size_x, step_y = contact.grid.size_y;
  double steepest = 0;
  for (Eigen::Index k = 0; k < contact.edge.points.cols(); ++k) {
    const double x = contact.edge.points(0, k), y = contact.edge.points(1, k);
    const double inner_x = x - std::copysign(step_x, x - contact.edge.centre.x());
    const double inner_y = y - std::copysign(step_y, y - contact.edge.centre.y());
    const double here = gap_m(x, y);
    steepest = std::max(steepest, std::hypot((gap_m(inner_x, y) - here) / step_x,
                                             (gap_m(x, inner_y) - here) / step_y));
  }
  return steepest;
}

class LayerFft final : public PressureModel {
 public:
  const ModelCard& card() const noexcept override {
    static const ModelCard card{
        "layer_fft",
        "Bonded elastic layers, solved on a grid of 128 x 128 cells",
        "Linear elasticity; layers of any thickness, homogeneous or of bonded sublayers, on rigid "
        "bases, the finger's and, where "
        "there is one, the object's; no friction in the normal problem; the gap is a quadric or "
        "any smooth one (softfinger predict --gap sampled), shallow inside the contact. The "
        "contact's edge is free: a and b are those of its best-fitting ellipse.",
        "u^(k) = 2 w(kh)/(E* k) p^(k), w(x) = [2 kappa sinh 2x - 4x]/[2 kappa cosh 2x + 4x² + 1 + "
        "kappa²], kappa = 3 - 4 nu, two layers add; p >= 0, u + gap >= d, complementary; Galerkin "
        "with constant pressure per cell, convolution by FFT, conjugate gradients; arm of the "
        "torque: (int p r dA)/P (exact), divided by (2/pi) sqrt(a/b) E(m) (paper)",
        "K. L. Johnson, Contact Mechanics (1985), section 5.8; I. A. Polonsky, L. M. Keer, Wear "
        "231 (1999) 206",
        "any nu, any sqrt(ab)/h below about 25 (h above two cells); R'/R'' up to 100; a/R', b/R'' "
        "and d/h below 0.3. Indentation and torque within 0.03 %, a and b within 0.1 % of exact "
        "solutions; the pressure between the cells balances load and torque within 0.5 %",
        "about 20 ms",
        false,
        false,
        {5e-3, 3e-2, 3e-3,
         "the pressure is constant in each of 128 x 128 cells and interpolated between them, also "
         "across the edge, which lies within a cell; a and b are within 0.1 %"}};
    return card;
  }

  bool knows_stacks() const noexcept override { return true; }

  Prediction predict(const ContactProblem& problem) const noexcept override {
    const ValidityCheck violation = first_range_violation(problem);
    if (*violation.check) return no_answer(violation);
    const double ratio = problem.radii.major_m / problem.radii.minor_m;
    if (!(ratio <= kLargestRadiiRatio))
      return no_answer({"radii_ratio", std::min(ratio, std::numeric_limits<double>::max()),
                        kLargestRadiiRatio, true,
                        "no answer: the contact is too long for a grid of 128 x 128 cells"});
    try {
      const LayerContact& contact = solution_of(problem).contact;
      Prediction prediction = to_prediction(contact);
      prediction.validity.add(small_slope_check(prediction, problem.radii));
      prediction.validity.add(strain_check(contact, problem));
      return finite_or_no_answer(prediction, problem);
    } catch (...) {
      // Failures that the checks above cannot foresee: a layer far thinner than a cell, numbers
      // that overflow, no memory.
      return no_answer({"solved", 0, 1, false,
                        "no answer: the grid's equations could not be solved; the layer may be so "
                        "thin against the contact that no grid resolves it"});
    }
  }

  double pressure_Pa(const ContactProblem& problem, const Prediction& prediction, double x_m,
                     double y_m) const noexcept override {
    if (!prediction.has_answer) return 0;
    try {
      const Solution& solution = solution_of(problem);
      return solution.normalisation * solution.contact.pressure_at_Pa(x_m, y_m);
    } catch (...) {
      return 0;
    }
  }
};

}  // namespace

const PressureModel& layer_fft_model() {
  static const LayerFft model;
  return model;
}

}  // namespace softfinger::models

namespace softfinger {

GapPrediction predict_layer_fft(const GapFunction& gap_m, const GapWindow& window,
                                const ContactProblem& problem) {
  GapPrediction result;
  result.contact = solve_layer_contact(gap_m, window, problem.finger_layers(), problem.object_layer,
                                       problem.load.normal_force_N);
  result.prediction = models::to_prediction(result.contact);
  result.prediction.validity.add(
      {"small_slope", models::steepest_slope(gap_m, result.contact), 0.3, true,
       "the surfaces are steep against each other at the contact's edge, where a vertical pressure "
       "does not describe them; the torque is underestimated"});
  result.prediction.validity.add(models::strain_check(result.contact, problem));
  result.prediction = finite_or_no_answer(result.prediction, problem);
  return result;
}

}  // namespace softfinger
