#include "comparisons/commands/typed_words.h"

#include <algorithm>
#include <cctype>

#include "comparisons/text/nearest_name.h"
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

}  // namespace

std::vector<std::string> join_vectors(std::vector<std::string> words) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const std::string &flag = words[i], &value = words[i + 1];
    const bool is_vector = (flag == "--point" || flag == "--normal" || flag == "--near") &&
                           value.find(',') != std::string::npos;
    const bool is_direction = flag == "--along" && value.size() == 2 && value[0] == '-';
    if (!is_vector && !is_direction) continue;
    words[i] += "=" + value;
    words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
  return words;
}

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
    throw InputError("command line",
                     "unknown option \"" + text::shortened(typed) + "\" of " + name +
                         text::did_you_mean(typed, options) + " (see " + name + " --help)",
                     "", "");
  }
}

}  // namespace softfinger::commands
