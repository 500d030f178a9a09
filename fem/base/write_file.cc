#include "fem/base/write_file.h"

#include <filesystem>

#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

void write_file(const std::string& path, const char* kind,
                const std::function<void(std::ostream&)>& write) {
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
  try {
    meshes::write_whole_file(path, write);
  } catch (const InputError& error) {
    throw InputError(path, std::string(kind) + " " + error.field(), "", error.allowed());
  }
}

}  // namespace softfinger::fem
