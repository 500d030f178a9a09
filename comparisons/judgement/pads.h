#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/input/mesh_unit.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/flat_faces.h"
#include "comparisons/prediction/quantity.h"
#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/input/triangle_surface.h"

/// Places of a surface that can be touched, each pressed by the default model.
namespace softfinger::judgement {

/// Contact in which places are tried.
struct Pressing {
  ElasticLayer layer{2e-3, 300e3, 0.49};
  double load_N = 1, friction_coefficient = 0.8;
  /// Radius of the ball that presses an object, with the layer on it; a finger is pressed on a
  /// plane.
  double ball_radius_m = 8e-3;
  prediction::Demand demand;
};

/// "1 N on a plane, layer of 2 mm, 300 kPa, nu 0.49, friction 0.8"
std::string in_words(const Pressing& pressing, input::MeshRole role);

/// A place of a surface.
struct Pad {
  std::string name;  ///< as given, else its kind and a number: "dome 3"
  /// "dome", "barrel", "edge", "hollow", "saddle" or "flat" of a finger; an object has "wall",
  /// "rim" and "base" for "barrel", "edge" and the face that it can stand on.
  std::string kind;
  Eigen::Vector3d point_m, normal;
  std::optional<QuadricFit> fit;                  ///< of the region that the contact asks for
  std::optional<prediction::FlatFace> face;       ///< on which it lies
  std::optional<prediction::ModelAnswer> answer;  ///< with its assessment
  std::string reason;                             ///< why it is not usable; empty where it is
  bool is_usable() const { return answer && answer->assessment && answer->assessment->usable; }
  double worst = 0;  ///< largest bound of what is demanded; infinite where none is known
};

struct Pads {
  /// The usable ones, then flat faces, then the others. A finger's flat pad stands before all.
  std::vector<Pad> best_first;
  std::size_t usable = 0;
  bool is_complete = true;  ///< false: the search was ended after 3 s
  std::vector<prediction::FlatFace> faces;

  /// The largest flat face where it is a finger's pad: flat faces have two fifths of the surface,
  /// or no curved place is usable and it has a twentieth; else null.
  const prediction::FlatFace* pad_face() const;
  double area_m2 = 0;  ///< of the surface
};

/// A place to try.
struct PadPlace {
  std::string name;  ///< may be empty
  Eigen::Vector3d point_m;
  std::optional<Eigen::Vector3d> normal;
};

/// Presses the named places, and with `everywhere` some forty more, spread over the surface. Takes
/// up to 0.5 s for them, and ends after `prediction::kLongestSearch`.
Pads find_pads(const TriangleSurface& surface, input::MeshRole role, const Pressing& pressing,
               const std::vector<PadPlace>& named, bool everywhere);

}  // namespace softfinger::judgement
