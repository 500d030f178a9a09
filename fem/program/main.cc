// softfinger-fem: one contact in, one JSON object out; or an array of contacts in, a line of JSON
// for each out. The format is in README.md beside this file.

#include <malloc.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>

#include "fem/base/blas_memory.h"
#include "fem/base/memory.h"
#include "fem/base/threads.h"
#include "fem/linear/model_cache.h"
#include "fem/pad/solve_pad.h"
#include "fem/program/pad_json.h"
#include "fem/program/read_pad.h"
#include "fem/program/read_problem.h"
#include "fem/program/reference_solver.h"
#include "fem/program/result_json.h"
#include "meshes/generation/layer_mesh.h"
#include "meshes/io/output_file.h"
#include "meshes/io/read_surface.h"
#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/visible_text.h"

namespace {

using nlohmann::json;
namespace fem = softfinger::fem;
namespace meshes = softfinger::meshes;

/// More than any list of problems; a stream without end is refused before memory is full.
constexpr std::size_t kLargestInput = 64 << 20;

std::string read(const std::string& path) {
  if (path != "-")
    return meshes::read_whole_file(path, "problem", "a file that can be read", kLargestInput);
  std::string text;
  char part[1 << 16];
  while (std::cin.read(part, sizeof part), std::cin.gcount() > 0) {
    text.append(part, static_cast<std::size_t>(std::cin.gcount()));
    if (text.size() > kLargestInput)
      throw softfinger::InputError("standard input", "problem", "larger than 64 MB",
                                   "at most 64 MB");
  }
  return text;
}

const fem::MeshReaders& mesh_readers() {
  static const fem::MeshReaders readers = {
      [](const std::string& path, double metres_per_unit) {
        return meshes::read_surface(path, metres_per_unit).surface;
      },
      [](const std::string& path, double metres_per_unit, const std::vector<std::string>& regions) {
        return std::make_shared<const meshes::LayerMesh>(
            meshes::read_layer_mesh(path, metres_per_unit, regions));
      }};
  return readers;
}

// A signal handler can reach nothing but a global. It runs on any thread, and any thread asks.
std::atomic<bool> g_stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

/// The first Ctrl-C ends the work after its present stage, with the results so far. The second one
/// ends the program at once.
void stop_when_convenient() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
}

/// Exit status, as README.md lists them.
constexpr int bad_input = 2, not_converged = 3, interrupted = 128 + SIGINT;

struct Failure {
  int exit_status;
  std::string message;
};

/// Runs `work`. An exception becomes an exit status and one line.
template <class Work>
std::optional<Failure> failure_of(const Work& work) {
  const auto failure = [](int exit_status, std::string message) {
    // A library's message may run over many lines; the contract is one.
    std::replace(message.begin(), message.end(), '\n', ' ');
    return Failure{exit_status, std::move(message)};
  };
  try {
    work();
    return std::nullopt;
  } catch (const softfinger::InputError& error) {
    return failure(bad_input, std::string("error: ") + error.what());
  } catch (const softfinger::ConvergenceError& error) {
    return failure(not_converged, std::string("error: ") + error.what());
  } catch (const fem::Interrupted& error) {
    return failure(interrupted, error.what());
  } catch (const std::bad_alloc&) {
    return failure(not_converged, "error: out of memory");
  } catch (const std::exception& error) {
    return failure(not_converged, std::string("error: ") + error.what());
  }
}

/// Meshes of earlier problems that may serve later ones.
struct Kept {
  fem::ModelCache models;
  fem::PadCache pads{};
};

void answer(const json& input, const std::string& prefix, Kept& kept) {
  const auto progress = [&](const std::string& line) { std::cerr << prefix << line << std::endl; };
  const auto stop = [] { return g_stop.load(); };
  json output;
  if (fem::is_pad(input)) {
    const fem::PadProblem problem = fem::read_pad(input);
    output = fem::to_json(problem, fem::solve_pad(problem, progress, stop, &kept.pads));
  } else {
    const fem::Problem problem = fem::read_problem(input, mesh_readers());
    output = fem::to_json(problem, fem::solve(problem, progress, stop, &kept.models));
  }
  std::cout << output.dump() << std::endl;
  if (!std::cout) throw softfinger::InputError("standard output", "result", "", "a place to write");
}

/// Name of a problem for messages, "problem" if it has none.
std::string name_of(const json& input) {
  const bool is_named = input.is_object() && input.contains("name") && input.at("name").is_string();
  return is_named ? input.at("name").get<std::string>() : "problem";
}

/// One line per problem, as it is done. A problem that fails does not end the run.
/// @returns the worst exit status of all
int answer_all(const json& inputs) {
  // Loads come the largest first, so that the latest meshes are the ones that may serve; a pair of
  // them holds about 150 MB. A single problem has no use for what it would leave behind.
  constexpr std::size_t kept_pairs = 2;
  Kept kept{fem::ModelCache(inputs.size() > 1 ? kept_pairs : 0)};
  int exit_status = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string prefix =
        "fem: " + std::to_string(i + 1) + "/" + std::to_string(inputs.size()) + ": ";
    const auto failure = failure_of([&] { answer(inputs[i], prefix, kept); });
    if (!failure) continue;
    exit_status = std::max(exit_status, failure->exit_status);
    if (failure->exit_status == interrupted) break;
    std::cout << json({{"name", name_of(inputs[i])},
                       {"failure", failure->message},
                       {"exit_status", failure->exit_status}})
                     .dump()
              << std::endl;
  }
  return exit_status;
}

/// Dense matrices of tens of megabytes come and go: kept by the process, their pages are not zeroed
/// by the system each time. One arena: what one thread frees another one takes.
void keep_freed_memory() {
  constexpr int larger_than_any = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, larger_than_any);
  mallopt(M_TRIM_THRESHOLD, larger_than_any);
  mallopt(M_ARENA_MAX, 1);
}

/// Answers one problem or an array of them. @returns the exit status
int answer_file(const std::string& path) {
  const json input = fem::parse_problems(read(path), path == "-" ? "standard input" : path);
  stop_when_convenient();
  // Tasks side by side need their memory at the same time: how much is available would otherwise
  // decide about the answer.
  constexpr double enough_for_two_MB = 4096;
  std::optional<fem::ThreadLimit> one_thread;
  if (fem::available_memory_MB() < enough_for_two_MB) one_thread.emplace(1);
  fem::reserve_blas_memory();
  if (input.is_array()) return answer_all(input);
  Kept nothing{fem::ModelCache(0)};
  answer(input, "fem: ", nothing);
  return 0;
}

}  // namespace

int main(int argument_count, char** arguments) {
  meshes::open_standard_descriptors();
  keep_freed_memory();
  if (argument_count != 2) {
    std::cerr << "usage: softfinger-fem PROBLEM.json (or - for standard input)\n";
    return bad_input;
  }
  int exit_status = 0;
  const auto failure = failure_of([&] { exit_status = answer_file(arguments[1]); });
  if (!failure) return exit_status;
  std::cerr << "softfinger-fem: " << softfinger::visible_text(failure->message) << std::endl;
  // A thread of OpenBLAS may ask for memory in an endless loop where it is short: an ordinary exit
  // would wait for that thread.
  std::_Exit(failure->exit_status);
}
