#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "comparisons/commands/case_input.h"
#include "comparisons/exporting/contact_curve.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/input/case.h"

/// What `export` and `apply` are told of the contact: a case, a model, loads.
namespace softfinger::commands {

struct ContactChoice {
  CaseInput typed_case;
  std::string model = "bonded_layer", load, load_range, fit = "nominal";
  double tolerance = 0.1;

  exporting::Fit kind_of_fit() const;
};

/// --model, --load, --load-range, --fit and --tolerance. The case's own options are add_case's,
/// with a load of its own.
void add_contact_choice(CLI::App& command, ContactChoice& choice);

/// @throws InputError, also for an unknown model and for loads that are none
input::Case read_contact_case(const ContactChoice& choice);

/// Remarks on meshes, and on a model that is not known to be within the tolerance, go to standard
/// error.
/// @throws InputError
exporting::ContactCurve ask_contact_curve(const input::Case& contact_case,
                                          const ContactChoice& choice);

/// @throws InputError with the nearest name
const exporting::Simulator& simulator_by_name(const std::string& name);

/// "±4.2 %", "±?" where it is not known.
std::string short_error(const exporting::LoadPoint& point);

/// "±4.2 % of the finger's", or why that is not known.
std::string error_in_words(const exporting::LoadPoint& point);

}  // namespace softfinger::commands
