#include "comparisons/judgement/reference_bound.h"

#include "comparisons/judgement/assessment.h"
#include "softfinger/input/constants.h"

namespace softfinger::judgement {
namespace {

using prediction::QuantityErrors;

/// One entry per quantity, in the order of `prediction::Quantity`.
QuantityErrors errors_of(const reference::ReferenceErrors& stated) {
  return {stated.a.value_or(kNaN),
          stated.b.value_or(kNaN),
          stated.indentation.value_or(kNaN),
          stated.area.value_or(kNaN),
          stated.peak_pressure.value_or(kNaN),
          stated.max_torque.value_or(kNaN)};
}

QuantityErrors sum(QuantityErrors one, const QuantityErrors& other) {
  for (std::size_t q = 0; q < one.size(); ++q) one[q] += other[q];
  return one;
}

}  // namespace

ReferenceBound bound_of(const SolvedReference& solved) {
  const QuantityErrors elements = errors_of(solved.result.error);
  const input::Case& contact_case = solved.contact_case;
  if (solved.is_full && solved.within_theory) {
    if (solved.result.is_geometry_unknown)
      return {std::nullopt,
              "what the scan's facets leave open is not known: another reading of "
              "them could not be pressed"};
    if (solved.result.geometry_error)
      return {sum(elements, errors_of(*solved.result.geometry_error)),
              "two meshes, and other readings of the scan: both errors together"};
    return {elements, "two meshes"};
  }
  if (contact_case.object_layer.thickness_m > 0)
    return {std::nullopt,
            "how far two flat layers in linear theory are from the bodies themselves is not known"};
  if (contact_case.fem_curved || contact_case.fem_finite || solved.by_approach)
    return {std::nullopt, "how far this idealisation is from the finger itself is not known"};
  const prediction::Assessment layer =
      assess(contact_case, solved.geometry,
             prediction::ask_model(*find_pressure_model("bonded_layer"), contact_case,
                                   solved.geometry, solved.result.load_N, 0),
             prediction::TorqueRule::exact, prediction::Demand{});
  if (!layer.known())
    return {std::nullopt,
            "how far a flat layer in linear theory is from the finger itself is not known: " +
                layer.evidence};
  QuantityErrors distance;
  for (std::size_t q = 0; q < distance.size(); ++q)
    distance[q] = layer.total(prediction::Quantity(q));
  return {sum(elements, distance),
          "the elements' own error and that of bonded_layer, which solves the same theory: " +
              layer.evidence};
}

}  // namespace softfinger::judgement
