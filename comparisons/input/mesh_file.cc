#include "comparisons/input/mesh_file.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>

#include "comparisons/input/mesh_unit.h"
#include "comparisons/system/process_pool.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/number.h"
#include "comparisons/text/toml_text.h"
#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace fs = std::filesystem;
namespace {

/// A file in memory, which other processes of this user can read. It is gone when this process
/// ends, however it ends.
class MemoryMeshFile {
 public:
  explicit MemoryMeshFile(std::string_view bytes)
      : descriptor_(memfd_create("softfinger_mesh", MFD_CLOEXEC)) {
    while (descriptor_ >= 0 && !bytes.empty()) {
      const ssize_t written = write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) break;
      bytes.remove_prefix(std::size_t(written));
    }
    if (descriptor_ < 0 || !bytes.empty())
      throw InputError("file in memory",
                       std::string("cannot be written (") + std::strerror(errno) + ")", "", "");
  }
  ~MemoryMeshFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  MemoryMeshFile(const MemoryMeshFile&) = delete;
  MemoryMeshFile& operator=(const MemoryMeshFile&) = delete;
  fs::path path() const { return fmt::format("/proc/{}/fd/{}", getpid(), descriptor_); }

 private:
  int descriptor_;
};

struct Conversion {
  std::optional<double> metres_per_unit;
  std::string note;
  std::unique_ptr<MemoryMeshFile> stl;
};

constexpr const char* kInstead = "; or convert the file to STL";

Conversion convert_by_program(const std::string& path, const std::string& part) {
  // Refuses what is no file or too large, and notes it as an input.
  meshes::read_whole_file(path, "file", "a readable mesh", meshes::kLargestSurface_bytes);
  system::ProcessJob job;
  try {
    job.command = {system::robot_program().string(), "--mesh", fs::absolute(path).string()};
  } catch (const InputError& error) {
    throw InputError(path, "format", meshes::mesh_format(path)->name,
                     "STL or OBJ, which are read without softfinger-robot; " + error.where() +
                         ": " + error.field() + kInstead);
  }
  if (!part.empty()) job.command.push_back(part);
  job.time_limit_s = 120;
  job.memory_limit_MB = 4000;
  Conversion made;
  system::ProcessOutcome outcome;
  system::ProcessCallbacks callbacks;
  callbacks.on_line = [&](std::size_t, const std::string& line) { made.note = line; };
  callbacks.on_finish = [&](std::size_t, const system::ProcessOutcome& ended) { outcome = ended; };
  if (const int signal = system::run_processes({job}, 1, callbacks))
    throw system::Interrupted(signal);
  const std::string& absolute = job.command[2];
  if (outcome.exit_status > 0 && !outcome.last_line.empty()) {
    const std::string& said = outcome.last_line;
    if (said.rfind(absolute + ":", 0) != 0) throw InputError(path, said, "", "");
    // The file as it was typed, and the line where there is one.
    const std::size_t colon = said.find(": ", absolute.size());
    throw InputError(path + said.substr(absolute.size(), colon - absolute.size()),
                     said.substr(std::min(colon, said.size() - 2) + 2), "", "");
  }
  const std::size_t end = outcome.output.find('\n');
  constexpr std::string_view kUnit = "metres_per_unit";
  if (!outcome.succeeded() || end == std::string::npos ||
      outcome.output.compare(0, kUnit.size(), kUnit) != 0)
    throw InputError(path, "reading it ended the program softfinger-robot",
                     outcome.exceeded == system::ProcessLimit::time     ? "after two minutes"
                     : outcome.exceeded == system::ProcessLimit::memory ? "at 4 GB"
                                                                        : "by a fault",
                     std::string("a whole file of fewer triangles") + kInstead);
  if (end > kUnit.size())
    made.metres_per_unit =
        text::read_number(outcome.output.substr(kUnit.size() + 1, end - kUnit.size() - 1));
  made.stl = std::make_unique<MemoryMeshFile>(std::string_view(outcome.output).substr(end + 1));
  return made;
}

const Conversion& conversion_of(const fs::path& path, const std::string& part) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::string>, Conversion> conversions;
  const std::lock_guard lock(mutex);
  const std::pair key(path.string(), part);
  auto known = conversions.find(key);
  if (known == conversions.end())
    known = conversions.emplace(key, convert_by_program(path.string(), part)).first;
  return known->second;
}

}  // namespace

meshes::ConvertedMesh converted_mesh(const fs::path& path, const std::string& part) {
  const Conversion& made = conversion_of(path, part);
  return {meshes::read_whole_file(made.stl->path().string(), "file", "",
                                  2 * meshes::kLargestSurface_bytes),
          made.metres_per_unit, made.note};
}

meshes::SurfaceFile read_mesh_file(const fs::path& path, const std::string& part,
                                   std::optional<double> metres_per_unit) {
  if (meshes::is_converted_mesh(path.string()))
    return meshes::parse_converted_surface(converted_mesh(path, part), path.string(),
                                           metres_per_unit);
  if (!part.empty())
    throw InputError(path.string(), "part", text::toml_text(part),
                     "none: STL and OBJ files are read whole; DAE, GLB, glTF and 3MF have parts");
  return meshes::read_surface(path.string(), metres_per_unit);
}

fs::path plain_mesh_file(const fs::path& path, const std::string& part) {
  return meshes::is_converted_mesh(path.string()) ? conversion_of(path, part).stl->path() : path;
}

std::string NamedMesh::entries() const {
  return "mesh = " + text::toml_text(file) +
         (part.empty() ? "" : ", part = " + text::toml_text(part)) +
         (is_own_unit ? "" : ", unit = \"" + unit_name(metres_per_unit) + "\"");
}

std::string NamedMesh::options() const {
  std::string quoted = part;
  // A shell takes everything between such quotes as it is, except for one itself.
  if (part.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-") !=
      std::string::npos) {
    quoted = "'";
    for (const char letter : part) quoted += letter == '\'' ? "'\\''" : std::string(1, letter);
    quoted += "'";
  }
  std::string text = part.empty() ? "" : "--part " + quoted;
  if (!is_own_unit)
    text += std::string(text.empty() ? "" : " ") + "--unit " + unit_name(metres_per_unit);
  return text;
}

NamedMesh named_mesh(const std::string& typed, const std::string& part,
                     const meshes::SurfaceFile& file) {
  return {typed, part, file.metres_per_unit, file.own_metres_per_unit == file.metres_per_unit};
}

}  // namespace softfinger::input
