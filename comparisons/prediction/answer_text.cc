#include "comparisons/prediction/answer_text.h"

#include <fmt/format.h>

#include <cmath>

#include "softfinger/input/constants.h"

namespace softfinger::prediction {
namespace {

constexpr double kDegreesPerRadian = 180 / kPi;

}  // namespace

std::vector<std::string> power_law_remarks(const input::Case& contact_case) {
  const auto& fit = contact_case.power_law_fit;
  if (!fit) return {};
  std::vector<std::string> remarks = {fmt::format(
      "power law fitted to the data: a = {:.4g} mm (P/N)^{:.4g} (exponent ± {:.2g}), radii scatter "
      "by {:.2g} %",
      fit->law.radius_coefficient * 1e3, fit->law.radius_exponent, fit->exponent_std,
      100 * fit->residual_rms)};
  for (const double load_N : contact_case.loads_N)
    if (load_N < fit->least_load_N || load_N > fit->largest_load_N)
      remarks.push_back(
          fmt::format("{:g} N lies outside the data, {:g} to {:g} N: there power_law extrapolates",
                      load_N, fit->least_load_N, fit->largest_load_N));
  return remarks;
}

std::string millimetres(double length_m) {
  return std::isfinite(length_m) ? fmt::format("{:.5g} mm", length_m * 1e3) : "flat";
}

std::string describe(const ShearLaw& law) {
  const std::string friction = fmt::format("friction {:.6g}", law.friction_coefficient);
  const std::string strength = fmt::format("{:.6g} kPa", law.shear_strength_Pa * 1e-3);
  switch (law.kind) {
    case ShearLaw::Kind::shear_strength:
      return "shear strength " + strength;
    case ShearLaw::Kind::limited:
      return friction + " up to a shear strength of " + strength;
    case ShearLaw::Kind::adhesive_shear:
      return friction + " and a shear strength of " + strength + " in addition";
    default:
      return friction;
  }
}

std::string describe(const input::Case& contact_case) {
  const auto layer_text = [](const ElasticLayer& layer) {
    return fmt::format("{:.6g} mm, E {:.6g} kPa, nu {:.6g}", layer.thickness_m * 1e3,
                       layer.youngs_modulus_Pa * 1e-3, layer.poisson_ratio);
  };
  const Relaxation& relaxation = contact_case.times.relaxation;
  const std::string relaxed = relaxation.is_elastic()
                                  ? ""
                                  : fmt::format(" (at once; {:.4g} kPa when held for long)",
                                                contact_case.layer.youngs_modulus_Pa * 1e-3 *
                                                    relaxation.long_time_modulus());
  std::string text =
      fmt::format("{}: {} {}", contact_case.id,
                  contact_case.layer_on_object ? "rigid finger, object's layer" : "layer",
                  layer_text(contact_case.layer) + relaxed);
  for (std::size_t i = 0; i < contact_case.sublayers.size(); ++i) {
    const input::Sublayer& sublayer = contact_case.sublayers[i];
    text += (i == 0 ? " on average of " : " over ") +
            (sublayer.name.empty() ? "" : sublayer.name + " ") + layer_text(sublayer.layer);
  }
  if (contact_case.object_layer.thickness_m > 0)
    text += "; object's layer " + layer_text(contact_case.object_layer) + "; ";
  else
    text += ", ";
  return text + describe(contact_case.shear_law);
}

std::string describe(const LocalGeometry& geometry) {
  if (!geometry.no_ellipse.empty())
    return "the bodies as they are, no relative radii: " + geometry.no_ellipse;
  std::string text =
      fmt::format("R' {}, R'' {}, long axis at {:.4g}°", millimetres(geometry.radii.major_m),
                  millimetres(geometry.radii.minor_m),
                  geometry.radii.axis_rad * kDegreesPerRadian + 0.0);  // -0 is 0
  if (geometry.patch) {
    text += fmt::format("; fitted over {:.3g} mm² for a contact of {:.3g} mm² ({})",
                        geometry.patch->region_area_m2 * 1e6,
                        geometry.patch->predicted_area_m2 * 1e6, geometry.patch_model);
    if (!geometry.patch->remark.empty()) text += "; " + geometry.patch->remark;
  }
  return text;
}

namespace {

/// "1.8%", one word, of the error against the finger, what the fit leaves open included.
std::string bound_of(const ModelAnswer& answer, Quantity quantity) {
  const double total = answer.assessment ? answer.assessment->total(quantity) : NAN;
  if (!std::isfinite(total)) return "?";
  return fmt::format(total < 0.0995 ? "{:.1f}%" : "{:.0f}%", 100 * total);
}

/// "  hertz: of area, torque the model itself costs +27 %, +20 %, strain -2.2 %, -1.6 %, ..."
std::string causes_in_words(const ModelAnswer& answer, const std::string& name) {
  // The causes' parts are known for Coulomb's torque only.
  if (!answer.assessment || !answer.assessment->bound ||
      answer.shear_law.kind != ShearLaw::Kind::coulomb)
    return "";
  constexpr std::array<const char*, kErrorCauses> words = {"the model itself", "strain", "slope",
                                                           "the layer's curvature"};
  std::string text;
  for (std::size_t cause = 0; cause < words.size(); ++cause) {
    const QuantityErrors& errors = answer.assessment->causes[cause];
    const auto percent = [&](Quantity quantity) {
      const double value = 100 * errors[std::size_t(quantity)];
      return fmt::format(std::abs(value) < 9.95 ? "{:+.1f} %" : "{:+.0f} %", value);
    };
    text += fmt::format("{} {} {}, {}", text.empty() ? "" : ";", words[cause],
                        percent(Quantity::area), percent(Quantity::max_torque));
  }
  return fmt::format("  {}: of area and torque cost{}\n", name, text);
}

/// "  hertz: the mesh leaves a ± 0.1 mm, ...", the same that `geometry_error` is; of bodies without
/// a mesh nothing.
std::string left_open_in_words(const ModelAnswer& answer, const std::string& name,
                               TorqueRule rule) {
  if (!answer.deviations || !answer.assessment || !answer.assessment->geometry) return "";
  const QuantityErrors& open = *answer.assessment->geometry;
  const auto part = [&](Quantity quantity) { return open[std::size_t(quantity)]; };
  if (!std::isfinite(part(Quantity::a) + part(Quantity::b))) return "";
  const Prediction& p = answer.prediction;
  return fmt::format(
      "  {}: the mesh leaves a ± {:.2g} mm, b ± {:.2g} mm, torque ± {:.2g} mN·m (95 %: scatter of "
      "the fit, choice of its region, facets)\n",
      name, 1e3 * p.a_m * part(Quantity::a), 1e3 * p.b_m * part(Quantity::b),
      1e3 * answer.friction_ellipsoid(rule).max_torque_Nm() * part(Quantity::max_torque));
}

}  // namespace

std::string table(const std::vector<ModelAnswer>& answers, TorqueRule rule) {
  std::string text =
      fmt::format("  {:<19} {:>9} {:>9} {:>9} {:>10} {:>10} {:>12} {:>9} {:>6} {:>8} {:>6} {:>9}\n",
                  "model", "a mm", "b mm", "d mm", "peak kPa", "area mm²", "torque mN·m", "e_n mm",
                  "area ±", "torque ±", "usable", "cost ns");
  std::string remarks;
  for (const ModelAnswer& answer : answers) {
    const Prediction& p = answer.pressed();
    const std::string name(answer.model->card().name);
    if (p.has_answer) {
      const FrictionEllipsoid ellipsoid = answer.friction_ellipsoid(rule);
      if (answer.shear_law.kind != ShearLaw::Kind::coulomb)
        remarks +=
            fmt::format("  {}: largest force {:.4g} N, e_n = largest torque / largest force\n",
                        name, ellipsoid.max_force_N);
      text += fmt::format(
          "  {:<19} {:>9.4g} {:>9.4g} {:>9.4g} {:>10.4g} {:>10.4g} {:>12.4g} {:>9.4g} {:>6} {:>8} "
          "{:>6} {:>9.0f}\n",
          name, p.a_m * 1e3, p.b_m * 1e3, p.indentation_m * 1e3, p.peak_pressure_Pa * 1e-3,
          p.area_m2() * 1e6, ellipsoid.max_torque_Nm() * 1e3, ellipsoid.eccentricity_m * 1e3,
          bound_of(answer, Quantity::area), bound_of(answer, Quantity::max_torque),
          answer.assessment && answer.assessment->usable ? "yes" : "no", answer.cost_ns);
    } else {
      text += fmt::format("  {:<19} {:>9}\n", name, "no answer");
    }
    for (const ValidityCheck& check : answer.prediction.validity)
      if (!check.holds())
        remarks += fmt::format("  {}: {} ({} = {:.3g}, holds {} {:.3g})\n", name, check.message,
                               check.check, check.value, check.holds_below ? "below" : "above",
                               check.limit);
    if (answer.rubbed)
      remarks += fmt::format(
          "  {}: pressed with friction, {}; without it a {:.4g} mm, d {:.4g} mm. The largest "
          "torque "
          "is the same: at full slip friction points along the slip\n",
          name, answer.pressing == PressingFriction::stuck ? "all of it stuck" : "Coulomb's law",
          1e3 * answer.prediction.a_m, 1e3 * answer.prediction.indentation_m);
    remarks += causes_in_words(answer, name);
    remarks += left_open_in_words(answer, name, rule);
  }
  for (const ModelAnswer& answer : answers)
    if (answer.sampled) {
      const SampledGapResult& sampled = *answer.sampled;
      remarks += fmt::format(
          "  {}: gap sampled from the meshes (all other models: the fitted quadric); contact of "
          "{:.4g} mm², long axis at {:.4g}°, centre at ({:.2g}, {:.2g}) mm, edge within {:.2g} % "
          "of "
          "the ellipse; rounding the facets changes a, b, d, torque by {:.2g}, {:.2g}, {:.2g}, "
          "{:.2g} %, the peak by {:.2g} %\n",
          answer.model->card().name, sampled.region_area_m2 * 1e6,
          answer.problem.radii.axis_rad * kDegreesPerRadian, sampled.centre_m.x() * 1e3,
          sampled.centre_m.y() * 1e3, sampled.edge_deviation * 100,
          sampled.changes_by_rounding.a * 100, sampled.changes_by_rounding.b * 100,
          sampled.changes_by_rounding.indentation * 100, sampled.changes_by_rounding.torque * 100,
          sampled.changes_by_rounding.peak * 100);
    }
  return text + remarks;
}

}  // namespace softfinger::prediction
