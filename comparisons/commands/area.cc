#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/input/mask.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct AreaOptions {
  std::vector<std::string> masks;
  std::vector<double> loads_N;
  double mm_per_pixel = 0;
  bool dark = false, ellipse = false, json = false;
};

void check(const AreaOptions& options) {
  if (!(options.mm_per_pixel >= 1e-6 && options.mm_per_pixel <= 1e3))
    throw InputError("command line", "--mm-per-pixel", options.mm_per_pixel, "1e-6 to 1000");
  for (const double load_N : options.loads_N)
    if (!(load_N > 0 && std::isfinite(load_N)))
      throw InputError("command line", "--load", load_N, "finite numbers > 0, in N");
  if (!options.loads_N.empty() && options.loads_N.size() != options.masks.size())
    throw InputError("command line", "--load", fmt::format("{} loads", options.loads_N.size()),
                     fmt::format("one for each of the {} pictures", options.masks.size()));
}

nlohmann::json to_json(const std::string& mask, const input::MaskedContact& contact) {
  return {{"mask", mask},
          {"pixels", contact.pixels},
          {"area_m2", contact.area_m2},
          {"area_std_m2", contact.area_std_m2},
          {"a_m", contact.a_m},
          {"b_m", contact.b_m},
          {"semi_axis_std_m", contact.semi_axis_std_m},
          {"axis_rad", contact.axis_rad},
          {"centre_m", contact.centre_m},
          {"ellipse_departure", contact.ellipse_departure}};
}

int run_area(const AreaOptions& options) {
  check(options);
  nlohmann::json results = nlohmann::json::array();
  std::string rows =
      options.ellipse ? "load_N,a_mm,a_mm_std,b_mm,b_mm_std\n" : "load_N,area_mm2,area_mm2_std\n";
  for (std::size_t i = 0; i < options.masks.size(); ++i) {
    const auto path = system::find_measurement_file(options.masks[i]);
    const input::MaskedContact contact =
        input::parse_mask(system::read_text_file(path, input::kLargestMaskFile),
                          options.mm_per_pixel * 1e-3, options.dark, path.string());
    results.push_back(to_json(options.masks[i], contact));
    if (!options.loads_N.empty()) {
      results.back()["load_N"] = options.loads_N[i];
      rows += fmt::format("{:g}", options.loads_N[i]);
    }
    rows += options.ellipse
                ? fmt::format(",{:.5g},{:.2g},{:.5g},{:.2g}\n", contact.a_m * 1e3,
                              contact.semi_axis_std_m * 1e3, contact.b_m * 1e3,
                              contact.semi_axis_std_m * 1e3)
                : fmt::format(",{:.5g},{:.2g}\n", contact.area_m2 * 1e6, contact.area_std_m2 * 1e6);
    remark(fmt::format(
        "{}: area {:.5g} mm² ± {:.2g}, a {:.4g} mm and b {:.4g} mm along {:.3g}° from the right, "
        "centre {:.4g} mm from the left and {:.4g} mm from above",
        options.masks[i], contact.area_m2 * 1e6, contact.area_std_m2 * 1e6, contact.a_m * 1e3,
        contact.b_m * 1e3, contact.axis_rad * 180 / kPi, contact.centre_m[0] * 1e3,
        contact.centre_m[1] * 1e3));
    constexpr double kFilled = 0.05;
    if (std::abs(contact.ellipse_departure) > kFilled)
      remark(fmt::format(
          "{}: the ellipse of the same moments is {:.0f} % larger than the area: ridges, holes or "
          "specks; fill them, or take the ellipse (--ellipse)",
          options.masks[i], -100 * contact.ellipse_departure));
  }
  if (options.json)
    system::write_to_stdout(text::printed(nlohmann::json({{"results", results}})));
  else
    system::write_to_stdout(rows);
  return 0;
}

}  // namespace

void add_area(CLI::App& app, Action& action) {
  auto options = std::make_shared<AreaOptions>();
  CLI::App* command = app.add_subcommand(
      "area", "Area and semi-axes of contacts in pictures (PNG), as rows for calibrate");
  command
      ->add_option("MASK", options->masks,
                   "PNG files, or built-in ones; light pixels are the contact")
      ->required();
  command
      ->add_option("--mm-per-pixel", options->mm_per_pixel,
                   "side of a pixel in mm, 1e-6 to 1000; 25.4/600 of a scan at 600 dpi")
      ->required();
  command
      ->add_option_function<std::string>(
          "--load",
          [options](const std::string& typed) {
            options->loads_N = numbers_of("--load", typed, "numbers > 0, in N");
          },
          "load of each picture in N, > 0, separated by commas; default: left empty")
      ->type_name("P1,P2,...");
  command->add_flag("--dark", options->dark,
                    "the contact is darker than half, like ink on white paper");
  command->add_flag(
      "--ellipse", options->ellipse,
      "rows with the semi-axes a and b, from the second moments, in place of the area");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "The standard deviation is that of an edge known to within half a pixel all round. A "
      "picture\n"
      "has at most 50 million pixels and 64 MiB; its contact must not reach the edge.\n"
      "Samples:\n"
      "  softfinger area ink_print.png --mm-per-pixel 0.1 --dark --load 2\n"
      "  softfinger area ink_print.png --mm-per-pixel 0.1 --dark --json");
  command->callback([options, &action] { action = [options] { return run_area(*options); }; });
}

}  // namespace softfinger::commands
