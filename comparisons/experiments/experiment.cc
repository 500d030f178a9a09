#include "comparisons/experiments/experiment.h"

#include <algorithm>
#include <functional>

#include "comparisons/input/toml_reader.h"
#include "comparisons/system/files.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::experiments {
namespace {

using input::kMillimetre;
using input::TomlReader;

constexpr std::size_t kMostEntries = 100;
constexpr std::size_t kMostLaws = 10;  ///< and Poisson's ratios: each pair takes some 20 ms

/// A number of a range, ends included.
double number_in(const TomlReader& reader, const toml::table& table, const std::string& name,
                 const char* key, double least, double largest, const std::string& allowed) {
  const toml::node& node = reader.required(table, name, key);
  const double value = reader.number(node, key, allowed);
  if (value < least || value > largest) reader.refuse(node, key, allowed);
  return value;
}

// No finger, gel or load is beyond these; they keep the calibration within what it searches.
double length_m(const TomlReader& reader, const toml::table& table, const std::string& name,
                const char* key) {
  return kMillimetre *
         number_in(reader, table, name, key, 1e-3, 1e4, "a number from 0.001 to 10000, in mm");
}

double load_N(const TomlReader& reader, const toml::table& table, const std::string& name,
              const char* key) {
  return number_in(reader, table, name, key, 1e-6, 1e6, "a number from 1e-6 to 1e6, in N");
}

double modulus_Pa(const TomlReader& reader, const toml::table& table, const std::string& name) {
  return 1e3 * number_in(reader, table, name, "youngs_modulus_kPa", 0.1, 1e8,
                         "a number from 0.1 to 1e8, in kPa");
}

double poisson_ratio(const TomlReader& reader, const toml::table& table, const std::string& name,
                     const char* key = "poisson_ratio") {
  return number_in(reader, table, name, key, 0, 0.5, "a number from 0 to 0.5");
}

/// Two loads, the smaller first.
std::array<double, 2> load_range(const TomlReader& reader, const toml::table& table,
                                 const std::string& name, const char* key) {
  const std::string allowed = "[least, largest], different numbers from 1e-6 to 1e6, in N";
  const toml::node& node = reader.required(table, name, key);
  const std::vector<double> loads_N = reader.numbers(node, key, 2, allowed);
  if (loads_N[0] < 1e-6 || loads_N[1] > 1e6 || loads_N[0] >= loads_N[1])
    reader.refuse(node, key, allowed);
  return {loads_N[0], loads_N[1]};
}

LawCalibration law_calibration(const TomlReader& reader, const toml::table& table) {
  const std::string name = "[growth.calibration]";
  reader.check_keys(table, name,
                    {"radius_mm", "fit_load_N", "predicted_load_N", "supposed_load_range_N",
                     "pressure_exponent_k"});
  LawCalibration found;
  found.radius_m = length_m(reader, table, name, "radius_mm");
  found.fit_load_N = load_range(reader, table, name, "fit_load_N");
  found.supposed_range_N = load_range(reader, table, name, "supposed_load_range_N");
  const std::string above = "loads in N above those of fit_load_N, to 1e6";
  const toml::node& loads = reader.required(table, name, "predicted_load_N");
  for (const toml::node& node : reader.list(loads, "predicted_load_N", kMostEntries, above)) {
    found.predicted_load_N.push_back(reader.number(node, "predicted_load_N", above));
    if (found.predicted_load_N.back() <= found.fit_load_N[1] || found.predicted_load_N.back() > 1e6)
      reader.refuse(node, "predicted_load_N", above);
  }
  if (found.predicted_load_N.empty()) reader.refuse(loads, "predicted_load_N", above);
  found.pressure_exponent_k =
      number_in(reader, table, name, "pressure_exponent_k", 1, 1000, "a number from 1 to 1000");
  return found;
}

Growth growth(const TomlReader& reader, const toml::table& table) {
  const std::string name = "[growth]";
  reader.check_keys(table, name,
                    {"laws", "supposed_exponent_uncertainty", "poisson_ratio", "main_poisson_ratio",
                     "calibration"});
  Growth found;
  const std::string laws_allowed = "[{ coefficient_mm, exponent }, ...]";
  const toml::node& laws = reader.required(table, name, "laws");
  for (const toml::node& node : reader.list(laws, "laws", kMostLaws, laws_allowed)) {
    const toml::table* law = node.as_table();
    if (!law) reader.refuse(node, "laws", laws_allowed);
    reader.check_keys(*law, "laws", {"coefficient_mm", "exponent"});
    found.laws.push_back(
        {length_m(reader, *law, "laws", "coefficient_mm"),
         number_in(reader, *law, "laws", "exponent", 0.01, 0.99, "a number from 0.01 to 0.99")});
  }
  if (found.laws.empty()) reader.refuse(laws, "laws", laws_allowed);
  if (table.contains("supposed_exponent_uncertainty"))
    found.exponent_uncertainty = number_in(reader, table, name, "supposed_exponent_uncertainty",
                                           1e-6, 0.5, "a number from 1e-6 to 0.5");
  const std::string ratios_allowed = "[nu, ...], numbers from 0 to 0.5";
  const toml::node& ratios = reader.required(table, name, "poisson_ratio");
  for (const toml::node& node : reader.list(ratios, "poisson_ratio", kMostLaws, ratios_allowed)) {
    const double value = reader.number(node, "poisson_ratio", ratios_allowed);
    if (value < 0 || value > 0.5) reader.refuse(node, "poisson_ratio", ratios_allowed);
    found.poisson_ratios.push_back(value);
  }
  found.main_poisson_ratio = poisson_ratio(reader, table, name, "main_poisson_ratio");
  if (std::find(found.poisson_ratios.begin(), found.poisson_ratios.end(),
                found.main_poisson_ratio) == found.poisson_ratios.end())
    reader.refuse(*table.get("main_poisson_ratio"), "main_poisson_ratio", "one of poisson_ratio");
  if (const toml::node* calibration = table.get("calibration")) {
    if (!calibration->is_table()) reader.refuse(*calibration, "calibration", "a table");
    if (found.laws.size() != 1 || !found.exponent_uncertainty)
      reader.say(*calibration,
                 "[growth.calibration] needs one law and its supposed_exponent_uncertainty");
    found.calibration = law_calibration(reader, *calibration->as_table());
  }
  return found;
}

Indentation indentation(const TomlReader& reader, const toml::table& table) {
  const std::string name = "[indentation]";
  reader.check_keys(table, name,
                    {"sphere_radius_mm", "load_N", "indentation_mm", "indentation_std_mm",
                     "includes_other_compliance", "thickness_mm", "youngs_modulus_kPa",
                     "youngs_modulus_factor", "poisson_ratio"});
  Indentation found;
  found.sphere_radius_m = length_m(reader, table, name, "sphere_radius_mm");
  found.load_N = load_N(reader, table, name, "load_N");
  found.indentation_m = length_m(reader, table, name, "indentation_mm");
  found.indentation_std_m = length_m(reader, table, name, "indentation_std_mm");
  found.thickness_m = length_m(reader, table, name, "thickness_mm");
  found.youngs_modulus_Pa = modulus_Pa(reader, table, name);
  found.youngs_modulus_factor =
      number_in(reader, table, name, "youngs_modulus_factor", 1, 100, "a number from 1 to 100");
  found.poisson_ratio = poisson_ratio(reader, table, name);
  found.includes_other_compliance = reader.boolean(
      reader.required(table, name, "includes_other_compliance"), "includes_other_compliance");
  return found;
}

Hardness hardness(const TomlReader& reader, const toml::table& table) {
  const std::string name = "[hardness]";
  reader.check_keys(table, name,
                    {"scale", "value", "uncertainty", "youngs_modulus_kPa", "poisson_ratio"});
  Hardness found;
  found.scale = reader.choice(reader.required(table, name, "scale"), "scale", {"A", "00"}) == "A"
                    ? Hardness::Scale::a
                    : Hardness::Scale::oo;
  const std::string allowed = "a number from 0 to 100";
  found.value = number_in(reader, table, name, "value", 0, 100, allowed);
  found.uncertainty = number_in(reader, table, name, "uncertainty", 0, 100, allowed);
  found.youngs_modulus_Pa = modulus_Pa(reader, table, name);
  found.poisson_ratio = poisson_ratio(reader, table, name);
  return found;
}

Repeated repeated(const TomlReader& reader, const toml::table& table) {
  const std::string name = "[repeated]";
  reader.check_keys(table, name, {"quantity", "pairs"});
  reader.choice(reader.required(table, name, "quantity"), "quantity", {"torque"});
  const std::string allowed = "[{ object, eccentricity_mm = [left, right] }, ...]";
  Repeated found;
  const toml::node& pairs = reader.required(table, name, "pairs");
  for (const toml::node& node : reader.list(pairs, "pairs", kMostEntries, allowed)) {
    const toml::table* pair = node.as_table();
    if (!pair) reader.refuse(node, "pairs", allowed);
    reader.check_keys(*pair, "pairs", {"object", "eccentricity_mm", "outlier"});
    Repeated::Pair& read = found.pairs.emplace_back();
    read.object = reader.name(reader.required(*pair, "pairs", "object"), "object");
    const toml::node& numbers = reader.required(*pair, "pairs", "eccentricity_mm");
    const std::vector<double> values =
        reader.numbers(numbers, "eccentricity_mm", 2, "two numbers > 0");
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!(values[i] > 0)) reader.refuse(numbers, "eccentricity_mm", "two numbers > 0");
      read.eccentricity_m[i] = values[i] * kMillimetre;
    }
    if (const toml::node* outlier = pair->get("outlier"))
      read.outlier = reader.boolean(*outlier, "outlier");
  }
  if (std::all_of(found.pairs.begin(), found.pairs.end(),
                  [](const Repeated::Pair& pair) { return pair.outlier; }))
    reader.refuse(pairs, "pairs", allowed + ", one of them no outlier");
  return found;
}

Observation observation(const TomlReader& reader, const toml::table& table) {
  const std::string name = "[observation]";
  reader.check_keys(table, name, {"quantity", "value", "supposed_uncertainty"});
  const std::vector<std::string> names = {"pressure_exponent", "torque_exponent",
                                          "shear_stress_exponent", "area_change_under_shear"};
  const std::string chosen =
      reader.choice(reader.required(table, name, "quantity"), "quantity", names);
  Observation found;
  found.quantity =
      Observation::Quantity(std::find(names.begin(), names.end(), chosen) - names.begin());
  found.value = number_in(reader, table, name, "value", -100, 100, "a number from -100 to 100");
  found.uncertainty =
      number_in(reader, table, name, "supposed_uncertainty", 0, 100, "a number from 0 to 100");
  return found;
}

/// At least `least` numbers of a range.
std::vector<double> number_list(const TomlReader& reader, const toml::table& table,
                                const std::string& name, const char* key, std::size_t least,
                                double lowest, double highest, const std::string& allowed) {
  const toml::node& node = reader.required(table, name, key);
  std::vector<double> values;
  for (const toml::node& entry : reader.list(node, key, kMostEntries, allowed)) {
    values.push_back(reader.number(entry, key, allowed));
    if (values.back() < lowest || values.back() > highest) reader.refuse(entry, key, allowed);
  }
  if (values.size() < least) reader.refuse(node, key, allowed);
  return values;
}

PressCurves press_curves(const TomlReader& reader, const toml::table& table) {
  const std::string name = "[press_curves]";
  reader.check_keys(table, name,
                    {"step_mm", "sphere_radius_mm", "thickness_mm", "poisson_ratio", "curves"});
  PressCurves found;
  found.step_m = length_m(reader, table, name, "step_mm");
  found.sphere_radius_m = length_m(reader, table, name, "sphere_radius_mm");
  found.thickness_m = length_m(reader, table, name, "thickness_mm");
  found.poisson_ratio = poisson_ratio(reader, table, name);
  const std::string allowed = "[{ code, description, hollow, loading_N, unloading_N }, ...]";
  const std::string forces = "three numbers or more from -1e4 to 1e4, one of them > 0, in N";
  const toml::node& curves = reader.required(table, name, "curves");
  for (const toml::node& node : reader.list(curves, "curves", kMostEntries, allowed)) {
    const toml::table* row = node.as_table();
    if (!row) reader.refuse(node, "curves", allowed);
    reader.check_keys(*row, "curves",
                      {"code", "description", "hollow", "loading_N", "unloading_N"});
    PressCurves::Curve& curve = found.curves.emplace_back();
    curve.code = reader.text(reader.required(*row, "curves", "code"), "code");
    curve.description = reader.text(reader.required(*row, "curves", "description"), "description");
    curve.hollow = reader.boolean(reader.required(*row, "curves", "hollow"), "hollow");
    curve.loading_N = number_list(reader, *row, "curves", "loading_N", 3, -1e4, 1e4, forces);
    curve.unloading_N = number_list(reader, *row, "curves", "unloading_N", 3, -1e4, 1e4, forces);
    if (!(*std::max_element(curve.loading_N.begin(), curve.loading_N.end()) > 0))
      reader.refuse(*row->get("loading_N"), "loading_N", forces);
  }
  if (found.curves.empty()) reader.refuse(curves, "curves", allowed);
  return found;
}

Tension tension(const TomlReader& reader, const toml::table& table) {
  const std::string name = "[tension]";
  reader.check_keys(table, name, {"materials"});
  const std::string allowed = "[{ material, shore_a }, ...]";
  Tension found;
  const toml::node& materials = reader.required(table, name, "materials");
  for (const toml::node& node : reader.list(materials, "materials", kMostEntries, allowed)) {
    const toml::table* row = node.as_table();
    if (!row) reader.refuse(node, "materials", allowed);
    reader.check_keys(*row, "materials", {"material", "shore_a"});
    found.materials.push_back(
        {reader.text(reader.required(*row, "materials", "material"), "material"),
         number_in(reader, *row, "materials", "shore_a", 0, 99, "a number from 0 to 99")});
  }
  if (found.materials.empty()) reader.refuse(materials, "materials", allowed);
  return found;
}

BondedDisc bonded_disc(const TomlReader& reader, const toml::table& table) {
  const std::string name = "[bonded_disc]";
  reader.check_keys(table, name,
                    {"diameter_mm", "thickness_mm", "machine_N_per_mm", "knee_extension",
                     "poisson_ratio", "extension", "stress_MPa"});
  BondedDisc found;
  found.diameter_m = length_m(reader, table, name, "diameter_mm");
  found.thickness_m = length_m(reader, table, name, "thickness_mm");
  found.machine_N_per_m = 1e3 * number_in(reader, table, name, "machine_N_per_mm", 1e-3, 1e9,
                                          "a number from 0.001 to 1e9, in N/mm");
  found.knee_extension =
      number_in(reader, table, name, "knee_extension", 1e-6, 10, "a number from 1e-6 to 10");
  found.poisson_ratios = number_list(reader, table, name, "poisson_ratio", 1, 0, 0.5,
                                     "[nu, ...], numbers from 0 to 0.5");
  const std::string rising = "rising numbers from 0 to 100, two of them below knee_extension";
  found.extension = number_list(reader, table, name, "extension", 2, 0, 100, rising);
  const auto& x = found.extension;
  if (std::adjacent_find(x.begin(), x.end(), std::greater_equal<>()) != x.end() ||
      x[1] >= found.knee_extension)
    reader.refuse(*table.get("extension"), "extension", rising);
  const std::string same = "as many rising numbers from 0 to 1e4 as extension has, in MPa";
  found.stress_Pa = number_list(reader, table, name, "stress_MPa", x.size(), 0, 1e4, same);
  if (found.stress_Pa.size() != x.size() ||
      std::adjacent_find(found.stress_Pa.begin(), found.stress_Pa.end(), std::greater_equal<>()) !=
          found.stress_Pa.end())
    reader.refuse(*table.get("stress_MPa"), "stress_MPa", same);
  for (double& stress : found.stress_Pa) stress *= 1e6;
  return found;
}

}  // namespace

Experiment parse_experiment(const std::string& text, const std::filesystem::path& file) {
  const toml::table root = input::parse_toml(text, file.string());
  const TomlReader reader(file.string());
  const std::vector<std::string> kinds = {"growth",      "indentation",  "hardness", "repeated",
                                          "observation", "press_curves", "tension",  "bonded_disc"};
  std::vector<std::string> known = {"id", "what", "source", "certainty", "unknown"};
  known.insert(known.end(), kinds.begin(), kinds.end());
  reader.check_keys(root, "the file", known);
  Experiment found;
  found.file = file;
  found.id = reader.id(root);
  for (const auto& [key, text_of] :
       {std::pair("what", &found.what), std::pair("source", &found.source),
        std::pair("certainty", &found.certainty)})
    *text_of = reader.text(reader.required(root, "the file", key), key);
  const std::string list = "[\"...\", ...]";
  const toml::node& unknown = reader.required(root, "the file", "unknown");
  for (const toml::node& node : reader.list(unknown, "unknown", kMostEntries, list))
    found.unknown.push_back(reader.text(node, "unknown"));
  std::vector<std::string> present;
  for (const std::string& kind : kinds)
    if (root.contains(kind)) present.push_back(kind);
  if (present.size() != 1)
    throw InputError(file.string(), "tables with data", std::to_string(present.size()),
                     "exactly one of [" + text::joined(kinds, "], [") + "]");
  const toml::table& table = reader.required_table(root, present[0]);
  if (present[0] == "growth") found.data = growth(reader, table);
  if (present[0] == "indentation") found.data = indentation(reader, table);
  if (present[0] == "hardness") found.data = hardness(reader, table);
  if (present[0] == "repeated") found.data = repeated(reader, table);
  if (present[0] == "observation") found.data = observation(reader, table);
  if (present[0] == "press_curves") found.data = press_curves(reader, table);
  if (present[0] == "tension") found.data = tension(reader, table);
  if (present[0] == "bonded_disc") found.data = bonded_disc(reader, table);
  return found;
}

Experiment read_experiment(const std::filesystem::path& file) {
  return parse_experiment(system::read_text_file(file, input::kLargestTomlFile), file);
}

}  // namespace softfinger::experiments
