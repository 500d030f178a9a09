#include "comparisons/exporting/mjcf.h"

namespace softfinger::exporting {

Mjcf::Mjcf(const XmlFile& file) {
  for (const XmlElement* element : file.elements()) {
    const XmlElement* const parent = element->parent;
    if (element->name == "default") {
      if (parent == &file.root()) main_.push_back(element);
      const std::string name = element->value("class");
      if (!name.empty() && name != "main") classes_[name].push_back(element);
    } else if (parent && parent->name == "contact" && element->name == "pair") {
      for (const char* geom : {"geom1", "geom2"}) pairs_[element->value(geom)].insert(element);
    } else if (parent && parent->name == "contact" && element->name == "exclude") {
      excludes_.push_back(element);
    } else if (element->name == "option" || (parent && parent->name == "option")) {
      options_.push_back(element);
    } else if ((element->name == "include" || element->name == "model") &&
               element->attribute("file")) {
      unread_.push_back(element->value("file"));
    }
  }
}

const XmlElement* Mjcf::source(const XmlElement& element, const char* name) const {
  if (element.attribute(name)) return &element;
  for (const auto* defaults = defaults_of(element); defaults;) {
    for (const XmlElement* of_class : *defaults)
      for (const XmlElement* child : of_class->children)
        if (child->name == element.name && child->attribute(name)) return child;
    defaults = defaults == &main_ ? nullptr : defaults_around(*defaults->front());
  }
  return nullptr;
}

std::string Mjcf::value(const XmlElement& element, const char* name) const {
  const XmlElement* const stating = source(element, name);
  return stating ? stating->value(name) : "";
}

const std::set<const XmlElement*>& Mjcf::pairs(const XmlElement& geom) const {
  static const std::set<const XmlElement*> none;
  const std::string name = geom.value("name");
  const auto found = pairs_.find(name);
  return name.empty() || found == pairs_.end() ? none : found->second;
}

const XmlElement* Mjcf::option(const char* element, const char* attribute) const {
  const XmlElement* last = nullptr;
  for (const XmlElement* option : options_)
    if (option->name == element && option->attribute(attribute)) last = option;
  return last;
}

bool Mjcf::states(const char* element, const char* attribute, const char* value) const {
  const XmlElement* const found = option(element, attribute);
  return found && found->value(attribute) == value;
}

const Mjcf::Elements* Mjcf::defaults_of(const XmlElement& element) const {
  std::string name = element.value("class");
  for (const XmlElement* body = element.parent; body && name.empty(); body = body->parent)
    name = body->value("childclass");
  if (name.empty() || name == "main") return main_.empty() ? nullptr : &main_;
  const auto found = classes_.find(name);
  return found == classes_.end() ? nullptr : &found->second;
}

const Mjcf::Elements* Mjcf::defaults_around(const XmlElement& of_class) const {
  const XmlElement* const around = of_class.parent;
  if (!around || around->name != "default") return nullptr;
  const auto found = classes_.find(around->value("class"));
  return found != classes_.end() && around->parent->name == "default" ? &found->second : &main_;
}

bool is_in_world(const XmlElement& element) {
  const XmlElement* top = &element;
  while (top->parent && top->parent->parent) top = top->parent;
  if (!top->parent) return false;
  return top->name == "worldbody" || top->name == "body" || top->name == "frame" ||
         top->name == "geom";
}

const XmlElement* body_of(const XmlElement& geom) {
  const XmlElement* body = geom.parent;
  while (body->parent && body->name != "body" && body->name != "worldbody") body = body->parent;
  return body;
}

}  // namespace softfinger::exporting
