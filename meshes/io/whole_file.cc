#include "meshes/io/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <streambuf>
#include <string_view>
#include <vector>

#include "meshes/io/input_files.h"
#include "meshes/io/output_file.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

/// An open file, closed at the end.
class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// A stream buffer that writes to a file.
class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(OutputFile& file) : file_(file), waiting_(1 << 16) { empty(); }
  /// Throws what the first write that failed has thrown: a stream only knows that one did.
  void rethrow_failure() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 protected:
  int overflow(int character) override {
    if (sync() != 0) return traits_type::eof();
    if (character != traits_type::eof()) sputc(traits_type::to_char_type(character));
    return traits_type::not_eof(character);
  }
  int sync() override {
    const std::string_view bytes(pbase(), static_cast<std::size_t>(pptr() - pbase()));
    empty();
    try {
      if (!failure_) file_.write(bytes);
    } catch (const InputError&) {
      failure_ = std::current_exception();
    }
    return failure_ ? -1 : 0;
  }

 private:
  void empty() { setp(waiting_.data(), waiting_.data() + waiting_.size()); }

  OutputFile& file_;
  std::vector<char> waiting_;
  std::exception_ptr failure_;
};

/// "a pipe", "a device" and the like; nullptr for a regular file.
const char* other_kind(mode_t mode) {
  if (S_ISREG(mode)) return nullptr;
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
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
  note_input(file.descriptor(), path);
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
  note_content(path, content);
  return content;
}

void write_whole_file(const std::string& path, const std::function<void(std::ostream&)>& write) {
  OutputFile file(path);
  FileBuffer buffer(file);
  std::ostream stream(&buffer);
  try {
    write(stream);
    stream.flush();
  } catch (const std::exception&) {
    stream.setstate(std::ios::badbit);  // instead of the library's message, which is a page long
  }
  buffer.rethrow_failure();
  if (!stream) throw InputError(path, "cannot be written (what it is made of failed)", "", "");
  file.sync();
  file.publish();
}

}  // namespace softfinger::meshes
