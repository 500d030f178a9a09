#include "softfinger/dynamics/facets/covering_vector.h"

#include <algorithm>
#include <limits>

#include "softfinger/dynamics/contacts/repeatable_random.h"

namespace softfinger::internal {

CoveringVector::CoveringVector(int contact_capacity, int vertex_capacity)
    : normal_(contact_capacity),
      slip_(contact_capacity),
      slack_(contact_capacity),
      vertex_(std::size_t(contact_capacity) * std::size_t(vertex_capacity)),
      least_of_vertices_(contact_capacity),
      uncovered_(std::size_t(contact_capacity) * std::size_t(vertex_capacity + 2)),
      is_basic_(uncovered_.size()) {
  uncovered_rows_.reserve(uncovered_.size());
}

void CoveringVector::choose(int number, int contacts) {
  const auto random = [number](int kind, int index) {
    return hash_to_unit(std::uint64_t(4 * number + kind), std::uint64_t(index));
  };
  for (int i = 0; i < contacts; ++i) {
    normal_[i] = 1 + random(0, i);
    slip_[i] = 1 + random(1, i);
    slack_[i] = 1 + random(2, i);
  }
  number_ = number;
}

void CoveringVector::forget_vertices() {
  least_of_vertices_.setConstant(std::numeric_limits<double>::infinity());
}

void CoveringVector::cover_vertex(int contact, int vertex, int slot) {
  constexpr double kSpread = 0.1;
  const double random = hash_to_unit(std::uint64_t(4 * number_ + 3), std::uint64_t(vertex));
  set_vertex(contact, slot, slip_[contact] * (1 + kSpread * random));
}

void CoveringVector::lead_towards(const int* basic, int k, const ContactOperator& contacts,
                                  const FrictionVertices& vertices, const ContactPairs& pairs) {
  constexpr double kSmall = 0.1;  // w0 in the rows of `basic`, over that of the others
  for (int p = 0; p < k; ++p) is_basic_[std::size_t(basic[p])] = char(true);
  const auto lead = [&](int row, double constant) {
    const double size =
        contacts.natural_size(pairs[row].contact) * (is_basic_[std::size_t(row)] ? kSmall : 1);
    return std::max(-constant, 0.) + size * (1 + hash_to_unit(4, std::uint64_t(row)));
  };
  forget_vertices();
  for (int i = 0; i < contacts.contacts(); ++i) {
    normal_[i] = lead(pairs.normal(i), contacts.free_velocity()[4 * i]);
    slack_[i] = lead(pairs.slip(i), 0);
    const Eigen::Vector3d free_slip = contacts.free_velocity().segment<3>(4 * i + 1);
    for (const int j : vertices.in_use(i))
      set_vertex(i, pairs.slot(i, j), lead(pairs.vertex(i, j), vertices.vertex(j).dot(free_slip)));
  }
  for (int p = 0; p < k; ++p) is_basic_[std::size_t(basic[p])] = char(false);
}

void CoveringVector::cover_all_but(const int* rows, int k) {
  for (const int row : uncovered_rows_) uncovered_[std::size_t(row)] = char(false);
  uncovered_rows_.assign(rows, rows + k);
  for (const int row : uncovered_rows_) uncovered_[std::size_t(row)] = char(true);
}

void CoveringVector::set_vertex(int contact, int slot, double value) {
  vertex_[std::size_t(slot)] = value;
  least_of_vertices_[contact] = std::min(least_of_vertices_[contact], value);
}

}  // namespace softfinger::internal
