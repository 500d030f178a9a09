#pragma once

#include "comparisons/input/case.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"

namespace softfinger::prediction {

/// The answer of `layer_fft` for the gap between the case's meshes themselves, measured along the
/// contact's normal, instead of the quadric that was fitted to them (`softfinger predict --gap
/// sampled`).
///
/// Contact point, normal and long axis are those of the fit. The bodies approach along the normal
/// without turning. Both are sampled on 257 x 257 lines over 2.5 times the fitted ellipse (6 times
/// if the contact needs it). If one of the bodies is given by radii, it is taken as a paraboloid; a
/// sphere is taken exactly.
///
/// The facets are taken as they are, as finite elements on the mesh would take them. On a body with
/// the radius R, facets with edges of length h lie up to h²/(8 R) below the smooth surface. To
/// estimate the error that this causes, the answer is also computed for the smooth surface that
/// follows from the mesh's normals (SurfaceHit::rounding). The difference is the error estimate.
///
/// @throws InputError naming the case's line when no body is a mesh; when the contact reaches a
///   place where a mesh ends, has a hole or a step (steeper than 60 degrees), naming that place
/// @throws ConvergenceError when the contact is not one region with a smooth edge: bodies that
///   touch in several places, facets larger than the contact, noise
/// Cost: about 0.3 s.
ModelAnswer ask_sampled_gap(const GeometryResolver& resolver, const LocalGeometry& geometry,
                            const input::Case& contact_case, double load_N);

}  // namespace softfinger::prediction
