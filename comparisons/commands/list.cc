#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/commands/commands.h"
#include "comparisons/input/case.h"
#include "comparisons/input/scene.h"
#include "comparisons/judgement/verdict.h"
#include "comparisons/prediction/mesh_points.h"
#include "comparisons/sweep/sweep_file.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "meshes/io/read_surface.h"
#include "softfinger/input/errors.h"
#include "softfinger/pads/pad_model.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::commands {
namespace {

/// A build without gmsh lacks the built-in meshes, and so scenes with them.
std::string question_of_scene(const std::filesystem::path& file) {
  try {
    return input::read_scene(file).question;
  } catch (const InputError& error) {
    return std::string("not in this build: ") + error.what();
  }
}

struct Entry {
  std::string name, title;
};

std::vector<Entry> entries(const std::string& kind) {
  std::vector<Entry> found;
  if (kind == "models")
    for (const PressureModel* model : all_pressure_models())
      found.push_back({std::string(model->card().name), std::string(model->card().title)});
  if (kind == "models")
    for (const PadModel* model : all_pad_models())
      found.push_back({std::string(model->card().name), std::string(model->card().title)});
  if (kind == "models")
    found.push_back(
        {std::string(line_layer().card().name), std::string(line_layer().card().title)});
  if (kind == "cases")
    for (const auto& file : system::builtin_case_files()) {
      const input::Case contact_case =
          input::read_case(file, {}, input::FlatPads::taken, input::Times::taken);
      found.push_back(
          {file.stem().string(), fmt::format("{} ({})", contact_case.question,
                                             judgement::load_list(contact_case.loads_N))});
    }
  if (kind == "scenes")
    for (const auto& file : system::builtin_scene_files())
      found.push_back({file.stem().string(), question_of_scene(file)});
  if (kind == "meshes")
    for (const auto& file : system::builtin_mesh_files()) {
      const auto surface = meshes::read_surface(file.string(), 1e-3).surface;
      const prediction::SurfaceFacts facts = prediction::facts_of(surface);
      const Eigen::Vector3d size_mm = 1e3 * (facts.largest_m - facts.least_m);
      found.push_back({file.stem().string(),
                       fmt::format("{:.3g} x {:.3g} x {:.3g} mm, {} triangles, {}", size_mm.x(),
                                   size_mm.y(), size_mm.z(), surface.triangles.size(),
                                   facts.open_edges == 0 ? "closed" : "open")});
    }
  if (kind == "sweeps")
    for (const auto& file : system::builtin_sweep_files())
      found.push_back(
          {file.stem().string(), sweep::Sweep(sweep::read_sweep_text(file), file).base().question});
  return found;
}

}  // namespace

void add_list(CLI::App& app, Action& action) {
  struct Options {
    std::string kind;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("list", "Names of the built-in models, cases, scenes, sweeps or meshes");
  command->add_option("KIND", options->kind, "models, cases, scenes, sweeps or meshes")
      ->required()
      ->check(CLI::IsMember({"models", "cases", "scenes", "sweeps", "meshes"}));
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Samples:\n"
      "  softfinger list models\n"
      "  softfinger list meshes\n"
      "  softfinger list cases --json");
  command->callback([options, &action] {
    action = [options] {
      const auto found = entries(options->kind);
      if (options->json) {
        nlohmann::json list = nlohmann::json::array();
        for (const Entry& entry : found)
          list.push_back({{"name", entry.name}, {"title", entry.title}});
        system::write_to_stdout(text::printed(nlohmann::json({{options->kind, list}})));
      } else {
        std::string text;
        for (const Entry& entry : found)
          text += fmt::format("{:<28} {}\n", entry.name, entry.title);
        system::write_text_to_stdout(text);
      }
      if (found.empty()) remark("this version has no " + options->kind);
      return 0;
    };
  });
}

}  // namespace softfinger::commands
