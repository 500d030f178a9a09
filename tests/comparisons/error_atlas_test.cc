// The bounds of the error atlas against atlases whose errors are known functions.
#include "comparisons/judgement/atlas/error_atlas.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <set>

#include "comparisons/judgement/atlas/make_atlas.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

constexpr double kStated = 1e-3;

/// Linear in the coordinates that the atlas interpolates in, with a product.
double known_error(double nu, double ratio, double s) {
  const double x = -std::log(0.501 - nu), y = std::log(ratio), z = std::log(s);
  return 0.1 + 0.02 * x - 0.03 * y + 0.05 * z + 0.01 * x * y;
}

judgement::AtlasRun run_at(double nu, double ratio, double s,
                           judgement::AtlasKind kind = judgement::AtlasKind::flat,
                           double thickness_over_radius = 0) {
  judgement::AtlasRun run;
  run.kind = kind;
  run.poisson_ratio = nu;
  run.radii_ratio = ratio;
  run.s = s;
  run.thickness_over_radius = thickness_over_radius;
  run.friction_coefficient = 0.5;
  run.answer = {1, 1, 0.1, 3, 0.2, 0.6};
  run.stated_error.fill(kStated);
  return run;
}

judgement::AtlasFile known_atlas() {
  judgement::AtlasFile atlas;
  atlas.provenance = {{"version", "test"}, {"cost_ns fem", "2e9"}};
  for (const double nu : {0.2, 0.4, 0.49})
    for (const double ratio : {1., 3.})
      for (const double s : {0.2, 1., 4.}) {
        atlas.runs.push_back(run_at(nu, ratio, s));
        judgement::QuantityErrors errors;
        errors.fill(known_error(nu, ratio, s));
        if (nu == 0.49 && s == 4) errors.fill(NAN);
        atlas.errors["hertz"].push_back(errors);
      }
  return atlas;
}

TEST(ErrorAtlas, InterpolatesBetweenItsRunsAndAddsWhatItDoesNotKnow) {
  const judgement::ErrorAtlas atlas(known_atlas());
  const double nu = 0.3, ratio = 2, s = 0.5;
  const auto estimate = atlas.estimate("hertz", judgement::problem_of(run_at(nu, ratio, s)));
  ASSERT_TRUE(estimate.bound) << estimate.outside;
  const double expected = known_error(nu, ratio, s);
  double lowest = 1e9, highest = -1e9;
  for (const double n : {0.2, 0.4})
    for (const double r : {1., 3.})
      for (const double t : {0.2, 1.}) {
        lowest = std::min(lowest, known_error(n, r, t));
        highest = std::max(highest, known_error(n, r, t));
      }
  for (std::size_t q = 0; q < judgement::kQuantities; ++q) {
    // The size is placed by a tabulated model that is inverted to round-off.
    EXPECT_NEAR(estimate.mean[q], expected, 1e-9);
    EXPECT_NEAR((*estimate.bound)[q], std::abs(expected) + (highest - lowest) / 2 + kStated / 4,
                1e-9);
  }
}

TEST(ErrorAtlas, IsTheRunsOwnErrorAtARun) {
  const judgement::ErrorAtlas atlas(known_atlas());
  // The last corner of the grid: no neighbour may widen the bound.
  const auto estimate = atlas.estimate("hertz", judgement::problem_of(run_at(0.49, 3, 1)));
  ASSERT_TRUE(estimate.bound) << estimate.outside;
  EXPECT_NEAR(estimate.mean[0], known_error(0.49, 3, 1), 1e-8);
}

TEST(ErrorAtlas, NeverExtrapolates) {
  const judgement::ErrorAtlas atlas(known_atlas());
  const auto outside = [&](const ContactProblem& problem, const char* model = "hertz") {
    const auto estimate = atlas.estimate(model, problem);
    EXPECT_FALSE(estimate.bound);
    return estimate.outside;
  };
  EXPECT_NE(outside(judgement::problem_of(run_at(0.495, 2, 0.5))).find("Poisson"),
            std::string::npos);
  EXPECT_NE(outside(judgement::problem_of(run_at(0.3, 3.1, 0.5))).find("R'/R''"),
            std::string::npos);
  EXPECT_NE(outside(judgement::problem_of(run_at(0.3, 2, 0.19))).find("s = "), std::string::npos);
  EXPECT_NE(outside(judgement::problem_of(run_at(0.3, 2, 4.1))).find("s = "), std::string::npos);
  EXPECT_NE(outside(judgement::problem_of(run_at(0.45, 2, 3))).find("no answer"), std::string::npos)
      << "one of the runs around has none";
  EXPECT_NE(outside(judgement::problem_of(run_at(0.3, 2, 0.5)), "power_law").find("no errors of"),
            std::string::npos);
  ContactProblem two_layers = judgement::problem_of(run_at(0.3, 2, 0.5));
  two_layers.object_layer = two_layers.layer;
  EXPECT_NE(outside(two_layers).find("two"), std::string::npos);
  EXPECT_FALSE(atlas
                   .estimate("hertz", judgement::problem_of(run_at(0.3, 1, 0.5)),
                             judgement::AtlasKind::curved, 0.1)
                   .bound)
      << "no curved runs here";
}

TEST(ErrorAtlas, KnowsCurvedLayersApartFromFlatOnes) {
  judgement::AtlasFile file = known_atlas();
  for (const double nu : {0.2, 0.4})
    for (const double curved : {0.1, 0.3})
      for (const double s : {0.2, 1.}) {
        file.runs.push_back(run_at(nu, 1, s, judgement::AtlasKind::curved, curved));
        judgement::QuantityErrors errors;
        errors.fill(-curved);
        file.errors["hertz"].push_back(errors);
      }
  const judgement::ErrorAtlas atlas(file);
  const ContactProblem problem = judgement::problem_of(run_at(0.3, 1, 0.5));
  EXPECT_NEAR(atlas.estimate("hertz", problem, judgement::AtlasKind::curved, 0.1).mean[0], -0.1,
              1e-12);
  EXPECT_NEAR(atlas.estimate("hertz", problem).mean[0], known_error(0.3, 1, 0.5), 1e-9);
  EXPECT_FALSE(atlas.estimate("hertz", problem, judgement::AtlasKind::curved, 0.31).bound);
  EXPECT_FALSE(atlas
                   .estimate("hertz", judgement::problem_of(run_at(0.3, 2, 0.5)),
                             judgement::AtlasKind::curved, 0.1)
                   .bound);
}

TEST(ErrorAtlas, FiniteElementsStateTheirOwnError) {
  const judgement::ErrorAtlas atlas(known_atlas());
  const auto estimate = atlas.estimate("fem", judgement::problem_of(run_at(0.3, 2, 0.5)));
  ASSERT_TRUE(estimate.bound);
  for (const double bound : *estimate.bound) EXPECT_EQ(bound, kStated);
  EXPECT_EQ(atlas.cost_ns("fem"), 2e9);
  EXPECT_TRUE(std::isnan(atlas.cost_ns("hertz")));
}

TEST(ErrorAtlas, SurvivesItsFile) {
  const judgement::AtlasFile atlas = known_atlas();
  const std::string text = to_csv(atlas);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  const judgement::AtlasFile read = judgement::parse_atlas(text, "atlas.csv");
  EXPECT_EQ(to_csv(read), text);
  ASSERT_EQ(read.runs.size(), atlas.runs.size());
  EXPECT_EQ(read.provenance, atlas.provenance);
  // The errors are written with four digits.
  EXPECT_NEAR(read.errors.at("hertz")[3][2], atlas.errors.at("hertz")[3][2], 1e-4);
}

TEST(ErrorAtlas, RefusesADamagedFile) {
  const std::string text = to_csv(known_atlas());
  const auto refusal = [](const std::string& damaged) {
    try {
      judgement::parse_atlas(damaged, "atlas.csv");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  std::string word = text;
  word.replace(word.find("\nflat,0.2"), 9, "\nflat,x.2");
  EXPECT_NE(refusal(word).find("atlas.csv:"), std::string::npos);
  std::string kind = text;
  kind.replace(kind.find("\nflat,0.2"), 9, "\nround,0.2");
  EXPECT_NE(refusal(kind).find("finite_pad"), std::string::npos) << "names what is allowed";
  // Found by fuzzing: a run without a place in the grid was written beside it.
  for (const char* damage : {"\nflat,,1", "\nflat", "\nflat,0.6,1", "\nflat,0.2,nan"}) {
    std::string place = text;
    place.replace(place.find("\nflat,0.2"), 9, damage);
    EXPECT_NE(refusal(place).find("atlas.csv:"), std::string::npos) << damage;
  }
  std::string header = text;
  header.replace(header.find("ratio"), 5, "radio");
  EXPECT_NE(refusal(header).find("header"), std::string::npos);
}

TEST(AtlasRuns, AreEnoughAndAllDifferent) {
  const auto runs = judgement::designed_runs();
  EXPECT_GE(runs.size(), 400u);
  std::set<std::string> all;
  for (const judgement::AtlasRun& run : runs)
    all.insert(name_of(run.kind) + std::to_string(run.poisson_ratio) + " " +
               std::to_string(run.radii_ratio) + " " + std::to_string(run.s) + " " +
               std::to_string(run.thickness_over_radius) + " " +
               std::to_string(run.friction_coefficient));
  EXPECT_EQ(all.size(), runs.size());
}

TEST(AtlasRuns, AreDrawnInsideTheGridTheSameForTheSameSeed) {
  const auto runs = judgement::random_runs(100, 5), again = judgement::random_runs(100, 5),
             other = judgement::random_runs(100, 6);
  const judgement::ErrorAtlas& atlas = judgement::error_atlas();
  int differ = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    EXPECT_EQ(runs[i].s, again[i].s);
    differ += runs[i].s != other[i].s;
    const auto estimate = atlas.estimate("bonded_layer", judgement::problem_of(runs[i]));
    EXPECT_TRUE(estimate.bound) << estimate.outside;
  }
  EXPECT_EQ(differ, 100);
}

TEST(AtlasProblem, HasTheSizeThatWasAskedFor) {
  for (const double nu : {0., 0.3, 0.5})
    for (const double ratio : {1., 10.})
      for (const double s : {0.06, 1., 8.})
        EXPECT_NEAR(judgement::contact_size(judgement::problem_of(run_at(nu, ratio, s))) / s, 1,
                    1e-9);
}

/// x of min |F x - y|².
Eigen::Vector2d least_squares(const std::vector<Eigen::Vector2d>& features,
                              const std::vector<double>& values) {
  Eigen::MatrixX2d matrix(features.size(), 2);
  for (std::size_t i = 0; i < features.size(); ++i) matrix.row(long(i)) = features[i];
  return matrix.completeOrthogonalDecomposition().solve(
      Eigen::Map<const Eigen::VectorXd>(values.data(), long(values.size())));
}

/// The model's numbers are the least squares of one half of the runs; its stated errors are those
/// on the other half.
TEST(FiniteStrainLayer, IsFittedOnOneHalfOfTheRunsAndJudgedOnTheOther) {
  const judgement::AtlasFile& atlas = judgement::finite_strain_atlas().file();
  const PressureModel& linear = *find_pressure_model("bonded_layer");
  const auto& of_linear = atlas.errors.at("bonded_layer");
  const auto& of_model = atlas.errors.at("finite_strain_layer");
  struct Fitted {
    judgement::Quantity quantity;
    Eigen::Vector2d numbers;
    double stated;
  };
  for (const Fitted& fitted : {Fitted{judgement::Quantity::a, {-0.266, 0}, 0.014},
                               {judgement::Quantity::indentation, {-0.426, 0.058}, 0.011},
                               {judgement::Quantity::peak_pressure, {0.925, 0.169}, 0.016},
                               {judgement::Quantity::max_torque, {-0.378, 0.180}, 0.005}}) {
    const auto q = std::size_t(fitted.quantity);
    std::vector<Eigen::Vector2d> features;
    std::vector<double> logarithms;
    double worst = 0;
    int number = 0;
    for (std::size_t r = 0; r < atlas.runs.size(); ++r) {
      if (atlas.runs[r].kind != judgement::AtlasKind::finite_sphere) continue;
      if (number++ % 2 == 1) {
        worst = std::max(worst, std::abs(of_model[r][q]));
        continue;
      }
      const ContactProblem problem = judgement::problem_of(atlas.runs[r]);
      const Prediction found = linear.predict(problem);
      const double compressibility = 1 - 2 * problem.layer.poisson_ratio;
      features.emplace_back(
          compressibility / std::sqrt(compressibility + 0.1) * found.indentation_m,
          found.a_m * found.b_m / problem.radii.major_m / problem.radii.minor_m);
      logarithms.push_back(-std::log1p(of_linear[r][q]));
    }
    ASSERT_GE(features.size(), 20u);
    // The slope does not change the semi-axes, which therefore have one number only. The program
    // has three digits of the numbers; the file's errors have four.
    if (fitted.quantity == judgement::Quantity::a)
      for (Eigen::Vector2d& feature : features) feature[1] = 0;
    const Eigen::Vector2d numbers = least_squares(features, logarithms);
    EXPECT_NEAR(numbers[0], fitted.numbers[0], 2e-3) << judgement::kQuantityNames[q];
    EXPECT_NEAR(numbers[1], fitted.numbers[1], 2e-3) << judgement::kQuantityNames[q];
    EXPECT_LE(worst, fitted.stated) << judgement::kQuantityNames[q];
    std::printf("finite_strain_layer, %s: largest error on the other half %.4f\n",
                judgement::kQuantityNames[q], worst);
  }
}

/// The suite's silicone pads, of which it has seen nothing: paraboloids, R'/R'' to 5/3, nu to
/// 0.4999. The 3 % are what a correction was asked for.
TEST(FiniteStrainLayer, HoldsOnPadsThatItHasNotSeen) {
  const judgement::AtlasFile& atlas = judgement::finite_strain_atlas().file();
  const auto& errors = atlas.errors.at("finite_strain_layer");
  int pads = 0;
  for (std::size_t r = 0; r < atlas.runs.size(); ++r) {
    const judgement::AtlasRun& run = atlas.runs[r];
    if (run.kind != judgement::AtlasKind::finite_pad || run.poisson_ratio < 0.3)
      continue;  // its own limit
    ++pads;
    for (const judgement::Quantity quantity :
         {judgement::Quantity::a, judgement::Quantity::b, judgement::Quantity::indentation,
          judgement::Quantity::max_torque})
      EXPECT_LE(std::abs(errors[r][std::size_t(quantity)]), 0.03)
          << judgement::kQuantityNames[std::size_t(quantity)] << ", s " << run.s;
  }
  EXPECT_EQ(pads, 25);
}

}  // namespace
}  // namespace softfinger
