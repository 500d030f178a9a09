#include "fem/write_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "softfinger/input/errors.h"

namespace softfinger::fem {

void write_file(const std::string& path, const char* kind,
                const std::function<void(std::ostream&)>& write) {
  const std::string unfinished = path + "." + std::to_string(getpid()) + ".partial";
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
  std::string failure;
  errno = 0;
  {
    std::ofstream file(unfinished, std::ios::binary);
    try {
      if (file) write(file);
    } catch (const std::exception&) {
      file.setstate(
          std::ios::failbit);  // a library's own message is a page long; errno has the cause
    }
    file.close();
    if (!file) failure = errno ? std::strerror(errno) : "the write failed";
  }
  if (failure.empty()) {
    std::error_code error;
    std::filesystem::rename(unfinished, path, error);
    if (!error) return;
    failure = error.message();
  }
  std::filesystem::remove(unfinished, ignored);
  throw InputError(path, kind, "",
                   "a folder that can be written, with room for it (" + failure + ")");
}

}  // namespace softfinger::fem
