#include "fem/finite/superposed_friction.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fem/algebra/fixed_point.h"
#include "fem/algebra/positive_definite.h"
#include "fem/finite/deformed_contact.h"
#include "fem/friction/coulomb_friction.h"
#include "fem/layer/surface_frame.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {

using Eigen::Index;

namespace {

struct Rows {
  std::vector<Index> tangential, normal;
};

/// Row numbers in a matrix of 3 x 3 blocks, one block per node.
Rows rows(Index count) {
  Rows result;
  for (Index i = 0; i < count; ++i) {
    result.tangential.push_back(3 * i);
    result.tangential.push_back(3 * i + 1);
    result.normal.push_back(3 * i + 2);
  }
  return result;
}

/// Displacements along the tangents per force along them, normals held; zero where the parity fixes
/// a component.
Eigen::MatrixXd tangential_compliance(const Eigen::MatrixXd& stiffness) {
  const Index count = stiffness.rows() / 3;
  const std::vector<Index> tangential = rows(count).tangential;
  std::vector<Index> free, from;
  for (Index row = 0; row < 2 * count; ++row) {
    const Index of_all = tangential[static_cast<std::size_t>(row)];
    if (stiffness(of_all, of_all) == 0) continue;
    free.push_back(row);
    from.push_back(of_all);
  }
  const Eigen::MatrixXd of_free = inverse_of_positive_definite(stiffness(from, from));
  if (!free.empty() && of_free.size() == 0)
    throw ConvergenceError("friction on the deformed layer", 0, 0,
                           "the pressed state is not stable against shear: less load");
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  result(free, free) = of_free;
  return result;
}

/// Change of the touching nodes' normal forces per displacement in their frames, n x 3n.
Eigen::MatrixXd normal_force_by_displacement(const TouchingNodes& nodes,
                                             const Eigen::MatrixXd& stiffness) {
  Eigen::MatrixXd result = -stiffness(rows(nodes.size()).normal, Eigen::all);
  for (Index i = 0; i < nodes.size(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    const Eigen::Matrix3d& axes = nodes.axes[node];
    // The stiffness also counts that the curved object turns the contact force. That changes the
    // force's direction and not its magnitude: it is taken off.
    result.block<1, 3>(i, 3 * i) -= nodes.force[i] * axes.col(2).head<2>().transpose() *
                                    nodes.object[node].curvature * axes.topRows<2>();
  }
  return result;
}

/// Cosine of the object's slope at each node.
Eigen::VectorXd cosine(const TouchingNodes& nodes) {
  Eigen::VectorXd result(nodes.size());
  for (Index i = 0; i < nodes.size(); ++i)
    result[i] = nodes.axes[static_cast<std::size_t>(i)](2, 2);
  return result;
}

/// Upward component of forces along the tangents, summed.
double lift_of(const TouchingNodes& nodes, const Eigen::VectorXd& force) {
  double result = 0;
  for (Index i = 0; i < nodes.size(); ++i)
    result += nodes.axes[static_cast<std::size_t>(i)].row(2).head<2>() * force.segment<2>(2 * i);
  return result;
}

/// Forces that agree with what they lead to: normal ones limit friction, and friction moves them.
/// @param start  one column per image
/// @param load   the scale of their sum
/// @throws ConvergenceError when they do not settle
template <class Next>
Eigen::MatrixXd settled(const char* stage, const Eigen::MatrixXd& start, double load,
                        const Next& next) {
  constexpr int limit = 1000;
  constexpr double tolerance = 1e-6;  // of the load, far below the discretisation's error
  // A point's shear lifts the surface in front of it and lowers it behind. So each change of the
  // pressure changes the shear, which changes the pressure back, and whole steps may grow without
  // end.
  FixedPoint settling;
  Eigen::MatrixXd force = start;
  double change = 0;
  for (int iteration = 1; iteration <= limit; ++iteration) {
    const Eigen::MatrixXd image = next(force);
    change = (image - force).cwiseAbs().sum() / load;
    if (change <= tolerance) return image;
    force = settling.next(force.reshaped(), image.reshaped()).reshaped(start.rows(), start.cols());
  }
  throw ConvergenceError(stage, limit, change,
                         "pressure and friction keep changing each other; is the coefficient of "
                         "friction very large?");
}

/// The images of a quarter of the contact are numbered by two bits: 0 for mirrored at x = 0, 1 for
/// mirrored at y = 0. The bits of a parity say where a field is odd. This is the field's sign on an
/// image, in mirrored axes. A whole contact has one image and one parity, both 0.
double sign(int image, int parity) {
  return ((image & parity & 1) != 0) != ((image & parity & 2) != 0) ? -1 : 1;
}
Eigen::Vector3d mirror(int image) { return {image & 1 ? -1.0 : 1.0, image & 2 ? -1.0 : 1.0, 1}; }

/// The bound of the touching nodes, from that of all nodes of the layer.
FrictionBound bound_of(const TouchingNodes& nodes, const FrictionBound& of_layer) {
  if (of_layer.area.size() == 0) return of_layer;
  return {of_layer.law, of_layer.area(nodes.node)};
}

}  // namespace

FrictionWrench slide(const FinitePressing& pressing, const FrictionBound& of_layer,
                     const PlaneMotion& velocity) {
  const TouchingNodes nodes = pressing.touching_nodes();
  const FrictionBound bound = bound_of(nodes, of_layer);
  FrictionWrench result;
  for (int image = 0; image < pressing.copies(); ++image) {
    const Eigen::Vector3d signs = pressing.layer().planes().image(image).signs();
    for (Index i = 0; i < nodes.size(); ++i) {
      const Eigen::Vector3d position = signs.cwiseProduct(nodes.position.col(i));
      const Eigen::Vector3d normal =
          signs.cwiseProduct(nodes.axes[static_cast<std::size_t>(i)].col(2));
      Eigen::Vector3d along =
          Eigen::Vector3d(velocity.x, velocity.y, 0) + velocity.turn_rad * turned(position);
      along -= normal.dot(along) * normal;
      const double speed = along.norm();
      // At the centre of rotation nothing slides. Forces around it point in all directions: it gets
      // their mean, none.
      if (!(speed > 0)) continue;
      const Eigen::Vector3d force = bound.at(i, nodes.normal_force[i]) / speed * along;
      result.force_x += force.x();
      result.force_y += force.y();
      result.torque += turned(position).dot(force);
    }
  }
  return result;
}

TangentialResponse::TangentialResponse(const TouchingNodes& nodes, const Eigen::MatrixXd& stiffness)
    : displacement(tangential_compliance(stiffness)) {
  const Rows of = rows(nodes.size());
  normal_force =
      normal_force_by_displacement(nodes, stiffness)(Eigen::all, of.tangential) * displacement;
  load = -(cosine(nodes).asDiagonal() * stiffness(of.normal, of.tangential)) * displacement;
}

ApproachResponse::ApproachResponse(const TouchingNodes& nodes, const Eigen::MatrixXd& stiffness,
                                   const TangentialResponse& tangential) {
  // The approach moves the nodes along their normals, and they give way along the tangents.
  const Rows of = rows(nodes.size());
  const Eigen::VectorXd slope = cosine(nodes);
  displacement = tangential.displacement * (stiffness(of.tangential, of.normal) * slope);
  Eigen::VectorXd of_all(3 * nodes.size());
  for (Index i = 0; i < nodes.size(); ++i) {
    of_all.segment<2>(3 * i) = displacement.segment<2>(2 * i);
    of_all[3 * i + 2] = -slope[i];
    displacement.segment<2>(2 * i) +=
        nodes.axes[static_cast<std::size_t>(i)].row(2).head<2>().transpose();
  }
  normal_force = normal_force_by_displacement(nodes, stiffness) * of_all;
  load = -(slope.asDiagonal() * (stiffness(of.normal, Eigen::all) * of_all));
}

SuperposedSlide::SuperposedSlide(FinitePressing& pressing, const FrictionBound& bound)
    : SuperposedSlide(pressing, bound,
                      [&](Parity parity) { return pressing.superposed_stiffness(parity); }) {}

SuperposedSlide::SuperposedSlide(const FinitePressing& pressing, const FrictionBound& bound,
                                 const Eigen::MatrixXd& stiffness)
    : SuperposedSlide(pressing, bound, [&](Parity) { return stiffness; }) {}

SuperposedSlide::SuperposedSlide(const FinitePressing& pressing, const FrictionBound& bound,
                                 const std::function<Eigen::MatrixXd(Parity)>& stiffness_of)
    : nodes_(pressing.touching_nodes()),
      images_(pressing.copies()),
      spacing_(node_spacing(pressing.layer().discretisation())),
      bound_(bound_of(nodes_, bound)) {
  for (int parity = 0; parity < images_; ++parity) {
    const Eigen::MatrixXd stiffness = stiffness_of({(parity & 1) != 0, (parity & 2) != 0});
    responses_.emplace_back(nodes_, stiffness);
    if (parity == 0) approach_ = {nodes_, stiffness, responses_.front()};
  }
}

SuperposedSlide::Slid SuperposedSlide::slide(const PlaneMotion& velocity, double share) const {
  const Index count = nodes_.size();
  const double load = images_ * nodes_.force.sum();
  const Eigen::VectorXd slope = cosine(nodes_);
  // All that follows is along the mirrored frames of each image.
  Eigen::MatrixXd displacement(2 * count, images_), normal_force(count, images_);
  const auto place = [&](Index node, int image) -> Eigen::Vector3d {
    return mirror(image).cwiseProduct(nodes_.position.col(node) +
                                      nodes_.axes[static_cast<std::size_t>(node)].leftCols<2>() *
                                          displacement.col(image).segment<2>(2 * node));
  };
  double not_pulled = 0, energy = 0;
  const auto next = [&](const Eigen::MatrixXd& force) {
    normal_force = nodes_.normal_force.replicate(1, images_);
    displacement.setZero();
    double along_load = load + not_pulled;
    energy = 0;
    for (int parity = 0; parity < images_; ++parity) {
      Eigen::VectorXd of_parity = Eigen::VectorXd::Zero(2 * count);
      for (int image = 0; image < images_; ++image)
        of_parity += sign(image, parity) / images_ * force.col(image);
      const TangentialResponse& response = responses_[static_cast<std::size_t>(parity)];
      const Eigen::VectorXd pressed = response.normal_force * of_parity,
                            moved = response.displacement * of_parity;
      energy += 0.5 * images_ * of_parity.dot(moved);
      for (int image = 0; image < images_; ++image) {
        normal_force.col(image) += sign(image, parity) * pressed;
        displacement.col(image) += sign(image, parity) * moved;
      }
      if (parity == 0) along_load += images_ * (response.load * of_parity).sum();
    }
    for (int image = 0; image < images_; ++image) along_load -= lift_of(nodes_, force.col(image));
    const double approach = (load - along_load) / (images_ * approach_.load.sum());
    normal_force.colwise() += approach * approach_.normal_force;
    displacement.colwise() += approach * approach_.displacement;
    not_pulled = -(slope.transpose() * normal_force.cwiseMin(0.0)).sum();
    normal_force = normal_force.cwiseMax(0.0);
    // Every node slips where it has been dragged to.
    Eigen::MatrixXd rubbed(2 * count, images_);
    for (int image = 0; image < images_; ++image)
      for (Index i = 0; i < count; ++i) {
        const Eigen::Vector3d at = Eigen::Vector3d(velocity.x, velocity.y, 0) +
                                   velocity.turn_rad * turned(place(i, image));
        const Eigen::Vector2d along =
            nodes_.axes[static_cast<std::size_t>(i)].leftCols<2>().transpose() *
            mirror(image).cwiseProduct(at);
        // Around the centre of rotation forces point in all directions. A node has their mean.
        rubbed.col(image).segment<2>(2 * i) =
            share * bound_.at(i, normal_force(i, image)) /
            std::hypot(along.norm(), 0.25 * velocity.turn_rad * spacing_, 1e-300) * along;
      }
    return rubbed;
  };
  const Eigen::MatrixXd force =
      settled("full slip on the deformed layer", Eigen::MatrixXd::Zero(2 * count, images_),
              images_ * bound_.of(nodes_.normal_force).sum(), next);
  FrictionWrench wrench;
  for (int image = 0; image < images_; ++image)
    for (Index i = 0; i < count; ++i) {
      const Eigen::Vector3d on_node =
          mirror(image).cwiseProduct(nodes_.axes[static_cast<std::size_t>(i)].leftCols<2>() *
                                     force.col(image).segment<2>(2 * i));
      wrench.force_x += on_node.x();
      wrench.force_y += on_node.y();
      wrench.torque += turned(place(i, image)).dot(on_node);
    }
  return {wrench, energy};
}

SuperposedMotion::SuperposedMotion(FinitePressing& pressing, const FrictionBound& bound)
    : SuperposedMotion(pressing, bound,
                       pressing.superposed_stiffness({/*odd_x=*/true, /*odd_y=*/true})) {}

SuperposedMotion::SuperposedMotion(const FinitePressing& pressing, const FrictionBound& bound,
                                   const Eigen::MatrixXd& stiffness)
    : nodes_(pressing.touching_nodes()),
      copies_(pressing.copies()),
      bound_(bound_of(nodes_, bound)),
      area_(nodal_area(pressing.layer())(nodes_.node)),
      limit_(bound_.of(nodes_.normal_force)),
      present_normal_force_(nodes_.normal_force),
      response_(nodes_, stiffness),
      compliance_(response_.displacement) {
  if (copies_ == 1) approach_ = {nodes_, stiffness, response_};
  const Index count = nodes_.size();
  rigid_.resize(2 * count, 3);
  Eigen::MatrixX3d normal(count, 3);  // V along the normals
  // Along the tangents: forces that hold the nodes while the object moves past them, because it
  // turns the forces' directions, and because its heights change.
  Eigen::MatrixX3d holding(2 * count, 3);
  for (Index i = 0; i < count; ++i) {
    const auto node = static_cast<std::size_t>(i);
    const Eigen::Matrix3d& axes = nodes_.axes[node];
    const ObjectHeight& object = nodes_.object[node];
    for (Index k = 0; k < 3; ++k) {
      const Eigen::Vector3d moved =
          k < 2 ? Eigen::Vector3d::Unit(k) : turned(nodes_.position.col(i));
      Eigen::Vector2d slope = object.curvature * moved.head<2>();
      if (k == 2) slope -= Eigen::Vector2d(-object.slope.y(), object.slope.x());
      Eigen::Vector3d follower = Eigen::Vector3d::Zero();
      follower.head<2>() = nodes_.force[i] * slope;
      rigid_.col(k).segment<2>(2 * i) = axes.leftCols<2>().transpose() * moved;
      normal(i, k) = axes.col(2).dot(moved);
      holding.col(k).segment<2>(2 * i) = axes.leftCols<2>().transpose() * follower;
    }
  }
  const Rows of = rows(count);
  holding += stiffness(of.tangential, of.normal) * normal;
  frictionless_ = -compliance_ * holding;
  // A component that a mirror plane fixes has the compliance 0, which would tell the friction
  // solver that the whole node cannot move. No force ever acts along it: any positive compliance
  // serves.
  const double mean = compliance_.diagonal().mean();
  for (Index row = 0; row < 2 * count; ++row)
    if (compliance_(row, row) == 0) compliance_(row, row) = mean;
  restart();
}

void SuperposedMotion::restart() {
  force_ = slip_ = Eigen::VectorXd::Zero(2 * nodes_.size());
  present_normal_force_ = nodes_.normal_force;
  limit_ = bound_.of(present_normal_force_);
  motion_.setZero();
  dissipated_ = approached_ = 0;
}

double SuperposedMotion::stiffness() const {
  const Eigen::VectorXd stuck =
      solve_positive_definite(compliance_, rigid_.col(2) - frictionless_.col(2));
  return copies_ * rigid_.col(2).dot(stuck);
}

void SuperposedMotion::move_to(const PlaneMotion& motion) {
  motion_ = {motion.x, motion.y, motion.turn_rad};
  Eigen::VectorXd target;
  const auto rub = [&] {
    target = (rigid_ - frictionless_) * motion_ - slip_;
    if (copies_ == 1) target -= approached_ * approach_.displacement;
    solve_friction(compliance_, limit_, target, force_, &stick_slip_);
  };
  if (copies_ == 1)
    settle(rub);
  else
    rub();
  const Eigen::VectorXd slipped = target - compliance_ * force_;
  slip_ += slipped;
  dissipated_ += copies_ * force_.dot(slipped);
}

void SuperposedMotion::settle(const std::function<void()>& rub) {
  const double load = nodes_.force.sum();
  const Eigen::VectorXd slope = cosine(nodes_);
  double not_pulled = 0;
  present_normal_force_ =
      settled("twist on the deformed layer", present_normal_force_, load,
              [&](const Eigen::MatrixXd& normal_force) {
                limit_ = bound_.of(normal_force.reshaped());
                rub();
                const double along_load =
                    not_pulled + (response_.load * force_).sum() - lift_of(nodes_, force_);
                approached_ = -along_load / approach_.load.sum();
                const Eigen::VectorXd next = nodes_.normal_force + response_.normal_force * force_ +
                                             approached_ * approach_.normal_force;
                not_pulled = -slope.dot(next.cwiseMin(0.0));
                return Eigen::MatrixXd(next.cwiseMax(0.0));
              });
  limit_ = bound_.of(present_normal_force_);
  rub();
}

FrictionWrench SuperposedMotion::wrench() const {
  const Eigen::Vector3d along = rigid_.transpose() * force_;
  return {copies_ == 1 ? along.x() : 0, copies_ == 1 ? along.y() : 0, copies_ * along.z()};
}

double SuperposedMotion::slip_fraction() const {
  double slipping = 0, touching = 0;
  for (Index i = 0; i < nodes_.size(); ++i) {
    // The centre of a twist does not move, and carries nothing.
    if (limit_[i] <= 0 || nodes_.position.col(i).head<2>().norm() < 1e-9) continue;
    touching += area_[i];
    if (force_.segment<2>(2 * i).norm() >= limit_[i] * (1 - 1e-9)) slipping += area_[i];
  }
  return slipping / touching;
}

double SuperposedMotion::stored_energy() const {
  return 0.5 * copies_ * force_.dot(compliance_ * force_);
}

double SuperposedMotion::pressure_change() const {
  Eigen::VectorXd change = response_.normal_force * force_;
  if (copies_ == 1) change += approached_ * approach_.normal_force;
  return change.cwiseAbs().sum() / nodes_.force.sum();
}

double SuperposedMotion::largest_displacement() const {
  const Eigen::VectorXd along = compliance_ * force_ + frictionless_ * motion_;
  double largest = 0;
  for (Index i = 0; i < nodes_.size(); ++i)
    largest = std::max(largest, along.segment<2>(2 * i).norm());
  return largest;
}

}  // namespace softfinger::fem::finite
