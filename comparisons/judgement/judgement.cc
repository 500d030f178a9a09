#include "comparisons/judgement/judgement.h"

#include <algorithm>

namespace softfinger::judgement {

Judgement judge(double error, bool sound, double tolerance) {
  if (!(error <= tolerance)) return Judgement::off;
  return sound ? Judgement::usable : Judgement::accident;
}

std::string label(const std::string& model) {
  if (model == "fem") return "FEM";
  if (model == "fem_coarse") return "FEM, coarse mesh";
  std::string words = model;
  std::replace(words.begin(), words.end(), '_', ' ');
  if (!words.empty() && words[0] >= 'a' && words[0] <= 'z') words[0] += 'A' - 'a';
  return words;
}

}  // namespace softfinger::judgement
