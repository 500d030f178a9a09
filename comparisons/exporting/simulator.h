#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "comparisons/exporting/contact_curve.h"

namespace softfinger::exporting {

/// A contact as a simulator is told it: one eccentricity, made for the nominal load.
struct SoftContact {
  double friction_coefficient = 0;
  double load_N = 0;          ///< nominal
  double eccentricity_m = 0;  ///< e_n that the simulator shall have at that load
  double indentation_m = 0;   ///< of the model, at that load
  RelativeRadii radii;        ///< of the gap, at that load
  std::string origin;         ///< "silicone_pad_2mm, bonded_layer, 2 N", for comments

  /// Largest torque about the normal per newton of load: mu e_n.
  double torque_per_load_m() const { return friction_coefficient * eccentricity_m; }
};

/// What to paste, and its numbers with their names (SI, the suffix is the unit).
struct Lines {
  std::string text;
  std::vector<std::pair<std::string, double>> values;
};

/// A simulator's law of torsional friction. One simulator is one file beside this one, which says
/// what the law is and where that is written.
struct Simulator {
  std::string_view name;   ///< as typed on the command line
  std::string_view title;  ///< as its authors write it
  std::string_view law;    ///< its limit of force and torque, in one line
  /// Its own e_n is proportional to P^this: 0 where the torque is a constant times the load.
  double load_exponent = 0;
  double least_torque_per_load_m = 0;  ///< smaller values are raised to it
  Lines (*lines)(const SoftContact&) = nullptr;
  std::vector<std::string_view> traps;  ///< a line each
};

Simulator mujoco();
Simulator bullet();
Simulator gazebo();
Simulator drake();
Simulator physx();

/// In the order above.
const std::vector<Simulator>& all_simulators();

/// e_n that the simulator has at a load once the contact's lines are in it.
double eccentricity_in_simulator_m(const Simulator& simulator, const SoftContact& contact,
                                   double load_N);

/// `nominal` is exact at the nominal load; `range` has the smallest worst error over the range.
enum class Fit { nominal, range };

/// The contact that the simulator is told. With c = e_n(P) (P0/P)^n over the range, n the
/// simulator's exponent, the worst of |e/c - 1| is smallest for e = 2 / (1/min c + 1/max c).
SoftContact soft_contact(const ContactCurve& curve, const Simulator& simulator, Fit fit);

/// Torque that the simulator allows against the model's, less one, at each of the curve's points.
std::vector<double> relative_errors(const Simulator& simulator, const SoftContact& contact,
                                    const ContactCurve& curve);

}  // namespace softfinger::exporting
