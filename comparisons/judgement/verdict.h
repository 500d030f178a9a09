#pragma once

#include <string>
#include <vector>

#include "comparisons/judgement/model_errors.h"

namespace softfinger::judgement {

/// Outcome of a case's comparison. Usable is defined at `Judgement`.
enum class VerdictClass {
  /// One model is usable at all loads. `Verdict::sentence` names the most accurate such model among
  /// those that take microseconds, and at most one more. It names a slower model only if none of
  /// these is usable at all loads.
  good,
  /// Models are usable at some of the loads only, or one agrees outside its range. The sentence
  /// says which model is usable at which loads, and gives the smallest error at the other loads.
  mixed,
  bad,           ///< no model is usable at any load
  undetermined,  ///< at no load, because the mesh does not determine the contact
  failed         ///< the finite elements finished at no load
};

/// "good", "mixed", "bad", "undetermined" or "failed".
const char* name_of(VerdictClass verdict_class);

struct Verdict {
  std::string sentence;
  VerdictClass verdict_class = VerdictClass::failed;
};

/// One sentence that answers which model can be used, with numbers.
/// @param tolerance  relative, in a, b, area and torque
/// @param reference  what the errors are relative to, in words
Verdict compose_verdict(const std::vector<LoadErrors>& loads, double tolerance,
                        const std::string& reference);

/// "0.5 N", "1, 2 and 5 N", "0.5 to 10 N"
std::string load_list(const std::vector<double>& loads_N);

}  // namespace softfinger::judgement
