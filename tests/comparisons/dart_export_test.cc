// The numbers of `softfinger export --to gz-sim` for its default engine, in the real DART.

#include <gtest/gtest.h>

#include <cmath>
#include <dart/collision/dart/DARTCollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>
#include <nlohmann/json.hpp>
#include <tuple>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace {

using namespace dart::dynamics;
using nlohmann::json;

/// So much inertia that what slips hardly turns.
constexpr double kMass_kg = 1, kInertia_kgm2 = 1, kTimeStep_s = 1e-3;

json exported(const std::vector<std::string>& contact) {
  TemporaryFolder folder;
  std::vector<std::string> arguments = {"export"};
  arguments.insert(arguments.end(), contact.begin(), contact.end());
  arguments.insert(arguments.end(), {"--to", "gz-sim", "--json"});
  const ProgramRun run = run_softfinger({folder.path(), {}, -1, ""}, arguments);
  EXPECT_EQ(run.status, 0) << run.err;
  return json::parse(run.out);
}

/// A body of some shapes on a table, without gravity.
class DartWorld {
 public:
  using Shapes = std::vector<std::pair<ShapePtr, Eigen::Vector3d>>;

  /// @param height_m  of the body's origin when it touches
  DartWorld(const Shapes& shapes, double height_m, double angle_rad, double friction) {
    world_->setGravity(Eigen::Vector3d::Zero());
    world_->setTimeStep(kTimeStep_s);
    world_->getConstraintSolver()->setCollisionDetector(
        dart::collision::DARTCollisionDetector::create());
    const SkeletonPtr table = Skeleton::create("table"), moving = Skeleton::create("moving");
    add(*table->createJointAndBodyNodePair<WeldJoint>().second,
        std::make_shared<BoxShape>(Eigen::Vector3d(2, 2, 0.2)), {0, 0, -0.1}, friction);
    FreeJoint* joint = nullptr;
    std::tie(joint, body_) = moving->createJointAndBodyNodePair<FreeJoint>();
    for (const auto& [shape, at_m] : shapes) add(*body_, shape, at_m, friction);
    body_->setInertia(
        Inertia(kMass_kg, Eigen::Vector3d::Zero(), kInertia_kgm2 * Eigen::Matrix3d::Identity()));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.rotate(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
    // A micrometre of overlap: else the first step finds no contact.
    pose.translation().z() = height_m - 1e-6;
    joint->setTransform(pose);
    world_->addSkeleton(table);
    world_->addSkeleton(moving);
  }

  struct Acceleration {
    Eigen::Vector3d linear, angular;
  };
  /// The mean of the second of two tenths of a second under these forces.
  Acceleration acceleration(const Eigen::Vector3d& force_N, double torque_Nm) {
    const auto run = [&] {
      for (int i = 0; i < 100; ++i) {
        body_->addExtForce(force_N, Eigen::Vector3d::Zero(), false, true);
        body_->addExtTorque({0, 0, torque_Nm}, false);
        world_->step();
      }
      return Acceleration{body_->getLinearVelocity(), body_->getAngularVelocity()};
    };
    const Acceleration first = run(), second = run();
    return {(second.linear - first.linear) / 0.1, (second.angular - first.angular) / 0.1};
  }

 private:
  static void add(BodyNode& body, const ShapePtr& shape, const Eigen::Vector3d& at_m,
                  double friction) {
    ShapeNode* node = body.createShapeNodeWith<CollisionAspect, DynamicsAspect>(shape);
    node->setRelativeTranslation(at_m);
    node->getDynamicsAspect()->setFrictionCoeff(friction);
  }

  dart::simulation::WorldPtr world_ = dart::simulation::World::create();
  BodyNode* body_ = nullptr;
};

/// Torques at which a body slips, over the predicted one, over all orientations.
struct SlipRange {
  double least = INFINITY, most = 0;
};
SlipRange slipping(const DartWorld::Shapes& shapes, double height_m, double friction, double load_N,
                   double torque_Nm) {
  SlipRange range;
  for (int degrees = 0; degrees < 90; degrees += 5) {
    DartWorld world(shapes, height_m, degrees * M_PI / 180, friction);
    const double applied_Nm = 2 * torque_Nm,
                 excess_Nm =
                     kInertia_kgm2 * world.acceleration({0, 0, -load_N}, applied_Nm).angular.z();
    const double share = (applied_Nm - excess_Nm) / torque_Nm;
    range.least = std::min(range.least, share);
    range.most = std::max(range.most, share);
  }
  return range;
}

double stated_share(const std::string& text) {
  const std::size_t within = text.find("within ");
  EXPECT_NE(within, std::string::npos) << text;
  return 0.01 * std::stod(text.substr(within + 7));
}

TEST(DartExport, ThreePointsHaveTheTorqueWithinTheStatedShareAtEveryOrientation) {
  const json answer = exported({"silicone_pad_2mm"});
  const double friction = answer["values"]["sliding_friction"], load_N = answer["load_N"],
               torque_Nm = friction * load_N * answer["eccentricity_m"].get<double>(),
               distance_m = answer["values"]["three_points_radius_m"], radius_m = 0.3e-3;
  DartWorld::Shapes points;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * M_PI / 3 * i;
    points.push_back({std::make_shared<SphereShape>(radius_m),
                      {distance_m * std::cos(angle), distance_m * std::sin(angle), 0}});
  }
  const SlipRange range = slipping(points, radius_m, friction, load_N, torque_Nm);
  const double stated = stated_share(answer["lines"]);
  // DART regularises friction (CFM 1e-5).
  EXPECT_NEAR(range.most, 1 + stated, 0.002);
  EXPECT_NEAR(range.least, 1 - stated, 0.002);
}

TEST(DartExport, OnePointHasNoTorqueAndSlidesByAPyramid) {
  const json answer = exported({"silicone_pad_2mm"});
  EXPECT_FALSE(answer["traps"].empty());
  const double friction = answer["values"]["sliding_friction"], load_N = answer["load_N"],
               limit_N = friction * load_N, radius_m = 20e-3, torque_Nm = 1e-3;
  const auto acceleration = [&](double x_N, double y_N, double twist_Nm) {
    return DartWorld({{std::make_shared<SphereShape>(radius_m), Eigen::Vector3d::Zero()}}, radius_m,
                     0, friction)
        .acceleration({x_N, y_N, -load_N}, twist_Nm);
  };
  EXPECT_NEAR(acceleration(0, 0, torque_Nm).angular.z(), torque_Nm / kInertia_kgm2, 1e-6);
  EXPECT_LT(acceleration(0.97 * limit_N, 0.97 * limit_N, 0).linear.norm(), 2e-3 * limit_N);
  EXPECT_GT(acceleration(1.03 * limit_N, 0, 0).linear.norm(), 0.02 * limit_N);
}

TEST(DartExport, APadsBoxHasTheTorqueWithinTheStatedShareAtEveryOrientation) {
  const json pad =
      exported({"--pad-mm", "22,37.5", "--thickness-mm", "3", "--youngs-modulus-kPa", "800",
                "--poisson-ratio", "0.49", "--load", "20", "--friction", "0.9"});
  const json values = pad["box_values"];
  const double friction = values["sliding_friction"], load_N = 20,
               torque_Nm = friction * load_N * pad["eccentricity_m"].get<double>(), height_m = 2e-3;
  const Eigen::Vector3d size_m(2 * values["box_half_length_x_m"].get<double>(),
                               2 * values["box_half_length_y_m"].get<double>(), 2 * height_m);
  const SlipRange range = slipping({{std::make_shared<BoxShape>(size_m), Eigen::Vector3d::Zero()}},
                                   height_m, friction, load_N, torque_Nm);
  const double stated = stated_share(pad["box_lines"]);
  EXPECT_NEAR(range.most, 1 + stated, 0.005);
  EXPECT_NEAR(range.least, 1 - stated, 0.005);
}

}  // namespace
}  // namespace softfinger::tests
