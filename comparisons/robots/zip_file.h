#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace softfinger::robots {

/// The files in a ZIP archive, which lies in memory. Nothing is unpacked to a disk.
class ZipFile {
 public:
  /// @param path  for messages
  /// @throws InputError for bytes that are no archive
  ZipFile(std::string bytes, std::string path);

  /// The content of a file by its name, in which small and capital letters are alike; none: there
  /// is no such file.
  /// @throws InputError for a damaged file, one that is encrypted or packed in another way than by
  /// deflation, and where the files read so far are larger than meshes are read
  std::optional<std::string> read(const std::string& name);

 private:
  struct Entry {
    std::string name;
    std::uint64_t packed = 0, size = 0, offset = 0;  ///< bytes
    std::uint32_t check = 0;
    unsigned method = 0;
    bool is_encrypted = false;
  };

  std::uint64_t number(std::uint64_t at, int bytes) const;
  void read_directory();
  [[noreturn]] void refuse(const std::string& value) const;

  std::string bytes_, path_;
  std::map<std::string, Entry> entries_;  ///< by the name in small letters
  std::uint64_t unpacked_ = 0;
};

}  // namespace softfinger::robots
