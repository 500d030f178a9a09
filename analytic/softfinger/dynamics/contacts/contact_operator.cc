#include "softfinger/dynamics/contacts/contact_operator.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "softfinger/dynamics/contacts/contact_residual.h"
#include "softfinger/math/wide.h"

namespace softfinger::internal {
namespace {

/// Whether all are zero, of either sign.
[[gnu::always_inline]] inline bool is_zero(const Four (&columns)[4]) {
  using Bits [[gnu::vector_size(sizeof(Four))]] = long long;
  const Bits any = (reinterpret_cast<Bits>(columns[0]) | reinterpret_cast<Bits>(columns[1]) |
                    reinterpret_cast<Bits>(columns[2]) | reinterpret_cast<Bits>(columns[3]))
                   << 1;
  return (any[0] | any[1] | any[2] | any[3]) == 0;
}

}  // namespace

ContactOperator::ContactOperator(int contact_capacity)
    : delassus_(Eigen::MatrixXd::Zero(4 * contact_capacity, 4 * contact_capacity)),
      free_velocity_(4 * contact_capacity),
      natural_sizes_(contact_capacity),
      impulse_scale_(4 * contact_capacity),
      velocity_scale_(4 * contact_capacity),
      metrics_(3 * contact_capacity),
      has_friction_(std::size_t(contact_capacity)),
      kept_friction_(std::size_t(contact_capacity)),
      shapes_(std::size_t(contact_capacity)),
      neighbours_(std::size_t(contact_capacity) * std::size_t(contact_capacity)),
      neighbour_end_(std::size_t(contact_capacity)),
      blocks_(16 * std::ptrdiff_t(contact_capacity) * contact_capacity) {}

void ContactOperator::set(const ContactLcp& problem, double proximal) {
  for (int j = 0; j < contacts_; ++j)
    for (const int i : neighbours(j)) delassus_.block<4, 4>(4 * i, 4 * j).setZero();
  contacts_ = problem.contacts();
  for (int i = 0; i < contacts_; ++i) scale_contact(problem, i);
  const int n = 4 * contacts_;
  set_blocks(problem.delassus, proximal);
  const bool has_root = problem.root.cols() > 0 && problem.root.cols() < n && proximal == 0;
  given_root_ = has_root ? &problem.root : nullptr;
  free_velocity_.head(n) = velocity_scale_.head(n).cwiseProduct(problem.free_velocity);
  velocity_unit_ = free_velocity_.head(n).lpNorm<Eigen::Infinity>();
  if (velocity_unit_ > 0) free_velocity_.head(n) /= velocity_unit_;
  const double largest_velocity = problem.free_velocity.lpNorm<Eigen::Infinity>();
  for (int i = 0; i < contacts_; ++i)
    natural_sizes_[i] =
        std::min(1., velocity_scale_[4 * i + 1] * largest_velocity / velocity_unit_);
}

void ContactOperator::scale_contact(const ContactLcp& problem, int i) {
  const double mu = problem.friction_coefficient[i], arm_m = problem.eccentricity_m[i];
  const Eigen::Vector3d arms(1, 1, arm_m);
  const double normal = problem.delassus(4 * i, 4 * i);
  const Eigen::Matrix3d tangential =
      arms.asDiagonal() * problem.delassus.block<3, 3>(4 * i + 1, 4 * i + 1) * arms.asDiagonal();
  // With a long arm on a light body the row about the normal would outweigh all others: the rows of
  // slip are scaled by the largest of the four.
  const double largest = std::max(normal, tangential.diagonal().maxCoeff());
  const double scale = 1 / std::sqrt(normal);
  impulse_scale_[4 * i] = velocity_scale_[4 * i] = scale;
  impulse_scale_.segment<3>(4 * i + 1) = (mu > 0 ? mu : 1) * scale * arms;
  velocity_scale_.segment<3>(4 * i + 1) = normal / largest * scale * arms;

  const bool moves = tangential.diagonal().maxCoeff() > 0 ||
                     !problem.free_velocity.segment<3>(4 * i + 1).cwiseProduct(arms).isZero(0);
  const bool has_limit = is_exact(problem) || problem.vertices.cols() > 0;
  has_friction_[std::size_t(i)] = mu > 0 && has_limit && moves;
  const bool has_shape = problem.friction_rule == FrictionRule::limit_surface && arm_m > 0;
  shapes_[std::size_t(i)] = has_shape ? problem.shapes[std::size_t(i)] : nullptr;
}

/// Contacts without a common movable body do not feel each other: their blocks of W are zero. Of
/// many contacts most are, so that each block is looked at once.
void ContactOperator::set_blocks(const Eigen::MatrixXd& delassus, double proximal) {
  with_best_instructions([&] {
    for (int j = 0; j < contacts_; ++j) {
      int end = j * contacts_;
      for (int i = 0; i < contacts_; ++i) {
        const double* given = &delassus(4 * i, 4 * j);
        Four columns[4], scale;
        for (int k = 0; k < 4; ++k) load(given + k * delassus.rows(), columns[k]);
        if (is_zero(columns)) continue;
        double *own = &delassus_(4 * i, 4 * j), *block = blocks_.data() + 16 * end;
        load(velocity_scale_.data() + 4 * i, scale);
        for (int k = 0; k < 4; ++k) {
          columns[k] = scale * columns[k] * impulse_scale_[4 * j + k];
          store(columns[k], own + k * delassus_.rows());
          store(columns[k], block + 4 * k);
        }
        if (i == j && proximal != 0)
          for (int k = 0; k < 4; ++k)
            block[5 * k] = own[k * (delassus_.rows() + 1)] *= 1 + proximal;
        neighbours_[std::size_t(end++)] = i;
      }
      neighbour_end_[std::size_t(j)] = end;
    }
  });
  for (int j = 0; j < contacts_; ++j) {
    const Eigen::Vector3d own = delassus_.block<3, 3>(4 * j + 1, 4 * j + 1).diagonal();
    metrics_.segment<3>(3 * j) = (own.array() > 0).select(own, 1);
  }
}

void ContactOperator::find_velocity(const Eigen::VectorXd& impulses,
                                    Eigen::VectorXd& velocity) const {
  velocity.head(4 * contacts_).setZero();
  with_best_instructions([&] {
    for (int j = 0; j < contacts_; ++j) {
      const double* impulse = impulses.data() + 4 * j;
      if (impulse[0] == 0 && impulse[1] == 0 && impulse[2] == 0 && impulse[3] == 0) continue;
      for (int n = j * contacts_; n < neighbour_end_[std::size_t(j)]; ++n) {
        const double* block = blocks_.data() + 16 * n;
        double* to = velocity.data() + 4 * neighbours_[std::size_t(n)];
        Four sum, first, second, third, fourth;
        load(to, sum);
        load(block, first);
        load(block + 4, second);
        load(block + 8, third);
        load(block + 12, fourth);
        sum = sum +
              (impulse[0] * first + impulse[1] * second + impulse[2] * third + impulse[3] * fourth);
        store(sum, to);
      }
    }
  });
}

bool ContactOperator::separates() const {
  for (int i = 0; i < contacts_; ++i)
    if (free_velocity_[4 * i] < 0) return false;
  return true;
}

void ContactOperator::drop_friction() {
  kept_friction_ = has_friction_;
  std::fill(has_friction_.begin(), has_friction_.end(), char(false));
}

Eigen::Vector3d ContactOperator::boundary_point(int contact,
                                                const Eigen::Vector3d& direction) const {
  const FrictionShape* own = shape(contact);
  return own ? own->boundary(direction, nullptr) : direction.stableNormalized();
}

}  // namespace softfinger::internal
