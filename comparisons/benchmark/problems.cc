#include "comparisons/benchmark/problems.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "softfinger/accuracy/default_model.h"
#include "softfinger/accuracy/error_bound.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::benchmark {
namespace {

using Eigen::Vector3d;

constexpr double kGravity_m_per_s2 = 9.81;
constexpr double kLoadShares[] = {0.1, 1. / 3, 1., 3., 10.};  ///< of the nominal load
constexpr double kFriction = 0.8, kRadius_m = 0.01, kNominal_N = 2;

/// A fingertip of 10 mm radius with 2 mm of silicone, on a flat object.
ContactProblem silicone_on_flat() {
  ContactProblem contact;
  contact.radii = {kRadius_m, kRadius_m, 0};
  contact.layer = {2e-3, 300e3, 0.45};
  contact.load = {kNominal_N, kFriction};
  contact.finger_curvature = {1 / kRadius_m, 1 / kRadius_m, 0};
  return contact;
}

Body ball(const std::string& name, double mass_kg, const Vector3d& position_m) {
  Body body;
  body.name = name;
  body.shape = Body::Shape::ball;
  body.half_size_m.setConstant(kRadius_m);
  body.mass_kg = mass_kg;
  body.position_m = position_m;
  body.is_fingertip = true;
  return body;
}

Body box(const std::string& name, const Vector3d& half_size_m, double mass_kg,
         const Vector3d& position_m) {
  Body body;
  body.name = name;
  body.half_size_m = half_size_m;
  body.mass_kg = mass_kg;
  body.position_m = position_m;
  if (mass_kg == 0) body.freedom = Body::Freedom::none;
  return body;
}

/// Runs the engine and adds what it cost to the score.
Motion run(const Engine& engine, const Scene& scene, Score& score) {
  Motion motion = engine.run(scene);
  score.steps += motion.steps;
  score.wall_s += motion.wall_s;
  if (score.failure.empty()) score.failure = motion.failure;
  return motion;
}

/// The smallest x between two ends for which `moves`, to 1e-4, or the largest for which it does
/// not.
double threshold(double least, double most, bool moves_above,
                 const std::function<bool(double)>& moves) {
  double low = least, high = most;
  while (high - low > 1e-4 * high) {
    const double middle = (low + high) / 2;
    (moves(middle) == moves_above ? high : low) = middle;
  }
  return high;
}

/// Time between the two short spans at the end whose mean velocities give the acceleration. A creep
/// at constant velocity has none, nor has a velocity that alternates from step to step.
constexpr double kWatched_s = 0.2;
constexpr int kAveraged = 20;  ///< steps
void watch_the_end(Scene& scene) {
  scene.sample_times_s.clear();
  for (const double end_s : {scene.duration_s - kWatched_s, scene.duration_s})
    for (int i = kAveraged - 1; i >= 0; --i)
      scene.sample_times_s.push_back(end_s - i * scene.time_step_s);
}

struct Acceleration {
  double linear_m_per_s2 = INFINITY, angular_rad_per_s2 = INFINITY;
};

/// Acceleration of a body at the end; infinite where the engine stopped before.
Acceleration acceleration(const Motion& motion, std::size_t body) {
  if (motion.samples.size() < 2 * kAveraged) return {};
  Vector3d velocity[2], turning[2];
  for (int half = 0; half < 2; ++half) {
    velocity[half].setZero();
    turning[half].setZero();
    for (int i = 0; i < kAveraged; ++i) {
      const State& state = motion.samples[std::size_t(half * kAveraged + i)][body];
      velocity[half] += state.velocity_m_per_s / kAveraged;
      turning[half] += state.angular_velocity_rad_per_s / kAveraged;
    }
  }
  return {(velocity[1].norm() - velocity[0].norm()) / kWatched_s,
          (turning[1].norm() - turning[0].norm()) / kWatched_s};
}

/// Share of the frictionless acceleration below which a contact counts as holding.
constexpr double kSlip = 2e-4;

Score twist(const Engine& engine) {
  Score score;
  for (const double share : kLoadShares) {
    const double load_N = share * kNominal_N;
    Scene scene;
    scene.contact = silicone_on_flat();
    scene.bodies = {box("block", {0.2, 0.2, 0.05}, 0, {0, 0, -0.05}),
                    ball("finger", 0.1, {0, 0, kRadius_m})};
    scene.duration_s = 0.7;
    watch_the_end(scene);
    const double truth_Nm = kFriction * load_N * eccentricity_m(scene.contact, load_N);
    const double free_rad_per_s2 = truth_Nm / scene.bodies[1].inertia_kg_m2().z();
    const double torque_Nm = threshold(0, 20 * truth_Nm, true, [&](double torque) {
      scene.loads = {{1, 0, {0, 0, -load_N}, Vector3d::Zero()},
                     {1, 0.3, {0, 0, -load_N}, {0, 0, torque}}};
      return acceleration(run(engine, scene, score), 1).angular_rad_per_s2 >
             kSlip * free_rad_per_s2;
    });
    score.measured.push_back({fmt::format("slip torque at {:.3g} N", load_N), "mN·m",
                              // A search that finds no torque held ends within its own width of 0.
                              torque_Nm < 1e-3 * truth_Nm ? 0 : 1e3 * torque_Nm, 1e3 * truth_Nm});
  }
  return score;
}

constexpr double kPlateMass_kg = 0.05, kOffset_m = 4e-3;

/// Two fingertips press on a plate. From 0.3 s on its weight acts, 4 mm beside the line between
/// them.
Scene pinched_plate(double grip_N) {
  Scene scene;
  scene.contact = silicone_on_flat();
  scene.bodies = {box("plate", {0.005, 0.03, 0.03}, kPlateMass_kg, Vector3d::Zero()),
                  ball("left", 0.05, {-0.005 - kRadius_m, 0, 0}),
                  ball("right", 0.05, {0.005 + kRadius_m, 0, 0})};
  scene.bodies[1].freedom = scene.bodies[2].freedom = Body::Freedom::along_x;
  const double weight_N = kPlateMass_kg * kGravity_m_per_s2;
  scene.loads = {{1, 0, {grip_N, 0, 0}, Vector3d::Zero()},
                 {2, 0, {-grip_N, 0, 0}, Vector3d::Zero()},
                 {0, 0.3, {0, 0, -weight_N}, {weight_N * kOffset_m, 0, 0}}};
  return scene;
}

/// Each finger has half of weight and torque; on the ellipsoid (f/mu P)² + (T/mu e_n P)² = 1.
double least_grip_N() {
  const ContactProblem contact = silicone_on_flat();
  const double half_N = kPlateMass_kg * kGravity_m_per_s2 / 2;
  double low_N = half_N / kFriction, high_N = 100 * low_N;
  while (high_N - low_N > 1e-9 * high_N) {
    const double grip_N = (low_N + high_N) / 2;
    const bool holds = std::hypot(half_N, half_N * kOffset_m / eccentricity_m(contact, grip_N)) <=
                       kFriction * grip_N;
    (holds ? high_N : low_N) = grip_N;
  }
  return high_N;
}

Score pinch(const Engine& engine) {
  Score score;
  const double truth_N = least_grip_N();
  const double weight_N = kPlateMass_kg * kGravity_m_per_s2;
  const double most_N = 8 * truth_N;
  const auto turns = [&](double grip_N) {
    Scene scene = pinched_plate(grip_N);
    scene.duration_s = 0.7;
    watch_the_end(scene);
    const Motion motion = run(engine, scene, score);
    const Acceleration found = acceleration(motion, 0);
    return found.linear_m_per_s2 > kSlip * kGravity_m_per_s2 ||
           found.angular_rad_per_s2 >
               kSlip * weight_N * kOffset_m / scene.bodies[0].inertia_kg_m2().x();
  };
  if (turns(most_N)) {
    score.measured.push_back(
        {"no grip up to eight times the least one holds", "N", INFINITY, truth_N});
    return score;
  }
  const double grip_N = threshold(0.1 * truth_N, most_N, false, turns);
  score.measured.push_back({"least grip that holds", "N", grip_N, truth_N});
  return score;
}

Score tilt(const Engine& engine) {
  Score score;
  Scene scene;
  scene.bodies = {box("table", {0.2, 0.2, 0.05}, 0, {0, 0, -0.05}),
                  box("box", {0.03, 0.03, 0.01}, 0.1, {0, 0, 0.01})};
  scene.duration_s = 0.7;
  watch_the_end(scene);
  const double mu = scene.rigid_friction_coefficient;
  const double slope = threshold(0, 4 * mu, true, [&](double tangent) {
    const double angle_rad = std::atan(tangent);
    // 30 degrees from the box's side: a direction that no pyramid is made for.
    const Vector3d down(std::cos(kPi / 6), std::sin(kPi / 6), 0);
    scene.gravity_m_per_s2 =
        kGravity_m_per_s2 * (std::sin(angle_rad) * down - std::cos(angle_rad) * Vector3d::UnitZ());
    return acceleration(run(engine, scene, score), 1).linear_m_per_s2 > kSlip * kGravity_m_per_s2;
  });
  score.measured.push_back({"tangent of the angle at which the box slides", "", slope, mu});
  return score;
}

constexpr double kSettled_s = 1, kHeld_s = 60;

Score held(const Engine& engine) {
  Score score;
  Scene scene = pinched_plate(1.5 * least_grip_N());
  scene.duration_s = kSettled_s + kHeld_s;
  scene.sample_times_s = {kSettled_s, scene.duration_s};
  const Motion motion = run(engine, scene, score);
  if (motion.samples.size() < 2) return score;
  const State &before = motion.samples[0][0], &after = motion.samples[1][0];
  if ((after.position_m - before.position_m).norm() > 2 * kRadius_m) score.failure = "dropped";
  score.measured.push_back(
      {"moved in 60 s", "mm", 1e3 * (after.position_m - before.position_m).norm(), 0, "moved"});
  score.measured.push_back({"turned in 60 s", "°",
                            180 / kPi * after.orientation.angularDistance(before.orientation), 0,
                            "turned"});
  return score;
}

Score stack(const Engine& engine) {
  Score score;
  Scene scene;
  scene.bodies = {box("table", {0.2, 0.2, 0.05}, 0, {0, 0, -0.05})};
  const double half_m = 0.02;
  for (int i = 0; i < 5; ++i)
    scene.bodies.push_back(box(fmt::format("box_{}", i + 1), Vector3d::Constant(half_m),
                               0.02 * std::pow(2, i), {0, 0, (2 * i + 1) * half_m}));
  scene.gravity_m_per_s2 = {0, 0, -kGravity_m_per_s2};
  scene.time_step_s = 2e-3;
  scene.duration_s = kSettled_s + kHeld_s;
  scene.sample_times_s = {kSettled_s, scene.duration_s};
  const Motion motion = run(engine, scene, score);
  if (motion.samples.size() < 2) return score;
  double moved_m = 0, sunk_m = 0;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    moved_m = std::max(moved_m,
                       (motion.samples[1][i].position_m - motion.samples[0][i].position_m).norm());
    sunk_m = std::max(sunk_m, scene.bodies[i].position_m.z() - motion.samples[0][i].position_m.z());
  }
  if (moved_m > 2 * half_m) score.failure = "fell";
  score.measured.push_back({"a box moved in 60 s", "mm", 1e3 * moved_m, 0, "moved"});
  score.measured.push_back({"a box sank in the first second", "mm", 1e3 * sunk_m, 0, "sank"});
  return score;
}

constexpr double kPadGrip_N = 10, kPadFriction = 0.7, kHeldMass_kg = 0.5;

/// Two flat pads of 22 x 37.5 mm with 3 mm of rubber, as of a common gripper, press on a box.
/// Its weight acts from 0.3 s on, beside the line between them.
Scene gripped_box(double offset_m) {
  Scene scene;
  scene.contact.layer = {3e-3, 800e3, 0.49};
  scene.contact.load = {kPadGrip_N, kPadFriction};
  scene.bodies = {box("object", {0.02, 0.1, 0.04}, kHeldMass_kg, Vector3d::Zero()),
                  box("left", {0.01, 0.011, 0.01875}, 0.05, {-0.03, 0, 0}),
                  box("right", {0.01, 0.011, 0.01875}, 0.05, {0.03, 0, 0})};
  for (const std::size_t pad : {1u, 2u}) {
    scene.bodies[pad].freedom = Body::Freedom::along_x;
    scene.bodies[pad].is_fingertip = true;
  }
  const double weight_N = kHeldMass_kg * kGravity_m_per_s2;
  scene.loads = {{1, 0, {kPadGrip_N, 0, 0}, Vector3d::Zero()},
                 {2, 0, {-kPadGrip_N, 0, 0}, Vector3d::Zero()},
                 {0, 0.3, {0, 0, -weight_N}, {-weight_N * offset_m, 0, 0}}};
  return scene;
}

Score grip(const Engine& engine) {
  Score score;
  const double arm_m = pad_eccentricity_m(gripped_box(0).contact, gripped_box(0).bodies[1]);
  const double half_N = kHeldMass_kg * kGravity_m_per_s2 / 2, limit_N = kPadFriction * kPadGrip_N;
  const double truth_m = arm_m * std::sqrt(limit_N * limit_N - half_N * half_N) / half_N;
  const double offset_m = threshold(0, 4 * truth_m, true, [&](double offset) {
    Scene scene = gripped_box(offset);
    scene.duration_s = 0.7;
    watch_the_end(scene);
    const Acceleration found = acceleration(run(engine, scene, score), 0);
    return found.linear_m_per_s2 > kSlip * kGravity_m_per_s2 ||
           found.angular_rad_per_s2 >
               kSlip * 2 * half_N * truth_m / scene.bodies[0].inertia_kg_m2().x();
  });
  score.measured.push_back({"largest offset of the weight that the pads hold", "mm",
                            offset_m < 1e-3 * truth_m ? 0 : 1e3 * offset_m, 1e3 * truth_m});
  return score;
}

/// Capsule, claw and wall are the holds of creep/scenes.mjs, turned so that pads move along x. The
/// weight acts at the centre of a body, with its torque, where that file shifts the centre of mass.
constexpr double kHoldFriction = 0.8, kPadMass_kg = 0.1, kHoldStep_s = 2e-3;

/// Adds what rises along a straight line, in steps.
void add_rising(Scene& scene, int body, double from_s, double to_s, const Vector3d& force_N,
                const Vector3d& torque_Nm = Vector3d::Zero()) {
  constexpr int kSteps = 50;
  for (int i = 1; i <= kSteps; ++i)
    scene.loads.push_back({body, from_s + (to_s - from_s) * i / kSteps, force_N * i / kSteps,
                           torque_Nm * i / kSteps});
}

/// Two pads beside a body of half thickness `half_m` press on it from the start on.
Scene held_by_pads(Body held, double half_m, const Vector3d& pad_half_size_m, double grip_N) {
  Scene scene;
  scene.time_step_s = kHoldStep_s;
  scene.rigid_friction_coefficient = kHoldFriction;
  const double at_m = half_m + pad_half_size_m.x();
  scene.bodies = {std::move(held), box("left", pad_half_size_m, kPadMass_kg, {-at_m, 0, 0}),
                  box("right", pad_half_size_m, kPadMass_kg, {at_m, 0, 0})};
  for (const int pad : {1, 2}) {
    scene.bodies[std::size_t(pad)].freedom = Body::Freedom::along_x;
    add_rising(scene, pad, 0, 0.2, {pad == 1 ? grip_N : -grip_N, 0, 0});
  }
  return scene;
}

constexpr double kDriftSample_s = 0.1;

/// Adds how fast the first body moves and turns along its path, relative to the middle of its pads,
/// and says that it is lost where it has moved by 5 mm or turned by 0.5 rad before, or ends 50 mm
/// away.
void add_drift(const Engine& engine, Scene scene, double from_s, double to_s,
               const std::string& when, Score& score) {
  scene.duration_s = to_s;
  const int count = int(std::lround(to_s / kDriftSample_s));
  for (int i = 1; i <= count; ++i) scene.sample_times_s.push_back(i * kDriftSample_s);
  const Motion motion = run(engine, scene, score);
  if (motion.samples.size() < scene.sample_times_s.size()) return;
  // Pads that press with forces may float along their line together, and what they hold with them.
  const bool has_pads = scene.bodies[1].freedom == Body::Freedom::along_x;
  std::vector<State> held;
  for (const std::vector<State>& bodies : motion.samples) {
    held.push_back(bodies[0]);
    if (has_pads) held.back().position_m -= (bodies[1].position_m + bodies[2].position_m) / 2;
  }
  const Vector3d start_m = scene.bodies[0].position_m;
  const auto is_far = [&](const State& state) {
    return (state.position_m - start_m).norm() > 5e-3 ||
           state.orientation.angularDistance(Eigen::Quaterniond::Identity()) > 0.5;
  };
  double moved_m = 0, turned_rad = 0, watched_s = 0;
  for (auto i = std::size_t(std::lround(from_s / kDriftSample_s)); i < held.size(); ++i) {
    const State &before = held[i - 1], &after = held[i];
    if (is_far(before)) break;
    moved_m += (after.position_m - before.position_m).norm();
    turned_rad += after.orientation.angularDistance(before.orientation);
    watched_s += kDriftSample_s;
  }
  const bool is_lost = watched_s == 0 || (held.back().position_m - start_m).norm() > 0.05;
  const auto speed = [&](double way) { return is_lost ? INFINITY : way / watched_s; };
  score.measured.push_back({"moves " + when, "µm/s", 1e6 * speed(moved_m), 0, when});
  score.measured.push_back({"turns " + when, "mrad/s", 1e3 * speed(turned_rad), 0});
}

Score capsule(const Engine& engine) {
  Score score;
  for (const double grip_N : {12, 24, 36, 60}) {
    Body held;
    held.name = "capsule";
    held.shape = Body::Shape::capsule;
    held.half_size_m = {0.01, 0.03, 0.01};
    held.mass_kg = 0.045;
    Scene scene = held_by_pads(held, 0.01, {0.01, 0.01, 0.015}, grip_N);
    const double weight_N = held.mass_kg * kGravity_m_per_s2;
    add_rising(scene, 0, 0.3, 0.4, {0, 0, -weight_N}, {-weight_N * 8e-3, 0, 0});
    add_drift(engine, scene, 1, 4, fmt::format("at {:g} N", grip_N), score);
    // The overview has room for the weakest and the strongest grip.
    if (!score.measured.empty() && grip_N > 12 && grip_N < 60)
      score.measured[score.measured.size() - 2].verb.clear();
  }
  return score;
}

Score claw(const Engine& engine) {
  const Body bar = box("bar", {0.005, 0.01, 0.1}, 0.1, Vector3d::Zero());
  Scene scene = held_by_pads(bar, 0.005, {0.01, 0.01, 0.01}, 20);
  scene.contact.layer = {2e-3, 300e3, 0.49};
  scene.contact.load = {20, kHoldFriction};
  scene.bodies[1].is_fingertip = scene.bodies[2].is_fingertip = true;
  // In the claw's frame the weight turns, at a point 20 mm from the line through the pads.
  const Vector3d point_m(0, 0, -0.02);
  const double weight_N = bar.mass_kg * kGravity_m_per_s2;
  const auto weight = [&](double angle_rad) -> Vector3d {
    return weight_N * Vector3d(0, -std::sin(angle_rad), -std::cos(angle_rad));
  };
  add_rising(scene, 0, 0.3, 0.4, weight(0), point_m.cross(weight(0)));
  constexpr int kSteps = 300;
  for (int i = 1; i <= kSteps; ++i) {
    const double x = double(i) / kSteps, angle_rad = kPi * x * x * x * (10 + x * (6 * x - 15));
    scene.loads.push_back({0, 1 + 3 * x, weight(angle_rad), point_m.cross(weight(angle_rad))});
  }
  Score score;
  add_drift(engine, scene, 1, 4, "while it turns", score);
  add_drift(engine, scene, 4, 6, "afterwards", score);
  return score;
}

Score wall(const Engine& engine) {
  constexpr double kHalf_m = 0.02;
  Scene scene;
  scene.time_step_s = kHoldStep_s;
  scene.rigid_friction_coefficient = kHoldFriction;
  scene.bodies = {box("cube", Vector3d::Constant(kHalf_m), 0.1, {-kHalf_m, 0, 0}),
                  box("wall", {0.05, 0.2, 0.2}, 0, {0.05, 0, 0})};
  const Vector3d push_N(10, 0, 0), weight_N(0, 0, -0.1 * kGravity_m_per_s2);
  add_rising(scene, 0, 0, 0.2, push_N);
  constexpr int kSteps = 50;
  for (int i = 1; i <= kSteps; ++i)
    scene.loads.push_back(
        {0, 0.3 + 0.1 * i / kSteps, push_N + weight_N * i / kSteps, Vector3d::Zero()});
  Score score;
  add_drift(engine, scene, 1, 4, "at 10 N", score);
  return score;
}

}  // namespace

const Measured* Score::worst() const {
  const auto found = std::max_element(measured.begin(), measured.end(),
                                      [](const Measured& one, const Measured& other) {
                                        return std::abs(one.error()) < std::abs(other.error());
                                      });
  return found == measured.end() ? nullptr : &*found;
}

std::vector<TruthBound> bounds_of_the_truth() {
  std::vector<TruthBound> bounds;
  for (const double share : kLoadShares) {
    ContactProblem contact = silicone_on_flat();
    contact.load.normal_force_N = share * kNominal_N;
    const ErrorBound error = error_bound(default_model(contact), contact);
    constexpr std::size_t kMaxTorque = 5;
    bounds.push_back({contact.load.normal_force_N, error.known ? error.bound[kMaxTorque] : NAN});
  }
  return bounds;
}

const std::vector<Problem>& all_problems() {
  static const std::vector<Problem> problems = {
      {"pinch",
       "Two fingertips hold a plate of 50 g, 4 mm beside its centre: what is the least grip?",
       "friction ellipsoid with e_n(P) of fingertip_layer", true, pinch},
      {"twist",
       "A pressed fingertip is twisted: at which torque does it slip, from a tenth to ten times "
       "the "
       "nominal load?",
       "mu P e_n(P) of fingertip_layer", true, twist},
      {"grip",
       "Two flat rubber pads of 22 x 37.5 mm hold a box of 500 g with 10 N each: how far beside "
       "them may its weight act before it turns?",
       "friction ellipsoid with e_n of pad_layer", true, grip},
      {"tilt", "A rigid box lies on a table that is tilted: when does it slide?",
       "Coulomb: the tangent is mu", true, tilt},
      {"held",
       "The plate of the pinch, with 1.5 times the least grip: how far does it move in 60 s?",
       "a held contact does not move", false, held},
      {"stack",
       "Five boxes on each other, each twice as heavy as the one below: how far do they sink into "
       "each other in the first second, and how far do they move in the 60 s after it?",
       "rigid boxes at rest neither sink nor move", false, stack},
      {"capsule",
       "Two flat pads pinch a capsule of 45 g, 8 mm beside its centre of mass, with 12 to 60 N: "
       "how "
       "fast does it move and turn?",
       "a held contact does not move", false, capsule},
      {"claw",
       "Two flat rubber pads hold a bar of 100 g with 20 N, 20 mm beside its centre of mass, in a "
       "claw that turns by half a turn within 3 s: how fast does it move and turn in the claw?",
       "a held contact does not move", false, claw},
      {"wall", "A cube of 100 g is pressed on an upright wall with 10 N: how fast does it slide?",
       "a held contact does not move", false, wall}};
  return problems;
}

}  // namespace softfinger::benchmark
