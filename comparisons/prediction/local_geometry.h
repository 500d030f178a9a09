#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "meshes/io/read_surface.h"
#include "softfinger/geometry/contact_patch.h"
#include "softfinger/input/triangle_surface.h"

namespace softfinger::prediction {

/// The geometry that models and finite elements get for one load of a case.
struct LocalGeometry {
  RelativeRadii radii;
  std::optional<ContactPatch> patch;  ///< set when a body is a mesh
  std::string patch_model;  ///< the pressure model that predicted the patch's contact area
  /// Set for an exact sphere on a flat finger: the finite elements then use the sphere itself. On a
  /// curved finger only the sphere's curvature enters, as in the models.
  double sphere_radius_m = std::numeric_limits<double>::infinity();
  /// Curvature of the body with the layer, along the contact's axes. Zero for radii alone, which
  /// stand for a flat layer.
  SurfaceCurvature finger_curvature;
  bool is_object_spherical = false;  ///< the body without the layer is an exact sphere
  /// Point at which a mesh is touched, in the file's coordinates; zero for other bodies.
  Eigen::Vector3d finger_point_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d object_point_m = Eigen::Vector3d::Zero();
  /// Units of the meshes' files, typed or guessed.
  double finger_metres_per_unit = 1e-3, object_metres_per_unit = 1e-3;
  /// Why the bodies have no relative radii; `radii` are then but a guess of the contact's size.
  std::string no_ellipse;
};

/// Problem that models solve for one load of a case.
ContactProblem contact_problem(const input::Case& contact_case, const LocalGeometry& geometry,
                               double load_N);

/// Turns a case's bodies into relative radii. Reads each mesh file once and fits each region of it
/// once, however many loads there are. Not for several threads at once.
class GeometryResolver {
 public:
  /// @throws InputError when a mesh cannot be read. `contact_case` must outlive this object.
  explicit GeometryResolver(const input::Case& contact_case)
      : GeometryResolver(contact_case, nullptr) {}
  /// @param known  another resolver, whose surfaces are reused if they come from the same files;
  /// may be null
  GeometryResolver(const input::Case& contact_case, const GeometryResolver* known);

  /// @param mesh  what every mesh of the case stands for; no file is read
  GeometryResolver(const input::Case& contact_case,
                   const std::shared_ptr<const TriangleSurface>& mesh);

  /// For meshes the fitted region depends on the load: region and predicted contact are iterated
  /// until they agree. The area is predicted by bonded_layer, by hertz where that has no answer.
  /// @throws InputError when the bodies do not touch in an ellipse (saddle, line, conforming), in
  /// words.
  LocalGeometry resolve(double load_N) const;

  /// Used by finite elements, which press curved bodies as they are: bodies that no ellipse
  /// describes (hollow ones, edges, few facets) have theirs placed at their points, and
  /// `no_ellipse` says so.
  /// @throws InputError where not even a point and a normal are known, and as `resolve` for bodies
  /// that are not curved, or of which none is a mesh.
  LocalGeometry place(double load_N) const;

  /// The triangles of one of the case's mesh bodies, metres.
  const TriangleSurface& surface(const input::MeshBody& mesh) const;

  /// The body with its file's unit, and with the point and the normal that its `along` or `near_m`
  /// stands for.
  input::MeshBody placed(const input::MeshBody& mesh) const;

  /// Defects of the meshes that were repaired and doubts about them, one line each.
  const std::vector<std::string>& remarks() const { return remarks_; }

 private:
  ContactBody contact_body(const input::CaseBody& body) const;
  void add_finger(LocalGeometry& geometry) const;
  void add_points(LocalGeometry& geometry) const;
  QuadricFit lie_of(const input::MeshBody& mesh) const;

  const input::Case& case_;
  struct Surface {
    std::shared_ptr<const TriangleSurface> surface;
    double metres_per_unit = 1e-3;
    bool is_own_unit = false;
  };
  std::map<std::string, Surface> surfaces_;  ///< by path, typed unit and part
  std::vector<std::string> remarks_;
  mutable std::optional<ContactSurface> contact_surface_;  ///< of meshes, for all loads
};

/// Refuses a contact point that is not on the surface, which is a mistake in the point or the unit.
/// @throws InputError when the surface is farther away than 5 % of its own extent.
void require_point_on_surface(const TriangleSurface& surface, const Eigen::Vector3d& point_m,
                              const std::string& where, const std::string& field);

}  // namespace softfinger::prediction
