#include "comparisons/system/program_paths.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "comparisons/text/nearest_name.h"
#include "comparisons/text/number.h"
#include "softfinger/input/errors.h"

namespace softfinger::system {
namespace fs = std::filesystem;

fs::path program_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::current_path() : program.parent_path();
}

fs::path share_folder() { return program_folder().parent_path() / "share" / "softfinger"; }

fs::path fem_program() {
  const char* chosen = std::getenv("SOFTFINGER_FEM_PROGRAM");
  const fs::path program =
      chosen && *chosen ? fs::path(chosen) : program_folder() / "softfinger-fem";
  std::error_code error;
  if (!fs::is_regular_file(program, error) || access(program.c_str(), X_OK) != 0)
    throw InputError(
        program.string(),
        "the finite-element program does not exist; install the package softfinger-fem, build it "
        "with -DSOFTFINGER_BUILD_FEM=ON or name it in SOFTFINGER_FEM_PROGRAM",
        "", "");
  return program;
}

fs::path robot_program() {
  const fs::path program = program_folder() / "softfinger-robot";
  std::error_code error;
  if (!fs::is_regular_file(program, error) || access(program.c_str(), X_OK) != 0)
    throw InputError(
        program.string(),
        "the program that reads robots' files, and meshes other than STL and OBJ, does "
        "not exist; install the package softfinger-robot, or build where MuJoCo, "
        "urdfdom, libsdformat or Assimp are (Debian: libmujoco-dev, liburdfdom-dev, "
        "libsdformat-dev, libassimp-dev)",
        "", "");
  return program;
}

namespace {

std::vector<fs::path> builtin_files(const char* folder, const char* ending = ".toml") {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(share_folder() / folder, error))
    if (entry.path().extension() == ending) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

fs::path find_builtin(const std::string& typed, const char* folder, const char* kind) {
  std::error_code error;
  if (typed == "-" || fs::exists(typed, error)) return typed;
  // Only a bare name can mean a built-in file: a path that does not exist is a mistake to report.
  if (typed.find('/') == std::string::npos && !typed.empty()) {
    for (const std::string& name : {typed, typed + ".toml"}) {
      const fs::path builtin = share_folder() / folder / name;
      if (fs::is_regular_file(builtin, error)) return builtin;
    }
    std::vector<std::string> names;
    for (const fs::path& file : builtin_files(folder)) {
      names.push_back(file.stem().string());
      const std::string name = text::lower_case(names.back()), any_case = text::lower_case(typed);
      if (any_case == name || any_case == name + ".toml") return file;
    }
    if (!names.empty())
      throw InputError(typed,
                       std::string("neither a file nor a built-in ") + kind +
                           text::did_you_mean(fs::path(typed).stem().string(), names),
                       "", text::joined(names));
  }
  return typed;
}

}  // namespace

std::vector<fs::path> builtin_case_files() { return builtin_files("cases"); }
std::vector<fs::path> builtin_mesh_files() { return builtin_files("meshes", ".stl"); }
std::vector<fs::path> builtin_scene_files() { return builtin_files("scenes"); }
std::vector<fs::path> builtin_sweep_files() { return builtin_files("sweeps"); }
std::vector<fs::path> builtin_experiment_files() { return builtin_files("experiments"); }

fs::path find_case_file(const std::string& typed) { return find_builtin(typed, "cases", "case"); }
fs::path find_scene_file(const std::string& typed) {
  return find_builtin(typed, "scenes", "scene");
}

fs::path find_sweep_file(const std::string& typed) {
  return find_builtin(typed, "sweeps", "sweep");
}

fs::path find_experiment_file(const std::string& typed) {
  return find_builtin(typed, "experiments", "data set");
}

fs::path find_measurement_file(const std::string& typed) {
  std::error_code error;
  if (fs::exists(typed, error)) return typed;
  const fs::path builtin = share_folder() / "measurements" / typed;
  return fs::is_regular_file(builtin, error) && typed.find('/') == std::string::npos
             ? builtin
             : fs::path(typed);
}

fs::path find_mesh_file(const std::string& typed, const fs::path& folder) {
  std::error_code error;
  const fs::path path = folder.empty() ? fs::path(typed) : folder / typed;
  if (fs::exists(path, error)) return path;
  for (const std::string& name : {typed, typed + ".stl"}) {
    const fs::path builtin = share_folder() / "meshes" / name;
    if (!typed.empty() && fs::is_regular_file(builtin, error)) return builtin;
  }
  return path;
}

}  // namespace softfinger::system
