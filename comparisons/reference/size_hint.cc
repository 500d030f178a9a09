#include "comparisons/reference/size_hint.h"

#include <cmath>

#include "softfinger/pressure/pressure_model.h"

namespace softfinger::reference {
namespace {

bool is_tapered(const PlacedBody& placed) {
  const auto* quadric = std::get_if<input::QuadricBody>(&placed.body);
  return quadric && quadric->shape == input::FingerShape::tapered;
}

}  // namespace

std::optional<std::array<double, 2>> size_hint_m(const FemProblem& problem) {
  if (!problem.sublayers.empty() || problem.approach_m) return std::nullopt;
  if (problem.bodies && is_tapered(problem.bodies->pad)) return std::nullopt;
  ContactProblem contact;
  contact.radii = problem.radii;
  contact.layer = problem.layer;
  contact.load.normal_force_N = problem.load_N;
  contact.is_object_spherical = std::isfinite(problem.sphere_radius_m);
  const char* model = problem.finite_strain ? "finite_strain_layer" : "bonded_layer";
  const Prediction found = find_pressure_model(model)->predict(contact);
  if (!found.has_answer) return std::nullopt;
  return {{found.a_m, found.b_m}};
}

}  // namespace softfinger::reference
