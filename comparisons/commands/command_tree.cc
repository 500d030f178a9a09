#include "comparisons/commands/command_tree.h"

#include <algorithm>
#include <sstream>

namespace softfinger::commands {
namespace {

/// The words of "TEXT:{exact,paper}", as CLI11 describes a value that has to be one of them.
std::vector<std::string> choices_of(const std::string& type) {
  const std::size_t open = type.find('{'), close = type.rfind('}');
  std::vector<std::string> words;
  if (open == std::string::npos || close == std::string::npos || close < open) return words;
  std::istringstream list(type.substr(open + 1, close - open - 1));
  for (std::string word; std::getline(list, word, ',');) words.push_back(word);
  return words;
}

DescribedOption describe(const CLI::Option& option) {
  DescribedOption described;
  for (const std::string& name : option.get_snames()) described.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) described.names.push_back("--" + name);
  described.description = option.get_description();
  described.required = option.get_required();
  described.repeats = option.get_expected_max() > 1;
  described.choices = choices_of(option.get_type_name());
  if (!option.get_positional() || !described.names.empty()) {
    const std::string type = option.get_type_name();
    if (option.get_expected_max() > 0) described.value = type.substr(0, type.find_first_of(":{ "));
    if (option.get_expected_max() > 0 && described.value.empty()) described.value = "VALUE";
  } else {
    described.value = option.get_name(true);
  }
  return described;
}

DescribedCommand describe(const CLI::App& app, const std::string& name) {
  DescribedCommand command{name, app.get_description(), app.get_footer(), {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    const DescribedOption described = describe(*option);
    (described.names.empty() ? command.positionals : command.options).push_back(described);
  }
  return command;
}

}  // namespace

std::vector<DescribedCommand> describe_commands(const CLI::App& app) {
  std::vector<DescribedCommand> commands = {describe(app, "")};
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    commands.push_back(describe(*command, command->get_name()));
  return commands;
}

std::string first_sentence(const std::string& description) {
  std::string line = description;
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line.substr(0, line.find(". "));
}

std::string listed_kind(const DescribedOption& option) {
  const std::string& value = option.value;
  if (option.names.empty()) {
    if (value == "CASE" || value == "CASES") return "cases";
    if (value == "SCENE") return "scenes";
    if (value == "SWEEP") return "sweeps";
    if (value == "MODEL") return "models";
    if (value == "MESH") return "meshes";
    return "";
  }
  for (const std::string& name : option.names)
    if (name == "--model" || name == "--models") return "models";
  return "";
}

}  // namespace softfinger::commands
