#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace softfinger::robots {

/// Finds the files that a URDF or SDF file names.
///
/// `package://NAME/REST` and `model://NAME/REST` lie in the package NAME: a folder of this name, or
/// one whose package.xml says so. It is looked for in the given folders, then above the robot's
/// file, folder by folder. Other names are relative to the robot's file, with or without the prefix
/// of a file URL.
class PackagePaths {
 public:
  PackagePaths(const std::filesystem::path& file, std::vector<std::string> package_paths);

  /// An existing regular file.
  /// @param where  the line that names it, for messages
  /// @throws InputError
  std::filesystem::path find(const std::string& name, const std::string& where) const;

 private:
  std::vector<std::filesystem::path> places_of(const std::string& name) const;

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> package_paths_;
};

}  // namespace softfinger::robots
