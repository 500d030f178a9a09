#include "comparisons/reference/finished_results.h"

#include <fmt/format.h>

#include <cstdint>

#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/hash.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::reference {
namespace fs = std::filesystem;
using nlohmann::json;

std::string program_identity(const fs::path& program) {
  return fmt::format("{} {:016x}", system::program_version(),
                     text::hash_of(system::read_text_file(program)));
}

FinishedResult parse_finished_result(const std::string& text, const std::string& program,
                                     const json& problem) {
  const json saved = text::parse_json(text);
  if (!saved.is_object()) return {std::nullopt, "no JSON object"};
  for (const char* key : {"program", "problem", "result"})
    if (!saved.contains(key)) return {std::nullopt, std::string("no \"") + key + "\""};
  if (saved["program"] != json(program))
    return {std::nullopt, "by another version of softfinger-fem"};
  if (saved["problem"] != problem) return {std::nullopt, "of another problem"};
  ReadReferenceResult read = read_reference_result(saved["result"]);
  return {std::move(read.result), read.flaw};
}

FinishedResult read_finished_result(const fs::path& file, const std::string& program,
                                    const json& problem) {
  std::error_code error;
  if (!fs::exists(file, error)) return {std::nullopt, ""};
  try {
    return parse_finished_result(system::read_text_file(file), program, problem);
  } catch (const InputError& unreadable) {
    return {std::nullopt, unreadable.field()};
  }
}

void write_finished_result(const fs::path& file, const std::string& program, const json& problem,
                           const ReferenceResult& result) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);  // a failure is the write's, with its reason
  system::write_file_atomically(
      file,
      json({{"program", program}, {"problem", problem}, {"result", result.document}}).dump(1) +
          "\n");
}

}  // namespace softfinger::reference
