#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Files and standard output, with every failure noticed: a full disk must never leave half a
/// result.
namespace softfinger::system {

/// The whole content of a file.
/// @param most_bytes  more are refused, and not read: no file of a user fills the memory
/// @throws InputError naming the file and the system's reason.
std::string read_text_file(const std::filesystem::path& path,
                           std::size_t most_bytes = std::string::npos);

/// Writes to a temporary name in the same folder, syncs, closes, renames: a reader sees the old
/// content or the new one, also after a power cut.
/// @throws InputError naming the file and the system's reason; the temporary file is removed.
void write_file_atomically(const std::filesystem::path& path, const std::string& content);

/// The same for files that belong together: none gets its name before all are written.
void write_files_together(const std::vector<std::pair<std::filesystem::path, std::string>>& files);

/// Creates a folder, with parents, and proves that files can be written in it.
/// @throws InputError
void make_writable_folder(const std::filesystem::path& folder);

/// A folder of results that one run has for itself: two runs in one folder would overwrite each
/// other's files. The system releases the lock however the run ends.
class OutputFolder {
 public:
  /// Creates the folder, with parents, proves that files can be written in it and locks it.
  /// @throws InputError, for a folder in use with the process that uses it
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

 private:
  std::filesystem::path lock_file_;
  int descriptor_ = -1;
};

/// @throws InputError when standard output cannot take the text (a full disk behind a redirection).
void write_to_stdout(const std::string& text);

/// The same for text that people read, not programs: names and paths in it cannot command their
/// terminal (visible_text).
void write_text_to_stdout(const std::string& text);

}  // namespace softfinger::system
