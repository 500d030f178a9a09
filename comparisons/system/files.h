#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Files and standard output. Every failure is reported: a full disk must never leave half a
/// result.
namespace softfinger::system {

/// The whole content of a file, which is noted as an input: no output may replace it.
/// @param most_bytes  larger files are refused without being read, so that none fills the memory
/// @throws InputError naming the file and the system's reason.
std::string read_text_file(const std::filesystem::path& path,
                           std::size_t most_bytes = std::string::npos);

/// Reads a file that the program writes again itself, such as a finished result; it is not noted as
/// an input.
std::string read_file_to_rewrite(const std::filesystem::path& path,
                                 std::size_t most_bytes = std::string::npos);

/// All of standard input; it is read once, and a second call gives the same text.
/// @param most_bytes  more is refused
/// @throws InputError
const std::string& read_standard_input(std::size_t most_bytes);

/// Writes a file whole or not at all, as meshes/io/output_file.h says: devices and pipes are
/// written to, links followed, modes kept, inputs and read-only files refused.
/// @throws InputError naming the file and the reason
void write_file_atomically(const std::filesystem::path& path, const std::string& content);

/// Writes files that belong together: all are written before the first is renamed.
void write_files_together(const std::vector<std::pair<std::filesystem::path, std::string>>& files);

/// Names an output before inputs are read: an input that is the same file is then refused before
/// anything is computed, and so is a second output.
/// @param option  for messages: "--page"
/// @throws InputError
void announce_output(const std::string& option, const std::filesystem::path& path);

/// Opens the descriptors 0 to 2 where they are closed, so that no message lands in a result.
void open_standard_descriptors();

/// A file in a folder of results that grows as a run goes on. A link under its name is refused.
class GrowingFile {
 public:
  /// Opens the file or creates it; its content stays.
  /// @throws InputError
  explicit GrowingFile(const std::filesystem::path& path);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// Reads from a place on. @returns the number of bytes, 0 at the end
  std::size_t read(std::uint64_t place, char* buffer, std::size_t size) const;
  std::string read_all() const;
  /// Cuts off what follows the first `size` bytes; the next text is appended there.
  void cut_to(std::uint64_t size);
  /// @throws InputError when the disk is full
  void append(std::string_view text);
  void sync();
  /// Gives the file another name, under which it replaces what is there.
  void rename_to(const std::filesystem::path& name);

 private:
  [[noreturn]] void refuse(const char* what) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
};

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

/// Writes to standard output, or to standard error after a file was written to standard output
/// (`--output /dev/stdout`).
/// @throws InputError when it cannot take the text (a full disk behind a redirection).
void write_to_stdout(const std::string& text);

/// Writes text that people read. Control characters from names and paths are made visible, as they
/// could otherwise control the terminal (visible_text). On a terminal titles are bold.
void write_text_to_stdout(const std::string& text);

}  // namespace softfinger::system
