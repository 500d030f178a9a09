#include "comparisons/judgement/atlas/fit_fingertip.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "comparisons/judgement/median.h"
#include "softfinger/accuracy/error_bound.h"
#include "softfinger/accuracy/pressing_error.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/stack_models.h"

namespace softfinger::judgement {
namespace {

/// Scatter of the finite elements that no number of a single run states.
constexpr double kScatter = 0.002;
/// Median of the true error over the stated one.
constexpr double kPartOfStated = 0.25;
/// Against terms that hardly differ within the runs.
constexpr double kRidge = 1e-5;
constexpr int kParts = 10;
constexpr double kInside = 0.96;

bool is_of_the_fit(const AtlasRun& run) {
  return is_finite_strain(run.kind) && std::isfinite(run.answer[0]);
}

/// A run as the model sees it.
struct Sample {
  const AtlasRun* run;
  ContactInputOf<double> input;
  LayerQuantities flat;
  ContactNumbers flat_numbers;
  FingertipArguments<double> arguments;
  double size = 0;  ///< of the departure
};

std::vector<Sample> samples_of(const AtlasFile& atlas) {
  std::vector<Sample> samples;
  for (const AtlasRun& run : atlas.runs) {
    if (!is_of_the_fit(run)) continue;
    const ContactProblem problem = problem_of(run);
    Sample sample;
    sample.run = &run;
    sample.input = contact_input(problem.radii, problem.layer, problem.load.normal_force_N,
                                 problem.finger_curvature);
    const auto at = layer_arguments(sample.input);
    sample.flat = bonded_layer_logarithms(at.log_load, run.poisson_ratio, at.log_radii_ratio);
    sample.flat_numbers = contact_of_logarithms(sample.flat, at.mean_radius_m, sample.input);
    sample.arguments = fingertip_arguments(sample.input, sample.flat_numbers,
                                           problem.is_object_spherical ? 1. : 0.);
    sample.size = departure_size(sample.arguments);
    samples.push_back(sample);
  }
  return samples;
}

/// Predicted by a table, in the order of the quantities.
QuantityErrors predicted(const Sample& sample, const FingertipLayerTable& table) {
  const ContactNumbers found = corrected_contact(
      sample.flat, sample.flat_numbers,
      fingertip_correction(table, sample.arguments, sample.input.poisson_ratio), sample.input);
  return {found.a_m,
          found.b_m,
          found.indentation_m,
          kPi * found.a_m * found.b_m,
          found.peak_pressure_Pa,
          found.torque_arm_exact_m};
}

/// Equations of a least-squares problem with several right-hand sides.
struct Equations {
  Eigen::MatrixXd terms;  ///< a row per sample
  Eigen::VectorXd solve(const Eigen::VectorXd& departures, const Eigen::VectorXd& weights) const {
    Eigen::MatrixXd normal = terms.transpose() * weights.asDiagonal() * terms;
    normal.diagonal() *= 1 + kRidge;
    return normal.ldlt().solve(terms.transpose() * weights.cwiseProduct(departures));
  }
};

Equations equations_of(const std::vector<Sample>& samples, int first_effect, int last_effect,
                       int terms) {
  Equations equations;
  equations.terms.resize(Eigen::Index(samples.size()), terms);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto shapes =
        fingertip_shapes(2 * samples[i].input.poisson_ratio, samples[i].arguments.l);
    int term = 0;
    for (int effect = first_effect; effect < last_effect; ++effect)
      for (int shape = 0; shape < kShapesOf[effect]; ++shape)
        equations.terms(Eigen::Index(i), term++) =
            samples[i].arguments.effects[std::size_t(effect)] * shapes[std::size_t(shape)];
  }
  return equations;
}

/// @param left_out  every kParts-th sample from here on; -1: none
FingertipLayerTable fit(const std::vector<Sample>& samples, int left_out) {
  const auto count = Eigen::Index(samples.size());
  const Equations symmetric = equations_of(samples, 0, kSymmetricEffects, kSymmetricTerms);
  const Equations aspect =
      equations_of(samples, kSymmetricEffects, kFingertipEffects, kAspectTerms);
  /// Weights by the stated errors of one or two quantities.
  const auto weights = [&](std::initializer_list<Quantity> quantities) {
    Eigen::VectorXd weight(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      double stated = 0;
      for (const Quantity q : quantities)
        stated += samples[std::size_t(i)].run->stated_error[std::size_t(q)];
      const double scatter = kPartOfStated * stated / double(quantities.size());
      const bool used = left_out < 0 || i % kParts != left_out;
      weight[i] = used ? 1 / (kScatter * kScatter + scatter * scatter) : 0;
    }
    return weight;
  };
  const auto departures = [&](const auto& of_sample) {
    Eigen::VectorXd departure(count);
    for (Eigen::Index i = 0; i < count; ++i) departure[i] = of_sample(samples[std::size_t(i)]);
    return departure;
  };
  const auto log_ratio = [](const Sample& sample, Quantity q, double flat) {
    return std::log(sample.run->answer[std::size_t(q)] / flat);
  };
  const auto departure_of = [&](Quantity q, double ContactNumbers::*flat) {
    return departures([&, q, flat](const Sample& sample) {
      return log_ratio(sample, q, sample.flat_numbers.*flat);
    });
  };
  FingertipLayerTable table{};
  const auto set_column = [&](FingertipColumn column, const Eigen::VectorXd& values) {
    for (int term = 0; term < kSymmetricTerms; ++term) table.symmetric[term][column] = values[term];
  };
  const Eigen::VectorXd a = departure_of(Quantity::a, &ContactNumbers::a_m);
  const Eigen::VectorXd b = departure_of(Quantity::b, &ContactNumbers::b_m);
  const Eigen::VectorXd axes = weights({Quantity::a, Quantity::b});
  set_column(kSizeColumn, symmetric.solve(0.5 * (a + b), axes));
  Eigen::Map<Eigen::VectorXd>(table.aspect, kAspectTerms) = aspect.solve(a - b, axes);
  set_column(kDepthColumn,
             symmetric.solve(departure_of(Quantity::indentation, &ContactNumbers::indentation_m),
                             weights({Quantity::indentation})));
  set_column(kPeakColumn, symmetric.solve(departure_of(Quantity::peak_pressure,
                                                       &ContactNumbers::peak_pressure_Pa),
                                          weights({Quantity::peak_pressure})));
  // The arm, which the finite elements tell best, makes up for what the fitted ellipse leaves.
  const Eigen::VectorXd arm = departures([&](const Sample& sample) {
    return log_ratio(sample, Quantity::max_torque,
                     predicted(sample, table)[std::size_t(Quantity::max_torque)]);
  });
  set_column(kArmColumn, symmetric.solve(arm, weights({Quantity::max_torque})));
  return table;
}

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return kNaN;
  const auto place = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// Returns the width of least geometric mean among those that hold enough of the residuals.
FingertipWidth width_of(const std::vector<double>& residuals, const std::vector<double>& sizes) {
  FingertipWidth width{};
  double best = std::numeric_limits<double>::infinity();
  for (const double power : {0.5, 0.75, 1., 1.5, 2.})
    for (double per_size = 0; per_size <= 0.3; per_size += 0.0025) {
      FingertipWidth tried{0, per_size, power};
      // The least that holds enough of them beside it.
      std::vector<double> rest;
      for (std::size_t i = 0; i < residuals.size(); ++i)
        rest.push_back(std::max(0., std::abs(residuals[i]) - tried.at(sizes[i])));
      tried.least = quantile(rest, kInside);
      double typical = 0;
      for (const double size : sizes) typical += std::log(tried.at(size));
      if (!(typical < best)) continue;
      best = typical;
      width = tried;
    }
  return width;
}

}  // namespace

FittedFingertip fit_fingertip(const AtlasFile& atlas) {
  const std::vector<Sample> samples = samples_of(atlas);
  if (samples.size() < 4 * std::size_t(kSymmetricTerms))
    throw InputError("atlas of fingers", fmt::format("{} runs at finite strain", samples.size()),
                     "", fmt::format("at least {}", 4 * kSymmetricTerms));
  FittedFingertip fitted;
  fitted.runs = samples.size();
  fitted.table = fit(samples, -1);
  std::array<std::vector<double>, kQuantities> residuals;
  for (std::vector<double>& of_quantity : residuals) of_quantity.resize(samples.size());
  std::vector<double> sizes;
  for (const Sample& sample : samples) sizes.push_back(sample.size);
  for (int part = 0; part < kParts; ++part) {
    const FingertipLayerTable of_others = fit(samples, part);
    for (std::size_t i = std::size_t(part); i < samples.size(); i += kParts) {
      const QuantityErrors found = predicted(samples[i], of_others);
      for (std::size_t q = 0; q < kQuantities; ++q)
        residuals[q][i] = found[q] / samples[i].run->answer[q] - 1;
    }
  }
  for (std::size_t q = 0; q < kQuantities; ++q) {
    fitted.table.widths[q] = width_of(residuals[q], sizes);
    std::vector<double> stated;
    for (const Sample& sample : samples)
      if (std::isfinite(sample.run->stated_error[q])) stated.push_back(sample.run->stated_error[q]);
    fitted.table.finite_elements[q] = quantile(stated, 0.95);
  }
  return fitted;
}

std::map<std::string, BoundTest> test_bounds_on_fingers(const AtlasFile& unseen) {
  std::map<std::string, BoundTest> tests;
  for (const PressureModel* model : all_pressure_models()) {
    if (model->card().is_empirical) continue;  // it holds for the finger it was fitted to
    if (is_for_stacks(*model)) continue;       // these fingers are of one material
    BoundTest test;
    std::array<std::vector<double>, kQuantities> ratios, all_errors;
    for (const AtlasRun& run : unseen.runs) {
      if (!is_of_the_fit(run)) continue;
      const ContactProblem problem = problem_of(run);
      const ErrorBound bound = run.kind == AtlasKind::rubbed_finger
                                   ? error_bound(*model, problem, run.friction_coefficient)
                                   : error_bound(*model, problem);
      if (!bound.known) continue;
      const QuantityErrors errors = model_errors(*model, run, problem);
      ++test.runs;
      for (std::size_t q = 0; q < kQuantities; ++q) {
        test.inside[q] += std::abs(errors[q]) <= bound.bound[q];
        ratios[q].push_back(bound.bound[q] / std::abs(errors[q]));
        all_errors[q].push_back(std::abs(errors[q]));
      }
    }
    if (test.runs == 0) continue;
    for (std::size_t q = 0; q < kQuantities; ++q) {
      test.inside[q] /= double(test.runs);
      test.ratio[q] = median(ratios[q]);
      test.median[q] = median(all_errors[q]);
      test.most[q] = quantile(all_errors[q], 0.95);
      test.largest[q] = quantile(all_errors[q], 1);
    }
    tests.emplace(model->card().name, test);
  }
  return tests;
}

std::string fingertip_table(const FittedFingertip& fitted, const std::string& command) {
  std::string text = fmt::format(
      "// Made by: {}\n// from {} finite-element runs. See fingertip_layer_core.h.\n"
      "#include \"softfinger/layer/fingertip_layer_core.h\"\n\nnamespace softfinger {{\n\n"
      "const FingertipLayerTable kFingertipLayerTable = {{\n    // ln sqrt(ab), ln d, ln peak, ln "
      "arm\n    {{\n",
      command, fitted.runs);
  for (const auto& term : fitted.table.symmetric)
    text += fmt::format("        {{{:.6g}}},\n", fmt::join(term, ", "));
  text += "    },\n    // ln(a/b)\n    {";
  for (int term = 0; term < kAspectTerms; ++term)
    text += fmt::format("{}{:.6g}",
                        term == 0       ? ""
                        : term % 6 == 0 ? ",\n     "
                                        : ", ",
                        fitted.table.aspect[term]);
  text += "},\n    // a, b, d, area, peak pressure, torque\n    {";
  for (std::size_t q = 0; q < kQuantities; ++q)
    text +=
        fmt::format("{}{{{:.4g}, {:.4g}, {:g}}}", q == 0 ? "" : ", ", fitted.table.widths[q].least,
                    fitted.table.widths[q].per_size, fitted.table.widths[q].power);
  text += fmt::format("}},\n    {{{:.4g}}},\n}};\n\n}}  // namespace softfinger\n",
                      fmt::join(fitted.table.finite_elements, ", "));
  return text;
}

}  // namespace softfinger::judgement
