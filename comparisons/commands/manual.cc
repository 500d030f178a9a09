#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "comparisons/commands/command_tree.h"
#include "comparisons/commands/commands.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

/// Text for troff: a hyphen that can be copied, no backslash and no request at a line's start.
std::string troff(const std::string& text) {
  std::string result;
  bool starts_line = true;
  for (const char c : text) {
    if (starts_line && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
    starts_line = c == '\n';
  }
  return result;
}

std::string page_name(const DescribedCommand& command) {
  return command.name.empty() ? "softfinger" : "softfinger-" + command.name;
}

std::string typed_name(const DescribedCommand& command) {
  return command.name.empty() ? "softfinger" : "softfinger " + command.name;
}

std::string synopsis(const DescribedCommand& command) {
  std::string line = "\\fB" + troff(typed_name(command)) + "\\fR";
  if (command.name.empty()) return line + " [\\fIOPTIONS\\fR] \\fICOMMAND\\fR ...\n";
  for (const DescribedOption& positional : command.positionals) {
    const std::string value =
        "\\fI" + positional.value + "\\fR" + (positional.repeats ? " ..." : "");
    line += positional.required ? " " + value : " [" + value + "]";
  }
  for (const DescribedOption& option : command.options)
    if (option.required) line += " " + troff(option.names.back()) + " \\fI" + option.value + "\\fR";
  return line + " [\\fIOPTIONS\\fR]\n";
}

std::string entry(const DescribedOption& option) {
  std::string heading;
  for (const std::string& name : option.names)
    heading += (heading.empty() ? "\\fB" : ", \\fB") + troff(name) + "\\fR";
  if (!option.value.empty())
    heading += (heading.empty() ? "\\fI" : " \\fI") + option.value + "\\fR";
  return ".TP\n" + heading + "\n" + troff(option.description) + "\n";
}

/// The end of --help: notes, and samples, which begin with "  softfinger".
std::string footer(const std::string& text) {
  std::string notes, samples;
  std::istringstream lines(text);
  bool in_samples = false;
  for (std::string line; std::getline(lines, line);) {
    if (line == "Samples:") {
      in_samples = true;
      continue;
    }
    (in_samples ? samples : notes) += troff(line) + "\n";
  }
  return (notes.empty() ? "" : ".SH NOTES\n.nf\n" + notes + ".fi\n") +
         (samples.empty() ? "" : ".SH EXAMPLES\n.nf\n" + samples + ".fi\n");
}

std::string man_page(const std::vector<DescribedCommand>& commands,
                     const DescribedCommand& command) {
  std::string text = fmt::format(
      ".TH {} 1 \"\" \"softfinger {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}"
      ".SH DESCRIPTION\n{}\n",
      troff(page_name(command)), system::program_version(), troff(page_name(command)),
      troff(first_sentence(command.description)), synopsis(command), troff(command.description));
  if (command.name.empty()) {
    text += ".SH COMMANDS\n";
    for (const DescribedCommand& one : commands)
      if (!one.name.empty())
        text += ".TP\n\\fB" + troff(one.name) + "\\fR\n" + troff(one.description) + "\n";
  }
  text += ".SH OPTIONS\n";
  for (const DescribedOption& positional : command.positionals) text += entry(positional);
  for (const DescribedOption& option : command.options) text += entry(option);
  text += footer(command.footer) + ".SH SEE ALSO\n";
  std::vector<std::string> others;
  for (const DescribedCommand& one : commands)
    if (one.name != command.name) others.push_back("\\fB" + troff(page_name(one)) + "\\fR(1)");
  return text +
         text::joined(command.name.empty() ? others : std::vector<std::string>{others.front()}) +
         "\n";
}

}  // namespace

void add_manual(CLI::App& app, Action& action) {
  struct Options {
    std::string command, output;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "manual", "Man pages, made from the same source as --help: of the program, or of a command");
  command->add_option("COMMAND", options->command, "whose page; default: of the program itself");
  CLI::Option* output = command->add_option(
      "-o,--output", options->output,
      "folder, created when missing, for all pages: softfinger.1, softfinger-predict.1, ...");
  command->add_flag("--json", options->json, "one JSON object on standard output: pages by name");
  command->footer(
      "Installed where man looks for them: man softfinger-predict\n"
      "Samples:\n"
      "  softfinger manual predict\n"
      "  softfinger manual --output man_pages");
  command->callback([options, output, &app, &action] {
    const bool write = output->count() > 0;
    action = [options, write, &app] {
      const auto commands = describe_commands(app);
      if (write) {
        if (options->output.empty())
          throw InputError("command line", "--output", "\"\"", "the name of a folder");
        const std::filesystem::path folder = options->output;
        system::make_writable_folder(folder);
        for (const DescribedCommand& one : commands)
          system::write_file_atomically(folder / (page_name(one) + ".1"), man_page(commands, one));
      }
      std::vector<std::string> known;
      nlohmann::json pages = nlohmann::json::object();
      std::string text;
      for (const DescribedCommand& one : commands) {
        if (!one.name.empty()) known.push_back(one.name);
        if (!write && one.name != options->command) continue;
        text = man_page(commands, one);
        pages[page_name(one) + ".1"] = text;
      }
      if (pages.empty())
        throw InputError("command line",
                         "unknown command \"" + text::shortened(options->command) + "\"" +
                             text::did_you_mean(options->command, known) +
                             " (see softfinger --help)",
                         "", "");
      if (options->json)
        system::write_to_stdout(text::printed(nlohmann::json({{"pages", pages}})));
      else if (!write)
        system::write_to_stdout(text);
      return 0;
    };
  });
}

}  // namespace softfinger::commands
