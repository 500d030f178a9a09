#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace softfinger::sweep {

/// results.csv while it grows. Rows are appended in the order of the points, under another name
/// until the last one is there: an interrupted sweep goes on after the last whole point.
class RowsFile {
 public:
  /// @param header  with its end of line
  /// @param rows_per_point  a point is whole when it has so many
  /// @param go_on  whether what is there belongs to the same sweep
  /// @throws InputError
  RowsFile(const std::filesystem::path& folder, const std::string& header,
           std::size_t rows_per_point, bool go_on);
  ~RowsFile();
  RowsFile(const RowsFile&) = delete;
  RowsFile& operator=(const RowsFile&) = delete;

  /// Points whose rows are in the file.
  std::size_t points() const { return points_; }

  /// @param text  the rows of the next `points` points
  /// @throws InputError when the disk is full
  void append(const std::string& text, std::size_t points);

  /// Gives the file its name.
  /// @throws InputError
  void finish();

 private:
  /// Cuts off what is not whole; nothing is left of a file with another header.
  void resume(const std::string& header, std::size_t rows_per_point);

  std::filesystem::path unfinished_, finished_;
  int descriptor_ = -1;
  std::size_t points_ = 0;
};

}  // namespace softfinger::sweep
