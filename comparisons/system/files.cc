#include "comparisons/system/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "comparisons/system/terminal.h"
#include "meshes/io/input_files.h"
#include "meshes/io/output_file.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/visible_text.h"

namespace softfinger::system {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const std::string& where, const char* what, int error) {
  throw InputError(where, std::string(what) + " (" + std::strerror(error) + ")", "", "");
}

/// Returns 0 or the errno of the write that failed.
int write_all(int file, std::string_view content) {
  for (std::size_t written = 0; written < content.size();) {
    const ssize_t count = write(file, content.data() + written, content.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    written += static_cast<std::size_t>(count);
  }
  return 0;
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

std::string read_regular_file(const fs::path& path, std::size_t most_bytes, bool is_input) {
  // O_NONBLOCK, because opening a pipe waits for a writer. A device may have no end: it is refused.
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (file < 0) refuse(path.string(), "cannot be read", errno);
  struct stat status {};
  if (fstat(file, &status) != 0 || !(S_ISREG(status.st_mode) || S_ISDIR(status.st_mode))) {
    close(file);
    throw InputError(path.string(), "file", "a pipe or a device", "a regular file");
  }
  try {
    if (is_input) meshes::note_input(file, path.string());
    std::string content = read_all(file, path.string(), most_bytes);
    close(file);
    return content;
  } catch (...) {
    close(file);
    throw;
  }
}

}  // namespace

const std::string& read_standard_input(std::size_t most_bytes) {
  static const std::string content = [most_bytes] {
    meshes::note_input(STDIN_FILENO, "/dev/stdin");
    return read_all(STDIN_FILENO, "standard input", most_bytes);
  }();
  return content;
}

std::string read_text_file(const fs::path& path, std::size_t most_bytes) {
  return read_regular_file(path, most_bytes, true);
}

std::string read_file_to_rewrite(const fs::path& path, std::size_t most_bytes) {
  return read_regular_file(path, most_bytes, false);
}

void write_file_atomically(const fs::path& path, const std::string& content) {
  write_files_together({{path, content}});
}

void write_files_together(const std::vector<std::pair<fs::path, std::string>>& files) {
  std::vector<std::pair<std::string, std::string_view>> contents;
  contents.reserve(files.size());
  for (const auto& [path, content] : files) contents.emplace_back(path.string(), content);
  meshes::write_files(contents);
}

void announce_output(const std::string& option, const fs::path& path) {
  meshes::announce_output(option, path.string());
}

void open_standard_descriptors() { meshes::open_standard_descriptors(); }

GrowingFile::GrowingFile(const fs::path& path) : path_(path) {
  descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor_ < 0) refuse("cannot be written");
}

GrowingFile::~GrowingFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void GrowingFile::refuse(const char* what) const { system::refuse(path_.string(), what, errno); }

std::size_t GrowingFile::read(std::uint64_t place, char* buffer, std::size_t size) const {
  while (true) {
    const ssize_t count = pread(descriptor_, buffer, size, static_cast<off_t>(place));
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EINTR) refuse("cannot be read");
  }
}

std::string GrowingFile::read_all() const {
  std::string content;
  std::vector<char> buffer(1 << 16);
  while (const std::size_t count = read(content.size(), buffer.data(), buffer.size()))
    content.append(buffer.data(), count);
  return content;
}

void GrowingFile::cut_to(std::uint64_t size) {
  const auto place = static_cast<off_t>(size);
  if (ftruncate(descriptor_, place) != 0 || lseek(descriptor_, place, SEEK_SET) != place)
    refuse("cannot be written");
}

void GrowingFile::append(std::string_view text) {
  if (const int error = write_all(descriptor_, text))
    system::refuse(path_.string(), "cannot be written", error);
}

void GrowingFile::sync() {
  if (fsync(descriptor_) != 0) refuse("cannot be written");
}

void GrowingFile::rename_to(const fs::path& name) {
  if (rename(path_.c_str(), name.c_str()) != 0)
    system::refuse(name.string(), "cannot be written", errno);
  path_ = name;
}

void make_writable_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse(folder.string(), "cannot be created", error.value());
  if (!fs::is_directory(folder, error)) refuse(folder.string(), "cannot be written", ENOTDIR);
  // Permission bits say nothing about root, read-only mounts and full disks: only writing shows it.
  meshes::OutputFile probe((folder / "probe").string());
  probe.write("probe\n");
  probe.sync();
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
      throw InputError(folder.string(), "in use by " + read_file_to_rewrite(lock_file_), "",
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
  const bool is_taken = meshes::has_written_to_stdout();
  const int error = write_all(is_taken ? STDERR_FILENO : STDOUT_FILENO, text);
  if (error) refuse(is_taken ? "standard error" : "standard output", "cannot be written", error);
}

void write_text_to_stdout(const std::string& text) {
  const std::string visible = visible_text(text);
  write_to_stdout(has_colour(STDOUT_FILENO) ? with_colours(visible) : visible);
}

}  // namespace softfinger::system
