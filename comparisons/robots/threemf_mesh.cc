#include "comparisons/robots/threemf_mesh.h"

#include <tinyxml2.h>

#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "comparisons/robots/imported_scene.h"
#include "comparisons/robots/zip_file.h"
#include "meshes/io/read_surface.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

using Eigen::Affine3d;
using tinyxml2::XMLElement;

/// The name without the prefix of its namespace.
std::string_view local_name(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

std::string attribute_of(const XMLElement& element, std::string_view name) {
  for (const auto* attribute = element.FirstAttribute(); attribute; attribute = attribute->Next())
    if (local_name(attribute->Name()) == name) return attribute->Value();
  return "";
}

const XMLElement* child_of(const XMLElement& element, std::string_view name) {
  for (const auto* child = element.FirstChildElement(); child; child = child->NextSiblingElement())
    if (local_name(child->Name()) == name) return child;
  return nullptr;
}

class ThreeMfReader {
 public:
  ThreeMfReader(std::string bytes, const std::string& path)
      : path_(path), archive_(std::move(bytes), path) {}

  MeshParts read() {
    const std::string root = root_model();
    const Model& model = this->model(root);
    parts_.metres_per_unit = model.metres_per_unit;
    const XMLElement* build = child_of(*model.document->RootElement(), "build");
    for (const auto* item = build ? build->FirstChildElement() : nullptr; item;
         item = item->NextSiblingElement())
      if (local_name(item->Name()) == "item")
        place(*item, model_of(*item, root), attribute_of(*item, "objectid"), -1, 0);
    return std::move(parts_);
  }

 private:
  struct Model {
    std::unique_ptr<tinyxml2::XMLDocument> document;
    double metres_per_unit = 1e-3;
    std::map<std::string, const XMLElement*> objects;
    std::map<std::string, std::size_t> meshes;  ///< those that were read
  };

  [[noreturn]] void refuse(const XMLElement& at, const std::string& value,
                           const std::string& allowed) const {
    throw InputError(path_, current_ + ":" + std::to_string(at.GetLineNum()) + ": " + at.Name(),
                     in_quotes(value.substr(0, kLongestName)), allowed);
  }

  /// The file with the things to build, which the archive names.
  std::string root_model() {
    const std::string kUsual = "3D/3dmodel.model";
    const auto text = archive_.read("_rels/.rels");
    tinyxml2::XMLDocument document;
    if (!text || document.Parse(text->data(), text->size()) != tinyxml2::XML_SUCCESS) return kUsual;
    const std::string_view wanted = "3dmodel";
    const auto* first =
        document.RootElement() ? document.RootElement()->FirstChildElement() : nullptr;
    for (const auto* relation = first; relation; relation = relation->NextSiblingElement()) {
      const std::string type = attribute_of(*relation, "Type");
      if (type.size() >= wanted.size() &&
          type.compare(type.size() - wanted.size(), wanted.size(), wanted) == 0)
        return in_archive(attribute_of(*relation, "Target"));
    }
    return kUsual;
  }

  /// Names in the archive have no slash at their beginning, references to them do.
  static std::string in_archive(const std::string& reference) {
    return reference.substr(std::min(reference.find_first_not_of('/'), reference.size()));
  }

  std::string model_of(const XMLElement& element, const std::string& own) const {
    const std::string path = attribute_of(element, "path");
    return path.empty() ? own : in_archive(path);
  }

  Model& model(const std::string& name) {
    const auto known = models_.find(name);
    if (known != models_.end()) return known->second;
    const auto text = archive_.read(name);
    if (!text)
      throw InputError(path_, "file in it", in_quotes(name.substr(0, kLongestName)),
                       "one that is there: is this a whole 3MF file?");
    Model made;
    made.document = std::make_unique<tinyxml2::XMLDocument>();
    if (made.document->Parse(text->data(), text->size()) != tinyxml2::XML_SUCCESS ||
        !made.document->RootElement())
      throw InputError(path_, name.substr(0, kLongestName),
                       made.document->RootElement() || made.document->Error()
                           ? "line " + std::to_string(made.document->ErrorLineNum())
                           : "empty",
                       "XML that is whole");
    current_ = name.substr(0, kLongestName);
    const XMLElement& root = *made.document->RootElement();
    made.metres_per_unit = unit_of(root);
    const XMLElement* resources = child_of(root, "resources");
    for (const auto* object = resources ? resources->FirstChildElement() : nullptr; object;
         object = object->NextSiblingElement())
      if (local_name(object->Name()) == "object")
        made.objects.emplace(attribute_of(*object, "id"), object);
    return models_.emplace(name, std::move(made)).first->second;
  }

  double unit_of(const XMLElement& root) const {
    struct Unit {
      const char* name;
      double metres;
    };
    const std::string typed = attribute_of(root, "unit");
    if (typed.empty()) return 1e-3;
    for (const Unit& unit : {Unit{"micron", 1e-6},
                             {"millimeter", 1e-3},
                             {"centimeter", 1e-2},
                             {"inch", 25.4e-3},
                             {"foot", 304.8e-3},
                             {"meter", 1}})
      if (typed == unit.name) return unit.metres;
    refuse(root, typed, "unit = micron, millimeter, centimeter, inch, foot or meter");
  }

  /// Adds an object, and the ones that it is composed of, as a node.
  void place(const XMLElement& by, const std::string& file, const std::string& id, int parent,
             int depth) {
    constexpr int kDeepest = 50;
    constexpr std::size_t kMostNodes = 100'000;
    const std::string named_in = current_;
    Model& model = this->model(file);
    current_ = named_in;
    const auto found = model.objects.find(id);
    if (found == model.objects.end()) refuse(by, id, "the id of an object in " + file);
    if (depth == kDeepest || parts_.nodes.size() == kMostNodes)
      refuse(by, id, "objects in at most 50 levels, 100000 together, none of which holds itself");
    if (parts_.metres_per_unit != model.metres_per_unit) refuse(by, file, "files of one unit");
    const XMLElement& object = *found->second;
    const int node = int(parts_.nodes.size());
    parts_.nodes.push_back({attribute_of(object, "name"), parent, transform_of(by), {}});
    if (parts_.nodes.back().name.empty()) parts_.nodes.back().name = "object " + id;
    current_ = file.substr(0, kLongestName);
    if (const XMLElement* mesh = child_of(object, "mesh"))
      parts_.nodes[std::size_t(node)].meshes.push_back(mesh_of(model, id, *mesh));
    const XMLElement* components = child_of(object, "components");
    for (const auto* one = components ? components->FirstChildElement() : nullptr; one;
         one = one->NextSiblingElement())
      if (local_name(one->Name()) == "component")
        place(*one, model_of(*one, file), attribute_of(*one, "objectid"), node, depth + 1);
    current_ = named_in;
  }

  /// Twelve numbers: the images of the axes, then the displacement.
  Affine3d transform_of(const XMLElement& element) const {
    Affine3d result = Affine3d::Identity();
    const std::string text = attribute_of(element, "transform");
    if (text.empty()) return result;
    const char *at = text.data(), *const end = at + text.size();
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row) {
        while (at != end && *at == ' ') ++at;
        const auto [rest, error] = std::from_chars(at, end, result.matrix()(row, column));
        if (error != std::errc() || !std::isfinite(result.matrix()(row, column)))
          refuse(element, text, "transform = twelve finite numbers");
        at = rest;
      }
    return result;
  }

  std::size_t mesh_of(Model& model, const std::string& id, const XMLElement& element) {
    const auto known = model.meshes.find(id);
    if (known != model.meshes.end()) return known->second;
    PartMesh mesh;
    if (const XMLElement* vertices = child_of(element, "vertices"))
      for (const auto* one = vertices->FirstChildElement(); one; one = one->NextSiblingElement())
        mesh.vertices.emplace_back(coordinate(*one, "x"), coordinate(*one, "y"),
                                   coordinate(*one, "z"));
    if (const XMLElement* triangles = child_of(element, "triangles"))
      for (const auto* one = triangles->FirstChildElement(); one; one = one->NextSiblingElement())
        if (local_name(one->Name()) == "triangle")
          mesh.triangles.push_back(
              {corner(*one, "v1", mesh), corner(*one, "v2", mesh), corner(*one, "v3", mesh)});
    parts_.meshes.push_back(std::move(mesh));
    return model.meshes.emplace(id, parts_.meshes.size() - 1).first->second;
  }

  double coordinate(const XMLElement& vertex, const char* name) const {
    const char* text = vertex.Attribute(name);
    double value = 0;
    const std::string_view digits = text ? text : "";
    const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || rest != digits.data() + digits.size() || !std::isfinite(value))
      refuse(vertex, std::string(digits), std::string(name) + " = a finite number");
    return value;
  }

  int corner(const XMLElement& triangle, const char* name, const PartMesh& mesh) const {
    const char* text = triangle.Attribute(name);
    int value = 0;
    const std::string_view digits = text ? text : "";
    const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || rest != digits.data() + digits.size() || value < 0 ||
        std::size_t(value) >= mesh.vertices.size())
      refuse(triangle, std::string(digits),
             std::string(name) + " = the number of a vertex, from 0 to below " +
                 std::to_string(mesh.vertices.size()));
    return value;
  }

  const std::string& path_;
  ZipFile archive_;
  std::map<std::string, Model> models_;
  std::string current_;  ///< the file of the archive that is looked at
  MeshParts parts_;
};

}  // namespace

MeshParts read_3mf(std::string bytes, const std::string& path) {
  return ThreeMfReader(std::move(bytes), path).read();
}

}  // namespace softfinger::robots
