#include "comparisons/judgement/atlas/error_atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <sstream>
#include <string_view>

#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/rubbed_prediction.h"

namespace softfinger::judgement {
namespace {

/// Parts of `line`, which has to outlive them.
void split(std::string_view line, std::vector<std::string_view>& cells) {
  cells.clear();
  for (std::size_t start = 0; start <= line.size();) {
    const std::size_t end = std::min(line.find(',', start), line.size());
    cells.push_back(line.substr(start, end - start));
    start = end + 1;
  }
}

const std::vector<std::string>& own_columns() {
  static const std::vector<std::string> columns = [] {
    std::vector<std::string> all = {"kind", "nu", "ratio", "s", "h_over_R", "mu"};
    for (const char* name : {"a/h", "b/h", "d/h", "area/h2", "peak/E*", "torque/(mu P h)"})
      all.emplace_back(name);
    for (const char* name : kQuantityNames) all.push_back(std::string("error ") + name);
    for (const char* name :
         {"stiffness/(G h3)", "error stiffness", "full slip/(mu P h)", "error full slip"})
      all.emplace_back(name);
    for (const char* name : kQuantityNames) all.push_back(std::string("coarse ") + name);
    for (const char* name :
         {"cost s", "coarse cost s", "finger share x", "finger share y", "finger share xy"})
      all.emplace_back(name);
    return all;
  }();
  return columns;
}

}  // namespace

double contact_size(const ContactProblem& problem) {
  const Prediction prediction = find_pressure_model("bonded_layer")->predict(problem);
  if (!prediction.has_answer) return kNaN;
  return std::sqrt(prediction.a_m * prediction.b_m) / problem.layer.thickness_m;
}

bool is_finite_strain(AtlasKind kind) {
  return kind == AtlasKind::finite_sphere || kind == AtlasKind::finite_curved ||
         kind == AtlasKind::finite_pad || is_finger(kind);
}

bool has_own_radius(const AtlasRun& run) {
  return run.kind != AtlasKind::flat && run.kind != AtlasKind::curved &&
         run.kind != AtlasKind::friction;
}

ContactProblem problem_of(const AtlasRun& run) {
  ContactProblem problem;
  const double nu = run.poisson_ratio;
  problem.layer = {1, 1 - nu * nu, nu};
  // Linear ones flat against the contact, so that no model complains of steep surfaces.
  const double radius_m =
      has_own_radius(run) ? 1 / run.thickness_over_radius : 1e3 * std::max(1., run.s);
  problem.radii = {radius_m * std::sqrt(run.radii_ratio), radius_m / std::sqrt(run.radii_ratio), 0};
  if (is_finger(run.kind))
    problem.finger_curvature = {
        run.finger_share_x / problem.radii.major_m, run.finger_share_y / problem.radii.minor_m,
        run.finger_share_xy / std::sqrt(problem.radii.major_m * problem.radii.minor_m)};
  if (run.kind == AtlasKind::finite_curved || run.kind == AtlasKind::linear_curved)
    problem.finger_curvature = {1 / radius_m, 1 / radius_m, 0};
  problem.is_object_spherical =
      run.kind == AtlasKind::finite_sphere || run.kind == AtlasKind::linear_sphere;
  problem.load.friction_coefficient = run.friction_coefficient > 0 ? run.friction_coefficient : 0.5;
  // ln s grows with ln P, at a slope between 1/6 and 1/3.
  double log_load = 0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    problem.load.normal_force_N = std::exp(log_load);
    const double step = std::log(run.s / contact_size(problem)) * 3.5;
    log_load += step;
    if (std::abs(step) < 1e-13) break;
  }
  problem.load.normal_force_N = std::exp(log_load);
  return problem;
}

QuantityErrors model_errors(const PressureModel& model, const AtlasRun& run,
                            const ContactProblem& problem) {
  QuantityErrors errors;
  errors.fill(kNaN);
  const Prediction found = model.predict(problem);
  if (!found.has_answer) return errors;
  // The largest torque is that of frictionless pressing.
  const Prediction pressed = run.kind == AtlasKind::rubbed_finger && knows_pressing_friction(model)
                                 ? rubbed(model, found, problem, run.friction_coefficient)
                                 : found;
  const QuantityErrors answer = {pressed.a_m,
                                 pressed.b_m,
                                 pressed.indentation_m,
                                 pressed.area_m2(),
                                 pressed.peak_pressure_Pa,
                                 found.torque_arm_exact_m};
  for (std::size_t q = 0; q < kQuantities; ++q) errors[q] = answer[q] / run.answer[q] - 1;
  return errors;
}

std::string to_csv(const AtlasFile& atlas) {
  std::string text;
  for (const auto& [key, value] : atlas.provenance) text += fmt::format("# {}: {}\n", key, value);
  std::string header;
  for (const std::string& column : own_columns()) header += (header.empty() ? "" : ",") + column;
  for (const auto& [model, errors] : atlas.errors)
    for (const char* name : kQuantityNames) header += fmt::format(",{} {}", model, name);
  text += header + "\n";
  const auto cell = [](double value, int digits) {
    return std::isfinite(value) ? fmt::format(",{:.{}g}", value, digits) : std::string(",");
  };
  for (std::size_t r = 0; r < atlas.runs.size(); ++r) {
    const AtlasRun& run = atlas.runs[r];
    text += name_of(run.kind);
    for (const double value : {run.poisson_ratio, run.radii_ratio, run.s, run.thickness_over_radius,
                               run.friction_coefficient})
      text += cell(value, 6);
    for (const double value : run.answer) text += cell(value, 7);
    for (const double value : run.stated_error) text += cell(value, 3);
    const bool friction = run.kind == AtlasKind::friction;
    for (const auto& [value, digits] : {std::pair(run.stiffness, 6),
                                        {run.stiffness_error, 3},
                                        {run.full_slip, 7},
                                        {run.full_slip_error, 3}})
      text += friction ? cell(value, digits) : ",";
    for (const double value : run.coarse_error) text += cell(value, 3);
    text += cell(run.cost_s, 3) + cell(run.coarse_cost_s, 3);
    for (const double share : {run.finger_share_x, run.finger_share_y, run.finger_share_xy})
      text += cell(share, 6);
    for (const auto& [model, errors] : atlas.errors)
      for (const double value : errors[r]) text += cell(value, 4);
    text += "\n";
  }
  return text;
}

AtlasFile parse_atlas(const std::string& text, const std::string& file) {
  AtlasFile atlas;
  std::istringstream lines(text);
  std::vector<std::string> header;
  std::vector<std::string_view> cells;
  std::vector<std::vector<QuantityErrors>*> models;  // whose columns follow, in that order
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.rfind("# ", 0) == 0) {
      const std::size_t colon = line.find(": ");
      if (colon != std::string::npos)
        atlas.provenance.emplace_back(line.substr(2, colon - 2), line.substr(colon + 2));
      continue;
    }
    split(line, cells);
    const std::size_t own = own_columns().size();
    if (header.empty()) {
      header.assign(cells.begin(), cells.end());
      if (header.size() < own ||
          !std::equal(own_columns().begin(), own_columns().end(), header.begin()) ||
          (header.size() - own) % kQuantities != 0)
        throw InputError(fmt::format("{}:{}", file, number), "header of the error atlas", "",
                         "that of this version");
      for (std::size_t column = own; column < header.size(); column += kQuantities)
        models.push_back(&atlas.errors[header[column].substr(0, header[column].find(' '))]);
      continue;
    }
    cells.resize(header.size());
    const auto value = [&](std::size_t column) {
      if (cells[column].empty()) return kNaN;
      double parsed = kNaN;
      const char* end = cells[column].data() + cells[column].size();
      const auto read = std::from_chars(cells[column].data(), end, parsed);
      if (read.ec != std::errc() || read.ptr != end || !std::isfinite(parsed))
        throw InputError(fmt::format("{}:{}", file, number), header[column],
                         std::string(cells[column]), "a finite number");
      return parsed;
    };
    // By these a run is found: no NaN among them.
    const auto number_of = [&](std::size_t column, double least, double largest) {
      const double parsed = value(column);
      if (!(parsed >= least && parsed <= largest))
        throw InputError(fmt::format("{}:{}", file, number), header[column],
                         std::string(cells[column]),
                         fmt::format("a number from {:g} to {:g}", least, largest));
      return parsed;
    };
    AtlasRun run;
    const auto kind = std::find(kAtlasKindNames.begin(), kAtlasKindNames.end(), cells[0]);
    if (kind == kAtlasKindNames.end())
      throw InputError(fmt::format("{}:{}", file, number), header[0], std::string(cells[0]),
                       fmt::format("{}", fmt::join(kAtlasKindNames, ", ")));
    run.kind = AtlasKind(kind - kAtlasKindNames.begin());
    run.poisson_ratio = number_of(1, 0, 0.5);
    run.radii_ratio = number_of(2, 1, 1e6);
    run.s = number_of(3, 1e-6, 1e6);
    run.thickness_over_radius = number_of(4, 0, 1e6);
    run.friction_coefficient = number_of(5, 0, 1e6);
    for (std::size_t q = 0; q < kQuantities; ++q) {
      run.answer[q] = value(6 + q);
      run.stated_error[q] = value(6 + kQuantities + q);
    }
    std::size_t column = 6 + 2 * kQuantities;
    for (double AtlasRun::*field : {&AtlasRun::stiffness, &AtlasRun::stiffness_error,
                                    &AtlasRun::full_slip, &AtlasRun::full_slip_error})
      run.*field = value(column++);
    for (double& error : run.coarse_error) error = value(column++);
    run.cost_s = value(column++);
    run.coarse_cost_s = value(column++);
    run.finger_share_x = value(column++);
    run.finger_share_y = value(column++);
    run.finger_share_xy = value(column++);
    atlas.runs.push_back(run);
    for (std::vector<QuantityErrors>* errors : models) {
      errors->emplace_back();
      for (double& error : errors->back()) error = value(column++);
    }
  }
  return atlas;
}

ErrorAtlas::ErrorAtlas(AtlasFile atlas) : atlas_(std::move(atlas)) {
  grids_[AtlasKind::flat] = grid_of(AtlasKind::flat, &AtlasRun::radii_ratio);
  for (const AtlasKind kind :
       {AtlasKind::curved, AtlasKind::finite_sphere, AtlasKind::finite_curved})
    grids_[kind] = grid_of(kind, &AtlasRun::thickness_over_radius);
}

ErrorAtlas::Grid ErrorAtlas::grid_of(AtlasKind kind, double AtlasRun::*second) const {
  const std::array<double AtlasRun::*, 3> coordinates = {&AtlasRun::poisson_ratio, second,
                                                         &AtlasRun::s};
  Grid grid;
  std::size_t size = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    std::set<double> values;
    for (const AtlasRun& run : atlas_.runs)
      if (run.kind == kind) values.insert(run.*coordinates[c]);
    grid.values[c].assign(values.begin(), values.end());
    size *= values.size();
  }
  // Runs that lie on no grid would make a sparse one, of the cube of their number.
  constexpr std::size_t kMostPlaces = 1'000'000;
  if (size > kMostPlaces)
    throw InputError("error atlas", fmt::format("grid of kind \"{}\"", name_of(kind)),
                     fmt::format("{} places", size), fmt::format("at most {}", kMostPlaces));
  grid.run.assign(size, -1);
  for (std::size_t r = 0; r < atlas_.runs.size(); ++r) {
    if (atlas_.runs[r].kind != kind) continue;
    std::size_t place = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& values = grid.values[c];
      const auto found = std::find(values.begin(), values.end(), atlas_.runs[r].*coordinates[c]);
      place = place * values.size() + std::size_t(found - values.begin());
    }
    grid.run[place] = int(r);
  }
  return grid;
}

namespace {

/// Share of the finite elements' stated error that is added to a model's bound. The stated error is
/// four times the true one in the median (docs/measurements/finite_elements.md).
/// With this share, leaving out each run of the atlas and asking its two neighbours in s, 98 % of
/// all errors of `bonded_layer` lie inside; with a share of 0 73 %, with 1 100 %.
constexpr double kShareOfStated = 0.25;

/// Contacts are placed by a load that is found to round-off.
constexpr double kRounding = 1e-9;

/// The place of a point between two values of a coordinate.
struct Place {
  std::size_t lower = 0, upper = 0;
  double part = 0;  ///< of the way from the lower to the upper one
};

/// The two values that enclose `value`. None if it lies outside all of them by more than round-off.
std::optional<Place> place_among(const std::vector<double>& values, double value,
                                 double (*scale)(double)) {
  if (values.empty() || !(value >= values.front() * (1 - kRounding) - kRounding) ||
      !(value <= values.back() * (1 + kRounding)))
    return std::nullopt;
  value = std::clamp(value, values.front(), values.back());
  const auto above = std::upper_bound(values.begin(), values.end(), value) - values.begin();
  Place place;
  place.upper = std::min(std::size_t(above), values.size() - 1);
  place.lower = place.upper > 0 ? place.upper - 1 : 0;
  const double span = scale(values[place.upper]) - scale(values[place.lower]);
  if (span > 0) place.part = (scale(value) - scale(values[place.lower])) / span;
  return place;
}

/// Near 1/2 it is the ratio of bulk to shear stiffness that changes.
double stiffening(double poisson_ratio) { return -std::log(0.501 - poisson_ratio); }
double logarithm(double value) { return std::log(value); }

}  // namespace

ErrorAtlas::Estimate ErrorAtlas::estimate(const std::string& model, const ContactProblem& problem,
                                          AtlasKind kind, double thickness_over_radius) const {
  Estimate result;
  const auto columns = atlas_.errors.find(model);
  const bool finite_elements = model == "fem";
  if (!finite_elements && columns == atlas_.errors.end()) {
    result.outside = "the error atlas has no errors of this model";
    return result;
  }
  if (problem.has_object_layer()) {
    result.outside = "the error atlas knows one elastic layer, not two";
    return result;
  }
  const bool flat = kind == AtlasKind::flat;
  const Grid& grid = grids_.at(kind);
  const double ratio = std::max(1., problem.radii.major_m / problem.radii.minor_m);
  if (!flat && ratio > 1 + 1e-6) {
    result.outside = kind == AtlasKind::curved
                         ? "the error atlas knows curved layers on round fingers only"
                         : "the error atlas knows round contacts only at finite strain";
    return result;
  }
  const std::array<double, 3> at = {problem.layer.poisson_ratio,
                                    flat ? ratio : thickness_over_radius, contact_size(problem)};
  const std::array<const char*, 3> names = {"Poisson's ratio", flat ? "R'/R''" : "h/R",
                                            "s = sqrt(ab)/h"};
  std::array<Place, 3> places;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto& values = grid.values[c];
    const auto place = place_among(values, at[c], c == 0 ? stiffening : logarithm);
    if (!place) {
      result.outside =
          values.empty()
              ? std::string("the error atlas has no such runs")
              : fmt::format("outside the error atlas: {} = {:.4g}, known from {:g} to {:g}",
                            names[c], at[c], values.front(), values.back());
      return result;
    }
    places[c] = *place;
  }
  QuantityErrors lowest, highest, stated{};
  lowest.fill(std::numeric_limits<double>::infinity());
  highest.fill(-std::numeric_limits<double>::infinity());
  for (int corner = 0; corner < 8; ++corner) {
    std::size_t index = 0;
    double weight = 1;
    for (std::size_t c = 0; c < 3; ++c) {
      const bool up = corner >> c & 1;
      weight *= up ? places[c].part : 1 - places[c].part;
      index = index * grid.values[c].size() + (up ? places[c].upper : places[c].lower);
    }
    if (weight <= kRounding) continue;  // the contact's place is known to round-off
    const int run = grid.run[index];
    if (run < 0) {
      result.outside = "the error atlas lacks a run there";
      return result;
    }
    const QuantityErrors& known = atlas_.runs[std::size_t(run)].stated_error;
    for (std::size_t q = 0; q < kQuantities; ++q) {
      const double error = finite_elements ? 0 : columns->second[std::size_t(run)][q];
      if (!std::isfinite(error)) {
        result.outside = "the model has no answer for contacts like this one";
        return result;
      }
      result.mean[q] += weight * error;
      lowest[q] = std::min(lowest[q], error);
      highest[q] = std::max(highest[q], error);
      stated[q] += weight * known[q];
    }
  }
  result.bound.emplace();
  const double share = finite_elements ? 1 : kShareOfStated;
  for (std::size_t q = 0; q < kQuantities; ++q)
    (*result.bound)[q] =
        std::abs(result.mean[q]) + 0.5 * (highest[q] - lowest[q]) + share * stated[q];
  return result;
}

double ErrorAtlas::cost_ns(const std::string& model) const {
  for (const auto& [key, value] : atlas_.provenance)
    if (key == "cost_ns " + model) return std::strtod(value.c_str(), nullptr);
  return kNaN;
}

namespace {

AtlasFile read_atlas(const char* name) {
  const auto path = system::share_folder() / name;
  return parse_atlas(system::read_text_file(path), path.string());
}

}  // namespace

const ErrorAtlas& error_atlas() {
  static const ErrorAtlas atlas(read_atlas("error_atlas.csv"));
  return atlas;
}

const ErrorAtlas& finite_strain_atlas() {
  static const ErrorAtlas atlas(read_atlas("finite_strain.csv"));
  return atlas;
}

const AtlasFile& finger_runs() {
  static const AtlasFile runs = read_atlas("fingers.csv");
  return runs;
}

const AtlasRun* nearest_finger_run(const ContactProblem& problem) {
  struct Place {
    double size, ratio, thickness, stiffening, share_x, share_y;
  };
  const auto place = [](double s, double ratio, double thickness, double nu, double x, double y) {
    return Place{std::log(s), std::log(ratio), std::log(thickness), -std::log(0.501 - nu), x, y};
  };
  const RelativeRadii& radii = problem.radii;
  const Place here =
      place(contact_size(problem), radii.major_m / radii.minor_m,
            problem.layer.thickness_m / (std::sqrt(radii.major_m) * std::sqrt(radii.minor_m)),
            problem.layer.poisson_ratio, problem.finger_curvature.xx_per_m * radii.major_m,
            problem.finger_curvature.yy_per_m * radii.minor_m);
  const AtlasRun* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const AtlasRun& run : finger_runs().runs) {
    const Place there = place(run.s, run.radii_ratio, run.thickness_over_radius, run.poisson_ratio,
                              run.finger_share_x, run.finger_share_y);
    const auto squared = [&](double Place::*coordinate) {
      return std::pow(here.*coordinate - there.*coordinate, 2);
    };
    const double distance = squared(&Place::size) + squared(&Place::ratio) +
                            squared(&Place::thickness) + squared(&Place::stiffening) +
                            squared(&Place::share_x) + squared(&Place::share_y);
    if (!(distance < least)) continue;
    least = distance;
    nearest = &run;
  }
  return nearest;
}

}  // namespace softfinger::judgement
