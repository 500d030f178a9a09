#pragma once

#include "fem/problem/problem.h"
#include "fem/problem/result.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

/// Checks what can be checked before anything is solved.
/// @throws InputError for a value outside its range and for requests that exclude each other
void check_problem(const Problem& problem);

/// The contact's load or its approach, whichever was given, is too large: an error that names it.
InputError too_much(const Problem& problem, const std::string& allowed);

/// The twist's axis has to lie in the contact, whose size is known only after a first mesh.
/// @throws InputError
void check_twist_axis(const Problem& problem, const LevelResult& contact);

}  // namespace softfinger::fem
