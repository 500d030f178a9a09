#include "fem/levels/scan_readings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "fem/algebra/cholesky.h"
#include "fem/base/formatted.h"
#include "fem/base/threads.h"
#include "fem/levels/mesh_size.h"

namespace softfinger::fem {
namespace {

/// A contact that is larger than its mesh was made for by this share still lies in the refined
/// patch.
constexpr double spare_size = 0.1;
/// Meshes that are tried for one perturbed scan.
constexpr int most_meshes = 15;

/// A perturbed scan: `reading(part)` applies that fraction of the perturbation; `ways` is the rule
/// for its core.
struct Other {
  std::function<Reading(double part)> reading;  ///< none: the unperturbed scan
  CoreWays ways;
};

/// @returns the change, or why this perturbed scan cannot be pressed
Outcome<RelativeError, std::string> change_by(const Reading& reading, CoreWays ways,
                                              const ReadingStart& start, const ContactTask& task,
                                              const OrderedProgress& tell) {
  Pressing other = task.pressing;
  other.bent = start.shape(reading, ways);
  // Solutions that start from this contact have its coordinates.
  const Eigen::Vector2d& centre = task.pressing.bent.centre;
  if (!centre.isZero(0)) other.bent = other.bent.seen_from(centre);
  const ContactTask other_task{task.problem, other, tell, task.stop};
  const auto pressed = start.press(other_task, start.mesh);
  if (!pressed) return message_of(pressed.reason());
  ContactPhysics* const physics = pressed->get();
  // The perturbed contact may lie beside the refined patch, because it touches first elsewhere.
  const auto fits = [&] {
    const RoughSize size = physics->size();
    const LayerDiscretisation& mesh = physics->discretisation();
    return !size.reaches_rim && std::max(size.a / mesh.a, size.b / mesh.b) < 1 + spare_size;
  };
  for (int trial = 1; !fits() && trial < most_meshes; ++trial) {
    LayerDiscretisation mesh = physics->discretisation();
    const RoughSize size = physics->size();
    const double growth = size.reaches_rim ? growth_at_rim : 1;
    mesh.a = rounded(growth * size.a);
    mesh.b = rounded(growth * size.b);
    if (const auto obstacle = physics->press(mesh, 0)) return message_of(*obstacle);
  }
  const Outcome<Measurement, Unmeasured> measurement = physics->measure();
  if (!measurement) return std::string(measurement.reason().error.what());
  const LevelResult& found = measurement->result;
  const auto change = [&](double LevelResult::*quantity) {
    return std::abs(found.*quantity / start.best.*quantity - 1);
  };
  return RelativeError{change(&LevelResult::a_m),
                       change(&LevelResult::b_m),
                       change(&LevelResult::area_projected_m2),
                       change(&LevelResult::indentation_m),
                       change(&LevelResult::peak_pressure_Pa),
                       change(&LevelResult::max_torque_Nm),
                       change(&LevelResult::load_N)};
}

/// Change by a perturbation. If a layer would fold, a part of it is applied, and the change is
/// taken to be in proportion.
std::optional<RelativeError> change_or_less(const Other& other, const ReadingStart& start,
                                            const ContactTask& task, const OrderedProgress& tell) {
  constexpr double least_part = 0.25;
  for (double part = 1; part >= least_part && !task.stop(); part /= 2) {
    std::string failure;
    try {
      Outcome<RelativeError, std::string> change =
          change_by(other.reading ? other.reading(part) : Reading(), other.ways, start, task, tell);
      if (change) {
        for (const auto quantity : relative_errors) (*change).*quantity /= part;
        return *change;
      }
      failure = change.reason();
    } catch (const NotEnoughMemory&) {
      throw;
    } catch (const Interrupted&) {
      return std::nullopt;
    } catch (const std::runtime_error& error) {
      failure = error.what();
    }
    tell("geometry: another reading of the scan or its core cannot be pressed: " + failure);
    if (!other.reading) break;
  }
  return std::nullopt;
}

/// Relative changes by perturbed scans, on the trial mesh. None where one cannot be pressed.
Changes changes_by(const std::vector<Other>& others, const ReadingStart& start,
                   const ContactTask& task) {
  Changes changes(others.size());
  std::vector<OrderedProgress> tell;
  for (std::size_t i = 0; i < others.size(); ++i) tell.push_back(start.progress.place());
  in_parallel(static_cast<int>(others.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    changes[i] = change_or_less(others[i], start, task, tell[i]);
    tell[i].close();
  });
  return changes;
}

}  // namespace

ReadingStart start_readings(ContactPhysics& physics, const LevelResult& best,
                            const ContactTask& task) {
  const auto shape = [fingertip = task.pressing.fingertip, h = task.pressing.thickness_m](
                         const Reading& reading, CoreWays ways) {
    return shape_fingertip(fingertip, h, reading, ways);
  };
  return {physics.press_other(), physics.discretisation(), best, task.progress.place(), shape};
}

Outcome<RelativeError, FoldedLayer> core_error(const ReadingStart& start, const ContactTask& task) {
  const CoreWays own = task.pressing.bent.ways;
  if (own == CoreWays::smoothed) return RelativeError{};
  std::vector<Other> others;
  for (const CoreWays ways :
       {CoreWays::eroded, CoreWays::eroded_nearer, CoreWays::eroded_smoother, CoreWays::smoothed})
    if (ways != own) others.push_back({{}, ways});
  RelativeError largest;
  bool is_known = false;
  for (const std::optional<RelativeError>& change : changes_by(others, start, task)) {
    if (!change) continue;
    is_known = true;
    for (const auto quantity : relative_errors)
      largest.*quantity = std::max(largest.*quantity, *change.*quantity);
  }
  if (!is_known && !task.stop())
    return FoldedLayer{InputError("contact", "room on the finger",
                                  "its layer would fold with all ways to its core but one",
                                  "less load, or another point")};
  start.progress(formatted(
      "core: what its ridge leaves open changes a by %.3g, area by %.3g, d by %.3g, torque by "
      "%.3g %%",
      100 * largest.a, 100 * largest.area, 100 * largest.indentation, 100 * largest.max_torque));
  return largest;
}

std::optional<RelativeError> geometry_error(const ReadingStart& start, const ContactTask& task) {
  constexpr double wider = 1.5;
  const FingertipShape& bent = task.pressing.bent;
  const auto moved = [&](unsigned int pattern) {
    return Other{[&bent, pattern](double part) {
                   return Reading{1, part, pattern, bent.own_normal};
                 },
                 bent.ways};
  };
  const auto smoother = [](double part) {
    return Reading{1 + part * (wider - 1), 0, 0, std::nullopt};
  };
  std::vector<Other> others{moved(1), moved(2), {smoother, bent.ways}};
  if (const double share = task.problem.fingertip.region_excess; share > 0) {
    const auto to_frame =
        Eigen::Quaterniond::FromTwoVectors(bent.own_normal, Eigen::Vector3d::UnitZ());
    const auto held = [=, &bent](double part) {
      const Eigen::Vector3d normal =
          Eigen::Quaterniond::Identity().slerp(part * share, to_frame) * bent.own_normal;
      return Reading{1, 0, 0, normal};
    };
    others.push_back({held, bent.ways});
  }
  const Changes changes = changes_by(others, start, task);
  Changes random(changes.begin(), changes.begin() + 2);
  std::vector<RelativeError> systematic;
  for (auto change = changes.begin() + 2; change != changes.end(); ++change) {
    // If a systematic change could not be computed, the others cannot replace it: state no error.
    if (!*change) return std::nullopt;
    systematic.push_back(**change);
  }
  std::optional<RelativeError> stated = left_open(random, systematic);
  // Two samples make a wide interval. What is less than this hardly matters to a choice of model.
  constexpr double worth_more_samples = 0.03;
  const auto is_large = [&](double RelativeError::*quantity) {
    return (*stated).*quantity > worth_more_samples;
  };
  if (!stated || std::any_of(relative_errors.begin(), relative_errors.end(), is_large)) {
    for (const auto& change : changes_by({moved(3), moved(4)}, start, task))
      random.push_back(change);
    stated = left_open(random, systematic);
  }
  if (!stated) return std::nullopt;
  start.progress(formatted(
      "geometry: what facets and noise leave open changes a by %.3g, area by %.3g, d by %.3g, "
      "torque by %.3g %%",
      100 * stated->a, 100 * stated->area, 100 * stated->indentation, 100 * stated->max_torque));
  return stated;
}

std::optional<RelativeError> left_open(const Changes& random,
                                       const std::vector<RelativeError>& systematic) {
  constexpr std::array<double, 5> student = {0, 12.706, 4.303, 3.182, 2.776};
  std::vector<RelativeError> known;
  for (const std::optional<RelativeError>& change : random)
    if (change) known.push_back(*change);
  if (known.empty()) return std::nullopt;
  const auto norm = [](const std::vector<RelativeError>& changes, double RelativeError::*quantity) {
    double squares = 0;
    for (const RelativeError& change : changes) squares += change.*quantity * change.*quantity;
    return std::sqrt(squares);
  };
  RelativeError result;
  for (const auto quantity : relative_errors)
    result.*quantity = student.at(known.size()) * norm(known, quantity) /
                           std::sqrt(static_cast<double>(known.size())) +
                       norm(systematic, quantity);
  return result;
}

}  // namespace softfinger::fem
