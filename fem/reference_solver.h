#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "softfinger/input/contact_problem.h"

/// The finite-element reference: a rigid quadric pressed without friction on an elastic layer
/// bonded to a rigid base, small strain. Nothing in this header depends on the finite-element
/// library, and nothing behind it on the analytic models: the judge does not borrow from the
/// judged.
namespace softfinger::fem {

/// What to solve. The gap is that of `contact.radii`; with a finite `sphere_radius_m` the
/// indenter's paraboloid is replaced by the exact sphere of that radius (both radii must equal it).
struct Problem {
  std::string name = "case";
  ContactProblem contact;
  double sphere_radius_m = std::numeric_limits<double>::infinity();
  int level = 2;                 ///< 1 to 4: elements per contact semi-axis double with each level
  std::string output_directory;  ///< for VTU; empty: none
};

/// One discretisation's answer, SI.
struct LevelResult {
  int level = 0;
  int elements_per_semi_axis = 0;
  long unknowns = 0;
  int active_nodes = 0;  ///< contact nodes of the quarter model
  int iterations = 0;    ///< of the active set
  double a_m = 0, b_m = 0, indentation_m = 0, peak_pressure_Pa = 0, max_torque_Nm = 0;
  double load_residual = 0;  ///< |sum of nodal forces - P| / P
  double complementarity_residual =
      0;  ///< worst penetration or tension, relative to d and to the peak pressure
  double fit_residual =
      0;  ///< rms of the pressure fit that gives a, b, relative to the mean pressure
  double wall_s = 0;
};

/// Relative, stated at about 95 % confidence.
struct RelativeError {
  double a = 0, b = 0, area = 0, indentation = 0, peak_pressure = 0, max_torque = 0;
};

struct Profile {
  std::vector<double> position_m, pressure_Pa;
};

struct Result {
  LevelResult finest;
  std::vector<LevelResult> levels;  ///< coarse to fine, `finest` included
  RelativeError error;
  double pressure_exponent =
      0;  ///< n of p0 (1 - r²)^n with the same load, area and peak: pi a b p0 / P - 1
  Profile along_x, along_y;  ///< nodal pressure from the centre outwards
  std::string vtu_file;      ///< empty when none was asked for
  double wall_s = 0, peak_memory_MB = 0;
};

/// Called as the work proceeds: one line of plain text per event.
using Progress = std::function<void(const std::string&)>;

/// @throws InputError for a problem outside the ranges (nu >= 1/2, load <= 0, a contact wider than
/// the gap's model can bear, ...)
/// @throws ConvergenceError with stage, iteration, residual and hint.
Result solve(const Problem& problem, const Progress& progress);

}  // namespace softfinger::fem
