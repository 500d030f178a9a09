#include "comparisons/system/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "comparisons/system/terminal.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/visible_text.h"

namespace softfinger::system {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const std::string& where, const char* what, int error) {
  throw InputError(where, std::string(what) + " (" + std::strerror(error) + ")", "", "");
}

/// Returns 0 or the errno of the write that failed.
int write_all(int file, const std::string& content) {
  for (std::size_t written = 0; written < content.size();) {
    const ssize_t count = write(file, content.data() + written, content.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    written += static_cast<std::size_t>(count);
  }
  return 0;
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Creates a file beside `path` under a random name. If others can write to the folder, they could
/// put a link under a predictable name and redirect the content.
/// @param temporary  the file's name
/// @returns its descriptor; -1 with errno
int create_temporary(const fs::path& path, fs::path& temporary) {
  constexpr int kAttempts = 100;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::uint64_t number = 0;
    if (getrandom(&number, sizeof number, 0) != sizeof number) return -1;
    temporary = folder_of(path) / fmt::format(".{}.{:016x}.tmp", path.filename().string(), number);
    const int file =
        open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file >= 0 || errno != EEXIST) return file;
  }
  return -1;
}

/// Writes the whole content and closes the file.
/// @returns 0 or the errno of what failed
int fill(int file, const std::string& content) {
  int error = write_all(file, content);
  // Network and quota-limited disks report a failed write only when the data is synced or closed.
  if (!error && fsync(file) != 0) error = errno;
  if (close(file) != 0 && !error) error = errno;
  return error;
}

/// "process 4711 on host: softfinger compare ..."
std::string description_of_this_process() {
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  std::string command = read_text_file("/proc/self/cmdline");
  std::replace(command.begin(), command.end(), '\0', ' ');
  while (!command.empty() && command.back() == ' ') command.pop_back();
  return fmt::format("process {} on {}: {}", getpid(), host, command);
}

/// Reads to the end. @param name  for messages
std::string read_all(int file, const std::string& name, std::size_t most_bytes) {
  std::string content;
  char buffer[1 << 16];
  for (;;) {
    const ssize_t count = read(file, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(name, "cannot be read", errno);
    if (count == 0) return content;
    if (static_cast<std::size_t>(count) > most_bytes - content.size())
      throw InputError(name, "size of the file", "",
                       "at most " + std::to_string(most_bytes >> 20) + " MiB");
    content.append(buffer, static_cast<std::size_t>(count));
  }
}

}  // namespace

const std::string& read_standard_input(std::size_t most_bytes) {
  static const std::string content = read_all(STDIN_FILENO, "standard input", most_bytes);
  return content;
}

std::string read_text_file(const fs::path& path, std::size_t most_bytes) {
  // O_NONBLOCK, because opening a pipe waits for a writer. A device may have no end: it is refused.
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (file < 0) refuse(path.string(), "cannot be read", errno);
  struct stat status {};
  if (fstat(file, &status) != 0 || !(S_ISREG(status.st_mode) || S_ISDIR(status.st_mode))) {
    close(file);
    throw InputError(path.string(), "file", "a pipe or a device", "a regular file");
  }
  try {
    std::string content = read_all(file, path.string(), most_bytes);
    close(file);
    return content;
  } catch (...) {
    close(file);
    throw;
  }
}

void write_file_atomically(const fs::path& path, const std::string& content) {
  write_files_together({{path, content}});
}

void write_files_together(const std::vector<std::pair<fs::path, std::string>>& files) {
  std::vector<fs::path> temporaries;
  const auto refuse_all = [&](const fs::path& path, int error) {
    for (const fs::path& temporary : temporaries) unlink(temporary.c_str());
    refuse(path.string(), "cannot be written", error);
  };
  for (const auto& [path, content] : files) {
    fs::path temporary;
    const int file = create_temporary(path, temporary);
    if (file < 0) refuse_all(path, errno);
    temporaries.push_back(temporary);
    if (const int error = fill(file, content)) refuse_all(path, error);
  }
  for (std::size_t i = 0; i < files.size(); ++i)
    if (rename(temporaries[i].c_str(), files[i].first.c_str()) != 0)
      refuse_all(files[i].first, errno);
  // Syncing the folder makes the new names survive a power cut. Some file systems cannot do that,
  // which is not treated as a failure.
  for (const auto& [path, content] : files) {
    const int directory = open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory < 0) continue;
    fsync(directory);
    close(directory);
  }
}

void make_writable_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse(folder.string(), "cannot be created", error.value());
  if (!fs::is_directory(folder, error)) refuse(folder.string(), "cannot be written", ENOTDIR);
  // Permission bits say nothing about root, read-only mounts and full disks: only writing shows it.
  fs::path probe;
  const int file = create_temporary(folder / "probe", probe);
  if (file < 0) refuse(folder.string(), "cannot be written", errno);
  const int failure = fill(file, "probe\n");
  unlink(probe.c_str());
  if (failure) refuse(folder.string(), "cannot be written", failure);
}

OutputFolder::OutputFolder(const fs::path& folder) : lock_file_(folder / ".softfinger.lock") {
  make_writable_folder(folder);
  while (true) {
    descriptor_ = open(lock_file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor_ < 0) refuse(lock_file_.string(), "cannot be written", errno);
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const bool in_use = errno == EWOULDBLOCK;
      close(descriptor_);
      descriptor_ = -1;
      if (!in_use) return;  // a file system without locks
      throw InputError(folder.string(), "in use by " + read_text_file(lock_file_), "",
                       "a folder of its own for each run, or this one when that run has ended");
    }
    // An ending run may have removed the lock file after it was opened here. Then the lock is on a
    // file without a name, and another run could lock a new file under the same name: try again.
    struct stat opened = {}, named = {};
    if (fstat(descriptor_, &opened) == 0 && stat(lock_file_.c_str(), &named) == 0 &&
        opened.st_ino == named.st_ino)
      break;
    close(descriptor_);
  }
  // For the message of another run that finds the folder in use. A failure to write it is harmless.
  if (ftruncate(descriptor_, 0) == 0) write_all(descriptor_, description_of_this_process());
}

OutputFolder::~OutputFolder() {
  if (descriptor_ < 0) return;
  unlink(lock_file_.c_str());
  close(descriptor_);
}

void write_to_stdout(const std::string& text) {
  const int error = write_all(STDOUT_FILENO, text);
  if (error) refuse("standard output", "cannot be written", error);
}

void write_text_to_stdout(const std::string& text) {
  const std::string visible = visible_text(text);
  write_to_stdout(has_colour(STDOUT_FILENO) ? with_colours(visible) : visible);
}

}  // namespace softfinger::system
