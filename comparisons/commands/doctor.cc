#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/commands/commands.h"
#include "comparisons/judgement/atlas/error_atlas.h"
#include "comparisons/reference/finished_results.h"
#include "comparisons/report/explorer_page.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::commands {
namespace {

namespace fs = std::filesystem;

/// One thing that is there or not.
struct Finding {
  std::string name;
  bool there = false, required = false;
  std::string detail;  ///< where it is; of what is missing, what for and how to get it
};

/// The path of a program, among the folders of PATH; empty: none.
fs::path in_path(const std::string& name) {
  const char* const typed = std::getenv("PATH");
  const std::string folders = typed ? typed : "";
  for (std::size_t start = 0; start <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', start), folders.size());
    const fs::path path = fs::path(folders.substr(start, end - start)) / name;
    std::error_code error;
    if (end > start && fs::is_regular_file(path, error)) return path;
    start = end + 1;
  }
  return {};
}

Finding file_finding(const std::string& name, const fs::path& path, const std::string& remedy) {
  std::error_code error;
  const bool there = !path.empty() && fs::is_regular_file(path, error);
  return {name, there, false, there ? path.string() : remedy};
}

Finding count_finding(const std::string& name, std::size_t count, bool required,
                      const std::string& remedy) {
  return {name, count > 0, required, count > 0 ? fmt::format("{} built in", count) : remedy};
}

Finding fem_finding() {
  try {
    const fs::path program = system::fem_program();
    return {"finite elements", true, false, program.string()};
  } catch (const InputError&) {
    return {"finite elements", false, false,
            "softfinger-fem: for fem, compare and sweeps with fem = true; build with "
            "-DSOFTFINGER_BUILD_FEM=ON (Debian: libdeal.ii-dev), or name it in "
            "SOFTFINGER_FEM_PROGRAM"};
  }
}

Finding atlas_finding() {
  try {
    judgement::error_atlas();
    judgement::finite_strain_atlas();
    return {"error atlas", true, true, (system::share_folder() / "error_atlas.csv").string()};
  } catch (const std::exception& error) {
    return {"error atlas", false, true, error.what()};
  }
}

/// Looks in the build tree's lib, or in that of an installation, which may be a folder for each
/// architecture; empty: nowhere.
fs::path mujoco_library(const fs::path& prefix) {
  const char* const name = "libsoftfinger_mujoco.so";
  std::error_code error;
  if (fs::is_regular_file(prefix / "lib" / name, error)) return prefix / "lib" / name;
  for (fs::directory_iterator folder(prefix / "lib", error), end; !error && folder != end;
       folder.increment(error))
    if (std::error_code none; fs::is_regular_file(folder->path() / name, none))
      return folder->path() / name;
  return {};
}

std::vector<Finding> find_all() {
  const fs::path prefix = system::program_folder().parent_path();
  const fs::path share = prefix / "share";
  const std::string reinstall =
      "in " + system::share_folder().string() + ": install or build again";
  std::vector<Finding> findings = {
      {"softfinger", true, true,
       fmt::format("{} ({}, {}), {}", system::program_version(), system::compiler(),
                   system::build_type(), system::program_folder().string())},
      {"models", true, true, fmt::format("{} built in", all_pressure_models().size())},
      count_finding("cases", system::builtin_case_files().size(), true, reinstall),
      count_finding("scenes", system::builtin_scene_files().size(), true, reinstall),
      count_finding("meshes", system::builtin_mesh_files().size(), false,
                    "they need gmsh when softfinger is built (Debian: libgmsh-dev)"),
      atlas_finding(),
      fem_finding(),
      {"page of explore", report::has_explorer(), false,
       report::has_explorer()
           ? "built"
           : "softfinger explore needs a script: " + report::how_to_build_explorer()},
      file_finding(
          "robots' files", system::program_folder() / "softfinger-robot",
          "softfinger-robot: MJCF, URDF and SDF for simulate, meshes as DAE, GLB, glTF, PLY "
          "and 3MF; needs MuJoCo, urdfdom, libsdformat and Assimp when softfinger is built "
          "(Debian: libmujoco-dev, liburdfdom-dev, libsdformat-dev, libassimp-dev)"),
      file_finding("sweeps on many machines", system::program_folder() / "softfinger-sweep",
                   "softfinger-sweep: needs MPI when softfinger is built (Debian: "
                   "libopenmpi-dev)"),
      file_finding(
          "MuJoCo library", mujoco_library(prefix),
          "libsoftfinger_mujoco, torsional friction that follows the load: needs MuJoCo 2.2 "
          "when softfinger is built (Debian: libmujoco-dev)"),
      file_finding("mpirun", in_path("mpirun"), "starts softfinger-sweep (Debian: openmpi-bin)"),
      file_finding("ParaView", in_path("paraview"), "shows VTU files (Debian: paraview)"),
      file_finding("bash completion", share / "bash-completion/completions/softfinger",
                   "softfinger completion bash"),
      file_finding("man pages", share / "man/man1/softfinger.1", "softfinger manual predict"),
  };
  return findings;
}

int run_doctor(bool as_json) {
  const std::vector<Finding> findings = find_all();
  nlohmann::json list = nlohmann::json::array();
  std::string text;
  bool well = true;
  for (const Finding& finding : findings) {
    list.push_back({{"name", finding.name},
                    {"there", finding.there},
                    {"required", finding.required},
                    {"detail", finding.detail}});
    text += fmt::format("{:<8} {:<24} {}\n", finding.there ? "ok" : "missing", finding.name,
                        finding.detail);
    well = well && (finding.there || !finding.required);
  }
  if (as_json)
    system::write_to_stdout(
        text::printed(nlohmann::json({{"findings", list}, {"complete", well}})));
  else
    system::write_text_to_stdout((well ? "Nothing is missing that predictions need.\n"
                                       : "Something is missing that predictions need.\n") +
                                 text);
  return well ? 0 : 1;
}

}  // namespace

void add_doctor(CLI::App& app, Action& action) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand(
      "doctor", "What is installed, what is missing, what it is for and how to get it");
  command->add_flag("--json", *json, "one JSON object on standard output");
  command->footer(
      "Exit status 1 when something is missing that predictions need.\n"
      "Samples:\n"
      "  softfinger doctor");
  command->callback([json, &action] { action = [json] { return run_doctor(*json); }; });
}

}  // namespace softfinger::commands
