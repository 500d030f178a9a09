#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "comparisons/input/scene.h"

/// Robots from other simulators' files as scenes.
namespace softfinger::commands {

struct RobotInput {
  std::vector<std::string> finger_layers;  ///< as typed
  std::string write_scene;                 ///< a file; empty: none
  std::vector<std::string> package_paths;  ///< folders in which package://NAME/.. lies
  bool verbose = false;                    ///< remarks that are alike are not counted but listed
};

void add_robot(CLI::App& command, RobotInput& typed);

/// Whether a file is a robot's, by its suffix: .xml, .mjcf, .urdf, .sdf or .xacro, in small or
/// capital letters. The last one is refused with the command that makes a URDF file of it.
bool is_robot(const std::string& file);

/// Prints remarks, those that are alike as one with a count unless all are wanted.
void remark_all(const std::vector<std::string>& lines, bool verbose);

/// The scene of a robot's file, as the program softfinger-robot writes it. Bodies that
/// overlap at the start do not collide.
/// @throws InputError
input::Scene read_robot(const std::string& file, const RobotInput& typed,
                        const input::Settings& settings);

}  // namespace softfinger::commands
