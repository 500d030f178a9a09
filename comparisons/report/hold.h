#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparisons/report/motion_data.h"
#include "comparisons/simulation/recording.h"

namespace softfinger::report {

/// Whether the contacts that hold something go on holding it: read from a recorded motion.
///
/// Counted are the soft contacts (those with an ellipse); in a motion without any those between two
/// movable bodies; otherwise all. A contact slips where the path of one slide exceeds
/// `kLeastSlip_m`; ten instants without sliding end a slide. The path of a step is |relative
/// displacement along the surface| + e_n |relative rotation about the normal|, of the instants at
/// which the solver says that the contact slides. What slides less, as a fingertip does that finds
/// its place, counts as held.
struct Hold {
  static constexpr double kLeastSlip_m = 1e-5;

  /// State of a contact at an instant.
  enum class State {
    absent,
    sticks,
    at_limit,  ///< its wrench is at its friction limit and it creeps: less than `kLeastSlip_m`
    slips      ///< at its limit too, in a slide that goes farther
  };

  /// A counted contact over the motion.
  struct Contact {
    std::size_t track = 0;
    double first_s = 0, last_s = 0;      ///< touches
    std::optional<double> slips_from_s;  ///< begins to slide there; nothing: it never slips
    double slips_until_s = 0;            ///< slides last
    double slip_m = 0, turn_rad = 0;     ///< how far in all, along the surface and about the normal
    double utilisation = 0;              ///< largest one before it slips
    double utilisation_s = 0;            ///< when
    bool touches_at_end = false;
    std::vector<State> states;  ///< per instant
  };
  std::vector<Contact> contacts;
  bool soft_only = false;  ///< whether only the soft contacts are counted
  double start_s = 0, end_s = 0, time_step_s = 0;

  bool holds() const;
  /// The contact that slips first; null when none does.
  const Contact* first_slip() const;
  /// The contact that comes nearest to its limit without slipping; null when all slip.
  const Contact* nearest() const;
  /// The time after which no contact slides any more; nothing when one does to the end, or none
  /// ever does.
  std::optional<double> holds_again_s() const;
};

/// @param tracks  those of `follow_contacts`
Hold examine_hold(const simulation::Recording& recording, const std::vector<ContactTrack>& tracks);

/// States of a contact, one for each instant, whether it is counted or not.
std::vector<Hold::State> states_of(const simulation::Recording& recording,
                                   const ContactTrack& track);

/// "sticks", "at its limit" or "slips"; empty where it does not touch.
const char* in_words(Hold::State state);

/// The answer in a sentence or two: whether it holds, until when, which contact slips first, and
/// how near the others come. Empty when nothing touches.
std::string in_words(const Hold& hold, const simulation::Recording& recording,
                     const std::vector<ContactTrack>& tracks);

/// "holds", "slips", "slips and holds again", "lets go" (no counted contact is left at the end) or
/// "touches nothing".
std::string outcome_of(const Hold& hold);

/// Outcome of a scene as it is written and with other models of its contacts, in a sentence that
/// begins with whether both are the same.
std::string outcome_in_words(const simulation::Recording& plain,
                             const simulation::Recording& chosen, const std::string& change);

/// Keys `holds`, `until_s`, `first_slip`, `again_s`, `nearest`, `utilisation`; SI units, absent
/// values null.
Json to_json(const Hold& hold, const simulation::Recording& recording,
             const std::vector<ContactTrack>& tracks);

}  // namespace softfinger::report
