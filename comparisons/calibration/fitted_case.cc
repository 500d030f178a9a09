#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "comparisons/calibration/case_calibration.h"
#include "comparisons/input/toml_reader.h"
#include "softfinger/input/errors.h"

namespace softfinger::calibration {
namespace fs = std::filesystem;
namespace {

/// As people write it: six digits are more than any measurement has.
double written(double value) { return std::stod(fmt::format("{:.6g}", value)); }

void scale(toml::node* node, double factor) {
  if (!node) return;
  if (toml::array* list = node->as_array()) {
    for (std::size_t i = 0; i < list->size(); ++i)
      list->replace(list->cbegin() + std::ptrdiff_t(i),
                    written(*(*list)[i].value<double>() * factor));
  }
}

void scale_radii(toml::table& geometry, double factor) {
  scale(geometry.get("relative_radii_mm"), factor);
  for (const char* name : {"finger", "object"}) {
    toml::table* body = geometry[name].as_table();
    if (!body) continue;
    scale(body->get("radii_mm"), factor);
    if (const auto sphere = (*body)["sphere_radius_mm"].value<double>())
      body->insert_or_assign("sphere_radius_mm", written(*sphere * factor));
  }
}

/// Files are looked up beside the case: from another folder they need their whole path.
void make_absolute(toml::table& geometry, const input::Case& contact_case) {
  const auto* pair = std::get_if<input::BodyPair>(&contact_case.geometry);
  if (!pair) return;
  const auto set = [&](const char* name, const input::CaseBody& body) {
    const auto* mesh = std::get_if<input::MeshBody>(&body);
    toml::table* table = geometry[name].as_table();
    if (!mesh || !table) return;
    table->insert_or_assign("mesh", fs::absolute(mesh->path).lexically_normal().string());
    if (toml::table* core = (*table)["core"].as_table(); core && !mesh->core.empty())
      core->insert_or_assign("mesh", fs::absolute(mesh->core).lexically_normal().string());
  };
  set("finger", pair->finger);
  set("object", pair->object);
}

std::string interval_text(const ParameterEstimate& estimate) {
  const ParameterRange& range = range_of(estimate.parameter);
  const double factor = range.unit == "m" ? 1e3 : range.unit == "Pa" ? 1e-3 : 1;
  const char* const unit = range.unit == "m" ? " mm" : range.unit == "Pa" ? " kPa" : "";
  return fmt::format("#   {}: {:.4g}{} (95 %: {:.4g} to {:.4g}{})\n", range.name,
                     estimate.value * factor, unit, estimate.low * factor, estimate.high * factor,
                     estimate.is_determined() ? "" : ", not determined");
}

}  // namespace

std::string fitted_case_text(const CaseCalibration& calibration, const fs::path& path) {
  const input::Case& fitted = calibration.fitted;
  const ParameterValues& values = calibration.found.values;
  toml::table root = input::parse_toml(fitted.text, fitted.file.string());
  toml::table& geometry = *root["geometry"].as_table();
  const auto of = [&](Parameter parameter) { return values[index_of(parameter)]; };
  const auto set = [&](const char* table, const char* key, double value) {
    root[table].as_table()->insert_or_assign(key, written(value));
  };
  // [[layer]] with a single entry is one layer, too.
  const char* const layer = fitted.layer_on_object ? "object_layer" : "layer";
  toml::table* target = root[layer].as_table();
  if (!target) target = root[layer].as_array()->get(0)->as_table();
  target->insert_or_assign("thickness_mm", written(of(Parameter::thickness) * 1e3));
  target->insert_or_assign("youngs_modulus_kPa", written(of(Parameter::youngs_modulus) * 1e-3));
  target->insert_or_assign("poisson_ratio", written(of(Parameter::poisson_ratio)));
  if (fitted.shear_law.has_friction_coefficient())
    set("contact", "friction_coefficient", of(Parameter::friction_coefficient));
  if (fitted.shear_law.has_shear_strength())
    set("contact", "shear_strength_kPa", of(Parameter::shear_strength) * 1e-3);
  const RelativeRadii& radii = calibration.problem.measurements.contacts[0].radii;
  const double factor =
      of(Parameter::radius) / (std::sqrt(radii.major_m) * std::sqrt(radii.minor_m));
  if (std::abs(factor - 1) > 1e-9) scale_radii(geometry, factor);
  if (fs::absolute(path).lexically_normal().parent_path() !=
      fs::absolute(fitted.file).lexically_normal().parent_path())
    make_absolute(geometry, fitted);
  const std::string suffix = "_fitted";
  if (fitted.id.size() + suffix.size() <= input::kLongestName)
    root.insert_or_assign("id", fitted.id + suffix);

  std::string text = fmt::format("# Fitted by softfinger calibrate with {}:\n",
                                 calibration.problem.model->card().name);
  for (const ParameterEstimate& estimate : calibration.found.parameters)
    text += interval_text(estimate);
  std::ostringstream written_table;
  written_table << root;
  text += written_table.str() + "\n";
  input::parse_case(text, path);
  return text;
}

}  // namespace softfinger::calibration
