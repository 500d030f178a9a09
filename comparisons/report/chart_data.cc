#include "comparisons/report/chart_data.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "comparisons/judgement/scoring.h"
#include "comparisons/report/atlas_sections.h"
#include "comparisons/report/report_json.h"
#include "comparisons/report/style.h"

namespace softfinger::report {
namespace {

double rounded(double value, int digits) {
  return std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
}

Json number_or_null(const Json& object, const char* key) {
  const auto value = number(object, key);
  // More digits than the tables show: a label in a chart must not round differently.
  return value ? Json(rounded(*value, 8)) : Json();
}

/// At most this many points per half axis: a curve 300 pixels wide shows no more.
constexpr std::size_t kProfilePoints = 48;

Json profile(const Json& source) {
  const Json& positions = child(source, "position_m");
  const Json& pressures = child(source, "pressure_Pa");
  if (!positions.is_array() || !pressures.is_array()) return nullptr;
  const std::size_t count = std::min(positions.size(), pressures.size());
  if (count == 0) return nullptr;
  const std::size_t kept = std::min(count, kProfilePoints);
  Json x = Json::array(), p = Json::array();
  for (std::size_t i = 0; i < kept; ++i) {
    // First and last are kept, and more towards the edge, where the pressure falls steeply.
    const double quarter = kept == 1 ? 0 : 1.5707963267948966 * i / (kept - 1);
    const auto spread = static_cast<std::size_t>(std::lround((count - 1) * std::sin(quarter)));
    const std::size_t source_index = kept == count ? i : spread;
    const auto position = element(positions, source_index);
    const auto pressure = element(pressures, source_index);
    if (!position || !pressure) continue;
    x.push_back(rounded(*position, 5));
    p.push_back(rounded(*pressure, 5));
  }
  return {{"x", x}, {"p", p}};
}

Json copied(const Json& object, std::initializer_list<const char*> keys) {
  Json out = Json::object();
  for (const char* key : keys) out[key] = number_or_null(object, key);
  return out;
}

Json drawn_fem(const Json& fem) {
  if (fem.is_null()) return nullptr;
  Json out = copied(fem, {"a_m", "b_m", "axis_rad", "max_torque_Nm", "wall_s"});
  out["error"] = copied(child(fem, "error"), {"a", "b", "max_torque"});
  out["trusted"] = flag(fem, "trusted");
  out["profile_x"] = profile(child(fem, "profile_x"));
  out["profile_y"] = profile(child(fem, "profile_y"));
  return out;
}

Json drawn_model(const judgement::LoadErrors& load, const judgement::ModelError& error,
                 const Json& model, double limit) {
  Json out =
      copied(model, {"a_m", "b_m", "axis_rad", "max_torque_Nm", "max_torque_paper_Nm", "cost_ns"});
  out["model"] = text(model, "model");
  out["has_answer"] = flag(model, "has_answer");
  out["sound"] = flag(model, "sound");
  out["hot_path"] = flag(model, "hot_path");
  out["relative_error"] =
      copied(child(model, "relative_error"), {"max_torque", "max_torque_paper"});
  const auto worst = judgement::score(load, error);
  out["score"] = worst ? Json(rounded(worst->error, 8)) : Json();
  out["usable"] = judgement::judge(load, error, limit) == judgement::Judgement::usable;
  out["profile_x"] = profile(child(model, "profile_x"));
  out["profile_y"] = profile(child(model, "profile_y"));
  return out;
}

}  // namespace

Json chart_data(const Json& report, const std::vector<judgement::CaseErrors>& compared) {
  Json cases = Json::array();
  for (std::size_t i = 0; i < compared.size(); ++i) {
    const Json& report_case = child(report, "cases")[i];
    Json loads = Json::array();
    for (std::size_t j = 0; j < compared[i].loads.size(); ++j) {
      const Json& load = child(report_case, "loads")[j];
      Json models = Json::array();
      const judgement::LoadErrors& errors = compared[i].loads[j];
      for (std::size_t k = 0; k < errors.models.size(); ++k)
        if (const Json& model = child(load, "models")[k]; is_asked(model))
          models.push_back(drawn_model(errors, errors.models[k], model, tolerance(report)));
      Json drawn = {{"load_N", number_or_null(load, "load_N")},
                    {"axis_rad", number_or_null(child(load, "geometry"), "axis_rad")},
                    {"s", number_or_null(child(load, "geometry"), "s")},
                    {"fem", drawn_fem(child(load, "fem"))},
                    {"models", std::move(models)}};
      loads.push_back(std::move(drawn));
    }
    cases.push_back(
        {{"id", text(report_case, "id")},
         {"poisson_ratio", number_or_null(child(report_case, "layer"), "poisson_ratio")},
         {"friction_coefficient", number_or_null(report_case, "friction_coefficient")},
         {"loads", std::move(loads)}});
  }
  return {{"tolerance", tolerance(report)},
          {"styles", chart_styles(report)},
          {"atlas", atlas_chart_data(report)},
          {"cases", cases}};
}

}  // namespace softfinger::report
