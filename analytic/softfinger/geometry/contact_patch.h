#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>

#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/geometry/relative_curvature.h"

namespace softfinger {

/// A point on a triangulated body, where it will be touched.
struct MeshContactPoint {
  const TriangleSurface* surface = nullptr;
  Eigen::Vector3d point_m;
  std::optional<Eigen::Vector3d> outward_normal;
};

/// One body of a contact: an exact quadric or a point on a mesh.
using ContactBody = std::variant<Quadric, MeshContactPoint>;

/// The local geometry on which region and contact agree.
struct ContactPatch {
  RelativeCurvature relative;
  std::optional<QuadricFit> finger_fit, object_fit;  ///< set for mesh bodies
  double predicted_area_m2 = 0;                      ///< of the contact, for the final radii
  double region_area_m2 = 0;                         ///< pi times the region's radius squared
  int iterations = 0;
  bool agrees = true;  ///< region within 2 % of twice the predicted area
  std::string
      remark;  ///< why not, in words, when it does not ("the mesh has only 5 vertices within ...")
};

/// Iterates region and prediction until the region is twice the predicted contact area
/// (Ciocarlie et al. 2007, section 4.1). A coarse mesh may not allow that, for a region has at
/// least 8 of its vertices: then as near to it as possible, and `agrees` is false. Both bodies are
/// fitted over regions of the same radius. The iteration is a damped fixed point within a bracket,
/// so that it ends even where no region agrees because the predicted area jumps.
///
/// Where no region makes an ellipse, the patch of the first region is returned, with its kind.
///
/// @param angle_rad  angle from the finger's x axis to the object's, counter-clockwise about the
///   finger's outward normal. For a mesh that is QuadricFit::x_axis; the mirror image that comes
///   from looking at the object from its other side is accounted for.
/// @param predicted_area_m2  area of the contact for given relative radii, from any pressure model;
///   positive and finite. What it throws is passed on.
/// @throws InputError, ConvergenceError from the fits.
ContactPatch fit_contact_patch(
    const ContactBody& finger, const ContactBody& object, double angle_rad,
    const std::function<double(const RelativeRadii&)>& predicted_area_m2);

}  // namespace softfinger
