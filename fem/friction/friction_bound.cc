#include "fem/friction/friction_bound.h"

namespace softfinger::fem {

using Eigen::Index;

Eigen::VectorXd FrictionBound::of(const Eigen::VectorXd& normal_force) const {
  Eigen::VectorXd result(normal_force.size());
  for (Index i = 0; i < normal_force.size(); ++i) result[i] = at(i, normal_force[i]);
  return result;
}

Eigen::VectorXd strength_share(const ShearLaw& law, const TouchedNodes& nodes) {
  const Index count = nodes.force.size();
  if (law.kind == ShearLaw::Kind::coulomb || law.kind == ShearLaw::Kind::limited)
    return Eigen::VectorXd::Ones(count);
  double inner = 0, edge = 0;
  const auto is_at_edge = [&](Index i) { return nodes.radius[i] > 1 - nodes.cell; };
  for (Index i = 0; i < count; ++i)
    if (nodes.force[i] > 0) (is_at_edge(i) ? edge : inner) += nodes.area[i];
  double of_edge = edge > 0 ? (nodes.contact_area - inner) / edge : 0, of_inner = 1;
  // A contact far from its ellipse: all nodes alike.
  constexpr double least = 0.25, most = 2;
  if (!(of_edge >= least && of_edge <= most))
    of_edge = of_inner = nodes.contact_area / (inner + edge);
  Eigen::VectorXd share = Eigen::VectorXd::Zero(count);
  for (Index i = 0; i < count; ++i)
    if (nodes.force[i] > 0) share[i] = is_at_edge(i) ? of_edge : of_inner;
  return share;
}

}  // namespace softfinger::fem
