#include "meshes/io/read_msh.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <limits>
#include <map>
#include <tuple>
#include <type_traits>
#include <utility>

#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

constexpr std::size_t kMostEntities = 1'000'000;
constexpr std::string_view kBlanks = " \t\r\n\f\v";
const char* const kAllowedMsh = "a gmsh file (.msh, format 2.2 or 4.1) that can be read";

// The shapes in gmsh's manual, without those of higher order, which layers do not use.
constexpr MshShape kShapes[] = {{1, "Line 2", 1, 2},
                                {2, "Triangle 3", 2, 3},
                                {3, "Quadrilateral 4", 2, 4},
                                {4, "Tetrahedron 4", 3, 4},
                                {5, "Hexahedron 8", 3, 8},
                                {6, "Prism 6", 3, 6},
                                {7, "Pyramid 5", 3, 5},
                                {8, "Line 3", 1, 3},
                                {9, "Triangle 6", 2, 6},
                                {10, "Quadrilateral 9", 2, 9},
                                {11, "Tetrahedron 10", 3, 10},
                                {12, "Hexahedron 27", 3, 27},
                                {13, "Prism 18", 3, 18},
                                {14, "Pyramid 14", 3, 14},
                                {15, "Point", 0, 1},
                                {16, "Quadrilateral 8", 2, 8},
                                {17, "Hexahedron 20", 3, 20},
                                {18, "Prism 15", 3, 15},
                                {19, "Pyramid 13", 3, 13},
                                {20, "Triangle 9", 2, 9},
                                {21, "Triangle 10", 2, 10},
                                {22, "Triangle 12", 2, 12},
                                {23, "Triangle 15", 2, 15},
                                {24, "Triangle 15", 2, 15},
                                {25, "Triangle 21", 2, 21},
                                {26, "Line 4", 1, 4},
                                {27, "Line 5", 1, 5},
                                {28, "Line 6", 1, 6},
                                {29, "Tetrahedron 20", 3, 20},
                                {30, "Tetrahedron 35", 3, 35},
                                {31, "Tetrahedron 56", 3, 56},
                                {36, "Quadrilateral 16", 2, 16},
                                {37, "Quadrilateral 25", 2, 25},
                                {92, "Hexahedron 64", 3, 64},
                                {93, "Hexahedron 125", 3, 125}};

bool is_control(char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }

/// The text with control characters made visible, so that it can be shown on a terminal.
std::string printable(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown(text.substr(0, kLongest));
  std::replace_if(shown.begin(), shown.end(), is_control, '?');
  return text.size() > kLongest ? shown + "..." : shown;
}

/// Reads the file from begin to end, once. Text and binary files contain the same numbers in the
/// same order.
class Parser {
 public:
  Parser(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  MshFile parse() {
    if (bytes_.size() > kLargestMsh_bytes)
      throw InputError(path_, "file size", std::to_string(bytes_.size()) + " bytes",
                       "at most " + std::to_string(kLargestMsh_bytes) + " bytes");
    read_format();
    bool has_nodes = false, has_elements = false;
    while (bytes_.find_first_not_of(kBlanks, next_) != std::string_view::npos) {
      const std::string_view title = word("section");
      if (title == "$PhysicalNames") {
        read_physical_names();
      } else if (title == "$Entities" && !is_old()) {
        if (has_elements) refuse("section", "$Entities", "before $Elements");
        read_entities();
      } else if (title == "$Nodes") {
        if (std::exchange(has_nodes, true)) refuse("section", "$Nodes", "one of its kind");
        if (is_old())
          read_old_nodes();
        else
          read_nodes();
        sort_nodes();
      } else if (title == "$Elements") {
        if (std::exchange(has_elements, true)) refuse("section", "$Elements", "one of its kind");
        if (!has_nodes) refuse("section", "$Elements", "after $Nodes");
        if (is_old())
          read_old_elements();
        else
          read_elements();
      } else if (title == "$PartitionedEntities") {
        refuse("mesh", "in partitions", "a mesh in one piece");
      } else {
        skip_section(title);
        continue;
      }
      if (word("end of the section") != "$End" + std::string(title.substr(1)))
        refuse("section", printable(title), "its end right after as many entries as it announces");
    }
    if (!has_nodes || !has_elements)
      throw InputError(path_, "section", has_nodes ? "$Elements is missing" : "$Nodes is missing",
                       "a mesh with $Nodes and $Elements");
    return std::move(file_);
  }

 private:
  // --- words, numbers, bytes ---

  [[noreturn]] void refuse(const std::string& field, const std::string& value,
                           const std::string& allowed) const {
    const auto before = bytes_.substr(0, last_);
    throw InputError(
        binary_ ? path_ + " (byte " + std::to_string(last_) + ")"
                : path_ + ":" + std::to_string(1 + std::count(before.begin(), before.end(), '\n')),
        field, value, allowed);
  }
  [[noreturn]] void refuse_end(const char* field) const {
    refuse(field, "missing", "a whole file (is it truncated?)");
  }

  std::size_t left() const { return bytes_.size() - next_; }

  std::string_view word(const char* field) {
    last_ = std::min(bytes_.find_first_not_of(kBlanks, next_), bytes_.size());
    next_ = std::min(bytes_.find_first_of(kBlanks, last_), bytes_.size());
    if (last_ == next_) refuse_end(field);
    return bytes_.substr(last_, next_ - last_);
  }

  std::string_view take(std::size_t count, const char* field) {
    last_ = next_;
    if (count > left()) refuse_end(field);
    next_ += count;
    return bytes_.substr(last_, count);
  }

  /// Skips the end of the line, right after which binary numbers begin.
  void end_line() {
    if (take(1, "end of the line") == "\r") take(1, "end of the line");
    if (bytes_[next_ - 1] != '\n') refuse("line", "goes on", "its end");
  }

  template <class Number>
  Number written_number(const char* field) {
    const std::string_view text = word(field);
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    // A number too small for its type counts as zero: `value` keeps its initial zero.
    const bool tiny = std::is_floating_point_v<Number> && error == std::errc::result_out_of_range &&
                      text.find("e-") != std::string_view::npos;
    if ((error != std::errc() && !tiny) || stop != end)
      refuse(field, printable(text),
             std::is_floating_point_v<Number> ? "a number" : "a whole number in range");
    return value;
  }

  template <class Number>
  Number number(const char* field) {
    if (!binary_) return written_number<Number>(field);
    Number value;
    std::memcpy(&value, take(sizeof value, field).data(), sizeof value);
    return value;
  }

  /// A count of entries that follow. It is refused if the rest of the file is too short for so
  /// many.
  std::size_t checked(const char* field, std::size_t count, std::size_t numbers,
                      std::size_t bytes) const {
    // A number in text takes at least two bytes, a digit and a blank.
    if (count > left() / (binary_ ? bytes : 2 * numbers))
      refuse(field, std::to_string(count), "no more than the file has room for");
    return count;
  }

  /// A node's or an element's number in the file.
  std::size_t tag(const char* field) {
    const auto value = is_old() ? number<std::int32_t>(field)
                                : static_cast<std::int64_t>(number<std::uint64_t>(field));
    if (value <= 0) refuse(field, std::to_string(value), "> 0");
    return static_cast<std::size_t>(value);
  }

  double coordinate() {
    const auto value = number<double>("coordinate");
    if (!std::isfinite(value)) refuse("coordinate", std::to_string(value), "a finite number");
    return value;
  }

  // --- sections of both formats ---

  bool is_old() const { return version_ == "2.2"; }

  void read_format() {
    if (bytes_.empty() || bytes_[0] != '$' || word("$MeshFormat") != "$MeshFormat")
      throw InputError(path_, "file", "no gmsh mesh",
                       "a file that begins with $MeshFormat (.msh, format 2.2 or 4.1)");
    version_ = word("format");
    if (version_ != "2.2" && version_ != "4.1")
      refuse("format", printable(version_),
             "2.2 or 4.1 (gmsh FILE -save -format msh41 -o NEW.msh writes it)");
    const auto kind = word("kind of file");
    if (kind != "0" && kind != "1")
      refuse("kind of file", printable(kind), "0 (text) or 1 (binary)");
    const auto size = word("size of numbers");
    binary_ = kind == "1";
    if (size != "8" && binary_) refuse("size of numbers", printable(size), "8");
    if (binary_) {
      end_line();
      const auto one = number<std::uint32_t>("byte order");
      if (one != 1)
        refuse("byte order", one == 0x01000000 ? "the opposite one" : "damaged",
               "a binary file from a machine of this kind, or a text file");
    }
    if (word("end of the section") != "$EndMeshFormat")
      refuse("section", "$MeshFormat", "three numbers and $EndMeshFormat");
  }

  /// Always text.
  void read_physical_names() {
    const auto count = written_number<std::uint32_t>("number of names");
    for (std::uint32_t i = 0; i < count; ++i) {
      MshFile::PhysicalName group;
      group.dimension = written_number<int>("dimension of a group");
      if (group.dimension < 0 || group.dimension > 3)
        refuse("dimension of a group", std::to_string(group.dimension), "0 to 3");
      group.tag = physical_tag(written_number<int>("group"));
      next_ = std::min(bytes_.find_first_not_of(" \t", next_), bytes_.size());
      last_ = next_;
      const auto end_of_line = std::min(bytes_.find('\n', next_), bytes_.size());
      const auto quoted = bytes_.substr(next_, end_of_line - next_);
      const auto closing = quoted.find('"', 1);
      if (quoted.empty() || quoted[0] != '"' || closing == std::string_view::npos)
        refuse("name of a group", printable(quoted), "a name in quotes, on the line of its number");
      const auto name = quoted.substr(1, closing - 1);
      constexpr std::size_t kLongest = 127;  // gmsh's own limit
      if (name.size() > kLongest || std::any_of(name.begin(), name.end(), is_control))
        refuse("name of a group", printable(name), "at most 127 printable characters");
      group.name = name;
      next_ += closing + 1;
      file_.physical_names.push_back(std::move(group));
    }
  }

  void skip_section(std::string_view title) {
    if (title[0] != '$' || title.substr(0, 4) == "$End")
      refuse("section", printable(title), "a line that begins with $");
    const std::string end = "\n$End" + std::string(title.substr(1));
    for (auto at = bytes_.find(end, next_); at != std::string_view::npos;
         at = bytes_.find(end, at + 1)) {
      const auto behind = at + end.size();
      if (behind < bytes_.size() && kBlanks.find(bytes_[behind]) == kBlanks.npos) continue;
      next_ = behind;
      return;
    }
    refuse("section", printable(title), "one that ends with $End...");
  }

  void reserve_nodes(std::size_t count) {
    if (count > kMostMshNodes)
      refuse("number of nodes", std::to_string(count), "at most " + std::to_string(kMostMshNodes));
    file_.node_tags.reserve(count);
    file_.nodes.reserve(count);
  }

  void reserve_elements(std::size_t count) {
    if (count > kMostMshElements)
      refuse("number of elements", std::to_string(count),
             "at most " + std::to_string(kMostMshElements));
    file_.elements.reserve(count);
  }

  void sort_nodes() {
    places_.reserve(file_.node_tags.size());
    for (const std::size_t node : file_.node_tags)
      places_.emplace_back(node, static_cast<int>(places_.size()));
    std::sort(places_.begin(), places_.end());
    const auto twice =
        std::adjacent_find(places_.begin(), places_.end(),
                           [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twice != places_.end())
      refuse("node " + std::to_string(twice->first), "twice", "a number of its own for each node");
  }

  /// gmsh marks a group's reversed orientation by the sign.
  int physical_tag(int tag) const {
    if (tag == std::numeric_limits<int>::min())
      refuse("group", std::to_string(tag), "a number that can change its sign");
    return std::abs(tag);
  }

  /// @param group  part of the entity's identity in format 2.2 only
  int entity(int dimension, int tag, int group) {
    const auto [entry, is_new] = entity_.emplace(std::make_tuple(dimension, tag, group),
                                                 static_cast<int>(file_.entities.size()));
    if (is_new) {
      if (file_.entities.size() == kMostEntities)
        refuse("number of entities", "more", "at most " + std::to_string(kMostEntities));
      file_.entities.push_back({dimension, tag, {}});
      if (group != 0) file_.entities.back().physical_tags = {group};
    }
    return entry->second;
  }

  const MshShape& shape(int type) const {
    const MshShape* const found = msh_shape(type);
    if (!found) refuse("type of element", std::to_string(type), "one of gmsh's manual");
    return *found;
  }

  /// The element's nodes come next.
  void add_element(std::size_t element, const MshShape& shape, int entity) {
    file_.elements.push_back({element, shape.type, entity, file_.element_nodes.size()});
    for (int i = 0; i < shape.nodes; ++i) {
      const std::size_t node = tag("node of an element");
      const auto found = std::lower_bound(places_.begin(), places_.end(), std::make_pair(node, 0));
      if (found == places_.end() || found->first != node)
        refuse("node of element " + std::to_string(element), std::to_string(node),
               "a number of a node in $Nodes");
      file_.element_nodes.push_back(found->second);
    }
  }

  // --- format 2.2 ---

  void read_old_nodes() {
    const auto count = written_number<std::uint32_t>("number of nodes");
    if (binary_) end_line();
    reserve_nodes(checked("number of nodes", count, 4, sizeof(std::int32_t) + 3 * sizeof(double)));
    for (std::uint32_t i = 0; i < count; ++i) {
      file_.node_tags.push_back(tag("node"));
      const double x = coordinate(), y = coordinate(), z = coordinate();
      file_.nodes.emplace_back(x, y, z);
    }
  }

  void read_old_elements() {
    const std::size_t count = written_number<std::uint32_t>("number of elements");
    if (binary_) end_line();
    reserve_elements(checked("number of elements", count, 4, 2 * sizeof(std::int32_t)));
    while (file_.elements.size() < count) {
      // In a text file each element begins with its number and is a block of its own.
      std::size_t element = binary_ ? 0 : tag("element");
      const MshShape& type = shape(number<int>("type of element"));
      const int block = binary_ ? number<int>("elements of a block") : 1;
      if (block < 1 || static_cast<std::size_t>(block) > count - file_.elements.size())
        refuse("elements of a block", std::to_string(block), "1 to as many as are announced");
      const int tags = number<int>("number of tags");
      if (tags < 0) refuse("number of tags", std::to_string(tags), ">= 0");
      for (int i = 0; i < block; ++i) {
        if (binary_) element = tag("element");
        int group = 0, elementary = 0;
        for (int t = 0; t < tags; ++t) {
          const int value = number<int>("tag of an element");
          if (t == 0) group = physical_tag(value);
          if (t == 1) elementary = value;
        }
        add_element(element, type, entity(type.dimension, elementary, group));
      }
    }
  }

  // --- format 4.1 ---

  /// A size, as the format calls it, of entries that each have some numbers.
  std::size_t count(const char* field, std::size_t numbers, std::size_t bytes) {
    return checked(field, number<std::uint64_t>(field), numbers, bytes);
  }

  void read_entities() {
    if (binary_) end_line();
    std::uint64_t counts[4];
    for (auto& value : counts) value = number<std::uint64_t>("number of entities");
    for (int dimension = 0; dimension <= 3; ++dimension)
      for (std::uint64_t i = 0; i < counts[dimension]; ++i) {
        const int tag = number<int>("entity");
        const std::size_t known = file_.entities.size();
        const int place = entity(dimension, tag, 0);
        if (file_.entities.size() == known)
          refuse("entity", std::to_string(tag), "a number of its own in its dimension");
        // A point's place, or the corners of a box.
        for (int x = 0; x < (dimension == 0 ? 3 : 6); ++x) number<double>("extent of an entity");
        const std::size_t groups = count("groups of an entity", 1, sizeof(int));
        auto& tags = file_.entities[static_cast<std::size_t>(place)].physical_tags;
        for (std::size_t g = 0; g < groups; ++g) tags.push_back(physical_tag(number<int>("group")));
        if (dimension == 0) continue;
        const std::size_t bounds = count("bounds of an entity", 1, sizeof(int));
        for (std::size_t b = 0; b < bounds; ++b) number<int>("bound of an entity");
      }
  }

  /// The numbers with which the sections of nodes and of elements begin.
  struct Blocks {
    std::size_t blocks, total;
  };
  Blocks read_blocks(const char* field, std::size_t numbers, std::size_t bytes) {
    if (binary_) end_line();
    const std::size_t blocks =
        count("number of blocks", 4, 3 * sizeof(int) + sizeof(std::uint64_t));
    const std::size_t total = count(field, numbers, bytes);
    number<std::uint64_t>("smallest number");
    number<std::uint64_t>("largest number");
    return {blocks, total};
  }

  int dimension() {
    const int value = number<int>("dimension of a block");
    if (value < 0 || value > 3) refuse("dimension of a block", std::to_string(value), "0 to 3");
    return value;
  }

  void require_total(const char* field, std::size_t have, std::size_t total, bool at_end) const {
    if (at_end ? have != total : have > total)
      refuse(field, std::to_string(have), "the announced " + std::to_string(total));
  }

  void read_nodes() {
    const char* const field = "number of nodes";
    const std::size_t bytes = sizeof(std::uint64_t) + 3 * sizeof(double);
    const auto [blocks, total] = read_blocks(field, 4, bytes);
    reserve_nodes(total);
    for (std::size_t b = 0; b < blocks; ++b) {
      const int entity_dimension = dimension();
      number<int>("entity");
      const bool parametric = number<int>("parametric") != 0;
      const std::size_t here = count(field, 4, bytes);
      require_total(field, file_.nodes.size() + here, total, false);
      for (std::size_t i = 0; i < here; ++i) file_.node_tags.push_back(tag("node"));
      for (std::size_t i = 0; i < here; ++i) {
        const double x = coordinate(), y = coordinate(), z = coordinate();
        file_.nodes.emplace_back(x, y, z);
        // The place on the entity follows, a number for each of its dimensions.
        for (int p = 0; parametric && p < entity_dimension; ++p) number<double>("parameter");
      }
    }
    require_total(field, file_.nodes.size(), total, true);
  }

  void read_elements() {
    const char* const field = "number of elements";
    const std::size_t bytes = 2 * sizeof(std::uint64_t);
    const auto [blocks, total] = read_blocks(field, 2, bytes);
    reserve_elements(total);
    for (std::size_t b = 0; b < blocks; ++b) {
      const int entity_dimension = dimension();
      const int place = entity(entity_dimension, number<int>("entity"), 0);
      const MshShape& type = shape(number<int>("type of element"));
      if (type.dimension != entity_dimension)
        refuse("type of element", type.name,
               "a shape of dimension " + std::to_string(entity_dimension));
      const std::size_t here = count(field, 2, bytes);
      require_total(field, file_.elements.size() + here, total, false);
      for (std::size_t i = 0; i < here; ++i) {
        const std::size_t element = tag("element");
        add_element(element, type, place);
      }
    }
    require_total(field, file_.elements.size(), total, true);
  }

  std::string_view bytes_;
  std::string path_;
  std::size_t next_ = 0, last_ = 0;  ///< what is read next; where the last word or number began
  std::string_view version_;
  bool binary_ = false;
  MshFile file_;
  std::vector<std::pair<std::size_t, int>> places_;  ///< of the nodes, by their numbers
  std::map<std::tuple<int, int, int>, int> entity_;  ///< by dimension, tag and group
};

}  // namespace

const MshShape* msh_shape(int type) {
  const auto found = std::find_if(std::begin(kShapes), std::end(kShapes),
                                  [&](const MshShape& shape) { return shape.type == type; });
  return found == std::end(kShapes) ? nullptr : found;
}

MshFile parse_msh(std::string_view bytes, const std::string& path) {
  return Parser(bytes, path).parse();
}

MshFile read_msh(const std::string& path) {
  return parse_msh(read_whole_file(path, "mesh of the layer", kAllowedMsh, kLargestMsh_bytes),
                   path);
}

}  // namespace softfinger::meshes
