#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/layer/line_law.h"
#include "softfinger/math/dual.h"
#include "softfinger/pads/pad_model.h"

namespace softfinger {
namespace {

using Load = Dual<1>;  ///< with its derivative by the load

/// Ranges that the ends were fitted in: b/h, and length over h + b.
constexpr double kWidestFitted = 7, kShortestLine = 2.5;
/// Thicknesses between the contact and a side wall along it, by finite elements with nearer ones.
constexpr double kLeastWallDistance = 3;

/// The length that a free end takes from a line, in thicknesses, by the load that is missing there:
/// P = P' (L - 2 c). At nu = 0 plane strain is plane stress, and nothing is missing. A thin
/// compressible layer misses a length that depends on nu alone, others one that grows with the
/// contact's width; the latter's ends feel each other from far away. Eleven constants, fitted to 40
/// runs of finite elements (level 2, nu 0.3 to 0.499, b/h 0.1 to 6, length 3 to 30 h).
double missing_at_end(double poisson_ratio, double half_width, double length) noexcept {
  if (!(poisson_ratio > 0)) return 0;
  const double of_layer =
      6.3256 * std::pow(poisson_ratio, 3.3846) / std::pow(1 - 2 * poisson_ratio, 0.5201);
  double of_width = 3.1403 * std::pow(poisson_ratio, 3.5033) * std::pow(half_width, -0.1299) *
                    std::pow(1 + 6.9385 * half_width, 1.1222);
  of_width /= 1 + 2.7612 * std::pow(of_width / length, 0.4322);
  constexpr double kPower = 1.6194;
  return std::pow(std::pow(of_layer, -kPower) + std::pow(of_width, -kPower), -1 / kPower);
}

/// Depth of an end's missing load inside of it, in thicknesses: the centroid.
struct EndDepth {
  double least, per_missing, shortening;
  double operator()(double missing, double length) const noexcept {
    return 1 / (1 / (least + per_missing * missing) + shortening / length);
  }
};
constexpr EndDepth kDepthOfLoad{0.72296, 1.59979, 3.21045};
constexpr EndDepth kDepthOfStiffness{0.27933, 0.52048, 0.95573};
/// Missing stiffness at an end over missing load.
constexpr double kMissingStiffness = 1.0298;

/// The contact in the middle of the line.
struct MiddleOfLine {
  double half_width_m = 0, indentation_m = 0, peak_Pa = 0;
  double spread = 0;                   ///< int x² p dx/(P' b²)
  double stiffness_per_length_Pa = 0;  ///< dP'/dd
  double log_slope = 0;                ///< d ln P'/d ln d
};

MiddleOfLine middle_of(double load_per_length_N_per_m, double radius_m,
                       const ElasticLayer& layer) noexcept {
  const double h = layer.thickness_m, nu = layer.poisson_ratio;
  const double modulus_Pa = layer.youngs_modulus_Pa / (1 - nu * nu);
  const double unitless = load_per_length_N_per_m * radius_m / (modulus_Pa * h * h);
  const LineQuantities<Load> line =
      line_logarithms<1>(Load::variable(std::log(unitless), 0), Load(1 - 2 * nu));
  MiddleOfLine middle;
  const double b = h * std::exp(line[kWidth].value);
  middle.half_width_m = b;
  middle.indentation_m = b / radius_m * b * std::exp(line[kApproach].value);
  middle.peak_Pa = load_per_length_N_per_m / b * std::exp(line[kCrest].value);
  middle.spread = std::exp(line[kSpread].value);
  middle.log_slope = 1 / (line[kApproach].slope[0] + 2 * line[kWidth].slope[0]);
  middle.stiffness_per_length_Pa =
      load_per_length_N_per_m / middle.indentation_m * middle.log_slope;
  return middle;
}

/// Mean distance of the points of a line of half-length l from a point beside its middle.
double mean_distance(double beside_m, double l_m) noexcept {
  const double share = beside_m / l_m;
  return 0.5 * l_m * (std::hypot(1, share) + share * share * std::asinh(1 / share));
}

/// Places over the half-width, and weights that add up to 1, of a pressure like (1 - x²/b²)^g with
/// a spread of 1/(2 g + 3): Chebyshev's rule of the second kind, which is exact for g = 1/2.
constexpr std::size_t kPlaces = 4;
struct AcrossLine {
  std::array<double, kPlaces> place, weight;
};
AcrossLine across_line(double spread) noexcept {
  const double exponent = 0.5 * (1 / spread - 3);
  AcrossLine across;
  double sum = 0;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double angle = kPi * double(i + 1) / (2 * kPlaces + 1);
    across.place[i] = std::cos(angle);
    sum += across.weight[i] = std::pow(std::sin(angle), 2 * exponent + 1);
  }
  for (double& weight : across.weight) weight /= sum;
  return across;
}

class LineLayerModel final : public PadModel {
 public:
  explicit LineLayerModel(const ModelCard& card) : card_(card) {}

  const ModelCard& card() const noexcept override { return card_; }
  PadPrediction predict(const PadProblem& problem) const noexcept override;
  PadGradient gradient(const PadProblem&) const noexcept override { return {}; }
  double pressure_Pa(const PadProblem& problem,
                     const Eigen::Vector2d& point_m) const noexcept override;
  std::vector<PressureSample> slipping_pressure(const PadProblem& problem) const override;

 private:
  ModelCard card_;
};

/// The middle of a line under a load, whose ends are free.
struct LineWithEnds {
  MiddleOfLine middle;
  double missing = 0;       ///< c, in thicknesses
  double arm_length_m = 0;  ///< of a uniform line with the arm

  LineWithEnds(const PadProblem& problem, double load_N) noexcept {
    const double length_m = problem.shape->outline().extent_m().x(), h = problem.layer.thickness_m;
    const double length = length_m / h, nu = problem.layer.poisson_ratio;
    // The missing length depends on the contact's width, and the width little on that.
    constexpr int kRounds = 5;
    for (int round = 0; round < kRounds; ++round) {
      middle = middle_of(load_N / (length_m - 2 * h * missing), problem.cylinder->radius_m,
                         problem.layer);
      missing = std::min(0.4 * length, missing_at_end(nu, middle.half_width_m / h, length));
    }
    // The first moment of what is missing.
    const double depth = kDepthOfLoad(missing, length);
    arm_length_m =
        length_m - 2 * h * missing * (1 - 4 * depth / length) / (1 - 2 * missing / length);
  }
};

PadPrediction LineLayerModel::predict(const PadProblem& problem) const noexcept {
  PadPrediction result;
  if (!problem.cylinder) return result;
  const Eigen::Vector2d extent_m = problem.shape->outline().extent_m();
  const double h = problem.layer.thickness_m;
  const Eigen::Vector2d middle_m = problem.shape->outline().centroid_m();
  const double load_N = problem.load.normal_force_N, length = extent_m.x() / h;
  const LineWithEnds whole(problem, load_N);
  const MiddleOfLine& line = whole.middle;
  const double wide = line.half_width_m / h;
  const double to_wall =
      (0.5 * extent_m.y() - std::abs(problem.cylinder->offset_m - middle_m.y())) / h - wide;
  result.validity.add({"half_width_over_thickness_least", wide, kNarrowestLine, false,
                       "the contact is narrower than a fiftieth of the thickness"});
  result.validity.add({"half_width_over_thickness", wide, kWidestFitted, true,
                       "the contact is wider than the ends' part was fitted to; ask finite "
                       "elements"});
  result.validity.add({"length", length, kShortestLine * (1 + wide), false,
                       "the line is so short that its ends meet; ask finite elements"});
  result.validity.add({"to_the_side_wall", to_wall, kLeastWallDistance, false,
                       "the contact comes near the side walls along it, which let the rubber "
                       "bulge; ask finite elements"});
  result.validity.add({"strain", line.indentation_m / h, 0.1, true,
                       "the layer is compressed by more than a tenth: the theory is linear"});
  if (!(wide > kNarrowestLine && wide < kWidestLine)) return result;
  result.indentation_m = line.indentation_m;
  result.half_width_m = line.half_width_m;
  result.peak_pressure_Pa = line.peak_Pa;
  // dP/dd, ends included: their part grows with the load.
  constexpr double kApart = 1e-4;
  const double more_m = LineWithEnds(problem, load_N * (1 + kApart)).middle.indentation_m,
               less_m = LineWithEnds(problem, load_N * (1 - kApart)).middle.indentation_m;
  result.normal_stiffness_N_per_m = 2 * kApart * load_N / (more_m - less_m);
  result.centre_x_m = middle_m.x();
  result.centre_y_m = problem.cylinder->offset_m;
  const AcrossLine across = across_line(line.spread);
  for (std::size_t i = 0; i < kPlaces; ++i)
    result.pressure_arm_m += across.weight[i] * mean_distance(across.place[i] * line.half_width_m,
                                                              0.5 * whole.arm_length_m);
  result.eccentricity_m = result.pressure_arm_m;
  // About the line's own axis a cylinder rolls: no stiffness is stated. About the other one the
  // second moment of the line's stiffness without that of its ends counts.
  const double from_middle = 0.5 * length - kDepthOfStiffness(whole.missing, length);
  result.tilt_stiffness_Nm_per_rad[1] =
      line.stiffness_per_length_Pa * h * h * h *
      (std::pow(length, 3) / 12 -
       2 * kMissingStiffness * whole.missing * from_middle * from_middle);
  const double numbers[] = {result.indentation_m, result.normal_stiffness_N_per_m,
                            result.peak_pressure_Pa, result.pressure_arm_m};
  result.has_answer = std::all_of(std::begin(numbers), std::end(numbers), [](double number) {
    return std::isfinite(number) && number > 0;
  });
  if (result.has_answer) return result;
  PadPrediction none;
  none.validity = result.validity;
  return none;
}

double LineLayerModel::pressure_Pa(const PadProblem& problem,
                                   const Eigen::Vector2d& point_m) const noexcept {
  const PadPrediction line = predict(problem);
  if (!line.has_answer) return 0;
  const double across = (point_m.y() - line.centre_y_m) / line.half_width_m;
  const double along = std::abs(point_m.x() - line.centre_x_m);
  if (!(std::abs(across) < 1 && along < 0.5 * problem.shape->outline().extent_m().x())) return 0;
  const double spread = LineWithEnds(problem, problem.load.normal_force_N).middle.spread;
  const double exponent = 0.5 * (1 / spread - 3);
  return line.peak_pressure_Pa * std::pow(1 - across * across, exponent);
}

std::vector<PressureSample> LineLayerModel::slipping_pressure(const PadProblem& problem) const {
  std::vector<PressureSample> samples;
  const PadPrediction line = predict(problem);
  if (!line.has_answer) return samples;
  const LineWithEnds whole(problem, problem.load.normal_force_N);
  const AcrossLine across = across_line(whole.middle.spread);
  constexpr int kAlong = 120;
  const double share_N = problem.load.normal_force_N / (2 * kAlong);
  for (int i = 0; i < kAlong; ++i) {
    const double x_m = line.centre_x_m + whole.arm_length_m * ((i + 0.5) / kAlong - 0.5);
    for (std::size_t j = 0; j < kPlaces; ++j)
      for (const double side : {-1.0, 1.0})
        samples.push_back({x_m, line.centre_y_m + side * across.place[j] * line.half_width_m,
                           share_N * across.weight[j]});
  }
  return samples;
}

}  // namespace

const PadModel& line_layer() {
  static const LineLayerModel model = [] {
    ModelCard card;
    card.name = "line_layer";
    card.title = "cylinder on a flat pad, or a roller: a line contact with ends";
    card.assumptions =
        "The middle of the line is in plane strain, on a bonded layer without friction. At its "
        "free ends the rubber bulges out, which shortens the line by a length for the load, one "
        "for the arm and one for the tilt.";
    card.equations =
        "blend of Hertz's line (b² = 4 P' R/(pi E*)), the thin compressible (P' = 2 M b³/(3 R h)) "
        "and the thin incompressible layer (P' = E* b⁵/(30 h³ R)), times a table of exact "
        "solutions; P = P'(d) (L - 2 c h)";
    card.source =
        "limits: K. L. Johnson, Contact Mechanics, sections 4.2 and 5.8; ends: fitted to finite "
        "elements of this project";
    card.validity =
        "b/h from 0.02 to 7, length at least 2.5 (h + b), side walls at least three thicknesses "
        "from "
        "the contact, strain to 0.1, nu to 0.4999";
    card.cost = "about 9 microseconds";
    return LineLayerModel(card);
  }();
  return model;
}

}  // namespace softfinger
