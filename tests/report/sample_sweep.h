#pragma once

#include <nlohmann/json.hpp>

namespace softfinger::tests {

/// Inputs of the page of `softfinger sweep`, in the shape of comparisons/report/README.md. Numbers
/// are plausible, not computed by the models: the page must not depend on them.

/// The thickness from 0.5 to 5 mm in ten steps (log), three loads. A model's torque is
/// 2 mN·m (h/mm)^(1/2) P/N, a straight line on logarithmic axes.
nlohmann::json sweep_of_one_key();

/// Thickness and Poisson's ratio against finite elements, of which some failed.
nlohmann::json sweep_with_fem();

/// Thickness over six values and one load, against finite elements.
nlohmann::json sweep_of_one_key_with_fem();

/// Three keys, every value with every other.
nlohmann::json sweep_of_three_keys();

/// Two keys that change together.
nlohmann::json sweep_of_zipped_keys();

/// Names longer than a phone is wide, values that differ in the sixth digit, an infinite radius.
nlohmann::json sweep_of_awkward_keys();

/// Four keys drawn at random: 20,000 rows of a million, eight models.
nlohmann::json sweep_at_random();

/// A single row, one value of the only key.
nlohmann::json sweep_of_one_row();

/// All rows failed.
nlohmann::json sweep_without_answers();

}  // namespace softfinger::tests
