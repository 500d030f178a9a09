#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "comparisons/system/files.h"

namespace softfinger::sweep {

/// The file results.csv while it is written, under the name results.partial.csv. Rows are appended
/// in the order of the points. Beside it lies results.partial.check: the sweep's identity, then
/// after each append a line with the number of points, the bytes of the rows and a hash of them
/// all. An interrupted sweep goes on after the last rows that are as they were written.
class RowsFile {
 public:
  /// @param header    with its end of line
  /// @param identity  a line; rows of another sweep are not continued
  /// @param go_on     whether existing rows are continued at all
  /// @throws InputError
  RowsFile(const std::filesystem::path& folder, const std::string& header,
           const std::string& identity, bool go_on);

  /// The number of points whose rows are in the file.
  std::size_t points() const { return at_.points; }
  /// Whether rows were found that had been changed since they were written. They are cut off.
  bool had_changed_rows() const { return had_changed_rows_; }

  /// @param text  the rows of the next `points` points
  /// @throws InputError when the disk is full
  void append(const std::string& text, std::size_t points);

  /// Text with which `is_whole` compares a finished file. Nothing may be appended any more.
  std::string check();
  /// Renames the finished file to results.csv.
  /// @throws InputError
  void finish();

  /// Whether a file is as it was when `check` was asked.
  static bool is_whole(const std::filesystem::path& file, const std::string& check);

 private:
  /// A place in the file and what is before it.
  struct Place {
    std::size_t points = 0;
    std::uint64_t bytes = 0, hash = 0;
    std::string line() const;
  };
  /// Finds the last place up to which the rows are as they were written.
  bool resume(const std::string& header, const std::string& identity);

  std::filesystem::path finished_, check_name_;
  system::GrowingFile rows_, checks_;
  Place at_;
  bool had_changed_rows_ = false;
};

}  // namespace softfinger::sweep
