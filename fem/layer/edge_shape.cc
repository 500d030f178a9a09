#include "fem/layer/edge_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace softfinger::fem {
namespace {

/// Edges are sampled in these steps, in thicknesses.
constexpr double step_of_search = 0.2, step_of_table = 0.1;
/// Factors on the length of cells between the first touch and an edge.
constexpr double most_stretched = 1.6, least_stretched = 0.55;
/// An edge is worth following from this length on, in thicknesses.
constexpr double shortest = 1;
/// Largest change of an edge's distance along it.
constexpr double most_oblique = 1;

}  // namespace

EdgeShape::EdgeShape(std::shared_ptr<const LayerShape> shape, const std::vector<double>& lines_x,
                     const std::vector<double>& lines_y, const Eigen::Vector2d& contact)
    : shape_(std::move(shape)) {
  for (const std::size_t side : {0u, 1u}) {
    const double sign = side == 0 ? -1 : 1;
    along_x_[side] = follow_edge(true, sign, lines_x, contact.x(), lines_y.back());
    along_y_[side] = follow_edge(false, sign, lines_y, contact.y(), lines_x.back());
  }
}

/// The distance of the edge from the axis, along x or y at a place on the other axis; none within
/// reach.
std::optional<double> EdgeShape::edge_distance(bool along_x, double sign, double along,
                                               double reach) const {
  const auto at = [&](double distance) {
    return along_x ? Point(sign * distance, along) : Point(along, sign * distance);
  };
  const auto is_cut = [&](const Point& point) { return !is_known(point); };
  const auto is_beyond = [&](const Point& point) {
    return shape_->beyond_edge(point.x(), point.y()) > 0;
  };
  if (is_cut(at(0)) || is_beyond(at(0))) return std::nullopt;
  for (double far = step_of_search; far < reach + step_of_search; far += step_of_search) {
    if (is_cut(at(far))) return std::nullopt;
    if (!is_beyond(at(far))) continue;
    double inside = far - step_of_search, outside = far;
    constexpr int halvings = 20;
    for (int i = 0; i < halvings; ++i) {
      const double middle = (inside + outside) / 2;
      (is_beyond(at(middle)) ? outside : inside) = middle;
    }
    return inside;
  }
  return std::nullopt;
}

/// @param lines    that may lie on the edge
/// @param contact  its half-length towards the edge
/// @param reach    of the block along the edge
EdgeShape::Side EdgeShape::follow_edge(bool along_x, double sign, const std::vector<double>& lines,
                                       double contact, double reach) const {
  const int half = static_cast<int>(std::ceil(reach / step_of_table));
  std::vector<std::optional<double>> distances;
  for (int i = -half; i <= half; ++i)
    distances.push_back(edge_distance(along_x, sign, i * step_of_table, lines.back()));
  Side nearest;
  for (int i = -half; i <= half;) {
    const Side side = follow_edge_from(distances, i, lines, contact);
    if (side.factor.empty()) {
      ++i;
      continue;
    }
    i = static_cast<int>(std::lround(side.high() / step_of_table)) + 1;
    if (nearest.factor.empty() || side.distance_along() < nearest.distance_along()) nearest = side;
  }
  return nearest;
}

/// The edge that begins at a place of the table; none where it is short.
EdgeShape::Side EdgeShape::follow_edge_from(const std::vector<std::optional<double>>& distances,
                                            int start, const std::vector<double>& lines,
                                            double contact) {
  const int half = static_cast<int>(distances.size()) / 2;
  const auto at = [&](int i) { return distances[static_cast<std::size_t>(i + half)]; };
  const auto goes_on = [&](int to) {
    return to <= half && at(to) && std::abs(*at(to) - *at(to - 1)) < most_oblique * step_of_table;
  };
  if (!at(start)) return {};
  int last = start;
  while (goes_on(last + 1)) ++last;
  // The edge shall lie on a line of the mesh at the place nearest to the axis through the first
  // touch.
  const int middle = std::clamp(0, start, last);
  // Beyond the contact, or else all of the way.
  for (const double from :
       {*std::lower_bound(lines.begin(), lines.end(), std::min(contact, lines.back())), 0.0}) {
    Side side;
    side.from = from;
    double least = std::numeric_limits<double>::infinity();
    for (const double line : lines)
      if (line > from && std::abs(line - *at(middle)) < least) {
        least = std::abs(line - *at(middle));
        side.line = line;
      }
    if (!(side.line > from)) continue;
    const auto factor = [&](int i) { return (*at(i) - from) / (side.line - from); };
    const auto fits = [&](int i) {
      return factor(i) < most_stretched && factor(i) > least_stretched;
    };
    if (!fits(middle)) continue;
    int low = middle, high = middle;
    while (high < last && fits(high + 1)) ++high;
    while (low > start && fits(low - 1)) --low;
    if (high - low < shortest / step_of_table) continue;
    side.low = low * step_of_table;
    side.step = step_of_table;
    for (int i = low; i <= high; ++i) side.factor.push_back(factor(i));
    return side;
  }
  return {};
}

double EdgeShape::Side::stretched(double distance, double along) const {
  if (factor.empty() || distance <= from) return distance;
  const double last = static_cast<double>(factor.size() - 1);
  const double place = std::clamp((along - low) / step, 0.0, last);
  const auto i = static_cast<std::size_t>(std::min(std::floor(place), last - 1));
  const double share = place - static_cast<double>(i);
  return from + ((1 - share) * factor[i] + share * factor[i + 1]) * (distance - from);
}

/// The stretch of one axis is known by where the other one leads, so that beside a corner of two
/// edges both are found in turn; edges that are not too oblique let that settle.
Eigen::Vector2d EdgeShape::place(double x, double y) const {
  constexpr int most_turns = 50;
  constexpr double settled = 1e-12;
  Point at(x, y);
  for (int turn = 0; turn < most_turns; ++turn) {
    const Point last = at;
    at.x() = std::copysign(along_x_[x < 0 ? 0 : 1].stretched(std::abs(x), at.y()), x);
    at.y() = std::copysign(along_y_[y < 0 ? 0 : 1].stretched(std::abs(y), at.x()), y);
    if ((at - last).lpNorm<Eigen::Infinity>() < settled) break;
  }
  return at;
}

Eigen::Vector3d EdgeShape::position(double x, double y, double z) const {
  const Point at = place(x, y);
  return shape_->position(at.x(), at.y(), z);
}

Eigen::Vector3d EdgeShape::normal(double x, double y) const {
  const Point at = place(x, y);
  return shape_->normal(at.x(), at.y());
}

double EdgeShape::area_ratio(double x, double y) const {
  const Point at = place(x, y);
  constexpr double step = 1e-4;
  const Point by_x = (place(x + step, y) - place(x - step, y)) / (2 * step),
              by_y = (place(x, y + step) - place(x, y - step)) / (2 * step);
  return (by_x.x() * by_y.y() - by_x.y() * by_y.x()) * shape_->area_ratio(at.x(), at.y());
}

bool EdgeShape::is_known(const Point& at) const {
  const Cover cover = shape_->covers(at.x(), at.x(), at.y(), at.y());
  return cover == Cover::whole || cover == Cover::edge;
}

LayerShape::Cover EdgeShape::covers(double low_x, double high_x, double low_y,
                                    double high_y) const {
  // The image of a rectangle is none: the shape is asked at points as near as its own cells.
  const auto points = [](double low, double high) {
    return std::max(1, static_cast<int>(std::ceil((high - low) / step_of_search)));
  };
  const int count_x = points(low_x, high_x), count_y = points(low_y, high_y);
  Cover worst = Cover::whole;
  for (int j = 0; j <= count_y; ++j)
    for (int i = 0; i <= count_x; ++i) {
      const Cover cover =
          cover_at(low_x + (high_x - low_x) * i / count_x, low_y + (high_y - low_y) * j / count_y);
      if (cover == Cover::cut) return cover;
      if (cover != Cover::whole) worst = Cover::rim;
    }
  return worst;
}

/// The block goes up to an edge that it follows; elsewhere it goes as far as the shape is whole.
/// The shape goes on a little beyond edges that the block does not follow.
LayerShape::Cover EdgeShape::cover_at(double x, double y) const {
  const Point at = place(x, y);
  const Side &side_x = along_x_[x < 0 ? 0 : 1], &side_y = along_y_[y < 0 ? 0 : 1];
  const bool follows_x = side_x.follows(at.y()), follows_y = side_y.follows(at.x());
  constexpr double round_off = 1e-9;
  if ((follows_x && std::abs(x) > side_x.line + round_off) ||
      (follows_y && std::abs(y) > side_y.line + round_off))
    return Cover::rim;
  if (!is_known(at))
    return follows_x || follows_y ? Cover::cut : shape_->covers(at.x(), at.x(), at.y(), at.y());
  return shape_->beyond_edge(at.x(), at.y()) > fitted_to_edge ? Cover::rim : Cover::whole;
}

double EdgeShape::beyond_edge(double x, double y) const {
  const Point at = place(x, y);
  return shape_->beyond_edge(at.x(), at.y());
}

}  // namespace softfinger::fem
