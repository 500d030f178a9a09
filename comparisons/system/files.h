#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Files and standard output. Every failure is reported: a full disk must never leave half a
/// result.
namespace softfinger::system {

/// The whole content of a file.
/// @param most_bytes  larger files are refused without being read, so that none fills the memory
/// @throws InputError naming the file and the system's reason.
std::string read_text_file(const std::filesystem::path& path,
                           std::size_t most_bytes = std::string::npos);

/// All of standard input; it is read once, and a second call gives the same text.
/// @param most_bytes  more is refused
/// @throws InputError
const std::string& read_standard_input(std::size_t most_bytes);

/// Writes under a temporary name in the same folder, syncs, closes and renames. A reader sees
/// either the old content or the new one, even after a power cut.
/// @throws InputError naming the file and the system's reason; the temporary file is removed.
void write_file_atomically(const std::filesystem::path& path, const std::string& content);

/// The same for files that belong together: all are written before the first is renamed.
void write_files_together(const std::vector<std::pair<std::filesystem::path, std::string>>& files);

/// Creates a folder with its parents, and writes a test file to see whether that is possible.
/// @throws InputError
void make_writable_folder(const std::filesystem::path& folder);

/// A folder of results, locked for one run: two runs in one folder would overwrite each other's
/// files. The system releases the lock however the run ends.
class OutputFolder {
 public:
  /// Creates the folder as make_writable_folder does, and locks it.
  /// @throws InputError; for a folder in use it names the process that uses it
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

/// The same for text that people read. Control characters from names and paths are made visible, as
/// they could otherwise control the terminal (visible_text). On a terminal titles are bold.
void write_text_to_stdout(const std::string& text);

}  // namespace softfinger::system
