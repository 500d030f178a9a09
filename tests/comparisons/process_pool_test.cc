#include "comparisons/system/process_pool.h"

#include <gtest/gtest.h>

#include <chrono>
#include <map>

#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

system::ProcessJob shell(const std::string& script, const std::string& input = "") {
  return {{"/bin/sh", "-c", script}, input, {}};
}

std::map<std::size_t, system::ProcessOutcome> outcomes(const std::vector<system::ProcessJob>& jobs,
                                                       int parallel) {
  std::map<std::size_t, system::ProcessOutcome> result;
  system::ProcessCallbacks callbacks;
  callbacks.on_finish = [&](std::size_t job, const system::ProcessOutcome& outcome) {
    result[job] = outcome;
  };
  EXPECT_EQ(system::run_processes(jobs, parallel, callbacks), 0);
  return result;
}

}  // namespace

TEST(ProcessPool, CollectsOutputStatusAndLastLine) {
  const auto result = outcomes({shell("cat; echo one >&2; echo two >&2; exit 3", "problem"),
                                shell("printf 'no newline' >&2"), shell("kill -SEGV $$")},
                               2);
  EXPECT_EQ(result.at(0).output, "problem");
  EXPECT_EQ(result.at(0).last_line, "two");
  EXPECT_EQ(result.at(0).exit_status, 3);
  EXPECT_EQ(result.at(1).last_line, "no newline");
  EXPECT_TRUE(result.at(1).succeeded());
  EXPECT_EQ(result.at(2).signal, 11);
  EXPECT_FALSE(result.at(2).succeeded());
}

TEST(ProcessPool, TakesOutputThatIsLargerThanAPipe) {
  const auto result = outcomes({shell("head -c 3000000 /dev/zero | tr '\\0' x")}, 1);
  EXPECT_EQ(result.at(0).output.size(), 3000000u);
}

TEST(ProcessPool, TakesInputThatIsLargerThanAUsualPipe) {
  const auto result = outcomes({shell("wc -c", std::string(500000, 'x'))}, 1);
  EXPECT_EQ(std::stoi(result.at(0).output), 500000);
}

TEST(ProcessPool, PassesLinesOfOutputOnAsTheyCome) {
  std::vector<std::string> seen;
  system::ProcessCallbacks callbacks;
  callbacks.on_output = [&](std::size_t, const std::string& line) {
    seen.push_back(line);
    if (line == "first") throw std::runtime_error("stop");
  };
  // The process would go on for half a minute: its first line comes before its end.
  EXPECT_THROW(system::run_processes({shell("echo first; sleep 30; echo second")}, 1, callbacks),
               std::runtime_error);
  EXPECT_EQ(seen, std::vector<std::string>{"first"});
}

TEST(ProcessPool, RunsNoMoreAtOnceThanAsked) {
  std::size_t running = 0, most = 0;
  system::ProcessCallbacks callbacks;
  callbacks.on_start = [&](std::size_t) { most = std::max(most, ++running); };
  callbacks.on_finish = [&](std::size_t, const system::ProcessOutcome&) { --running; };
  system::run_processes(std::vector<system::ProcessJob>(7, shell("sleep 0.02")), 3, callbacks);
  EXPECT_EQ(most, 3u);
  EXPECT_EQ(running, 0u);
}

TEST(ProcessPool, GivesAJobItsOwnEnvironment) {
  system::ProcessJob job = shell("echo $OMP_NUM_THREADS");
  job.environment = {"OMP_NUM_THREADS=1"};
  EXPECT_EQ(outcomes({job}, 1).at(0).output, "1\n");
}

TEST(ProcessPool, HidesVariablesFromAJob) {
  setenv("SOFTFINGER_TEST_RANK", "3", 1);
  system::ProcessJob job = shell("echo ${SOFTFINGER_TEST_RANK:-none}");
  job.hidden = {"SOFTFINGER_TEST_"};
  EXPECT_EQ(outcomes({job}, 1).at(0).output, "none\n");
}

TEST(ProcessPool, EndsAJobThatIsSilentForTooLong) {
  system::ProcessJob job = shell("echo 1; sleep 0.6; echo 2; sleep 0.6; echo 3; sleep 30; echo 4");
  job.time_limit_s = 1;
  const system::ProcessOutcome outcome = outcomes({job}, 1).at(0);
  EXPECT_EQ(outcome.exceeded, system::ProcessLimit::time);
  EXPECT_EQ(outcome.output, "1\n2\n3\n") << "each line starts the time anew";
}

TEST(ProcessPool, NamesAProgramThatCannotBeStarted) {
  try {
    system::run_processes({{{"/nonexistent/program"}, "", {}}}, 1, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.where(), "/nonexistent/program");
  }
}

TEST(ProcessPool, StopsTheOthersWhenACallbackThrows) {
  system::ProcessCallbacks callbacks;
  callbacks.on_finish = [](std::size_t, const system::ProcessOutcome&) {
    throw std::runtime_error("disk");
  };
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THROW(system::run_processes({shell("sleep 30"), shell("true")}, 2, callbacks),
               std::runtime_error);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

}  // namespace softfinger
