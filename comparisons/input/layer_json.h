#pragma once

#include <nlohmann/json.hpp>

#include "softfinger/input/contact_problem.h"

namespace softfinger::input {

/// {"thickness_m", "youngs_modulus_Pa", "poisson_ratio"}, as results and FEM problems hold it.
inline nlohmann::json layer_json(const ElasticLayer& layer) {
  return {{"thickness_m", layer.thickness_m},
          {"youngs_modulus_Pa", layer.youngs_modulus_Pa},
          {"poisson_ratio", layer.poisson_ratio}};
}

}  // namespace softfinger::input
