#include "tests/fuzz/target.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace softfinger::fuzz {

std::vector<Target> all_targets() {
  return {case_toml,       scene_toml,        sweep_toml,   surface_stl,   surface_obj,
          layer_msh,       recorded_contacts, fem_problem,  stored_result, error_atlas,
          experiment_toml, measurements,      mask_png,     mesh_3mf,      mesh_assimp,
          robot_import,    robot_xml,         typed_numbers};
}

std::vector<std::string> texts_of(const std::string& folder, const std::string& extension) {
  std::vector<std::string> texts;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != extension) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    texts.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  // The order of a folder is the file system's.
  std::sort(texts.begin(), texts.end());
  return texts;
}

namespace {

std::size_t below(std::size_t end, std::mt19937& generator) {
  return std::uniform_int_distribution<std::size_t>(0, end - 1)(generator);
}

/// Numbers at which readers go wrong.
constexpr const char* kNumbers[] = {"0",
                                    "-1",
                                    "1",
                                    "2",
                                    "3",
                                    "-0.0",
                                    "1e-320",
                                    "1e308",
                                    "1e999",
                                    "nan",
                                    "inf",
                                    "-inf",
                                    "1e-5",
                                    "0.5",
                                    "255",
                                    "256",
                                    "65536",
                                    "100000",
                                    "2147483647",
                                    "2147483648",
                                    "-2147483649",
                                    "4294967296",
                                    "9007199254740993",
                                    "9223372036854775807",
                                    "18446744073709551616",
                                    "0x10",
                                    "1_000",
                                    "+1",
                                    ".5",
                                    "1e"};

/// Begin and end of the words and numbers of a line.
std::vector<std::pair<std::size_t, std::size_t>> words_of(const std::string& line) {
  const auto is_part = [](unsigned char letter) {
    return std::isalnum(letter) || letter == '.' || letter == '-' || letter == '+' || letter == '_';
  };
  std::vector<std::pair<std::size_t, std::size_t>> words;
  for (std::size_t begin = 0; begin < line.size();) {
    std::size_t end = begin;
    while (end < line.size() && is_part(line[end])) ++end;
    if (end > begin) words.emplace_back(begin, end);
    begin = end + 1;
  }
  return words;
}

}  // namespace

std::string change_text(std::string_view text, std::mt19937& generator) {
  std::vector<std::string> lines(1);
  for (const char letter : text)
    if (letter == '\n')
      lines.emplace_back();
    else
      lines.back() += letter;
  const std::size_t from = below(lines.size(), generator), to = below(lines.size(), generator);
  const auto place = [&](std::size_t line) {
    return lines.begin() + static_cast<std::ptrdiff_t>(line);
  };
  const std::string moved = lines[from];
  switch (below(7, generator)) {
    case 0:
      lines.insert(place(to), moved);
      break;
    case 1:
      lines.erase(place(from));
      lines.insert(place(std::min(to, lines.size())), moved);
      break;
    case 2:
      lines.erase(place(from));
      break;
    case 3:
      lines[to] += " " + moved;
      break;
    default: {
      std::string& line = lines[to];
      const auto words = words_of(line);
      if (words.empty()) break;
      const auto [begin, end] = words[below(words.size(), generator)];
      const auto other = words_of(moved);
      const bool copied = !other.empty() && below(3, generator) == 0;
      std::string word = kNumbers[below(std::size(kNumbers), generator)];
      if (copied) {
        const auto [other_begin, other_end] = other[below(other.size(), generator)];
        word = moved.substr(other_begin, other_end - other_begin);
      }
      line.replace(begin, end - begin, word);
    }
  }
  std::string changed;
  for (std::size_t i = 0; i < lines.size(); ++i) changed += (i > 0 ? "\n" : "") + lines[i];
  return changed;
}

}  // namespace softfinger::fuzz
