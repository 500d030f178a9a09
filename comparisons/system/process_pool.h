#pragma once

#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

/// Runs child processes in parallel, collects their output and stops them on Ctrl-C.
namespace softfinger::system {

struct ProcessJob {
  std::vector<std::string> command;      ///< program and arguments
  std::string input;                     ///< standard input, at most 1 MB
  std::vector<std::string> environment;  ///< "NAME=value", on top of this process's own
  std::vector<std::string> hidden = {};  ///< variables whose names begin so are not passed on
  /// The longest time between two lines on standard output, or before the first one. A process that
  /// takes longer is killed.
  double time_limit_s = std::numeric_limits<double>::infinity();
  /// The largest resident memory, checked four times a second.
  double memory_limit_MB = std::numeric_limits<double>::infinity();
};

enum class ProcessLimit { none, time, memory };

struct ProcessOutcome {
  int exit_status = -1;  ///< -1 when killed by `signal`
  int signal = 0;
  ProcessLimit exceeded = ProcessLimit::none;  ///< the limit for which it was killed
  std::string output;                          ///< standard output, whole
  std::string last_line;                       ///< of standard error
  double wall_s = 0;

  bool succeeded() const { return exit_status == 0; }
};

struct ProcessCallbacks {
  /// A line on a child's standard error.
  std::function<void(std::size_t job, const std::string& line)> on_line = [](auto, const auto&) {};
  /// A whole line on a child's standard output. Lines that the child wrote on standard error before
  /// it are passed on first. `on_output` and `on_finish` may throw: all children are then stopped,
  /// and the exception is passed on.
  std::function<void(std::size_t job, const std::string& line)> on_output = [](auto, const auto&) {
  };
  std::function<void(std::size_t job)> on_start = [](auto) {};
  std::function<void(std::size_t job, const ProcessOutcome&)> on_finish = [](auto, const auto&) {};
};

/// Ctrl-C or a request to end: the program's exit status is then 128 + signal.
struct Interrupted : std::runtime_error {
  explicit Interrupted(int number) : std::runtime_error("interrupted"), signal(number) {}
  int signal;
};

/// Effect of SIGINT on the children.
enum class OnInterrupt {
  stop,   ///< ends them, like SIGTERM
  finish  ///< passes it on, starts no more and waits for results; a second SIGINT ends them
};

/// Starts the jobs in their order, at most `parallel` at once. SIGTERM stops all children and ends
/// the call; SIGINT does what `on_interrupt` says. The children are also stopped if this process
/// dies.
/// @returns 0, or the signal that interrupted.
/// @throws InputError when a program cannot be started.
int run_processes(const std::vector<ProcessJob>& jobs, int parallel,
                  const ProcessCallbacks& callbacks, OnInterrupt on_interrupt = OnInterrupt::stop);

}  // namespace softfinger::system
