#include "fem/pad/check_pad.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "fem/base/formatted.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using Eigen::Vector2d;

/// Widths of a pad over its thickness within which the meshes were tested.
constexpr double narrowest_pad = 0.2, widest_pad = 200;
/// A face that is longer than this share of its width is nearly a line.
constexpr double longest_face = 40;
constexpr int most_corners = 12;
/// Fillets over the thickness: a smaller one needs cells that small and changes nothing, a larger
/// one leaves no side wall.
constexpr double least_fillet = 0.05, largest_fillet = 0.9;

[[noreturn]] void refuse(const PadProblem& problem, const std::string& field,
                         const std::string& value, const std::string& allowed) {
  throw InputError(problem.name, field, value, allowed);
}

void require_positive(const PadProblem& problem, double value, const std::string& field) {
  if (!(value > 0) || !std::isfinite(value))
    refuse(problem, field, formatted("%g", value), "> 0 and finite");
}

ConvexOutline outline_of(const PadProblem& problem, const FlatShape& shape,
                         const std::string& field) {
  switch (shape.kind) {
    case FlatShape::Kind::disc:
      require_positive(problem, shape.radius_m, field + ".radius_m");
      return ConvexOutline::disc(shape.radius_m);
    case FlatShape::Kind::rectangle: {
      require_positive(problem, shape.lengths_m[0], field + ".lengths_m");
      require_positive(problem, shape.lengths_m[1], field + ".lengths_m");
      const double largest = std::min(shape.lengths_m[0], shape.lengths_m[1]) / 2;
      if (!(shape.corner_radius_m >= 0 && shape.corner_radius_m <= largest * (1 + 1e-9)))
        refuse(problem, field + ".corner_radius_m", formatted("%g", shape.corner_radius_m),
               formatted("0 to half of the shorter length, %g", largest));
      return ConvexOutline::rectangle(shape.lengths_m[0], shape.lengths_m[1],
                                      std::min(shape.corner_radius_m, largest));
    }
    case FlatShape::Kind::polygon: {
      std::vector<Vector2d> points;
      for (const auto& [x, y] : shape.points_m) {
        if (!std::isfinite(x) || !std::isfinite(y))
          refuse(problem, field + ".points_m", formatted("%g, %g", x, y), "finite numbers");
        points.emplace_back(x, y);
      }
      ConvexOutline outline =
          ConvexOutline::polygon(std::move(points), problem.name, field + ".points_m");
      if (outline.corners() > most_corners)
        refuse(problem, field + ".points_m", formatted("%d corners", outline.corners()),
               formatted("at most %d: take a disc or a rectangle with a corner_radius_m",
                         most_corners));
      return outline;
    }
  }
  refuse(problem, field, "unknown", "disc, rectangle or polygon");
}

void check_numbers(const PadProblem& problem) {
  require_positive(problem, problem.thickness_m, "pad.thickness_m");
  require_positive(problem, problem.youngs_modulus_Pa, "pad.youngs_modulus_Pa");
  if (!(problem.poisson_ratio >= 0 && problem.poisson_ratio <= 0.5))
    refuse(problem, "pad.poisson_ratio", formatted("%.9g", problem.poisson_ratio),
           "0 <= nu <= 1/2");
  if (!(problem.edge_radius_m >= 0 &&
        problem.edge_radius_m <= largest_fillet * problem.thickness_m))
    refuse(problem, "pad.edge_radius_m", formatted("%g", problem.edge_radius_m),
           formatted("0 to %g, %g times the thickness", largest_fillet * problem.thickness_m,
                     largest_fillet));
  require_positive(problem, problem.load_N, "load_N");
  require_positive(problem, problem.friction_coefficient, "friction_coefficient");
  if (problem.level < 1 || problem.level > 3)
    refuse(problem, "level", std::to_string(problem.level), "1 to 3");
}

void check_size(const PadProblem& problem, const ConvexOutline& outline, const std::string& field) {
  const double narrow = outline.smallest_width(), wide = outline.largest_width();
  const auto in_thicknesses = [&](double length) {
    return formatted("%.4g thicknesses wide", length / problem.thickness_m);
  };
  if (narrow < narrowest_pad * problem.thickness_m)
    refuse(problem, field, in_thicknesses(narrow), formatted("at least %g", narrowest_pad));
  if (wide > widest_pad * problem.thickness_m)
    refuse(problem, field, in_thicknesses(wide), formatted("at most %g", widest_pad));
  if (wide > longest_face * narrow)
    refuse(problem, field, formatted("%.4g times as long as wide", wide / narrow),
           formatted("at most %g: longer pads need a plane model", longest_face));
}

bool is_along_axes(const FlatShape& shape, double angle_rad) {
  constexpr double straight = 1e-9;
  return shape.kind == FlatShape::Kind::rectangle && shape.corner_radius_m == 0 &&
         std::abs(std::sin(2 * angle_rad)) < straight;
}

/// The part of a rectangular pad that a rectangular face along its sides covers, whose sides are
/// the pad's or lie far enough inside.
/// @throws InputError where a side comes near to the pad's
ConvexOutline common_rectangle(const PadProblem& problem, const ConvexOutline& pad,
                               const ConvexOutline& face, double least_m) {
  Eigen::AlignedBox2d whole, covered;
  for (const Vector2d& corner : pad.corner_points()) whole.extend(corner);
  for (const Vector2d& corner : face.corner_points()) covered.extend(corner);
  const Eigen::AlignedBox2d common = whole.intersection(covered);
  if (common.isEmpty())
    refuse(problem, "face.offset_m", "beside the pad", "a face that lies over the pad");
  for (int axis = 0; axis < 2; ++axis)
    for (const double side : {common.min()[axis], common.max()[axis]}) {
      const double margin = std::min(side - whole.min()[axis], whole.max()[axis] - side);
      if (margin > 0 && margin < least_m)
        refuse(problem, "face", formatted("a side of it comes within %.3g m of the pad's", margin),
               formatted("sides beyond the pad's, or at least %.3g m inside of them", least_m));
    }
  return ConvexOutline::rectangle(common.sizes().x(), common.sizes().y(), 0)
      .placed(common.center(), 0);
}

/// Smallest distance of a face's outline from the pad's, inside of it.
double margin_in(const ConvexOutline& pad, const ConvexOutline& face) {
  double farthest = -std::numeric_limits<double>::infinity();
  constexpr int points = 64;
  for (int corner = 0; corner < face.corners(); ++corner)
    for (int i = 0; i <= points; ++i) {
      const double share = static_cast<double>(i) / points;
      const double straight =
          face.lengths_to_corner(corner).x() / face.lengths_to_corner(corner).sum();
      farthest = std::max(farthest, pad.distance(face.to_corner(corner, share, straight)));
      const double after =
          face.lengths_from_corner(corner).x() / face.lengths_from_corner(corner).sum();
      farthest = std::max(farthest, pad.distance(face.from_corner(corner, share, after)));
    }
  return -farthest;
}

}  // namespace

PadPlan plan_pad(const PadProblem& problem) {
  check_numbers(problem);
  const ConvexOutline pad = outline_of(problem, problem.outline, "pad.outline");
  check_size(problem, pad, "pad.outline");
  PadPlan plan{{pad, std::nullopt, {}}};
  if (problem.face) {
    const Vector2d offset(problem.face->offset_m[0], problem.face->offset_m[1]);
    if (!offset.allFinite() || !std::isfinite(problem.face->angle_rad))
      refuse(problem, "face.offset_m", formatted("%g, %g", offset.x(), offset.y()),
             "finite numbers");
    const ConvexOutline face = outline_of(problem, problem.face->shape, "face.outline")
                                   .placed(offset, problem.face->angle_rad);
    // A face that covers the pad is a plane.
    if (margin_in(face, pad) < 0) {
      const double margin = margin_in(pad, face);
      constexpr double least = 0.05;  // of the thickness: cells have to fit between
      const double least_m = least * problem.thickness_m;
      plan.geometry.pad = pad;
      if (margin >= least_m) {
        plan.geometry.contact = face;
        check_size(problem, face, "face.outline");
      } else if (is_along_axes(problem.outline, 0) &&
                 is_along_axes(problem.face->shape, problem.face->angle_rad)) {
        plan.geometry.contact = common_rectangle(problem, pad, face, least_m);
        plan.geometry.shares_sides = true;
        check_size(problem, plan.geometry.contact, "face.outline");
      } else {
        refuse(problem, "face",
               margin < 0 ? "its outline crosses the pad's"
                          : formatted("its outline comes within %.3g m of the pad's", margin),
               formatted("a face that covers the pad, one that stays %.3g m inside of it, or "
                         "rectangles with parallel sides and sharp corners",
                         least_m));
      }
    }
  }
  if (!plan.geometry.pad && problem.edge_radius_m > least_fillet * problem.thickness_m) {
    plan.geometry.pad = pad.expanded(problem.edge_radius_m);
    plan.geometry.edge_radius = problem.edge_radius_m / problem.thickness_m;
  }
  plan.origin_m = plan.geometry.contact.centroid();
  const double scale = 1 / problem.thickness_m;
  const auto in_thicknesses = [&](const ConvexOutline& outline) {
    return outline.placed(-plan.origin_m, 0).scaled(scale);
  };
  const bool symmetric = plan.geometry.contact.is_symmetric() &&
                         (!plan.geometry.pad || plan.geometry.pad->is_symmetric());
  if (symmetric && !plan.geometry.shares_sides) plan.geometry.planes = both_planes;
  plan.geometry.contact = in_thicknesses(plan.geometry.contact);
  if (plan.geometry.pad) plan.geometry.pad = in_thicknesses(*plan.geometry.pad);
  if (problem.load_point_m) {
    const Vector2d at((*problem.load_point_m)[0], (*problem.load_point_m)[1]);
    const double outside =
        at.allFinite() ? plan.geometry.contact.distance(scale * (at - plan.origin_m)) : kInfinity;
    if (!(outside < 0))
      refuse(problem, "load_point_m", formatted("%g, %g", at.x(), at.y()),
             "a point inside of the touched face: there it tips");
  }
  return plan;
}

}  // namespace softfinger::fem
