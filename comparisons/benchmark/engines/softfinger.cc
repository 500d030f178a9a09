#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/benchmark/engine.h"
#include "comparisons/simulation/simulate.h"

/// `softfinger simulate` with contacts of fingertip_layer: e_n(P) is found together with P.
namespace softfinger::benchmark {
namespace {

std::string numbers(const Eigen::Vector3d& v) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z());
}

/// The loads of a body as straight lines between times; a step lasts a thousandth of a time step.
std::string force_text(const Scene& scene, int body) {
  std::string times, forces, torques;
  Load before;
  for (const Load& load : scene.loads) {
    if (load.body != body) continue;
    const auto add = [&](double time_s, const Load& value) {
      times += fmt::format("{}{:.17g}", times.empty() ? "" : ", ", time_s);
      forces += (forces.empty() ? "" : ", ") + numbers(value.force_N);
      torques += (torques.empty() ? "" : ", ") + numbers(value.torque_Nm);
    };
    // A load from t on acts in the step that begins at t.
    const double change_s = load.from_s - scene.time_step_s / 2;
    if (change_s > 0) add(change_s, before);
    add(std::max(0., change_s + 1e-3 * scene.time_step_s), load);
    before = load;
  }
  if (times.empty()) return "";
  return fmt::format("[[force]]\nbody = \"{}\"\ntime_s = [{}]\nforce_N = [{}]\ntorque_Nm = [{}]\n",
                     scene.bodies[std::size_t(body)].name, times, forces, torques);
}

std::string shape_text(const Body& body) {
  const Eigen::Vector3d half_mm = 1e3 * body.half_size_m;
  switch (body.shape) {
    case Body::Shape::ball:
      return fmt::format("sphere_radius_mm = {:.17g}", half_mm.x());
    case Body::Shape::capsule:
      return fmt::format("capsule_radius_length_mm = [{:.17g}, {:.17g}], rotation_deg = [90, 0, 0]",
                         half_mm.x(), 2 * half_mm.y());
    default:
      return "box_size_mm = " + numbers(2 * half_mm);
  }
}

std::string scene_text(const Scene& scene, bool is_soft) {
  const ContactProblem& contact = scene.contact;
  std::string text = fmt::format(
      "id = \"benchmark\"\n[simulation]\ntime_step_ms = {:.17g}\nduration_s = {:.17g}\n"
      "gravity_m_per_s2 = {}\n",
      1e3 * scene.time_step_s, scene.duration_s, numbers(scene.gravity_m_per_s2));
  if (scene.has_fingertips())
    text += fmt::format(
        "[[layer]]\nname = \"layer\"\nthickness_mm = {:.17g}\nyoungs_modulus_kPa = {:.17g}\n"
        "poisson_ratio = {:.17g}\n",
        1e3 * contact.layer.thickness_m, 1e-3 * contact.layer.youngs_modulus_Pa,
        contact.layer.poisson_ratio);
  std::string rest;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    text += fmt::format("[[body]]\nname = \"{}\"\nposition_mm = {}\nshapes = [{{ {} }}]\n",
                        body.name, numbers(1e3 * body.position_m), shape_text(body));
    text += body.freedom == Body::Freedom::none
                ? std::string("fixed = true\n")
                : fmt::format("mass_g = {:.17g}\n", 1e3 * body.mass_kg);
    if (body.is_fingertip) {
      if (is_soft) text += "layer = \"layer\"\n";
      rest += fmt::format(
          "[[contact]]\nbodies = [\"{}\", \"*\"]\nfriction_coefficient = {:.17g}\n"
          "model = \"{}\"\n",
          body.name, contact.load.friction_coefficient,
          is_soft && body.shape == Body::Shape::ball ? "fingertip_layer" : "auto");
    }
    if (body.freedom == Body::Freedom::along_x)
      rest += fmt::format(
          "[[joint]]\nname = \"slide_{0}\"\nkind = \"prismatic\"\nparent = \"world\"\n"
          "child = \"{0}\"\naxis = [1, 0, 0]\n",
          body.name);
    rest += force_text(scene, int(i));
  }
  if (!scene.has_fingertips())
    rest += fmt::format("[[contact]]\nbodies = [\"*\", \"*\"]\nfriction_coefficient = {:.17g}\n",
                        scene.rigid_friction_coefficient);
  return text + rest;
}

Motion run(const Scene& scene, bool is_soft) {
  Motion motion;
  const simulation::Simulation done =
      simulation::simulate(input::parse_scene(scene_text(scene, is_soft), "benchmark.toml"));
  // A frame at the start, and one after each step.
  const auto& frames = done.recording.frames;
  for (const double time_s : scene.sample_times_s) {
    const auto at = std::size_t(std::lround(time_s / scene.time_step_s));
    if (at >= frames.size()) break;
    const simulation::Frame& frame = frames[at];
    motion.samples.emplace_back();
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
      motion.samples.back().push_back({frame.poses[i].translation(), frame.velocities_m_per_s[i],
                                       Eigen::Quaterniond(frame.poses[i].rotation()),
                                       frame.angular_velocities_rad_per_s[i]});
  }
  motion.steps = done.steps;
  motion.wall_s = done.wall_s;
  motion.failure = done.failure;
  return motion;
}

}  // namespace

std::vector<Engine> softfinger_engines() {
  return {{"softfinger", "softfinger simulate", "layer and shapes; e_n(P) in the same step as P",
           [](const Scene& scene) { return run(scene, true); }},
          {"softfinger_rigid", "softfinger simulate, rigid",
           "mu; points without torque, four at the corners of a face",
           [](const Scene& scene) { return run(scene, false); }}};
}

}  // namespace softfinger::benchmark
