// Kills the program at random moments (kill -9) while it writes. Each file that it had written
// before has to be the old one or a new whole one, and the same command has to succeed afterwards.
// SOFTFINGER_KILLS=N kills N times in all; by default once for each command, twice for some.
//   SOFTFINGER_KILLS=100 build/release/tests/faults/kill_test

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace {

namespace fs = std::filesystem;

/// A command that writes into the folder `out`. "@" in a word is "old" or "new".
struct Writer {
  const char* name;
  std::vector<std::string> arguments;
};

std::vector<Writer> writers() {
  return {
      {"apply",
       {"apply", "hand.xml", "@.toml", "--finger", "tip_1", "--to", "mujoco", "-o", "out/a.xml"}},
      {"predict", {"predict", "@_tip.toml", "--page", "out/page.html"}},
      {"mesh", {"mesh", "@.obj", "--page", "out/page.html", "--picture", "out/picture.png"}},
      {"calibrate",
       {"calibrate", "@.csv", "old.toml", "-o", "out/fitted.toml", "--page", "out/page.html"}},
      {"sweep", {"sweep", "@_sweep.toml", "-o", "out", "--jobs", "2"}},
      {"fem_sweep", {"sweep", "@_fem_sweep.toml", "-o", "out", "--jobs", "2"}},
      {"compare", {"compare", "@.toml", "-o", "out", "--jobs", "2"}},
      {"simulate", {"simulate", "@_scene.toml", "-o", "out", "--vtu-every", "20"}},
      {"select", {"select", "@.toml", "--tolerance", "0.1", "-o", "out"}},
#ifdef SOFTFINGER_EXPLORER
      {"explore", {"explore", "-o", "out/explore.html"}},
#endif
  };
}

/// z = top - (x² + y²)/20 on a grid, in mm.
std::string surface_obj(double top_mm) {
  std::string text;
  constexpr int cells = 24;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j) {
      const double x = 0.5 * i - 6, y = 0.5 * j - 6, z = top_mm - (x * x + y * y) / 20;
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    }
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const int corner = 1 + i * (cells + 1) + j;
      const auto face = [&](int a, int b, int c) {
        text += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
      };
      face(corner, corner + cells + 1, corner + cells + 2);
      face(corner, corner + cells + 2, corner + 1);
    }
  return text;
}

/// The files in a folder, by their paths in it; hidden ones and those of an unfinished sweep are
/// the program's own affair, and so are the finite elements' results, which are made again.
std::map<std::string, std::string> targets_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string path = fs::relative(entry.path(), folder).string();
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && name[0] != '.' && name.rfind("results.partial", 0) != 0 &&
        path.rfind("fem/", 0) != 0)
      files[path] = file_text(entry.path());
  }
  return files;
}

bool is_whole(const std::string& name, const std::string& text) {
  const auto ends_with = [&](const std::string& end) {
    return text.size() >= end.size() &&
           text.compare(text.size() - end.size(), end.size(), end) == 0;
  };
  const std::string kind = fs::path(name).extension().string();
  if (kind == ".json") return nlohmann::json::accept(text);
  if (kind == ".html") return ends_with("</html>\n");
  if (kind == ".xml") return ends_with("</mujoco>\n");
  if (kind == ".vtu" || kind == ".pvd") return ends_with("</VTKFile>\n");
  if (kind == ".png") return ends_with("IEND\xAE\x42\x60\x82");
  return !text.empty() && text.back() == '\n';
}

class Kill : public testing::TestWithParam<Writer> {
 protected:
  void SetUp() override {
    folder_.write("hand.xml", file_text(SOFTFINGER_HAND));
    for (const bool is_new : {false, true}) {
      const std::string name = is_new ? "new" : "old";
      std::string contact = case_text(name, is_new ? "[1.0, 6.0]" : "[1.0, 5.0]");
      folder_.write(name + ".toml", contact);
      folder_.write(name + ".obj", surface_obj(is_new ? 5 : 6));
      const std::string radii = "relative_radii_mm = [20.0, 10.0]";
      std::string tip = contact;
      tip.replace(tip.find(radii), radii.size(),
                  "finger = { mesh = \"" + name +
                      ".obj\", unit = \"mm\", along = \"+z\" }\n"
                      "object = { radii_mm = [inf, inf] }");
      folder_.write(name + "_tip.toml", tip);
      // A sweep of enough rows to be killed between them.
      folder_.write(name + "_sweep.toml",
                    contact +
                        "[sweep]\nmodels = [\"bonded_layer\"]\n\"layer.thickness_mm\" = { "
                        "from = 1, to = 4, steps = " +
                        std::string(is_new ? "6000" : "5000") + " }\n");
      folder_.write(name + "_fem_sweep.toml",
                    contact +
                        "[sweep]\nfem = true\nmodels = [\"bonded_layer\"]\n"
                        "\"layer.thickness_mm\" = [1, " +
                        (is_new ? "2" : "3") + "]\n");
      folder_.write(name + ".csv", std::string("load_N,a_mm\n0.5,1.5\n1,1.9\n2,2.4\n4,") +
                                       (is_new ? "3.0\n" : "3.1\n"));
      std::string scene = file_text(fs::path(SOFTFINGER_SCENES) / "pinch.toml");
      const std::size_t begin = scene.find("\nduration_s"), end = scene.find('\n', begin + 1);
      folder_.write(name + "_scene.toml",
                    scene.replace(begin + 1, end - begin - 1,
                                  is_new ? "duration_s = 0.2" : "duration_s = 0.1"));
    }
  }

  pid_t begin(const std::string& inputs) const {
    std::vector<std::string> arguments = GetParam().arguments;
    for (std::string& word : arguments)
      if (const std::size_t at = word.find('@'); at != std::string::npos)
        word.replace(at, 1, inputs);
    return start_softfinger(start_, arguments);
  }
  ProgramRun run(const std::string& inputs) const { return wait_for(start_, begin(inputs)); }

  TemporaryFolder folder_;
  Start start_{folder_.path(), {}, -1, "", ""};
  const fs::path out_ = folder_.path() / "out", kept_ = folder_.path() / "kept";
};

/// Returns how often this command is killed: its share of SOFTFINGER_KILLS, once by default.
int kills_of(const std::string& name) {
  const auto all = writers();
  const char* const asked = std::getenv("SOFTFINGER_KILLS");
  const int kills = asked ? std::atoi(asked) : int(all.size());
  int index = 0;
  while (all[std::size_t(index)].name != name) ++index;
  return kills / int(all.size()) + (index < kills % int(all.size()));
}

TEST_P(Kill, LeavesOldOrNewFilesAndASecondRunSucceeds) {
  using Clock = std::chrono::steady_clock;
  fs::create_directory(out_);
  const ProgramRun first = run("old");
  ASSERT_EQ(first.status, 0) << first.err;
  fs::copy(out_, kept_, fs::copy_options::recursive);
  const auto old_files = targets_in(out_);
  ASSERT_FALSE(old_files.empty());
  const auto start = Clock::now();
  ASSERT_EQ(run("new").status, 0);
  const auto took =
      std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start).count();
  const auto new_files = targets_in(out_);

  std::random_device seed;
  std::mt19937 generator(seed());
  int ended_before = 0;
  for (int i = 0; i < kills_of(GetParam().name); ++i) {
    fs::remove_all(out_);
    fs::copy(kept_, out_, fs::copy_options::recursive);
    const long moment_us = std::uniform_int_distribution<long>(0, took)(generator);
    SCOPED_TRACE(std::to_string(moment_us) + " us of " + std::to_string(took));
    const pid_t process = begin("new");
    usleep(useconds_t(moment_us));
    kill(process, SIGKILL);
    ended_before += wait_for(start_, process).status >= 0;

    auto files = targets_in(out_);
    for (const auto& [name, text] : old_files) EXPECT_TRUE(files.count(name)) << name << " is lost";
    for (const auto& [name, text] : files) {
      const auto old_file = old_files.find(name);
      if (old_file != old_files.end() && old_file->second == text) continue;
      EXPECT_TRUE(is_whole(name, text)) << name;
      ASSERT_TRUE(new_files.count(name)) << name;
      if (fs::path(name).extension() == ".csv") {
        EXPECT_EQ(lines(text).size(), lines(new_files.at(name)).size()) << name;
      }
    }
    const ProgramRun again = run("new");
    EXPECT_EQ(again.status, 0) << again.err;
    files = targets_in(out_);
    for (const auto& [name, text] : new_files) EXPECT_TRUE(files.count(name)) << name;
    for (const auto& [name, text] : files) EXPECT_TRUE(is_whole(name, text)) << name;
    for (const auto& entry : fs::recursive_directory_iterator(out_))
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path() << " is left behind";
  }
  RecordProperty("ended_before_the_kill", ended_before);
}

INSTANTIATE_TEST_SUITE_P(AtARandomMoment, Kill, testing::ValuesIn(writers()),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace softfinger::tests
