#include "meshes/io/output_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>

#include "meshes/io/input_files.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/hash.h"

namespace softfinger::meshes {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kTemporaryEnd = ".softfinger.tmp";

std::atomic<bool> written_to_stdout = false;

[[noreturn]] void refuse_output(const std::string& path, const std::string& why,
                                const std::string& allowed) {
  throw InputError(path, "cannot be written (" + why + ")", "", allowed);
}

std::string folder_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

bool is_same_file(const struct stat& one, const struct stat& other) {
  return one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

/// A descriptor of this process that a link in /proc names, or -1.
int own_descriptor(const std::string& path) {
  std::error_code error;
  const fs::path folder = fs::canonical(folder_of(path), error);
  if (error || folder != fs::canonical("/proc/self/fd", error)) return -1;
  const std::string name = fs::path(path).filename().string();
  if (name.empty() || name.size() > 9 || name.find_first_not_of("0123456789") != std::string::npos)
    return -1;
  return std::stoi(name);
}

/// Destination of a path after all links have been followed.
struct Target {
  std::string path;
  int own_descriptor = -1;           ///< it is an open file of this process
  std::optional<struct stat> there;  ///< none: a new file
};

Target follow_links(const std::string& typed) {
  constexpr int kMostLinks = 40;
  Target target{typed, -1, {}};
  for (int links = 0;; ++links) {
    struct stat status = {};
    if (lstat(target.path.c_str(), &status) != 0) {
      if (errno == ENOENT) return target;
      refuse_output(typed, std::strerror(errno), "");
    }
    target.own_descriptor = own_descriptor(target.path);
    if (!S_ISLNK(status.st_mode) || target.own_descriptor >= 0) {
      target.there = status;
      break;
    }
    if (links == kMostLinks) refuse_output(typed, std::strerror(ELOOP), "");
    if (status.st_uid != geteuid() && status.st_uid != 0)
      refuse_output(typed, "a link that another user has made", "the file that it leads to");
    std::error_code error;
    const fs::path next = fs::read_symlink(target.path, error);
    if (error) refuse_output(typed, error.message(), "");
    target.path = (fs::path(folder_of(target.path)) / next).string();
  }
  if (target.own_descriptor < 0 && S_ISREG(target.there->st_mode))
    for (const int standard : {STDOUT_FILENO, STDERR_FILENO}) {
      struct stat open_file = {};
      if (fstat(standard, &open_file) == 0 && is_same_file(open_file, *target.there))
        target.own_descriptor = standard;
    }
  return target;
}

/// Refuses a regular file that must not be replaced.
void check_replaced(const std::string& path, const Target& target) {
  const struct stat& there = *target.there;
  if (is_input(there)) refuse_output(path, "this command reads it", "another name for the output");
  constexpr mode_t kWritable = 0222;
  // The system lets root write to all files.
  if ((there.st_mode & kWritable) == 0 ||
      faccessat(AT_FDCWD, target.path.c_str(), W_OK, AT_EACCESS) != 0)
    refuse_output(path, "it is read-only", "another name, or chmod u+w of this file");
  if (there.st_nlink > 1)
    refuse_output(path,
                  "it is one file with " + std::to_string(there.st_nlink) + " names, hard links",
                  "another name, or this one when it has been removed");
}

/// Removes what killed processes have left in a folder: files of our naming and our user on which
/// no process holds a lock. Failures do not matter.
void remove_abandoned(const std::string& folder) {
  const std::unique_ptr<DIR, int (*)(DIR*)> open_folder(opendir(folder.c_str()), closedir);
  if (!open_folder) return;
  while (const dirent* entry = readdir(open_folder.get())) {
    const std::string_view name = entry->d_name;
    if (name.size() <= kTemporaryEnd.size() || name[0] != '.' ||
        name.substr(name.size() - kTemporaryEnd.size()) != kTemporaryEnd)
      continue;
    const std::string path = folder + "/" + std::string(name);
    const int file = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) continue;
    struct stat status = {};
    if (fstat(file, &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == geteuid() &&
        status.st_nlink == 1 && flock(file, LOCK_EX | LOCK_NB) == 0)
      unlink(path.c_str());
    close(file);
  }
}

void remove_abandoned_once(const std::string& folder) {
  static std::mutex mutex;
  static std::set<std::string> looked_at;
  {
    const std::lock_guard lock(mutex);
    if (!looked_at.insert(folder).second) return;
  }
  remove_abandoned(folder);
}

/// Creates a file under a random name, which nobody who can write to the folder can foresee, and
/// locks it.
/// @returns its descriptor; -1 with errno
int create_temporary(const std::string& target, std::string& temporary) {
  constexpr int kAttempts = 100;
  // A name has at most 255 bytes.
  constexpr std::size_t kMostOfName = 200;
  const std::string name = fs::path(target).filename().string().substr(0, kMostOfName);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::uint64_t number = 0;
    if (getrandom(&number, sizeof number, 0) != sizeof number) return -1;
    temporary =
        folder_of(target) + "/." + name + "." + hash_text(number) + std::string(kTemporaryEnd);
    const int file =
        open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file < 0 && errno == EEXIST) continue;
    if (file < 0) return -1;
    flock(file, LOCK_EX | LOCK_NB);  // without effect on file systems that have no locks
    // Before the lock another process may have taken the file for an abandoned one.
    struct stat opened = {}, named = {};
    if (fstat(file, &opened) == 0 && stat(temporary.c_str(), &named) == 0 &&
        is_same_file(opened, named))
      return file;
    close(file);
  }
  errno = EEXIST;
  return -1;
}

}  // namespace

OutputFile::OutputFile(const std::string& path) : path_(path) {
  const Target target = follow_links(path);
  target_ = target.path;
  if (target.own_descriptor >= 0) {
    descriptor_ = fcntl(target.own_descriptor, F_DUPFD_CLOEXEC, 3);
    if (descriptor_ < 0) refuse(errno);
    if (target.own_descriptor == STDOUT_FILENO) written_to_stdout = true;
    return;
  }
  if (target.there && !S_ISREG(target.there->st_mode)) {
    const mode_t mode = target.there->st_mode;
    if (S_ISDIR(mode)) refuse(EISDIR);
    if (!S_ISCHR(mode) && !S_ISFIFO(mode))
      refuse_output(path, S_ISBLK(mode) ? "a block device" : "a socket", "a file or a pipe");
    descriptor_ = open(target_.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
    if (descriptor_ < 0) refuse(errno);
    return;
  }
  if (target.there) check_replaced(path, target);
  remove_abandoned_once(folder_of(target_));
  descriptor_ = create_temporary(target_, temporary_);
  if (descriptor_ < 0) {
    const int error = errno;
    temporary_.clear();
    refuse(error);
  }
  if (!target.there) return;
  struct stat made = {};
  const struct stat& there = *target.there;
  const bool is_foreign = fstat(descriptor_, &made) == 0 &&
                          (made.st_uid != there.st_uid || made.st_gid != there.st_gid);
  // Only root may give files away. The mode comes after it, because it clears some of its bits.
  if (is_foreign && fchown(descriptor_, there.st_uid, there.st_gid) != 0) errno = 0;
  if (fchmod(descriptor_, there.st_mode & 07777) != 0) errno = 0;
}

OutputFile::~OutputFile() {
  if (!temporary_.empty()) unlink(temporary_.c_str());
  if (descriptor_ >= 0) close(descriptor_);
}

void OutputFile::refuse(int error) const { refuse_output(path_, std::strerror(error), ""); }

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void OutputFile::sync() {
  // Network and quota-limited disks report a failed write only when the data is synced.
  if (!is_direct() && fsync(descriptor_) != 0) refuse(errno);
}

void OutputFile::publish() {
  if (is_direct()) {
    const int error = close(std::exchange(descriptor_, -1)) != 0 ? errno : 0;
    if (error) refuse(error);
    return;
  }
  if (rename(temporary_.c_str(), target_.c_str()) != 0) refuse(errno);
  temporary_.clear();
  // Syncing the folder makes the new name survive a power cut. Some file systems cannot do that,
  // which is not treated as a failure.
  const int folder = open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    fsync(folder);
    close(folder);
  }
  close(std::exchange(descriptor_, -1));
}

void write_files(const std::vector<std::pair<std::string, std::string_view>>& contents) {
  std::vector<std::unique_ptr<OutputFile>> files;
  files.reserve(contents.size());
  for (const auto& [path, content] : contents) files.push_back(std::make_unique<OutputFile>(path));
  // Output to a device or a pipe cannot be withdrawn: it comes last.
  for (const bool direct : {false, true})
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (files[i]->is_direct() != direct) continue;
      files[i]->write(contents[i].second);
      files[i]->sync();
    }
  for (const auto& file : files) file->publish();
}

bool has_written_to_stdout() { return written_to_stdout; }

void open_standard_descriptors() {
  for (int number = STDIN_FILENO; number <= STDERR_FILENO; ++number)
    // The lowest number that is free is taken. A descriptor for reading lets no output get lost
    // without a word.
    if (fcntl(number, F_GETFD) == -1 && errno == EBADF)
      open("/dev/null", number == STDERR_FILENO ? O_WRONLY : O_RDONLY);
}

}  // namespace softfinger::meshes
