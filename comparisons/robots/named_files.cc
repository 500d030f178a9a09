#include "comparisons/robots/named_files.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "comparisons/robots/imported_scene.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

/// A file as it is named, and where.
struct Named {
  std::string name, where;
};

class NamedFiles {
 public:
  explicit NamedFiles(const fs::path& file) : folder_(file.parent_path()) {
    folders_.insert(folder_);
    read(file);
  }

  void refuse_pipes() const {
    for (const Named& named : named_)
      for (const fs::path& path : places_of(named.name)) {
        std::error_code ignored;
        const fs::file_status status = fs::status(path, ignored);
        if (fs::is_fifo(status) || fs::is_socket(status) || fs::is_character_file(status) ||
            fs::is_block_file(status))
          throw InputError(named.where, "file", in_quotes(named.name),
                           "a regular file, not a pipe or a device");
      }
  }

 private:
  void read(const fs::path& file) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored) || !read_.insert(file).second) return;
    tinyxml2::XMLDocument document;
    if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) return;
    // Without recursion through the elements, of which there may be many levels.
    const XMLElement* const root = document.RootElement();
    for (const XMLElement* element = root; element; element = next(element, root))
      look_at(*element, file);
  }

  static const XMLElement* next(const XMLElement* element, const XMLElement* root) {
    if (element->FirstChildElement()) return element->FirstChildElement();
    while (element != root && !element->NextSiblingElement())
      element = element->Parent()->ToElement();
    return element == root ? nullptr : element->NextSiblingElement();
  }

  void look_at(const XMLElement& element, const fs::path& file) {
    const std::string kind = element.Name();
    for (const auto* attribute = element.FirstAttribute(); attribute;
         attribute = attribute->Next()) {
      const std::string name = attribute->Name(), value = attribute->Value();
      if (value.empty()) continue;
      if (kind == "compiler" && name.size() > 3 && name.substr(name.size() - 3) == "dir")
        folders_.insert(folder_ / value);
      // A texture has six of them: fileright, fileleft, ...
      if (name.rfind("file", 0) != 0) continue;
      named_.push_back({value, fmt::format("{}:{}", file.string(), element.GetLineNum())});
      if (kind == "include") read(folder_ / value);
    }
  }

  /// Wherever MuJoCo may look for it: with its folders or, as in URDF, without.
  std::vector<fs::path> places_of(const std::string& name) const {
    const std::size_t scheme = name.find("://");
    const fs::path path = scheme == std::string::npos ? name : name.substr(scheme + 3);
    std::vector<fs::path> places;
    for (const fs::path& folder : folders_) {
      places.push_back(folder / path);
      places.push_back(folder / path.filename());
    }
    return places;
  }

  fs::path folder_;
  std::set<fs::path> folders_, read_;
  std::vector<Named> named_;
};

}  // namespace

void refuse_named_pipes(const fs::path& file) { NamedFiles(file).refuse_pipes(); }

}  // namespace softfinger::robots
