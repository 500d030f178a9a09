#include "comparisons/commands/robot_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/commands/temporary_folder.h"
#include "comparisons/simulation/simulate.h"
#include "comparisons/system/files.h"
#include "comparisons/system/process_pool.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/alike_lines.h"
#include "comparisons/text/number.h"
#include "comparisons/text/robot_mesh_title.h"
#include "meshes/io/mesh_formats.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace fs = std::filesystem;
namespace {

/// "BODY:THICKNESS_MM,YOUNGS_MODULUS_kPa,POISSON_RATIO" as four words.
std::vector<std::string> layer_words(const std::string& typed) {
  const std::string allowed =
      "BODY:THICKNESS_MM,YOUNGS_MODULUS_kPa,POISSON_RATIO, such as tip:2,300,0.49; thickness and "
      "modulus > 0, Poisson's ratio from 0 to 0.5";
  const std::size_t colon = typed.rfind(':');
  const auto refuse = [&] {
    throw InputError("command line", "--finger-layer", "\"" + typed + "\"", allowed);
  };
  if (colon == std::string::npos || colon == 0) refuse();
  const auto numbers = text::read_numbers(typed.substr(colon + 1));
  if (!numbers || numbers->size() != 3) refuse();
  const std::vector<double>& layer = *numbers;
  if (!(layer[0] > 0 && layer[1] > 0 && layer[2] >= 0 && layer[2] <= 0.5)) refuse();
  std::vector<std::string> words = {typed.substr(0, colon)};
  for (const double number : layer) words.push_back(fmt::format("{}", number));
  return words;
}

/// Writes what the program has made: the scene, and its meshes beside it.
/// @param made  folder with the meshes
/// @throws InputError where a mesh would replace a file that is not of this command's making
void write_scene(const fs::path& scene_file, const std::string& scene, const fs::path& made) {
  std::vector<std::pair<fs::path, std::string>> files;
  for (const auto& entry : fs::directory_iterator(made)) {
    const fs::path mesh = scene_file.parent_path() / entry.path().filename();
    const std::string content = system::read_file_to_rewrite(entry.path());
    std::error_code error;
    const fs::file_status there = fs::symlink_status(mesh, error);
    if (fs::exists(there)) {
      const std::string old =
          fs::is_regular_file(there) ? system::read_file_to_rewrite(mesh) : std::string();
      if (old == content) continue;
      if (old.rfind(text::kRobotMeshTitle, 0) != 0)
        throw InputError(mesh.string(), "is there already, and is no mesh of --write-scene", "",
                         "another folder for --write-scene, or this one without that file");
    }
    files.emplace_back(mesh, content);
  }
  std::sort(files.begin(), files.end());
  std::error_code error;
  const fs::file_status there = fs::status(scene_file, error);
  if (!files.empty() && fs::exists(there) && !fs::is_regular_file(there))
    throw InputError(scene_file.string(), "--write-scene", "a device or a pipe",
                     "a file, beside which the scene's meshes can lie");
  files.emplace_back(scene_file, scene);
  system::write_files_together(files);
}

}  // namespace

void add_robot(CLI::App& command, RobotInput& typed) {
  command
      .add_option("--finger-layer", typed.finger_layers,
                  "soft layer on a body of a robot's file, repeatable: "
                  "BODY:THICKNESS_MM,YOUNGS_MODULUS_kPa,POISSON_RATIO")
      ->expected(1)
      ->take_all();
  command.add_option("--write-scene", typed.write_scene,
                     "writes the scene made of a robot's file there (TOML), its meshes beside it");
  command
      .add_option("--package-path", typed.package_paths,
                  "folder with the packages of a robot's file, repeatable: package://NAME/.. is "
                  "looked for there, then above the file")
      ->expected(1)
      ->take_all();
  command.add_flag("--verbose", typed.verbose,
                   "lists remarks that are alike, instead of one with their number");
}

bool is_robot(const std::string& file) {
  const std::string suffix = text::lower_case(fs::path(file).extension().string());
  return suffix == ".xml" || suffix == ".mjcf" || suffix == ".urdf" || suffix == ".sdf" ||
         suffix == ".xacro";
}

void remark_all(const std::vector<std::string>& lines, bool verbose) {
  for (const std::string& line :
       verbose ? lines : text::alike_as_one(lines, "--verbose lists them"))
    remark(line);
}

input::Scene read_robot(const std::string& file, const RobotInput& typed,
                        const input::Settings& settings) {
  constexpr std::size_t kMostRobotBytes = std::size_t(16) << 20;
  system::read_text_file(file, kMostRobotBytes);  // refuses what is no file, or too large
  const TemporaryFolder temporary;
  const bool writes = !typed.write_scene.empty();
  // The robot's own meshes and included files are not known here.
  if (is_robot(typed.write_scene) || meshes::mesh_format(typed.write_scene))
    throw InputError("command line", "--write-scene", typed.write_scene,
                     "the name of a scene's file, such as scene.toml");
  const fs::path scene_file = writes ? fs::absolute(typed.write_scene) : fs::path(file);
  const fs::path draft = temporary.path() / (input::id_of(file) + ".toml");
  if (writes) system::make_writable_folder(scene_file.parent_path());
  system::ProcessJob job;
  job.command = {system::robot_program().string(), fs::absolute(file).string(),
                 temporary.path().string(), input::id_of(file)};
  for (const std::string& folder : typed.package_paths) {
    std::error_code error;
    if (!fs::is_directory(folder, error))
      throw InputError("command line", "--package-path", "\"" + folder + "\"", "a folder");
    job.command.insert(job.command.end(), {"--package-path", fs::absolute(folder).string()});
  }
  for (const std::string& layer : typed.finger_layers)
    for (const std::string& word : layer_words(layer)) job.command.push_back(word);
  job.time_limit_s = 120;
  job.memory_limit_MB = 4000;
  std::vector<std::string> lines;
  system::ProcessOutcome outcome;
  system::ProcessCallbacks callbacks;
  callbacks.on_line = [&](std::size_t, const std::string& line) { lines.push_back(line); };
  callbacks.on_finish = [&](std::size_t, const system::ProcessOutcome& ended) { outcome = ended; };
  if (const int signal = system::run_processes({job}, 1, callbacks))
    throw system::Interrupted(signal);
  if (!outcome.succeeded()) {
    if (outcome.exit_status >= 0 && !outcome.last_line.empty()) {
      const std::string& path = job.command[1];
      if (outcome.last_line.rfind(path + ":", 0) != 0)
        throw InputError(file, outcome.last_line, "", "");
      // The file as it was typed, and the line where there is one.
      const std::size_t colon = outcome.last_line.find(": ");
      throw InputError(file + outcome.last_line.substr(path.size(), colon - path.size()),
                       outcome.last_line.substr(colon + 2), "", "");
    }
    throw InputError(file, "reading it ended the program softfinger-robot",
                     outcome.exceeded == system::ProcessLimit::time     ? "after two minutes"
                     : outcome.exceeded == system::ProcessLimit::memory ? "at 4 GB"
                                                                        : "by a fault",
                     "a robot's file of fewer or smaller parts");
  }
  remark_all(lines, typed.verbose);
  const auto keep = [&] {
    write_scene(scene_file, outcome.output, temporary.path());
    remark("the scene is in " + typed.write_scene);
  };
  input::Scene scene;
  try {
    scene = input::parse_scene(outcome.output, draft, settings);
  } catch (const InputError& error) {
    if (writes) {
      keep();
      input::parse_scene(outcome.output, scene_file, settings);  // names a line of what is kept
    }
    const std::string path = draft.string();
    if (error.where().rfind(path, 0) != 0) throw;
    const std::string line = error.where().substr(path.size());  // ":13", or nothing
    throw InputError(
        file,
        fmt::format("the scene made of it, which --write-scene SCENE.toml would keep{}: {}",
                    line.empty() ? "" : ", line " + line.substr(1), error.field()),
        error.value(), error.allowed());
  }
  const simulation::SeparatedBodies separated = simulation::separate_overlapping_bodies(scene);
  remark_all(separated.remarks, typed.verbose);
  outcome.output += separated.tables;
  scene.text += separated.tables;
  if (writes) keep();
  scene.file = scene_file;  // the draft is gone when the scene is simulated
  return scene;
}

}  // namespace softfinger::commands
