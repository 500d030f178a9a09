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
};

void add_robot(CLI::App& command, RobotInput& typed);

/// Whether a file is a robot's, by its suffix: .xml, .mjcf, .urdf or .sdf, in small or
/// capital letters.
bool is_robot(const std::string& file);

/// The scene of a robot's file, as the program softfinger-robot writes it.
/// @throws InputError
input::Scene read_robot(const std::string& file, const RobotInput& typed,
                        const input::Settings& settings);

}  // namespace softfinger::commands
