#pragma once

#include <sys/stat.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Output files: the only code by which the programs write files (a test looks for others).
///
/// - A regular file is replaced as a whole: the content is written under a random name in the same
///   folder, synced and renamed, so that a reader sees the old content or the new one, even after a
///   power cut or on a full disk. The mode of a file that is there is kept, and its owner where the
///   system allows it.
/// - Devices and pipes are written to, and so is this process's own standard output (/dev/stdout).
/// - A symbolic link is followed, and the file that it names is replaced. A link that another user
///   has made is refused: it could lead anywhere.
/// - Refused are a read-only file, an input of the same process (input_files.h), a block device,
/// and
///   a file with several names (hard links): replacing would part them, and to write in place could
///   leave half a file under all of them.
///
/// A process that is killed leaves its file under the random name. It is locked as long as its
/// process lives; the next process that writes to the folder removes those without a lock.
namespace softfinger::meshes {

class OutputFile {
 public:
  /// Opens the file. Nothing is changed under its own name until `publish`, except for devices.
  /// @throws InputError naming the file and the system's reason
  explicit OutputFile(const std::string& path);
  /// Removes what was written, unless it was published.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Whether what is written appears at once: a device, a pipe or standard output.
  bool is_direct() const { return temporary_.empty(); }

  /// @throws InputError for a full disk and the like
  void write(std::string_view bytes);
  /// Sees to it that all that was written is on the disk.
  void sync();
  /// Gives the file its name.
  void publish();

 private:
  [[noreturn]] void refuse(int error) const;

  std::string path_;       ///< as typed, for messages
  std::string target_;     ///< the file that is replaced
  std::string temporary_;  ///< its name until then; empty for devices and pipes
  int descriptor_ = -1;
};

/// Writes files that belong together: all are on the disk before the first gets its name.
void write_files(const std::vector<std::pair<std::string, std::string_view>>& contents);

/// Whether a file was written to this process's standard output. Other text then belongs to
/// standard error.
bool has_written_to_stdout();

/// Opens those of the descriptors 0 to 2 that are closed on /dev/null: the next files to be opened
/// would get their numbers, and messages would land in them. Writing to a standard output that was
/// closed still fails. Programs call this first.
void open_standard_descriptors();

}  // namespace softfinger::meshes
