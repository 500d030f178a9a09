#pragma once

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/prediction/local_geometry.h"

namespace softfinger::reference {

/// A point of a triangulated body and the frame there.
struct PlacedMesh {
  input::MeshBody mesh;
  double metres_per_unit = 1e-3;           ///< of its file, typed or guessed
  Eigen::Vector3d outward_normal, x_axis;  ///< in the file's coordinates
  /// Radii of the surface's sections along the frame's axes; none where a section is flat or
  /// hollow.
  std::optional<double> radius_x_m, radius_y_m;
  /// Share of the fitted region's area that the contact did not ask for: facets were too large.
  double region_excess = 0;
};

/// A body with its own shape, in the frame of the relative radii.
struct PlacedBody {
  std::variant<input::QuadricBody, input::SphereBody, PlacedMesh> body;
  double turn_rad = 0;  ///< from that frame's x to the body's own
};

/// The layer is a user's own mesh.
struct LayerMesh {
  std::filesystem::path file;  ///< absolute
  double metres_per_unit = 1e-3;
  std::string content;  ///< a hash of it: a mesh with another content is another problem
};

/// Results asked for beyond the normal contact.
struct FrictionRequest {
  bool torsion = false;        ///< twist to full slip
  int increments = 20;         ///< of the twist
  int limit_surface = 0;       ///< points of it
  int increments_to_slip = 0;  ///< of a push to full slip
  std::optional<Eigen::Vector2d> twist_axis_m;
};

/// A problem for the finite-element program, in the frame of the relative radii.
struct FemProblem {
  std::string name;
  RelativeRadii radii;
  /// A flat layer is then pressed by the sphere itself, not by its paraboloid.
  double sphere_radius_m = std::numeric_limits<double>::infinity();
  ElasticLayer layer;
  ElasticLayer object_layer;                         ///< thickness 0: the object is rigid
  std::vector<input::Sublayer> sublayers;            ///< empty: a homogeneous layer
  std::optional<input::FiniteStrain> finite_strain;  ///< none: linear elasticity
  double load_N = 0;
  std::optional<double> approach_m;  ///< the load is then a result
  /// A layer that relaxes, and its history until a time: its load or approach is that above.
  struct InTime {
    Relaxation relaxation;
    std::vector<HistoryPoint> points;
    double time_s = 0;  ///< infinite: at rest
  };
  std::optional<InTime> in_time;
  ShearLaw shear_law;
  PressingFriction pressing = PressingFriction::none;
  int level = 2;
  std::optional<LayerMesh> layer_mesh;
  struct Bodies {
    PlacedBody pad, object;
  };
  std::optional<Bodies> bodies;  ///< none: a flat layer under the quadric gap
  std::optional<FrictionRequest> friction;
  bool lists_forces = false;  ///< the answer has the forces on the surface's nodes
  // Output paths, which decide nothing about the answer.
  std::filesystem::path output_directory, compliance_file;  ///< empty: none are written
};

/// The problem as the program reads it (fem/README.md). Equal problems give equal objects.
nlohmann::json to_json(const FemProblem& problem);

/// The problem as a process gets it: with `read_from`, the file to read, for each mesh in a format
/// that softfinger-fem does not read itself. Such a file is only there while this process lives.
nlohmann::json process_input(const FemProblem& problem);

/// The problem of one load of a case.
/// @throws InputError where finite elements cannot solve the case
FemProblem fem_problem(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                       double load_N, int level);

}  // namespace softfinger::reference
