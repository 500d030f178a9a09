#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "comparisons/reference/reference_result.h"

/// Results of the finite elements that are kept between runs: one file each,
/// {"program", "problem", "result", "check"}. A result is used again only when the same program
/// gave it for the same problem, which names the content of each mesh, and when the file is as it
/// was written: "check" is a hash of the rest.
namespace softfinger::reference {

/// The version and the program's own bytes: a rebuilt program must not use an older one's results.
/// @throws InputError when the program cannot be read
std::string program_identity(const std::filesystem::path& program);

/// Content of a file with a finished result.
struct FinishedResult {
  std::optional<ReferenceResult> result;
  std::string flaw;  ///< why a file that is there is of no use; empty when nothing is wrong
};

/// @param text     of the file
/// @param program  `program_identity` of the one that would be asked
FinishedResult parse_finished_result(const std::string& text, const std::string& program,
                                     const nlohmann::json& problem);

/// Reads a file with a finished result; one that does not exist is no flaw.
FinishedResult read_finished_result(const std::filesystem::path& file, const std::string& program,
                                    const nlohmann::json& problem);

/// A finished document of which only `flaw_of` knows what it should be.
struct FinishedDocument {
  nlohmann::json result;  ///< null: none
  std::string flaw;
};
/// @param flaw_of  why the document is not to be believed; empty: it is
using FlawOf = std::function<std::string(const nlohmann::json& result)>;
FinishedDocument read_finished_document(const std::filesystem::path& file,
                                        const std::string& program, const nlohmann::json& problem,
                                        const FlawOf& flaw_of);
/// @throws InputError
void write_finished_document(const std::filesystem::path& file, const std::string& program,
                             const nlohmann::json& problem, const nlohmann::json& result);

/// The content of such a file.
/// @param result  as the program wrote it
std::string finished_result_text(const std::string& program, const nlohmann::json& problem,
                                 const nlohmann::json& result);

/// Writes the file whole or not at all; its folder is made when it is missing.
/// @throws InputError
void write_finished_result(const std::filesystem::path& file, const std::string& program,
                           const nlohmann::json& problem, const ReferenceResult& result);

}  // namespace softfinger::reference
