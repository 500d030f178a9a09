#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "comparisons/calibration/case_calibration.h"
#include "comparisons/input/toml_reader.h"
#include "comparisons/system/program_paths.h"
#include "softfinger/input/errors.h"

namespace softfinger::calibration {
namespace fs = std::filesystem;
namespace {

/// Replacements in the text of a file, so that everything else, comments too, stays as typed.
class Edits {
 public:
  explicit Edits(const std::string& text) : text_(text) {
    starts_.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i)
      if (text[i] == '\n') starts_.push_back(i + 1);
  }

  /// The number as people write it: six digits are more than any measurement has.
  void set(const toml::node& node, double value) { add(node, fmt::format("{:.6g}", value)); }
  void set(const toml::node& node, const std::string& word) {
    std::ostringstream quoted;
    quoted << toml::value<std::string>(word);
    add(node, quoted.str());
  }

  std::string result() {
    std::sort(edits_.begin(), edits_.end(),
              [](const Edit& one, const Edit& other) { return one.from > other.from; });
    std::string text = text_;
    for (const Edit& edit : edits_) text.replace(edit.from, edit.to - edit.from, edit.word);
    return text;
  }

 private:
  struct Edit {
    std::size_t from, to;
    std::string word;
  };

  void add(const toml::node& node, const std::string& word) {
    edits_.push_back({place(node.source().begin), place(node.source().end), word});
  }

  /// The parser counts columns in characters, from 1.
  std::size_t place(const toml::source_position& position) const {
    std::size_t at = starts_[position.line - 1];
    for (std::size_t column = 1; column < position.column && at < text_.size(); ++column) {
      ++at;
      while (at < text_.size() && (static_cast<unsigned char>(text_[at]) & 0xc0) == 0x80) ++at;
    }
    return at;
  }

  const std::string& text_;
  std::vector<std::size_t> starts_;  ///< of the lines
  std::vector<Edit> edits_;
};

void scale_radii(Edits& edits, const toml::table& geometry, double factor) {
  const auto scale = [&](const toml::node* node) {
    if (!node) return;
    if (const toml::array* list = node->as_array())
      for (const toml::node& entry : *list) edits.set(entry, *entry.value<double>() * factor);
    else
      edits.set(*node, *node->value<double>() * factor);
  };
  scale(geometry.get("relative_radii_mm"));
  for (const char* name : {"finger", "object"})
    if (const toml::table* body = geometry[name].as_table()) {
      scale(body->get("radii_mm"));
      scale(body->get("sphere_radius_mm"));
    }
}

/// Files are looked up beside the case: from another folder they need their whole path, except for
/// built-in ones.
void make_absolute(Edits& edits, const toml::table& geometry, const input::Case& contact_case,
                   const fs::path& folder) {
  const auto* pair = std::get_if<input::BodyPair>(&contact_case.geometry);
  if (!pair) return;
  const auto set_path = [&](const toml::node& node, const fs::path& file) {
    std::error_code error;
    const auto typed = node.value<std::string>();
    if (!fs::equivalent(system::find_mesh_file(*typed, folder), file, error))
      edits.set(node, fs::absolute(file).lexically_normal().string());
  };
  const auto set = [&](const char* name, const input::CaseBody& body) {
    const auto* mesh = std::get_if<input::MeshBody>(&body);
    const toml::table* table = geometry[name].as_table();
    if (!mesh || !table) return;
    set_path(*table->get("mesh"), mesh->path);
    if (const toml::table* core = (*table)["core"].as_table(); core && !mesh->core.empty())
      set_path(*core->get("mesh"), mesh->core);
  };
  set("finger", pair->finger);
  set("object", pair->object);
}

std::string header_line(const ParameterEstimate& estimate) {
  const ParameterRange& range = range_of(estimate.parameter);
  const double factor = range.unit == "m" || range.unit == "m/N" ? 1e3
                        : range.unit == "Pa"                     ? 1e-3
                                                                 : 1;
  const char* const unit = range.unit == "m"     ? " mm"
                           : range.unit == "m/N" ? " mm/N"
                           : range.unit == "Pa"  ? " kPa"
                                                 : "";
  return fmt::format("#   {}: {:.4g}{} (95 %: {:.4g} to {:.4g}{})\n", range.name,
                     estimate.value * factor, unit, estimate.low * factor, estimate.high * factor,
                     estimate.is_determined() ? "" : ", not determined");
}

void write(Edits& edits, Parameter parameter, double value, const toml::table& layer,
           const toml::table& contact) {
  switch (parameter) {
    case Parameter::youngs_modulus:
      return edits.set(*layer.get("youngs_modulus_kPa"), value * 1e-3);
    case Parameter::thickness:
      return edits.set(*layer.get("thickness_mm"), value * 1e3);
    case Parameter::poisson_ratio:
      return edits.set(*layer.get("poisson_ratio"), value);
    case Parameter::friction_coefficient:
      return edits.set(*contact.get("friction_coefficient"), value);
    case Parameter::shear_strength:
      return edits.set(*contact.get("shear_strength_kPa"), value * 1e-3);
    default:
      return;
  }
}

}  // namespace

std::string fitted_case_text(const CaseCalibration& calibration, const fs::path& path) {
  const input::Case& fitted = calibration.fitted;
  const toml::table root = input::parse_toml(fitted.text, fitted.file.string());
  const toml::table& geometry = *root["geometry"].as_table();
  const toml::table& contact = *root["contact"].as_table();
  // [[layer]] with a single entry is one layer, too.
  const auto named = root[fitted.layer_on_object ? "object_layer" : "layer"];
  const toml::table& layer =
      named.is_table() ? *named.as_table() : *named.as_array()->get(0)->as_table();
  Edits edits(fitted.text);
  for (const ParameterEstimate& estimate : calibration.found.parameters)
    write(edits, estimate.parameter, estimate.value, layer, contact);
  for (const auto& [parameter, value] : calibration.fixed)
    write(edits, parameter, value, layer, contact);
  const RelativeRadii& radii = calibration.problem.measurements.contacts[0].radii;
  const double factor = calibration.found.values[index_of(Parameter::radius)] /
                        (std::sqrt(radii.major_m) * std::sqrt(radii.minor_m));
  if (std::abs(factor - 1) > 1e-9) scale_radii(edits, geometry, factor);
  if (fs::absolute(path).lexically_normal().parent_path() !=
      fs::absolute(fitted.file).lexically_normal().parent_path())
    make_absolute(edits, geometry, fitted, path.parent_path());
  const std::string suffix = "_fitted";
  if (const toml::node* id = root.get("id"); id && input::is_id(fitted.id + suffix))
    edits.set(*id, fitted.id + suffix);

  std::string text = fmt::format("# Fitted by softfinger calibrate with {}:\n",
                                 calibration.problem.model->card().name);
  for (const ParameterEstimate& estimate : calibration.found.parameters)
    text += header_line(estimate);
  text += edits.result();
  input::parse_case(text, path);
  return text;
}

}  // namespace softfinger::calibration
