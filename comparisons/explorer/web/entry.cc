// Functions that the page's script calls. Numbers go through memory, words come back as JSON.
#include <cmath>
#include <cstddef>
#include <string>

#include "comparisons/explorer/explorer.h"

namespace {

softfinger::explorer::Question typed(const double* values) {
  softfinger::explorer::Question question;
  softfinger::ContactProblem& problem = question.problem;
  problem.radii.major_m = values[0];
  problem.radii.minor_m = values[1];
  problem.layer = {values[2], values[3], values[4]};
  problem.load = {values[5], values[6]};
  question.tolerance = values[7];
  question.shown = int(values[8]);
  const softfinger::RelativeRadii& gap = problem.radii;
  problem.finger_curvature = {values[9] / gap.major_m, values[10] / gap.minor_m,
                              values[11] / std::sqrt(gap.major_m) / std::sqrt(gap.minor_m)};
  problem.is_object_spherical = values[12] != 0;
  return question;
}

double numbers[13];

}  // namespace

extern "C" {

/// Buffer into which the script writes R', R'', h, E, nu, P, mu (SI), tolerance, the shown model's
/// place, the finger's parts of the relative curvature along x, y and its twist, and 1 for a sphere
/// as object.
__attribute__((export_name("question"))) double* question() { return numbers; }

/// The answer to what lies there: `softfinger::explorer::answer`, ended by a zero.
__attribute__((export_name("answer"))) const char* answer() {
  static std::string text;
  text = softfinger::explorer::answer(typed(numbers));
  return text.c_str();
}

/// Asks one model again and again, for the script to take the time. The sum keeps the compiler from
/// removing the calls.
__attribute__((export_name("repeat"))) double repeat(int model, int calls) {
  const softfinger::ContactProblem problem = typed(numbers).problem;
  double sum = 0;
  for (int i = 0; i < calls; ++i)
    sum += softfinger::explorer::models()[std::size_t(model)]->predict(problem).a_m;
  return sum;
}
}
