#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/prediction/ask_model.h"
#include "softfinger/time/predict_in_time.h"

/// Answers to a case whose rubber relaxes, or whose load changes, at a time.
namespace softfinger::prediction {

/// A moment that a case is asked about.
struct Moment {
  ContactHistory history;
  double time_s = 0;     ///< infinite: at rest
  bool is_held = false;  ///< one load of the case, put on at the time 0
};

/// The moments of a case: the time that was asked for, else the end of its history, else for each
/// load at once and at rest.
/// @throws InputError for a time that the history does not know
std::vector<Moment> moments_of(const input::Case& contact_case, std::optional<double> time_s);

/// Moments for a curve against time: from at once to rest, evenly in ln t, where a load or approach
/// is only held; else over the history, to its end or the moment's time if that is later. Without
/// those at which nothing is known.
std::vector<Moment> curve_of(const Moment& moment);
/// Whether such a curve is over ln t.
bool is_only_held(const Moment& moment);

/// The moment of a load at a time: held since the time 0, or the case's history of loads times a
/// factor.
/// @throws InputError as `moments_of`, and for a history of approaches
Moment moment_under(const input::Case& contact_case, double load_N, double time_s);

/// "at once", "held 10 s", "held for long", "at 3 s".
std::string in_words(const Moment& moment);

/// A model's answer at a moment.
struct AnswerInTime {
  /// The elastic contact of this size at the instantaneous modulus, under the effective load: its
  /// errors are those of the answer, its stiffness that of quick further motion.
  ModelAnswer elastic;
  ModelAnswer now;
  double effective_load_N = 0;
  /// The answer to the same load or approach of rubber that has not relaxed.
  ModelAnswer unrelaxed;
};

/// Geometry for a moment: of meshes it depends on the size of the contact.
LocalGeometry geometry_at(const input::Case& contact_case, const GeometryResolver& resolver,
                          const Moment& moment);

/// Asks a model about a contact of a case at a moment, as `ask_model` does for an elastic one. The
/// answer has neither deviations nor an assessment.
AnswerInTime ask_in_time(const PressureModel& model, const input::Case& contact_case,
                         const LocalGeometry& geometry, const Moment& moment,
                         std::optional<double> time_budget_ns = std::nullopt);

/// Gives the elastic answer's assessment and deviations to the answer of the moment. Deviations of
/// peak and torque are the same parts of them.
void adopt_errors(AnswerInTime& answer);

/// "against t = 0: torque +1.4 %, area +9 %, indentation +12 %; as large as ..": a line for people.
/// Empty at the time 0, for an elastic layer and without an answer.
std::string change_in_words(const AnswerInTime& answer, const Moment& moment, TorqueRule rule);

/// The keys of `to_json(answer.now, ..)`, and `time_s` (null: at rest), `effective_load_N`,
/// `change`: relative, against rubber that has not relaxed. Stiffnesses are those of quick further
/// motion.
nlohmann::json to_json(const AnswerInTime& answer, const Moment& moment, TorqueRule rule,
                       int limit_surface_points);

/// `relaxation`: [{"share", "time_s"}]; `history`: [{"time_s", "load_N" or "approach_m"}], null
/// without one.
nlohmann::json relaxation_json(const input::ContactTimes& times);
nlohmann::json history_json(const input::ContactTimes& times);

}  // namespace softfinger::prediction
