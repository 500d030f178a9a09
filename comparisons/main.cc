#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/typed_words.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/progress.h"
#include "comparisons/system/terminal.h"
#include "softfinger/input/errors.h"

namespace {

enum ExitStatus { kDone = 0, kBadInput = 2, kNotConverged = 3 };

int fail(const std::string& message, ExitStatus status) {
  softfinger::commands::remark("error: " + message);
  return status;
}

/// Reads the command line and runs the command.
int run(int argc, char** argv) {
  using namespace softfinger;
  const std::vector<std::string> arguments = commands::with_version_as_option(
      commands::join_vectors(std::vector<std::string>(argv + 1, argv + argc)));
  std::string command_line = "softfinger";
  for (const auto& argument : arguments) command_line += " " + argument;

  CLI::App app("Soft-finger contact: analytic models, verified by finite elements.", "softfinger");
  app.set_version_flag("-V,--version", "softfinger " + system::program_version());
  bool quiet = false;
  app.add_flag("-q,--quiet", quiet,
               "errors alone on standard error, no remarks and no progress; also after a command");
  app.require_subcommand(1);
  app.fallthrough();  // of each command, too
  app.footer(
      "Exit status: 0 done, 1 a comparison fell short or nothing usable to write, 2 bad input, 3 "
      "the numerics did not "
      "converge.\n"
      "Results go to standard output, messages and progress to standard error.\n"
      "Colours on terminals only; NO_COLOR in the environment turns them off, CLICOLOR_FORCE on.\n"
      "Samples:\n"
      "  softfinger list cases\n"
      "  softfinger predict seed_thumb\n"
      "  softfinger predict --help");
  commands::Action action;
  commands::add_predict(app, action, command_line);
  commands::add_fit(app, action, command_line);
  commands::add_fem(app, action);
  commands::add_compare(app, action, command_line);
  commands::add_sweep(app, action, command_line);
  commands::add_atlas(app, action, command_line);
  commands::add_select(app, action, command_line);
  commands::add_experiments(app, action, command_line);
  commands::add_calibrate(app, action, command_line);
  commands::add_area(app, action);
  commands::add_export(app, action);
  commands::add_explore(app, action, command_line);
  commands::add_apply(app, action);
  commands::add_lint(app, action);
  commands::add_list(app, action);
  commands::add_explain(app, action);
  commands::add_lcp(app, action);
  commands::add_simulate(app, action, command_line);
  commands::add_mesh(app, action, command_line);
  commands::add_init(app, action);
  commands::add_doctor(app, action);
  commands::add_completion(app, action);
  commands::add_manual(app, action);
  commands::prepare_options(app);
  try {
    commands::refuse_unknown_words(app, arguments);
    // The parser expects the arguments in reverse order.
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::Success& request) {
    std::ostringstream text;  // --help, --version
    app.exit(request, text, text);
    system::write_to_stdout(text.str());
    return kDone;
  } catch (const CLI::ParseError& error) {
    return fail(commands::in_words(app, error), kBadInput);
  }
  system::set_quiet(quiet);
  commands::announce_outputs(app);
  return action();
}

/// Prints one line without allocating memory.
int fail_without_memory() {
  std::fputs("softfinger: error: out of memory\n", stderr);
  return kNotConverged;
}

/// Called where an exception cannot be caught, for instance when memory runs out in a destructor of
/// a library. The program may end at any point, because files under their final names are always
/// whole.
[[noreturn]] void end_in_words() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    std::_Exit(fail_without_memory());
  } catch (...) {
    std::abort();
  }
  // The exception has just left a library's function that must not throw. It cannot be inspected
  // here.
  if (std::uncaught_exceptions() == 0) std::abort();
  std::fputs("softfinger: error: a library could not go on (out of memory?)\n", stderr);
  std::_Exit(kNotConverged);
}

}  // namespace

void softfinger::commands::remark(const std::string& line) {
  std::string text = "softfinger: " + line;
  for (char& letter : text)
    if (letter == '\n' || letter == '\r') letter = ' ';
  system::Progress stream;
  if (line.rfind("error: ", 0) == 0)
    stream.fail(text);
  else
    stream.say(text);
}

int main(int argc, char** argv) {
  using namespace softfinger;
  system::open_standard_descriptors();
  // With the signal ignored, exceeding a file-size limit is an error of the write, which is
  // reported. By default the signal would end the program.
  std::signal(SIGXFSZ, SIG_IGN);
  std::set_terminate(end_in_words);
  try {
    return run(argc, argv);
  } catch (const system::Interrupted& interruption) {
    commands::remark(interruption.what());
    return 128 + interruption.signal;
  } catch (const InputError& error) {
    return fail(error.what(), kBadInput);
  } catch (const ConvergenceError& error) {
    return fail(error.what(), kNotConverged);
  } catch (const std::bad_alloc&) {
    return fail_without_memory();
  } catch (const std::exception& error) {
    return fail(std::string("unexpected: ") + error.what(), kNotConverged);
  }
}
