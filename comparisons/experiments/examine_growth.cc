#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "comparisons/experiments/examine.h"
#include "comparisons/experiments/hardness_relations.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/accuracy/error_bound.h"
#include "softfinger/calibration/calibrate.h"
#include "softfinger/layer/growth_exponent.h"
#include "softfinger/pressure/rubbed_prediction.h"

namespace softfinger::experiments {
namespace {

struct Limit {
  const char* model;
  double exponent;
};
constexpr Limit kHertz{"hertz", 1. / 3}, kWinkler{"winkler", 1. / 4},
    kThin{"thin_incompressible", 1. / 6};

/// value, and where the numbers at the ends of another interval lie.
Interval spanned(double value, double one, double other) {
  return {value, std::min({value, one, other}), std::max({value, one, other})};
}

/// a/h of an exponent, which is looked for but once.
class Sizes {
 public:
  std::optional<double> of(double exponent, double poisson_ratio) {
    const auto [place, is_new] = found_.try_emplace({exponent, poisson_ratio});
    if (is_new) place->second = layer_size_of_exponent(exponent, poisson_ratio);
    return place->second;
  }

  /// Range of a/h with the exponent moved by its uncertainty; 0 or infinite at an end that no layer
  /// has.
  std::optional<Interval> interval(double exponent, double uncertainty, double poisson_ratio) {
    const auto s = of(exponent, poisson_ratio);
    if (!s) return std::nullopt;
    if (uncertainty == 0) return Interval{*s, *s, *s};
    return spanned(*s, of(exponent + uncertainty, poisson_ratio).value_or(0),
                   of(exponent - uncertainty, poisson_ratio).value_or(INFINITY));
  }

 private:
  std::map<std::pair<double, double>, std::optional<double>> found_;
};

/// The exponent alone, without any free number: a bonded layer's lies between its smallest one and
/// 1/3; half-space, columns and thin incompressible layer each have one.
void test_exponents(const Growth& growth, Sizes& sizes_of, Examined& examined) {
  const double nu = growth.main_poisson_ratio, smallest = smallest_layer_exponent(nu);
  const double moved = growth.exponent_uncertainty.value_or(0);
  std::string sizes;
  std::vector<std::string> excluded;
  for (const GrowthLaw& law : growth.laws) {
    const std::string test = fmt::format("exponent d ln a/d ln P, a = {:.4g} mm P^{:.4g}",
                                         law.coefficient_m * 1e3, law.exponent);
    Finding finding;
    finding.test = test;
    finding.model = "bonded_layer";
    finding.measured = law.exponent;
    finding.uncertainty = growth.exponent_uncertainty;
    finding.predicted = {std::clamp(law.exponent, smallest, 1. / 3), smallest, 1. / 3};
    finding.verdict = compared(finding);
    const auto s = sizes_of.interval(law.exponent, moved, nu);
    if (s) {
      finding.reason =
          fmt::format("A layer of nu {:g} has this exponent at a/h = {:.3g}.", nu, s->value);
      sizes += fmt::format("{}P^{:.4g} says a/h = {:.3g}", sizes.empty() ? "a ~ " : ", ",
                           law.exponent, s->value);
      if (s->high > s->low && std::isfinite(s->high))
        sizes += fmt::format(" ({:.3g} to {:.3g})", s->low, s->high);
    }
    examined.findings.push_back(finding);
    excluded.clear();
    for (const Limit& limit : {kHertz, kWinkler, kThin}) {
      Finding rival = finding;
      rival.model = limit.model;
      rival.role = Role::rival;
      rival.predicted = {limit.exponent, limit.exponent, limit.exponent};
      rival.verdict = compared(rival);
      rival.reason.clear();
      if (rival.verdict == Verdict::fails) excluded.push_back(limit.model);
      examined.findings.push_back(rival);
    }
    for (const double ratio : growth.poisson_ratios)
      if (const auto size = sizes_of.interval(law.exponent, moved, ratio))
        examined.inferred.push_back(
            {"size_over_thickness", "",
             fmt::format("of the exponent {:.4g}, nu {:g}", law.exponent, ratio), *size});
  }
  examined.sentence =
      sizes.empty() ? "No bonded layer grows like this" : sizes + fmt::format(" at nu {:g}", nu);
  if (growth.exponent_uncertainty && !excluded.empty()) {
    examined.sentence +=
        fmt::format("; excluded, if the exponent is known to ± {:g} as supposed: {}", moved,
                    text::joined(excluded));
  }
  examined.sentence +=
      growth.exponent_uncertainty ? "." : "; how certain the exponent is is not known.";
}

/// The two interpretations of a published a = c P^gamma with a pressure exponent k.
enum class Reading {
  radius,  ///< c P^gamma is the radius
  torque   ///< c was identified from torques: e_n = 2 (xi nu)_k c P^gamma is what was measured
};

const char* words_of(Reading reading) {
  return reading == Reading::radius ? "coefficient is the radius" : "coefficient is from torques";
}

/// (int p r dA)/(P a) of p ~ (1 - (r/a)^k)^(1/k):
/// B(3/k, 1 + 1/k)/B(2/k, 1 + 1/k), which is 2 (xi nu)_k.
double torque_arm_of_power_law(double k) {
  return std::exp(std::lgamma(3 / k) - std::lgamma(4 / k + 1) - std::lgamma(2 / k) +
                  std::lgamma(3 / k + 1));
}

/// One interpretation of a law, as measurements of a finger.
struct MeasuredLaw {
  const LawCalibration& data;
  Reading reading;
  GrowthLaw law;
  double poisson_ratio;

  /// Radius or eccentricity.
  double value_m(double load_N) const {
    return (reading == Reading::radius ? 1 : torque_arm_of_power_law(data.pressure_exponent_k)) *
           law.coefficient_m * std::pow(load_N, law.exponent);
  }

  ContactProblem contact(const ElasticLayer& layer, double load_N) const {
    ContactProblem problem;
    problem.radii = {data.radius_m, data.radius_m, 0};
    problem.finger_curvature = {1 / data.radius_m, 1 / data.radius_m, 0};
    problem.layer = layer;
    problem.load = {load_N, 1};
    return problem;
  }

  double predicted_m(const ElasticLayer& layer, double load_N) const {
    const PressureModel& model = *find_pressure_model("fingertip_layer");
    const ContactProblem problem = contact(layer, load_N);
    const Prediction found = model.predict(problem);
    if (reading != Reading::radius) return found.torque_arm_exact_m;
    return rubbed(model, found, problem, std::numeric_limits<double>::infinity()).a_m;
  }
};

/// Thickness and modulus by points of the law, evenly spaced in ln P, without errors of their own.
Calibration calibrated(const MeasuredLaw& law, const std::array<double, 2>& loads_N) {
  constexpr int kPoints = 8;
  CalibrationProblem problem;
  problem.model = find_pressure_model("fingertip_layer");
  problem.free = {Parameter::youngs_modulus, Parameter::thickness};
  problem.pressing = PressingFriction::stuck;  // as silicone does
  problem.start[index_of(Parameter::youngs_modulus)] = 3e5;
  problem.start[index_of(Parameter::thickness)] = law.data.radius_m / 10;
  problem.start[index_of(Parameter::poisson_ratio)] = law.poisson_ratio;
  problem.start[index_of(Parameter::radius)] = law.data.radius_m;
  problem.start[index_of(Parameter::friction_coefficient)] = 1;
  problem.start[index_of(Parameter::shear_strength)] = 1e4;
  problem.start[index_of(Parameter::radius_coefficient)] = 1e-3;
  problem.start[index_of(Parameter::radius_exponent)] = 0.3;
  const ElasticLayer start{law.data.radius_m / 10, 3e5, law.poisson_ratio};
  for (int i = 0; i < kPoints; ++i) {
    const double load_N = loads_N[0] * std::pow(loads_N[1] / loads_N[0], i / (kPoints - 1.));
    problem.measurements.contacts.push_back(law.contact(start, load_N));
    const bool is_radius = law.reading == Reading::radius;
    problem.measurements.values.push_back(
        {is_radius ? MeasuredQuantity::a : MeasuredQuantity::max_torque, std::size_t(i),
         is_radius ? law.value_m(load_N) : law.value_m(load_N) * load_N});
  }
  return calibrate(problem);
}

ElasticLayer layer_of(const Calibration& calibration) {
  return {calibration.values[index_of(Parameter::thickness)],
          calibration.values[index_of(Parameter::youngs_modulus)],
          calibration.values[index_of(Parameter::poisson_ratio)]};
}

/// The largest relative deviation of an elastic layer from the measured power law, to which it is
/// fitted over all loads. A power law that was fitted to points measured on such a layer misses
/// them by about as much.
double misfit(const MeasuredLaw& law, const std::array<double, 2>& range_N) {
  const ElasticLayer layer = layer_of(calibrated(law, range_N));
  double largest = 0;
  for (const double load_N : range_N)
    largest = std::max(largest, std::abs(law.predicted_m(layer, load_N) / law.value_m(load_N) - 1));
  return largest;
}

/// Calibrated below, predicted above. The law is uncertain there by its exponent, turned about the
/// middle of the fitted loads. A deviation beyond that, but within what a power law cannot follow
/// of a layer over the loads that were supposedly measured, tells nothing: the points are not
/// published. The rivals are given the same tolerance.
void predict_above(const MeasuredLaw& law, double exponent_uncertainty, Examined& examined) {
  const LawCalibration& data = law.data;
  const Calibration calibration = calibrated(law, data.fit_load_N);
  const ElasticLayer layer = layer_of(calibration);
  const double middle_N = std::sqrt(data.fit_load_N[0] * data.fit_load_N[1]);
  const double misfit_of_law = misfit(law, data.supposed_range_N);
  const bool is_radius = law.reading == Reading::radius;
  const std::string condition =
      fmt::format("calibrated from {:g} to {:g} N, nu {:g}", data.fit_load_N[0], data.fit_load_N[1],
                  law.poisson_ratio);
  for (const ParameterEstimate& estimate : calibration.parameters)
    examined.inferred.push_back({std::string(range_of(estimate.parameter).name),
                                 std::string(range_of(estimate.parameter).unit),
                                 condition,
                                 {estimate.value, estimate.low, estimate.high},
                                 words_of(law.reading)});
  for (const double load_N : data.predicted_load_N) {
    Finding finding;
    finding.test = fmt::format("{} at {:g} N, calibrated from {:g} to {:g} N",
                               is_radius ? "radius" : "eccentricity (torque read as measured)",
                               load_N, data.fit_load_N[0], data.fit_load_N[1]);
    finding.unit = "m";
    finding.measured = law.value_m(load_N);
    finding.uncertainty = *finding.measured * exponent_uncertainty * std::log(load_N / middle_N);
    const ErrorBound error =
        error_bound(*find_pressure_model("fingertip_layer"), law.contact(layer, load_N));
    const double bound = error.known ? error.bound[is_radius ? 0 : 5] : 0;
    const double tolerated = exponent_uncertainty * std::log(load_N / middle_N) + bound;
    std::string deviations;
    const auto add = [&](const char* model, Role role, double value) {
      finding.model = model;
      finding.role = role;
      finding.predicted = {value, value * (1 - bound), value * (1 + bound)};
      const double deviation = value / *finding.measured - 1;
      finding.verdict = compared(finding);
      finding.reason = fmt::format("{:+.1f} % ± {:.1f} %.", 100 * deviation, 100 * tolerated);
      if (finding.verdict == Verdict::fails && std::abs(deviation) < tolerated + misfit_of_law) {
        finding.verdict = Verdict::cannot_tell;
        finding.reason += fmt::format(
            " A power law misses a layer's points from {:g} to {:g} N by up to {:.1f} % itself.",
            data.supposed_range_N[0], data.supposed_range_N[1], 100 * misfit_of_law);
      }
      deviations += fmt::format("{}{} {:+.1f} % ({})", deviations.empty() ? "" : ", ", model,
                                100 * deviation, words_of(finding.verdict));
      examined.findings.push_back(finding);
    };
    add("fingertip_layer", Role::theory, law.predicted_m(layer, load_N));
    // The others have one free number, which takes them through the middle of the points.
    for (const Limit& limit : {kHertz, kWinkler})
      add(limit.model, Role::rival,
          law.value_m(middle_N) * std::pow(load_N / middle_N, limit.exponent));
    if (load_N == data.predicted_load_N.back())
      examined.sentence += fmt::format(
          " Calibrated below {:g} N, {} at {:g} N is off the law, which is known to {:.1f} "
          "%, by: {}.",
          data.fit_load_N[1], is_radius ? "the radius" : "the torque", load_N, 100 * tolerated,
          deviations);
  }
}

/// Thickness and modulus where the layer has the law's radius and exponent at one load, the largest
/// of the fitted ones. A power law has one exponent, a layer's falls with the load: this is the
/// layer whose curve the law touches there.
void match_at_one_load(const Growth& growth, Reading reading, Sizes& sizes, Examined& examined) {
  const LawCalibration& data = *growth.calibration;
  const GrowthLaw& law = growth.laws.front();
  const double load_N = data.fit_load_N[1], moved = *growth.exponent_uncertainty;
  for (const double nu : growth.poisson_ratios) {
    const auto s = sizes.interval(law.exponent, moved, nu);
    if (!s) continue;
    const auto matched = [&](double size) {
      double a_m = law.coefficient_m * std::pow(load_N, law.exponent);
      const MatchedLayer found = match_layer(size, a_m, load_N, data.radius_m, nu);
      if (reading == Reading::radius) return found;
      // The exponent alone gives a/h, and a/h the factor between eccentricity and radius.
      a_m *= torque_arm_of_power_law(data.pressure_exponent_k) / found.torque_arm_over_a;
      return match_layer(size, a_m, load_N, data.radius_m, nu);
    };
    const MatchedLayer middle = matched(s->value), thick = matched(s->low > 0 ? s->low : s->value),
                       thin = matched(std::isfinite(s->high) ? s->high : s->value);
    const std::string condition = fmt::format("matched at {:g} N, nu {:g}", load_N, nu);
    const auto add = [&](const char* name, const char* unit, const Interval& value,
                         const std::string& remark = "") {
      examined.inferred.push_back({name, unit, condition + remark, value, words_of(reading)});
    };
    add("thickness", "m", spanned(middle.thickness_m, thick.thickness_m, thin.thickness_m));
    const Interval modulus_Pa =
        spanned(middle.youngs_modulus_Pa, thick.youngs_modulus_Pa, thin.youngs_modulus_Pa);
    add("youngs_modulus", "Pa", modulus_Pa);
    if (nu != growth.main_poisson_ratio) continue;
    const double E_Pa = modulus_Pa.value, low_Pa = modulus_Pa.low / kHardnessModulusFactor,
                 high_Pa = modulus_Pa.high * kHardnessModulusFactor;
    const std::string rough =
        fmt::format(", of that modulus to a factor of {:g}", kHardnessModulusFactor);
    add("shore_00", "",
        {shore_oo_of_modulus(E_Pa, nu), shore_oo_of_modulus(low_Pa, nu),
         shore_oo_of_modulus(high_Pa, nu)},
        rough);
    add("shore_a", "",
        {shore_a_of_modulus(E_Pa), shore_a_of_modulus(low_Pa), shore_a_of_modulus(high_Pa)},
        rough + fmt::format(", not trusted below {:g}", kLeastTrustedShoreA));
    examined.sentence += fmt::format(
        " {}: h = {:.3g} mm, E = {:.3g} kPa at nu {:g} ({:g} N; exponent ± {:g}: h {:+.0f} to "
        "{:+.0f} "
        "%).",
        reading == Reading::radius ? "If the coefficient is the radius" : "If it is from torques",
        middle.thickness_m * 1e3, E_Pa * 1e-3, nu, load_N, moved,
        100 * (thin.thickness_m / middle.thickness_m - 1),
        100 * (thick.thickness_m / middle.thickness_m - 1));
  }
}

/// Tests the cost of the assumed pressure: the published torque arm against the layer's at the
/// published radius.
void test_assumed_pressure(const Growth& growth, Sizes& sizes, Examined& examined) {
  const LawCalibration& data = *growth.calibration;
  const GrowthLaw& law = growth.laws.front();
  const double load_N = data.fit_load_N[1];
  const auto s = sizes.of(law.exponent, growth.main_poisson_ratio);
  if (!s) return;
  const double a_m = law.coefficient_m * std::pow(load_N, law.exponent);
  const MatchedLayer matched =
      match_layer(*s, a_m, load_N, data.radius_m, growth.main_poisson_ratio);
  Finding finding;
  finding.test = fmt::format("eccentricity at {:g} N (radius read as measured)", load_N);
  finding.model = "bonded_layer";
  finding.unit = "m";
  const double published_m = a_m * torque_arm_of_power_law(data.pressure_exponent_k);
  const double own_m = a_m * matched.torque_arm_over_a;
  finding.predicted = {own_m, own_m, own_m};
  finding.reason = fmt::format(
      "The publication's own, {:.3g} mm, is {:+.0f} % from the layer's; it follows from the "
      "assumed "
      "k = {:g} and is no measurement.",
      published_m * 1e3, 100 * (published_m / own_m - 1), data.pressure_exponent_k);
  finding.verdict = compared(finding);
  examined.findings.push_back(finding);
}

/// In the second interpretation the eccentricity has the law's exponent. This gives another a/h
/// than taking the exponent for the radius's, which match_at_one_load does in both interpretations.
void match_by_eccentricity(const Growth& growth, Examined& examined) {
  const LawCalibration& data = *growth.calibration;
  const GrowthLaw& law = growth.laws.front();
  const double load_N = data.fit_load_N[1], nu = growth.main_poisson_ratio;
  const double arm_m = torque_arm_of_power_law(data.pressure_exponent_k) * law.coefficient_m *
                       std::pow(load_N, law.exponent);
  const auto matched = [&](double exponent) -> std::optional<MatchedLayer> {
    const auto s = layer_size_of_exponent(exponent, nu, Growing::torque_arm);
    if (!s) return std::nullopt;
    // Any radius would do here, as the ratio of arm and radius depends on a/h alone.
    const double ratio = match_layer(*s, 1, load_N, data.radius_m, nu).torque_arm_over_a;
    return match_layer(*s, arm_m / ratio, load_N, data.radius_m, nu);
  };
  const auto middle = matched(law.exponent);
  if (!middle) return;
  const MatchedLayer thick = matched(law.exponent + *growth.exponent_uncertainty).value_or(*middle),
                     thin = matched(law.exponent - *growth.exponent_uncertainty).value_or(*middle);
  const std::string condition =
      fmt::format("matched at {:g} N by the eccentricity's own exponent, nu {:g}", load_N, nu);
  examined.inferred.push_back({"thickness", "m", condition,
                               spanned(middle->thickness_m, thick.thickness_m, thin.thickness_m),
                               words_of(Reading::torque)});
  examined.inferred.push_back(
      {"youngs_modulus", "Pa", condition,
       spanned(middle->youngs_modulus_Pa, thick.youngs_modulus_Pa, thin.youngs_modulus_Pa),
       words_of(Reading::torque)});
  examined.sentence += fmt::format(
      " (By the torque's own exponent, which is lower than the radius's, h = {:.3g} mm, E = {:.3g} "
      "kPa.)",
      middle->thickness_m * 1e3, middle->youngs_modulus_Pa * 1e-3);
}

}  // namespace

void examine_growth(const Growth& growth, Examined& examined) {
  Sizes sizes;
  test_exponents(growth, sizes, examined);
  if (!growth.calibration) return;
  for (const Reading reading : {Reading::radius, Reading::torque}) {
    match_at_one_load(growth, reading, sizes, examined);
    predict_above({*growth.calibration, reading, growth.laws.front(), growth.main_poisson_ratio},
                  *growth.exponent_uncertainty, examined);
  }
  match_by_eccentricity(growth, examined);
  test_assumed_pressure(growth, sizes, examined);
}

}  // namespace softfinger::experiments
