#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "comparisons/commands/answer_lines.h"
#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/commands/demand_input.h"
#include "comparisons/judgement/assessment.h"
#include "comparisons/judgement/next_step.h"
#include "comparisons/judgement/pad_doubt.h"
#include "comparisons/judgement/selection/model_choice.h"
#include "comparisons/judgement/selection/pad_choice.h"
#include "comparisons/judgement/selection/scene_choice.h"
#include "comparisons/judgement/selection/selection_report.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/pad_answer.h"
#include "comparisons/reference/fem_process.h"
#include "comparisons/report/hold.h"
#include "comparisons/report/select_page.h"
#include "comparisons/simulation/overlapping_shapes.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/terminal.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "comparisons/text/percent.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct SelectOptions {
  CaseInput typed_case;
  std::string models, output, command_line;
  DemandInput demand;
  judgement::SelectionOptions selection;
  bool json = false, write_page = false;
};

/// Names of models, and "fem".
/// @param all  the models that there are for the case
template <class Model>
std::vector<std::string> allowed_models(const std::string& typed,
                                        const std::vector<const Model*>& all) {
  std::vector<std::string> names, known = {"fem"};
  if (typed.empty()) return names;
  for (const Model* model : all) known.emplace_back(model->card().name);
  for (std::size_t start = 0; start <= typed.size();) {
    const std::size_t end = std::min(typed.find(',', start), typed.size());
    const std::string name = typed.substr(start, end - start);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError("command line",
                       "unknown model \"" + name + "\"" + text::did_you_mean(name, known), "",
                       text::joined(known));
    names.push_back(name);
    start = end + 1;
  }
  return names;
}

/// A surface by its principal radii, along axes turned by `turn_rad` from the contact's.
struct PrincipalRadii {
  double x_m = kInfinity, y_m = kInfinity, turn_rad = 0;

  bool is_flat() const { return std::isinf(x_m) && std::isinf(y_m); }
  bool is_round() const { return x_m > 0 && std::isfinite(x_m) && x_m == y_m; }
};

PrincipalRadii principal_radii(const SurfaceCurvature& curvature, const RelativeRadii& gap) {
  // Curvatures below this share of the gap's largest one are round-off.
  constexpr double kFlat = 1e-6;
  const double mean_per_m = (curvature.xx_per_m + curvature.yy_per_m) / 2;
  const double half_per_m = (curvature.xx_per_m - curvature.yy_per_m) / 2;
  const double spread_per_m = std::hypot(half_per_m, curvature.xy_per_m);
  const double flat_per_m = kFlat / gap.minor_m;
  const auto radius_m = [&](double per_m) {
    return std::abs(per_m) < flat_per_m ? kInfinity : 1 / per_m;
  };
  PrincipalRadii result;
  if (spread_per_m < flat_per_m) {
    result.x_m = result.y_m = radius_m(mean_per_m);
  } else {
    result.x_m = radius_m(mean_per_m + spread_per_m);
    result.y_m = radius_m(mean_per_m - spread_per_m);
    result.turn_rad = std::atan2(curvature.xy_per_m, half_per_m) / 2;
  }
  return result;
}

/// Shapes that bodies of the same radii may have.
struct Shapes {
  input::FingerShape finger = input::FingerShape::ellipsoid;
  bool is_object_spherical = false;
};

/// Finite elements of the whole finger at one load: its own layer, curved by its radii, at finite
/// strain, against the object's radii.
reference::FemProblem whole_finger(const ContactProblem& problem, const Shapes& shapes,
                                   double load_N) {
  const RelativeRadii& gap = problem.radii;
  const SurfaceCurvature& of_finger = problem.finger_curvature;
  const PrincipalRadii finger = principal_radii(of_finger, gap);
  const PrincipalRadii object =
      principal_radii({1 / gap.major_m - of_finger.xx_per_m, 1 / gap.minor_m - of_finger.yy_per_m,
                       -of_finger.xy_per_m},
                      gap);
  input::Case contact;
  contact.id = "contact";
  contact.layer = problem.layer;
  contact.fem_finite = input::FiniteStrain{};
  contact.fem_curved = !finger.is_flat();
  contact.shear_law.friction_coefficient = problem.load.friction_coefficient;
  input::BodyPair pair;
  pair.finger = input::QuadricBody{finger.x_m, finger.y_m, shapes.finger, 0};
  pair.object = input::QuadricBody{object.x_m, object.y_m, input::FingerShape::paraboloid, 0};
  if (shapes.is_object_spherical) pair.object = input::SphereBody{object.x_m};
  pair.angle_rad = object.turn_rad - finger.turn_rad;
  contact.geometry = pair;
  prediction::LocalGeometry geometry;
  geometry.radii = gap;
  geometry.radii.axis_rad = -finger.turn_rad;
  if (shapes.is_object_spherical && finger.is_flat()) geometry.sphere_radius_m = object.x_m;
  return reference::fem_problem(contact, geometry, load_N, contact.fem_level);
}

/// The shapes for the table, then those that differ in one body's shape from it, as far as that is
/// not known.
std::vector<Shapes> possible_shapes(const judgement::FingerContact& contact) {
  const ContactProblem& problem = contact.problem;
  const SurfaceCurvature& finger = problem.finger_curvature;
  const RelativeRadii& gap = problem.radii;
  std::vector<Shapes> shapes = {{input::FingerShape::ellipsoid, problem.is_object_spherical}};
  if (!contact.is_finger_spherical && !principal_radii(finger, gap).is_flat())
    shapes.push_back({input::FingerShape::paraboloid, problem.is_object_spherical});
  const SurfaceCurvature object = {1 / gap.major_m - finger.xx_per_m,
                                   1 / gap.minor_m - finger.yy_per_m, -finger.xy_per_m};
  if (!problem.is_object_spherical && principal_radii(object, gap).is_round())
    shapes.push_back({input::FingerShape::ellipsoid, true});
  return shapes;
}

/// Relative error of e_n that the shape of a non-round object can cause where finite elements press
/// its paraboloid: estimated as the change in the model that knows spheres.
double error_of_object_shape(ContactProblem problem) {
  const PressureModel& model = *find_pressure_model("fingertip_layer");
  problem.is_object_spherical = false;
  const double paraboloid_m = model.predict(problem).torque_arm_exact_m;
  problem.is_object_spherical = true;
  return std::abs(model.predict(problem).torque_arm_exact_m / paraboloid_m - 1);
}

/// e_n at six loads, evenly spaced in ln P, and at the largest one with the bodies' other shapes.
judgement::FemEccentricity fem_table(const judgement::FingerContact& finger, double least_N,
                                     double largest_N) {
  constexpr int kLoads = 6;
  const std::vector<Shapes> shapes = possible_shapes(finger);
  reference::FemBatch batch;
  for (int i = 0; i < kLoads; ++i)
    batch.problems.push_back(whole_finger(
        finger.problem, shapes[0], least_N * std::pow(largest_N / least_N, i / (kLoads - 1.))));
  for (std::size_t other = 1; other < shapes.size(); ++other)
    batch.problems.push_back(whole_finger(finger.problem, shapes[other], largest_N));
  std::vector<double> found_m(batch.problems.size(), 0);
  double stated = 0;
  std::string failure;
  reference::FemCallbacks callbacks;
  callbacks.on_answer = [&](reference::FemIndex which, const reference::FemAnswer& answer) {
    if (!answer.result) {
      failure = answer.failure;
      return;
    }
    found_m[which.problem] = answer.result->eccentricity_m;
    if (const auto& error = answer.result->error.max_torque)
      stated = std::max(stated, *error);
    else
      failure = "the error of the torque is not known";
  };
  remark(fmt::format("finite elements of the finger itself: {} problems", batch.problems.size()));
  if (const int signal = reference::run_fem(system::fem_program().string(), {batch}, 1, callbacks))
    throw system::Interrupted(signal);
  if (!failure.empty()) throw ConvergenceError("finite elements of a contact", 0, 0, failure);
  judgement::FemEccentricity found;
  found.eccentricity_m.assign(found_m.begin(), found_m.begin() + kLoads);
  found.error = stated;
  const double at_largest_m = found.eccentricity_m.back();
  for (std::size_t other = kLoads; other < found_m.size(); ++other)
    found.error += std::abs(found_m[other] / at_largest_m - 1);
  const bool object_is_asked = finger.problem.is_object_spherical ||
                               (shapes.size() > 1 && shapes.back().is_object_spherical);
  ContactProblem at_largest = finger.problem;
  at_largest.load.normal_force_N = largest_N;
  if (!object_is_asked) found.error += error_of_object_shape(at_largest);
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
      {{folder / "select.json", text::printed(result)}, {folder / "select.html", page}});
  remark("the page is " + (folder / "select.html").string());
}

int run_scene(const std::filesystem::path& file, const SelectOptions& options) {
  if (!options.models.empty() || !options.demand.quantities.empty() ||
      options.selection.budget_us > 0)
    throw InputError("command line", "--models, --quantities, --budget-us", "",
                     "a case: in a scene the models are chosen by how they change its motion");
  const input::Scene scene = input::read_scene(file, settings_of(options.typed_case));
  for (const std::string& line : scene.remarks) remark(line);
  for (const std::string& line : simulation::overlap_remarks(scene)) remark(line);
  for (const input::ContactRule& rule : scene.rules)
    if (rule.shear_law.kind != ShearLaw::Kind::coulomb)
      throw InputError(
          file.string(), "shear_law", rule.shear_law.name(),
          "\"coulomb\" for select: errors of the models' torque are known for it only");
  const judgement::SceneChoice choice =
      judgement::choose_for_scene(scene, options.demand.tolerance, fem_table, remark);
  const std::string outcome =
      report::outcome_in_words(choice.plain, choice.chosen, in_words(choice.plain_change));
  nlohmann::json result = to_json(choice, options.demand.tolerance);
  result["outcome"] = outcome;
  if (options.write_page)
    write_page(
        options.output, result,
        report::render_scene_selection(judgement::with_provenance(result, options.command_line)));
  if (options.json)
    system::write_to_stdout(text::printed(result));
  else
    system::write_text_to_stdout(fmt::format("{}{}: what its soft contacts need for {}\n",
                                             outcome.empty() ? "" : outcome + "\n", choice.scene.id,
                                             text::percent(options.demand.tolerance)) +
                                 table(choice, options.demand.tolerance));
  return 0;
}

/// Advice for a case in which no model meets the demand.
std::string advice(const input::Case& contact_case, const prediction::GeometryResolver& resolver,
                   const prediction::LocalGeometry& geometry, double load_N,
                   const prediction::Demand& demand) {
  const ContactProblem problem = prediction::contact_problem(contact_case, geometry, load_N);
  prediction::ModelAnswer answer =
      prediction::ask_model(default_model(problem), contact_case, geometry, load_N, 0);
  answer.assessment =
      judgement::assess(contact_case, geometry, answer, prediction::TorqueRule::exact, demand);
  return judgement::next_step(contact_case, resolver, answer, demand).in_words();
}

/// Results of all loads in one list, after the choices.
nlohmann::json selection_json(const input::Case& contact_case, double tolerance,
                              const std::vector<judgement::Choice>& choices) {
  nlohmann::json chosen = nlohmann::json::array(), results = nlohmann::json::array();
  for (const judgement::Choice& choice : choices) {
    chosen.push_back(to_json(choice));
    for (const nlohmann::json& one : judgement::results_json(choice)) results.push_back(one);
  }
  return {{"case", contact_case.id},
          {"tolerance", tolerance},
          {"choices", chosen},
          {"results", results}};
}

/// A pad's choice and, behind it, what the case's own doubts move, which no model can mend.
struct PadWords {
  std::string answer, inputs;
};

PadWords words_of(const judgement::Choice& choice, const input::Case& contact_case,
                  const PadShape& shape, std::size_t load) {
  PadWords words{answer_line(choice), ""};
  const prediction::PadAnswer answer = prediction::ask_pad_model(
      *all_pad_models().front(), contact_case, shape, choice.load_N, prediction::Demand{}, 0);
  if (!answer.prediction.has_answer) return words;
  words.answer.pop_back();
  words.answer += in_words(judgement::pad_doubt(contact_case, answer, load)) + "\n";
  words.inputs = "  torque by the inputs: " + judgement::pad_cost_of_inputs(answer) + "\n";
  return words;
}

int run_pad(const input::Case& contact_case, SelectOptions options) {
  auto& selection = options.selection;
  selection.models = allowed_models(options.models, all_pad_models());
  QuantityChoice without_axes = selection.demand.quantities;
  for (const auto axis : {prediction::Quantity::a, prediction::Quantity::b})
    without_axes[std::size_t(axis)] = false;
  if (std::none_of(without_axes.begin(), without_axes.end(), [](bool wanted) { return wanted; }))
    throw InputError("command line", "--quantities", options.demand.quantities,
                     "indentation, area, peak_pressure, max_torque: a flat pad has no semi-axes");
  const PadShape shape(prediction::bearing_outline(contact_case));
  std::vector<judgement::Choice> choices;
  std::string first_lines, tables;
  for (std::size_t load = 0; load < contact_case.loads_N.size(); ++load) {
    choices.push_back(
        judgement::choose_pad_model(contact_case, shape, contact_case.loads_N[load], selection));
    const PadWords words = words_of(choices.back(), contact_case, shape, load);
    first_lines += words.answer;
    tables += table(choices.back(), selection) + words.inputs;
  }
  const nlohmann::json result = selection_json(contact_case, options.demand.tolerance, choices);
  if (options.write_page)
    write_page(options.output, result,
               report::render_selection(judgement::pad_selection_report(
                   contact_case, selection, choices, options.command_line)));
  if (options.json)
    system::write_to_stdout(text::printed(result));
  else
    system::write_text_to_stdout(system::within_terminal(
        first_lines + tables + "\n" + prediction::describe(contact_case) + "\n" +
        prediction::describe(std::get<input::PadPair>(contact_case.geometry), contact_case.layer) +
        "\n"));
  return 0;
}

int run_select(SelectOptions options) {
  options.selection.demand = options.demand.demand();
  if (options.write_page && options.output.empty())
    throw InputError("command line", "--output", "\"\"", "the name of a folder");
  if (const auto file = scene_file(options.typed_case.file); !file.empty())
    return run_scene(file, options);
  const input::Case contact_case = read_case(options.typed_case);
  input::require_coulomb(contact_case, "select");
  input::refuse_curved_pad(contact_case, "softfinger select");
  if (std::holds_alternative<input::PadPair>(contact_case.geometry))
    return run_pad(contact_case, options);
  options.selection.models = allowed_models(options.models, all_pressure_models());
  const prediction::GeometryResolver resolver(contact_case);
  for (const std::string& line : resolver.remarks()) remark(line);
  std::vector<judgement::LoadChoice> loads;
  std::string first_lines, tables;
  for (const double load_N : contact_case.loads_N) {
    judgement::LoadChoice& load = loads.emplace_back();
    load.geometry =
        judgement::resolve_or_advise(contact_case, resolver, load_N, options.selection.demand);
    load.problem = prediction::contact_problem(contact_case, load.geometry, load_N);
    load.choice = judgement::choose_model(contact_case, load.geometry, load_N, options.selection);
    first_lines += answer_line(load.choice);
    tables += table(load.choice, options.selection);
    // For people only: it may take some tenths of a second.
    if (load.choice.chosen < 0 && !options.json)
      first_lines +=
          "  " + advice(contact_case, resolver, load.geometry, load_N, options.selection.demand) +
          "\n";
  }
  std::vector<judgement::Choice> choices;
  for (const judgement::LoadChoice& load : loads) choices.push_back(load.choice);
  const nlohmann::json result = selection_json(contact_case, options.demand.tolerance, choices);
  if (options.write_page) {
    const nlohmann::json report = judgement::selection_report(
        contact_case, resolver, options.selection, loads, options.command_line);
    write_page(options.output, result, report::render_selection(report));
  }
  if (options.json)
    system::write_to_stdout(text::printed(result));
  else
    system::write_text_to_stdout(system::within_terminal(
        first_lines + tables + "\n" + prediction::describe(contact_case) + "\n"));
  return 0;
}

}  // namespace

void add_select(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<SelectOptions>();
  CLI::App* command = app.add_subcommand(
      "select",
      "The cheapest model whose stated error meets a tolerance, or a clear \"none\", and why");
  add_case(*command, options->typed_case, false, input::FlatPads::taken);
  add_demand(*command, options->demand);
  command
      ->add_option("--budget-us", options->selection.budget_us,
                   "longest time allowed for one answer, in microseconds, 1e-3 to 1e12; default: "
                   "any")
      ->check(CLI::Range(1e-3, 1e12));
  command->add_option("--models,--model", options->models,
                      "allowed models, separated by commas; \"fem\" is one; default: all");
  options->command_line = command_line;
  const CLI::Option* output = command->add_option(
      "-o,--output", options->output,
      "folder for a page with the choice, the figures of speed and accuracy and, of chosen models "
      "that the error atlas has, the maps of "
      "validity: select.html, and select.json; of a scene, what each pair of bodies needs");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "CASE may be a scene, too: which contacts can be points, ellipsoids or exact limit surfaces, "
      "and with\n"
      "which model. It measures how much of its friction limit each contact uses, how much the\n"
      "simpler models change the motion, and what of a step's time they save. It says first "
      "whether\n"
      "the scene holds, slips or lets go as it does with the models that it is written with.\n"
      "Contacts that are alike get the same.\n"
      "Stated errors are bounds against the finger itself, curved and at finite strain, fitted to\n"
      "finite-element runs: 95 % of them lie inside. What the fit of a mesh leaves open is added.\n"
      "predict states the same ones. Models that take milliseconds are not asked.\n"
      "A flat pad has models of its own, pad_layer and pad_uniform, and no semi-axes a and b.\n"
      "Samples:\n"
      "  softfinger select seed_thumb --tolerance 0.05\n"
      "  softfinger select silicone_pad_2mm --tolerance 0.05 --output my_choice\n"
      "  softfinger select silicone_pad_2mm --tolerance 0.02 --budget-us 5 --quantities "
      "max_torque\n"
      "  softfinger select robotiq_like_pad --tolerance 0.03\n"
      "  softfinger select pinch --tolerance 0.02\n"
      "  softfinger select hertz_ratio_4 --tolerance 0.05 --models hertz,winkler --json");
  command->callback([options, output, &action] {
    options->write_page = output->count() > 0;
    action = [options] { return run_select(*options); };
  });
}

}  // namespace softfinger::commands
