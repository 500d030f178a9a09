#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "comparisons/prediction/ask_model.h"
#include "softfinger/input/errors.h"
#include "softfinger/taxels/taxel_array.h"

/// Readings of a tactile array for people, programs and tables.
namespace softfinger::prediction {

/// The array that a user asks for.
struct TaxelRequest {
  int columns = 0, rows = 0;
  std::optional<double> pitch_m;  ///< none: the array covers the contact and a taxel on each side
  double depth_m = 0;             ///< below the layer's surface
};

/// An array's readings of one contact.
struct TaxelAnswer {
  double load_N = 0;
  std::string model;
  double a_m = 0, b_m = 0;  ///< the contact's own
  taxels::TaxelReadings readings;
  double normalisation = 1;  ///< load over the forces as they were integrated

  /// Relative errors of an array that takes each taxel's force to act in its middle, against the
  /// same moments of the contact's own pressure: a and b from the root of the mean of x² and y²,
  /// and the arm of the torque, (sum r f)/(sum f).
  struct Errors {
    double a = 0, b = 0, arm = 0;
  };
  /// Left empty where no force reaches the array.
  std::optional<Errors> errors;
  double own_arm_m = 0;  ///< of the contact's own pressure
};

/// @param own  the forces that the readings are made of
TaxelAnswer taxel_answer(taxels::TaxelReadings readings, const taxels::ForceCells& own);

/// Passes on, in the words of the command line, that an array does not fit its contact.
/// @param error  of the library
/// @throws InputError
[[noreturn]] void refuse_taxels(const InputError& error, const TaxelRequest& request);

/// Readings under the pressure of a model, with the friction that acts while pressing where the
/// answer has it and the model does not solve for its pressure; the shear of that friction is left
/// out.
/// @pre answer.prediction.has_answer, and checked by `check_taxels`
/// @throws InputError naming --taxels
TaxelAnswer read_taxels(const ModelAnswer& answer, const TaxelRequest& request);

/// Refuses, before anything is computed, a depth that the case's layer does not have, and layers of
/// which nothing is known there.
/// @throws InputError in the words of the command line
void check_taxels(const TaxelRequest& request, const input::Case& contact_case);

/// The value of the key "taxels": a list per row of taxels in each table, SI.
nlohmann::json to_json(const TaxelAnswer& answer);

/// "taxels, 8 x 8 of 1.15 mm, on the surface: .." and what they show, a line each.
std::string in_words(const TaxelAnswer& answer);

/// The first line of a table of readings.
std::string taxel_csv_header();
/// A line for each taxel. Numbers keep all of their digits.
std::string taxel_csv_rows(const TaxelAnswer& answer);

}  // namespace softfinger::prediction
