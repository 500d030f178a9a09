#include "comparisons/reference/reference_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace softfinger::reference {
namespace {

using nlohmann::json;

/// Missing or impossible value of a result, in a few words.
struct Flaw {
  std::string words;
};

double number_or_nan(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>()
                                                     : std::numeric_limits<double>::quiet_NaN();
}

std::optional<double> optional_number(const json& object, const char* key) {
  const double value = number_or_nan(object, key);
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

/// @param of  before the key in messages: "a level's "
void require_positive(const json& object, const char* of, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number())
      throw Flaw{std::string(of) + key + " is missing"};
    if (!(found->get<double>() > 0)) throw Flaw{fmt::format("{}{} = {}", of, key, found->dump())};
  }
}

/// @param block  the name of what holds the errors
ReferenceErrors stated_errors(const json& error, const char* block) {
  const auto stated = [&](const char* key) {
    const std::optional<double> value = optional_number(error, key);
    if (value && !(*value >= 0))
      throw Flaw{fmt::format("the {} of {} = {}", block, key, error.at(key).dump())};
    return value;
  };
  ReferenceErrors errors;
  errors.a = stated("a");
  errors.b = stated("b");
  errors.indentation = stated("indentation");
  errors.area = stated("area");
  errors.peak_pressure = stated("peak_pressure");
  errors.max_torque = stated("max_torque");
  errors.load = stated("load");
  errors.torsional_stiffness = stated("torsional_stiffness");
  errors.full_slip_torque = stated("torque_full_slip");
  errors.torsion_curve = stated("torsion");
  errors.limit_surface = stated("limit_surface");
  return errors;
}

ReferenceErrors read_errors(const json& document) {
  const auto error = document.find("error");
  if (error == document.end() || !error->is_object()) throw Flaw{"error is missing"};
  for (const char* key : {"a", "b", "indentation", "max_torque"}) {
    const auto stated = error->find(key);
    // A single level cannot state its error: that is null.
    if (stated == error->end() || !(stated->is_number() || stated->is_null()))
      throw Flaw{std::string("the error of ") + key + " is missing"};
  }
  return stated_errors(*error, "error");
}

std::optional<ReferenceErrors> read_geometry_errors(const json& document) {
  const auto error = document.find("geometry_error");
  if (error == document.end() || !error->is_object()) return std::nullopt;
  return stated_errors(*error, "geometry_error");
}

std::vector<ReferenceLevel> read_levels(const json& document) {
  const auto found = document.find("levels");
  if (found == document.end() || !found->is_array() || found->empty())
    throw Flaw{"levels is missing"};
  std::vector<ReferenceLevel> levels;
  for (const json& level : *found) {
    if (!level.is_object()) throw Flaw{"a level is no JSON object"};
    require_positive(level, "a level's ", {"a_m", "b_m", "indentation_m", "max_torque_Nm"});
    levels.push_back({number_or_nan(level, "a_m"), number_or_nan(level, "b_m"),
                      number_or_nan(level, "indentation_m"),
                      number_or_nan(level, "peak_pressure_Pa"),
                      number_or_nan(level, "max_torque_Nm"), number_or_nan(level, "cpu_s")});
  }
  return levels;
}

std::optional<FrictionlessReference> read_frictionless(const json& document) {
  const auto found = document.find("frictionless");
  if (found == document.end()) return std::nullopt;
  if (!found->is_object()) throw Flaw{"frictionless is no JSON object"};
  require_positive(*found, "frictionless: ",
                   {"a_m", "b_m", "indentation_m", "area_projected_m2", "max_torque_Nm"});
  const auto number = [&](const char* key) { return number_or_nan(*found, key); };
  return FrictionlessReference{number("a_m"), number("b_m"), number("indentation_m"),
                               number("area_projected_m2"), number("max_torque_Nm")};
}

PressureProfile read_profile(const json& document, const char* key) {
  const auto found = document.find(key);
  if (found == document.end() || !found->is_object()) throw Flaw{std::string(key) + " is missing"};
  const auto list = [&](const char* name) {
    const auto values = found->find(name);
    if (values == found->end() || !values->is_array())
      throw Flaw{std::string(key) + " is incomplete"};
    std::vector<double> numbers;
    for (const json& value : *values) {
      if (!value.is_number() && !value.is_null()) throw Flaw{std::string(key) + " is incomplete"};
      numbers.push_back(value.is_number() ? value.get<double>()
                                          : std::numeric_limits<double>::quiet_NaN());
    }
    return numbers;
  };
  PressureProfile profile{list("position_m"), list("pressure_Pa")};
  if (profile.position_m.size() != profile.pressure_Pa.size())
    throw Flaw{std::string(key) + " is incomplete"};
  return profile;
}

/// The list of objects under a key; empty when there is none.
std::vector<json> objects(const json& document, const char* key) {
  std::vector<json> list;
  const auto found = document.find(key);
  if (found == document.end()) return list;
  if (!found->is_array()) throw Flaw{std::string(key) + " is no list"};
  for (const json& entry : *found) {
    if (!entry.is_object()) throw Flaw{std::string(key) + " is no list of objects"};
    list.push_back(entry);
  }
  return list;
}

std::optional<TwistedContact> read_twist(const json& document) {
  if (!document.contains("torsion")) return std::nullopt;
  TwistedContact twist;
  twist.stiffness_Nm_per_rad = number_or_nan(document, "torsional_stiffness_Nm_per_rad");
  twist.full_slip_torque_Nm = number_or_nan(document, "torque_full_slip_Nm");
  for (const json& state : objects(document, "torsion"))
    twist.states.push_back({number_or_nan(state, "angle_rad"), number_or_nan(state, "torque_Nm"),
                            number_or_nan(state, "slip_fraction")});
  return twist;
}

std::optional<std::vector<NodalForce>> read_forces(const json& document) {
  const auto entry = document.find("nodal_forces");
  if (entry == document.end()) return std::nullopt;
  const auto numbers = [&](const char* key) {
    const auto values = entry->find(key);
    if (values == entry->end() || !values->is_array()) throw Flaw{"nodal_forces without numbers"};
    std::vector<double> result;
    for (const json& value : *values) {
      if (!value.is_number() || !std::isfinite(value.get<double>()))
        throw Flaw{"a nodal force that is no number"};
      result.push_back(value.get<double>());
    }
    return result;
  };
  const std::vector<double> x_m = numbers("x_m"), y_m = numbers("y_m"),
                            force_N = numbers("force_N"), area_m2 = numbers("area_m2"),
                            friction_x_N = numbers("friction_x_N"),
                            friction_y_N = numbers("friction_y_N");
  if (x_m.empty() || y_m.size() != x_m.size() || force_N.size() != x_m.size() ||
      area_m2.size() != x_m.size() || friction_x_N.size() != x_m.size() ||
      friction_y_N.size() != x_m.size())
    throw Flaw{"nodal forces of unequal number"};
  std::vector<NodalForce> forces;
  for (std::size_t i = 0; i < x_m.size(); ++i) {
    if (!(force_N[i] > 0 && area_m2[i] > 0)) throw Flaw{"a nodal force that pulls"};
    forces.push_back({x_m[i], y_m[i], force_N[i], area_m2[i], friction_x_N[i], friction_y_N[i]});
  }
  return forces;
}

ReferenceResult read(const json& document) {
  if (!document.is_object()) throw Flaw{"no JSON object"};
  require_positive(document, "",
                   {"load_N", "a_m", "b_m", "indentation_m", "peak_pressure_Pa",
                    "area_projected_m2", "area_m2", "max_torque_Nm"});
  ReferenceResult result;
  result.load_N = document["load_N"];
  result.a_m = document["a_m"];
  result.b_m = document["b_m"];
  result.axis_rad = number_or_nan(document, "axis_rad");
  result.indentation_m = document["indentation_m"];
  result.peak_pressure_Pa = document["peak_pressure_Pa"];
  result.area_projected_m2 = document["area_projected_m2"];
  result.area_m2 = document["area_m2"];
  result.max_torque_Nm = document["max_torque_Nm"];
  result.eccentricity_m = number_or_nan(document, "eccentricity_m");
  result.projected_torque_Nm = optional_number(document, "max_torque_projected_Nm");
  result.peak_memory_MB = optional_number(document, "peak_memory_MB");
  result.unknowns = optional_number(document, "unknowns");
  result.wall_s = number_or_nan(document, "wall_s");
  result.cpu_s = number_or_nan(document, "cpu_s");
  const auto coarse = document.find("coarse");
  result.coarse = coarse != document.end() && coarse->is_boolean() && coarse->get<bool>();
  result.levels = read_levels(document);
  result.frictionless = read_frictionless(document);
  result.error = read_errors(document);
  result.geometry_error = read_geometry_errors(document);
  result.is_geometry_unknown = document.contains("geometry_error") && !result.geometry_error;
  result.along_x = read_profile(document, "profile_x");
  result.along_y = read_profile(document, "profile_y");
  const auto vtu = document.find("vtu");
  if (vtu != document.end() && vtu->is_string()) result.vtu_file = vtu->get<std::string>();
  result.twist = read_twist(document);
  for (const json& point : objects(document, "limit_surface"))
    result.limit_surface.push_back({number_or_nan(point, "fx_N"), number_or_nan(point, "fy_N"),
                                    number_or_nan(point, "torque_Nm")});
  result.forces = read_forces(document);
  result.document = document;
  return result;
}

}  // namespace

ReadReferenceResult read_reference_result(const json& document) {
  try {
    return {read(document), ""};
  } catch (const Flaw& flaw) {
    return {std::nullopt, flaw.words};
  }
}

bool are_elements_trusted(const ReferenceErrors& error) {
  const auto is_within = [](const std::optional<double>& stated, double limit) {
    return stated && *stated <= limit;
  };
  return is_within(error.a, kTrustLimits.axes) && is_within(error.b, kTrustLimits.axes) &&
         is_within(error.indentation, kTrustLimits.indentation_and_torque) &&
         is_within(error.max_torque, kTrustLimits.indentation_and_torque);
}

double largest_geometry_error(const ReferenceResult& result) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  if (!result.geometry_error) return result.is_geometry_unknown ? unknown : 0;
  const ReferenceErrors& open = *result.geometry_error;
  double largest = 0;
  for (const auto& error : {open.a, open.b, open.area, open.max_torque})
    largest = std::max(largest, error.value_or(unknown));
  return largest;
}

bool is_trusted(const ReferenceResult& result) {
  return are_elements_trusted(result.error) &&
         largest_geometry_error(result) <= kTrustLimits.geometry;
}

std::string trust_limits_in_words() {
  return fmt::format("{:g} % in a and b, {:g} % in indentation and torque", 100 * kTrustLimits.axes,
                     100 * kTrustLimits.indentation_and_torque);
}

}  // namespace softfinger::reference
