#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/finger_shapes.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/exporting/included_files.h"
#include "comparisons/exporting/robot_lint.h"
#include "comparisons/system/files.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

using exporting::LintedNumber;
using exporting::LintVerdict;
using exporting::XmlFile;

struct LintOptions {
  std::string robot, load = "1", youngs_modulus_kPa = "10000";
  std::vector<std::string> package_paths;
  bool all = false, json = false;
};

double positive(const std::string& option, const std::string& typed, const std::string& unit) {
  const std::string allowed = "a number > 0, in " + unit;
  const double value = number_of(option, typed, allowed);
  if (!(value > 0)) throw InputError("command line", option, "\"" + typed + "\"", allowed);
  return value;
}

std::unique_ptr<XmlFile> read_linted(const std::string& typed) {
  constexpr std::size_t kMostLintedBytes = 20'000'000;
  const auto read = [](const std::filesystem::path& path) {
    return system::read_text_file(path, kMostLintedBytes);
  };
  auto model = typed == "-"
                   ? exporting::read_with_included_files(
                         system::read_standard_input(kMostLintedBytes), "standard input", "", read)
                   : exporting::read_with_included_files(read(typed), typed, typed, read);
  for (const exporting::XmlElement* element : model->elements())
    if (element->name.compare(0, 6, "xacro:") == 0)
      throw InputError(element->where(), "<" + text::shortened(element->name) + ">", "",
                       "a file without xacro: xacro FILE -o robot.urdf expands it");
  return model;
}

/// "hand.xml:12: friction[1] = 0.25"
std::string short_words(const LintedNumber& number) {
  return fmt::format("{}: {} = {}", number.element->where(), number.name,
                     text::shortened(number.typed, 30));
}

std::string lint_answer(const std::vector<LintedNumber>& numbers, std::size_t impossible,
                        std::size_t doubtful) {
  const std::string of_all =
      fmt::format("of {} number{}", numbers.size(), numbers.size() == 1 ? "" : "s");
  if (numbers.empty()) return "no number on friction or stiffness is typed in the file\n";
  std::string line;
  if (impossible == 0) {
    line = "none " + of_all + " is impossible";
    if (doubtful > 0)
      line += fmt::format("; {} {} doubtful", doubtful, doubtful == 1 ? "is" : "are");
    return line + "\n";
  }
  line = fmt::format("{} {} {} impossible", impossible, of_all, impossible == 1 ? "is" : "are");
  std::size_t shown = 0;
  for (const LintedNumber& number : numbers) {
    if (number.verdict != LintVerdict::impossible) continue;
    if (shown == 3) {
      line += ", ...";
      break;
    }
    line += (shown++ == 0 ? ": " : ", ") + short_words(number);
  }
  return line + "\n";
}

nlohmann::json to_json(const LintedNumber& number) {
  const auto or_null = [](const std::string& text) {
    return text.empty() ? nlohmann::json() : nlohmann::json(text);
  };
  return {{"file", number.element->file->where()},
          {"line", number.element->line},
          {"element", number.owner},
          {"name", number.name},
          {"meaning", number.meaning},
          {"typed", number.typed},
          {"value", text::finite_or_null(number.value)},
          {"least", text::finite_or_null(number.least)},
          {"most", text::finite_or_null(number.most)},
          {"verdict", name_of(number.verdict)},
          {"reason", or_null(number.reason)},
          {"type", or_null(number.advice)}};
}

int run_lint(const LintOptions& options) {
  exporting::LintConditions conditions;
  conditions.load_N = positive("--load", options.load, "N");
  conditions.youngs_modulus_Pa =
      1e3 * positive("--youngs-modulus-kPa", options.youngs_modulus_kPa, "kPa");
  const std::unique_ptr<XmlFile> model = read_linted(options.robot);
  const exporting::RobotFormat format = format_of(*model);
  const exporting::RobotShapes shapes = read_shapes(*model, format, exporting::Mjcf(*model));
  RobotMeshes meshes(options.robot == "-" ? "" : options.robot, format, shapes,
                     options.package_paths);
  std::set<std::string> unread;
  const auto mesh_size = [&](const exporting::NamedMesh& named) -> std::optional<Eigen::Vector3d> {
    try {
      return meshes.size_m(named);
    } catch (const InputError&) {
      unread.insert(named.file);
      return std::nullopt;
    }
  };
  const std::vector<LintedNumber> numbers = exporting::lint(*model, conditions, mesh_size);
  const auto count = [&](LintVerdict verdict) {
    return std::size_t(
        std::count_if(numbers.begin(), numbers.end(),
                      [&](const LintedNumber& number) { return number.verdict == verdict; }));
  };
  const std::size_t impossible = count(LintVerdict::impossible),
                    doubtful = count(LintVerdict::doubtful);
  const int status = impossible > 0 ? 1 : 0;
  if (!unread.empty())
    remark(fmt::format("{}: the size of {} meshes is not known, as they are not read: {}",
                       options.robot, unread.size(),
                       text::shortened(text::joined({unread.begin(), unread.end()}), 200)));
  if (options.json) {
    nlohmann::json results = nlohmann::json::array();
    for (const LintedNumber& number : numbers) results.push_back(to_json(number));
    system::write_to_stdout(text::printed({{"robot", options.robot},
                                           {"format", exporting::name_of(format)},
                                           {"load_N", conditions.load_N},
                                           {"youngs_modulus_Pa", conditions.youngs_modulus_Pa},
                                           {"numbers", numbers.size()},
                                           {"impossible", impossible},
                                           {"doubtful", doubtful},
                                           {"results", std::move(results)}}));
    return status;
  }
  std::string text = lint_answer(numbers, impossible, doubtful);
  for (const LintVerdict verdict :
       {LintVerdict::impossible, LintVerdict::doubtful, LintVerdict::possible})
    for (const LintedNumber& number : numbers) {
      if (number.verdict != verdict || (verdict == LintVerdict::possible && !options.all)) continue;
      text += fmt::format("\n{}, {} ({}): {}", short_words(number), number.owner, number.meaning,
                          name_of(verdict));
      if (!number.reason.empty()) text += ": " + number.reason;
      if (!number.advice.empty()) text += "\n  type: " + number.advice;
    }
  if (text.back() != '\n') text += "\n";
  system::write_text_to_stdout(text);
  return status;
}

}  // namespace

void add_lint(CLI::App& app, Action& action) {
  auto options = std::make_shared<LintOptions>();
  CLI::App* command = app.add_subcommand(
      "lint",
      "Judges the contact numbers that a robot's file has. Each number on sliding, torsional and "
      "rolling friction, solref, solimp, stiffness and patch radius against what a pad of the "
      "geom's own size can have, with what to type");
  command
      ->add_option("ROBOT", options->robot, "MJCF, URDF or SDF file, or \"-\" for standard input")
      ->required();
  command->add_option("--load", options->load,
                      "in N, > 0: the least lever is that of Hertz' circle there; default: 1");
  command->add_option("--youngs-modulus-kPa", options->youngs_modulus_kPa,
                      "of the hardest pad that is thought of, in kPa, > 0; default: 10000, hard "
                      "rubber");
  command
      ->add_option("--package-path", options->package_paths,
                   "folder with the packages of the file's meshes, repeatable")
      ->allow_extra_args(false);
  command->add_flag("--all", options->all, "lists the possible numbers, too");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "A lever e_n is the largest torque about the normal over mu times the load: pi/4 a for a\n"
      "rigid punch of radius a, 2/3 a for a uniform pressure, 3 pi/16 a for Hertz. It is "
      "impossible\n"
      "where it is longer than the geom reaches, and doubtful outside of Hertz to punch.\n"
      "Exit status: 1 where a number is impossible, 2 for a file that cannot be read.\n"
      "Samples:\n"
      "  softfinger lint hand.xml\n"
      "  softfinger lint hand.xml --load 2 --all --json");
  command->callback([options, &action] { action = [options] { return run_lint(*options); }; });
}

}  // namespace softfinger::commands
