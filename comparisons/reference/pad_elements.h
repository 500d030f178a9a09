#pragma once

#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/reference/fem_jobs.h"
#include "comparisons/reference/fem_process.h"

/// Finite elements of a flat pad, by the same process as those of fingers (fem/pad/README.md).
namespace softfinger::reference {

/// Relative errors that the elements state for their own numbers. Absent: not known.
struct PadElementErrors {
  std::optional<double> indentation, normal_stiffness, peak_pressure, pressure_arm, max_torque,
      tilt_stiffness;  ///< of the worse axis
};

/// The pressure at the nodes of the touched face, in the pad's frame.
struct PadPressureSamples {
  std::vector<double> x_m, y_m, pressure_Pa;
};

/// Numbers of a pad, SI; pairs are about the x and about the y axis, or along them.
struct PadElements {
  double load_N = 0, indentation_m = 0, normal_stiffness_N_per_m = 0, area_m2 = 0,
         peak_pressure_Pa = 0, pressure_arm_m = 0, eccentricity_m = 0, max_torque_Nm = 0,
         torsional_stiffness_Nm_per_rad = 0, lifted_share = 0;
  std::array<double, 2> tilt_stiffness_Nm_per_rad{}, tangential_stiffness_N_per_m{};
  std::array<double, 2> contact_half_lengths_m{};  ///< under a curved object
  /// The value is missing where the rim is under tension without any tilt.
  std::array<std::optional<double>, 2> tilt_limit_Nm;
  PadElementErrors error;
  PadPressureSamples pressure;
  double unknowns = 0, wall_s = 0, peak_memory_MB = 0;
  /// The answer as the program wrote it, with what nothing here computes with.
  nlohmann::json document;
};

/// A result, or why it is not to be believed. Exactly one of the two is there.
struct ReadPadElements {
  std::optional<PadElements> elements;
  std::string flaw;
};
ReadPadElements read_pad_elements(const nlohmann::json& document);

/// Whether the elements' errors of indentation and torque are within `kTrustLimits`.
bool is_trusted(const PadElements& elements);

/// The answer as commands and reports have it (docs/json.md).
nlohmann::json to_json(const PadElements& elements, const input::Case& contact_case);

/// The problem of a load as the program reads it. The block has the side walls of the flat face:
/// with a fillet, those that the face alone would have.
nlohmann::json pad_problem(const input::Case& contact_case, double load_N, int level,
                           int limit_surface);

/// A sentence about the part of a case's geometry that the elements leave out, if there is any.
std::optional<std::string> elements_remark(const input::Case& contact_case);

/// Why the elements would refuse the case's geometry; nothing where they do not.
std::optional<std::string> elements_refusal(const input::Case& contact_case);

/// Roughly how long the elements take on one core of a usual machine.
double expected_pad_s(const input::Case& contact_case);

/// A result, or in one line why there is none.
struct PadSolution {
  std::optional<PadElements> elements;
  std::string failure;
  int exit_status = 0;  ///< as in `FemAnswer`
};

struct PadCallbacks {
  std::function<void(FemIndex, const std::string& line)> on_line = [](auto, const auto&) {};
  std::function<void(FemIndex, PadSolution)> on_solution = [](auto, auto&&) {};
};

/// `run_fem` for pads: those of one batch share their meshes where only loads differ.
int run_pads(const std::string& program, const std::vector<FemDocuments>& batches, int parallel,
             const PadCallbacks& callbacks);

/// A pad's problem whose result is kept in a file, so that the same command continues after an
/// interruption.
struct PadJob {
  std::string title;  ///< for messages
  nlohmann::json problem;
  std::filesystem::path file;
  std::size_t group = 0;  ///< jobs of one group that follow each other share a process
};

/// The finished result of a job, if there is one; else what is wrong with its file, if that exists.
ReadPadElements finished_pad(const PadJob& job, const FemJobOptions& options);

/// Reuses the results that are finished, solves the other jobs and says how far it is.
/// @param on_solution  called once for each job
/// @returns 0, or the signal that interrupted
int run_pad_jobs(const std::vector<PadJob>& jobs, const FemJobOptions& options,
                 system::Progress& progress,
                 const std::function<void(const PadJob&, PadSolution)>& on_solution);

}  // namespace softfinger::reference
