#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "softfinger/friction/sampled_pressure.h"
#include "softfinger/pads/pad_shape.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// Friction while a pad is pressed. Rubber sticks where mu exceeds 0.3 (nu = 0.3) to 0.9
/// (nu = 0.49); between, stuck is the limit that stiffness and pressure approach.
enum class PadPressing { stuck, frictionless };

/// A rigid cylinder that lies across a rectangular pad, along the outline's x.
struct CylinderOnPad {
  double radius_m = 0;  ///< > 0; of a roller on an object: of the gap
  double offset_m = 0;  ///< of its axis, along y
};

/// A flat pad, bonded to a rigid backing, pressed by a rigid plane or cylinder. SI.
struct PadProblem {
  const PadShape* shape = nullptr;  ///< of the contact; not owned
  ElasticLayer layer;               ///< ranges as in contact_problem.h
  ContactLoad load;
  PadPressing pressing = PadPressing::stuck;
  /// The load's place, in the outline's coordinates; none: both faces stay parallel.
  std::optional<Eigen::Vector2d> load_at_m;
  /// none: a plane. Taken by line_layer alone; without friction, and no `load_at_m`.
  std::optional<CylinderOnPad> cylinder;
};

/// All values are finite; zero where the model has no answer. Moments and what belongs to them are
/// in pairs: about the x and about the y axis, so that the first moves the pressure along y.
struct PadPrediction {
  bool has_answer = false;
  double indentation_m = 0;  ///< approach d of the faces at the outline's centroid
  double half_width_m = 0;   ///< b of a line contact, in its middle
  double normal_stiffness_N_per_m = 0;
  /// Largest pressure within 0.95 of the way from the centroid to the outline. A stuck rim has no
  /// largest one: linear theory makes it infinite.
  double peak_pressure_Pa = 0;
  double centre_x_m = 0, centre_y_m = 0;  ///< of pressure, in the outline's coordinates
  double pressure_arm_m = 0;              ///< int p r dA / P about it, as pressed
  /// The arm of frictionless pressing, whatever the pressing was. A twist turns the friction of all
  /// points into its own direction, which lets the radial shear go; so mu P times this is the
  /// largest torque.
  double eccentricity_m = 0;
  std::array<double, 2> tilt_stiffness_Nm_per_rad{};  ///< free to shift sideways
  /// Largest moment, together with the load, before the rim lifts off, from the middle.
  std::array<double, 2> tilt_limit_Nm{};
  std::array<double, 2> tilt_rad{};  ///< by a load that is not in the middle
  double torsional_stiffness_Nm_per_rad = 0;
  /// Along x and y, for faces that stay parallel: 1/(h (1 + e)/(G A) + h³/(12 E I)). A thick pad
  /// also bends, which takes a moment; e, what the free sides lose, is fitted to round pads (within
  /// 5 %).
  std::array<double, 2> tangential_stiffness_N_per_m{};
  /// Share of the largest eccentricity without lift-off that the load uses. Above 1 the rim lifts
  /// off, and the pressure is that of the tilted face where it is positive; stiffnesses stay those
  /// of the whole face.
  double tilt_utilisation = 0;
  double lifted_share = 0;  ///< of the contact's area, at most 0.8: beyond, there is no answer
  Validity validity;

  bool valid() const { return has_answer && validity.holds(); }
};

/// Derivatives with respect to load, E, nu and h, for a load in the middle.
struct PadDerivatives {
  double by_normal_force_N = 0, by_youngs_modulus_Pa = 0, by_poisson_ratio = 0, by_thickness_m = 0;
};
struct PadGradient {
  bool known = false;
  PadDerivatives indentation_m, normal_stiffness_N_per_m, pressure_arm_m, eccentricity_m,
      max_torque_Nm;
};

/// Many loads and layers of one outline: arrays of `count` numbers each.
struct PadBatch {
  std::size_t count = 0;
  const double* normal_force_N = nullptr;
  const double* youngs_modulus_Pa = nullptr;
  const double* poisson_ratio = nullptr;
  const double* thickness_m = nullptr;
};

class PadModel {
 public:
  virtual ~PadModel() = default;
  virtual const ModelCard& card() const noexcept = 0;
  /// Never throws, never allocates, never returns NaN or infinity.
  virtual PadPrediction predict(const PadProblem& problem) const noexcept = 0;
  /// Derivatives by forward differentiation, exact to round-off.
  virtual PadGradient gradient(const PadProblem& problem) const noexcept = 0;
  /// Pressure at a point of the outline's coordinates, 0 outside; may be negative where a load
  /// beyond the limit would lift the face off. Finite at the rim (see `peak_pressure_Pa`).
  virtual double pressure_Pa(const PadProblem& problem,
                             const Eigen::Vector2d& point_m) const noexcept = 0;
  /// The pressure at full slip, by points, for the exact limit surface (SampledPressure), of
  /// frictionless pressing as `eccentricity_m`. Allocates.
  virtual std::vector<PressureSample> slipping_pressure(const PadProblem& problem) const = 0;

  /// Many answers at once, one after the other.
  void predict_batch(const PadShape& shape, PadPressing pressing, const PadBatch& batch,
                     PadPrediction* predictions) const noexcept;
};

/// The models of a flat face: pad_layer and pad_uniform.
const std::vector<const PadModel*>& all_pad_models();
const PadModel* find_pad_model(std::string_view name);  ///< of them, or nullptr

/// The model of a cylinder: a line contact with ends.
const PadModel& line_layer();

}  // namespace softfinger
