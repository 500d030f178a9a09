#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

/// The commands and options that --help shows, for completions and man pages.
namespace softfinger::commands {

struct DescribedOption {
  std::vector<std::string> names;    ///< "--json", "-h"; empty for a positional
  std::string value;                 ///< what follows the name, or the positional: "CASE"; "": none
  std::vector<std::string> choices;  ///< all values there are, or empty
  std::string description;
  bool required = false, repeats = false;
};

struct DescribedCommand {
  std::string name, description, footer;
  std::vector<DescribedOption> positionals, options;
};

/// The program itself first, with an empty name, then its commands.
std::vector<DescribedCommand> describe_commands(const CLI::App& app);

/// The first sentence of a description, on one line.
std::string first_sentence(const std::string& description);

/// The list that `softfinger list` has of a value's names, "cases" for CASE, or empty.
std::string listed_kind(const DescribedOption& option);

}  // namespace softfinger::commands
