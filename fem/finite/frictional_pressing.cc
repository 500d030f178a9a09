#include "fem/finite/frictional_pressing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "fem/algebra/fixed_point.h"
#include "fem/algebra/positive_definite.h"
#include "fem/finite/deformed_contact.h"
#include "fem/finite/tangent_contact.h"
#include "fem/friction/coulomb_friction.h"
#include "fem/friction/friction_study.h"
#include "fem/layer/surface_frame.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {

using Eigen::Index;

namespace {

/// Tolerance of Newton's step, relative to the approach. What a slide misses no later one inherits:
/// it changes their wrenches by less than 3e-4.
constexpr double of_increments = 5e-4, of_slides = 2e-3;
/// Increments of the load are extrapolated, which doubles what each misses.
constexpr double of_pressing = 1e-4;

Eigen::Rotation2Dd rotation(const PlaneMotion& motion) {
  return Eigen::Rotation2Dd(motion.turn_rad);
}

PlaneMotion between(const PlaneMotion& from, const PlaneMotion& to, double share) {
  return {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y),
          from.turn_rad + share * (to.turn_rad - from.turn_rad)};
}

/// Carries points on the object along when it moves from one place to another and nearer.
Eigen::Matrix3Xd carried(Eigen::Matrix3Xd points, const PlaneMotion& from, const PlaneMotion& to,
                         double approached) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(to.turn_rad - from.turn_rad).toRotationMatrix();
  for (auto point : points.colwise()) {
    point.head<2>() = turn * (point.head<2>() - Eigen::Vector2d(from.x, from.y)).eval() +
                      Eigen::Vector2d(to.x, to.y);
    point.z() -= approached;
  }
  return points;
}

Eigen::Matrix3Xd only_normal(const Eigen::VectorXd& normal_force) {
  Eigen::Matrix3Xd result = Eigen::Matrix3Xd::Zero(3, normal_force.size());
  result.row(2) = normal_force.transpose();
  return result;
}

}  // namespace

/// A surface node against the moved object.
struct FrictionalPressing::Touch {
  double gap = 1e3;  ///< along the load, before the approach; beside the object: any large one
  double secant = 1;
  NodeFrame frame;
};

/// A step of the surface, in the nodes' frames.
struct FrictionalPressing::SurfaceStep {
  Eigen::Matrix3Xd force;          ///< on the nodes
  Eigen::VectorXd force_of_layer;  ///< what goes together with the displacement on the tangent
  Eigen::VectorXd displacement;
  double approach = 0;
  bool is_settled = false;  ///< pressure and friction agree
};

/// The layer's tangent about an earlier state, condensed to the surface, for normal displacements
/// with friction given, and for tangential ones with the normal displacements given.
struct FrictionalPressing::Tangent {
  std::vector<Index> tangential, normal;  ///< rows
  Eigen::MatrixXd compliance;             ///< 2n x 2n, along the tangents, normals held
  Eigen::MatrixXd by_normal;              ///< 2n x n: tangential forces per normal displacement
  Eigen::MatrixXd lift;                   ///< n x 2n: normal forces per tangential one
  SurfaceResponse normal_response;        ///< n, to normal displacements, friction kept
  ReleasedFactor released;                ///< of that, unshifted
  StickSlipFactor stick_slip;

  /// Added to the stiffness along the load, on its diagonal, where it has to be positive definite.
  /// It shortens the steps and vanishes with them: the state that they lead to is the same.
  double shift = 0;

  void stabilise() {
    const Eigen::MatrixXd& stiffness = normal_response.stiffness;
    const double enough = stiffness.norm();
    for (shift = 1e-2 * stiffness.diagonal().maxCoeff(); shift < enough; shift *= 2) {
      Eigen::MatrixXd shifted = stiffness;
      shifted.diagonal().array() += shift;
      if (factorise_positive_definite(shifted)) return;
    }
  }

  /// @returns false where the state is not stable against shear
  bool set(const Eigen::MatrixXd& of_surface) {
    tangential.clear();
    normal.clear();
    // A mirror plane fixes some of the tangential rows.
    std::vector<Index> movable, movable_of_surface;
    for (Index i = 0; i < of_surface.rows() / 3; ++i) {
      for (const Index row : {3 * i, 3 * i + 1}) {
        if (of_surface(row, row) != 0) {
          movable.push_back(static_cast<Index>(tangential.size()));
          movable_of_surface.push_back(row);
        }
        tangential.push_back(row);
      }
      normal.push_back(3 * i + 2);
    }
    const Eigen::MatrixXd of_movable =
        inverse_of_positive_definite(of_surface(movable_of_surface, movable_of_surface));
    if (of_movable.size() == 0) return false;
    compliance.setZero(of_surface.rows() / 3 * 2, of_surface.rows() / 3 * 2);
    compliance(movable, movable) = of_movable;
    by_normal = of_surface(tangential, normal);
    lift = by_normal.transpose() * compliance;
    normal_response.stiffness = of_surface(normal, normal) - lift * by_normal;
    return true;
  }
};

FrictionalPressing::FrictionalPressing(const FinitePressing& pressed, FrictionBound bound,
                                       bool has_room)
    : layer_(pressed.shared_layer()),
      object_(pressed.object()),
      offset_(pressed.offset()),
      drive_{pressed.equilibrium().load / pressed.copies(), 0},
      bound_(std::move(bound)),
      has_room_(has_room),
      pressed_state_(layer_->state()),
      pressed_force_(only_normal(pressed.equilibrium().normal_force)),
      pressed_approach_(pressed.equilibrium().approach) {
  spacing_ = node_spacing(layer_->discretisation());
  restart();
  pressed_position_ = kept_position_;
  pressed_area_ = projected_area();
  pressed_peak_ = peak_pressure();
  const Eigen::VectorXd limit = bound_.of(pressed_force_.row(2).transpose());
  arm_ = limit.dot(pressed_position_.topRows<2>().colwise().norm()) / limit.sum();
  slid_.push_back({Eigen::Vector3d::Zero(), present()});
}

FrictionalPressing::~FrictionalPressing() {
  layer_->restore(*pressed_state_);
  layer_->release_factor();
}

void FrictionalPressing::restart() {
  slide_.reset();
  layer_->restore(*pressed_state_);
  force_ = pressed_force_;
  approach_ = pressed_approach_;
  motion_ = {};
  keep();
}

void FrictionalPressing::keep() {
  kept_state_ = layer_->state();
  kept_force_ = force_;
  kept_approach_ = approach_;
  kept_motion_ = motion_;
  kept_position_.resize(3, force_.cols());
  for (Index i = 0; i < force_.cols(); ++i)
    kept_position_.col(i) = layer_->position(static_cast<std::size_t>(i));
}

void FrictionalPressing::take_back() {
  layer_->restore(*kept_state_);
  force_ = kept_force_;
  approach_ = kept_approach_;
  motion_ = kept_motion_;
}

std::vector<FrictionalPressing::Touch> FrictionalPressing::touches() const {
  std::vector<Touch> result(static_cast<std::size_t>(force_.cols()));
  const Eigen::Matrix2d turn = rotation(motion_).toRotationMatrix();
  const Eigen::Vector2d shift(motion_.x, motion_.y);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Eigen::Vector3d at = layer_->position(i);
    const Eigen::Vector2d on_object = turn.transpose() * (at.head<2>() - shift);
    const auto over = object_->over(on_object.x(), on_object.y());
    if (!over) continue;
    Touch& touch = result[i];
    const Eigen::Vector2d slope = turn * over->slope;
    touch.gap = over->height - offset_ - at.z();
    touch.secant = std::sqrt(1 + slope.squaredNorm());
    touch.frame.axes = surface_frame(Eigen::Vector3d(-slope.x(), -slope.y(), 1) / touch.secant);
    touch.frame.curvature_force = force_(2, static_cast<Index>(i)) / touch.secant *
                                  (turn * over->curvature * turn.transpose());
  }
  return result;
}

/// The target of sticking nodes, along the present tangents: from each node to the place on the
/// object where it was at the last increment's end. An object that turns takes it there on an arc,
/// whose chord is ahead of the motion under a node that stays by half of the turn: it is turned
/// back by that, so that friction on a slipping node is along the motion under it. Where a node
/// sticks there is nothing to turn.
Eigen::VectorXd FrictionalPressing::stuck_target(const std::vector<Touch>& touching,
                                                 double approach) const {
  const Eigen::Matrix3Xd taken =
      carried(kept_position_, kept_motion_, motion_, approach - kept_approach_);
  const Eigen::Matrix2d back =
      Eigen::Rotation2Dd((kept_motion_.turn_rad - motion_.turn_rad) / 2).toRotationMatrix();
  Eigen::VectorXd result(2 * force_.cols());
  for (Index i = 0; i < force_.cols(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    Eigen::Vector3d ahead = taken.col(i) - layer_->position(node);
    ahead.head<2>() = (back * ahead.head<2>()).eval();
    result.segment<2>(2 * i) = touching[node].frame.axes.leftCols<2>().transpose() * ahead;
  }
  return result;
}

bool FrictionalPressing::try_motion(const PlaneMotion& motion, const Rub& rub, double tolerance) {
  constexpr int most_iterations = 60, most_tangents = 6;
  constexpr double slow = 0.85;  // a tangent that shortens two steps by less is renewed
  constexpr double far = 0.25;   // h: the tangent is of no use beyond
  motion_ = motion;
  double previous = std::numeric_limits<double>::infinity(), two_before = previous;
  bool renew = tangent_ == nullptr;
  FixedPoint mixing;
  std::vector<State> history;  // latest first
  int renewed = 0;
  for (int iteration = 1; iteration <= most_iterations; ++iteration) {
    ++iterations_;
    const std::vector<Touch> touching = touches();
    std::vector<NodeFrame> frames;
    for (const Touch& touch : touching) frames.push_back(touch.frame);
    const double balance = renew ? layer_->linearise(frames, force_, Along::all)
                                 : layer_->update_residual(frames, force_);
    out_of_balance_ = balance / std::max(1e-300, force_.row(2).maxCoeff());
    if (renew) {
      ++factorisations_;
      ++renewed;
    }
    if (renew) {
      history.clear();
      mixing.restart();
      tangent_ = std::make_unique<Tangent>();
      if (!tangent_->set(layer_->take_surface_stiffness())) {
        tangent_.reset();
        failure_ = "the surface is not stable against shear";
        return false;
      }
    }
    const Eigen::VectorXd rest = layer_->surface_force();
    const Eigen::VectorXd before = layer_->displacements();

    SurfaceStep next = step_of_surface(touching, rest, rub);
    double step = layer_->find_step(next.force_of_layer, next.displacement);
    if (step > far && tangent_->shift == 0) {
      tangent_->stabilise();
      next = step_of_surface(touching, rest, rub);
      step = layer_->find_step(next.force_of_layer, next.displacement);
    }
    if (!std::isfinite(step)) {
      failure_ = "a step leads nowhere";
      return false;
    }
    double fraction = std::min(1.0, far / step);
    while (!(layer_->take_step(fraction) > 0)) {
      fraction /= 2;
      if (fraction < 1.0 / 16) {
        failure_ = "an element turns over";
        return false;
      }
    }
    force_ += fraction * (next.force - force_);
    approach_ += fraction * (next.approach - approach_);
    if (fraction == 1 && step <= tolerance * approach_ && next.is_settled) {
      const std::size_t nodes = layer_->nodes().size();
      const LayerDiscretisation& mesh = layer_->discretisation();
      for (std::size_t i = 0; i < nodes; ++i) {
        const SurfaceNode& node = layer_->nodes()[i];
        if (force_(2, static_cast<Index>(i)) > 0 && reaches_rim(mesh, node)) {
          failure_ = "friction moves the contact out of the refined patch";
          if (has_room_)
            throw EdgeLeftMargin("size of the frictional contact", iterations_,
                                 std::hypot(node.x / mesh.a, node.y / mesh.b), failure_);
          return false;
        }
      }
      return true;
    }
    const bool is_slow = step > slow * two_before;
    two_before = previous;
    renew = is_slow || fraction < 1;
    if (renew && renewed > most_tangents) {
      failure_ = "Newton's method does not converge";
      return false;
    }
    if (renew) two_before = std::numeric_limits<double>::infinity();
    previous = step;
    if (!renew) mix(layer_->displacements() - before, mixing, history);
  }
  failure_ = "too many iterations";
  return false;
}

/// Contact with friction on the tangent. Where pressed nodes that are released would be unstable,
/// none may be found; then the nodes are shifted towards where they are, as far as it takes.
FrictionalPressing::SurfaceStep FrictionalPressing::step_of_surface(
    const std::vector<Touch>& touching, const Eigen::VectorXd& rest, const Rub& rub) {
  if (tangent_->shift > 0) return settle_surface(touching, rest, rub);
  try {
    return settle_surface(touching, rest, rub);
  } catch (const ConvergenceError&) {
    tangent_->stabilise();
    return settle_surface(touching, rest, rub);
  }
}

/// Normal and tangential problem in turn.
FrictionalPressing::SurfaceStep FrictionalPressing::settle_surface(
    const std::vector<Touch>& touching, const Eigen::VectorXd& rest, const Rub& rub) const {
  constexpr int most_turns = 40;
  constexpr double settled = 3e-5;  // of pressure and friction, relative to the load
  Tangent& tangent = *tangent_;
  const Index count = force_.cols();
  const Eigen::VectorXd rest_t = rest(tangent.tangential), rest_n = rest(tangent.normal);
  Eigen::VectorXd gap(count), cosine(count), up(2 * count), friction(2 * count);
  for (Index i = 0; i < count; ++i) {
    const Touch& touch = touching[static_cast<std::size_t>(i)];
    gap[i] = touch.gap;
    cosine[i] = 1 / touch.secant;
    up.segment<2>(2 * i) = touch.frame.axes.row(2).head<2>().transpose();
    friction.segment<2>(2 * i) = force_.col(i).head<2>();
  }
  SurfaceResponse shifted;
  ReleasedFactor of_shifted;
  if (tangent.shift > 0) {
    shifted.stiffness = tangent.normal_response.stiffness;
    shifted.stiffness.diagonal() += tangent.shift * cosine.cwiseAbs2().cwiseInverse();
  }
  SurfaceResponse& response = tangent.shift > 0 ? shifted : tangent.normal_response;
  ReleasedFactor& released = tangent.shift > 0 ? of_shifted : tangent.released;
  Eigen::VectorXd normal_force = force_.row(2).transpose(), sunk, free;
  SurfaceStep result;
  const double largest = bound_.of(pressed_force_.row(2).transpose()).sum();
  FixedPoint settling;
  for (int turn = 0; turn < most_turns && !result.is_settled; ++turn) {
    response.force = rest_n - tangent.lift * (friction + rest_t);
    const TangentContact contact =
        drive_.approach > 0
            ? solve_tangent_contact(response, cosine, gap, 0, drive_.approach, normal_force,
                                    &released)
            : solve_tangent_contact(response, cosine, gap, drive_.load + up.dot(friction), 0,
                                    normal_force, &released);
    normal_force = contact.force;
    sunk = contact.displacement;
    result.approach = contact.approach;
    free = tangent.compliance * (rest_t - tangent.by_normal * sunk);
    Eigen::VectorXd rubbed = friction;
    rub({touching, normal_force, stuck_target(touching, result.approach) - free,
         free + tangent.compliance * friction},
        rubbed);
    const double change = (rubbed - friction).cwiseAbs().sum() / largest;
    result.is_settled = change <= settled;
    if (!result.is_settled) friction = settling.next(friction, rubbed);
  }
  const Eigen::VectorXd along = free + tangent.compliance * friction;
  const Eigen::VectorXd of_layer =
      normal_force - tangent.shift * sunk.cwiseQuotient(cosine.cwiseAbs2());
  result.force.resize(3, count);
  result.displacement.resize(3 * count);
  result.force_of_layer.resize(3 * count);
  for (Index i = 0; i < count; ++i) {
    result.force.col(i) << friction.segment<2>(2 * i), normal_force[i];
    result.force_of_layer.segment<3>(3 * i) << friction.segment<2>(2 * i), of_layer[i];
    result.displacement.segment<3>(3 * i) << along.segment<2>(2 * i), sunk[i];
  }
  return result;
}

/// Goes on from a combination of the latest iterates: the tangent that is kept alone would converge
/// linearly.
void FrictionalPressing::mix(const Eigen::VectorXd& step, FixedPoint& mixing,
                             std::vector<State>& history) {
  history.insert(history.begin(), {layer_->state(), force_, approach_});
  const Eigen::VectorXd weights = mixing.weights(step);
  history.resize(static_cast<std::size_t>(weights.size()));
  combine(history, weights);
}

FrictionalPressing::State FrictionalPressing::present() const {
  return {layer_->state(), force_, approach_};
}

FrictionalPressing::Rub FrictionalPressing::rub_by_coulomb() {
  return [this](const Rubbed& at, Eigen::VectorXd& friction) {
    solve_friction(tangent_->compliance, bound_.of(at.normal_force), at.target, friction,
                   &tangent_->stick_slip);
  };
}

void FrictionalPressing::press_to(const Drive& drive) {
  const Rub rub = rub_by_coulomb();
  slide_.reset();
  // An approach comes first where the contact was pressed to a load.
  if (drive.approach > 0 && drive_.approach == 0) drive_ = {0, approach_};
  const Drive start = drive_;
  const Drive end{drive.load / layer_->planes().images(), drive.approach};
  // The load steps before point to this one, along a parabola where there are two.
  pressed_to_.insert(pressed_to_.begin(), {kept_state_, kept_force_, kept_approach_});
  if (pressed_to_.size() > 3) pressed_to_.pop_back();
  if (pressed_to_.size() == 3) start_from(pressed_to_, Eigen::Vector3d(3, -3, 1));
  if (pressed_to_.size() == 2) start_from(pressed_to_, Eigen::Vector2d(2, -1));
  double length = 1;
  const double reached = advance(length, 1.0 / 8, 1, [&](double share, bool) {
    drive_ = {start.load + share * (end.load - start.load),
              start.approach + share * (end.approach - start.approach)};
    return try_motion(motion_, rub, of_pressing);
  });
  if (reached < 1)
    throw ConvergenceError("pressing with friction at finite strain", iterations_, reached,
                           failure_);
}

Eigen::Matrix3Xd FrictionalPressing::places() const {
  return carried(kept_position_, kept_motion_, {}, -kept_approach_);
}

void FrictionalPressing::settle_at(const Eigen::Matrix3Xd& places, const Drive& drive) {
  const Rub rub = rub_by_coulomb();
  slide_.reset();
  drive_ = {drive.load / layer_->planes().images(), drive.approach};
  const Eigen::Matrix3Xd start = this->places();
  double length = 1;
  const double reached = advance(length, 1.0 / 8, 1, [&](double share, bool) {
    kept_position_ = carried(start + share * (places - start), {}, kept_motion_, kept_approach_);
    return try_motion(motion_, rub, of_pressing);
  });
  if (reached < 1)
    throw ConvergenceError("pressed contact with friction at finite strain", iterations_, reached,
                           failure_);
}

void FrictionalPressing::move_to(const PlaneMotion& motion) {
  const Rub rub = rub_by_coulomb();
  // The slip law holds at an increment's end: a node that begins to slip within a longer turn would
  // be taken to stick.
  constexpr double longest_turn_rad = 0.5;
  slide_.reset();
  const PlaneMotion start = motion_;
  const double parts =
      std::max(1.0, std::ceil(std::abs(motion.turn_rad - start.turn_rad) / longest_turn_rad));
  for (double part = 0; part < parts; ++part) {
    double length = 1;
    const double reached = advance(length, 1.0 / 8, 1, [&](double share, bool) {
      return try_motion(between(start, motion, (part + share) / parts), rub, of_increments);
    });
    if (reached < 1)
      throw ConvergenceError("friction at finite strain", iterations_, (part + reached) / parts,
                             failure_);
  }
}

/// Goes from 0 to 1 in steps, in shorter ones where they do not converge.
/// @param length  of the first step, becomes that of a next one
/// @param enough  where a step does not converge beyond this and there are two already, it ends
/// @param try_share  tries a step; `again` where it is the same step once more, without a tangent
/// @returns how far it came
double FrictionalPressing::advance(double& length, double shortest, double enough,
                                   const std::function<bool(double, bool again)>& try_share,
                                   const std::function<void(double)>& on_share) {
  double done = 0, before = 0;
  std::optional<State> earlier;  // converged at `before`
  bool again = false;
  while (done < 1 && length >= shortest) {
    const double next = std::min(1.0, done + length);
    const int iterations = iterations_;
    const bool has_tangent = tangent_ != nullptr;
    bool converged = false;
    try {
      if (earlier) extrapolate(*earlier, (next - done) / (done - before));
      converged = try_share(next, again);
    } catch (const EdgeLeftMargin&) {
      throw;
    } catch (const ConvergenceError& error) {
      failure_ = error.what();
    }
    if (converged) {
      // A tangent that took many iterations is renewed where a state is in equilibrium: it is
      // surely stable there, and the renewed one serves longer than one that is made on the way.
      constexpr int many_iterations = 7;
      if (iterations_ - iterations >= many_iterations) tangent_.reset();
      again = false;
      earlier = {kept_state_, kept_force_, kept_approach_};
      keep();
      before = done;
      done = next;
      on_share(done);
      // One hard stretch need not make all that follow it short.
      constexpr double growth = 1.5;
      length = std::min(1.0, growth * length);
      continue;
    }
    take_back();
    tangent_.reset();
    earlier.reset();
    // A tangent of the last state may do what one from further away did not.
    again = has_tangent && !again;
    length = again ? next - done : (next - done) / 2;
    if (again) continue;
    if (done >= enough && before > 0) break;
  }
  return done;
}

/// Starts from where the last two converged states point to: in steps of friction that is far
/// nearer than the last one.
void FrictionalPressing::extrapolate(const State& earlier, double share) {
  start_from({{kept_state_, kept_force_, kept_approach_}, earlier},
             Eigen::Vector2d(1 + share, -share));
}

FrictionalPressing::Rub FrictionalPressing::rub_of(const Slide& slide) const {
  return [this, &slide](const Rubbed& rubbed, Eigen::VectorXd& friction) {
    const PlaneMotion& velocity = slide.velocity;
    for (Index i = 0; i < rubbed.normal_force.size(); ++i) {
      const auto node = static_cast<std::size_t>(i);
      const auto tangents = rubbed.touching[node].frame.axes.leftCols<2>();
      const Eigen::Vector3d place =
          layer_->position(node) + tangents * rubbed.moved.segment<2>(2 * i);
      const Eigen::Vector3d speed =
          Eigen::Vector3d(velocity.x, velocity.y, 0) + velocity.turn_rad * turned(place);
      const Eigen::Vector2d along = tangents.transpose() * speed;
      // Around the centre of rotation forces point in all directions. A node has their mean over
      // its surroundings.
      friction.segment<2>(2 * i) = slide.share * bound_.at(i, rubbed.normal_force[i]) /
                                   std::hypot(along.norm(), 0.25 * velocity.turn_rad * spacing_) *
                                   along;
    }
  };
}

/// Relative force and torque of an ellipsoidal limit surface whose semi-axes are those of a shift
/// and of a turn, times the share of friction.
Eigen::Vector3d FrictionalPressing::place_of(const Slide& slide) const {
  const PlaneMotion& velocity = slide.velocity;
  return slide.share *
         Eigen::Vector3d(velocity.x, velocity.y, arm_ * velocity.turn_rad).normalized();
}

/// Starts from what the solved slides and the contact without friction, which is at the origin of
/// their places, let expect at the place of this one: the best linear combination of states whose
/// correlation falls with their distance (kriging with an unknown mean).
void FrictionalPressing::start_near(const Slide& slide) {
  constexpr double range = 1;
  constexpr double nugget = 1e-3;  // slides are known to Newton's tolerance
  const auto count = static_cast<Index>(slid_.size());
  Eigen::Matrix3Xd places(3, count);
  for (Index i = 0; i < count; ++i) places.col(i) = slid_[static_cast<std::size_t>(i)].place;
  const auto correlations = [&](const Eigen::Vector3d& place) -> Eigen::VectorXd {
    return ((places.colwise() - place).colwise().squaredNorm() / (-2 * range * range))
        .array()
        .exp()
        .transpose();
  };
  // The last row and column: weights sum to 1.
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(count + 1, count + 1);
  Eigen::VectorXd right = Eigen::VectorXd::Ones(count + 1);
  for (Index i = 0; i < count; ++i) matrix.col(i).head(count) = correlations(places.col(i));
  matrix.diagonal().array() += nugget;
  matrix(count, count) = 0;
  right.head(count) = correlations(place_of(slide));
  const Eigen::VectorXd weights = matrix.partialPivLu().solve(right).head(count);
  std::vector<State> states;
  for (const Slid& slid : slid_) states.push_back(slid.state);
  if (start_from(states, weights)) tangent_.reset();
}

/// Goes to a combination of states. @returns false where it turns an element over; then nothing
/// changes
bool FrictionalPressing::combine(const std::vector<State>& states, const Eigen::VectorXd& weights) {
  const auto before = layer_->state();
  std::vector<std::shared_ptr<const FiniteLayer::State>> of_layer;
  Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, force_.cols());
  double approach = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double weight = weights[static_cast<Index>(i)];
    of_layer.push_back(states[i].layer);
    force += weight * states[i].force;
    approach += weight * states[i].approach;
  }
  layer_->restore(of_layer, weights);
  if (!(layer_->smallest_volume_ratio() > 0)) {
    layer_->restore(*before);
    return false;
  }
  force_ = force;
  approach_ = approach;
  return true;
}

/// Starts from a combination of states, in which no force pulls. @returns as `combine`
bool FrictionalPressing::start_from(const std::vector<State>& states,
                                    const Eigen::VectorXd& weights) {
  if (!combine(states, weights)) return false;
  for (auto of_node : force_.colwise())
    if (!(of_node.z() > 0)) of_node.setZero();
  return true;
}

/// Goes from the present slide to another one. @returns false where the way does not converge
bool FrictionalPressing::go_on_to(const Slide& next) {
  constexpr double shortest = 1.0 / 2;
  const Slide from = *slide_;
  Slide present;
  const Rub rub = rub_of(present);
  double length = 1;
  const auto at = [&](double part) -> Slide {
    return {between(from.velocity, next.velocity, part),
            from.share + part * (next.share - from.share)};
  };
  const double reached = advance(
      length, shortest, 1,
      [&](double part, bool again) {
        present = at(part);
        if (!again) start_near(present);
        return try_motion({}, rub, of_slides);
      },
      [&](double) { remember(present); });
  if (reached > 0) slide_ = at(reached);
  return reached == 1;
}

bool FrictionalPressing::try_guess(const PlaneMotion& velocity, const State& guess) {
  const Slide present{velocity, 1};
  try {
    if (start_from({guess}, Eigen::VectorXd::Ones(1)) &&
        try_motion({}, rub_of(present), of_slides)) {
      keep();
      slide_ = present;
      remember(present);
      return true;
    }
  } catch (const EdgeLeftMargin&) {
    throw;
  } catch (const ConvergenceError&) {
    // From no friction it may go.
  }
  take_back();
  tangent_.reset();
  return false;
}

double FrictionalPressing::slide(const PlaneMotion& velocity, double aim,
                                 const std::function<void(double)>& on_share, const State* guess) {
  if (slide_) {
    for (double share = aim; share >= telling_share; share *= 0.75) {
      std::vector<double> shares = {share};
      if (share < 1) shares.insert(shares.begin(), share / 2);
      const bool converges = std::all_of(shares.begin(), shares.end(), [&](double part) {
        if (!go_on_to({velocity, part})) return false;
        on_share(part);
        return true;
      });
      if (converges) return share;
    }
  }
  restart();
  tangent_.reset();
  if (guess && aim == 1 && try_guess(velocity, *guess)) {
    on_share(1);
    return 1;
  }
  constexpr double shortest_ramp = 1.0 / 32;
  Slide present{velocity, 0};
  const Rub rub = rub_of(present);
  // Less than all is asked for where all of it was too much at once.
  ramp_ = aim < 1 ? 0.5 : std::clamp(2 * ramp_, 4 * shortest_ramp, 1.0);
  const double reached = aim * advance(
                                   ramp_, shortest_ramp, telling_share / aim,
                                   [&](double part, bool) {
                                     present.share = aim * part;
                                     return try_motion({}, rub, of_slides);
                                   },
                                   [&](double part) {
                                     remember(present);
                                     on_share(aim * part);
                                   });
  if (reached > 0) slide_ = {velocity, reached};
  return reached;
}

FrictionWrench FrictionalPressing::wrench() const {
  FrictionWrench result;
  const std::vector<Touch> touching = touches();
  for (Index i = 0; i < force_.cols(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    const Eigen::Vector3d force = touching[node].frame.axes.leftCols<2>() * force_.col(i).head<2>();
    result.force_x += force.x();
    result.force_y += force.y();
    result.torque += turned(layer_->position(node)).dot(force);
  }
  return result;
}

bool FrictionalPressing::slips(Index node) const {
  constexpr double nearly = 1 - 1e-4;  // forces are known to Newton's tolerance
  return force_.col(node).head<2>().norm() >= nearly * bound_.at(node, force_(2, node));
}

double FrictionalPressing::slip_fraction() const {
  const Eigen::VectorXd area = nodal_area(*layer_);
  double slipping = 0, touching = 0;
  for (Index i = 0; i < force_.cols(); ++i) {
    // The centre of a twist does not move, and carries nothing.
    if (bound_.at(i, force_(2, i)) <= 0 ||
        layer_->position(static_cast<std::size_t>(i)).head<2>().norm() < 1e-9)
      continue;
    touching += area[i];
    if (slips(i)) slipping += area[i];
  }
  return touching > 0 ? slipping / touching : 0;
}

double FrictionalPressing::projected_area() const {
  const Eigen::VectorXd area = nodal_area(*layer_);
  const std::vector<Touch> touching = touches();
  double result = 0;
  for (Index i = 0; i < force_.cols(); ++i)
    if (force_(2, i) > 0) result += area[i] / touching[static_cast<std::size_t>(i)].secant;
  return result;
}

double FrictionalPressing::peak_pressure() const {
  return force_.row(2).transpose().cwiseQuotient(nodal_area(*layer_)).maxCoeff();
}

namespace {

/// The four quarters of each face all of whose nodes can be touched.
std::vector<std::array<std::size_t, 4>> quarters_of(const std::vector<SurfaceFace>& faces) {
  std::vector<std::array<std::size_t, 4>> result;
  for (const SurfaceFace& face : faces)
    for (const std::size_t first : {0, 1, 3, 4}) {
      const std::array<std::size_t, 4> corners = {first, first + 1, first + 4, first + 3};
      std::array<std::size_t, 4> quarter;
      bool is_whole = true;
      for (std::size_t k = 0; k < 4; ++k) {
        const int node = face.node[corners[k]];
        is_whole = is_whole && node >= 0;
        quarter[k] = static_cast<std::size_t>(std::max(node, 0));
      }
      if (is_whole) result.push_back(quarter);
    }
  return result;
}

}  // namespace

RubbedSurface FrictionalPressing::surface() const {
  const Eigen::VectorXd area = nodal_area(*layer_);
  const std::vector<Touch> touching = touches();
  const Eigen::Matrix3Xd taken =
      carried(pressed_position_, {}, motion_, approach_ - pressed_approach_);
  RubbedSurface result;
  for (Index i = 0; i < force_.cols(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    RubbedSurface::Point& point = result.points.emplace_back();
    point.position = layer_->position(node);
    if (!(force_(2, i) > 0)) continue;
    const auto tangents = touching[node].frame.axes.leftCols<2>();
    point.pressure = force_(2, i) / area[i];
    point.shear = tangents * force_.col(i).head<2>() / area[i];
    point.slip = tangents * (tangents.transpose() * (taken.col(i) - point.position));
    point.state = slips(i) ? RubbedSurface::slips : RubbedSurface::sticks;
  }
  result.quadrilaterals = quarters_of(layer_->faces());
  return result;
}

ShearedContact FrictionalPressing::sheared() const {
  return {projected_area() / pressed_area_, peak_pressure() / pressed_peak_,
          approach_ / pressed_approach_};
}

}  // namespace softfinger::fem::finite
