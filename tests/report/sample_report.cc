#include "sample_report.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "comparisons/calibration/calibration_report.h"
#include "softfinger/input/constants.h"

namespace softfinger::tests {
namespace {

using Json = nlohmann::json;

struct Layer {
  double thickness_m, youngs_modulus_Pa, poisson_ratio;
};

/// An answer p0 (1 - r²)^n over an ellipse.
struct Answer {
  double a_m, b_m, indentation_m, exponent;
};

double peak_pressure(const Answer& answer, double load_N) {
  return (answer.exponent + 1) * load_N / (kPi * answer.a_m * answer.b_m);
}

/// Circle's factor times sqrt(ab), raised towards the exact ellipse's value.
double torque(const Answer& answer, double load_N, double friction, bool exact) {
  const double n = answer.exponent;
  const double circle =
      2 * (n + 1) / 2 * std::tgamma(1.5) * std::tgamma(n + 1) / std::tgamma(n + 2.5);
  const double aspect = answer.a_m / answer.b_m;
  const double rise = exact ? 1 + 0.075 * std::pow(std::log(aspect), 2) : 1;
  return friction * load_N * std::sqrt(answer.a_m * answer.b_m) * circle * rise;
}

Json profile(double semi_axis_m, double peak_Pa, double exponent, int points, double reach) {
  Json positions = Json::array(), pressures = Json::array();
  for (int i = 0; i < points; ++i) {
    const double r = reach * i / (points - 1);
    positions.push_back(r * semi_axis_m);
    pressures.push_back(r < 1 ? peak_Pa * std::pow(1 - r * r, exponent) : 0.0);
  }
  return {{"position_m", positions}, {"pressure_Pa", pressures}};
}

Json common(const Answer& answer, double load_N, double friction) {
  const double max_torque = torque(answer, load_N, friction, true);
  return {{"a_m", answer.a_m},
          {"b_m", answer.b_m},
          {"axis_rad", 0.35},
          {"indentation_m", answer.indentation_m},
          {"peak_pressure_Pa", peak_pressure(answer, load_N)},
          {"area_projected_m2", kPi * answer.a_m * answer.b_m},
          {"max_torque_Nm", max_torque},
          {"eccentricity_m", max_torque / (friction * load_N)}};
}

Json fem_entry(const Answer& truth, double load_N, double friction, double stated) {
  Json fem = common(truth, load_N, friction);
  fem["model"] = "fem";
  fem["error"] = {{"a", 2.1 * stated},
                  {"b", 2.4 * stated},
                  {"area", 4.1 * stated},
                  {"indentation", 0.6 * stated},
                  {"peak_pressure", 1.7 * stated},
                  {"max_torque", stated}};
  fem["level"] = 2;
  fem["unknowns"] = 48213;
  fem["active_nodes"] = 412;
  fem["iterations"] = 9;
  fem["wall_s"] = 6.2 + load_N;
  fem["peak_memory_MB"] = 713.0;
  fem["pressure_exponent"] = truth.exponent;
  fem["trusted"] = stated < 0.02;
  fem["levels"] = Json::array();
  for (int level = 0; level < 3; ++level) {
    const double bias = 1 + stated * std::pow(4.0, 2 - level) * 0.3;
    fem["levels"].push_back({{"level", level},
                             {"unknowns", 1713 << (2 * level)},
                             {"a_m", truth.a_m * bias},
                             {"b_m", truth.b_m * bias},
                             {"indentation_m", truth.indentation_m / bias},
                             {"max_torque_Nm", fem["max_torque_Nm"].get<double>() * bias}});
  }
  const double peak = peak_pressure(truth, load_N);
  fem["profile_x"] = profile(truth.a_m, peak, truth.exponent, 26, 1.2);
  fem["profile_y"] = profile(truth.b_m, peak, truth.exponent, 22, 1.2);
  fem["vtu"] = "fem/sample/solution.vtu";
  return fem;
}

Json model_entry(const std::string& name, const Answer& answer, double load_N, double friction,
                 const Json& fem, double s, double limit, bool holds_below) {
  Json model = common(answer, load_N, friction);
  const bool holds = holds_below ? s <= limit : s >= limit;
  model["model"] = name;
  model["torque_rule"] = "exact";
  model["has_answer"] = true;
  model["valid"] = holds;
  model["validity"] =
      Json::array({{{"check", "relative_size"},
                    {"value", s},
                    {"limit", limit},
                    {"holds", holds},
                    {"message", holds_below ? "the contact is too large for a half-space"
                                            : "the contact is too small for a thin layer"}}});
  model["max_torque_paper_Nm"] = torque(answer, load_N, friction, false);
  model["cost_ns"] = 60.0 + 25 * static_cast<double>(name.size());
  model["profile_x"] = profile(answer.a_m, peak_pressure(answer, load_N), answer.exponent, 101, 1);
  model["profile_y"] = profile(answer.b_m, peak_pressure(answer, load_N), answer.exponent, 101, 1);
  model["relative_error"] = nullptr;
  if (!fem.is_null()) {
    Json errors;
    for (const auto& [key, member] :
         std::vector<std::pair<std::string, std::string>>{{"a", "a_m"},
                                                          {"b", "b_m"},
                                                          {"area", "area_projected_m2"},
                                                          {"indentation", "indentation_m"},
                                                          {"peak_pressure", "peak_pressure_Pa"},
                                                          {"max_torque", "max_torque_Nm"}})
      errors[key] = model[member].get<double>() / fem[member].get<double>() - 1;
    errors["max_torque_paper"] =
        model["max_torque_paper_Nm"].get<double>() / fem["max_torque_Nm"].get<double>() - 1;
    model["relative_error"] = errors;
  }
  return model;
}

/// One load. The invented finite-element answer lies between those of Hertz and Winkler, as it does
/// for a bonded layer.
Json load_entry(const Layer& layer, double major_m, double minor_m, double load_N, double friction,
                double stated, int extra_models) {
  const double mean_radius = std::sqrt(major_m * minor_m), aspect = major_m / minor_m;
  const double plane_strain = layer.youngs_modulus_Pa / (1 - std::pow(layer.poisson_ratio, 2));
  const double confined = layer.youngs_modulus_Pa * (1 - layer.poisson_ratio) /
                          ((1 + layer.poisson_ratio) * (1 - 2 * layer.poisson_ratio));
  const auto ellipse = [&](double size, double depth, double ratio, double exponent) {
    return Answer{size * std::sqrt(ratio), size / std::sqrt(ratio), depth, exponent};
  };
  const double hertz_size = std::cbrt(0.75 * load_N * mean_radius / plane_strain);
  const Answer hertz =
      ellipse(hertz_size, hertz_size * hertz_size / mean_radius, std::pow(aspect, 0.64), 0.5);
  const double depth = std::sqrt(load_N * layer.thickness_m / (kPi * mean_radius * confined));
  const Answer winkler = ellipse(std::sqrt(2 * depth * mean_radius), depth, std::sqrt(aspect), 1);
  const double x = hertz_size / layer.thickness_m;
  const double weight = 1 / (1 + x * x * x);
  const Answer truth = ellipse(std::pow(hertz_size, weight) *
                                   std::pow(std::sqrt(winkler.a_m * winkler.b_m), 1 - weight) *
                                   (1 - 0.3 * weight * (1 - weight)),
                               weight * hertz.indentation_m + (1 - weight) * depth,
                               std::pow(aspect, 0.5 + 0.14 * weight), 0.5 + 0.5 * (1 - weight));
  const double s = std::sqrt(truth.a_m * truth.b_m) / layer.thickness_m;

  Json load;
  load["load_N"] = load_N;
  load["geometry"] = {{"radii_m", {major_m, minor_m}},
                      {"radii_std_m", nullptr},
                      {"axis_rad", 0.35},
                      {"s", s},
                      {"patch", nullptr}};
  load["fem"] = fem_entry(truth, load_N, friction, stated);
  load["models"] =
      Json::array({model_entry("hertz", hertz, load_N, friction, load["fem"], s, 0.7, true),
                   model_entry("winkler", winkler, load_N, friction, load["fem"], s, 4, false)});
  for (int i = 0; i < extra_models; ++i) {
    const double off = 1 + 0.013 * (i + 1);
    Answer near_truth = truth;
    near_truth.a_m *= off;
    near_truth.b_m /= off * off;
    load["models"].push_back(model_entry("layer_variant_" + std::to_string(i + 1), near_truth,
                                         load_N, friction, load["fem"], s, 20, true));
  }
  return load;
}

Json case_entry(const std::string& id, const std::string& question,
                const std::string& verdict_class, const std::string& verdict, const Layer& layer,
                double friction, Json loads) {
  return {{"id", id},
          {"question", question},
          {"verdict", verdict},
          {"verdict_class", verdict_class},
          {"file", id + ".toml"},
          {"case_toml", "id = \"" + id + "\"\n[layer]\nthickness_mm = " +
                            std::to_string(1e3 * layer.thickness_m) + "\n"},
          {"layer",
           {{"thickness_m", layer.thickness_m},
            {"youngs_modulus_Pa", layer.youngs_modulus_Pa},
            {"poisson_ratio", layer.poisson_ratio}}},
          {"friction_coefficient", friction},
          {"loads", std::move(loads)}};
}

Json card(const std::string& name, const std::string& title) {
  return {{"name", name},
          {"title", title},
          {"assumptions", "Small strain, no friction while the contact forms, a rigid object."},
          {"equations", "p = p0 (1 - x²/a² - y²/b²)^n"},
          {"source", "K. L. Johnson, Contact Mechanics, ch. 4"},
          {"validity", "The contact is small against the layer: sqrt(ab)/h < 0.7."},
          {"cost", "about 200 ns"}};
}

Json fit(double first_m, Json second_m, double residual_m) {
  return {{"A_per_m", 0.5 / first_m},
          {"B_per_m", second_m.is_null() ? 0.0 : 0.5 / second_m.get<double>()},
          {"C_per_m", 1.27},
          {"radii_m", {first_m, second_m}},
          {"axis_rad", 0.35},
          {"normal", {0.03, -0.01, 0.9995}},
          {"residual_rms_m", residual_m},
          {"points", 187},
          {"area_m2", 81.4e-6},
          {"radii_std_m", {0.03 * first_m, second_m.is_null() ? Json() : Json(0.4e-3)}}};
}

Json empty_report() {
  Json report;
  report["provenance"] = {{"version", "0.1.0 (sample)"},
                          {"date", "2026-01-31T12:00:00Z"},
                          {"compiler", "GNU 12.2.0"},
                          {"build_type", "Release"},
                          {"machine", "sample machine, 2 cores"},
                          {"cores", 2},
                          {"command", "softfinger compare --output sample"},
                          {"wall_s", 187.4},
                          {"peak_memory_MB", 1840.0}};
  report["tolerance"] = 0.10;
  report["models"] = Json::array({card("hertz", "Elastic half-space under an ellipse"),
                                  card("winkler", "Bed of springs with the confined modulus")});
  report["cases"] = Json::array();
  return report;
}

/// An error atlas of 3 x 2 x 3 contacts; errors grow with s, and winkler has no answer at nu = 1/2.
Json sample_atlas() {
  const std::vector<double> poisson_ratio{0, 0.3, 0.5}, radii_ratio{1, 4}, s{0.1, 1, 5};
  const auto quantiles = [](double median) {
    return Json{{"count", 18}, {"median", median}, {"p95", 2.5 * median}, {"worst", 4 * median}};
  };
  const auto by_quantity = [](const auto& value) {
    Json object;
    for (const char* key : {"a", "b", "indentation", "area", "peak_pressure", "max_torque"})
      object[key] = value();
    return object;
  };
  Json models = Json::array();
  double scale = 0.02, cost_ns = 80;
  for (const std::string name : {"hertz", "winkler", "fem_coarse", "fem"}) {
    const bool finite_elements = name.rfind("fem", 0) == 0;
    const auto errors = [&] {
      Json nodes = Json::array();
      for (const double nu : poisson_ratio)
        for (const double ratio : radii_ratio)
          for (const double size : s)
            nodes.push_back(
                name == "winkler" && nu == 0.5 ? Json() : Json(scale * size * ratio * (nu - 0.2)));
      return nodes;
    };
    models.push_back(
        {{"model", name},
         {"cost_ns", cost_ns},
         {"quantiles", by_quantity([&] { return quantiles(scale); })},
         {"claimed",
          finite_elements ? Json() : by_quantity([&] { return quantiles(0.3 * scale); })},
         {"paper_torque", finite_elements ? Json() : quantiles(1.7 * scale)},
         {"causes", finite_elements ? Json()
                                    : Json{{"ellipse", quantiles(0.031)},
                                           {"pressure", quantiles(0.0123)},
                                           {"circle_rule", quantiles(0.0829)},
                                           {"max_torque", quantiles(0.0457)}}},
         {"grid", by_quantity(errors)},
         {"holds",
          finite_elements ? Json() : Json{1, 0, 0, 1, 0, 0, 1, 1, 0, 1, 1, 0, 1, 1, 1, 0, 0, 0}}});
    scale *= finite_elements ? 0.3 : 5;
    cost_ns *= finite_elements ? 30 : 3e3;
  }
  const auto law = [&](const char* name, double law_cost_ns, double error) {
    return Json{{"name", name}, {"cost_ns", law_cost_ns}, {"error", quantiles(error)}};
  };
  const auto mark = [](const char* id, double nu, double ratio, double size, bool seed) {
    return Json{{"id", id},  {"load_N", 2}, {"poisson_ratio", nu}, {"radii_ratio", ratio},
                {"s", size}, {"seed", seed}};
  };
  return {{"provenance", {{"version", "0.1.0"}, {"date", "2026-01-31"}, {"command", "atlas"}}},
          {"runs", {{"flat", 18}}},
          {"grid", {{"poisson_ratio", poisson_ratio}, {"radii_ratio", radii_ratio}, {"s", s}}},
          {"models", models},
          {"friction_laws",
           {law("ellipsoid", 20, 0.06), law("32 facet vertices", 40, 0.078),
            law("exact limit surface", 3e4, 0)}},
          {"marks",
           {mark("seed_thumb", 0, 1, 0.8, true), mark("pad <b>", 0.45, 4, 0.4, false),
            mark("outside", 0.2, 1, 60, false)}}};
}

/// The pressure of a pad, p0 (1 - share u^6)(1 - share v^6) of both coordinates over the half
/// sides.
struct PadPressure {
  double half_x_m, half_y_m, peak_Pa, share;

  double at(double x_m, double y_m) const {
    const auto factor = [&](double part) { return 1 - share * std::pow(part, 6); };
    return peak_Pa * factor(x_m / half_x_m) * factor(y_m / half_y_m);
  }
  Json profile(bool along_x, int points) const {
    Json positions = Json::array(), pressures = Json::array();
    for (int i = 0; i < points; ++i) {
      const double part = -1 + 2.0 * i / (points - 1);
      positions.push_back(part * (along_x ? half_x_m : half_y_m));
      pressures.push_back(along_x ? at(part * half_x_m, 0) : at(0, part * half_y_m));
    }
    return {{"position_m", positions}, {"pressure_Pa", pressures}};
  }
  Json samples(int points) const {
    Json x = Json::array(), y = Json::array(), p = Json::array();
    for (int i = 0; i < points; ++i)
      for (int j = 0; j < points; ++j) {
        x.push_back(half_x_m * (-1 + 2.0 * i / (points - 1)));
        y.push_back(half_y_m * (-1 + 2.0 * j / (points - 1)));
        p.push_back(at(x.back(), y.back()));
      }
    return {{"x_m", x}, {"y_m", y}, {"pressure_Pa", p}};
  }
};

Json rectangle(double half_x_m, double half_y_m) {
  return Json::array(
      {{half_x_m, half_y_m}, {-half_x_m, half_y_m}, {-half_x_m, -half_y_m}, {half_x_m, -half_y_m}});
}

Json pad_answer(const PadPressure& pressure, double torque_Nm, double stiffness_N_per_m) {
  return {{"contact", "patch"},
          {"a_m", nullptr},
          {"b_m", nullptr},
          {"max_torque_Nm", torque_Nm},
          {"eccentricity_m", torque_Nm / 18},
          {"pressure_arm_m", torque_Nm / 17.9},
          {"indentation_m", 20 / stiffness_N_per_m},
          {"normal_stiffness_N_per_m", stiffness_N_per_m},
          {"tilt_stiffness_Nm_per_rad", {116.4, 30.34}},
          {"peak_pressure_Pa", pressure.peak_Pa},
          {"profile_x", pressure.profile(true, 41)},
          {"profile_y", pressure.profile(false, 41)}};
}

Json pad_model(const char* name, const PadPressure& pressure, double torque_error, bool sound) {
  Json model = pad_answer(pressure, 0.1791 * (1 + torque_error), 1.49e6 * (1 + torque_error));
  model["model"] = name;
  model["has_answer"] = true;
  model["sound"] = sound;
  model["usable"] = sound && std::abs(torque_error) < 0.1;
  model["cost_ns"] = 1200;
  model["validity"] = Json::array();
  if (!sound)
    model["validity"].push_back({{"check", "covered"},
                                 {"value", 0.5},
                                 {"limit", 0.98},
                                 {"holds", false},
                                 {"message", "the object's face ends within the pad"}});
  model["error_bound"] = sound ? Json{{"max_torque", 0.025}, {"indentation", 0.03}} : Json();
  model["relative_error"] = {
      {"max_torque", torque_error},         {"normal_stiffness", torque_error},
      {"indentation", -torque_error},       {"pressure_arm", torque_error / 2},
      {"tilt_stiffness", torque_error / 3}, {"peak_pressure", -torque_error}};
  return model;
}

Json pad_load(double load_N, double half_x_m, double half_y_m, bool sound) {
  const PadPressure pressed{half_x_m, half_y_m, 2e3 * load_N, 0.8};
  Json fem = pad_answer(pressed, 0.1791, 1.49e6);
  fem.update(
      {{"model", "fem"},
       {"trusted", true},
       {"error", {{"max_torque", 6e-4}, {"indentation", 7e-4}, {"pressure_arm", 6e-4}}},
       {"pressure", pressed.samples(17)},
       {"levels", Json::array({{{"level", 2}, {"unknowns", 9996}, {"max_torque_Nm", 0.179}}})},
       {"unknowns", 9996},
       {"wall_s", 2.2},
       {"peak_memory_MB", 266.0},
       {"lifted_share", 0.0}});
  const PadPressure flat{half_x_m, half_y_m, 1.2e3 * load_N, 0};
  return {{"load_N", load_N},
          {"fem", fem},
          {"models", Json::array({pad_model("pad_layer", pressed, -0.0074, sound),
                                  pad_model("pad_uniform", flat, 0.167, sound)})}};
}

Json pad_case(const char* id, const char* verdict_class, bool is_covered) {
  return {{"id", id},
          {"contact", "patch"},
          {"question", "Which torque does a pad of <22 x 37.5> mm hold?"},
          {"description", "flat pad, contact 22 x 37.5 mm"},
          {"verdict", "Use the default, Pad layer."},
          {"verdict_class", verdict_class},
          {"reference", "the whole pad in linear theory"},
          {"file", std::string(id) + ".toml"},
          {"case_toml", "id = \"pad\""},
          {"outline_m", is_covered ? rectangle(0.011, 0.01875) : rectangle(0.008, 0.012)},
          {"pad_outline_m", rectangle(0.011, 0.01875)},
          {"layer", {{"thickness_m", 3e-3}, {"youngs_modulus_Pa", 8e5}, {"poisson_ratio", 0.49}}},
          {"friction_coefficient", 0.9},
          {"loads", Json::array()}};
}

}  // namespace

Json sample_pads() {
  Json good = pad_case("wide_pad", "good", true), open = pad_case("pad_on_rib", "bad", false);
  for (const double load_N : {20.0, 60.0}) {
    good["loads"].push_back(pad_load(load_N, 0.011, 0.01875, true));
    open["loads"].push_back(pad_load(load_N, 0.008, 0.012, false));
  }
  Json& failed = open["loads"][1];
  failed["fem"] = nullptr;
  failed["fem_failure"] = "softfinger-fem was killed by signal 9 (Killed)";
  for (Json& model : failed["models"]) {
    model["relative_error"] = nullptr;
    model["usable"] = false;
  }
  return {{"tolerance", 0.1},
          {"models", Json::array({{{"name", "pad_layer"}, {"title", "flat pad"}},
                                  {{"name", "pad_uniform"}, {"title", "uniform pressure"}}})},
          {"cases", Json::array({good, open})},
          {"provenance", {{"version", "1.0"}, {"command", "softfinger compare"}}}};
}

Json sample_report() {
  Json report = empty_report();
  report["atlas"] = sample_atlas();
  Json& cases = report["cases"];

  const Layer thick{0.02, 300e3, 0.3};
  cases.push_back(case_entry(
      "hertz_circular", "Is Hertz right when the layer is thick?", "good",
      "Hertz is within 3 % of the FEM in the ellipse and the torque; Winkler is not usable.", thick,
      0.8, Json::array({load_entry(thick, 0.01, 0.01, 1, 0.8, 0.0016, 0)})));

  const Layer pad{0.002, 300e3, 0.45};
  Json loads = Json::array();
  for (const double load_N : {0.5, 2.0, 10.0})
    loads.push_back(load_entry(pad, 0.02, 0.005, load_N, 0.8, 0.0021 + 0.0002 * load_N, 0));
  // A model that answers nothing, and one whose curves were not recorded.
  Json& silent = loads[1]["models"][1];
  silent["has_answer"] = false;
  silent["valid"] = false;
  silent["relative_error"] = nullptr;
  silent["validity"] = Json::array({{{"check", "compressibility"},
                                     {"value", nullptr},
                                     {"limit", 0.5},
                                     {"holds", false},
                                     {"message", "an incompressible bed of springs is rigid"}}});
  for (const char* key : {"a_m", "b_m", "indentation_m", "peak_pressure_Pa", "area_projected_m2",
                          "max_torque_Nm", "max_torque_paper_Nm", "eccentricity_m"})
    silent[key] = nullptr;
  loads[2]["models"][0].erase("profile_x");
  loads[2]["models"][0]["profile_y"] = nullptr;
  cases.push_back(case_entry(
      "silicone_pad_2mm", "Can Hertz or Winkler be used for a 2 mm silicone pad?", "mixed",
      "Hertz up to 0.5 N; above, neither: the torque is off by up to 31 %.", pad, 0.8, loads));

  const Layer thin{0.001, 500e3, 0.3};
  cases.push_back(case_entry(
      "elongated_6", "Does the paper's torque rule hold for a contact six times longer than wide?",
      "bad", "No: the paper's rule is 22 % too low; the exact rule is right.", thin, 0.5,
      Json::array({load_entry(thin, 0.144, 0.004, 5, 0.5, 0.0041, 0),
                   load_entry(thin, 0.144, 0.004, 20, 0.5, 0.0315, 0)})));

  const Layer tip{0.003, 1.5e6, 0.49};
  Json mesh = load_entry(tip, 0.0126, 0.0091, 5, 1.0, 0.0033, 0);
  mesh["geometry"]["radii_std_m"] = {0.4e-3, 0.3e-3};
  mesh["geometry"]["patch"] = {{"region_area_m2", 81.4e-6},
                               {"predicted_area_m2", 40.9e-6},
                               {"agrees", true},
                               {"remark", "12 duplicate triangles were ignored."},
                               {"patch_model", "winkler"},
                               {"finger", fit(0.0131, 0.0094, 21e-6)},
                               {"object", fit(0.33, nullptr, 1.5e-6)}};
  cases.push_back(case_entry(
      "fingertip_on_glass", "What does a meshed fingertip <finger & glass> give at 5 N?", "mixed",
      "Hertz is within 18 % although it is outside its validity.", tip, 1.0, Json::array({mesh})));

  const Layer soft{0.003, 1.5e6, 0.4999};
  Json failed = load_entry(soft, 0.01, 0.01, 5, 0.8, 0.003, 0);
  failed["fem"] = nullptr;
  failed["fem_failure"] =
      "the active set did not settle in 60 iterations </script><script>alert(1)";
  failed["geometry"]["radii_m"] = {nullptr, 0.01};
  failed["geometry"]["s"] = nullptr;
  for (Json& model : failed["models"]) model["relative_error"] = nullptr;
  cases.push_back(case_entry("nearly_incompressible", "Does anything hold at ν = 0.4999?", "failed",
                             "No reference: the finite elements did not converge.", soft, 0.8,
                             Json::array({failed})));
  return report;
}

Json large_report(int cases) {
  Json report = empty_report();
  report["atlas"] = sample_atlas();
  for (int i = 1; i <= 6; ++i)
    report["models"].push_back(card("layer_variant_" + std::to_string(i), "A variant"));
  for (int i = 0; i < cases; ++i) {
    const Layer layer{0.001 * (1 + i % 4), 300e3,
                      std::vector<double>{0.1, 0.3, 0.45, 0.49}[i / 5 % 4]};
    Json loads = Json::array();
    for (const double load_N : {0.5, 2.0, 8.0})
      loads.push_back(load_entry(layer, 0.02 + 0.004 * i, 0.008, load_N, 0.8, 0.002, 6));
    report["cases"].push_back(
        case_entry("case_" + std::to_string(i), "Question number " + std::to_string(i) + "?",
                   i % 3 ? "good" : "mixed",
                   "A verdict in one sentence of common length, with 7 %.", layer, 0.8, loads));
  }
  return report;
}

Json sample_selection() {
  const auto candidate = [](const char* model, double cost_us, double error, bool accurate) {
    return Json{{"model", model},
                {"cost_us", cost_us},
                {"error_bound",
                 {{"a", error / 2},
                  {"b", error / 3},
                  {"indentation", error / 4},
                  {"area", error},
                  {"peak_pressure", error / 5},
                  {"max_torque", error / 6}}},
                {"worst", error},
                {"worst_quantity", "area"},
                {"usable", accurate},
                {"affordable", true},
                {"remark", nullptr}};
  };
  Json choices = Json::array();
  for (const double load_N : {0.5, 2., 10.}) {
    const double hertz = 0.031 * load_N, winkler = 0.5 / load_N;
    const bool hertz_will_do = hertz <= 0.05, winkler_will_do = winkler <= 0.05 && load_N < 5;
    Json silent = candidate("power_law", 0.03, 0, false);
    silent["error_bound"] = nullptr;
    silent["remark"] = "no law <given>";
    choices.push_back(
        {{"load_N", load_N},
         {"s", 0.3 * load_N},
         {"model", hertz_will_do     ? Json("hertz")
                   : winkler_will_do ? Json("winkler")
                                     : Json()},
         {"next_better", hertz_will_do ? Json("fem") : Json()},
         {"next_cheaper", nullptr},
         {"reason", hertz_will_do ? "the cheapest that meets 5 %" : "none is within 5 %"},
         {"candidates",
          {silent, candidate("hertz", 0.08, hertz, hertz_will_do),
           candidate("winkler", 0.1, winkler, winkler_will_do),
           candidate("fem", 4e6, 0.001, false)}},
         {"causes",
          {{"nearest_run", {{"poisson_ratio", 0.45}, {"radii_ratio", 4}, {"s", 0.75}}},
           {"ellipsoid", 0.0781},
           {"models",
            {{{"model", "hertz"},
              {"geometry_fit", 0.0211},
              {"ellipse", 0.1893},
              {"pressure", -0.0258},
              {"circle_rule", -0.0829},
              {"max_torque", 0.1586}}}}}}});
  }
  return {{"case", "my_finger"},
          {"question", "What is enough for <my> finger?"},
          {"description", "my_finger: layer 2 mm"},
          {"limits", ""},
          {"file", "my_finger.toml"},
          {"case_toml", "id = \"my_finger\"\n"},
          {"tolerance", 0.05},
          {"choices", choices},
          {"models", empty_report()["models"]},
          {"curves",
           {{"load_N", {0.1, 1, 10, 50}},
            {"models",
             {{{"model", "hertz"}, {"worst", {0.003, 0.031, 0.31, nullptr}}},
              {{"model", "fem"}, {"worst", {0.001, 0.001, 0.001, 0.001}}}}}}},
          {"atlas", sample_atlas()},
          {"provenance",
           {{"version", "0.1.0"}, {"date", "2026-01-31"}, {"command", "softfinger select <x>"}}}};
}

Json sample_calibration() {
  const input::MeasurementTable table =
      input::read_measurements(SOFTFINGER_MEASUREMENTS "/inked_fingertip.csv");
  const input::Case contact = input::parse_case(
      "id = \"silicone_fingertip\"\n[geometry]\nrelative_radii_mm = [20.0, 12.0]\n[layer]\n"
      "thickness_mm = 2.0\nyoungs_modulus_kPa = 500.0\npoisson_ratio = 0.49\n[contact]\n"
      "load_N = 1.0\nfriction_coefficient = 0.8\n",
      "silicone_fingertip.toml");
  calibration::Request request;
  request.model = find_pressure_model("fingertip_layer");
  Json data =
      calibration::page_data(calibration::calibrate_case(contact, table, request), "load_N,a_mm\n");
  data["provenance"] = {{"version", "0.1.0"}, {"command", "softfinger calibrate"}};
  return data;
}

Json one_case_report() {
  Json report = sample_report();
  report["cases"].erase(report["cases"].begin() + 1, report["cases"].end());
  // Radii that are given leave nothing open, and Hertz may be used.
  for (Json& load : report["cases"][0]["loads"]) {
    load["geometry"]["error"] = {
        {"a", 0}, {"b", 0}, {"area", 0}, {"indentation", 0}, {"max_torque", 0}};
    load["models"][0]["sound"] = load["models"][0]["hot_path"] = true;
  }
  report["atlas"]["models"].erase(report["atlas"]["models"].begin());
  return report;
}

}  // namespace softfinger::tests
