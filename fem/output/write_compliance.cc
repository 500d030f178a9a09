#include "fem/output/write_compliance.h"

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "fem/base/write_file.h"

namespace softfinger::fem {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using NamedArrays = std::vector<std::pair<const char*, RowMajor>>;
using nlohmann::ordered_json;

ordered_json description(const NamedArrays& arrays) {
  ordered_json result = ordered_json::array();
  for (const auto& [name, array] : arrays)
    result.push_back({{"name", name}, {"rows", array.rows()}, {"columns", array.cols()}});
  return result;
}

}  // namespace

void write_compliance(const std::string& path, const SurfaceCompliance& surface, double thickness_m,
                      double youngs_modulus_Pa, double poisson_ratio) {
  const double per_newton = 1 / (youngs_modulus_Pa * thickness_m);
  const NamedArrays arrays = {
      {"position_m", thickness_m * surface.position.transpose()},
      {"area_m2", thickness_m * thickness_m * surface.area},
      {"normal_m_per_N", per_newton * surface.normal},
      {"tangential_m_per_N", per_newton * surface.tangential},
      {"normal_tangential_m_per_N", per_newton * surface.normal_tangential}};
  const ordered_json head = {{"format", "softfinger surface compliance 1"},
                             {"byte_order", "little"},
                             {"type", "float64"},
                             {"order", "row by row"},
                             {"points", surface.size()},
                             {"thickness_m", thickness_m},
                             {"youngs_modulus_Pa", youngs_modulus_Pa},
                             {"poisson_ratio", poisson_ratio},
                             {"arrays", description(arrays)}};
  write_file(path, "compliance file", [&](std::ostream& out) {
    out << head.dump() << '\n';
    for (const auto& [name, array] : arrays)
      out.write(reinterpret_cast<const char*>(array.data()),
                static_cast<std::streamsize>(sizeof(double)) * array.size());
  });
}

}  // namespace softfinger::fem
