#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/case.h"
#include "comparisons/commands/commands.h"
#include "comparisons/files.h"
#include "comparisons/program_paths.h"
#include "comparisons/simulation/scene.h"
#include "comparisons/sweep/sweep_file.h"
#include "comparisons/verdict.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::commands {
namespace {

struct Entry {
  std::string name, title;
};

std::vector<Entry> entries(const std::string& kind) {
  std::vector<Entry> found;
  if (kind == "models")
    for (const PressureModel* model : all_pressure_models())
      found.push_back({std::string(model->card().name), std::string(model->card().title)});
  if (kind == "cases")
    for (const auto& file : builtin_case_files()) {
      const Case contact_case = read_case(file);
      found.push_back({file.stem().string(), fmt::format("{} ({})", contact_case.question,
                                                         load_list(contact_case.loads_N))});
    }
  if (kind == "scenes")
    for (const auto& file : builtin_scene_files())
      found.push_back({file.stem().string(), simulation::read_scene(file).question});
  if (kind == "sweeps")
    for (const auto& file : builtin_sweep_files())
      found.push_back({file.stem().string(), Sweep(read_sweep_text(file), file).base().question});
  return found;
}

}  // namespace

void add_list(CLI::App& app, Action& action) {
  struct Options {
    std::string kind;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("list", "What there is: models, cases, scenes or sweeps");
  command->add_option("KIND", options->kind, "models, cases, scenes or sweeps")
      ->required()
      ->check(CLI::IsMember({"models", "cases", "scenes", "sweeps"}));
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Samples:\n"
      "  softfinger list models\n"
      "  softfinger list cases --json");
  command->callback([options, &action] {
    action = [options] {
      const auto found = entries(options->kind);
      if (options->json) {
        nlohmann::json list = nlohmann::json::array();
        for (const Entry& entry : found)
          list.push_back({{"name", entry.name}, {"title", entry.title}});
        write_to_stdout(nlohmann::json({{options->kind, list}}).dump(2) + "\n");
      } else {
        std::string text;
        for (const Entry& entry : found)
          text += fmt::format("{:<28} {}\n", entry.name, entry.title);
        write_text_to_stdout(text);
      }
      if (found.empty()) remark("this version has no " + options->kind);
      return 0;
    };
  });
}

}  // namespace softfinger::commands
