#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"

/// Comment lines that every export ends with. The page of `softfinger explore` compiles this file
/// too.
namespace softfinger::exporting {
namespace {

/// The text with the number in place of each `{k}`.
std::string with_stiffness(std::string text, double stiffness_N_per_m) {
  constexpr std::string_view kMark = "{k}";
  for (std::size_t at; (at = text.find(kMark)) != std::string::npos;)
    text.replace(at, kMark.size(), fmt::format("{:.4g}", stiffness_N_per_m));
  return text;
}

/// @param points  the number of contact points that share the normal stiffness
Lines remarked(Lines lines, const Simulator& simulator, const SoftContact& contact, int points) {
  const std::string about_the_normal =
      contact.torsional_stiffness_Nm_per_rad > 0
          ? fmt::format(", about the normal {:.4g} N m/rad before it slips",
                        contact.torsional_stiffness_Nm_per_rad)
          : std::string();
  const std::string place = with_stiffness(std::string(simulator.stiffness_place),
                                           contact.normal_stiffness_N_per_m / points);
  const auto [open, close] = simulator.comment;
  lines.text += fmt::format(
      "{0}The model's stiffness is dP/dd {2:.4g} N/m{3}; it has no damping. {4}{1}\n"
      "{0}The law was read in {5}.{1}\n",
      open, close, contact.normal_stiffness_N_per_m, about_the_normal, place,
      simulator.checked_against);
  return lines;
}

}  // namespace

Lines point_lines(const Simulator& simulator, const SoftContact& contact) {
  return remarked(simulator.lines(contact), simulator, contact, 1);
}

Lines box_lines(const Simulator& simulator, const SoftContact& contact) {
  return remarked(simulator.box_lines(contact), simulator, contact, 4);
}

}  // namespace softfinger::exporting
