#include "comparisons/input/setting.h"

#include <algorithm>

#include "comparisons/input/toml_path.h"
#include "comparisons/input/toml_reader.h"
#include "comparisons/system/files.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestId = 64;
constexpr const char* kIdLetters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";

}  // namespace

bool is_id(const std::string& text) {
  return !text.empty() && text.size() <= kLongestId && text[0] != '.' &&
         text.find_first_not_of(kIdLetters) == std::string::npos;
}

std::string id_of(const fs::path& file) {
  std::string id = file.stem().string().substr(0, kLongestId);
  for (std::size_t at = 0; (at = id.find_first_not_of(kIdLetters, at)) != std::string::npos;)
    id[at] = '_';
  if (!id.empty() && id[0] == '.') id[0] = '_';
  return id;
}

Setting parse_setting(const std::string& typed) {
  const std::string allowed = "KEY=VALUE on one line, for instance layer.thickness_mm=3";
  const std::size_t equals = typed.find('=');
  const auto is_control = [](unsigned char letter) { return letter < 0x20 || letter == 0x7f; };
  if (equals == std::string::npos || equals == 0 || equals + 1 == typed.size() ||
      std::any_of(typed.begin(), typed.end(), is_control))
    throw InputError("command line", "--set", "\"" + text::shortened(typed) + "\"", allowed);
  const auto trimmed = [](const std::string& text) {
    const std::size_t first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
  };
  return {trimmed(typed.substr(0, equals)), trimmed(typed.substr(equals + 1)),
          "--set " + text::shortened(typed, 100)};
}

void require_each_key_once(const Settings& settings) {
  for (std::size_t i = 0; i < settings.size(); ++i) {
    // A key that is no path is refused where it is applied.
    const std::vector<std::string> steps = steps_of(settings[i].key);
    for (std::size_t j = 0; j < i && !steps.empty(); ++j) {
      const std::vector<std::string> others = steps_of(settings[j].key);
      // A table and a number within it: the later one of both could undo the other.
      const std::size_t common = std::min(steps.size(), others.size());
      if (common > 0 &&
          std::equal(steps.begin(), steps.begin() + std::ptrdiff_t(common), others.begin()))
        throw InputError("command line",
                         settings[j].where + " and " + settings[i].where + " both say what " +
                             (steps.size() > others.size() ? settings[i].key : settings[j].key) +
                             " is",
                         "", "one of them");
    }
  }
}

std::string read_typed_text(const fs::path& file) {
  return file == "-" ? system::read_standard_input(kLargestTomlFile)
                     : system::read_text_file(file, kLargestTomlFile);
}

fs::path name_of_typed(const fs::path& file) { return file == "-" ? "standard input" : file; }

}  // namespace softfinger::input
