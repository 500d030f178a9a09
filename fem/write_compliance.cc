#include "fem/write_compliance.h"

#include <vector>

#include "fem/write_file.h"

namespace softfinger::fem {

void write_compliance(const std::string& path, const SurfaceCompliance& surface, double thickness_m,
                      double youngs_modulus_Pa, double poisson_ratio) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const double per_newton = 1 / (youngs_modulus_Pa * thickness_m);
  const std::vector<std::pair<const char*, RowMajor>> arrays = {
      {"position_m", thickness_m * surface.position.transpose()},
      {"area_m2", thickness_m * thickness_m * surface.area},
      {"normal_m_per_N", per_newton * surface.normal},
      {"tangential_m_per_N", per_newton * surface.tangential},
      {"normal_tangential_m_per_N", per_newton * surface.normal_tangential}};
  write_file(path, "compliance file", [&](std::ostream& out) {
    out.precision(17);
    out << R"({"format": "softfinger surface compliance 1", "byte_order": "little", )"
        << R"("type": "float64", "order": "row by row", "points": )" << surface.size()
        << ", \"thickness_m\": " << thickness_m << ", \"youngs_modulus_Pa\": " << youngs_modulus_Pa
        << ", \"poisson_ratio\": " << poisson_ratio << ", \"arrays\": [";
    for (std::size_t i = 0; i < arrays.size(); ++i)
      out << (i ? ", " : "") << R"({"name": ")" << arrays[i].first << R"(", "rows": )"
          << arrays[i].second.rows() << R"(, "columns": )" << arrays[i].second.cols() << "}";
    out << "]}\n";
    for (const auto& array : arrays)
      out.write(reinterpret_cast<const char*>(array.second.data()),
                static_cast<std::streamsize>(sizeof(double)) * array.second.size());
  });
}

}  // namespace softfinger::fem
