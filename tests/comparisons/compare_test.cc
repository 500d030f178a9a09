// `softfinger compare` with finite elements that are instant or misbehave: what survives what.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace fs = std::filesystem;
using nlohmann::json;

class Compare : public testing::Test {
 protected:
  TemporaryFolder folder;
  fs::path log = folder.path() / "log";
  Start start{folder.path(), {"FAKE_FEM_LOG=" + log.string()}, -1, ""};
  fs::path output = folder.path() / "report";
  fs::path two_loads = folder.write("two.toml", case_text("two", "[1.0, 5.0]"));

  /// Compares in linear theory, which needs one solve per load.
  ProgramRun compare(std::vector<std::string> more = {}) {
    more.insert(more.begin(), "--linear");
    return compare_in_full(more);
  }

  ProgramRun compare_in_full(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"compare",       two_loads.string(), "--output",
                                          output.string(), "--jobs",           "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_softfinger(start, arguments);
  }

  int solves() const { return static_cast<int>(lines(file_text(log)).size()); }

  /// Whatever happened: every file with a final name is whole and nothing temporary is left.
  void expect_nothing_half_written() const {
    if (!fs::exists(output)) return;
    for (const auto& entry : fs::recursive_directory_iterator(output)) {
      const std::string name = entry.path().filename().string();
      if (name == ".softfinger.lock") continue;  // of a run that was killed: nobody holds it
      EXPECT_NE(name[0], '.') << "left behind: " << entry.path();
      if (entry.path().extension() == ".json") {
        EXPECT_TRUE(json::accept(file_text(entry.path()))) << entry.path();
      }
      if (name == "report.html") {
        EXPECT_NE(file_text(entry.path()).find("</html>"), std::string::npos);
      }
    }
  }
};

TEST_F(Compare, WritesReportNumbersAndResults) {
  const ProgramRun result = compare();
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("two: "), std::string::npos) << "the verdict: " << result.out;
  EXPECT_NE(result.out.find("report.html"), std::string::npos);
  EXPECT_NE(file_text(output / "report.html").find("</html>"), std::string::npos);

  const json report = json::parse(file_text(output / "report.json"));
  const json& entry = report["cases"][0];
  EXPECT_EQ(entry["id"], "two");
  EXPECT_EQ(entry["file"], "two.toml");
  EXPECT_EQ(entry["case_toml"], file_text(two_loads));
  EXPECT_FALSE(entry["verdict"].get<std::string>().empty());
  ASSERT_EQ(entry["loads"].size(), 2u);
  const json& load = entry["loads"][1];
  EXPECT_EQ(load["load_N"], 5.0);
  EXPECT_EQ(load["fem"]["trusted"], true);
  EXPECT_EQ(load["fem"]["vtu"], "fem/two_5N/solution.vtu");
  EXPECT_TRUE(fs::exists(output / load["fem"]["vtu"].get<std::string>()));
  for (const json& model : load["models"]) {
    if (!model["has_answer"].get<bool>()) continue;
    ASSERT_TRUE(model["relative_error"].is_object());
    const double error =
        model["area_m2"].get<double>() / load["fem"]["area_projected_m2"].get<double>() - 1;
    EXPECT_NEAR(model["relative_error"]["area"].get<double>(), error, 1e-12);
    if (model["profile_x"].is_null()) continue;  // too slow to be drawn
    EXPECT_EQ(model["profile_x"]["position_m"].size(), model["profile_x"]["pressure_Pa"].size());
    EXPECT_NEAR(model["profile_x"]["pressure_Pa"].front().get<double>() /
                    model["peak_pressure_Pa"].get<double>(),
                1, 5e-3)  // what a model on a grid states for the pressure between its cells
        << model["model"];
  }
  const auto rows = lines(file_text(output / "results.csv"));
  EXPECT_EQ(rows.size(), 1 + 2 * (1 + load["models"].size()));
  const auto columns = [](const std::string& row) {
    return std::count(row.begin(), row.end(), ',');
  };
  for (const std::string& row : rows) EXPECT_EQ(columns(row), columns(rows[0])) << row;
  expect_nothing_half_written();
}

TEST_F(Compare, ReusesWhatIsFinishedAndRecomputesWhatChanged) {
  ASSERT_EQ(compare().status, 0);
  EXPECT_EQ(solves(), 2);
  const ProgramRun again = compare();
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(solves(), 2);
  EXPECT_NE(again.err.find("two 5 N: reused"), std::string::npos) << again.err;
  folder.write("two.toml", case_text("two", "[5.0, 7.0]"));
  EXPECT_EQ(compare().status, 0);
  EXPECT_EQ(solves(), 3) << "5 N is known";
  EXPECT_EQ(compare({"--full"}).status, 0);
  EXPECT_EQ(solves(), 5) << "another level is another problem";
  fs::remove(output / "fem" / "two_5N" / "solution.vtu");
  EXPECT_EQ(compare({"--full"}).status, 0);
  EXPECT_EQ(solves(), 6) << "a result without its VTU is not finished";
  folder.write("report/fem/two_5N/result.json", "{ half");
  EXPECT_EQ(compare({"--full"}).status, 0);
  EXPECT_EQ(solves(), 7) << "a damaged result is not believed";
}

TEST_F(Compare, SaysWhyAFinishedResultIsMadeAgain) {
  ASSERT_EQ(compare().status, 0);
  const fs::path file = output / "fem" / "two_5N" / "result.json";
  json saved = json::parse(file_text(file));
  const std::vector<std::pair<json, std::string>> damages = {
      {{{"result", {{"a_m", -1e-3}}}}, "a_m = -0.001"},
      {{{"result", {{"levels", nullptr}}}}, "levels is missing"},
      {{{"result", {{"peak_pressure_Pa", nullptr}}}}, "peak_pressure_Pa is missing"},
      {{{"result", {{"error", {{"a", -1}}}}}}, "the error of a = -1"},
      {{{"program", "0.0.1 of long ago"}}, "another version of softfinger-fem"},
      {{{"problem", {{"load_N", 4}}}}, "of another problem"}};
  int solved = solves();
  for (const auto& [damage, reason] : damages) {
    json damaged = saved;
    damaged.merge_patch(damage);
    folder.write("report/fem/two_5N/result.json", damaged.dump());
    const ProgramRun again = compare();
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(solves(), ++solved) << reason;
    EXPECT_NE(again.err.find(reason), std::string::npos) << again.err;
  }
  folder.write("report/fem/two_5N/result.json", std::string(300000, '['));
  EXPECT_EQ(compare().status, 0);
  EXPECT_EQ(solves(), solved + 1) << "brackets without end";
}

TEST_F(Compare, MakesAResultAgainThatWasChangedByHand) {
  ASSERT_EQ(compare().status, 0);
  const std::string name = "report/fem/two_5N/result.json";
  const json saved = json::parse(file_text(folder.path() / name));
  const double a_m = saved["result"]["a_m"];
  int solved = solves();
  // Numbers that a contact can have, and that pass for a result.
  for (const json& change :
       {json{{"result", {{"a_m", 3 * a_m}}}}, json{{"result", {{"b_m", 2 * a_m}}}},
        json{{"result", {{"load_N", 4}}}}, json{{"result", {{"wall_s", 1}}}},
        json{{"check", nullptr}}, json{{"check", "0123456789abcdef"}}}) {
    json changed = saved;
    changed.merge_patch(change);
    folder.write(name, changed.dump());
    const ProgramRun again = compare();
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(solves(), ++solved) << change;
    EXPECT_NE(again.err.find("made again, it cannot be used"), std::string::npos) << again.err;
    EXPECT_EQ(json::parse(file_text(folder.path() / name))["result"]["a_m"], a_m);
  }
  // In another layout it is the same result.
  folder.write(name, json::parse(file_text(folder.path() / name)).dump());
  EXPECT_EQ(compare().status, 0);
  EXPECT_EQ(solves(), solved);
}

TEST_F(Compare, MakesResultsAgainOfFilesWithAnotherContentAndTheSameTime) {
  const auto surface = [](double radius_mm) {
    std::string text;
    constexpr int cells = 24;
    for (int i = 0; i <= cells; ++i)
      for (int j = 0; j <= cells; ++j) {
        const double x = i - 12, y = j - 12;
        text += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
                std::to_string(-(x * x + y * y) / (2 * radius_mm)) + "\n";
      }
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j) {
        const int a = 1 + i * (cells + 1) + j, b = a + cells + 1;
        for (const auto& [p, q, r] : {std::array{a, b, b + 1}, std::array{a, b + 1, a + 1}})
          text +=
              "f " + std::to_string(p) + " " + std::to_string(q) + " " + std::to_string(r) + "\n";
      }
    return text;
  };
  folder.write("tip.obj", surface(20));
  folder.write("bone.obj", surface(18));
  std::string text = case_text("two", "5.0");
  const std::string radii = "relative_radii_mm = [20.0, 10.0]";
  text.replace(
      text.find(radii), radii.size(),
      "finger = { mesh = \"tip.obj\", unit = \"mm\", point_mm = [0, 0, 0], normal = [0, 0, "
      "1], core = { mesh = \"bone.obj\" } }\nobject = { radii_mm = [inf, inf] }");
  folder.write("two.toml", text + "[fem]\nlevel = 1\ngeometry = \"curved\"\n");
  ASSERT_NE(compare_in_full({"--quick"}).status, 2);
  const int first = solves();
  ASSERT_GT(first, 0);
  compare_in_full({"--quick"});
  ASSERT_EQ(solves(), first) << "all is as it was";
  for (const auto& [name, radius_mm] : {std::pair("bone.obj", 17.), std::pair("tip.obj", 21.)}) {
    const int before = solves();
    const auto time = fs::last_write_time(folder.path() / name);
    folder.write(name, surface(radius_mm));
    fs::last_write_time(folder.path() / name, time);
    compare_in_full({"--quick"});
    EXPECT_GT(solves(), before) << name;
  }
}

TEST_F(Compare, WritesWholeResultsWithAllDescriptorsClosed) {
  const std::string command =
      "cd '" + folder.path().string() + "' && SOFTFINGER_FEM_PROGRAM=" + SOFTFINGER_FAKE_FEM + " " +
      SOFTFINGER_PROGRAM + " compare two.toml --linear -o report <&- >&- 2>&-";
  const int status = std::system(command.c_str());
  // The answer could not be written, as standard output is closed; the report could.
  EXPECT_EQ(WEXITSTATUS(status), 2);
  expect_nothing_half_written();
  for (const auto& entry : fs::recursive_directory_iterator(output))
    if (entry.is_regular_file()) {
      EXPECT_EQ(file_text(entry.path()).find("softfinger: error"), std::string::npos) << entry;
    }
  const ProgramRun again = compare();
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.err.find("two 5 N: reused"), std::string::npos) << again.err;
}

TEST_F(Compare, EndsASolveBeyondItsTimeOrMemoryAndGoesOn) {
  start.environment.push_back("FAKE_FEM_LINGER_N=5");
  const ProgramRun slow = compare({"--fem-time-s", "1"});
  EXPECT_EQ(slow.status, 1);
  EXPECT_NE(slow.err.find("two 5 N: FEM failed: softfinger-fem was ended after 1 s"),
            std::string::npos)
      << slow.err;
  EXPECT_TRUE(fs::exists(output / "fem" / "two_1N" / "result.json")) << "the other load goes on";
  start.environment.back() = "FAKE_FEM_HOARD_N=5";
  const ProgramRun large = compare({"--fem-memory-MB", "100"});
  EXPECT_EQ(large.status, 1);
  EXPECT_NE(large.err.find("took more than 100 MB"), std::string::npos) << large.err;
  EXPECT_NE(large.err.find("two 1 N: reused"), std::string::npos) << large.err;
}

TEST_F(Compare, RefusesAFolderInUseAndNamesWhoUsesIt) {
  start.environment.push_back("FAKE_FEM_LINGER_N=1");
  const pid_t first = start_softfinger(start, {"compare", two_loads.string(), "--output",
                                               output.string(), "--jobs", "1", "--linear"});
  for (int i = 0; i < 1000 && solves() < 2; ++i) usleep(10000);
  TemporaryFolder elsewhere;
  const ProgramRun second = run_softfinger(
      {elsewhere.path(), {}, -1, ""}, {"compare", two_loads.string(), "--output", output.string()});
  EXPECT_EQ(second.status, 2);
  EXPECT_EQ(lines(second.err).size(), 1u) << second.err;
  EXPECT_NE(second.err.find("in use by process " + std::to_string(first)), std::string::npos)
      << second.err;
  kill(first, SIGKILL);
  wait_for(start, first);
  start.environment.pop_back();
  EXPECT_EQ(compare().status, 0) << "a killed run holds no lock";
  EXPECT_FALSE(fs::exists(output / ".softfinger.lock"));
}

TEST_F(Compare, SaysWhichCasesAReportWillLoseThatIsThereAlready) {
  const auto other = folder.write("other.toml", case_text("other"));
  const ProgramRun both = compare({other.string()});
  ASSERT_EQ(both.status, 0) << both.err;
  EXPECT_EQ(both.err.find("replaced"), std::string::npos) << both.err;
  const ProgramRun one = compare();
  EXPECT_EQ(one.status, 0);
  EXPECT_NE(one.err.find("without other"), std::string::npos) << one.err;
}

class InterruptedCompare : public Compare, public testing::WithParamInterface<int> {};

TEST_P(InterruptedCompare, KeepsFinishedResultsAndContinues) {
  start.environment.push_back("FAKE_FEM_LINGER_N=1");
  const pid_t process = start_softfinger(start, {"compare", two_loads.string(), "--output",
                                                 output.string(), "--jobs", "1", "--linear"});
  // Until the first result is there and the second solve has begun.
  for (int i = 0;
       i < 1000 && (solves() < 2 || !fs::exists(output / "fem" / "two_5N" / "result.json")); ++i)
    usleep(10000);
  ASSERT_EQ(solves(), 2);
  kill(process, GetParam());
  const ProgramRun result = wait_for(start, process);
  if (GetParam() != SIGKILL) {
    EXPECT_EQ(result.status, 128 + GetParam());
    EXPECT_NE(result.err.find("1 of 2"), std::string::npos) << result.err;
  }
  EXPECT_FALSE(fs::exists(output / "report.html"));
  expect_nothing_half_written();
  std::string name, load;
  pid_t child = 0;
  std::istringstream(lines(file_text(log)).back()) >> name >> load >> child;
  bool alive = true;
  for (int i = 0; i < 300 && alive; ++i, usleep(10000)) alive = kill(child, 0) == 0;
  // In a container without an init a dead orphan stays in the process table.
  if (alive) {
    const std::string status = file_text("/proc/" + std::to_string(child) + "/status");
    EXPECT_NE(status.find("State:\tZ"), std::string::npos)
        << "the solve goes on without its parent";
  }

  start.environment.pop_back();
  const ProgramRun resumed = compare();
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_NE(resumed.err.find("two 5 N: reused"), std::string::npos) << resumed.err;
  EXPECT_EQ(solves(), 3);
}

INSTANTIATE_TEST_SUITE_P(By, InterruptedCompare, testing::Values(SIGINT, SIGTERM, SIGKILL));

TEST_F(Compare, ReportsAFailedSolveAndFallsShort) {
  start.environment.push_back("FAKE_FEM_EXIT=3");
  const ProgramRun result = compare();
  EXPECT_EQ(result.status, 1) << result.err;
  const json entry = json::parse(file_text(output / "report.json"))["cases"][0];
  EXPECT_EQ(entry["verdict_class"], "failed");
  EXPECT_TRUE(entry["loads"][0]["fem"].is_null());
  EXPECT_EQ(entry["loads"][0]["fem_failure"], "the fake fails as it was told");
  start.environment.pop_back();
  EXPECT_EQ(compare().status, 0) << "a failure is not kept";
}

TEST_F(Compare, SolvesTheLoadsOfACaseInOneProcessTheLargestFirst) {
  ASSERT_EQ(compare().status, 0);
  std::string name, pid, other_pid;
  double load_N = 0, other_load_N = 0;
  const auto solved = lines(file_text(log));
  ASSERT_EQ(solved.size(), 2u);
  std::istringstream(solved[0]) >> name >> load_N >> pid;
  std::istringstream(solved[1]) >> name >> other_load_N >> other_pid;
  EXPECT_EQ(pid, other_pid);
  EXPECT_EQ(load_N, 5);
  EXPECT_EQ(other_load_N, 1);
}

TEST_F(Compare, SolvesWhatTheLadderNeedsBesideTheReference) {
  ASSERT_EQ(compare_in_full().status, 0);
  EXPECT_EQ(solves(), 4) << "at finite strain and in linear theory";
  const json report = json::parse(file_text(output / "report.json"));
  EXPECT_EQ(report["cases"][0]["reference"],
            "a flat layer at finite strain, pressed with friction");
  for (const json& load : report["cases"][0]["loads"]) {
    std::vector<std::string> steps;
    for (const json& step : load["ladder"]) {
      steps.push_back(step["step"]);
      EXPECT_EQ(step["quantity"].size(), 5u);
    }
    EXPECT_EQ(steps,
              (std::vector<std::string>{"closed_form", "layer_flat_linear", "fem_flat_linear",
                                        "fem_frictionless", "fem_flat_finite", "elements"}));
    EXPECT_NEAR(load["ladder"][3]["quantity"]["indentation"], 0.02, 1e-12)
        << "of the same run, pressed without friction";
    EXPECT_EQ(load["ladder"][4]["quantity"]["area"], 0.0) << "the reference itself";
    double area = 0;
    for (const json& model : load["models"])
      if (model["model"] == "bonded_layer") area = model["relative_error"]["area"];
    EXPECT_EQ(load["ladder"][1]["quantity"]["area"], area);
    EXPECT_EQ(load["largest_step"].get<std::string>().rfind("The largest step is from ", 0), 0u);
  }
  EXPECT_NE(file_text(output / "report.html").find("What each idealisation costs"),
            std::string::npos);
}

TEST_F(Compare, AsksForNoIdealisationOfAReferenceThatFailed) {
  start.environment.push_back("FAKE_FEM_CRASH_N=5");
  EXPECT_EQ(compare_in_full().status, 1);
  // Each at finite strain, then 1 N in linear theory.
  std::vector<double> loads_N;
  for (const std::string& line : lines(file_text(log))) {
    std::istringstream words(line);
    std::string name;
    words >> name >> loads_N.emplace_back();
  }
  EXPECT_EQ(loads_N, (std::vector<double>{5, 1, 1}));
}

TEST_F(Compare, LosesOnlyTheLoadThatCrashes) {
  two_loads = folder.write("two.toml", case_text("three", "[1.0, 3.0, 5.0]"));
  start.environment.push_back("FAKE_FEM_CRASH_N=3");
  EXPECT_EQ(compare().status, 1);
  const json report = json::parse(file_text(output / "report.json"));
  const json& loads = report["cases"][0]["loads"];
  EXPECT_TRUE(loads[0]["fem"].is_object());
  EXPECT_TRUE(loads[1]["fem"].is_null());
  EXPECT_NE(loads[1]["fem_failure"].get<std::string>().find("signal 9"), std::string::npos);
  EXPECT_TRUE(loads[2]["fem"].is_object());
  EXPECT_EQ(solves(), 3);
}

TEST_F(Compare, FallsShortWhenTheReferenceIsNotTrusted) {
  start.environment.push_back("FAKE_FEM_ERROR=0.03");
  const ProgramRun result = compare();
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(
      json::parse(file_text(output / "report.json"))["cases"][0]["loads"][0]["fem"]["trusted"],
      false);
  EXPECT_EQ(solves(), 4) << "the finer level is tried as well";
}

TEST_F(Compare, SolvesDoubtedReferencesOnceMoreOneLevelFiner) {
  // 1.5 % in d and torque on level 2 is too much, what the fake states on level 3 is not.
  start.environment.push_back("FAKE_FEM_ERROR=0.015");
  const ProgramRun result = compare();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(solves(), 4);
  EXPECT_NE(result.err.find("2 FEM results are less accurate than 2 % in a and b"),
            std::string::npos)
      << result.err;
  const json fem = json::parse(file_text(output / "report.json"))["cases"][0]["loads"][1]["fem"];
  EXPECT_EQ(fem["trusted"], true);
  EXPECT_EQ(fem["error"]["indentation"], 0.0075);
  EXPECT_EQ(fem["vtu"], "fem/two_5N_finer/solution.vtu");
  EXPECT_TRUE(fs::exists(output / fem["vtu"].get<std::string>()));

  EXPECT_EQ(compare().status, 0);
  EXPECT_EQ(solves(), 4) << "both levels are finished";

  fs::remove_all(output);
  start.environment.push_back("FAKE_FEM_CRASH_FINER=1");
  const ProgramRun crashed = compare();
  EXPECT_EQ(crashed.status, 1);
  EXPECT_EQ(json::parse(file_text(
                output / "report.json"))["cases"][0]["loads"][1]["fem"]["error"]["indentation"],
            0.015)
      << "the coarser result stays";
}

TEST_F(Compare, ChecksEveryCaseBeforeItWritesAnything) {
  const auto bad = folder.write("bad.toml", case_text("bad", "-1"));
  ProgramRun result = compare({bad.string()});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("load_N"), std::string::npos);
  EXPECT_FALSE(fs::exists(output));
  result = compare({folder.write("same.toml", case_text("two")).string()});
  EXPECT_EQ(result.status, 2) << "two cases with one id would share a folder";
  EXPECT_NE(result.err.find("two.toml"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(output));
}

TEST_F(Compare, RefusesAFolderThatCannotBeWritten) {
  const auto file = folder.write("file", "precious");
  for (const fs::path& bad : {file, file / "below", fs::path("/proc/softfinger-report")}) {
    output = bad;
    const ProgramRun result = compare();
    EXPECT_EQ(result.status, 2) << bad;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
    EXPECT_NE(result.err.find(bad.string()), std::string::npos) << result.err;
  }
  EXPECT_EQ(file_text(file), "precious");
  EXPECT_EQ(solves(), 0);
}

TEST_F(Compare, LeavesNothingHalfWrittenOnAFullDisk) {
  // Limits at which the disk fills up while a result, the report or the page is being written.
  for (long bytes : {600L, 12000L, 100000L}) {
    start.largest_file_bytes = bytes;
    const ProgramRun result = compare();
    EXPECT_EQ(result.status, 2) << bytes << ": " << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(lines(result.err).back().find("cannot be written"), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(output / "report.html"));
    expect_nothing_half_written();
  }
  start.largest_file_bytes = -1;
  EXPECT_EQ(compare().status, 0);
}

}  // namespace softfinger::tests
