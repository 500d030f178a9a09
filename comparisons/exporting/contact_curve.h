#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/prediction/local_geometry.h"
#include "softfinger/pressure/pressure_model.h"

/// What to type into a simulator, and what its law of torsional friction makes of it.
namespace softfinger::exporting {

/// What the user said of the loads; what is empty follows from the case.
struct LoadChoice {
  std::optional<double> nominal_N;             ///< > 0
  std::optional<std::vector<double>> range_N;  ///< lowest and highest, 0 < lowest < highest
};

/// The load that a simulator's constants are made for, and the loads that it will meet.
struct LoadRange {
  double nominal_N = 0, lowest_N = 0, highest_N = 0;
};

/// Without a choice: the range is the case's loads, or P/3 to 3P if it has one; the nominal load is
/// their middle one, the geometric mean of the two middle ones if they are even in number. A
/// nominal load beyond the case's loads widens the range; a range without the case's middle load
/// has its own geometric middle.
/// @throws InputError for a load that is no number > 0, a range that is none, a nominal load
/// outside of a range that was given.
LoadRange choose_loads(const std::vector<double>& case_loads_N, const LoadChoice& choice);

/// What one model says of a contact at one load.
struct LoadPoint {
  double load_N = 0;
  double eccentricity_m = 0;  ///< e_n = max torque / (mu P), (6) of Ciocarlie et al. 2007
  double indentation_m = 0;
  std::string objection;  ///< why the model does not hold there, in its words; empty: it holds

  bool valid() const { return objection.empty(); }
};

/// How a contact's torsional limit follows its load, by one model.
struct ContactCurve {
  std::string case_id, model;
  double friction_coefficient = 0;
  RelativeRadii radii;  ///< at the nominal load; those fitted to meshes vary with it
  LoadPoint nominal;
  std::vector<LoadPoint>
      points;  ///< evenly spaced in ln P from lowest to highest, with the nominal
  /// d ln e_n / d ln P at the nominal load: 1/3 for Hertz, 1/4 for Winkler.
  double load_exponent = 0;
};

/// Asks the model at each load, some ten times.
/// @throws InputError when the model has no answer for one of them, in its own words.
ContactCurve ask_contact_curve(const input::Case& contact_case,
                               const prediction::GeometryResolver& resolver,
                               const PressureModel& model, const LoadRange& loads);

}  // namespace softfinger::exporting
