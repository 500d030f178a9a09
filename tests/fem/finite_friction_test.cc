// Friction on contacts pressed at finite strain: against linear elasticity for small loads, against
// pressings of their own, and against what has to hold for any.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "fem/contact/pressing.h"
#include "fem/finite/correct_friction.h"
#include "fem/finite/deformed_contact.h"
#include "fem/finite/frictional_pressing.h"
#include "fem/finite/full_slip.h"
#include "fem/finite/rubbed_pressing.h"
#include "fem/finite/solved_slides.h"
#include "fem/finite/superposed_friction.h"
#include "fem/friction/friction_study.h"
#include "fem/levels/error_model.h"
#include "fem/program/reference_solver.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"

namespace softfinger::fem {
namespace {

using Eigen::Index;
using finite::FinitePressing;
using finite::SuperposedMotion;

constexpr double kFriction = 0.5;

/// A mesh with cells of a quarter of the contact.
LayerDiscretisation mesh_for(double a, double b) {
  LayerDiscretisation mesh;
  mesh.a = a;
  mesh.b = b;
  mesh.elements_per_semi_axis = 4;
  mesh.patch = 1.6;
  return mesh;
}

FinitePressing layer_under(std::shared_ptr<const RigidObject> object,
                           const LayerDiscretisation& mesh, double poisson_ratio,
                           MirrorPlanes planes = both_planes, const MaterialChoice& choice = {}) {
  return {std::make_shared<finite::FiniteLayer>(mesh, nullptr, planes,
                                                finite::make_material(choice, 1.0, poisson_ratio)),
          std::move(object)};
}

/// Angles from mostly stuck to full slip, in units of the one at which the stuck contact would
/// carry the torque of full slip.
std::vector<double> angles(const FinitePressing& pressing, const SuperposedMotion& twist) {
  const double unit = finite::slide(pressing, kFriction, {0, 0, 1}).torque / twist.stiffness();
  std::vector<double> result;
  for (double share = 0.02; share < 20; share *= 1.4) result.push_back(share * unit);
  return result;
}

/// A quadric turned about the normal.
class TurnedQuadric : public RigidObject {
 public:
  TurnedQuadric(double major, double minor, double angle_rad) {
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle_rad).toRotationMatrix();
    curvature_ = turn * Eigen::Vector2d(1 / major, 1 / minor).asDiagonal() * turn.transpose();
  }
  std::optional<ObjectHeight> over(double x, double y) const override {
    const Eigen::Vector2d at(x, y), slope = curvature_ * at;
    return ObjectHeight{0.5 * slope.dot(at), slope, curvature_};
  }

 private:
  Eigen::Matrix2d curvature_;
};

TEST(SuperposedMotion, FollowsPressingsUnderTheTurnedObject) {
  // The layer's tangent for motions odd in x and y, with what the pressed state's stresses and the
  // turning contact forces add, against central differences of whole pressings without friction,
  // which know no linearisation: error (angle)², and Newton's own over the angle.
  constexpr double angle = 1e-3;
  LayerDiscretisation mesh = mesh_for(1.3, 0.8);
  mesh.elements_per_semi_axis = 3;
  mesh.extent = 2;
  std::vector<Eigen::Vector3d> turned[2];
  for (const int side : {0, 1}) {
    auto pressing = layer_under(std::make_shared<TurnedQuadric>(8, 3, side == 0 ? -angle : angle),
                                mesh, 0.45, no_plane);
    pressing.press({0, 0.15});
    for (std::size_t i = 0; i < pressing.layer().nodes().size(); ++i)
      turned[side].push_back(pressing.layer().position(i));
  }
  auto pressing = layer_under(std::make_shared<TurnedQuadric>(8, 3, 0), mesh, 0.45, no_plane);
  pressing.press({0, 0.15});
  const finite::TouchingNodes nodes = pressing.touching_nodes();
  const SuperposedMotion twist(pressing, kFriction);
  Eigen::VectorXd expected(2 * nodes.size());
  for (Index i = 0; i < nodes.size(); ++i) {
    const auto node = static_cast<std::size_t>(nodes.node[static_cast<std::size_t>(i)]);
    expected.segment<2>(2 * i) = nodes.axes[static_cast<std::size_t>(i)].leftCols<2>().transpose() *
                                 (turned[1][node] - turned[0][node]) / (2 * angle);
  }
  const double largest = expected.cwiseAbs().maxCoeff();
  EXPECT_GT(largest, 0.02);  // it is worth comparing
  EXPECT_LT((twist.frictionless() - expected).cwiseAbs().maxCoeff(), 1e-4 * largest);
}

TEST(SuperposedMotion, IsTheSameByAQuarterAndAsAWhole) {
  double stiffness[2];
  std::vector<double> torque[2], moved;
  for (const bool whole : {false, true}) {
    LayerDiscretisation mesh = mesh_for(1.1, 0.8);
    mesh.elements_per_semi_axis = 3;
    auto pressing = layer_under(quadric(8, 4), mesh, 0.49, whole ? no_plane : both_planes);
    pressing.press({0, 0.12});
    SuperposedMotion twist(pressing, kFriction);
    stiffness[whole] = twist.stiffness();
    for (const double angle : {0.01, 0.05, 0.2, 1.0}) {
      twist.turn_to(angle);
      torque[whole].push_back(twist.torque());
      if (whole) moved.push_back(twist.pressure_change());
    }
  }
  // Two presses that Newton's method ends at 1e-9, through a factor of condition about 1e5 whose
  // springs cost two digits; `solve_friction` stops at 1e-9.
  EXPECT_NEAR(stiffness[1] / stiffness[0], 1, 1e-6);
  // The quarter leaves out what the odd change of the pressure does: nothing where friction goes
  // with it linearly, but nodes begin to slip or let go. Less than what the limits change by.
  for (std::size_t i = 0; i < torque[0].size(); ++i)
    EXPECT_NEAR(torque[1][i] / torque[0][i], 1, moved[i]);
}

TEST(SuperposedMotion, LosesAndStoresWhatTheObjectDoes) {
  // Under an object of revolution friction's moment is all of the torque. Between two increments it
  // is nearly a straight line; the law holds at the end of each, which dissipates more by what the
  // slipping forces turn, to second order in the step.
  auto pressing = layer_under(sphere(5), mesh_for(1.6, 1.6), 0.49);
  pressing.press({0, 0.3});
  SuperposedMotion twist(pressing, kFriction);
  const double end = 2 * angles(pressing, twist).back() / 20;
  double work = 0, torque = 0, dissipated = 0;
  constexpr int steps = 200;
  for (int i = 1; i <= steps; ++i) {
    twist.turn_to(end * i / steps);
    work += 0.5 * (torque + twist.torque()) * end / steps;
    torque = twist.torque();
    // While nothing slips, `solve_friction` leaves an error of 1e-9 of the motion.
    EXPECT_GE(twist.dissipated_energy(), dissipated - 1e-9 * work);
    dissipated = twist.dissipated_energy();
  }
  EXPECT_NEAR((twist.stored_energy() + twist.dissipated_energy()) / work, 1, 1e-3);
  EXPECT_GT(twist.stored_energy(), 0.1 * work);
  EXPECT_GT(twist.dissipated_energy(), 0.1 * work);
}

TEST(SuperposedMotion, GoesFromStickToTheTorqueOfItsPressure) {
  for (const double nu : {0.3, 0.49}) {
    auto pressing = layer_under(sphere(5), mesh_for(1.5, 1.5), nu);
    pressing.press({0, 0.3});
    SuperposedMotion twist(pressing, kFriction);
    double torque = 0, slip = 0;
    for (const double angle : angles(pressing, twist)) {
      twist.turn_to(angle);
      EXPECT_GT(twist.torque(), torque);
      EXPECT_GE(twist.slip_fraction(), slip);
      // While nothing slips, `solve_friction` leaves an error of 1e-9 of the motion.
      EXPECT_LE(twist.torque() / (twist.stiffness() * angle), 1 + 1e-9);
      torque = twist.torque();
      slip = twist.slip_fraction();
    }
    EXPECT_EQ(slip, 1);
    // All forces along the circles: the arm that is measured on the deformed surface.
    const double full =
        kFriction * pressing.equilibrium().load * finite::measure(pressing, 1)->torque_arm;
    // The mesh is no body of revolution: of the surface's motion some hundredths go sideways, and
    // of the slip a twentieth of that at the last angles; its square is missing.
    EXPECT_NEAR(torque / full, 1, 1e-6);
    EXPECT_NEAR(finite::slide(pressing, kFriction, {0, 0, 1}).torque / full, 1, 1e-12);
  }
}

/// A contact of the same size at any small approach, pressed by both kinematics on one mesh.
struct SmallContact {
  SmallContact(double approach, double poisson_ratio) {
    const LayerDiscretisation mesh = mesh_for(1.0, 0.7);
    Pressing linear;
    linear.major = 0.8 / approach;
    linear.minor = 0.4 / approach;
    linear.sphere = std::numeric_limits<double>::infinity();
    linear.approach = approach;
    linear.poisson_ratio = poisson_ratio;
    pressed = *press_on(*make_layer(mesh, linear), linear);
    // About the undeformed state this energy has the very element of linear elasticity; of the
    // other one the volumetric strain that the pressures do not resolve is softer.
    MaterialChoice choice;
    choice.volumetric = VolumetricLaw::logarithmic;
    pressing = std::make_unique<FinitePressing>(
        layer_under(quadric(linear.major, linear.minor), mesh, poisson_ratio, both_planes, choice));
    pressing->press({0, approach});
    quarters =
        std::make_unique<QuarterCompliances>(friction_compliances(contact(), Invariance::none));
  }

  /// Stuck tractions are singular at the edge: a node more or less there counts, so those of finite
  /// strain.
  PressedContact contact() const {
    return {*pressed.model,   pressed.gap,    pressing->equilibrium().force, pressed.moment_a,
            pressed.moment_b, pressed.load(), ShearLaw::coulomb(kFriction)};
  }

  Pressed pressed;
  std::unique_ptr<FinitePressing> pressing;
  std::unique_ptr<QuarterCompliances> quarters;
};

/// Strains and slopes are of the order of the approach, here 1e-3.
constexpr double kSmallLoad = 2e-3;

struct AgainstLinear {
  double stiffness, worst_torque;  ///< a ratio; a difference over the torque at full slip
};

AgainstLinear twisted(double approach, double poisson_ratio) {
  const SmallContact small(approach, poisson_ratio);
  SuperposedMotion twist(*small.pressing, kFriction);
  AgainstLinear result{
      twist.stiffness() / stuck_torsional_stiffness(small.contact(), *small.quarters), 0};
  const SurfaceCompliance surface = surface_compliance(*small.quarters, Invariance::half_turn);
  std::vector<PlaneMotion> motions;
  for (const double angle : angles(*small.pressing, twist)) motions.push_back({0, 0, angle});
  const auto linear = move_through(small.contact(), surface, motions, [](auto&&...) {});
  const double full = linear.back().wrench.torque;
  for (const FrictionState& expected : linear) {
    twist.turn_to(expected.motion.turn_rad);
    result.worst_torque =
        std::max(result.worst_torque, std::abs(twist.torque() - expected.wrench.torque) / full);
  }
  return result;
}

TEST(SuperposedMotion, IsLinearElasticityForSmallLoads) {
  for (const double nu : {0.3, 0.49}) {
    const AgainstLinear at_2 = twisted(1e-3, nu), at_1 = twisted(5e-4, nu);
    EXPECT_NEAR(at_2.stiffness, 1, kSmallLoad);
    // It departs in proportion to the load: nothing else is left.
    EXPECT_NEAR((at_1.stiffness - 1) / (at_2.stiffness - 1), 0.5, 0.01);
    // The linear solver lets the twist move the pressure, which is of second order here too.
    EXPECT_LT(at_2.worst_torque, kSmallLoad);
    EXPECT_LT(at_1.worst_torque, at_2.worst_torque);
  }
}

/// Worst difference of points of the limit surface, over mu P and the largest torque.
double difference(const SmallContact& small, const std::vector<FrictionWrench>& found,
                  const std::vector<FrictionState>& expected) {
  const double force = kFriction * small.pressed.load(), arm = small.pressed.torque_arm();
  double worst = 0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    worst = std::max({worst, std::abs(found[i].force_x - expected[i].wrench.force_x) / force,
                      std::abs(found[i].force_y - expected[i].wrench.force_y) / force,
                      std::abs(found[i].torque - expected[i].wrench.torque) / (force * arm)});
  return worst;
}

TEST(Slide, IsTheSumOverTheLinearPressureForSmallLoads) {
  const SmallContact small(1e-3, 0.49);
  const std::vector<PlaneMotion> velocities = spread_velocities(12, small.pressed.torque_arm());
  std::vector<FrictionWrench> found;
  std::vector<FrictionState> expected;
  for (const PlaneMotion& velocity : velocities) {
    found.push_back(finite::slide(*small.pressing, kFriction, velocity));
    FrictionWrench sum;
    const auto& nodes = small.pressed.model->nodes();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (const double x : {-nodes[i].x, nodes[i].x})
        for (const double y : {-nodes[i].y, nodes[i].y}) {
          Eigen::Vector2d along(velocity.x - velocity.turn_rad * y,
                                velocity.y + velocity.turn_rad * x);
          along *= kFriction * small.pressed.contact.force[static_cast<Index>(i)] / along.norm();
          sum.force_x += along.x();
          sum.force_y += along.y();
          sum.torque += x * along.y() - y * along.x();
        }
    expected.push_back({velocity, sum, 1, 1});
  }
  EXPECT_LT(difference(small, found, expected), kSmallLoad);
}

TEST(SuperposedSlide, IsLinearElasticityForSmallLoads) {
  for (const double nu : {0.3, 0.49}) {
    const SmallContact small(1e-3, nu);
    const std::vector<PlaneMotion> velocities = spread_velocities(12, small.pressed.torque_arm());
    const auto expected = slide_through(
        small.contact(), surface_compliance(*small.quarters, Invariance::none), velocities);
    const finite::SuperposedSlide slides(*small.pressing, kFriction);
    std::vector<FrictionWrench> found, frictionless;
    for (const PlaneMotion& velocity : velocities) {
      found.push_back(slides.slide(velocity).wrench);
      frictionless.push_back(finite::slide(*small.pressing, kFriction, velocity));
    }
    // Friction moves the pressure by this much; it moves the edge too, to second order, where only
    // the linear solver follows.
    const double moved = difference(small, frictionless, expected);
    EXPECT_GT(moved, 0.02);
    EXPECT_LT(moved, 0.1);
    EXPECT_LT(difference(small, found, expected), kSmallLoad + moved * moved);
  }
}

TEST(SuperposedSlide, IsTheSameByAQuarterAndAsAWhole) {
  const std::vector<PlaneMotion> velocities = spread_velocities(6, 0.8);
  std::vector<FrictionWrench> found[2];
  double load = 0;
  for (const bool whole : {false, true}) {
    LayerDiscretisation mesh = mesh_for(1.1, 0.8);
    mesh.elements_per_semi_axis = 3;
    mesh.extent = 2;
    auto pressing = layer_under(quadric(8, 4), mesh, 0.49, whole ? no_plane : both_planes);
    pressing.press({0, 0.12});
    load = pressing.equilibrium().load;
    const finite::SuperposedSlide slides(pressing, kFriction);
    for (const PlaneMotion& velocity : velocities)
      found[whole].push_back(slides.slide(velocity).wrench);
  }
  // Both stop where pressure and friction change each other by 1e-6 of the load.
  const double tolerance = 1e-5 * kFriction * load;
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    EXPECT_NEAR(found[1][i].force_x, found[0][i].force_x, tolerance);
    EXPECT_NEAR(found[1][i].force_y, found[0][i].force_y, tolerance);
    EXPECT_NEAR(found[1][i].torque, found[0][i].torque, tolerance);
  }
}

/// A tapered finger under a turned object, both kinematics on one mesh of the whole layer; radii
/// go with the approach, so that the contact's size does not.
struct SmallContactWithoutSymmetry {
  explicit SmallContactWithoutSymmetry(double approach) {
    LayerDiscretisation mesh = mesh_for(1.2, 0.8);
    mesh.elements_per_semi_axis = 3;
    mesh.extent = 2;
    Pressing linear;
    linear.fingertip.pad = meshes::tapered_pad(1.2 / approach, 0.6 / approach, 0.3 * approach);
    linear.fingertip.object = meshes::quadric_object(3 / approach, 1 / approach, 0.5);
    linear.approach = approach;
    linear.poisson_ratio = 0.45;
    linear.bent = shape_fingertip(linear.fingertip, 1);
    pressed = *press_on(*make_layer(mesh, linear), linear);
    MaterialChoice choice;
    choice.volumetric = VolumetricLaw::logarithmic;
    pressing = std::make_unique<FinitePressing>(
        std::make_shared<finite::FiniteLayer>(mesh, linear.bent.shape, no_plane,
                                              finite::make_material(choice, 1.0, 0.45)),
        sampled(
            [object = linear.fingertip.object](double x, double y) { return object->height(x, y); },
            0.1));
    pressing->press({0, approach});
    surface = std::make_unique<SurfaceCompliance>(
        surface_compliance(friction_compliances(contact(), Invariance::none), Invariance::none));
  }

  PressedContact contact() const {
    PressedContact result{
        *pressed.model,   pressed.gap,    pressing->equilibrium().force, pressed.moment_a,
        pressed.moment_b, pressed.load(), ShearLaw::coulomb(kFriction)};
    result.edge = 1.3;
    return result;
  }

  Pressed pressed;
  std::unique_ptr<FinitePressing> pressing;
  std::unique_ptr<SurfaceCompliance> surface;
};

TEST(SuperposedMotion, OfAContactWithoutSymmetryIsLinearElasticityForSmallLoads) {
  const SmallContactWithoutSymmetry small(1e-3);
  SuperposedMotion twist(*small.pressing, kFriction);
  std::vector<PlaneMotion> motions;
  for (const double angle : angles(*small.pressing, twist)) motions.push_back({0, 0, angle});
  const auto expected = move_through(small.contact(), *small.surface, motions, [](auto&&...) {});
  const double full = expected.back().wrench.torque;
  // Friction changes the pressure. That moves the contact's edge to second order, which only the
  // linear solver takes into account.
  double moved = 0;
  for (const FrictionState& state : expected) {
    twist.turn_to(state.motion.turn_rad);
    moved = twist.pressure_change();
    EXPECT_NEAR(twist.torque() / full, state.wrench.torque / full, kSmallLoad + moved * moved);
  }
}

TEST(SuperposedSlide, OfAContactWithoutSymmetryIsLinearElasticityForSmallLoads) {
  const SmallContactWithoutSymmetry small(1e-3);
  const std::vector<PlaneMotion> velocities = spread_velocities(12, small.pressed.torque_arm());
  const auto expected = slide_through(small.contact(), *small.surface, velocities);
  const finite::SuperposedSlide slides(*small.pressing, kFriction);
  const double force = kFriction * small.pressed.load(), arm = small.pressed.torque_arm();
  double moved = 0, worst = 0;
  const auto differ = [&](const FrictionWrench& found, const FrictionWrench& other) {
    return std::max({std::abs(found.force_x - other.force_x) / force,
                     std::abs(found.force_y - other.force_y) / force,
                     std::abs(found.torque - other.torque) / (force * arm)});
  };
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    worst = std::max(worst, differ(slides.slide(velocities[i]).wrench, expected[i].wrench));
    moved = std::max(moved, differ(finite::slide(*small.pressing, kFriction, velocities[i]),
                                   expected[i].wrench));
  }
  EXPECT_GT(moved, 0.02);
  // The linear solver takes the direction of slip at the node. Here it is the mean over the node's
  // surroundings, 1 - s²/(32 r²) at the distance r from the centre of rotation, which over a disc
  // of the radius b = 6 s comes to s²/(16 b²) log(b/s).
  const double of_centre = std::log(6.0) / (16 * 36);
  EXPECT_LT(worst, kSmallLoad + moved * moved + of_centre);
}

TEST(Slide, DissipatesMostInItsOwnDirection) {
  // Among all friction forces within Coulomb's limits, those of a motion dissipate most in it. The
  // wrenches of full slip therefore lie on a convex surface whose normals are the velocities.
  auto pressing = layer_under(quadric(8, 4), mesh_for(1.6, 1.1), 0.49);
  pressing.press({0, 0.2});
  const std::vector<PlaneMotion> velocities = spread_velocities(30, 0.8);
  std::vector<FrictionWrench> wrenches;
  for (const PlaneMotion& velocity : velocities)
    wrenches.push_back(finite::slide(pressing, kFriction, velocity));
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    const auto power = [&](const FrictionWrench& wrench) {
      return velocities[i].x * wrench.force_x + velocities[i].y * wrench.force_y +
             velocities[i].turn_rad * wrench.torque;
    };
    for (const FrictionWrench& other : wrenches)
      EXPECT_LE(power(other), power(wrenches[i]) * (1 + 1e-12));
  }
  // A shift: more than mu P, because the normals lean; at most by the steepest one.
  const double force = finite::slide(pressing, kFriction, {1, 0, 0}).force_x;
  const double limit = kFriction * pressing.equilibrium().load;
  EXPECT_GT(force, limit);
  EXPECT_LT(force, limit / std::cos(pressing.equilibrium().steepest_rad));
}

constexpr double kThickness_m = 2e-3, kModulus_Pa = 3e5;

Problem problem_of(double major_m, double minor_m, double poisson_ratio, double approach) {
  Problem problem;
  problem.contact.radii = {major_m, minor_m, 0};
  problem.contact.layer = {kThickness_m, kModulus_Pa, poisson_ratio};
  problem.contact.load = {0, kFriction};
  problem.approach_m = approach * kThickness_m;
  problem.finite_strain = MaterialChoice();
  problem.friction.torsion = true;
  problem.friction.limit_surface = 24;
  return problem;
}

TEST(FiniteFriction, AnswersAsLinearElasticityForSmallLoads) {
  for (const double nu : {0.3, 0.49}) {
    Problem problem = problem_of(1.0, 0.5, nu, 1e-3);
    problem.level = 1;
    const auto silent = [](const std::string&) {};
    const Result finite_strain = solve(problem, silent);
    problem.finite_strain.reset();
    const Result linear = solve(problem, silent);
    ASSERT_TRUE(finite_strain.torsion && linear.torsion);
    const Torsion &one = *finite_strain.torsion, &other = *linear.torsion;
    // Meshes of their own: stated errors, and what the load changes.
    EXPECT_NEAR(one.stiffness_Nm_per_rad / other.stiffness_Nm_per_rad, 1,
                one.stiffness_error + other.stiffness_error + kSmallLoad);
    EXPECT_NEAR(one.full_slip_Nm / other.full_slip_Nm, 1,
                one.full_slip_error + other.full_slip_error + kSmallLoad);
    ASSERT_EQ(one.increments.size(), other.increments.size());
    ASSERT_EQ(finite_strain.limit_surface.size(), linear.limit_surface.size());
    const double force = kFriction * linear.finest.load_N, torque = linear.finest.max_torque_Nm;
    const double tolerance =
        finite_strain.limit_surface_error + linear.limit_surface_error + kSmallLoad;
    for (std::size_t i = 0; i < linear.limit_surface.size(); ++i) {
      const Wrench &found = finite_strain.limit_surface[i].wrench,
                   &expected = linear.limit_surface[i].wrench;
      EXPECT_NEAR(found.force_x_N, expected.force_x_N, tolerance * force);
      EXPECT_NEAR(found.force_y_N, expected.force_y_N, tolerance * force);
      EXPECT_NEAR(found.torque_Nm, expected.torque_Nm, tolerance * torque);
    }
  }
}

/// Torque over that of full slip, linear between the increments.
double share_of_torque(const Torsion& torsion, double angle_rad) {
  double from_rad = 0, from = 0;
  for (const FrictionIncrement& at : torsion.increments) {
    const double to = at.wrench.torque_Nm / torsion.full_slip_Nm;
    if (at.angle_rad >= angle_rad)
      return from + (to - from) * (angle_rad - from_rad) / (at.angle_rad - from_rad);
    from_rad = at.angle_rad;
    from = to;
  }
  return from;
}

// Friction has sheared the surface while it was pressed, and leaves less of it to a twist: by up to
// 4 % of the torque at full slip.
TEST(FiniteFriction, TwistsFromTheContactAsItWasPressedAsLinearElasticityForSmallLoads) {
  const auto silent = [](const std::string&) {};
  for (const bool by_approach : {false, true}) {
    Problem problem = problem_of(1.0, 1.0, 0.49, 2e-3);
    problem.friction.limit_surface = 0;
    if (!by_approach) {
      problem.approach_m = 0;
      problem.contact.load.normal_force_N = 0.3;
    }
    const auto twist = [&](PressingFriction pressing, bool finite_strain) {
      problem.pressing = pressing;
      problem.finite_strain.reset();
      if (finite_strain) problem.finite_strain = MaterialChoice();
      const Torsion torsion = solve(problem, silent).torsion.value();
      EXPECT_EQ(torsion.pressing, pressing);
      return torsion;
    };
    const Torsion finite_strain = twist(PressingFriction::coulomb, true),
                  without = twist(PressingFriction::none, true),
                  linear = twist(PressingFriction::coulomb, false),
                  linear_without = twist(PressingFriction::none, false);
    EXPECT_NEAR(finite_strain.full_slip_Nm / linear.full_slip_Nm, 1,
                finite_strain.full_slip_error + linear.full_slip_error + kSmallLoad);
    double largest = 0;
    for (const FrictionIncrement& at : linear.increments) {
      const double less =
          share_of_torque(linear_without, at.angle_rad) - share_of_torque(linear, at.angle_rad);
      largest = std::max(largest, less);
      // The part from friction comes from four elements on a semi-axis, which leave a quarter of it
      // open.
      EXPECT_NEAR(
          share_of_torque(without, at.angle_rad) - share_of_torque(finite_strain, at.angle_rad),
          less, 0.01);
    }
    EXPECT_GT(largest, 0.025);
  }
}

// The elements are a little compressible, which the stated error knows.
TEST(FiniteFriction, PressesAnIncompressibleLayer) {
  Problem problem = problem_of(20e-3, 20e-3, 0.5, 0.15);
  problem.level = 1;
  problem.friction = {};
  problem.pressing = PressingFriction::coulomb;
  const auto silent = [](const std::string&) {};
  const Result deep = solve(problem, silent);
  EXPECT_GT(deep.finest.stick_share, 0.5);
  problem.contact.layer.poisson_ratio = 0.4999;
  const Result nearly = solve(problem, silent);
  EXPECT_NEAR(deep.finest.load_N / nearly.finest.load_N, 1, 1e-9) << "the same elements";
  EXPECT_GT(deep.error.load, nearly.error.load);
  problem.contact.layer.poisson_ratio = 0.5;
  problem.pressing = PressingFriction::none;
  problem.friction.torsion = true;
  problem.approach_m /= 3;
  EXPECT_LT(solve(problem, silent).torsion.value().full_slip_error, 0.02);
  problem = problem_of(1.0, 1.0, 0.5, 2e-3);
  problem.level = 1;
  problem.friction = {};
  problem.pressing = PressingFriction::coulomb;
  const Result shallow = solve(problem, silent);
  problem.finite_strain.reset();
  const Result linear = solve(problem, silent);
  EXPECT_NEAR(shallow.finest.load_N / linear.finest.load_N, 1,
              shallow.error.load + linear.error.load + kSmallLoad);
  EXPECT_NEAR(shallow.finest.a_m / linear.finest.a_m, 1,
              shallow.error.a + linear.error.a + kSmallLoad);
}

TEST(FiniteFriction, FollowsAnyMotionAsLinearElasticityForSmallLoads) {
  Problem problem = problem_of(0.05, 0.03, 0.45, 1e-3);
  problem.level = 1;
  problem.friction.increments = 6;
  problem.friction.limit_surface = 3;
  problem.friction.increments_to_slip = 4;
  problem.friction.twist_axis_x_m = 1e-4;
  const auto silent = [](const std::string&) {};
  const Result finite_strain = solve(problem, silent);
  problem.finite_strain.reset();
  const Result linear = solve(problem, silent);
  ASSERT_TRUE(finite_strain.torsion && linear.torsion);
  const double force = kFriction * linear.finest.load_N, torque = linear.finest.max_torque_Nm;
  const auto expect_near = [&](const FrictionIncrement& one, const FrictionIncrement& other,
                               double error) {
    EXPECT_NEAR(one.wrench.force_x_N, other.wrench.force_x_N, error * force);
    EXPECT_NEAR(one.wrench.force_y_N, other.wrench.force_y_N, error * force);
    EXPECT_NEAR(one.wrench.torque_Nm, other.wrench.torque_Nm, error * torque);
  };
  const double of_twist =
      finite_strain.torsion->curve_error + linear.torsion->curve_error + kSmallLoad;
  for (std::size_t i = 0; i < linear.torsion->increments.size(); ++i)
    expect_near(finite_strain.torsion->increments[i], linear.torsion->increments[i], of_twist);
  EXPECT_GT(std::abs(linear.torsion->increments.back().wrench.force_y_N), 0.05 * force);
  const double of_paths =
      finite_strain.limit_surface_error + linear.limit_surface_error + kSmallLoad;
  ASSERT_EQ(finite_strain.limit_surface.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(finite_strain.limit_surface[i].path.size(), 4u);
    for (std::size_t j = 0; j < 4; ++j)
      expect_near(finite_strain.limit_surface[i].path[j], linear.limit_surface[i].path[j],
                  of_paths);
  }
}

// A soft sphere loses area before it slides, and its torque with it: its surface strains by more
// than small motions know of.
TEST(FiniteFriction, OfADeeplyPressedSphereIsSolvedFor) {
  Problem problem = problem_of(0.01, 0.01, 0.49, 0.3);
  problem.sphere_radius_m = 0.01;
  problem.friction.increments = 8;
  problem.friction.limit_surface = 0;
  const Result result = solve(problem, [](const std::string&) {});
  ASSERT_TRUE(result.torsion);
  EXPECT_LT(result.torsion->full_slip_Nm, 0.97 * result.finest.max_torque_Nm);
  EXPECT_GT(result.torsion->increments.back().slip_fraction, 0.98);
  ASSERT_TRUE(result.torsion->increments.back().sheared);
  const ShearedContact& sheared = *result.torsion->increments.back().sheared;
  EXPECT_LT(sheared.area_ratio, 0.98);
  EXPECT_GT(sheared.peak_pressure_ratio, 1);
  EXPECT_LT(result.torsion->curve_error, 0.03);
}

/// Pressed by a sphere, all of the layer.
class SolvedFriction : public testing::Test {
 protected:
  SolvedFriction() : pressing(layer_under(sphere(5), mesh_for(1.2, 1.2), 0.45, no_plane)) {
    pressing.press({0, 0.25});
  }
  FinitePressing pressing;
};

TEST_F(SolvedFriction, OfASmallTwistIsSuperposed) {
  SuperposedMotion superposed(pressing, kFriction);
  const double unit = finite::slide(pressing, kFriction, {0, 0, 1}).torque / superposed.stiffness();
  finite::FrictionalPressing solved(pressing, kFriction);
  for (const double share : {0.02, 0.05, 0.1}) {
    const PlaneMotion motion{0.02 * share * unit, 0, share * unit};
    superposed.move_to(motion);
    solved.move_to(motion);
    const FrictionWrench one = solved.wrench(), other = superposed.wrench();
    // Superposition neglects terms of second order in the strain, at which friction stores energy.
    const double second_order = 2 * superposed.stored_energy() / pressing.equilibrium().load;
    const double newton = 1e-3;  // of its steps, relative to the approach
    EXPECT_NEAR(one.torque / other.torque, 1, second_order + newton);
    EXPECT_NEAR(one.force_x / other.force_x, 1, second_order + newton);
  }
}

// With friction that holds everything, the work of the object is the layer's strain energy.
TEST_F(SolvedFriction, WorkOfAStuckObjectIsStrainEnergy) {
  finite::FrictionalPressing solved(pressing, /*friction_coefficient=*/100);
  const double load = pressing.equilibrium().load, sunk = pressing.equilibrium().approach;
  const double energy = pressing.layer().strain_energy();
  double work = 0, before = 0, step = 0.01;
  for (double angle = step; angle < 0.0801; angle += step) {
    solved.move_to({0, 0, angle});
    const double torque = solved.wrench().torque;
    work += 0.5 * (before + torque) * step;
    before = torque;
  }
  const double approached = sunk * (solved.sheared().approach_ratio - 1);
  EXPECT_LT(approached, 0)
      << "a layer that is sheared at constant thickness pushes the object away";
  // The trapezoidal rule is exact for a torque that is linear in the angle. Nodes at the edge that
  // open and touch again slip there.
  EXPECT_NEAR((pressing.layer().strain_energy() - energy) / (work + load * approached), 1, 0.01);
}

// The surface that is written carries the torque that is stated. What sticks has not moved against
// the object, and what slips carries mu p.
TEST_F(SolvedFriction, IsWrittenAsItIs) {
  finite::FrictionalPressing solved(pressing, kFriction);
  solved.move_to({0, 0, 0.3});
  const RubbedSurface surface = solved.surface();
  const double slip_fraction = solved.slip_fraction();
  ASSERT_GT(slip_fraction, 0.1);
  ASSERT_LT(slip_fraction, 0.9);
  double largest_slip = 0, torque = 0;
  for (const auto& corners : surface.quadrilaterals) {
    // Integrates by the midpoint of the corners: the lattice is fine against the field.
    const auto at = [&](std::size_t k) -> const RubbedSurface::Point& {
      return surface.points[corners[k]];
    };
    const Eigen::Vector3d diagonal = at(2).position - at(0).position,
                          other = at(3).position - at(1).position;
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector3d& place = at(k).position;
      torque += 0.125 * diagonal.cross(other).norm() *
                (place.x() * at(k).shear.y() - place.y() * at(k).shear.x());
    }
  }
  for (const RubbedSurface::Point& point : surface.points)
    largest_slip = std::max(largest_slip, point.slip.norm());
  int slipping = 0, sticking = 0;
  for (const RubbedSurface::Point& point : surface.points) {
    const double limit = kFriction * point.pressure;
    if (point.state == RubbedSurface::slips) {
      ++slipping;
      EXPECT_NEAR(point.shear.norm(), limit, 1e-3 * limit);
    } else if (point.state == RubbedSurface::sticks) {
      ++sticking;
      EXPECT_LE(point.shear.norm(), limit);
      EXPECT_LT(point.slip.norm(), 0.02 * largest_slip);  // Newton's tolerance
    } else {
      EXPECT_EQ(point.pressure, 0);
      EXPECT_EQ(point.shear.norm(), 0);
    }
  }
  EXPECT_GT(slipping, 0);
  EXPECT_GT(sticking, 0);
  // The areas of the nodes weigh corners, middles and centres of faces differently.
  EXPECT_NEAR(torque / solved.wrench().torque, 1, 0.1);
}

TEST_F(SolvedFriction, SlidesTheSameWayInAllDirections) {
  finite::FrictionalPressing solved(pressing, kFriction);
  EXPECT_EQ(solved.slide({1, 0, 0}), 1);
  const FrictionWrench along = solved.wrench();
  solved.slide({-1, 0, 0});
  const FrictionWrench back = solved.wrench();
  solved.slide({0, 1, 0});
  const FrictionWrench across = solved.wrench();
  const double force = kFriction * pressing.equilibrium().load;
  constexpr double newton = 1e-3;  // of its steps, relative to the approach
  EXPECT_NEAR(along.force_x, -back.force_x, newton * force);
  EXPECT_NEAR(along.force_x, across.force_y, newton * force);
  EXPECT_NEAR(along.force_y, 0, newton * force);
  // The normals lean: friction exceeds mu P by what N exceeds its component along the load.
  EXPECT_GT(along.force_x, force);
}

// Full friction is far from none: it is reached in steps, and how long they are changes nothing.
// Every slide begins with steps as long as the last one could take.
TEST_F(SolvedFriction, IsTheSameInStepsOfAnyLength) {
  constexpr double high = 0.7;
  const PlaneMotion velocity{1, 0, 0.5};
  finite::FrictionalPressing solved(pressing, high);
  ASSERT_EQ(solved.slide(velocity), 1);
  const FrictionWrench once = solved.wrench();
  const ShearedContact sheared = solved.sheared();
  ASSERT_EQ(solved.slide({0, 1, 0}), 1);
  ASSERT_EQ(solved.slide(velocity), 1);
  const FrictionWrench again = solved.wrench();
  constexpr double newton = 1e-3;  // of its steps, relative to the approach
  const double force = high * pressing.equilibrium().load;
  EXPECT_NEAR(again.force_x, once.force_x, newton * force);
  EXPECT_NEAR(again.force_y, once.force_y, newton * force);
  EXPECT_NEAR(again.torque, once.torque, newton * once.torque);
  EXPECT_NEAR(solved.sheared().area_ratio, sheared.area_ratio, newton);
}

// If a layer folds before full slip, full slip is inferred from slides with less friction.
TEST_F(SolvedFriction, InfersFullSlipFromSlidesWithLess) {
  constexpr double high = 0.7;
  const double force = high * pressing.equilibrium().load,
               torque = finite::slide(pressing, high, {0, 0, 1}).torque;
  const finite::SuperposedSlide superposed(pressing, high);
  finite::FrictionalPressing solved(pressing, high);
  for (const PlaneMotion velocity : {PlaneMotion{0, 0, 1}, PlaneMotion{1, 0, 0.5}}) {
    std::vector<finite::SolvedSlide> solutions;
    const double aim = 0.6;
    EXPECT_DOUBLE_EQ(solved.slide(velocity, aim,
                                  [&](double share) {
                                    solutions.push_back({share, solved.wrench()});
                                  }),
                     aim);
    ASSERT_GE(solutions.size(), 2u);
    const finite::FullSlip inferred =
        finite::full_slip(superposed, velocity, solutions, force, torque);
    ASSERT_EQ(solved.slide(velocity), 1);
    const Eigen::Vector3d exact = finite::relative(solved.wrench(), force, torque);
    constexpr double newton = 1e-3;  // of the steps, relative to the approach
    EXPECT_LE((inferred.wrench - exact).cwiseAbs().maxCoeff(), inferred.added + newton);
    // That is better than what superposed motions say.
    const Eigen::Vector3d without =
        finite::relative(superposed.slide(velocity).wrench, force, torque);
    EXPECT_LT((inferred.wrench - exact).norm(), 0.5 * (without - exact).norm());
  }
}

struct DraggedContact {
  FinitePressing frictionless;
  finite::RubbedPressing by_steps;
};

/// A ball on a layer that sticks but for a ring at the edge.
DraggedContact dragged_on(const LayerDiscretisation& mesh, const finite::Drive& drive) {
  constexpr double poisson_ratio = 0.49, friction = 0.3;
  DraggedContact result{layer_under(sphere(5), mesh, poisson_ratio), {}};
  result.frictionless.press(drive);
  result.by_steps = finite::press_rubbing(
      result.frictionless, layer_under(sphere(5), mesh, poisson_ratio).shared_layer(), friction,
      drive);
  return result;
}

finite::RubbedPressing taken_over(const DraggedContact& on, const LayerDiscretisation& mesh,
                                  const finite::Drive& drive, const finite::Drag& drag) {
  return finite::press_dragged(on.frictionless, layer_under(sphere(5), mesh, 0.49).shared_layer(),
                               0.3, drive, drag);
}

TEST(Drag, LeadsToTheContactThatItCameFrom) {
  const LayerDiscretisation mesh = mesh_for(1, 1);
  for (const finite::Drive& drive : {finite::Drive{1, 0}, finite::Drive{0, 0.15}}) {
    const DraggedContact dragged = dragged_on(mesh, drive);
    const finite::Equilibrium& by_steps = dragged.by_steps.pressing->equilibrium();
    const finite::RubbedPressing again = taken_over(dragged, mesh, drive, dragged.by_steps.drag);
    const finite::Equilibrium& taken = again.pressing->equilibrium();
    // The field smooths what the nodes remember: within what is stated for load steps.
    EXPECT_NEAR(taken.approach / by_steps.approach, 1, finite_strain.load_steps);
    EXPECT_NEAR(taken.load / by_steps.load, 1, 2 * finite_strain.load_steps);
    EXPECT_EQ(again.drag.stick_share, dragged.by_steps.drag.stick_share);
    const double change = by_steps.approach / dragged.frictionless.equilibrium().approach - 1;
    if (drive.load > 0) {
      EXPECT_LT(change, -0.02) << "friction has an effect to be taken over";
    }
  }
}

TEST(Drag, OfACoarserMeshServesAFinerOne) {
  const finite::Drive drive{1, 0};
  LayerDiscretisation fine = mesh_for(1, 1);
  fine.elements_per_semi_axis = 6;
  const DraggedContact coarse = dragged_on(mesh_for(1, 1), drive), finer = dragged_on(fine, drive);
  const finite::RubbedPressing taken = taken_over(finer, fine, drive, coarse.by_steps.drag);
  const double by_steps = finer.by_steps.pressing->equilibrium().approach,
               without = finer.frictionless.equilibrium().approach;
  // A fiftieth of what friction changes, which four elements along the semi-axis know to a tenth.
  EXPECT_NEAR(taken.pressing->equilibrium().approach / by_steps, 1,
              0.02 * std::abs(by_steps / without - 1));
}

// Superposed motions neglect a small part of a wrench, which coarser cells resolve nearly as well.
TEST_F(SolvedFriction, NeglectedOfSlidesIsTheSameOnACoarserMesh) {
  LayerDiscretisation coarser = mesh_for(1.2, 1.2);
  coarser.elements_per_semi_axis = 3;
  FinitePressing coarse(layer_under(sphere(5), coarser, 0.45, no_plane));
  coarse.press({pressing.equilibrium().load, 0});
  const double force = kFriction * pressing.equilibrium().load,
               torque = finite::slide(pressing, kFriction, {0, 0, 1}).torque;
  const std::vector<PlaneMotion> velocities{{0, 0, 1}, {1, 0, 0.5}, {0.5, 1, 0}};
  std::vector<std::vector<finite::SolvedSlides::Neglected>> found;
  double spread = 0;
  for (FinitePressing* on : {&pressing, &coarse}) {
    finite::SolvedSlides slides(*on, kFriction, false, force, torque, 1,
                                [](const std::string& why) { ADD_FAILURE() << why; });
    found.push_back(slides.of(velocities, spread));
  }
  EXPECT_EQ(spread, 0);
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    const Eigen::Vector3d fine = finite::relative(found[0][i].wrench, force, torque),
                          rough = finite::relative(found[1][i].wrench, force, torque);
    const double neglected = fine.cwiseAbs().maxCoeff();
    EXPECT_GT(neglected, 0.002);
    // A quarter of what is neglected, as was found on scans where that is a tenth of the wrench.
    EXPECT_LT((fine - rough).cwiseAbs().maxCoeff(), 0.25 * neglected);
    EXPECT_TRUE(found[0][i].sheared);
  }
}

// The correction is that of the finer mesh; the coarser one yields its error, which without it is
// taken as the square of the neglected part.
TEST_F(SolvedFriction, StatesTheTwistsErrorByASecondMesh) {
  constexpr double high = 0.7;
  LayerDiscretisation fewer = mesh_for(1.2, 1.2);
  fewer.elements_per_semi_axis = 3;
  FinitePressing coarse(layer_under(sphere(5), fewer, 0.45, no_plane));
  coarse.press({pressing.equilibrium().load, 0});
  FrictionOfLevel superposed;
  SuperposedMotion motion(pressing, high);
  superposed.full_slip = finite::slide(pressing, high, {0, 0, 1}).torque;
  const double unit = superposed.full_slip / motion.stiffness();
  for (const double share : {0.3, 1.0, 3.0}) {
    motion.turn_to(share * unit);
    superposed.twist.push_back({{0, 0, share * unit}, motion.wrench(), 0, 0});
  }
  finite::FrictionCorrecting correcting{{&pressing, high}};
  correcting.force = high * pressing.equilibrium().load;
  correcting.with_turn = true;
  correcting.progress = [](const std::string&) {};
  int solved = 0;
  correcting.on_solved = [&](double, const RubbedSurface&) { ++solved; };
  const FrictionCorrection alone = finite::correct_friction(correcting, superposed);
  EXPECT_EQ(solved, 3);
  correcting.coarser = finite::FrictionMesh{&coarse, high};
  correcting.refinement =
      static_cast<double>(pressing.layer().discretisation().elements_per_semi_axis) / 3;
  const FrictionCorrection compared = finite::correct_friction(correcting, superposed);
  constexpr double newton = 1e-3;  // of its steps, relative to the approach
  const double full = superposed.full_slip;
  for (std::size_t i = 0; i < superposed.twist.size(); ++i)
    EXPECT_NEAR(compared.twist[i].wrench.torque, alone.twist[i].wrench.torque, newton * full);
  EXPECT_NEAR(compared.full_slip, alone.full_slip, newton * full);
  // A tenth of what is neglected, or its square: no mesh was asked.
  EXPECT_GE(alone.twist_error, 0.1 * std::abs(alone.twist.back().wrench.torque) / full);
  EXPECT_GT(compared.twist_error, 0);
  EXPECT_LT(compared.twist_error, 2 * alone.twist_error);
  EXPECT_NE(compared.twist_error, alone.twist_error);
}

// Under much pressure nodes that are released would be unstable, and the contact on the tangent has
// no solution, or several. Full friction is reached all the same, and soon.
TEST_F(SolvedFriction, ReachesFullSlipSoon) {
  finite::FrictionalPressing solved(pressing, /*friction_coefficient=*/0.7);
  for (const PlaneMotion velocity : {PlaneMotion{0, 0, 1}, PlaneMotion{0.6, 0.6, 0.4}}) {
    const int before = solved.iterations();
    EXPECT_EQ(solved.slide(velocity), 1);
    EXPECT_LT(solved.iterations() - before, 25);
  }
}

// At the end of a long twist all points slip. A slide that starts there comes to the same state, in
// fewer iterations.
TEST_F(SolvedFriction, SlidesTheSameWayFromAGuess) {
  finite::FrictionalPressing solved(pressing, kFriction);
  ASSERT_EQ(solved.slide({0, 0, 1}), 1);
  const double torque = solved.wrench().torque;
  const int from_none = solved.iterations();
  solved.restart();
  for (const double turn : {0.3, 1.2}) solved.move_to({0, 0, turn});
  const finite::FrictionalPressing::State guess = solved.present();
  solved.restart();
  const int before = solved.iterations();
  ASSERT_EQ(solved.slide(
                {0, 0, 1}, 1, [](double) {}, &guess),
            1);
  EXPECT_LT(solved.iterations() - before, from_none);
  EXPECT_NEAR(solved.wrench().torque / torque, 1, 1e-3);
}

// Slides that start from the extrapolated states of earlier ones come to the states that each has
// alone, in fewer iterations.
TEST_F(SolvedFriction, SlidesTheSameWayFromThoseBefore) {
  std::vector<PlaneMotion> velocities;
  for (const double angle : {0.0, 0.4, 0.8, 1.2})
    velocities.push_back({std::cos(angle), std::sin(angle), 0.5});
  const double force = kFriction * pressing.equilibrium().load,
               torque = finite::slide(pressing, kFriction, {0, 0, 1}).torque;
  std::vector<Eigen::Vector3d> alone;
  int iterations_alone = 0;
  for (const PlaneMotion& velocity : velocities) {
    finite::FrictionalPressing solved(pressing, kFriction);
    ASSERT_EQ(solved.slide(velocity), 1);
    alone.push_back(finite::relative(solved.wrench(), force, torque));
    iterations_alone += solved.iterations();
  }
  finite::FrictionalPressing solved(pressing, kFriction);
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    ASSERT_EQ(solved.slide(velocities[i]), 1);
    const Eigen::Vector3d found = finite::relative(solved.wrench(), force, torque);
    constexpr double newton = 1e-3;  // of its steps, relative to the approach
    EXPECT_LT((found - alone[i]).cwiseAbs().maxCoeff(), newton);
  }
  EXPECT_LT(solved.iterations(), iterations_alone);
}

// However far the object turns in one increment, friction is along the motion under each node at
// its end: full slip has one torque.
TEST_F(SolvedFriction, OfALargeTurnIsThatOfASlide) {
  finite::FrictionalPressing solved(pressing, kFriction);
  for (const double turn : {0.3, 1.2}) solved.move_to({0, 0, turn});
  EXPECT_GT(solved.slip_fraction(), 0.9);
  const double turned = solved.wrench().torque;
  ASSERT_EQ(solved.slide({0, 0, 1}), 1);
  // The sticking region around the centre carries little. The chord of 0.9 rad would lose 10 %.
  EXPECT_NEAR(turned / solved.wrench().torque, 1, 0.01);
}

TEST(FrictionalPressing, HasTheTorqueOfFrictionlessPressingAtFullSlip) {
  // Shear that points inwards or outwards turns into the direction of the slip, and the surface is
  // then where it would be without friction. Nothing of this is used by the solver.
  struct Contact {
    double poisson_ratio, major, minor, size, load, friction;
  };
  for (const Contact& contact :
       {Contact{0.49, 5, 5, 1.2, 0.5, 0.8}, Contact{0.3, 4, 4, 0.9, 0.3, 0.3},
        Contact{0.45, 6, 3, 1.1, 0.4, 0.5}}) {
    SCOPED_TRACE("nu " + std::to_string(contact.poisson_ratio));
    const double narrow = contact.size * std::sqrt(contact.minor / contact.major);
    FinitePressing pressing =
        layer_under(std::make_shared<TurnedQuadric>(contact.major, contact.minor, 0),
                    mesh_for(contact.size, narrow), contact.poisson_ratio, no_plane);
    pressing.press({contact.load, 0});
    const double frictionless_approach = pressing.equilibrium().approach;
    double torque = 0, approach = 0;  // of a turn from frictionless pressing
    {
      finite::FrictionalPressing slides(pressing, contact.friction);
      ASSERT_EQ(slides.slide({0, 0, 1}), 1);
      torque = slides.wrench().torque;
      approach = slides.present().approach;
    }
    constexpr int steps = 6;
    const auto load_of = [&](int step) {
      return contact.load * std::pow(static_cast<double>(step) / steps, 3);
    };
    pressing.press({load_of(1), 0});
    finite::FrictionalPressing rubbed(pressing, contact.friction);
    for (int step = 2; step <= steps; ++step) rubbed.press_to({load_of(step), 0});
    EXPECT_LT(rubbed.present().approach, frictionless_approach);
    double largest = 0;
    for (double turn_rad = 0.1; turn_rad < 3; turn_rad *= 1.5) {
      rubbed.move_to({0, 0, turn_rad});
      largest = std::max(largest, rubbed.wrench().torque);
    }
    // A slide softens friction within a quarter of the nodes' spacing of its centre, which takes
    // some 0.2 % of the torque on these meshes; a turn of this length leaves a thousandth of the
    // approach.
    constexpr double of_turn = 4e-3;
    EXPECT_NEAR(rubbed.wrench().torque / torque, 1, of_turn);
    EXPECT_NEAR(largest / torque, 1, of_turn);
    EXPECT_NEAR(rubbed.present().approach / approach, 1, of_turn);
  }
}

}  // namespace
}  // namespace softfinger::fem
