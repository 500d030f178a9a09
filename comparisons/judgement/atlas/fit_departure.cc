#include "comparisons/judgement/atlas/fit_departure.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "comparisons/judgement/median.h"
#include "softfinger/accuracy/error_bound.h"
#include "softfinger/input/errors.h"

namespace softfinger::judgement {
namespace {

/// Scatter of the finite elements that no number of a single run states.
constexpr double kScatter = 0.002;
/// Of the stated error the true one is a quarter in the median.
constexpr double kPartOfStated = 0.25;
/// Against terms that hardly differ within the runs.
constexpr double kRidge = 1e-6;
constexpr int kParts = 10;
constexpr double kInside = 0.96;

FingerShare share_of(const AtlasRun& run) {
  if (run.kind == AtlasKind::finger) return {run.finger_share_x, run.finger_share_y};
  return run.kind == AtlasKind::finite_curved ? FingerShare{1, 1} : FingerShare{0, 0};
}

bool is_of_the_fit(const AtlasRun& run) {
  return run.kind == AtlasKind::finger || run.kind == AtlasKind::finite_curved ||
         run.kind == AtlasKind::finite_pad;
}

struct Samples {
  Eigen::MatrixXd terms;  ///< a row per run
  Eigen::VectorXd size;
  std::vector<const AtlasRun*> runs;
};

Samples samples_of(const AtlasFile& atlas) {
  Samples samples;
  for (const AtlasRun& run : atlas.runs)
    if (is_of_the_fit(run)) samples.runs.push_back(&run);
  const auto count = Eigen::Index(samples.runs.size());
  samples.terms.resize(count, kDepartureTerms);
  samples.size.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const AtlasRun& run = *samples.runs[std::size_t(i)];
    const ContactProblem problem = problem_of(run);
    const Prediction flat = find_pressure_model("bonded_layer")->predict(problem);
    const auto terms = departure_terms(problem, flat, share_of(run));
    samples.terms.row(i) = Eigen::Map<const Eigen::RowVectorXd>(terms.data(), kDepartureTerms);
    samples.size[i] = departure_size(problem, flat, share_of(run));
  }
  return samples;
}

/// @param left_out  every kParts-th row from here on; -1: none
Eigen::VectorXd solve(const Samples& samples, const Eigen::VectorXd& departures,
                      const Eigen::VectorXd& weights, int left_out) {
  Eigen::VectorXd used = weights;
  if (left_out >= 0)
    for (Eigen::Index i = left_out; i < used.size(); i += kParts) used[i] = 0;
  Eigen::MatrixXd normal = samples.terms.transpose() * used.asDiagonal() * samples.terms;
  normal.diagonal() *= 1 + kRidge;
  return normal.ldlt().solve(samples.terms.transpose() * used.cwiseProduct(departures));
}

/// The pair of least median bound that holds enough of the residuals.
void choose_width(const Eigen::VectorXd& predicted, const Eigen::VectorXd& departures,
                  const Eigen::VectorXd& size, DepartureFit& fit) {
  const Eigen::VectorXd residual = (departures - predicted).cwiseAbs();
  double best = std::numeric_limits<double>::infinity();
  for (double per_size = 0; per_size <= 0.2; per_size += 0.0025) {
    // The least that holds enough of them beside it.
    std::vector<double> rest;
    for (Eigen::Index i = 0; i < residual.size(); ++i)
      rest.push_back(std::max(0., residual[i] - per_size * size[i]));
    const auto place = rest.begin() + std::ptrdiff_t(kInside * double(rest.size()));
    std::nth_element(rest.begin(), place, rest.end());
    std::vector<double> bounds;
    for (Eigen::Index i = 0; i < residual.size(); ++i)
      bounds.push_back(std::abs(predicted[i]) + *place + per_size * size[i]);
    const double typical = median(bounds);
    if (!(typical < best)) continue;
    best = typical;
    fit.width_least = *place;
    fit.width_per_size = per_size;
  }
}

}  // namespace

FittedDeparture fit_departure(const AtlasFile& atlas) {
  const Samples samples = samples_of(atlas);
  const auto count = Eigen::Index(samples.runs.size());
  if (count < 4 * Eigen::Index(kDepartureTerms))
    throw InputError("atlas of fingers", fmt::format("{} runs at finite strain", count), "",
                     fmt::format("at least {}", 4 * kDepartureTerms));
  FittedDeparture fitted;
  fitted.runs = samples.runs.size();
  const PressureModel& layer = *find_pressure_model("bonded_layer");
  Eigen::MatrixXd departures(count, kQuantities), weights(count, kQuantities);
  for (Eigen::Index i = 0; i < count; ++i) {
    const AtlasRun& run = *samples.runs[std::size_t(i)];
    const QuantityErrors errors = model_errors(layer, run, problem_of(run));
    for (int q = 0; q < kQuantities; ++q) {
      departures(i, q) = errors[std::size_t(q)];
      const double scatter = kPartOfStated * run.stated_error[std::size_t(q)];
      weights(i, q) = 1 / (kScatter * kScatter + scatter * scatter);
    }
  }
  for (int q = 0; q < kQuantities; ++q) {
    DepartureFit& fit = fitted.fits[std::size_t(q)];
    const Eigen::VectorXd of_quantity = departures.col(q), weight = weights.col(q);
    Eigen::VectorXd predicted(count);
    for (int part = 0; part < kParts; ++part) {
      const Eigen::VectorXd coefficients = solve(samples, of_quantity, weight, part);
      for (Eigen::Index i = part; i < count; i += kParts)
        predicted[i] = samples.terms.row(i) * coefficients;
    }
    choose_width(predicted, of_quantity, samples.size, fit);
    Eigen::Map<Eigen::VectorXd>(fit.coefficients.data(), kDepartureTerms) =
        solve(samples, of_quantity, weight, -1);
  }
  for (std::size_t q = 0; q < kQuantities; ++q) {
    std::vector<double> stated;
    for (const AtlasRun* run : samples.runs)
      if (std::isfinite(run->stated_error[q])) stated.push_back(run->stated_error[q]);
    const auto place = stated.begin() + std::ptrdiff_t(0.95 * double(stated.size()));
    std::nth_element(stated.begin(), place, stated.end());
    fitted.finite_elements[q] = *place;
  }
  return fitted;
}

std::map<std::string, DepartureTest> test_departure(const AtlasFile& unseen) {
  std::map<std::string, DepartureTest> tests;
  for (const PressureModel* model : all_pressure_models()) {
    if (model->card().name == "power_law") continue;  // it holds for the finger it was fitted to
    DepartureTest test;
    std::array<std::vector<double>, kQuantities> ratios;
    for (const AtlasRun& run : unseen.runs) {
      if (!is_of_the_fit(run)) continue;
      const ContactProblem problem = problem_of(run);
      const ErrorBound bound = error_bound(*model, problem, share_of(run));
      if (!bound.known) continue;
      const QuantityErrors errors = model_errors(*model, run, problem);
      ++test.runs;
      for (std::size_t q = 0; q < kQuantities; ++q) {
        test.inside[q] += std::abs(errors[q]) <= bound.bound[q];
        ratios[q].push_back(bound.bound[q] / std::abs(errors[q]));
      }
    }
    if (test.runs == 0) continue;
    for (std::size_t q = 0; q < kQuantities; ++q) {
      test.inside[q] /= double(test.runs);
      test.ratio[q] = median(ratios[q]);
    }
    tests.emplace(model->card().name, test);
  }
  return tests;
}

std::string departure_table(const FittedDeparture& fitted, const std::string& command) {
  std::string text = fmt::format(
      "// Made by: {}\n// from {} finite-element runs. See finger_departure.h.\n"
      "#include \"softfinger/accuracy/finger_departure.h\"\n\nnamespace softfinger {{\n\n"
      "const std::array<DepartureFit, kBoundedQuantities> kDepartureFits = {{{{\n",
      command, fitted.runs);
  for (std::size_t q = 0; q < fitted.fits.size(); ++q) {
    const DepartureFit& fit = fitted.fits[q];
    text += fmt::format("    // {}\n    {{{{{{", kQuantityNames[q]);
    for (std::size_t t = 0; t < kDepartureTerms; ++t)
      text += fmt::format("{}{:.6g}",
                          t == 0       ? ""
                          : t % 6 == 0 ? ",\n       "
                                       : ", ",
                          fit.coefficients[t]);
    text +=
        fmt::format("}}}},\n     {:.4g},\n     {:.4g}}},\n", fit.width_least, fit.width_per_size);
  }
  text += "}};\n\nconst BoundedErrors kFiniteElementErrors = {";
  for (std::size_t q = 0; q < fitted.finite_elements.size(); ++q)
    text += fmt::format("{}{:.4g}", q == 0 ? "" : ", ", fitted.finite_elements[q]);
  return text + "};\n\n}  // namespace softfinger\n";
}

}  // namespace softfinger::judgement
