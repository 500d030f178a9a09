#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "comparisons/input/contact_times.h"
#include "comparisons/input/doubt.h"
#include "comparisons/input/pad.h"
#include "comparisons/input/setting.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/input/pressing_friction.h"
#include "softfinger/input/shear_law.h"
#include "softfinger/pressure/power_law_fit.h"

/// A case file: what to compare, as written by a user. The only place that knows TOML.
namespace softfinger::input {

/// The shape of a finger away from the contact point, where its radii alone do not describe it.
/// Only finite elements on its curved layer use it. Default: a paraboloid; at finite strain an
/// ellipsoid.
enum class FingerShape { paraboloid, ellipsoid, tapered };

/// A paraboloid by its principal radii; infinite = flat, negative = concave.
struct QuadricBody {
  double radius_x_m = 0, radius_y_m = 0;
  FingerShape shape = FingerShape::paraboloid;
  double taper_per_m = 0;  ///< of `tapered`: relative change of the cross-section's radius along x
  bool shape_typed = false;
};

/// An exact sphere.
struct SphereBody {
  double radius_m = 0;
};

/// A point on a triangulated surface.
struct MeshBody {
  std::filesystem::path path;
  std::string typed;      ///< the same as the case names it
  std::string part = {};  ///< of the file, by its name; empty: all
  std::string where;      ///< "file:line" that names it, for messages
  /// Unit of the file's coordinates; none: as the file says it, or guessed.
  std::optional<double> metres_per_unit;
  bool is_own_unit = false;                           ///< a placed body's: the file says it
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< not used with `along` and `near_m`
  std::optional<Eigen::Vector3d> normal;              ///< outward, need only be roughly right
  /// Stands in place of point and normal: the point that lies farthest in this direction, of
  /// length 1.
  std::optional<Eigen::Vector3d> along;
  /// Stands in place of a point on the surface: the surface's point nearest to this one.
  std::optional<Eigen::Vector3d> near_m;
  /// Surface of a finger's rigid core, in the same coordinates, for finite elements on the curved
  /// finger; empty: the finger's own surface, offset by the layer's thickness.
  std::filesystem::path core;
  std::string core_part = {};  ///< as `part`
};

using CaseBody = std::variant<QuadricBody, SphereBody, MeshBody>;

/// Two bodies; the object is turned by `angle_rad` about the finger's normal.
struct BodyPair {
  CaseBody finger, object;
  double angle_rad = 0;
};

/// A hyperelastic layer; its small-strain constants are those of [layer]. The finite-element
/// program checks the parameters (`softfinger explain neo_hookean` describes them).
struct FiniteStrain {
  std::string material = "neo_hookean";
  std::string volumetric = "quadratic";
  double mooney_rivlin_share = 0;
  std::vector<double> yeoh_ratios;  ///< two, or none
};

/// One of several bonded layers.
struct Sublayer {
  std::string name;  ///< with a mesh, the name of its volume there; else it may be empty
  ElasticLayer layer;
  FiniteStrain material;  ///< at finite strain
};

/// A case with every value checked, in SI units.
struct Case {
  std::string id;
  std::string question;  ///< may be empty
  std::filesystem::path file;
  Settings settings;  ///< the values from the command line that took the place of the file's
  std::string text;   ///< of the file, for reproduction
  std::variant<RelativeRadii, BodyPair, PadPair> geometry;
  std::string geometry_where;  ///< "file:line" of [geometry], for messages
  ElasticLayer layer;          ///< the finger's, or the only one
  /// Sublayers from the surface inwards, if [[layer]] is repeated; empty for a homogeneous layer.
  /// With sublayers, `layer` is the homogeneous layer that the models get: of the same thickness,
  /// with 1/E and nu averaged over the thickness, which is exact for columns that stretch freely.
  std::vector<Sublayer> sublayers;
  ElasticLayer object_layer;  ///< thickness 0: one of the bodies is rigid
  /// The file has an [object_layer] and no [layer]: the finger is rigid and `layer` is the
  /// object's. For a quadric gap it makes no difference which of the bodies carries the layer.
  bool layer_on_object = false;
  ModelOptions options;
  std::optional<PowerLawFit> power_law_fit;  ///< when [power_law] has data instead of parameters
  std::vector<double> loads_N;               ///< all different
  ContactTimes times;                        ///< how the layer relaxes and is pressed over time
  Doubts doubts;                             ///< numbers that were given with their doubt
  ShearLaw shear_law;                        ///< what friction carries at a point
  PressingFriction pressing = PressingFriction::none;  ///< friction while it is pressed
  int fem_level = 2;                                   ///< 1 to 3
  bool fem_curved = false;         ///< finite elements on the finger's own curved core
  std::filesystem::path fem_mesh;  ///< of the layer, in place of the flat one; empty: our own
  double fem_mesh_metres_per_unit = 1e-3;
  std::optional<FiniteStrain> fem_finite;  ///< none: linear elasticity
  std::vector<std::string> remarks;        ///< values that are unusual, a sentence each
  /// Whether [fem] chose them. `reference::with_full_reference` settles those that it left open.
  bool fem_geometry_typed = false, fem_kinematics_typed = false;

  /// The coefficient that acts while the contact is pressed.
  double pressing_friction_coefficient() const {
    return softfinger::pressing_friction_coefficient(pressing, shear_law.friction_coefficient);
  }

  /// With the sublayers where there are not more than models take.
  ContactProblem problem(const RelativeRadii& radii, double load_N) const {
    ContactProblem made{
        radii, layer, {load_N, shear_law.friction_coefficient}, object_layer, options};
    if (sublayers.size() <= LayerStack::kMost)
      for (const Sublayer& one : sublayers) made.stack.sublayers[made.stack.count++] = one.layer;
    return made;
  }
};

/// At finite strain the shape of the finger counts, not only its curvature at the contact. A finger
/// by its radii on a curved core is then an ellipsoid (a sphere for equal radii) and not a
/// paraboloid, unless a shape was typed.
void settle_finger_shape(Case& contact_case);

/// Whether a reader of cases can do with a flat pad. Most commands only know curved contacts.
enum class FlatPads { refused, taken };

/// Whether a reader of cases knows time: `[layer] relaxation` and `[contact] history`.
enum class Times { refused, taken };

/// @throws InputError that names the command, where the case has relaxation or history
void refuse_times(const Case& contact_case, const std::string& command);

/// @throws InputError that names the command, where the case's contact is a flat pad
void refuse_pad(const Case& contact_case, const std::string& command);

/// @throws InputError that names the command, where a flat pad's object is curved, or where it is a
/// roller
void refuse_curved_pad(const Case& contact_case, const std::string& command);

/// Reads and checks a case file. Mesh files are looked up relative to the case's folder, then among
/// the built-in meshes, but not opened.
/// @throws InputError with where = "file:line" for anything that is missing, unknown, of the wrong
/// type or out of range; the nearest known key is named for an unknown one. For a value of
/// `settings` `where` is what typed it.
/// @param file  "-": standard input
Case read_case(const std::filesystem::path& file, const Settings& settings = {},
               FlatPads pads = FlatPads::refused, Times times = Times::refused);

/// Reads a case from a text in memory; `file` is used in messages and to find meshes.
Case parse_case(const std::string& text, const std::filesystem::path& file,
                const Settings& settings = {}, FlatPads pads = FlatPads::refused,
                Times times = Times::refused);

/// Copy of a case with another value of a doubted number, in the file's unit.
/// @throws InputError where the case does not allow that value
Case with_value(const Case& contact_case, const Doubt& doubt, double value);

/// A direction by its axis: "x", "+x", "-x", ... "-z"; null for any other text.
std::optional<Eigen::Vector3d> axis_direction(const std::string& typed);

/// @throws InputError unless the case's friction is Coulomb's, for commands that compare torques
/// whose errors are known for that one only.
void require_coulomb(const Case& contact_case, const std::string& command);

}  // namespace softfinger::input
