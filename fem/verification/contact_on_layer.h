#pragma once

#include <functional>

#include "fem/contact/pressing.h"
#include "fem/levels/friction_levels.h"
#include "fem/program/reference_solver.h"
#include "fem/verification/check.h"

/// Contacts by their dimensionless numbers, for the groups of checks.
namespace softfinger::fem::verification {

/// Expected results of a contact, SI, and the relative error of the reference that they come from.
struct Expected {
  double a_m = 0, b_m = 0, indentation_m = 0, max_torque_Nm = 0;
  double peak_pressure_Pa = 0;  ///< 0: not compared
  double reference_error = 0, edge_reference_error = 0;
  std::string reference;  ///< what it is, for the table
};

/// A bonded layer under a paraboloid with the radius of contact given: P R/(E* a³), d R/a²,
/// torque/(mu P a), p0 R/(E* a) at s = a/h, by the integral equation of the bonded layer (relative
/// 1e-8).
struct CircularLayer {
  double nu, s, load, approach, torque, peak;
};
/// @throws std::out_of_range where there is no such row
const CircularLayer& circular_layer(double nu, double s);
const std::vector<CircularLayer>& circular_layers();

Problem circular_problem(const CircularLayer& layer);
Expected expected_of(const CircularLayer& layer);

/// Residuals of every contact that was solved so far.
struct Residuals {
  double load = 0, complementarity = 0;
  int contacts = 0;
};
const Residuals& residuals_so_far();

/// Solves without messages of progress and keeps the residuals.
Result solve_quietly(const Problem& problem, ModelCache* models = nullptr);

/// d, torque, a, b (and peak pressure) against what is expected, each with its stated error.
Checks compare(const std::string& group, const std::string& name, const Problem& problem,
               const Expected& expected);

/// Compares on the meshes that were made for a larger load. There are no checks where these do not
/// suit.
/// @param larger_load  over the problem's load
Checks compare_reused(const std::string& group, const std::string& name, const Problem& problem,
                      const Expected& expected, double larger_load);

/// Solves friction on two meshes, `problem.level` - 1 and `problem.level`, of a contact whose
/// semi-axes are known. `make_plan` sets the motions of the slider. The result states friction and
/// its errors as the solver does; of the rest it has only the load and the largest torque.
Result friction_of(const Problem& problem, double a_m, double b_m,
                   const std::function<void(FrictionPlan&)>& make_plan);

/// A contact pressed on one mesh, `level` as in `Problem`.
Pressed press_at_level(const Problem& problem, double a_m, double b_m, int level);
PressedContact friction_start(const Pressed& pressed, const Problem& problem, double a_m,
                              double b_m);

}  // namespace softfinger::fem::verification
