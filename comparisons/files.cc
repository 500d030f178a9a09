#include "comparisons/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "softfinger/input/errors.h"

namespace softfinger {
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

}  // namespace

std::string read_text_file(const fs::path& path) {
  // Opening a pipe waits for someone to write into it, and a device may have no end.
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (file < 0) refuse(path.string(), "cannot be read", errno);
  struct stat status {};
  if (fstat(file, &status) != 0 || !(S_ISREG(status.st_mode) || S_ISDIR(status.st_mode))) {
    close(file);
    throw InputError(path.string(), "file", "a pipe or a device", "a regular file");
  }
  std::string content;
  char buffer[1 << 16];
  for (;;) {
    const ssize_t count = read(file, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int error = errno;
      close(file);
      refuse(path.string(), "cannot be read", error);
    }
    if (count == 0) break;
    content.append(buffer, static_cast<std::size_t>(count));
  }
  close(file);
  return content;
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
  const auto folder_of = [](const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
  };
  for (const auto& [path, content] : files) {
    temporaries.push_back(folder_of(path) / ("." + path.filename().string() + "." +
                                             std::to_string(getpid()) + ".tmp"));
    const int file =
        open(temporaries.back().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) refuse_all(path, errno);
    int error = write_all(file, content);
    // Network and quota-limited disks report a failed write only when the data is synced or closed.
    if (!error && fsync(file) != 0) error = errno;
    if (close(file) != 0 && !error) error = errno;
    if (error) refuse_all(path, error);
  }
  for (std::size_t i = 0; i < files.size(); ++i)
    if (rename(temporaries[i].c_str(), files[i].first.c_str()) != 0)
      refuse_all(files[i].first, errno);
  // The new names must survive a power cut too; some file systems cannot sync folders, which is no
  // failure.
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
  // Permission bits do not tell (root, read-only mounts, full disks): only writing does.
  const fs::path probe = folder / (".softfinger." + std::to_string(getpid()) + ".probe");
  const int file = open(probe.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) refuse(folder.string(), "cannot be written", errno);
  int failure = write_all(file, "probe\n");
  if (!failure && fsync(file) != 0) failure = errno;
  if (close(file) != 0 && !failure) failure = errno;
  unlink(probe.c_str());
  if (failure) refuse(folder.string(), "cannot be written", failure);
}

void write_to_stdout(const std::string& text) {
  const int error = write_all(STDOUT_FILENO, text);
  if (error) refuse("standard output", "cannot be written", error);
}

}  // namespace softfinger
