// Functions that the page's script calls. Numbers go through memory, words come back as JSON.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "comparisons/explorer/explorer.h"
#include "comparisons/explorer/pad_explorer.h"
#include "softfinger/pads/outline_refusal.h"

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

constexpr std::size_t kPadNumbers = 15, kMostCorners = 400;
double pad_numbers[kPadNumbers + 2 * kMostCorners];

softfinger::ConvexOutline typed_outline(const double* values) {
  using softfinger::ConvexOutline;
  if (values[0] == 1) return ConvexOutline::disc(values[4]);
  if (values[0] == 0)
    return ConvexOutline::rounded_rectangle(
        values[1], values[2], std::min(values[3], std::min(values[1], values[2]) / 2));
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t i = 0; i < std::size_t(values[14]); ++i)
    corners.emplace_back(values[kPadNumbers + 2 * i], values[kPadNumbers + 2 * i + 1]);
  return ConvexOutline::polygon(corners);
}

/// Solved again only where the outline has changed: it takes longer than all else.
const softfinger::PadShape& typed_shape() {
  static std::unique_ptr<const softfinger::PadShape> shape;
  static std::vector<double> solved;
  std::vector<double> asked(pad_numbers, pad_numbers + 5);
  asked.insert(asked.end(), pad_numbers + kPadNumbers - 1,
               pad_numbers + kPadNumbers + 2 * std::size_t(pad_numbers[14]));
  if (asked != solved) {
    shape = std::make_unique<const softfinger::PadShape>(typed_outline(pad_numbers));
    solved = asked;
  }
  return *shape;
}

softfinger::explorer::PadQuestion typed_pad() {
  const double* values = pad_numbers;
  softfinger::explorer::PadQuestion question;
  question.problem = {
      &typed_shape(),
      {values[5], values[6], values[7]},
      {values[8], values[9]},
      values[10] == 0 ? softfinger::PadPressing::stuck : softfinger::PadPressing::frictionless,
      {}};
  question.tolerance = values[11];
  question.shown = int(values[12]);
  question.is_covered = values[13] != 0;
  return question;
}

}  // namespace

/// Never reached: the script keeps to outlines that exist.
void softfinger::refuse_outline(const char*, const std::string&, const std::string&) {
  __builtin_trap();
}

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

/// Buffer for a flat pad: 0 a rectangle, 1 a disc, 2 corners; length, width, radius of the corners,
/// diameter, h, E, nu, P, mu (SI); 0 stuck, 1 without friction; tolerance, the shown model's place,
/// 0 for a pad that its object does not cover, the number of corners, then x and y of each.
__attribute__((export_name("pad_question"))) double* pad_question() { return pad_numbers; }

/// `softfinger::explorer::pad_answer`, ended by a zero.
__attribute__((export_name("pad_answer"))) const char* pad_answer() {
  static std::string text;
  text = softfinger::explorer::pad_answer(typed_pad());
  return text.c_str();
}
}
