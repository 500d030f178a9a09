#pragma once

#include <string>

namespace softfinger::judgement {

/// A model at one load. Agreement within the tolerance counts only where the model itself claims to
/// hold: where its error merely crosses zero outside its assumptions, that is an accident.
enum class Judgement { usable, accident, off, silent };
Judgement judge(double error, bool claims_to_hold, double tolerance);

/// The name as people read it: `thin_incompressible` -> `Thin incompressible`, `fem` -> `FEM`.
std::string label(const std::string& model);

}  // namespace softfinger::judgement
