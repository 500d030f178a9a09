#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "comparisons/exporting/pad_face.h"
#include "softfinger/input/contact_problem.h"

namespace softfinger::exporting {

struct ContactCurve;

/// The contact that is exported: one constant e_n, and one constant mu, chosen for the nominal
/// load.
struct SoftContact {
  double friction_coefficient = 0;      ///< largest force / load
  double load_N = 0;                    ///< nominal
  double eccentricity_m = 0;            ///< e_n that the simulator should have at that load
  double indentation_m = 0;             ///< of the model, at that load
  double normal_stiffness_N_per_m = 0;  ///< dP/dd of the model, at that load
  /// Torque per rotation about the normal before anything slips, at that load; 0: not known.
  double torsional_stiffness_Nm_per_rad = 0;
  double meters_per_unit = 1;   ///< the length unit of a USD stage, in m
  RelativeRadii radii;          ///< of the gap, at that load; of no meaning beside a face
  std::optional<PadFace> face;  ///< of a flat pad
  std::string origin;           ///< "silicone_pad_2mm, bonded_layer, 2 N", for comments

  /// Largest torque about the normal per newton of load: mu e_n.
  double torque_per_load_m() const { return friction_coefficient * eccentricity_m; }
};

/// The text to paste, and the numbers in it with their names (SI, the suffix is the unit).
struct Lines {
  std::string text;
  std::vector<std::pair<std::string, double>> values;
};

/// The marks of a comment line in a simulator's language.
struct CommentMarks {
  std::string_view open, close;
};
constexpr CommentMarks kPythonComment = {"# ", ""}, kCppComment = {"// ", ""},
                       kXmlComment = {"<!-- ", " -->"};

/// A simulator's law of torsional friction. Each simulator has a file in simulators/, which states
/// the law and where it is documented.
struct Simulator {
  std::string_view name;   ///< as typed on the command line
  std::string_view title;  ///< its name as its authors write it
  std::string_view law;    ///< its limit of tangential force and torque, in one line
  /// In the simulator, e_n is proportional to P to this power; 0 where the torque is a constant
  /// times the load.
  double load_exponent = 0;
  double least_torque_per_load_m = 0;            ///< the simulator raises smaller values to it
  Lines (*lines)(const SoftContact&) = nullptr;  ///< for one contact point, or one pressed patch
  /// For a pad's face as several points, at `PadFace::corner_box_m`, whose forces alone carry the
  /// torque.
  Lines (*box_lines)(const SoftContact&) = nullptr;
  std::vector<std::string_view> traps;  ///< peculiarities that change the result, a line each
  /// The version and the source files in which the law was read.
  std::string_view checked_against;
  /// Sentences that say where stiffness and damping go, or that the simulator has no place for
  /// them. `{k}` stands for dP/dd of each contact point, in N/m.
  std::string_view stiffness_place;
  CommentMarks comment = kPythonComment;
  std::string_view other_name = "";  ///< a second name that the command line takes
  bool friction_is_pyramid = false;  ///< of several contact points: see friction_pyramid.h
  bool has_torque = true;            ///< false: the simulator has no torsional friction at all
};

/// One per file simulators/NAME.cc, which defines NAME_simulator(), in the order of their names.
const std::vector<Simulator>& all_simulators();

/// Null when there is none of this name. An underscore is as good as a hyphen.
const Simulator* find_simulator(std::string_view name);

/// The lines for one contact point, or one pressed patch, with two comment lines: the model's
/// stiffness and its place in the simulator, and the source in which the law was read.
Lines point_lines(const Simulator& simulator, const SoftContact& contact);
/// Likewise the lines for a pad's face as several points.
Lines box_lines(const Simulator& simulator, const SoftContact& contact);

/// A case's name may contain two hyphens in a row, which end an XML comment.
std::string without_double_hyphens(std::string text);

/// One number in place of one that varies between two positive ends.
struct BestConstant {
  double value = 0;
  double worst_error = 0;  ///< largest |value/x - 1|, the same at both ends
};

/// The constant whose worst relative error is smallest: value = 2/(1/least + 1/largest), and the
/// error is (largest - least)/(largest + least).
BestConstant best_constant(double least, double largest);

/// e_n in the simulator at a load, with the exported lines.
double eccentricity_in_simulator_m(const Simulator& simulator, const SoftContact& contact,
                                   double load_N);

/// `nominal` is exact at the nominal load; `range` has the smallest worst error over the range.
enum class Fit { nominal, range };

/// The contact to export. `Fit::range`: in the simulator, the torque per load mu e at the nominal
/// load P0 becomes mu e (P/P0)^n at P, where n is its exponent. The relative error at P is thus mu
/// e/c - 1 with c = T(P)/P (P0/P)^n. Its largest magnitude over the range is smallest for the
/// `best_constant` of c. So is that of the force for the best constant of F(P)/P.
SoftContact soft_contact(const ContactCurve& curve, const Simulator& simulator, Fit fit);

/// Relative error of the largest force in the simulator, against the model, at each of the curve's
/// points: 0 under Coulomb's law.
std::vector<double> relative_force_errors(const SoftContact& contact, const ContactCurve& curve);

/// Relative error of the largest torque in the simulator, against the model, at each of the curve's
/// points.
std::vector<double> relative_errors(const Simulator& simulator, const SoftContact& contact,
                                    const ContactCurve& curve);

}  // namespace softfinger::exporting
