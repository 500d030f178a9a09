#include "fem/pad/solve_pad.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "fem/base/formatted.h"
#include "fem/base/memory.h"
#include "fem/base/stopwatch.h"
#include "fem/friction/friction_study.h"
#include "fem/pad/check_pad.h"
#include "fem/pad/pad_contact.h"
#include "fem/pad/solve_curved_object.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using Eigen::Vector2d;

/// Part of the face in which the peak of the pressure is looked for.
constexpr double inner_share = 0.95;

std::array<double, 2> pair_of(const Vector2d& vector) { return {vector.x(), vector.y()}; }
std::array<double, 2> swapped(const Vector2d& vector) { return {vector.y(), vector.x()}; }

/// Turns numbers of the model (h = E = 1) into SI.
struct Units {
  double length_m, stress_Pa;

  double force_N(double force) const { return stress_Pa * length_m * length_m * force; }
  double moment_Nm(double moment) const { return length_m * force_N(moment); }
  double stiffness_N_per_m(double stiffness) const { return stress_Pa * length_m * stiffness; }
};

/// A mesh's answer before it is put into SI: the pressed face and what presses it.
struct LevelAnswer {
  PadLevel level;
  PressedFace pressed, frictionless;
  FaceLoad load;
  Vector2d centre = Vector2d::Zero();
};

class PadSolver {
 public:
  PadSolver(const PadProblem& problem, const PadPlan& plan)
      : problem_(problem), plan_(plan), units_{problem.thickness_m, problem.youngs_modulus_Pa} {}

  std::shared_ptr<const FaceResponse> respond(int level, LevelAnswer& answer,
                                              PadCache& cache) const {
    for (const auto& [solved, kept] : cache.levels)
      if (solved.level == level) {
        answer.level = solved;
        return kept;
      }
    const PadCells cells = cells_of_level(plan_.geometry, level);
    PadModel model(mesh_pad(plan_.geometry, cells), plan_.geometry.planes, problem_.poisson_ratio);
    auto face = std::make_shared<const FaceResponse>(model);
    answer.level.level = level;
    answer.level.cells_across = cells.across;
    answer.level.cells_deep = cells.deep;
    answer.level.unknowns = model.unknowns();
    answer.level.face_nodes = static_cast<int>(model.nodes().size());
    cache.levels.emplace_back(answer.level, face);
    return face;
  }

  void press(const FaceResponse& face, LevelAnswer& answer) const {
    answer.centre = stiffness_centre(face, problem_.pressing);
    answer.load = load_on(face, problem_.pressing);
    answer.pressed = press_face(face, problem_.pressing, answer.load);
    answer.frictionless =
        problem_.pressing == PadPressing::frictionless
            ? answer.pressed
            : press_face(face, PadPressing::frictionless, load_on(face, PadPressing::frictionless));
    // Coarse elements pull at the singular corners of a stuck rim even under a load in the middle.
    if (problem_.pressing == PadPressing::stuck && problem_.load_point_m &&
        has_tension(answer.pressed))
      refuse_tension(face);
    describe(face, answer);
  }

 private:
  FaceLoad load_on(const FaceResponse& face, PadPressing pressing) const {
    const double force = problem_.load_N / units_.force_N(1);
    if (!problem_.load_point_m) return {force, stiffness_centre(face, pressing)};
    const Vector2d at_m((*problem_.load_point_m)[0], (*problem_.load_point_m)[1]);
    return {force, (at_m - plan_.origin_m) / units_.length_m};
  }

  [[noreturn]] void refuse_tension(const FaceResponse& face) const {
    const Vector2d limit_m = units_.length_m * tilt_limit(face, problem_.pressing, /*free=*/false);
    const std::array<double, 2> at = problem_.load_point_m.value_or(std::array<double, 2>{});
    throw InputError(problem_.name, "load_point_m", formatted("%g, %g", at[0], at[1]),
                     formatted("a stuck face has to be pressed everywhere: up to %.3g mm from the "
                               "middle along x, %.3g mm along y; a frictionless one lifts off",
                               1e3 * limit_m.x(), 1e3 * limit_m.y()));
  }

  void describe(const FaceResponse& face, LevelAnswer& answer) const {
    PadLevel& level = answer.level;
    const PadPressing pressing = problem_.pressing;
    const double load_N = problem_.load_N;
    level.area_m2 = units_.length_m * units_.length_m * face.area();
    const double parallel = pressing == PadPressing::stuck
                                ? face.stuck_resultants()(approach, approach)
                                : face.frictionless_resultants()(approach, approach);
    level.normal_stiffness_N_per_m = units_.stiffness_N_per_m(parallel);
    const Eigen::Vector3d& motion = answer.pressed.motion;
    level.indentation_m = units_.length_m * (motion[0] + motion.tail<2>().dot(answer.load.at));
    level.peak_pressure_Pa = units_.stress_Pa * peak_within(face, plan_.geometry.contact,
                                                            answer.pressed.force, inner_share);
    level.pressure_arm_m = units_.length_m * arm_of(face, answer.pressed.force).arm;
    level.eccentricity_m = units_.length_m * arm_of(face, answer.frictionless.force).arm;
    level.max_torque_Nm = problem_.friction_coefficient * load_N * level.eccentricity_m;
    const auto moment = [&](double in_model) { return units_.moment_Nm(in_model); };
    // A tilt along x turns about y.
    level.tilt_stiffness_Nm_per_rad =
        swapped(moment(1) * tilt_stiffness(face, pressing, /*free=*/false));
    level.free_tilt_stiffness_Nm_per_rad =
        swapped(moment(1) * tilt_stiffness(face, pressing, /*free=*/true));
    const double moment_of_load_Nm = units_.length_m * load_N;
    level.tilt_limit_Nm = swapped(moment_of_load_Nm * tilt_limit(face, pressing, /*free=*/false));
    level.free_tilt_limit_Nm =
        swapped(moment_of_load_Nm * tilt_limit(face, pressing, /*free=*/true));
    const auto& stuck = face.stuck_resultants();
    level.torsional_stiffness_Nm_per_rad = moment(torsional_stiffness(face));
    level.shear_stiffness_N_per_m = {units_.stiffness_N_per_m(stuck(shear_x, shear_x)),
                                     units_.stiffness_N_per_m(stuck(shear_y, shear_y))};
    level.shear_moment_Nm_per_m = {units_.force_N(stuck(tilt_x, shear_x)),
                                   units_.force_N(stuck(tilt_y, shear_y))};
  }

  const PadProblem& problem_;
  const PadPlan& plan_;
  const Units units_;
};

/// Two levels' answer on one quantity.
struct Extrapolated {
  double value, error;  ///< the latter relative
};

/// Integrals over pad and face converge with the cube of the cells' size or a little faster: 2.9 to
/// 3.6 was observed on discs, rectangles and punches with nu 0.3 and 0.49. They are extrapolated by
/// the cube, and 0.6 of that correction is stated. A peak or a limit is that of single nodes: the
/// finer level's own value, with an error of the first order.
class TwoLevels {
 public:
  TwoLevels(const PadLevel& coarse, const PadLevel& fine)
      : ratio_(static_cast<double>(fine.cells_across) / coarse.cells_across),
        is_coarse_(fine.level < 2) {}

  Extrapolated integral(double coarse, double fine) const {
    constexpr double order = 3, stated = 0.6;
    const double correction = (fine - coarse) / (std::pow(ratio_, order) - 1);
    const double value = fine + correction;
    const double common = is_coarse_ ? 2e-3 : 5e-4;
    return {value, relative(stated * correction, value) + common};
  }
  Extrapolated node(double coarse, double fine) const {
    constexpr double order = 1.5, common = 2e-2;
    return {fine, relative((fine - coarse) / (std::pow(ratio_, order) - 1), fine) + common};
  }

 private:
  static double relative(double change, double value) {
    return value == 0 ? 0 : std::abs(change / value);
  }

  double ratio_;
  bool is_coarse_;
};

/// Puts the extrapolated quantities in the place of the finer level's and states their errors.
void extrapolate(const PadLevel& coarse, PadLevel& fine, PadError& error) {
  const TwoLevels levels(coarse, fine);
  const auto put = [](const Extrapolated& found, double& value, double& stated) {
    value = found.value;
    stated = found.error;
  };
  const auto integral = [&](auto PadLevel::*quantity, auto PadError::*stated) {
    auto &value = fine.*quantity, &told = error.*stated;
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>)
      put(levels.integral(coarse.*quantity, value), value, told);
    else
      for (std::size_t i = 0; i < value.size(); ++i)
        put(levels.integral((coarse.*quantity)[i], value[i]), value[i], told[i]);
  };
  const auto limit = [&](std::array<double, 2> PadLevel::*quantity,
                         std::array<double, 2> PadError::*stated) {
    for (std::size_t i = 0; i < 2; ++i)
      put(levels.node((coarse.*quantity)[i], (fine.*quantity)[i]), (fine.*quantity)[i],
          (error.*stated)[i]);
  };
  integral(&PadLevel::normal_stiffness_N_per_m, &PadError::normal_stiffness);
  integral(&PadLevel::indentation_m, &PadError::indentation);
  integral(&PadLevel::pressure_arm_m, &PadError::pressure_arm);
  integral(&PadLevel::eccentricity_m, &PadError::eccentricity);
  integral(&PadLevel::max_torque_Nm, &PadError::max_torque);
  integral(&PadLevel::tilt_stiffness_Nm_per_rad, &PadError::tilt_stiffness);
  integral(&PadLevel::free_tilt_stiffness_Nm_per_rad, &PadError::free_tilt_stiffness);
  integral(&PadLevel::torsional_stiffness_Nm_per_rad, &PadError::torsional_stiffness);
  integral(&PadLevel::shear_stiffness_N_per_m, &PadError::shear_stiffness);
  limit(&PadLevel::tilt_limit_Nm, &PadError::tilt_limit);
  limit(&PadLevel::free_tilt_limit_Nm, &PadError::free_tilt_limit);
  put(levels.node(coarse.peak_pressure_Pa, fine.peak_pressure_Pa), fine.peak_pressure_Pa,
      error.peak_pressure);
}

/// Numbers that the two meshes depend on.
std::vector<double> key_of(const PadProblem& problem) {
  std::vector<double> key{static_cast<double>(problem.level), problem.thickness_m,
                          problem.poisson_ratio};
  const auto add = [&](const FlatShape& shape) {
    key.push_back(static_cast<double>(shape.kind));
    key.insert(key.end(),
               {shape.radius_m, shape.lengths_m[0], shape.lengths_m[1], shape.corner_radius_m});
    for (const auto& point : shape.points_m) key.insert(key.end(), point.begin(), point.end());
  };
  add(problem.outline);
  if (problem.face) {
    add(problem.face->shape);
    key.insert(key.end(),
               {problem.face->offset_m[0], problem.face->offset_m[1], problem.face->angle_rad});
  }
  return key;
}

/// Full slip with each velocity, about the pressure's centre. Friction acts along the velocity of
/// the object; pressure is that of frictionless pressing, which full slip brings back.
std::vector<Wrench> limit_surface(const FaceResponse& face, const Eigen::VectorXd& force,
                                  double friction_coefficient, int points, const Units& units) {
  std::vector<Wrench> surface;
  if (points == 0) return surface;
  const PressureArm centred = arm_of(face, force);
  const Eigen::VectorXd pressure = face.pressure_of(force);
  for (const PlaneMotion& velocity : spread_velocities(points, centred.arm)) {
    const auto component = [&](int wanted) {
      return face.integral(pressure, [&](const Vector2d& place, double p) {
        const Vector2d arm = place - centred.centre;
        const Vector2d slip(velocity.x - velocity.turn_rad * arm.y(),
                            velocity.y + velocity.turn_rad * arm.x());
        const double speed = slip.norm();
        if (!(speed > 0)) return 0.0;
        const Vector2d traction = friction_coefficient * p / speed * slip;
        if (wanted < 2) return traction[wanted];
        return arm.x() * traction.y() - arm.y() * traction.x();
      });
    };
    surface.push_back(
        {units.force_N(component(0)), units.force_N(component(1)), units.moment_Nm(component(2))});
  }
  return surface;
}

PadPressure samples(const FaceResponse& face, const Eigen::VectorXd& force, const Units& units,
                    const Vector2d& origin_m) {
  PadPressure result;
  for (Eigen::Index i = 0; i < face.size(); ++i) {
    const Vector2d at_m = origin_m + units.length_m * face.place().col(i);
    result.x_m.push_back(at_m.x());
    result.y_m.push_back(at_m.y());
    result.pressure_Pa.push_back(units.stress_Pa * force[i] / face.weight()[i]);
    result.weight_m2.push_back(units.length_m * units.length_m * face.weight()[i]);
  }
  return result;
}

}  // namespace

PadResult solve_pad(const PadProblem& problem, const Progress& progress, const StopRequested& stop,
                    PadCache* cache) {
  if (problem.object) return solve_curved_object(problem, progress, stop);
  const PadPlan plan = plan_pad(problem);
  const Stopwatch watch;
  const PadSolver solver(problem, plan);
  const Units units{problem.thickness_m, problem.youngs_modulus_Pa};
  PadResult result;
  result.planes = plan.geometry.planes;
  LevelAnswer answer;
  std::shared_ptr<const FaceResponse> face;
  PadCache none;
  PadCache& kept = cache ? *cache : none;
  if (kept.key != key_of(problem)) kept = {key_of(problem), {}};
  for (int level = problem.level - 1; level <= problem.level; ++level) {
    if (stop()) throw Interrupted();
    const Stopwatch of_level;
    face.reset();
    answer = {};
    face = solver.respond(level, answer, kept);
    solver.press(*face, answer);
    answer.level.cpu_s = of_level.cpu_seconds();
    progress(formatted("level %d: %ld unknowns, d %.6g m, %.2f s", level, answer.level.unknowns,
                       answer.level.indentation_m, of_level.seconds()));
    result.levels.push_back(answer.level);
  }
  result.finest = answer.level;
  extrapolate(result.levels.front(), result.finest, result.error);
  const auto in_pad_m = [&](const Vector2d& place) {
    return pair_of(plan.origin_m + units.length_m * place);
  };
  result.load_point_m = in_pad_m(answer.load.at);
  result.stiffness_centre_m = in_pad_m(answer.centre);
  result.tilt_rad = pair_of(answer.pressed.motion.tail<2>());
  result.centre_of_pressure_m = in_pad_m(arm_of(*face, answer.pressed.force).centre);
  result.uniform_arm_m = units.length_m * arm_of(*face, face->weight()).arm;
  result.lifted_share = answer.pressed.lifted_area / face->area();
  result.pressure = samples(*face, answer.pressed.force, units, plan.origin_m);
  result.limit_surface = limit_surface(*face, answer.frictionless.force,
                                       problem.friction_coefficient, problem.limit_surface, units);
  result.wall_s = watch.seconds();
  result.cpu_s = watch.cpu_seconds();
  result.peak_memory_MB = peak_memory_MB();
  return result;
}

}  // namespace softfinger::fem
