#include "meshes/io/input_files.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <vector>

#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/hash.h"

namespace softfinger::meshes {
namespace fs = std::filesystem;
namespace {

bool is_same(const struct stat& one, const struct stat& other) {
  return one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

struct InputFile {
  std::string path;  // absolute
  struct stat file = {};
};

struct AnnouncedOutput {
  std::string option;
  fs::path path;  // canonical as far as it exists
  bool exists = false;
  struct stat file = {};
};

/// Whether a path still leads to this file: the number of one that is gone may be another's.
bool leads_to(const fs::path& path, const struct stat& file) {
  struct stat now = {};
  return stat(path.c_str(), &now) == 0 && is_same(now, file);
}

struct Ledger {
  std::mutex mutex;
  std::vector<InputFile> inputs;
  std::vector<AnnouncedOutput> outputs;
  std::map<std::string, std::string> hashes;
};

Ledger& ledger() {
  static Ledger the_one;
  return the_one;
}

}  // namespace

void note_input(int descriptor, const std::string& path) {
  InputFile input;
  // A device, such as a terminal or /dev/null, may be both.
  if (fstat(descriptor, &input.file) != 0 || !S_ISREG(input.file.st_mode)) return;
  std::error_code error;
  input.path = fs::absolute(path, error).string();
  Ledger& known = ledger();
  const std::lock_guard lock(known.mutex);
  for (const AnnouncedOutput& output : known.outputs)
    if (output.exists && is_same(output.file, input.file) && leads_to(output.path, input.file))
      throw InputError("command line", output.option, path,
                       "another file than this one, which the command reads");
  for (const InputFile& other : known.inputs)
    if (is_same(other.file, input.file) && other.path == input.path) return;
  known.inputs.push_back(std::move(input));
}

void note_content(const std::string& path, std::string_view content) {
  const std::string hash = hash_text(hash_of(content));
  Ledger& known = ledger();
  const std::lock_guard lock(known.mutex);
  known.hashes[path] = hash;
}

bool is_input(const struct stat& file) {
  Ledger& known = ledger();
  const std::lock_guard lock(known.mutex);
  return std::any_of(known.inputs.begin(), known.inputs.end(), [&](const InputFile& input) {
    return is_same(input.file, file) && leads_to(input.path, file);
  });
}

void announce_output(const std::string& option, const std::string& path) {
  AnnouncedOutput output;
  std::error_code error;
  output.option = option;
  output.path = fs::weakly_canonical(path, error);
  if (error) output.path = path;
  output.exists = stat(path.c_str(), &output.file) == 0;
  if (output.exists && !S_ISREG(output.file.st_mode)) return;
  Ledger& known = ledger();
  const std::lock_guard lock(known.mutex);
  for (const AnnouncedOutput& other : known.outputs)
    if (other.path == output.path ||
        (other.exists && output.exists && is_same(other.file, output.file)))
      throw InputError("command line", option, path, "another file than that of " + other.option);
  known.outputs.push_back(std::move(output));
}

std::string content_hash(const std::string& path) {
  Ledger& known = ledger();
  for (const bool was_read : {false, true}) {
    {
      const std::lock_guard lock(known.mutex);
      if (const auto found = known.hashes.find(path); found != known.hashes.end())
        return found->second;
    }
    if (was_read) break;
    try {
      read_whole_file(path, "file", "", std::numeric_limits<std::size_t>::max());
    } catch (const InputError&) {
      // Whoever needs the file says what is wrong with it.
    }
  }
  return "";
}

}  // namespace softfinger::meshes
