#include "fem/pad/curved_contact.h"

#include <algorithm>

#include "fem/algebra/positive_definite.h"
#include "fem/contact/active_set.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

using Eigen::Index;

FaceCompliance::FaceCompliance(PadModel& model, Parity parity) {
  const FaceStiffness face = model.face_stiffness(parity);
  std::vector<Index> normal, tangential;
  for (std::size_t i = 0; i < face.node.size(); ++i)
    if (face.component[i] == 2) {
      normal.push_back(static_cast<Index>(i));
      node_.push_back(face.node[i]);
    } else {
      tangential.push_back(static_cast<Index>(i));
    }
  // Normal forces move the face along itself, too: its compliance is a block of the whole one.
  const Eigen::MatrixXd coupling = face.stiffness(tangential, normal);
  Eigen::MatrixXd factor = face.stiffness(tangential, tangential);
  if (factorise_positive_definite(factor)) {
    Eigen::MatrixXd stiffness = face.stiffness(normal, normal);
    stiffness.noalias() -= coupling.transpose() * solve_by_factor(factor, coupling);
    compliance_ = inverse_of_positive_definite(stiffness);
  }
  if (compliance_.size() == 0)
    throw ConvergenceError("condensation of the pad's face", 0, 0,
                           "its stiffness is not positive definite; is nu too near 1/2?");
}

CurvedContact FaceCompliance::press(const Eigen::VectorXd& gap, double load) const {
  ActiveSet set(gap, nullptr);
  CurvedContact contact;
  const Index count = compliance_.rows();
  for (contact.iterations = 1; contact.iterations <= ActiveSet::most_steps; ++contact.iterations) {
    const std::vector<Index> touching = set.touching();
    Eigen::MatrixXd factor = compliance_(touching, touching);
    if (!factorise_positive_definite(factor)) break;
    Eigen::MatrixXd sides(static_cast<Index>(touching.size()), 2);
    sides.col(0).setOnes();
    sides.col(1) = gap(touching);
    const Eigen::MatrixXd forces = solve_by_factor(factor, sides);
    contact.approach = (load + forces.col(1).sum()) / forces.col(0).sum();
    contact.force = Eigen::VectorXd::Zero(count);
    contact.force(touching) = contact.approach * forces.col(0) - forces.col(1);
    const Eigen::VectorXd clearance = product_with_zeros(compliance_, contact.force) + gap -
                                      Eigen::VectorXd::Constant(count, contact.approach);
    if (!set.improve(contact.force, clearance, contact.force.cwiseAbs().maxCoeff(),
                     contact.approach))
      continue;
    contact.force = contact.force.cwiseMax(0.0);
    contact.touching = touching;
    return contact;
  }
  set.give_up();
}

Eigen::MatrixXd FaceCompliance::resultants(const std::vector<Index>& touching,
                                           const Eigen::MatrixXd& shapes) const {
  std::vector<Index> rows, nodes;
  for (std::size_t i = 0; i < node_.size(); ++i)
    if (std::find(touching.begin(), touching.end(), node_[i]) != touching.end()) {
      rows.push_back(static_cast<Index>(i));
      nodes.push_back(node_[i]);
    }
  const Eigen::MatrixXd moved = shapes(nodes, Eigen::all);
  Eigen::MatrixXd factor = compliance_(rows, rows);
  if (!factorise_positive_definite(factor))
    throw ConvergenceError("stiffness of the pad's contact", 0, 0, "it is not positive definite");
  return moved.transpose() * solve_by_factor(factor, moved);
}

}  // namespace softfinger::fem
