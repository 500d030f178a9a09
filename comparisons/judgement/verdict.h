#pragma once

#include <string>
#include <vector>

#include "comparisons/judgement/model_errors.h"

namespace softfinger::judgement {

struct Verdict {
  std::string sentence;
  std::string verdict_class;  ///< good, mixed, bad, failed
};

/// One sentence that answers which model can be used, with numbers. "good": one model is usable
/// (judge) at all loads: it names the most accurate such model of the hot path, at
/// most one more, and a slower one only when none of those will do. "mixed": different models are
/// usable at different loads, or at some, or one agrees outside its validity; then it says which
/// where, and how near the nearest comes elsewhere. "bad": none is usable at any load. "failed":
/// FEM finished at no load.
Verdict compose_verdict(const std::vector<LoadErrors>& loads, double tolerance);

/// "0.5 N", "1, 2 and 5 N", "0.5 to 10 N"
std::string load_list(const std::vector<double>& loads_N);

}  // namespace softfinger::judgement
