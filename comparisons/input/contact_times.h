#pragma once

#include <string>
#include <vector>

#include "softfinger/time/contact_history.h"

namespace softfinger::input {

/// Time in a case: how its layer relaxes, and how it is pressed.
struct ContactTimes {
  Relaxation relaxation;  ///< of the layer, whose typed modulus is the instantaneous one
  /// Loads in N or approaches in m over time; empty: each load of the case is put on at once, at
  /// the time 0, and held.
  std::vector<HistoryPoint> history;
  ContactHistory::Drive drive = ContactHistory::Drive::load;
  std::string where;  ///< "file:line" of the first key of these; empty: there is none

  bool are_given() const { return !where.empty(); }

  /// @param load_N  that is held where there is no history
  ContactHistory of(double load_N) const {
    return history.empty() ? ContactHistory::held(relaxation, drive, load_N)
                           : ContactHistory(relaxation, drive, history);
  }
};

}  // namespace softfinger::input
