#include <fmt/format.h>

#include <memory>

#include "comparisons/commands/commands.h"
#include "comparisons/input/material_cards.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/system/files.h"

namespace softfinger::commands {

void add_explain(CLI::App& app, Action& action) {
  auto name = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("explain", "A model's assumptions, equations, source and validity");
  command
      ->add_option("MODEL", *name,
                   "name of a model, or \"all\"; see: list models; or of a hyperelastic "
                   "material: neo_hookean, mooney_rivlin, yeoh")
      ->required();
  command->footer(
      "Samples:\n"
      "  softfinger explain hertz\n"
      "  softfinger explain yeoh");
  command->callback([name, &action] {
    action = [name] {
      for (const input::MaterialCard& card : input::material_cards())
        if (card.name == *name) {
          system::write_text_to_stdout(fmt::format(
              "{}: {}\n\nEnergy:     {}\nParameters: {}\nSource:     {}\nValidity:   {}\n"
              "In a case:  [layer] material = \"{}\", [fem] kinematics = \"finite\"\n",
              card.name, card.title, card.energy, card.parameters, card.source, card.validity,
              card.name));
          return 0;
        }
      std::string text;
      for (const PressureModel* model :
           prediction::models_by_name(*name == "all" ? "everything" : *name)) {
        const ModelCard& card = model->card();
        text += fmt::format(
            "{}{}: {}\n\nAssumptions: {}\nEquations:   {}\nSource:      {}\nValidity:    {}\nCost: "
            "       {}\n",
            text.empty() ? "" : "\n", card.name, card.title, card.assumptions, card.equations,
            card.source, card.validity, card.cost);
      }
      system::write_text_to_stdout(text);
      return 0;
    };
  });
}

}  // namespace softfinger::commands
