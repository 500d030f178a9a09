#include "comparisons/prediction/taxel_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "comparisons/text/csv.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"

namespace softfinger::prediction {
namespace {

constexpr const char* kArrayOption = "--taxels";
/// A depth that is typed as the thickness may differ from it by a rounding.
constexpr double kRounding = 1 + 1e-12;

nlohmann::json table_json(const Eigen::ArrayXXd& values) {
  nlohmann::json rows = nlohmann::json::array();
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    nlohmann::json line = nlohmann::json::array();
    for (Eigen::Index column = 0; column < values.cols(); ++column)
      line.push_back(text::finite_or_null(values(row, column)));
    rows.push_back(std::move(line));
  }
  return rows;
}

/// "+1.2 %", "-0.3 %", "±0" of what nobody reads as a difference.
std::string signed_percent(double relative) {
  constexpr double kNothing = 5e-5;
  if (std::abs(relative) < kNothing) return "±0";
  return (relative > 0 ? "+" : "-") + text::percent(std::abs(relative));
}

}  // namespace

TaxelAnswer taxel_answer(taxels::TaxelReadings readings, const taxels::ForceCells& own) {
  TaxelAnswer answer;
  answer.normalisation = own.normalisation;
  answer.own_arm_m = own.arm_m;
  // Far beside the contact an array at depth may feel less than rounding.
  constexpr double kFelt = 1e-9;
  if (readings.force_N.sum() > kFelt * readings.load_N) {
    const taxels::ArrayMoments seen = moments_of(readings);
    answer.errors = {seen.spread_x_m / own.spread_x_m - 1, seen.spread_y_m / own.spread_y_m - 1,
                     seen.arm_m / own.arm_m - 1};
  }
  answer.readings = std::move(readings);
  answer.load_N = answer.readings.load_N;
  return answer;
}

void check_taxels(const TaxelRequest& request, const input::Case& contact_case) {
  const std::size_t sublayers = contact_case.sublayers.size();
  if (sublayers > LayerStack::kMost)
    throw InputError("command line", kArrayOption,
                     fmt::format("on a layer of {} sublayers", sublayers),
                     fmt::format("at most {} sublayers", LayerStack::kMost));
  const double thickness_m = contact_case.layer.thickness_m;
  if (!(request.depth_m >= 0 && request.depth_m <= thickness_m * kRounding))
    throw InputError(
        "command line", "--taxels-depth", 1e3 * request.depth_m,
        fmt::format("0 (the surface) to {:.6g} mm (the layer's base)", 1e3 * thickness_m));
  if (request.depth_m > 0 && sublayers > 1)
    throw InputError("command line", "--taxels-depth", 1e3 * request.depth_m,
                     "0 for a layer of several sublayers: no stress is known within them");
}

void refuse_taxels(const InputError& error, const TaxelRequest& request) {
  const std::string array = fmt::format("{},{}", request.columns, request.rows);
  if (request.pitch_m && error.field() == "pitch_m")
    throw InputError("command line", kArrayOption,
                     fmt::format("{},{:g}", array, 1e3 * *request.pitch_m),
                     "a pitch in mm that is " + error.allowed());
  throw InputError("command line", kArrayOption, array, error.field() + " " + error.allowed());
}

TaxelAnswer read_taxels(const ModelAnswer& answer, const TaxelRequest& request) {
  const double depth_m = std::min(request.depth_m, answer.problem.finger_layers().thickness_m());
  // A solved pressure is known without friction alone.
  const Prediction& prediction =
      answer.model->card().hot_path ? answer.pressed() : answer.prediction;
  try {
    const taxels::ModelReadings read =
        taxels::read_taxels(*answer.model, answer.problem, prediction, request.columns,
                            request.rows, request.pitch_m, depth_m);
    TaxelAnswer result = taxel_answer(read.readings, read.forces);
    result.load_N = answer.problem.load.normal_force_N;
    result.model = std::string(answer.model->card().name);
    result.a_m = prediction.a_m;
    result.b_m = prediction.b_m;
    return result;
  } catch (const InputError& error) {
    refuse_taxels(error, request);
  }
}

nlohmann::json to_json(const TaxelAnswer& answer) {
  const taxels::TaxelReadings& readings = answer.readings;
  const taxels::TaxelGrid& grid = readings.grid;
  const double area_m2 = grid.pitch_m * grid.pitch_m;
  nlohmann::json x_m = nlohmann::json::array(), y_m = nlohmann::json::array();
  for (int column = 0; column < grid.columns; ++column) x_m.push_back(grid.x_m(column));
  for (int row = 0; row < grid.rows; ++row) y_m.push_back(grid.y_m(row));
  nlohmann::json result = {
      {"columns", grid.columns},
      {"rows", grid.rows},
      {"pitch_m", grid.pitch_m},
      {"depth_m", readings.depth_m},
      {"x_m", x_m},
      {"y_m", y_m},
      {"force_N", table_json(readings.force_N)},
      {"pressure_Pa", table_json(readings.pressure_Pa())},
      {"shear_x_Pa", table_json(readings.shear_x_N / area_m2)},
      {"shear_y_Pa", table_json(readings.shear_y_N / area_m2)},
      {"displacement_m", table_json(readings.displacement_m)},
      {"sum_N", readings.force_N.sum()},
      {"outside_N", readings.outside_N()},
      {"normalisation", answer.normalisation},
      {"own", {{"a_m", answer.a_m}, {"b_m", answer.b_m}, {"torque_arm_m", answer.own_arm_m}}},
      {"shown", nullptr}};
  if (answer.errors)
    result["shown"] = {
        {"a_m", answer.a_m * (1 + answer.errors->a)},
        {"b_m", answer.b_m * (1 + answer.errors->b)},
        {"torque_arm_m", answer.own_arm_m * (1 + answer.errors->arm)},
        {"relative_error",
         {{"a", answer.errors->a}, {"b", answer.errors->b}, {"torque", answer.errors->arm}}}};
  return result;
}

std::string in_words(const TaxelAnswer& answer) {
  const taxels::TaxelReadings& readings = answer.readings;
  const taxels::TaxelGrid& grid = readings.grid;
  const double area_m2 = grid.pitch_m * grid.pitch_m;
  const std::string where = readings.depth_m > 0
                                ? fmt::format("{:.4g} mm below the surface", 1e3 * readings.depth_m)
                                : std::string("on the surface");
  std::string text = fmt::format(
      "  taxels, {} x {} of {:.3g} mm, {}: {:.4g} N of {:.4g} N by {}, at most {:.3g} kPa",
      grid.columns, grid.rows, 1e3 * grid.pitch_m, where, readings.force_N.sum(), answer.load_N,
      answer.model, 1e-3 * readings.pressure_Pa().maxCoeff());
  const double shear_N =
      (readings.shear_x_N.square() + readings.shear_y_N.square()).sqrt().maxCoeff();
  if (shear_N > 0) text += fmt::format(", shear at most {:.3g} kPa", 1e-3 * shear_N / area_m2);
  text += "\n";
  // Less than this is rounding.
  constexpr double kBeside = 1e-9;
  if (const double outside = readings.outside_N() / readings.load_N; outside > kBeside)
    text += fmt::format("    {} of the load is outside of the array\n", text::percent(outside));
  else if (outside < -kBeside)
    text += fmt::format("    {} more than the load: around the array the layer pulls at its core\n",
                        text::percent(-outside));
  if (answer.errors)
    text += fmt::format(
        "    taken as point forces they show a {}, b {}, torque {} against the contact's own\n",
        signed_percent(answer.errors->a), signed_percent(answer.errors->b),
        signed_percent(answer.errors->arm));
  else
    text += "    they feel no contact\n";
  return text;
}

std::string taxel_csv_header() {
  return "load_N,model,column,row,x_m,y_m,depth_m,force_N,pressure_Pa,shear_x_Pa,shear_y_Pa,"
         "displacement_m\n";
}

std::string taxel_csv_rows(const TaxelAnswer& answer) {
  const taxels::TaxelReadings& readings = answer.readings;
  const taxels::TaxelGrid& grid = readings.grid;
  const double area_m2 = grid.pitch_m * grid.pitch_m;
  std::string rows;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      rows += fmt::format(
          "{},{},{},{},{},{},{},{},{},{},{},{}\n", answer.load_N, text::csv_cell(answer.model),
          column, row, grid.x_m(column), grid.y_m(row), readings.depth_m,
          readings.force_N(row, column), readings.force_N(row, column) / area_m2,
          readings.shear_x_N(row, column) / area_m2, readings.shear_y_N(row, column) / area_m2,
          readings.displacement_m(row, column));
  return rows;
}

}  // namespace softfinger::prediction
