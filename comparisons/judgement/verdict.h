#pragma once

#include <string>
#include <vector>

namespace softfinger::judgement {

/// A model against FEM at one load: signed relative errors.
struct ModelError {
  std::string model;
  bool has_answer = false;
  bool valid = false;  ///< by the model's own statement
  double area = 0, max_torque = 0;
  bool hot_path = true;    ///< microseconds; a slower model is named only when no such one will do
  bool applicable = true;  ///< false: it was given nothing to answer with, and is not mentioned
};

/// All models at one load.
struct LoadErrors {
  double load_N = 0;
  bool fem_finished = false;
  bool fem_trusted = false;
  std::string fem_failure;
  std::vector<ModelError> models;  ///< the same models in the same order for every load
};

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
