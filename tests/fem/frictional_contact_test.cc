#include "fem/friction/frictional_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "fem/contact/pressing.h"
#include "fem/friction/friction_study.h"
#include "fem/friction/surface_compliance.h"
#include "fem/output/write_compliance.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using Eigen::Index;

/// A coarse oblong contact, its compliances, and what serves for a half turn and for any motion.
struct Contact {
  Contact() {
    Pressing pressing;
    pressing.major = 40;
    pressing.minor = 20;
    pressing.sphere = std::numeric_limits<double>::infinity();
    pressing.load = load;
    pressing.poisson_ratio = 0.4;
    LayerDiscretisation mesh;
    mesh.a = 1.0;
    mesh.b = 0.7;
    mesh.elements_per_semi_axis = 4;
    mesh.patch = 1.3;
    pressed = *press_on(*make_layer(mesh, pressing), pressing);
    quarters =
        std::make_unique<QuarterCompliances>(friction_compliances(start(), Invariance::none));
    whole = surface_compliance(*quarters, Invariance::none);
    half = surface_compliance(*quarters, Invariance::half_turn);
  }

  PressedContact start() const {
    return {*pressed.model,   pressed.gap, pressed.contact.force, pressed.moment_a,
            pressed.moment_b, load,        ShearLaw::coulomb(mu)};
  }
  FrictionalContact on(const SurfaceCompliance& surface) const {
    Eigen::VectorXd gap(surface.size());
    for (Index i = 0; i < gap.size(); ++i)
      gap[i] = pressed.gap[surface.model_node[static_cast<std::size_t>(i)]];
    return {surface, gap, load, mu};
  }

  double load = 0.05, mu = 0.3;
  Pressed pressed;
  std::unique_ptr<QuarterCompliances> quarters;
  SurfaceCompliance whole, half;
};

/// Built once: the factorisations are most of these tests' time.
const Contact& contact() {
  static const Contact instance;
  return instance;
}

/// Round-off through a factorisation of condition about 1e5.
constexpr double round_off = 1e-10;
/// Two states that differ by rounding alone: `settle` stops at 1e-5 of the load, and what it finds
/// is nearer by the rate of the settling, about a tenth.
constexpr double settled = 1e-5;

TEST(KeptCompliances, ServeWhatTheyHaveAndAreReplacedWhereTheyHaveNot) {
  PressedContact inner = contact().start();
  inner.margin = 0.5;
  KeptCompliances kept;
  const QuarterCompliances twist = friction_compliances(inner, Invariance::half_turn, &kept);
  ASSERT_NE(kept, nullptr);
  const auto first = kept;
  friction_compliances(inner, Invariance::half_turn, &kept);
  EXPECT_EQ(kept, first) << "asked for what it has";
  friction_compliances(inner, Invariance::none, &kept);
  EXPECT_NE(kept, first) << "two more parities";
  const auto second = kept;
  const QuarterCompliances wider = friction_compliances(contact().start(), Invariance::none, &kept);
  EXPECT_NE(kept, second) << "more nodes";
  ASSERT_GT(wider.nodes.size(), twist.nodes.size());
  const auto third = kept;
  const QuarterCompliances part = friction_compliances(inner, Invariance::half_turn, &kept);
  EXPECT_EQ(kept, third);
  ASSERT_EQ(part.nodes, twist.nodes);
  ASSERT_EQ(part.by_parity.size(), twist.by_parity.size());
  for (std::size_t p = 0; p < part.by_parity.size(); ++p)
    EXPECT_LT((part.by_parity[p] - twist.by_parity[p]).norm(),
              round_off * twist.by_parity[p].norm());
}

TEST(SurfaceCompliance, IsSymmetric) {
  for (const auto* surface : {&contact().whole, &contact().half}) {
    EXPECT_LT((surface->normal - surface->normal.transpose()).norm(),
              round_off * surface->normal.norm());
    EXPECT_LT((surface->tangential - surface->tangential.transpose()).norm(),
              round_off * surface->tangential.norm());
  }
}

TEST(SurfaceCompliance, OfASymmetricForceIsThatOfTheQuarter) {
  const auto& surface = contact().whole;
  Eigen::VectorXd force(surface.size()),
      of_quarter = Eigen::VectorXd::Zero(contact().pressed.gap.size());
  for (Index i = 0; i < surface.size(); ++i) {
    const double x = std::abs(surface.position(0, i)), y = std::abs(surface.position(1, i));
    force[i] = 1 + x - 0.5 * y;
    // On a plane of symmetry the quarter has half of the point's force.
    of_quarter[surface.model_node[static_cast<std::size_t>(i)]] =
        force[i] / ((x < 1e-9 ? 2 : 1) * (y < 1e-9 ? 2 : 1));
  }
  const Eigen::VectorXd displacement = surface.normal * force;
  const Eigen::VectorXd expected = contact().pressed.model->compliance() * of_quarter;
  for (Index i = 0; i < surface.size(); ++i)
    EXPECT_NEAR(displacement[i], expected[surface.model_node[static_cast<std::size_t>(i)]],
                round_off * expected.cwiseAbs().maxCoeff());
}

TEST(SurfaceCompliance, SharesOutTheSameArea) {
  EXPECT_NEAR(contact().half.area.sum() * contact().half.copies, contact().whole.area.sum(),
              round_off * contact().whole.area.sum());
}

TEST(FrictionalContact, StartsFromTheFrictionlessPressure) {
  const FrictionalContact state = contact().on(contact().whole);
  EXPECT_NEAR(state.approach(), contact().pressed.contact.approach, round_off);
  EXPECT_NEAR(state.normal_force().sum(), contact().load, round_off);
  EXPECT_EQ(state.wrench().torque, 0);
}

TEST(FrictionalContact, TwistsAsStifflyAsIfStuckAtFirst) {
  const double stiffness = stuck_torsional_stiffness(contact().start(), *contact().quarters);
  FrictionalContact state = contact().on(contact().half);
  const double angle = 1e-4 * contact().mu * contact().load / stiffness;
  state.move_to({0, 0, angle});
  // The stuck stiffness holds the surface down, the increment holds the pressure: a coupling of
  // second order in Dundurs' constant (1 - 2 nu) / (2 (1 - nu)).
  const double coupling = (1 - 2 * 0.4) / (2 * (1 - 0.4));
  EXPECT_NEAR(state.wrench().torque / (stiffness * angle), 1, coupling * coupling);
}

TEST(FrictionalContact, IsTheSameByHalfATurnAndAsAWhole) {
  FrictionalContact half = contact().on(contact().half), whole = contact().on(contact().whole);
  for (const double angle : {1e-3, 3e-3, 1e-2}) {
    half.move_to({0, 0, angle});
    whole.move_to({0, 0, angle});
    EXPECT_NEAR(half.wrench().torque / whole.wrench().torque, 1, settled);
    EXPECT_NEAR(whole.wrench().force_x, 0, settled * contact().load);
  }
}

TEST(FrictionalContact, EndsInFullSlipWithTheTorqueOfItsPressure) {
  FrictionalContact state = contact().on(contact().half);
  double before = 0;
  for (const double angle : {1e-3, 3e-3, 1e-2, 0.1, 1.0}) {
    state.move_to({0, 0, angle});
    EXPECT_GT(state.wrench().torque, before * (1 - settled));
    before = state.wrench().torque;
  }
  EXPECT_NEAR(state.slip_fraction(), 1, 1e-12);
  EXPECT_NEAR(state.wrench().torque, state.torque_of_pressure(),
              settled * state.torque_of_pressure());
  FrictionalContact sliding = contact().on(contact().half);
  sliding.slide({0, 0, 1});
  EXPECT_NEAR(state.wrench().torque, sliding.wrench().torque, settled * before);
}

TEST(FrictionalContact, ObeysCoulombsLawHoweverSmallTheCoefficientIs) {
  // Shear that hardly moves the pressure must be solved as exactly as shear that does.
  const SurfaceCompliance& surface = contact().half;
  Eigen::VectorXd gap(surface.size());
  for (Index i = 0; i < gap.size(); ++i)
    gap[i] = contact().pressed.gap[surface.model_node[static_cast<std::size_t>(i)]];
  for (const double mu : {1e-4, 1e-2, 0.3}) {
    FrictionalContact state(surface, gap, contact().load, mu);
    Eigen::VectorXd before = state.slip();
    for (const double angle : {0.004, 0.01, 0.02, 0.035, 0.06}) {
      state.move_to({0, 0, angle * mu});
      const Eigen::VectorXd slip = state.slip() - before;
      before = state.slip();
      double violation = 0;
      for (Index i = 0; i < surface.size(); ++i) {
        const double limit = mu * state.normal_force()[i], own = surface.tangential(2 * i, 2 * i);
        // The centre of the turn cannot move.
        if (!(limit > 0 && own > 0)) continue;
        // A point sticks where what would stop its slip is within the limit, else it slips along.
        const Eigen::Vector2d force = state.tangential_force().segment<2>(2 * i),
                              stopping = force + slip.segment<2>(2 * i) / own;
        const Eigen::Vector2d allowed = stopping.norm() > limit
                                            ? Eigen::Vector2d(limit / stopping.norm() * stopping)
                                            : stopping;
        violation += surface.copies * (force - allowed).norm();
      }
      // The limits are those of a pressure that still changes by that part of the load.
      EXPECT_LT(violation, settled * mu * contact().load) << mu << " " << angle;
    }
    EXPECT_GT(state.slip_fraction(), 0.5) << mu;
    EXPECT_LT(state.slip_fraction(), 1) << mu;
  }
}

TEST(FrictionalContact, KeepsItsLoadAndSlidesAgainstTheFullForce) {
  FrictionalContact state = contact().on(contact().whole);
  state.slide({1, 0, 0});
  const double force = contact().mu * contact().load;
  EXPECT_NEAR(state.normal_force().sum(), contact().load, round_off);
  EXPECT_NEAR(state.wrench().force_x, force, settled * force);
  FrictionalContact back = contact().on(contact().whole);
  back.slide({-1, 0, 0});
  EXPECT_NEAR(back.wrench().force_x, -force, settled * force);
}

/// An ellipsoidal fingertip on a plane, by a quarter, by halves and as a whole, on one mesh.
struct BentContact {
  explicit BentContact(MirrorPlanes planes, double radius_x = 8, double radius_y = 5) {
    Pressing pressing;
    pressing.load = load;
    pressing.poisson_ratio = 0.4;
    pressing.fingertip.pad = meshes::ellipsoid_pad(radius_x, radius_y);
    pressing.fingertip.object = meshes::plane_object();
    pressing.bent = shape_fingertip(pressing.fingertip, 1);
    LayerDiscretisation mesh;
    mesh.a = 1.3;
    mesh.b = 1.0;
    mesh.elements_per_semi_axis = 3;
    mesh.patch = 1.4;
    mesh.reach_x = pressing.bent.reach_x;
    mesh.reach_y = pressing.bent.reach_y;
    pressed = *press_on(
        std::make_shared<const LayerModel>(mesh, pressing.materials(), pressing.bent.shape, planes),
        pressing);
    quarters =
        std::make_unique<QuarterCompliances>(friction_compliances(start(), Invariance::none));
    surface = surface_compliance(*quarters, Invariance::none);
  }
  PressedContact start() const {
    return {*pressed.model, pressed.gap,          pressed.contact.force, 1.3, 1.0,
            load,           ShearLaw::coulomb(mu)};
  }
  FrictionalContact contact() const {
    Eigen::VectorXd gap(surface.size());
    for (Index i = 0; i < gap.size(); ++i)
      gap[i] = pressed.gap[surface.model_node[static_cast<std::size_t>(i)]];
    return {surface, gap, load, mu};
  }

  double load = 0.15, mu = 0.5;
  Pressed pressed;
  std::unique_ptr<QuarterCompliances> quarters;
  SurfaceCompliance surface;
};

TEST(BentFrictionalContact, IsTheSameByAQuarterByHalvesAndAsAWhole) {
  const BentContact whole(no_plane);
  for (const MirrorPlanes planes :
       {both_planes, MirrorPlanes{true, false}, MirrorPlanes{false, true}}) {
    const BentContact part(planes);
    ASSERT_EQ(part.surface.size(), whole.surface.size());
    EXPECT_NEAR(part.pressed.contact.approach / whole.pressed.contact.approach, 1, 1e-8);
    EXPECT_NEAR(part.pressed.torque_arm() / whole.pressed.torque_arm(), 1, 1e-8);
    EXPECT_NEAR(part.surface.area.sum() / whole.surface.area.sum(), 1, round_off);
    EXPECT_NEAR(stuck_torsional_stiffness(part.start(), *part.quarters) /
                    stuck_torsional_stiffness(whole.start(), *whole.quarters),
                1, 1e-8);
    FrictionalContact one = part.contact(), other = whole.contact();
    EXPECT_NEAR(one.approach() / part.pressed.contact.approach, 1, 1e-8)
        << "the composed compliance is the one that it was pressed on";
    const double force = part.mu * part.load;
    for (const PlaneMotion motion : {PlaneMotion{0.02, 0.01, 0.005}, PlaneMotion{0.1, 0.05, 0.3}}) {
      one.move_to(motion);
      other.move_to(motion);
      EXPECT_NEAR(one.wrench().force_x, other.wrench().force_x, settled * force);
      EXPECT_NEAR(one.wrench().force_y, other.wrench().force_y, settled * force);
      EXPECT_NEAR(one.wrench().torque, other.wrench().torque, settled * force);
    }
  }
}

TEST(BentFrictionalContact, HoldsMuPAndTheTorqueOfItsPressureAtFullSlip) {
  const BentContact bent(both_planes);
  FrictionalContact state = bent.contact();
  const double force = bent.mu * bent.load;
  for (const double angle : {0.0, 0.7, M_PI / 2}) {
    state.slide({std::cos(angle), std::sin(angle), 0});
    EXPECT_NEAR(std::hypot(state.wrench().force_x, state.wrench().force_y), force, settled * force);
  }
  state.slide({0, 0, 1});
  EXPECT_NEAR(state.wrench().torque, state.torque_of_pressure(), settled * force);
  EXPECT_NEAR(state.normal_force().sum(), bent.load, round_off);
}

TEST(BentFrictionalContact, OnASphereKnowsNoDirection) {
  const BentContact bent(no_plane, 6, 6);
  FrictionalContact along_x = bent.contact(), along_y = bent.contact();
  along_x.move_to({0.02, 0, 0});
  along_y.move_to({0, 0.02, 0});
  // The mesh's cells are oblong: as far as they know the contact's edge, a cell of a third.
  EXPECT_NEAR(along_y.wrench().force_y / along_x.wrench().force_x, 1, 0.02);
  EXPECT_NEAR(along_x.wrench().force_y, 0, settled * bent.mu * bent.load);
}

TEST(BentFrictionalContact, DissipatesAndStores) {
  const BentContact bent(both_planes);
  FrictionalContact state = bent.contact();
  double work = 0, dissipated = 0, turn = 0, torque = 0;
  Eigen::VectorXd slip = state.slip();
  for (const double angle : {0.01, 0.02, 0.04, 0.08, 0.04, 0.0, -0.04}) {
    state.move_to({0, 0, angle});
    work += 0.5 * (torque + state.wrench().torque) * (angle - turn);
    const double lost = state.tangential_force().dot(state.slip() - slip);
    EXPECT_GE(lost, -round_off);
    dissipated += lost;
    slip = state.slip();
    turn = angle;
    torque = state.wrench().torque;
  }
  EXPECT_GT(dissipated, 0);
  EXPECT_GT(work, 0);
  const Eigen::VectorXd& force = state.tangential_force();
  EXPECT_GT(force.dot(bent.surface.tangential * force), 0);
}

TEST(WriteCompliance, IsReadBackAsItWas) {
  const double h = 2e-3, E = 3e5;
  const auto path = std::filesystem::temp_directory_path() / "softfinger_compliance_test.bin";
  write_compliance(path, contact().half, h, E, 0.4);
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::getline(file, line);
  const auto header = nlohmann::json::parse(line);
  EXPECT_EQ(header.at("points"), contact().half.size());
  EXPECT_EQ(header.at("thickness_m"), h);
  EXPECT_EQ(header.at("byte_order"), "little");
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::map<std::string, RowMajor> arrays;
  for (const auto& array : header.at("arrays")) {
    RowMajor values(array.at("rows").get<Index>(), array.at("columns").get<Index>());
    file.read(reinterpret_cast<char*>(values.data()),
              static_cast<std::streamsize>(sizeof(double)) * values.size());
    arrays[array.at("name")] = values;
  }
  ASSERT_TRUE(file);
  EXPECT_EQ(file.get(), std::ifstream::traits_type::eof());
  const auto& surface = contact().half;
  const auto expect_equal = [](const Eigen::MatrixXd& read, const Eigen::MatrixXd& expected) {
    ASSERT_EQ(read.rows(), expected.rows());
    ASSERT_EQ(read.cols(), expected.cols());
    EXPECT_LE((read - expected).norm(), 1e-14 * expected.norm());
  };
  expect_equal(arrays.at("position_m"), h * surface.position.transpose());
  expect_equal(arrays.at("area_m2"), h * h * surface.area);
  expect_equal(arrays.at("normal_m_per_N"), surface.normal / (E * h));
  expect_equal(arrays.at("tangential_m_per_N"), surface.tangential / (E * h));
  expect_equal(arrays.at("normal_tangential_m_per_N"), surface.normal_tangential / (E * h));
  std::filesystem::remove(path);
}

TEST(WriteCompliance, RefusesAFolderThatCannotBeWritten) {
  EXPECT_THROW(write_compliance("/dev/null/compliance", contact().half, 1, 1, 0.4), InputError);
}

}  // namespace
}  // namespace softfinger::fem
