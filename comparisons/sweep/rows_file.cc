#include "comparisons/sweep/rows_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "softfinger/input/errors.h"

namespace softfinger::sweep {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const fs::path& file, const char* what) {
  throw InputError(file.string(), std::string(what) + " (" + std::strerror(errno) + ")", "", "");
}

}  // namespace

RowsFile::RowsFile(const fs::path& folder, const std::string& header, std::size_t rows_per_point,
                   bool go_on)
    : unfinished_(folder / "results.partial.csv"), finished_(folder / "results.csv") {
  descriptor_ = open(unfinished_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor_ < 0) refuse(unfinished_, "cannot be written");
  if (go_on) resume(header, rows_per_point);
  if (points_ > 0) return;
  if (ftruncate(descriptor_, 0) != 0 || lseek(descriptor_, 0, SEEK_SET) != 0)
    refuse(unfinished_, "cannot be written");
  append(header, 0);
}

RowsFile::~RowsFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void RowsFile::resume(const std::string& header, std::size_t rows_per_point) {
  std::vector<char> buffer(1 << 20);
  std::string first(header.size(), '\0');
  const auto got = pread(descriptor_, first.data(), first.size(), 0);
  if (got != static_cast<ssize_t>(header.size()) || first != header) return;
  off_t place = static_cast<off_t>(header.size()), whole = place;
  std::size_t rows = 0;
  while (true) {
    const ssize_t count = pread(descriptor_, buffer.data(), buffer.size(), place);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(unfinished_, "cannot be read");
    if (count == 0) break;
    const char* const end = buffer.data() + count;
    for (const char* at = buffer.data(); at < end; ++at) {
      at = static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at)));
      if (!at) break;
      if (++rows % rows_per_point == 0) whole = place + (at - buffer.data()) + 1;
    }
    place += count;
  }
  points_ = rows / rows_per_point;
  if (ftruncate(descriptor_, whole) != 0 || lseek(descriptor_, whole, SEEK_SET) != whole)
    refuse(unfinished_, "cannot be written");
}

void RowsFile::append(const std::string& text, std::size_t points) {
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t count = write(descriptor_, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(unfinished_, "cannot be written");
    written += static_cast<std::size_t>(count);
  }
  points_ += points;
}

void RowsFile::finish() {
  const bool synced = fsync(descriptor_) == 0;
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (close(descriptor) != 0 || !synced) refuse(unfinished_, "cannot be written");
  if (rename(unfinished_.c_str(), finished_.c_str()) != 0) refuse(finished_, "cannot be written");
}

}  // namespace softfinger::sweep
