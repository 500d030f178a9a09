#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "softfinger/input/errors.h"

namespace softfinger::commands {

/// A folder for the time of its life.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "softfinger_XXXXXX").string();
    if (!mkdtemp(name.data())) throw InputError(name, "cannot be created", "", "");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace softfinger::commands
