// Hyperelastic materials and the mixed element against closed forms and finite differences.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "fem/finite/element.h"
#include "fem/finite/material.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double round_off = 1e-14;  // a few dozen operations on numbers of order one

struct Sample {
  MaterialChoice choice;
  std::string name;
};

std::vector<Sample> samples() {
  std::vector<Sample> result;
  for (const VolumetricLaw law : {VolumetricLaw::quadratic, VolumetricLaw::logarithmic}) {
    const std::string suffix = name_of(law);
    result.push_back({{MaterialName::neo_hookean, law, 0, 0, 0}, "neo_hookean_" + suffix});
    result.push_back({{MaterialName::mooney_rivlin, law, 0.3, 0, 0}, "mooney_rivlin_" + suffix});
    result.push_back({{MaterialName::yeoh, law, 0, -0.02, 0.005}, "yeoh_" + suffix});
  }
  return result;
}

Matrix3d random_gradient(std::mt19937& generator, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  return Matrix3d::Identity() + Matrix3d::NullaryExpr([&] { return uniform(generator); });
}

Matrix3d rotation() {
  return Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
}

Matrix3d cauchy(const Material& material, const Matrix3d& gradient) {
  const Deformation deformation(gradient);
  return material.whole(deformation).stress * gradient.transpose() / deformation.volume_ratio;
}

class EachMaterial : public testing::TestWithParam<Sample> {
 protected:
  std::unique_ptr<const Material> make(double poisson_ratio = 0.4) const {
    return make_material(GetParam().choice, 1.0, poisson_ratio);
  }
};

TEST_P(EachMaterial, StressAndTangentAreTheEnergysDerivatives) {
  const auto material = make();
  std::mt19937 generator(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Matrix3d gradient = random_gradient(generator, 0.3);
    const Response response = material->whole(Deformation(gradient));
    // Central differences: step² of truncation (third derivatives of order 10 to 100 at this size
    // of strain) against eps / step of cancellation.
    constexpr double step = 1e-5, tolerance = 1e-7;
    for (int k = 0; k < 9; ++k) {
      Matrix3d change = Matrix3d::Zero();
      change.data()[k] = step;
      const Response more = material->whole(Deformation(gradient + change));
      const Response less = material->whole(Deformation(gradient - change));
      EXPECT_NEAR((more.energy - less.energy) / (2 * step), response.stress.data()[k], tolerance);
      const Matrix3d slope = (more.stress - less.stress) / (2 * step);
      for (int i = 0; i < 9; ++i)
        EXPECT_NEAR(slope.data()[i], response.tangent(i, k), tolerance) << i << " " << k;
    }
    EXPECT_LT((response.tangent - response.tangent.transpose()).norm(),
              round_off * response.tangent.norm());
  }
}

TEST_P(EachMaterial, VolumetricPressureAndModulusAreItsEnergysDerivatives) {
  const auto material = make();
  for (const double J : {0.6, 1.0, 1.5}) {
    constexpr double step = 1e-5, tolerance = 1e-8;
    const auto more = material->respond_to_volume(J + step);
    const auto less = material->respond_to_volume(J - step);
    EXPECT_NEAR((more.energy - less.energy) / (2 * step), material->respond_to_volume(J).pressure,
                tolerance);
    EXPECT_NEAR((more.pressure - less.pressure) / (2 * step),
                material->respond_to_volume(J).modulus, tolerance);
  }
}

TEST_P(EachMaterial, IsObjectiveAndIsotropic) {
  const auto material = make();
  std::mt19937 generator(2);
  const Matrix3d Q = rotation();
  const Matrix3d gradient = random_gradient(generator, 0.3);
  const Response response = material->whole(Deformation(gradient));
  const Response turned = material->whole(Deformation(Q * gradient));
  const Response before = material->whole(Deformation(gradient * Q));
  EXPECT_NEAR(turned.energy, response.energy, round_off);
  EXPECT_LT((turned.stress - Q * response.stress).norm(), 10 * round_off);
  EXPECT_NEAR(before.energy, response.energy, round_off);
  EXPECT_LT((before.stress - response.stress * Q).norm(), 10 * round_off);
}

TEST_P(EachMaterial, IsHookesLawForSmallStrain) {
  const double nu = 0.4, G = 0.5 / (1 + nu), lambda = nu / ((1 + nu) * (1 - 2 * nu));
  const auto material = make(nu);
  const Response rest = material->whole(Deformation(Matrix3d::Identity()));
  EXPECT_NEAR(rest.energy, 0, round_off);
  EXPECT_LT(rest.stress.norm(), round_off);
  for (int k = 0; k < 9; ++k) {
    Matrix3d change = Matrix3d::Zero();
    change.data()[k] = 1;
    const Matrix3d stress =
        G * (change + change.transpose()) + lambda * change.trace() * Matrix3d::Identity();
    EXPECT_LT((rest.tangent.col(k) - as_vector(stress)).norm(), 10 * round_off);
  }
}

TEST_P(EachMaterial, DiffersFromHookesLawAtSecondOrder) {
  const double nu = 0.4, G = 0.5 / (1 + nu), lambda = nu / ((1 + nu) * (1 - 2 * nu));
  const auto material = make(nu);
  std::mt19937 generator(3);
  Matrix3d strain = random_gradient(generator, 1) - Matrix3d::Identity();
  strain = 0.5 * (strain + strain.transpose()).eval();
  const auto difference = [&](double size) {
    const Matrix3d small = size * strain;
    const Matrix3d stress = 2 * G * small + lambda * small.trace() * Matrix3d::Identity();
    return (cauchy(*material, Matrix3d::Identity() + small) - stress).norm();
  };
  // Halved, the difference is a quarter, but for the third order: of the size of the strain.
  EXPECT_NEAR(difference(2e-3) / difference(1e-3), 4, 4 * 2e-2);
}

INSTANTIATE_TEST_SUITE_P(Materials, EachMaterial, testing::ValuesIn(samples()),
                         [](const auto& test) { return test.param.name; });

TEST(NeoHookean, TwoEnergiesAgreeToFirstOrderInStress) {
  // Their Cauchy stresses differ by the square of the strain: a quarter when it is halved.
  const auto quadratic = make_material({}, 1.0, 0.3);
  const auto logarithmic =
      make_material({MaterialName::neo_hookean, VolumetricLaw::logarithmic, 0, 0, 0}, 1.0, 0.3);
  const auto difference = [&](double strain) {
    const Matrix3d gradient = Vector3d(1 + strain, 1 - 0.4 * strain, 1 + 0.2 * strain).asDiagonal();
    return (cauchy(*quadratic, gradient) - cauchy(*logarithmic, gradient)).norm();
  };
  EXPECT_NEAR(difference(2e-3) / difference(1e-3), 4, 4 * 2e-2);
}

// Closed forms: Holzapfel, Nonlinear Solid Mechanics, 2000, section 6.5, or by hand from W.
constexpr double kNu = 0.4;
const double kShear = 0.5 / (1 + kNu), kBulk = 1 / (3 * (1 - 2 * kNu));

TEST(NeoHookean, ConfinedCompressionHasItsClosedForm) {
  for (const double l : {0.6, 0.9, 1.3}) {
    const Matrix3d gradient = Vector3d(1, 1, l).asDiagonal();
    const auto quadratic = make_material({}, 1.0, kNu);
    EXPECT_NEAR(cauchy(*quadratic, gradient)(2, 2),
                2.0 / 3 * kShear * std::pow(l, -5.0 / 3) * (l * l - 1) + kBulk * (l - 1),
                10 * round_off);
    const auto logarithmic =
        make_material({MaterialName::neo_hookean, VolumetricLaw::logarithmic, 0, 0, 0}, 1.0, kNu);
    EXPECT_NEAR(cauchy(*logarithmic, gradient)(2, 2),
                (kShear * (l * l - 1) + (kBulk - 2 * kShear / 3) * std::log(l)) / l,
                10 * round_off);
  }
}

/// Stress differences in a stretch (l, l^-1/2, l^-1/2) of constant volume, which no U changes.
double uniaxial_difference(const Material& material, double l) {
  const Matrix3d stress =
      cauchy(material, Matrix3d(Vector3d(l, 1 / std::sqrt(l), 1 / std::sqrt(l)).asDiagonal()));
  return stress(0, 0) - stress(1, 1);
}

TEST(Materials, UniaxialStretchHasItsClosedForm) {
  constexpr double share = 0.3, second = 0.1, third = 0.02, c1 = 0.5;
  for (const double l : {0.5, 0.8, 1.5, 2.0}) {
    const double stretch = l * l - 1 / l, x = l * l + 2 / l - 3;
    EXPECT_NEAR(uniaxial_difference(*make_material({}, 1.0, kNu), l), kShear * stretch,
                10 * round_off);
    EXPECT_NEAR(uniaxial_difference(*make_material({MaterialName::mooney_rivlin,
                                                    VolumetricLaw::quadratic, share, 0, 0},
                                                   1.0, kNu),
                                    l),
                2 * c1 * kShear * stretch * (1 - share + share / l), 10 * round_off);
    EXPECT_NEAR(uniaxial_difference(
                    *make_material({MaterialName::yeoh, VolumetricLaw::quadratic, 0, second, third},
                                   1.0, kNu),
                    l),
                2 * c1 * kShear * stretch * (1 + 2 * second * x + 3 * third * x * x),
                20 * round_off);
  }
}

TEST(Materials, SimpleShearHasItsClosedForm) {
  constexpr double share = 0.3, second = 0.1, third = 0.02, g = 0.7;
  Matrix3d gradient = Matrix3d::Identity();
  gradient(0, 1) = g;
  const Matrix3d neo = cauchy(*make_material({}, 1.0, kNu), gradient);
  EXPECT_NEAR(neo(0, 1), kShear * g, round_off);
  EXPECT_NEAR(neo(0, 0) - neo(1, 1), kShear * g * g, round_off);
  EXPECT_NEAR(neo(1, 1) - neo(2, 2), 0, round_off);
  const Matrix3d mooney =
      cauchy(*make_material({MaterialName::mooney_rivlin, VolumetricLaw::quadratic, share, 0, 0},
                            1.0, kNu),
             gradient);
  EXPECT_NEAR(mooney(0, 1), kShear * g, round_off);
  EXPECT_NEAR(mooney(0, 0) - mooney(2, 2), (1 - share) * kShear * g * g, round_off);
  EXPECT_NEAR(mooney(1, 1) - mooney(2, 2), -share * kShear * g * g, round_off);
  const Matrix3d yeoh = cauchy(
      *make_material({MaterialName::yeoh, VolumetricLaw::quadratic, 0, second, third}, 1.0, kNu),
      gradient);
  EXPECT_NEAR(yeoh(0, 1), kShear * g * (1 + 2 * second * g * g + 3 * third * std::pow(g, 4)),
              round_off);
}

TEST(Materials, ParametersOfNoStableMaterialAreRefused) {
  const auto message = [](const MaterialChoice& choice) -> std::string {
    try {
      make_material(choice, 1.0, kNu);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message({MaterialName::mooney_rivlin, VolumetricLaw::quadratic, 1.4, 0, 0})
                .find("c01/(c10 + c01) = 1.4"),
            std::string::npos);
  EXPECT_NE(
      message({MaterialName::yeoh, VolumetricLaw::quadratic, 0, -0.3, 0}).find("a stretch of"),
      std::string::npos);
  // Yeoh's own carbon-black rubber: the softening of c20 < 0 is made up for by c30 > 0.
  EXPECT_EQ(message({MaterialName::yeoh, VolumetricLaw::quadratic, 0, -0.03, 0.003}), "");
}

/// A quadratic hexahedron over the unit cube, with 3 x 3 x 3 Gauss points.
ElementGeometry unit_cube() {
  const double offset = std::sqrt(0.15);
  const double place[] = {0.5 - offset, 0.5, 0.5 + offset}, weight[] = {5. / 18, 8. / 18, 5. / 18};
  const auto value = [](int k, double t) {
    const double values[] = {(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)};
    return values[k];
  };
  const auto slope = [](int k, double t) {
    const double slopes[] = {4 * t - 3, 4 - 8 * t, 4 * t - 1};
    return slopes[k];
  };
  ElementGeometry geometry;
  Eigen::MatrixXd gradients(27, 81);
  geometry.weight.resize(27);
  geometry.linear.resize(4, 27);
  for (int p = 0; p < 27; ++p) {
    const double x = place[p % 3], y = place[p / 3 % 3], z = place[p / 9];
    geometry.weight[p] = weight[p % 3] * weight[p / 3 % 3] * weight[p / 9];
    geometry.linear.col(p) << 1, x - 0.5, y - 0.5, z - 0.5;
    for (int n = 0; n < 27; ++n) {
      const int i = n % 3, j = n / 3 % 3, k = n / 9;
      gradients.row(n).segment<3>(3 * p) << slope(i, x) * value(j, y) * value(k, z),
          value(i, x) * slope(j, y) * value(k, z), value(i, x) * value(j, y) * slope(k, z);
    }
  }
  geometry.unit_gradients = std::make_shared<const Eigen::MatrixXd>(std::move(gradients));
  geometry.to_unit = Matrix3d::Identity().replicate(1, 27);
  geometry.set_mass();
  return geometry;
}

/// The cube sheared and stretched. Deformations of it are of the same material points.
ElementGeometry oblique() {
  ElementGeometry geometry = unit_cube();
  Matrix3d to_unit;
  to_unit << 0.8, 0.3, 0, 0.1, 1.2, -0.2, 0, 0.4, 1;
  geometry.to_unit = to_unit.replicate(1, 27);
  geometry.weight /= to_unit.determinant();
  geometry.set_mass();
  return geometry;
}

Eigen::MatrixX3d unit_gradient(const ElementGeometry& geometry, const Eigen::VectorXd& field) {
  return geometry.unit_gradients->transpose() * field.reshaped(27, 3);
}

ElementLinearisation linearised(const ElementGeometry& geometry, const Material& material,
                                const ElementState& state, const Eigen::VectorXd& displacement) {
  return linearise(geometry, material, state, unit_gradient(geometry, displacement));
}

/// Displacements of the nodes for an affine deformation.
Eigen::VectorXd affine(const Matrix3d& gradient) {
  Eigen::VectorXd result(81);
  for (int n = 0; n < 27; ++n) {
    const Vector3d at(0.5 * (n % 3), 0.5 * (n / 3 % 3), 0.5 * (n / 9));
    const Vector3d moved = gradient * at - at;
    for (int c = 0; c < 3; ++c) result[27 * c + n] = moved[c];
  }
  return result;
}

TEST(Element, LinearisationIsItsForcesDerivativeAlongNewtonsStep) {
  const ElementGeometry geometry = oblique();
  std::srand(4);
  for (const Sample& sample : samples()) {
    const auto material = make_material(sample.choice, 1.0, 0.45);
    const Eigen::VectorXd displacement = 0.05 * Eigen::VectorXd::Random(81);
    const Eigen::VectorXd step = Eigen::VectorXd::Random(81);
    ElementState state;
    state.pressure = 0.2 * Eigen::Vector4d::Random();
    state.volume_ratio = Eigen::Vector4d(1.05, 0.03, -0.02, 0.04);
    const ElementLinearisation linear = linearised(geometry, *material, state, displacement);
    // Along the step, with the pressure and volume ratio that go with it.
    const auto force = [&](double fraction) {
      const ElementState there =
          advance(geometry, linear, state, unit_gradient(geometry, step), fraction).state;
      return linearised(geometry, *material, there, displacement + fraction * step).force;
    };
    constexpr double small = 1e-5;
    const Eigen::VectorXd slope = (force(small) - force(-small)) / (2 * small);
    const Eigen::VectorXd expected = linear.stiffness * step + linear.residual - linear.force;
    // Truncation small² x third derivatives of order 1e2.
    EXPECT_LT((slope - expected).norm(), 1e-7 * expected.norm()) << sample.name;
    EXPECT_LT((linear.stiffness - linear.stiffness.transpose()).norm(),
              round_off * linear.stiffness.norm());
  }
}

TEST(Element, IsTheSameWithoutItsStiffness) {
  const ElementGeometry geometry = oblique();
  std::srand(6);
  for (const Sample& sample : samples()) {
    const auto material = make_material(sample.choice, 1.0, 0.45);
    const Eigen::VectorXd displacement = 0.05 * Eigen::VectorXd::Random(81);
    ElementState state;
    state.pressure = 0.2 * Eigen::Vector4d::Random();
    const auto all = linearised(geometry, *material, state, displacement);
    Eigen::MatrixX3d stress(81, 3);
    const auto some =
        balance(geometry, *material, state, unit_gradient(geometry, displacement), stress);
    const Eigen::MatrixX3d residual = *geometry.unit_gradients * stress;
    EXPECT_LT((residual.reshaped() - all.residual).norm(), round_off * all.residual.norm())
        << sample.name;
    EXPECT_EQ(some.deformation, all.deformation);
    EXPECT_LT((some.volume_mismatch - all.volume_mismatch).norm(), round_off);
    EXPECT_LT((some.pressure_mismatch - all.pressure_mismatch).norm(), round_off);
    EXPECT_LT((some.bulk - all.bulk).norm(), round_off * all.bulk.norm());
  }
}

TEST(Element, StiffnessInSinglePrecisionDiffersByItsRoundOffAndNothingElseDoes) {
  const ElementGeometry geometry = oblique();
  std::srand(8);
  const auto material = make_material(samples().front().choice, 1.0, 0.45);
  const Eigen::MatrixX3d displacement = unit_gradient(geometry, 0.05 * Eigen::VectorXd::Random(81));
  const auto full = linearise(geometry, *material, ElementState(), displacement);
  const auto single =
      linearise(geometry, *material, ElementState(), displacement, Precision::single);
  const double change = (single.stiffness - full.stiffness).norm() / full.stiffness.norm();
  EXPECT_LT(change, std::numeric_limits<float>::epsilon());
  EXPECT_GT(change, 0);
  EXPECT_EQ(single.residual, full.residual);
}

TEST(Element, SmallestVolumeRatioOfAStepIsThatOfWhereItLeads) {
  const ElementGeometry geometry = oblique();
  std::srand(7);
  const auto material = make_material(samples().front().choice, 1.0, 0.45);
  const Eigen::VectorXd displacement = 0.05 * Eigen::VectorXd::Random(81);
  const Eigen::VectorXd step = 0.05 * Eigen::VectorXd::Random(81);
  const ElementState state;
  const auto linear = linearised(geometry, *material, state, displacement);
  for (const double fraction : {0.5, 1.0}) {
    const ElementAdvance advanced =
        advance(geometry, linear, state, unit_gradient(geometry, step), fraction);
    EXPECT_NEAR(advanced.smallest_volume_ratio,
                smallest_volume_ratio(geometry, advanced.state,
                                      unit_gradient(geometry, displacement + fraction * step)),
                1e2 * round_off);
    EXPECT_LT(advanced.smallest_volume_ratio, 1);
  }
}

TEST(Element, HomogeneousStateHasTheMaterialsOwnStress) {
  const ElementGeometry geometry = unit_cube();
  std::mt19937 generator(5);
  const Matrix3d gradient = random_gradient(generator, 0.2);
  const Deformation deformation(gradient);
  for (const Sample& sample : samples()) {
    const auto material = make_material(sample.choice, 1.0, 0.45);
    ElementState state;
    state.volume_ratio[0] = deformation.volume_ratio;
    state.pressure[0] = material->respond_to_volume(deformation.volume_ratio).pressure;
    const auto linear = linearised(geometry, *material, state, affine(gradient));
    EXPECT_LT(linear.volume_mismatch.norm() + linear.pressure_mismatch.norm(), 1e3 * round_off);
    const Matrix3d stress = material->whole(deformation).stress;
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(81);
    for (int p = 0; p < 27; ++p)
      for (int c = 0; c < 3; ++c)
        expected.segment(27 * c, 27) += geometry.weight[p] *
                                        geometry.gradients().middleCols<3>(3 * p) *
                                        stress.row(c).transpose();
    EXPECT_LT((linear.force - expected).norm(), 1e3 * round_off) << sample.name;
    EXPECT_NEAR(
        strain_energy(geometry, *material, state, unit_gradient(geometry, affine(gradient))),
        material->whole(deformation).energy, 1e2 * round_off);
  }
}

TEST(Element, RigidRotationMakesNoForce) {
  const ElementGeometry geometry = unit_cube();
  for (const Sample& sample : samples()) {
    const auto material = make_material(sample.choice, 1.0, 0.499);
    const auto linear = linearised(geometry, *material, ElementState(), affine(rotation()));
    // 1/(1 - 2 nu) magnifies the round-off of det F.
    EXPECT_LT(linear.residual.norm(), 1e5 * round_off) << sample.name;
  }
}

}  // namespace
}  // namespace softfinger::fem::finite
