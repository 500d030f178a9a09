#include "fem/friction/frictional_contact.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fem/algebra/fixed_point.h"
#include "fem/algebra/positive_definite.h"
#include "fem/friction/coulomb_friction.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

using Eigen::Index;

namespace {

/// Displacement of each point of the indenter.
Eigen::VectorXd displacement(const SurfaceCompliance& surface, const PlaneMotion& motion) {
  Eigen::VectorXd result(2 * surface.size());
  for (Index i = 0; i < surface.size(); ++i)
    result.segment<2>(2 * i) << motion.x - motion.turn_rad * surface.position(1, i),
        motion.y + motion.turn_rad * surface.position(0, i);
  return result;
}

}  // namespace

RubbedState on_points(const RubbedState& of_nodes, const SurfaceCompliance& surface) {
  const Index count = surface.size();
  RubbedState result{Eigen::VectorXd(count), Eigen::VectorXd(2 * count), Eigen::VectorXd(2 * count),
                     of_nodes.approach};
  for (Index i = 0; i < count; ++i) {
    const Index node = surface.model_node[static_cast<std::size_t>(i)];
    const Eigen::Vector2d signs = surface.mirrored.col(i);
    result.normal[i] = surface.images[i] * of_nodes.normal[node];
    result.tangential.segment<2>(2 * i) =
        surface.images[i] * signs.cwiseProduct(of_nodes.tangential.segment<2>(2 * node));
    result.slip.segment<2>(2 * i) = signs.cwiseProduct(of_nodes.slip.segment<2>(2 * node));
  }
  return result;
}

FrictionalContact::FrictionalContact(const SurfaceCompliance& surface, const Eigen::VectorXd& gap,
                                     double load, FrictionBound bound)
    : surface_(surface),
      gap_(gap),
      load_(load / surface.copies),
      bound_(std::move(bound)),
      normal_(solve_normal_contact(surface.normal, gap, load_)),
      pressed_(normal_.force),
      tangential_(Eigen::VectorXd::Zero(2 * surface.size())),
      last_change_(tangential_),
      slip_(tangential_),
      limit_(bound_.of(normal_.force)) {}

FrictionalContact::FrictionalContact(const SurfaceCompliance& surface, const Eigen::VectorXd& gap,
                                     double load, FrictionBound bound, RubbedState start)
    : surface_(surface),
      gap_(gap),
      load_(load / surface.copies),
      bound_(std::move(bound)),
      pressed_(Eigen::VectorXd::Zero(surface.size())),
      tangential_(std::move(start.tangential)),
      last_change_(Eigen::VectorXd::Zero(2 * surface.size())),
      slip_(std::move(start.slip)),
      limit_(bound_.of(start.normal)) {
  normal_.force = std::move(start.normal);
  normal_.approach = start.approach;
}

template <class TangentialSolver>
void FrictionalContact::settle(const char* stage, const TangentialSolver& solve_tangential) {
  constexpr int limit = 60;
  // Share of the load. The result is nearer than its last change by the rate of the settling, about
  // a tenth: far below the discretisation's error.
  constexpr double tolerance = 1e-5;
  // Limits that still change need no exact shear.
  constexpr double coarsest = 1e-3, share_of_change = 1e-2;
  // A point's shear lifts the surface in front of it and lowers it behind. Whole steps of pressure
  // and shear after one another settle slowly where the layer is thin and nearly incompressible.
  FixedPoint settling;
  NormalContact found = normal_;
  double change = 1;
  for (int iteration = 1; iteration <= limit; ++iteration) {
    limit_ = bound_.of(normal_.force);
    const double precision = std::clamp(share_of_change * change, friction_tolerance, coarsest);
    solve_tangential(precision);
    const Eigen::VectorXd lift = product_with_zeros(surface_.normal_tangential, tangential_);
    found = solve_normal_contact(surface_.normal, gap_ + lift, load_, &found, &touching_);
    change = (found.force - normal_.force).cwiseAbs().sum() / load_;
    // A small change alone is not enough: if shear hardly moves the pressure, the first iteration
    // has it, with a shear that is too coarse.
    if (change <= tolerance && precision <= share_of_change * tolerance) {
      normal_ = std::move(found);
      return;
    }
    normal_.force = settling.next(normal_.force, found.force).cwiseMax(0.0);
  }
  throw ConvergenceError(stage, limit, change,
                         "pressure and friction keep changing each other; is the coefficient of "
                         "friction very large?");
}

void FrictionalContact::press_to(double load) {
  load_ = load / surface_.copies;
  move_to({});
}

void FrictionalContact::settle_slip(const Eigen::VectorXd& slip) {
  slip_ = slip;
  last_change_.setZero();
  move_to({});
}

void FrictionalContact::move_to(const PlaneMotion& motion) {
  const Eigen::VectorXd target = displacement(surface_, motion) - slip_;
  // The next increment of a path likely does what the last one did.
  const Eigen::VectorXd start = tangential_;
  tangential_ += last_change_;
  Eigen::VectorXd by_pressure;
  settle("increment with friction", [&](double precision) {
    by_pressure = surface_.normal_tangential.transpose() * (normal_.force - pressed_);
    solve_friction(surface_.tangential, limit_, target - by_pressure, tangential_, &stick_slip_,
                   precision);
  });
  slip_ += target - by_pressure - product_with_zeros(surface_.tangential, tangential_);
  last_change_ = tangential_ - start;
}

void FrictionalContact::slide(const PlaneMotion& velocity) {
  const Eigen::VectorXd direction = displacement(surface_, velocity);
  last_change_.setZero();
  settle("full slip", [&](double) {
    for (Index i = 0; i < surface_.size(); ++i) {
      const Eigen::Vector2d along = direction.segment<2>(2 * i);
      const double speed = along.norm();
      // At the centre of rotation nothing slides. Forces around it point in all directions: it gets
      // their mean, none.
      tangential_.segment<2>(2 * i) =
          speed > 0 ? Eigen::Vector2d(limit_[i] / speed * along) : Eigen::Vector2d::Zero();
    }
  });
}

FrictionWrench FrictionalContact::wrench() const {
  FrictionWrench result;
  for (Index i = 0; i < surface_.size(); ++i) {
    const double x = surface_.position(0, i), y = surface_.position(1, i);
    const double qx = tangential_[2 * i], qy = tangential_[2 * i + 1];
    // A half turn's copies cancel the forces and double the torque.
    if (surface_.copies == 1) {
      result.force_x += qx;
      result.force_y += qy;
    }
    result.torque += surface_.copies * (x * qy - y * qx);
  }
  return result;
}

bool FrictionalContact::slips(Index point) const {
  return limit_[point] > 0 &&
         tangential_.segment<2>(2 * point).norm() >= limit_[point] * (1 - 1e-9);
}

double FrictionalContact::slip_fraction() const {
  double slipping = 0, touching = 0;
  for (Index i = 0; i < surface_.size(); ++i) {
    if (limit_[i] <= 0) continue;
    // The centre of a twist does not move, and carries nothing.
    if (surface_.position.col(i).norm() < 1e-9) continue;
    touching += surface_.area[i];
    if (slips(i)) slipping += surface_.area[i];
  }
  return touching > 0 ? slipping / touching : 0;
}

double FrictionalContact::torque_of_pressure() const {
  return surface_.copies * surface_.position.colwise().norm().dot(bound_.of(normal_.force));
}

}  // namespace softfinger::fem
