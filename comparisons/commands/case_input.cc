#include "comparisons/commands/case_input.h"

#include <algorithm>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/nearest_name.h"
#include "comparisons/text/number.h"
#include "meshes/io/mesh_formats.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {

void add_settings(CLI::App& command, std::vector<std::string>& settings, const std::string& of) {
  command
      .add_option("--set", settings,
                  "KEY=VALUE in place of the " + of +
                      "'s own value, in the units of the file, for instance "
                      "layer.thickness_mm=3; may be repeated")
      ->allow_extra_args(false);
}

void add_case(CLI::App& command, CaseInput& typed, bool has_load, input::FlatPads pads) {
  typed.command = command.get_name();
  typed.pads = pads;
  command.add_option("CASE", typed.file,
                     "case file (TOML), the name of a built-in case, or \"-\" for standard input; "
                     "none: the case is made of the numbers below");
  add_settings(command, typed.settings, "case");
  const auto add = [&](const char* flag, std::string& value, const char* what) {
    command.add_option(flag, value, what)->group("Numbers in place of a case, or of a case's own");
  };
  add("--radii-mm", typed.radii_mm, "R',R'' or R: relative radii of the gap in mm, finite and > 0");
  if (pads == input::FlatPads::taken) {
    add("--pad-mm", typed.pad_mm, "L,W: a flat rectangular pad under a larger plane, in mm, > 0");
    add("--pad-diameter-mm", typed.pad_diameter_mm, "D: a flat round pad under a larger plane");
  }
  add("--thickness-mm", typed.thickness_mm, "of the layer, in mm, > 0");
  add("--youngs-modulus-kPa", typed.youngs_modulus_kPa, "of the layer, in kPa, > 0");
  add("--poisson-ratio", typed.poisson_ratio, "of the layer, 0 to 0.5");
  if (!has_load) add("--load", typed.load_N, "P or P1,P2,...: in N, > 0");
  add("--friction", typed.friction,
      "friction coefficient, > 0; without a case, default: 1, the torque is proportional to it");
}

input::Settings settings_of(const std::vector<std::string>& typed) {
  input::Settings settings;
  for (const std::string& setting : typed) settings.push_back(input::parse_setting(setting));
  input::require_each_key_once(settings);
  return settings;
}

input::Settings settings_of(const CaseInput& typed) {
  struct Number {
    const char *flag, *key;
    const std::string& value;
    std::size_t most;
    const char* allowed;
  };
  const Number numbers[] = {
      {"--radii-mm", "geometry.relative_radii_mm", typed.radii_mm, 2,
       "R',R'' or R: numbers > 0, in mm; a line needs its length, in a case with finger = { "
       "roller_radius_mm = 14, length_mm = 28 }"},
      {"--thickness-mm", "layer.thickness_mm", typed.thickness_mm, 1, "a number > 0, in mm"},
      {"--youngs-modulus-kPa", "layer.youngs_modulus_kPa", typed.youngs_modulus_kPa, 1,
       "a number > 0, in kPa"},
      {"--poisson-ratio", "layer.poisson_ratio", typed.poisson_ratio, 1, "a number from 0 to 0.5"},
      {"--load", "contact.load_N", typed.load_N, 0, "P or P1,P2,...: numbers > 0, in N"},
      {"--friction", "contact.friction_coefficient", typed.friction, 1, "a number > 0"}};
  input::Settings settings;
  std::vector<std::string> missing;
  if (!typed.radii_mm.empty() + !typed.pad_mm.empty() + !typed.pad_diameter_mm.empty() > 1)
    throw InputError("command line", "--radii-mm, --pad-mm, --pad-diameter-mm", "", "one of them");
  const bool has_pad = !typed.pad_mm.empty() || !typed.pad_diameter_mm.empty();
  if (has_pad) {
    const bool is_round = typed.pad_mm.empty();
    const char* flag = is_round ? "--pad-diameter-mm" : "--pad-mm";
    const std::string& typed_pad = is_round ? typed.pad_diameter_mm : typed.pad_mm;
    const std::size_t count = is_round ? 1 : 2;
    const char* allowed = is_round ? "a number > 0, in mm" : "L,W: two numbers > 0, in mm";
    if (numbers_of(flag, typed_pad, allowed).size() != count)
      throw InputError("command line", flag, "\"" + text::shortened(typed_pad) + "\"", allowed);
    const std::string where = flag + (" " + text::shortened(typed_pad, 100));
    settings.push_back(
        {"geometry.finger",
         is_round ? "{ pad_diameter_mm = " + typed_pad + " }" : "{ pad_mm = [" + typed_pad + "] }",
         where});
    if (typed.file.empty()) settings.push_back({"geometry.object", "{ flat = true }", where});
  }
  for (const Number& number : numbers) {
    if (number.value.empty()) {
      if (has_pad && number.flag == std::string("--radii-mm")) continue;
      if (number.key != std::string("contact.friction_coefficient")) missing.push_back(number.flag);
      continue;
    }
    const std::size_t count = numbers_of(number.flag, number.value, number.allowed).size();
    if (number.most > 0 && count > number.most)
      throw InputError("command line", number.flag, "\"" + text::shortened(number.value) + "\"",
                       number.allowed);
    std::string value = number.value;
    // One radius is that of a sphere on a plane.
    if (number.most == 2 && count == 1) value += "," + value;
    if (number.most != 1) value = "[" + value + "]";
    settings.push_back(
        {number.key, value, number.flag + (" " + text::shortened(number.value, 100))});
  }
  if (typed.file.empty() && !missing.empty())
    throw InputError(
        "command line",
        missing.size() == 5 ? "CASE is missing"
                            : "without a CASE " + text::joined(missing) + " " +
                                  (missing.size() == 1 ? "is" : "are") + " missing",
        "",
        "a case file, the name of a built-in case (softfinger list cases), \"-\", or "
        "--radii-mm, --thickness-mm, --youngs-modulus-kPa, --poisson-ratio, --load" +
            std::string(typed.pads == input::FlatPads::taken
                            ? "; --pad-mm or --pad-diameter-mm for a flat pad"
                            : "") +
            (typed.command.empty() ? "" : "; see softfinger " + typed.command + " --help"));
  for (const input::Setting& setting : settings_of(typed.settings)) settings.push_back(setting);
  input::require_each_key_once(settings);
  return settings;
}

namespace {

bool is_mesh(const std::filesystem::path& file) {
  return meshes::mesh_format(file.string()) != nullptr;
}

}  // namespace

input::Case read_case(const CaseInput& typed) {
  const input::Settings settings = settings_of(typed);
  if (is_mesh(typed.file))
    throw InputError(typed.file, "file", "a mesh",
                     "a case, which names the mesh: softfinger mesh FILE prints the line for it");
  if (!typed.file.empty()) {
    input::Case read = input::read_case(system::find_case_file(typed.file), settings,
                                        input::FlatPads::taken, input::Times::taken);
    if (typed.pads == input::FlatPads::refused) refuse_pad(read, "softfinger " + typed.command);
    if (typed.times == input::Times::refused) refuse_times(read, "softfinger " + typed.command);
    for (const std::string& line : read.remarks) remark(line);
    return read;
  }
  std::string text = "id = \"command_line\"\n";
  const auto is_set = [&](const char* key) {
    return std::any_of(settings.begin(), settings.end(),
                       [&](const input::Setting& setting) { return setting.key == key; });
  };
  const bool has_friction = !typed.friction.empty() || is_set("contact.friction_coefficient") ||
                            is_set("contact.shear_law");
  if (!has_friction) text += "[contact]\nfriction_coefficient = 1\n";
  // Nobody said that it sticks while it is pressed. Flat pads have another default.
  const bool is_pad = !typed.pad_mm.empty() || !typed.pad_diameter_mm.empty();
  if (!has_friction && !is_pad && !is_set("contact.pressing"))
    text += "pressing = \"frictionless\"\n";
  input::Case made = input::parse_case(text, "command line", settings, input::FlatPads::taken,
                                       input::Times::taken);
  if (typed.pads == input::FlatPads::refused) refuse_pad(made, "softfinger " + typed.command);
  if (typed.times == input::Times::refused) refuse_times(made, "softfinger " + typed.command);
  for (const std::string& line : made.remarks) remark(line);
  if (!has_friction)
    remark(std::string("no --friction: a coefficient of 1 is taken, the torque is proportional "
                       "to it") +
           (is_pad ? "" : "; pressed without friction"));
  return made;
}

void refuse_time_without_times(const input::Case& contact_case, const std::string& at_time) {
  if (contact_case.times.are_given()) return;
  throw InputError("command line", "--at-time", at_time,
                   "for a case with [layer] relaxation or [contact] history: nothing changes with "
                   "time here");
}

}  // namespace softfinger::commands
