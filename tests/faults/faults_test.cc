// Behaviour of the program when memory, disk or descriptors fail under it, at each single call.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace {

namespace fs = std::filesystem;

/// A command that leaves its files, if any, in `out`.
struct Command {
  const char* name;
  std::vector<std::string> arguments;
};

/// A surface that a quadric fits: z = 5 - (x² + y²)/10 on a grid, in mm.
std::string fingertip_obj() {
  std::string text;
  constexpr int cells = 12;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j) {
      const double x = 0.5 * i - 3, y = 0.5 * j - 3, z = 5 - (x * x + y * y) / 10;
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    }
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const int corner = 1 + i * (cells + 1) + j;
      text += "f " + std::to_string(corner) + " " + std::to_string(corner + cells + 1) + " " +
              std::to_string(corner + cells + 2) + " " + std::to_string(corner + 1) + "\n";
    }
  return text;
}

std::vector<Command> commands() {
  return {{"predict", {"predict", "case.toml", "--limit-surface", "4", "--json"}},
          {"fit", {"fit", "tip.obj", "--point", "0,0,5", "--json"}},
          {"compare", {"compare", "case.toml", "--output", "out"}},
          {"simulate", {"simulate", "pinch.toml", "--vtu-every", "10", "--output", "out"}},
          {"select", {"select", "case.toml", "--tolerance", "0.03", "--output", "out", "--json"}},
          {"sweep", {"sweep", "sweep.toml", "--output", "out", "--jobs", "2"}}};
}

/// Results without the times that were measured on the way, alone or in sentences, and without what
/// follows from measured times: candidates are sorted by their cost.
nlohmann::json without_times(nlohmann::json value) {
  if (value.is_object()) {
    for (const char* key :
         {"cost_ns", "cost_us", "wall_s", "reason", "next_better", "next_cheaper"})
      value.erase(key);
    if (value.contains("candidates"))
      std::sort(value["candidates"].begin(), value["candidates"].end(),
                [](const auto& one, const auto& other) { return one["model"] < other["model"]; });
  }
  if (value.is_structured())
    for (nlohmann::json& entry : value) entry = without_times(entry);
  return value;
}

std::string last_line(const std::string& text) {
  const std::vector<std::string> all = lines(text);
  return all.empty() ? "" : all.back();
}

/// Whether a file is all there, seen by its end, of which a run without faults has the like.
bool is_whole(const fs::path& file, const std::string& text, const std::string& whole_text) {
  if (file.extension() == ".json") return nlohmann::json::accept(text);
  if (file.extension() == ".csv")
    return !text.empty() && text.back() == '\n' && lines(text).size() == lines(whole_text).size();
  return last_line(text) == last_line(whole_text);
}

/// The files below a folder that have their final names, by their paths in it.
std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  if (!fs::exists(folder)) return files;
  const auto is_final = [](const std::string& name) {
    return name[0] != '.' && name.rfind("results.partial.", 0) != 0;
  };
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && is_final(entry.path().filename().string()))
      files[fs::relative(entry.path(), folder).string()] = file_text(entry.path());
  return files;
}

/// Each call of one kind during a command.
struct Calls {
  Command command;
  const char* kind;
};

std::string name_of(const Calls& calls) {
  return std::string(calls.command.name) + "_" + calls.kind;
}
void PrintTo(const Calls& calls, std::ostream* out) { *out << name_of(calls); }

class Faults : public testing::TestWithParam<Calls> {
 protected:
  void SetUp() override {
    folder_.write("case.toml", case_text());
    folder_.write("tip.obj", fingertip_obj());
    folder_.write("pinch.toml", scene_text());
    folder_.write("sweep.toml", case_text() + "[sweep]\n\"layer.thickness_mm\" = [1, 2, 3]\n");
  }

  static std::string scene_text() {
    std::string text = file_text(fs::path(SOFTFINGER_SCENES) / "pinch.toml");
    const std::size_t begin = text.find("\nduration_s"), end = text.find('\n', begin + 1);
    return text.replace(begin + 1, end - begin - 1, "duration_s = 0.02");
  }

  ProgramRun run(const std::vector<std::string>& environment) {
    fs::remove_all(folder_.path() / "out");
    fs::remove(reached());
    Start start;
    start.folder = folder_.path();
    start.environment = environment;
    return run_softfinger(start, GetParam().command.arguments);
  }

  fs::path reached() const { return folder_.path() / ".reached"; }

  TemporaryFolder folder_;
};

TEST_P(Faults, EndInWordsAndLeaveNoHalfFile) {
  const char* const kind = GetParam().kind;
  const ProgramRun whole = run({});
  ASSERT_EQ(whole.status, 0) << whole.err;
  const auto whole_files = files_in(folder_.path() / "out");

  long faults = 0;
  // Each of the first two hundred, then ever fewer, to the last one.
  for (long n = 1;; n += n <= 200 ? 1 : n / 4) {
    const std::string fault = std::string(kind) + ":" + std::to_string(n);
    SCOPED_TRACE(fault);
    const ProgramRun hurt =
        run({"LD_PRELOAD=" SOFTFINGER_FAIL_NTH_CALL, "SOFTFINGER_FAULT=" + fault,
             "SOFTFINGER_FAULT_REACHED=" + reached().string()});
    if (!fs::exists(reached())) {
      EXPECT_EQ(hurt.status, 0) << hurt.err;
      break;
    }
    ++faults;
    EXPECT_TRUE(hurt.status == 0 || hurt.status == 2 || hurt.status == 3)
        << hurt.status << ": " << hurt.err;
    int error_lines = 0;
    for (const std::string& line : lines(hurt.err))
      if (line.rfind("softfinger: error: ", 0) == 0) ++error_lines;
    EXPECT_EQ(error_lines, hurt.status == 0 ? 0 : 1) << hurt.err;

    const auto files = files_in(folder_.path() / "out");
    for (const auto& [name, text] : files) {
      const auto found = whole_files.find(name);
      if (found == whole_files.end())
        ADD_FAILURE() << name << " is not among the results";
      else
        EXPECT_TRUE(is_whole(name, text, found->second)) << name << " is not whole";
    }
    if (hurt.status != 0) continue;
    // Then it did no harm.
    EXPECT_EQ(files.size(), whole_files.size());
    if (nlohmann::json::accept(whole.out)) {
      ASSERT_TRUE(nlohmann::json::accept(hurt.out)) << hurt.out;
      EXPECT_EQ(without_times(nlohmann::json::parse(hurt.out)),
                without_times(nlohmann::json::parse(whole.out)));
    } else {
      EXPECT_EQ(lines(hurt.out).size(), lines(whole.out).size()) << hurt.out;
    }
  }
  RecordProperty("faults", int(faults));
  EXPECT_GT(faults, 0) << "no call of this kind was met";
}

std::vector<Calls> all_calls() {
  std::vector<Calls> all;
  for (const Command& command : commands()) {
    all.push_back({command, "allocation"});
    all.push_back({command, "write"});
    const auto& arguments = command.arguments;
    // The others write to standard output alone.
    if (std::find(arguments.begin(), arguments.end(), "--output") == arguments.end()) continue;
    for (const char* kind : {"open", "fsync", "rename"}) all.push_back({command, kind});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(OfOneCall, Faults, testing::ValuesIn(all_calls()),
                         [](const auto& tested) { return name_of(tested.param); });

TEST(FullDevice, HelpVersionAndListsSayThatNothingWasWritten) {
  TemporaryFolder folder;
  Start start;
  start.folder = folder.path();
  start.output_to = "/dev/full";
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"--help"},
                                             {"--version"},
                                             {"predict", "--help"},
                                             {"list", "cases"},
                                             {"list", "models"},
                                             {"explain", "hertz"}}) {
    const ProgramRun run = run_softfinger(start, arguments);
    EXPECT_EQ(run.status, 2) << arguments.front();
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
  }
}

}  // namespace
}  // namespace softfinger::tests
