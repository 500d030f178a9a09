#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "comparisons/commands/commands.h"
#include "comparisons/input/recorded_contacts.h"
#include "comparisons/system/files.h"
#include "comparisons/text/json_text.h"
#include "softfinger/dynamics/step/contact_lcp_solver.h"

namespace softfinger::commands {
namespace {

struct LcpOptions {
  std::vector<std::string> files;
  std::string solver = "lemke";
  std::string friction = "facets";
  bool json = false;
};

const char* name_of(LcpStatus status) {
  switch (status) {
    case LcpStatus::solved:
      return "solved";
    case LcpStatus::infeasible_or_ray:
      return "infeasible";
    case LcpStatus::iteration_limit:
      break;
  }
  return "limit";
}

const char* name_of(RayProof proof) {
  switch (proof) {
    case RayProof::infeasible:
      return "no_feasible_velocity";
    case RayProof::ray_only:
      return "jammed_by_friction";
    case RayProof::none:
      break;
  }
  return nullptr;
}

const char* name_of(SolvedBy rung) {
  switch (rung) {
    case SolvedBy::separating:
      return "separating";
    case SolvedBy::still:
      return "still";
    case SolvedBy::warm:
      return "warm";
    case SolvedBy::first_start:
      return "first_start";
    case SolvedBy::drawn_start:
      return "drawn_start";
    case SolvedBy::facets:
      return "facets";
    case SolvedBy::none:
      break;
  }
  return "none";
}

std::vector<double> values(const Eigen::VectorXd& vector) {
  return std::vector<double>(vector.data(), vector.data() + vector.size());
}

struct SolvedProblem {
  LcpResult result;
  ContactSolution solution;
  double solve_us = 0;
};

SolvedProblem solve(const ContactLcp& problem) {
  ContactLcpSolver solver(problem.contacts(), int(problem.vertices.cols()));
  SolvedProblem solved;
  solved.solution.resize(problem.contacts());
  const auto start = std::chrono::steady_clock::now();
  solved.result = solver.solve(problem, solved.solution);
  solved.solve_us =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  return solved;
}

nlohmann::json to_json(const std::string& file, const SolvedProblem& solved) {
  const LcpResult& result = solved.result;
  nlohmann::json object{{"file", file},
                        {"status", name_of(result.status)},
                        {"iterations", result.pivots},
                        {"attempts", result.attempts},
                        {"solved_by", name_of(result.solved_by)},
                        {"solve_us", solved.solve_us}};
  const bool has_point =
      result.status != LcpStatus::infeasible_or_ray && std::isfinite(result.residual);
  object["residual"] = has_point ? nlohmann::json(result.residual) : nlohmann::json();
  object["v4"] = has_point ? nlohmann::json(values(solved.solution.velocity)) : nlohmann::json();
  object["r4"] = has_point ? nlohmann::json(values(solved.solution.impulse)) : nlohmann::json();
  if (const char* proof = name_of(result.proof)) {
    object["proof"] = proof;
    object["ray4"] = values(solved.solution.ray);
  }
  return object;
}

int run_lcp(const LcpOptions& options) {
  nlohmann::json results = nlohmann::json::array();
  std::string table;
  bool limit = false;
  for (const std::string& file : options.files) {
    ContactLcp problem = input::read_recorded_contacts(file);
    if (options.friction == "ellipsoid") problem.friction_rule = FrictionRule::ellipsoid;
    const SolvedProblem solved = solve(problem);
    const LcpResult& result = solved.result;
    if (result.status == LcpStatus::iteration_limit) {
      limit = true;
      remark(
          fmt::format("error: {}: not solved within the iteration limit; hint: look for masses, "
                      "arms or velocities that are too large or too small by powers of ten",
                      file));
    }
    if (options.json) {
      results.push_back(to_json(file, solved));
      continue;
    }
    const std::string residual =
        std::isfinite(result.residual) ? fmt::format("{:.1e}", result.residual) : "-";
    table += fmt::format("{:<10}  {:>8}  {:>6}  {:>9.1f}  {}\n", name_of(result.status), residual,
                         result.pivots, solved.solve_us, file);
  }
  if (options.json)
    system::write_to_stdout(text::printed(nlohmann::json{{"results", results}}));
  else
    system::write_text_to_stdout(fmt::format("{:<10}  {:>8}  {:>6}  {:>9}  {}\n", "status",
                                             "residual", "pivots", "us", "file") +
                                 table);
  return limit ? 3 : 0;
}

}  // namespace

void add_lcp(CLI::App& app, Action& action) {
  auto options = std::make_shared<LcpOptions>();
  CLI::App* command =
      app.add_subcommand("lcp",
                         "Solve recorded contact problems: impulses, velocities, residual\n"
                         "An infeasible problem is an answer (status \"infeasible\", exit status "
                         "0); exit status 3 when "
                         "a problem could not be solved within the iteration limit");
  command
      ->add_option(
          "FILE", options->files,
          "recorded problems (softlcp 1), SI units, \"-\" for standard input; at most 1000 "
          "contacts and 64 MiB each")
      ->required();
  command->add_option("--solver", options->solver, "\"lemke\" (default)")
      ->check(CLI::IsMember({"lemke"}));
  command
      ->add_option("--friction", options->friction,
                   "\"facets\": the recorded vertices (default); \"ellipsoid\": the exact friction "
                   "ellipsoid")
      ->check(CLI::IsMember({"facets", "ellipsoid"}));
  command->add_flag("--json", options->json,
                    "one JSON object on standard output: impulses r4 in N s and N m s, velocities "
                    "v4 in m/s and rad/s, four per contact; without unit: residual");
  command->footer(
      "Samples:\n"
      "  softfinger lcp step_0001.txt step_0002.txt\n"
      "  softfinger lcp step_0001.txt --solver lemke --json\n"
      "  softfinger lcp step_0001.txt --friction ellipsoid");
  command->callback([options, &action] { action = [options] { return run_lcp(*options); }; });
}

}  // namespace softfinger::commands
