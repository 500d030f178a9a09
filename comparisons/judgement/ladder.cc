#include "comparisons/judgement/ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "comparisons/judgement/comparison.h"
#include "comparisons/judgement/judgement.h"
#include "softfinger/input/constants.h"

namespace softfinger::judgement {
namespace {

LadderNumbers numbers_of(const RelativeErrors& errors) {
  return {errors.a, errors.b, errors.area, errors.indentation, errors.max_torque};
}

template <class Result>
LadderNumbers departure(const Result& result, const reference::ReferenceResult& reference) {
  return {result.a_m / reference.a_m - 1, result.b_m / reference.b_m - 1,
          result.area_projected_m2 / reference.area_projected_m2 - 1,
          result.indentation_m / reference.indentation_m - 1,
          result.max_torque_Nm / reference.max_torque_Nm - 1};
}

std::string_view name_of(const ModelComparison& model) { return model.answer.model->card().name; }

const ModelComparison* compared(const Comparison& comparison, std::string_view name) {
  for (const ModelComparison& model : comparison.models)
    if (name_of(model) == name && model.errors) return &model;
  return nullptr;
}

/// The one that comes nearest in area and torque.
const ModelComparison* nearest_closed_form(const Comparison& comparison) {
  const auto distance = [](const ModelComparison& model) {
    return std::max(std::abs(model.errors->area), std::abs(model.errors->max_torque));
  };
  const ModelComparison* nearest = nullptr;
  for (const char* name : {"hertz", "winkler", "thin_incompressible"})
    if (const ModelComparison* model = compared(comparison, name))
      if (!nearest || distance(*model) < distance(*nearest)) nearest = model;
  return nearest;
}

void add_doubts(const Comparison& comparison, Ladder& ladder) {
  if (const auto open = comparison.geometry_error(); open && comparison.geometry.patch) {
    const auto of = [&](prediction::Quantity quantity) { return (*open)[std::size_t(quantity)]; };
    using prediction::Quantity;
    ladder.doubts.push_back({"fit",
                             "fit of the radii, and its region",
                             {of(Quantity::a), of(Quantity::b), of(Quantity::area),
                              of(Quantity::indentation), of(Quantity::max_torque)}});
  }
  const auto departure = [](const reference::ReferenceErrors& stated) {
    return std::array<double, kLadderQuantities.size()>{
        stated.a.value_or(kNaN), stated.b.value_or(kNaN), stated.area.value_or(kNaN),
        stated.indentation.value_or(kNaN), stated.max_torque.value_or(kNaN)};
  };
  if (const auto& facets = comparison.reference->geometry_error)
    ladder.doubts.push_back({"facets", "facets of the mesh", departure(*facets)});
  ladder.doubts.push_back({"elements", "elements", departure(comparison.reference->error)});
}

/// "from Hertz to Bonded layer: -12 percentage points in area". Of area, indentation and torque: a
/// and b follow the area.
/// @param first  the step from which on
std::string largest_step(const std::vector<LadderStep>& steps, std::size_t first) {
  constexpr std::array<std::size_t, 3> quantities = {2, 3, 4};
  constexpr std::array<const char*, 3> words = {"area", "indentation", "torque"};
  double largest = 0;
  std::string sentence;
  for (std::size_t i = first + 1; i < steps.size(); ++i)
    for (std::size_t k = 0; k < quantities.size(); ++k) {
      const double change =
          steps[i].departure[quantities[k]] - steps[i - 1].departure[quantities[k]];
      if (!(std::abs(change) > largest)) continue;
      largest = std::abs(change);
      const double percent = 100 * change;
      sentence =
          fmt::format(std::abs(percent) < 9.95 ? "from {} to {}: {:+.1f} percentage points in {}"
                                               : "from {} to {}: {:+.0f} percentage points in {}",
                      steps[i - 1].words, steps[i].words, percent, words[k]);
    }
  return sentence;
}

}  // namespace

std::optional<Ladder> make_ladder(const Comparison& comparison,
                                  const IdealisedReferences& idealised) {
  if (!comparison.reference) return std::nullopt;
  const reference::ReferenceResult& reference = *comparison.reference;
  const input::Case& contact_case = *comparison.contact_case;
  Ladder ladder;
  if (const ModelComparison* closed = nearest_closed_form(comparison))
    ladder.steps.push_back({"closed_form", label(std::string(name_of(*closed))) + " in closed form",
                            numbers_of(*closed->errors)});
  if (const ModelComparison* layer = compared(comparison, "bonded_layer"))
    ladder.steps.push_back(
        {"layer_flat_linear", label("bonded_layer"), numbers_of(*layer->errors)});
  if (idealised.flat_linear)
    ladder.steps.push_back({"fem_flat_linear", "a flat layer in linear theory",
                            departure(*idealised.flat_linear, reference)});
  if (idealised.flat_finite)
    ladder.steps.push_back({"fem_flat_finite", "a flat layer at finite strain",
                            departure(*idealised.flat_finite, reference)});
  if (reference.frictionless) {
    input::Case frictionless = contact_case;
    frictionless.pressing = PressingFriction::none;
    ladder.steps.push_back({"fem_frictionless",
                            reference_in_words(frictionless) + ", pressed without friction",
                            departure(*reference.frictionless, reference)});
  }
  ladder.steps.push_back({contact_case.fem_curved   ? "fem_finger_finite"
                          : contact_case.fem_finite ? "fem_flat_finite"
                                                    : "fem_flat_linear",
                          reference_in_words(contact_case),
                          {}});
  const std::string largest = largest_step(ladder.steps, 0);
  if (!largest.empty()) ladder.sentence = "The largest step is " + largest + ".";
  // The closed form's is the largest nearly always: what remains is the news.
  if (ladder.steps.front().step == "closed_form")
    if (const std::string next = largest_step(ladder.steps, 1); !next.empty() && next != largest)
      ladder.sentence += " Beyond the closed form it is " + next + ".";
  add_doubts(comparison, ladder);
  return ladder;
}

}  // namespace softfinger::judgement
