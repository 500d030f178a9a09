#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "fem/contact/contact_shape.h"
#include "fem/contact/normal_contact.h"
#include "fem/contact/rigid_object.h"
#include "fem/layer/fingertip_shape.h"
#include "fem/layer/layer_model.h"
#include "fem/problem/problem.h"

/// Pressing without friction, on one mesh, in units of h and E.
namespace softfinger::fem {

/// A contact problem in the units of its layer: the layer and the object that is pressed on it.
struct Pressing {
  double major = 1, minor = 1;           ///< relative radii
  double sphere = 0;                     ///< radius, infinite for a paraboloid
  double load = 0;                       ///< P / (E h²); 0: by approach
  double approach = 0;                   ///< d / h, in place of the load
  std::optional<PressedInTime> in_time;  ///< in these units
  double poisson_ratio = 0;              ///< of the layer as a whole
  /// Depths of the interfaces between bonded sublayers, and what these are made of, from the
  /// surface on.
  std::vector<double> interfaces;
  std::vector<ElasticConstants> sublayers;  ///< none: homogeneous
  std::optional<OppositeLayer> opposite;    ///< on the object; none: it is rigid
  double thickness_m = 1;
  double unit_of_force_N = 1;  ///< E h²
  Fingertip fingertip;         ///< none: a flat layer, and the gap of the relative radii
  FingertipShape bent;         ///< curved ("bent") layer; without a shape where it is flat
  std::shared_ptr<const meshes::LayerMesh>
      mesh;  ///< from outside; null: the flat or curved block's
  bool moves_off_centre =
      false;                   ///< at finite strain: friction follows motions that no mirror keeps
  bool rubs_deformed = false;  ///< friction follows at finite strain, on the deformed layer

  /// Elastic constants of the sublayers, or of the homogeneous layer.
  std::vector<ElasticConstants> materials() const;

  /// Thickness of the layers, on both bodies together.
  double whole_thickness() const { return opposite ? 1 + opposite->thickness : 1; }

  /// A gap larger than any approach.
  static constexpr double beside_object = 1e3;

  /// Modulus E* of the materials at the surfaces, 1/E* = sum (1 - nu²)/E over the soft bodies.
  double surface_modulus() const;

  /// Dundurs' constant beta, absolute: how far pressing shears the surfaces that touch (K. L.
  /// Johnson, Contact Mechanics, 1985, section 5.1). Zero for bodies that are alike.
  double coupling() const;

  /// The mirror planes of finger, object and motion. Friction at finite strain is solved with both
  /// or none.
  MirrorPlanes planes() const;

  /// The distance from a surface point to the object above it, along the load; `beside_object`
  /// where there is none.
  double gap(const SurfaceNode& node) const;
};

/// The problem in the units of its layer.
/// @param ways  rule for the core of a scan
/// @throws InputError where the layer is too thick for the pad's curvature
Pressing pressing_of(const Problem& problem, CoreWays ways = CoreWays::smoothed);

/// A contact pressed on one mesh.
struct Pressed {
  std::shared_ptr<const LayerModel> model;
  Eigen::VectorXd gap;
  NormalContact contact;                 ///< its forces are the components along the load
  std::optional<NormalContact> largest;  ///< on the way there, over time
  Eigen::VectorXd lift;               ///< of each node towards the object by friction; empty: none
  Eigen::VectorXd normal_force;       ///< per node, along the surface's normal
  Eigen::VectorXd cosine;             ///< of each node's normal with the load
  double moment_a = 0, moment_b = 0;  ///< semi-axes from moments, rough but robust; on a
                                      ///< scan those of `holding_axes`
  bool reaches_rim = false;           ///< of the region where contact is possible

  double pressure(Eigen::Index node) const;
  /// Sums over the nodes times this are sums over the contact.
  int copies() const { return model->planes().images(); }
  /// P / (E h²)
  double load() const { return copies() * contact.force.sum(); }
  /// The centre of the pressure, seen along the load.
  Eigen::Vector2d centre() const;
  /// int p r dA / P over the contact seen along the load, r the distance from the pressure's
  /// centre: the deformed surface has the object's slope, not the finger's.
  double torque_arm() const;
  /// Sum of nodal forces times their distance from that centre.
  double moment_of(const Eigen::VectorXd& force) const;
};

/// Refuses a mesh from outside whose surface ends at a node that the object touches.
/// @throws InputError
[[noreturn]] void refuse_end_of_surface(const SurfaceNode& node, double thickness_m);

/// An object that ends within the contact has an edge there, which is no contact of two smooth
/// surfaces any more.
/// @param place  where it has no surface
/// @throws InputError
[[noreturn]] void refuse_end_of_object(const Eigen::Vector2d& place, const Pressing& pressing);

/// Largest share of a load or approach with which a contact keeps off the end of a layer, to a
/// thousandth of the whole, which does not.
/// @param fits  whether it does with a share
double share_that_fits(const std::function<bool(double)>& fits);

/// Describes a contact that reaches the end of a scan's layer.
/// @param end     touches there, or nearest to it
/// @param fits    largest share of the load or approach that does not reach it on the same mesh; 0
///                where that is less than a thousandth, as on large cells that are cut off beside
///                the first touch; none where it is not known
/// @param around  how far from the node the layer ends at most, in h
/// @throws InputError where the finger ends
FoldedLayer end_of_layer(const SurfaceNode& end, const Pressing& pressing,
                         std::optional<double> fits, double around = 0.3);

/// Describes a contact whose layer ends within three thicknesses of what touches, as seen from
/// there; none where it does not.
/// @throws InputError where the finger ends
std::optional<FoldedLayer> end_beside(const std::vector<SurfaceNode>& nodes,
                                      const Eigen::VectorXd& force, const Pressing& pressing);

/// Semi-axes to begin meshing with: half-space and thin-layer stiffness added, and what is too soft
/// about that. It decides how many meshes are tried, never the result.
LayerDiscretisation first_guess(const Pressing& pressing);

/// Elements and patch of the solver's levels; level 0 is that of the trial meshes.
void choose_elements(LayerDiscretisation& mesh, int level);

/// The layer of a contact on one mesh, factorised.
/// @throws what LayerModel's constructor throws
Outcome<std::shared_ptr<const LayerModel>, FoldedLayer> make_layer(
    const LayerDiscretisation& discretisation, const Pressing& pressing,
    const Rubs& rubs = none_rubs);

/// Sets the size of a contact from its nodal forces.
/// @throws InputError for one that wraps around the finger or reaches the end of a mesh
void set_size(Pressed& pressed, const Pressing& pressing);

/// @param model  of the pressing's own layer
/// @throws InputError, ConvergenceError
Outcome<Pressed, FoldedLayer> press_on(std::shared_ptr<const LayerModel> model,
                                       const Pressing& pressing);

/// The object's surface with its slopes, faceted ones with their edges rounded.
std::shared_ptr<const RigidObject> rigid_object(const Pressing& pressing);

/// The shape of a pressed contact (contact_shape.h).
Outcome<ContactShape, Unmeasured> measure_shape(const Pressed& pressed, const Pressing& pressing);

}  // namespace softfinger::fem
