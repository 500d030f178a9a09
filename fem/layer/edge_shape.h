#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "fem/layer/layer_model.h"

namespace softfinger::fem {

/// A line of cells at most this far from the finger's sharp edge, in thicknesses, counts as lying
/// on it: the edge is sampled at a few places.
constexpr double fitted_to_edge = 0.02;

/// A finger's shape over a block whose lines follow the finger's sharp edges: the block is
/// stretched along y, by a factor that depends on x, so that an edge that runs along x lies on a
/// line y = const between cells; and likewise along x. Each of the four sides has its own edge, or
/// none. Where the edge runs too obliquely, or the cells would be stretched too much, it is not
/// followed, and cells that reach beyond it have to be left out. Past the end of an edge the
/// stretch stays as it was there.
class EdgeShape : public LayerShape {
 public:
  /// @param shape    covers up to the lines' ends
  /// @param lines_x  between columns of cells, ascending, with 0 among them
  /// @param lines_y  likewise
  /// @param contact  its half-lengths along x and y
  EdgeShape(std::shared_ptr<const LayerShape> shape, const std::vector<double>& lines_x,
            const std::vector<double>& lines_y, const Eigen::Vector2d& contact);

  /// Takes a point of the block to its place in the given shape's own block.
  Eigen::Vector2d place(double x, double y) const;

  Eigen::Vector3d position(double x, double y, double z) const override;
  Eigen::Vector3d normal(double x, double y) const override;
  double area_ratio(double x, double y) const override;
  MirrorPlanes planes() const override { return shape_->planes(); }
  Cover covers(double low_x, double high_x, double low_y, double high_y) const override;
  bool has_edges() const override { return true; }
  double beyond_edge(double x, double y) const override;

 private:
  /// The edge beside one side of the block.
  struct Side {
    double from = 0, line = 0;   ///< between which it is stretched; the edge is where `line` is
    double low = 0, step = 1;    ///< of the table
    std::vector<double> factor;  ///< of the stretch; empty: 1
    double high() const { return low + step * static_cast<double>(factor.size() - 1); }
    /// The distance of the edge's nearest place from the axis through the first touch.
    double distance_along() const { return std::max({0.0, low, -high()}); }
    bool follows(double along) const {
      constexpr double rounding = 1e-9;
      return !factor.empty() && along >= low - rounding && along <= high() + rounding;
    }
    /// The distance from the axis that the stretch makes of another one.
    double stretched(double distance, double along) const;
  };
  using Point = Eigen::Vector2d;

  Side follow_edge(bool along_x, double sign, const std::vector<double>& lines, double contact,
                   double reach) const;
  static Side follow_edge_from(const std::vector<std::optional<double>>& distances, int start,
                               const std::vector<double>& lines, double contact);
  bool is_known(const Point& at) const;
  Cover cover_at(double x, double y) const;
  std::optional<double> edge_distance(bool along_x, double sign, double along, double reach) const;

  std::shared_ptr<const LayerShape> shape_;
  std::array<Side, 2> along_x_, along_y_;  ///< on the negative side and on the positive one
};

}  // namespace softfinger::fem
