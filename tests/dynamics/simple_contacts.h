#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "softfinger/dynamics/step/time_stepper.h"

namespace softfinger::tests {

/// Contacts of balls and of boxes' corners in closed form, for a given list of pairs.
class SimpleContacts final : public ContactFinder {
 public:
  struct Pair {
    enum class Kind { ball_on_plane, ball_on_ball, corners_on_plane } kind;
    int a = -1, b = -1;
    double radius_a_m = 0, radius_b_m = 0;             ///< of balls about their frames' origins
    Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< of the box b
    double friction_coefficient = 0, eccentricity_m = 0;
    const EccentricityLaw* law = nullptr;
    double height_m = 0;  ///< of the plane in the frame of a: its normal is the frame's z axis
    double reach_m = std::numeric_limits<double>::infinity();
  };
  std::vector<Pair> pairs;

  void find(const Multibody& bodies, double, std::vector<Contact>& contacts) override {
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const Pair& pair = pairs[p];
      Contact contact;
      contact.a = pair.a;
      contact.b = pair.b;
      contact.friction_coefficient = pair.friction_coefficient;
      contact.eccentricity_m = pair.eccentricity_m;
      contact.eccentricity_law = pair.law;
      const Eigen::Isometry3d &pose_a = bodies.pose(pair.a), &pose_b = bodies.pose(pair.b);
      const auto add = [&](const Eigen::Vector3d& on_b, const Eigen::Vector3d& normal, double gap_m,
                           int number) {
        if (gap_m > pair.reach_m) return;
        contact.gap_m = gap_m;
        contact.point_m = on_b - gap_m / 2 * normal;
        contact.axes.col(2) = normal;
        contact.axes.col(0) = normal.unitOrthogonal();
        contact.axes.col(1) = normal.cross(contact.axes.col(0));
        contact.id = long(8 * p) + number;
        contacts.push_back(contact);
      };
      if (pair.kind == Pair::Kind::ball_on_ball) {
        const Eigen::Vector3d apart = pose_b.translation() - pose_a.translation();
        const Eigen::Vector3d normal = apart.normalized();
        add(pose_b.translation() - pair.radius_b_m * normal, normal,
            apart.norm() - pair.radius_a_m - pair.radius_b_m, 0);
        continue;
      }
      const Eigen::Vector3d normal = pose_a.linear().col(2);
      const auto height = [&](const Eigen::Vector3d& point) {
        return normal.dot(point - pose_a.translation()) - pair.height_m;
      };
      if (pair.kind == Pair::Kind::ball_on_plane) {
        const Eigen::Vector3d lowest = pose_b.translation() - pair.radius_b_m * normal;
        add(lowest, normal, height(lowest), 0);
        continue;
      }
      for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d corner =
            pose_b * pair.size_m.cwiseProduct(Eigen::Vector3d(
                         i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5));
        if (normal.dot(corner - pose_b.translation()) < 0) add(corner, normal, height(corner), i);
      }
    }
  }
};

inline BodyDescription ball(const std::string& name, double radius_m, double mass_kg,
                            const Eigen::Vector3d& position_m) {
  BodyDescription body;
  body.name = name;
  body.mass = with_mass(unit_mass_of_ellipsoid(Eigen::Vector3d::Constant(radius_m)), mass_kg);
  body.pose.translation() = position_m;
  return body;
}

inline BodyDescription box(const std::string& name, const Eigen::Vector3d& size_m, double mass_kg,
                           const Eigen::Vector3d& position_m) {
  BodyDescription body;
  body.name = name;
  body.mass = with_mass(unit_mass_of_box(size_m), mass_kg);
  body.pose.translation() = position_m;
  return body;
}

inline BodyDescription ground(const std::string& name = "ground") {
  BodyDescription body;
  body.name = name;
  body.fixed = true;
  return body;
}

}  // namespace softfinger::tests
