// The commands of README.md do what a reader expects of a command: they run.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "meshes/io/read_surface.h"
#include "tests/comparisons/run_program.h"
#include "tests/meshes/triangulated_ellipsoid.h"

namespace softfinger {
namespace {

/// The fenced blocks of one language.
std::vector<std::string> blocks(const std::string& text, const std::string& language) {
  std::vector<std::string> found;
  const std::string opening = "```" + language + "\n";
  for (std::size_t at = text.find(opening); at != std::string::npos; at = text.find(opening, at)) {
    at += opening.size();
    const std::size_t end = text.find("```", at);
    found.push_back(text.substr(at, end - at));
    at = end;
  }
  return found;
}

/// The words of each command of `softfinger` itself, without the comment.
std::vector<std::vector<std::string>> commands(const std::string& text) {
  std::vector<std::vector<std::string>> found;
  for (const std::string& block : blocks(text, "sh"))
    for (std::string line : tests::lines(block)) {
      line = line.substr(0, line.find('#'));
      std::vector<std::string> words;
      const std::regex word("[^ ]+");
      for (std::sregex_iterator i(line.begin(), line.end(), word), none; i != none; ++i)
        words.push_back(i->str());
      if (words.empty() || words[0] != "softfinger") continue;
      words.erase(words.begin());
      found.push_back(words);
    }
  return found;
}

TEST(Readme, CommandsRun) {
  const std::string readme = tests::file_text(SOFTFINGER_README);
  tests::TemporaryFolder folder;
  std::string my_finger;
  for (const std::string& block : blocks(readme, "toml"))
    if (block.find("id = \"my_finger\"") == 0) my_finger = block;
  ASSERT_FALSE(my_finger.empty());
  folder.write("my_finger.toml", my_finger);
  // Any fingertip with a surface at the point of the samples.
  meshes::write_stl_mm(
      meshes::triangulated_ellipsoid({12e-3, 7e-3, 14e-3}, Eigen::Vector3d::Zero(), 32),
      (folder.path() / "tip.stl").string());
  std::set<std::string> run;
  for (const std::vector<std::string>& words : commands(readme)) {
    // Its mesh is made by gmsh, which is not everywhere; it has a test of its own.
    if (words[0] == "simulate") continue;
    const tests::ProgramRun result = tests::run_softfinger({folder.path(), {}, -1, {}}, words);
    std::string line;
    for (const std::string& word : words) line += " " + word;
    EXPECT_EQ(result.status, 0) << line << "\n" << result.err;
    run.insert(words[0]);
  }
  for (const char* command :
       {"predict", "fit", "compare", "fem", "select", "export", "calibrate", "area"})
    EXPECT_TRUE(run.count(command)) << command;
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "my_choice" / "select.html"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "fit.html"));
}

}  // namespace
}  // namespace softfinger
