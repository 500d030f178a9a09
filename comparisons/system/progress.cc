#include "comparisons/system/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

#include "comparisons/system/terminal.h"
#include "softfinger/input/visible_text.h"

namespace softfinger::system {

Progress::Progress() : terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { clear(); }

void Progress::clear() {
  if (shown_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

void Progress::say(const std::string& line) {
  if (!is_quiet()) fail(line);
}

void Progress::fail(const std::string& typed_line) {
  clear();
  const std::string line = visible_text(typed_line);
  std::fputs(((has_colour(STDERR_FILENO) ? message_with_colours(line) : line) + "\n").c_str(),
             stderr);
}

void Progress::show(const std::string& typed_line) {
  if (!terminal_ || is_quiet()) return;
  const std::string line = visible_text(typed_line);
  winsize size = {};
  const std::size_t columns =
      ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col - 1u : 79u;
  // Cut between UTF-8 characters: continuation bytes take no column.
  std::size_t end = 0, used = 0;
  while (end < line.size()) {
    const bool starts_character = (static_cast<unsigned char>(line[end]) & 0xC0) != 0x80;
    if (starts_character && used == columns) break;
    used += starts_character ? 1 : 0;
    ++end;
  }
  clear();
  std::fputs(line.substr(0, end).c_str(), stderr);
  std::fflush(stderr);
  shown_ = true;
}

}  // namespace softfinger::system
