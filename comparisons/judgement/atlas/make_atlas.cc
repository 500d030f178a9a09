#include "comparisons/judgement/atlas/make_atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <random>

#include "comparisons/input/case.h"
#include "comparisons/judgement/median.h"
#include "comparisons/reference/fem_problem.h"
#include "comparisons/system/clock.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/progress.h"
#include "softfinger/geometry/relative_curvature.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/stack_models.h"

namespace softfinger::judgement {
namespace {

const std::vector<double> kPoissonRatios = {0, 0.15, 0.3, 0.4, 0.45, 0.475, 0.49, 0.4999, 0.5};
const std::vector<double> kRadiiRatios = {1, 2, 4, 10};
const std::vector<double> kSizes = {0.06, 0.1, 0.17, 0.28, 0.45, 0.75, 1.25, 2, 3.2, 5, 8};

/// A millimetre of rubber: the finite elements scale what they get, but sizes far from those of
/// fingers would be refused as wrong units.
constexpr double kThickness_m = 1e-3, kModulus_Pa = 1e6;

std::string name_of(const AtlasRun& run) {
  std::string name =
      fmt::format("{}_nu{:g}_ratio{:g}_s{:g}_hR{:g}_mu{:g}", name_of(run.kind), run.poisson_ratio,
                  run.radii_ratio, run.s, run.thickness_over_radius, run.friction_coefficient);
  if (is_finger(run.kind))
    name += fmt::format("_share{:g}_{:g}_{:g}", run.finger_share_x, run.finger_share_y,
                        run.finger_share_xy);
  return name;
}

/// A linear curved finger's own radius over the one of `problem_of`. s stays with the load times
/// the radius, indentation and pressure then go with the load.
double radius_scale(const AtlasRun& run, const ContactProblem& unit) {
  return run.kind == AtlasKind::curved ? 1 / run.thickness_over_radius / unit.radii.major_m : 1;
}

double load_of(const ContactProblem& unit, double scale) {
  return unit.load.normal_force_N / scale * kModulus_Pa * kThickness_m * kThickness_m;
}

bool is_on_curved_layer(const AtlasRun& run) {
  return run.kind == AtlasKind::curved || run.kind == AtlasKind::linear_curved ||
         run.kind == AtlasKind::finite_curved;
}
bool is_on_sphere(const AtlasRun& run) {
  return run.kind == AtlasKind::linear_sphere || run.kind == AtlasKind::finite_sphere;
}

/// A body with this curvature in the frame of the relative radii.
reference::PlacedBody placed_body(const SurfaceCurvature& curvature, input::FingerShape round) {
  input::QuadricBody body{1 / curvature.xx_per_m, 1 / curvature.yy_per_m, round, 0};
  double turn_rad = 0;
  // Without a twist the axes stay as they are: that keeps the symmetry which saves most of the
  // work.
  if (curvature.xy_per_m != 0) {
    const PrincipalCurvature principal = principal_curvature(
        {0.5 * curvature.xx_per_m, 0.5 * curvature.yy_per_m, curvature.xy_per_m});
    body.radius_x_m = principal.radii_m[0];
    body.radius_y_m = principal.radii_m[1];
    turn_rad = principal.axis_rad;
  }
  // No ellipsoid has a flat direction.
  if (std::isinf(body.radius_x_m) || std::isinf(body.radius_y_m))
    body.shape = input::FingerShape::paraboloid;
  return {body, turn_rad};
}

/// Both bodies of a run of kind "finger".
reference::FemProblem::Bodies bodies_of(const AtlasRun& run, const RelativeRadii& radii) {
  // From the shares, so that what is the finger's or the object's alone has no round-off.
  const double x_per_m = 1 / radii.major_m, y_per_m = 1 / radii.minor_m;
  const double xy_per_m = run.finger_share_xy / std::sqrt(radii.major_m * radii.minor_m);
  return {placed_body({run.finger_share_x * x_per_m, run.finger_share_y * y_per_m, xy_per_m},
                      input::FingerShape::ellipsoid),
          placed_body(
              {(1 - run.finger_share_x) * x_per_m, (1 - run.finger_share_y) * y_per_m, -xy_per_m},
              input::FingerShape::paraboloid)};
}

reference::FemProblem fem_problem_of(const AtlasRun& run) {
  const ContactProblem unit = problem_of(run);
  const double scale = radius_scale(run, unit);
  reference::FemProblem problem;
  problem.name = name_of(run);
  problem.radii = {kThickness_m * scale * unit.radii.major_m,
                   kThickness_m * scale * unit.radii.minor_m, 0};
  problem.layer = {kThickness_m, kModulus_Pa * unit.layer.youngs_modulus_Pa, run.poisson_ratio};
  problem.load_N = load_of(unit, scale);
  problem.shear_law = ShearLaw::coulomb(unit.load.friction_coefficient);
  if (is_finite_strain(run.kind)) problem.finite_strain.emplace();
  if (run.kind == AtlasKind::rubbed_finger) problem.pressing = PressingFriction::coulomb;
  const double radius_m = kThickness_m / run.thickness_over_radius;
  if (is_on_sphere(run)) problem.sphere_radius_m = radius_m;
  if (is_on_curved_layer(run)) {
    const input::QuadricBody finger{radius_m, radius_m, input::FingerShape::ellipsoid, 0};
    const input::QuadricBody plane{kInfinity, kInfinity, input::FingerShape::paraboloid, 0};
    problem.bodies = {{finger, 0}, {plane, 0}};
  }
  if (is_finger(run.kind)) problem.bodies = bodies_of(run, problem.radii);
  if (run.kind == AtlasKind::friction) problem.friction.emplace().torsion = true;
  return problem;
}

/// The numbers without units that AtlasRun wants.
void take_answer(const reference::ReferenceResult& result, AtlasRun& run) {
  const auto or_nan = [](const std::optional<double>& error) { return error.value_or(kNaN); };
  const ContactProblem unit = problem_of(run);
  const double scale = radius_scale(run, unit);
  const double h = kThickness_m, load_N = load_of(unit, scale);
  const double mu = unit.load.friction_coefficient;
  run.answer = {result.a_m / h,
                result.b_m / h,
                scale * result.indentation_m / h,
                result.area_projected_m2 / (h * h),
                scale * result.peak_pressure_Pa / kModulus_Pa,
                result.max_torque_Nm / (mu * load_N * h)};
  const reference::ReferenceLevel& coarse = result.levels.front();
  run.coarse_error = {coarse.a_m / result.a_m - 1,
                      coarse.b_m / result.b_m - 1,
                      coarse.indentation_m / result.indentation_m - 1,
                      kPi * coarse.a_m * coarse.b_m / result.area_projected_m2 - 1,
                      coarse.peak_pressure_Pa / result.peak_pressure_Pa - 1,
                      coarse.max_torque_Nm / result.max_torque_Nm - 1};
  run.cost_s = result.cpu_s;
  run.coarse_cost_s = run.cost_s - result.levels.back().cpu_s;
  const reference::ReferenceErrors& error = result.error;
  run.stated_error = {or_nan(error.a),
                      or_nan(error.b),
                      or_nan(error.indentation),
                      or_nan(error.area),
                      or_nan(error.peak_pressure),
                      or_nan(error.max_torque)};
  if (!result.twist) return;
  const double nu = run.poisson_ratio;
  const double shear_modulus_Pa = kModulus_Pa * unit.layer.youngs_modulus_Pa / (2 * (1 + nu));
  run.stiffness = result.twist->stiffness_Nm_per_rad / (shear_modulus_Pa * h * h * h);
  run.stiffness_error = or_nan(error.torsional_stiffness);
  run.full_slip = result.twist->full_slip_torque_Nm / (mu * load_N * h);
  run.full_slip_error = or_nan(error.full_slip_torque);
}

}  // namespace

std::vector<AtlasRun> designed_runs() {
  std::vector<AtlasRun> runs;
  const auto add = [&runs](AtlasKind kind, double nu, double ratio, double s, double curved,
                           double mu) {
    AtlasRun run;
    run.kind = kind;
    run.poisson_ratio = nu;
    run.radii_ratio = ratio;
    run.s = s;
    run.thickness_over_radius = curved;
    run.friction_coefficient = mu;
    runs.push_back(run);
  };
  for (const double ratio : kRadiiRatios)
    for (const double nu : kPoissonRatios)
      for (const double s : kSizes) add(AtlasKind::flat, nu, ratio, s, 0, 0.5);
  for (const double curved : {0.05, 0.15, 0.3})
    for (const double nu : {0.3, 0.45, 0.49})
      for (const double s : {0.3, 0.6, 1., 1.6}) {
        // a/R beyond 0.6 is no fingertip any more.
        if (s * curved <= 0.45) add(AtlasKind::curved, nu, 1, s, curved, 0.5);
      }
  for (const double mu : {0.2, 0.8, 1.5})
    for (const double nu : {0.3, 0.45, 0.4999})
      for (const double s : {0.2, 1., 3.2}) add(AtlasKind::friction, nu, 1, s, 0, mu);
  return runs;
}

/// The suite's silicone pads and the fingers of Ciocarlie et al. by their relative radii, from a
/// touch to a hard grip.
void add_pads(AtlasKind kind, std::vector<AtlasRun>& runs) {
  for (const char* name :
       {"silicone_pad_1mm", "silicone_pad_2mm", "silicone_pad_3mm", "seed_thumb_silicone",
        "seed_thumb", "seed_ring_finger", "nearly_incompressible"}) {
    const input::Case pad = input::read_case(system::find_case_file(name));
    const RelativeRadii radii = std::get<RelativeRadii>(pad.geometry);
    for (const double load_N : {0.01, 0.1, 1., 3., 10.}) {
      AtlasRun run;
      run.kind = kind;
      run.poisson_ratio = pad.layer.poisson_ratio;
      run.radii_ratio = radii.major_m / radii.minor_m;
      run.s = contact_size(pad.problem(radii, load_N));
      run.thickness_over_radius = pad.layer.thickness_m / std::sqrt(radii.major_m * radii.minor_m);
      run.friction_coefficient = 0.5;
      // Beyond d/h of 0.4 or so, as above, the layer is as good as pressed through.
      if (run.s * run.s * run.thickness_over_radius > (run.poisson_ratio > 0.4 ? 0.8 : 0.55))
        continue;
      runs.push_back(run);
    }
  }
}

std::vector<AtlasRun> finite_strain_runs() {
  std::vector<AtlasRun> runs;
  for (const AtlasKind kind : {AtlasKind::finite_sphere, AtlasKind::finite_curved,
                               AtlasKind::linear_sphere, AtlasKind::linear_curved})
    for (const double curved : {0.05, 0.15, 0.3})
      for (const double nu : {0.3, 0.45, 0.49})
        for (const double s : {0.3, 0.6, 1., 1.6, 2.5, 4.}) {
          // d/h is about s² h/R / 2, and half of it where the layer cannot change its volume.
          // Beyond 0.4 and a/R of 0.6 it is no fingertip any more.
          const double deepest = nu > 0.4 ? 0.8 : 0.55;
          if (s * s * curved > deepest || s * curved > 0.6) continue;
          AtlasRun run;
          run.kind = kind;
          run.poisson_ratio = nu;
          run.s = s;
          run.thickness_over_radius = curved;
          run.friction_coefficient = 0.5;
          runs.push_back(run);
        }
  for (const AtlasKind kind : {AtlasKind::finite_pad, AtlasKind::linear_pad}) add_pads(kind, runs);
  return runs;
}

namespace {

/// Not std::uniform_real_distribution: its numbers differ between libraries.
class Draws {
 public:
  explicit Draws(unsigned seed) : generator_(seed) {}
  double between(double lowest, double highest) {
    return lowest + (highest - lowest) * double(generator_() >> 11) * 0x1p-53;
  }
  double logarithmic(double lowest, double highest) {
    return std::exp(between(std::log(lowest), std::log(highest)));
  }
  /// 0 to 1/2, even in -ln(0.501 - nu).
  double poisson_ratio() { return 0.501 - logarithmic(0.001, 0.501); }

 private:
  std::mt19937_64 generator_;
};

/// Whether a fingertip can be pressed so: d/h is about s² h/R / 2, and half of it where the layer
/// cannot change its volume. Beyond a d/h of 0.4 the layer is as good as pressed through, beyond a
/// slope of 0.6 it is no fingertip any more.
bool is_a_fingertip(const AtlasRun& run) {
  const double deepest = run.poisson_ratio > 0.4 ? 0.8 : 0.55;
  if (run.s * run.s * run.thickness_over_radius > deepest) return false;
  const ContactProblem problem = problem_of(run);
  // A core must be left.
  const SurfaceCurvature& finger = problem.finger_curvature;
  const double largest_per_m =
      0.5 * (finger.xx_per_m + finger.yy_per_m) +
      std::hypot(0.5 * (finger.xx_per_m - finger.yy_per_m), finger.xy_per_m);
  if (problem.layer.thickness_m * largest_per_m > 0.85) return false;
  const Prediction found = find_pressure_model("bonded_layer")->predict(problem);
  return found.has_answer && found.a_m <= 0.6 * problem.radii.major_m &&
         found.b_m <= 0.6 * problem.radii.minor_m;
}

}  // namespace

std::vector<AtlasRun> random_fingers(int count, unsigned seed) {
  Draws draws(seed);
  std::vector<AtlasRun> runs;
  while (int(runs.size()) < count) {
    AtlasRun run;
    run.kind = AtlasKind::finger;
    // Few foams would be drawn by the stiffness alone.
    run.poisson_ratio = draws.between(0, 1) < 0.5 ? draws.between(0, 0.5) : draws.poisson_ratio();
    run.radii_ratio = draws.between(0, 1) < 1. / 3 ? 1 : draws.logarithmic(1, 20);
    const double who_is_curved = draws.between(0, 1);
    // A thicker layer leaves no core in a finger, but may lie flat under an object.
    const bool flat = who_is_curved > 0.4 && who_is_curved <= 0.6;
    run.thickness_over_radius = draws.logarithmic(0.005, flat ? 5 : 0.6);
    run.s = draws.logarithmic(0.02, 20);
    run.friction_coefficient = 0.5;
    run.finger_share_x = run.finger_share_y = 1;
    run.finger_share_xy = 0;
    if (who_is_curved > 0.4) run.finger_share_x = run.finger_share_y = 0;
    if (who_is_curved > 0.6) {
      run.finger_share_x = draws.between(0, 1);
      run.finger_share_y = draws.between(0, 1);
    }
    if (is_a_fingertip(run)) runs.push_back(run);
  }
  return runs;
}

std::vector<AtlasRun> random_fingertips(int count, unsigned seed) {
  Draws draws(seed);
  const auto is_below = [&](double chance) { return draws.between(0, 1) < chance; };
  std::vector<AtlasRun> runs;
  while (int(runs.size()) < count) {
    AtlasRun run;
    run.kind = AtlasKind::finger;
    run.poisson_ratio = is_below(0.5) ? draws.between(0, 0.5) : draws.poisson_ratio();
    run.friction_coefficient = 0.5;
    // Lengths in h; a third of the fingers is round.
    const double finger_minor = 1 / draws.logarithmic(0.01, 0.5);
    const double finger_major = finger_minor * (is_below(1. / 3) ? 1 : draws.logarithmic(1, 10));
    // A quarter of the objects is flat, of the others three in eight are hollow; half of all that
    // are not flat are cylinders.
    double object_x = kInfinity, object_y = kInfinity;
    if (!is_below(0.25)) {
      const bool hollow = is_below(0.375);
      const auto radius = [&] {
        return hollow ? -finger_minor * draws.logarithmic(1.2, 10)
                      : finger_minor * draws.logarithmic(0.3, 10);
      };
      object_x = radius();
      if (is_below(0.5)) object_y = radius();
    }
    const double which = draws.between(0, 1);
    const double angle_rad = which < 0.4   ? 0
                             : which < 0.8 ? 0.5 * kPi
                                           : draws.between(0, 0.5 * kPi);
    const RelativeCurvature gap = relative_curvature(
        quadric_from_radii(finger_major, finger_minor), Eigen::Matrix3d::Zero(),
        quadric_from_radii(object_x, object_y), Eigen::Matrix3d::Zero(), angle_rad);
    // Loads even in ln s would hardly press a finger; half of these are pressed hard.
    const double least_strain = is_below(0.5) ? 0.1 : 0;
    // Small contacts without symmetry take minutes, and depart from a flat layer in d only.
    run.s = draws.logarithmic(which < 0.8 ? 0.05 : 0.5, 8);
    if (gap.kind != ContactKind::elliptic) continue;
    const RelativeRadii& radii = gap.radii;
    run.radii_ratio = radii.major_m / radii.minor_m;
    run.thickness_over_radius = 1 / std::sqrt(radii.major_m * radii.minor_m);
    const SurfaceCurvature finger = curvature_along(finger_major, finger_minor, radii.axis_rad);
    const auto settled = [](double share) { return std::abs(share) < 1e-9 ? 0 : share; };
    run.finger_share_x = finger.xx_per_m * radii.major_m;
    run.finger_share_y = finger.yy_per_m * radii.minor_m;
    run.finger_share_xy = settled(finger.xy_per_m * std::sqrt(radii.major_m * radii.minor_m));
    if (run.radii_ratio > 20 || run.thickness_over_radius > 2 || !is_a_fingertip(run)) continue;
    const Prediction found = find_pressure_model("bonded_layer")->predict(problem_of(run));
    if (found.indentation_m < least_strain || found.indentation_m > 0.42 ||
        found.a_m > 0.5 * radii.major_m || found.b_m > 0.5 * radii.minor_m)
      continue;
    runs.push_back(run);
  }
  return runs;
}

std::vector<AtlasRun> random_rubbed_fingertips(int count, unsigned seed) {
  std::vector<AtlasRun> runs = random_fingertips(count, seed);
  Draws draws(seed);
  for (AtlasRun& run : runs) {
    run.kind = AtlasKind::rubbed_finger;
    run.friction_coefficient = draws.logarithmic(0.05, 1.5);
  }
  return runs;
}

std::vector<AtlasRun> random_runs(int count, unsigned seed) {
  Draws draws(seed);
  std::vector<AtlasRun> runs;
  for (int i = 0; i < count; ++i) {
    AtlasRun run;
    run.kind = AtlasKind::flat;
    run.poisson_ratio = draws.poisson_ratio();
    run.radii_ratio = draws.logarithmic(kRadiiRatios.front(), kRadiiRatios.back());
    run.s = draws.logarithmic(kSizes.front(), kSizes.back());
    run.friction_coefficient = 0.5;
    runs.push_back(run);
  }
  return runs;
}

std::vector<reference::FemJob> atlas_jobs(const std::vector<AtlasRun>& runs,
                                          const std::filesystem::path& folder) {
  std::vector<reference::FemJob> jobs;
  for (const AtlasRun& run : runs) {
    reference::FemJob job;
    job.title = name_of(run);
    job.problem = fem_problem_of(run);
    job.file = folder / (job.title + ".json");
    job.weight =
        run.radii_ratio + (is_finite_strain(run.kind) ? 100 * run.thickness_over_radius : 0);
    // A process per run: on a larger contact's meshes errors would be stated larger.
    job.group = jobs.size();
    jobs.push_back(std::move(job));
  }
  return jobs;
}

std::optional<AtlasFile> collect_atlas(const std::vector<AtlasRun>& runs,
                                       const std::vector<reference::FemJob>& jobs,
                                       const reference::FemJobOptions& settings,
                                       const std::string& command, bool without_failed) {
  AtlasFile atlas;
  std::size_t missing = 0;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    const auto result = reference::finished_result(jobs[run], settings).result;
    if (result) {
      atlas.runs.push_back(runs[run]);
      take_answer(*result, atlas.runs.back());
    } else {
      ++missing;
    }
  }
  if (missing > 0 && without_failed)
    system::Progress().say(fmt::format("{} of {} runs failed, left out", missing, runs.size()));
  else if (missing > 0) {
    system::Progress().say(fmt::format("{} of {} runs are not finished; the same command goes on",
                                       missing, runs.size()));
    return std::nullopt;
  }
  atlas.provenance = {{"version", system::program_version()},
                      {"date", system::utc_now("%Y-%m-%d")},
                      {"command", command}};
  judge_models(atlas);
  return atlas;
}

AtlasOutcome make_atlas(const std::vector<AtlasRun>& runs, const AtlasOptions& options) {
  const system::OutputFolder folder(options.folder);
  reference::FemJobOptions settings;
  settings.program = system::fem_program().string();
  settings.identity = reference::program_identity(settings.program);
  settings.parallel = options.jobs;
  settings.limits = options.fem_limits;
  const std::vector<reference::FemJob> jobs = atlas_jobs(runs, options.folder);
  system::Progress progress;
  const auto pending =
      reference::pending_fem_jobs(jobs, settings, progress, [](const auto&, const auto&) {});
  reference::FemJobProgress shown(progress, jobs.size(), pending, options.jobs);
  AtlasOutcome outcome;
  outcome.signal = reference::run_fem_jobs(
      pending, settings,
      [&](const reference::FemJob& job, const std::string& line) { shown.line(job, line); },
      [&](const reference::FemJob& job, const reference::FemAnswer& answer) {
        shown.finished(job, describe(answer));
      });
  outcome.atlas = collect_atlas(runs, jobs, settings, options.command,
                                options.without_failed && outcome.signal == 0);
  return outcome;
}

namespace {

/// The kind of the same contacts in linear elasticity.
std::optional<AtlasKind> linear_counterpart(AtlasKind kind) {
  if (is_finger(kind)) return std::nullopt;
  if (kind == AtlasKind::finite_sphere) return AtlasKind::linear_sphere;
  return kind == AtlasKind::finite_curved ? AtlasKind::linear_curved : AtlasKind::linear_pad;
}

/// Adds the errors of the linear finite elements, relative to those at finite strain on the same
/// contacts.
void judge_linear_theory(AtlasFile& atlas) {
  auto& errors = atlas.errors["fem_linear"];
  for (const AtlasRun& run : atlas.runs) {
    errors.emplace_back().fill(is_finite_strain(run.kind) ? kNaN : 0);
    if (!is_finite_strain(run.kind)) continue;
    const std::optional<AtlasKind> kind = linear_counterpart(run.kind);
    if (!kind) errors.back().fill(kNaN);
    for (const AtlasRun& linear : atlas.runs)
      if (linear.kind == kind && linear.poisson_ratio == run.poisson_ratio && linear.s == run.s &&
          linear.radii_ratio == run.radii_ratio &&
          linear.thickness_over_radius == run.thickness_over_radius)
        for (std::size_t q = 0; q < kQuantities; ++q)
          errors.back()[q] = linear.answer[q] / run.answer[q] - 1;
  }
}

}  // namespace

void judge_models(AtlasFile& atlas) {
  const bool finite_strain =
      std::any_of(atlas.runs.begin(), atlas.runs.end(),
                  [](const AtlasRun& run) { return is_finite_strain(run.kind); });
  atlas.errors.clear();
  if (finite_strain) judge_linear_theory(atlas);
  auto& provenance = atlas.provenance;
  provenance.erase(
      std::remove_if(provenance.begin(), provenance.end(),
                     [](const auto& line) { return line.first.rfind("cost", 0) == 0; }),
      provenance.end());
  std::vector<double> costs_ns;
  for (const AtlasRun& run : atlas.runs)
    if ((run.kind == AtlasKind::flat || is_finite_strain(run.kind)) && std::isfinite(run.cost_s))
      costs_ns.push_back(1e9 * run.cost_s);
  if (!costs_ns.empty())
    provenance.emplace_back("cost_ns fem", fmt::format("{:.3g}", median(costs_ns)));
  for (const PressureModel* model : all_pressure_models()) {
    // A measured law holds for the finger that it was fitted to, not for the atlas's layers.
    if (model->card().is_empirical) continue;
    // Layers of the atlas are homogeneous.
    if (is_for_stacks(*model)) continue;
    // The linear runs have no finite strain, and their contacts no radius: a model that corrects
    // for large strain cannot be compared with them.
    if (model->card().finite_strain && !finite_strain) continue;
    auto& errors = atlas.errors[std::string(model->card().name)];
    costs_ns.clear();
    for (const AtlasRun& run : atlas.runs) {
      const ContactProblem problem = problem_of(run);
      const auto start = std::chrono::steady_clock::now();
      errors.push_back(model_errors(*model, run, problem));
      if (!std::isfinite(errors.back()[0])) continue;  // it said no, which is cheap
      costs_ns.push_back(
          std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start)
              .count());
    }
    if (!model->card().hot_path &&
        !costs_ns.empty())  // the others are measured anew where they are asked for
      provenance.emplace_back(fmt::format("cost_ns {}", model->card().name),
                              fmt::format("{:.3g}", median(costs_ns)));
  }
}

}  // namespace softfinger::judgement
