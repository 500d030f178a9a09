#pragma once

#include "comparisons/input/case.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"

namespace softfinger::prediction {

/// `layer_fft` on the gap as the case's meshes have it, along the contact's normal, instead of the
/// quadric that was fitted to them (`softfinger predict --gap sampled`).
///
/// Point, normal and long axis are those of the fit; the bodies then approach along that normal
/// without turning. Both bodies are sampled on 257 x 257 lines over 2.5 times the fitted ellipse
/// (6 times, if the contact needs it). Beside a mesh, a body given by radii is its paraboloid and a
/// sphere is itself.
///
/// The facets are taken as they are, as finite elements on the mesh take them: of a body with the
/// radius R and edges of length h they miss up to h²/(8 R). By how much that may matter is
/// measured: the answer for the facets rounded by the mesh's own normals (SurfaceHit::rounding) is
/// computed too, and the difference is the error estimate.
///
/// @throws InputError naming the case's line when no body is a mesh; when the contact reaches a
///   place where a mesh ends, has a hole or a step (steeper than 60 degrees), naming that place
/// @throws ConvergenceError when the contact is not one region with a smooth edge: bodies that
///   touch in several places, facets larger than the contact, noise
/// Cost: about 0.3 s.
ModelAnswer ask_sampled_gap(const GeometryResolver& resolver, const LocalGeometry& geometry,
                            const input::Case& contact_case, double load_N);

}  // namespace softfinger::prediction
