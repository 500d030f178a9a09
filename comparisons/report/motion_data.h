#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparisons/report/html.h"
#include "comparisons/simulation/recording.h"

namespace softfinger::report {

/// A contact followed through the motion. Recordings list the contacts of each instant separately.
/// Curves over time need the same contact throughout: else they would jump when a pair of bodies
/// touches in several places.
struct ContactTrack {
  int a = -1, b = -1;
  int ordinal = 0;  ///< among the tracks of the same two bodies, from 0
  /// For each frame the index into its contacts, or nothing while the bodies do not touch here.
  std::vector<std::optional<std::size_t>> contacts;
};

/// Follows every contact by its place on body `b`. A pair of bodies gets as many tracks as it has
/// contacts at one time, so contacts that come back continue a track.
std::vector<ContactTrack> follow_contacts(const simulation::Recording& recording);

/// "thumb – glass", numbered where a pair has several.
std::string track_name(const simulation::Recording& recording,
                       const std::vector<ContactTrack>& tracks, std::size_t track);

/// Which frames are shown: evenly spaced, the first and the last among them.
std::vector<std::size_t> shown_frames(const simulation::Recording& recording);

/// Data that motion.js plays. Arrays are base64 of little-endian float32 or uint32: short, and a
/// picture shows no more digits.
Json motion_data(const simulation::Recording& recording, const std::vector<ContactTrack>& tracks);

}  // namespace softfinger::report
