#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "softfinger/pads/convex_outline.h"
#include "softfinger/pads/pad_model.h"

/// A flat pad against a flat face, as a case names them.
namespace softfinger::input {

struct RectangleFigure {
  double length_m = 0, width_m = 0, corner_radius_m = 0;
};
struct DiscFigure {
  double diameter_m = 0;
};
struct OutlineFigure {
  std::vector<Eigen::Vector2d> points_m;
};
using FlatFigure = std::variant<RectangleFigure, DiscFigure, OutlineFigure>;

/// The finger's flat end. The pad's frame has its origin where the figure has its own: in the
/// middle of a rectangle or disc.
struct FlatPad {
  FlatFigure figure;
  double edge_radius_m = 0;  ///< of the fillet between face and side walls, which stays clear
};

/// A curved object without an end, gap x²/(2 R_x) + y²/(2 R_y) about its middle. A cylinder's
/// radius along its axis is infinite.
struct CurvedFace {
  double radius_x_m = 0, radius_y_m = 0;  ///< > 0, not both infinite

  bool is_cylinder() const { return std::isinf(radius_x_m) || std::isinf(radius_y_m); }
};

/// The object's flat face.
struct FlatFace {
  std::optional<FlatFigure> figure;  ///< none: a plane larger than the pad
};

/// Both, and where they touch.
struct PadPair {
  FlatPad finger;
  FlatFace object;
  /// In the place of a flat face. The pad is a rectangle then; that of a roller is as wide as the
  /// roller, with the line along x.
  std::optional<CurvedFace> curved;
  bool is_roller = false;
  Eigen::Vector2d offset_m = Eigen::Vector2d::Zero();  ///< of the face in the pad's frame
  double angle_rad = 0;                                ///< of the face, counter-clockwise
  PadPressing pressing = PadPressing::stuck;
  std::optional<Eigen::Vector2d> load_at_m;    ///< in the pad's frame; none: faces stay parallel
  std::string load_at_where;                   ///< "file:line" of it
  ConvexOutline pad = ConvexOutline::disc(1);  ///< the pad's flat face, in its own frame
  ConvexOutline contact = ConvexOutline::disc(1);  ///< the intersection, in the pad's frame
  /// Share of the pad's flat face that touches. Below 1 the object's edge presses into the pad.
  double covered = 1;
};

}  // namespace softfinger::input
