#pragma once

#include <string>
#include <vector>

#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"

/// Cases, geometry and answers as text for people, in mm, kPa, mN·m.
namespace softfinger::prediction {

/// Lines about the power law that was fitted to a case's data: its parameters and scatter, and
/// which loads lie outside the data. Empty without data.
std::vector<std::string> power_law_remarks(const input::Case& contact_case);

/// "20 mm"; "flat" for an infinite radius.
std::string millimetres(double length_m);

/// "friction 0.8 up to a shear strength of 40 kPa".
std::string describe(const ShearLaw& law);

/// "x, layer 2 mm, E 300 kPa, nu 0.49, friction 0.8": the checked input, echoed before any result.
std::string describe(const input::Case& contact_case);

/// "R' 20 mm, R'' 5 mm, axis 0°" and, for meshes, how well the patch agrees.
std::string describe(const LocalGeometry& geometry);

/// The answers for one load as a table in mm, kPa, mN·m, and why models do not hold.
std::string table(const std::vector<ModelAnswer>& answers, TorqueRule rule);

}  // namespace softfinger::prediction
