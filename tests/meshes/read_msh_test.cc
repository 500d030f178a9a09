// gmsh's files, formats 2.2 and 4.1, text and binary: what is in them, and one clear refusal for
// everything else.

#include "meshes/io/read_msh.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

/// A cube of one hexahedron, the volume "layer", with its top face, the surface "contact". Numbers
/// can be changed one by one.
struct Cube {
  bool old = false, binary = false;
  std::uint64_t nodes = 8, elements = 2;  ///< as announced
  std::uint64_t first_node = 11, corner = 11;
  int hexahedron = 5;
  double x = 1;
  std::string before;  ///< further sections

  std::string text() const {
    std::ostringstream out;
    const auto number = [&](auto value) {
      if (binary) {
        out.write(reinterpret_cast<const char*>(&value), sizeof value);
      } else {
        out.precision(17);
        out << value << ' ';
      }
    };
    const auto size = [&](std::uint64_t value) {
      if (old)
        number(static_cast<std::int32_t>(value));
      else
        number(value);
    };
    const auto point = [&](int i) {
      number(i % 4 == 1 || i % 4 == 2 ? x : 0.0);
      number(i % 4 > 1 ? 1.0 : 0.0);
      number(i > 3 ? 1.0 : 0.0);
    };
    const auto end = [&](const char* section) { out << "\n$End" << section << "\n"; };
    out << "$MeshFormat\n" << (old ? "2.2 " : "4.1 ") << binary << " 8\n";
    if (binary) number(1);
    end("MeshFormat");
    out << before << "$PhysicalNames\n2\n2 7 \"contact\"\n3 9 \"the layer\"\n$EndPhysicalNames\n";
    if (!old) {
      out << "$Entities\n";
      for (const std::uint64_t count : {0, 0, 1, 1}) size(count);
      for (const int dimension : {2, 3}) {
        number(dimension == 2 ? 4 : 5);
        for (int i = 0; i < 6; ++i) number(0.5 * i);
        size(1);
        number(dimension == 2 ? -7 : 9);
        size(1);
        number(-3);
      }
      end("Entities");
    }
    out << "$Nodes\n";
    if (old) {
      out << nodes << "\n";
      for (int i = 0; i < 8; ++i) {
        size(i == 0 ? first_node : 11 + static_cast<std::uint64_t>(i));
        point(i);
      }
    } else {
      for (const std::uint64_t value :
           {std::uint64_t{2}, nodes, std::uint64_t{11}, std::uint64_t{18}})
        size(value);
      for (const int block : {0, 1}) {  // those of the surface have a place on it
        const int dimension = block == 0 ? 3 : 2;
        number(dimension);
        number(dimension == 2 ? 4 : 5);
        number(block);
        size(4);
        for (int i = 4 * block; i < 4 * block + 4; ++i)
          size(i == 0 ? first_node : 11 + static_cast<std::uint64_t>(i));
        for (int i = 4 * block; i < 4 * block + 4; ++i) {
          point(i);
          if (block == 1) number(0.25), number(0.75);
        }
      }
    }
    end("Nodes");
    out << "$Elements\n";
    if (old)
      out << elements << "\n";
    else
      for (const std::uint64_t value :
           {std::uint64_t{2}, elements, std::uint64_t{1}, std::uint64_t{2}})
        size(value);
    for (const int block : {0, 1}) {
      const int type = block == 0 ? 3 : hexahedron, group = block == 0 ? 7 : 9,
                entity = block == 0 ? 4 : 5;
      const auto element = static_cast<std::uint64_t>(block + 1);
      if (old && binary) {
        for (const int value : {type, 1, 2}) number(value);
        size(element);
      } else if (old) {
        size(element);
        for (const int value : {type, 2}) number(value);
      } else {
        for (const int value : {block + 2, entity, type}) number(value);
        size(1);
        size(element);
      }
      if (old)
        for (const int value : {group, entity}) number(value);
      for (std::uint64_t i = block == 0 ? 4 : 0; i < 8; ++i)
        size(block == 1 && i == 0 ? corner : 11 + i);
    }
    end("Elements");
    return out.str();
  }
};

class ReadMsh : public testing::TestWithParam<std::pair<bool, bool>> {
 protected:
  ReadMsh() { std::tie(cube.old, cube.binary) = GetParam(); }

  static std::string error(const std::string& bytes) {
    try {
      parse_msh(bytes, "cube.msh");
    } catch (const InputError& e) {
      const std::string line = e.what();
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      EXPECT_EQ(line.find("cube.msh"), 0u) << line;
      EXPECT_FALSE(e.allowed().empty()) << line;
      return line;
    }
    return "nothing was thrown";
  }
  /// @param value  "field = value" in the message
  static void expect_error(const std::string& value, const Cube& changed) {
    const std::string line = error(changed.text());
    EXPECT_NE(line.find(value), std::string::npos) << line;
  }

  Cube cube;
};
INSTANTIATE_TEST_SUITE_P(Formats, ReadMsh,
                         testing::Values(std::pair{true, false}, std::pair{true, true},
                                         std::pair{false, false}, std::pair{false, true}),
                         [](const auto& format) {
                           return std::string(format.param.first ? "Format2" : "Format4") +
                                  (format.param.second ? "Binary" : "Text");
                         });

TEST_P(ReadMsh, FindsNodesElementsAndGroups) {
  cube.before = "$Comments\n$Nodes\nof no mesh\n$EndCommentsNot\n$EndComments\n";
  const MshFile file = parse_msh(cube.text(), "cube.msh");
  ASSERT_EQ(file.nodes.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(file.node_tags[i], 11 + i);
    EXPECT_EQ(file.nodes[i], Eigen::Vector3d(i % 4 == 1 || i % 4 == 2, i % 4 > 1, i > 3));
  }
  ASSERT_EQ(file.elements.size(), 2u);
  for (const std::size_t e : {0, 1}) {
    const auto& element = file.elements[e];
    const auto& entity = file.entities[static_cast<std::size_t>(element.entity)];
    EXPECT_EQ(element.tag, e + 1);
    EXPECT_EQ(element.type, e == 0 ? 3 : 5);
    EXPECT_EQ(entity.dimension, e == 0 ? 2 : 3);
    EXPECT_EQ(entity.tag, e == 0 ? 4 : 5);
    // The sign of a group's number is the orientation.
    EXPECT_EQ(entity.physical_tags, std::vector<int>{e == 0 ? 7 : 9});
  }
  EXPECT_EQ(file.element_nodes, (std::vector<int>{4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7}));
  ASSERT_EQ(file.physical_names.size(), 2u);
  EXPECT_EQ(file.physical_names[1].dimension, 3);
  EXPECT_EQ(file.physical_names[1].tag, 9);
  EXPECT_EQ(file.physical_names[1].name, "the layer");
}

TEST_P(ReadMsh, RefusesCountsBeyondTheFile) {
  for (const std::uint64_t count : {9ull, 1000ull, 100'000'000ull, 2'147'483'647ull}) {
    Cube changed = cube;
    changed.nodes = count;
    EXPECT_NE(error(changed.text()), "nothing was thrown") << count;
    changed = cube;
    changed.elements = count;
    EXPECT_NE(error(changed.text()), "nothing was thrown") << count;
  }
  if (!cube.old) {
    cube.nodes = ~0ull;
    expect_error("number of nodes = 18446744073709551615: allowed: no more than", cube);
  }
}

TEST_P(ReadMsh, RefusesIndicesOfNothingAndNodesTwice) {
  Cube changed = cube;
  changed.corner = 19;
  expect_error("node of element 2 = 19", changed);
  changed.corner = 0;
  expect_error("node of an element = 0", changed);
  changed = cube;
  changed.first_node = 12;
  expect_error("node 12 = twice", changed);
  changed = cube;
  changed.hexahedron = 1234;
  expect_error("type of element = 1234", changed);
}

TEST_P(ReadMsh, RefusesNumbersThatAreNotFinite) {
  for (const double x : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    cube.x = x;
    expect_error("coordinate = ", cube);
  }
}

TEST_P(ReadMsh, RefusesAMeshInPartitions) {
  cube.before = "$PartitionedEntities\n2\n$EndPartitionedEntities\n";
  expect_error("in partitions", cube);
}

TEST_P(ReadMsh, SurvivesEveryFileThatEndsEarlyAndEveryDamagedByte) {
  const std::string whole = cube.text();
  const std::size_t last_word = whole.rfind("$EndElements") + std::strlen("$EndElements");
  for (std::size_t size = 0; size < last_word; ++size)
    EXPECT_NE(error(whole.substr(0, size)), "nothing was thrown") << size;
  int refused = 0;
  for (std::size_t i = 0; i < whole.size(); ++i)
    for (const char byte : {'\0', '\xff', '-', '9', ' ', '\x80'}) {
      std::string damaged = whole;
      damaged[i] = byte;
      refused += error(damaged) != "nothing was thrown";  // and nothing else happens
    }
  EXPECT_GT(refused, 0);
}

TEST_P(ReadMsh, RefusesWhatNoTerminalShouldShow) {
  std::string text = cube.text();
  text.replace(text.find("contact"), 7, "con\x1b[2J");
  const std::string line = error(text);
  EXPECT_NE(line.find("name of a group = con?[2J"), std::string::npos) << line;
}

TEST(ReadMshFile, RefusesWhatDoesNotBeginAsAGmshFile) {
  const std::string good = Cube().text();
  for (const std::string& bytes :
       {std::string(), std::string("$MeshFormat"), std::string("$MeshFormatter\n4.1 0 8\n"),
        "\n" + good, " " + good, std::string("SystemCall \"touch ran\";\n"), "//\n" + good,
        std::string("$NOD\n1\n1 0 0 0\n$ENDNOD\n")}) {
    try {
      parse_msh(bytes, "layer.msh");
      ADD_FAILURE() << "accepted: " << bytes.substr(0, 40);
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find("layer.msh"), 0u) << e.what();
    }
  }
}

TEST(ReadMshFile, SaysWhichFormatsItTakes) {
  const auto message = [](std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    try {
      parse_msh(text, "layer.msh");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("nothing was thrown");
  };
  const std::string text = Cube().text();
  EXPECT_EQ(message(text, "4.1 0", "4 0").find("layer.msh:2: format = 4: allowed: 2.2 or 4.1"), 0u);
  EXPECT_EQ(message(text, "4.1 0", "4.1 2").find("layer.msh:2: kind of file = 2"), 0u);
  Cube binary;
  binary.binary = true;
  const std::string one("\1\0\0\0", 4), swapped("\0\0\0\1", 4);
  EXPECT_NE(message(binary.text(), one, swapped).find("byte order = the opposite one"),
            std::string::npos);
  EXPECT_NE(message(text, "$Nodes", "$Notes").find("$End"), std::string::npos);
}

TEST(ReadMshFile, TakesNoMoreNodesThanItsLimit) {
  try {
    parse_msh("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(kMostMshNodes + 1) +
                  "\n" + std::string(10 * kMostMshNodes, ' '),
              "layer.msh");
    ADD_FAILURE() << "accepted";
  } catch (const InputError& e) {
    EXPECT_EQ(e.allowed(), "at most 20000000");
  }
}

TEST(ReadMshFile, NeverWaitsForAPipe) {
  const std::string path =
      std::filesystem::temp_directory_path() / ("softfinger_pipe_" + std::to_string(getpid()));
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  try {
    read_msh(path);
    ADD_FAILURE() << "read from a pipe";
  } catch (const InputError& e) {
    EXPECT_EQ(e.value(), "a pipe");
  }
  std::filesystem::remove(path);
}

TEST(ReadMshFile, RefusesAFileBeyondItsLimit) {
  const std::string path =
      std::filesystem::temp_directory_path() / ("softfinger_large_" + std::to_string(getpid()));
  std::ofstream(path) << "$MeshFormat\n";
  std::filesystem::resize_file(path, kLargestMsh_bytes + 1);  // takes no room on the disk
  try {
    read_msh(path);
    ADD_FAILURE() << "accepted";
  } catch (const InputError& e) {
    EXPECT_EQ(e.field(), "file size");
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace softfinger::meshes
