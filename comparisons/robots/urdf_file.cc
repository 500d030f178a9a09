#include "comparisons/robots/urdf_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <algorithm>

#include "comparisons/robots/imported_scene.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

using tinyxml2::XMLElement;

std::string attribute(const XMLElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value ? value : "";
}

/// Number in an attribute; 0 where there is none, as in URDF.
double number(const XMLElement& limit, const char* name, const std::string& where) {
  double value = 0;
  if (limit.QueryDoubleAttribute(name, &value) == tinyxml2::XML_WRONG_ATTRIBUTE_TYPE)
    throw InputError(where, name, in_quotes(attribute(limit, name)), "a number");
  return value;
}

/// MuJoCo ends with a fault at another one.
void check_type(const std::filesystem::path& file, const XMLElement& joint) {
  static const std::vector<std::string> known = {"revolute", "continuous", "prismatic",
                                                 "fixed",    "floating",   "planar"};
  const std::string type = attribute(joint, "type");
  if (std::find(known.begin(), known.end(), type) == known.end())
    throw InputError(fmt::format("{}:{}: joint {}", file.string(), joint.GetLineNum(),
                                 in_quotes(attribute(joint, "name"))),
                     "type", in_quotes(type), fmt::format("{}", fmt::join(known, ", ")));
}

void check_limits(const std::filesystem::path& file, const XMLElement& joint, UrdfFile& urdf) {
  const std::string type = attribute(joint, "type");
  if (type != "revolute" && type != "prismatic") return;
  const std::string name = in_quotes(attribute(joint, "name"));
  const XMLElement* limit = joint.FirstChildElement("limit");
  const std::string where =
      fmt::format("{}:{}: joint {}", file.string(), (limit ? limit : &joint)->GetLineNum(), name);
  const double lower = limit ? number(*limit, "lower", where) : 0,
               upper = limit ? number(*limit, "upper", where) : 0;
  if (!(lower <= upper))
    throw InputError(where, "limits", fmt::format("{} to {}", lower, upper), "lower <= upper");
  // MuJoCo does so without a word.
  if (lower == upper)
    urdf.notes.push_back(fmt::format("joint {} has no limits: the file's leave it no room", name));
}

void note_joints(const XMLElement& root, UrdfFile& urdf) {
  std::vector<std::string> limited;
  for (const XMLElement* joint = root.FirstChildElement("joint"); joint;
       joint = joint->NextSiblingElement("joint")) {
    const std::string name = in_quotes(attribute(*joint, "name"));
    if (const XMLElement* mimic = joint->FirstChildElement("mimic"))
      urdf.notes.push_back(fmt::format(
          "joint {} moves by itself, not as joint {}: <mimic> is left out, a [[motor]] of its own "
          "can move it",
          name, in_quotes(attribute(*mimic, "joint"))));
    const XMLElement* limit = joint->FirstChildElement("limit");
    if (limit && (limit->Attribute("effort") || limit->Attribute("velocity")))
      limited.push_back(name);
  }
  if (!limited.empty())
    urdf.notes.push_back(
        fmt::format("the effort and velocity limits of joints {} are left out: a [[motor]] has "
                    "max_effort_Nm or max_effort_N",
                    fmt::join(limited, ", ")));
}

void note_elements(const XMLElement& root, UrdfFile& urdf) {
  for (const char* name : {"gazebo", "transmission"}) {
    int count = 0;
    for (const XMLElement* child = root.FirstChildElement(name); child;
         child = child->NextSiblingElement(name))
      ++count;
    if (count > 0) urdf.notes.push_back(fmt::format("{} <{}> are left out", count, name));
  }
}

/// MuJoCo's own element of a URDF file.
std::string with_all_links(tinyxml2::XMLDocument& document) {
  XMLElement* parent = document.RootElement();
  for (const char* name : {"mujoco", "compiler"}) {
    XMLElement* child = parent->FirstChildElement(name);
    parent = child ? child : parent->InsertNewChildElement(name);
  }
  parent->SetAttribute("fusestatic", "false");
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace

bool is_urdf(const std::filesystem::path& file) {
  tinyxml2::XMLDocument document;
  return document.LoadFile(file.c_str()) == tinyxml2::XML_SUCCESS && document.RootElement() &&
         document.RootElement()->Name() == std::string("robot");
}

UrdfFile read_urdf(const std::filesystem::path& file) {
  tinyxml2::XMLDocument document;
  UrdfFile urdf;
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS || !document.RootElement())
    throw InputError(file.string(), "not an XML file", "", "");
  const XMLElement& root = *document.RootElement();
  for (const XMLElement* joint = root.FirstChildElement("joint"); joint;
       joint = joint->NextSiblingElement("joint")) {
    check_type(file, *joint);
    check_limits(file, *joint, urdf);
  }
  note_joints(root, urdf);
  note_elements(root, urdf);
  urdf.with_all_links = with_all_links(document);
  return urdf;
}

}  // namespace softfinger::robots
