// Flat pads against exact limits, series, other outlines and finite elements.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pads/pad_error.h"
#include "softfinger/pads/pad_model.h"
#include "tests/allocation_counter.h"

namespace softfinger {
namespace {

using Eigen::Vector2d;

const PadModel& layer_model() { return *find_pad_model("pad_layer"); }

PadProblem pressed_pad(const PadShape& shape, double thickness_m, double poisson_ratio,
                       PadPressing pressing = PadPressing::stuck) {
  PadProblem problem;
  problem.shape = &shape;
  problem.layer = {thickness_m, 5e5, poisson_ratio};
  problem.load = {1, 0.8};
  problem.pressing = pressing;
  return problem;
}

/// Modified Bessel function by its series.
double bessel_i(int order, double z) {
  double sum = 0, term = std::pow(z / 2, order) / std::tgamma(order + 1.0);
  for (int k = 1; term > 1e-17 * sum; ++k) {
    sum += term;
    term *= z * z / 4 / (k * double(k + order));
  }
  return sum;
}

double sum_of(const PadShape::Sums& sums, const PadShape::Row& row, double k2) {
  double sum = 0;
  for (std::size_t i = 0; i < row.size(); ++i) sum += row[i] / (k2 + sums.stiffness_per_m2[i]);
  return sum;
}

double uniform_arm_m(const ConvexOutline& outline) {
  return outline.radius_integral_m3(outline.centroid_m()) / outline.area_m2();
}

/// Stiffness over that of a column.
double stiffness_ratio(const PadProblem& problem) {
  const PadPrediction prediction = layer_model().predict(problem);
  return prediction.normal_stiffness_N_per_m * problem.layer.thickness_m /
         (problem.layer.youngs_modulus_Pa * problem.shape->outline().area_m2());
}

}  // namespace

TEST(ConvexOutline, KnowsTheMomentsOfDiscAndRectangle) {
  // The 40-gon of the same area: its second moment and arm differ by (pi/40)^4.
  const ConvexOutline disc = ConvexOutline::disc(2);
  EXPECT_NEAR(disc.area_m2(), kPi, 1e-12);
  EXPECT_NEAR(uniform_arm_m(disc), 2. / 3, 1e-5);
  EXPECT_NEAR(disc.second_moments_m4()(0, 0), kPi / 4, 1e-4);
  EXPECT_NEAR(disc.largest_width_m(), 2, 0.01);
  const ConvexOutline square = ConvexOutline::rounded_rectangle(2, 2);
  // (sqrt 2 + asinh 1)/3 times the half side.
  EXPECT_NEAR(uniform_arm_m(square), (std::sqrt(2) + std::asinh(1)) / 3, 1e-14);
  EXPECT_NEAR(square.second_moments_m4()(1, 1), 4. / 3, 1e-14);
  const ConvexOutline rounded = ConvexOutline::rounded_rectangle(3, 2, 0.5);
  EXPECT_NEAR(rounded.area_m2(), 6 - (4 - kPi) * 0.25, 1e-12);
  EXPECT_NEAR(rounded.extent_m().x(), 3, 1e-12);
}

TEST(ConvexOutline, ForgetsOrderDirectionAndStraightPoints) {
  const ConvexOutline one = ConvexOutline::polygon({{0, 0}, {2, 0}, {2, 1}, {0, 1}});
  const ConvexOutline other =
      ConvexOutline::polygon({{2, 1}, {2, 0.5}, {2, 0}, {1, 0}, {0, 0}, {0, 0}, {0, 1}});
  EXPECT_EQ(other.vertices_m().size(), 4u);
  EXPECT_NEAR(one.area_m2(), other.area_m2(), 1e-15);
  EXPECT_NEAR((one.centroid_m() - other.centroid_m()).norm(), 0, 1e-15);
  EXPECT_NEAR(uniform_arm_m(one), uniform_arm_m(other), 1e-15);
}

TEST(ConvexOutline, RefusesWhatIsNotConvex) {
  const std::vector<std::vector<Vector2d>> wrong = {
      {},
      {{0, 0}, {1, 0}},
      {{0, 0}, {1, 0}, {2, 0}},
      {{0, 0}, {2, 0}, {0, 2}, {2, 2}},  // crosses itself
      {{0, 0}, {4, 0}, {1, 1}, {0, 4}},  // hollow
      {{0, 0}, {1, 0}, {std::nan(""), 1}},
      {{1, 0}, {-0.8, 0.6}, {0.3, -1}, {0.3, 1}, {-0.8, -0.6}}};  // a star runs around twice
  for (const auto& points : wrong) EXPECT_THROW(ConvexOutline::polygon(points), InputError);
  EXPECT_THROW(ConvexOutline::rounded_rectangle(2, 1, 0.6), InputError);
}

TEST(ConvexOutline, IntersectsAndShrinks) {
  const ConvexOutline square = ConvexOutline::rounded_rectangle(2, 2);
  const auto common = square.common_with(square.moved(0, {1.5, 0}));
  ASSERT_TRUE(common);
  EXPECT_NEAR(common->area_m2(), 1, 1e-14);
  EXPECT_NEAR(common->centroid_m().x(), 0.75, 1e-14);
  const auto octagon = square.common_with(square.moved(kPi / 4, {0, 0}));
  EXPECT_EQ(octagon->vertices_m().size(), 8u);
  EXPECT_FALSE(square.common_with(square.moved(0, {2.1, 0})));
  EXPECT_FALSE(square.common_with(square.moved(0, {2, 0}))) << "they touch in a line";
  EXPECT_NEAR(square.shrunk(0.25)->area_m2(), 1.5 * 1.5, 1e-14);
  EXPECT_FALSE(square.shrunk(1.1));
}

TEST(PadShape, AgreesWithBesselFunctionsAndSeries) {
  const PadShape disc(ConvexOutline::disc(2));
  const PadShape::Sums& sums = disc.sums(PadShape::constant);
  const PadShape::Sums& tilted = disc.sums(PadShape::linear_x);
  for (const double z : {0.1, 1., 3., 10., 30.}) {
    const double mean = (1 - 2 * bessel_i(1, z) / (z * bessel_i(0, z))) / (z * z);
    EXPECT_NEAR(sum_of(sums, sums.integral, z * z) / kPi / mean, 1, 3e-4) << z;
    const double moment = (1 - 4 * bessel_i(2, z) / (z * bessel_i(1, z))) / (z * z);
    EXPECT_NEAR(sum_of(tilted, tilted.moment_x, z * z) / (kPi / 4) / moment, 1, 4e-4) << z;
  }
  for (const double length : {1., 2., 10.}) {
    const double a = length / 2, b = 0.5;
    const PadShape shape(ConvexOutline::rounded_rectangle(length, 1));
    const PadShape::Sums& rectangle = shape.sums(PadShape::constant);
    for (const double k : {0.3, 3., 10., 30.}) {
      double mean = (1 - std::tanh(k * b) / (k * b)) / (k * k);
      for (int n = 0; n < 2000; ++n) {
        const double beta = (n + 0.5) * kPi / b, g = std::hypot(k, beta);
        mean -= 2 * std::tanh(g * a) / (b * b * beta * beta * g * g * g * a);
      }
      EXPECT_NEAR(sum_of(rectangle, rectangle.integral, k * k) / length / mean, 1, 2e-3)
          << length << " " << k;
    }
  }
}

TEST(PadShape, FindsTheTorsionConstantOfTheSquare) {
  // Timoshenko and Goodier: 0.1406 (2 a)^4.
  EXPECT_NEAR(PadShape(ConvexOutline::rounded_rectangle(1, 1)).torsion_constant_m4(), 0.1406, 1e-4);
  // 40-gon
  EXPECT_NEAR(PadShape(ConvexOutline::disc(2)).torsion_constant_m4(), kPi / 2, 5e-4);
}

TEST(PadModel, IsUniformAtPoissonRatioZero) {
  for (const ConvexOutline& outline :
       {ConvexOutline::disc(0.02), ConvexOutline::rounded_rectangle(0.03, 0.01, 0.002)}) {
    const PadShape shape(outline);
    for (const double thickness_m : {0.001, 0.005, 0.02}) {
      const PadProblem problem = pressed_pad(shape, thickness_m, 0);
      const PadPrediction p = layer_model().predict(problem);
      ASSERT_TRUE(p.has_answer);
      EXPECT_NEAR(p.eccentricity_m / uniform_arm_m(outline), 1, 1e-12);
      EXPECT_NEAR(stiffness_ratio(problem), 1, 1e-12);
      EXPECT_NEAR(p.peak_pressure_Pa * outline.area_m2(), 1, 1e-12);
    }
  }
}

TEST(PadModel, ReachesTheLimitsOfThinIncompressiblePads) {
  // R/h = 400: the corrections, a tenth of the thickness, are below one per cent.
  const PadShape shape(ConvexOutline::disc(0.02));
  const PadProblem problem = pressed_pad(shape, 0.01 / 400, 0.5);
  const PadPrediction p = layer_model().predict(problem);
  ASSERT_TRUE(p.has_answer);
  EXPECT_NEAR(p.eccentricity_m / 0.01, 8. / 15, 0.01);
  const double shape_factor = 200;
  EXPECT_NEAR(stiffness_ratio(problem) / (1 + 2 * shape_factor * shape_factor), 1, 0.02);
  // Just below 1/2 the answer is the same.
  const PadProblem near = pressed_pad(shape, 0.01 / 4, 0.5 - 1e-9);
  const PadProblem at = pressed_pad(shape, 0.01 / 4, 0.5);
  EXPECT_NEAR(stiffness_ratio(near) / stiffness_ratio(at), 1, 1e-5);
}

TEST(PadModel, ReachesTheConfinedModulusOfThinCompressiblePads) {
  const PadShape shape(ConvexOutline::disc(0.02));
  const PadProblem problem = pressed_pad(shape, 0.01 / 2000, 0.3);
  EXPECT_NEAR(stiffness_ratio(problem),
              problem.layer.oedometric_modulus_Pa() / problem.layer.youngs_modulus_Pa, 0.01);
}

TEST(PadModel, HalvesAFrictionlessPad) {
  // The mirror image is the other half of a stuck pad of twice the thickness.
  const PadShape shape(ConvexOutline::rounded_rectangle(0.03, 0.02, 0.002));
  const PadPrediction half =
      layer_model().predict(pressed_pad(shape, 0.004, 0.49, PadPressing::frictionless));
  const PadPrediction whole = layer_model().predict(pressed_pad(shape, 0.008, 0.49));
  EXPECT_NEAR(half.normal_stiffness_N_per_m / whole.normal_stiffness_N_per_m, 2, 1e-12);
  EXPECT_NEAR(half.tilt_stiffness_Nm_per_rad[0] / whole.tilt_stiffness_Nm_per_rad[0], 2, 1e-12);
}

TEST(PadModel, DoesNotDependOnUnitsPlaceAndTurn) {
  const ConvexOutline outline =
      ConvexOutline::polygon({{0, 0}, {0.03, 0}, {0.03, 0.01}, {0.02, 0.02}, {0, 0.02}});
  const PadShape shape(outline), turned(outline.moved(1.1, {7, -3}));
  const PadPrediction p = layer_model().predict(pressed_pad(shape, 0.003, 0.48));
  const PadPrediction q = layer_model().predict(pressed_pad(turned, 0.003, 0.48));
  // The rays of the elements are the same, only turned.
  EXPECT_NEAR(q.eccentricity_m / p.eccentricity_m, 1, 1e-9);
  EXPECT_NEAR(q.indentation_m / p.indentation_m, 1, 1e-9);
  EXPECT_NEAR(q.torsional_stiffness_Nm_per_rad / p.torsional_stiffness_Nm_per_rad, 1, 1e-9);
  const PadShape larger(ConvexOutline::polygon({{0, 0}, {30, 0}, {30, 10}, {20, 20}, {0, 20}}));
  PadProblem scaled = pressed_pad(larger, 3, 0.48);
  scaled.layer.youngs_modulus_Pa *= 1e3;
  scaled.load.normal_force_N = 7;
  const PadPrediction s = layer_model().predict(scaled);
  EXPECT_NEAR(s.eccentricity_m / p.eccentricity_m, 1e3, 1e-6);
  EXPECT_NEAR(s.normal_stiffness_N_per_m / p.normal_stiffness_N_per_m, 1e6, 1e-3);
  EXPECT_NEAR(s.peak_pressure_Pa / p.peak_pressure_Pa, 7e-6, 1e-12);
}

TEST(PadModel, CarriesItsOwnPressure) {
  // Over the samples the pressure at points has the load, the centre and the arm that are stated.
  const PadShape shape(ConvexOutline::polygon({{0, 0}, {0.03, 0}, {0.02, 0.02}, {0, 0.02}}));
  for (const bool is_eccentric : {false, true})
    for (const double nu : {0.3, 0.49}) {
      PadProblem problem = pressed_pad(shape, 0.004, nu);
      if (is_eccentric)
        problem.load_at_m = shape.outline().centroid_m() + Vector2d(0.0008, -0.0005);
      const PadPrediction p = layer_model().predict(problem);
      ASSERT_TRUE(p.valid());
      double force = 0, radius = 0;
      const Vector2d centre(p.centre_x_m, p.centre_y_m);
      Vector2d moment = Vector2d::Zero();
      for (std::size_t i = 0; i < shape.samples().points_m.size(); ++i) {
        const Vector2d point = shape.outline().centroid_m() + shape.samples().points_m[i];
        const double part = shape.samples().areas_m2[i] * layer_model().pressure_Pa(problem, point);
        force += part;
        moment += part * point;
        radius += part * (point - centre).norm();
      }
      EXPECT_NEAR(force, 1, 1e-3);
      EXPECT_NEAR((moment / force - centre).norm(), 0, 1e-5);
      EXPECT_NEAR(radius / force / p.pressure_arm_m, 1, 1e-3);
      EXPECT_EQ(layer_model().pressure_Pa(problem, {0.031, 0}), 0);
      // The largest torque is that of the same surface, sampled.
      const SampledPressure surface(layer_model().slipping_pressure(problem), 0.8);
      EXPECT_NEAR(surface.eccentricity_m() / p.eccentricity_m, 1, 1e-3);
    }
}

TEST(PadModel, LiftsOffAtItsStatedLimit) {
  const PadShape shape(ConvexOutline::rounded_rectangle(0.03, 0.02));
  PadProblem problem = pressed_pad(shape, 0.004, 0.45);
  const PadPrediction p = layer_model().predict(problem);
  problem.load_at_m = Vector2d(0.999 * p.tilt_limit_Nm[1], 0);
  EXPECT_NEAR(layer_model().predict(problem).tilt_utilisation, 0.999, 1e-9);
  problem.load_at_m = Vector2d(1.001 * p.tilt_limit_Nm[1], 0);
  EXPECT_NEAR(layer_model().predict(problem).tilt_utilisation, 1.001, 1e-9);
  problem.load_at_m = Vector2d(0, 0.5 * p.tilt_limit_Nm[0]);
  const PadPrediction tilted = layer_model().predict(problem);
  EXPECT_TRUE(tilted.valid());
  EXPECT_EQ(tilted.lifted_share, 0);
  EXPECT_NEAR(tilted.tilt_rad[0] * p.tilt_stiffness_Nm_per_rad[0], 0.5 * p.tilt_limit_Nm[0],
              1e-9 * p.tilt_limit_Nm[0]);
}

TEST(PadModel, LiftsOffAsColumnsDo) {
  // Columns (nu = 0) under a load at e beyond a sixth of the length: a wedge of pressure on the
  // last 3 (L/2 - e), from 0 to 2 P/(3 (L/2 - e) w) at the end.
  const double length = 0.03, width = 0.02, thickness = 0.004;
  const PadShape shape(ConvexOutline::rounded_rectangle(length, width));
  for (const double share : {0.4, 0.5, 0.6}) {
    PadProblem problem = pressed_pad(shape, thickness, 0);
    const double place = share * length / 2, touching = 3 * (length / 2 - place);
    problem.load_at_m = Vector2d(place, 0);
    const PadPrediction p = layer_model().predict(problem);
    ASSERT_TRUE(p.valid());
    EXPECT_NEAR(p.lifted_share, 1 - touching / length, 0.02);
    const double end_Pa = 2 / (touching * width);
    const double depth_m = end_Pa * thickness / problem.layer.youngs_modulus_Pa;
    EXPECT_NEAR(p.tilt_rad[1] * touching / depth_m, 1, 0.01);
    EXPECT_NEAR((p.indentation_m + p.tilt_rad[1] * length / 2) / depth_m, 1, 0.005);
    double arm = 0;  // by midpoints
    constexpr int kParts = 400;
    for (int i = 0; i < kParts; ++i)
      for (int j = 0; j < kParts; ++j) {
        const double from_edge = touching * (i + 0.5) / kParts;
        const double x = length / 2 - touching + from_edge - place;
        const double y = width * ((j + 0.5) / kParts - 0.5);
        arm += 2 * from_edge / touching / (kParts * kParts) * std::hypot(x, y);
      }
    EXPECT_NEAR(p.eccentricity_m / arm, 1, 0.003);
  }
}

TEST(PadModel, KeepsItsBoundsWhereTheRimHasLiftedOff) {
  // Frictionless finite elements with contact (level 1) of eccentric loads of 2 N.
  struct Row {
    double length_m, width_m, thickness_m, nu;
    Vector2d at_m;
    double arm_m, indentation_m, lifted;
  };
  for (const Row& row :
       {Row{22e-3, 37.5e-3, 2e-3, 0.3, {0.000e-3, 10.312e-3}, 7.891e-3, 9.6257e-6, 0.297},
        {22e-3, 37.5e-3, 2e-3, 0.49, {3.080e-3, 5.250e-3}, 8.4196e-3, 2.2444e-6, 0.217},
        {22e-3, 37.5e-3, 5e-3, 0.45, {4.235e-3, 7.219e-3}, 8.2149e-3, 20.401e-6, 0.367},
        {22e-3, 37.5e-3, 9e-3, 0.45, {4.400e-3, 0.000e-3}, 10.061e-3, 31.563e-6, 0.178},
        {17e-3, 17e-3, 2e-3, 0.3, {4.675e-3, 0.000e-3}, 5.003e-3, 28.799e-6, 0.297},
        {17e-3, 17e-3, 2e-3, 0.49, {0.000e-3, 3.400e-3}, 4.7827e-3, 10.084e-6, 0.252},
        {17e-3, 17e-3, 5e-3, 0.45, {0.000e-3, 4.675e-3}, 4.838e-3, 68.234e-6, 0.297},
        {17e-3, 17e-3, 9e-3, 0.3, {2.380e-3, 2.380e-3}, 5.5454e-3, 109.11e-6, 0.138},
        {17e-3, 17e-3, 9e-3, 0.49, {3.273e-3, 3.273e-3}, 4.9088e-3, 131.66e-6, 0.349},
        {10e-3, 40e-3, 2e-3, 0.49, {2.000e-3, 0.000e-3}, 9.5857e-3, 8.5061e-6, 0.244},
        {10e-3, 40e-3, 5e-3, 0.45, {2.750e-3, 0.000e-3}, 9.7594e-3, 47.024e-6, 0.327},
        {10e-3, 40e-3, 9e-3, 0.3, {0.000e-3, 8.000e-3}, 7.6826e-3, 78.04e-6, 0.133},
        {10e-3, 40e-3, 9e-3, 0.49, {0.000e-3, 11.000e-3}, 5.9866e-3, 93.556e-6, 0.297}}) {
    const PadShape shape(ConvexOutline::rounded_rectangle(row.length_m, row.width_m));
    PadProblem problem = pressed_pad(shape, row.thickness_m, row.nu, PadPressing::frictionless);
    problem.layer.youngs_modulus_Pa = 8e5;
    problem.load.normal_force_N = 2;
    problem.load_at_m = row.at_m;
    const PadPrediction p = layer_model().predict(problem);
    const auto bound = pad_error_bound(layer_model(), problem);
    ASSERT_TRUE(p.valid() && bound);
    EXPECT_NEAR(p.eccentricity_m / row.arm_m, 1, bound->max_torque);
    const double indentation_m =
        p.indentation_m + p.tilt_rad[1] * row.at_m.x() + p.tilt_rad[0] * row.at_m.y();
    EXPECT_NEAR(indentation_m / row.indentation_m, 1, bound->indentation);
    EXPECT_NEAR((1 - p.lifted_share) / (1 - row.lifted), 1, bound->area);
    // A stuck face turns about the same centre at full slip.
    problem.pressing = PadPressing::stuck;
    EXPECT_EQ(layer_model().predict(problem).eccentricity_m, p.eccentricity_m);
    EXPECT_TRUE(std::isnan(pad_error_bound(layer_model(), problem)->indentation));
  }
}

TEST(PadModel, HasNoAnswerWhereItTips) {
  const PadShape shape(ConvexOutline::rounded_rectangle(0.03, 0.02));
  PadProblem problem = pressed_pad(shape, 0.004, 0.45);
  for (const double share : {0.97, 1.0, 1.5}) {
    problem.load_at_m = Vector2d(share * 0.015, 0);
    const PadPrediction p = layer_model().predict(problem);
    EXPECT_FALSE(p.has_answer) << share;
    EXPECT_FALSE(p.valid());
  }
}

TEST(PadGradient, AgreesWithDifferences) {
  const PadShape shape(ConvexOutline::rounded_rectangle(0.03, 0.02, 0.004));
  for (const double nu : {0.1, 0.35, 0.49})
    for (const PadPressing pressing : {PadPressing::stuck, PadPressing::frictionless}) {
      const PadProblem problem = pressed_pad(shape, 0.004, nu, pressing);
      const PadGradient gradient = layer_model().gradient(problem);
      ASSERT_TRUE(gradient.known);
      const auto check = [&](double PadPrediction::*number, const PadDerivatives& derivatives) {
        const auto difference = [&](double& variable, double step) {
          const double middle = variable;
          variable = middle + step;
          const double above = layer_model().predict(problem).*number;
          variable = middle - step;
          const double below = layer_model().predict(problem).*number;
          variable = middle;
          return (above - below) / (2 * step);
        };
        PadProblem& changed = const_cast<PadProblem&>(problem);
        const double scale = layer_model().predict(problem).*number;
        EXPECT_NEAR(difference(changed.load.normal_force_N, 1e-5), derivatives.by_normal_force_N,
                    1e-6 * scale);
        EXPECT_NEAR(difference(changed.layer.youngs_modulus_Pa, 1) * 5e5,
                    derivatives.by_youngs_modulus_Pa * 5e5, 1e-6 * scale);
        EXPECT_NEAR(difference(changed.layer.poisson_ratio, 1e-6), derivatives.by_poisson_ratio,
                    2e-5 * scale);
        EXPECT_NEAR(difference(changed.layer.thickness_m, 1e-9) * 0.004,
                    derivatives.by_thickness_m * 0.004, 1e-5 * scale);
      };
      check(&PadPrediction::indentation_m, gradient.indentation_m);
      check(&PadPrediction::normal_stiffness_N_per_m, gradient.normal_stiffness_N_per_m);
      check(&PadPrediction::pressure_arm_m, gradient.pressure_arm_m);
      check(&PadPrediction::eccentricity_m, gradient.eccentricity_m);
    }
}

TEST(PadModel, DoesNotAllocate) {
  const PadShape shape(ConvexOutline::rounded_rectangle(0.0375, 0.022, 0.001));
  PadProblem problem = pressed_pad(shape, 0.003, 0.49);
  layer_model();  // makes the models, once for all
  const std::size_t before = testing::allocations();
  constexpr int kCalls = 2000;
  double sum = 0;
  for (int i = 0; i < kCalls; ++i) {
    problem.layer.thickness_m = 0.003 + 1e-6 * i;
    sum += layer_model().predict(problem).eccentricity_m;
  }
  sum += layer_model().gradient(problem).eccentricity_m.by_thickness_m;
  problem.load_at_m = Vector2d(0.001, 0.001);
  sum += layer_model().predict(problem).eccentricity_m;
  sum += layer_model().pressure_Pa(problem, {0.001, 0.002});
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_TRUE(std::isfinite(sum));
}

TEST(PadModel, IsFiniteAtTheExtremes) {
  for (const double size : {1e-6, 1e-2, 1e3}) {
    const PadShape shape(ConvexOutline::rounded_rectangle(size, size / 3));
    for (const PadModel* model : all_pad_models())
      for (const double thickness_m : {1e-12, 1e-6, 1e-2, 1e6})
        for (const double modulus_Pa : {1e-300, 1., 1e300})
          for (const double nu : {0., 1e-300, 0.3, 0.5})
            for (const double load_N : {1e-300, 1., 1e300}) {
              PadProblem problem = pressed_pad(shape, thickness_m, nu);
              problem.layer.youngs_modulus_Pa = modulus_Pa;
              problem.load.normal_force_N = load_N;
              const PadPrediction p = model->predict(problem);
              for (const double number :
                   {p.indentation_m, p.normal_stiffness_N_per_m, p.peak_pressure_Pa,
                    p.pressure_arm_m, p.eccentricity_m, p.tilt_limit_Nm[0], p.tilt_limit_Nm[1],
                    p.torsional_stiffness_Nm_per_rad})
                EXPECT_TRUE(std::isfinite(number));
              EXPECT_TRUE(p.has_answer || p.eccentricity_m == 0);
            }
  }
}

// Rows of the project's reference for flat pads (mixed finite elements on three meshes, 1e-4), as
// P h/(d E A) and arm over that of uniform pressure. The tolerance is the stated bound.
TEST(PadModel, IsWithinItsBoundsOfFiniteElements) {
  struct Row {
    double length_h, width_h;  ///< width 0: a disc of this diameter
    double nu;
    PadPressing pressing;
    double stiffness, arm;
  };
  constexpr auto kStuck = PadPressing::stuck, kFree = PadPressing::frictionless;
  const Row rows[] = {
      {1, 0, 0.3, kFree, 1.0262028, 0.99900507},  {1, 0, 0.3, kStuck, 1.0543033, 1.0514633},
      {4, 0, 0.3, kFree, 1.118576, 0.96690284},   {4, 0, 0.3, kStuck, 1.2106955, 1.0024149},
      {16, 0, 0.3, kFree, 1.2765613, 0.98023622}, {16, 0, 0.3, kStuck, 1.3113207, 0.9911078},
      {1, 0, 0.49, kFree, 1.0839588, 0.99843242}, {1, 0, 0.49, kStuck, 1.1850144, 1.0676868},
      {4, 0, 0.49, kFree, 1.5025557, 0.90694741}, {4, 0, 0.49, kStuck, 2.6337282, 0.93170712},
      {16, 0, 0.49, kFree, 5.6501, 0.84076234},   {16, 0, 0.49, kStuck, 9.9609251, 0.86752667},
      {2, 2, 0.3, kFree, 1.0639351, 0.97622292},  {2, 2, 0.3, kStuck, 1.1359394, 1.0268924},
      {2, 2, 0.49, kFree, 1.2197198, 0.95200215}, {2, 2, 0.49, kStuck, 1.6153923, 1.0134626},
      {4, 2, 0.3, kFree, 1.0954131, 0.97159973},  {4, 2, 0.3, kStuck, 1.1739574, 1.0055123},
      {4, 2, 0.49, kFree, 1.3557049, 0.93364564}, {4, 2, 0.49, kStuck, 1.968136, 0.96330978},
      {8, 4, 0.3, kFree, 1.1739574, 0.97214901},  {8, 4, 0.3, kStuck, 1.249624, 0.99072866},
      {8, 4, 0.49, kFree, 1.968136, 0.89441759},  {8, 4, 0.49, kStuck, 3.8099402, 0.88921186}};
  double worst_stiffness = 0, worst_arm = 0;
  for (const Row& row : rows) {
    const double h_m = 0.002;
    const PadShape shape(
        row.width_h == 0 ? ConvexOutline::disc(row.length_h * h_m)
                         : ConvexOutline::rounded_rectangle(row.length_h * h_m, row.width_h * h_m));
    PadProblem problem = pressed_pad(shape, h_m, row.nu, row.pressing);
    problem.load.normal_force_N = 1e-3;  // at small strain
    const PadPrediction p = layer_model().predict(problem);
    const auto bound = pad_error_bound(layer_model(), problem);
    ASSERT_TRUE(bound);
    const double stiffness = stiffness_ratio(problem) / row.stiffness - 1;
    const double arm = p.pressure_arm_m / uniform_arm_m(shape.outline()) / row.arm - 1;
    EXPECT_LE(std::abs(stiffness), bound->indentation)
        << row.length_h << " x " << row.width_h << ", nu " << row.nu;
    EXPECT_LE(std::abs(arm), row.pressing == kFree ? bound->max_torque : bound->pressure_arm)
        << row.length_h << " x " << row.width_h << ", nu " << row.nu;
    worst_stiffness = std::max(worst_stiffness, std::abs(stiffness));
    worst_arm = std::max(worst_arm, std::abs(arm));
  }
  std::printf("stiffness within %.2f %%, arm within %.2f %%\n", 100 * worst_stiffness,
              100 * worst_arm);
}

// Other outlines, by this project's finite elements of whole pads (linear, 5e-4), sides in h.
TEST(PadModel, IsWithinItsBoundsForLongAndOddOutlines) {
  const std::vector<Vector2d> triangle = {{0, 0}, {5, 0}, {2, 4}},
                              trapezoid = {{0, 0}, {6, 0}, {4, 3}, {0, 3}},
                              sector = {{0, 0},       {4, 0},      {3.7, 1.53},
                                        {2.83, 2.83}, {1.53, 3.7}, {0, 4}};
  const auto rectangle = [](double length, double width) -> std::vector<Vector2d> {
    return {{0, 0}, {length, 0}, {length, width}, {0, width}};
  };
  struct Row {
    std::vector<Vector2d> corners_h;
    double nu;
    PadPressing pressing;
    double stiffness, arm;
  };
  constexpr auto kStuck = PadPressing::stuck, kFree = PadPressing::frictionless;
  const std::vector<Row> rows = {{rectangle(12, 12), 0.4, kStuck, 1.92644, 0.96444},
                                 {rectangle(12, 12), 0.495, kFree, 5.15707, 0.82162},
                                 {rectangle(12, 12), 0.495, kStuck, 11.90758, 0.82593},
                                 {rectangle(20, 4), 0.475, kFree, 2.04290, 0.94113},
                                 {rectangle(20, 4), 0.495, kStuck, 4.99756, 0.92018},
                                 {rectangle(6, 1), 0.4, kFree, 1.17797, 0.96525},
                                 {rectangle(6, 1), 0.495, kFree, 1.32090, 0.94802},
                                 {rectangle(6, 1), 0.495, kStuck, 1.59001, 0.97128},
                                 {rectangle(3, 2), 0.475, kStuck, 1.71272, 0.98901},
                                 {triangle, 0.4, kFree, 1.22818, 0.94847},
                                 {triangle, 0.49, kFree, 1.42657, 0.92096},
                                 {triangle, 0.49, kStuck, 2.18747, 0.93772},
                                 {trapezoid, 0.4, kStuck, 1.54604, 0.97462},
                                 {trapezoid, 0.49, kFree, 1.56210, 0.91246},
                                 {sector, 0.49, kFree, 1.48919, 0.91241},
                                 {sector, 0.49, kStuck, 2.48009, 0.92802}};
  for (const Row& row : rows) {
    std::vector<Vector2d> corners_m;
    for (const Vector2d& corner : row.corners_h) corners_m.push_back(0.002 * corner);
    const PadShape shape(ConvexOutline::polygon(corners_m));
    PadProblem problem = pressed_pad(shape, 0.002, row.nu, row.pressing);
    problem.load.normal_force_N = 1e-3;
    const auto bound = pad_error_bound(layer_model(), problem);
    ASSERT_TRUE(bound);
    const double stiffness = stiffness_ratio(problem) / row.stiffness - 1;
    const double arm =
        layer_model().predict(problem).pressure_arm_m / uniform_arm_m(shape.outline()) / row.arm -
        1;
    EXPECT_LT(std::abs(stiffness), bound->indentation);
    EXPECT_LT(std::abs(arm), bound->max_torque);
    std::printf("stiffness %+.1f %%, arm %+.1f %%\n", 100 * stiffness, 100 * arm);
  }
}

TEST(PadModel, ShearsAndTwistsAsFiniteElementsDo) {
  // Round pads sheared between stuck faces that stay parallel, over G A/h: mixed finite elements
  // with one wave around, whose normal pressing meets the reference's to 2e-4.
  struct Row {
    double radius_h, nu, over_block;
  };
  for (const Row& row : {Row{0.5, 0.3, 0.63204},
                         {1, 0.1, 0.79510},
                         {2, 0.3, 0.91785},
                         {8, 0.3, 0.98009},
                         {0.5, 0.49, 0.70009},
                         {1, 0.49, 0.87037},
                         {2, 0.49, 0.93873},
                         {8, 0.49, 0.98525},
                         {4, 0.4999, 0.97072}}) {
    const PadShape shape(ConvexOutline::disc(2 * row.radius_h * 0.002));
    const PadProblem problem = pressed_pad(shape, 0.002, row.nu);
    const PadPrediction p = layer_model().predict(problem);
    const double block_N_per_m =
        problem.layer.shear_modulus_Pa() * shape.outline().area_m2() / 0.002;
    EXPECT_NEAR(p.tangential_stiffness_N_per_m[0] / block_N_per_m / row.over_block, 1, 0.05)
        << row.radius_h << " " << row.nu;
    // A round pad does not warp: G times the polar moment over h. The outline is a polygon.
    EXPECT_NEAR(p.torsional_stiffness_Nm_per_rad / (problem.layer.shear_modulus_Pa() / 0.002 * kPi /
                                                    2 * std::pow(row.radius_h * 0.002, 4)),
                1, 1e-3);
  }
}

TEST(PadModel, StatesThePeakWithinItsRim) {
  // Rows of that reference: the largest pressure of round pads up to 0.95 R, over the mean.
  struct Row {
    double radius_h, nu;
    PadPressing pressing;
    double peak;
  };
  constexpr auto kStuck = PadPressing::stuck, kFree = PadPressing::frictionless;
  for (const Row& row : {Row{0.5, 0.3, kFree, 1.0075},
                         {0.5, 0.3, kStuck, 1.2096},
                         {2, 0.3, kFree, 1.1162},
                         {2, 0.3, kStuck, 1.0587},
                         {8, 0.3, kFree, 1.0538},
                         {8, 0.3, kStuck, 1.0266},
                         {0.5, 0.49, kFree, 1.0125},
                         {0.5, 0.49, kStuck, 1.2299},
                         {2, 0.49, kFree, 1.3960},
                         {2, 0.49, kStuck, 1.4867},
                         {8, 0.49, kFree, 1.7271},
                         {8, 0.49, kStuck, 1.5538}}) {
    const PadShape shape(ConvexOutline::disc(2 * row.radius_h * 0.002));
    PadProblem problem = pressed_pad(shape, 0.002, row.nu, row.pressing);
    problem.load.normal_force_N = 1e-3;
    const double peak = layer_model().predict(problem).peak_pressure_Pa *
                        shape.outline().area_m2() / problem.load.normal_force_N;
    EXPECT_NEAR(peak / row.peak, 1, pad_error_bound(layer_model(), problem)->peak_pressure)
        << row.radius_h << " " << row.nu;
    std::printf("R/h %g, nu %g: peak %+.1f %%\n", row.radius_h, row.nu,
                100 * (peak / row.peak - 1));
  }
}

}  // namespace softfinger
