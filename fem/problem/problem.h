#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/problem/fingertip.h"
#include "fem/problem/material_choice.h"
#include "fem/problem/pressed_in_time.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/input/pressing_friction.h"
#include "softfinger/input/shear_law.h"

namespace softfinger::meshes {
struct LayerMesh;
}

namespace softfinger::fem {

/// Results about friction that are wanted besides the torque int mu p r dA of the frictionless
/// pressure.
struct FrictionRequest {
  bool torsion = false;        ///< twist from stick to full slip
  int increments = 20;         ///< of the twist
  int limit_surface = 0;       ///< points of full slip; 0: none
  int increments_to_slip = 0;  ///< partial-slip states on the way to each point; 0: none
  /// Place of the axis that the twist turns about, from the contact's centre along the contact's
  /// axes. It has to lie in the contact.
  double twist_axis_x_m = 0, twist_axis_y_m = 0;

  bool any() const { return torsion || limit_surface > 0; }
};

/// One of several bonded sublayers.
struct Sublayer {
  ElasticLayer layer;
  MaterialChoice material;  ///< at finite strain
};

/// A contact to solve. On a flat layer the gap is that of `contact.radii`. With a finite
/// `sphere_radius_m` the object is the exact sphere of that radius instead of the paraboloid (both
/// radii must equal it).
struct Problem {
  std::string name = "case";
  ContactProblem contact;
  double sphere_radius_m = std::numeric_limits<double>::infinity();
  /// The law that bounds friction at a point; its coefficient is that of the contact's load.
  ShearLaw::Kind shear_law = ShearLaw::Kind::coulomb;
  double shear_strength_Pa = 0;  ///< > 0, for laws that have one
  PressingFriction pressing = PressingFriction::none;
  /// Presses by this approach in place of the contact's load, which is then ignored; 0: by load.
  double approach_m = 0;
  /// Follows this history of a relaxing layer, in N or m. Load or approach above are the last ones.
  std::optional<PressedInTime> in_time;
  /// Semi-axes to expect along x and y, from an earlier contact or a closed form: they save trial
  /// meshes and decide nothing else. None: guessed.
  std::optional<std::array<double, 2>> size_hint_m;
  int level = 2;        ///< 1 to 4: elements per contact semi-axis double with each level
  Fingertip fingertip;  ///< none: a flat layer and the gap of the relative radii
  /// The layer's mesh from outside, in place of the flat layer; null: our own.
  std::shared_ptr<const meshes::LayerMesh> mesh;
  std::string mesh_name;  ///< meshes of one name are one
  /// Sublayers from the surface inwards, together as thick as the contact's layer; on a mesh from
  /// outside its regions. Empty: the layer is homogeneous. With sublayers, E of the contact's layer
  /// is only the unit of stress, and its nu only serves for a first guess of the contact's size.
  std::vector<Sublayer> sublayers;
  FrictionRequest friction;
  /// Finite strain of this material, its small-strain constants those of the contact's layer; none:
  /// linear elasticity.
  std::optional<MaterialChoice> finite_strain;
  /// Whether friction acts on the layer, while it is pressed or after.
  bool has_friction() const { return pressing != PressingFriction::none || friction.any(); }
  ShearLaw friction_law() const {
    return {shear_law, contact.load.friction_coefficient, shear_strength_Pa};
  }
  /// The friction law in the units of the model, whose stress is E.
  ShearLaw friction_law_of_model() const {
    ShearLaw law = friction_law();
    law.shear_strength_Pa /= contact.layer.youngs_modulus_Pa;
    return law;
  }

  bool lists_forces = false;     ///< asks for `Result::forces`
  std::string output_directory;  ///< for VTU; empty: none
  std::string compliance_file;   ///< for the surface's compliance (write_compliance.h); empty: none
};

}  // namespace softfinger::fem
