#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/layer/layer_kernel.h"
#include "softfinger/math/gauss_legendre.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/taxels/corner_response.h"
#include "softfinger/taxels/layer_stress.h"
#include "softfinger/taxels/taxel_array.h"

namespace softfinger::taxels {
namespace {

ContactProblem finger(double thickness_m, double poisson_ratio, double load_N = 2) {
  ContactProblem problem;
  problem.radii = {20e-3, 12e-3};
  problem.layer = {thickness_m, 300e3, poisson_ratio};
  problem.load = {load_N, 0.8};
  return problem;
}

ModelReadings read(const char* name, const ContactProblem& problem, int columns, int rows,
                   std::optional<double> pitch_m = std::nullopt, double depth_m = 0) {
  const PressureModel& model = *find_pressure_model(name);
  const Prediction prediction = model.predict(problem);
  EXPECT_TRUE(prediction.has_answer) << name;
  return read_taxels(model, problem, prediction, columns, rows, pitch_m, depth_m);
}

/// Stresses at depth by integrating the equations of plane strain through the thickness, which
/// share nothing with the closed form: state (u, w, shear, normal) of waves sin x, cos x, sin x,
/// cos x, z downwards in units of 1/k, 2 G = 1.
struct IntegratedStress {
  double normal = 0, shear = 0;  ///< on what lies deeper; compression positive
  double surface = 0;            ///< the surface's displacement into the layer
};
/// @param pressure, shear  on the surface
IntegratedStress integrated_stress(double nu, double thickness, double depth, double pressure,
                                   double shear) {
  const double lame = nu / (1 - 2 * nu), confined = lame + 1;
  Eigen::Matrix4d slope;
  slope << 0, 1, 2, 0,                                           //
      -lame / confined, 0, 0, 1 / confined,                      //
      confined - lame * lame / confined, 0, 0, lame / confined,  //
      0, 0, -1, 0;
  const auto propagator = [&](double length) {
    constexpr int kSteps = 2000;
    const Eigen::Matrix4d hA = length / kSteps * slope, hA2 = hA * hA;
    const Eigen::Matrix4d step =
        Eigen::Matrix4d::Identity() + hA + hA2 / 2 + hA2 * hA / 6 + hA2 * hA2 / 24;
    Eigen::Matrix4d all = Eigen::Matrix4d::Identity();
    for (int i = 0; i < kSteps; ++i) all = step * all;
    return all;
  };
  const Eigen::Matrix4d through = propagator(thickness);
  Eigen::Vector4d surface(0, 0, -shear, -pressure);
  surface.head<2>() = -through.topLeftCorner<2, 2>().inverse() * (through * surface).head<2>();
  const Eigen::Vector4d there = propagator(depth) * surface;
  // On what lies deeper acts minus the shear stress, whose normal points into it.
  return {-there[3], -there[2], surface[1]};
}

TEST(LayerStress, EqualsTheEquationsIntegratedThroughTheThickness) {
  for (const double nu : {0., 0.3, 0.49})
    for (const double x : {0.1, 0.5, 1., 3., 6.})
      for (const double depth : {0.1, 0.5, 1.}) {
        const LayerStress::Wave stress = LayerStress(nu, depth).stress(x);
        const IntegratedStress expected = integrated_stress(nu, x, depth * x, 1, 0);
        // Runge-Kutta's error, (6/2000)^4, grows by exp(6) on its way to the base.
        EXPECT_NEAR(stress.normal, expected.normal, 1e-7) << nu << " " << x << " " << depth;
        EXPECT_NEAR(stress.shear, expected.shear, 1e-7) << nu << " " << x << " " << depth;
      }
}

/// Waves of the whole layer.
LayerStress::ShearWave shear_stress(const LayerStress& stress, double x, double depth) {
  const double y = x * depth, decay = std::exp(-y);
  LayerStress::ShearWave wave = stress.shear_excess(x);
  wave.normal += y * decay;
  wave.along += (1 - y) * decay;
  wave.across += decay;
  return wave;
}

TEST(LayerStress, OfShearEqualsTheEquationsIntegratedThroughTheThickness) {
  for (const double nu : {0., 0.3, 0.49})
    for (const double x : {0.1, 0.5, 1., 3., 6.})
      for (const double depth : {0.1, 0.5, 1.}) {
        const LayerStress layer(nu, depth);
        const LayerStress::ShearWave stress = shear_stress(layer, x, depth);
        const IntegratedStress expected = integrated_stress(nu, x, depth * x, 0, 1);
        // Runge-Kutta's error grows by exp(6) on its way to the base, as in the test before.
        EXPECT_NEAR(stress.normal, -expected.normal, 1e-7) << nu << " " << x << " " << depth;
        EXPECT_NEAR(stress.along, expected.shear, 1e-7) << nu << " " << x << " " << depth;
        // The shear modulus is 1/2.
        EXPECT_NEAR(layer.lift(x), -expected.surface / 2, 1e-7) << nu << " " << x;
        // Shear across the wave has w'' = w, w = 0 at the base: closed forms, equal to rounding.
        EXPECT_NEAR(stress.across, std::cosh(x * (1 - depth)) / std::cosh(x), 1e-14);
      }
  // exp(-80) is left of the layer: rounding of numbers below 1.
  EXPECT_NEAR(LayerStress(0.3, 1).lift(40), LayerStress(0.3, 1).lift_of_half_space(), 1e-15);
}

TEST(LayerStress, IsThePressureOnTheSurfaceAndOfLongWaves) {
  for (const double nu : {0., 0.3, 0.5}) {
    for (const double x : {0., 0.3, 5., 40.}) {
      // Equal in closed form: a few roundings of numbers of size 1 are left.
      EXPECT_NEAR(LayerStress(nu, 0).stress(x).normal, 1, 1e-15);
      EXPECT_NEAR(LayerStress(nu, 0).stress(x).shear, 0, 1e-15);
    }
    EXPECT_NEAR(LayerStress(nu, 1).stress(0).normal, 1, 1e-15);
  }
}

/// A Gaussian pressure of the load 1 on cells, and the integral of its Hankel transform for a
/// reading at the distance r from its middle.
struct Gaussian {
  double width_m;

  /// @param shear_x, shear_y  friction over pressure
  ForceCells on(const TaxelGrid& grid, double shear_x = 0, double shear_y = 0) const {
    std::vector<SpreadForce> forces;
    constexpr int kHalf = 60;
    const double step = 6 * width_m / kHalf;  // exp(-18) is left out
    const auto part = [&](int i) {
      const double s = step / (width_m * std::sqrt(2.));
      return 0.5 * (std::erf((i + 1) * s) - std::erf(i * s));
    };
    for (int j = -kHalf; j < kHalf; ++j)
      for (int i = -kHalf; i < kHalf; ++i)
        forces.push_back({(i + 0.5) * step, (j + 0.5) * step, 0.5 * step, 0.5 * step,
                          part(i) * part(j), shear_x * part(i) * part(j),
                          shear_y * part(i) * part(j)});
    return forces_on_cells(forces, 1, grid);
  }

  /// 1/(2 pi) int factor(k) exp(-k² width²/2) J_order(k r) dk
  template <class Factor>
  double transform(double r_m, int order, const Factor& factor) const {
    const QuadratureRule rule = composite_gauss_legendre(9 / width_m, 0.25 / width_m);
    double sum = 0;
    for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
      const double k = rule.nodes[i];
      sum += rule.weights[i] * factor(k) * std::exp(-0.5 * k * k * width_m * width_m) *
             std::cyl_bessel_j(order, k * r_m);
    }
    return sum / (2 * kPi);
  }
};

TEST(Taxels, AtDepthEqualTheHankelTransformOfAGaussianPressure) {
  const Gaussian pressure{1e-3};
  // Cells and taxels are the steps of the pressure. Each of the means over a cell or a taxel is
  // 1 - k² pitch²/24 of a wave, up to (k pitch)^4/1920 = 1e-5 where k = 3 per mm.
  constexpr double kPitch = 0.1e-3, kTolerance = 1e-5;
  const auto mean = [&](double k) { return 1 - k * k * kPitch * kPitch / 24; };
  const ForceCells cells = pressure.on({24, 10, kPitch});
  constexpr int kColumn = 23, kRow = 9;
  const double x = cells.grid.x_m(kColumn), y = cells.grid.y_m(kRow), r = std::hypot(x, y);
  for (const double nu : {0., 0.45, 0.5})
    for (const double thickness_m : {0.4e-3, 2e-3, 20e-3})
      for (const double share : {0.5, 1.}) {
        const ElasticLayer layer{thickness_m, 1e5, nu};
        const double depth_m = share * thickness_m;
        const TaxelReadings readings = read_taxels(cells, layer, depth_m);
        const auto where = ::testing::Message()
                           << "nu " << nu << ", h " << thickness_m << ", z " << depth_m;
        const LayerStress stress(nu, share);
        const auto normal = [&](double k) {
          return k * stress.stress(k * thickness_m).normal * mean(k) * mean(k);
        };
        const auto shear = [&](double k) {
          return k * stress.stress(k * thickness_m).shear * mean(k) * mean(k);
        };
        const double peak = pressure.transform(0, 0, normal);
        EXPECT_NEAR(readings.pressure_Pa()(kRow, kColumn), pressure.transform(r, 0, normal),
                    kTolerance * peak)
            << where;
        const double outwards = pressure.transform(r, 1, shear) * kPitch * kPitch;
        EXPECT_NEAR(readings.shear_x_N(kRow, kColumn), outwards * x / r,
                    kTolerance * peak * kPitch * kPitch)
            << where;
        EXPECT_NEAR(readings.shear_y_N(kRow, kColumn), outwards * y / r,
                    kTolerance * peak * kPitch * kPitch)
            << where;
        // The cells' forces are spread over them once more.
        const LayerKernel kernel(nu);
        const auto compliance = [&](double k) {
          return 2 * kernel.compliance(k * thickness_m) / layer.plane_strain_modulus_Pa() *
                 mean(k) * mean(k) * mean(k);
        };
        // A thin layer's displacement is a small difference from the half-space's.
        const double half_space =
            pressure.transform(0, 0, [&](double) { return 2 / layer.plane_strain_modulus_Pa(); });
        EXPECT_NEAR(readings.displacement_m(kRow, kColumn), pressure.transform(r, 0, compliance),
                    kTolerance * half_space)
            << where;
      }
}

TEST(Taxels, AtDepthEqualTheHankelTransformOfAGaussianShear) {
  const Gaussian pressure{1e-3};
  constexpr double kPitch = 0.1e-3, kTolerance = 1e-5;  // as above
  const auto mean = [&](double k) { return 1 - k * k * kPitch * kPitch / 24; };
  const TaxelGrid grid{24, 10, kPitch};
  constexpr int kColumn = 23, kRow = 9;
  const double x = grid.x_m(kColumn), y = grid.y_m(kRow), r = std::hypot(x, y);
  const ForceCells without = pressure.on(grid), along_x = pressure.on(grid, 1, 0),
                   along_y = pressure.on(grid, 0, 1);
  for (const double nu : {0., 0.45, 0.5})
    for (const double thickness_m : {0.4e-3, 2e-3, 20e-3})
      for (const double share : {0.5, 1.}) {
        const ElasticLayer layer{thickness_m, 1e5, nu};
        const double depth_m = share * thickness_m, area_m2 = kPitch * kPitch;
        const auto where = ::testing::Message()
                           << "nu " << nu << ", h " << thickness_m << ", z " << depth_m;
        const LayerStress stress(nu, share);
        const auto wave = [&](double k) { return shear_stress(stress, k * thickness_m, share); };
        const auto means = [&](double k) { return mean(k) * mean(k); };
        const double normal = pressure.transform(
                         r, 1, [&](double k) { return k * wave(k).normal * means(k); }),
                     across = pressure.transform(
                         r, 0, [&](double k) { return k * wave(k).across * means(k); }),
                     second = pressure.transform(
                         r, 0,
                         [&](double k) { return k * (wave(k).along - wave(k).across) * means(k); }),
                     first =
                         pressure.transform(r, 1,
                                            [&](double k) {
                                              return (wave(k).along - wave(k).across) * means(k);
                                            }) /
                         r,
                     lift = pressure.transform(r, 1, [&](double k) {
                       return stress.lift(k * thickness_m) * means(k);
                     }) / (layer.youngs_modulus_Pa / (2 * (1 + nu)));
        const double c = x / r, s = y / r;
        const double peak = pressure.transform(0, 0, [](double k) { return k; });
        // The lift is that of point forces in the middles of the cells: its kernel, of the lengths
        // 0 to h, and the shear itself vary over a cell.
        const double thick = kPitch / thickness_m, wide = kPitch / 1e-3,
                     lift_tolerance = std::abs(lift) * (thick * thick + wide * wide) / 10;
        const TaxelReadings plain = read_taxels(without, layer, depth_m);
        const auto expect = [&](const ForceCells& cells, double expected_normal, double expected_x,
                                double expected_y, double expected_lift) {
          const TaxelReadings readings = read_taxels(cells, layer, depth_m);
          const auto added = [&](const Eigen::ArrayXXd TaxelReadings::*of) {
            return (readings.*of)(kRow, kColumn) - (plain.*of)(kRow, kColumn);
          };
          EXPECT_NEAR(added(&TaxelReadings::force_N) / area_m2, expected_normal, kTolerance * peak)
              << where;
          EXPECT_NEAR(added(&TaxelReadings::shear_x_N) / area_m2, expected_x, kTolerance * peak)
              << where;
          EXPECT_NEAR(added(&TaxelReadings::shear_y_N) / area_m2, expected_y, kTolerance * peak)
              << where;
          EXPECT_NEAR(added(&TaxelReadings::displacement_m), expected_lift, lift_tolerance)
              << where;
        };
        // Derivatives of the potential of l - c: J0' = -J1, J1' = J0 - J1/s.
        const double mixed = c * s * (second - 2 * first);
        expect(along_x, c * normal, across + c * c * (second - first) + s * s * first, mixed,
               c * lift);
        expect(along_y, s * normal, mixed, across + s * s * (second - first) + c * c * first,
               s * lift);
      }
}

// Friction with a net force, which is a constant share of the pressure.
TEST(Taxels, ReadFrictionOnTheSurfaceAndItsForceThroughEveryPlane) {
  const ElasticLayer layer{1e-3, 1e5, 0.45};
  const Gaussian pressure{1e-3};
  const ForceCells cells = pressure.on({64, 64, 0.6e-3}, 0.3, -0.1);
  const TaxelReadings surface = read_taxels(cells, layer, 0),
                      base = read_taxels(cells, layer, 1e-3);
  // Sums of some thousand cells, and single taxels of at most 0.05 N: rounding.
  EXPECT_NEAR(surface.shear_x_N.sum(), 0.3, 1e-12);
  EXPECT_NEAR(surface.shear_y_N.sum(), -0.1, 1e-12);
  EXPECT_NEAR((surface.shear_x_N - 0.3 * surface.force_N).abs().maxCoeff(), 0, 1e-15);
  // 19 mm to each side: the layer's stress, which decays like exp(-0.739 r/h), has fallen to 1e-6.
  EXPECT_NEAR(base.shear_x_N.sum(), 0.3, 1e-6);
  EXPECT_NEAR(base.shear_y_N.sum(), -0.1, 1e-6);
  EXPECT_NEAR(base.force_N.sum(), 1, 1e-6);
}

TEST(Taxels, AddUpToTheLoadForEveryModel) {
  ContactProblem problem = finger(2e-3, 0.45);
  problem.options.power_law.radius_coefficient = 3e-3;
  int answered = 0;
  for (const PressureModel* model : all_pressure_models()) {
    const Prediction prediction = model->predict(problem);
    if (!prediction.has_answer) continue;  // of round contacts only
    ++answered;
    for (const int count : {1, 2, 5, 16}) {
      const ModelReadings all =
          read_taxels(*model, problem, prediction, count, count + 3, std::nullopt, 0);
      // Rounding of some thousand cells.
      EXPECT_NEAR(all.readings.force_N.sum(), 2, 2e-12) << model->card().name << " " << count;
      // The error that each model states for its pressure; a closed form leaves the rule's.
      EXPECT_NEAR(all.forces.normalisation, 1, std::max(2e-5, model->card().accuracy.pressure))
          << model->card().name;
      EXPECT_GE(all.readings.force_N.minCoeff(), 0);
    }
  }
  EXPECT_GE(answered, 8);
}

TEST(Taxels, HaveTheClosedFormForcesOfAHertzPressure) {
  ContactProblem problem = finger(2e-3, 0.3);
  problem.radii = {10e-3, 10e-3};
  const Prediction hertz = find_pressure_model("hertz")->predict(problem);
  // Strips across a round contact: int p dy = p0 pi (a² - x²)/(2 a).
  const TaxelReadings readings = read("hertz", problem, 11, 13).readings;
  const auto up_to = [&](double x_m) {
    const double u = std::clamp(x_m / hertz.a_m, -1., 1.);
    return 2 * (2 + 3 * u - u * u * u) / 4;
  };
  for (int column = 0; column < 11; ++column) {
    const double middle = readings.grid.x_m(column), half = 0.5 * readings.grid.pitch_m;
    // The rule's error along the edge, of a strip's force.
    EXPECT_NEAR(readings.force_N.col(column).sum(), up_to(middle + half) - up_to(middle - half),
                2e-6)
        << column;
  }
  // A square inside of the contact, by another rule.
  const double side = 2 * readings.grid.pitch_m;
  const TaxelReadings one = read("hertz", problem, 1, 1, side).readings;
  const QuadratureRule rule = gauss_legendre(24);
  double force = 0;
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 24; ++j) {
      const double x = side * (rule.nodes[i] - 0.5), y = side * (rule.nodes[j] - 0.5);
      force += side * side * rule.weights[i] * rule.weights[j] * hertz.peak_pressure_Pa *
               std::sqrt(1 - (x * x + y * y) / (hertz.a_m * hertz.a_m));
    }
  EXPECT_NEAR(one.force_N(0, 0), force, 2e-6);
  EXPECT_NEAR(one.outside_N(), 2 - force, 2e-6);
}

TEST(Taxels, DeepInAThickLayerReadBoussinesqsStressOnTheAxis) {
  ContactProblem problem = finger(1, 0.3);
  problem.radii = {10e-3, 10e-3};
  const Prediction hertz = find_pressure_model("hertz")->predict(problem);
  for (const double relative_depth : {0.25, 0.5, 1., 2.}) {
    const double depth_m = relative_depth * hertz.a_m;
    const TaxelReadings readings = read("hertz", problem, 3, 3, 0.02 * hertz.a_m, depth_m).readings;
    // A taxel's mean is (0.02)²/24 of the curvature off, a cell's too; the layer, which is some
    // hundred contacts thick, less.
    const double expected = hertz.peak_pressure_Pa / (1 + relative_depth * relative_depth);
    EXPECT_NEAR(readings.pressure_Pa()(1, 1), expected, 2e-4 * hertz.peak_pressure_Pa)
        << relative_depth;
  }
}

TEST(Taxels, AtTheBaseOfAThinCompressibleLayerReadThePressureOfTheSurface) {
  const ContactProblem problem = finger(0.15e-3, 0.2);
  const TaxelReadings above = read("winkler", problem, 10, 10).readings;
  const TaxelReadings below =
      read("winkler", problem, 16, 16, above.grid.pitch_m, 0.15e-3).readings;
  const double peak = above.force_N.maxCoeff();
  // The layer smooths the pressure over its thickness, a fifth of a taxel's side: the corner that a
  // Winkler pressure has at the edge loses some per mille of the peak.
  const double h = 0.15e-3 / above.grid.pitch_m;
  EXPECT_LT((above.force_N - below.force_N.block(3, 3, 10, 10)).abs().maxCoeff(), h * h * peak);
  // Beside the contact lie four taxels, 17 thicknesses.
  EXPECT_NEAR(below.force_N.sum(), 2, 2e-7);
}

TEST(Taxels, AtTheBaseAddUpToTheLoadOverAWideArray) {
  for (const double nu : {0., 0.45, 0.5}) {
    ContactProblem round = finger(2e-3, nu);
    round.radii = {15e-3, 15e-3};
    // 64 mm on each side: what is left beyond 32 thicknesses has decayed like exp(-0.739 r/h).
    const TaxelReadings readings = read("layer_fredholm", round, 64, 64, 2e-3, 2e-3).readings;
    // The stated error of the kernel's tables.
    EXPECT_NEAR(readings.force_N.sum(), 2, 2e-7) << nu;
    // Shear points outwards, and its sum is zero by symmetry.
    EXPECT_NEAR(readings.shear_x_N.sum(), 0, 1e-9);
    EXPECT_GT(readings.shear_x_N(32, 33), 0);
    EXPECT_NEAR(readings.shear_x_N(32, 30), -readings.shear_x_N(32, 33), 1e-9);
    EXPECT_NEAR(readings.shear_x_N(30, 33), readings.shear_y_N(33, 30), 1e-9);
  }
}

TEST(Taxels, SeeTheSurfaceThatTheObjectPressesDown) {
  const ContactProblem problem = finger(2e-3, 0.45);
  const PressureModel& model = *find_pressure_model("layer_fft");
  const Prediction prediction = model.predict(problem);
  const ModelReadings all = read("layer_fft", problem, 24, 24);
  const TaxelGrid& grid = all.readings.grid;
  for (int row = 0; row < 24; ++row)
    for (int column = 0; column < 24; ++column) {
      const double x = grid.x_m(column), y = grid.y_m(row), half = 0.5 * grid.pitch_m;
      const double u = (std::abs(x) + half) / prediction.a_m,
                   v = (std::abs(y) + half) / prediction.b_m;
      if (u * u + v * v > 0.95) continue;
      // The surface follows the object: d less the mean gap over the taxel.
      const double mean_square = grid.pitch_m * grid.pitch_m / 12;
      const double expected = prediction.indentation_m -
                              (x * x + mean_square) / (2 * problem.radii.major_m) -
                              (y * y + mean_square) / (2 * problem.radii.minor_m);
      // Forces of layer_fft's cells spread over others of the same size change displacements by the
      // square of a cell's share of the contact, (1/64)².
      EXPECT_NEAR(all.readings.displacement_m(row, column), expected,
                  1e-3 * prediction.indentation_m)
          << column << " " << row;
    }
}

TEST(Taxels, ShowSizeAndArmOfTheContactTheBetterTheFinerTheyAre) {
  const ContactProblem problem = finger(2e-3, 0.49);
  const Prediction prediction = find_pressure_model("bonded_layer")->predict(problem);
  double last = 1;
  for (const int count : {4, 8, 16, 32}) {
    const ModelReadings all = read("bonded_layer", problem, count, count);
    const ArrayMoments seen = moments_of(all.readings);
    // The model's own arm, by integrating its pressure.
    EXPECT_NEAR(all.forces.arm_m, prediction.torque_arm_exact_m,
                1e-5 * prediction.torque_arm_exact_m);
    const double error = std::abs(seen.arm_m / all.forces.arm_m - 1);
    // At least of first order, up to what cancels by chance.
    EXPECT_LT(error, last / 2) << count;
    last = error;
  }
  EXPECT_LT(last, 2e-3);
}

TEST(Taxels, DoNotDependOnTheUnits) {
  const ContactProblem problem = finger(2e-3, 0.45);
  ContactProblem large = problem;
  constexpr double kScale = 1024;
  large.radii = {kScale * 20e-3, kScale * 12e-3};
  large.layer.thickness_m *= kScale;
  large.load.normal_force_N *= kScale * kScale;
  const TaxelReadings one = read("hertz", problem, 6, 5, std::nullopt, 1e-3).readings;
  const TaxelReadings other = read("hertz", large, 6, 5, std::nullopt, kScale * 1e-3).readings;
  EXPECT_NEAR(other.grid.pitch_m, kScale * one.grid.pitch_m, 1e-12 * other.grid.pitch_m);
  EXPECT_LT((other.force_N / (kScale * kScale) - one.force_N).abs().maxCoeff(), 1e-12);
  EXPECT_LT((other.shear_x_N / (kScale * kScale) - one.shear_x_N).abs().maxCoeff(), 1e-12);
  EXPECT_LT((other.displacement_m / kScale - one.displacement_m).abs().maxCoeff(), 1e-15);
}

TEST(Taxels, RefuseWhatIsNoArray) {
  const ContactProblem problem = finger(2e-3, 0.45);
  const auto refused = [&](int columns, int rows, std::optional<double> pitch_m, double depth_m,
                           const ContactProblem& asked) {
    const PressureModel& model = *find_pressure_model("hertz");
    EXPECT_THROW(read_taxels(model, asked, model.predict(asked), columns, rows, pitch_m, depth_m),
                 InputError)
        << columns << " " << rows << " " << depth_m;
  };
  refused(0, 4, std::nullopt, 0, problem);
  refused(4, 65, std::nullopt, 0, problem);
  refused(4, 4, 0., 0, problem);
  refused(4, 4, std::nan(""), 0, problem);
  refused(4, 4, 1e-6, 0, problem);
  refused(4, 4, std::nullopt, -1e-4, problem);
  refused(4, 4, std::nullopt, 2.1e-3, problem);
  refused(4, 4, std::nullopt, std::nan(""), problem);
  ContactProblem stack = problem;
  stack.stack.count = 2;
  stack.stack.sublayers[0] = stack.stack.sublayers[1] = {1e-3, 300e3, 0.45};
  refused(4, 4, std::nullopt, 1e-3, stack);
}

}  // namespace
}  // namespace softfinger::taxels
