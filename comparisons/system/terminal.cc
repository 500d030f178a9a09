#include "comparisons/system/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <vector>

namespace softfinger::system {
namespace {

bool quiet = false;

bool is_set(const char* variable) {
  const char* const value = std::getenv(variable);
  return value && *value;
}

std::string in_colour(const char* code, const std::string& text) {
  return std::string("\033[") + code + "m" + text + "\033[0m";
}

constexpr const char *kBold = "1", *kRed = "1;31", *kGreen = "32", *kYellow = "33";

/// Colours the answer in the column "usable", which follows two columns in per cent.
std::string with_usable(std::string line) {
  for (const auto& [word, colour] : {std::pair("    yes ", kGreen), std::pair("     no ", kRed)}) {
    const std::string ending = word;
    const std::size_t at = line.find(ending);
    if (at == std::string::npos || at == 0 || (line[at - 1] != '%' && line[at - 1] != '?'))
      continue;
    return line.replace(at, ending.size(), in_colour(colour, ending));
  }
  return line;
}

}  // namespace

void set_quiet(bool wanted) { quiet = wanted; }
bool is_quiet() { return quiet; }

bool has_colour(int descriptor) {
  if (is_set("NO_COLOR")) return false;
  if (is_set("CLICOLOR_FORCE") && std::string(std::getenv("CLICOLOR_FORCE")) != "0") return true;
  const char* const terminal = std::getenv("TERM");
  return isatty(descriptor) == 1 && terminal && std::string(terminal) != "dumb";
}

std::string with_colours(const std::string& visible) {
  std::vector<std::string> lines;
  std::istringstream stream(visible);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  const auto is_indented = [](const std::string& line) { return line.rfind("  ", 0) == 0; };
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool is_title = !lines[i].empty() && !is_indented(lines[i]) && i + 1 < lines.size() &&
                          is_indented(lines[i + 1]);
    text += is_title ? in_colour(kBold, lines[i]) : with_usable(lines[i]);
    if (i + 1 < lines.size() || (!visible.empty() && visible.back() == '\n')) text += '\n';
  }
  return text;
}

std::string within_columns(const std::string& text, std::size_t columns) {
  std::string out;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    // Columns of UTF-8: one for each byte that does not continue a character.
    std::size_t column = 0, start = 0, space = std::string::npos;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (line[i] == ' ' && i > start + indent) space = i;
      column += (static_cast<unsigned char>(line[i]) & 0xC0) != 0x80;
      if (column <= columns || space == std::string::npos) continue;
      out += line.substr(start, space - start) + "\n" + std::string(indent + 4, ' ');
      start = space + 1;
      i = space;
      column = indent + 4;
      space = std::string::npos;
    }
    out += line.substr(start);
    if (end < text.size()) out += '\n';
    begin = end + 1;
  }
  return out;
}

std::string within_terminal(const std::string& text) {
  winsize size{};
  if (isatty(STDOUT_FILENO) != 1 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 ||
      size.ws_col < 20)
    return text;
  return within_columns(text, size.ws_col);
}

std::string message_with_colours(const std::string& line) {
  for (const auto& [start, colour] :
       {std::pair("softfinger: error:", kRed), std::pair("softfinger:", kYellow)}) {
    const std::string begin = start;
    if (line.rfind(begin, 0) == 0) return in_colour(colour, begin) + line.substr(begin.size());
  }
  return line;
}

}  // namespace softfinger::system
