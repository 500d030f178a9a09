#include "comparisons/commands/typed_words.h"

#include <algorithm>
#include <cctype>

#include "comparisons/commands/command_tree.h"
#include "comparisons/text/nearest_name.h"
#include "comparisons/text/number.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

std::vector<std::string> long_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// "-x", which has no near name.
void refuse_unknown_letter(const CLI::App& app, const CLI::App* command, const std::string& word) {
  std::vector<std::string> known;
  for (const CLI::App* one : {&app, command})
    if (one)
      for (const CLI::Option* option : one->get_options())
        for (const std::string& name : option->get_snames()) known.push_back("-" + name);
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  if (std::find(known.begin(), known.end(), word) == known.end())
    throw InputError("command line", "unknown option \"" + word + "\"", "", text::joined(known));
}

/// Refuses a text that is no number before the parser reads it, who takes nan, 0x10 and more.
void read_strictly(CLI::Option& option) {
  const std::string type = option.get_type_name(), kind = type.substr(0, type.find(':'));
  const bool is_whole = kind == "INT" || kind == "UINT";
  if (kind != "FLOAT" && !is_whole) return;
  const std::size_t range = type.find(" in [");
  const std::string allowed = std::string(is_whole ? "a whole number" : "a number such as 0.5") +
                              (range == std::string::npos ? "" : type.substr(range));
  const std::string name = option.get_name(option.get_positional());
  option.transform(CLI::Validator(
      [name, allowed, kind, is_whole](std::string& typed) {
        const bool is_number = is_whole ? text::read_whole_number(typed).has_value()
                                        : text::read_number(typed).has_value();
        if (!is_number || (kind == "UINT" && typed[0] == '-'))
          throw InputError("command line", name, "\"" + text::shortened(typed) + "\"", allowed);
        // The parser knows no plus sign before a whole number.
        if (typed[0] == '+') typed.erase(0, 1);
        return std::string();
      },
      ""));
}

void take_in_any_case(CLI::Option& option) {
  option.transform(CLI::Validator(
      [](std::string& typed) {
        typed = text::lower_case(typed);
        return std::string();
      },
      ""));
}

bool is_name_of_model_or_simulator(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true) == "MODEL";
  return option.check_lname("to") || option.check_lname("model") || option.check_lname("models");
}

}  // namespace

std::vector<std::string> with_version_as_option(std::vector<std::string> words) {
  const auto is_option = [](const std::string& word) { return !word.empty() && word[0] == '-'; };
  const auto command = std::find_if_not(words.begin(), words.end(), is_option);
  if (command != words.end() && *command == "version" &&
      std::all_of(command + 1, words.end(), is_option))
    return {"--version"};
  return words;
}

void prepare_options(CLI::App& app) {
  std::vector<CLI::App*> commands = app.get_subcommands([](CLI::App*) { return true; });
  commands.push_back(&app);
  for (CLI::App* command : commands)
    for (CLI::Option* option : command->get_options()) {
      read_strictly(*option);
      // The model of `apply` is a robot's file.
      if (is_name_of_model_or_simulator(*option) &&
          !(option->get_positional() && command->get_name() == "apply"))
        take_in_any_case(*option);
    }
}

std::string in_words(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> typed = app.get_subcommands();
  if (typed.empty()) return std::string(error.what()) + " (see softfinger --help)";
  const CLI::App& command = *typed.front();
  const std::string name = "softfinger " + command.get_name();
  const std::string help = "; see " + name + " --help";
  if (dynamic_cast<const CLI::RequiredError*>(&error))
    for (const CLI::Option* option : command.get_options())
      if (option->get_required() && option->count() == 0)
        return name + ": " + option->get_name(option->get_positional()) +
               " is missing: " + first_sentence(option->get_description()) + help;
  return name + ": " + error.what() + help;
}

std::vector<std::string> join_vectors(std::vector<std::string> words) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const std::string &flag = words[i], &value = words[i + 1];
    const bool is_vector =
        (flag == "--point" || flag == "--normal" || flag == "--near" || flag == "--pad") &&
        value.find(',') != std::string::npos;
    const bool is_direction =
        (flag == "--along" || flag == "--pad") && value.size() == 2 && value[0] == '-';
    if (!is_vector && !is_direction) continue;
    words[i] += "=" + value;
    words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
  return words;
}

namespace {

/// Hint at the place where a command without --model has its choice of a model; else empty.
std::string model_hint(const std::string& option, const std::string& command) {
  if (option != "--model" && option != "--models") return "";
  if (command == "sweep") return ": the models are a key of the file, [sweep] models = [\"hertz\"]";
  if (command == "simulate")
    return ": the model is a key of the scene, [[contact]] bodies = [\"*\", \"*\"], model = "
           "\"hertz\"";
  return ": predict, select, export, apply and calibrate take a choice of models";
}

}  // namespace

void refuse_unknown_words(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = nullptr;
  std::vector<std::string> known;
  for (const CLI::App* one : app.get_subcommands([](const CLI::App*) { return true; }))
    known.push_back(one->get_name());
  for (const std::string& word : words) {
    if (word == "--") return;  // from here on nothing is an option
    const bool is_option = word.size() > 2 && word.rfind("--", 0) == 0;
    if (!is_option && !command && word.rfind('-', 0) != 0) {
      if (std::find(known.begin(), known.end(), word) == known.end())
        throw InputError("command line",
                         "unknown command \"" + text::shortened(word) + "\"" +
                             text::did_you_mean(word, known) + " (see softfinger --help)",
                         "", "");
      command = app.get_subcommand(word);
    }
    if (word.size() == 2 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])))
      refuse_unknown_letter(app, command, word);
    if (!is_option) continue;
    const std::string typed = word.substr(0, word.find('='));
    std::vector<std::string> options = long_options(app);
    if (command)
      for (const std::string& name : long_options(*command)) options.push_back(name);
    if (std::find(options.begin(), options.end(), typed) != options.end()) continue;
    const std::string name = command ? "softfinger " + command->get_name() : "softfinger";
    const std::string hint = model_hint(typed, command ? command->get_name() : "");
    throw InputError("command line",
                     "unknown option \"" + text::shortened(typed) + "\" of " + name +
                         (hint.empty() ? text::did_you_mean(typed, options) : hint) + " (see " +
                         name + " --help)",
                     "", "");
  }
}

}  // namespace softfinger::commands
