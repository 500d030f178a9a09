#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace softfinger::system {

/// "0.1.0"
std::string program_version();
/// "GNU 12.2.0"
std::string compiler();
/// "Release"
std::string build_type();

/// The folder of the running program, from /proc/self/exe: data and the FEM program are found
/// relative to it, the same way in the build tree and when installed.
std::filesystem::path program_folder();

/// `../share/softfinger` beside the program's folder.
std::filesystem::path share_folder();

/// The path of `softfinger-fem`: the environment variable SOFTFINGER_FEM_PROGRAM if it is set, else
/// the folder of this program.
/// @throws InputError when there is no such executable.
std::filesystem::path fem_program();

/// The path of `softfinger-robot`, which reads other simulators' files, beside this program.
/// @throws InputError when there is no such executable.
std::filesystem::path robot_program();

/// All built-in case files, ordered by name.
std::vector<std::filesystem::path> builtin_case_files();

/// A case file as typed on the command line: a path, the name of a built-in case, or "-", standard
/// input.
std::filesystem::path find_case_file(const std::string& typed);

/// Scenes: the built-in ones, and one as typed on the command line.
std::vector<std::filesystem::path> builtin_scene_files();
std::filesystem::path find_scene_file(const std::string& typed);

/// Sweeps, likewise.
std::vector<std::filesystem::path> builtin_sweep_files();
std::filesystem::path find_sweep_file(const std::string& typed);

/// Data sets of published measurements, likewise.
std::vector<std::filesystem::path> builtin_experiment_files();
std::filesystem::path find_experiment_file(const std::string& typed);

/// A file of measurements as typed on the command line, a table or a picture: a path, or the name
/// of a built-in file with its suffix.
std::filesystem::path find_measurement_file(const std::string& typed);

/// All built-in meshes, ordered by name.
std::vector<std::filesystem::path> builtin_mesh_files();

/// The path of a mesh file: relative to `folder` (empty: the working directory) if it exists there,
/// else a built-in mesh of that name, with or without ".stl".
std::filesystem::path find_mesh_file(const std::string& typed, const std::filesystem::path& folder);

}  // namespace softfinger::system
