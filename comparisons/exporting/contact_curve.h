#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/judgement/input_doubt.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"
#include "softfinger/pressure/pressure_model.h"

/// Numbers of a contact for a simulator, and the error that the simulator's law of torsional
/// friction makes with them.
namespace softfinger::exporting {

/// The loads that the user has given; those that are missing follow from the case.
struct LoadChoice {
  std::optional<double> nominal_N;             ///< > 0
  std::optional<std::vector<double>> range_N;  ///< lowest and highest, 0 < lowest < highest
};

/// The load that the constants are made for, and the range over which their error is stated.
struct LoadRange {
  double nominal_N = 0, lowest_N = 0, highest_N = 0;
  /// The time that the constants are made for, for a case with relaxation or history.
  double time_s = 0;
};

/// Chooses what the user has left open:
/// - The range is that of the case's loads, or P/3 to 3P if it has only one. If a given nominal
///   load lies outside, the range is widened to it.
/// - The nominal load is the median of the case's loads. If their number is even, it is the
///   geometric mean of the two middle ones. If a given range does not contain it, it is the
///   geometric mean of the range.
/// @throws InputError for a load that is not a number > 0, for a range that is not LOW,HIGH with
/// 0 < LOW < HIGH, and for a given nominal load outside of a given range.
LoadRange choose_loads(const std::vector<double>& case_loads_N, const LoadChoice& choice);

/// The answer of one model for a contact at one load.
struct LoadPoint {
  double load_N = 0;
  double friction_coefficient = 0;  ///< largest force / P: mu under Coulomb's law
  double eccentricity_m = 0;  ///< e_n = max torque / largest force, (6) of Ciocarlie et al. 2007
  double indentation_m = 0;
  double a_m = 0, b_m = 0;  ///< semi-axes of the contact
  std::string reason;       ///< why the answer is not usable; empty: it is
  prediction::Assessment assessment;
  std::optional<judgement::InputDoubt> inputs;  ///< what the case's own doubts move, if asked for
  double effective_load_N = 0;  ///< the elastic contact under it is as large; the load without time

  double max_force_N() const { return friction_coefficient * load_N; }
  double max_torque_Nm() const { return max_force_N() * eccentricity_m; }
  /// Bound of the torque's relative error, including what the fit of a mesh leaves open; NaN where
  /// it is not known.
  double error_bound() const { return assessment.total(prediction::Quantity::max_torque); }
};

/// The torsional friction limit of a contact against the load, by one model.
struct ContactCurve {
  std::string case_id, model;
  std::string when;  ///< " held 3 s"; empty for a case without time
  ShearLaw shear_law;
  RelativeRadii radii;  ///< at the nominal load; radii that are fitted to meshes depend on the load
  LoadPoint nominal;
  std::string advice;  ///< why its answer is not usable and what to do; empty: it is
  std::vector<LoadPoint>
      points;  ///< evenly spaced in ln P from lowest to highest load, and the nominal load
  /// d ln e_n / d ln P at the nominal load: 1/3 for Hertz, 1/4 for Winkler.
  double load_exponent = 0;
  /// d ln (largest force / P) / d ln P there: 0 under Coulomb's law, -1/3 for a constant stress on
  /// Hertz' ellipse.
  double friction_exponent = 0;
  double normal_stiffness_N_per_m = 0;        ///< dP/dd at the nominal load
  double torsional_stiffness_Nm_per_rad = 0;  ///< of the stuck contact there; 0: not known
};

/// Asks the model at each of these loads, about ten.
/// @param demand  what the assessments call usable
/// @param model  null: the recommended one at the nominal load
/// @throws InputError with the model's reason when it has no answer for one of them.
ContactCurve ask_contact_curve(const input::Case& contact_case,
                               const prediction::GeometryResolver& resolver,
                               const PressureModel* model, const LoadRange& loads,
                               const prediction::Demand& demand);

}  // namespace softfinger::exporting
