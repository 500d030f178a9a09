// The numbers of `softfinger export --to ode`, and the boxes of --to gazebo, whose engine has the
// same friction, in the real ODE.

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace {

using nlohmann::json;

/// So much inertia that what slips hardly turns, and does not roll.
constexpr double kMass_kg = 1, kInertia_kgm2 = 1, kTimeStep_s = 1e-3;

/// A body on a plane, without gravity.
class OdeWorld {
 public:
  enum class Solver { exact, quick };

  /// @param height_m  of the body's centre
  /// @param angle     by which it is turned about z
  OdeWorld(const std::function<dGeomID(dSpaceID)>& shape, double height_m, double angle_rad,
           const dSurfaceParameters& surface)
      : surface_(surface) {
    dInitODE();
    world_ = dWorldCreate();
    space_ = dSimpleSpaceCreate(nullptr);
    contacts_ = dJointGroupCreate(0);
    dCreatePlane(space_, 0, 0, 1, 0);
    body_ = dBodyCreate(world_);
    dMass mass;
    dMassSetParameters(&mass, kMass_kg, 0, 0, 0, kInertia_kgm2, kInertia_kgm2, kInertia_kgm2, 0, 0,
                       0);
    dBodySetMass(body_, &mass);
    dGeomSetBody(shape(space_), body_);
    dBodySetPosition(body_, 0, 0, height_m);
    dMatrix3 turned;
    dRFromAxisAndAngle(turned, 0, 0, 1, angle_rad);
    dBodySetRotation(body_, turned);
  }
  ~OdeWorld() {
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
    dCloseODE();
  }

  struct Acceleration {
    double along_x = 0, about_z = 0;
  };
  /// The mean of the second of two tenths of a second under these forces.
  Acceleration acceleration(double load_N, double x_N, double y_N, double torque_Nm,
                            Solver solver) {
    const auto run = [&] {
      for (int i = 0; i < 100; ++i) {
        dBodyAddForce(body_, x_N, y_N, -load_N);
        dBodyAddTorque(body_, 0, 0, torque_Nm);
        dSpaceCollide(space_, this, touch);
        (solver == Solver::exact ? dWorldStep : dWorldQuickStep)(world_, kTimeStep_s);
        dJointGroupEmpty(contacts_);
      }
      return Acceleration{dBodyGetLinearVel(body_)[0], dBodyGetAngularVel(body_)[2]};
    };
    const Acceleration first = run(), second = run();
    return {(second.along_x - first.along_x) / 0.1, (second.about_z - first.about_z) / 0.1};
  }

 private:
  static void touch(void* self, dGeomID one, dGeomID other) {
    const auto* world = static_cast<OdeWorld*>(self);
    dContact contacts[8] = {};
    const int count = dCollide(one, other, 8, &contacts[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
      contacts[i].surface = world->surface_;
      dJointAttach(dJointCreateContact(world->world_, world->contacts_, &contacts[i]),
                   dGeomGetBody(one), dGeomGetBody(other));
    }
  }

  dSurfaceParameters surface_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  dBodyID body_;
};

json exported(const std::vector<std::string>& contact, const std::string& to) {
  TemporaryFolder folder;
  std::vector<std::string> arguments = {"export"};
  arguments.insert(arguments.end(), contact.begin(), contact.end());
  arguments.insert(arguments.end(), {"--to", to, "--json"});
  const ProgramRun run = run_softfinger({folder.path(), {}, -1, ""}, arguments);
  EXPECT_EQ(run.status, 0) << run.err;
  return json::parse(run.out);
}

class OdeExport : public testing::TestWithParam<OdeWorld::Solver> {
 protected:
  double load_N = 0, friction = 0, max_torque_Nm = 0;
  dSurfaceParameters surface = {};

  void SetUp() override {
    const json answer = exported({"silicone_pad_2mm"}, "ode"), values = answer["values"];
    load_N = answer["load_N"];
    friction = answer["friction_coefficient"];
    max_torque_Nm = friction * load_N * answer["eccentricity_m"].get<double>();
    surface.mode = dContactApprox1 | dContactAxisDep | dContactRolling;
    surface.mu = surface.mu2 = values["sliding_friction"];
    surface.rho = surface.rho2 = values["rolling_friction_m"];
    surface.rhoN = values["spinning_friction_m"];
  }

  OdeWorld::Acceleration acceleration(double x_N, double y_N, double torque_Nm) const {
    constexpr double kRadius_m = 0.02;
    return OdeWorld([](dSpaceID space) { return dCreateSphere(space, kRadius_m); }, kRadius_m, 0,
                    surface)
        .acceleration(load_N, x_N, y_N, torque_Nm, GetParam());
  }
};

// A thousandth of the distance from the limit: ODE regularises contacts by 1e-10 (CFM).
constexpr double kTolerance = 1e-6;

TEST_P(OdeExport, HoldsAndSlipsAtThePredictedTorqueWhateverTheSlidingForce) {
  const double limit = max_torque_Nm / kInertia_kgm2;
  for (const double push : {0.0, 0.6}) {
    SCOPED_TRACE(push);
    const double x_N = push * friction * load_N;
    EXPECT_NEAR(acceleration(x_N, 0, 0.999 * max_torque_Nm).about_z, 0, kTolerance * limit);
    EXPECT_NEAR(acceleration(x_N, 0, 1.001 * max_torque_Nm).about_z, 0.001 * limit,
                kTolerance * limit);
  }
}

TEST_P(OdeExport, SlidesByAPyramid) {
  const double limit_N = friction * load_N;
  // The body turns about y as it is pushed above the plane: 1 % of the force's excess or less.
  EXPECT_NEAR(acceleration(0.97 * limit_N, 0.97 * limit_N, 0).along_x, 0, 1e-3 * limit_N);
  EXPECT_GT(acceleration(1.03 * limit_N, 0, 0).along_x, 0.02 * limit_N / kMass_kg);
}

// The traps that the export names.
TEST_P(OdeExport, NeedsTheFlagsOfTheLines) {
  // Without dContactApprox1_N rhoN is a torque.
  surface.mode &= ~dContactApprox1_N;
  const double torque_Nm = 1.5 * surface.rhoN;
  ASSERT_LT(torque_Nm, max_torque_Nm);
  EXPECT_NEAR(acceleration(0, 0, torque_Nm).about_z, torque_Nm / 3 / kInertia_kgm2,
              kTolerance * torque_Nm);
  // Without dContactAxisDep it is not read, and rho is 0.
  surface.mode = dContactApprox1 | dContactRolling;
  EXPECT_NEAR(acceleration(0, 0, torque_Nm).about_z, torque_Nm / kInertia_kgm2,
              kTolerance * torque_Nm);
}

INSTANTIATE_TEST_SUITE_P(StepAndQuickStep, OdeExport,
                         testing::Values(OdeWorld::Solver::exact, OdeWorld::Solver::quick));

// Corners in a friction pyramid hold more than mu P times their distance. The box takes that into
// account as well as one number can, since ODE chooses the pyramid's directions.
TEST(OdePad, BoxesHaveTheTorqueWithinTheStatedShareAtEveryOrientation) {
  for (const std::string to : {"ode", "gazebo"})
    for (const std::string size_mm : {"22,37.5", "20,20", "60,6"}) {
      SCOPED_TRACE(to + " " + size_mm);
      const json pad =
          exported({"--pad-mm", size_mm, "--thickness-mm", "1.5", "--youngs-modulus-kPa", "800",
                    "--poisson-ratio", "0.49", "--load", "20", "--friction", "0.9"},
                   to);
      const json values = pad["box_values"];
      const double load_N = 20, torque_Nm = 0.9 * load_N * pad["eccentricity_m"].get<double>();
      const std::string text = pad["box_lines"];
      const std::size_t within = text.find("within ");
      ASSERT_NE(within, std::string::npos);
      const double stated = 0.01 * std::stod(text.substr(within + 7));
      const double x_m = values["box_half_length_x_m"], y_m = values["box_half_length_y_m"],
                   half_height_m = 1e-3;
      dSurfaceParameters surface = {};
      surface.mode = dContactApprox1;
      surface.mu = values["sliding_friction"];
      double least = INFINITY, most = 0;
      for (int degrees = 0; degrees < 90; degrees += 5) {
        OdeWorld world(
            [&](dSpaceID space) { return dCreateBox(space, 2 * x_m, 2 * y_m, 2 * half_height_m); },
            half_height_m, degrees * M_PI / 180, surface);
        const double applied_Nm = 2 * torque_Nm,
                     excess_Nm =
                         kInertia_kgm2 *
                         world.acceleration(load_N, 0, 0, applied_Nm, OdeWorld::Solver::exact)
                             .about_z;
        least = std::min(least, (applied_Nm - excess_Nm) / torque_Nm);
        most = std::max(most, (applied_Nm - excess_Nm) / torque_Nm);
      }
      // Orientations 5 degrees apart miss an extreme by up to 0.4 %.
      EXPECT_NEAR(most, 1 + stated, 0.005);
      EXPECT_NEAR(least, 1 - stated, 0.005);
    }
}

}  // namespace
}  // namespace softfinger::tests
