#pragma once

#include <string>

namespace softfinger::judgement {

/// A model at one load, compared with the finite elements.
///   usable    its error is within the tolerance, and the model says that its assumptions hold
///   accident  its error is within the tolerance, but its assumptions do not hold: the error may
///   just
///             change its sign there
///   off       its error is larger than the tolerance
///   silent    there is no answer or no reference
enum class Judgement { usable, accident, off, silent };
Judgement judge(double error, bool claims_to_hold, double tolerance);

/// The name as people read it: `thin_incompressible` -> `Thin incompressible`, `fem` -> `FEM`.
std::string label(const std::string& model);

}  // namespace softfinger::judgement
