#include "tests/dynamics/random_scene.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <map>

#include "softfinger/friction/linearised_friction.h"
#include "softfinger/input/constants.h"

namespace softfinger::tests {
namespace {

Eigen::Matrix3d contact_frame(const Eigen::Vector3d& normal) {
  Eigen::Matrix3d frame;
  frame.col(0) = normal;
  frame.col(1) = normal.unitOrthogonal();
  frame.col(2) = normal.cross(frame.col(1));
  return frame;
}

}  // namespace

const Eigen::Matrix3Xd& friction_vertices(int count) {
  static std::map<int, Eigen::Matrix3Xd> known;
  auto found = known.find(count);
  if (found == known.end())
    found = known.emplace(count, LinearisedFriction(count).columns(1.0)).first;
  return found->second;
}

ContactLcp RandomScenes::next(int contacts, int vertices) {
  const int bodies = 1 + int(uniform(0, 1 + contacts / 3.0));
  ContactLcp problem;
  problem.vertices = friction_vertices(vertices);
  problem.friction_coefficient.resize(contacts);
  problem.eccentricity_m.resize(contacts);

  const double decades = uniform(0, 6);
  inverse_mass_.setZero(6 * bodies, 6 * bodies);
  velocity_.resize(6 * bodies);
  std::vector<double> radius_m;
  for (int b = 0; b < bodies; ++b) {
    const double mass_kg = 0.1 * std::pow(10, uniform(0, decades));
    radius_m.push_back(uniform(0.01, 0.1));
    const Eigen::Matrix3d axes = rotation();
    // Drawn one after the other, last first: the arguments of a call are drawn in an order that
    // each compiler chooses, and the same scenes are wanted of all.
    const double about_z = uniform(0.3, 0.6), about_y = uniform(0.3, 0.6),
                 about_x = uniform(0.2, 0.6);
    const Eigen::Vector3d inertia_kg_m2 =
        mass_kg * radius_m.back() * radius_m.back() * Eigen::Vector3d(about_x, about_y, about_z);
    inverse_mass_.block<3, 3>(6 * b, 6 * b).diagonal().setConstant(1 / mass_kg);
    inverse_mass_.block<3, 3>(6 * b + 3, 6 * b + 3) =
        axes * inertia_kg_m2.cwiseInverse().asDiagonal() * axes.transpose();
    const Eigen::Vector3d along = direction();
    velocity_.segment<3>(6 * b) = uniform(0, 1) * along - Eigen::Vector3d(0, 0, 0.0981);
    const Eigen::Vector3d about = direction();
    velocity_.segment<3>(6 * b + 3) = uniform(0, 10) * about;
  }
  if (uniform(0, 1) < 0.3) {  // at rest under gravity: many ties
    velocity_.setZero();
    for (int b = 0; b < bodies; ++b) velocity_[6 * b + 2] = -0.0981;
  }

  touches_.clear();
  int first = 0, second = -1;
  Eigen::Vector3d normal, arm_m;
  for (int i = 0; i < contacts; ++i) {
    const double kind = uniform(0, 1);
    if (i == 0 || kind < 0.67) {
      first = int(uniform(0, bodies));
      second = int(uniform(-1, bodies));
      if (second == first || uniform(0, 1) < 0.4) second = -1;
      normal = second < 0 && uniform(0, 1) < 0.6 ? Eigen::Vector3d(0, 0, 1) : direction();
      arm_m = -radius_m[std::size_t(first)] * normal;
    } else if (kind < 0.9) {
      arm_m += 0.5 * radius_m[std::size_t(first)] * direction().cross(normal);
    }
    touches_.push_back({first, second, contact_frame(normal), arm_m,
                        second < 0 ? Eigen::Vector3d::Zero()
                                   : Eigen::Vector3d(radius_m[std::size_t(second)] * normal)});
    problem.friction_coefficient[i] = uniform(0, 1) < 0.05 ? 0 : uniform(0.05, 1.5);
    problem.eccentricity_m[i] = std::pow(10, uniform(-6, 0));
  }
  assemble(problem);
  return problem;
}

void RandomScenes::step(ContactLcp& problem, const ContactSolution& solution, double amount) {
  velocity_ += inverse_mass_ * jacobian_.transpose() * solution.impulse;
  for (Eigen::Index row = 2; row < velocity_.size(); row += 6) velocity_[row] -= 0.0981;
  disturb(problem, amount);
}

void RandomScenes::disturb(ContactLcp& problem, double amount) {
  for (double& component : velocity_) component *= 1 + amount * uniform(-1, 1);
  for (Touch& touch : touches_) {
    const Eigen::Vector3d shift = amount * direction(), axis = direction();
    touch.first_arm_m += touch.first_arm_m.norm() * shift;
    touch.second_arm_m += touch.first_arm_m.norm() * shift;
    touch.frame = Eigen::AngleAxisd(amount, axis) * touch.frame;
  }
  assemble(problem);
}

Eigen::Vector3d RandomScenes::direction() {
  const double z = uniform(-1, 1), heading = uniform(0, 2 * kPi), r = std::sqrt(1 - z * z);
  return {r * std::cos(heading), r * std::sin(heading), z};
}

Eigen::Matrix3d RandomScenes::rotation() {
  const Eigen::Vector3d axis = direction();
  return Eigen::AngleAxisd(uniform(0, kPi), axis).toRotationMatrix();
}

void RandomScenes::assemble(ContactLcp& problem) {
  const int contacts = int(touches_.size());
  jacobian_.setZero(4 * contacts, velocity_.size());
  for (int i = 0; i < contacts; ++i) {
    const Touch& touch = touches_[std::size_t(i)];
    add_body(i, touch.first, touch.frame, touch.first_arm_m, 1);
    if (touch.second >= 0) add_body(i, touch.second, touch.frame, touch.second_arm_m, -1);
  }
  problem.delassus = jacobian_ * inverse_mass_ * jacobian_.transpose();
  problem.free_velocity = jacobian_ * velocity_;
  if (gives_roots)
    problem.root = (jacobian_ * Eigen::MatrixXd(inverse_mass_.llt().matrixL())).sparseView();
}

void RandomScenes::add_body(int contact, int body, const Eigen::Matrix3d& frame,
                            const Eigen::Vector3d& arm_m, double sign) {
  for (int row = 0; row < 3; ++row) {
    jacobian_.block<1, 3>(4 * contact + row, 6 * body) += sign * frame.col(row).transpose();
    jacobian_.block<1, 3>(4 * contact + row, 6 * body + 3) +=
        sign * arm_m.cross(frame.col(row)).transpose();
  }
  jacobian_.block<1, 3>(4 * contact + 3, 6 * body + 3) += sign * frame.col(0).transpose();
}

ContactLcp separate_contacts(RandomScenes& scenes, int contacts) {
  ContactLcp problem;
  const int n = 4 * contacts;
  const auto random = [&scenes] { return scenes.uniform(-1, 1); };
  const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(n, n, random);
  problem.delassus = root * root.transpose() / n + Eigen::MatrixXd::Identity(n, n);
  problem.free_velocity = Eigen::VectorXd::NullaryExpr(n, random);
  problem.friction_coefficient =
      Eigen::VectorXd::NullaryExpr(contacts, [&scenes] { return scenes.uniform(0.05, 0.3); });
  problem.eccentricity_m =
      Eigen::VectorXd::NullaryExpr(contacts, [&scenes] { return scenes.uniform(0.1, 1); });
  return problem;
}

}  // namespace softfinger::tests
