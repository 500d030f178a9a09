#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "comparisons/commands/commands.h"
#include "comparisons/input/material_cards.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/system/files.h"
#include "comparisons/text/json_text.h"
#include "softfinger/pads/pad_model.h"

namespace softfinger::commands {

void add_explain(CLI::App& app, Action& action) {
  struct Options {
    std::string name;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("explain", "A model's assumptions, equations, source and validity");
  command
      ->add_option("MODEL", options->name,
                   "name of a model, or \"all\"; see: list models; or of a hyperelastic "
                   "material: neo_hookean, mooney_rivlin, yeoh")
      ->required();
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Samples:\n"
      "  softfinger explain hertz\n"
      "  softfinger explain yeoh");
  command->callback([options, &action] {
    action = [options] {
      const std::string& name = options->name;
      const auto print = [&](const nlohmann::json& object) {
        system::write_to_stdout(text::printed(object));
        return 0;
      };
      for (const input::MaterialCard& card : input::material_cards())
        if (card.name == name) {
          if (options->json)
            return print({{"material", card.name},
                          {"title", card.title},
                          {"energy", card.energy},
                          {"parameters", card.parameters},
                          {"source", card.source},
                          {"validity", card.validity}});
          system::write_text_to_stdout(fmt::format(
              "{}: {}\n\nEnergy:     {}\nParameters: {}\nSource:     {}\nValidity:   {}\n"
              "In a case:  [layer] material = \"{}\", [fem] kinematics = \"finite\"\n",
              card.name, card.title, card.energy, card.parameters, card.source, card.validity,
              card.name));
          return 0;
        }
      std::vector<const ModelCard*> cards;
      const PadModel* const pad =
          name == line_layer().card().name ? &line_layer() : find_pad_model(name);
      if (pad)
        cards.push_back(&pad->card());
      else
        for (const PressureModel* model :
             prediction::models_by_name(name == "all" ? "everything" : name))
          cards.push_back(&model->card());
      if (name == "all")
        for (const PadModel* model : all_pad_models()) cards.push_back(&model->card());
      if (name == "all") cards.push_back(&line_layer().card());
      std::string text;
      nlohmann::json models = nlohmann::json::array();
      for (const ModelCard* shown : cards) {
        const ModelCard& card = *shown;
        models.push_back({{"model", card.name},
                          {"title", card.title},
                          {"assumptions", card.assumptions},
                          {"equations", card.equations},
                          {"source", card.source},
                          {"validity", card.validity},
                          {"cost", card.cost}});
        text += fmt::format(
            "{}{}: {}\n\nAssumptions: {}\nEquations:   {}\nSource:      {}\nValidity:    {}\nCost: "
            "       {}\n",
            text.empty() ? "" : "\n", card.name, card.title, card.assumptions, card.equations,
            card.source, card.validity, card.cost);
      }
      if (options->json) return print({{"models", models}});
      system::write_text_to_stdout(text);
      return 0;
    };
  });
}

}  // namespace softfinger::commands
