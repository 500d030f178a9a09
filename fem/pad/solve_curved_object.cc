#include "fem/pad/solve_curved_object.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "fem/base/formatted.h"
#include "fem/base/memory.h"
#include "fem/base/stopwatch.h"
#include "fem/friction/friction_study.h"
#include "fem/pad/check_pad.h"
#include "fem/pad/curved_contact.h"
#include "fem/pad/grid_mesh.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Cells in half of the contact by level; level 0 looks for the contact's size.
constexpr std::array<int, 4> cells_across{4, 6, 10, 16};
int cells_of(int level) { return cells_across.at(static_cast<std::size_t>(level)); }
/// Part of the contact's half-length beyond which nodes cannot touch.
constexpr double touchable_share = 1.25;

/// The problem in thicknesses and Young's moduli, its origin in the object's middle.
struct CurvedGeometry {
  std::array<GridAxis, 2> axes;
  Vector2d curvatures;
  MirrorPlanes planes;
  double load = 0;

  double gap(const Vector2d& at) const { return 0.5 * curvatures.dot(at.cwiseAbs2()); }
};

void refuse_others(const PadProblem& problem) {
  const auto refuse = [&](const std::string& field, const std::string& value,
                          const std::string& allowed) {
    throw InputError(problem.name, field, value, allowed);
  };
  if (problem.outline.kind != FlatShape::Kind::rectangle)
    refuse("pad.outline.shape", "not a rectangle", "\"rectangle\" under a curved object");
  if (problem.face) refuse("face", "beside object", "one of them");
  if (problem.pressing == PadPressing::stuck)
    refuse("pressing", "stuck",
           "\"frictionless\" under a curved object: points that stick as they touch depend on the "
           "load's history");
  if (problem.load_point_m)
    refuse("load_point_m", "given", "none under a curved object, which does not turn");
  for (std::size_t i = 0; i < 2; ++i) {
    if (!(problem.object->radii_m[i] > 0))
      refuse("object.radii_m", formatted("%g", problem.object->radii_m[i]), "> 0");
    const double half_m = problem.outline.lengths_m[i] / 2, offset_m = problem.object->offset_m[i];
    if (!(std::abs(offset_m) < half_m))
      refuse("object.offset_m", formatted("%g", offset_m), "the object's middle within the pad");
  }
  if (std::isinf(problem.object->radii_m[0]) && std::isinf(problem.object->radii_m[1]))
    refuse("object.radii_m", "inf, inf", "a curved object: a plane is given by no object at all");
}

CurvedGeometry geometry_of(const PadProblem& problem) {
  plan_pad(problem);  // checks the numbers
  refuse_others(problem);
  const double h = problem.thickness_m;
  CurvedGeometry geometry;
  for (std::size_t i = 0; i < 2; ++i) {
    GridAxis& axis = geometry.axes[i];
    const double half = problem.outline.lengths_m[i] / 2 / h,
                 offset = problem.object->offset_m[i] / h;
    // A cylinder may lie anywhere along its axis.
    const bool is_straight = std::isinf(problem.object->radii_m[i]);
    axis.is_mirrored = is_straight || offset == 0;
    axis.low = axis.is_mirrored ? 0 : -half - offset;
    axis.high = is_straight ? half : half - offset;
    geometry.curvatures[static_cast<Index>(i)] = h / problem.object->radii_m[i];
  }
  geometry.planes = {geometry.axes[0].is_mirrored, geometry.axes[1].is_mirrored};
  geometry.load = problem.load_N / (problem.youngs_modulus_Pa * h * h);
  return geometry;
}

/// One mesh with the object pressed on it.
class CurvedSolver {
 public:
  CurvedSolver(const CurvedGeometry& geometry, double poisson_ratio, int level)
      : geometry_(geometry),
        x_(lines(0, level)),
        y_(lines(1, level)),
        depths_(grid_depths(std::min(geometry.axes[0].contact, geometry.axes[1].contact),
                            cells_of(level))),
        model_(grid_mesh(x_, y_, depths_, touchable()), geometry.planes, poisson_ratio),
        compliance_(model_, Parity{}) {
    const auto count = static_cast<Index>(model_.nodes().size());
    place_.resize(2, count);
    weight_.resize(count);
    gap_.resize(count);
    for (Index i = 0; i < count; ++i) {
      const SurfaceNode& node = model_.nodes()[static_cast<std::size_t>(i)];
      place_.col(i) = Vector2d(node.x, node.y);
      weight_[i] = node.weight;
      gap_[i] = geometry.gap(place_.col(i));
    }
    contact_ = press(1);
  }

  const CurvedContact& contact() const { return contact_; }
  const PadModel& model() const { return model_; }
  int cells_deep() const { return static_cast<int>(depths_.size()) - 1; }
  const Eigen::Matrix2Xd& place() const { return place_; }
  const Eigen::VectorXd& weight() const { return weight_; }

  /// Mean of the pressure around a node, by its shape function.
  double pressure(Index node) const { return contact_.force[node] / weight_[node]; }

  /// Distance that the contact reaches from the middle along an axis, on the line through the
  /// middle: where the square of the pressure, which is smooth up to there, is zero.
  double reach(Index axis) const {
    const Index other = 1 - axis;
    double nearest = kInfinity;
    for (Index i = 0; i < place_.cols(); ++i)
      nearest = std::min(nearest, std::abs(place_(other, i)));
    std::vector<std::pair<double, Index>> row;
    for (Index i = 0; i < place_.cols(); ++i)
      if (std::abs(place_(other, i)) < nearest + 1e-9 && place_(axis, i) > -1e-9)
        row.emplace_back(place_(axis, i), i);
    std::sort(row.begin(), row.end());
    double last = 0, spacing = 0;
    std::vector<Index> inner;
    // Vertices: the nodes between them average differently. The mean of the last one reaches over
    // the edge.
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (!(contact_.force[row[i].second] > 0)) continue;
      last = row[i].first;
      if (i + 2 < row.size()) spacing = row[i + 2].first - last;
      if (i % 2 == 0) inner.push_back(row[i].second);
    }
    const double wall = geometry_.axes[static_cast<std::size_t>(axis)].high;
    if (last > wall - 1e-9) return wall;
    if (inner.size() < 5) return last;
    inner.pop_back();
    // p² over x² is a line for Hertz's contact, and bends little for others: one through the outer
    // half of the nodes.
    const std::size_t first = inner.size() / 2;
    Eigen::MatrixXd matrix(static_cast<Index>(inner.size() - first), 2);
    Eigen::VectorXd squares(matrix.rows());
    for (Index i = 0; i < matrix.rows(); ++i) {
      const Index node = inner[first + static_cast<std::size_t>(i)];
      matrix.row(i) << 1, std::pow(place_(axis, node), 2);
      squares[i] = std::pow(pressure(node), 2);
    }
    const Vector2d line = matrix.colPivHouseholderQr().solve(squares);
    if (!(line[0] > 0 && line[1] < 0)) return last;
    return std::clamp(std::sqrt(-line[0] / line[1]), last - spacing,
                      std::min(wall, last + spacing));
  }

  /// Whether nodes touch at the end of what can be touched.
  bool is_cramped() const {
    const Eigen::AlignedBox2d box = touchable();
    for (const Index i : contact_.touching)
      for (Index axis = 0; axis < 2; ++axis) {
        const GridAxis& along = geometry_.axes[static_cast<std::size_t>(axis)];
        const double end = largest_place(axis), at = place_(axis, i);
        if (box.max()[axis] < along.high && at > end - 1e-9) return true;
      }
    return false;
  }

  /// Stiffness against approach, and against turns that make it deeper along x and along y, the
  /// object being free to approach.
  Eigen::Vector3d stiffness() {
    // The contact grows from node to node, and so jumps what it resists while it stays as it is.
    // Loads that are apart tell the slope: the logarithms' is nearly constant.
    constexpr double apart = 1.2;
    const double larger = press(apart).approach, smaller = press(1 / apart).approach;
    const double normal =
        geometry_.load / contact_.approach * 2 * std::log(apart) / std::log(larger / smaller);
    Eigen::MatrixXd shapes(place_.cols(), 3);
    shapes << Eigen::VectorXd::Ones(place_.cols()), place_.transpose();
    const double jumping = compliance_.resultants(contact_.touching, shapes.leftCols(1))(0, 0);
    Eigen::Vector3d result(normal, 0, 0);
    for (const Index axis : {0, 1}) {
      double turning = 0;
      if (geometry_.axes[static_cast<std::size_t>(axis)].is_mirrored) {
        const FaceCompliance odd(model_, {axis == 0, axis == 1});
        turning = odd.resultants(contact_.touching, shapes.col(1 + axis))(0, 0);
      } else {
        const Eigen::MatrixXd both = compliance_.resultants(
            contact_.touching, shapes(Eigen::all, std::array<Index, 2>{0, 1 + axis}));
        turning = both(1, 1) - both(0, 1) * both(0, 1) / both(0, 0);
      }
      result[1 + axis] = normal * turning / jumping;
    }
    return result;
  }

  /// Calls `use(place, force)` at the nodes of the whole face.
  template <class Use>
  void for_each_force(const Use& use) const {
    for (const Index i : contact_.touching)
      for (int k = 0; k < geometry_.planes.images(); ++k)
        use(geometry_.planes.image(k).signs().head<2>().cwiseProduct(place_.col(i)).eval(),
            contact_.force[i]);
  }

 private:
  CurvedContact press(double share) const {
    return compliance_.press(gap_, share * geometry_.load / geometry_.planes.images());
  }
  std::vector<double> lines(std::size_t axis, int level) const {
    return grid_lines(geometry_.axes[axis], cells_of(level));
  }
  Eigen::AlignedBox2d touchable() const {
    Eigen::AlignedBox2d box;
    for (Index i = 0; i < 2; ++i) {
      const GridAxis& axis = geometry_.axes[static_cast<std::size_t>(i)];
      const double reach = touchable_share * axis.contact;
      box.min()[i] = std::max(axis.low, -reach);
      box.max()[i] = std::min(axis.high, reach);
    }
    return box;
  }
  double largest_place(Index axis) const { return place_.row(axis).maxCoeff(); }

  const CurvedGeometry& geometry_;
  const std::vector<double> x_, y_, depths_;
  PadModel model_;
  FaceCompliance compliance_;
  Eigen::Matrix2Xd place_;
  Eigen::VectorXd weight_, gap_;
  CurvedContact contact_;
};

/// Half-lengths of the contact, by coarse meshes: each is made for what the one before it found.
void find_contact(CurvedGeometry& geometry, double poisson_ratio, const StopRequested& stop) {
  // Hertz's line or circle on a half-space is wider than any contact of a layer.
  for (std::size_t i = 0; i < 2; ++i) {
    GridAxis& axis = geometry.axes[i];
    const double curvature = geometry.curvatures[static_cast<Index>(i)];
    const double other = geometry.axes[1 - i].high * (geometry.axes[1 - i].is_mirrored ? 2 : 1);
    if (curvature == 0) {
      axis.contact = 2 * axis.high;
    } else {
      const double line = std::sqrt(4 / 3.0 * geometry.load / other / curvature),
                   circle = std::cbrt(0.75 * geometry.load / curvature);
      axis.contact = std::min(2 * axis.high, std::max(line, circle));
    }
  }
  constexpr int most_steps = 12;
  constexpr double near_enough = 0.2;
  for (int step = 0; step < most_steps; ++step) {
    if (stop()) throw Interrupted();
    const CurvedSolver solver(geometry, poisson_ratio, 0);
    const bool is_cramped = solver.is_cramped();
    double change = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      GridAxis& axis = geometry.axes[i];
      double reach = is_cramped ? 1.5 * axis.contact : solver.reach(static_cast<Index>(i));
      // A contact that ends at a wall has no edge of its own.
      if (reach >= axis.high - 1e-9) reach = 2 * axis.high;
      change = std::max(change, std::abs(std::log(reach / axis.contact)));
      axis.contact = reach;
    }
    if (change < near_enough) return;
  }
}

double relative(double change, double value) { return value == 0 ? 0 : std::abs(change / value); }

/// Errors by the difference of two levels. The contact's edge lies anywhere in a cell, so that they
/// do not fall evenly, and nothing is extrapolated.
void state_errors(const PadLevel& coarse, const PadLevel& fine, PadError& error) {
  constexpr double share = 0.5;
  const double common = fine.level < 2 ? 4e-3 : 1e-3;
  const auto of = [&](double before, double after) {
    return share * relative(after - before, after) + common;
  };
  error.indentation = of(coarse.indentation_m, fine.indentation_m);
  error.normal_stiffness = of(coarse.normal_stiffness_N_per_m, fine.normal_stiffness_N_per_m);
  error.pressure_arm = of(coarse.pressure_arm_m, fine.pressure_arm_m);
  error.eccentricity = error.max_torque = error.pressure_arm;
  // The value of a single node.
  constexpr double of_node = 1e-2;
  error.peak_pressure = of(coarse.peak_pressure_Pa, fine.peak_pressure_Pa) + of_node;
  for (std::size_t i = 0; i < 2; ++i)
    error.tilt_stiffness[i] =
        of(coarse.tilt_stiffness_Nm_per_rad[i], fine.tilt_stiffness_Nm_per_rad[i]);
}

}  // namespace

PadResult solve_curved_object(const PadProblem& problem, const Progress& progress,
                              const StopRequested& stop) {
  const Stopwatch watch;
  CurvedGeometry geometry = geometry_of(problem);
  find_contact(geometry, problem.poisson_ratio, stop);
  const double h = problem.thickness_m, E = problem.youngs_modulus_Pa;
  const Vector2d origin_m(std::isinf(problem.object->radii_m[0]) ? 0 : problem.object->offset_m[0],
                          std::isinf(problem.object->radii_m[1]) ? 0 : problem.object->offset_m[1]);
  PadResult result;
  result.planes = geometry.planes;
  for (int level = problem.level - 1; level <= problem.level; ++level) {
    if (stop()) throw Interrupted();
    const Stopwatch of_level;
    CurvedSolver solver(geometry, problem.poisson_ratio, level);
    PadLevel answer;
    answer.level = level;
    answer.cells_across = cells_of(level);
    answer.cells_deep = solver.cells_deep();
    answer.unknowns = solver.model().unknowns();
    answer.face_nodes = static_cast<int>(solver.place().cols());
    answer.indentation_m = h * solver.contact().approach;
    Vector2d centre = Vector2d::Zero();
    solver.for_each_force(
        [&](const Vector2d& at, double force) { centre += force / geometry.load * at; });
    double arm = 0;
    solver.for_each_force([&](const Vector2d& at, double force) {
      arm += force / geometry.load * (at - centre).norm();
    });
    answer.pressure_arm_m = answer.eccentricity_m = h * arm;
    answer.max_torque_Nm = problem.friction_coefficient * problem.load_N * answer.eccentricity_m;
    double area = 0;
    for (const Index i : solver.contact().touching) {
      area += geometry.planes.images() * solver.weight()[i];
      answer.peak_pressure_Pa = std::max(answer.peak_pressure_Pa, E * solver.pressure(i));
    }
    answer.area_m2 = h * h * area;
    answer.contact_half_lengths_m = {h * solver.reach(0), h * solver.reach(1)};
    const Eigen::Vector3d stiffness = solver.stiffness();
    answer.normal_stiffness_N_per_m = E * h * stiffness[0];
    // A turn about y makes it deeper along x.
    answer.tilt_stiffness_Nm_per_rad = {E * h * h * h * stiffness[2], E * h * h * h * stiffness[1]};
    answer.cpu_s = of_level.cpu_seconds();
    progress(formatted("level %d: %ld unknowns, d %.6g m, %.2f s", level, answer.unknowns,
                       answer.indentation_m, of_level.seconds()));
    result.levels.push_back(answer);
    if (level < problem.level) continue;
    const Vector2d centre_m = origin_m + h * centre;
    result.centre_of_pressure_m = result.load_point_m =
        result.stiffness_centre_m = {centre_m.x(), centre_m.y()};
    for (Index i = 0; i < solver.place().cols(); ++i) {
      // On a mirror plane the image is the node itself, whose weight is then that of both.
      constexpr double on_plane = 1e-12;
      const Vector2d place = solver.place().col(i);
      const bool on_x = geometry.planes.x && std::abs(place.x()) < on_plane,
                 on_y = geometry.planes.y && std::abs(place.y()) < on_plane;
      const double weight = (on_x ? 2 : 1) * (on_y ? 2 : 1) * solver.weight()[i];
      for (int k = 0; k < geometry.planes.images(); ++k) {
        const Image image = geometry.planes.image(k);
        if ((on_x && image.mirror_x) || (on_y && image.mirror_y)) continue;
        const Vector2d at = image.signs().head<2>().cwiseProduct(place);
        result.pressure.x_m.push_back(origin_m.x() + h * at.x());
        result.pressure.y_m.push_back(origin_m.y() + h * at.y());
        result.pressure.pressure_Pa.push_back(E * solver.pressure(i));
        result.pressure.weight_m2.push_back(h * h * weight);
      }
    }
    for (const PlaneMotion& velocity : spread_velocities(problem.limit_surface, arm)) {
      Eigen::Vector3d wrench = Eigen::Vector3d::Zero();
      solver.for_each_force([&](const Vector2d& at, double force) {
        const Vector2d from = at - centre;
        const Vector2d slip(velocity.x - velocity.turn_rad * from.y(),
                            velocity.y + velocity.turn_rad * from.x());
        if (!(slip.norm() > 0)) return;
        const Vector2d traction = problem.friction_coefficient * force / slip.norm() * slip;
        wrench += Eigen::Vector3d(traction.x(), traction.y(),
                                  from.x() * traction.y() - from.y() * traction.x());
      });
      wrench *= E * h * h;
      result.limit_surface.push_back({wrench[0], wrench[1], h * wrench[2]});
    }
  }
  result.finest = result.levels.back();
  state_errors(result.levels.front(), result.finest, result.error);
  result.wall_s = watch.seconds();
  result.cpu_s = watch.cpu_seconds();
  result.peak_memory_MB = peak_memory_MB();
  return result;
}

}  // namespace softfinger::fem
