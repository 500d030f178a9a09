// softfinger-benchmark: the same problems in several simulators.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "comparisons/benchmark/results.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::benchmark {
namespace {

template <typename Item>
std::vector<const Item*> chosen(const std::vector<Item>& all, const std::vector<std::string>& names,
                                const char* flag) {
  std::vector<const Item*> found;
  std::vector<std::string> known;
  for (const Item& item : all) {
    known.push_back(item.name);
    if (names.empty()) found.push_back(&item);
  }
  for (const std::string& name : names) {
    const std::size_t before = found.size();
    for (const Item& item : all)
      if (item.name == name) found.push_back(&item);
    if (found.size() == before)
      throw InputError(
          "command line",
          std::string(flag) + " " + text::shortened(name) + text::did_you_mean(name, known), "",
          text::joined(known));
  }
  return found;
}

std::string to_text(const Results& results) {
  std::string text = fmt::format("{:<20}", "");
  for (const Problem* problem : results.problems) text += fmt::format(" {:>30}", problem->name);
  text += "\n";
  for (std::size_t i = 0; i < results.engines.size(); ++i) {
    text += fmt::format("{:<20}", results.engines[i]->name);
    for (std::size_t j = 0; j < results.problems.size(); ++j) {
      const Score& score = results.scores[i][j];
      text +=
          fmt::format(" {:>30}", score.failure.empty() ? worst_in_words(*results.problems[j], score)
                                                       : score.failure);
    }
    text += fmt::format("\n{:<20}", "  steps/s");
    for (std::size_t j = 0; j < results.problems.size(); ++j)
      text += fmt::format(" {:>30.0f}", results.scores[i][j].steps_per_s());
    text += "\n";
  }
  for (const AbsentEngine& engine : absent_engines())
    text += fmt::format("{} is absent in this build (Debian: {})\n", engine.name, engine.package);
  return text;
}

int run(int argc, char** argv) {
  CLI::App app(
      "The same problems of soft contacts in several simulators: error against the truth, "
      "and speed.",
      "softfinger-benchmark");
  std::string page, creep;
  std::vector<std::string> engines, problems;
  bool json = false;
  app.add_option("--engine", engines, "only this one; may be repeated")->allow_extra_args(false);
  app.add_option("--problem", problems,
                 "only this one: pinch, twist, grip, tilt, held, stack, capsule, claw or wall; may "
                 "be repeated")
      ->allow_extra_args(false);
  app.add_option("--page", page, "HTML file to write");
  app.add_option(
      "--creep", creep,
      "JSON file of creep/creep.mjs, holds in MuJoCo 3 and PhysX 5, for a table on the page");
  app.add_flag("--json", json, "one JSON object on standard output");
  app.footer(
      "Samples:\n  softfinger-benchmark --page benchmark.html\n"
      "  softfinger-benchmark --engine softfinger --problem twist --json");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  Results results;
  results.engines = chosen(all_engines(), engines, "--engine");
  results.problems = chosen(all_problems(), problems, "--problem");
  constexpr std::size_t kMostBytes = 10'000'000;
  if (!creep.empty())
    results.drifts = read_drifts(system::read_text_file(creep, kMostBytes), creep);
  results.version = "softfinger " + system::program_version() + ", " + system::compiler() + ", " +
                    system::build_type();
  results.command = "softfinger-benchmark";
  for (int i = 1; i < argc; ++i) results.command += std::string(" ") + argv[i];
  for (const Engine* engine : results.engines) {
    results.scores.emplace_back();
    for (const Problem* problem : results.problems) {
      std::fprintf(stderr, "%s: %s\n", engine->name.c_str(), problem->name.c_str());
      results.scores.back().push_back(problem->solve(*engine));
    }
  }
  if (!page.empty()) system::write_file_atomically(page, render_page(results));
  if (json)
    system::write_to_stdout(text::printed(to_json(results)));
  else
    system::write_text_to_stdout(to_text(results));
  return 0;
}

}  // namespace
}  // namespace softfinger::benchmark

int main(int argc, char** argv) {
  try {
    return softfinger::benchmark::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "softfinger-benchmark: error: %s\n", error.what());
    return dynamic_cast<const softfinger::InputError*>(&error) ? 2 : 3;
  }
}
