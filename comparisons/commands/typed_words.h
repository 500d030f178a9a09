#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

/// The words of a command line before CLI11 parses them.
namespace softfinger::commands {

/// "--normal -.5,0,1" becomes "--normal=-.5,0,1", and "--along -y" "--along=-y": a value that
/// starts with a minus sign looks like a flag.
std::vector<std::string> join_vectors(std::vector<std::string> words);

/// "softfinger version" is what "softfinger --version" is.
std::vector<std::string> with_version_as_option(std::vector<std::string> words);

/// Prepares the options of all commands: numbers go through the reader of text/number.h, and the
/// names of models and simulators may be typed in capital letters.
void prepare_options(CLI::App& app);

/// A message of the parser with the command's name and its own help; of something that is missing,
/// what it has to be.
std::string in_words(const CLI::App& app, const CLI::ParseError& error);

/// Refuses unknown commands and options with the nearest known name. The parser would name
/// something that is missing first, or no name at all.
/// @throws InputError
void refuse_unknown_words(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace softfinger::commands
