#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/commands/commands.h"
#include "comparisons/judgement/atlas/error_atlas.h"
#include "comparisons/judgement/atlas/fit_fingertip.h"
#include "comparisons/judgement/atlas/make_atlas.h"
#include "comparisons/suite/compare.h"
#include "comparisons/system/files.h"
#include "comparisons/text/json_text.h"

namespace softfinger::commands {
namespace {

struct AtlasOptions {
  std::string folder = "softfinger-atlas", output, fit, test, command_line;
  int jobs = suite::default_job_count(), random = 0;
  unsigned seed = 1;
  bool json = false, models_only = false, finite_strain = false, fingers = false,
       fingertips = false, rubbed = false;
  reference::FemLimits fem_limits;
};

/// Tests the bounds on runs that the atlas does not contain: how many errors lie inside, and how
/// much larger than the error a bound is. One object per model and quantity, the last for all.
nlohmann::json test_bounds(const judgement::AtlasFile& unseen) {
  nlohmann::json rows = nlohmann::json::array();
  std::size_t inside_all = 0, all = 0;
  std::vector<double> ratios_all;
  const auto add = [&](const std::string& model, const char* quantity, std::size_t inside,
                       std::vector<double>& ratios) {
    const auto middle = ratios.begin() + long(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    rows.push_back({{"model", model},
                    {"quantity", quantity},
                    {"inside", double(inside) / double(ratios.size())},
                    {"tested", ratios.size()},
                    {"bound_over_error_median", *middle}});
  };
  for (const auto& [model, errors] : unseen.errors)
    for (std::size_t q = 0; q < judgement::kQuantities; ++q) {
      std::size_t inside = 0;
      std::vector<double> ratios;
      for (std::size_t r = 0; r < unseen.runs.size(); ++r) {
        const auto estimate =
            judgement::error_atlas().estimate(model, judgement::problem_of(unseen.runs[r]));
        if (!estimate.bound || !std::isfinite(errors[r][q])) continue;
        const double error = std::abs(errors[r][q]);
        inside += error <= (*estimate.bound)[q];
        ratios.push_back((*estimate.bound)[q] / error);
      }
      if (ratios.empty()) continue;
      inside_all += inside, all += ratios.size();
      ratios_all.insert(ratios_all.end(), ratios.begin(), ratios.end());
      add(model, judgement::kQuantityNames[q], inside, ratios);
    }
  if (all > 0) add("all", "", inside_all, ratios_all);
  return rows;
}

std::string bounds_table(const nlohmann::json& rows) {
  std::string text = fmt::format("{:<22}{:<16}{:>10}{:>12}{:>22}\n", "model", "quantity", "inside",
                                 "of", "bound/true, median");
  for (const auto& row : rows)
    text +=
        fmt::format("{:<22}{:<16}{:>9.1f} %{:>11}{:>22.2f}\n", row["model"].get<std::string>(),
                    row["quantity"].get<std::string>(), 100 * row["inside"].get<double>(),
                    row["tested"].get<std::size_t>(), row["bound_over_error_median"].get<double>());
  return text;
}

/// Test of the bounds against whole fingers, a row for each model and quantity.
nlohmann::json test_finger_bounds(const judgement::AtlasFile& unseen) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& [model, test] : judgement::test_bounds_on_fingers(unseen))
    for (std::size_t q = 0; q < judgement::kQuantities; ++q)
      rows.push_back({{"model", model},
                      {"quantity", judgement::kQuantityNames[q]},
                      {"inside", test.inside[q]},
                      {"tested", test.runs},
                      {"bound_over_error_median", text::finite_or_null(test.ratio[q])},
                      {"error_median", text::finite_or_null(test.median[q])},
                      {"error_95_percent", text::finite_or_null(test.most[q])},
                      {"error_largest", text::finite_or_null(test.largest[q])}});
  return rows;
}

std::string finger_bounds_table(const nlohmann::json& rows) {
  std::string text = fmt::format("{:<22}{:<16}{:>8}{:>12}{:>22}{:>13}{:>9}{:>10}\n",
                                 "model, against finger", "quantity", "inside", "of",
                                 "bound/error, median", "error median", "95 %", "largest");
  const auto number = [](const nlohmann::json& value) {
    return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  };
  for (const auto& row : rows)
    text += fmt::format("{:<22}{:<16}{:>6.1f} %{:>12}{:>22.2f}{:>11.2f} %{:>7.2f} %{:>8.2f} %\n",
                        row["model"].get<std::string>(), row["quantity"].get<std::string>(),
                        100 * number(row["inside"]), row["tested"].get<std::size_t>(),
                        number(row["bound_over_error_median"]), 100 * number(row["error_median"]),
                        100 * number(row["error_95_percent"]), 100 * number(row["error_largest"]));
  return text;
}

/// Bounds that were tested, or the file that was written.
void answer(const AtlasOptions& options, const nlohmann::json& bounds, const std::string& table) {
  if (options.json)
    system::write_to_stdout(text::printed(nlohmann::json(
        {{"output", options.output.empty() ? nlohmann::json() : nlohmann::json(options.output)},
         {"bounds", bounds}})));
  else if (!table.empty())
    system::write_text_to_stdout(table);
}

judgement::AtlasFile read_atlas_file(const std::string& name) {
  return judgement::parse_atlas(system::read_text_file(name), name);
}

/// Writes the table of fingertip_layer_core.h from runs of fingers and the installed atlas at
/// finite strain.
int fit_fingertip(const AtlasOptions& options) {
  judgement::AtlasFile runs = read_atlas_file(options.fit);
  const judgement::AtlasFile& known = judgement::finite_strain_atlas().file();
  runs.runs.insert(runs.runs.end(), known.runs.begin(), known.runs.end());
  const judgement::FittedFingertip fitted = judgement::fit_fingertip(runs);
  system::write_file_atomically(
      options.output, judgement::fingertip_table(fitted, "softfinger atlas --fit fingers.csv"));
  answer(options, nullptr, "");
  return 0;
}

int run_atlas(const AtlasOptions& options) {
  if (!options.test.empty()) {
    const nlohmann::json rows = test_finger_bounds(read_atlas_file(options.test));
    answer(options, rows, finger_bounds_table(rows));
    return 0;
  }
  if (!options.fit.empty()) return fit_fingertip(options);
  require_single_process("softfinger-sweep --atlas FILE.csv --output FOLDER");
  if (options.models_only) {
    judgement::AtlasFile atlas =
        judgement::parse_atlas(system::read_file_to_rewrite(options.output), options.output);
    judgement::judge_models(atlas);
    system::write_file_atomically(options.output, to_csv(atlas));
    answer(options, nullptr, "");
    return 0;
  }
  judgement::AtlasOptions settings;
  settings.folder = options.folder;
  settings.jobs = options.jobs;
  settings.without_failed = options.fingers || options.fingertips;
  settings.command = options.command_line;
  settings.fem_limits = options.fem_limits;
  const auto [atlas, signal] = judgement::make_atlas(
      options.fingers         ? judgement::random_fingers(options.random, options.seed)
      : options.rubbed        ? judgement::random_rubbed_fingertips(options.random, options.seed)
      : options.fingertips    ? judgement::random_fingertips(options.random, options.seed)
      : options.random > 0    ? judgement::random_runs(options.random, options.seed)
      : options.finite_strain ? judgement::finite_strain_runs()
                              : judgement::designed_runs(),
      settings);
  if (signal != 0) return 128 + signal;
  if (!atlas) return 1;
  if (!options.output.empty()) system::write_file_atomically(options.output, to_csv(*atlas));
  if (options.random == 0) {
    answer(options, nullptr, "");
    return 0;
  }
  const nlohmann::json rows =
      settings.without_failed ? test_finger_bounds(*atlas) : test_bounds(*atlas);
  answer(options, rows, settings.without_failed ? finger_bounds_table(rows) : bounds_table(rows));
  return 0;
}

}  // namespace

void add_atlas(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<AtlasOptions>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand(
      "atlas",
      "Makes the error atlas: some 400 finite-element runs over Poisson's ratio, R'/R'', contact\n"
      "size, curvature and friction, and each model's errors against them. On many machines:\n"
      "mpirun softfinger-sweep --atlas");
  command->add_option("--folder", options->folder,
                      "folder that keeps finished runs: the same command continues after an "
                      "interruption; default: ./softfinger-atlas");
  CLI::Option* output = command->add_option("-o,--output", options->output,
                                            "the CSV file to write when all runs are finished");
  command
      ->add_option("--jobs", options->jobs,
                   "finite-element processes side by side, 1 to 64; default: the cores, at most 8")
      ->check(CLI::Range(1, 64));
  CLI::Option* random =
      command
          ->add_option(
              "--random", options->random,
              "instead N random contacts, on which the bounds of the installed atlas are tested: "
              "prints how many errors lie inside their bound and the ratio of bound to error; 1 to "
              "100000")
          ->check(CLI::Range(1, 100000));
  add_fem_limits(*command, options->fem_limits);
  command->add_option("--seed", options->seed, "of the random contacts; default: 1");
  CLI::Option* finite_strain = command->add_flag(
      "--finite-strain", options->finite_strain,
      "instead the atlas at finite strain: rubber layers under large indentation, each solved "
      "with linear elasticity too");
  finite_strain->excludes(random);
  command
      ->add_flag("--fingers", options->fingers,
                 "of the random contacts: curved fingers on curved objects at finite strain")
      ->needs(random);
  command
      ->add_flag("--fingertips", options->fingertips,
                 "of the random contacts: the same, but drawn by the radii of finger and object, "
                 "which is turned against the finger and may be hollow")
      ->needs(random);
  command
      ->add_flag("--rubbed", options->rubbed,
                 "of the fingertips: pressed with friction from the first touch, mu 0.05 to 1.5")
      ->needs("--fingertips");
  command
      ->add_option("--fit", options->fit,
                   "FILE.csv of --fingers: writes the table of the bounds against whole fingers to "
                   "--output, C++")
      ->needs(output)
      ->excludes(random, finite_strain);
  command
      ->add_option("--test", options->test,
                   "FILE.csv of --fingers: how many errors lie inside these bounds")
      ->excludes(random, finite_strain);
  command
      ->add_flag(
          "--models-only", options->models_only,
          "computes only the models' errors again, from the finite-element results in --output")
      ->needs(output)
      ->excludes(random, finite_strain);
  command->add_flag("--json", options->json,
                    "one JSON object on standard output: the file, or the tested bounds");
  command->footer(
      "Samples:\n"
      "  softfinger atlas --output error_atlas.csv --jobs 2\n"
      "  softfinger atlas --finite-strain --output finite_strain.csv\n"
      "  softfinger atlas --random 200 --seed 7 --folder unseen");
  command->callback([options, &action] { action = [options] { return run_atlas(*options); }; });
}

}  // namespace softfinger::commands
