#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace softfinger::sweep {

/// The file results.csv while it is written. Rows are appended in the order of the points. The file
/// has another name until it is complete, and an interrupted sweep continues after the last point
/// whose rows are all there.
class RowsFile {
 public:
  /// @param header  with its end of line
  /// @param rows_per_point  the number of rows of a complete point
  /// @param go_on  whether an existing file belongs to the same sweep and is continued
  /// @throws InputError
  RowsFile(const std::filesystem::path& folder, const std::string& header,
           std::size_t rows_per_point, bool go_on);
  ~RowsFile();
  RowsFile(const RowsFile&) = delete;
  RowsFile& operator=(const RowsFile&) = delete;

  /// The number of points whose rows are in the file.
  std::size_t points() const { return points_; }

  /// @param text  the rows of the next `points` points
  /// @throws InputError when the disk is full
  void append(const std::string& text, std::size_t points);

  /// Renames the finished file to results.csv.
  /// @throws InputError
  void finish();

 private:
  /// Finds how many complete points the file has and cuts off the rest. A file with another header
  /// is started anew.
  void resume(const std::string& header, std::size_t rows_per_point);

  std::filesystem::path unfinished_, finished_;
  int descriptor_ = -1;
  std::size_t points_ = 0;
};

}  // namespace softfinger::sweep
