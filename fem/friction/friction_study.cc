#include "fem/friction/friction_study.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "fem/algebra/positive_definite.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

using Eigen::Index;

namespace {

double relative_radius(const PressedContact& contact, double x, double y) {
  return std::hypot(x / contact.a, y / contact.b);
}

double rim(const PressedContact& contact) {
  return contact.edge + contact.margin / contact.model.discretisation().elements_per_semi_axis;
}

/// Whether a node lies at the end of the contact's region.
bool is_spare(const PressedContact& contact, int node) {
  if (contact.region.places.empty() || contact.force[node] > 0) return false;
  const SurfaceNode& at = contact.model.nodes()[static_cast<std::size_t>(node)];
  return contact.region.distance(at.x, at.y) > contact.region.spacing;
}

FrictionalContact press(const PressedContact& contact, const SurfaceCompliance& surface) {
  Eigen::VectorXd gap(surface.size());
  for (Index i = 0; i < surface.size(); ++i)
    gap[i] = contact.gap[surface.model_node[static_cast<std::size_t>(i)]];
  Eigen::VectorXd area;
  if (contact.strength_share.size() > 0)
    area = surface.area.cwiseProduct(contact.strength_share(surface.model_node));
  const FrictionBound bound(contact.law, area);
  if (contact.rubbed)
    return {surface, gap, contact.load, bound, on_points(*contact.rubbed, surface)};
  return {surface, gap, contact.load, bound};
}

/// The first of the velocities, then always the one whose direction is nearest to the last.
/// @param arm  a length that makes a turn comparable with a shift
std::vector<std::size_t> short_way(const std::vector<PlaneMotion>& velocities, double arm) {
  const auto distance = [&](std::size_t one, std::size_t other) {
    const auto direction = [&](std::size_t i) {
      const PlaneMotion& velocity = velocities[i];
      return Eigen::Vector3d(velocity.x, velocity.y, arm * velocity.turn_rad).normalized();
    };
    return (direction(one) - direction(other)).norm();
  };
  std::vector<std::size_t> way(velocities.size());
  std::iota(way.begin(), way.end(), 0);
  for (auto last = way.begin(); last < way.end() && last + 1 < way.end(); ++last)
    std::iter_swap(last + 1, std::min_element(last + 1, way.end(), [&](auto one, auto other) {
                     return distance(one, *last) < distance(other, *last);
                   }));
  return way;
}

}  // namespace

void find_touching(const PressedContact& contact, const SurfaceCompliance& surface,
                   const FrictionalContact& state, FrictionState& result) {
  const double allowed =
      rim(contact) - spare_margin / contact.model.discretisation().elements_per_semi_axis;
  for (Index i = 0; i < surface.size(); ++i) {
    if (state.normal_force()[i] <= 0) continue;
    const int node = surface.model_node[static_cast<std::size_t>(i)];
    result.touching.push_back(node);
    const double radius = relative_radius(contact, surface.in_block(0, i), surface.in_block(1, i));
    result.edge = std::max(result.edge, radius);
    if (radius > allowed || is_spare(contact, node))
      throw EdgeLeftMargin("size of the frictional contact", static_cast<int>(i), radius,
                           "friction moved the contact's edge to this relative radius, out of the "
                           "refined patch; use a lower friction coefficient");
  }
}

bool is_in_region(const TouchedRegion& region, const SurfaceNode& node,
                  const LayerDiscretisation& mesh) {
  return region.places.empty() || region.distance(node.x, node.y) <=
                                      region.spacing + spare_margin / mesh.elements_per_semi_axis;
}

Eigen::VectorXd largest_friction(const PressedContact& contact) {
  const auto& nodes = contact.model.nodes();
  Eigen::VectorXd area = contact.strength_share;
  for (Index i = 0; i < area.size(); ++i) area[i] *= seen_area(nodes[static_cast<std::size_t>(i)]);
  return FrictionBound(contact.law, area).of(contact.force);
}

QuarterCompliances friction_compliances(const PressedContact& contact, Invariance fewest,
                                        KeptCompliances* kept) {
  std::vector<int> chosen;
  const auto& nodes = contact.model.nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    // A node that bears load takes part, even on an island that a finer mesh alone has found.
    const bool bears_load = contact.force[static_cast<Index>(i)] > 0;
    if (relative_radius(contact, nodes[i].x, nodes[i].y) <= rim(contact) &&
        (bears_load || is_in_region(contact.region, nodes[i], contact.model.discretisation())))
      chosen.push_back(static_cast<int>(i));
  }
  if (kept && *kept)
    if (std::optional<QuarterCompliances> part = part_of(**kept, chosen, fewest))
      return *std::move(part);
  QuarterCompliances made = quarter_compliances(contact.model, std::move(chosen), fewest);
  if (kept) *kept = std::make_shared<const QuarterCompliances>(made);
  return made;
}

double stuck_torsional_stiffness(const PressedContact& contact,
                                 const QuarterCompliances& quarters) {
  // A turn is odd about each mirror plane: one problem has its stiffness. The object also holds the
  // normal displacements of the nodes that touch.
  const Eigen::MatrixXd& odd = quarters.of_turn();
  const Eigen::VectorXd& force = contact.rubbed ? contact.rubbed->normal : contact.force;
  std::vector<Index> stuck;
  std::vector<double> turn;
  for (std::size_t i = 0; i < quarters.nodes.size(); ++i) {
    if (force[quarters.nodes[i]] <= 0) continue;
    const SurfaceNode& node = contact.model.nodes()[static_cast<std::size_t>(quarters.nodes[i])];
    const double displacement[] = {-node.position.y(), node.position.x(), 0};
    for (Index c = 0; c < 3; ++c) {
      const Index row = static_cast<Index>(3 * i) + c;
      if (odd(row, row) <= 0) continue;  // fixed by the symmetry
      stuck.push_back(row);
      turn.push_back(displacement[c]);
    }
  }
  const Eigen::Map<const Eigen::VectorXd> target(turn.data(), static_cast<Index>(turn.size()));
  const Eigen::MatrixXd compliance = odd(stuck, stuck);
  return copies(contact) * target.dot(solve_positive_definite(compliance, target));
}

std::vector<FrictionState> move_through(const PressedContact& contact,
                                        const SurfaceCompliance& surface,
                                        const std::vector<PlaneMotion>& motions,
                                        const OnState& on_state) {
  FrictionalContact state = press(contact, surface);
  std::vector<FrictionState> states;
  for (const PlaneMotion& motion : motions) {
    state.move_to(motion);
    states.push_back({motion, state.wrench(), state.slip_fraction()});
    find_touching(contact, surface, state, states.back());
    on_state(state, states.back());
  }
  return states;
}

std::vector<FrictionState> slide_through(const PressedContact& contact,
                                         const SurfaceCompliance& surface,
                                         const std::vector<PlaneMotion>& velocities) {
  FrictionalContact state = press(contact, surface);
  std::vector<FrictionState> states(velocities.size());
  // Each slide starts from the one before.
  for (const std::size_t i : short_way(velocities, contact.b)) {
    state.slide(velocities[i]);
    states[i] = {velocities[i], state.wrench(), 1};
    find_touching(contact, surface, state, states[i]);
  }
  return states;
}

std::vector<PlaneMotion> spread_velocities(int count, double arm) {
  const double golden_angle = M_PI * (3 - std::sqrt(5.0));
  std::vector<PlaneMotion> velocities;
  for (int i = 0; i < count; ++i) {
    const double turn = 1 - (2 * i + 1.0) / count, shift = std::sqrt(1 - turn * turn);
    velocities.push_back(
        {shift * std::cos(golden_angle * i), shift * std::sin(golden_angle * i), turn / arm});
  }
  return velocities;
}

}  // namespace softfinger::fem
