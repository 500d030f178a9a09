#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "comparisons/exporting/xml_text.h"

namespace softfinger::exporting {

/// Parts of a model in MJCF outside the geom that affect it: defaults, pairs, options. Collected
/// once, so that asking for each geom costs no pass through the file.
class Mjcf {
 public:
  explicit Mjcf(const XmlFile& file);

  /// The element that states an attribute of a geom, a pair or another one with defaults: it
  /// itself, else the default of its class, else of a class around that. Null: none does.
  const XmlElement* source(const XmlElement& element, const char* name) const;
  /// The value there, or empty.
  std::string value(const XmlElement& element, const char* name) const;

  /// The pairs that a geom is in.
  const std::set<const XmlElement*>& pairs(const XmlElement& geom) const;

  /// The last `<option>` that states an attribute counts, and the last `<flag>`. Null: none does.
  const XmlElement* option(const char* element, const char* attribute) const;
  bool states(const char* element, const char* attribute, const char* value) const;

  const std::vector<const XmlElement*>& excludes() const { return excludes_; }
  /// Files that are a part of the model, but not of this tree.
  const std::vector<std::string>& unread() const { return unread_; }

 private:
  using Elements = std::vector<const XmlElement*>;

  /// Defaults of the class that the element names, else of the nearest childclass around it; null:
  /// none.
  const Elements* defaults_of(const XmlElement& element) const;
  const Elements* defaults_around(const XmlElement& of_class) const;

  Elements main_, excludes_, options_;
  std::map<std::string, Elements> classes_;
  std::map<std::string, std::set<const XmlElement*>> pairs_;
  std::vector<std::string> unread_;
};

/// Whether an element lies in the world of an MJCF model, not among its defaults. An included file
/// may have bodies directly under its root.
bool is_in_world(const XmlElement& element);

/// The body of a geom, around the frames that only place it; the root of a file without one.
const XmlElement* body_of(const XmlElement& geom);

}  // namespace softfinger::exporting
