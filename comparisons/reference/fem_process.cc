#include "comparisons/reference/fem_process.h"

#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <cstring>

#include "comparisons/reference/size_hint.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::reference {

namespace {

/// The error of the problem that a process was at when it ended before its time.
FemDocument failure_of(const system::ProcessOutcome& outcome, const FemLimits& limits) {
  FemDocument answer;
  // Whatever else a crashed program returns, for the user the numerics failed.
  answer.exit_status = outcome.exit_status == 2 ? 2 : kNotConverged;
  if (outcome.exceeded == system::ProcessLimit::time) {
    answer.failure = fmt::format("softfinger-fem was ended after {:g} s, its limit (--fem-time-s)",
                                 limits.time_s);
  } else if (outcome.exceeded == system::ProcessLimit::memory) {
    answer.failure = fmt::format(
        "softfinger-fem was ended as it took more than {:g} MB, its limit "
        "(--fem-memory-MB)",
        limits.memory_MB);
  } else if (outcome.signal != 0) {
    answer.failure = fmt::format(
        "softfinger-fem was killed by signal {} ({}){}", outcome.signal, strsignal(outcome.signal),
        outcome.signal == 9 ? "; often this means that memory ran out" : "");
  } else if (outcome.exit_status == 0) {
    answer.failure = "softfinger-fem ended without a complete result";
  } else {
    answer.failure = outcome.last_line.empty() ? "it did not say why" : outcome.last_line;
    for (const char* prefix : {"softfinger-fem: ", "error: "})
      if (answer.failure.rfind(prefix, 0) == 0) answer.failure.erase(0, std::strlen(prefix));
  }
  return answer;
}

/// The line that a process writes for each of its problems: a result, or its error under the key
/// "failure".
FemDocument document_of(const std::string& line) {
  FemDocument answer;
  answer.document = text::parse_json(line);
  if (!answer.document.is_object() || !answer.document.contains("failure")) return answer;
  answer.failure = answer.document.value("failure", "");
  if (answer.failure.rfind("error: ", 0) == 0) answer.failure.erase(0, std::strlen("error: "));
  answer.exit_status = answer.document.value("exit_status", kNotConverged);
  answer.document = nullptr;
  return answer;
}

/// A line of progress such as "fem: 2/3: text", which is about the second of three problems.
/// @param problem  index of the first problem of the process; becomes that of the line's own
/// @returns the text
std::string text_of(const std::string& line, std::size_t& problem) {
  std::size_t number = 0;
  int length = 0;
  if (std::sscanf(line.c_str(), "fem: %zu/%*u: %n", &number, &length) != 1 || length == 0)
    return line;
  problem += number - 1;
  return line.substr(static_cast<std::size_t>(length));
}

/// The process that takes an array of problems, one line each as the answer.
system::ProcessJob fem_job(const std::string& program, const nlohmann::json& problems,
                           bool single_thread, const FemLimits& limits) {
  system::ProcessJob job;
  job.command = {program, "-"};
  job.input = problems.dump() + "\n";
  // The program has threads of its own, so the linear algebra gets none.
  job.environment = {"OPENBLAS_NUM_THREADS=1", "OMP_NUM_THREADS=1"};
  if (single_thread) job.environment.push_back("DEAL_II_NUM_THREADS=1");
  // Under mpirun this program is a rank; the finite elements are not.
  job.hidden = {"OMPI_", "PMIX_", "PMI_"};
  job.time_limit_s = limits.time_s;
  job.memory_limit_MB = limits.memory_MB;
  return job;
}

FemAnswer answer_of(FemDocument given) {
  if (!given.failure.empty()) return {std::nullopt, given.failure, given.exit_status};
  ReadReferenceResult read = read_reference_result(given.document);
  if (read.result) return {std::move(read.result), "", 0};
  return {std::nullopt, "softfinger-fem gave no result to believe: " + read.flaw, kNotConverged};
}

}  // namespace

int run_fem(const std::string& program, const std::vector<FemBatch>& batches, int parallel,
            const FemCallbacks& callbacks, system::OnInterrupt on_interrupt) {
  std::vector<FemDocuments> documents;
  for (const FemBatch& batch : batches) {
    documents.push_back({{}, batch.single_thread, batch.limits});
    for (const FemProblem& problem : batch.problems) {
      nlohmann::json& input = documents.back().problems.emplace_back(process_input(problem));
      if (const auto hint = size_hint_m(problem)) input["size_hint_m"] = *hint;
    }
  }
  FemDocumentCallbacks of_documents;
  of_documents.on_line = callbacks.on_line;
  of_documents.on_answer = [&](FemIndex index, FemDocument given) {
    callbacks.on_answer(index, answer_of(std::move(given)));
  };
  return run_fem_documents(program, documents, parallel, of_documents, on_interrupt);
}

int run_fem_documents(const std::string& program, const std::vector<FemDocuments>& batches,
                      int parallel, const FemDocumentCallbacks& callbacks,
                      system::OnInterrupt on_interrupt) {
  std::vector<std::size_t> answered(batches.size(), 0);
  // A crash ends its process: the problems behind it go to a new one.
  while (true) {
    std::vector<system::ProcessJob> jobs;
    std::vector<std::size_t> batch_of, first;
    for (std::size_t batch = 0; batch < batches.size(); ++batch) {
      const auto& problems = batches[batch].problems;
      if (answered[batch] == problems.size()) continue;
      const nlohmann::json left(std::vector<nlohmann::json>(
          problems.begin() + std::ptrdiff_t(answered[batch]), problems.end()));
      jobs.push_back(fem_job(program, left, batches[batch].single_thread, batches[batch].limits));
      batch_of.push_back(batch);
      first.push_back(answered[batch]);
    }
    if (jobs.empty()) return 0;
    const auto answer = [&](std::size_t job, FemDocument given) {
      const std::size_t batch = batch_of[job];
      if (answered[batch] == batches[batch].problems.size()) return;  // nobody asked
      callbacks.on_answer({batch, answered[batch]++}, std::move(given));
    };
    bool stopping = false;
    system::ProcessCallbacks processes;
    processes.on_line = [&](std::size_t job, const std::string& line) {
      FemIndex index{batch_of[job], first[job]};
      const std::string text = text_of(line, index.problem);
      if (index.problem < batches[index.batch].problems.size()) callbacks.on_line(index, text);
    };
    processes.on_output = [&](std::size_t job, const std::string& line) {
      answer(job, document_of(line));
    };
    processes.on_finish = [&](std::size_t job, const system::ProcessOutcome& outcome) {
      // Interrupted, it leaves out what it has not begun.
      if (outcome.exit_status == 128 + SIGINT) stopping = true;
      const std::size_t batch = batch_of[job];
      if (!stopping && answered[batch] < batches[batch].problems.size())
        answer(job, failure_of(outcome, batches[batch].limits));
    };
    if (const int signal = system::run_processes(jobs, parallel, processes, on_interrupt))
      return signal;
    if (stopping) return SIGINT;
  }
}

std::string load_folder(const std::string& case_id, double load_N) {
  return fmt::format("{}_{}N", case_id, load_N);
}

}  // namespace softfinger::reference
