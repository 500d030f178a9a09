// `softfinger sweep`, `softfinger atlas` and their MPI twin, with finite elements that are instant
// or misbehave.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace fs = std::filesystem;
using nlohmann::json;

class SweepProgram : public testing::Test {
 protected:
  TemporaryFolder folder;
  fs::path log = folder.path() / "log", output = folder.path() / "out";
  Start start{folder.path(), {"FAKE_FEM_LOG=" + log.string()}, -1, ""};

  fs::path write_sweep(const std::string& sweep) const {
    return folder.write("sweep.toml", case_text("swept", "[1.0, 5.0]") + "[sweep]\n" + sweep);
  }
  ProgramRun sweep(const char* jobs = "2") {
    return run_softfinger(start, {"sweep", (folder.path() / "sweep.toml").string(), "--output",
                                  output.string(), "--jobs", jobs});
  }
  int solves() const { return static_cast<int>(lines(file_text(log)).size()); }
};

const char* const kThicknesses =
    "\"layer.thickness_mm\" = { from = 1, to = 6, steps = 6 }\nmodels = [\"hertz\", "
    "\"bonded_layer\"]\n";

TEST_F(SweepProgram, WritesARowPerPointAndLoadAsPredictHasThem) {
  write_sweep(kThicknesses);
  const ProgramRun run = sweep();
  ASSERT_EQ(run.status, 0) << run.err;
  const auto rows = lines(file_text(output / "results.csv"));
  ASSERT_EQ(rows.size(), 1u + 6 * 2);
  EXPECT_EQ(
      rows[0].rfind("point,layer.thickness_mm,load_N,radius_major_m,radius_minor_m,hertz_a_m,", 0),
      0u)
      << rows[0];
  for (const std::string& row : rows)
    EXPECT_EQ(std::count(row.begin(), row.end(), ','),
              std::count(rows[0].begin(), rows[0].end(), ','))
        << row;
  EXPECT_TRUE(fs::exists(output / "sweep.html"));
  EXPECT_FALSE(fs::exists(output / "results.partial.csv"));
  // The third point is 3 mm; the base case has 2 mm, so that it is written anew.
  std::string text = case_text("swept", "[1.0, 5.0]");
  text.replace(text.find("thickness_mm = 2.0"), 18, "thickness_mm = 3.0");
  folder.write("three.toml", text);
  const ProgramRun one =
      run_softfinger(start, {"predict", "three.toml", "--json", "--model", "bonded_layer"});
  const json expected = json::parse(one.out)["results"][1];
  std::istringstream cells(rows[1 + 2 * 2 + 1]);
  std::vector<std::string> row;
  for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
  EXPECT_EQ(row[0], "2");
  EXPECT_EQ(row[1], "3");
  EXPECT_EQ(row[2], "5");
  const char* const keys[] = {"a_m",     "b_m",          "indentation_m", "peak_pressure_Pa",
                              "area_m2", "max_torque_Nm"};
  for (std::size_t i = 0; i < 6; ++i)  // ten digits are written
    EXPECT_NEAR(std::stod(row[12 + i]) / expected[keys[i]].get<double>(), 1, 1e-9) << keys[i];
}

TEST_F(SweepProgram, JudgesByTheDemandAndNotByRowsOfAnother) {
  write_sweep(kThicknesses);
  const auto usable = [&](const std::vector<std::string>& demand) {
    std::vector<std::string> words = {"sweep", (folder.path() / "sweep.toml").string(), "--output",
                                      output.string()};
    words.insert(words.end(), demand.begin(), demand.end());
    const ProgramRun run = run_softfinger(start, words);
    EXPECT_EQ(run.status, 0) << run.err;
    const std::string rows = file_text(output / "results.csv");
    std::ptrdiff_t count = 0;
    for (std::size_t at = 0; (at = rows.find(",yes", at)) != std::string::npos; ++at) ++count;
    return std::pair(count, run.out);
  };
  const auto [usual, usual_line] = usable({});
  EXPECT_NE(usual_line.find("usable (within 10 %) in "), std::string::npos) << usual_line;
  EXPECT_GT(usual, 0);
  EXPECT_EQ(usable({"--tolerance", "10"}).first, 24) << "each model in each row";
  const auto [strict, strict_line] = usable({"--tolerance", "1e-6", "--quantities", "max_torque"});
  EXPECT_EQ(strict, 0);
  EXPECT_NE(strict_line.find("no model is usable (within 0.0001 % in max_torque)"),
            std::string::npos)
      << strict_line;
  EXPECT_EQ(usable({}).first, usual);
}

TEST_F(SweepProgram, DoesNotDependOnTheNumberOfThreads) {
  write_sweep("\"layer.thickness_mm\" = { from = 1, to = 6, steps = 4000 }\n");
  ASSERT_EQ(sweep("1").status, 0);
  const std::string one = file_text(output / "results.csv");
  fs::remove_all(output);
  ASSERT_EQ(sweep("5").status, 0);
  EXPECT_EQ(file_text(output / "results.csv"), one);
}

TEST_F(SweepProgram, SaysInTheRowWhereTheBodiesMakeNoContact) {
  folder.write(
      "sweep.toml",
      "id = \"saddle\"\n[geometry]\nfinger = { radii_mm = [10.0, 10.0] }\n"
      "object = { radii_mm = [-20.0, 30.0] }\n[layer]\nthickness_mm = 2.0\n"
      "youngs_modulus_kPa = 300.0\npoisson_ratio = 0.45\n[contact]\nload_N = 1.0\n"
      "friction_coefficient = 0.8\n[sweep]\n\"geometry.object.radii_mm[0]\" = [-20, -5]\n");
  const ProgramRun run = sweep();
  EXPECT_EQ(run.status, 0) << run.err;
  const auto rows = lines(file_text(output / "results.csv"));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_NE(rows[2].find("\"no contact ellipse"), std::string::npos) << rows[2];
  EXPECT_EQ(rows[2].find("nan"), std::string::npos);
}

TEST_F(SweepProgram, GoesOnWithWhatIsMissing) {
  write_sweep(std::string(kThicknesses) + "fem = true\n");
  ASSERT_EQ(sweep().status, 0);
  EXPECT_EQ(solves(), 12);
  const std::string whole = file_text(output / "results.csv");
  EXPECT_EQ(sweep().status, 0);
  EXPECT_EQ(solves(), 12) << "all there";
  EXPECT_EQ(file_text(output / "results.csv"), whole);
  for (const auto& entry : fs::directory_iterator(output / "fem")) {
    fs::remove(entry);
    break;
  }
  EXPECT_EQ(sweep().status, 0);
  EXPECT_EQ(solves(), 13);
  EXPECT_EQ(file_text(output / "results.csv"), whole);
  write_sweep("\"layer.thickness_mm\" = [6, 2, 7]\nfem = true\n");
  EXPECT_EQ(sweep().status, 0);
  EXPECT_EQ(solves(), 15) << "6 and 2 mm are known, by whatever sweep";
}

TEST_F(SweepProgram, KeepsTheRowsOfAFailedSolveAndSaysWhy) {
  write_sweep(std::string(kThicknesses) + "fem = true\n");
  start.environment.push_back("FAKE_FEM_CRASH_N=5");
  const ProgramRun failed = sweep();
  EXPECT_EQ(failed.status, 1);
  EXPECT_NE(failed.err.find("6 of 12 finite-element results are missing"), std::string::npos)
      << failed.err;
  const auto rows = lines(file_text(output / "results.csv"));
  ASSERT_EQ(rows.size(), 13u);
  EXPECT_NE(rows[2].find("killed by signal 9"), std::string::npos) << rows[2];
  start.environment.pop_back();
  EXPECT_EQ(sweep().status, 0);
  EXPECT_EQ(lines(file_text(output / "results.csv"))[2].find("killed"), std::string::npos);
}

TEST_F(SweepProgram, IsInterruptedCleanlyAndContinues) {
  write_sweep("\"layer.thickness_mm\" = { from = 1, to = 6, steps = 1000000 }\n");
  for (const int number : {SIGINT, SIGKILL}) {
    const pid_t process = start_softfinger(
        start, {"sweep", "sweep.toml", "--output", output.string(), "--jobs", "2"});
    const fs::path partial = output / "results.partial.csv";
    std::error_code error;
    const auto before = fs::exists(partial) ? fs::file_size(partial) : 0;
    for (int i = 0;
         i < 1000 && (!fs::exists(partial) || fs::file_size(partial, error) < before + (1u << 20));
         ++i)
      usleep(10000);
    kill(process, number);
    const ProgramRun run = wait_for(start, process);
    EXPECT_EQ(run.status, number == SIGINT ? 130 : -SIGKILL);
    EXPECT_FALSE(fs::exists(output / "results.csv"));
    EXPECT_GT(fs::file_size(partial), before + 1000);
  }
  // Not to the end: the same rows follow, wherever it goes on.
  const std::string partial = file_text(output / "results.partial.csv");
  const auto rows = lines(partial.substr(0, partial.rfind('\n') + 1));
  for (std::size_t row = 1; row < rows.size(); ++row)
    ASSERT_EQ(rows[row].rfind(std::to_string((row - 1) / 2) + ",", 0), 0u) << rows[row];
}

TEST_F(SweepProgram, MakesFinishedRowsAgainThatWereChanged) {
  write_sweep(kThicknesses);
  ASSERT_EQ(sweep().status, 0);
  const std::string whole = file_text(output / "results.csv");
  const ProgramRun reused = sweep();
  EXPECT_NE(reused.err.find("is finished: reused"), std::string::npos) << reused.err;
  std::string digit = whole;
  digit[digit.find_last_of("123456789")] ^= 1;
  for (const std::string& changed : {whole.substr(0, whole.find('\n') + 1), digit, whole + "x\n",
                                     whole.substr(0, whole.size() - 1)}) {
    folder.write("out/results.csv", changed);
    const ProgramRun again = sweep();
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_NE(again.err.find("was changed after it had been written: made again"),
              std::string::npos)
        << again.err;
    EXPECT_EQ(file_text(output / "results.csv"), whole);
  }
}

TEST_F(SweepProgram, GoesOnBeforeTheFirstRowThatWasChanged) {
  write_sweep("\"layer.thickness_mm\" = { from = 1, to = 6, steps = 20000 }\n");
  ASSERT_EQ(sweep().status, 0);
  const std::string whole = file_text(output / "results.csv");
  fs::remove_all(output);
  const pid_t process =
      start_softfinger(start, {"sweep", "sweep.toml", "--output", output.string(), "--jobs", "1"});
  const fs::path partial = output / "results.partial.csv";
  // The sweep's identity, the header and a chunk of rows are noted in it. A sanitized program on a
  // busy machine needs seconds for that.
  for (int i = 0; i < 600000 && lines(file_text(output / "results.partial.check")).size() < 3; ++i)
    usleep(100);
  kill(process, SIGKILL);
  wait_for(start, process);
  ASSERT_TRUE(fs::exists(partial));
  std::string text = file_text(partial);
  const std::size_t changed = text.find("\n101,");
  ASSERT_NE(changed, std::string::npos);
  folder.write("out/results.partial.csv", text.replace(changed + 1, 3, "99,garbage"));
  const ProgramRun again = sweep();
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.err.find("rows were changed"), std::string::npos) << again.err;
  EXPECT_EQ(file_text(output / "results.csv"), whole);
}

TEST_F(SweepProgram, MakesRowsAgainOfAMeshWithAnotherContentAndTheSameTime) {
  const fs::path tip = folder.path() / "tip.stl", meshes = fs::path(SOFTFINGER_SHARE) / "meshes";
  if (!fs::exists(meshes / "sphere.stl")) GTEST_SKIP() << "the build has no meshes";
  fs::copy_file(meshes / "shadow_like_pad.stl", tip);
  const auto time = fs::last_write_time(tip);
  folder.write("sweep.toml",
               "id = \"stale\"\n[geometry]\nfinger = { mesh = \"tip.stl\", along = \"-y\" }\n"
               "object = { radii_mm = [inf, inf] }\n[layer]\nthickness_mm = 2\n"
               "youngs_modulus_kPa = 300\npoisson_ratio = 0.45\n[contact]\nload_N = 1\n"
               "friction_coefficient = 0.8\n[sweep]\n\"contact.load_N\" = [1, 2]\nmodels = "
               "[\"bonded_layer\"]\n");
  ASSERT_EQ(sweep().status, 0);
  const std::string before = file_text(output / "results.csv");
  fs::copy_file(meshes / "sphere.stl", tip, fs::copy_options::overwrite_existing);
  fs::last_write_time(tip, time);
  const ProgramRun again = sweep();
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.err.find("reused"), std::string::npos) << again.err;
  EXPECT_NE(file_text(output / "results.csv"), before);
  EXPECT_NE(sweep().err.find("reused"), std::string::npos);
}

TEST_F(SweepProgram, PutsNoMessageAmongTheRowsWhenDescriptorsAreClosed) {
  write_sweep("\"layer.thickness_mm\" = { from = 1, to = 6, steps = 3 }\n");
  const std::string command = "cd '" + folder.path().string() +
                              "' && " SOFTFINGER_PROGRAM
                              " sweep sweep.toml -o out <&- 2>&- > answer";
  EXPECT_EQ(std::system(command.c_str()), 0);
  const std::string rows = file_text(output / "results.csv");
  EXPECT_EQ(rows.find("softfinger"), std::string::npos) << rows;
  fs::remove_all(output);
  ASSERT_EQ(sweep().status, 0);
  EXPECT_EQ(file_text(output / "results.csv"), rows);
}

TEST_F(SweepProgram, RefusesBadSweepsInOneLine) {
  write_sweep("\"layer.poisson_ratio\" = [0.3, 0.7]\n");
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"sweep", "sweep.toml"},
                                             {"sweep", "missing.toml"},
                                             {"sweep", "sweep.toml", "--jobs", "0"}}) {
    const ProgramRun run = run_softfinger(start, arguments);
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
    EXPECT_FALSE(fs::exists(folder.path() / "softfinger-sweep"));
  }
}

class AtlasProgram : public SweepProgram {
 protected:
  ProgramRun atlas(const char* jobs = "2") {
    return run_softfinger(start, {"atlas", "--random", "3", "--folder", output.string(), "--jobs",
                                  jobs, "--output", (folder.path() / "atlas.csv").string()});
  }
  fs::path one_result() const {
    for (const auto& entry : fs::directory_iterator(output))
      if (entry.path().extension() == ".json") return entry.path();
    return {};
  }
};

TEST_F(AtlasProgram, BelievesNoResultThatIsDamagedOrAnotherPrograms) {
  ASSERT_EQ(atlas().status, 0);
  EXPECT_EQ(solves(), 3);
  EXPECT_EQ(atlas().status, 0);
  EXPECT_EQ(solves(), 3);
  const json saved = json::parse(file_text(one_result()));
  int solved = 3;
  for (const json& damage :
       {json{{"result", {{"a_m", -1e-3}}}}, json{{"result", {{"levels", nullptr}}}},
        json{{"result", {{"error", nullptr}}}}, json{{"program", "older"}},
        json{{"program", nullptr}}}) {
    json damaged = saved;
    damaged.merge_patch(damage);
    const fs::path file = one_result();
    folder.write("out/" + file.filename().string(), damaged.dump());
    const ProgramRun again = atlas();
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(solves(), ++solved) << damage;
    EXPECT_NE(again.err.find("made again, it cannot be used"), std::string::npos) << again.err;
  }
}

TEST_F(AtlasProgram, AsksModelsOfAFileWithoutFlatRuns) {
  ASSERT_EQ(atlas().status, 0);
  std::string text = file_text(folder.path() / "atlas.csv");
  std::string without;
  for (const std::string& line : lines(text))
    if (line.rfind("flat,", 0) != 0) without += line + "\n";
  folder.write("atlas.csv", without);
  const ProgramRun run = run_softfinger(
      start, {"atlas", "--models-only", "--output", (folder.path() / "atlas.csv").string()});
  EXPECT_EQ(run.status, 0) << run.err;
}

TEST_F(AtlasProgram, SaysByWhichSignalItWasInterrupted) {
  start.environment.push_back("FAKE_FEM_SLOW_S=30");
  const pid_t process = start_softfinger(
      start, {"atlas", "--random", "3", "--folder", output.string(), "--jobs", "1"});
  for (int i = 0; i < 1000 && solves() < 1; ++i) usleep(10000);
  kill(process, SIGINT);
  EXPECT_EQ(wait_for(start, process).status, 130);
}

#ifdef SOFTFINGER_SWEEP_PROGRAM

/// Four ranks on whatever cores there are.
class SweepOnRanks : public SweepProgram {
 protected:
  std::string command(const std::string& arguments) const {
    std::string line = "cd " + folder.path().string() +
                       " && exec env SOFTFINGER_FEM_PROGRAM=" + SOFTFINGER_FAKE_FEM;
    for (const auto& entry : start.environment) line += " " + entry;
    // Containers and CI run as root, on fewer cores than ranks.
    return line +
           " OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --oversubscribe -np "
           "4 " +
           SOFTFINGER_SWEEP_PROGRAM + " " + arguments + " > out.txt 2> err.txt < /dev/null";
  }
  int run(const std::string& arguments) const {
    const int status = std::system(command(arguments).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string messages() const { return file_text(folder.path() / "err.txt"); }
};

TEST_F(SweepOnRanks, HasTheRowsOfASingleProcess) {
  write_sweep(std::string(kThicknesses) + "fem = true\n");
  ASSERT_EQ(run("sweep.toml --output ranks"), 0) << messages();
  EXPECT_EQ(solves(), 12) << "each problem once";
  ASSERT_EQ(sweep().status, 0);
  EXPECT_EQ(file_text(folder.path() / "ranks" / "results.csv"), file_text(output / "results.csv"));
  EXPECT_EQ(run("sweep.toml --output ranks"), 0) << messages();
  EXPECT_EQ(solves(), 24) << "a run that finds all there ends at once";
}

TEST_F(SweepOnRanks, HasTheRowsOfManyPoints) {
  write_sweep("\"layer.thickness_mm\" = { from = 1, to = 6, steps = 45000 }\n");
  ASSERT_EQ(run("sweep.toml --output ranks"), 0) << messages();
  ASSERT_EQ(sweep().status, 0);
  EXPECT_EQ(file_text(folder.path() / "ranks" / "results.csv"), file_text(output / "results.csv"));
  for (const auto& entry : fs::directory_iterator(folder.path() / "ranks"))
    EXPECT_NE(entry.path().filename().string().rfind("rows_", 0), 0u) << "left behind";
}

TEST_F(SweepOnRanks, DoesWhatIsMissingAfterARankWasKilled) {
  write_sweep(std::string(kThicknesses) + "fem = true\n");
  start.environment.push_back("FAKE_FEM_SLOW_S=0.3");
  const pid_t shell = fork();
  if (shell == 0) {
    execl("/bin/sh", "sh", "-c", command("sweep.toml --output killed").c_str(), nullptr);
    _exit(127);
  }
  for (int i = 0; i < 1000 && solves() < 6; ++i) usleep(10000);
  // A rank that is no launcher: the last one started. No other test's output has this name.
  const std::string ranks = std::string(SOFTFINGER_SWEEP_PROGRAM) + " sweep.toml --output killed";
  std::system(("pkill -KILL -n -f '^" + ranks + "'").c_str());
  int status = 0;
  waitpid(shell, &status, 0);
  EXPECT_NE(status, 0) << "MPI ends the run";
  const int done = static_cast<int>(std::distance(
      fs::directory_iterator(folder.path() / "killed" / "fem"), fs::directory_iterator()));
  EXPECT_LT(done, 12);
  start.environment.pop_back();
  const int before = solves();
  ASSERT_EQ(run("sweep.toml --output killed"), 0) << messages();
  EXPECT_EQ(solves() - before, 12 - done) << "exactly what is missing";
  EXPECT_EQ(lines(file_text(folder.path() / "killed" / "results.csv")).size(), 13u);
}

TEST_F(SweepOnRanks, EndsWithOneWhenSomeSolvesFail) {
  write_sweep(std::string(kThicknesses) + "fem = true\n");
  start.environment.push_back("FAKE_FEM_CRASH_N=5");
  EXPECT_EQ(run("sweep.toml --output ranks"), 1);
  EXPECT_NE(messages().find("6 of 12 finite-element results are missing"), std::string::npos)
      << messages();
  EXPECT_EQ(lines(file_text(folder.path() / "ranks" / "results.csv")).size(), 13u);
}

TEST_F(SweepOnRanks, MakesTheAtlas) {
  ASSERT_EQ(run("--atlas atlas.csv --random 5 --output runs"), 0) << messages();
  EXPECT_EQ(solves(), 5);
  int rows = 0;
  for (const std::string& line : lines(file_text(folder.path() / "atlas.csv")))
    rows += line.rfind("flat,", 0) == 0;
  EXPECT_EQ(rows, 5);
}

TEST_F(SweepOnRanks, RefusesBadInput) {
  write_sweep("\"layer.poisson_ratio\" = [0.3, 0.7]\n");
  EXPECT_EQ(run("sweep.toml --output ranks"), 2);
  EXPECT_NE(messages().find("poisson_ratio = 0.7"), std::string::npos) << messages();
  EXPECT_EQ(run("--output ranks"), 2);
  EXPECT_EQ(run("--atlas atlas.csv --tolerance 0.05 --output ranks"), 2) << "the atlas judges none";
}

#endif

}  // namespace softfinger::tests
