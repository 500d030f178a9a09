#pragma once

#include "comparisons/input/case.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"
#include "softfinger/accuracy/error_bound.h"

/// The one place that says whether a model's answer is usable without finite elements: its bounds
/// against the finger itself, and what the geometry leaves open.
namespace softfinger::judgement {

/// Whether the layer's sublayers differ: one of equal sublayers is homogeneous.
bool is_stack(const input::Case& contact_case);

/// Whether it has sublayers that differ, or a layer on each body.
bool has_several_layers(const input::Case& contact_case);

/// @param answer     of the case's contact
/// @param rule       by which the torque is stated
/// @param demand     what an answer has to meet to be usable
prediction::Assessment assess(const input::Case& contact_case,
                              const prediction::LocalGeometry& geometry,
                              const prediction::ModelAnswer& answer, prediction::TorqueRule rule,
                              const prediction::Demand& demand);

/// `assess` without its evidence in words, which costs more than all of its numbers.
prediction::Assessment assess_numbers(const input::Case& contact_case,
                                      const prediction::LocalGeometry& geometry,
                                      const prediction::ModelAnswer& answer,
                                      prediction::TorqueRule rule,
                                      const prediction::Demand& demand);

/// Assesses finite elements of the whole finger that have not run.
prediction::Assessment assess_finite_elements(const input::Case& contact_case,
                                              const prediction::LocalGeometry& geometry,
                                              double load_N, const prediction::Demand& demand);

}  // namespace softfinger::judgement
