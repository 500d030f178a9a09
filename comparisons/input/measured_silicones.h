#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace softfinger::input {

/// A casting silicone in tension. One table: `init --material`, the advice of `calibrate` and the
/// experiment silicones_tension read it.
struct MeasuredSilicone {
  std::string_view name;
  /// Young's modulus in kPa: the secant at 10 % of strain, and neo-Hookean fits to 30 % and 100 %.
  double secant_10_kPa, to_30_kPa, to_100_kPa;

  /// The middle one is the value; the least and the largest of the three are its scatter.
  double low_kPa() const;
  double high_kPa() const;
};

/// The tension tests (ASTM D412) of the Soft Robotics Materials Database, repository
/// LucMarechal/Soft-Robotics-Materials-Database: Marechal et al., Soft Robotics (2020), doi
/// 10.1089/soro.2019.0115. Crosshead strain: lower bounds.
const std::vector<MeasuredSilicone>& measured_silicones();

/// The material of this name; case does not count, and "Dragon Skin 10" finds "Dragon Skin 10
/// MEDIUM" where only one name begins so.
/// @throws InputError with the nearest names
const MeasuredSilicone& find_measured_silicone(const std::string& typed);

/// Materials whose scatter contains this modulus, the nearest first.
std::vector<const MeasuredSilicone*> silicones_like(double youngs_modulus_Pa);

}  // namespace softfinger::input
