#include "comparisons/robots/package_paths.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cstdint>
#include <system_error>

#include "comparisons/robots/imported_scene.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

namespace fs = std::filesystem;

/// The name in the folder's package.xml, or nothing.
std::string name_in_package_xml(const fs::path& folder) {
  constexpr std::uintmax_t kMost_bytes = 1 << 20;
  const fs::path file = folder / "package.xml";
  std::error_code error;
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) > kMost_bytes) return "";
  tinyxml2::XMLDocument document;
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS || !document.RootElement())
    return "";
  const tinyxml2::XMLElement* name = document.RootElement()->FirstChildElement("name");
  return name && name->GetText() ? name->GetText() : "";
}

bool begins_with(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

}  // namespace

PackagePaths::PackagePaths(const fs::path& file, std::vector<std::string> package_paths)
    : folder_(fs::absolute(file).lexically_normal().parent_path()) {
  for (std::string& path : package_paths) package_paths_.push_back(fs::absolute(path));
}

std::vector<fs::path> PackagePaths::places_of(const std::string& name) const {
  const std::size_t scheme_end = name.find("://");
  if (scheme_end == std::string::npos) return {folder_ / name};
  const std::string rest = name.substr(scheme_end + 3);
  if (begins_with(name, "file://")) return {folder_ / rest};  // an absolute path replaces it
  const std::size_t slash = rest.find('/');
  if (slash == std::string::npos) return {};
  const std::string package = rest.substr(0, slash);
  const fs::path inside = fs::path(rest.substr(slash + 1)).relative_path();
  std::vector<fs::path> places;
  const auto look_in = [&](const fs::path& folder) {
    if (folder.filename() == package || name_in_package_xml(folder) == package)
      places.push_back(folder / inside);
    places.push_back(folder / package / inside);
  };
  for (const fs::path& folder : package_paths_) look_in(folder);
  std::vector<fs::path> above;
  for (fs::path folder = folder_;; folder = folder.parent_path()) {
    above.push_back(folder);
    if (folder == folder.parent_path()) break;
  }
  for (const fs::path& folder : above) look_in(folder);
  // A copy of the package in a folder of another name, without package.xml.
  for (const fs::path& folder : above) places.push_back(folder / inside);
  return places;
}

fs::path PackagePaths::find(const std::string& name, const std::string& where) const {
  const std::size_t scheme_end = name.find("://");
  const std::string scheme = scheme_end == std::string::npos ? "file" : name.substr(0, scheme_end);
  const std::vector<std::string> known = {"file", "package", "model"};
  if (std::find(known.begin(), known.end(), scheme) == known.end())
    throw InputError(where, "file", in_quotes(name),
                     "a path, package://, model:// or file://: nothing is fetched");
  for (const fs::path& place : places_of(name)) {
    std::error_code error;
    const fs::file_status status = fs::status(place, error);
    if (fs::is_regular_file(status)) return place.lexically_normal();
    if (fs::exists(status) && !fs::is_directory(status))
      throw InputError(where, "file", in_quotes(name), "a regular file, not a pipe or a device");
  }
  if (scheme == "file")
    throw InputError(where, "file", in_quotes(name),
                     "a file that is there, relative to the robot's file");
  throw InputError(where, "file", in_quotes(name),
                   "a file of a package that lies above the robot's file, or in the folder of "
                   "--package-path DIR");
}

}  // namespace softfinger::robots
