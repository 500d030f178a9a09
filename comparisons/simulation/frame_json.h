#pragma once

#include <nlohmann/json.hpp>

#include "comparisons/simulation/recording.h"

namespace softfinger::simulation {

/// The bodies of a frame, in their order: name, position, quaternion with w >= 0, velocities; SI.
nlohmann::json bodies_json(const Frame& frame, const std::vector<RecordedBody>& bodies);

/// The contacts of a frame: bodies, point, forces along the world's axes, ellipse, use of the
/// limit.
nlohmann::json contacts_json(const Frame& frame, const std::vector<RecordedBody>& bodies);

}  // namespace softfinger::simulation
