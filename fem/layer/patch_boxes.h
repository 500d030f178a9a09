#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "fem/layer/dimension.h"
#include "fem/layer/layer_discretisation.h"

/// Boxes around cells and faces, compared with the patch in which contact is possible. Internal to
/// this room.
namespace softfinger::fem {

/// Whether a coordinate is that of a plane.
inline bool at(double coordinate, double plane) { return std::abs(coordinate - plane) < 1e-9; }

/// Marks of the faces of a mesh from outside; all others are free.
enum : dealii::types::boundary_id { contact_face = 1, core_face = 2 };

/// Our meshes number a cell's corners around its faces, deal.II layer by layer and row by row.
constexpr std::array<std::size_t, 8> corners_layer_by_layer{0, 1, 3, 2, 4, 5, 7, 6};

using Box = std::pair<dealii::Point<dim>, dealii::Point<dim>>;
constexpr double infinite = std::numeric_limits<double>::infinity();

template <class Object>
Box box_of(const Object& object) {
  return object->bounding_box().get_boundary_points();
}

inline double distance(const Box& one, const Box& other) {
  double squares = 0;
  for (unsigned int c = 0; c < dim; ++c) {
    const double apart =
        std::max({0.0, one.first[c] - other.second[c], other.first[c] - one.second[c]});
    squares += apart * apart;
  }
  return std::sqrt(squares);
}

/// Whether a box reaches into the ellipse where contact is possible, seen along the load.
inline bool is_in_patch(const Box& box, const LayerDiscretisation& discretisation) {
  const auto& [low, high] = box;
  const double x = std::max({0.0, low[0], -high[0]}) / (discretisation.patch * discretisation.a);
  const double y = std::max({0.0, low[1], -high[1]}) / (discretisation.patch * discretisation.b);
  return x * x + y * y < 1;
}

/// Cells are halved that are nearer to the patch than this, in their longest sides. A contact that
/// is small against the thickness strains what is around it: with 0.7 its approach was 0.09 % off
/// at s = 0.1, 0.05 % at 0.2, 0.01 % from 0.5 on, and its torque 0.04 % up to s = 0.5. Larger
/// contacts lose nothing, and their meshes are half as large. On scans less is enough: with a
/// third, cells of up to three times their depth are halved in one layer, not in two, which would
/// double the mesh. Against 1, a fingertip under 0.2 to 5 N changes by up to 0.15 % in a and the
/// area, where 0.3 and 0.5 % are stated, and 0.04 % in the torque.
inline double fine_surroundings(const LayerDiscretisation& mesh) {
  constexpr double small = 0.75;
  constexpr double on_scan = 1.0 / 3;
  if (mesh.is_scan) return on_scan;
  return mesh.b < small ? 1 : 0.7;
}

}  // namespace softfinger::fem
