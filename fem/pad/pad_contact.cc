#include "fem/pad/pad_contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "fem/algebra/positive_definite.h"
#include "fem/contact/active_set.h"

namespace softfinger::fem {
namespace {

using Eigen::Index;
using Motions = std::vector<Index>;

const Motions pressing_motions{approach, tilt_x, tilt_y};
const Motions all_but_twist{approach, tilt_x, tilt_y, shear_x, shear_y};

/// Resultants of one face or the other, motions by motions.
Eigen::MatrixXd resultants_of(const FaceResponse& face, PadPressing pressing,
                              const Motions& motions) {
  if (pressing == PadPressing::stuck) return face.stuck_resultants()(motions, motions);
  return face.frictionless_resultants();
}

Eigen::MatrixXd forces_of(const FaceResponse& face, PadPressing pressing, const Motions& motions) {
  if (pressing == PadPressing::stuck) return face.stuck()(Eigen::all, motions);
  return face.frictionless();
}

/// Stiffness of one motion while others are free to follow.
double stiffness_with_free(const Eigen::MatrixXd& resultants, Index motion, const Motions& free) {
  const Eigen::MatrixXd of_free = resultants(free, free);
  const Eigen::VectorXd coupling = resultants(free, motion);
  return resultants(motion, motion) - coupling.dot(solve_positive_definite(of_free, coupling));
}

/// Normal displacements of nodes by the first three motions.
Eigen::MatrixXd pressing_shapes(const FaceResponse& face) {
  Eigen::MatrixXd shapes(face.size(), 3);
  shapes.col(approach).setOnes();
  shapes.col(tilt_x) = face.place().row(0).transpose();
  shapes.col(tilt_y) = face.place().row(1).transpose();
  return shapes;
}

Eigen::Vector3d resultant_of(const FaceLoad& load) {
  return load.force * Eigen::Vector3d(1, load.at.x(), load.at.y());
}

/// Lets the frictionless face lift off. Nodes that have come off are displaced beyond the object's
/// plane by as much as makes their forces zero.
PressedFace lift_off(const FaceResponse& face, const FaceLoad& load, const PressedFace& held) {
  const Eigen::MatrixXd stiffness = face.frictionless_stiffness();
  const Eigen::MatrixXd shapes = pressing_shapes(face);
  const Eigen::VectorXd from_load = (face.place().colwise() - load.at).colwise().norm();
  ActiveSet set(from_load, &held.force);
  PressedFace pressed;
  for (pressed.iterations = 1; pressed.iterations <= ActiveSet::most_steps; ++pressed.iterations) {
    const std::vector<Index> off = set.free();
    Eigen::MatrixXd forces = face.frictionless(), beyond;
    if (!off.empty()) {
      beyond = inverse_of_positive_definite(stiffness(off, off)) * forces(off, Eigen::all);
      forces -= stiffness(Eigen::all, off) * beyond;
    }
    const Eigen::Matrix3d resultants = shapes.transpose() * forces;
    pressed.motion = resultants.fullPivLu().solve(resultant_of(load));
    pressed.force = forces * pressed.motion;
    Eigen::VectorXd clearance = Eigen::VectorXd::Zero(face.size());
    if (!off.empty()) {
      pressed.force(off).setZero();
      clearance(off) = -beyond * pressed.motion;
    }
    const double scale = (shapes * pressed.motion).cwiseAbs().maxCoeff();
    if (!set.improve(pressed.force, clearance, pressed.force.cwiseAbs().maxCoeff(), scale))
      continue;
    pressed.force = pressed.force.cwiseMax(0.0);
    pressed.lifted_area = face.weight()(off).sum();
    return pressed;
  }
  set.give_up();
}

}  // namespace

Eigen::Vector2d stiffness_centre(const FaceResponse& face, PadPressing pressing) {
  const Eigen::MatrixXd resultants = resultants_of(face, pressing, pressing_motions);
  return resultants.row(approach).segment<2>(tilt_x).transpose() / resultants(approach, approach);
}

bool has_tension(const PressedFace& pressed) {
  constexpr double round_off = 1e-9;
  return pressed.force.minCoeff() < -round_off * pressed.force.maxCoeff();
}

PressedFace press_face(const FaceResponse& face, PadPressing pressing, const FaceLoad& load) {
  PressedFace pressed;
  pressed.motion = resultants_of(face, pressing, pressing_motions)
                       .topLeftCorner<3, 3>()
                       .llt()
                       .solve(resultant_of(load));
  pressed.force = forces_of(face, pressing, pressing_motions) * pressed.motion;
  if (pressing == PadPressing::frictionless && has_tension(pressed))
    return lift_off(face, load, pressed);
  return pressed;
}

Eigen::Vector2d tilt_limit(const FaceResponse& face, PadPressing pressing, bool free) {
  const bool sideways = free && pressing == PadPressing::stuck;
  const Motions& motions = sideways ? all_but_twist : pressing_motions;
  const Eigen::MatrixXd resultants = resultants_of(face, pressing, motions);
  const Eigen::MatrixXd forces = forces_of(face, pressing, motions);
  const Eigen::Vector2d centre = stiffness_centre(face, pressing);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(resultants.rows());
  load.head<3>() = resultant_of({1, centre});
  const auto at_nodes = [&](const Eigen::VectorXd& motion) -> Eigen::VectorXd {
    const Eigen::VectorXd force = forces * motion;
    // A stuck face's pressure is singular along the edge, where that of the elements oscillates:
    // the nodes' forces have one sign. Without friction it is smooth, and forces would average over
    // it.
    return pressing == PadPressing::stuck ? force : face.pressure_of(force);
  };
  const Eigen::VectorXd even = at_nodes(solve_positive_definite(resultants, load));
  if (even.minCoeff() < 0) return Eigen::Vector2d::Zero();
  Eigen::Vector2d limit;
  for (const Index tilt : {tilt_x, tilt_y}) {
    const Eigen::VectorXd per_moment = at_nodes(
        solve_positive_definite(resultants, Eigen::VectorXd::Unit(resultants.rows(), tilt)));
    // The first node to pull, for either sense of the moment.
    limit[tilt - tilt_x] = 1 / (per_moment.array() / even.array()).abs().maxCoeff();
  }
  return limit;
}

Eigen::Vector2d tilt_stiffness(const FaceResponse& face, PadPressing pressing, bool free) {
  const bool sideways = free && pressing == PadPressing::stuck;
  const Eigen::MatrixXd resultants =
      resultants_of(face, pressing, sideways ? all_but_twist : pressing_motions);
  const Motions followers = sideways ? Motions{approach, shear_x, shear_y} : Motions{approach};
  return {stiffness_with_free(resultants, tilt_x, followers),
          stiffness_with_free(resultants, tilt_y, followers)};
}

double torsional_stiffness(const FaceResponse& face) {
  return stiffness_with_free(face.stuck_resultants(), twist, {shear_x, shear_y});
}

PressureArm arm_of(const FaceResponse& face, const Eigen::VectorXd& force) {
  PressureArm result;
  const double load = force.sum();
  result.centre = face.place() * force / load;
  result.arm = face.integral(face.pressure_of(force), [&](const Eigen::Vector2d& at,
                                                          double pressure) {
    return pressure * (at - result.centre).norm();
  }) / load;
  return result;
}

double peak_within(const FaceResponse& face, const ConvexOutline& outline,
                   const Eigen::VectorXd& force, double share) {
  const Eigen::VectorXd pressure = face.pressure_of(force);
  const Eigen::Vector2d centre = outline.centroid();
  double peak = 0;
  for (Index i = 0; i < face.size(); ++i)
    if (outline.distance(centre + (face.place().col(i) - centre) / share) <= 0)
      peak = std::max(peak, pressure[i]);
  return peak;
}

}  // namespace softfinger::fem
