#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "comparisons/input/shape.h"
#include "comparisons/simulation/recording.h"

/// Shapes as triangles and how far they reach, for the files and the page alike.
namespace softfinger::simulation {

/// The surface of a shape in its body's frame. Round shapes get 36 segments, vertices on the
/// surface. A half-space is drawn as a square of its plane, centred at the shape's origin.
/// @param half_space_width_m  side of that square
TriangleSurface triangulate(const input::Shape& shape, double half_space_width_m);

/// The box that holds all bodies in all frames, and all contacts; half-spaces do not count. Empty
/// (Eigen's isEmpty) when there is nothing else.
Eigen::AlignedBox3d extent_of(const Recording& recording);

/// Side of the square that is drawn for a half-space. The motion lies well within it at any pose of
/// the half-space. 1 m when there is no motion to cover.
double half_space_width_m(const Recording& recording);

}  // namespace softfinger::simulation
