#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "softfinger/time/relaxation_fit.h"

/// Results of `softfinger calibrate` on force against time, as text and as data.
namespace softfinger::calibration {

/// Sentences on the numbers that the forces leave open.
std::vector<std::string> cannot_tell(const RelaxationFit& fit,
                                     const std::vector<HeldForce>& forces);

/// The value of `[layer] relaxation`: [{ share = 0.12, time_s = 0.5 }], empty without a term.
std::string relaxation_toml(const RelaxationFit& fit);

/// The line to paste first, then shares and times with intervals, and what is left open.
std::string describe(const RelaxationFit& fit, const std::vector<HeldForce>& forces);

/// {"relaxation": [{"share", "share_std", "time_s", "time_interval95_s", "determined"}],
/// "long_time_modulus", "long_time_modulus_std", "force_at_once_N", "scatter_N", "forces",
/// "criterion", "cannot_tell"}.
nlohmann::json to_json(const RelaxationFit& fit, const std::vector<HeldForce>& forces);

}  // namespace softfinger::calibration
