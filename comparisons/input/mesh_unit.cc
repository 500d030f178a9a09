#include "comparisons/input/mesh_unit.h"

#include <fmt/format.h>

#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

/// Widths of fingertips and links, and of what a hand can hold.
constexpr double kNarrowestFinger_m = 5e-3, kWidestFinger_m = 40e-3;
constexpr double kSmallestBody_m = 0.5e-3, kLargestBody_m = 1;

std::string width_text(double width_m) {
  return width_m < 1 ? fmt::format("{:.3g} mm", 1e3 * width_m) : fmt::format("{:.3g} m", width_m);
}

std::string both_widths(const meshes::SurfaceFile& file) {
  const double width_in_file = file.width_m / file.metres_per_unit;
  return width_text(1e-3 * width_in_file) + " or " + width_text(width_in_file) + " wide";
}

std::string typed_unit(const std::string& unit, UnitIsTold told) {
  return told == UnitIsTold::in_a_file ? "unit = \"" + unit + "\"" : "--unit " + unit;
}

}  // namespace

std::string unit_remark(const meshes::SurfaceFile& file, MeshRole role, UnitIsTold told) {
  const bool is_narrow_range = file.is_unit_guessed && role == MeshRole::finger;
  const double least_m = is_narrow_range ? kNarrowestFinger_m : kSmallestBody_m;
  const double largest_m = is_narrow_range ? kWidestFinger_m : kLargestBody_m;
  const auto is_usual = [&](double width_m) { return width_m >= least_m && width_m <= largest_m; };
  const std::string unit = unit_name(file.metres_per_unit);
  const bool is_doubtful = !is_usual(file.width_m);
  if (!is_doubtful && !(file.is_unit_guessed && unit == "m")) return "";
  std::string text = file.is_unit_guessed ? both_widths(file) + ": taken as " + unit
                                          : width_text(file.width_m) + " wide, read in " + unit;
  if (!is_doubtful) return text + "; " + typed_unit(unit, told) + " says so without this line";
  text += fmt::format("; {} is {} to {} wide", is_narrow_range ? "a finger" : "what a hand holds",
                      width_text(least_m), width_text(largest_m));
  struct Other {
    std::string name, remedy;
    double metres;
  };
  bool is_known = false;
  for (const Other& other : {Other{"mm", typed_unit("mm", told), 1e-3},
                             {"m", typed_unit("m", told), 1.},
                             {"cm", "scale it by 10 to mm", 1e-2},
                             {"inches", "scale it by 25.4 to mm", 25.4e-3}}) {
    const double there_m = file.width_m / file.metres_per_unit * other.metres;
    // Within the wide range nearly any unit would do.
    const bool is_unit_of_files = other.metres == 1e-3 || other.metres == 1;
    if (other.name == unit || !is_usual(there_m) || !(is_narrow_range || is_unit_of_files))
      continue;
    text +=
        fmt::format("; in {} it would be {}: {}?", other.name, width_text(there_m), other.remedy);
    is_known = true;
  }
  if (!is_known) text += "; is it the whole of it, and in that unit?";
  return text;
}

void require_finger_size(const meshes::SurfaceFile& file, const std::string& where,
                         UnitIsTold told) {
  constexpr double kLeast_m = 1e-3, kLargest_m = 1;
  if (!file.is_unit_guessed || (file.width_m >= kLeast_m && file.width_m <= kLargest_m)) return;
  throw InputError(where, "mesh", both_widths(file),
                   "a finger 1 mm to 1 m wide, or its unit: " + typed_unit("mm", told) + " or " +
                       typed_unit("m", told));
}

}  // namespace softfinger::input
