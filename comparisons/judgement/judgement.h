#pragma once

#include <string>

namespace softfinger::judgement {

/// A model at one load, compared with the finite elements.
///   usable    its error is within the tolerance, and it is sound there (`ModelError::sound`)
///   accident  its error is within the tolerance outside the model's own range: the error may just
///             change its sign there
///   off       its error is larger than the tolerance
///   undetermined  its error is within the tolerance of a surface that the mesh does not determine:
///             what the fit of the radii leaves open is larger than the tolerance
///   silent    there is no answer or no reference
enum class Judgement { usable, accident, off, undetermined, silent };
Judgement judge(double error, bool sound, double tolerance);

/// The name as people read it: `thin_incompressible` -> `Thin incompressible`, `fem` -> `FEM`.
std::string label(const std::string& model);

}  // namespace softfinger::judgement
