#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

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
  /// Radii over a region of 0.8 or of 1.25 times the radius.
  struct OtherRegion {
    RelativeRadii radii;
    /// Number of standard deviations of this patch by which noise alone makes the radii differ. Two
    /// estimates, one of which uses what the other one uses and more, differ with the difference of
    /// their variances (Hausman 1978).
    double noise = 0;
  };
  /// Fits over other regions, as far as they are elliptic. They show how much the answer depends on
  /// the region, because no body is of fourth order all over.
  std::vector<OtherRegion> other_regions;
  /// Share of the region that the surface covers, at most 1: less where it ends within the region.
  double covered = 1;
  /// Distance in m by which the bodies' surfaces may differ from their facets within the contact,
  /// both bodies together: the middle of a facet lies kappa e²/8 under a surface of curvature kappa
  /// whose vertices are e apart, with e at most the contact's diameter. The mean over the n
  /// vertices of twice the contact's area is known better by sqrt(n). 0 without an ellipse.
  double facet_doubt_m = 0;
  int iterations = 0;  ///< quadrics that were fitted
  bool agrees = true;  ///< region within 2 % of twice the predicted area
  /// Reason, in words, for a region that does not agree ("the mesh has only 5 vertices within
  /// ..."), or a note that the surface is narrower than the region.
  std::string remark;
};

/// Two bodies near their contact point, for any load.
///
/// The region of a load is twice as large as the contact that is predicted for it (Ciocarlie et al.
/// 2007, section 4.1). Quadrics are fitted over a row of regions whose radii differ by a factor of
/// 1.25, whatever the load, and blended between them: curvature is one continuous function of the
/// region. From a region that has enough vertices not to be noise the search goes outwards to the
/// first region that is large enough, or inwards to the first that is not. For a prediction whose
/// area grows with the load region and area therefore never fall when the load rises.
///
/// A coarse mesh may not allow a region that agrees, for it has at least 8 vertices: then as near
/// to it as possible, and `ContactPatch::agrees` is false. Both bodies are fitted over regions of
/// the same radius. Where no region makes an ellipse, the patch of the first region is returned,
/// with its kind.
///
/// Keeps what it has fitted. Not for several threads at once.
class ContactSurface {
 public:
  /// @param angle_rad  angle from the finger's x axis to the object's, counter-clockwise about the
  ///   finger's outward normal. For a mesh that is QuadricFit::x_axis; the mirror image that comes
  ///   from looking at the object from its other side is accounted for.
  /// @throws InputError for a mesh without a surface near the point
  ContactSurface(const ContactBody& finger, const ContactBody& object, double angle_rad);
  ~ContactSurface();
  ContactSurface(ContactSurface&&) noexcept;
  ContactSurface& operator=(ContactSurface&&) noexcept;

  /// @param predicted_area_m2  area of the contact for given relative radii, from any pressure
  ///   model; positive and finite. What it throws is passed on.
  /// @throws InputError, ConvergenceError from the fits.
  ContactPatch patch(const std::function<double(const RelativeRadii&)>& predicted_area_m2);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The patch of one load.
ContactPatch fit_contact_patch(
    const ContactBody& finger, const ContactBody& object, double angle_rad,
    const std::function<double(const RelativeRadii&)>& predicted_area_m2);

}  // namespace softfinger
