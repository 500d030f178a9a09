#include "comparisons/benchmark/engine.h"

#include <algorithm>

#include "comparisons/exporting/pad_face.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/pads/pad_model.h"

namespace softfinger::benchmark {

Eigen::Vector3d Body::inertia_kg_m2() const {
  const Eigen::Vector3d square = half_size_m.cwiseAbs2();
  if (shape == Shape::ball) return 0.4 * mass_kg * square;
  if (shape == Shape::capsule) {
    const double radius_m = half_size_m.x(), half_m = half_size_m.y();
    const double cylinder_kg = mass_kg * half_m / (half_m + 2 * radius_m / 3);
    const double caps_kg = mass_kg - cylinder_kg;
    const double along = square.x() * (cylinder_kg / 2 + 0.4 * caps_kg);
    const double across = cylinder_kg * (square.x() / 4 + square.y() / 3) +
                          caps_kg * (0.4 * square.x() + square.y() + 0.75 * half_m * radius_m);
    return {across, along, across};
  }
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

double pad_eccentricity_m(const ContactProblem& contact, const Body& pad) {
  const PadShape shape(
      ConvexOutline::rounded_rectangle(2 * pad.half_size_m.y(), 2 * pad.half_size_m.z()));
  PadProblem problem;
  problem.shape = &shape;
  problem.layer = contact.layer;
  problem.load = contact.load;
  return find_pad_model("pad_layer")->predict(problem).eccentricity_m;
}

Eigen::Vector3d exported_half_size_m(const Scene& scene, const Body& body) {
  if (!body.is_fingertip || body.shape != Body::Shape::box) return body.half_size_m;
  exporting::PadFace face;
  face.length_m = 2 * body.half_size_m.y();
  face.width_m = 2 * body.half_size_m.z();
  face.eccentricity_m = pad_eccentricity_m(scene.contact, body);
  const auto [y_m, z_m] = face.corner_box_m();
  return {body.half_size_m.x(), y_m, z_m};
}

}  // namespace softfinger::benchmark
