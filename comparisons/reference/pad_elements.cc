#include "comparisons/reference/pad_elements.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::reference {
namespace {

using nlohmann::json;

json pair_json(const Eigen::Vector2d& pair) { return {pair.x(), pair.y()}; }

/// @param inset_m  by which the outline lies further inside
json shape_json(const input::FlatFigure& figure, double inset_m) {
  return std::visit(
      [&](const auto& shape) -> json {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, input::DiscFigure>) {
          return {{"shape", "disc"}, {"radius_m", shape.diameter_m / 2 - inset_m}};
        } else if constexpr (std::is_same_v<Shape, input::RectangleFigure>) {
          return {{"shape", "rectangle"},
                  {"lengths_m", {shape.length_m - 2 * inset_m, shape.width_m - 2 * inset_m}},
                  {"corner_radius_m", std::max(0.0, shape.corner_radius_m - inset_m)}};
        } else {
          const ConvexOutline typed = ConvexOutline::polygon(shape.points_m);
          const auto inner = inset_m > 0 ? typed.shrunk(inset_m) : typed;
          json points = json::array();
          if (inner)
            for (const Eigen::Vector2d& point : inner->vertices_m())
              points.push_back(pair_json(point));
          return {{"shape", "polygon"}, {"points_m", points}};
        }
      },
      figure);
}

/// Numbers of an object that have to be there and finite.
class Numbers {
 public:
  explicit Numbers(const json& object) : object_(object) {}

  double operator()(const char* key) { return checked(object_.value(key, json()), key); }
  std::array<double, 2> pair(const char* key) {
    const json both = object_.value(key, json());
    if (!both.is_array() || both.size() != 2) return {checked({}, key), 0};
    return {checked(both[0], key), checked(both[1], key)};
  }
  std::array<std::optional<double>, 2> pair_or_none(const char* key) {
    std::array<std::optional<double>, 2> result;
    const json both = object_.value(key, json());
    if (both.is_array() && both.size() == 2)
      for (std::size_t i = 0; i < 2; ++i)
        if (!both[i].is_null()) result[i] = checked(both[i], key);
    return result;
  }
  const std::string& flaw() const { return flaw_; }

 private:
  double checked(const json& value, const char* key) {
    if (value.is_number() && std::isfinite(value.get<double>())) return value.get<double>();
    if (flaw_.empty()) flaw_ = std::string(key) + " is not a finite number";
    return 0;
  }

  const json& object_;
  std::string flaw_;
};

/// @param flaw  receives why the result is not to be believed; empty: it is
PadElements read_result(const json& written, std::string& flaw) {
  PadElements pad;
  if (!written.is_object()) {
    flaw = "it is no object";
    return pad;
  }
  Numbers number(written);
  const bool is_stuck = written.value("pressing", "") == "stuck";
  pad.load_N = number("load_N");
  pad.indentation_m = number("indentation_m");
  pad.normal_stiffness_N_per_m = number("normal_stiffness_N_per_m");
  pad.area_m2 = number("area_m2");
  pad.peak_pressure_Pa = number("peak_pressure_inside_Pa");
  pad.pressure_arm_m = number("pressure_arm_m");
  pad.eccentricity_m = number("eccentricity_m");
  pad.max_torque_Nm = number("max_torque_Nm");
  pad.torsional_stiffness_Nm_per_rad = number("torsional_stiffness_Nm_per_rad");
  pad.lifted_share = number("lifted_share");
  pad.tilt_stiffness_Nm_per_rad = number.pair(is_stuck ? "tilt_stiffness_free_to_slide_Nm_per_rad"
                                                       : "tilt_stiffness_Nm_per_rad");
  pad.tilt_limit_Nm =
      number.pair_or_none(is_stuck ? "tilt_limit_free_to_slide_Nm" : "tilt_limit_Nm");
  pad.tangential_stiffness_N_per_m = number.pair("shear_stiffness_N_per_m");
  pad.unknowns = number("unknowns");
  pad.wall_s = number("wall_s");
  pad.peak_memory_MB = number("peak_memory_MB");
  pad.error = written.value("error", json::object());
  pad.limit_surface = written.value("limit_surface", json::array());
  flaw = number.flaw();
  return pad;
}

}  // namespace

json pad_problem(const input::Case& contact_case, double load_N, int level, int limit_surface) {
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  json face;
  // A face that covers the pad is a plane to it.
  if (pair.object.figure && pair.covered < 1)
    face = {{"outline", shape_json(*pair.object.figure, 0)},
            {"offset_m", pair_json(pair.offset_m)},
            {"angle_rad", pair.angle_rad}};
  return {{"name", contact_case.id},
          {"pad",
           {{"outline", shape_json(pair.finger.figure, pair.finger.edge_radius_m)},
            {"thickness_m", contact_case.layer.thickness_m},
            {"youngs_modulus_Pa", contact_case.layer.youngs_modulus_Pa},
            {"poisson_ratio", contact_case.layer.poisson_ratio}}},
          {"face", face},
          {"pressing", pair.pressing == PadPressing::stuck ? "stuck" : "frictionless"},
          {"load_N", load_N},
          {"load_point_m", pair.load_at_m ? pair_json(*pair.load_at_m) : json()},
          {"friction_coefficient", contact_case.shear_law.friction_coefficient},
          {"friction", limit_surface > 0 ? json{{"limit_surface", limit_surface}} : json()},
          {"level", level}};
}

PadRun solve_pads(const std::string& program, const std::vector<json>& problems,
                  const FemLimits& limits,
                  const std::function<void(std::size_t, const std::string&)>& on_line) {
  PadRun run;
  system::ProcessCallbacks callbacks;
  callbacks.on_line = [&](std::size_t, const std::string& line) {
    std::size_t problem = 0;
    const std::string text = text_of(line, problem);
    if (problem < problems.size()) on_line(problem, text);
  };
  callbacks.on_output = [&](std::size_t, const std::string& line) {
    if (!run.failure.failure.empty() || run.of_load.size() == problems.size()) return;
    const json written = text::parse_json(line);
    if (written.is_object() && written.contains("failure")) {
      run.failure = failure_of(written);
      return;
    }
    std::string flaw;
    PadElements pad = read_result(written, flaw);
    if (flaw.empty())
      run.of_load.push_back(std::move(pad));
    else
      run.failure = {std::nullopt, "softfinger-fem gave no result to believe: " + flaw, 3};
  };
  callbacks.on_finish = [&](std::size_t, const system::ProcessOutcome& outcome) {
    if (run.failure.failure.empty() && run.of_load.size() < problems.size())
      run.failure = failure_of(outcome, limits);
  };
  run.interrupted = system::run_processes({fem_job(program, json(problems), false, limits)}, 1,
                                          callbacks, system::OnInterrupt::stop);
  return run;
}

}  // namespace softfinger::reference
