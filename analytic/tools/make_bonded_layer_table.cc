// Writes analytic/softfinger/layer/bonded_layer_table.cc: the corrections that turn the blend of
// the exact limits into the solution for a quadric on a bonded layer.
//
//   make_bonded_layer_table OUTPUT.cc [THREADS]
//
// At each node of the table the contact is solved by the spectral method of elliptic_contact.h, and
// a tensor cubic B-spline is laid through the logarithms of its ratios to the blend. Progress goes
// to the standard error.
#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/layer/bonded_layer_table.h"
#include "softfinger/layer/elliptic_contact.h"
#include "softfinger/math/dual.h"

namespace {

using namespace softfinger;
using Table = BondedLayerTable;

constexpr int kSizeKnots = Table::kSizeKnots;
constexpr int kCompressibilityKnots = Table::kCompressibilityKnots;
constexpr int kElongationKnots = Table::kElongationKnots;

double knot(int i, int count, double lowest, double highest) {
  return lowest + (highest - lowest) * i / (count - 1);
}

/// ln(P R/(E* h³)) at which the blend has the size exp(`log_size`).
double load_of_blend(const LimitShapes& shapes, double log_size, double compressibility) {
  double log_load = 4 * log_size;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Dual<1> size = layer_blend<Dual<1>>(
        {shapes.log_radii_ratio, shapes.log_hertz_aspect, shapes.log_incompressible_aspect,
         shapes.log_hertz_depth, shapes.log_incompressible_depth,
         shapes.log_hertz_size_at_unit_load, shapes.log_incompressible_size_at_unit_load},
        Dual<1>::variable(log_load, 0), compressibility)[kSize];
    const double step = (log_size - size.value) / size.slope[0];
    log_load += step;
    if (std::abs(step) < 1e-13) break;
  }
  return log_load;
}

/// The corrections at one node; `guess` holds those of a neighbour.
LayerQuantities correction(double log_size, double coordinate, double log_ratio,
                           const LayerQuantities& guess) {
  const double ratio = std::exp(log_ratio);
  const double compressibility = compressibility_at(log_size, coordinate);
  const LimitShapes shapes = limit_shapes(ratio);
  const double log_load = load_of_blend(shapes, log_size, compressibility);
  const LayerQuantities blend = layer_blend(shapes, log_load, compressibility);
  const double size = blend[kSize] + guess[kSize];
  const double aspect = std::max(0.0, blend[kAspect] + guess[kAspect] * shapes.log_radii_ratio);
  const EllipticLayerContact contact = elliptic_layer_contact_at_load(
      std::exp(log_load), ratio, LayerKernel(LayerKernel::Compressibility{compressibility}),
      std::exp(size + 0.5 * aspect), std::exp(size - 0.5 * aspect), 1e-7);
  const double area = contact.a * contact.b;
  // The arm of a ring of that ellipse, (2/pi) a E(m): its mean distance from the centre.
  double ring = 0;
  const int points = 64 + int(16 * contact.a / contact.b);
  for (int i = 0; i < points; ++i) {
    const double t = 0.5 * kPi * (i + 0.5) / points;
    ring += std::hypot(contact.a * std::cos(t), contact.b * std::sin(t)) / points;
  }
  return {0.5 * std::log(area) - blend[kSize],
          log_ratio > 0 ? (std::log(contact.a / contact.b) - blend[kAspect]) / log_ratio : 0,
          std::log(contact.indentation / area) - blend[kDepth],
          std::log(contact.torque_arm / ring) - blend[kArm],
          std::log(contact.peak_pressure * kPi * area / contact.load) - blend[kPeak]};
}

/// Coefficients of the cubic B-spline through equidistant values, without a jump of the third
/// derivative at the last inner knots.
Eigen::MatrixXd interpolation_matrix(int count) {
  Eigen::MatrixXd spline = Eigen::MatrixXd::Zero(count + 2, count + 2);
  for (int i = 0; i < count; ++i) spline.row(i).segment<3>(i) << 1 / 6.0, 4 / 6.0, 1 / 6.0;
  spline.row(count).head<5>() << 1, -4, 6, -4, 1;
  spline.row(count + 1).tail<5>() << 1, -4, 6, -4, 1;
  return spline.inverse().leftCols(count);
}

/// Applies `matrix` along one direction of values[outer][count][inner].
std::vector<double> transform(const std::vector<double>& values, int outer, int count, int inner) {
  const Eigen::MatrixXd matrix = interpolation_matrix(count);
  std::vector<double> result(std::size_t(outer) * std::size_t(count + 2) * std::size_t(inner));
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  for (int i = 0; i < outer; ++i)
    Eigen::Map<RowMajor>(result.data() + i * (count + 2) * inner, count + 2, inner) =
        matrix * Eigen::Map<const RowMajor>(values.data() + i * count * inner, count, inner);
  return result;
}

/// Fills one line of the table, from thick to thin layers: each node starts from its predecessors.
void fill_line(int line, std::vector<double>& values) {
  const double coordinate = knot(line / kElongationKnots, kCompressibilityKnots, 0, 1);
  const double log_ratio =
      log_radii_ratio_at(knot(line % kElongationKnots, kElongationKnots, 0, Table::kElongationMax));
  LayerQuantities last{}, before_last{};
  for (int k = 0; k < kSizeKnots; ++k) {
    const double log_size = knot(k, kSizeKnots, kTableLogSizeMin, kTableLogSizeMax);
    LayerQuantities guess{};
    for (int q = 0; q < kLayerQuantities; ++q)
      guess[std::size_t(q)] = 2 * last[std::size_t(q)] - before_last[std::size_t(q)];
    LayerQuantities value = correction(log_size, coordinate, log_ratio, guess);
    // At the circle the aspect's correction is a limit; it is even in the logarithm.
    if (log_ratio == 0) value[kAspect] = correction(log_size, coordinate, 0.05, guess)[kAspect];
    before_last = last;
    last = value;
    std::copy(value.begin(), value.end(),
              values.begin() + (line * kSizeKnots + k) * kLayerQuantities);
  }
}

int write_table(const char* path, const std::vector<double>& coefficients, double minutes) {
  std::ofstream file(path);
  file << "// Generated by analytic/tools/make_bonded_layer_table.cc; do not edit.\n"
          "// Version 1, November 2026. Spectral Galerkin solution at "
       << kSizeKnots * kCompressibilityKnots * kElongationKnots
       << " nodes (residual 1e-7), not-a-knot\n// tensor cubic B-spline; took "
       << int(std::ceil(minutes)) << " min.\n"
       << "#include \"softfinger/layer/bonded_layer_table.h\"\n\nnamespace softfinger {\n\n";
  double unit[kLayerQuantities] = {};
  for (std::size_t i = 0; i < coefficients.size(); ++i)
    unit[i % kLayerQuantities] =
        std::max(unit[i % kLayerQuantities], std::abs(coefficients[i]) / 32767);
  file << "// clang-format off\nconst double BondedLayerTable::unit[] = {";
  file.precision(17);
  for (int q = 0; q < kLayerQuantities; ++q) file << (q ? ",\n    " : "\n    ") << unit[q];
  file << "};\n\nconst float BondedLayerTable::coefficients[] = {";
  std::string line;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const std::string word =
        std::to_string(std::lround(coefficients[i] / unit[i % kLayerQuantities])) + ",";
    if (line.empty() || line.size() + word.size() > 100) {
      file << line << "\n";
      line.clear();
    }
    line += word;
  }
  file << line << "\n};\n// clang-format on\n\n}  // namespace softfinger\n";
  return file ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: make_bonded_layer_table OUTPUT.cc [THREADS]\n");
    return 2;
  }
  const int threads = argc > 2 ? std::max(1, std::atoi(argv[2])) : 1;
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  constexpr int kLines = kCompressibilityKnots * kElongationKnots;
  std::vector<double> values(std::size_t(kLines * kSizeKnots * kLayerQuantities));
  std::atomic<int> next{0}, done{0};
  std::atomic<bool> failed{false};
  std::vector<std::thread> workers;
  for (int i = 0; i < threads; ++i)
    workers.emplace_back([&] {
      for (int line = next++; line < kLines && !failed; line = next++) {
        try {
          fill_line(line, values);
        } catch (const std::exception& error) {
          std::fprintf(stderr, "line %d: %s\n", line, error.what());
          failed = true;
        }
        std::fprintf(stderr, "%d of %d lines, %.0f s\n", ++done, kLines, seconds());
      }
    });
  for (std::thread& worker : workers) worker.join();
  if (failed) return EXIT_FAILURE;

  values = transform(values, kLines, kSizeKnots, kLayerQuantities);
  values =
      transform(values, kCompressibilityKnots, kElongationKnots, Table::kSizes * kLayerQuantities);
  values = transform(values, 1, kCompressibilityKnots,
                     Table::kElongations * Table::kSizes * kLayerQuantities);
  return write_table(argv[1], values, seconds() / 60);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return EXIT_FAILURE;
}
