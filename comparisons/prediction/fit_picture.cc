#include "comparisons/prediction/fit_picture.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace softfinger::prediction {

FitPicture picture_of(const TriangleSurface& surface, const QuadricFit& fit) {
  constexpr double kReach = 1.5;
  constexpr std::size_t kMost = 2000;
  Eigen::Matrix3d axes;
  axes << fit.x_axis, fit.normal.cross(fit.x_axis), fit.normal;
  std::vector<std::pair<double, FitPicture::Facet>> found;
  for (const auto& triangle : surface.triangles) {
    std::array<Eigen::Vector3d, 3> corners;
    for (int i = 0; i < 3; ++i)
      corners[std::size_t(i)] =
          axes.transpose() *
          (surface.vertices_m[std::size_t(triangle[std::size_t(i)])] - fit.origin_m);
    const Eigen::Vector3d centre = (corners[0] + corners[1] + corners[2]) / 3;
    const double distance_m = centre.norm();
    const bool faces_out = (corners[1] - corners[0]).cross(corners[2] - corners[0]).z() > 0;
    if (!faces_out || distance_m > kReach * fit.region_radius_m) continue;
    // Against the quadric's own facet between the same corners, as in the fit: a chord lies below.
    const Quadric& q = fit.quadric;
    double above_m = 0;
    for (const Eigen::Vector3d& at : corners)
      above_m += (at.z() + q.A_per_m * at.x() * at.x() + q.B_per_m * at.y() * at.y() +
                  q.C_per_m * at.x() * at.y()) /
                 3;
    found.push_back(
        {distance_m,
         {{corners[0].head<2>(), corners[1].head<2>(), corners[2].head<2>()}, above_m}});
  }
  std::sort(found.begin(), found.end(),
            [](const auto& one, const auto& other) { return one.first < other.first; });
  FitPicture picture;
  picture.region_radius_m = fit.region_radius_m;
  for (std::size_t i = 0; i < std::min(found.size(), kMost); ++i)
    picture.facets.push_back(found[i].second);
  return picture;
}

}  // namespace softfinger::prediction
