#include "meshes/io/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <random>
#include <streambuf>
#include <utility>
#include <vector>

#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

/// An open file, closed at the end.
class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File() { close(); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }
  /// @return 0 or the system's error number
  int close() {
    const int descriptor = std::exchange(descriptor_, -1);
    return descriptor >= 0 && ::close(descriptor) != 0 ? errno : 0;
  }

 private:
  int descriptor_;
};

/// A stream buffer that writes to an open file.
class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(int descriptor) : descriptor_(descriptor), waiting_(1 << 16) { empty(); }
  /// The system's error number of the first write that failed, or 0.
  int error() const { return error_; }

 protected:
  int overflow(int character) override {
    if (sync() != 0) return traits_type::eof();
    if (character != traits_type::eof()) sputc(traits_type::to_char_type(character));
    return traits_type::not_eof(character);
  }
  int sync() override {
    for (const char* next = pbase(); next < pptr() && error_ == 0;) {
      const ssize_t count = ::write(descriptor_, next, static_cast<std::size_t>(pptr() - next));
      if (count >= 0)
        next += count;
      else if (errno != EINTR)
        error_ = errno;
    }
    empty();
    return error_ == 0 ? 0 : -1;
  }

 private:
  void empty() { setp(waiting_.data(), waiting_.data() + waiting_.size()); }

  int descriptor_;
  std::vector<char> waiting_;
  int error_ = 0;
};

/// "a pipe", "a device" and the like; nullptr for a regular file.
const char* other_kind(mode_t mode) {
  if (S_ISREG(mode)) return nullptr;
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

/// Makes a new file beside `path`, exclusively: a file or link that already has the name is never
/// opened.
File make_beside(const std::string& path, std::string& name) {
  std::random_device random;
  for (int attempt = 0;; ++attempt) {
    constexpr int kAttempts = 100;
    char suffix[32];
    std::snprintf(suffix, sizeof suffix, ".%08x%08x.partial", random(), random());
    name = path + suffix;
    const int descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST || attempt == kAttempts) return File(descriptor);
  }
}

}  // namespace

std::string read_whole_file(const std::string& path, const std::string& field,
                            const std::string& allowed, std::size_t largest_bytes) {
  const auto refuse = [&](const std::string& value) {
    throw InputError(path, field, value, allowed);
  };
  const auto unreadable = [&] { refuse(std::string("unreadable (") + std::strerror(errno) + ")"); };
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) refuse("missing");
    unreadable();
  }
  // The kind of file is checked before opening, because opening alone can start a device, and again
  // after it, because the file may have been replaced in between.
  if (const char* kind = other_kind(status.st_mode)) refuse(kind);
  const File file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!file.is_open() || ::fstat(file.descriptor(), &status) != 0) unreadable();
  if (const char* kind = other_kind(status.st_mode)) refuse(kind);
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > largest_bytes)
    throw InputError(path, "file size", std::to_string(size) + " bytes",
                     "at most " + std::to_string(largest_bytes) + " bytes");
  std::string content(size, '\0');
  std::size_t have = 0;
  while (have < size) {
    const ssize_t count = ::read(file.descriptor(), &content[have], size - have);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) unreadable();
    if (count == 0) break;
    have += static_cast<std::size_t>(count);
  }
  content.resize(have);
  return content;
}

std::string write_whole_file(const std::string& path,
                             const std::function<void(std::ostream&)>& write) {
  std::string unfinished;
  File file = make_beside(path, unfinished);
  if (!file.is_open()) return std::strerror(errno);
  FileBuffer buffer(file.descriptor());
  std::ostream stream(&buffer);
  try {
    write(stream);
    stream.flush();
  } catch (const std::exception&) {
    stream.setstate(std::ios::badbit);  // instead of the library's message, which is a page long
  }
  int error = buffer.error();
  const int closing = file.close();
  if (error == 0) error = closing;
  if (error == 0 && stream && std::rename(unfinished.c_str(), path.c_str()) != 0) error = errno;
  if (error == 0 && stream) return "";
  ::unlink(unfinished.c_str());
  return error != 0 ? std::strerror(error) : "the write failed";
}

}  // namespace softfinger::meshes
