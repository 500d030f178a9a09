#pragma once

#include <string>

#include "comparisons/simulation/recording.h"

namespace softfinger::report {

/// Origin of a recording; empty parts are left out.
struct MotionPageOptions {
  std::string scene_text;  ///< the scene file
  std::string version, date;
  std::string command;  ///< that writes the page again
};

/// One HTML file that plays a recording in 3-D, with its contacts, their forces over time and each
/// wrench against its limit surface; needs no network. Text, tables and provenance are complete
/// without JavaScript. Shown are 300 frames at most, fewer when there are many contacts or bodies,
/// and meshes of 32,000 triangles in all, coarsened if need be, so that the page stays below 3 MB;
/// the tables are of all steps.
/// @throws std::out_of_range when a frame lacks a body or a contact names one that does not exist.
std::string motion_page(const simulation::Recording& recording, const MotionPageOptions& options);

}  // namespace softfinger::report
