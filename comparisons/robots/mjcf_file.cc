#include "comparisons/robots/mjcf_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>
#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <sstream>

#include "comparisons/robots/imported_scene.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

constexpr int kMostIncludes = 200;
constexpr double kMostReplicas = 20'000;

/// Elements that are only seen, or reported: no scene has them, in any version. Sensors are
/// counted.
const std::set<std::string> kUnused = {"visual",   "statistic", "custom", "sensor", "texture",
                                       "material", "skin",      "camera", "light",  "extension"};

/// Attributes that are newer than the library and change nothing that a scene has, by the element;
/// those of `*` in any element.
const std::map<std::string, std::set<std::string>> kHarmless = {
    {"*", {"user", "group", "material", "rgba"}},
    {"compiler", {"alignfree", "saveinertial", "conflict"}},
    {"option",
     {"ccd_tolerance", "ccd_iterations", "sdf_iterations", "sdf_initpoints", "ls_iterations",
      "ls_tolerance", "o_friction", "sleep_tolerance"}},
    {"flag",
     {"nativeccd", "eulerdamp", "island", "midphase", "sensor", "autoreset", "invdiscrete",
      "multiccd", "sleep"}},
    {"size", {"memory", "nuser_body", "nuser_jnt", "nuser_geom"}},
    {"mesh", {"content_type", "maxhullvert", "smoothnormal", "octree"}},
    {"hfield", {"content_type"}},
    {"body", {"sleep"}},
    {"joint", {"actuatorgravcomp"}},
    {"freejoint", {"align"}},
    {"geom", {"fluidshape", "fluidcoef"}},
    {"site", {}},
    {"pair", {"solreffriction"}},
    {"key", {"ctrl", "act"}},
};
/// Actuators drive joints by what a scene's motor has; the rest of them is left out in any case.
const std::set<std::string> kActuators = {"general",  "motor",  "position", "velocity",   "damper",
                                          "cylinder", "muscle", "adhesion", "intvelocity"};
const std::set<std::string> kOrientations = {"quat", "axisangle", "xyaxes", "zaxis", "euler"};

XMLElement* next_in(XMLElement* parent, XMLElement* after) {
  return after ? after->NextSiblingElement() : parent->FirstChildElement();
}

std::vector<XMLElement*> children(XMLElement& parent) {
  std::vector<XMLElement*> result;
  for (XMLElement* child = next_in(&parent, nullptr); child; child = next_in(&parent, child))
    result.push_back(child);
  return result;
}

std::string kind(const XMLElement& element) {
  const std::string name = element.Name();
  return name == "worldbody" ? "body" : name;
}

class MjcfFilter {
 public:
  MjcfFilter(const fs::path& file, const MjcfSchema& schema) : file_(file), schema_(schema) {}

  MjcfFile run() {
    if (document_.LoadFile(file_.c_str()) != tinyxml2::XML_SUCCESS || !document_.RootElement() ||
        document_.RootElement()->Name() != std::string("mujoco"))
      return {};
    XMLElement& root = *document_.RootElement();
    include(root, file_.parent_path());
    read_compiler(root);
    for (XMLElement* child : children(root))
      if (child->Name() == std::string("default")) read_defaults(*child, "");
    for (XMLElement* child : children(root)) replicate(*child);
    if (!replicated_.empty()) refuse_replicated_names(root);
    refuse_attached(root);
    for (XMLElement* child : children(root)) flatten(*child);
    note_sites(root, "");
    for (XMLElement* child : children(root))
      if (child->Name() == std::string("actuator"))
        for (XMLElement* actuator : children(*child)) rewrite_actuator(*actuator);
    for (XMLElement* child : children(root))
      if (child->Name() == std::string("equality"))
        for (XMLElement* equality : children(*child)) rewrite_equality(*equality);
    for (XMLElement* child : children(root))
      if (kind(*child) == "body") collect(*child);
    leave_out_visuals(root);
    for (XMLElement* child : children(root))
      if (kind(*child) == "body") note_mesh_masses(*child);
    choose_mesh_inertia(root);
    filter(root);
    if (!left_out_.empty()) {
      std::vector<std::string> parts;
      int count = 0;
      for (const auto& [name, times] : left_out_) {
        parts.push_back(times > 1 ? fmt::format("{} ({})", name, times) : name);
        count += times;
      }
      note("{} parts of the file are newer than MuJoCo {} and change nothing here: {}", count,
           mj_versionString(), fmt::join(parts, ", "));
    }
    if (sensors_ > 0) note("{} sensors are left out", sensors_);
    // Text behind the root is accepted, and would not be again at the end.
    tinyxml2::XMLPrinter printer(nullptr, true);
    root.Accept(&printer);
    result_.text = printer.CStr();
    return std::move(result_);
  }

 private:
  template <class... Arguments>
  void note(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    result_.notes.push_back(fmt::format(text, std::forward<Arguments>(arguments)...));
  }
  /// Place of an element in the file. Elements of included files have no line here.
  std::string at(const XMLElement& element) const {
    return element.GetLineNum() > 0 ? fmt::format("{}:{}", file_.string(), element.GetLineNum())
                                    : file_.string();
  }
  [[noreturn]] void refuse(const XMLElement& element, const std::string& what) const {
    throw InputError(
        at(element), what, "",
        fmt::format("what MuJoCo {} has, or what changes no motion: this is newer, and "
                    "the scene would move otherwise{}",
                    mj_versionString(),
                    element.Name() == std::string("attach")
                        ? "; MuJoCo 3's program compile writes the whole as one file: "
                          "compile MODEL.xml WHOLE.xml"
                        : ""));
  }

  /// Puts the children of included files in the place of their <include>.
  void include(XMLElement& parent, const fs::path& folder) {
    for (XMLElement* child : children(parent)) {
      if (child->Name() != std::string("include")) {
        include(*child, folder);
        continue;
      }
      const char* name = child->Attribute("file");
      fs::path path = file_.parent_path() / (name ? name : "");
      std::error_code error;
      if (!fs::is_regular_file(path, error)) path = folder / (name ? name : "");
      tinyxml2::XMLDocument part;
      if (!name || !fs::is_regular_file(path, error))
        throw InputError(at(*child), "file", in_quotes(name ? name : ""), "a file that is there");
      if (!included_.insert(fs::weakly_canonical(path, error)).second ||
          included_.size() > std::size_t(kMostIncludes))
        throw InputError(at(*child), "file", in_quotes(name),
                         fmt::format("each file once, and at most {}", kMostIncludes));
      if (part.LoadFile(path.c_str()) != tinyxml2::XML_SUCCESS || !part.RootElement())
        throw InputError(at(*child), "file", in_quotes(name), "an XML file");
      include(*part.RootElement(), path.parent_path());
      tinyxml2::XMLNode* last = child;
      for (XMLElement* inner : children(*part.RootElement()))
        last = parent.InsertAfterChild(last, inner->DeepClone(&document_));
      parent.DeleteChild(child);
    }
  }

  void read_compiler(XMLElement& root) {
    for (XMLElement* child : children(root)) {
      if (child->Name() != std::string("compiler")) continue;
      if (const char* angle = child->Attribute("angle"))
        in_degrees_ = angle != std::string("radian");
      if (const char* sequence = child->Attribute("eulerseq")) euler_sequence_ = sequence;
      if (const char* from = child->Attribute("inertiafromgeom"))
        takes_mass_from_geoms_ = from == std::string("true");
      if (const char* limits = child->Attribute("autolimits"))
        has_autolimits_ = limits != std::string("false");
      if (const char* folder = child->Attribute("assetdir")) {
        if (!child->Attribute("meshdir")) child->SetAttribute("meshdir", folder);
        child->DeleteAttribute("assetdir");
      }
    }
    // Newer versions take a range for a limit unless the file says otherwise.
    XMLElement* first = root.InsertNewChildElement("compiler");
    root.InsertFirstChild(first);
    first->SetAttribute("autolimits", has_autolimits_ ? "true" : "false");
  }

  /// Values of attributes by element and attribute, and the class above.
  struct Class {
    std::string parent;
    std::map<std::string, std::map<std::string, std::string>> values;
  };

  void read_defaults(XMLElement& element, const std::string& parent) {
    const char* typed = element.Attribute("class");
    const std::string name = typed ? typed : "main";
    Class& own = classes_[name];
    if (name != parent) own.parent = parent;
    for (XMLElement* child : children(element)) {
      if (child->Name() == std::string("default")) {
        read_defaults(*child, name);
        continue;
      }
      auto& values = classes_[name].values[child->Name()];
      for (const auto* one = child->FirstAttribute(); one; one = one->Next())
        values[one->Name()] = one->Value();
    }
  }

  /// The value of an attribute, its own or that of its class.
  std::optional<std::string> value(const XMLElement& element, const char* name) const {
    if (const char* own = element.Attribute(name)) return own;
    std::string of_class;
    if (const char* own = element.Attribute("class")) of_class = own;
    for (const tinyxml2::XMLNode* above = element.Parent(); of_class.empty() && above;
         above = above->Parent())
      if (const XMLElement* body = above->ToElement())
        if (const char* own = body->Attribute("childclass")) of_class = own;
    if (of_class.empty()) of_class = "main";
    for (int levels = 0; !of_class.empty() && levels < 1000; ++levels) {
      const auto found = classes_.find(of_class);
      if (found == classes_.end()) break;
      const auto values = found->second.values.find(element.Name());
      if (values != found->second.values.end()) {
        const auto one = values->second.find(name);
        if (one != values->second.end()) return one->second;
      }
      of_class = found->second.parent;
    }
    return {};
  }

  std::vector<double> numbers(const XMLElement& element, const char* name,
                              const std::vector<double>& usual) const {
    const auto typed = value(element, name);
    if (!typed) return usual;
    std::istringstream words(*typed);
    std::vector<double> result;
    for (std::string word; words >> word;) {
      char* end = nullptr;
      result.push_back(std::strtod(word.c_str(), &end));
      if (*end != '\0' || !std::isfinite(result.back()))
        throw InputError(at(element), name, in_quotes(*typed), "finite numbers");
    }
    if (result.size() < usual.size() && name != std::string("axisangle"))
      throw InputError(at(element), name, in_quotes(*typed),
                       fmt::format("{} numbers", usual.size()));
    return result;
  }
  Vector3d vector(const XMLElement& element, const char* name, const Vector3d& usual) const {
    const auto three = numbers(element, name, {usual.x(), usual.y(), usual.z()});
    return {three[0], three[1], three[2]};
  }
  double angle(double typed) const { return in_degrees_ ? typed * kDegree : typed; }

  Eigen::Matrix3d orientation(const XMLElement& element) const {
    using Eigen::AngleAxisd;
    if (value(element, "quat")) {
      const auto q = numbers(element, "quat", {1, 0, 0, 0});
      return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    }
    if (value(element, "axisangle")) {
      const auto a = numbers(element, "axisangle", {0, 0, 1, 0});
      return AngleAxisd(angle(a.at(3)), Vector3d(a[0], a[1], a[2]).normalized()).toRotationMatrix();
    }
    if (value(element, "euler")) {
      const Vector3d turns = vector(element, "euler", Vector3d::Zero());
      Eigen::Matrix3d result = Eigen::Matrix3d::Identity();
      for (std::size_t i = 0; i < 3 && i < euler_sequence_.size(); ++i) {
        const char letter = euler_sequence_[i];
        const int axis = letter == 'x' || letter == 'X'   ? 0
                         : letter == 'y' || letter == 'Y' ? 1
                                                          : 2;
        const Eigen::Matrix3d turn =
            AngleAxisd(angle(turns[int(i)]), Vector3d::Unit(axis)).toRotationMatrix();
        // Small letters turn with the frame, capital ones stay.
        result = letter >= 'a' ? Eigen::Matrix3d(result * turn) : Eigen::Matrix3d(turn * result);
      }
      return result;
    }
    if (value(element, "xyaxes")) {
      const auto six = numbers(element, "xyaxes", {1, 0, 0, 0, 1, 0});
      Eigen::Matrix3d result;
      result.col(0) = Vector3d(six[0], six[1], six[2]).normalized();
      const Vector3d y(six[3], six[4], six[5]);
      result.col(1) = (y - y.dot(result.col(0)) * result.col(0)).normalized();
      result.col(2) = result.col(0).cross(result.col(1));
      return result;
    }
    if (value(element, "zaxis"))
      return Eigen::Quaterniond::FromTwoVectors(
                 Vector3d::UnitZ(), vector(element, "zaxis", Vector3d::UnitZ()).normalized())
          .toRotationMatrix();
    return Eigen::Matrix3d::Identity();
  }
  Isometry3d pose(const XMLElement& element) const {
    Isometry3d result = Isometry3d::Identity();
    result.translation() = vector(element, "pos", Vector3d::Zero());
    result.linear() = orientation(element);
    return result;
  }

  static std::string words(const Vector3d& v) {
    return fmt::format("{} {} {}", v.x(), v.y(), v.z());
  }
  static void set_pose(XMLElement& element, const Isometry3d& at) {
    for (const std::string& name : kOrientations) element.DeleteAttribute(name.c_str());
    const Eigen::Quaterniond turn(at.linear());
    element.SetAttribute("pos", words(at.translation()).c_str());
    element.SetAttribute(
        "quat", fmt::format("{} {} {} {}", turn.w(), turn.x(), turn.y(), turn.z()).c_str());
  }

  /// Replaces each <replicate> by as many <frame>s, whose names end in their number: the place of
  /// each is that of the one before, moved by `offset` in its axes, and turned by `euler`.
  void replicate(XMLElement& parent) {
    for (XMLElement* child : children(parent)) replicate(*child);
    for (XMLElement* child : children(parent)) {
      if (child->Name() != std::string("replicate")) continue;
      const double typed = numbers(*child, "count", {-1})[0];
      made_ += typed * count_of(*child);
      if (!(typed >= 0 && typed == std::floor(typed) && made_ <= kMostReplicas))
        throw InputError(at(*child), "count of <replicate>", in_quotes(fmt::format("{}", typed)),
                         fmt::format("a whole number >= 0, which makes at most {} elements in all",
                                     kMostReplicas));
      const Vector3d offset = vector(*child, "offset", Vector3d::Zero()),
                     turns = vector(*child, "euler", Vector3d::Zero());
      const char* separator = child->Attribute("sep");
      const std::size_t digits = fmt::format("{}", typed).size();
      Isometry3d place = Isometry3d::Identity();
      tinyxml2::XMLNode* last = child;
      for (int i = 0; i < int(typed); ++i) {
        XMLElement* frame = child->DeepClone(&document_)->ToElement();
        frame->SetName("frame");
        for (const char* name : {"count", "offset", "euler", "sep"}) frame->DeleteAttribute(name);
        frame->SetAttribute("euler", words(i * turns).c_str());
        frame->SetAttribute("pos", words(place.translation()).c_str());
        place.linear() = orientation(*frame);
        place.translation() += place.linear() * offset;
        add_suffix(*frame, fmt::format("{}{:0{}}", separator ? separator : "", i, digits));
        last = parent.InsertAfterChild(last, frame);
      }
      parent.DeleteChild(child);
    }
  }

  static double count_of(const XMLElement& element) {
    double count = 1;
    for (const XMLElement* child = element.FirstChildElement(); child;
         child = child->NextSiblingElement())
      count += count_of(*child);
    return count;
  }

  /// Adds a suffix to the names of bodies and what they have.
  void add_suffix(XMLElement& parent, const std::string& suffix) {
    for (XMLElement* child : children(parent)) {
      if (const char* name = child->Attribute("name")) {
        replicated_.insert(name);
        child->SetAttribute("name", (name + suffix).c_str());
      }
      add_suffix(*child, suffix);
    }
  }

  /// MuJoCo 3 replicates what names something replicated, too: actuators, equalities, contacts.
  void refuse_replicated_names(XMLElement& root) {
    for (XMLElement* group : children(root)) {
      if (kind(*group) == "body" || kUnused.count(group->Name()) > 0 ||
          group->Name() == std::string("default"))
        continue;
      std::vector<XMLElement*> open = children(*group);
      while (!open.empty()) {
        XMLElement& element = *open.back();
        open.pop_back();
        for (const auto* one = element.FirstAttribute(); one; one = one->Next())
          if (one->Name() != std::string("name") && replicated_.count(one->Value()) > 0)
            refuse(element, fmt::format("<{}> of {}, which is in a <replicate>", element.Name(),
                                        in_quotes(one->Value())));
        for (XMLElement* child : children(element)) open.push_back(child);
      }
    }
  }

  void refuse_attached(XMLElement& parent) {
    for (XMLElement* child : children(parent)) {
      if (child->Name() == std::string("attach"))
        refuse(*child, fmt::format("<attach> in <{}>", parent.Name()));
      refuse_attached(*child);
    }
  }

  /// Replaces each <frame> by its children, placed in the body that has it.
  void flatten(XMLElement& parent) {
    for (XMLElement* child : children(parent)) flatten(*child);
    if (kind(parent) != "body" && parent.Name() != std::string("frame")) return;
    for (XMLElement* child : children(parent)) {
      if (child->Name() != std::string("frame")) continue;
      const Isometry3d frame = pose(*child);
      tinyxml2::XMLNode* last = child;
      for (XMLElement* inner : children(*child)) {
        place_in(frame, *inner);
        if (const char* childclass = child->Attribute("childclass")) {
          const char* own = kind(*inner) == "body" ? "childclass" : "class";
          if (!inner->Attribute(own)) inner->SetAttribute(own, childclass);
        }
        last = parent.InsertAfterChild(last, inner);
      }
      parent.DeleteChild(child);
    }
  }

  void place_in(const Isometry3d& frame, XMLElement& element) {
    const std::string name = kind(element);
    if (name == "joint") {
      element.SetAttribute("pos", words(frame * vector(element, "pos", Vector3d::Zero())).c_str());
      element.SetAttribute(
          "axis",
          words(frame.linear() * vector(element, "axis", Vector3d::UnitZ()).normalized()).c_str());
    } else if (value(element, "fromto") && (name == "geom" || name == "site")) {
      const auto six = numbers(element, "fromto", {0, 0, 0, 0, 0, 1});
      const Vector3d from = frame * Vector3d(six[0], six[1], six[2]),
                     to = frame * Vector3d(six[3], six[4], six[5]);
      if (value(element, "type") != "box") {
        element.SetAttribute("fromto", (words(from) + " " + words(to)).c_str());
        return;
      }
      // A box is turned about its axis as it would be without the frame.
      const Vector3d along(six[0] - six[3], six[1] - six[4], six[2] - six[5]);
      Isometry3d at = frame;
      at.translation() = (from + to) / 2;
      at.linear() *=
          Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), along).toRotationMatrix();
      element.DeleteAttribute("fromto");
      set_pose(element, at);
      const double side = numbers(element, "size", {0})[0];
      element.SetAttribute("size", words({side, side, along.norm() / 2}).c_str());
    } else if (name == "body" || name == "geom" || name == "site") {
      set_pose(element, frame * pose(element));
    } else if (name != "freejoint" && kUnused.count(name) == 0) {
      refuse(element, fmt::format("<{}> in a <frame>", name));
    }
  }

  struct Site {
    std::string body;
    Vector3d place;
  };

  /// Notes the places of sites, which equalities may name.
  void note_sites(XMLElement& parent, const std::string& body) {
    for (XMLElement* child : children(parent)) {
      if (child->Name() == std::string("worldbody")) {
        note_sites(*child, "world");
      } else if (child->Name() == std::string("body")) {
        const char* name = child->Attribute("name");
        note_sites(*child, name ? name : "");
      } else if (child->Name() == std::string("site")) {
        if (const char* name = child->Attribute("name"))
          sites_[name] = {body, vector(*child, "pos", Vector3d::Zero())};
      }
    }
  }

  /// Newer files put a damping, or a ratio of damping, beside the stiffness of a position actuator.
  void rewrite_actuator(XMLElement& actuator) {
    if (actuator.Name() != std::string("position")) return;
    const auto damping = value(actuator, "kv"), ratio = value(actuator, "dampratio");
    const double stiffness = numbers(actuator, "kp", {1})[0];
    const double second = damping && numbers(actuator, "kv", {0})[0] != 0
                              ? -numbers(actuator, "kv", {0})[0]
                          : ratio ? numbers(actuator, "dampratio", {0})[0]
                                  : 0;
    for (const char* name : {"kv", "dampratio", "timeconst", "inheritrange"})
      if (actuator.Attribute(name)) actuator.DeleteAttribute(name);
    if (second == 0) return;
    actuator.SetName("general");
    actuator.DeleteAttribute("kp");
    actuator.SetAttribute("dyntype", "none");
    actuator.SetAttribute("gaintype", "fixed");
    actuator.SetAttribute("biastype", "affine");
    actuator.SetAttribute("gainprm", fmt::format("{}", stiffness).c_str());
    // Newer versions of MuJoCo take a positive number for a damping ratio.
    actuator.SetAttribute("biasprm", fmt::format("0 {} {}", -stiffness, second).c_str());
  }

  void rewrite_equality(XMLElement& equality) {
    const char *first = equality.Attribute("site1"), *second = equality.Attribute("site2");
    if (!first && !second) return;
    const auto a = sites_.find(first ? first : ""), b = sites_.find(second ? second : "");
    const bool is_connect = equality.Name() == std::string("connect");
    if (a == sites_.end() || b == sites_.end() || a->second.body.empty() ||
        b->second.body.empty() || (!is_connect && equality.Name() != std::string("weld")))
      refuse(equality, fmt::format("<{}> of sites that have no named bodies", equality.Name()));
    equality.DeleteAttribute("site1");
    equality.DeleteAttribute("site2");
    equality.SetAttribute("body1", a->second.body.c_str());
    if (b->second.body != "world") equality.SetAttribute("body2", b->second.body.c_str());
    if (is_connect) equality.SetAttribute("anchor", words(a->second.place).c_str());
  }

  /// Collects the attributes that change the motion and that the scene honours.
  void collect(XMLElement& parent) {
    for (XMLElement* child : children(parent)) {
      const std::string name = child->Name();
      if (name == "body") {
        if (child->Attribute("gravcomp")) {
          const double part = numbers(*child, "gravcomp", {0})[0];
          if (part != 0) result_.gravity_compensation[own_name(*child, "body")] = part;
          child->DeleteAttribute("gravcomp");
        }
        const XMLElement* inertial = child->FirstChildElement("inertial");
        if (inertial && inertial->Attribute("fullinertia") && child->Attribute("name")) {
          const auto six = numbers(*inertial, "fullinertia", {0, 0, 0, 0, 0, 0});
          std::copy_n(six.begin(), 6, result_.full_inertia[child->Attribute("name")].begin());
        }
        collect(*child);
      } else if (name == "joint" && value(*child, "actuatorfrcrange")) {
        const auto range = numbers(*child, "actuatorfrcrange", {0, 0});
        const auto limited = value(*child, "actuatorfrclimited");
        if (limited ? *limited == "true" || (*limited == "auto" && has_autolimits_)
                    : has_autolimits_)
          result_.actuator_force_range[own_name(*child, "joint")] = {range[0], range[1]};
      }
    }
  }

  std::string own_name(XMLElement& element, const char* what) {
    if (const char* name = element.Attribute("name")) return name;
    const std::string name = fmt::format("unnamed_{}_{}", what, ++unnamed_);
    element.SetAttribute("name", name.c_str());
    return name;
  }

  /// Leaves out geoms that are only seen, and the meshes of them, which are often the larger part
  /// of the files, or are not there.
  void leave_out_visuals(XMLElement& root) {
    for (XMLElement* child : children(root)) {
      const std::string name = child->Name();
      if (name == "contact" || name == "tendon" || name == "equality") note_named_geoms(*child);
    }
    for (XMLElement* child : children(root))
      if (kind(*child) == "body") leave_out_geoms(*child);
    std::set<std::string> used;
    note_meshes(root, used);
    for (XMLElement* child : children(root)) {
      if (child->Name() != std::string("asset")) continue;
      for (XMLElement* mesh : children(*child)) {
        if (mesh->Name() != std::string("mesh")) continue;
        const char *own = mesh->Attribute("name"), *file = mesh->Attribute("file");
        const std::string name = own ? own : fs::path(file ? file : "").stem().string();
        if (used.count(name) == 0) child->DeleteChild(mesh);
      }
    }
  }

  void note_named_geoms(const XMLElement& parent) {
    for (const XMLElement* child = parent.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      for (const char* name : {"geom", "geom1", "geom2", "sidesite"})
        if (const char* geom = child->Attribute(name)) named_geoms_.insert(geom);
      note_named_geoms(*child);
    }
  }

  static void note_meshes(const XMLElement& parent, std::set<std::string>& used) {
    for (const XMLElement* child = parent.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      if (const char* mesh = child->Attribute("mesh")) used.insert(mesh);
      note_meshes(*child, used);
    }
  }

  void leave_out_geoms(XMLElement& body) {
    const bool has_mass = body.FirstChildElement("inertial") && !takes_mass_from_geoms_;
    const bool is_world = body.Name() == std::string("worldbody");
    const auto is_zero = [&](const XMLElement& geom, const char* name, double usual) {
      const auto typed = numbers(geom, name, {usual});
      return typed[0] == 0;
    };
    for (XMLElement* child : children(body)) {
      if (kind(*child) == "body") leave_out_geoms(*child);
      if (child->Name() != std::string("geom")) continue;
      const char* name = child->Attribute("name");
      if (name && named_geoms_.count(name) > 0) continue;
      if (!is_zero(*child, "contype", 1) || !is_zero(*child, "conaffinity", 1)) continue;
      const bool is_light =
          value(*child, "mass") ? is_zero(*child, "mass", 0) : is_zero(*child, "density", 1000);
      if (!has_mass && !is_world && !is_light) continue;
      ++result_.visual_geoms;
      body.DeleteChild(child);
    }
  }

  /// Geoms from whose meshes the mass of a body follows.
  void note_mesh_masses(XMLElement& body) {
    const bool is_derived = !body.FirstChildElement("inertial") || takes_mass_from_geoms_;
    for (XMLElement* child : children(body)) {
      if (kind(*child) == "body") note_mesh_masses(*child);
      if (child->Name() != std::string("geom") || !is_derived ||
          body.Name() == std::string("worldbody") || value(*child, "type") != "mesh")
        continue;
      if (const auto mesh = value(*child, "mesh")) weighed_meshes_.insert(*mesh);
      if (value(*child, "mass") || value(*child, "shellinertia") == "true") continue;
      result_.density_of_mesh_geom[own_name(*child, "geom")] =
          numbers(*child, "density", {1000})[0];
    }
  }

  /// The library knows one way for all meshes.
  void choose_mesh_inertia(XMLElement& root) {
    std::set<std::string> ways;
    for (XMLElement* assets : children(root)) {
      if (assets->Name() != std::string("asset")) continue;
      for (XMLElement* mesh : children(*assets)) {
        if (mesh->Name() != std::string("mesh")) continue;
        const char *own = mesh->Attribute("name"), *file = mesh->Attribute("file");
        const std::string name = own ? own : fs::path(file ? file : "").stem().string();
        if (weighed_meshes_.count(name) == 0) continue;
        const std::string way = value(*mesh, "inertia").value_or("legacy");
        if (way != "legacy" && way != "exact")
          refuse(*mesh, fmt::format("inertia = {} of mesh {}, from which a mass follows",
                                    in_quotes(way), in_quotes(name)));
        ways.insert(way);
        if (ways.size() > 1)
          refuse(*mesh,
                 "inertia of meshes, from which masses follow, in two ways: \"exact\" and "
                 "\"legacy\"");
      }
    }
    if (ways.count("exact") == 0) return;
    result_.density_of_mesh_geom.clear();
    root.FirstChildElement("compiler")->SetAttribute("exactmeshinertia", "true");
  }

  void leave_out(const std::string& what) { ++left_out_[what]; }

  void filter(XMLElement& parent) {
    for (XMLElement* child : children(parent)) {
      const std::string name = kind(*child);
      if (name == "inertial" && !child->Attribute("pos")) child->SetAttribute("pos", "0 0 0");
      if (kUnused.count(name) > 0) {
        if (name == "sensor") sensors_ += int(children(*child).size());
        parent.DeleteChild(child);
        continue;
      }
      const auto known = schema_.find(kind(parent) + "/" + name);
      if (known == schema_.end()) {
        leave_out_element(parent, *child);
        continue;
      }
      filter_attributes(*child, known->second, kind(parent) == "default");
      filter(*child);
    }
  }

  void leave_out_element(XMLElement& parent, XMLElement& child) {
    const std::string name = child.Name(), inside = kind(parent);
    if (inside == "actuator") {
      const char* own = child.Attribute("name");
      note(
          "the actuator {} is left out: only motor, position and velocity on a hinge or slide are "
          "known",
          in_quotes(own ? own : name));
    } else if (inside == "default" || (name == "deformable" && !child.FirstChildElement("flex"))) {
      leave_out("<" + name + ">");
    } else {
      refuse(child, fmt::format("element <{}> in <{}>", name, parent.Name()));
    }
    parent.DeleteChild(&child);
  }

  void filter_attributes(XMLElement& element, const std::set<std::string>& known, bool is_default) {
    const std::string name = kind(element), inside = kind(*element.Parent()->ToElement());
    std::vector<std::string> unknown;
    for (const auto* one = element.FirstAttribute(); one; one = one->Next()) {
      const std::string attribute = one->Name();
      if (attribute == "material" || attribute == "rgba" ||
          (name == "key" && known.count(attribute) &&
           (attribute == "ctrl" || attribute == "act"))) {
        unknown.push_back(attribute);
        continue;
      }
      if (attribute == "integrator" && one->Value() == std::string("implicitfast"))
        element.SetAttribute("integrator", "implicit");
      if (known.count(attribute) == 0) unknown.push_back(attribute);
    }
    for (const std::string& attribute : unknown) {
      if (known.count(attribute) == 0) judge(element, name, inside, attribute, is_default);
      element.DeleteAttribute(attribute.c_str());
    }
    // Tendons are left out, and one with a range of lengths would not be read.
    if (inside == "tendon" && element.Attribute("springlength"))
      element.DeleteAttribute("springlength");
  }

  void judge(const XMLElement& element, const std::string& name, const std::string& inside,
             const std::string& attribute, bool is_default) {
    const auto is_harmless = [&](const char* kind_of) {
      const auto found = kHarmless.find(kind_of);
      return found != kHarmless.end() && found->second.count(attribute) > 0;
    };
    if (name == "joint" && inside != "equality" &&
        (attribute == "actuatorfrcrange" || attribute == "actuatorfrclimited"))
      return;                                              // done by the scene
    if (name == "mesh" && attribute == "inertia") return;  // looked at where masses follow
    const bool of_actuator = kActuators.count(name) > 0 && (is_default || inside == "actuator");
    if (of_actuator && (attribute == "kv" || attribute == "dampratio") && name == "position")
      return;
    if (is_harmless("*") || is_harmless(name.c_str()) || name == "site" || inside == "tendon" ||
        name == "tendon" || of_actuator) {
      leave_out(name + " " + attribute);
      return;
    }
    if (name == "flag" && element.Attribute(attribute.c_str()) == std::string("enable") &&
        (attribute == "spring" || attribute == "damper")) {
      leave_out(name + " " + attribute);
      return;
    }
    refuse(element, fmt::format("attribute {} = {} of <{}>", attribute,
                                in_quotes(element.Attribute(attribute.c_str())), element.Name()));
  }

  const fs::path& file_;
  const MjcfSchema& schema_;
  tinyxml2::XMLDocument document_;
  MjcfFile result_;
  std::set<fs::path> included_;
  bool in_degrees_ = true, has_autolimits_ = true, takes_mass_from_geoms_ = false;
  std::set<std::string> weighed_meshes_;
  std::set<std::string> replicated_;   ///< names before their suffix
  double made_ = 0;                    ///< elements that <replicate> made
  std::set<std::string> named_geoms_;  ///< by contacts, tendons and equalities
  std::string euler_sequence_ = "xyz";
  std::map<std::string, Class> classes_;
  std::map<std::string, Site> sites_;
  std::map<std::string, int> left_out_;
  int sensors_ = 0, unnamed_ = 0;
};

}  // namespace

MjcfSchema schema_of_library() {
  std::vector<char> buffer(1 << 20);
  mj_printSchema(nullptr, buffer.data(), int(buffer.size()), 0, 0);
  // A line per element, `name (how often)   attributes`, by its depth; lines without a name go on.
  constexpr std::size_t kPerLevel = 3, kNames = 30;
  MjcfSchema schema;
  std::vector<std::string> path;
  std::set<std::string>* attributes = nullptr;
  std::istringstream lines(buffer.data());
  for (std::string line; std::getline(lines, line);) {
    const std::string head = line.substr(0, kNames);
    const std::size_t start = head.find_first_not_of(' ');
    if (start != std::string::npos) {
      std::string name = head.substr(start, head.find(' ', start) - start);
      if (name == "(world)body") name = "body";
      path.resize(std::min(path.size(), start / kPerLevel));
      attributes = &schema[(path.empty() ? "" : path.back()) + "/" + name];
      // Bodies are in bodies, and defaults in defaults.
      if (name == "body" || name == "default") schema[name + "/" + name] = {};
      path.push_back(name);
    }
    if (!attributes || line.size() <= kNames) continue;
    std::istringstream words(line.substr(kNames));
    for (std::string word; words >> word;) attributes->insert(word);
  }
  for (const char* name : {"body", "default"})
    schema[std::string(name) + "/" + name] = schema["mujoco/" + std::string(name)];
  return schema;
}

std::string with_masses(const std::string& text, const std::map<std::string, double>& mass_kg) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS || !document.RootElement())
    return text;
  std::vector<XMLElement*> open = {document.RootElement()};
  while (!open.empty()) {
    XMLElement* element = open.back();
    open.pop_back();
    for (XMLElement* child : children(*element)) open.push_back(child);
    const char* name = element->Attribute("name");
    const auto found = mass_kg.find(name ? name : "");
    if (element->Name() == std::string("geom") && found != mass_kg.end())
      element->SetAttribute("mass", fmt::format("{}", found->second).c_str());
  }
  tinyxml2::XMLPrinter printer(nullptr, true);
  document.Print(&printer);
  return printer.CStr();
}

MjcfFile read_mjcf(const fs::path& file, const MjcfSchema& schema) {
  return MjcfFilter(file, schema).run();
}

}  // namespace softfinger::robots
