#include "comparisons/suite/pad_report.h"

#include "comparisons/input/layer_json.h"
#include "comparisons/suite/csv_cells.h"
#include "comparisons/text/csv.h"
#include "comparisons/text/json_text.h"

namespace softfinger::suite {
namespace {

using judgement::PadCaseComparison;
using judgement::PadComparison;
using judgement::PadModelComparison;
using judgement::PadModelErrors;
using nlohmann::json;
using text::finite_or_null;

json profile_json(const std::optional<reference::PressureProfile>& profile) {
  if (!profile) return nullptr;
  return {{"position_m", profile->position_m}, {"pressure_Pa", profile->pressure_Pa}};
}

json errors_json(const std::optional<PadModelErrors>& errors) {
  if (!errors) return nullptr;
  return {{"a", nullptr},
          {"b", nullptr},
          {"area", 0},
          {"indentation", finite_or_null(errors->indentation)},
          {"peak_pressure", finite_or_null(errors->peak_pressure)},
          {"max_torque", finite_or_null(errors->max_torque)},
          {"normal_stiffness", finite_or_null(errors->normal_stiffness)},
          {"pressure_arm", finite_or_null(errors->pressure_arm)},
          {"tilt_stiffness", finite_or_null(errors->tilt_stiffness)}};
}

json model_json(const PadModelComparison& model) {
  json object = prediction::to_json(model.answer, 0);
  object["has_answer"] = model.answer.prediction.has_answer;
  object["hot_path"] = true;
  object["sound"] = model.is_sound;
  object["usable"] = model.judgement == judgement::Judgement::usable;
  object["relative_error"] = errors_json(model.errors);
  object["profile_x"] = profile_json(model.along_x);
  object["profile_y"] = profile_json(model.along_y);
  return object;
}

json elements_json(const PadCaseComparison& compared, const PadComparison& load) {
  if (!load.elements) return nullptr;
  json object = reference::to_json(*load.elements, *compared.contact_case);
  const auto& pressure = load.elements->pressure;
  object["trusted"] = reference::is_trusted(*load.elements);
  object["levels"] = load.elements->document.value("levels", json::array());
  object["pressure"] = {
      {"x_m", pressure.x_m}, {"y_m", pressure.y_m}, {"pressure_Pa", pressure.pressure_Pa}};
  object["profile_x"] = profile_json(load.along_x);
  object["profile_y"] = profile_json(load.along_y);
  return object;
}

json points_json(const ConvexOutline& outline) {
  json points = json::array();
  for (const Eigen::Vector2d& vertex : outline.vertices_m())
    points.push_back({vertex.x(), vertex.y()});
  return points;
}

json load_json(const PadCaseComparison& compared, const PadComparison& load) {
  json models = json::array();
  for (const PadModelComparison& model : load.models) models.push_back(model_json(model));
  json object = {
      {"load_N", load.load_N}, {"fem", elements_json(compared, load)}, {"models", models}};
  if (!load.elements) object["fem_failure"] = load.failure;
  return object;
}

/// The largest error that one of them states; the columns of tables have one number for both axes.
std::string stated_cells(const reference::PadElementErrors& error) {
  return cells({{}, {}, 0.0, error.indentation, error.peak_pressure, error.max_torque});
}

std::string elements_row(const std::string& head, const PadComparison& load) {
  const reference::PadElements& pad = *load.elements;
  return head + ",fem," + (reference::is_trusted(pad) ? "yes" : "no") +
         cells({{},
                {},
                {},
                pad.indentation_m,
                pad.peak_pressure_Pa,
                pad.area_m2,
                pad.area_m2,
                pad.max_torque_Nm,
                pad.eccentricity_m,
                {}}) +
         ",,,,,," + stated_cells(pad.error) + "," + cell(pad.wall_s) + ",patch" +
         cells({pad.normal_stiffness_N_per_m,
                pad.pressure_arm_m,
                pad.tilt_stiffness_Nm_per_rad[0],
                pad.tilt_stiffness_Nm_per_rad[1],
                {},
                {},
                {},
                pad.error.normal_stiffness,
                pad.error.pressure_arm,
                pad.error.tilt_stiffness}) +
         "\n";
}

std::string model_row_of_pad(const std::string& head, const PadModelComparison& model) {
  const PadPrediction& p = model.answer.prediction;
  const auto number = [&](double value) {
    return p.has_answer ? std::optional(value) : std::nullopt;
  };
  const auto error = [&](double PadModelErrors::*which) {
    return model.errors ? std::optional((*model.errors).*which) : std::nullopt;
  };
  const double area_m2 = model.answer.area_m2();
  return head + "," + text::csv_cell(std::string(model.answer.model->card().name)) + "," +
         (model.judgement == judgement::Judgement::usable ? "yes" : "no") +
         cells({{},
                {},
                {},
                number(p.indentation_m),
                number(p.peak_pressure_Pa),
                number(area_m2),
                number(area_m2),
                number(model.answer.friction_ellipsoid().max_torque_Nm()),
                number(p.eccentricity_m),
                {},
                {},
                {},
                model.errors ? std::optional(0.0) : std::nullopt,
                error(&PadModelErrors::indentation),
                error(&PadModelErrors::peak_pressure),
                error(&PadModelErrors::max_torque)}) +
         ",,,,,," + cell(model.answer.cost_ns) + ",,patch" +
         cells({number(p.normal_stiffness_N_per_m),
                number(p.pressure_arm_m),
                number(p.tilt_stiffness_Nm_per_rad[0]),
                number(p.tilt_stiffness_Nm_per_rad[1]),
                error(&PadModelErrors::normal_stiffness),
                error(&PadModelErrors::pressure_arm),
                error(&PadModelErrors::tilt_stiffness),
                {},
                {},
                {}}) +
         "\n";
}

}  // namespace

const std::string kPadColumns =
    ",contact,normal_stiffness_N_per_m,pressure_arm_m,tilt_stiffness_x_Nm_per_rad,"
    "tilt_stiffness_y_Nm_per_rad,relative_error_normal_stiffness,relative_error_pressure_arm,"
    "relative_error_tilt_stiffness,stated_error_normal_stiffness,stated_error_pressure_arm,"
    "stated_error_tilt_stiffness";
const std::string kEllipseInPadColumns = ",ellipse,,,,,,,,,,";

json pad_json(const PadCaseComparison& compared) {
  const input::Case& contact_case = *compared.contact_case;
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  json loads = json::array();
  for (const PadComparison& load : compared.loads) loads.push_back(load_json(compared, load));
  return {{"id", contact_case.id},
          {"contact", "patch"},
          {"question", contact_case.question},
          {"description", prediction::describe(pair, contact_case.layer)},
          {"outline_m", points_json(pair.contact)},
          {"pad_outline_m", points_json(pair.pad)},
          {"verdict", compared.verdict.sentence},
          {"reference", "the whole pad in linear theory"},
          {"verdict_class", judgement::name_of(compared.verdict.verdict_class)},
          {"file", contact_case.file.filename().string()},
          {"case_toml", contact_case.text},
          {"layer", input::layer_json(contact_case.layer)},
          {"sublayers", json::array()},
          {"friction_coefficient", contact_case.shear_law.friction_coefficient},
          {"loads", loads}};
}

json pad_results_json(const PadCaseComparison& compared) {
  json results = json::array();
  for (const PadComparison& load : compared.loads) {
    if (load.elements) {
      results.push_back(reference::to_json(*load.elements, *compared.contact_case));
      results.back()["case"] = compared.contact_case->id;
    }
    for (const PadModelComparison& model : load.models) {
      json one = model_json(model);
      one["case"] = compared.contact_case->id;
      for (const char* key : {"profile_x", "profile_y", "hot_path", "sound", "has_answer"})
        one.erase(key);
      results.push_back(one);
    }
  }
  return results;
}

std::string pad_csv_rows(const PadCaseComparison& compared) {
  const input::Case& contact_case = *compared.contact_case;
  const ElasticLayer& layer = contact_case.layer;
  std::string rows;
  for (const PadComparison& load : compared.loads) {
    const std::string head =
        text::csv_cell(contact_case.id) + cells({load.load_N,
                                                 layer.thickness_m,
                                                 layer.youngs_modulus_Pa,
                                                 layer.poisson_ratio,
                                                 contact_case.shear_law.friction_coefficient,
                                                 {},
                                                 {}});
    if (load.elements) rows += elements_row(head, load);
    for (const PadModelComparison& model : load.models) rows += model_row_of_pad(head, model);
  }
  return rows;
}

}  // namespace softfinger::suite
