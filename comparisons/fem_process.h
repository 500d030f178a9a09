#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "comparisons/case.h"
#include "comparisons/local_geometry.h"
#include "comparisons/process_pool.h"

/// The finite-element program as seen from here: a process that takes a problem and gives a result,
/// both JSON (fem/README.md).
namespace softfinger {

/// The problem without its output directory: what decides the answer, and nothing else.
/// With `fem_curved` it holds finger and object in the frame of the relative radii.
nlohmann::json fem_problem(const Case& contact_case, const LocalGeometry& geometry, double load_N,
                           int level);

/// @param output_directory  for the VTU files; empty: none. It must exist.
/// @param single_thread     for several processes side by side: linear algebra on one thread each
ProcessJob fem_job(const std::string& program, nlohmann::json problem,
                   const std::string& output_directory, bool single_thread);

/// A process that ended well gave its result, any other says why in one line.
struct FemAnswer {
  nlohmann::json result;  ///< null when it failed
  std::string failure;
  int exit_status = 0;  ///< 0, 2 bad input, 3 no convergence or a crash
};
FemAnswer interpret_fem(const ProcessOutcome& outcome);

/// Whether the stated errors are small enough to judge models by: 2 % in a and b, 1 % in
/// indentation and torque.
bool fem_is_trusted(const nlohmann::json& result);

/// "seed_thumb_5N": the name of the folder of a result.
std::string load_folder(const std::string& case_id, double load_N);

}  // namespace softfinger
