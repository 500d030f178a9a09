#include "comparisons/exporting/included_files.h"

#include <fmt/format.h>

#include <set>
#include <system_error>

#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::exporting {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFiles = 200, kMostBytes = 20'000'000;

/// The path of an included file; empty: none is there.
fs::path find_included(const std::string& name, const fs::path& model, const fs::path& including) {
  std::error_code error;
  for (const fs::path& folder : {model.parent_path(), including.parent_path()}) {
    const fs::path path = (folder / name).lexically_normal();
    const fs::file_status status = fs::status(path, error);
    if (fs::is_regular_file(status)) return path;
  }
  return {};
}

}  // namespace

std::unique_ptr<XmlFile> read_with_included_files(const std::string& text, const std::string& where,
                                                  const fs::path& path, const TextReader& read) {
  auto model = std::make_unique<XmlFile>(text, where);
  const std::string& root = model->root().name;
  if (path.empty() || (root != "mujoco" && root != "mujocoinclude")) return model;
  std::error_code error;
  std::set<fs::path> known = {fs::weakly_canonical(path, error)};
  std::size_t bytes = text.size();
  std::vector<XmlFile::Inclusion> inclusions;
  struct Open {
    const XmlFile* file;
    fs::path path;
  };
  std::vector<Open> open = {{model.get(), path}};
  for (std::size_t next = 0; next < open.size(); ++next) {
    const Open including = open[next];
    for (const XmlElement* element : including.file->elements()) {
      if (element->name != "include" || !element->parent) continue;
      const std::string name = element->value("file");
      const fs::path found = find_included(name, path, including.path);
      if (name.empty() || found.empty()) continue;
      if (!known.insert(fs::weakly_canonical(found, error)).second)
        throw InputError(element->where(), "file", "\"" + text::shortened(name) + "\"",
                         "each file once: it is a part of the model already");
      if (known.size() > kMostFiles + 1)
        throw InputError(element->where(), "<include>", "",
                         fmt::format("at most {} files", kMostFiles));
      std::string part = read(found);
      bytes += part.size();
      if (bytes > kMostBytes)
        throw InputError(element->where(), "the files together", "",
                         fmt::format("at most {} MB", kMostBytes / 1'000'000));
      auto file = std::make_unique<XmlFile>(std::move(part), found.string());
      open.push_back({file.get(), found});
      inclusions.push_back({element, std::move(file)});
    }
  }
  if (!inclusions.empty()) model->include(std::move(inclusions));
  return model;
}

}  // namespace softfinger::exporting
