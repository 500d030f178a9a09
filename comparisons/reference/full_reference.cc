#include "comparisons/reference/full_reference.h"

#include <algorithm>
#include <cmath>

#include "softfinger/pressure/pressure_model.h"

namespace softfinger::reference {
namespace {

/// Below both, finite strain moves no number of a contact on a flat layer by more than the finite
/// elements state at level 2: in the atlas at finite strain the torque moves by 0.08 % at a strain
/// of 0.4 % and a slope of 0.015, by 0.24 % at 1.3 % and 0.03, of which 0.07 % are stated.
constexpr double negligible_strain = 0.005, negligible_slope = 0.02;

bool has_two_layers(const input::Case& contact_case) {
  return contact_case.object_layer.thickness_m > 0;
}

/// The curved layer is the finger's, and the only one.
bool can_be_curved(const input::Case& contact_case) {
  return std::holds_alternative<input::BodyPair>(contact_case.geometry) &&
         !contact_case.layer_on_object && !has_two_layers(contact_case) &&
         contact_case.fem_mesh.empty();
}

bool needs_finite_strain(const input::Case& contact_case,
                         const prediction::GeometryResolver& geometry,
                         std::optional<double> approach_m) {
  if (approach_m && *approach_m > negligible_strain * contact_case.layer.thickness_m) return true;
  const double load_N = *std::max_element(contact_case.loads_N.begin(), contact_case.loads_N.end());
  const prediction::GeometryResolver resolver(contact_case, &geometry);
  const prediction::LocalGeometry place = resolver.place(load_N);
  // Without an ellipse no closed form tells.
  if (!place.no_ellipse.empty()) return true;
  const ContactProblem problem = contact_case.problem(place.radii, load_N);
  // A layer is touched inside of where the quadric is sunk in, b^2 = 2 R'' d, at most.
  if (approach_m) return std::sqrt(2 * *approach_m / problem.radii.minor_m) > negligible_slope;
  const Prediction found = find_pressure_model("bonded_layer")->predict(problem);
  if (!found.has_answer) return true;
  return found.indentation_m > negligible_strain * problem.layer.thickness_m ||
         found.a_m > negligible_slope * problem.radii.major_m ||
         found.b_m > negligible_slope * problem.radii.minor_m;
}

}  // namespace

input::Case with_full_reference(input::Case contact_case,
                                const prediction::GeometryResolver& geometry,
                                const Idealisations& idealisations,
                                std::optional<double> approach_m) {
  if (!contact_case.fem_geometry_typed && can_be_curved(contact_case) && !idealisations.flat)
    contact_case.fem_curved = true;
  if (!contact_case.fem_kinematics_typed && contact_case.fem_mesh.empty() &&
      !has_two_layers(contact_case) && !idealisations.linear &&
      needs_finite_strain(contact_case, geometry, approach_m))
    contact_case.fem_finite.emplace();
  input::settle_finger_shape(contact_case);
  return contact_case;
}

bool is_full_reference(const input::Case& solved, const prediction::GeometryResolver& geometry,
                       std::optional<double> approach_m) {
  return (solved.fem_curved || !can_be_curved(solved)) &&
         (solved.fem_finite || !needs_finite_strain(solved, geometry, approach_m));
}

}  // namespace softfinger::reference
