#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

/// Results of the finite elements for one contact. The program writes them as JSON (fem/README.md),
/// and this is the one place that reads them.
namespace softfinger::reference {

/// Relative errors that the finite elements state for their own numbers, >= 0. Absent: not asked
/// for, or not known, as after a single level.
struct ReferenceErrors {
  std::optional<double> a, b, indentation, area, peak_pressure, max_torque;
  std::optional<double> load;  ///< where the approach was given
  std::optional<double> torsional_stiffness, full_slip_torque, torsion_curve;
  std::optional<double> limit_surface;  ///< of mu P and of the largest torque
};

/// The pressure along a half-axis, from the centre outwards. NaN where the program gave no number.
struct PressureProfile {
  std::vector<double> position_m, pressure_Pa;
};

/// One mesh's answer, the coarsest first. NaN: the program did not say.
struct ReferenceLevel {
  double a_m, b_m, indentation_m, peak_pressure_Pa, max_torque_Nm, cpu_s;
};

struct FrictionWrench {
  double force_x_N, force_y_N, torque_Nm;
};

/// A state on the way from sticking to full slip.
struct TwistState {
  double angle_rad, torque_Nm;
  double slip_fraction;  ///< of the contact's area, 0 to 1
};

struct TwistedContact {
  double stiffness_Nm_per_rad;  ///< of the stuck contact
  double full_slip_torque_Nm;
  std::vector<TwistState> states;
};

/// Force of the contact on a node, seen along the load from the contact's centre, x along its long
/// axis.
struct NodalForce {
  double x_m, y_m, force_N;
  double area_m2;                     ///< the node's share of the surface
  double friction_x_N, friction_y_N;  ///< on the layer, while it is pressed
};

/// Numbers of the contact when it is pressed without friction.
struct FrictionlessReference {
  double a_m, b_m, indentation_m, area_projected_m2, max_torque_Nm;
};

struct ReferenceResult {
  double load_N = 0;
  double a_m = 0, b_m = 0;
  double axis_rad = 0;  ///< of the long axis
  double indentation_m = 0;
  double peak_pressure_Pa = 0;
  double area_projected_m2 = 0;  ///< seen along the load: what models predict
  double area_m2 = 0;            ///< on the deformed surface
  double max_torque_Nm = 0;
  double eccentricity_m = 0;                  ///< e_n = torque / (mu P)
  std::optional<double> projected_torque_Nm;  ///< at finite strain: int mu p n_z r dA
  std::optional<double> peak_memory_MB, unknowns;
  double wall_s = 0, cpu_s = 0;                   ///< NaN: not said
  bool coarse = false;                            ///< stopped before the level that was asked for
  ReferenceErrors error;                          ///< of the elements
  std::optional<ReferenceErrors> geometry_error;  ///< what a scan's facets and noise leave open
  /// Whether `geometry_error` is unknown because a perturbed scan could not be pressed.
  bool is_geometry_unknown = false;
  std::optional<FrictionlessReference> frictionless;  ///< where it is pressed with friction
  std::vector<ReferenceLevel> levels;                 ///< at least one
  PressureProfile along_x, along_y;
  std::optional<std::string> vtu_file;
  std::optional<TwistedContact> twist;
  std::vector<FrictionWrench> limit_surface;
  std::optional<std::vector<NodalForce>> forces;  ///< where they were asked for
  /// The answer as the program wrote it. Files and pages also show entries that nothing here
  /// computes with.
  nlohmann::json document;
};

/// A result, or the flaw for which it is refused: a number that is missing, or one that no contact
/// can have. Exactly one of the two is there.
struct ReadReferenceResult {
  std::optional<ReferenceResult> result;
  std::string flaw;  ///< a few words
};
ReadReferenceResult read_reference_result(const nlohmann::json& document);

/// Largest stated errors of a reference with which models can be compared.
struct TrustLimits {
  double axes = 0.02;  ///< a and b
  double indentation_and_torque = 0.01;
  /// Largest error that a scan may leave open in a, b, area and torque: the tolerance of
  /// comparisons.
  double geometry = 0.1;
};
constexpr TrustLimits kTrustLimits;

/// Whether the elements' own errors are stated and within `kTrustLimits`: finer ones help else.
bool are_elements_trusted(const ReferenceErrors& error);

/// The largest of what a scan leaves open in a, b, area and torque: 0 for exact bodies, infinite
/// where it is not known.
double largest_geometry_error(const ReferenceResult& result);

/// Whether the elements are, and the scan leaves no more open than `kTrustLimits`, where finer
/// elements do not help.
bool is_trusted(const ReferenceResult& result);

/// "2 % in a and b, 1 % in indentation and torque"
std::string trust_limits_in_words();

}  // namespace softfinger::reference
