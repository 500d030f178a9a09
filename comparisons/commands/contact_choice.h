#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "comparisons/commands/case_input.h"
#include "comparisons/commands/demand_input.h"
#include "comparisons/exporting/contact_curve.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/input/case.h"

/// Options with which `export` and `apply` choose the contact: a case, a model, loads.
namespace softfinger::commands {

struct ContactChoice {
  CaseInput typed_case;
  std::string model, load, load_range, fit = "nominal";  ///< no model: the recommended one
  DemandInput demand;
  std::string at_time;  ///< for a case that knows time, where the command takes one; may be empty
  bool force = false;   ///< also where the answer is not usable

  exporting::Fit kind_of_fit() const;
};

/// --model, --load, --load-range, --fit, --tolerance, --quantities and --force. The case's own
/// options are add_case's, with a load of its own.
void add_contact_choice(CLI::App& command, ContactChoice& choice);

/// Refuses an unknown model, and loads and demands that are none.
/// @throws InputError
void check_contact_choice(const ContactChoice& choice);

/// @throws InputError as check_contact_choice, and for the case
input::Case read_contact_case(const ContactChoice& choice);

/// The nominal load and the range of a case.
/// @throws InputError
exporting::LoadRange loads_of(const input::Case& contact_case, const ContactChoice& choice);

/// Remarks on meshes go to standard error.
/// @throws InputError
exporting::ContactCurve ask_contact_curve(const input::Case& contact_case,
                                          const ContactChoice& choice);
/// @param resolver  of the same case
exporting::ContactCurve ask_contact_curve(const input::Case& contact_case,
                                          const prediction::GeometryResolver& resolver,
                                          const ContactChoice& choice);

/// The second line of an answer that is not usable.
constexpr const char* kHowToForce =
    "Nothing is printed or written to be used; --force does it all the same\n";

/// @throws InputError with the nearest name
const exporting::Simulator& simulator_by_name(const std::string& name);

/// "± 4.2 %", "± ?" where it is not known.
std::string short_error(const exporting::LoadPoint& point);

/// "2 N: torque 4.49 mN·m ± 1.4 %, by fingertip_layer; contact 5.1 x 3.7 mm; e_n 1.87 mm", or
/// "NOT USABLE: ..." with the reason and what to do.
std::string answer_line(const exporting::ContactCurve& curve);

}  // namespace softfinger::commands
