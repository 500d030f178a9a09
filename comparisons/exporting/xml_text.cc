#include "comparisons/exporting/xml_text.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <map>
#include <set>
#include <string_view>

#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::exporting {
namespace {

constexpr const char* kBlanks = " \t\r\n";

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  return begin == std::string::npos
             ? ""
             : text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

/// Escapes text that stands between double quotes, or between tags.
std::string escaped(const std::string& value) {
  std::string text;
  for (const char letter : value) switch (letter) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '>':
        text += "&gt;";
        break;
      case '"':
        text += "&quot;";
        break;
      case '\'':
        text += "&apos;";
        break;
      default:
        text += letter;
    }
  return text;
}

/// Finds the places of the elements in a text that tinyxml2 has accepted.
class Places {
 public:
  explicit Places(const std::string& text) : text_(text) {}

  /// Empty when the text is not understood.
  std::vector<std::unique_ptr<XmlElement>> find() {
    std::vector<XmlElement*> open;
    while ((at_ = text_.find('<', at_)) != std::string::npos) {
      if (skips("<!--", "-->") || skips("<![CDATA[", "]]>") || skips("<?", "?>")) continue;
      if (text_.compare(at_, 2, "</") == 0) {
        const std::size_t end = text_.find('>', at_);
        if (open.empty() || end == std::string::npos) return {};
        open.back()->content_end = at_;
        open.back()->end = at_ = end + 1;
        open.pop_back();
        continue;
      }
      auto element = std::make_unique<XmlElement>();
      if (!read_tag(*element)) return {};
      if (!open.empty()) {
        element->parent = open.back();
        open.back()->children.push_back(element.get());
      }
      if (!element->is_self_closing) open.push_back(element.get());
      elements_.push_back(std::move(element));
    }
    return open.empty() ? std::move(elements_) : std::vector<std::unique_ptr<XmlElement>>();
  }

 private:
  bool skips(const char* start, const char* stop) {
    if (text_.compare(at_, std::strlen(start), start) != 0) return false;
    const std::size_t end = text_.find(stop, at_ + std::strlen(start));
    at_ = end == std::string::npos ? text_.size() : end + std::strlen(stop);
    return true;
  }

  std::string word() {
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(" \t\r\n=/>", at_), text_.size());
    return text_.substr(begin, at_ - begin);
  }

  void skip_blanks() { at_ = std::min(text_.find_first_not_of(kBlanks, at_), text_.size()); }

  bool read_tag(XmlElement& element) {
    element.begin = at_++;
    element.name = word();
    element.attributes_end = at_;
    for (skip_blanks(); at_ < text_.size(); skip_blanks()) {
      if (text_[at_] == '>' || text_.compare(at_, 2, "/>") == 0) {
        element.is_self_closing = text_[at_] == '/';
        at_ += element.is_self_closing ? 2 : 1;
        element.content = element.content_end = element.end = at_;
        return true;
      }
      XmlElement::Attribute attribute;
      attribute.name = word();
      skip_blanks();
      if (attribute.name.empty() || at_ >= text_.size() || text_[at_] != '=') return false;
      ++at_;
      skip_blanks();
      if (at_ >= text_.size()) return false;
      attribute.quote = text_[at_];
      attribute.value_begin = at_ + 1;
      attribute.value_end = text_.find(attribute.quote, at_ + 1);
      if (attribute.value_end == std::string::npos) return false;
      at_ = attribute.value_end + 1;
      element.attributes_end = at_;
      element.attributes.push_back(attribute);
    }
    return false;
  }

  const std::string& text_;
  std::size_t at_ = 0;
  std::vector<std::unique_ptr<XmlElement>> elements_;
};

/// Takes lines, values and texts from tinyxml2; false where it reads other elements or
/// attributes than we do.
bool adopt(const tinyxml2::XMLElement* read, std::vector<std::unique_ptr<XmlElement>>& elements) {
  std::size_t at = 0;
  // In the order of the file, without recursion.
  for (const tinyxml2::XMLElement* node = read; node;) {
    if (at >= elements.size() || elements[at]->name != node->Name()) return false;
    XmlElement& element = *elements[at++];
    element.line = node->GetLineNum();
    element.text = trimmed(node->GetText() ? node->GetText() : "");
    for (XmlElement::Attribute& attribute : element.attributes) {
      const char* const value = node->Attribute(attribute.name.c_str());
      if (!value) return false;
      attribute.value = value;
    }
    if (node->FirstChildElement()) {
      node = node->FirstChildElement();
      continue;
    }
    while (node && node != read && !node->NextSiblingElement())
      node = node->Parent() ? node->Parent()->ToElement() : nullptr;
    node = !node || node == read ? nullptr : node->NextSiblingElement();
  }
  return at == elements.size();
}

std::string rendered(const WantedElement& wanted, const std::string& indent) {
  std::string tag = indent + "<" + wanted.name;
  for (const auto& value : wanted.attributes)
    tag += fmt::format(" {}=\"{}\"", value.name, escaped(value.value));
  if (wanted.children.empty())
    return tag +
           (wanted.text.empty() ? "/>\n" : ">" + escaped(wanted.text) + "</" + wanted.name + ">\n");
  tag += ">\n";
  for (const WantedElement& child : wanted.children) tag += rendered(child, indent + "  ");
  return tag + indent + "</" + wanted.name + ">\n";
}

std::string joined_path(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "/" + name;
}

/// Finds the children of an element that are wanted: by their key, each of which may be asked for
/// once, or the first of a name.
class Children {
 public:
  explicit Children(const XmlElement& element) : element_(element) {}

  const XmlElement* find(const WantedElement& wanted) {
    const auto [place, is_new] = of_key_.try_emplace({wanted.name, wanted.key});
    auto& found = place->second;
    if (is_new)
      for (const XmlElement* child : element_.children)
        if (child->name == wanted.name) found.emplace(child->value(wanted.key), child);
    std::string value;
    for (const auto& attribute : wanted.attributes)
      if (attribute.name == wanted.key) value = attribute.value;
    const auto child = wanted.key.empty() ? found.find("") : found.find(value);
    return child == found.end() ? nullptr : child->second;
  }

 private:
  const XmlElement& element_;
  std::map<std::pair<std::string, std::string>, std::map<std::string, const XmlElement*>> of_key_;
};

}  // namespace

const XmlElement::Attribute* XmlElement::attribute(const std::string& attribute_name) const {
  for (const Attribute& attribute : attributes)
    if (attribute.name == attribute_name) return &attribute;
  return nullptr;
}

std::string XmlElement::value(const std::string& attribute_name) const {
  const Attribute* const found = attribute(attribute_name);
  return found ? found->value : "";
}

std::string XmlElement::where() const { return fmt::format("{}:{}", file->where(), line); }

XmlFile::XmlFile(std::string text, std::string where)
    : text_(std::move(text)), where_(std::move(where)) {
  // A text that a program wrote with the zero at its end is read by other readers, too.
  const std::string_view xml = std::string_view(text_).substr(0, text_.find_last_not_of('\0') + 1);
  if (xml.find('\0') != std::string_view::npos)
    throw InputError(where_, "a byte of zero", "", "XML text");
  // tinyxml2 expands no entities; a file that declares some would lose them.
  if (text_.find("<!DOCTYPE") != std::string::npos || text_.find("<!ENTITY") != std::string::npos)
    throw InputError(where_, "<!DOCTYPE>", "", "a file without one: entities are not read");
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) {
    // "XML_ELEMENT_DEPTH_EXCEEDED" and the like, of no user.
    std::string reason = document.ErrorName();
    std::replace(reason.begin(), reason.end(), '_', ' ');
    std::transform(reason.begin(), reason.end(), reason.begin(),
                   [](unsigned char letter) { return char(std::tolower(letter)); });
    throw InputError(fmt::format("{}:{}", where_, document.ErrorLineNum()),
                     reason.substr(reason.find(' ') + 1), "", "well-formed XML");
  }
  line_begins_ = {0};
  for (std::size_t at = 0; (at = text_.find('\n', at)) != std::string::npos;)
    line_begins_.push_back(++at);
  owned_ = Places(text_).find();
  if (owned_.empty() || !document.RootElement() || !adopt(document.RootElement(), owned_))
    throw InputError(where_, "the text is not understood", "", "XML with one root element");
  for (const auto& element : owned_) {
    element->file = this;
    elements_.push_back(element.get());
  }
}

void XmlFile::include(std::vector<Inclusion> inclusions) {
  std::map<const XmlElement*, XmlFile*> file_of;
  for (Inclusion& inclusion : inclusions) {
    file_of[inclusion.element] = inclusion.file.get();
    included_.push_back(std::move(inclusion.file));
  }
  // An included root is left out: its children, and what they include, go to the outermost parent.
  std::set<const XmlElement*> roots;
  for (const auto& file : included_) roots.insert(file->owned_.front().get());
  std::set<XmlElement*> parents;
  for (const auto& [element, file] : file_of)
    if (roots.count(element->parent) == 0) parents.insert(element->parent);
  for (XmlElement* parent : parents) {
    std::vector<XmlElement*> children;
    // Children are stacked in reverse order, so that the first one is taken next.
    std::vector<XmlElement*> open(parent->children.rbegin(), parent->children.rend());
    while (!open.empty()) {
      XmlElement* const child = open.back();
      open.pop_back();
      const auto found = file_of.find(child);
      if (found == file_of.end()) {
        child->parent = parent;
        children.push_back(child);
        continue;
      }
      const auto& inner = found->second->elements_.front()->children;
      open.insert(open.end(), inner.rbegin(), inner.rend());
    }
    parent->children = std::move(children);
  }
  elements_.clear();
  std::vector<XmlElement*> open = {owned_.front().get()};
  while (!open.empty()) {
    XmlElement* const element = open.back();
    open.pop_back();
    elements_.push_back(element);
    open.insert(open.end(), element->children.rbegin(), element->children.rend());
  }
}

std::vector<const XmlFile*> XmlFile::files() const {
  std::vector<const XmlFile*> files = {this};
  for (const auto& file : included_) files.push_back(file.get());
  return files;
}

bool XmlFile::has_changes() const {
  const std::vector<const XmlFile*> all = files();
  return std::any_of(all.begin(), all.end(),
                     [](const XmlFile* file) { return !file->changes_.empty(); });
}

std::string XmlFile::indentation(std::size_t place) const {
  const std::size_t begin =
      *std::prev(std::upper_bound(line_begins_.begin(), line_begins_.end(), place));
  const std::size_t end = text_.find_first_not_of(" \t", begin);
  return text_.substr(begin, std::min(end, place) - begin);
}

void XmlFile::note(const XmlElement& element, XmlChange change) {
  const XmlElement* named = &element;
  while (named->parent && named->value("name").empty() && named->value("reference").empty())
    named = named->parent;
  const std::string name = named->value("name") + named->value("reference");
  const XmlElement& shown = named->parent || !name.empty() ? *named : element;
  change.line = element.line;
  change.element = shown.name + (name.empty() ? "" : " \"" + text::shortened(name) + "\"");
  changes_.push_back(std::move(change));
}

void XmlFile::set_attribute(const XmlElement& element, const WantedElement::Value& value,
                            const std::string& path) {
  const XmlElement::Attribute* const attribute = element.attribute(value.name);
  if (attribute && attribute->value == value.value) return;
  if (attribute)
    edits_.push_back({attribute->value_begin, attribute->value_end - attribute->value_begin,
                      escaped(value.value)});
  else
    edits_.push_back(
        {element.attributes_end, 0, fmt::format(" {}=\"{}\"", value.name, escaped(value.value))});
  note(element, {0, "", joined_path(path, value.name), attribute ? attribute->value : "",
                 value.value, value.effect});
}

void XmlFile::set_text(const XmlElement& element, const WantedElement& wanted,
                       const std::string& path) {
  // URDF's extensions may have the value in an attribute.
  if (element.attribute("value")) {
    set_attribute(element, {"value", wanted.text, wanted.effect}, path);
    return;
  }
  if (element.text == wanted.text) return;
  if (element.is_self_closing)
    edits_.push_back(
        {element.content - 2, 2, ">" + escaped(wanted.text) + "</" + element.name + ">"});
  else
    edits_.push_back(
        {element.content, element.content_end - element.content, escaped(wanted.text)});
  note(element, {0, "", path, element.text, wanted.text, wanted.effect});
}

void XmlFile::add_children(const XmlElement& element,
                           const std::vector<const WantedElement*>& children,
                           const std::string& path) {
  if (children.empty()) return;
  const std::string indent = indentation(element.begin);
  std::string block;
  for (const WantedElement* child : children) {
    block += rendered(*child, indent + "  ");
    // A list of the new element's leaves, in the order of the file.
    std::vector<std::pair<const WantedElement*, std::string>> rest = {
        {child, joined_path(path, child->name)}};
    while (!rest.empty()) {
      const auto [wanted, here] = rest.back();
      rest.pop_back();
      for (const auto& value : wanted->attributes)
        note(element, {0, "", joined_path(here, value.name), "", value.value, value.effect});
      if (wanted->children.empty() && wanted->attributes.empty())
        note(element,
             {0, "", here, "", wanted->text.empty() ? "(set)" : wanted->text, wanted->effect});
      for (auto grandchild = wanted->children.rbegin(); grandchild != wanted->children.rend();
           ++grandchild)
        rest.push_back({&*grandchild, joined_path(here, grandchild->name)});
    }
  }
  if (element.is_self_closing) {
    edits_.push_back({element.content - 2, 2, ">\n" + block + indent + "</" + element.name + ">"});
    return;
  }
  // On lines of their own before the closing tag, which keeps its own.
  const std::size_t close = element.content_end;
  const std::size_t line =
      *std::prev(std::upper_bound(line_begins_.begin(), line_begins_.end(), close));
  const bool is_alone =
      line >= element.content && line > 0 && text_.find_first_not_of(" \t", line) == close;
  if (is_alone)
    edits_.push_back({line, 0, block});
  else
    edits_.push_back({close, 0, "\n" + block + indent});
}

void XmlFile::change(const XmlElement& element, const WantedElement& wanted) {
  element.file->change(element, wanted, "");
}

void XmlFile::change(const XmlElement& element, const WantedElement& wanted,
                     const std::string& path) {
  for (const auto& value : wanted.attributes) set_attribute(element, value, path);
  if (!wanted.text.empty()) set_text(element, wanted, path);
  for (const XmlElement* child : element.children)
    if (std::find(wanted.removed.begin(), wanted.removed.end(), child->name) !=
        wanted.removed.end()) {
      edits_.push_back({child->begin, child->end - child->begin, ""});
      note(element, {0, "", joined_path(path, child->name),
                     child->text.empty() ? "(set)" : child->text, "", ""});
    }
  std::vector<const WantedElement*> missing;
  Children children(element);
  for (const WantedElement& child : wanted.children) {
    if (const XmlElement* const found = children.find(child))
      found->file->change(*found, child, joined_path(path, child.name));
    else
      missing.push_back(&child);
  }
  add_children(element, missing, path);
}

std::string XmlFile::text() const {
  std::vector<const Edit*> edits;
  for (const Edit& edit : edits_) edits.push_back(&edit);
  std::stable_sort(edits.begin(), edits.end(),
                   [](const Edit* one, const Edit* other) { return one->begin < other->begin; });
  std::string changed;
  std::size_t at = 0;
  for (const Edit* edit : edits) {
    changed += text_.substr(at, edit->begin - at) + edit->text;
    at = edit->begin + edit->length;
  }
  return changed + text_.substr(at);
}

}  // namespace softfinger::exporting
