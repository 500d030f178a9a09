#include "comparisons/benchmark/engine.h"

#include <algorithm>

#include "softfinger/accuracy/default_model.h"

namespace softfinger::benchmark {

Eigen::Vector3d Body::inertia_kg_m2() const {
  const Eigen::Vector3d square = half_size_m.cwiseAbs2();
  if (shape == Shape::ball) return 0.4 * mass_kg * square;
  return mass_kg / 3 * (square.sum() - square.array()).matrix();
}

bool Scene::has_fingertips() const {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& body) { return body.is_fingertip; });
}

Load Scene::load_at(int body, double time_s) const {
  Load found;
  found.body = body;
  // Half a step is the rounding of the steps' times.
  for (const Load& load : loads)
    if (load.body == body && load.from_s <= time_s + time_step_s / 2) found = load;
  return found;
}

double eccentricity_m(ContactProblem contact, double load_N) {
  contact.load.normal_force_N = load_N;
  return default_model(contact).predict(contact).torque_arm_exact_m;
}

}  // namespace softfinger::benchmark
