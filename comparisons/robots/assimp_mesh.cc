#include "comparisons/robots/assimp_mesh.h"

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <new>
#include <optional>
#include <string_view>
#include <utility>

#include "comparisons/robots/imported_scene.h"
#include "meshes/io/cut_polygon.h"
#include "meshes/io/read_surface.h"
#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

namespace fs = std::filesystem;
using Eigen::Affine3d;

/// A file's bytes as a stream.
class ByteStream : public Assimp::IOStream {
 public:
  explicit ByteStream(std::string bytes) : bytes_(std::move(bytes)) {}

  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    count = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(to, bytes_.data() + at_, size * count);
    at_ += size * count;
    return count;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t size = bytes_.size();
    const std::size_t from = origin == aiOrigin_SET ? 0 : at_;
    if (offset > size - (origin == aiOrigin_CUR ? at_ : 0)) return aiReturn_FAILURE;
    at_ = origin == aiOrigin_END ? size - offset : from + offset;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

/// "%20" and the like as the letters that they stand for.
std::string without_percents(const std::string& name) {
  std::string plain;
  for (std::size_t i = 0; i < name.size(); ++i) {
    int letter = 0;
    const char* const digits = name.data() + i + 1;
    if (name[i] == '%' && i + 2 < name.size() &&
        std::from_chars(digits, digits + 2, letter, 16).ptr == digits + 2) {
      plain += char(letter);
      i += 2;
    } else {
      plain += name[i];
    }
  }
  return plain;
}

/// The files that Assimp may see: the one to read, and those in its folder or below it.
class OwnFolder : public Assimp::IOSystem {
 public:
  OwnFolder(std::string bytes, std::string path)
      : bytes_(std::move(bytes)), path_(std::move(path)) {}

  bool Exists(const char* name) const override { return name == path_; }
  char getOsSeparator() const override { return '/'; }
  void Close(Assimp::IOStream* stream) override { delete stream; }

  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (std::strchr(mode, 'w') || std::strchr(mode, 'a')) return nullptr;
    // Readers look into the file before they read it.
    if (name == path_) return new ByteStream(bytes_);
    try {
      return new ByteStream(named_file(name));
    } catch (const InputError& error) {
      // Assimp would make a message of its own of it.
      if (!refusal_) refusal_ = error;
      return nullptr;
    }
  }

  const std::optional<InputError>& refusal() const { return refusal_; }

 private:
  std::string named_file(const std::string& name) const {
    const fs::path folder = fs::path(path_).parent_path();
    // Assimp writes its folder before whatever the file names.
    const std::string start = folder.empty() ? "" : folder.string() + "/";
    const std::string named = name.rfind(start, 0) == 0 ? name.substr(start.size()) : name;
    const auto refuse = [&] {
      throw InputError(path_, "file that it names", in_quotes(named.substr(0, 200)),
                       "a file in the folder of the mesh or below it: nothing else is opened and "
                       "nothing is fetched");
    };
    std::error_code error;
    const fs::path inside = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
    if (error || fs::path(named).is_absolute() || named.find("://") != std::string::npos) refuse();
    for (const std::string& spelling : {named, without_percents(named)}) {
      const fs::path file = fs::canonical(inside / spelling, error);
      if (error) continue;
      const fs::path rest = file.lexically_relative(inside);
      if (rest.empty() || *rest.begin() == "..") refuse();
      return meshes::read_whole_file(file.string(), "file that " + path_ + " names",
                                     "a file that can be read", meshes::kLargestSurface_bytes);
    }
    const fs::path there = (inside / named).lexically_normal().lexically_relative(inside);
    if (there.empty() || *there.begin() == "..") refuse();
    throw InputError(path_, "file that it names", in_quotes(named.substr(0, 200)),
                     "a file that is there, in the folder of the mesh or below it");
  }

  std::string bytes_, path_;
  std::optional<InputError> refusal_;
};

/// Leaves only the readers of this file's format, so that no other of Assimp's many readers sees
/// its bytes.
void keep_readers_of(Assimp::Importer& importer, const std::string& suffix) {
  std::vector<Assimp::BaseImporter*> others;
  for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
    const std::string suffixes = fmt::format(" {} ", importer.GetImporterInfo(i)->mFileExtensions);
    if (suffixes.find(" " + suffix + " ") == std::string::npos)
      others.push_back(importer.GetImporter(i));
  }
  for (Assimp::BaseImporter* other : others) {
    importer.UnregisterLoader(other);
    delete other;
  }
}

/// Numbers that Assimp holds in single precision: 0.0254f as 0.0254.
double as_written(float number) { return std::stod(fmt::format("{}", number)); }

Affine3d affine(const aiMatrix4x4& from) {
  Affine3d to;
  to.matrix() << double(from.a1), double(from.a2), double(from.a3), double(from.a4),
      double(from.b1), double(from.b2), double(from.b3), double(from.b4), double(from.c1),
      double(from.c2), double(from.c3), double(from.c4), 0, 0, 0, 1;
  return to;
}

PartMesh mesh_from(const aiMesh& from, const std::string& path, std::size_t& left_out) {
  // The time to cut a polygon grows as the square of its corners.
  constexpr unsigned kMostCorners = 10'000;
  PartMesh mesh;
  mesh.name = from.mName.C_Str();
  mesh.vertices.reserve(from.mNumVertices);
  for (unsigned v = 0; v < from.mNumVertices; ++v)
    mesh.vertices.emplace_back(double(from.mVertices[v].x), double(from.mVertices[v].y),
                               double(from.mVertices[v].z));
  std::vector<int> polygon;
  for (unsigned f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    if (face.mNumIndices < 3) {
      ++left_out;
      continue;
    }
    polygon.clear();
    for (unsigned corner = 0; corner < face.mNumIndices; ++corner) {
      if (face.mIndices[corner] >= from.mNumVertices)
        throw InputError(path, "vertex index", std::to_string(face.mIndices[corner]),
                         fmt::format("below {}, the number of vertices", from.mNumVertices));
      polygon.push_back(int(face.mIndices[corner]));
    }
    if (face.mNumIndices > kMostCorners)
      throw InputError(path, "face", fmt::format("{} corners", face.mNumIndices),
                       fmt::format("at most {}", kMostCorners));
    if (face.mNumIndices == 3)
      mesh.triangles.push_back({polygon[0], polygon[1], polygon[2]});
    else
      meshes::cut_polygon(polygon, mesh.vertices, mesh.triangles);
  }
  return mesh;
}

/// Parents before children, without recursion: a chain may be long.
void add_nodes(const aiNode& root, MeshParts& parts) {
  std::vector<std::pair<const aiNode*, int>> open = {{&root, -1}};
  while (!open.empty()) {
    const auto [from, parent] = open.back();
    open.pop_back();
    PartNode node;
    node.name = from->mName.C_Str();
    node.parent = parent;
    node.in_parent = affine(from->mTransformation);
    for (unsigned m = 0; m < from->mNumMeshes; ++m)
      if (from->mMeshes[m] < parts.meshes.size()) node.meshes.push_back(from->mMeshes[m]);
    const int own = int(parts.nodes.size());
    parts.nodes.push_back(std::move(node));
    for (unsigned child = from->mNumChildren; child-- > 0;)
      open.emplace_back(from->mChildren[child], own);
  }
}

/// The next word of a text, which loses it; empty: there is none.
std::string_view next_word_of(std::string_view& text) {
  const std::string_view blanks = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(blanks));
  text.remove_prefix(word.size());
  return word;
}

/// The number that is the whole word; the largest one for anything else.
std::size_t whole_number(std::string_view word) {
  std::size_t number = 0;
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, number);
  return error == std::errc() && rest == end ? number : std::numeric_limits<std::size_t>::max();
}

/// Refuses a PLY file that ends before what its head announces. Assimp takes the corners that are
/// missing in a text for those that were read last, and counts to any number that is announced.
void refuse_truncated_ply(std::string_view text, const std::string& path) {
  struct Element {
    std::string_view name;
    std::size_t count = 0;
    std::vector<bool> is_list;  ///< its properties
  };
  const auto refuse = [&](const std::string& allowed) {
    throw InputError(path, "PLY file", "truncated or damaged", allowed);
  };
  const std::string_view last_line = "\nend_header";
  const std::size_t end = text.find(last_line);
  if (end == std::string_view::npos) refuse("a head that ends with end_header");
  std::string_view head = text.substr(0, end), body = text.substr(end + last_line.size());
  if (body.empty() || (body[0] != '\n' && body[0] != '\r'))
    refuse("a head that ends with end_header");
  const bool is_text = head.find("format ascii") != std::string_view::npos;
  std::vector<Element> elements;
  while (!head.empty()) {
    std::string_view line = head.substr(0, head.find('\n'));
    head.remove_prefix(std::min(line.size() + 1, head.size()));
    const std::string_view word = next_word_of(line), name = next_word_of(line);
    if (word == "element") elements.push_back({name, whole_number(next_word_of(line)), {}});
    if (word == "property" && !elements.empty()) elements.back().is_list.push_back(name == "list");
  }
  for (const Element& element : elements) {
    const auto refuse_element = [&] {
      refuse(fmt::format("as many of element {} as it announces",
                         in_quotes(std::string(element.name.substr(0, kLongestName)))));
    };
    // Each takes a byte at least.
    if (element.count > body.size()) refuse_element();
    for (std::size_t i = 0; is_text && i < element.count; ++i)
      for (const bool is_list : element.is_list) {
        std::string_view word = next_word_of(body);
        for (std::size_t more = is_list ? whole_number(word) : 0; more > 0 && !word.empty(); --more)
          word = next_word_of(body);
        if (word.empty()) refuse_element();
      }
  }
}

/// Refuses indices of a DAE file that are no numbers, at which Assimp never ends.
void refuse_broken_indices(std::string_view text, const std::string& path) {
  for (const std::string_view opening : {"<p>", "<vcount>"})
    for (std::size_t at = 0; (at = text.find(opening, at)) != std::string_view::npos;) {
      at += opening.size();
      const std::size_t bad = text.find_first_not_of("0123456789 \t\r\n", at);
      if (bad != std::string_view::npos && text[bad] != '<') {
        const auto line = 1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(bad), '\n');
        throw InputError(fmt::format("{}:{}", path, line), std::string(opening),
                         in_quotes(std::string(text.substr(bad, 1))), "whole numbers >= 0");
      }
    }
}

/// Assimp leaves out what it does not know of these, instead of refusing the file.
void refuse_packed_gltf(const std::string& bytes, const std::string& path) {
  for (const char* extension : {"EXT_meshopt_compression", "MESHOPT_compression"})
    if (const std::size_t at = bytes.find("\"extensionsRequired\"");
        at != std::string::npos &&
        bytes.substr(at, std::min(bytes.find(']', at), bytes.size()) - at).find(extension) !=
            std::string::npos)
      throw InputError(path, "extensionsRequired", in_quotes(extension),
                       "meshes that are not packed, or by KHR_draco_mesh_compression: write the "
                       "file without compression");
}

}  // namespace

MeshParts read_by_assimp(std::string bytes, const std::string& path) {
  const meshes::MeshFormat& format = *meshes::mesh_format(path);
  const std::string suffix = format.suffix + 1;
  const bool is_dae = suffix == "dae", is_ply = suffix == "ply";
  if (is_dae) refuse_broken_indices(bytes, path);
  if (is_ply && !bytes.empty()) refuse_truncated_ply(bytes, path);
  if (!is_dae && !is_ply) refuse_packed_gltf(bytes, path);
  Assimp::Importer importer;
  auto* const folder = new OwnFolder(std::move(bytes), path);
  importer.SetIOHandler(folder);  // which owns it from now on
  keep_readers_of(importer, suffix);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const aiScene* scene = nullptr;
  std::string fault;
  try {
    scene = importer.ReadFile(path, 0);
    if (!scene) fault = importer.GetErrorString();
  } catch (const std::bad_alloc&) {
    fault = "it needs more memory than there is";
  } catch (const std::exception& error) {
    fault = error.what();
  }
  if (folder->refusal()) throw *folder->refusal();
  if (!scene || !scene->mRootNode) {
    if (fault.empty()) fault = "nothing in it";
    throw InputError(path, std::string(format.name) + " file", fault.substr(0, 300),
                     "a whole one that Assimp can read");
  }
  MeshParts parts;
  if (!is_ply) parts.metres_per_unit = 1;  // glTF
  for (unsigned m = 0; m < scene->mNumMeshes; ++m)
    parts.meshes.push_back(mesh_from(*scene->mMeshes[m], path, parts.left_out));
  add_nodes(*scene->mRootNode, parts);
  if (is_dae) {
    // The unit is all that the root's transform holds.
    parts.metres_per_unit = as_written(float(parts.nodes.front().in_parent.matrix()(0, 0)));
    parts.nodes.front().in_parent = Affine3d::Identity();
  }
  return parts;
}

}  // namespace softfinger::robots
