// needs header: mujoco/mujoco.h
// needs libraries: mujoco
// needs package: libmujoco-dev
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "comparisons/benchmark/engine.h"
#include "comparisons/benchmark/load_mujoco.h"
#ifdef SOFTFINGER_MUJOCO_PLUGIN
#include "comparisons/exporting/mujoco/softfinger_mujoco.h"
#endif

/// MuJoCo as it is; as its manual recommends for grasping (elliptic cones, a large impratio,
/// torsional friction on); with the lines of `softfinger export`; and with libsoftfinger_mujoco
/// beside them.
namespace softfinger::benchmark {
namespace {

enum class Kind { standard, recommended, exported, plugin };

std::string numbers(const Eigen::Vector3d& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}

std::string friction(const Scene& scene, const Body& body, Kind kind) {
  const double mu = scene.contact.load.friction_coefficient;
  const bool is_pad = body.shape == Body::Shape::box;
  switch (kind) {
    case Kind::standard:
      return fmt::format("friction=\"{:.17g}\"", mu);
    case Kind::recommended:
      return fmt::format("condim=\"4\" friction=\"{:.17g}\"", mu);
    default:
      if (is_pad) return fmt::format("condim=\"3\" priority=\"1\" friction=\"{:.17g}\"", mu);
      return fmt::format("condim=\"4\" priority=\"1\" friction=\"{:.17g} {:.17g} 0.0001\"", mu,
                         mu * eccentricity_m(scene.contact, scene.contact.load.normal_force_N));
  }
}

/// A shape's type; MuJoCo's capsules lie along z.
const char* type_text(Body::Shape shape) {
  switch (shape) {
    case Body::Shape::ball:
      return "\"sphere\"";
    case Body::Shape::capsule:
      return "\"capsule\" euler=\"-90 0 0\"";
    default:
      return "\"box\"";
  }
}

std::string model_text(const Scene& scene, Kind kind) {
  const bool is_exported = kind == Kind::exported || kind == Kind::plugin;
  std::string text = fmt::format("<mujoco><option timestep=\"{:.17g}\" gravity=\"{}\"{}{}/>",
                                 scene.time_step_s, numbers(scene.gravity_m_per_s2),
                                 kind == Kind::standard ? "" : " cone=\"elliptic\" impratio=\"10\"",
                                 is_exported ? " noslip_iterations=\"5\"" : "");
  std::string listed;
  for (const Body& body : scene.bodies)
    if (body.is_fingertip && body.shape == Body::Shape::ball && kind == Kind::plugin) {
      const ContactProblem& contact = scene.contact;
      listed += fmt::format(
          "<numeric name=\"softfinger:{}\" data=\"{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} "
          "{:.17g} {:.17g}\"/>",
          body.name, contact.radii.major_m, contact.radii.minor_m, contact.layer.thickness_m,
          contact.layer.youngs_modulus_Pa, contact.layer.poisson_ratio,
          contact.finger_curvature.xx_per_m, contact.finger_curvature.yy_per_m,
          contact.finger_curvature.xy_per_m);
    }
  if (!listed.empty()) text += "<custom>" + listed + "</custom>";
  text += "<worldbody>";
  for (const Body& body : scene.bodies) {
    const std::string geom = fmt::format(
        "<geom name=\"{}\" type={} size=\"{}\" mass=\"{:.17g}\" {}/>", body.name,
        type_text(body.shape),
        numbers(is_exported ? exported_half_size_m(scene, body) : body.half_size_m), body.mass_kg,
        body.is_fingertip ? friction(scene, body, kind)
                          : fmt::format("friction=\"{:.17g}\"", scene.rigid_friction_coefficient));
    const char* const joint = body.freedom == Body::Freedom::all ? "<freejoint/>"
                              : body.freedom == Body::Freedom::along_x
                                  ? "<joint type=\"slide\" axis=\"1 0 0\"/>"
                                  : "";
    text += fmt::format("<body name=\"{}\" pos=\"{}\">{}{}</body>", body.name,
                        numbers(body.position_m), joint, geom);
  }
  return text + "</worldbody></mujoco>";
}

State state_of(const mjModel* model, const mjData* data, int body) {
  State state;
  const mjtNum* const q = data->xquat + 4 * body;
  state.position_m = Eigen::Map<const Eigen::Vector3d>(data->xpos + 3 * body);
  state.orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  mjtNum velocity[6];
  mj_objectVelocity(model, data, mjOBJ_BODY, body, velocity, 0);
  state.angular_velocity_rad_per_s = Eigen::Map<const Eigen::Vector3d>(velocity);
  state.velocity_m_per_s = Eigen::Map<const Eigen::Vector3d>(velocity + 3);
  return state;
}

Motion run(const Scene& scene, Kind kind) {
  Motion motion;
  // MuJoCo prints warnings on standard output and into a file; they are counted below.
  mju_user_warning = [](const char*) {};
  const MujocoModel model = load_mujoco(model_text(scene, kind), motion.failure);
  if (!model) return motion;
#ifdef SOFTFINGER_MUJOCO_PLUGIN
  char error[1000] = "";
  std::unique_ptr<softfinger_mujoco, decltype(&softfinger_mujoco_free)> plugin(
      nullptr, softfinger_mujoco_free);
  const bool is_listed = std::any_of(
      scene.bodies.begin(), scene.bodies.end(),
      [](const Body& body) { return body.is_fingertip && body.shape == Body::Shape::ball; });
  if (kind == Kind::plugin && is_listed) {
    plugin.reset(softfinger_mujoco_create(model.get(), error, sizeof error));
    if (!plugin) {
      motion.failure = error;
      return motion;
    }
    softfinger_mujoco_install(plugin.get());
  }
#endif
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(model.get()),
                                                               mj_deleteData);
  std::size_t next = 0;
  const int steps = int(std::lround(scene.duration_s / scene.time_step_s));
  const auto start = std::chrono::steady_clock::now();
  for (motion.steps = 0; motion.steps < steps;) {
    const double time_s = motion.steps * scene.time_step_s;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      const Load load = scene.load_at(int(i), time_s);
      mjtNum* const applied = data->xfrc_applied + 6 * (i + 1);
      Eigen::Map<Eigen::Vector3d>(applied + 0) = load.force_N;
      Eigen::Map<Eigen::Vector3d>(applied + 3) = load.torque_Nm;
    }
    mj_step(model.get(), data.get());
    ++motion.steps;
    if (next < scene.sample_times_s.size() &&
        motion.steps * scene.time_step_s >= scene.sample_times_s[next] - scene.time_step_s / 2) {
      mj_kinematics(model.get(), data.get());
      mj_comPos(model.get(), data.get());
      mj_comVel(model.get(), data.get());
      motion.samples.emplace_back();
      for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        motion.samples.back().push_back(state_of(model.get(), data.get(), int(i) + 1));
      ++next;
    }
  }
  motion.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (int warning = 0; warning < mjNWARNING; ++warning)
    if (data->warning[warning].number > 0)
      motion.failure = mju_warningText(warning, data->warning[warning].lastinfo);
  return motion;
}

}  // namespace

std::vector<Engine> mujoco_engines() {
  const std::string version = fmt::format("MuJoCo {}", mj_versionString());
  std::vector<Engine> engines = {
      {"mujoco_default", version + ", defaults",
       "mu; condim 3 without torsional friction, pyramidal cone",
       [](const Scene& scene) { return run(scene, Kind::standard); }},
      {"mujoco_recommended", version + ", recommended for grasping",
       "mu; elliptic cone, impratio 10, condim 4: torsional friction of 5 mm",
       [](const Scene& scene) { return run(scene, Kind::recommended); }},
      {"mujoco_exported", version + ", lines of softfinger export",
       "mu, mu e_n, pads as boxes; elliptic cone, impratio 10, noslip 5",
       [](const Scene& scene) { return run(scene, Kind::exported); }}};
#ifdef SOFTFINGER_MUJOCO_PLUGIN
  engines.push_back({"mujoco_plugin", version + ", libsoftfinger_mujoco",
                     "as exported, but e_n(P) of the last step's load",
                     [](const Scene& scene) { return run(scene, Kind::plugin); }});
#endif
  return engines;
}

}  // namespace softfinger::benchmark
