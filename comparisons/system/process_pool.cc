#include "comparisons/system/process_pool.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>

#include "softfinger/input/errors.h"

extern char** environ;

namespace softfinger::system {
namespace {

using Clock = std::chrono::steady_clock;

class Descriptor {
 public:
  Descriptor() = default;
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { reset(); }
  void reset(int number = -1) {
    if (number_ >= 0) close(number_);
    number_ = number;
  }
  int get() const { return number_; }

 private:
  int number_ = -1;
};

struct Pipe {
  Descriptor read_end, write_end;
  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
      throw InputError("pipe", std::string("cannot be opened (") + std::strerror(errno) + ")", "",
                       "");
    read_end.reset(ends[0]);
    write_end.reset(ends[1]);
  }
};

// A global, because a signal handler has no other way to reach the pipe.
int g_signal_pipe = -1;

extern "C" void remember_signal(int number) {
  const int saved = errno;
  const char byte = static_cast<char>(number);
  if (g_signal_pipe >= 0 && write(g_signal_pipe, &byte, 1) < 0) {
    // The pipe is full of earlier signals, which have the same effect: nothing is lost.
  }
  errno = saved;
}

/// While it exists, SIGINT and SIGTERM become bytes in a pipe, which `poll` can wait for.
class SignalWatch {
 public:
  SignalWatch() {
    fcntl(pipe_.write_end.get(), F_SETFL, O_NONBLOCK);
    outer_pipe_ = g_signal_pipe;
    g_signal_pipe = pipe_.write_end.get();
    struct sigaction action = {};
    action.sa_handler = remember_signal;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, &old_interrupt_);
    sigaction(SIGTERM, &action, &old_terminate_);
  }
  ~SignalWatch() {
    sigaction(SIGINT, &old_interrupt_, nullptr);
    sigaction(SIGTERM, &old_terminate_, nullptr);
    g_signal_pipe = outer_pipe_;
  }
  int descriptor() const { return pipe_.read_end.get(); }
  int take() const {
    char byte = 0;
    return read(descriptor(), &byte, 1) == 1 ? byte : 0;
  }

 private:
  Pipe pipe_;
  int outer_pipe_ = -1;  ///< of processes among which these run, such as a mesh's reader
  struct sigaction old_interrupt_ = {}, old_terminate_ = {};
};

class Child {
 public:
  Child(std::size_t job_index, const ProcessJob& job)
      : index(job_index),
        start_(Clock::now()),
        last_output_(start_),
        time_limit_s_(job.time_limit_s),
        memory_limit_MB_(job.memory_limit_MB) {
    Pipe input, output, errors, failure;
    // All input is written before the process starts, so that nothing has to be fed later and
    // nothing can block. For that it must fit into the pipe's buffer, which is enlarged for long
    // inputs, up to the size that the system allows every user.
    constexpr std::size_t usual_buffer = 1 << 16;
    if (job.input.size() > usual_buffer)
      fcntl(input.write_end.get(), F_SETPIPE_SZ, static_cast<int>(job.input.size()));
    fcntl(input.write_end.get(), F_SETFL, O_NONBLOCK);
    if (write(input.write_end.get(), job.input.data(), job.input.size()) !=
        static_cast<ssize_t>(job.input.size()))
      throw InputError(job.command[0], "the problem is too long for a pipe", "", "");

    // All memory is allocated before the fork: allocating in the child could deadlock.
    std::vector<char*> arguments, environment;
    for (const auto& word : job.command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    for (char** entry = environ; *entry; ++entry) {
      const auto replaces = [&](const std::string& own) {
        return std::strncmp(own.c_str(), *entry, own.find('=') + 1) == 0;
      };
      const auto hides = [&](const std::string& start) {
        return std::strncmp(start.c_str(), *entry, start.size()) == 0;
      };
      if (std::none_of(job.environment.begin(), job.environment.end(), replaces) &&
          std::none_of(job.hidden.begin(), job.hidden.end(), hides))
        environment.push_back(*entry);
    }
    for (const auto& entry : job.environment)
      environment.push_back(const_cast<char*>(entry.c_str()));
    environment.push_back(nullptr);

    const pid_t parent = getpid();
    process_ = fork();
    if (process_ < 0)
      throw InputError(job.command[0],
                       std::string("cannot be started (") + std::strerror(errno) + ")", "", "");
    if (process_ == 0) {
      // A process group of its own: Ctrl-C reaches only the parent, which then stops the whole
      // group with the helpers that the child has started.
      setpgid(0, 0);
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      if (getppid() != parent) _exit(127);
      signal(SIGINT, SIG_DFL);
      signal(SIGTERM, SIG_DFL);
      dup2(input.read_end.get(), STDIN_FILENO);
      dup2(output.write_end.get(), STDOUT_FILENO);
      dup2(errors.write_end.get(), STDERR_FILENO);
      execve(arguments[0], arguments.data(), environment.data());
      const int error = errno;
      if (write(failure.write_end.get(), &error, sizeof error) < 0) _exit(126);
      _exit(127);
    }
    setpgid(process_, process_);
    failure.write_end.reset();
    // Closed by a successful exec, otherwise it carries the reason.
    int error = 0;
    ssize_t count;
    do count = read(failure.read_end.get(), &error, sizeof error);
    while (count < 0 && errno == EINTR);
    if (count == sizeof error) {
      waitpid(process_, nullptr, 0);
      process_ = -1;
      throw InputError(job.command[0],
                       std::string("cannot be started (") + std::strerror(error) + ")", "", "");
    }
    output_.reset(dup_cloexec(output.read_end.get()));
    errors_.reset(dup_cloexec(errors.read_end.get()));
  }

  ~Child() { stop(); }

  int output_descriptor() const { return output_.get(); }
  int errors_descriptor() const { return errors_.get(); }
  bool closed() const { return output_.get() < 0 && errors_.get() < 0; }

  /// Passes complete lines to `on_output`.
  template <class OnLine>
  void read_output(const OnLine& on_line) {
    char buffer[1 << 16];
    const ssize_t count = read(output_.get(), buffer, sizeof buffer);
    if (count > 0)
      outcome.output.append(buffer, static_cast<std::size_t>(count));
    else if (count == 0 || errno != EINTR)
      output_.reset();
    for (std::size_t end; (end = outcome.output.find('\n', passed_on_)) != std::string::npos;) {
      const std::string line = outcome.output.substr(passed_on_, end - passed_on_);
      passed_on_ = end + 1;
      last_output_ = Clock::now();
      on_line(index, line);
    }
  }

  /// Passes complete lines to `on_line`, and at the end also a last line without line break.
  template <class OnLine>
  void read_errors(const OnLine& on_line) {
    char buffer[1 << 14];
    const ssize_t count = read(errors_.get(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) return;
    if (count > 0)
      pending_.append(buffer, static_cast<std::size_t>(count));
    else if (!pending_.empty())
      pending_ += '\n';
    for (std::size_t end; (end = pending_.find_first_of("\r\n")) != std::string::npos;) {
      const std::string line = pending_.substr(0, end);
      pending_.erase(0, end + 1);
      if (line.empty()) continue;
      outcome.last_line = line;
      on_line(index, line);
    }
    if (count <= 0) errors_.reset();
  }

  void wait_for_end() {
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    outcome.wall_s = std::chrono::duration<double>(Clock::now() - start_).count();
    if (WIFEXITED(status)) outcome.exit_status = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  }

  void terminate() {
    if (process_ > 0) kill(-process_, SIGTERM);
  }

  void interrupt() {
    if (process_ > 0) kill(-process_, SIGINT);
  }

  bool is_limited() const {
    return std::isfinite(time_limit_s_) || std::isfinite(memory_limit_MB_);
  }

  /// Kills the process when it exceeds one of its limits, and records which.
  void enforce_limits() {
    if (process_ <= 0 || outcome.exceeded != ProcessLimit::none) return;
    if (std::chrono::duration<double>(Clock::now() - last_output_).count() > time_limit_s_)
      outcome.exceeded = ProcessLimit::time;
    else if (std::isfinite(memory_limit_MB_) && resident_MB() > memory_limit_MB_)
      outcome.exceeded = ProcessLimit::memory;
    if (outcome.exceeded != ProcessLimit::none) kill(-process_, SIGKILL);
  }

  /// Ends the process: by SIGTERM, and by SIGKILL if it still runs after one second.
  void stop() {
    if (process_ <= 0) return;
    terminate();
    for (int i = 0; i < 100; ++i) {
      const pid_t ended = waitpid(process_, nullptr, WNOHANG);
      if (ended == process_ || (ended < 0 && errno != EINTR)) {
        kill(-process_, SIGKILL);  // helpers that it started and left running
        process_ = -1;
        return;
      }
      usleep(10000);
    }
    kill(-process_, SIGKILL);
    while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
  }

  std::size_t index;
  ProcessOutcome outcome;

 private:
  static int dup_cloexec(int number) { return fcntl(number, F_DUPFD_CLOEXEC, 3); }

  double resident_MB() const {
    std::ifstream file("/proc/" + std::to_string(process_) + "/statm");
    double all_pages = 0, resident_pages = 0;
    if (!(file >> all_pages >> resident_pages)) return 0;  // it has just ended
    return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
  }

  Clock::time_point start_, last_output_;
  double time_limit_s_, memory_limit_MB_;
  pid_t process_ = -1;
  Descriptor output_, errors_;
  std::string pending_;
  std::size_t passed_on_ = 0;  ///< of the output
};

}  // namespace

int run_processes(const std::vector<ProcessJob>& jobs, int parallel,
                  const ProcessCallbacks& callbacks, OnInterrupt on_interrupt) {
  SignalWatch signals;
  int interrupted = 0;
  std::vector<std::unique_ptr<Child>> children;
  std::size_t next = 0;
  while ((next < jobs.size() && !interrupted) || !children.empty()) {
    while (next < jobs.size() && !interrupted &&
           children.size() < static_cast<std::size_t>(std::max(1, parallel))) {
      callbacks.on_start(next);
      children.push_back(std::make_unique<Child>(next, jobs[next]));
      ++next;
    }
    std::vector<pollfd> waiting = {{signals.descriptor(), POLLIN, 0}};
    for (const auto& child : children) {
      // poll ignores negative descriptors, so that closed ends can stay in the list.
      waiting.push_back({child->output_descriptor(), POLLIN, 0});
      waiting.push_back({child->errors_descriptor(), POLLIN, 0});
    }
    const bool limited = std::any_of(children.begin(), children.end(),
                                     [](const auto& child) { return child->is_limited(); });
    constexpr int kLimitCheck_ms = 250;
    if (poll(waiting.data(), waiting.size(), limited ? kLimitCheck_ms : -1) < 0) {
      if (errno == EINTR) continue;
      throw InputError("poll", std::string("failed (") + std::strerror(errno) + ")", "", "");
    }
    for (auto& child : children) child->enforce_limits();
    if (waiting[0].revents) {
      const int number = signals.take();
      if (number == SIGINT && on_interrupt == OnInterrupt::finish && !interrupted) {
        interrupted = number;
        for (auto& child : children) child->interrupt();
        continue;
      }
      for (auto& child : children) child->terminate();
      return number;
    }
    for (std::size_t i = 0; i < children.size(); ++i) {
      if (waiting[2 + 2 * i].revents) children[i]->read_errors(callbacks.on_line);
      if (waiting[1 + 2 * i].revents) children[i]->read_output(callbacks.on_output);
    }
    for (std::size_t i = 0; i < children.size();) {
      if (!children[i]->closed()) {
        ++i;
        continue;
      }
      children[i]->wait_for_end();
      const std::unique_ptr<Child> ended = std::move(children[i]);
      children.erase(children.begin() + static_cast<std::ptrdiff_t>(i));
      callbacks.on_finish(ended->index, ended->outcome);
    }
  }
  return interrupted;
}

}  // namespace softfinger::system
