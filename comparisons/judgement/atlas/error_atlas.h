#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/prediction/quantity.h"
#include "softfinger/accuracy/error_bound.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/pressure/pressure_model.h"

/// Errors of each model against finite elements, over all contacts of a quadric with a bonded
/// layer.
namespace softfinger::judgement {

using prediction::kQuantities;
using prediction::kQuantityNames;
using prediction::Quantity;
using prediction::QuantityErrors;

/// Kind of problem that a run of the finite elements solves.
enum class AtlasKind {
  flat,           ///< a paraboloid on a flat layer, linear
  curved,         ///< a plane on a round finger's layer, linear
  friction,       ///< a twist to full slip on a flat layer, linear
  finite_sphere,  ///< a sphere on a flat layer, finite strain
  finite_curved,  ///< a plane on a round finger's layer, finite strain
  finite_pad,     ///< a paraboloid on a flat layer, finite strain
  linear_sphere,  ///< the contacts of the three above, linear
  linear_curved,
  linear_pad,
  finger,        ///< a finger and an object, both curved, at finite strain
  rubbed_finger  ///< the same, pressed with friction from the first touch
};
constexpr std::array<const char*, 11> kAtlasKindNames = {
    "flat",          "curved",        "friction",   "finite_sphere", "finite_curved", "finite_pad",
    "linear_sphere", "linear_curved", "linear_pad", "finger",        "rubbed_finger"};
inline const char* name_of(AtlasKind kind) { return kAtlasKindNames[std::size_t(kind)]; }
bool is_finite_strain(AtlasKind kind);
inline bool is_finger(AtlasKind kind) {
  return kind == AtlasKind::finger || kind == AtlasKind::rubbed_finger;
}

/// A run of the finite elements. A contact on a flat layer depends on three numbers only: nu,
/// R'/R'' and s = sqrt(ab)/h. s is computed by the model bonded_layer.
struct AtlasRun {
  AtlasKind kind = AtlasKind::flat;
  double poisson_ratio = 0, radii_ratio = 1, s = 0;
  double thickness_over_radius =
      0;  ///< h/R of a curved finger, sphere or pad, R = sqrt(R' R''); else 0
  double friction_coefficient = 0;
  /// Curvature of a finger (kind "finger") along the long and the short axis over that of the gap,
  /// 1/R' and 1/R'', and its twist times sqrt(R' R''); the object has the rest. NaN for other
  /// kinds.
  double finger_share_x = kNaN, finger_share_y = kNaN, finger_share_xy = kNaN;
  /// a/h, b/h, d/h, area/h², peak pressure/E*, max torque/(mu P h).
  QuantityErrors answer{};
  QuantityErrors stated_error{};  ///< of the finite elements, relative; area: of a and b
  /// Twist to full slip, of kind "friction": stuck stiffness/(G h³), full-slip torque/(mu P h).
  double stiffness = 0, stiffness_error = 0, full_slip = 0, full_slip_error = 0;
  /// The coarser of the two meshes: signed relative difference from `answer`.
  QuantityErrors coarse_error{};
  double cost_s = 0,
         coarse_cost_s = 0;  ///< CPU, of both meshes; of the coarse one and what went before
};

/// Whether the answer depends on h/R, as it does at finite strain. Linear answers do not.
bool has_own_radius(const AtlasRun& run);

/// Contact problem of a run: h = 1 m, E* = 1 Pa, the load that gives its s.
ContactProblem problem_of(const AtlasRun& run);

/// Signed relative errors of a model's answer; NaN where it has none.
/// @param problem  `problem_of(run)`
QuantityErrors model_errors(const PressureModel& model, const AtlasRun& run,
                            const ContactProblem& problem);

/// The compact CSV: lines "# key: value" of provenance, a header, a row per run: what the finite
/// elements found, then for each model the signed errors.
struct AtlasFile {
  std::vector<std::pair<std::string, std::string>> provenance;
  std::vector<AtlasRun> runs;
  std::map<std::string, std::vector<QuantityErrors>> errors;  ///< by model, per run
};
std::string to_csv(const AtlasFile& atlas);
/// @throws InputError(file, line)
AtlasFile parse_atlas(const std::string& text, const std::string& file);

/// Bounds of a model's errors for a contact, from the atlas's finite-element runs with the nearest
/// parameters.
class ErrorAtlas {
 public:
  explicit ErrorAtlas(AtlasFile atlas);

  struct Estimate {
    std::optional<QuantityErrors> bound;  ///< of |relative error|
    QuantityErrors mean{};                ///< interpolated signed error; set with `bound`
    std::string outside;                  ///< why there is no bound: in words, for a reader
  };
  /// Multilinear between the runs, in ln s, ln R'/R'' and -ln(0.501 - nu), as stiffness grows near
  /// 1/2: |interpolated error| + half the spread of the corners' errors + a quarter of the finite
  /// elements' own stated error there. Never extrapolates.
  /// @param model  its name, or "fem": what the finite elements state of themselves at level 2
  /// @param kind  of the runs: flat, curved, finite_sphere or finite_curved
  /// @param thickness_over_radius  h/R, of all kinds but flat ones
  Estimate estimate(const std::string& model, const ContactProblem& problem,
                    AtlasKind kind = AtlasKind::flat, double thickness_over_radius = 0) const;

  /// The time of one answer as it was when the atlas was made, in ns; NaN for unknown models.
  double cost_ns(const std::string& model) const;

  const AtlasFile& file() const { return atlas_; }

 private:
  /// Runs on a grid of three coordinates.
  struct Grid {
    std::array<std::vector<double>, 3> values;
    std::vector<int> run;  ///< the last coordinate fastest; -1: missing
  };
  Grid grid_of(AtlasKind kind, double AtlasRun::*second) const;

  AtlasFile atlas_;
  std::map<AtlasKind, Grid> grids_;  ///< of flat ones (nu, R'/R'', s), of others (nu, h/R, s)
};

/// s = sqrt(ab)/h by the model bonded_layer. Runs and new contacts are placed on the grid by this
/// s. NaN if the model has no answer.
double contact_size(const ContactProblem& problem);

/// The atlas beside the program, read once.
/// @throws InputError when it is missing or damaged
const ErrorAtlas& error_atlas();

/// The one at finite strain, neo-Hookean with a quadratic volume energy. A "model" of it is
/// "fem_linear", the finite elements of linear theory.
const ErrorAtlas& finite_strain_atlas();

/// Whole fingers at finite strain, drawn at random, without errors of models.
const AtlasFile& finger_runs();

/// The one of them that is most like a contact: by ln s, ln R'/R'', ln h/R, -ln(0.501 - nu) and the
/// finger's part of the curvature. Null where the contact has no size.
const AtlasRun* nearest_finger_run(const ContactProblem& problem);

}  // namespace softfinger::judgement
