#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// Editing XML files that others wrote. What is not changed keeps its bytes: comments, blanks, the
/// order and the quotes of attributes. tinyxml2 reads the file; the edits are made in its text.
namespace softfinger::exporting {

class XmlFile;

/// An element of the file, and where it lies in the text.
struct XmlElement {
  struct Attribute {
    std::string name, value;
    std::size_t value_begin = 0, value_end = 0;  ///< between the quotes
    char quote = '"';
  };
  std::string name;
  std::string text;  ///< of a leaf, blanks at its ends cut off
  int line = 0;
  std::vector<Attribute> attributes;
  XmlFile* file = nullptr;  ///< that holds its text
  XmlElement* parent = nullptr;
  std::vector<XmlElement*> children;
  std::size_t begin = 0, end = 0;            ///< of the whole element
  std::size_t attributes_end = 0;            ///< where another attribute may be written
  std::size_t content = 0, content_end = 0;  ///< between the tags; equal for `<name/>`
  bool is_self_closing = false;

  /// Null when there is none.
  const Attribute* attribute(const std::string& attribute_name) const;
  /// The attribute's value, or empty.
  std::string value(const std::string& attribute_name) const;
  /// "hand.xml:12"
  std::string where() const;
};

/// Required content of an element; anything else in it stays.
struct WantedElement {
  struct Value {
    std::string name, value;
    std::string effect;  ///< what it does, for the list of changes
  };
  std::string name;
  std::vector<Value> attributes;
  std::string text;    ///< of a leaf; empty: the text does not matter
  std::string effect;  ///< of the text
  std::vector<WantedElement> children;
  std::string
      key;  ///< an attribute that tells elements of this name apart; empty: the first counts
  std::vector<std::string> removed;  ///< children of these names go
};

/// One value that is different from before.
struct XmlChange {
  int line = 0;         ///< of the element in the file that was read
  std::string element;  ///< geom "tip"
  std::string name;     ///< of the attribute, or the path of the new element
  std::string before;   ///< empty: there was none
  std::string after;    ///< empty: removed
  std::string effect;
};

class XmlFile {
 public:
  /// @param where  for messages
  /// @throws InputError for text that is not well-formed, for a DOCTYPE (entities are not read),
  /// and for elements nested deeper than a hundred levels
  XmlFile(std::string text, std::string where);
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;

  const std::string& where() const { return where_; }
  const XmlElement& root() const { return *elements_.front(); }
  /// All elements in the order of the model, the root first: those of an included file stand in
  /// the place of the element that includes it.
  const std::vector<XmlElement*>& elements() const { return elements_; }

  /// Puts the children of another file's root in the place of an element. What is then changed in
  /// them is changed in that file.
  struct Inclusion {
    const XmlElement* element = nullptr;  ///< of this file, or of one that it includes
    std::unique_ptr<XmlFile> file;
  };
  void include(std::vector<Inclusion> inclusions);
  /// This file and those that it includes, in the order in which they were included.
  std::vector<const XmlFile*> files() const;

  /// Gives the element what is wanted of it: its name is not looked at.
  void change(const XmlElement& element, const WantedElement& wanted);

  /// The differences of this file, without those that it includes.
  const std::vector<XmlChange>& changes() const { return changes_; }
  /// Whether this file or one that it includes is different.
  bool has_changes() const;
  /// The file with all changes.
  std::string text() const;

 private:
  struct Edit {
    std::size_t begin = 0, length = 0;
    std::string text;
  };
  void change(const XmlElement& element, const WantedElement& wanted, const std::string& path);
  void set_attribute(const XmlElement& element, const WantedElement::Value& value,
                     const std::string& path);
  void set_text(const XmlElement& element, const WantedElement& wanted, const std::string& path);
  void add_children(const XmlElement& element, const std::vector<const WantedElement*>& children,
                    const std::string& path);
  void note(const XmlElement& element, XmlChange change);

  /// The blanks at the start of the line of a place.
  std::string indentation(std::size_t place) const;

  std::string text_, where_;
  std::vector<std::size_t> line_begins_;
  std::vector<std::unique_ptr<XmlElement>> owned_;  ///< the elements of this text
  std::vector<XmlElement*> elements_;
  std::vector<std::unique_ptr<XmlFile>> included_;
  std::vector<Edit> edits_;
  std::vector<XmlChange> changes_;
};

}  // namespace softfinger::exporting
