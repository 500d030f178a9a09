#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/experiments/experiment.h"

/// Published measurements against the theory.
namespace softfinger::experiments {

enum class Verdict {
  agrees,      ///< within the uncertainties, and some other theory is not
  fails,       ///< not within the uncertainties
  cannot_tell  ///< nothing was measured, or its uncertainty is not known, or no theory is excluded
};
/// "agrees", "fails", "cannot tell".
const char* words_of(Verdict verdict);

/// A number and where it can lie.
struct Interval {
  double value = 0, low = 0, high = 0;
};

/// Weight of a finding in the verdict on the data set.
enum class Role {
  theory,  ///< the project's default: it decides the data set's verdict
  option,  ///< what the project offers beside it
  rival    ///< a simpler theory, to see whether the test can tell them apart
};
/// "theory", "option", "rival".
const char* words_of(Role role);

/// One number of a theory beside a measured one. SI; a unit of "" is a plain number.
struct Finding {
  std::string test;  ///< what is compared
  std::string model;
  Role role = Role::theory;
  std::string unit;
  std::optional<double> measured;
  std::optional<double> uncertainty;  ///< of `measured`, to either side
  Interval predicted;
  Verdict verdict = Verdict::cannot_tell;
  std::string reason;  ///< a sentence, or empty
};

/// A number that only the theory together with the measurement gives.
struct Inferred {
  std::string name, unit, condition;
  Interval value;
  /// Interpretation of the publication on which the number rests, where there are several; else
  /// empty.
  std::string reading = "";
};

struct Examined {
  Experiment experiment;
  std::vector<Finding> findings;
  std::vector<Inferred> inferred;
  Verdict verdict = Verdict::cannot_tell;
  std::string sentence;  ///< the verdict in words, with its numbers
};

/// Whether measured and predicted intervals touch; cannot_tell without a measurement or its
/// uncertainty.
Verdict compared(const Finding& finding);

/// Cost: some 0.1 s for a growth law, below 10 ms for the others.
/// @throws InputError, ConvergenceError where the calibration does
Examined examine(const Experiment& experiment);

/// The kinds of data, one file each. They fill findings, inferred numbers and the sentence.
void examine_growth(const Growth& growth, Examined& examined);
void examine_indentation(const Indentation& indentation, Examined& examined);
void examine_hardness(const Hardness& hardness, Examined& examined);
void examine_repeated(const Repeated& repeated, Examined& examined);
void examine_observation(const Observation& observation, Examined& examined);
void examine_press_curves(const PressCurves& curves, Examined& examined);
void examine_tension(const Tension& tension, Examined& examined);
void examine_bonded_disc(const BondedDisc& disc, Examined& examined);

}  // namespace softfinger::experiments
