#include "fem/pad/solve_pad.h"

#include <algorithm>
#include <cmath>

#include "fem/base/formatted.h"
#include "fem/base/memory.h"
#include "fem/base/stopwatch.h"
#include "fem/friction/friction_study.h"
#include "fem/pad/check_pad.h"
#include "fem/pad/pad_contact.h"
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

  std::unique_ptr<FaceResponse> respond(int level, LevelAnswer& answer) const {
    const PadCells cells = cells_of_level(plan_.geometry, level);
    PadModel model(mesh_pad(plan_.geometry, cells), plan_.geometry.planes, problem_.poisson_ratio);
    auto face = std::make_unique<FaceResponse>(model);
    answer.level.level = level;
    answer.level.cells_across = cells.across;
    answer.level.cells_deep = cells.deep;
    answer.level.unknowns = model.unknowns();
    answer.level.face_nodes = static_cast<int>(model.nodes().size());
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
    if (problem_.pressing == PadPressing::stuck && has_tension(answer.pressed))
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
                     formatted("a stuck face has to be pressed everywhere: up to %.3g m from the "
                               "centre along x, %.3g m along y; a frictionless one lifts off",
                               limit_m.x(), limit_m.y()));
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

/// Errors are the difference of the two levels over (r^2 - 1), r the ratio of their cells, and what
/// both miss alike. Observed orders are 2.5 to 4.
class PadErrorModel {
 public:
  PadErrorModel(const PadLevel& coarse, const PadLevel& fine) : coarse_(coarse), fine_(fine) {
    const double ratio = static_cast<double>(fine.cells_across) / coarse.cells_across;
    share_ = 1 / (ratio * ratio - 1);
  }
  double operator()(double PadLevel::*quantity) const {
    return relative(coarse_.*quantity, fine_.*quantity);
  }
  std::array<double, 2> operator()(std::array<double, 2> PadLevel::*pair) const {
    return {relative((coarse_.*pair)[0], (fine_.*pair)[0]),
            relative((coarse_.*pair)[1], (fine_.*pair)[1])};
  }

 private:
  double relative(double coarse, double fine) const {
    constexpr double common = 2e-4;
    if (fine == 0) return coarse == 0 ? 0 : 1;
    return share_ * std::abs(coarse - fine) / std::abs(fine) + common;
  }

  const PadLevel &coarse_, &fine_;
  double share_;
};

PadError errors_of(const PadLevel& coarse, const PadLevel& fine) {
  const PadErrorModel of(coarse, fine);
  PadError error;
  error.normal_stiffness = of(&PadLevel::normal_stiffness_N_per_m);
  error.indentation = of(&PadLevel::indentation_m);
  error.peak_pressure = of(&PadLevel::peak_pressure_Pa);
  error.pressure_arm = of(&PadLevel::pressure_arm_m);
  error.eccentricity = of(&PadLevel::eccentricity_m);
  error.max_torque = of(&PadLevel::max_torque_Nm);
  error.torsional_stiffness = of(&PadLevel::torsional_stiffness_Nm_per_rad);
  error.tilt_stiffness = of(&PadLevel::tilt_stiffness_Nm_per_rad);
  error.free_tilt_stiffness = of(&PadLevel::free_tilt_stiffness_Nm_per_rad);
  error.tilt_limit = of(&PadLevel::tilt_limit_Nm);
  error.free_tilt_limit = of(&PadLevel::free_tilt_limit_Nm);
  error.shear_stiffness = of(&PadLevel::shear_stiffness_N_per_m);
  return error;
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

PadResult solve_pad(const PadProblem& problem, const Progress& progress,
                    const StopRequested& stop) {
  const PadPlan plan = plan_pad(problem);
  const Stopwatch watch;
  const PadSolver solver(problem, plan);
  const Units units{problem.thickness_m, problem.youngs_modulus_Pa};
  PadResult result;
  result.planes = plan.geometry.planes;
  LevelAnswer answer;
  std::unique_ptr<FaceResponse> face;
  for (int level = problem.level - 1; level <= problem.level; ++level) {
    if (stop()) throw Interrupted();
    const Stopwatch of_level;
    face.reset();
    answer = {};
    face = solver.respond(level, answer);
    solver.press(*face, answer);
    answer.level.cpu_s = of_level.cpu_seconds();
    progress(formatted("level %d: %ld unknowns, d %.6g m, %.2f s", level, answer.level.unknowns,
                       answer.level.indentation_m, of_level.seconds()));
    result.levels.push_back(answer.level);
  }
  result.finest = answer.level;
  result.error = errors_of(result.levels.front(), result.finest);
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
