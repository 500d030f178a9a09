#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <variant>
#include <vector>

#include "comparisons/commands/answer_lines.h"
#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/commands/demand_input.h"
#include "comparisons/commands/mesh_points_text.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/commands/predict_pad.h"
#include "comparisons/commands/taxel_input.h"
#include "comparisons/experiments/experiments_report.h"
#include "comparisons/input/layer_json.h"
#include "comparisons/input/mesh_unit.h"
#include "comparisons/judgement/assessment.h"
#include "comparisons/judgement/input_doubt.h"
#include "comparisons/judgement/next_step.h"
#include "comparisons/judgement/recommended.h"
#include "comparisons/prediction/answer_in_time.h"
#include "comparisons/prediction/answer_json.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/curved_pad.h"
#include "comparisons/prediction/gap_sampling.h"
#include "comparisons/prediction/pad_answer.h"
#include "comparisons/report/time_page.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/terminal.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/stack_models.h"

namespace softfinger::commands {
namespace {

struct PredictOptions {
  CaseInput typed_case;
  DemandInput demand;
  TaxelInput taxels;
  std::string models = "all", torque_rule = "exact", gap = "quadric", page, command_line, at_time;
  int limit_surface = 0;
  bool json = false, explain = false, write_page = false;
};

// Short, so that measuring the cost of a call does not slow the program down noticeably.
constexpr double kCostBudget_ns = 0.7e6;

/// The requested models; with a sampled gap also layer_fft, which is the one that uses it.
std::vector<const PressureModel*> chosen_models(const PredictOptions& options,
                                                const input::Case& contact_case) {
  auto models = prediction::models_by_name(options.models);
  // Without a measured law the model that needs one has nothing to say.
  if (options.models == "all" && !(contact_case.options.power_law.radius_coefficient > 0))
    models.erase(
        std::remove_if(models.begin(), models.end(),
                       [](const PressureModel* model) { return model->card().is_empirical; }),
        models.end());
  // The answer of the fast model of several layers can be checked by the slow ones. For one layer
  // it would be shown twice.
  if (options.models == "all" && judgement::has_several_layers(contact_case))
    for (const char* name : {"layer_fredholm", "layer_fft"})
      models.push_back(find_pressure_model(name));
  else if (options.models == "all")
    models.erase(std::remove_if(models.begin(), models.end(),
                                [](const PressureModel* model) { return is_for_stacks(*model); }),
                 models.end());
  const PressureModel* sampler = find_pressure_model("layer_fft");
  if (options.gap == "sampled" &&
      std::find(models.begin(), models.end(), sampler) == models.end()) {
    if (options.models != "all")
      throw InputError("command line", "--gap", "sampled",
                       "with --model layer_fft among the models: the others need the quadric");
    models.push_back(sampler);
  }
  return models;
}

/// Limits the points of all loads and models together, so that the text stays below a gigabyte.
void check_limit_surface(const PredictOptions& options, std::size_t answers) {
  constexpr std::size_t kMostPoints = 1000000;
  if (answers * std::size_t(options.limit_surface) > kMostPoints)
    throw InputError("command line", "--limit-surface", std::to_string(options.limit_surface),
                     fmt::format("at most {} points for {} answers (loads times models)",
                                 kMostPoints / answers, answers));
}

/// The mesh of a case whose region is shown: the finger's, else the object's; null: neither is one.
const input::MeshBody* shown_mesh(const input::Case& contact_case) {
  const auto* bodies = std::get_if<input::BodyPair>(&contact_case.geometry);
  if (!bodies) return nullptr;
  const auto* finger = std::get_if<input::MeshBody>(&bodies->finger);
  return finger ? finger : std::get_if<input::MeshBody>(&bodies->object);
}

/// The argument as one types it: a built-in mesh by its name.
std::string typed_name(const std::filesystem::path& mesh) {
  for (const std::filesystem::path& file : system::builtin_mesh_files())
    if (std::error_code error; std::filesystem::equivalent(file, mesh, error))
      return mesh.filename().string();
  return mesh.string();
}

/// The prediction, and the mesh with the region that was fitted for each load.
void write_page(const PredictOptions& options, const input::Case& contact_case,
                const prediction::GeometryResolver& resolver, const input::MeshBody& mesh,
                const std::string& answers, const std::string& numbers) {
  report::MeshPage page;
  page.prediction = report::PrintedPrediction{contact_case.id, answers, numbers};
  for (const double load_N : contact_case.loads_N) {
    const prediction::LocalGeometry geometry = resolver.resolve(load_N);
    const auto& bodies = std::get<input::BodyPair>(contact_case.geometry);
    const bool is_finger = &mesh == std::get_if<input::MeshBody>(&bodies.finger);
    report::MeshPoint point;
    point.name = fmt::format("{:g} N", load_N);
    point.point_m = is_finger ? geometry.finger_point_m : geometry.object_point_m;
    point.fit = is_finger ? geometry.patch->finger_fit : geometry.patch->object_fit;
    point.normal = point.fit->normal;
    point.doubt = geometry.patch->remark;
    page.points.push_back(point);
  }
  const input::MeshBody placed = resolver.placed(mesh);
  write_fits_page(options.page,
                  {typed_name(mesh.path), mesh.part, *placed.metres_per_unit, placed.is_own_unit},
                  resolver.surface(mesh), std::move(page), options.command_line);
}

/// Curves of one model from a moment's first touch on.
report::TimeSeries series_of(const input::Case& contact_case,
                             const prediction::GeometryResolver& resolver,
                             const prediction::Moment& moment, const std::string& title,
                             const PressureModel& model, prediction::TorqueRule rule) {
  report::TimeSeries series;
  series.title = title;
  series.model = std::string(model.card().name);
  series.is_logarithmic = is_only_held(moment);
  series.marked_s = moment.time_s - (series.is_logarithmic ? moment.history.begin_s() : 0);
  for (const prediction::Moment& at : curve_of(moment)) {
    const prediction::ModelAnswer now =
        ask_in_time(model, contact_case, geometry_at(contact_case, resolver, at), at).now;
    if (!now.prediction.has_answer) continue;
    series.time_s.push_back(at.time_s - (series.is_logarithmic ? moment.history.begin_s() : 0));
    series.load_N.push_back(now.problem.load.normal_force_N);
    series.length_m.push_back(2 * now.prediction.a_m);
    series.width_m.push_back(2 * now.prediction.b_m);
    series.indentation_m.push_back(now.prediction.indentation_m);
    series.max_torque_Nm.push_back(now.friction_ellipsoid(rule).max_torque_Nm());
  }
  return series;
}

/// Line with the moments about the contact's two tangents, which the limit surface does not cover:
/// rolling stiffness and tilt limit.
std::string tilting_text(const nlohmann::json& result) {
  const auto& limit = result["tilt_limit_Nm"];
  const auto& rolling = result["rolling_stiffness_Nm_per_rad"];
  if (limit.is_null()) return "";
  for (const auto& one : limit)
    if (!std::isfinite(1e3 * one.get<double>())) return "";
  // In mN·m what is just finite in N·m no longer is.
  const auto rolls = [&](int axis) {
    return rolling[axis].is_null() || !std::isfinite(1e3 * rolling[axis].get<double>())
               ? "does not roll"
               : fmt::format("{:.4g} mN·m/rad by rolling", 1e3 * rolling[axis].get<double>());
  };
  return fmt::format(
      "  tilting about the long axis: {}, at most {:.4g} mN·m; about the short one: {}, at most "
      "{:.4g} mN·m\n",
      rolls(0), 1e3 * limit[0].get<double>(), rolls(1), 1e3 * limit[1].get<double>());
}

/// Lines below the first line of a load.
/// @param elastic  the contact that `first` is as large as
std::string block_of(const std::vector<prediction::ModelAnswer>& answers,
                     const prediction::ModelAnswer* first, const prediction::ModelAnswer* elastic,
                     prediction::TorqueRule rule, const prediction::Demand& demand) {
  std::string text;
  if (elastic)
    if (const std::string inputs = judgement::cost_of_inputs(*elastic, rule); !inputs.empty())
      text += "  torque by the inputs: " + inputs + "\n";
  for (const prediction::ModelAnswer& answer : answers) {
    if (!answer.sampled || !answer.prediction.has_answer) continue;
    const FrictionEllipsoid limit = answer.friction_ellipsoid(rule);
    text += fmt::format(
        "  sampled gap, by {}: torque {:.3g} mN·m, contact {:.3g} mm², e_n {:.3g} mm; no bound is "
        "known for it\n",
        answer.model->card().name, limit.max_torque_Nm() * 1e3,
        answer.sampled->region_area_m2 * 1e6, limit.eccentricity_m * 1e3);
  }
  return text + models_text(answers, first, rule, demand);
}

/// Options that a pad has no use for are refused, not ignored.
int run_predict_pad(const PredictOptions& options, const prediction::Demand& demand,
                    const input::Case& contact_case) {
  const auto refuse = [](const char* flag, const std::string& value, const char* allowed) {
    throw InputError("command line", flag, value, allowed);
  };
  if (options.torque_rule != "exact")
    refuse("--torque-rule", options.torque_rule,
           "\"exact\" for a flat pad: the paper's rule is for ellipses");
  if (options.gap != "quadric")
    refuse("--gap", options.gap, "nothing for a flat pad: it has no gap to sample");
  if (options.write_page)
    refuse("--page", options.page, "for a case whose finger or object is a mesh");
  options.taxels.refuse("for a contact of curved bodies: no array under a flat pad is computed");
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  const auto models = prediction::pad_models_by_name(options.models, pair.curved.has_value());
  check_limit_surface(options, models.size() * contact_case.loads_N.size());
  return predict_pad({demand, options.models, options.limit_surface, options.json, options.explain},
                     contact_case);
}

/// A sphere well inside of a pad is an ordinary contact.
input::Case settle_pad(const input::Case& typed) {
  const auto* pair = std::get_if<input::PadPair>(&typed.geometry);
  if (!pair || !pair->curved || pair->curved->is_cylinder()) return typed;
  input::Case ordinary = prediction::without_ends(typed);
  remark("the contact lies well inside of the pad: it is that of a layer without an end");
  return ordinary;
}

/// One load, or one moment of a case that knows time.
struct Asked {
  double load_N;
  std::optional<prediction::Moment> moment;
};

std::vector<Asked> asked_of(const PredictOptions& options, const input::Case& contact_case) {
  std::vector<Asked> all;
  const bool knows_time = contact_case.times.are_given();
  std::optional<double> time_s;
  if (!options.at_time.empty()) {
    time_s = number_of("--at-time", options.at_time, "a finite number of seconds");
  }
  if (knows_time && options.gap != "quadric")
    throw InputError("command line", "--gap", options.gap,
                     "\"quadric\" for a case with relaxation or history");
  if (knows_time)
    for (const prediction::Moment& moment : prediction::moments_of(contact_case, time_s))
      all.push_back({moment.history.value(moment.time_s), moment});
  else
    for (const double load_N : contact_case.loads_N) all.push_back({load_N, std::nullopt});
  return all;
}

/// Array that is asked for, where the case has a pressure for it.
std::optional<prediction::TaxelRequest> taxels_of(const PredictOptions& options,
                                                  const input::Case& contact_case) {
  const auto request = options.taxels.request();
  if (request && contact_case.times.are_given())
    options.taxels.refuse("for a case without relaxation and history");
  if (request && options.gap != "quadric")
    throw InputError("command line", "--gap", options.gap, "\"quadric\" together with --taxels");
  if (request) check_taxels(*request, contact_case);
  return request;
}

/// Asks all models of one load or moment, in the order of `models`.
struct AskedAnswers {
  std::vector<prediction::ModelAnswer> answers, elastic;
  std::vector<std::optional<judgement::InputDoubt>> doubts;
  std::vector<prediction::AnswerInTime> in_time;  ///< with a moment
};

int run_predict(const PredictOptions& options) {
  const prediction::Demand demand = options.demand.demand();
  const input::Case contact_case = settle_pad(read_case(options.typed_case));
  if (!options.at_time.empty()) refuse_time_without_times(contact_case, options.at_time);
  if (std::holds_alternative<input::PadPair>(contact_case.geometry))
    return run_predict_pad(options, demand, contact_case);
  const auto models = chosen_models(options, contact_case);
  const std::vector<Asked> all_asked = asked_of(options, contact_case);
  const std::optional<prediction::TaxelRequest> taxels = taxels_of(options, contact_case);
  check_limit_surface(options, models.size() * all_asked.size());
  const input::MeshBody* const mesh = shown_mesh(contact_case);
  if (options.write_page && options.page.empty())
    throw InputError("command line", "--page", "\"\"", "the name of an HTML file");
  if (options.write_page && !mesh && !contact_case.times.are_given())
    throw InputError("command line", "--page", options.page,
                     "for a case whose finger or object is a mesh, or with relaxation or history");
  const prediction::GeometryResolver resolver(contact_case);
  for (const std::string& line : resolver.remarks()) remark(line);
  const judgement::DoubtedCases doubted(contact_case, resolver);
  const prediction::TorqueRule rule = options.torque_rule == "paper"
                                          ? prediction::TorqueRule::paper
                                          : prediction::TorqueRule::exact;
  const double budget_ns = kCostBudget_ns / static_cast<double>(models.size() * all_asked.size());

  nlohmann::json results = nlohmann::json::array(), geometries = nlohmann::json::array();
  std::string first_lines, evidence = prediction::describe(contact_case) + "\n";
  if (contact_case.times.are_given())
    evidence +=
        "The errors are those of the elastic contact of the same size. They do not hold what is "
        "not known of the relaxation, nor that rubber at large strain relaxes by other shares\n";
  std::vector<std::string> titles, blocks;
  std::vector<report::TimeSeries> series;
  std::vector<prediction::TaxelAnswer> read_by_taxels;  ///< of the recommended models
  std::string advice;  ///< what to do where an answer is not usable
  for (const Asked& asked : all_asked) {
    const prediction::LocalGeometry geometry =
        asked.moment ? geometry_at(contact_case, resolver, *asked.moment)
                     : judgement::resolve_or_advise(contact_case, resolver, asked.load_N, demand);
    AskedAnswers all;
    std::vector<prediction::ModelAnswer>& answers = all.answers;
    for (const PressureModel* model : models) {
      if (asked.moment) {
        all.in_time.push_back(
            ask_in_time(*model, contact_case, geometry, *asked.moment, budget_ns));
        answers.push_back(all.in_time.back().elastic);
      } else if (options.gap == "sampled" && model->card().name == "layer_fft") {
        answers.push_back(
            prediction::ask_sampled_gap(resolver, geometry, contact_case, asked.load_N));
      } else {
        answers.push_back(
            prediction::ask_model(*model, contact_case, geometry, asked.load_N, budget_ns));
      }
      if (geometry.patch)
        prediction::propagate_radii_uncertainty(geometry.patch->relative, answers.back());
      answers.back().assessment =
          judgement::assess(contact_case, geometry, answers.back(), rule, demand);
      all.doubts.push_back(doubted.move(answers.back(), rule));
      all.elastic.push_back(answers.back());
      if (asked.moment) {
        prediction::AnswerInTime& in_time = all.in_time.back();
        in_time.elastic = answers.back();
        adopt_errors(in_time);
        answers.back() = in_time.now;
        results.push_back(to_json(in_time, *asked.moment, rule, options.limit_surface));
      } else {
        results.push_back(to_json(answers.back(), rule, options.limit_surface));
      }
    }
    const prediction::ModelAnswer* const first = judgement::recommended(answers);
    const std::size_t place = first ? std::size_t(first - answers.data()) : 0;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      nlohmann::json& result = results[results.size() - answers.size() + i];
      result["recommended"] = &answers[i] == first;
      result["input_doubt"] = to_json(all.doubts[i]);
      if (!taxels || !answers[i].prediction.has_answer) continue;
      // Text is about one model.
      if (!options.json && &answers[i] != first) continue;
      const prediction::TaxelAnswer read = read_taxels(answers[i], *taxels);
      result["taxels"] = to_json(read);
      if (&answers[i] == first) read_by_taxels.push_back(read);
    }
    // Under a prescribed approach the load is the model's.
    const double load_N = asked.moment && first ? first->problem.load.normal_force_N : asked.load_N;
    geometries.push_back({{"load_N", load_N},
                          {"radii_m", {geometry.radii.major_m, geometry.radii.minor_m}},
                          {"axis_rad", geometry.radii.axis_rad},
                          {"patch", prediction::patch_to_json(geometry)}});
    const std::string when = asked.moment ? " " + prediction::in_words(*asked.moment) : "";
    first_lines +=
        answer_line(load_N, first, rule, demand, first ? all.doubts[place] : std::nullopt, when);
    if (asked.moment && first)
      if (const std::string change = change_in_words(all.in_time[place], *asked.moment, rule);
          !change.empty())
        first_lines += "  " + change + "\n";
    if (taxels && first) first_lines += in_words(read_by_taxels.back());
    // A load that is answered at once and at rest has one curve.
    if (options.write_page && asked.moment && first &&
        !(asked.moment->is_held && asked.moment->time_s == 0))
      series.push_back(
          series_of(contact_case, resolver, *asked.moment,
                    asked.moment->is_held ? fmt::format("{:g} N held", load_N) : "The history",
                    *first->model, rule));
    titles.push_back(fmt::format("{:g} N{}", load_N, when));
    blocks.push_back(block_of(answers, first, first ? &all.elastic[place] : nullptr, rule, demand));
    // One search for all loads: it looks at many points of a mesh.
    if (!options.json && !asked.moment && advice.empty() && first && !first->assessment->usable)
      advice = judgement::next_step(contact_case, resolver, *first, demand).in_words();
    if (!options.json && advice.empty() && !first)
      advice = fmt::format(
          "without --model: {} is the recommended one",
          default_model(prediction::contact_problem(contact_case, geometry, load_N)).card().name);
    evidence += fmt::format("\n{}: {}\n", titles.back(), prediction::describe(geometry)) +
                table(answers, rule);
  }
  const std::string next_step = advice.empty() ? "" : "  " + advice + "\n";
  std::string numbers;
  for (std::size_t load = 0; load < blocks.size(); ++load)
    numbers += (blocks.size() > 1 ? "\n" + titles[load] + "\n" : "") + blocks[load];
  if (options.write_page && contact_case.times.are_given()) {
    report::TimePage page;
    page.case_id = contact_case.id;
    page.facts = prediction::describe(contact_case);
    page.answers = first_lines;
    page.series = std::move(series);
    page.version = "softfinger " + system::program_version();
    page.command = options.command_line;
    system::write_file_atomically(options.page, report::time_page(page));
    remark("the page is " + options.page);
  } else if (options.write_page) {
    write_page(options, contact_case, resolver, *mesh, first_lines + next_step, numbers);
  }
  if (taxels) options.taxels.write(read_by_taxels);
  // Last, so that a refusal stays a single line.
  for (const std::string& line : prediction::power_law_remarks(contact_case)) remark(line);
  if (options.json) {
    const ShearLaw& law = contact_case.shear_law;
    const bool two_layers = contact_case.object_layer.thickness_m > 0;
    nlohmann::json object = {
        {"case", contact_case.id},
        {"layer", input::layer_json(contact_case.layer)},
        {"layer_on", contact_case.layer_on_object ? "object" : "finger"},
        {"object_layer",
         two_layers ? input::layer_json(contact_case.object_layer) : nlohmann::json()},
        {"power_law_fit", prediction::to_json(contact_case.power_law_fit)},
        {"shear_law", law.name()},
        {"friction_coefficient", law.has_friction_coefficient()
                                     ? nlohmann::json(law.friction_coefficient)
                                     : nlohmann::json()},
        {"shear_strength_Pa",
         law.has_shear_strength() ? nlohmann::json(law.shear_strength_Pa) : nlohmann::json()},
        {"geometry", geometries},
        {"results", results}};
    if (contact_case.times.are_given()) {
      object["relaxation"] = prediction::relaxation_json(contact_case.times);
      object["history"] = prediction::history_json(contact_case.times);
    }
    system::write_to_stdout(text::printed(object));
  } else {
    std::string text = first_lines + next_step + numbers;
    if (options.explain) {
      text += "\n" + evidence;
      if (options.models == "all" && options.gap == "quadric")
        text += "Left out, slower than the others: " + text::joined(prediction::slow_models()) +
                "; ask with --model NAME or --model everything\n";
      text += experiments::noise_remark();
    }
    if (options.limit_surface > 0) {
      for (const auto& result : results) {
        if (result["limit_surface"].empty()) continue;
        text += fmt::format("\nLimit surface, {} at {:g} N: ", result["model"].get<std::string>(),
                            result["load_N"].get<double>());
        if (result["limit_surface_model"] == "exact")
          text += fmt::format(
              "exact for p ~ (1 - x²/a² - y²/b²)^n, n = {:.4g}, which has the model's torque; the "
              "friction ellipsoid is up to {:.1f} % outside of it and {:.1f} % inside\n",
              result["pressure_exponent"].get<double>(),
              -100 * result["ellipsoid_deviation"][0].get<double>(),
              100 * result["ellipsoid_deviation"][1].get<double>());
        else
          text += "the friction ellipsoid of Ciocarlie et al. (2007)\n";
        text += fmt::format("  {:>12}{:>12}{:>14}\n", "fx N", "fy N", "torque mN·m");
        for (const auto& point : result["limit_surface"])
          text += fmt::format("  {:>12.5g}{:>12.5g}{:>13.5g}\n", point["fx_N"].get<double>(),
                              point["fy_N"].get<double>(), point["torque_Nm"].get<double>() * 1e3);
        text += tilting_text(result);
      }
    }
    system::write_text_to_stdout(system::within_terminal(text));
  }
  return 0;
}

}  // namespace

void add_predict(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<PredictOptions>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand(
      "predict", "Contact ellipse, pressure, torque and validity of the analytic models, per load");
  add_case(*command, options->typed_case, false, input::FlatPads::taken);
  options->typed_case.times = input::Times::taken;
  command->add_option("--model,--models", options->models,
                      "model names, separated by commas; \"all\" (default): those that take "
                      "microseconds; \"everything\": also the slow ones; see: list models");
  add_demand(*command, options->demand);
  command->add_option("--at-time", options->at_time,
                      "seconds: the answer at this time, for a case with [layer] relaxation or "
                      "[contact] history; default: the end of the history, else at once and held "
                      "for long");
  command->add_flag("--explain", options->explain,
                    "also all numbers of all models, which of their assumptions fail, what each "
                    "cause costs in per cent, and what a mesh leaves open");
  command
      ->add_option(
          "--torque-rule", options->torque_rule,
          "\"exact\" (default): friction integrated over the ellipse; \"paper\": arm of the "
          "circle of radius sqrt(ab)")
      ->check(CLI::IsMember({"exact", "paper"}));
  command
      ->add_option(
          "--limit-surface", options->limit_surface,
          "also the moments about the contact's axes that tilt it, and N points all over the limit "
          "surface (forces in N along these axes, torque in N m): exact, or with --torque-rule "
          "paper the ellipsoid of Ciocarlie et al. (2007); 2 to 100000, and at most a million for "
          "all loads and models together")
      ->check(CLI::Range(2, 100000));
  command
      ->add_option(
          "--gap", options->gap,
          "\"quadric\" (default): all models get the quadrics fitted to meshes; "
          "\"sampled\": the model layer_fft gets the gap between the meshes themselves, "
          "sampled along the contact's normal (0.3 s per load; no error is known for it), all "
          "others the quadric")
      ->check(CLI::IsMember({"quadric", "sampled"}));
  add_taxels(*command, options->taxels, "the recommended model");
  const CLI::Option* page = command->add_option(
      "--page", options->page,
      "HTML file to write, for a case with a mesh: the surface in 3-D with the region and the "
      "quadric of each load, as softfinger mesh; for a case with relaxation or history: contact, "
      "indentation and torque against time");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "Case files may also contain, besides geometry, layer, contact and fem:\n"
      "  [layer] winkler_modulus = \"oedometric\" (default) or \"youngs\"\n"
      "  [object_layer] thickness_mm, youngs_modulus_kPa, poisson_ratio: a compliant object;\n"
      "    without [layer]: a rigid finger on it\n"
      "  [power_law] radius_coefficient_mm, radius_exponent, pressure_exponent (default 2), or\n"
      "    data = [[load_N, radius_mm], ...] to fit the first two: for the model power_law\n"
      "  [contact] shear_law = \"coulomb\" (default): a point carries the shear stress mu p,\n"
      "    \"shear_strength\" tau_0, \"limited\" min(mu p, tau_0), \"adhesive_shear\" tau_0 + mu "
      "p;\n"
      "    mu: friction_coefficient (not for shear_strength), tau_0: shear_strength_kPa (not for\n"
      "    coulomb). Largest force, torque and limit surface are the law's; e_n is largest torque "
      "/\n"
      "    largest force, which is mu P under Coulomb's law. The models' pressure is taken as\n"
      "    p ~ (1 - x²/a² - y²/b²)^n with n from their torque\n"
      "  [layer] relaxation = [{ share = 0.12, time_s = 0.5 }, ..]: parts of youngs_modulus_kPa "
      "that\n"
      "    are lost with time, or { exponent = 0.03, time_s = 0.01, until_s = 1e4 }, a power law\n"
      "  [contact] history = [{ time_s = 0, load_N = 0 }, { time_s = 0.2, load_N = 5 }, ..] in "
      "place of\n"
      "    load_N, linear between, a repeated time is a step; or approach_mm in place of its "
      "load_N;\n"
      "    see docs/a_gripper_that_creeps.md\n"
      "A flat pad: [geometry] finger = { pad_mm = [l, w] or pad_diameter_mm or pad_outline_mm,\n"
      "    corner_radius_mm, edge_radius_mm }, object = { flat = true } or { face_mm, "
      "face_diameter_mm or\n"
      "    face_outline_mm, offset_mm = [x, y], angle_deg }; [contact] pressing = \"stuck\" "
      "(default) or\n"
      "    \"frictionless\", load_at_mm = [x, y]; see: explain pad_layer, init --pad\n"
      "A case has at most 1000 loads, 100 sublayers, 1000 measured radii and 16 MiB.\n"
      "Samples:\n"
      "  softfinger predict seed_thumb\n"
      "  softfinger predict --radii-mm 20,12 --thickness-mm 2 --youngs-modulus-kPa 300 "
      "--poisson-ratio 0.49 --load 2\n"
      "  softfinger predict --pad-mm 22,37.5 --thickness-mm 3 --youngs-modulus-kPa 600 "
      "--poisson-ratio 0.49 --load 20\n"
      "  softfinger predict seed_thumb --set layer.thickness_mm=2 --quiet\n"
      "  softfinger predict hertz_ratio_4 --model hertz --torque-rule paper\n"
      "  softfinger predict silicone_pad_2mm --limit-surface 9 --json\n"
      "  softfinger predict silicone_pad_2mm --explain\n"
      "  softfinger predict pad_on_plane --gap sampled\n"
      "  softfinger predict silicone_pad_2mm --load 2 --taxels 8,8 --taxels-depth 2\n"
      "  softfinger predict pad_on_plane --page regions.html");
  command->callback([options, page, &action] {
    options->write_page = page->count() > 0;
    action = [options] { return run_predict(*options); };
  });
}

}  // namespace softfinger::commands
