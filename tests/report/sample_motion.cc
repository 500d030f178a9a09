#include "sample_motion.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "softfinger/friction/limit_surface.h"
#include "softfinger/input/constants.h"

namespace softfinger::tests {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;
using simulation::Frame;
using simulation::RecordedContact;
using simulation::Recording;

/// From 0 before `from` to 1 after `to`, smoothly.
double ramp(double time, double from, double to) {
  const double t = std::clamp((time - from) / (to - from), 0., 1.);
  return t * t * (3 - 2 * t);
}

Eigen::Matrix3d axes_of(const Vector3d& normal, const Vector3d& long_axis) {
  Eigen::Matrix3d axes;
  axes << long_axis, normal.cross(long_axis), normal;
  return axes;
}

/// Velocities that the poses imply.
void differentiate(Recording& recording) {
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    Frame& frame = recording.frames[i];
    const Frame& before = recording.frames[i > 0 ? i - 1 : 0];
    for (std::size_t body = 0; body < frame.poses.size(); ++body) {
      const AngleAxisd turn(
          Eigen::Matrix3d(frame.poses[body].linear() * before.poses[body].linear().transpose()));
      const double step_s = recording.time_step_s;
      frame.velocities_m_per_s.push_back(
          (frame.poses[body].translation() - before.poses[body].translation()) / step_s);
      frame.angular_velocities_rad_per_s.push_back(turn.angle() / step_s * turn.axis());
    }
  }
}

/// A surface of revolution about z; `profile` gives (radius, z) of its parameter from 0 to 1.
template <typename Profile>
input::Mesh turned(int segments, int rings, const Profile& profile) {
  TriangleSurface surface;
  for (int ring = 0; ring < rings; ++ring)
    for (int j = 0; j < segments; ++j) {
      const auto [radius_m, z_m] = profile((ring + 0.5) / rings);
      const double angle = 2 * kPi * j / segments;
      surface.vertices_m.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle), z_m);
      if (ring == 0) continue;
      const int next = (j + 1) % segments, low = (ring - 1) * segments, high = ring * segments;
      surface.triangles.push_back({low + j, low + next, high + next});
      surface.triangles.push_back({low + j, high + next, high + j});
    }
  return {std::make_shared<const TriangleSurface>(std::move(surface))};
}

RecordedContact soft_contact(int a, int b, const Vector3d& point_m, const Eigen::Matrix3d& axes,
                             double normal_force_N) {
  RecordedContact contact;
  contact.a = a;
  contact.b = b;
  contact.point_m = point_m;
  contact.axes = axes;
  contact.semi_axis_a_m = 3.2e-3 * std::cbrt(normal_force_N / 4);
  contact.semi_axis_b_m = 0.55 * contact.semi_axis_a_m;
  contact.normal_force_N = normal_force_N;
  contact.friction_coefficient = 0.8;
  contact.pressure_exponent = 1;
  contact.eccentricity_m =
      LimitSurface(contact.semi_axis_a_m, contact.semi_axis_b_m, 1, 1).eccentricity_m();
  contact.model = "winkler";
  return contact;
}

void set_wrench(RecordedContact& contact, double force_1_N, double force_2_N, double torque_Nm) {
  contact.tangent_force_1_N = force_1_N;
  contact.tangent_force_2_N = force_2_N;
  contact.torque_Nm = torque_Nm;
  const double torque_as_force_N =
      contact.eccentricity_m > 0 ? torque_Nm / contact.eccentricity_m : 0;
  contact.utilisation = Vector3d(force_1_N, force_2_N, torque_as_force_N).norm() /
                        (contact.friction_coefficient * contact.normal_force_N);
  contact.slides = contact.utilisation > 0.999;
}

}  // namespace

Recording sample_motion(int steps) {
  Recording recording;
  recording.scene = "box_in_pinch";
  recording.question =
      "Does a box that is held off its centre turn between two fingertips, and when?";
  recording.time_step_s = 2. / std::max(1, steps);
  const Vector3d box_size(0.03, 0.02, 0.07);
  const double finger_radius_m = 0.009;
  const auto tip = [&](const char* name) {
    return simulation::RecordedBody{
        name, true, {{input::Capsule{finger_radius_m, 0.03}, Isometry3d::Identity()}}};
  };
  recording.bodies = {tip("thumb"),
                      tip("index finger"),
                      {"box", true, {{input::Box{box_size}, Isometry3d::Identity()}}},
                      {"table", false, {{input::HalfSpace{}, Isometry3d::Identity()}}}};
  for (int step = 0; step <= steps; ++step) {
    const double time_s = step * recording.time_step_s;
    Frame frame;
    frame.time_s = time_s;
    const double grip_N = 0.4 + 3.6 * ramp(time_s, 0.1, 0.5);
    const double lift_m = 0.06 * ramp(time_s, 0.5, 1.2);
    const double angle = 0.7 * ramp(time_s, 1.2, 1.9);
    const Vector3d grip_m(0, 0, 0.055 + lift_m);
    const Isometry3d box =
        Translation3d(grip_m) * AngleAxisd(angle, Vector3d::UnitX()) * Translation3d(0, 0, -0.02);
    const double finger_x_m = box_size.x() / 2 + finger_radius_m;
    const AngleAxisd across(kPi / 2, Vector3d::UnitX());
    frame.poses = {Translation3d(grip_m + Vector3d(-finger_x_m, -0.008, 0)) * across,
                   Translation3d(grip_m + Vector3d(finger_x_m, -0.008, 0)) * across, box,
                   Isometry3d::Identity()};

    const double weight_N = 1.1 * ramp(time_s, 0.5, 0.6);
    for (const double side : {-1., 1.}) {
      RecordedContact contact =
          soft_contact(side < 0 ? 0 : 1, 2, grip_m + Vector3d(side * box_size.x() / 2, 0, 0),
                       axes_of(Vector3d(-side, 0, 0), Vector3d::UnitY()), grip_N);
      const double limit_N = contact.friction_coefficient * grip_N;
      const double left_N = std::sqrt(limit_N * limit_N - weight_N * weight_N / 4);
      const double torque_share = ramp(time_s, 0.6, 1.2);
      // Upwards is minus or plus the second tangent.
      set_wrench(contact, 0.15 * limit_N * (1 - torque_share) * ramp(time_s, 0, 0.5),
                 (contact.axes(2, 1) > 0 ? 1 : -1) * weight_N / 2,
                 -side * torque_share * left_N * contact.eccentricity_m *
                     (angle > 0 && time_s < 1.9 ? 1 : 0.93));
      frame.contacts.push_back(contact);
    }
    if (lift_m == 0)
      for (const Vector3d& corner : {Vector3d(-0.5, -0.5, 0), Vector3d(0.5, -0.5, 0),
                                     Vector3d(0.5, 0.5, 0), Vector3d(-0.5, 0.5, 0)}) {
        RecordedContact contact;
        contact.a = 3;
        contact.b = 2;
        contact.point_m = corner.cwiseProduct(box_size);
        contact.axes = axes_of(Vector3d::UnitZ(), Vector3d::UnitX());
        contact.normal_force_N = 0.3;
        contact.friction_coefficient = 0.4;
        contact.model = "rigid";
        set_wrench(contact, 0.02, 0, 0);
        frame.contacts.push_back(contact);
      }
    recording.frames.push_back(std::move(frame));
  }
  differentiate(recording);
  return recording;
}

Recording large_motion() {
  Recording recording;
  recording.scene = "hand_and_glass";
  recording.question = "Does the page carry 27 bodies over 1,800 steps?";
  recording.time_step_s = 1. / 180;
  // As fine as surfaces come out of CAD: 6,720 and 24,000 triangles.
  const input::Mesh fingertip = turned(60, 57, [](double t) {
    return std::pair{0.008 * std::sin(kPi * t), -0.013 * std::cos(kPi * t)};
  });
  // Up the outer wall and down the inner one.
  const input::Mesh glass = turned(120, 101, [](double t) {
    const bool is_outside = t < 0.5;
    const double along_m = 0.28 * (is_outside ? t : 1 - t);  // from the axis, over the foot, up
    const double radius_m = std::min(along_m, 0.033), height_m = std::max(0., along_m - 0.033);
    return is_outside ? std::pair{radius_m, height_m - 0.055}
                      : std::pair{std::min(radius_m, 0.031), height_m - 0.053};
  });
  for (int finger = 0; finger < 5; ++finger) {
    for (int link = 0; link < 4; ++link)
      recording.bodies.push_back(
          {"finger " + std::to_string(finger) + " link " + std::to_string(link),
           true,
           {{input::Capsule{0.009 - 0.001 * link, 0.03 + 0.002 * finger + 0.001 * link},
             Isometry3d::Identity()}}});
    recording.bodies.push_back(
        {"fingertip " + std::to_string(finger), true, {{fingertip, Isometry3d::Identity()}}});
  }
  recording.bodies.push_back({"glass", true, {{glass, Isometry3d::Identity()}}});
  recording.bodies.push_back({"table", false, {{input::HalfSpace{}, Isometry3d::Identity()}}});
  const int glass_index = 25, table_index = 26;
  for (int step = 0; step <= 1800; ++step) {
    const double time_s = step * recording.time_step_s;
    Frame frame;
    frame.time_s = time_s;
    const Vector3d centre_m(0, 0, 0.06 + 0.1 * ramp(time_s, 2, 5));
    for (int finger = 0; finger < 5; ++finger) {
      const double around = (finger == 0 ? kPi : -0.6 + 0.4 * (finger - 1));
      const Vector3d outward(std::cos(around), std::sin(around), 0);
      const Vector3d contact_m = centre_m + 0.033 * outward;
      for (int link = 0; link < 5; ++link)
        frame.poses.push_back(Translation3d(contact_m + (0.008 + 0.028 * (4 - link)) * outward +
                                            Vector3d(0, 0, 0.012 * (4 - link))) *
                              AngleAxisd(around, Vector3d::UnitZ()) *
                              AngleAxisd(kPi / 2 - 0.4, Vector3d::UnitY()));
      RecordedContact contact =
          soft_contact(5 * finger + 4, glass_index, contact_m, axes_of(-outward, Vector3d::UnitZ()),
                       1.5 + std::sin(time_s + finger));
      const double limit_N = contact.friction_coefficient * contact.normal_force_N;
      set_wrench(contact, 0.5 * limit_N * ramp(time_s, 2, 3),
                 0.2 * limit_N * std::sin(3 * time_s + finger),
                 0.6 * limit_N * contact.eccentricity_m * std::sin(2 * time_s));
      frame.contacts.push_back(contact);
    }
    if (time_s < 2)
      for (int i = 0; i < 9; ++i) {
        RecordedContact contact;
        contact.a = table_index;
        contact.b = glass_index;
        contact.point_m = 0.033 * Vector3d(std::cos(0.7 * i), std::sin(0.7 * i), 0);
        contact.normal_force_N = 0.2;
        contact.friction_coefficient = 0.3;
        contact.model = "rigid";
        set_wrench(contact, 0.01, 0, 0);
        frame.contacts.push_back(contact);
      }
    frame.poses.push_back(Translation3d(centre_m) * AngleAxisd(0.1 * time_s, Vector3d::UnitZ()));
    frame.poses.push_back(Isometry3d::Identity());
    recording.frames.push_back(std::move(frame));
  }
  differentiate(recording);
  return recording;
}

Recording far_motion() {
  Recording recording = sample_motion(200);
  recording.scene = "box_carried_away";
  for (Frame& frame : recording.frames) {
    const Vector3d aside_m(1.5 * ramp(frame.time_s, 0.5, 2), 0, 0);
    for (std::size_t body = 0; body < 3; ++body) frame.poses[body].pretranslate(aside_m);
    for (RecordedContact& contact : frame.contacts) contact.point_m += aside_m;
  }
  return recording;
}

Recording motion_without_contacts() {
  Recording recording = sample_motion(50);
  recording.scene = "free_fall";
  for (Frame& frame : recording.frames) frame.contacts.clear();
  return recording;
}

Recording motion_of_one_frame() {
  Recording recording = sample_motion(50);
  recording.frames.resize(1);
  return recording;
}

Recording empty_motion() {
  Recording recording;
  recording.scene = "nothing";
  return recording;
}

}  // namespace softfinger::tests
