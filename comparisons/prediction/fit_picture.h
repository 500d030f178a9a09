#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "softfinger/geometry/quadric_fit.h"

namespace softfinger::prediction {

/// Facets to which a quadric was fitted, to be drawn as in figure 2 of Ciocarlie et al. (2007):
/// those of the mesh about the contact point, seen along the normal.
struct FitPicture {
  struct Facet {
    std::array<Eigen::Vector2d, 3> corners_m;  ///< along the fit's x and y
    double above_m = 0;  ///< mean height of its corners above the quadric, outwards positive
  };
  std::vector<Facet> facets;  ///< nearest first
  double region_radius_m = 0;
};

/// Facets that face outwards, up to 1.5 times the region's radius, at most 2000.
FitPicture picture_of(const TriangleSurface& surface, const QuadricFit& fit);

}  // namespace softfinger::prediction
