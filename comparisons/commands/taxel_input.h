#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/prediction/taxel_answer.h"

namespace softfinger::commands {

/// Options that ask for the readings of a tactile array: --taxels, --taxels-depth,
/// --taxels-output, --taxels-picture.
struct TaxelInput {
  std::string array, depth_mm;  ///< as typed; empty: not asked for
  std::optional<std::string> output, picture;

  /// Returns the array that was asked for, if any.
  /// @throws InputError for what is no array, and for the other options without --taxels
  std::optional<prediction::TaxelRequest> request() const;

  /// Refuses an array, in a word that names the option.
  /// @param allowed  cases that have one
  /// @throws InputError
  void refuse(const std::string& allowed) const;

  /// Writes the files that were asked for.
  /// @param answers  one per load
  /// @throws InputError also for a picture of several loads, or of none
  void write(const std::vector<prediction::TaxelAnswer>& answers) const;
};

/// Adds --taxels and --taxels-depth to a command.
/// @param read   what is read, and where: "also the .. that NX times NY square taxels read"
void add_taxel_array(CLI::App& command, TaxelInput& typed, const std::string& read);

/// Adds all of these options to a command that reads one contact per load.
/// @param of  whose readings the files hold: "the recommended model"
void add_taxels(CLI::App& command, TaxelInput& typed, const std::string& of);

}  // namespace softfinger::commands
