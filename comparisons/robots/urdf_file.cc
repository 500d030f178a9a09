#include "comparisons/robots/urdf_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "comparisons/robots/imported_scene.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

using tinyxml2::XMLElement;

/// Frames without mass are links, too, and there are many of them. urdfdom takes its tree apart by
/// recursion, so that a chain of links must not be endless.
constexpr int kMostLinks = 5000;

std::string attribute(const XMLElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value ? value : "";
}

class UrdfCheck {
 public:
  explicit UrdfCheck(const std::filesystem::path& file) : file_(file.string()) {}

  UrdfFile run() {
    const tinyxml2::XMLError error = document_.LoadFile(file_.c_str());
    if (error != tinyxml2::XML_SUCCESS || !document_.RootElement()) {
      const int line = document_.ErrorLineNum();
      throw InputError(line > 0 ? fmt::format("{}:{}", file_, line) : file_, "not an XML file", "",
                       "");
    }
    XMLElement& root = *document_.RootElement();
    if (root.Name() != std::string("robot"))
      throw InputError(at(root), "root element", in_quotes(root.Name()), "robot");
    refuse_xacro(root);
    for (const XMLElement* link = root.FirstChildElement("link"); link;
         link = link->NextSiblingElement("link"))
      look_at_link(*link);
    for (const XMLElement* joint = root.FirstChildElement("joint"); joint;
         joint = joint->NextSiblingElement("joint"))
      look_at_joint(*joint);
    note_the_rest(root);
    strip(root);
    tinyxml2::XMLPrinter printer(nullptr, true);
    document_.Print(&printer);
    urdf_.text = printer.CStr();
    return std::move(urdf_);
  }

 private:
  template <class... Arguments>
  void note(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    urdf_.notes.push_back(fmt::format(text, std::forward<Arguments>(arguments)...));
  }
  std::string at(const XMLElement& element) const {
    return fmt::format("{}:{}", file_, element.GetLineNum());
  }

  void refuse_xacro(const XMLElement& root) const {
    for (const XMLElement* child = root.FirstChildElement(); child;
         child = child->NextSiblingElement())
      if (std::string(child->Name()).rfind("xacro:", 0) == 0)
        throw InputError(
            at(*child), "element", fmt::format("<{}>", child->Name()),
            fmt::format("links and joints: this is a xacro file. Type: xacro {} -o robot.urdf "
                        "(from ROS, or `pip install xacro`), then name robot.urdf",
                        std::filesystem::path(file_).filename().string()));
  }

  void look_at_link(const XMLElement& link) {
    const std::string name = attribute(link, "name");
    if (!urdf_.line_of_link.emplace(name, link.GetLineNum()).second)
      throw InputError(at(link), "link", in_quotes(name), "each name once");
    if (urdf_.line_of_link.size() > std::size_t(kMostLinks))
      throw InputError(at(link), "links", "", fmt::format("at most {}", kMostLinks));
    const std::string where = fmt::format("{}: link {}", at(link), in_quotes(name));
    check_numbers(link, where, 0);
    if (const XMLElement* contact = link.FirstChildElement("contact"))
      if (const XMLElement* friction = contact->FirstChildElement("lateral_friction"))
        take_friction(name, *friction, friction->Attribute("value"));
  }

  void take_friction(const std::string& link, const XMLElement& element, const char* typed) {
    double value = 0;
    if (!typed || !tinyxml2::XMLUtil::ToDouble(typed, &value) || !(value >= 0) ||
        !std::isfinite(value))
      throw InputError(at(element), element.Name(), in_quotes(typed ? typed : ""),
                       "a friction coefficient >= 0");
    urdf_.friction_of_link[link] = value;
  }

  /// Checks the numbers of what a scene is made of: urdfdom takes some of them without a word.
  void check_numbers(const XMLElement& parent, const std::string& where, int depth) {
    struct Numbers {
      const char *element, *attribute;
      int count;
    };
    static const std::vector<Numbers> known = {
        {"origin", "xyz", 3},       {"origin", "rpy", 3},        {"axis", "xyz", 3},
        {"mass", "value", 1},       {"inertia", "ixx", 1},       {"inertia", "ixy", 1},
        {"inertia", "ixz", 1},      {"inertia", "iyy", 1},       {"inertia", "iyz", 1},
        {"inertia", "izz", 1},      {"box", "size", 3},          {"sphere", "radius", 1},
        {"cylinder", "radius", 1},  {"cylinder", "length", 1},   {"capsule", "radius", 1},
        {"capsule", "length", 1},   {"mesh", "scale", 3},        {"limit", "lower", 1},
        {"limit", "upper", 1},      {"limit", "effort", 1},      {"limit", "velocity", 1},
        {"dynamics", "damping", 1}, {"dynamics", "friction", 1}, {"mimic", "multiplier", 1},
        {"mimic", "offset", 1}};
    constexpr int kDepth = 4;
    for (const XMLElement* child = parent.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      for (const Numbers& numbers : known)
        if (child->Name() == std::string(numbers.element))
          if (const char* typed = child->Attribute(numbers.attribute))
            check_list(*child, numbers.attribute, typed, numbers.count, where);
      if (parent.Name() == std::string("geometry")) check_shape(*child, where);
      if (depth < kDepth) check_numbers(*child, where, depth + 1);
    }
  }

  void check_list(const XMLElement& element, const char* name, const std::string& typed, int count,
                  const std::string& where) const {
    // A limit that is none is often a huge number.
    const double most = element.Name() == std::string("limit") ? 1e300 : 1e12;
    std::size_t position = 0;
    int found = 0;
    bool is_good = true;
    while (is_good) {
      position = typed.find_first_not_of(" \t\r\n", position);
      if (position == std::string::npos) break;
      const std::size_t end = std::min(typed.find_first_of(" \t\r\n", position), typed.size());
      const std::string word = typed.substr(position, end - position);
      char* rest = nullptr;
      const double value = std::strtod(word.c_str(), &rest);
      is_good = rest && *rest == '\0' && std::abs(value) <= most;
      ++found;
      position = end;
    }
    if (is_good && found == count) return;
    throw InputError(where,
                     fmt::format("<{}> {}, line {}", element.Name(), name, element.GetLineNum()),
                     in_quotes(typed.substr(0, kLongestName)),
                     count == 1 ? "a finite number" : fmt::format("{} finite numbers", count));
  }
  void check_shape(const XMLElement& shape, const std::string& where) {
    static const std::vector<std::string> known = {"box", "sphere", "cylinder", "capsule", "mesh"};
    if (std::find(known.begin(), known.end(), shape.Name()) == known.end())
      throw InputError(where, fmt::format("geometry, line {}", shape.GetLineNum()),
                       in_quotes(shape.Name()), "box, sphere, cylinder, capsule or mesh");
    if (const char* mesh = shape.Attribute("filename"))
      urdf_.line_of_mesh.emplace(mesh, shape.GetLineNum());
  }

  void look_at_joint(const XMLElement& joint) {
    const std::string name = attribute(joint, "name");
    if (!urdf_.line_of_joint.emplace(name, joint.GetLineNum()).second)
      throw InputError(at(joint), "joint", in_quotes(name), "each name once");
    const std::string where = fmt::format("{}: joint {}", at(joint), in_quotes(name));
    check_type(joint, where);
    check_numbers(joint, where, 0);
    check_limits(joint);
    const XMLElement* child = joint.FirstChildElement("child");
    const std::string link = child ? attribute(*child, "link") : "";
    const auto [other, is_new] = parent_joint_.emplace(link, name);
    if (!is_new)
      throw InputError(where, "child", in_quotes(link),
                       "a link that is not the child of joint " + in_quotes(other->second) +
                           ": closed chains are not URDF");
    const XMLElement* parent = joint.FirstChildElement("parent");
    const std::string holder = parent ? attribute(*parent, "link") : "";
    // urdfdom never frees links in a ring.
    if (!link.empty() && root_of(holder) == link)
      throw InputError(where, "parent", in_quotes(holder),
                       "a link that does not hang on its child " + in_quotes(link) +
                           ": closed chains are not URDF");
    // A joint without a child hangs on nothing, and would hang on itself without a parent.
    if (!link.empty()) root_[link] = holder;
  }

  /// The link on which `link` hangs, by way of the joints so far: itself where it hangs on none.
  std::string root_of(std::string link) {
    for (auto at = root_.find(link); at != root_.end(); at = root_.find(link)) {
      // Halves the way for the next search.
      if (const auto next = root_.find(at->second); next != root_.end()) at->second = next->second;
      link = at->second;
    }
    return link;
  }

  void check_type(const XMLElement& joint, const std::string& where) const {
    static const std::vector<std::string> known = {"revolute", "continuous", "prismatic", "fixed",
                                                   "floating", "planar",     "spherical"};
    const std::string type = attribute(joint, "type");
    if (std::find(known.begin(), known.end(), type) == known.end())
      throw InputError(where, "type", in_quotes(type), fmt::format("{}", fmt::join(known, ", ")));
  }

  void check_limits(const XMLElement& joint) {
    const std::string type = attribute(joint, "type");
    if (type != "revolute" && type != "prismatic") return;
    const std::string name = in_quotes(attribute(joint, "name"));
    const XMLElement* limit = joint.FirstChildElement("limit");
    const std::string where = fmt::format("{}: joint {}", at(limit ? *limit : joint), name);
    if (!limit)
      throw InputError(where, "limit", "",
                       "a <limit> in a revolute or prismatic joint; without one a hinge is "
                       "\"continuous\"");
    const double lower = limit->DoubleAttribute("lower"), upper = limit->DoubleAttribute("upper");
    if (!(lower <= upper))
      throw InputError(where, "limits", fmt::format("{} to {}", lower, upper), "lower <= upper");
    if (lower == upper) note("joint {} has no limits: the file's leave it no room", name);
  }

  void note_the_rest(const XMLElement& root) {
    for (const XMLElement* gazebo = root.FirstChildElement("gazebo"); gazebo;
         gazebo = gazebo->NextSiblingElement("gazebo")) {
      const XMLElement* friction = gazebo->FirstChildElement("mu1");
      if (!friction || !gazebo->Attribute("reference")) continue;
      const char* typed = friction->Attribute("value");
      take_friction(attribute(*gazebo, "reference"), *friction,
                    typed ? typed : friction->GetText());
    }
    for (const char* name : {"gazebo", "transmission"}) {
      int count = 0;
      for (const XMLElement* child = root.FirstChildElement(name); child;
           child = child->NextSiblingElement(name))
        ++count;
      if (count > 0)
        note("{} <{}> are left out{}", count, name,
             name == std::string("gazebo") ? ", but for mu1" : "");
    }
  }

  /// Leaves links and joints, and of links what a scene is made of.
  void strip(XMLElement& root) {
    keep_only(root, {"link", "joint"});
    for (XMLElement* link = root.FirstChildElement("link"); link;
         link = link->NextSiblingElement("link")) {
      keep_only(*link, {"inertial", "visual", "collision"});
      for (XMLElement* visual = link->FirstChildElement("visual"); visual;
           visual = visual->NextSiblingElement("visual"))
        keep_only(*visual, {"origin", "geometry"});
      for (const char* name : {"visual", "collision"}) {
        int number = 0;
        for (XMLElement* one = link->FirstChildElement(name); one;
             one = one->NextSiblingElement(name), ++number)
          replace_capsule(*one, attribute(*link, "name"), number);
      }
    }
    for (XMLElement* joint = root.FirstChildElement("joint"); joint;
         joint = joint->NextSiblingElement("joint"))
      keep_only(*joint, {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"});
    for (XMLElement* joint = root.FirstChildElement("joint"); joint;
         joint = joint->NextSiblingElement("joint")) {
      if (attribute(*joint, "type") == "spherical") {
        urdf_.ball_joints.insert(attribute(*joint, "name"));
        joint->SetAttribute("type", "floating");
      }
      if (XMLElement* limit = joint->FirstChildElement("limit"))
        // urdfdom wants them; without them there are none.
        for (const char* name : {"lower", "upper", "effort", "velocity"})
          if (!limit->Attribute(name)) limit->SetAttribute(name, "0");
    }
  }

  void replace_capsule(XMLElement& shape, const std::string& link, int number) {
    XMLElement* geometry = shape.FirstChildElement("geometry");
    XMLElement* capsule = geometry ? geometry->FirstChildElement("capsule") : nullptr;
    if (!capsule) return;
    capsule->SetName("cylinder");
    const bool is_visual = shape.Name() == std::string("visual");
    urdf_.capsules.insert({link, is_visual ? UrdfFile::kVisual + number : number});
  }

  static void keep_only(XMLElement& parent, const std::vector<std::string>& names) {
    for (tinyxml2::XMLNode* child = parent.FirstChild(); child;) {
      tinyxml2::XMLNode* next = child->NextSibling();
      const XMLElement* element = child->ToElement();
      if (!element || std::find(names.begin(), names.end(), element->Name()) == names.end())
        parent.DeleteChild(child);
      child = next;
    }
  }

  std::string file_;
  tinyxml2::XMLDocument document_;
  UrdfFile urdf_;
  std::map<std::string, std::string> parent_joint_;  ///< of links
  std::map<std::string, std::string> root_;          ///< of links: one nearer to the root
};

}  // namespace

bool is_urdf(const std::filesystem::path& file) {
  tinyxml2::XMLDocument document;
  return document.LoadFile(file.c_str()) == tinyxml2::XML_SUCCESS && document.RootElement() &&
         document.RootElement()->Name() == std::string("robot");
}

UrdfFile read_urdf(const std::filesystem::path& file) { return UrdfCheck(file).run(); }

}  // namespace softfinger::robots
