#include "comparisons/reference/finished_results.h"

#include <fmt/format.h>

#include <cstdint>
#include <utility>

#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/hash.h"

namespace softfinger::reference {
namespace fs = std::filesystem;
using nlohmann::json;

std::string program_identity(const fs::path& program) {
  return fmt::format("{} {:016x}", system::program_version(),
                     hash_of(system::read_file_to_rewrite(program)));
}

namespace {

/// @param saved  without its check
std::string check_of(const json& saved) {
  return hash_text(hash_of(saved.dump(-1, ' ', true, json::error_handler_t::replace)));
}

FinishedDocument parse_finished_document(const std::string& text, const std::string& program,
                                         const json& problem, const FlawOf& flaw_of) {
  json saved = text::parse_json(text);
  if (!saved.is_object()) return {nullptr, "no JSON object"};
  for (const char* key : {"program", "problem", "result", "check"})
    if (!saved.contains(key)) return {nullptr, std::string("no \"") + key + "\""};
  if (saved["program"] != json(program)) return {nullptr, "by another version of softfinger-fem"};
  if (saved["problem"] != problem) return {nullptr, "of another problem"};
  if (std::string flaw = flaw_of(saved["result"]); !flaw.empty()) return {nullptr, std::move(flaw)};
  // Last, because the others tell more.
  const json check = std::move(saved["check"]);
  saved.erase("check");
  if (check != json(check_of(saved))) return {nullptr, "it was changed after it had been written"};
  return {std::move(saved["result"]), ""};
}

}  // namespace

FinishedDocument read_finished_document(const fs::path& file, const std::string& program,
                                        const json& problem, const FlawOf& flaw_of) {
  std::error_code error;
  if (!fs::exists(file, error)) return {};
  try {
    return parse_finished_document(system::read_file_to_rewrite(file), program, problem, flaw_of);
  } catch (const InputError& unreadable) {
    return {nullptr, unreadable.field()};
  }
}

FinishedResult parse_finished_result(const std::string& text, const std::string& program,
                                     const json& problem) {
  ReadReferenceResult read;
  const FinishedDocument found =
      parse_finished_document(text, program, problem, [&](const json& result) {
        read = read_reference_result(result);
        return read.flaw;
      });
  if (!found.flaw.empty()) return {std::nullopt, found.flaw};
  return {std::move(read.result), ""};
}

FinishedResult read_finished_result(const fs::path& file, const std::string& program,
                                    const json& problem) {
  ReadReferenceResult read;
  const FinishedDocument found =
      read_finished_document(file, program, problem, [&](const json& result) {
        read = read_reference_result(result);
        return read.flaw;
      });
  if (!found.flaw.empty()) return {std::nullopt, found.flaw};
  return {std::move(read.result), ""};
}

std::string finished_result_text(const std::string& program, const json& problem,
                                 const json& result) {
  json saved = {{"program", program}, {"problem", problem}, {"result", result}};
  saved["check"] = check_of(saved);
  return saved.dump(1) + "\n";
}

void write_finished_document(const fs::path& file, const std::string& program, const json& problem,
                             const json& result) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);  // a failure is the write's, with its reason
  system::write_file_atomically(file, finished_result_text(program, problem, result));
}

void write_finished_result(const fs::path& file, const std::string& program, const json& problem,
                           const ReferenceResult& result) {
  write_finished_document(file, program, problem, result.document);
}

}  // namespace softfinger::reference
