#include "comparisons/judgement/atlas/atlas_overview.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <set>

#include "comparisons/judgement/atlas/error_causes.h"
#include "comparisons/judgement/median.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/system/program_paths.h"
#include "softfinger/friction/linearised_friction.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/friction/six_patch_surface.h"

namespace softfinger::judgement {
namespace {

using nlohmann::json;

constexpr auto kTorque = std::size_t(Quantity::max_torque);

/// A picture shows no more digits, and the page stays small.
json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.4g}", value).c_str(), nullptr);
}

/// Statistics of absolute values: {"count", "median", "p95", "worst"}, null for none.
json quantiles(std::vector<double> values) {
  values.erase(
      std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
      values.end());
  if (values.empty()) return nullptr;
  // The difference of equal numbers is zero up to round-off.
  for (double& value : values) value = std::abs(value) < 1e-9 ? 0 : std::abs(value);
  std::sort(values.begin(), values.end());
  // The smallest value that at least this part of all does not exceed.
  const auto at = [&](double part) {
    return values[std::size_t(std::ceil(part * double(values.size()))) - 1];
  };
  return {{"count", values.size()},
          {"median", rounded(at(0.5))},
          {"p95", rounded(at(0.95))},
          {"worst", rounded(values.back())}};
}

/// The runs that lie on the grid of the maps, nu first, then R'/R'', then s.
struct Grid {
  std::vector<double> poisson_ratio, radii_ratio, s;
  std::vector<int> run;  ///< -1: missing
};

Grid grid_of(const AtlasFile& atlas) {
  std::set<double> poisson_ratio, radii_ratio, s;
  for (const AtlasRun& run : atlas.runs) {
    if (run.kind != AtlasKind::flat) continue;
    poisson_ratio.insert(run.poisson_ratio);
    radii_ratio.insert(run.radii_ratio);
    s.insert(run.s);
  }
  Grid grid;
  grid.poisson_ratio.assign(poisson_ratio.begin(), poisson_ratio.end());
  grid.radii_ratio.assign(radii_ratio.begin(), radii_ratio.end());
  grid.s.assign(s.begin(), s.end());
  grid.run.assign(poisson_ratio.size() * radii_ratio.size() * s.size(), -1);
  const auto place = [](const std::vector<double>& values, double value) {
    return std::size_t(std::find(values.begin(), values.end(), value) - values.begin());
  };
  for (std::size_t r = 0; r < atlas.runs.size(); ++r) {
    const AtlasRun& run = atlas.runs[r];
    if (run.kind != AtlasKind::flat) continue;
    grid.run[(place(grid.poisson_ratio, run.poisson_ratio) * radii_ratio.size() +
              place(grid.radii_ratio, run.radii_ratio)) *
                 s.size() +
             place(grid.s, run.s)] = int(r);
  }
  return grid;
}

std::vector<double> column(const std::vector<QuantityErrors>& errors, std::size_t quantity) {
  std::vector<double> values;
  for (const QuantityErrors& of_run : errors) values.push_back(of_run[quantity]);
  return values;
}

json quantiles_by_quantity(const std::vector<QuantityErrors>& errors) {
  json object;
  for (std::size_t q = 0; q < kQuantities; ++q)
    object[kQuantityNames[q]] = quantiles(column(errors, q));
  return object;
}

json on_grid(const Grid& grid, const std::vector<QuantityErrors>& errors) {
  json object;
  for (std::size_t q = 0; q < kQuantities; ++q) {
    json& values = object[kQuantityNames[q]] = json::array();
    for (const int run : grid.run)
      values.push_back(run < 0 ? json() : rounded(errors[std::size_t(run)][q]));
  }
  return object;
}

/// The cost over a tenth of the runs: median of the medians of repeated calls.
double measured_cost_ns(const PressureModel& model, const std::vector<ContactProblem>& problems) {
  constexpr double kBudget_ns = 1e5;  // per problem
  std::vector<double> costs_ns;
  for (std::size_t i = 0; i < problems.size(); i += 10)
    costs_ns.push_back(prediction::ask_model(model, problems[i], kBudget_ns).cost_ns);
  return median(costs_ns);
}

json causes_of(const AtlasFile& atlas, const std::vector<QuantityErrors>& errors) {
  std::vector<double> ellipse, pressure, circle_rule, torque;
  for (std::size_t r = 0; r < atlas.runs.size(); ++r) {
    if (atlas.runs[r].kind != AtlasKind::flat || !std::isfinite(errors[r][kTorque])) continue;
    const TorqueCauses causes =
        torque_causes(contact_of(atlas.runs[r], errors[r]), contact_of(atlas.runs[r]));
    ellipse.push_back(causes.ellipse);
    pressure.push_back(causes.pressure);
    circle_rule.push_back(causes.circle_rule);
    torque.push_back(errors[r][kTorque]);
  }
  return {{"ellipse", quantiles(ellipse)},
          {"pressure", quantiles(pressure)},
          {"circle_rule", quantiles(circle_rule)},
          {"max_torque", quantiles(torque)}};
}

/// Errors of the model's torque with the rule of Ciocarlie et al. (2007).
std::vector<double> paper_torque_errors(const AtlasFile& atlas,
                                        const std::vector<QuantityErrors>& errors) {
  std::vector<double> paper;
  for (std::size_t r = 0; r < atlas.runs.size(); ++r) {
    if (!std::isfinite(errors[r][kTorque])) continue;
    const TorqueCauses causes =
        torque_causes(contact_of(atlas.runs[r], errors[r]), contact_of(atlas.runs[r]));
    paper.push_back((1 + errors[r][kTorque]) * (1 + causes.circle_rule) - 1);
  }
  return paper;
}

template <class Function>
double time_ns(const Function& function) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> samples_ns;
  for (int sample = 0; sample < 9; ++sample) {
    constexpr int kCalls = 200;
    const auto start = Clock::now();
    double sink = 0;
    for (int i = 0; i < kCalls; ++i) sink += function(0.3 + 1e-6 * i);
    const double elapsed_ns =
        std::chrono::duration<double, std::nano>(Clock::now() - start).count();
    if (std::isfinite(sink)) samples_ns.push_back(elapsed_ns / kCalls);
  }
  return median(samples_ns);
}

/// Friction laws that can replace the exact limit surface, for the shapes of the atlas's contacts:
/// largest radial error, and the time of one answer to "how far is this wrench from slip".
json friction_laws(const AtlasFile& atlas) {
  // Errors depend on the shape alone; they hardly change within steps of 10 % in a/b and of 0.25 in
  // n.
  std::set<std::pair<int, int>> shapes;
  for (const AtlasRun& run : atlas.runs) {
    const TorqueContact contact = contact_of(run);
    const double aspect = std::max(contact.a, contact.b) / std::min(contact.a, contact.b);
    if (!std::isfinite(contact.arm)) continue;
    const double exponent = std::clamp(exponent_of(contact), 0., 4.);
    shapes.insert({int(std::lround(10 * std::log(aspect))), int(std::lround(4 * exponent))});
  }
  std::vector<double> ellipsoid, paper, patches;
  for (const auto& [aspect_step, exponent_step] : shapes) {
    const double aspect = std::exp(0.1 * aspect_step), exponent = 0.25 * exponent_step;
    ellipsoid.push_back(ellipsoid_error(aspect, exponent));
    // At pure torque; along the forces it is the ellipsoid's.
    const double rule = torque_causes({aspect, 1, torque_arm_exact_m(aspect, 1, exponent)},
                                      {aspect, 1, torque_arm_exact_m(aspect, 1, exponent)})
                            .circle_rule;
    paper.push_back(std::max(ellipsoid.back(), -rule));
    const LimitSurface surface(aspect, 1, exponent, 1);
    const SixPatchSurface six(aspect, 1, exponent, 1);
    double worst = 0;
    for (const LimitWrench& wrench : surface.sample(60)) {
      worst = std::max(worst, std::abs(six.utilisation(wrench) - 1));
    }
    patches.push_back(worst);
  }
  const LimitSurface surface(2, 1, 0.5, 1);
  const FrictionEllipsoid exact_arm = surface.ellipsoid();
  const SixPatchSurface six(2, 1, 0.5, 1);
  const double ellipsoid_ns =
      time_ns([&](double force) { return exact_arm.utilisation(force, 0.2, 0.1); });
  json laws = json::array();
  const auto add = [&](const char* name, double cost_ns, const json& error) {
    laws.push_back({{"name", name}, {"cost_ns", rounded(cost_ns)}, {"error", error}});
  };
  add("ellipsoid, √(ab) rule", ellipsoid_ns, quantiles(paper));
  add("ellipsoid", ellipsoid_ns, quantiles(ellipsoid));
  for (const int count : {16, 32, 128}) {
    const LinearisedFriction facets(count);
    Eigen::Matrix3Xd columns(3, facets.count());
    const double cost_ns = time_ns([&](double arm) {
      facets.columns(arm, columns);
      return columns(2, 0);
    });
    add(fmt::format("{} facet vertices", count).c_str(), cost_ns,
        quantiles({1 - facets.inner_bound()}));
  }
  add("six patches", time_ns([&](double force) {
        return six.utilisation({force, 0.2, 0.1});
      }),
      quantiles(patches));
  // To 1e-12 and less, limit_surface.h.
  add("exact limit surface", time_ns([&](double force) {
        return surface.utilisation({force, 0.2, 0.1});
      }),
      quantiles({0}));
  return laws;
}

}  // namespace

json atlas_overview(const AtlasFile& atlas) {
  const Grid grid = grid_of(atlas);
  if (grid.run.empty()) return nullptr;
  std::map<std::string, int> counts;
  json provenance = json::object();
  for (const AtlasRun& run : atlas.runs) ++counts[name_of(run.kind)];
  for (const auto& [key, value] : atlas.provenance) provenance[key] = value;
  const ErrorAtlas known(atlas);

  std::vector<ContactProblem> problems;
  std::vector<QuantityErrors> stated, coarse;
  std::vector<double> cost_s, coarse_cost_s;
  for (const AtlasRun& run : atlas.runs) {
    problems.push_back(problem_of(run));
    stated.push_back(run.stated_error);
    coarse.push_back(run.coarse_error);
    if (std::isfinite(run.cost_s)) cost_s.push_back(run.cost_s);
    if (std::isfinite(run.coarse_cost_s)) coarse_cost_s.push_back(run.coarse_cost_s);
  }

  json models = json::array();
  for (const auto& [name, errors] : atlas.errors) {
    const PressureModel* model = find_pressure_model(name);
    const bool fast = model && model->card().hot_path;
    const double cost_ns = fast ? measured_cost_ns(*model, problems) : known.cost_ns(name);
    json entry = {{"model", name},
                  {"cost_ns", rounded(cost_ns)},
                  {"quantiles", quantiles_by_quantity(errors)},
                  {"claimed", nullptr},
                  {"paper_torque", quantiles(paper_torque_errors(atlas, errors))},
                  {"causes", causes_of(atlas, errors)},
                  {"grid", on_grid(grid, errors)},
                  {"holds", nullptr}};
    if (fast) {
      std::vector<QuantityErrors> claimed;
      std::vector<bool> holds;
      for (std::size_t r = 0; r < problems.size(); ++r) {
        holds.push_back(model->predict(problems[r]).valid());
        if (holds.back()) claimed.push_back(errors[r]);
      }
      entry["claimed"] = quantiles_by_quantity(claimed);
      json& on_nodes = entry["holds"] = json::array();
      for (const int run : grid.run)
        on_nodes.push_back(run >= 0 && holds[std::size_t(run)] ? 1 : 0);
    }
    models.push_back(entry);
  }
  const auto add_finite_elements = [&](const char* name, std::vector<double> costs_s,
                                       const std::vector<QuantityErrors>& errors) {
    models.push_back({{"model", name},
                      {"cost_ns", rounded(1e9 * median(std::move(costs_s)))},
                      {"quantiles", quantiles_by_quantity(errors)},
                      {"claimed", nullptr},
                      {"paper_torque", nullptr},
                      {"causes", nullptr},
                      {"grid", on_grid(grid, errors)},
                      {"holds", nullptr}});
  };
  add_finite_elements("fem_coarse", coarse_cost_s, coarse);
  add_finite_elements("fem", cost_s, stated);
  return {
      {"provenance", provenance},
      {"runs", counts},
      {"grid",
       {{"poisson_ratio", grid.poisson_ratio}, {"radii_ratio", grid.radii_ratio}, {"s", grid.s}}},
      {"models", models},
      {"friction_laws", friction_laws(atlas)},
      {"marks", json::array()}};
}

json finite_strain_overview(const AtlasFile& atlas) {
  // Ranges of d/h at which fingertips of rubber work: touched lightly, held, pressed hard.
  const std::vector<std::pair<double, double>> depths = {{0, 0.05}, {0.05, 0.15}, {0.15, 0.6}};
  std::set<double> poisson_ratios;
  for (const AtlasRun& run : atlas.runs) poisson_ratios.insert(run.poisson_ratio);
  json groups = json::array();
  for (const AtlasKind kind :
       {AtlasKind::finite_sphere, AtlasKind::finite_curved, AtlasKind::finite_pad})
    for (const double nu : poisson_ratios)
      for (const auto& [from, to] : depths) {
        std::vector<std::size_t> chosen;
        double largest_a_over_R = 0;
        for (std::size_t r = 0; r < atlas.runs.size(); ++r) {
          const AtlasRun& run = atlas.runs[r];
          const double depth = run.answer[std::size_t(Quantity::indentation)];
          if (run.kind != kind || run.poisson_ratio != nu || !(depth > from && depth <= to))
            continue;
          chosen.push_back(r);
          largest_a_over_R = std::max(
              largest_a_over_R, run.answer[std::size_t(Quantity::a)] * run.thickness_over_radius);
        }
        if (chosen.empty()) continue;
        json models = json::array();
        for (const auto& [name, errors] : atlas.errors) {
          std::vector<QuantityErrors> of_group;
          for (const std::size_t r : chosen) of_group.push_back(errors[r]);
          json by_quantity = quantiles_by_quantity(of_group);
          if (by_quantity[kQuantityNames[0]].is_null()) continue;
          models.push_back({{"model", name}, {"quantiles", by_quantity}});
        }
        groups.push_back({{"kind", name_of(kind)},
                          {"poisson_ratio", nu},
                          {"indentation_over_thickness", {from, to}},
                          {"largest_a_over_R", rounded(largest_a_over_R)},
                          {"count", chosen.size()},
                          {"models", models}});
      }
  return groups;
}

json map_mark(const input::Case& contact_case, const ContactProblem& problem) {
  return {{"id", contact_case.id},
          {"load_N", problem.load.normal_force_N},
          {"poisson_ratio", problem.layer.poisson_ratio},
          {"radii_ratio", rounded(problem.radii.major_m / problem.radii.minor_m)},
          {"s", rounded(contact_size(problem))},
          {"seed", contact_case.id.rfind("seed_", 0) == 0}};
}

json seed_marks() {
  json marks = json::array();
  for (const auto& file : system::builtin_case_files()) {
    if (file.stem().string().rfind("seed_", 0) != 0) continue;
    const input::Case contact_case = input::read_case(file);
    const prediction::GeometryResolver resolver(contact_case);
    for (const double load_N : contact_case.loads_N)
      marks.push_back(map_mark(contact_case, prediction::contact_problem(
                                                 contact_case, resolver.resolve(load_N), load_N)));
  }
  return marks;
}

}  // namespace softfinger::judgement
