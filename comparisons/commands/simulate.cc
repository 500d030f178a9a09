#include "comparisons/simulation/simulate.h"

#include <fmt/format.h>

#include <csignal>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/commands/robot_input.h"
#include "comparisons/commands/taxel_input.h"
#include "comparisons/report/hold.h"
#include "comparisons/report/motion_page.h"
#include "comparisons/simulation/control.h"
#include "comparisons/simulation/frame_json.h"
#include "comparisons/simulation/overlapping_shapes.h"
#include "comparisons/simulation/taxel_frames.h"
#include "comparisons/simulation/trajectory_files.h"
#include "comparisons/simulation/vtu_files.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/progress.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

using namespace simulation;

struct SimulateOptions {
  std::string scene_file, output, record_lcp, command_line;
  std::vector<std::string> settings;
  RobotInput robot;
  TaxelInput taxels;
  int vtu_every = -1;  ///< -1: as many as usual; 0: none
  bool json = false, control = false;
};

volatile std::sig_atomic_t interrupted = 0;

/// While it lives, Ctrl-C ends the simulation after the step, and reading a command at once.
class InterruptCatcher {
 public:
  InterruptCatcher() {
    struct sigaction action {};
    action.sa_handler = [](int) { interrupted = 1; };
    sigaction(SIGINT, &action, &before_);  // no SA_RESTART: a read ends
  }
  ~InterruptCatcher() { sigaction(SIGINT, &before_, nullptr); }
  InterruptCatcher(const InterruptCatcher&) = delete;
  InterruptCatcher& operator=(const InterruptCatcher&) = delete;

 private:
  struct sigaction before_ {};
};

nlohmann::json to_json(const Simulation& run, const input::Scene& scene) {
  const Recording& recording = run.recording;
  const Frame& last = recording.frames.back();
  const auto tracks = report::follow_contacts(recording);
  const report::Hold hold = report::examine_hold(recording, tracks);
  nlohmann::json contacts = contacts_json(last, recording.bodies);
  for (const report::ContactTrack& track : tracks)
    if (const auto index = track.contacts.back())
      contacts[*index]["state"] = report::in_words(report::states_of(recording, track).back());
  nlohmann::json unknown = nlohmann::json::array();
  for (const UnknownContact& contact : recording.unknown)
    unknown.push_back({{"bodies",
                        {recording.bodies[std::size_t(contact.a)].name,
                         recording.bodies[std::size_t(contact.b)].name}},
                       {"rigid_points", contact.why.empty()},
                       {"why", contact.why},
                       {"in_words", in_words(contact, recording.bodies, run.steps)},
                       {"steps", contact.steps},
                       {"first_s", contact.first_s},
                       {"slope", contact.slope},
                       {"strain", contact.strain},
                       {"size", contact.size},
                       {"load_N", contact.load_N}});
  std::string verdict = report::in_words(hold, recording, tracks);
  if (verdict.empty()) verdict = fmt::format("No contact carries a load in {:.4g} s.", last.time_s);
  return {{"scene", scene.id},
          {"unknown_errors", unknown},
          {"hold", report::to_json(hold, recording, tracks)},
          {"verdict", verdict},
          {"steps", run.steps},
          {"simulated_s", last.time_s},
          {"wall_s", run.wall_s},
          {"steps_per_s", run.wall_s > 0 ? double(run.step_ms.size()) / run.wall_s : 0},
          {"step_ms_p50", percentile(run.step_ms, 0.5)},
          {"step_ms_p99", percentile(run.step_ms, 0.99)},
          {"lcp_failures", run.lcp_failures},
          {"max_residual", run.max_residual},
          {"most_contacts", run.most_contacts},
          {"quadric_fits", run.quadric_fits},
          {"load_iterations", run.most_load_iterations},
          {"load_disagreement", run.max_load_disagreement},
          {"motor_disagreements", run.motor_disagreements},
          {"failure", run.failure.empty() ? nlohmann::json() : nlohmann::json(run.failure)},
          {"bodies", bodies_json(last, recording.bodies)},
          {"contacts", contacts}};
}

std::string summary(const nlohmann::json& result) {
  const auto number = [&](const char* key) { return result.at(key).get<double>(); };
  std::string text = fmt::format(
      "{}\n{}: {} steps, {:.4g} s simulated in {:.3g} s: {:.0f} steps/s (median {:.3g} ms, 99 % "
      "below "
      "{:.3g} ms)\n"
      "  largest residual {:.1e}; up to {} contacts; e_n and load agree to {:.1e} after at most {} "
      "rounds; {} quadric fits\n",
      result["verdict"].get<std::string>(), result["scene"].get<std::string>(),
      result["steps"].get<int>(), number("simulated_s"), number("wall_s"), number("steps_per_s"),
      number("step_ms_p50"), number("step_ms_p99"), number("max_residual"),
      result["most_contacts"].get<int>(), number("load_disagreement"),
      result["load_iterations"].get<int>(), result["quadric_fits"].get<int>());
  for (const auto& unknown : result["unknown_errors"])
    text += unknown["in_words"].get<std::string>() + "\n";
  text += fmt::format("\n  {:<32} {:>9} {:>15} {:>15} {:>9}  {}\n", "contacts at the end", "P (N)",
                      "tangential (N)", "torque (mN·m)", "of limit", "model");
  for (const auto& contact : result["contacts"]) {
    const double normal = contact["normal_force_N"].get<double>();
    double square = -normal * normal;
    for (const auto& part : contact["force_N"]) square += part.get<double>() * part.get<double>();
    text += fmt::format(
        "  {:<32} {:>9.4g} {:>15.4g} {:>15.4g} {:>7.1f} %  {}{}\n",
        contact["bodies"][0].get<std::string>() + " / " + contact["bodies"][1].get<std::string>(),
        normal, std::sqrt(std::max(0., square)), 1e3 * contact["torque_Nm"].get<double>(),
        100 * contact["utilisation"].get<double>(), contact["model"].get<std::string>(),
        contact["slides"].get<bool>() ? ", " + contact["state"].get<std::string>() : "");
  }
  return text;
}

void write_results(const SimulateOptions& options, const input::Scene& scene,
                   const Simulation& run) {
  const std::filesystem::path folder = options.output;
  write_trajectory(run.recording, folder);
  const int every = options.vtu_every >= 0 ? options.vtu_every : usual_vtu_interval(run.recording);
  if (every > 0) write_vtu(run.recording, folder, every);
  if (const auto taxels = options.taxels.request())
    system::write_file_atomically(
        folder / "taxels.csv", taxels_csv(run.recording, scene, *taxels,
                                          every > 0 ? every : usual_vtu_interval(run.recording)));
  report::MotionPageOptions page;
  page.scene_text = scene.text;
  page.version = system::program_version();
  page.command = options.command_line;
  system::write_file_atomically(folder / "motion.html", report::motion_page(run.recording, page));
  system::write_file_atomically(folder / "simulation.json", text::printed(to_json(run, scene)));
  remark("results in " + options.output +
         ": motion.html, trajectory.csv, contacts.csv, trajectory.json" +
         (every > 0 ? ", motion.pvd" : "") + (options.taxels.array.empty() ? "" : ", taxels.csv"));
}

input::Scene read_scene(const SimulateOptions& options) {
  const input::Settings settings = settings_of(options.settings);
  if (is_robot(options.scene_file)) return read_robot(options.scene_file, options.robot, settings);
  if (!options.robot.finger_layers.empty() || !options.robot.write_scene.empty() ||
      !options.robot.package_paths.empty())
    throw InputError("command line", "SCENE", "\"" + options.scene_file + "\"",
                     "a robot's file with --finger-layer, --write-scene or --package-path: .xml, "
                     ".mjcf, .urdf, .sdf");
  return input::read_scene(system::find_scene_file(options.scene_file), settings);
}

int run_simulate(const SimulateOptions& options) {
  if (options.control && options.scene_file == "-")
    throw InputError("command line", "SCENE", "\"-\"",
                     "a file with --control, which takes its commands from standard input");
  const input::Scene scene = read_scene(options);
  if (const auto taxels = options.taxels.request()) {
    if (options.output.empty())
      throw InputError("command line", "--taxels", options.taxels.array, "together with --output");
    check_taxels(scene, *taxels);
  }
  remark_all(scene.remarks, options.robot.verbose);
  remark_all(simulation::overlap_remarks(scene), options.robot.verbose);
  std::optional<system::OutputFolder> output;
  if (!options.output.empty()) output.emplace(options.output);
  std::optional<Control> control;
  SimulationOptions settings;
  if (options.control) settings = control.emplace(scene, std::cin, std::cout).options();
  if (output) settings.keeps_frames = true;  // its files show all of them
  if (!options.record_lcp.empty()) {
    system::make_writable_folder(options.record_lcp);
    settings.record_lcp = options.record_lcp;
  }
  Simulation run;
  {
    system::Progress progress;
    const InterruptCatcher catcher;
    settings.go_on = [&, further = settings.go_on](int step) {
      if (step % 100 == 0 && !options.control)
        progress.show(fmt::format("{}: step {} of {}", scene.id, step, scene.steps()));
      return !interrupted && further(step);
    };
    run = simulate(scene, settings);
  }
  if (!options.output.empty()) write_results(options, scene, run);
  // The end of the commands is no interruption, and the states have been written.
  if (!options.control) {
    const nlohmann::json result = to_json(run, scene);
    if (options.json)
      system::write_to_stdout(text::printed(result));
    else
      system::write_text_to_stdout(summary(result));
  }
  const bool is_cut_short = interrupted && run.interrupted;
  if (is_cut_short)
    remark(fmt::format("interrupted after {} of {} steps", run.steps, scene.steps()));
  if (!run.failure.empty()) remark("error: " + run.failure);
  if (!run.failure.empty()) return 3;
  return is_cut_short ? 128 + SIGINT : 0;
}

}  // namespace

void add_simulate(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<SimulateOptions>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand(
      "simulate",
      "Time stepping of a scene: rigid bodies, joints, motors, soft and rigid contacts in one\n"
      "complementarity problem per step. Exit status 3 when a step has no solution; everything up "
      "to it is written");
  command
      ->add_option(
          "SCENE", options->scene_file,
          "scene file (TOML), the name of a built-in scene, \"-\" for standard input, or a "
          "robot's file: MJCF (.xml, .mjcf), URDF (.urdf) or SDF (.sdf)")
      ->required();
  add_settings(*command, options->settings, "scene");
  add_robot(*command, options->robot);
  command->add_option("-o,--output", options->output,
                      "folder for motion.html, trajectory.csv, contacts.csv, trajectory.json, "
                      "simulation.json and motion.pvd with its VTU files");
  command
      ->add_option("--vtu-every", options->vtu_every,
                   "VTU files of each N-th step, 1 to 1000000; 0: none; default: about 150 in all, "
                   "fewer where these would fill more than 64 MB")
      ->check(CLI::Range(0, 1000000));
  add_taxel_array(*command, options->taxels,
                  "with --output: the file taxels.csv, normal force, pressure, shear and "
                  "displacement under each soft contact, at the steps of the VTU files; with a "
                  "PITCH in mm;");
  command->add_option("--record-lcp", options->record_lcp,
                      "folder for the contact problem of each step, for softfinger lcp");
  command->add_flag(
      "--json", options->json,
      "one JSON object on standard output: SI units; the end state, times, residuals");
  command->add_flag("--control", options->control,
                    "another program steps: commands on standard input, states on standard output, "
                    "one JSON object per line (comparisons/simulation/control.h; from Python: "
                    "softfinger.simulate)");
  std::string laws;
  for (const input::FrictionLaw* law : input::all_friction_laws())
    laws += fmt::format("  {:<14}{}\n", law->name, law->description);
  command->footer(
      "A scene has [simulation], [[body]], and may have [[layer]], [[joint]], [[loop]], [[motor]], "
      "[[force]]\nand [[contact]]; see the built-in ones and docs/files.md. At most 1000 bodies "
      "(copies counted) "
      "and as many joints and forces,\n20000 contacts, 100 shapes per body, 10000 times per table, "
      "a "
      "million steps, five million steps times bodies, 16 MiB.\n"
      "friction in [simulation] or [[contact]] names a law:\n" +
      laws +
      "Samples:\n"
      "  softfinger list scenes\n"
      "  softfinger simulate pinch\n"
      "  softfinger simulate lift_box --output results/lift_box --json\n"
      "  softfinger simulate gripper.xml --finger-layer tip:2,300,0.49 --write-scene gripper.toml");
  command->callback([options, &action] { action = [options] { return run_simulate(*options); }; });
}

}  // namespace softfinger::commands
