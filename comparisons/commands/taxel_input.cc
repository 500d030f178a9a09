#include "comparisons/commands/taxel_input.h"

#include <fmt/format.h>

#include <cmath>

#include "comparisons/commands/number_option.h"
#include "comparisons/report/taxel_picture.h"
#include "comparisons/system/files.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

constexpr const char* kArray = "--taxels";

int taxels_along(double typed, const std::string& text) {
  constexpr int kMost = taxels::TaxelGrid::kMost;
  if (typed != std::floor(typed) || typed < 1 || typed > kMost)
    throw InputError("command line", kArray, text,
                     fmt::format("NX,NY[,PITCH_mm]: two whole numbers from 1 to {}, and a pitch > "
                                 "0 in mm",
                                 kMost));
  return int(typed);
}

}  // namespace

std::optional<prediction::TaxelRequest> TaxelInput::request() const {
  if (array.empty()) {
    const auto needs_array = [](const char* option, const std::string& value) {
      throw InputError("command line", option, value, "together with --taxels NX,NY");
    };
    if (!depth_mm.empty()) needs_array("--taxels-depth", depth_mm);
    if (output) needs_array("--taxels-output", *output);
    if (picture) needs_array("--taxels-picture", *picture);
    return std::nullopt;
  }
  if (output && output->empty())
    throw InputError("command line", "--taxels-output", "\"\"", "the name of a CSV file");
  if (picture && picture->empty())
    throw InputError("command line", "--taxels-picture", "\"\"", "the name of a PNG file");
  const std::vector<double> numbers =
      numbers_of(kArray, array, "NX,NY or NX,NY,PITCH_mm: finite numbers");
  if (numbers.size() != 2 && numbers.size() != 3)
    throw InputError("command line", kArray, array, "NX,NY or NX,NY,PITCH_mm");
  prediction::TaxelRequest request;
  request.columns = taxels_along(numbers[0], array);
  request.rows = taxels_along(numbers[1], array);
  if (numbers.size() == 3) {
    if (!(numbers[2] > 0)) throw InputError("command line", kArray, array, "a pitch > 0 in mm");
    request.pitch_m = 1e-3 * numbers[2];
  }
  if (!depth_mm.empty())
    request.depth_m =
        1e-3 * number_of("--taxels-depth", depth_mm, "0 to the layer's thickness, in mm");
  return request;
}

void TaxelInput::refuse(const std::string& allowed) const {
  if (request()) throw InputError("command line", kArray, array, allowed);
}

void TaxelInput::write(const std::vector<prediction::TaxelAnswer>& answers) const {
  if (picture && answers.size() != 1)
    throw InputError("command line", "--taxels-picture", *picture,
                     fmt::format("a case with one load that is answered, not {}", answers.size()));
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  if (output) {
    std::string table = prediction::taxel_csv_header();
    for (const prediction::TaxelAnswer& answer : answers)
      table += prediction::taxel_csv_rows(answer);
    files.emplace_back(*output, table);
  }
  if (picture) files.emplace_back(*picture, report::taxel_picture(answers.front()));
  system::write_files_together(files);
}

void add_taxel_array(CLI::App& command, TaxelInput& typed, const std::string& read) {
  command
      .add_option(kArray, typed.array,
                  read +
                      " NX times NY square taxels (1 to 64 each) that are centred on the "
                      "contact, x along its long axis")
      ->type_name("NX,NY[,PITCH]");
  command
      .add_option("--taxels-depth", typed.depth_mm,
                  "depth of the array below the layer's surface (mm), 0 to its thickness; default: "
                  "0, the surface")
      ->type_name("MM");
}

void add_taxels(CLI::App& command, TaxelInput& typed, const std::string& of) {
  add_taxel_array(command, typed,
                  "also the normal force, pressure, shear and displacement on a tactile array; "
                  "default for PITCH, in mm: it covers the contact and a taxel on each side;");
  command.add_option("--taxels-output", typed.output,
                     "CSV file for the readings of " + of + ", a row per taxel, SI units");
  command.add_option("--taxels-picture", typed.picture,
                     "PNG file for the pressure that they read, of one load, with the edge of the "
                     "contact's ellipse");
}

}  // namespace softfinger::commands
