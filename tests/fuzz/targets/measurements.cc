// Tables of measurements, read and, where they are small, fitted.

#include "comparisons/input/measurements.h"

#include <cmath>
#include <exception>

#include "comparisons/calibration/calibration_report.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

const input::Case& finger() {
  static const input::Case contact = input::parse_case(
      "id = \"finger\"\n[geometry]\nrelative_radii_mm = [20.0, 12.0]\n[layer]\nthickness_mm = "
      "2.0\nyoungs_modulus_kPa = 500.0\npoisson_ratio = 0.49\n[contact]\nload_N = "
      "1.0\nfriction_coefficient = 0.8\n",
      "finger.toml");
  return contact;
}

bool read(std::string_view bytes) {
  try {
    const input::MeasurementTable table =
        input::parse_measurements(std::string(bytes), "fuzzed.csv");
    for (const Measurement& value : table.values)
      if (!(value.value > 0 && std::isfinite(value.value) && value.std >= 0 &&
            value.contact < table.loads_N.size()))
        std::terminate();
    constexpr std::size_t kMostFitted = 12;
    if (table.values.size() > kMostFitted) return true;
    calibration::Request request;
    request.model = find_pressure_model("bonded_layer");
    const auto found = calibration::calibrate_case(finger(), table, request);
    for (const ParameterEstimate& estimate : found.found.parameters)
      if (!(estimate.low <= estimate.value && estimate.value <= estimate.high)) std::terminate();
    calibration::describe(found);
    calibration::page_data(found, std::string(bytes))
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

std::vector<std::string> seeds() {
  std::vector<std::string> texts = texts_of(SOFTFINGER_MEASUREMENTS, ".csv");
  texts.push_back(
      "load_N,a_mm,a_mm_std,area_m2,tangential_force_N\n0.5,2.2,0.1,,\n1,2.8,0.1,,0.8\n"
      "2,3.3,0.2,24e-6,\n4,3.9,0.2,,3.1\n");
  return texts;
}

}  // namespace

const Target measurements = {"measurements", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
