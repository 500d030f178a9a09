#include "comparisons/input/setting.h"

#include <algorithm>

#include "comparisons/input/toml_reader.h"
#include "comparisons/system/files.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace fs = std::filesystem;

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

std::string read_typed_text(const fs::path& file) {
  return file == "-" ? system::read_standard_input(kLargestTomlFile)
                     : system::read_text_file(file, kLargestTomlFile);
}

fs::path name_of_typed(const fs::path& file) { return file == "-" ? "standard input" : file; }

}  // namespace softfinger::input
