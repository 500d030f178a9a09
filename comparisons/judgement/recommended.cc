#include "comparisons/judgement/recommended.h"

#include <algorithm>
#include <utility>

#include "softfinger/accuracy/default_model.h"

namespace softfinger::judgement {
namespace {

using prediction::ModelAnswer;

/// Smaller is better.
std::pair<bool, double> rank_of(const ModelAnswer& answer) {
  if (!answer.assessment) return {true, kInfinity};
  return {!answer.assessment->usable, worst_of(answer.assessment->totals())};
}

}  // namespace

const ModelAnswer* recommended(const std::vector<ModelAnswer>& answers) {
  const ModelAnswer* best = nullptr;
  for (const ModelAnswer& answer : answers) {
    if (!answer.prediction.has_answer) continue;
    if (!answer.sampled && answer.model == &default_model(answer.problem)) return &answer;
    if (!best || rank_of(answer) < rank_of(*best)) best = &answer;
  }
  return best;
}

std::vector<const ModelAnswer*> usable_ones(const std::vector<ModelAnswer>& answers,
                                            const ModelAnswer* first) {
  std::vector<const ModelAnswer*> usable;
  for (const ModelAnswer& answer : answers)
    if (&answer != first && answer.assessment && answer.assessment->usable)
      usable.push_back(&answer);
  std::stable_sort(usable.begin(), usable.end(),
                   [](const ModelAnswer* one, const ModelAnswer* other) {
                     return rank_of(*one) < rank_of(*other);
                   });
  if (first && first->assessment && first->assessment->usable) usable.insert(usable.begin(), first);
  return usable;
}

}  // namespace softfinger::judgement
