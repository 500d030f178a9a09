#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/commands/command_tree.h"
#include "comparisons/commands/commands.h"
#include "comparisons/system/files.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

std::string words_of(const std::vector<DescribedOption>& options) {
  std::vector<std::string> names;
  for (const DescribedOption& option : options)
    names.insert(names.end(), option.names.begin(), option.names.end());
  return text::joined(names, " ");
}

/// Options of a command, with the program's own ones that every command takes.
std::vector<DescribedOption> options_of(const std::vector<DescribedCommand>& commands,
                                        const DescribedCommand& command) {
  std::vector<DescribedOption> options = command.options;
  for (const DescribedOption& option : commands.front().options)
    for (const std::string& name : option.names)
      if (name == "--quiet" && !command.name.empty()) options.push_back(option);
  return options;
}

std::string names_of_commands(const std::vector<DescribedCommand>& commands) {
  std::vector<std::string> names;
  for (const DescribedCommand& command : commands)
    if (!command.name.empty()) names.push_back(command.name);
  return text::joined(names, " ");
}

/// Bash code that completes the value of an option.
std::string bash_words(const DescribedOption& option, const std::string& commands) {
  if (!option.choices.empty())
    return fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$current\"))",
                       text::joined(option.choices, " "));
  if (option.names.empty() && option.value == "COMMAND")
    return fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$current\"))", commands);
  const std::string kind = listed_kind(option);
  if (!kind.empty())
    return fmt::format("COMPREPLY=($(compgen -f -W \"$(_softfinger_names {})\" -- \"$current\"))",
                       kind);
  return "COMPREPLY=($(compgen -f -- \"$current\"))";
}

std::string bash_script(const std::vector<DescribedCommand>& commands) {
  const std::string names = names_of_commands(commands);
  std::string values, options, positionals;
  for (const DescribedCommand& command : commands) {
    const std::vector<DescribedOption> all = options_of(commands, command);
    options += fmt::format("      '{}') options='{}' ;;\n", command.name, words_of(all));
    for (const DescribedOption& option : all) {
      if (option.value.empty()) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : option.names)
        patterns.push_back(fmt::format("'{} {}'", command.name, name));
      values += fmt::format("    {}) {}; return ;;\n", text::joined(patterns, "|"),
                            bash_words(option, names));
    }
    if (!command.positionals.empty())
      positionals += fmt::format("    '{}') {} ;;\n", command.name,
                                 bash_words(command.positionals.front(), names));
  }
  return "# bash completion for softfinger, made by: softfinger completion bash\n"
         "_softfinger_names() { softfinger list \"$1\" 2>/dev/null | cut -d' ' -f1; }\n"
         "_softfinger() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}\n"
         "  local command= options= i\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    [[ ${COMP_WORDS[i]} == -* ]] || { command=${COMP_WORDS[i]}; break; }\n"
         "  done\n"
         "  COMPREPLY=()\n"
         "  case \"$command $previous\" in\n" +
         values +
         "  esac\n"
         "  if [[ $current == -* ]]; then\n"
         "    case $command in\n" +
         options +
         "    esac\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
         "    return\n"
         "  fi\n"
         "  case $command in\n"
         "    '') COMPREPLY=($(compgen -W '" +
         names + "' -- \"$current\")) ;;\n" + positionals +
         "  esac\n"
         "}\n"
         "complete -o filenames -F _softfinger softfinger\n";
}

/// Puts text into single quotes of a shell.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

/// A description within a specification of zsh's _arguments.
std::string zsh_text(const std::string& text) {
  std::string result;
  for (const char c : first_sentence(text)) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string zsh_values(const DescribedOption& option, const std::string& commands) {
  if (!option.choices.empty()) return "(" + text::joined(option.choices, " ") + ")";
  if (option.names.empty() && option.value == "COMMAND") return "(" + commands + ")";
  const std::string kind = listed_kind(option);
  return kind.empty() ? "_files" : "_softfinger_" + kind;
}

std::string zsh_script(const std::vector<DescribedCommand>& commands) {
  const std::string names = names_of_commands(commands);
  std::string lists, described, cases;
  for (const char* kind : {"cases", "scenes", "sweeps", "models", "meshes"})
    lists += fmt::format(
        "_softfinger_{0}() {{ compadd -- ${{(f)\"$(softfinger list {0} 2>/dev/null | cut -d' ' "
        "-f1)\"}}; _files }}\n",
        kind);
  for (const DescribedCommand& command : commands) {
    if (command.name.empty()) continue;
    described += "    " + quoted(command.name + ":" + zsh_text(command.description)) + "\n";
    std::string specifications;
    for (const DescribedOption& option : options_of(commands, command))
      for (const std::string& name : option.names)
        specifications +=
            " \\\n        " +
            quoted((option.repeats ? "*" : "") + name + "[" + zsh_text(option.description) + "]" +
                   (option.value.empty() ? "" : ":value:" + zsh_values(option, names)));
    for (const DescribedOption& positional : command.positionals)
      specifications +=
          " \\\n        " + quoted((positional.repeats ? "*:" : ":") + positional.value + ":" +
                                   zsh_values(positional, names));
    cases += "    " + command.name + ") _arguments" + specifications + " ;;\n";
  }
  return "#compdef softfinger\n# zsh completion for softfinger, made by: softfinger completion "
         "zsh\n" +
         lists +
         "_softfinger() {\n"
         "  local -a commands=(\n" +
         described +
         "  )\n"
         "  local curcontext=$curcontext state line\n"
         "  _arguments -C '(-h --help)'{-h,--help}'[help]' '(-V "
         "--version)'{-V,--version}'[version]' "
         "'(-q --quiet)'{-q,--quiet}'[errors alone]' '1: :->command' '*:: :->rest'\n"
         "  case $state in\n"
         "    command) _describe command commands; return ;;\n"
         "  esac\n"
         "  case $line[1] in\n" +
         cases +
         "  esac\n"
         "}\n"
         "_softfinger \"$@\"\n";
}

/// Completes words only: -f leaves out files.
std::string fish_values(const DescribedOption& option, const std::string& commands) {
  if (!option.choices.empty()) return " -f -a " + quoted(text::joined(option.choices, " "));
  if (option.names.empty() && option.value == "COMMAND") return " -f -a " + quoted(commands);
  const std::string kind = listed_kind(option);
  return kind.empty() ? "" : " -a " + quoted("(__softfinger_names " + kind + ")");
}

std::string fish_script(const std::vector<DescribedCommand>& commands) {
  const std::string names = names_of_commands(commands);
  std::string text =
      "# fish completion for softfinger, made by: softfinger completion fish\n"
      "function __softfinger_names\n"
      "  softfinger list $argv[1] 2>/dev/null | string replace -r ' +' \\t\n"
      "end\n";
  for (const DescribedCommand& command : commands) {
    const std::string when = command.name.empty()
                                 ? " -n __fish_use_subcommand"
                                 : " -n " + quoted("__fish_seen_subcommand_from " + command.name);
    if (!command.name.empty())
      text += fmt::format("complete -c softfinger -f -n __fish_use_subcommand -a {} -d {}\n",
                          command.name, quoted(first_sentence(command.description)));
    for (const DescribedOption& option : options_of(commands, command)) {
      text += "complete -c softfinger" + when;
      for (const std::string& name : option.names)
        text += name[1] == '-' ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!option.value.empty()) text += " -r" + fish_values(option, names);
      text += " -d " + quoted(first_sentence(option.description)) + "\n";
    }
    for (const DescribedOption& positional : command.positionals)
      if (const std::string values = fish_values(positional, names); !values.empty())
        text += "complete -c softfinger" + when + values + "\n";
  }
  return text;
}

}  // namespace

void add_completion(CLI::App& app, Action& action) {
  struct Options {
    std::string shell, output;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "completion", "The script that lets a shell complete commands, options and names");
  command->add_option("SHELL", options->shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  CLI::Option* output =
      command->add_option("-o,--output", options->output,
                          "file to write, its folder created when missing; default: "
                          "standard output");
  command->add_flag("--json", options->json, "the script in one JSON object on standard output");
  command->footer(
      "Installed where the shells look for it. From a build, for this session:\n"
      "  source <(softfinger completion bash)\n"
      "Samples:\n"
      "  softfinger completion bash\n"
      "  softfinger completion fish");
  command->callback([options, output, &app, &action] {
    const bool write = output->count() > 0;
    action = [options, write, &app] {
      const auto commands = describe_commands(app);
      const std::string script = options->shell == "bash"  ? bash_script(commands)
                                 : options->shell == "zsh" ? zsh_script(commands)
                                                           : fish_script(commands);
      if (write) {
        const std::filesystem::path file = options->output;
        if (!file.has_filename())
          throw InputError("command line", "--output", "\"" + options->output + "\"",
                           "the name of a file");
        if (file.has_parent_path()) system::make_writable_folder(file.parent_path());
        system::write_file_atomically(file, script);
        if (!options->json) return 0;
      }
      system::write_to_stdout(options->json ? text::printed(nlohmann::json(
                                                  {{"shell", options->shell}, {"script", script}}))
                                            : script);
      return 0;
    };
  });
}

}  // namespace softfinger::commands
