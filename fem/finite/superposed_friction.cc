#include "fem/finite/superposed_friction.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "fem/coulomb_friction.h"
#include "fem/finite/deformed_contact.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {

using Eigen::Index;

namespace {

/// e_z x x.
Eigen::Vector3d turned(const Eigen::Vector3d& position) { return {-position.y(), position.x(), 0}; }

struct Rows {
  std::vector<Index> tangential, normal;
};

/// Of the nodes' 3 x 3 blocks.
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
  const Eigen::LLT<Eigen::MatrixXd> factor(stiffness(from, from));
  if (factor.info() != Eigen::Success)
    throw ConvergenceError("friction on the deformed layer", 0, 0,
                           "the pressed state is not stable against shear: less load");
  const auto size = static_cast<Index>(free.size());
  const Eigen::MatrixXd of_free = factor.solve(Eigen::MatrixXd::Identity(size, size));
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
    // The reaction leaves out what the tangent counts as the contact force's own.
    result.block<1, 3>(i, 3 * i) -= nodes.force[i] * axes.col(2).head<2>().transpose() *
                                    nodes.object[node].curvature * axes.topRows<2>();
  }
  return result;
}

/// Images of a quarter of the contact, bit 0: mirrored at x = 0, bit 1: at y = 0. Seen in its
/// mirror, a field that is odd where bit 0 (1) of the parity is set has this sign on an image.
constexpr int images = 4;
double sign(int image, int parity) {
  return ((image & parity & 1) != 0) != ((image & parity & 2) != 0) ? -1 : 1;
}
Eigen::Vector3d mirror(int image) { return {image & 1 ? -1.0 : 1.0, image & 2 ? -1.0 : 1.0, 1}; }

}  // namespace

FrictionWrench slide(const FinitePressing& pressing, double friction_coefficient,
                     const PlaneMotion& velocity) {
  const TouchingNodes nodes = pressing.touching_nodes();
  FrictionWrench result;
  for (int image = 0; image < pressing.copies(); ++image) {
    for (Index i = 0; i < nodes.size(); ++i) {
      const Eigen::Vector3d position = mirror(image).cwiseProduct(nodes.position.col(i));
      const Eigen::Vector3d normal =
          mirror(image).cwiseProduct(nodes.axes[static_cast<std::size_t>(i)].col(2));
      Eigen::Vector3d along =
          Eigen::Vector3d(velocity.x, velocity.y, 0) + velocity.turn_rad * turned(position);
      along -= normal.dot(along) * normal;
      const double speed = along.norm();
      // At the centre of rotation nothing slides: no force is the mean of what its neighbours have.
      if (!(speed > 0)) continue;
      const Eigen::Vector3d force = friction_coefficient * nodes.normal_force[i] / speed * along;
      result.force_x += force.x();
      result.force_y += force.y();
      result.torque += turned(position).dot(force);
    }
  }
  return result;
}

SuperposedSlide::SuperposedSlide(FinitePressing& pressing, double friction_coefficient)
    : nodes_(pressing.touching_nodes()), friction_coefficient_(friction_coefficient) {
  const Index count = nodes_.size();
  const Rows of = rows(count);
  cosine_.resize(count);
  for (Index i = 0; i < count; ++i) cosine_[i] = nodes_.axes[static_cast<std::size_t>(i)](2, 2);
  for (int parity = 0; parity < images; ++parity) {
    const Eigen::MatrixXd stiffness =
        pressing.superposed_stiffness({(parity & 1) != 0, (parity & 2) != 0});
    const Eigen::MatrixXd normal_force = normal_force_by_displacement(nodes_, stiffness);
    const Eigen::MatrixXd load = -(cosine_.asDiagonal() * stiffness(of.normal, Eigen::all));
    const Eigen::MatrixXd compliance = tangential_compliance(stiffness);
    responses_.push_back({normal_force(Eigen::all, of.tangential) * compliance,
                          load(Eigen::all, of.tangential) * compliance, compliance});
    if (parity != 0) continue;
    // The object's approach pushes the normals, and the nodes give way along the tangents.
    Eigen::VectorXd displacement(3 * count);
    displacement(of.normal) = -cosine_;
    displacement(of.tangential) = compliance * (stiffness(of.tangential, of.normal) * cosine_);
    normal_by_approach_ = normal_force * displacement;
    load_by_approach_ = load * displacement;
  }
}

SuperposedSlide::Slid SuperposedSlide::slide(const PlaneMotion& velocity) const {
  const Index count = nodes_.size();
  const double load = images * nodes_.force.sum();
  Eigen::MatrixXd normal_force = nodes_.normal_force.replicate(1, images);
  // In the frames' mirrors, like all that follows: directions of slip.
  Eigen::MatrixXd direction(2 * count, images), lift(count, images);
  for (int image = 0; image < images; ++image)
    for (Index i = 0; i < count; ++i) {
      const Eigen::Matrix3d& axes = nodes_.axes[static_cast<std::size_t>(i)];
      const Eigen::Vector3d position = mirror(image).cwiseProduct(nodes_.position.col(i));
      const Eigen::Vector3d at =
          Eigen::Vector3d(velocity.x, velocity.y, 0) + velocity.turn_rad * turned(position);
      Eigen::Vector2d along = axes.leftCols<2>().transpose() * mirror(image).cwiseProduct(at);
      if (along.norm() > 0) along.normalize();
      direction.col(image).segment<2>(2 * i) = along;
      lift(i, image) = axes.row(2).head<2>() * along;
    }

  constexpr int limit = 1000;
  constexpr double tolerance = 1e-6;  // of the load, far below the discretisation's error
  // Shear lifts the surface before a point and lowers it behind: on the whole the pressure's change
  // oscillates with the shear's, which a large share of each step would amplify.
  constexpr double smallest_share = 1.0 / 64;
  double change = 0, previous = 0, share = 1, not_pulled = 0;
  for (int iteration = 1; iteration <= limit; ++iteration) {
    Eigen::MatrixXd force(2 * count, images);
    for (int image = 0; image < images; ++image)
      for (Index i = 0; i < count; ++i)
        force.col(image).segment<2>(2 * i) =
            friction_coefficient_ * normal_force(i, image) * direction.col(image).segment<2>(2 * i);
    Eigen::MatrixXd next = nodes_.normal_force.replicate(1, images);
    double along_load = load + not_pulled, energy = 0;
    for (int parity = 0; parity < images; ++parity) {
      Eigen::VectorXd of_parity = Eigen::VectorXd::Zero(2 * count);
      for (int image = 0; image < images; ++image)
        of_parity += sign(image, parity) / images * force.col(image);
      const Response& response = responses_[static_cast<std::size_t>(parity)];
      const Eigen::VectorXd moved = response.normal_force * of_parity;
      energy += 0.5 * images * of_parity.dot(response.displacement * of_parity);
      for (int image = 0; image < images; ++image) next.col(image) += sign(image, parity) * moved;
      if (parity == 0) along_load += images * (response.load * of_parity).sum();
    }
    along_load -= friction_coefficient_ * normal_force.cwiseProduct(lift).sum();
    const double approach = (load - along_load) / (images * load_by_approach_.sum());
    next.colwise() += approach * normal_by_approach_;
    not_pulled = -(cosine_.transpose() * next.cwiseMin(0.0)).sum();
    next = next.cwiseMax(0.0);
    change = (next - normal_force).cwiseAbs().sum() / load;
    if (iteration > 1 && change > 0.9 * previous) share = std::max(smallest_share, share / 2);
    previous = change;
    normal_force += share * (next - normal_force);
    if (change > tolerance) continue;
    FrictionWrench wrench;
    for (int image = 0; image < images; ++image)
      for (Index i = 0; i < count; ++i) {
        const Eigen::Vector3d position = mirror(image).cwiseProduct(nodes_.position.col(i));
        const Eigen::Vector3d along =
            mirror(image).cwiseProduct(nodes_.axes[static_cast<std::size_t>(i)].leftCols<2>() *
                                       direction.col(image).segment<2>(2 * i));
        const Eigen::Vector3d on_node = friction_coefficient_ * normal_force(i, image) * along;
        wrench.force_x += on_node.x();
        wrench.force_y += on_node.y();
        wrench.torque += turned(position).dot(on_node);
      }
    return {wrench, energy};
  }
  throw ConvergenceError("full slip on the deformed layer", limit, change,
                         "pressure and friction keep changing each other; is the coefficient of "
                         "friction very large?");
}

SuperposedTwist::SuperposedTwist(FinitePressing& pressing, double friction_coefficient)
    : nodes_(pressing.touching_nodes()),
      copies_(pressing.copies()),
      area_(nodal_area(pressing)(nodes_.node)),
      limit_(friction_coefficient * nodes_.normal_force),
      stiffness_(pressing.superposed_stiffness({/*odd_x=*/true, /*odd_y=*/true})) {
  const Index count = nodes_.size();
  turn_.resize(2 * count);
  Eigen::VectorXd normal_turn(count);  // e_z x x along the normals
  // Along the tangents: forces that hold the nodes while the object turns under them, because it
  // turns the forces' directions, and because its heights change.
  Eigen::VectorXd holding(2 * count);
  for (Index i = 0; i < count; ++i) {
    const auto node = static_cast<std::size_t>(i);
    const Eigen::Matrix3d& axes = nodes_.axes[node];
    const ObjectHeight& object = nodes_.object[node];
    const Eigen::Vector3d turn = turned(nodes_.position.col(i));
    turn_.segment<2>(2 * i) = axes.leftCols<2>().transpose() * turn;
    normal_turn[i] = axes.col(2).dot(turn);
    Eigen::Vector3d follower = Eigen::Vector3d::Zero();
    follower.head<2>() = nodes_.force[i] * (object.curvature * turn.head<2>() -
                                            Eigen::Vector2d(-object.slope.y(), object.slope.x()));
    holding.segment<2>(2 * i) = axes.leftCols<2>().transpose() * follower;
  }
  const Rows of = rows(count);
  holding += stiffness_(of.tangential, of.normal) * normal_turn;
  compliance_ = tangential_compliance(stiffness_);
  frictionless_ = -compliance_ * holding;
  // What a mirror plane fixes is never pushed; any compliance keeps the node's two components apart
  // and lets the other one move.
  const double mean = compliance_.diagonal().mean();
  for (Index row = 0; row < 2 * count; ++row)
    if (compliance_(row, row) == 0) compliance_(row, row) = mean;
  force_ = slip_ = Eigen::VectorXd::Zero(2 * count);
}

double SuperposedTwist::stiffness() const {
  const Eigen::VectorXd stuck = compliance_.llt().solve(turn_ - frictionless_);
  return copies_ * turn_.dot(stuck);
}

void SuperposedTwist::turn_to(double angle_rad) {
  const Eigen::VectorXd target = angle_rad * (turn_ - frictionless_) - slip_;
  solve_friction(compliance_, limit_, target, force_);
  const Eigen::VectorXd slipped = target - compliance_ * force_;
  slip_ += slipped;
  dissipated_ += copies_ * force_.dot(slipped);
  angle_ = angle_rad;
}

double SuperposedTwist::torque() const { return copies_ * turn_.dot(force_); }

double SuperposedTwist::slip_fraction() const {
  double slipping = 0, touching = 0;
  for (Index i = 0; i < nodes_.size(); ++i) {
    // The centre of a twist does not move, and carries nothing.
    if (nodes_.position.col(i).head<2>().norm() < 1e-9) continue;
    touching += area_[i];
    if (force_.segment<2>(2 * i).norm() >= limit_[i] * (1 - 1e-9)) slipping += area_[i];
  }
  return slipping / touching;
}

double SuperposedTwist::stored_energy() const {
  return 0.5 * copies_ * force_.dot(compliance_ * force_);
}

double SuperposedTwist::pressure_change() const {
  const Eigen::MatrixXd change = normal_force_by_displacement(nodes_, stiffness_);
  const Eigen::VectorXd sheared = compliance_ * force_;
  return (change(Eigen::all, rows(nodes_.size()).tangential) * sheared).cwiseAbs().sum() /
         nodes_.force.sum();
}

double SuperposedTwist::largest_displacement() const {
  const Eigen::VectorXd along = compliance_ * force_ + angle_ * frictionless_;
  double largest = 0;
  for (Index i = 0; i < nodes_.size(); ++i)
    largest = std::max(largest, along.segment<2>(2 * i).norm());
  return largest;
}

}  // namespace softfinger::fem::finite
