#include "comparisons/suite/suite_report.h"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "comparisons/experiments/experiments_report.h"
#include "comparisons/input/layer_json.h"
#include "comparisons/judgement/atlas/atlas_overview.h"
#include "comparisons/judgement/scoring.h"
#include "comparisons/prediction/answer_json.h"
#include "comparisons/suite/csv_cells.h"
#include "comparisons/suite/pad_report.h"
#include "comparisons/system/clock.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/csv.h"
#include "comparisons/text/json_text.h"

namespace softfinger::suite {
namespace {

namespace fs = std::filesystem;
using judgement::CaseComparison;
using judgement::Comparison;
using judgement::ModelComparison;
using nlohmann::json;
using prediction::TorqueRule;
using text::finite_or_null;

json to_json(const std::optional<reference::PressureProfile>& profile) {
  if (!profile) return nullptr;
  return {{"position_m", profile->position_m}, {"pressure_Pa", profile->pressure_Pa}};
}

json to_json(const std::optional<judgement::RelativeErrors>& errors) {
  if (!errors) return nullptr;
  return {{"a", finite_or_null(errors->a)},
          {"b", finite_or_null(errors->b)},
          {"area", finite_or_null(errors->area)},
          {"indentation", finite_or_null(errors->indentation)},
          {"peak_pressure", finite_or_null(errors->peak_pressure)},
          {"max_torque", finite_or_null(errors->max_torque)},
          {"max_torque_paper", finite_or_null(errors->max_torque_paper)},
          {"pressure_misfit", finite_or_null(errors->pressure_misfit)}};
}

json to_json(const ModelComparison& model) {
  const prediction::ModelAnswer& answer = model.answer;
  json object = prediction::to_json(answer, TorqueRule::exact, 0);
  object.erase("load_N");
  // Here it is measured: the verdict says it.
  object.erase("usable");
  const bool has_answer = answer.prediction.has_answer;
  const double paper_Nm = answer.friction_ellipsoid(TorqueRule::paper).max_torque_Nm();
  object["has_answer"] = has_answer;
  object["hot_path"] = answer.model->card().hot_path;
  object["max_torque_paper_Nm"] = has_answer ? finite_or_null(paper_Nm) : json();
  object["relative_error"] = to_json(model.errors);
  object["profile_x"] = to_json(model.along_x);
  object["profile_y"] = to_json(model.along_y);
  return object;
}

/// The finite elements' own document, with what was found out about it.
json reference_json(const Comparison& load) {
  if (!load.reference) return nullptr;
  json object = load.reference->document;
  object["trusted"] = reference::is_trusted(*load.reference);
  object["vtu"] = nullptr;
  if (load.reference->vtu_file) {
    // The page lies in the output folder: a link must not depend on where that folder is.
    object["vtu"] = (fs::path("fem") / load.folder / fs::path(*load.reference->vtu_file).filename())
                        .generic_string();
  }
  return object;
}

/// Each facet: x, y of its corners, and its height above the quadric; to the nanometre.
json to_json(const prediction::FitPicture& picture) {
  const auto rounded = [](double length_m) { return std::round(length_m * 1e9) / 1e9; };
  json facets = json::array();
  for (const prediction::FitPicture::Facet& facet : picture.facets) {
    json numbers = json::array();
    for (const Eigen::Vector2d& corner : facet.corners_m) {
      numbers.push_back(rounded(corner.x()));
      numbers.push_back(rounded(corner.y()));
    }
    numbers.push_back(rounded(facet.above_m));
    facets.push_back(numbers);
  }
  return {{"region_radius_m", picture.region_radius_m}, {"facets", facets}};
}

json geometry_json(const Comparison& load) {
  const prediction::LocalGeometry& geometry = load.geometry;
  json object = {{"radii_m", {geometry.radii.major_m, geometry.radii.minor_m}},
                 {"radii_std_m", nullptr},
                 {"axis_rad", geometry.radii.axis_rad},
                 {"s", nullptr},
                 {"patch", prediction::patch_to_json(geometry)}};
  for (const auto& [body, picture] :
       {std::pair("finger", &load.finger_picture), std::pair("object", &load.object_picture)})
    if (*picture) object["patch"]["pictures"][body] = to_json(**picture);
  if (geometry.patch) {
    const auto& deviations = geometry.patch->relative.radii_std_m;
    object["radii_std_m"] = {finite_or_null(deviations[0]), finite_or_null(deviations[1])};
  }
  if (const auto size = load.size()) object["s"] = *size;
  object["error"] = prediction::to_json(load.geometry_error());
  return object;
}

json to_json(const judgement::LadderStep& step) {
  json quantity;
  for (std::size_t q = 0; q < step.departure.size(); ++q)
    quantity[judgement::kLadderQuantities[q]] = finite_or_null(step.departure[q]);
  return {{"step", step.step}, {"words", step.words}, {"quantity", quantity}};
}

json to_json(const judgement::Ladder& ladder) {
  json steps = json::array();
  for (const judgement::LadderStep& step : ladder.steps) steps.push_back(to_json(step));
  for (const judgement::LadderStep& doubt : ladder.doubts) steps.push_back(to_json(doubt));
  return steps;
}

json to_json(const Comparison& load) {
  json models = json::array();
  for (const ModelComparison& model : load.models) {
    models.push_back(to_json(model));
    models.back()["sound"] = judgement::is_sound(model.answer.prediction, *load.contact_case);
  }
  json object = {{"load_N", load.load_N},
                 {"geometry", geometry_json(load)},
                 {"fem", reference_json(load)},
                 {"models", models}};
  if (!load.reference) object["fem_failure"] = load.failure;
  object["ladder"] = load.ladder ? to_json(*load.ladder) : json::array();
  object["largest_step"] = load.ladder ? load.ladder->sentence : "";
  return object;
}

json to_json(const CaseComparison& compared) {
  const input::Case& contact_case = *compared.contact_case;
  json sublayers = json::array(), loads = json::array();
  for (const input::Sublayer& sublayer : contact_case.sublayers) {
    sublayers.push_back(input::layer_json(sublayer.layer));
    sublayers.back()["name"] = sublayer.name;
  }
  for (const Comparison& load : compared.loads) loads.push_back(to_json(load));
  return {{"id", contact_case.id},
          {"question", contact_case.question},
          {"verdict", compared.verdict.sentence},
          {"reference", judgement::reference_in_words(contact_case)},
          {"verdict_class", judgement::name_of(compared.verdict.verdict_class)},
          {"file", contact_case.file.filename().string()},
          {"case_toml", contact_case.text},
          {"layer", input::layer_json(contact_case.layer)},
          {"sublayers", sublayers},
          {"friction_coefficient", contact_case.shear_law.friction_coefficient},
          {"loads", loads}};
}

json to_json(const ModelCard& card) {
  return {{"name", card.name},
          {"title", card.title},
          {"assumptions", card.assumptions},
          {"equations", card.equations},
          {"source", card.source},
          {"validity", card.validity},
          {"cost", card.cost}};
}

/// The cards of all models. Those of pads and of lines come last, and only where a case has one.
json model_cards(const SuiteComparison& suite) {
  json cards = json::array();
  for (const PressureModel* model : all_pressure_models()) cards.push_back(to_json(model->card()));
  if (!suite.pads.empty())
    for (const PadModel* model : all_pad_models()) cards.push_back(to_json(model->card()));
  const bool has_line = std::any_of(
      suite.pads.begin(), suite.pads.end(), [](const judgement::PadCaseComparison& pad) {
        return std::get<input::PadPair>(pad.contact_case->geometry).curved.has_value();
      });
  if (has_line) cards.push_back(to_json(line_layer().card()));
  return cards;
}

std::string machine_name() {
  utsname system = {};
  uname(&system);
  std::string processor = system.machine;
  std::ifstream information("/proc/cpuinfo");
  for (std::string line; std::getline(information, line);)
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos) {
      processor = line.substr(line.find(": ") + 2);
      break;
    }
  return fmt::format("{}, {} {}", processor, system.sysname, system.machine);
}

json provenance(const SuiteComparison& suite) {
  std::optional<double> peak_memory_MB;
  const auto count_memory = [&](double used_MB) {
    peak_memory_MB = std::max(peak_memory_MB.value_or(0), used_MB);
  };
  for (const CaseComparison& compared : suite.cases)
    for (const Comparison& load : compared.loads)
      if (load.reference && load.reference->peak_memory_MB)
        count_memory(*load.reference->peak_memory_MB);
  for (const judgement::PadCaseComparison& compared : suite.pads)
    for (const judgement::PadComparison& load : compared.loads)
      if (load.elements) count_memory(load.elements->peak_memory_MB);
  return {{"version", system::program_version()},
          {"date", system::utc_now()},
          {"compiler", system::compiler()},
          {"build_type", system::build_type()},
          {"machine", machine_name()},
          {"cores", suite.cores},
          {"command", suite.command},
          {"wall_s", suite.wall_s},
          {"peak_memory_MB", peak_memory_MB ? json(*peak_memory_MB) : json()}};
}

constexpr const char* kErrors[] = {"a", "b", "area", "indentation", "peak_pressure", "max_torque"};
const std::string kNoErrors(std::size(kErrors), ',');

std::string csv_head() {
  std::string head =
      "case,load_N,thickness_m,youngs_modulus_Pa,poisson_ratio,friction_coefficient,"
      "radius_major_m,radius_minor_m,model,usable,a_m,b_m,axis_rad,indentation_m,peak_pressure_Pa,"
      "area_m2,area_projected_m2,max_torque_Nm,eccentricity_m,max_torque_paper_Nm";
  for (const char* key : kErrors) head += std::string(",relative_error_") + key;
  for (const char* key : kErrors) head += std::string(",stated_error_") + key;
  return head + ",cost_ns,wall_s" + kPadColumns + "\n";
}

std::string contact_cells(const Comparison& load) {
  const input::Case& contact_case = *load.contact_case;
  const ElasticLayer& layer = contact_case.layer;
  return text::csv_cell(contact_case.id) +
         cells({load.load_N, layer.thickness_m, layer.youngs_modulus_Pa, layer.poisson_ratio,
                contact_case.shear_law.friction_coefficient, load.geometry.radii.major_m,
                load.geometry.radii.minor_m});
}

std::string reference_row(const Comparison& load) {
  const reference::ReferenceResult& result = *load.reference;
  const reference::ReferenceErrors& error = result.error;
  return contact_cells(load) + ",fem," + (reference::is_trusted(result) ? "yes" : "no") +
         cells({result.a_m, result.b_m, result.axis_rad, result.indentation_m,
                result.peak_pressure_Pa, result.area_m2, result.area_projected_m2,
                result.max_torque_Nm, result.eccentricity_m}) +
         "," + kNoErrors +
         cells({error.a, error.b, error.area, error.indentation, error.peak_pressure,
                error.max_torque}) +
         "," + cell(result.wall_s) + kEllipseInPadColumns + "\n";
}

std::string model_row(const Comparison& load, const ModelComparison& model, bool usable) {
  const prediction::ModelAnswer& answer = model.answer;
  const Prediction& p = answer.pressed();
  const FrictionEllipsoid exact = answer.friction_ellipsoid(TorqueRule::exact);
  std::string numbers =
      p.has_answer
          ? cells({p.a_m, p.b_m, answer.problem.radii.axis_rad, p.indentation_m, p.peak_pressure_Pa,
                   p.area_m2(), p.area_m2(), exact.max_torque_Nm(), exact.eccentricity_m,
                   answer.friction_ellipsoid(TorqueRule::paper).max_torque_Nm()})
          : ",," + cell(answer.problem.radii.axis_rad) + ",,,,,,,";
  const auto& errors = model.errors;
  return contact_cells(load) + "," + text::csv_cell(std::string(answer.model->card().name)) + "," +
         (usable ? "yes" : "no") + numbers +
         (errors ? cells({errors->a, errors->b, errors->area, errors->indentation,
                          errors->peak_pressure, errors->max_torque})
                 : kNoErrors) +
         kNoErrors + cell(answer.cost_ns) + "," + kEllipseInPadColumns + "\n";
}

}  // namespace

bool is_trusted_everywhere(const SuiteComparison& suite) {
  for (const CaseComparison& compared : suite.cases)
    for (const Comparison& load : compared.loads)
      if (!load.reference || !reference::is_trusted(*load.reference)) return false;
  for (const judgement::PadCaseComparison& compared : suite.pads)
    for (const judgement::PadComparison& load : compared.loads)
      if (!load.elements || !reference::is_trusted(*load.elements)) return false;
  return true;
}

json report_json(const SuiteComparison& suite) {
  json cases = json::array();
  for (const CaseComparison& compared : suite.cases) cases.push_back(to_json(compared));
  for (const judgement::PadCaseComparison& compared : suite.pads)
    cases.push_back(pad_json(compared));
  return {{"tolerance", suite.tolerance},
          {"models", model_cards(suite)},
          {"cases", cases},
          {"provenance", provenance(suite)}};
}

json page_json(const SuiteComparison& suite) {
  json atlas = judgement::atlas_overview(judgement::error_atlas().file());
  if (!atlas.is_null()) {
    json& marks = atlas["marks"] = judgement::seed_marks();
    for (const CaseComparison& compared : suite.cases)
      for (const Comparison& load : compared.loads) {
        const ContactProblem problem =
            compared.contact_case->problem(load.geometry.radii, load.load_N);
        // The publication's fingertips are there already.
        if (json mark = judgement::map_mark(*compared.contact_case, problem); mark["seed"] == false)
          marks.push_back(std::move(mark));
      }
  }
  return {
      {"atlas", atlas},
      {"finite_strain", judgement::finite_strain_overview(judgement::finite_strain_atlas().file())},
      {"experiments", experiments::to_json(experiments::examine_builtin())}};
}

std::string results_csv(const SuiteComparison& suite) {
  std::string csv = csv_head();
  for (const CaseComparison& compared : suite.cases)
    for (const Comparison& load : compared.loads) {
      if (load.reference) csv += reference_row(load);
      const judgement::LoadErrors errors = judgement::errors_of(load);
      for (std::size_t i = 0; i < load.models.size(); ++i)
        csv += model_row(load, load.models[i],
                         judgement::judge(errors, errors.models[i], suite.tolerance) ==
                             judgement::Judgement::usable);
    }
  for (const judgement::PadCaseComparison& compared : suite.pads) csv += pad_csv_rows(compared);
  return csv;
}

json results_json(const Comparison& load, double tolerance) {
  json results = json::array();
  if (load.reference) {
    const reference::ReferenceResult& fem = *load.reference;
    results.push_back({{"case", load.contact_case->id},
                       {"load_N", load.load_N},
                       {"model", "fem"},
                       {"a_m", fem.a_m},
                       {"b_m", fem.b_m},
                       {"indentation_m", fem.indentation_m},
                       {"area_projected_m2", fem.area_projected_m2},
                       {"max_torque_Nm", fem.max_torque_Nm},
                       {"eccentricity_m", fem.eccentricity_m},
                       {"error", fem.document.value("error", json())},
                       {"geometry_error", prediction::to_json(load.geometry_error())}});
  }
  const judgement::LoadErrors errors = judgement::errors_of(load);
  for (std::size_t i = 0; i < load.models.size(); ++i) {
    const prediction::ModelAnswer& answer = load.models[i].answer;
    const Prediction& p = answer.pressed();
    const auto number = [&](double value) { return p.has_answer ? finite_or_null(value) : json(); };
    const FrictionEllipsoid limit = answer.friction_ellipsoid(TorqueRule::exact);
    results.push_back({{"case", load.contact_case->id},
                       {"load_N", load.load_N},
                       {"model", answer.model->card().name},
                       {"a_m", number(p.a_m)},
                       {"b_m", number(p.b_m)},
                       {"indentation_m", number(p.indentation_m)},
                       {"area_projected_m2", number(p.area_m2())},
                       {"max_torque_Nm", number(limit.max_torque_Nm())},
                       {"eccentricity_m", number(limit.eccentricity_m)},
                       {"usable", judgement::judge(errors, errors.models[i], tolerance) ==
                                      judgement::Judgement::usable},
                       {"relative_error", to_json(load.models[i].errors)}});
  }
  return results;
}

}  // namespace softfinger::suite
