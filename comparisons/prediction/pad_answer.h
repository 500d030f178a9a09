#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/prediction/quantity.h"
#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/friction/sampled_pressure.h"
#include "softfinger/pads/pad_error.h"
#include "softfinger/pads/pad_model.h"

/// Answers of the flat pads' models.
namespace softfinger::prediction {

/// Share of the pad's face below which an object's edge within it counts.
constexpr double kCovered = 0.98;

/// One model's answer at one load, with its bound against finite elements of the pad.
struct PadAnswer {
  const PadModel* model = nullptr;
  PadProblem problem;
  PadPrediction prediction;
  std::optional<PadErrors> bound;  ///< none: not known, `evidence` says why
  std::string evidence;
  bool usable = false;  ///< the demanded quantities of a pad are within the tolerance
  double cost_ns = 0;

  ConvexOutline face = ConvexOutline::disc(1);  ///< where pad and object overlap
  /// The pad's contact; under a cylinder the rectangle of its length and 2 b.
  ConvexOutline contact() const;
  FrictionEllipsoid friction_ellipsoid() const {
    return {problem.load.friction_coefficient * problem.load.normal_force_N,
            prediction.eccentricity_m};
  }
  double area_m2() const;  ///< that carries
  /// Relative bound of a quantity; infinite where it is not known. The area of a pad that has not
  /// lifted off is that of the outline, whose error is the case's own; semi-axes it has none, and
  /// they ask for nothing.
  double bound_of(Quantity quantity) const;
};

/// "all" or "everything", or names separated by commas: of the models of flat faces, or under a
/// cylinder of the one of lines.
/// @throws InputError that names the pads' models for another name
std::vector<const PadModel*> pad_models_by_name(const std::string& names,
                                                bool under_cylinder = false);

/// The outline of a pad without a fillet that bears as the case's own does: rubber beside the face
/// helps to carry. With r the fillet's radius it lies further out by 0.95 r/(1 + 1.75 r/h), which
/// was fitted to the arms of finite elements of rectangles; without a fillet, and beside a smaller
/// face, it is the contact.
ConvexOutline bearing_outline(const input::Case& contact_case);

/// @param shape     of the case's `bearing_outline`; outlives the answer
/// @param budget_ns  time for repeated calls that measure the cost
PadAnswer ask_pad_model(const PadModel& model, const input::Case& contact_case,
                        const PadShape& shape, double load_N, const Demand& demand,
                        double budget_ns);

/// @throws InputError that says how far the load may go, where nearly all of the face has lifted
/// off
void refuse_tipping(const input::PadPair& pair, const PadAnswer& answer);

/// Approach of the faces where the load acts, as finite elements have it; in the middle it is
/// `indentation_m`.
double indentation_at_load_m(const PadAnswer& answer);

/// Exact limit surface of the pad by its sampled pressure at full slip.
SampledPressure limit_surface_of(const PadAnswer& answer);

/// Largest deviations of the friction ellipsoid, out of (negative) and into the exact surface, over
/// evenly spread twists.
struct PadEllipsoidDeviation {
  double lowest = 0, highest = 0;
};
PadEllipsoidDeviation ellipsoid_deviation_of(const PadAnswer& answer,
                                             const SampledPressure& surface);

/// @param limit_surface_points  0: none
nlohmann::json to_json(const PadAnswer& answer, int limit_surface_points);

/// "flat pad, 22 x 37.5 mm of contact, 824 mm², shape factor S = 3.4": what is in contact.
std::string describe(const input::PadPair& pair, const ElasticLayer& layer);

}  // namespace softfinger::prediction
