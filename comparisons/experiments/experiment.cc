#include "comparisons/experiments/experiment.h"

#include <algorithm>

#include "comparisons/input/toml_reader.h"
#include "comparisons/system/files.h"
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

}  // namespace

Experiment parse_experiment(const std::string& text, const std::filesystem::path& file) {
  const toml::table root = input::parse_toml(text, file.string());
  const TomlReader reader(file.string());
  const std::vector<std::string> kinds = {"growth", "indentation", "hardness", "repeated",
                                          "observation"};
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
                     "exactly one of [growth], [indentation], [hardness], [repeated], "
                     "[observation]");
  const toml::table& table = reader.required_table(root, present[0]);
  if (present[0] == "growth") found.data = growth(reader, table);
  if (present[0] == "indentation") found.data = indentation(reader, table);
  if (present[0] == "hardness") found.data = hardness(reader, table);
  if (present[0] == "repeated") found.data = repeated(reader, table);
  if (present[0] == "observation") found.data = observation(reader, table);
  return found;
}

Experiment read_experiment(const std::filesystem::path& file) {
  return parse_experiment(system::read_text_file(file, input::kLargestTomlFile), file);
}

}  // namespace softfinger::experiments
