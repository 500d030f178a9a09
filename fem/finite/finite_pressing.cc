#include "fem/finite/finite_pressing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "fem/base/formatted.h"
#include "fem/contact/pressing.h"
#include "fem/layer/surface_frame.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {

using Eigen::Index;

namespace {

/// The last step to a load may be this much longer than the largest one: no tiny step is left.
constexpr double kStretch = 1.25;

}  // namespace

bool reaches_rim(const LayerDiscretisation& mesh, const SurfaceNode& node) {
  const double x = std::abs(node.x) / mesh.a, y = std::abs(node.y) / mesh.b;
  return std::hypot(x, y + 0.5 / mesh.elements_along_b()) > mesh.patch ||
         std::hypot(x + 0.5 / mesh.elements_along_a(), y) > mesh.patch;
}

double node_spacing(const LayerDiscretisation& mesh) {
  return 0.5 * std::min(mesh.a / mesh.elements_along_a(), mesh.b / mesh.elements_along_b());
}

/// A surface node against the object at its present place.
struct FinitePressing::Touch {
  double gap = 0;                                     ///< along the load, before the approach
  double secant = 1;                                  ///< 1 / cosine of the object's slope
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< outward from the finger
  Eigen::Matrix2d curvature = Eigen::Matrix2d::Zero();
};

FinitePressing::FinitePressing(std::shared_ptr<FiniteLayer> layer,
                               std::shared_ptr<const RigidObject> object,
                               const PressingOptions& options)
    : layer_(std::move(layer)), object_(std::move(object)), options_(options) {
  step_ = options_.largest_step;
  offset_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < layer_->nodes().size(); ++i) {
    const Eigen::Vector3d at = layer_->position(i);
    if (const auto over = object_->over(at.x(), at.y()))
      offset_ = std::min(offset_, over->height - at.z());
  }
  if (!std::isfinite(offset_))
    throw InputError("object", "surface", "none over the contact", "an object over the finger");
  unloaded_ = layer_->state();
  equilibrium_.force = equilibrium_.normal_force =
      Eigen::VectorXd::Zero(static_cast<Index>(layer_->nodes().size()));
}

std::vector<FinitePressing::Touch> FinitePressing::touches() const {
  std::vector<Touch> result(layer_->nodes().size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Eigen::Vector3d at = layer_->position(i);
    const auto over = object_->over(at.x(), at.y());
    Touch& touch = result[i];
    if (!over) {
      // Beside the object there is nothing to touch: any gap larger than an approach will do.
      touch.gap = 1e3;
      continue;
    }
    touch.gap = over->height - offset_ - at.z();
    touch.secant = std::sqrt(1 + over->slope.squaredNorm());
    touch.normal = Eigen::Vector3d(-over->slope.x(), -over->slope.y(), 1) / touch.secant;
    touch.curvature = over->curvature;
  }
  return result;
}

std::vector<NodeFrame> FinitePressing::frames(const std::vector<Touch>& touching,
                                              const Eigen::VectorXd& force) const {
  std::vector<NodeFrame> result(touching.size());
  for (std::size_t i = 0; i < touching.size(); ++i) {
    result[i].axes = surface_frame(touching[i].normal);
    result[i].curvature_force = force[static_cast<Index>(i)] * touching[i].curvature;
  }
  return result;
}

TouchingNodes FinitePressing::touching_nodes() const {
  TouchingNodes result;
  for (std::size_t i = 0; i < layer_->nodes().size(); ++i)
    if (equilibrium_.force[static_cast<Index>(i)] > 0) result.node.push_back(static_cast<int>(i));
  const std::vector<NodeFrame> of_all = frames(touches(), equilibrium_.force);
  result.position.resize(3, static_cast<Index>(result.node.size()));
  for (std::size_t i = 0; i < result.node.size(); ++i) {
    const auto node = static_cast<std::size_t>(result.node[i]);
    const Eigen::Vector3d at = layer_->position(node);
    result.position.col(static_cast<Index>(i)) = at;
    result.axes.push_back(of_all[node].axes);
    result.object.push_back(object_->over(at.x(), at.y()).value());
  }
  result.force = equilibrium_.force(result.node);
  result.normal_force = equilibrium_.normal_force(result.node);
  return result;
}

Eigen::VectorXd FinitePressing::clearance() const {
  const std::vector<Touch> touching = touches();
  Eigen::VectorXd result(static_cast<Index>(touching.size()));
  for (std::size_t i = 0; i < touching.size(); ++i)
    result[static_cast<Index>(i)] = touching[i].gap - equilibrium_.approach;
  return result;
}

Eigen::MatrixXd FinitePressing::superposed_stiffness(Parity parity) {
  return layer_->superposed_stiffness(frames(touches(), equilibrium_.force),
                                      equilibrium_.normal_force, parity, touching_nodes().node);
}

Eigen::Vector3d FinitePressing::normal(std::size_t node) const {
  const Eigen::Vector3d at = layer_->position(node);
  const auto over = object_->over(at.x(), at.y());
  if (!over) return Eigen::Vector3d::UnitZ();
  return Eigen::Vector3d(-over->slope.x(), -over->slope.y(), 1).normalized();
}

/// Newton's method from the present equilibrium to `drive`, or, where `limited` and that is further
/// than the largest step, to an approach that is not.
/// @returns whether it converged; the layer's state is anywhere if not
bool FinitePressing::try_step(const Drive& drive, bool limited, Equilibrium& reached) {
  constexpr int most_iterations = 16;
  Drive target = drive;
  Eigen::VectorXd contact_force = equilibrium_.force;
  double approach = equilibrium_.approach;
  double balance = 0, previous_balance = 0, previous_change = 0;
  bool renew = true;
  for (int iteration = 1; iteration <= most_iterations; ++iteration) {
    ++history_.iterations;
    const std::vector<Touch> touching = touches();
    Eigen::VectorXd secant(contact_force.size()), gap(contact_force.size());
    for (std::size_t i = 0; i < touching.size(); ++i) {
      const auto row = static_cast<Index>(i);
      secant[row] = touching[i].secant;
      gap[row] = touching[i].gap;
    }
    const Eigen::VectorXd normal_force = contact_force.cwiseProduct(secant);
    if (renew) {
      balance = layer_->linearise(frames(touching, contact_force), normal_force) /
                std::max(1e-300, contact_force.maxCoeff());
      history_.shifts += layer_->shift() > 0;
      failed_iteration_ = iteration;
      failed_residual_ = balance;
      // The first iteration answers the change of the load, and the second one everything nonlinear
      // in it: only then does Newton's method have to converge.
      if (iteration > 3 && !(balance < 10 * previous_balance)) return false;
      previous_balance = balance;
    } else {
      balance = layer_->update_residual(frames(touching, contact_force), normal_force) /
                std::max(1e-300, contact_force.maxCoeff());
    }

    // In components along the load, contact on inclined normals is that of a flat surface with
    // another stiffness (as in `press_on`).
    SurfaceResponse response = layer_->surface_response();
    const Eigen::VectorXd cosine = secant.cwiseInverse();
    response.stiffness = cosine.asDiagonal() * response.stiffness * cosine.asDiagonal();
    response.force = response.force.cwiseProduct(cosine);
    const auto solve = [&](const Drive& to) {
      return solve_tangent_contact(response, Eigen::VectorXd::Ones(gap.size()), gap,
                                   to.approach > 0 ? 0 : to.load / copies(), to.approach,
                                   contact_force);
    };
    const double longest = kStretch * std::copysign(step_, drive.load - equilibrium_.load);
    const double farthest = equilibrium_.approach + longest;
    if (iteration == 1 && limited && farthest > 0) {
      // The longest step comes first: the tangent far beyond it may have no contact that bears the
      // load, and then no shorter step would help.
      const double load = copies() * solve({0, farthest}).force.sum();
      // If the load falls as the approach grows, no equilibrium with a larger load is near.
      if ((load - equilibrium_.load) * longest <= 0) return false;
      if ((drive.load - load) * longest > 0)
        target = {0, equilibrium_.approach + longest / kStretch};
    }
    const TangentContact next = solve(target);

    const double change =
        layer_->find_step(next.force.cwiseProduct(secant), next.displacement.cwiseProduct(cosine));
    if (!std::isfinite(change)) return false;
    double fraction = 1;
    constexpr double shortest = 1.0 / 16;
    while (!(layer_->take_step(fraction) > 0)) {
      fraction /= 2;
      if (fraction < shortest) return false;
    }
    contact_force += fraction * (next.force - contact_force);
    approach += fraction * (next.approach - approach);
    if (iteration > 3 && change > previous_change && change > 0.1 * step_) return false;
    // With the true tangent the next step would be about the square of this one. With a shifted
    // tangent it would not: there the forces have to be in balance. A tangent is good for a few
    // small steps more. The last one is always such a step, since a tangent may be in single
    // precision: how much shorter it is than the one before tells what is left.
    constexpr double small = 1e-3, of_next = 1e-3, slow = 0.1, balanced = 1e-8;
    const bool was_kept = !renew;
    const double shortening = was_kept ? change / previous_change : 0;
    previous_change = change;
    renew = fraction < 1 || !(change <= small * approach) || shortening > slow;
    const bool is_shifted = layer_->shift() > 0;
    if (is_shifted) renew = true;
    if (fraction < 1 || !(change <= options_.tolerance * approach) ||
        (is_shifted ? balance > balanced
                    : !was_kept || shortening * change > of_next * options_.tolerance * approach))
      continue;

    reached.approach = approach;
    reached.force = contact_force;
    reached.active = next.active;
    reached.out_of_balance = balance;
    describe(reached);
    return true;
  }
  return false;
}

void FinitePressing::describe(Equilibrium& equilibrium) const {
  const auto& nodes = layer_->nodes();
  const LayerDiscretisation& discretisation = layer_->discretisation();
  const std::vector<Touch> touching = touches();
  equilibrium.normal_force.resize(equilibrium.force.size());
  equilibrium.load = copies() * equilibrium.force.sum();
  equilibrium.energy = copies() * layer_->strain_energy();
  equilibrium.reaches_rim = false;
  equilibrium.steepest_rad = 0;
  double penetration = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto row = static_cast<Index>(i);
    const double force = equilibrium.force[row];
    equilibrium.normal_force[row] = force * touching[i].secant;
    const double clearance = touching[i].gap - equilibrium.approach;
    penetration = std::max(penetration, force > 0 ? std::abs(clearance) : -clearance);
    if (force <= 0) continue;
    equilibrium.steepest_rad =
        std::max(equilibrium.steepest_rad, std::acos(1 / touching[i].secant));
    equilibrium.reaches_rim =
        equilibrium.reaches_rim || finite::reaches_rim(discretisation, nodes[i]);
  }
  equilibrium.complementarity_residual = penetration / equilibrium.approach;
  const Eigen::Vector2d axes = discretisation.is_scan
                                   ? holding_axes(nodes, equilibrium.force, no_plane)
                                   : axes_of_moments(nodes, equilibrium.force);
  equilibrium.moment_a = axes.x();
  equilibrium.moment_b = axes.y();
}

void FinitePressing::take_over(const Eigen::Matrix3Xd& force, double approach,
                               double out_of_balance) {
  const std::vector<Touch> touching = touches();
  equilibrium_.approach = approach;
  equilibrium_.out_of_balance = out_of_balance;
  equilibrium_.active = 0;
  equilibrium_.friction.setZero(2, force.cols());
  for (std::size_t i = 0; i < touching.size(); ++i) {
    const auto of_node = force.col(static_cast<Index>(i));
    const bool touches = of_node.z() > 0;
    equilibrium_.active += touches;
    // Friction on an inclined surface bears a part of the load, or adds to it.
    const Eigen::Vector3d friction =
        surface_frame(touching[i].normal).leftCols<2>() * of_node.head<2>();
    equilibrium_.force[static_cast<Index>(i)] =
        touches ? of_node.z() / touching[i].secant - friction.z() : 0;
    if (touches) equilibrium_.friction.col(static_cast<Index>(i)) = friction.head<2>();
  }
  describe(equilibrium_);
  equilibrium_.normal_force = force.row(2).transpose();
}

void FinitePressing::continue_from(const FinitePressing& other) {
  layer_->continue_from(*other.layer_);
  equilibrium_.approach = other.equilibrium_.approach;
  // The other mesh's nodal forces over their share of the block, at this one's nodes.
  const auto &nodes = layer_->nodes(), &theirs = other.layer_->nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (const SurfaceFace& face : other.layer_->faces()) {
      const double xi = (nodes[i].x - face.x) / face.size_x,
                   eta = (nodes[i].y - face.y) / face.size_y;
      if (!(xi >= 0 && xi <= 1 && eta >= 0 && eta <= 1)) continue;
      // Bilinear between the corners: it stays positive.
      double pressure = 0;
      for (const int k : {0, 2, 6, 8})
        if (const int node = face.node[static_cast<std::size_t>(k)]; node >= 0)
          pressure += (k % 3 == 0 ? 1 - xi : xi) * (k < 3 ? 1 - eta : eta) *
                      other.equilibrium_.force[node] /
                      theirs[static_cast<std::size_t>(node)].weight;
      equilibrium_.force[static_cast<Index>(i)] = pressure * nodes[i].weight;
      break;
    }
  continues_ = true;
}

void FinitePressing::press(const Drive& drive) {
  if (continues_) {
    continues_ = false;
    Equilibrium reached;
    try {
      if (layer_->smallest_volume_ratio() > 0 && try_step(drive, /*limited=*/false, reached)) {
        equilibrium_ = std::move(reached);
        ++history_.steps;
        return;
      }
    } catch (const ConvergenceError&) {
      // From the unloaded state it may go.
    }
    ++history_.cuts;
    layer_->restore(*unloaded_);
    equilibrium_.approach = 0;
    equilibrium_.force.setZero();
  }
  constexpr double shortest_step = 1e-3;
  constexpr int most_steps = 200;
  const auto is_there = [&] {
    return drive.approach > 0
               ? std::abs(equilibrium_.approach - drive.approach) <= 1e-12 * drive.approach
               : std::abs(equilibrium_.load - drive.load) <= 1e-9 * drive.load;
  };
  for (int steps = 0; !is_there(); ++steps) {
    if (steps == most_steps)
      throw ConvergenceError("steps of the load", steps, equilibrium_.approach,
                             "the load is not approached; is it more than the layer can carry?");
    const auto before = layer_->state();
    Equilibrium reached;
    Drive next = drive;
    bool limited = true;
    if (drive.approach > 0) {
      const double left = drive.approach - equilibrium_.approach;
      if (std::abs(left) > kStretch * step_)
        next.approach = equilibrium_.approach + std::copysign(step_, left);
      limited = false;
    }
    const int iterations = history_.iterations;
    bool converged = false;
    try {
      converged = try_step(next, limited, reached);
    } catch (const ConvergenceError&) {
      // The factorisation or the active set failed. A shorter step may help with both.
    }
    // On a mesh that was made for a larger contact, the nodes around the object can be pressed
    // further when the layer under it is used up.
    constexpr double pressed_through = 1;
    if (converged && reached.approach >= pressed_through) {
      layer_->restore(*before);
      throw ConvergenceError("finite strain", history_.iterations, reached.out_of_balance,
                             "the layer is pressed through: less load");
    }
    if (converged) {
      equilibrium_ = std::move(reached);
      ++history_.steps;
      constexpr int few_iterations = 5;
      if (history_.iterations - iterations <= few_iterations)
        step_ = std::min(options_.largest_step, 1.5 * step_);
      continue;
    }
    layer_->restore(*before);
    ++history_.cuts;
    step_ /= 2;
    if (step_ >= shortest_step) continue;
    const std::string stage =
        formatted("finite strain beyond d/h = %.3g, P/(E h²) = %.4g, the last that is converged,",
                  equilibrium_.approach, equilibrium_.load);
    throw ConvergenceError(stage, failed_iteration_, failed_residual_,
                           "the layer is nearly pressed through or its surface folds; press less");
  }
}

}  // namespace softfinger::fem::finite
