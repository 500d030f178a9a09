#pragma once

#include <string>

#include "comparisons/input/scene.h"
#include "comparisons/prediction/taxel_answer.h"
#include "comparisons/simulation/recording.h"

namespace softfinger::simulation {

/// Readings of an array under each soft contact of a recording, as a table: a row per step, contact
/// and taxel, the first columns time_s, body_a, body_b, then those of
/// `prediction::taxel_csv_header`. The array is centred on the contact, wherever that moves, and
/// its x runs along the contact's long axis. The pressure is that of the contact's model, without
/// friction, under the normal force at the end of the step.
/// @param every  of so many steps one, >= 1, the last one too
/// @throws InputError for a pitch that is missing, as an array does not grow with the load, and for
/// a depth that a body's layer does not have
/// Cost: about 10 ms per step and contact, at depth 40 ms.
std::string taxels_csv(const Recording& recording, const input::Scene& scene,
                       const prediction::TaxelRequest& request, int every);

/// Refuses what `taxels_csv` does, before anything is simulated.
/// @throws InputError
void check_taxels(const input::Scene& scene, const prediction::TaxelRequest& request);

}  // namespace softfinger::simulation
