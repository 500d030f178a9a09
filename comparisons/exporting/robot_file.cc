#include "comparisons/exporting/robot_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <unordered_map>

#include "comparisons/exporting/mjcf.h"
#include "comparisons/exporting/simulators/drake.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::exporting {
namespace {

using Value = WantedElement::Value;

std::string number(double value) { return fmt::format("{:.6g}", value); }

WantedElement leaf(const std::string& name, const std::string& text,
                   const std::string& effect = "") {
  WantedElement wanted;
  wanted.name = name;
  wanted.text = text;
  wanted.effect = effect;
  return wanted;
}

WantedElement group(const std::string& name, std::vector<WantedElement> children) {
  WantedElement wanted;
  wanted.name = name;
  wanted.children = std::move(children);
  return wanted;
}

WantedElement tag(const std::string& name, std::vector<Value> attributes,
                  const std::string& key = "") {
  WantedElement wanted;
  wanted.name = name;
  wanted.attributes = std::move(attributes);
  wanted.key = key;
  return wanted;
}

/// <name value="..."/> in URDF, <name>...</name> in SDF.
WantedElement value_of(RobotFormat format, const std::string& name, const std::string& value,
                       const std::string& effect = "") {
  return format == RobotFormat::urdf ? tag(name, {{"value", value, effect}})
                                     : leaf(name, value, effect);
}

/// A part of the file that can be a finger, with the names that it may be called by.
struct Part {
  const XmlElement* element = nullptr;
  const XmlElement* owner = nullptr;  ///< body or link
  std::vector<std::string> names;
};

/// The parts of a file, and which of them have a name.
struct Parts {
  std::vector<Part> all;
  std::unordered_map<std::string, std::vector<std::size_t>> by_name;
};

/// Geoms of bodies; collisions of links.
Parts parts_of(const XmlFile& file, RobotFormat format) {
  Parts parts;
  for (const auto& element : file.elements()) {
    Part part;
    part.element = element;
    part.owner = element->parent;
    const XmlElement* const parent = element->parent;
    if (!parent) continue;
    const std::string name = element->value("name"), owner = parent->value("name");
    if (format == RobotFormat::mjcf) {
      if (element->name != "geom" || !is_in_world(*element)) continue;
      const XmlElement* const body = body_of(*element);
      part.owner = body;
      if (!name.empty()) part.names.push_back(name);
      if (body->name == "body" && !body->value("name").empty())
        part.names.push_back(body->value("name"));
    } else {
      if (element->name != "collision" || parent->name != "link") continue;
      if (!name.empty()) part.names.push_back(name);
      // From the inside out: LINK, LINK::COLLISION, MODEL::LINK, MODEL::LINK::COLLISION, ...
      std::string scope = owner;
      for (const XmlElement* around = parent; around->parent; around = around->parent) {
        if (around != parent && !around->value("name").empty() && around->name == "model")
          scope = around->value("name") + "::" + scope;
        else if (around != parent)
          continue;
        part.names.push_back(scope);
        if (!name.empty()) part.names.push_back(scope + "::" + name);
      }
    }
    for (const std::string& known : part.names) {
      std::vector<std::size_t>& places = parts.by_name[known];
      if (places.empty() || places.back() != parts.all.size()) places.push_back(parts.all.size());
    }
    parts.all.push_back(std::move(part));
  }
  return parts;
}

/// Hint where the finger may be if this file is not the whole model; else empty.
std::string elsewhere(const XmlFile& file) {
  for (const auto& element : file.elements()) {
    if (element->name == "include")
      return "; the file includes others: apply it to the one that has it";
    if (element->name.compare(0, 6, "xacro:") == 0) return "; the file is xacro: expand it first";
  }
  return "";
}

double numeric(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

/// The bits of contype or conaffinity, which are 1 where nothing is said.
unsigned mask(const Mjcf& mjcf, const XmlElement& geom, const char* name) {
  const std::string value = mjcf.value(geom, name);
  return value.empty() ? 1u : unsigned(std::strtoul(value.c_str(), nullptr, 0));
}

/// Why friction of this geom has no effect: it is only there to be seen; empty: it has one.
std::string why_untouched(const Mjcf& mjcf, const XmlElement& geom) {
  if (!mjcf.pairs(geom).empty()) return "";
  if (mjcf.states("option", "collision", "predefined"))
    return "only geoms of a <pair> do under <option collision=\"predefined\">, and it is in none";
  if (mask(mjcf, geom, "contype") == 0 && mask(mjcf, geom, "conaffinity") == 0)
    return "its contype and conaffinity are 0, so that friction has no effect";
  return "";
}

/// @throws InputError where the file has switched off what the geoms' friction would do
void check_flags(const Mjcf& mjcf) {
  const auto refuse = [&](const char* name, const char* value, const std::string& allowed) {
    if (!mjcf.states("flag", name, value)) return;
    throw InputError(mjcf.option("flag", name)->where(),
                     fmt::format("<flag {}=\"{}\"/>", name, value), "", allowed);
  };
  for (const char* flag : {"contact", "constraint"})
    refuse(flag, "disable", "a model with contacts: without them friction has no effect");
  refuse("override", "enable",
         "a model without it: each contact has the friction of <option o_friction>, whatever its "
         "geoms say");
}

/// Bodies, of which two are enough to say whether there is another one.
struct OtherBodies {
  const XmlElement *one = nullptr, *other = nullptr;

  void add(const XmlElement* body) {
    if (!one || one == body)
      one = body;
    else
      other = body;
  }
  bool has_other_than(const XmlElement* body) const { return (one && one != body) || other; }
};

/// Notes on what else decides whether and how the fingers touch, a sentence each.
std::vector<std::string> notes_about(const XmlFile& file, const Mjcf& mjcf,
                                     const std::vector<const XmlElement*>& geoms) {
  std::vector<std::string> notes;
  if (!mjcf.unread().empty()) {
    const bool is_one = mjcf.unread().size() == 1;
    notes.push_back(fmt::format(
        "the file includes {}, which {} not read: a geom there may have a higher priority, whose "
        "friction then counts, and defaults and options there may change this contact",
        text::shortened(text::joined(mjcf.unread()), 200), is_one ? "is" : "are"));
  }
  std::set<std::string> bodies;
  for (const XmlElement* geom : geoms) bodies.insert(body_of(*geom)->value("name"));
  for (const XmlElement* exclude : mjcf.excludes())
    for (const char* name : {"body1", "body2"})
      if (!exclude->value(name).empty() && bodies.count(exclude->value(name)) > 0) {
        notes.push_back(fmt::format("line {}: the bodies \"{}\" and \"{}\" do not touch: <exclude>",
                                    exclude->line, text::shortened(exclude->value("body1")),
                                    text::shortened(exclude->value("body2"))));
        break;
      }

  OtherBodies with_type[32], with_affinity[32], any;
  for (const XmlElement* element : file.elements()) {
    if (element->name != "geom" || !is_in_world(*element)) continue;
    const XmlElement* const body = body_of(*element);
    any.add(body);
    const unsigned type = mask(mjcf, *element, "contype");
    const unsigned affinity = mask(mjcf, *element, "conaffinity");
    for (unsigned bit = 0; bit < 32; ++bit) {
      if ((type >> bit & 1u) != 0) with_type[bit].add(body);
      if ((affinity >> bit & 1u) != 0) with_affinity[bit].add(body);
    }
  }
  std::set<std::string> untouched;
  for (const XmlElement* geom : geoms) {
    const XmlElement* const body = body_of(*geom);
    if (!mjcf.pairs(*geom).empty() || !any.has_other_than(body)) continue;
    const unsigned type = mask(mjcf, *geom, "contype"), affinity = mask(mjcf, *geom, "conaffinity");
    bool touches = false;
    for (unsigned bit = 0; bit < 32; ++bit)
      touches |= ((type >> bit & 1u) != 0 && with_affinity[bit].has_other_than(body)) ||
                 ((affinity >> bit & 1u) != 0 && with_type[bit].has_other_than(body));
    if (!touches) untouched.insert(fmt::format("contype {} and conaffinity {}", type, affinity));
  }
  for (const std::string& masks : untouched)
    notes.push_back("a finger touches no other body of the file: none fits its " + masks);
  return notes;
}

/// Names that tell apart what one name has in several places: "; name it a::c or b::c".
std::string longer_names(const std::vector<Part>& parts, const std::string& finger) {
  std::map<std::string, std::set<const XmlElement*>> owners;
  for (const Part& part : parts)
    for (const std::string& name : part.names) owners[name].insert(part.owner);
  std::string text;
  std::set<const XmlElement*> named;
  const std::string end = "::" + finger;
  for (const Part& part : parts)
    for (const std::string& name : part.names) {
      const bool ends_so =
          name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
      if (!ends_so || owners[name].size() > 1 || !named.insert(part.owner).second) continue;
      text += (text.empty() ? "; name it " : " or ") + text::shortened(name);
    }
  return text;
}

std::vector<const XmlElement*> parts_of_finger(const XmlFile& file, RobotFormat format,
                                               const Mjcf& mjcf, const Parts& parts,
                                               const std::string& finger) {
  std::vector<const XmlElement*> found;
  std::set<const XmlElement*> owners;
  if (const auto named = parts.by_name.find(finger); named != parts.by_name.end())
    for (const std::size_t place : named->second) {
      found.push_back(parts.all[place].element);
      owners.insert(parts.all[place].owner);
    }
  const char* const kind = format == RobotFormat::mjcf ? "geom or body" : "collision or link";
  if (found.empty()) {
    std::vector<std::string> names;
    std::set<std::string> known;
    for (const Part& part : parts.all)
      for (const std::string& name : part.names)
        if (known.insert(name).second) names.push_back(name);
    const bool is_mjcf = format == RobotFormat::mjcf;
    for (const XmlElement* element : file.elements())
      if (element->name == (is_mjcf ? "body" : "link") && element->value("name") == finger &&
          !names.empty())
        throw InputError(element->where(),
                         fmt::format("{} \"{}\" has no {}", element->name, text::shortened(finger),
                                     is_mjcf ? "geom" : "collision"),
                         "", "one with a shape: " + text::shortened(text::joined(names), 200));
    if (names.empty())
      throw InputError(file.where(), "--finger " + text::shortened(finger), "",
                       fmt::format("a {} with a name: the file has none{}", kind, elsewhere(file)));
    throw InputError(file.where(),
                     fmt::format("no {} \"{}\"{}{}", kind, text::shortened(finger),
                                 text::did_you_mean(finger, names), elsewhere(file)),
                     "", text::shortened(text::joined(names), 200));
  }
  if (owners.size() > 1)
    throw InputError(file.where(), "--finger", "\"" + text::shortened(finger) + "\"",
                     fmt::format("one {}: {} have this name{}", kind, owners.size(),
                                 longer_names(parts.all, finger)));
  if (format != RobotFormat::mjcf) return found;
  const XmlElement& first = *found.front();
  found.erase(
      std::remove_if(found.begin(), found.end(),
                     [&](const XmlElement* geom) { return !why_untouched(mjcf, *geom).empty(); }),
      found.end());
  if (found.empty())
    throw InputError(first.where(), "--finger", "\"" + text::shortened(finger) + "\"",
                     "a geom that touches others: " + why_untouched(mjcf, first));
  return found;
}

/// The largest priority over all of the file but the fingers' geoms, at least 0.
int largest_priority(const XmlFile& file, const std::vector<const XmlElement*>& fingers) {
  const std::set<const XmlElement*> except(fingers.begin(), fingers.end());
  double value = 0;
  for (const auto& element : file.elements())
    if (element->attribute("priority") && except.count(element) == 0)
      value = std::max(value, numeric(element->value("priority")));
  return int(std::min(value, 1e6));
}

/// condim 6 has the torque, too, and keeps its rolling friction, except for a flat pad, which
/// gets 3.
struct Rolling {
  bool has_any = false;
  std::vector<std::string> numbers;

  /// @param from  where the rolling friction begins in the attribute `friction`
  Rolling(const Mjcf& mjcf, const XmlElement& element, const RobotContact& wanted, std::size_t from,
          std::size_t count)
      : has_any(mjcf.value(element, "condim") == "6" && !wanted.contact.face),
        numbers(count, "0.0001") {
    std::istringstream words(mjcf.value(element, "friction"));
    std::string word;
    for (std::size_t i = 0; has_any && words >> word; ++i)
      if (i >= from && i - from < count) numbers[i - from] = word;
  }
};

/// An element that is changed, and the contact that it gets.
struct Wanted {
  const XmlElement* element = nullptr;
  const RobotContact* contact = nullptr;
};

std::string effect_of(const RobotContact& wanted) {
  return wanted.torque_error + "; " + wanted.force_error;
}

/// A flat pad touches at several points, whose forces alone carry a torque.
double spin_of(const RobotContact& wanted) {
  return wanted.contact.face ? 0 : wanted.contact.torque_per_load_m();
}
Value condim_of(const RobotContact& wanted) {
  return wanted.contact.face ? Value{"condim", "3", "several points of a flat pad: no torque more"}
                             : Value{"condim", "4", "a torque about the normal"};
}

/// A pair that the file defines has its own friction: that of the first finger in it.
void change_pairs(XmlFile& file, const Mjcf& mjcf, const std::vector<Wanted>& fingers) {
  std::set<const XmlElement*> changed_pairs;
  for (const auto& [geom, wanted] : fingers)
    for (const XmlElement* pair : mjcf.pairs(*geom)) {
      if (!changed_pairs.insert(pair).second) continue;
      const double mu = wanted->contact.friction_coefficient;
      const double spin_m = spin_of(*wanted);
      const Rolling rolling(mjcf, *pair, *wanted, 3, 2);
      WantedElement changed;
      if (!rolling.has_any) changed.attributes.push_back(condim_of(*wanted));
      changed.attributes.push_back({"friction",
                                    fmt::format("{0} {0} {1} {2} {3}", number(mu), number(spin_m),
                                                rolling.numbers[0], rolling.numbers[1]),
                                    effect_of(*wanted)});
      file.change(*pair, changed);
    }
}

/// Whether a file is meant to be included: it has bodies directly under its root.
bool is_part_of_a_model(const XmlFile& file) {
  const auto& children = file.root().children;
  return file.root().name == "mujocoinclude" ||
         std::any_of(children.begin(), children.end(), [](const XmlElement* child) {
           return child->name == "body" || child->name == "geom" || child->name == "frame";
         });
}

/// The last <option> that states one counts.
/// @param root  takes an <option> where there is none
void change_options(XmlFile& file, WantedElement& root) {
  const std::vector<Value> options = {
      {"cone", "elliptic", "the friction ellipsoid; pyramids allow less"},
      {"impratio", "10", "sticking friction is ten times as stiff"},
      {"noslip_iterations", "5", "without them a held contact creeps"}};
  std::vector<const XmlElement*> option_elements;
  for (const XmlElement* child : file.root().children)
    if (child->name == "option") option_elements.push_back(child);
  std::vector<WantedElement> option_changes(option_elements.size());
  WantedElement new_option = group("option", {});
  for (const Value& option : options) {
    std::size_t place = option_elements.size();
    for (std::size_t i = 0; i < option_elements.size(); ++i)
      if (option_elements[i]->attribute(option.name)) place = i;
    const bool is_more =
        place < option_elements.size() && option.name != "cone" &&
        numeric(option_elements[place]->value(option.name)) >= numeric(option.value);
    if (is_more) continue;
    if (place == option_elements.size() && !option_elements.empty()) place = 0;
    (option_elements.empty() ? new_option : option_changes[place]).attributes.push_back(option);
  }
  for (std::size_t i = 0; i < option_elements.size(); ++i)
    file.change(*option_elements[i], option_changes[i]);
  if (!new_option.attributes.empty()) root.children.push_back(new_option);
}

constexpr const char* kCornerSize = "the forces at its corners have the pad's torque";

/// Sizes in URDF and SDF.
void change_sizes(XmlFile& file, RobotFormat format, const std::vector<Wanted>& fingers) {
  for (const auto& [finger, wanted] : fingers) {
    if (!wanted->corner_size) continue;
    const auto& [kind, name, value] = *wanted->corner_size;
    const WantedElement size = format == RobotFormat::urdf
                                   ? tag(kind, {{name, value, kCornerSize}})
                                   : group(kind, {leaf(name, value, kCornerSize)});
    file.change(*finger, group("collision", {group("geometry", {size})}));
  }
}

std::vector<std::string> apply_mujoco(XmlFile& file, const Mjcf& mjcf,
                                      const std::vector<Wanted>& fingers) {
  check_flags(mjcf);
  std::vector<const XmlElement*> geoms;
  for (const Wanted& finger : fingers) geoms.push_back(finger.element);
  const int other_priority = largest_priority(file, geoms);

  for (const auto& [geom, contact] : fingers) {
    const RobotContact& wanted = *contact;
    const double mu = wanted.contact.friction_coefficient;
    const double spin_m = spin_of(wanted);
    WantedElement changed;
    const Rolling rolling(mjcf, *geom, wanted, 2, 1);
    if (!rolling.has_any) changed.attributes.push_back(condim_of(wanted));
    if (!(numeric(mjcf.value(*geom, "priority")) > other_priority))
      changed.attributes.push_back({"priority", std::to_string(other_priority + 1),
                                    mjcf.unread().empty()
                                        ? "this geom's friction counts, not the object's"
                                        : "this geom's friction counts before all others' of this "
                                          "file"});
    changed.attributes.push_back(
        {"friction", fmt::format("{} {} {}", number(mu), number(spin_m), rolling.numbers[0]),
         effect_of(wanted)});
    if (wanted.effective_mass_kg) {
      const MujocoSpring spring =
          mujoco_spring(wanted.contact.normal_stiffness_N_per_m, *wanted.effective_mass_kg);
      const std::string stiffness = fmt::format("dP/dd {:.4g} N/mm, for a mass of {:.4g} g",
                                                1e-3 * wanted.contact.normal_stiffness_N_per_m,
                                                1e3 * *wanted.effective_mass_kg);
      changed.attributes.push_back(
          {"solref",
           fmt::format("{} {}", number(-spring.stiffness_per_s2), number(-spring.damping_per_s)),
           stiffness});
      changed.attributes.push_back(
          {"solimp", fmt::format("{0} {0} 0.001", number(spring.impedance)), stiffness});
    }
    if (wanted.corner_size) {
      const auto& [kind, name, value] = *wanted.corner_size;
      changed.attributes.push_back({name, value, kCornerSize});
    }
    file.change(*geom, changed);
  }

  change_pairs(file, mjcf, fingers);

  std::vector<std::string> notes = notes_about(file, mjcf, geoms);
  WantedElement root;
  if (is_part_of_a_model(file))
    notes.push_back(
        "the file is a part of a model, whose <option> should have cone=\"elliptic\" "
        "impratio=\"10\" noslip_iterations=\"5\"");
  else
    change_options(file, root);

  WantedElement custom = group("custom", {});
  for (const auto& [geom, wanted] : fingers) {
    if (!wanted->plugin) continue;
    const ContactProblem& problem = *wanted->plugin;
    const std::string data = fmt::format(
        "{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g}", problem.radii.major_m,
        problem.radii.minor_m, problem.layer.thickness_m, problem.layer.youngs_modulus_Pa,
        problem.layer.poisson_ratio, problem.finger_curvature.xx_per_m,
        problem.finger_curvature.yy_per_m, problem.finger_curvature.xy_per_m);
    const std::string name = geom->value("name");
    if (name.empty())
      throw InputError(geom->where(), "--plugin", "",
                       "a geom with a name, by which the plugin finds it");
    custom.children.push_back(tag("numeric",
                                  {{"name", "softfinger:" + name, ""},
                                   {"data", data,
                                    "with libsoftfinger_mujoco the torque follows the load, "
                                    "within 1 % of fingertip_layer"}},
                                  "name"));
  }
  if (!custom.children.empty()) {
    if (is_part_of_a_model(file))
      throw InputError(file.where(), "--plugin", "", "the model that includes this file");
    root.children.push_back(custom);
  }
  file.change(file.root(), root);
  return notes;
}

/// <surface><friction> of Gazebo Classic.
WantedElement gazebo_surface(const RobotContact& wanted, bool has_ode) {
  const std::string mu = number(wanted.contact.friction_coefficient);
  const bool is_flat = wanted.contact.face.has_value();
  std::vector<WantedElement> friction;
  if (has_ode)
    friction.push_back(
        group("ode", {leaf("mu", mu, wanted.force_error), leaf("mu2", mu, wanted.force_error)}));
  if (is_flat)
    friction.push_back(group("torsional", {leaf("coefficient", "0", wanted.torque_error)}));
  else
    friction.push_back(group(
        "torsional", {leaf("coefficient", mu, wanted.force_error),
                      leaf("use_patch_radius", "true", "not the solver's penetration"),
                      leaf("patch_radius", number(16 / (3 * kPi) * wanted.contact.eccentricity_m),
                           wanted.torque_error)}));
  return group("surface", {group("friction", friction)});
}

void apply_gazebo(XmlFile& file, RobotFormat format, const std::vector<Wanted>& fingers) {
  if (format == RobotFormat::sdf) {
    for (const auto& [finger, wanted] : fingers)
      file.change(*finger, group("collision", {gazebo_surface(*wanted, true)}));
    return;
  }
  WantedElement root;
  std::set<std::string> links;
  for (const auto& [finger, contact] : fingers) {
    const RobotContact& wanted = *contact;
    const std::string mu = number(wanted.contact.friction_coefficient);
    const std::string link = finger->parent->value("name");
    if (!links.insert(link).second) continue;
    WantedElement gazebo = tag("gazebo", {{"reference", link, ""}}, "reference");
    gazebo.children = {leaf("mu1", mu, wanted.force_error), leaf("mu2", mu, wanted.force_error),
                       group("collision", {gazebo_surface(wanted, false)})};
    root.children.push_back(gazebo);
  }
  file.change(file.root(), root);
}

void apply_bullet(XmlFile& file, RobotFormat format, const std::vector<Wanted>& fingers) {
  std::set<const XmlElement*> links;
  for (const auto& [finger, contact] : fingers) {
    const RobotContact& wanted = *contact;
    const double spin_m = spin_of(wanted);
    if (!links.insert(finger->parent).second) continue;
    file.change(
        *finger->parent,
        group("link",
              {group("contact",
                     {value_of(format, "lateral_friction",
                               number(wanted.contact.friction_coefficient), wanted.force_error),
                      value_of(format, "spinning_friction", number(spin_m), wanted.torque_error),
                      // As simulators/bullet.cc.
                      value_of(format, "rolling_friction", fmt::format("{:.3g}", 1e-3 * spin_m),
                               wanted.contact.face
                                   ? "a flat pad needs none"
                                   : "rigid bodies have no spinning friction without it")})}));
  }
}

std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.c_str();
  for (char* end = nullptr;; at = end) {
    const double value = std::strtod(at, &end);
    if (end == at) return numbers;
    numbers.push_back(value);
  }
}

/// The depth of the innermost point of a shape, where Drake's extent is 1; NaN: not known.
double depth_of(const XmlElement& collision) {
  for (const XmlElement* geometry : collision.children) {
    if (geometry->name != "geometry" && geometry->name != "drake:geometry") continue;
    for (const XmlElement* shape : geometry->children) {
      const auto read = [&](const char* name) {
        std::string text = shape->value(name);
        for (const XmlElement* child : shape->children)
          if (child->name == name) text = child->text;
        const std::vector<double> numbers = numbers_of(text);
        return numbers.empty() ? NAN : *std::min_element(numbers.begin(), numbers.end());
      };
      const std::string& name = shape->name;
      if (name == "sphere" || name == "capsule" || name == "drake:capsule") return read("radius");
      if (name == "box") return read("size") / 2;
      if (name == "cylinder") return std::min(read("radius"), read("length") / 2);
      if (name == "ellipsoid") return read("radii");
    }
  }
  return NAN;
}

void apply_drake(XmlFile& file, RobotFormat format, const std::vector<Wanted>& fingers) {
  for (const auto& [finger, contact] : fingers) {
    const RobotContact& wanted = *contact;
    const bool is_flat = wanted.contact.face.has_value();
    const Foundation foundation =
        is_flat ? Foundation()
                : foundation_with_eccentricity(wanted.contact.radii, wanted.contact.load_N,
                                               wanted.contact.eccentricity_m);
    const double dPdd_N_per_m =
        is_flat ? wanted.contact.normal_stiffness_N_per_m : foundation.normal_stiffness_N_per_m();
    const double stiffness_Pa_per_m =
        is_flat ? dPdd_N_per_m / wanted.contact.face->area_m2 : foundation.stiffness_Pa_per_m;
    const std::string mu = number(wanted.contact.friction_coefficient);
    const double depth_m = wanted.depth_m.value_or(depth_of(*finger));
    if (!(std::isfinite(depth_m) && depth_m > 0))
      throw InputError(finger->where(), "the depth of the fingertip's shape is not known", "",
                       "a sphere, capsule, cylinder, box or ellipsoid, or --depth-mm");
    WantedElement properties = group(
        "drake:proximity_properties",
        {leaf("drake:compliant_hydroelastic", "", "point contact has no torque"),
         value_of(format, "drake:hydroelastic_modulus", number(stiffness_Pa_per_m * depth_m),
                  fmt::format("{}; dP/dd {:.4g} N/mm, the model's {:.4g}", wanted.torque_error,
                              1e-3 * dPdd_N_per_m, 1e-3 * wanted.contact.normal_stiffness_N_per_m)),
         value_of(
             format, "drake:mesh_resolution_hint",
             fmt::format("{:.3g}", is_flat ? wanted.contact.face->width_m / 8 : foundation.b_m / 4),
             "a quarter of the contact's short semi-axis"),
         value_of(format, "drake:mu_static", mu, wanted.force_error),
         value_of(format, "drake:mu_dynamic", mu, wanted.force_error)});
    properties.removed = {"drake:rigid_hydroelastic"};
    file.change(*finger, group("collision", {properties}));
  }
  file.change(file.root(), tag(file.root().name,
                               {{"xmlns:drake", "http://drake.mit.edu", "the elements' prefix"}}));
}

}  // namespace

MujocoSpring mujoco_spring(double normal_stiffness_N_per_m, double mass_kg) {
  MujocoSpring spring;
  const double rest = 1 - spring.impedance;
  spring.stiffness_per_s2 = normal_stiffness_N_per_m * rest / mass_kg;
  spring.damping_per_s = 2 * rest * std::sqrt(normal_stiffness_N_per_m / mass_kg);
  return spring;
}

std::string_view name_of(RobotFormat format) {
  return format == RobotFormat::mjcf ? "MJCF" : format == RobotFormat::urdf ? "URDF" : "SDF";
}

RobotFormat format_of(const XmlFile& file) {
  const std::string& root = file.root().name;
  if (root == "mujoco" || root == "mujocoinclude") return RobotFormat::mjcf;
  if (root == "robot") return RobotFormat::urdf;
  if (root == "sdf") return RobotFormat::sdf;
  throw InputError(file.root().where(), "<" + text::shortened(root) + ">", "",
                   "<mujoco>, <robot> (URDF) or <sdf>");
}

void require_reader(const XmlFile& file, const Simulator& simulator) {
  const std::string name(simulator.name);
  const RobotFormat format = format_of(file);
  const bool is_mjcf = format == RobotFormat::mjcf;
  if (name != "mujoco" && name != "bullet" && name != "gazebo" && name != "drake")
    throw InputError("command line", "--to", name,
                     "mujoco, bullet, gazebo or drake; export --to " + name + " prints the lines");
  if (is_mjcf != (name == "mujoco"))
    throw InputError(file.where(), fmt::format("{} --to {}", name_of(format), name), "",
                     is_mjcf ? "mujoco for MJCF"
                             : "bullet, gazebo or drake for URDF and SDF: MuJoCo reads no "
                               "friction from them, save the model as MJCF first");
}

std::vector<FingerParts> find_fingers(const XmlFile& file, const Mjcf& mjcf,
                                      const std::vector<std::string>& fingers) {
  const RobotFormat format = format_of(file);
  const Parts parts = parts_of(file, format);
  std::vector<FingerParts> found;
  for (const std::string& finger : fingers)
    found.push_back({finger, parts_of_finger(file, format, mjcf, parts, finger)});
  return found;
}

std::vector<std::string> apply_contact(XmlFile& file, const std::vector<std::string>& fingers,
                                       const Simulator& simulator,
                                       const std::vector<RobotContact>& contacts) {
  require_reader(file, simulator);
  const RobotFormat format = format_of(file);
  const Mjcf mjcf(file);
  std::vector<Wanted> wanted;
  std::set<const XmlElement*> known;
  const std::vector<FingerParts> found = find_fingers(file, mjcf, fingers);
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const XmlElement* element : found[i].elements)
      if (known.insert(element).second)
        wanted.push_back({element, &contacts[std::min(i, contacts.size() - 1)]});
  const std::string name(simulator.name);
  if (name == "mujoco") return apply_mujoco(file, mjcf, wanted);
  change_sizes(file, format, wanted);
  if (name == "bullet") apply_bullet(file, format, wanted);
  if (name == "gazebo") apply_gazebo(file, format, wanted);
  if (name == "drake") apply_drake(file, format, wanted);
  return {};
}

}  // namespace softfinger::exporting
