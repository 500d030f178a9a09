#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/judgement/selection/model_choice.h"
#include "comparisons/judgement/selection/scene_choice.h"
#include "comparisons/judgement/selection/selection_report.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/reference/fem_process.h"
#include "comparisons/report/select_page.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/nearest_name.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct SelectOptions {
  CaseInput typed_case;
  std::string models, quantities, output, command_line;
  judgement::SelectionOptions selection;
  bool json = false, write_page = false;
};

/// Names of models, and "fem".
std::vector<std::string> allowed_models(const std::string& typed) {
  std::vector<std::string> names, known = {"fem"};
  for (const PressureModel* model : all_pressure_models()) known.emplace_back(model->card().name);
  for (std::size_t start = 0; start <= typed.size();) {
    const std::size_t end = std::min(typed.find(',', start), typed.size());
    const std::string name = typed.substr(start, end - start);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError("command line",
                       "unknown model \"" + name + "\", did you mean \"" +
                           text::nearest_name(name, known) + "\"?",
                       "", text::joined(known));
    names.push_back(name);
    start = end + 1;
  }
  return names;
}

/// e_n by finite elements of a flat layer at finite strain at six loads, evenly spaced in ln P.
judgement::FemEccentricity fem_table(const ContactProblem& problem, double least_N,
                                     double largest_N) {
  constexpr int kLoads = 6;
  input::Case contact;
  contact.id = "contact";
  contact.layer = problem.layer;
  contact.fem_finite = input::FiniteStrain{};
  contact.shear_law.friction_coefficient = problem.load.friction_coefficient;
  prediction::LocalGeometry geometry;
  geometry.radii = problem.radii;
  reference::FemBatch batch;
  for (int i = 0; i < kLoads; ++i)
    batch.problems.push_back(reference::fem_problem(
        contact, geometry, least_N * std::pow(largest_N / least_N, i / (kLoads - 1.)),
        contact.fem_level));
  judgement::FemEccentricity found;
  found.eccentricity_m.assign(kLoads, 0);
  std::string failure;
  reference::FemCallbacks callbacks;
  callbacks.on_answer = [&](reference::FemIndex which, const reference::FemAnswer& answer) {
    if (!answer.result) {
      failure = answer.failure;
      return;
    }
    found.eccentricity_m[which.problem] = answer.result->eccentricity_m;
    if (const auto& stated = answer.result->error.max_torque)
      found.error = std::max(found.error, *stated);
    else
      failure = "the error of the torque is not known";
  };
  remark(fmt::format("finite elements at {} loads", kLoads));
  if (const int signal = reference::run_fem(system::fem_program().string(), {batch}, 1, callbacks))
    throw system::Interrupted(signal);
  if (!failure.empty()) throw ConvergenceError("finite elements of a contact", 0, 0, failure);
  return found;
}

/// A path or a built-in name; empty: a case.
std::filesystem::path scene_file(const std::string& typed) {
  const auto scenes = system::builtin_scene_files();
  for (const auto& file : scenes)
    if (file.stem() == typed) return file;
  std::error_code error;
  if (typed != "-" && !std::filesystem::is_regular_file(typed, error)) return {};
  return input::is_scene(typed) ? std::filesystem::path(typed) : std::filesystem::path();
}

/// select.json and select.html, both or none.
void write_page(const std::filesystem::path& folder, const nlohmann::json& result,
                const std::string& page) {
  const system::OutputFolder output(folder);
  system::write_files_together(
      {{folder / "select.json", result.dump(2) + "\n"}, {folder / "select.html", page}});
  remark("the page is " + (folder / "select.html").string());
}

int run_scene(const std::filesystem::path& file, const SelectOptions& options) {
  if (!options.models.empty() || !options.quantities.empty() || options.selection.budget_us > 0)
    throw InputError("command line", "--models, --quantities, --budget-us", "",
                     "a case: in a scene the models are chosen by how they change its motion");
  const input::Scene scene = input::read_scene(file, settings_of(options.typed_case));
  for (const input::ContactRule& rule : scene.rules)
    if (rule.shear_law.kind != ShearLaw::Kind::coulomb)
      throw InputError(
          file.string(), "shear_law", rule.shear_law.name(),
          "\"coulomb\" for select: errors of the models' torque are known for it only");
  const judgement::SceneChoice choice =
      judgement::choose_for_scene(scene, options.selection.tolerance, fem_table, remark);
  const nlohmann::json result = to_json(choice, options.selection.tolerance);
  if (options.write_page)
    write_page(
        options.output, result,
        report::render_scene_selection(judgement::with_provenance(result, options.command_line)));
  if (options.json)
    system::write_to_stdout(result.dump(2) + "\n");
  else
    system::write_text_to_stdout(fmt::format("{}: what its soft contacts need for {}\n",
                                             choice.scene.id,
                                             text::percent(options.selection.tolerance)) +
                                 table(choice, options.selection.tolerance));
  return 0;
}

int run_select(SelectOptions options) {
  refuse_nan(options.selection.tolerance, "--tolerance", "1e-6 to 10");
  refuse_nan(options.selection.budget_us, "--budget-us", "1e-3 to 1e12");
  if (options.write_page && options.output.empty())
    throw InputError("command line", "--output", "\"\"", "the name of a folder");
  if (const auto file = scene_file(options.typed_case.file); !file.empty())
    return run_scene(file, options);
  if (!options.models.empty()) options.selection.models = allowed_models(options.models);
  if (!options.quantities.empty())
    options.selection.quantities = judgement::quantities_by_name(options.quantities);
  const input::Case contact_case = read_case(options.typed_case);
  input::require_coulomb(contact_case, "select");
  const prediction::GeometryResolver resolver(contact_case);
  for (const std::string& line : resolver.remarks()) remark(line);
  std::vector<judgement::LoadChoice> loads;
  nlohmann::json choices = nlohmann::json::array();
  std::string text = prediction::describe(contact_case) + "\n";
  for (const double load_N : contact_case.loads_N) {
    judgement::LoadChoice& load = loads.emplace_back();
    load.geometry = resolver.resolve(load_N);
    load.problem = prediction::contact_problem(contact_case, load.geometry, load_N);
    load.choice = judgement::choose_model(contact_case, load.geometry, load_N, options.selection);
    choices.push_back(to_json(load.choice));
    text += table(load.choice, options.selection);
  }
  const nlohmann::json result = {
      {"case", contact_case.id}, {"tolerance", options.selection.tolerance}, {"choices", choices}};
  if (options.write_page) {
    const nlohmann::json report = judgement::selection_report(
        contact_case, resolver, options.selection, loads, options.command_line);
    write_page(options.output, result, report::render_selection(report));
  }
  if (options.json)
    system::write_to_stdout(result.dump(2) + "\n");
  else
    system::write_text_to_stdout(text);
  return 0;
}

}  // namespace

void add_select(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<SelectOptions>();
  CLI::App* command = app.add_subcommand(
      "select",
      "The cheapest model whose stated error meets a tolerance, or a clear \"none\", and why");
  add_case(*command, options->typed_case);
  command
      ->add_option("--tolerance", options->selection.tolerance,
                   "largest relative error allowed, 1e-6 to 10; 0.05 is 5 %")
      ->required()
      ->check(CLI::Range(1e-6, 10.));
  command
      ->add_option("--budget-us", options->selection.budget_us,
                   "longest time allowed for one answer, in microseconds, 1e-3 to 1e12; default: "
                   "any")
      ->check(CLI::Range(1e-3, 1e12));
  command->add_option("--models", options->models,
                      "allowed models, separated by commas; \"fem\" is one; default: all");
  command->add_option("--quantities", options->quantities,
                      "what the tolerance is for, separated by commas: a, b, indentation, area, "
                      "peak_pressure, max_torque; default: all of them");
  options->command_line = command_line;
  const CLI::Option* output = command->add_option(
      "-o,--output", options->output,
      "folder for a page with the choice, the figures of speed and accuracy and the maps of "
      "validity: select.html, and select.json; of a scene, what each pair of bodies needs");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "CASE may be a scene, too: which contacts can be points, ellipsoids or exact limit surfaces, "
      "and with\n"
      "which model. It measures how much of its friction limit each contact uses, how much the\n"
      "simpler models change the motion, and what of a step's time they save. Contacts that are\n"
      "alike get the same.\n"
      "Stated errors are bounds against the finger itself, curved and at finite strain, fitted to\n"
      "finite-element runs: 95 % of them lie inside. What the fit of a mesh leaves open is added.\n"
      "predict states the same ones. Models that take milliseconds are not asked.\n"
      "Samples:\n"
      "  softfinger select seed_thumb --tolerance 0.05\n"
      "  softfinger select silicone_pad_2mm --tolerance 0.05 --output my_choice\n"
      "  softfinger select silicone_pad_2mm --tolerance 0.02 --budget-us 5 --quantities "
      "max_torque\n"
      "  softfinger select pinch --tolerance 0.02\n"
      "  softfinger select hertz_ratio_4 --tolerance 0.05 --models hertz,winkler --json");
  command->callback([options, output, &action] {
    options->write_page = output->count() > 0;
    action = [options] { return run_select(*options); };
  });
}

}  // namespace softfinger::commands
