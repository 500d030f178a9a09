#include "comparisons/input/mesh_unit.h"

#include <fmt/format.h>

#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

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

struct UsualWidth {
  double least_m, largest_m;
  bool holds(double width_m) const { return width_m >= least_m && width_m <= largest_m; }
};

constexpr UsualWidth kFinger = {5e-3, 40e-3};  // fingertips and links
constexpr UsualWidth kHandHeld = {0.5e-3, 1};

bool is_judged_as_finger(const meshes::SurfaceFile& file, MeshRole role) {
  return file.is_unit_guessed && role == MeshRole::finger;
}

const UsualWidth& usual_width(const meshes::SurfaceFile& file, MeshRole role) {
  return is_judged_as_finger(file, role) ? kFinger : kHandHeld;
}

/// "; in inches it would be 24 mm: scale it by 25.4 to mm?", for each unit in which the width is
/// usual; empty: in none.
std::string in_other_units(const meshes::SurfaceFile& file, const UsualWidth& usual,
                           UnitIsTold told) {
  struct Other {
    std::string name, remedy;
    double metres;
  };
  std::string text;
  for (const Other& other : {Other{"mm", typed_unit("mm", told), 1e-3},
                             {"m", typed_unit("m", told), 1.},
                             {"cm", "scale it by 10 to mm", 1e-2},
                             {"inches", "scale it by 25.4 to mm", 25.4e-3}}) {
    const double there_m = file.width_m / file.metres_per_unit * other.metres;
    // Within the wide range nearly any unit would do.
    const bool is_unit_of_files = other.metres == 1e-3 || other.metres == 1;
    if (other.metres == file.metres_per_unit || !usual.holds(there_m) ||
        !(&usual == &kFinger || is_unit_of_files))
      continue;
    text +=
        fmt::format("; in {} it would be {}: {}?", other.name, width_text(there_m), other.remedy);
  }
  return text;
}

}  // namespace

MeshRole likely_role(const meshes::SurfaceFile& file) {
  constexpr double kWiderThanFingers_m = 50e-3;
  return file.width_m > kWiderThanFingers_m ? MeshRole::object : MeshRole::finger;
}

bool is_width_doubtful(const meshes::SurfaceFile& file, MeshRole role) {
  return !usual_width(file, role).holds(file.width_m);
}

std::string unit_name(double metres_per_unit) {
  struct Unit {
    const char* name;
    double metres;
  };
  for (const Unit& unit :
       {Unit{"mm", 1e-3}, {"m", 1}, {"cm", 1e-2}, {"in", 25.4e-3}, {"ft", 304.8e-3}, {"µm", 1e-6}})
    if (metres_per_unit == unit.metres) return unit.name;
  return fmt::format("{} m", metres_per_unit);
}

namespace {

/// @param file  whose unit does not contradict what was told
std::string width_remark(const meshes::SurfaceFile& file, MeshRole role, UnitIsTold told) {
  const UsualWidth& usual = usual_width(file, role);
  const std::string unit = unit_name(file.metres_per_unit);
  const bool is_doubtful = is_width_doubtful(file, role);
  if (!is_doubtful && !(file.is_unit_guessed && unit == "m")) return "";
  const std::string text = file.is_unit_guessed
                               ? both_widths(file) + ": taken as " + unit
                               : width_text(file.width_m) + " wide, read in " + unit;
  if (!is_doubtful) return text + "; " + typed_unit(unit, told) + " says so without this line";
  const bool is_finger = is_judged_as_finger(file, role);
  const std::string other = in_other_units(file, usual, told);
  return text +
         fmt::format("; {} is {} to {} wide", is_finger ? "a finger" : "what a hand holds",
                     width_text(usual.least_m), width_text(usual.largest_m)) +
         (!other.empty() ? other
                         : fmt::format("; is it the whole of {}, and in that unit?",
                                       is_finger ? "a finger" : "it"));
}

}  // namespace

std::string unit_remark(const meshes::SurfaceFile& file, MeshRole role, UnitIsTold told) {
  const std::string width = width_remark(file, role, told);
  if (!file.own_metres_per_unit || *file.own_metres_per_unit == file.metres_per_unit) return width;
  return fmt::format(
      "the file says that its unit is {}; {} counts{}{}", unit_name(*file.own_metres_per_unit),
      typed_unit(unit_name(file.metres_per_unit), told), width.empty() ? "" : "; ", width);
}

void require_finger_size(const meshes::SurfaceFile& file, const std::string& where,
                         UnitIsTold told) {
  constexpr UsualWidth kAllowed = {1e-3, 1};
  if (!file.is_unit_guessed || kAllowed.holds(file.width_m)) return;
  throw InputError(where, "mesh", both_widths(file),
                   "a finger 1 mm to 1 m wide, or its unit: " + typed_unit("mm", told) + " or " +
                       typed_unit("m", told) + in_other_units(file, kFinger, told));
}

}  // namespace softfinger::input
