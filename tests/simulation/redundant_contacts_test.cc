// Bodies with more contacts than they need: they share their forces, whatever the order, and rest
// without work for the solver.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "comparisons/simulation/simulate.h"
#include "softfinger/input/constants.h"

namespace softfinger::simulation {
namespace {

using Eigen::Vector3d;

std::string box(const std::string& name, const Vector3d& size_mm, const Vector3d& at_mm,
                const std::string& mass = "density_kg_per_m3 = 1000", double turned_deg = 0) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nposition_mm = [{}, {}, {}]\nrotation_deg = [0, 0, {}]\n"
      "shapes = [{{ box_size_mm = [{}, {}, {}] }}]\n{}\n",
      name, at_mm.x(), at_mm.y(), at_mm.z(), turned_deg, size_mm.x(), size_mm.y(), size_mm.z(),
      mass);
}

const std::string kTable =
    "[[body]]\nname = \"table\"\nfixed = true\nshapes = [{ half_space = true }]\n";

Simulation run(const std::string& bodies, double duration_s, double time_step_ms = 1) {
  const Simulation result = simulate(input::parse_scene(
      fmt::format("id = \"test\"\n[simulation]\ntime_step_ms = {}\nduration_s = {}\n{}"
                  "[[contact]]\nbodies = [\"*\", \"*\"]\nfriction_coefficient = 0.5\n",
                  time_step_ms, duration_s, bodies),
      "test.toml"));
  EXPECT_EQ(result.failure, "");
  return result;
}

TEST(RedundantContacts, FourCornersOfABoxShare) {
  const Simulation rest = run(kTable + box("box", {40, 60, 20}, {0, 0, 10}), 0.05);
  const Frame& last = rest.recording.frames.back();
  const double weight_N = 0.04 * 0.06 * 0.02 * 1000 * 9.81;
  ASSERT_EQ(last.contacts.size(), 4u);
  for (const RecordedContact& contact : last.contacts) {
    EXPECT_NEAR(contact.normal_force_N, weight_N / 4, 1e-9 * weight_N);
    EXPECT_NEAR(contact.tangent_force_1_N, 0, 1e-9 * weight_N);
    EXPECT_NEAR(contact.tangent_force_2_N, 0, 1e-9 * weight_N);
  }
}

/// Heavy boxes on light ones: what rounding leaves of the velocities of unloaded corners is a
/// hundred times that of loaded ones. Yet all corners share in each step.
TEST(RedundantContacts, AllCornersUnderHeavyBoxesShareInEachStep) {
  constexpr int kBoxes = 5;
  std::string bodies = kTable;
  for (int i = 0; i < kBoxes; ++i)
    bodies += box(fmt::format("box_{}", i), Vector3d::Constant(40), {0, 0, 40. * i + 20},
                  fmt::format("mass_g = {}", 20 << i));
  const Simulation stack = run(bodies, 10, 2);
  ASSERT_EQ(stack.recording.frames.size(), 5001u);
  for (const Frame& frame : stack.recording.frames) {
    if (frame.time_s < 0.1) continue;
    ASSERT_EQ(frame.contacts.size(), 4u * kBoxes) << frame.time_s;
    for (const RecordedContact& contact : frame.contacts) {
      // 20 g is the lowest one; body 0 is the table.
      const double above_kg = 0.02 * ((1 << kBoxes) - (1 << (std::max(contact.a, contact.b) - 1)));
      const double weight_N = 9.81 * above_kg;
      ASSERT_NEAR(contact.normal_force_N, weight_N / 4, 1e-9 * weight_N) << frame.time_s;
      ASSERT_NEAR(contact.tangent_force_1_N, 0, 1e-9 * weight_N) << frame.time_s;
    }
  }
}

/// A rod between two jaws, along its whole length or over a part of it, and a torque about the
/// jaws' normal. Each jaw bears at the two ends of the common line, l apart: the limit is 2 mu P
/// l/2.
double fastest_turn_in_jaws(double jaw_mm, double torque_Nm, double from_s) {
  std::string bodies =
      "[[body]]\nname = \"rod\"\nmass_g = 100\n"
      "shapes = [{ cylinder_radius_length_mm = [10, 40] }]\n";
  for (const int side : {-1, 1}) {
    const std::string name = side < 0 ? "left" : "right";
    bodies += box(name, {20, 20, jaw_mm}, {side * 20., 0, 0}, "mass_g = 10") +
              fmt::format(
                  "[[joint]]\nname = \"j{0}\"\nkind = \"prismatic\"\nparent = \"world\"\n"
                  "child = \"{0}\"\naxis = [{1}, 0, 0]\n"
                  "[[motor]]\njoint = \"j{0}\"\ntime_s = [0]\neffort_N = [5]\n",
                  name, -side);
  }
  bodies += fmt::format(
      "[[force]]\nbody = \"rod\"\ntime_s = [0, {0}, {0}1]\n"
      "torque_Nm = [[0, 0, 0], [0, 0, 0], [{1}, 0, 0]]\n",
      from_s, torque_Nm);
  const Simulation result = simulate(input::parse_scene(
      "id = \"test\"\n[simulation]\ntime_step_ms = 0.2\nduration_s = 0.2\n"
      "gravity_m_per_s2 = [0, 0, 0]\n" +
          bodies + "[[contact]]\nbodies = [\"*\", \"*\"]\nfriction_coefficient = 0.5\n",
      "test.toml"));
  EXPECT_EQ(result.failure, "");
  double fastest = 0;
  for (const Frame& frame : result.recording.frames)
    fastest = std::max(fastest, frame.angular_velocities_rad_per_s[0].norm());
  return fastest;
}

TEST(RedundantContacts, ARodInJawsTurnsAtItsLimitOnly) {
  for (const double jaw_mm : {20., 60.})
    for (const double from_s : {0.0001, 0.05}) {
      const double limit_Nm = 0.5 * 5 * std::min(jaw_mm, 40.) * 1e-3;
      EXPECT_LE(fastest_turn_in_jaws(jaw_mm, 0.99 * limit_Nm, from_s), 1e-9)
          << jaw_mm << ' ' << from_s;
      EXPECT_GT(fastest_turn_in_jaws(jaw_mm, 1.05 * limit_Nm, from_s), 1e-2)
          << jaw_mm << ' ' << from_s;
    }
}

std::string stack(bool turned_round, double twist_deg = 0) {
  std::vector<std::string> boxes;
  for (int i = 0; i < 5; ++i)
    boxes.push_back(box(fmt::format("s{}", i), {40, 40, 20},
                        {i % 2 ? 0.7 : -0.7, 0.3 * i, 10. + 20 * i}, "density_kg_per_m3 = 1000",
                        twist_deg * i));
  if (turned_round) std::reverse(boxes.begin(), boxes.end());
  std::string text = turned_round ? "" : kTable;
  for (const std::string& one : boxes) text += one;
  return turned_round ? text + kTable : text;
}

/// Normal forces by place, which has a rounding of its own: to a micrometre.
std::map<std::array<long, 3>, double> forces_by_place(const Simulation& simulation) {
  std::map<std::array<long, 3>, double> result;
  for (const RecordedContact& contact : simulation.recording.frames.back().contacts) {
    std::array<long, 3> place;
    for (int i = 0; i < 3; ++i) place[std::size_t(i)] = std::lround(1e6 * contact.point_m[i]);
    result[place] += contact.normal_force_N;
  }
  return result;
}

TEST(RedundantContacts, DoNotDependOnTheOrderOfTheBodies) {
  for (const double twist_deg : {0., 7.}) {
    const auto one = forces_by_place(run(stack(false, twist_deg), 0.004));
    const auto other = forces_by_place(run(stack(true, twist_deg), 0.004));
    ASSERT_GE(one.size(), 20u);
    ASSERT_EQ(one.size(), other.size());
    double weight_N = 5 * 0.04 * 0.04 * 0.02 * 1000 * 9.81;
    for (auto a = one.begin(), b = other.begin(); a != one.end(); ++a, ++b) {
      EXPECT_EQ(a->first, b->first);
      EXPECT_NEAR(a->second, b->second, 1e-9 * weight_N) << twist_deg;
    }
  }
}

TEST(RedundantContacts, AStackAtRestStaysWhereItIs) {
  std::string text = kTable;
  for (int i = 0; i < 10; ++i)
    text += box(fmt::format("s{}", i), {40, 40, 20}, {0, 0, 10. + 20 * i});
  const Simulation rest = run(text, 1);
  const Frame& last = rest.recording.frames.back();
  for (int i = 0; i < 10; ++i)
    EXPECT_LE(
        (last.poses[std::size_t(i + 1)].translation() - Vector3d(0, 0, 0.01 + 0.02 * i)).norm(),
        1e-12);
  EXPECT_LE(rest.max_residual, 1e-10);
}

TEST(RedundantContacts, AHeavyBodyStandsOnALightOne) {
  // Seven decades: the light one's velocities are known to 1e-9 of the free ones at best.
  for (const double mass_g : {1e5, 1e6}) {
    const Simulation rest =
        run(kTable + box("light", {40, 40, 20}, {0, 0, 10}, "mass_g = 1") +
                box("heavy", {60, 60, 60}, {0, 0, 50}, fmt::format("mass_g = {}", mass_g)),
            0.2);
    const Frame& last = rest.recording.frames.back();
    EXPECT_EQ(rest.steps, 200);
    EXPECT_LE(rest.max_residual, 1e-8);
    EXPECT_LE((last.poses[2].translation() - Vector3d(0, 0, 0.05)).norm(), 1e-9);
    double carried_N = 0;
    for (const RecordedContact& contact : last.contacts)
      if (contact.a == 0) carried_N += contact.normal_force_N;
    EXPECT_NEAR(carried_N / ((mass_g + 1) * 1e-3 * 9.81), 1, 1e-6);
  }
}

TEST(RedundantContacts, ASymmetricGraspHasSymmetricTorques) {
  const Simulation lift = simulate(input::read_scene(SOFTFINGER_SCENES "/lift_box.toml"));
  ASSERT_EQ(lift.failure, "");
  const std::vector<RecordedContact>& contacts = lift.recording.frames.back().contacts;
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_GT(std::abs(contacts[0].torque_Nm), 1e-3);
  EXPECT_NEAR(contacts[0].torque_Nm / contacts[1].torque_Nm, -1, 1e-6);
  EXPECT_NEAR(contacts[0].utilisation, contacts[1].utilisation, 1e-6);
}

}  // namespace
}  // namespace softfinger::simulation
