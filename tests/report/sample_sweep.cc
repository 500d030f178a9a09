#include "sample_sweep.h"

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/input/constants.h"

namespace softfinger::tests {
namespace {

using Json = nlohmann::json;

struct Key {
  const char* key;
  std::vector<double> values;
  bool log = false;
};

/// The numbers of a point, in the units of the keys.
struct Contact {
  double thickness_mm = 2, poisson_ratio = 0.45, youngs_modulus_kPa = 300, radius_mm = 20;

  void set(const std::string& key, double value) {
    if (key == "layer.thickness_mm") thickness_mm = value;
    if (key == "layer.poisson_ratio") poisson_ratio = value;
    if (key == "layer.youngs_modulus_kPa") youngs_modulus_kPa = value;
    if (key == "geometry.relative_radii_mm[0]") radius_mm = value;
  }
};

std::vector<double> steps(double from, double to, int count, bool log = false) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const double part = count == 1 ? 0 : double(i) / (count - 1);
    values.push_back(log ? from * std::pow(to / from, part) : from + (to - from) * part);
  }
  return values;
}

/// The six answers of an invented contact, with sizes and torque times `factor`.
std::vector<double> answers(const Contact& contact, double load_N, double factor) {
  const double torque_Nm = 2e-3 * std::sqrt(contact.thickness_mm) * load_N * factor *
                           (1.3 - contact.poisson_ratio) / 0.85 *
                           std::pow(300 / contact.youngs_modulus_kPa, 0.3) *
                           std::pow(contact.radius_mm / 20, 0.2);
  const double a_m = 1.6 * torque_Nm / load_N, b_m = 0.6 * a_m;
  return {a_m, b_m, 0.2 * b_m, 1.5 * load_N / (kPi * a_m * b_m), kPi * a_m * b_m, torque_Nm};
}

const std::vector<std::pair<const char*, const char*>> kModels{
    {"bonded_layer", "Bonded layer"},
    {"hertz", "Elliptic Hertz contact on a half-space"},
    {"winkler", "Elastic foundation of independent columns"},
    {"thin_incompressible", "Thin incompressible layer that flows sideways"},
    {"power_law", "Measured growth of a round contact"},
    {"finite_strain_layer", "Elastic layer, pressed far"},
    {"layer_fft", "Bonded elastic layers on a grid"},
    {"layer_fredholm", "Round contact on a layer"}};

class SampleSweep {
 public:
  SampleSweep(const std::string& id, const std::vector<Key>& keys, std::vector<double> loads_N,
              std::size_t models, bool fem)
      : loads_N_(std::move(loads_N)), models_(models), fem_(fem) {
    Json columns = {"point"}, described = Json::array();
    for (const Key& key : keys) {
      columns.push_back(key.key);
      keys_.push_back(key.key);
      described.push_back({{"key", key.key},
                           {"count", key.values.size()},
                           {"least", key.values.front()},
                           {"largest", key.values.back()},
                           {"log", key.log}});
    }
    for (const char* column : {"load_N", "radius_major_m", "radius_minor_m"})
      columns.push_back(column);
    Json names = Json::array();
    for (std::size_t i = 0; i < models_; ++i) {
      names.push_back({{"name", kModels[i].first}, {"title", kModels[i].second}});
      for (const char* quantity : {"a_m", "b_m", "indentation_m", "peak_pressure_Pa", "area_m2",
                                   "max_torque_Nm", "usable"})
        columns.push_back(std::string(kModels[i].first) + "_" + quantity);
    }
    if (fem_) {
      for (const char* quantity :
           {"a_m", "b_m", "indentation_m", "peak_pressure_Pa", "area_m2", "max_torque_Nm"})
        columns.push_back(std::string("fem_") + quantity);
      for (const char* quantity : {"a", "b", "indentation", "peak_pressure", "area", "max_torque"})
        columns.push_back(std::string("fem_error_") + quantity);
    }
    columns.push_back("failure");
    sweep_ = {
        {"id", id},
        {"question", "What does the <layer> do?"},
        {"usable", "within 10 %"},
        {"keys", described},
        {"models", names},
        {"fem", fem_},
        {"loads_N", loads_N_},
        {"failed", 0},
        {"sweep_toml", "id = \"" + id + "\"\n[sweep]\n\"layer.thickness_mm\" = [1, 2]  # <&>"},
        {"command", "softfinger sweep <x>.toml --output out"},
        {"version", "1.2.3"},
        {"columns", columns},
        {"rows", Json::array()}};
  }

  /// One row per load.
  void add(const std::vector<double>& values, const std::string& failure = "") {
    Contact contact;
    for (std::size_t i = 0; i < keys_.size(); ++i) contact.set(keys_[i], values[i]);
    for (const double load_N : loads_N_) {
      Json row = {points_};
      for (const double value : values) row.push_back(value);
      row.push_back(load_N);
      row.push_back(20e-3);
      row.push_back(10e-3);
      for (std::size_t i = 0; i < models_; ++i) append_model(i, contact, load_N, failure, row);
      if (fem_) append_fem(contact, load_N, failure, row);
      row.push_back(failure);
      sweep_["rows"].push_back(row);
      if (!failure.empty()) sweep_["failed"] = sweep_["failed"].get<int>() + 1;
    }
    ++points_;
  }

  Json finished() {
    sweep_["points"] = points_;
    sweep_["all_rows"] = sweep_["rows"].size();
    return sweep_;
  }

 private:
  void append_model(std::size_t model, const Contact& contact, double load_N,
                    const std::string& failure, Json& row) const {
    // The first is exact at 2 mm, the second too stiff on thin layers, the fourth refuses thick
    // ones.
    const double thickness = contact.thickness_mm / 2;
    const double factor = model == 0   ? 1 + 0.02 * std::log(thickness) * fem_
                          : model == 1 ? std::pow(thickness, 0.3)
                                       : 1 + 0.04 * double(model) * (contact.poisson_ratio - 0.2);
    const bool silent = model == 3 && contact.thickness_mm > 2.5;
    const bool valid = model == 1   ? contact.thickness_mm > 2
                       : model == 2 ? contact.poisson_ratio < 0.4
                                    : true;
    if (!failure.empty() || silent) {
      for (int i = 0; i < 6; ++i) row.push_back(nullptr);
      row.push_back(failure.empty() ? Json("no") : Json(nullptr));
      return;
    }
    for (const double value : answers(contact, load_N, factor)) row.push_back(value);
    row.push_back(valid ? "yes" : "no");
  }

  static void append_fem(const Contact& contact, double load_N, const std::string& failure,
                         Json& row) {
    for (const double value : answers(contact, load_N, 1))
      row.push_back(failure.empty() ? Json(value) : Json(nullptr));
    for (int i = 0; i < 6; ++i) row.push_back(failure.empty() ? Json(0.01 + 0.01 * i) : Json());
  }

  std::vector<double> loads_N_;
  std::vector<std::string> keys_;
  std::size_t models_;
  bool fem_;
  int points_ = 0;
  Json sweep_;
};

}  // namespace

Json sweep_of_one_key() {
  const std::vector<double> thicknesses_mm = steps(0.5, 5, 10, true);
  SampleSweep sweep("one_key", {{"layer.thickness_mm", thicknesses_mm, true}}, {1, 2, 5}, 4, false);
  for (const double thickness_mm : thicknesses_mm) sweep.add({thickness_mm});
  return sweep.finished();
}

Json sweep_of_one_key_with_fem() {
  const std::vector<double> thicknesses_mm = steps(0.5, 5, 6, true);
  SampleSweep sweep("one_key_fem", {{"layer.thickness_mm", thicknesses_mm, true}}, {2}, 3, true);
  for (const double thickness_mm : thicknesses_mm) sweep.add({thickness_mm});
  return sweep.finished();
}

Json sweep_with_fem() {
  const std::vector<double> thicknesses_mm = steps(0.5, 5, 12, true), ratios = steps(0.2, 0.49, 8);
  SampleSweep sweep(
      "two_keys",
      {{"layer.thickness_mm", thicknesses_mm, true}, {"layer.poisson_ratio", ratios, false}},
      {1, 2, 5}, 4, true);
  for (const double thickness_mm : thicknesses_mm)
    for (const double ratio : ratios)
      sweep.add({thickness_mm, ratio}, thickness_mm < 0.7 && ratio > 0.44
                                           ? "the active set did not settle: <level 3>"
                                           : "");
  Json made = sweep.finished();
  made["friction_coefficient"] = 0.8;
  return made;
}

Json sweep_of_three_keys() {
  const std::vector<double> thicknesses_mm = steps(0.5, 5, 14, true), ratios = steps(0.2, 0.49, 10),
                            moduli_kPa = steps(100, 1000, 9, true);
  SampleSweep sweep("three_keys",
                    {{"layer.thickness_mm", thicknesses_mm, true},
                     {"layer.poisson_ratio", ratios, false},
                     {"layer.youngs_modulus_kPa", moduli_kPa, true}},
                    {1, 10}, 4, false);
  for (const double thickness_mm : thicknesses_mm)
    for (const double ratio : ratios)
      for (const double modulus_kPa : moduli_kPa) sweep.add({thickness_mm, ratio, modulus_kPa});
  return sweep.finished();
}

Json sweep_of_zipped_keys() {
  const std::vector<double> thicknesses_mm = steps(1, 4, 5), moduli_kPa = steps(100, 500, 5);
  SampleSweep sweep("zipped",
                    {{"layer.thickness_mm", thicknesses_mm, false},
                     {"layer.youngs_modulus_kPa", moduli_kPa, false}},
                    {1}, 2, false);
  for (std::size_t i = 0; i < 5; ++i) sweep.add({thicknesses_mm[i], moduli_kPa[i]});
  return sweep.finished();
}

Json sweep_of_awkward_keys() {
  const char* radius = "geometry.object.a_name_that_is_longer_than_a_phone_is_wide.radii_mm[0]";
  const std::vector<double> ratios{0.49999, 0.499995, 0.499999}, radii_mm{-100, 20, 50};
  SampleSweep sweep("awkward_" + std::string(60, 'x'),
                    {{"layer.poisson_ratio", ratios, true}, {radius, radii_mm, true}}, {0.001, 1e5},
                    3, true);
  for (const double ratio : ratios)
    for (const double radius_mm : {-100., 20., 50., double(INFINITY)})
      sweep.add({ratio, radius_mm});
  // The result is as JSON text has it: no infinity.
  return Json::parse(sweep.finished().dump());
}

Json sweep_at_random() {
  SampleSweep sweep("at_random",
                    {{"layer.thickness_mm", {0.5, 5}, true},
                     {"layer.poisson_ratio", {0, 0.49}, false},
                     {"layer.youngs_modulus_kPa", {100, 1000}, true},
                     {"geometry.relative_radii_mm[0]", {5, 50}, false}},
                    {2}, 8, false);
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> part(0, 1);
  for (int i = 0; i < 20'000; ++i)
    sweep.add({0.5 * std::pow(10, part(engine)), 0.49 * part(engine),
               100 * std::pow(10, part(engine)), 5 + 45 * part(engine)});
  Json made = sweep.finished();
  made["points"] = made["all_rows"] = 1'000'000;
  for (Json& key : made["keys"]) key["count"] = 1'000'000;
  return made;
}

Json sweep_of_one_row() {
  SampleSweep sweep("one_row", {{"layer.thickness_mm", {2}, false}}, {1}, 2, false);
  sweep.add({2});
  return sweep.finished();
}

Json sweep_without_answers() {
  SampleSweep sweep("without_answers", {{"layer.thickness_mm", {1, 2, 3}, false}}, {1, 2}, 2, true);
  for (const double thickness_mm : {1, 2, 3}) sweep.add({thickness_mm}, "the bodies do not touch");
  return sweep.finished();
}

}  // namespace softfinger::tests
