// Results of finite elements that are kept between runs.

#include "comparisons/reference/fem_process.h"
#include "comparisons/reference/finished_results.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

constexpr const char* kProgram = "softfinger-fem 0";

nlohmann::json problem() { return {{"name", "pad"}, {"load_N", 1}}; }

bool read(std::string_view bytes) {
  try {
    const reference::FinishedResult finished =
        reference::parse_finished_result(std::string(bytes), kProgram, problem());
    if (!finished.result) return false;
    reference::is_trusted(*finished.result);
    finished.result->document.dump();
    return true;
  } catch (const InputError&) {
    return false;
  }
}

std::vector<std::string> seeds() {
  const nlohmann::json level = {{"level", 1},  {"unknowns", 1000},      {"a_m", 1e-3},
                                {"b_m", 1e-3}, {"indentation_m", 1e-4}, {"max_torque_Nm", 1e-3}};
  const nlohmann::json profile = {{"position_m", {0.0, 1e-3}}, {"pressure_Pa", {1e4, nullptr}}};
  nlohmann::json result = level;
  result.update({{"load_N", 1},
                 {"peak_pressure_Pa", 1e4},
                 {"area_projected_m2", 3e-6},
                 {"area_m2", 3e-6},
                 {"error", {{"a", 1e-3}, {"b", nullptr}, {"indentation", 1e-3}, {"max_torque", 0}}},
                 {"levels", {level}},
                 {"profile_x", profile},
                 {"profile_y", profile}});
  const std::string whole = reference::finished_result_text(kProgram, problem(), result);
  return {whole, nlohmann::json::parse(whole).dump()};
}

}  // namespace

const Target stored_result = {"stored_result", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
