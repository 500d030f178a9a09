#include "fem/pad/pad_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "fem/pad/grid_mesh.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using Eigen::Vector2d;
using Lines = std::vector<double>;

/// Power of the distance in cells by which cells grow from an edge.
constexpr double grading = 3;

/// A patch of the plane that a map makes of the unit square, with the lines that divide it.
struct FaceBlock {
  std::function<Vector2d(double, double)> place;
  Lines first, second;
  bool touched = true;
};

Lines uniform_lines(int cells) {
  Lines lines;
  for (int i = 0; i <= cells; ++i) lines.push_back(static_cast<double>(i) / cells);
  return lines;
}

/// Lines that become dense towards 1.
Lines towards_end(int cells) {
  Lines lines;
  for (int i = 0; i <= cells; ++i)
    lines.push_back(1 - std::pow(1 - static_cast<double>(i) / cells, grading));
  return lines;
}

/// Lines that become dense towards 0.
Lines from_begin(int cells) {
  Lines lines;
  for (int i = 0; i <= cells; ++i)
    lines.push_back(std::pow(static_cast<double>(i) / cells, grading));
  return lines;
}

/// Depths from the backing (-1) to the face (0), dense towards both.
Lines depth_lines(int cells) {
  Lines lines;
  const int half = cells / 2;
  for (const double share : from_begin(half)) lines.push_back(-1 + share / 2);
  for (int i = 1; i <= half; ++i) lines.push_back(-1 - lines[static_cast<std::size_t>(half - i)]);
  return lines;
}

/// Share of half a side at which its rounding begins: on a line between cells.
double rounding_begins(const Vector2d& lengths, int cells) {
  if (!(lengths.y() > 0)) return 1;
  if (!(lengths.x() > 0)) return 0;
  // A rounded length needs more cells than a straight one.
  constexpr double weight = 2;
  const double share = lengths.x() / (lengths.x() + weight * lengths.y());
  return static_cast<double>(std::clamp(std::lround(share * cells), 1L, cells - 1L)) / cells;
}

/// A ray's angle on the pad's outline for an angle on the contact's: corners of the pad lie on
/// lines of the mesh, so that no cell cuts one off.
class OuterAngles {
 public:
  /// @param lines  angles of the mesh's lines, ascending, over one turn or a quarter of one
  /// @param ends   whether the first and the last are kept, as on mirror planes
  OuterAngles(const Lines& lines, std::vector<double> corners, bool ends)
      : lines_(lines), to_(lines) {
    std::sort(corners.begin(), corners.end());
    std::vector<std::size_t> anchors;
    if (ends) anchors = {0, lines.size() - 1};
    const std::size_t count = ends ? lines.size() : lines.size() - 1;
    for (const double corner : corners) {
      std::size_t nearest = count;
      for (std::size_t i = 0; i < count; ++i) {
        if (std::find(anchors.begin(), anchors.end(), i) != anchors.end()) continue;
        if (nearest == count || std::abs(lines[i] - corner) < std::abs(lines[nearest] - corner))
          nearest = i;
      }
      if (nearest == count) break;
      anchors.push_back(nearest);
      to_[nearest] = corner;
    }
    std::sort(anchors.begin(), anchors.end());
    if (anchors.empty()) return;
    const double turn = lines.back() - lines.front();
    const auto line = [&](std::size_t k) {
      return lines_[anchors[k % anchors.size()]] + (k >= anchors.size() ? turn : 0);
    };
    const auto corner = [&](std::size_t k) {
      return to_[anchors[k % anchors.size()]] + (k >= anchors.size() ? turn : 0);
    };
    const Lines moved = to_;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      double at = lines_[i];
      if (at < line(0)) at += turn;
      for (std::size_t k = 0; k + (ends ? 1 : 0) < anchors.size(); ++k)
        if (at >= line(k) && at <= line(k + 1)) {
          const double share = (at - line(k)) / (line(k + 1) - line(k));
          to_[i] = corner(k) + share * (corner(k + 1) - corner(k)) + (lines_[i] - at);
          break;
        }
    }
  }

  double operator()(double angle) const {
    const double turn = lines_.back() - lines_.front();
    double shift = 0;
    while (angle - shift > lines_.back() + 1e-9) shift += turn;
    while (angle - shift < lines_.front() - 1e-9) shift -= turn;
    const double at = angle - shift;
    const auto next = std::upper_bound(lines_.begin() + 1, lines_.end() - 1, at);
    const auto i = static_cast<std::size_t>(next - lines_.begin());
    const double share = (at - lines_[i - 1]) / (lines_[i] - lines_[i - 1]);
    return to_[i - 1] + share * (to_[i] - to_[i - 1]) + shift;
  }

 private:
  Lines lines_, to_;
};

class FaceBlocks {
 public:
  FaceBlocks(const PadGeometry& geometry, const PadCells& cells)
      : contact_(geometry.contact),
        pad_(geometry.pad),
        centre_(geometry.contact.centroid()),
        core_(std::max(2, (cells.across + 1) / 2)),
        ring_(cells.across - core_ + 1),
        across_(cells.across) {
    const int sectors = geometry.planes.both() ? 1 : contact_.corners();
    for (int corner = 0; corner < sectors; ++corner) {
      if (contact_.is_rounded())
        add_rounded(corner);
      else
        add_sharp(corner);
    }
    if (pad_) add_outer(sectors);
  }

  std::vector<FaceBlock> take() { return std::move(blocks_); }

 private:
  void add_four_sided(const std::array<Vector2d, 4>& at, const Lines& lines) {
    blocks_.push_back({[at](double u, double v) -> Vector2d {
                         return (1 - u) * (1 - v) * at[0] + u * (1 - v) * at[1] + u * v * at[2] +
                                (1 - u) * v * at[3];
                       },
                       lines, lines});
  }

  void add_sharp(int corner) {
    add_four_sided({centre_, contact_.side_middle(corner), contact_.corner_middle(corner),
                    contact_.side_middle(corner + 1)},
                   towards_end(across_));
  }

  double straight_to(int corner) const {
    return rounding_begins(contact_.lengths_to_corner(corner), cells_along());
  }
  double straight_from(int corner) const {
    return rounding_begins(contact_.lengths_from_corner(corner), cells_along());
  }
  int cells_along() const { return contact_.is_rounded() ? core_ : across_; }
  /// The contact's outline is divided as the blocks inside of it are.
  Lines lines_along(bool to_corner) const {
    if (contact_.is_rounded()) return uniform_lines(core_);
    Lines lines = towards_end(across_);
    if (to_corner) return lines;
    for (double& line : lines) line = 1 - line;
    std::reverse(lines.begin(), lines.end());
    return lines;
  }

  void add_rounded(int corner) {
    // Half-way to the sides; a little farther to the corners, so that no angle comes near 180°.
    constexpr double to_side = 0.5, to_corner = 0.6;
    const auto between = [&](double share, const Vector2d& end) -> Vector2d {
      return centre_ + share * (end - centre_);
    };
    const Vector2d before = between(to_side, contact_.side_middle(corner)),
                   middle = between(to_corner, contact_.corner_middle(corner)),
                   after = between(to_side, contact_.side_middle(corner + 1));
    add_four_sided({centre_, before, middle, after}, uniform_lines(core_));
    const double straight_before = straight_to(corner), straight_after = straight_from(corner);
    const ConvexOutline outline = contact_;
    blocks_.push_back({[=](double u, double v) -> Vector2d {
                         return (1 - u) * (before + v * (middle - before)) +
                                u * outline.to_corner(corner, v, straight_before);
                       },
                       towards_end(ring_), uniform_lines(core_)});
    blocks_.push_back({[=](double u, double v) -> Vector2d {
                         return (1 - u) * (middle + v * (after - middle)) +
                                u * outline.from_corner(corner, v, straight_after);
                       },
                       towards_end(ring_), uniform_lines(core_)});
  }

  double angle_of(const Vector2d& point) const {
    return std::atan2(point.y() - centre_.y(), point.x() - centre_.x());
  }

  void add_outer(int sectors) {
    struct Curve {
      std::function<Vector2d(double)> at;
      Lines lines;
    };
    std::vector<Curve> curves;
    const ConvexOutline outline = contact_;
    for (int corner = 0; corner < sectors; ++corner) {
      const double before = straight_to(corner), after = straight_from(corner);
      curves.push_back(
          {[=](double v) { return outline.to_corner(corner, v, before); }, lines_along(true)});
      curves.push_back(
          {[=](double v) { return outline.from_corner(corner, v, after); }, lines_along(false)});
    }
    // Angles ascend from that of the first point; `atan2` jumps once on the way.
    const double begin = angle_of(curves.front().at(0));
    const auto ascending = [this, begin](const Vector2d& point) {
      double angle = angle_of(point);
      while (angle < begin - 1e-9) angle += 2 * kPi;
      return angle;
    };
    const bool quarter = sectors == 1 && outline.corners() > 1;
    Lines angles;
    for (const Curve& curve : curves)
      for (std::size_t i = 0; i + 1 < curve.lines.size(); ++i)
        angles.push_back(ascending(curve.at(curve.lines[i])));
    angles.push_back(quarter ? kPi / 2 : begin + 2 * kPi);
    std::vector<double> corners;
    // A rounded pad's outline has no corner to be kept.
    if (!pad_->is_rounded())
      for (const Vector2d& corner : pad_->corner_points()) {
        const double angle = ascending(corner);
        if (!quarter || angle < kPi / 2) corners.push_back(angle);
      }
    const auto outer = std::make_shared<const OuterAngles>(angles, corners, quarter);
    const Vector2d centre = centre_;
    const ConvexOutline pad = *pad_;
    for (std::size_t k = 0; k < curves.size(); ++k) {
      const Curve curve = curves[k];
      const bool is_last = k + 1 == curves.size();
      blocks_.push_back({[=](double u, double v) -> Vector2d {
                           const Vector2d inner = curve.at(v);
                           double angle = ascending(inner);
                           if (is_last && !quarter && v > 0.5 && angle < begin + kPi)
                             angle += 2 * kPi;
                           const double turned = (*outer)(angle);
                           const Vector2d direction(std::cos(turned), std::sin(turned));
                           return (1 - u) * inner +
                                  u * (centre + pad.along_ray(centre, direction) * direction);
                         },
                         from_begin(across_), curve.lines, false});
    }
  }

  const ConvexOutline contact_;
  const std::optional<ConvexOutline> pad_;
  const Vector2d centre_;
  const int core_, ring_, across_;
  std::vector<FaceBlock> blocks_;
};

/// A quadrilateral of the face: a rectangle of a block's coordinates.
struct FaceCell {
  std::size_t block;
  Vector2d low, high;
  std::array<unsigned int, 4> vertex;  ///< row by row
};

struct FaceCells {
  std::vector<FaceBlock> blocks;
  std::vector<Vector2d> vertices;
  std::vector<FaceCell> cells;

  unsigned int number_of(const Vector2d& point, double tolerance) {
    for (std::size_t i = vertices.size(); i-- > 0;)
      if ((vertices[i] - point).norm() < tolerance) return static_cast<unsigned int>(i);
    vertices.push_back(point);
    return static_cast<unsigned int>(vertices.size() - 1);
  }
};

FaceCells divide(std::vector<FaceBlock> blocks, double size) {
  constexpr double same = 1e-8;
  FaceCells face;
  face.blocks = std::move(blocks);
  for (std::size_t b = 0; b < face.blocks.size(); ++b) {
    const FaceBlock block = face.blocks[b];
    const std::size_t rows = block.second.size(), columns = block.first.size();
    std::vector<unsigned int> number;
    for (const double v : block.second)
      for (const double u : block.first)
        number.push_back(face.number_of(block.place(u, v), same * size));
    for (std::size_t j = 0; j + 1 < rows; ++j)
      for (std::size_t i = 0; i + 1 < columns; ++i) {
        const std::size_t first = j * columns + i;
        face.cells.push_back({b,
                              {block.first[i], block.second[j]},
                              {block.first[i + 1], block.second[j + 1]},
                              {number[first], number[first + 1], number[first + columns],
                               number[first + columns + 1]}});
      }
  }
  return face;
}

/// Lines along a side of the pad, dense towards both ends of the contact.
Lines lines_with_contact(double pad_low, double pad_high, double low, double high, int cells) {
  Lines lines;
  const auto add = [&](double from, double to, const Lines& shares) {
    for (const double share : shares)
      if (lines.empty() || share > 0) lines.push_back(from + share * (to - from));
  };
  if (low > pad_low) add(pad_low, low, towards_end(cells));
  add(low, (low + high) / 2, from_begin(cells));
  add((low + high) / 2, high, towards_end(cells));
  if (high < pad_high) add(high, pad_high, from_begin(cells));
  return lines;
}

PlacedMesh mesh_crossed(const PadGeometry& geometry, const PadCells& cells) {
  const auto box_of = [](const ConvexOutline& outline) {
    Eigen::AlignedBox2d box;
    for (const Vector2d& corner : outline.corner_points()) box.extend(corner);
    return box;
  };
  const Eigen::AlignedBox2d pad = box_of(*geometry.pad), contact = box_of(geometry.contact);
  const auto lines = [&](int axis) {
    return lines_with_contact(pad.min()[axis], pad.max()[axis], contact.min()[axis],
                              contact.max()[axis], cells.across);
  };
  return grid_mesh(lines(0), lines(1), depth_lines(cells.deep), contact);
}

/// Height of a fillet's surface above the bond, over that of the face.
double height_at(const PadGeometry& geometry, const Vector2d& at) {
  const double r = geometry.edge_radius;
  const double beyond = std::clamp(geometry.contact.distance(at), 0.0, r);
  return 1 - (r - std::sqrt(r * r - beyond * beyond));
}

/// Refuses cells that the map turns inside out, at a corner where they are worst.
void require_regular(const FaceCells& face) {
  for (const FaceCell& cell : face.cells) {
    const auto corner = [&](std::size_t i) { return face.vertices[cell.vertex[i]]; };
    constexpr std::array<std::array<std::size_t, 3>, 4> around{
        {{0, 1, 2}, {1, 3, 0}, {3, 2, 1}, {2, 0, 3}}};
    for (const auto& [at, next, before] : around) {
      const Vector2d one = corner(next) - corner(at), other = corner(before) - corner(at);
      const double sine = (one.x() * other.y() - one.y() * other.x()) / (one.norm() * other.norm());
      constexpr double least = 0.01;
      if (!(sine > least))
        throw InputError("pad", "outline", "too irregular to be meshed",
                         "an outline that its centre sees under moderate angles: drop points that "
                         "are close to others, or to the line between their neighbours");
    }
  }
}

}  // namespace

PadCells cells_of_level(const PadGeometry& geometry, int level) {
  constexpr std::array<int, 4> across{3, 5, 8, 13}, deep{2, 4, 6, 10};
  const auto at = static_cast<std::size_t>(level);
  PadCells cells{across[at], deep[at]};
  // The blocks around a polygon's centre are as many as its corners.
  if (!geometry.planes.both() && !geometry.contact.is_rounded()) {
    constexpr double blocks = 2.6;
    const double share = std::sqrt(std::min(1.0, blocks / geometry.contact.corners()));
    cells.across = std::max(level + 2, static_cast<int>(std::lround(cells.across * share)));
  }
  return cells;
}

PlacedMesh mesh_pad(const PadGeometry& geometry, const PadCells& cells) {
  if (geometry.shares_sides) return mesh_crossed(geometry, cells);
  const ConvexOutline& outermost = geometry.pad ? *geometry.pad : geometry.contact;
  const auto face = std::make_shared<const FaceCells>(
      [&] { return divide(FaceBlocks(geometry, cells).take(), outermost.largest_width()); }());
  require_regular(*face);
  const Lines depths = depth_lines(cells.deep);
  PlacedMesh mesh;
  const auto in_layer = static_cast<unsigned int>(face->vertices.size());
  const auto placed = [geometry](const Vector2d& at, double z) -> Eigen::Vector3d {
    return {at.x(), at.y(), geometry.edge_radius > 0 ? (z + 1) * height_at(geometry, at) - 1 : z};
  };
  for (const double z : depths)
    for (const Vector2d& vertex : face->vertices) mesh.vertices.push_back(placed(vertex, z));
  for (unsigned int layer = 0; layer + 1 < depths.size(); ++layer)
    for (const FaceCell& cell : face->cells) {
      std::array<unsigned int, 8> vertices{};
      for (std::size_t i = 0; i < 4; ++i) {
        vertices[i] = layer * in_layer + cell.vertex[i];
        vertices[i + 4] = (layer + 1) * in_layer + cell.vertex[i];
      }
      mesh.cells.push_back(vertices);
      mesh.touched.push_back(layer + 2 == depths.size() && face->blocks[cell.block].touched);
    }
  mesh.curved = geometry.contact.is_rounded() || geometry.pad;
  mesh.place = [face, depths, placed](std::size_t number,
                                      const Eigen::Vector3d& unit) -> Eigen::Vector3d {
    const FaceCell& cell = face->cells[number % face->cells.size()];
    const std::size_t layer = number / face->cells.size();
    const Vector2d in_block = cell.low + unit.head<2>().cwiseProduct(cell.high - cell.low);
    const Vector2d at = face->blocks[cell.block].place(in_block.x(), in_block.y());
    return placed(at, depths[layer] + unit.z() * (depths[layer + 1] - depths[layer]));
  };
  return mesh;
}

}  // namespace softfinger::fem
