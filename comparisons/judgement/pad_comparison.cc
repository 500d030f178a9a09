#include "comparisons/judgement/pad_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "comparisons/judgement/selection/model_choice.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/constants.h"

namespace softfinger::judgement {
namespace {

using prediction::PadAnswer;
using reference::PadElements;
using reference::PressureProfile;

constexpr double kPadCostBudget_ns = 1e5;  // per model and load

double farther_off(double one, double other) {
  return std::abs(other) > std::abs(one) ? other : one;
}

PadModelErrors pad_errors(const PadAnswer& answer, const PadElements& elements) {
  const PadPrediction& prediction = answer.prediction;
  const auto error = [](double value, double truth) { return value / truth - 1; };
  const auto tilt = [&](std::size_t axis) {
    return error(prediction.tilt_stiffness_Nm_per_rad[axis],
                 elements.tilt_stiffness_Nm_per_rad[axis]);
  };
  PadModelErrors errors;
  errors.indentation = error(indentation_at_load_m(answer), elements.indentation_m);
  errors.normal_stiffness =
      error(prediction.normal_stiffness_N_per_m, elements.normal_stiffness_N_per_m);
  errors.pressure_arm = error(prediction.pressure_arm_m, elements.pressure_arm_m);
  // Both carry mu P.
  errors.max_torque = error(prediction.eccentricity_m, elements.eccentricity_m);
  errors.peak_pressure = error(prediction.peak_pressure_Pa, elements.peak_pressure_Pa);
  // About its own axis a cylinder rolls: no stiffness of a line is stated there.
  errors.tilt_stiffness = answer.problem.cylinder ? tilt(1) : farther_off(tilt(0), tilt(1));
  return errors;
}

/// Distances to the outline from its centroid along an axis, backwards (negative) and forwards.
std::pair<double, double> reach_m(const ConvexOutline& outline, int axis) {
  double back_m = 0, front_m = 0;
  const auto& vertices = outline.vertices_m();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Eigen::Vector2d from = vertices[i] - outline.centroid_m(),
                          to = vertices[(i + 1) % vertices.size()] - outline.centroid_m();
    const double side = from[1 - axis], other_side = to[1 - axis];
    if (side * other_side > 0 || side == other_side) continue;
    const double at_m = from[axis] + side / (side - other_side) * (to[axis] - from[axis]);
    back_m = std::min(back_m, at_m);
    front_m = std::max(front_m, at_m);
  }
  return {back_m, front_m};
}

PressureProfile model_profile(const PadAnswer& answer, int axis) {
  constexpr int kPoints = 81;
  constexpr double kJustInside = 1 - 1e-6;  // a point of the outline itself may count as outside
  const ConvexOutline outline = answer.contact();
  const auto [back_m, front_m] = reach_m(outline, axis);
  PressureProfile profile;
  for (int i = 0; i < kPoints; ++i) {
    // Denser towards the edges, where the pressure changes fast.
    const double share = (1 - std::cos(kPi * i / (kPoints - 1))) / 2;
    const double at_m = kJustInside * (back_m + share * (front_m - back_m));
    const Eigen::Vector2d point_m =
        outline.centroid_m() + at_m * Eigen::Vector2d::Unit(Eigen::Index(axis));
    profile.position_m.push_back(at_m);
    profile.pressure_Pa.push_back(answer.model->pressure_Pa(answer.problem, point_m));
  }
  return profile;
}

/// The nodes near a line through the centroid. Meshes of discs and rectangles have nodes on it, a
/// polygon's have some beside it.
PressureProfile elements_profile(const PadElements& elements, const ConvexOutline& outline,
                                 int axis) {
  constexpr double kNear = 0.01;  // of the outline's extent across the line
  const auto& at_m = axis == 0 ? elements.pressure.x_m : elements.pressure.y_m;
  const auto& across_m = axis == 0 ? elements.pressure.y_m : elements.pressure.x_m;
  const Eigen::Vector2d& centroid_m = outline.centroid_m();
  const double near_m = kNear * outline.extent_m()[1 - axis];
  std::vector<std::pair<double, double>> nodes;
  for (std::size_t i = 0; i < at_m.size(); ++i)
    if (std::abs(across_m[i] - centroid_m[1 - axis]) < near_m)
      nodes.emplace_back(at_m[i] - centroid_m[axis], elements.pressure.pressure_Pa[i]);
  std::sort(nodes.begin(), nodes.end());
  PressureProfile profile;
  for (const auto& [position_m, pressure_Pa] : nodes) {
    profile.position_m.push_back(position_m);
    profile.pressure_Pa.push_back(pressure_Pa);
  }
  return profile;
}

PadModelComparison compare_pad_model(const PadModel& model, const input::Case& contact_case,
                                     const PadShape& shape, const PadComparison& load,
                                     double tolerance) {
  prediction::Demand demand;
  demand.tolerance = tolerance;
  PadModelComparison compared;
  compared.answer =
      prediction::ask_pad_model(model, contact_case, shape, load.load_N, demand, kPadCostBudget_ns);
  compared.is_sound = compared.answer.bound.has_value();
  if (!compared.answer.prediction.has_answer) return compared;
  compared.along_x = model_profile(compared.answer, 0);
  compared.along_y = model_profile(compared.answer, 1);
  if (!load.elements) return compared;
  compared.errors = pad_errors(compared.answer, *load.elements);
  compared.judgement = judge(std::abs(compared.errors->max_torque), compared.is_sound, tolerance);
  return compared;
}

PadComparison compare_pad_load(const input::Case& contact_case, const PadShape& shape,
                               double load_N, reference::PadSolution solution, double tolerance) {
  PadComparison load;
  load.load_N = load_N;
  load.elements = std::move(solution.elements);
  load.failure = solution.failure;
  if (load.elements) {
    load.along_x = elements_profile(*load.elements, shape.outline(), 0);
    load.along_y = elements_profile(*load.elements, shape.outline(), 1);
  }
  const auto models = std::get<input::PadPair>(contact_case.geometry).curved
                          ? std::vector<const PadModel*>{&line_layer()}
                          : all_pad_models();
  for (const PadModel* model : models)
    load.models.push_back(compare_pad_model(*model, contact_case, shape, load, tolerance));
  return load;
}

/// One model over some loads that have a reference.
struct PadRecord {
  std::string name;
  double torque = 0;              ///< the worst error, signed
  PadModelErrors::Worst pressed;  ///< that of pressing and tilting
  double cost_us = 0;             ///< the largest

  double larger() const { return std::max(std::abs(torque), std::abs(pressed.error)); }
};

PadRecord record_of(const std::vector<const PadComparison*>& loads, std::size_t model) {
  PadRecord record;
  for (const PadComparison* load : loads) {
    const PadModelComparison& compared = load->models[model];
    record.name = label(std::string(compared.answer.model->card().name));
    record.cost_us = std::max(record.cost_us, 1e-3 * compared.answer.cost_ns);
    if (!compared.errors) continue;
    record.torque = farther_off(record.torque, compared.errors->max_torque);
    if (const auto worst = compared.errors->pressed();
        std::abs(worst.error) > std::abs(record.pressed.error))
      record.pressed = worst;
  }
  return record;
}

/// The bound of a sentence "within ..", where zero would claim too much.
std::string within(double error) { return text::percent(std::max(std::abs(error), 1e-3)); }
std::string apart(double error) { return (error < 0 ? "-" : "+") + text::percent(std::abs(error)); }

std::string agreement_of_pad(const PadRecord& record) {
  return fmt::format("torque within {}, pressing and tilting within {}", within(record.torque),
                     within(record.pressed.error));
}

std::string departure_of_pad(const PadRecord& record) {
  return fmt::format("off by {} in torque, {} in {}", apart(record.torque),
                     apart(record.pressed.error), record.pressed.quantity);
}

std::string list_of(const std::vector<const PadComparison*>& loads) {
  std::vector<double> loads_N;
  for (const PadComparison* load : loads) loads_N.push_back(load->load_N);
  return load_list(loads_N);
}

using PadLoads = std::vector<const PadComparison*>;

PadLoads at_which(const PadLoads& loads, std::size_t model, Judgement judgement) {
  PadLoads found;
  for (const PadComparison* load : loads)
    if (load->models[model].judgement == judgement) found.push_back(load);
  return found;
}

/// "no model can be relied on at 200 N: ..", with the nearest of them.
std::string unreliable(const PadLoads& open) {
  std::string words = "none has an answer";
  double least = kInfinity;
  for (std::size_t model = 0; model < open.front()->models.size(); ++model) {
    if (!at_which(open, model, Judgement::silent).empty()) continue;
    const PadRecord record = record_of(open, model);
    if (!(record.larger() < least)) continue;
    least = record.larger();
    const bool states_none = std::any_of(open.begin(), open.end(), [&](const PadComparison* load) {
      return !load->models[model].is_sound;
    });
    words = fmt::format("nearest is {}, {}{}", record.name, departure_of_pad(record),
                        states_none ? ", which states no bound there" : "");
  }
  return fmt::format("o model can be relied on at {}: {}; ask the finite elements there",
                     list_of(open), words);
}

}  // namespace

PadModelErrors::Worst PadModelErrors::pressed() const {
  Worst worst{indentation, "indentation"};
  for (const Worst& other :
       {Worst{normal_stiffness, "stiffness"}, Worst{pressure_arm, "the arm as pressed"},
        Worst{tilt_stiffness, "tilt stiffness"}})
    if (std::abs(other.error) > std::abs(worst.error)) worst = other;
  return worst;
}

PadCaseComparison compare_pad(const input::Case& contact_case,
                              std::vector<reference::PadSolution> solutions, double tolerance) {
  PadCaseComparison compared;
  compared.contact_case = &contact_case;
  compared.shape = std::make_unique<const PadShape>(prediction::bearing_outline(contact_case));
  for (std::size_t load = 0; load < solutions.size(); ++load)
    compared.loads.push_back(compare_pad_load(contact_case, *compared.shape,
                                              contact_case.loads_N[load],
                                              std::move(solutions[load]), tolerance));
  compared.verdict = compose_pad_verdict(compared.loads, tolerance);
  return compared;
}

Verdict compose_pad_verdict(const std::vector<PadComparison>& loads, double tolerance) {
  PadLoads all, failed, doubtful;
  for (const PadComparison& load : loads) {
    (load.elements ? all : failed).push_back(&load);
    if (load.elements && !reference::is_trusted(*load.elements)) doubtful.push_back(&load);
  }
  if (all.empty())
    return {fmt::format("No verdict: FEM failed at {} ({}).", list_of(failed),
                        failed.empty() ? "" : failed.back()->failure),
            VerdictClass::failed};
  Verdict verdict;
  std::string& sentence = verdict.sentence;
  PadLoads open = all;
  std::string others;
  bool is_any_usable = false;
  // The first model is the default, the others are its idealisations.
  for (std::size_t model = 0; model < all.front()->models.size(); ++model) {
    const PadLoads usable = at_which(open, model, Judgement::usable);
    if (!usable.empty()) {
      const PadRecord record = record_of(usable, model);
      sentence +=
          fmt::format("{} {}{} ({}; {} per answer) at {}", sentence.empty() ? "Use" : ",",
                      model == 0 ? "the default, " : "", record.name, agreement_of_pad(record),
                      duration_text(record.cost_us), list_of(usable));
      is_any_usable = true;
      PadLoads left;
      for (const PadComparison* load : open)
        if (std::find(usable.begin(), usable.end(), load) == usable.end()) left.push_back(load);
      open = left;
      continue;
    }
    if (at_which(all, model, Judgement::silent).empty()) {
      const PadRecord record = record_of(all, model);
      others += record.larger() <= tolerance
                    ? fmt::format("; {} will do, too ({})", record.name, agreement_of_pad(record))
                    : fmt::format("; {} is {}", record.name, departure_of_pad(record));
    }
  }
  sentence += open.empty() ? others : (sentence.empty() ? "N" : "; n") + unreliable(open);
  verdict.verdict_class = open.empty()    ? VerdictClass::good
                          : is_any_usable ? VerdictClass::mixed
                                          : VerdictClass::bad;
  if (!doubtful.empty())
    sentence += fmt::format("; the FEM's own error is too large at {}", list_of(doubtful));
  if (!failed.empty()) sentence += fmt::format("; FEM failed at {}", list_of(failed));
  sentence += ".";
  return verdict;
}

}  // namespace softfinger::judgement
