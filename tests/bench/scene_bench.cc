// Prints steps per second of built-in scenes and of two stacks of boxes, beside MuJoCo's on the
// same bodies, joints, motors and friction at the same time step; and how far what should rest
// moves. What differs is said in comparisons/benchmark/README.md.

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "comparisons/benchmark/load_mujoco.h"
#include "comparisons/input/scene.h"
#include "comparisons/simulation/simulate.h"
#include "comparisons/system/program_paths.h"

namespace {

using namespace softfinger;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// A scene, and what should rest in it: a body and the one that holds it.
struct Question {
  input::Scene scene;
  std::string body, holder;
};

/// Ten boxes of 40 x 40 x 20 mm and 32 g on a table, each turned by so much against the one below.
input::Scene stack_of_ten(const std::string& id, double turn_deg) {
  std::string text = fmt::format(
      "id = \"{}\"\n[simulation]\ntime_step_ms = 1\nduration_s = 2\n[[body]]\nname = \"table\"\n"
      "fixed = true\nshapes = [{{ half_space = true }}]\n",
      id);
  const bool is_turned = turn_deg != 0;
  for (int i = 0; i < 10; ++i)
    text += fmt::format(
        "[[body]]\nname = \"box_{}\"\nposition_mm = [{}, {}, {}]\nrotation_deg = [0, 0, {}]\n"
        "shapes = [{{ box_size_mm = [40, 40, 20] }}]\ndensity_kg_per_m3 = 1000\n",
        i, is_turned ? (i % 2 ? -0.7 : 0.7) : 0, is_turned ? 0.4 * (i % 3) : 0, 10 + 20 * i,
        turn_deg * i);
  return input::parse_scene(text, id + ".toml");
}

std::string numbers(const Vector3d& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}

std::string pose_text(const Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return fmt::format("pos=\"{}\" quat=\"{:.17g} {:.17g} {:.17g} {:.17g}\"",
                     numbers(pose.translation()), q.w(), q.x(), q.y(), q.z());
}

/// A scene as MJCF. Friction is that of explicit pairs of geoms.
class Mjcf {
 public:
  /// @param arms_m  e_n by pair of bodies
  /// @param is_stiff  contacts as stiff as MuJoCo allows at this time step, elliptic cones and a
  ///   large impratio, as its manual recommends for grasping; else its defaults
  Mjcf(const input::Scene& scene, std::map<std::pair<int, int>, double> arms_m, bool is_stiff)
      : scene_(scene), arms_m_(std::move(arms_m)), is_stiff_(is_stiff) {
    if (!scene.loops.empty() || !scene.forces.empty())
      throw std::runtime_error(scene.id + ": loops and forces are not translated");
  }

  std::string text() {
    for (int b = 0; b < int(scene_.bodies.size()); ++b)
      if (const JointDescription* joint = joint_of(b); !joint || joint->parent < 0)
        add_body(b, Isometry3d::Identity());
    return fmt::format(
        "<mujoco><compiler angle=\"radian\"/><size njmax=\"4000\" nconmax=\"1000\"/>"
        "<option timestep=\"{:.17g}\"{}/><worldbody>{}</worldbody>"
        "<contact>{}</contact></mujoco>",
        scene_.time_step_s, is_stiff_ ? " cone=\"elliptic\" impratio=\"10\"" : "", bodies_,
        pairs());
  }

 private:
  const JointDescription* joint_of(int body) const {
    for (const JointDescription& joint : scene_.joints)
      if (joint.child == body) return &joint;
    return nullptr;
  }

  void add_body(int b, const Isometry3d& parent) {
    const BodyDescription& body = scene_.descriptions[std::size_t(b)];
    bodies_ += fmt::format("<body name=\"b{}\" {}>", b, pose_text(parent.inverse() * body.pose));
    const JointDescription* joint = joint_of(b);
    if (joint)
      add_joint(*joint, body.pose);
    else if (!body.fixed)
      bodies_ += "<freejoint/>";
    if (!body.fixed) {
      const Eigen::Matrix3d& inertia = body.mass.inertia_kg_m2;
      bodies_ += fmt::format(
          "<inertial pos=\"{}\" mass=\"{:.17g}\" fullinertia=\"{:.17g} {:.17g} {:.17g} {:.17g} "
          "{:.17g} {:.17g}\"/>",
          numbers(body.mass.center_m), body.mass.mass_kg, inertia(0, 0), inertia(1, 1),
          inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2));
    }
    const auto& shapes = scene_.bodies[std::size_t(b)].shapes;
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      Isometry3d pose = shapes[s].pose;
      const std::string shape = kind(shapes[s].kind, pose);
      bodies_ += fmt::format("<geom name=\"{}\" contype=\"0\" conaffinity=\"0\" {} {}/>",
                             geom(b, int(s)), pose_text(pose), shape);
    }
    for (const JointDescription& next : scene_.joints)
      if (next.parent == b) add_body(next.child, body.pose);
    bodies_ += "</body>";
  }

  void add_joint(const JointDescription& joint, const Isometry3d& pose) {
    if (joint.kind == JointKind::fixed) return;
    const bool slides = joint.kind == JointKind::prismatic;
    double damping = 0;
    for (const Motor& motor : scene_.motors)
      if (scene_.joints[std::size_t(motor.joint)].child == joint.child) damping = motor.damping;
    bodies_ += fmt::format(
        "<joint name=\"j{}\" type=\"{}\" pos=\"{}\" axis=\"{}\" ref=\"{:.17g}\" "
        "damping=\"{:.17g}\" armature=\"{:.17g}\"",
        joint.child, slides ? "slide" : "hinge",
        numbers(slides ? Vector3d(0, 0, 0) : Vector3d(pose.inverse() * joint.anchor_m)),
        numbers(pose.linear().transpose() * joint.axis), joint.start, damping, joint.rotor_inertia);
    if (std::isfinite(joint.lower) && std::isfinite(joint.upper))
      bodies_ +=
          fmt::format(" limited=\"true\" range=\"{:.17g} {:.17g}\"", joint.lower, joint.upper);
    bodies_ += "/>";
  }

  /// @param pose  of the shape, which becomes that of the geom
  std::string kind(const input::ShapeKind& shape, Isometry3d& pose) const {
    if (const auto* sphere = std::get_if<input::Sphere>(&shape))
      return fmt::format("type=\"sphere\" size=\"{:.17g}\"", sphere->radius_m);
    if (const auto* capsule = std::get_if<input::Capsule>(&shape))
      return fmt::format("type=\"capsule\" size=\"{:.17g} {:.17g}\"", capsule->radius_m,
                         capsule->length_m / 2);
    if (const auto* box = std::get_if<input::Box>(&shape))
      return fmt::format("type=\"box\" size=\"{}\"", numbers(box->size_m / 2));
    if (std::holds_alternative<input::HalfSpace>(shape)) return "type=\"plane\" size=\"1 1 1\"";
    const auto* mesh = std::get_if<input::Mesh>(&shape);
    if (!mesh) throw std::runtime_error(scene_.id + ": a shape that is not translated");
    // The cylinder around it, about the shape's z axis: MuJoCo itself takes a mesh's convex hull.
    double radius_m = 0;
    Eigen::AlignedBox3d box;
    for (const Vector3d& vertex : mesh->surface->vertices_m) {
      radius_m = std::max(radius_m, vertex.head<2>().norm());
      box.extend(vertex);
    }
    pose.translation() += pose.linear().col(2) * box.center().z();
    return fmt::format("type=\"cylinder\" size=\"{:.17g} {:.17g}\"", radius_m, box.sizes().z() / 2);
  }

  std::string pairs() const {
    std::string text;
    const int count = int(scene_.bodies.size());
    for (int a = 0; a < count; ++a)
      for (int b = a + 1; b < count; ++b) {
        const input::ContactRule& rule = scene_.rule(a, b);
        const bool can_move = !scene_.descriptions[std::size_t(a)].fixed ||
                              !scene_.descriptions[std::size_t(b)].fixed;
        const bool are_joined =
            std::any_of(scene_.joints.begin(), scene_.joints.end(), [&](const auto& joint) {
              return std::minmax(joint.parent, joint.child) == std::minmax(a, b);
            });
        if (!rule.collide || !can_move || are_joined) continue;
        const auto arm = arms_m_.find({a, b});
        const double mu = rule.shear_law.friction_coefficient;
        const double torsional_m = arm == arms_m_.end() ? 0 : mu * arm->second;
        for (std::size_t i = 0; i < scene_.bodies[std::size_t(a)].shapes.size(); ++i)
          for (std::size_t j = 0; j < scene_.bodies[std::size_t(b)].shapes.size(); ++j)
            text += fmt::format(
                "<pair geom1=\"{}\" geom2=\"{}\" condim=\"{}\" friction=\"{:.17g} {:.17g} {:.17g} "
                "0.0001 0.0001\" solref=\"{:.17g} 1\"/>",
                geom(a, int(i)), geom(b, int(j)), torsional_m > 0 ? 4 : 3, mu, mu,
                std::max(torsional_m, 1e-5), is_stiff_ ? 2 * scene_.time_step_s : 0.02);
      }
    return text;
  }

  static std::string geom(int body, int shape) { return fmt::format("g{}_{}", body, shape); }

  const input::Scene& scene_;
  std::map<std::pair<int, int>, double> arms_m_;
  bool is_stiff_;
  std::string bodies_;
};

struct Measured {
  double steps_per_s = 0;
  double moved_mm = 0, turned_deg = 0;
  std::string failure;
};

/// Sets how far the body moves (mm) and turns (degrees) in the frame of its holder between two
/// poses, those around the last quarter of the scene.
void measure(const Isometry3d& before, const Isometry3d& after, Measured& measured) {
  measured.moved_mm = 1e3 * (after.translation() - before.translation()).norm();
  measured.turned_deg =
      Eigen::AngleAxisd(before.linear().transpose() * after.linear()).angle() * 180 / M_PI;
}

int index_of(const input::Scene& scene, const std::string& body) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].name == body) return int(b);
  throw std::runtime_error(scene.id + ": no body " + body);
}

constexpr int kRepeats = 5;  // the fastest counts, as others may use the machine

Measured ours(const Question& question, std::map<std::pair<int, int>, double>& arms_m) {
  Measured measured;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const simulation::Simulation run = simulation::simulate(question.scene);
    measured.steps_per_s = std::max(measured.steps_per_s, run.steps / run.wall_s);
    if (repeat > 0) continue;
    measured.failure = run.failure;
    const auto& frames = run.recording.frames;
    const auto body = std::size_t(index_of(question.scene, question.body));
    const auto holder = std::size_t(index_of(question.scene, question.holder));
    const auto held = [&](const simulation::Frame& frame) {
      return frame.poses[holder].inverse() * frame.poses[body];
    };
    measure(held(frames[3 * (frames.size() - 1) / 4]), held(frames.back()), measured);
    std::map<std::pair<int, int>, int> counts;
    for (const simulation::Frame& frame : frames)
      for (const simulation::RecordedContact& contact : frame.contacts)
        if (contact.eccentricity_m > 0) {
          const std::pair<int, int> pair = std::minmax(contact.a, contact.b);
          arms_m[pair] += (contact.eccentricity_m - arms_m[pair]) / ++counts[pair];
        }
  }
  return measured;
}

/// Gravity and motors as they are at the end of the coming step. The damping of motors is the
/// joints', which MuJoCo integrates implicitly; their stiffness acts explicitly.
void command(const input::Scene& scene, double time_s, mjModel* model, mjData* data) {
  const Vector3d gravity = scene.gravity.value(time_s);
  std::copy(gravity.begin(), gravity.end(), model->opt.gravity);
  std::vector<Motor> motors = scene.motors;
  for (const input::Motion& motion : scene.motions) {
    Motor& motor = motors[std::size_t(motion.motor)];
    if (motion.is_effort) {
      motor.feed_forward = motion.table.value(time_s)[0];
    } else {
      motor.target = motion.table.value(time_s)[0];
      motor.target_velocity = motion.table.rate(time_s)[0];
    }
  }
  for (const Motor& motor : motors) {
    const std::string name = fmt::format("j{}", scene.joints[std::size_t(motor.joint)].child);
    const int joint = mj_name2id(model, mjOBJ_JOINT, name.c_str());
    const double effort = motor.feed_forward + motor.damping * motor.target_velocity +
                          motor.stiffness * (motor.target - data->qpos[model->jnt_qposadr[joint]]);
    data->qfrc_applied[model->jnt_dofadr[joint]] =
        std::clamp(effort, -motor.max_effort, motor.max_effort);
  }
}

Measured mujocos(const Question& question, const std::map<std::pair<int, int>, double>& arms_m,
                 bool is_stiff) {
  Measured measured;
  const input::Scene& scene = question.scene;
  const MujocoModel model = load_mujoco(Mjcf(scene, arms_m, is_stiff).text(), measured.failure);
  if (!model) return measured;
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(model.get()),
                                                               mj_deleteData);
  const auto pose = [&](const std::string& body) {
    const std::string name = fmt::format("b{}", index_of(scene, body));
    const int b = mj_name2id(model.get(), mjOBJ_BODY, name.c_str());
    const mjtNum* q = data->xquat + 4 * b;
    Isometry3d result = Isometry3d::Identity();
    result.translation() = Eigen::Map<const Vector3d>(data->xpos + 3 * b);
    result.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
    return result;
  };
  const auto held = [&] {
    mj_kinematics(model.get(), data.get());
    return pose(question.holder).inverse() * pose(question.body);
  };
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    mj_resetData(model.get(), data.get());
    Isometry3d before = Isometry3d::Identity();
    double wall_s = 0;
    for (int step = 0; step < scene.steps(); ++step) {
      if (step == 3 * scene.steps() / 4) before = held();
      const auto start = std::chrono::steady_clock::now();
      command(scene, (step + 1) * scene.time_step_s, model.get(), data.get());
      mj_step(model.get(), data.get());
      wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    measured.steps_per_s = std::max(measured.steps_per_s, scene.steps() / wall_s);
    measure(before, held(), measured);
    for (int warning = 0; warning < mjNWARNING; ++warning)
      if (data->warning[warning].number > 0)
        measured.failure = mju_warningText(warning, data->warning[warning].lastinfo);
  }
  return measured;
}

void print(const std::string& scene, const char* engine, const Measured& measured) {
  fmt::print("{:<14} {:<20} {:>8.0f} {:>12.3g} {:>12.3g}  {}\n", scene, engine,
             measured.steps_per_s, measured.moved_mm, measured.turned_deg, measured.failure);
  std::fflush(stdout);
}

}  // namespace

int main() {
  mju_user_warning = [](const char*) {};
  const auto built_in = [](const char* name) {
    return input::read_scene(system::find_scene_file(name));
  };
  const std::vector<Question> questions = {{built_in("lift_box"), "object", "left_tip"},
                                           {built_in("drag_box"), "object", "left_tip"},
                                           {built_in("pick_glass"), "glass", "palm"},
                                           {stack_of_ten("stack", 0), "box_9", "table"},
                                           {stack_of_ten("turned_stack", 7), "box_9", "table"}};
  fmt::print("{:<14} {:<20} {:>8} {:>12} {:>12}\n", "scene", "engine", "steps/s", "moved (mm)",
             "turned (deg)");
  for (const Question& question : questions) {
    std::map<std::pair<int, int>, double> arms_m;
    print(question.scene.id, "softfinger", ours(question, arms_m));
    print(question.scene.id, "MuJoCo, defaults", mujocos(question, arms_m, false));
    print(question.scene.id, "MuJoCo, stiff", mujocos(question, arms_m, true));
  }
}
