#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

#include "fem/layer/layer_space.h"

// The part of LayerSpace that numbers unknowns and gives matrices their form.
namespace softfinger::fem {

using dealii::types::global_dof_index;

dealii::AffineConstraints<double> LayerSpace::constraints_in(
    const std::vector<Eigen::Matrix3d>& frames) const {
  dealii::AffineConstraints<double> turned;
  for (const auto& line : constraints.get_lines()) {
    turned.add_line(line.index);
    for (const auto& [dof, share] : line.entries) {
      const int node = surface_node[dof];
      if (node < 0) {
        turned.add_entry(line.index, dof, share);
        continue;
      }
      const auto number = static_cast<std::size_t>(node);
      for (std::size_t c = 0; c < dim; ++c)
        turned.add_entry(line.index, node_dofs[number][c],
                         share * frames[number](component[line.index], static_cast<int>(c)));
    }
  }
  turned.close();
  return turned;
}

std::vector<std::pair<int, double>> LayerSpace::node_shares(std::size_t face,
                                                            std::size_t place) const {
  const global_dof_index dof = face_dofs[face][place][2];
  if (surface_node[dof] >= 0) return {{surface_node[dof], 1.0}};
  std::vector<std::pair<int, double>> shares;
  if (const auto* masters = constraints.get_constraint_entries(dof))
    for (const auto& [master, share] : *masters)
      if (surface_node[master] >= 0) shares.emplace_back(surface_node[master], share);
  return shares;
}

void LayerSpace::turn_to_frames(const std::vector<Eigen::Matrix3d>& frames,
                                const std::vector<global_dof_index>& indices,
                                dealii::FullMatrix<double>& matrix) const {
  std::map<int, std::array<unsigned int, 3>> places;
  for (unsigned int i = 0; i < indices.size(); ++i)
    if (const int node = surface_node[indices[i]]; node >= 0)
      places[node][static_cast<std::size_t>(component[indices[i]])] = i;
  for (const auto& [node, place] : places) {
    const Eigen::Matrix3d& frame = frames[static_cast<std::size_t>(node)];
    for (unsigned int j = 0; j < indices.size(); ++j) {
      const Eigen::Vector3d row(matrix(place[0], j), matrix(place[1], j), matrix(place[2], j));
      const Eigen::Vector3d turned = frame.transpose() * row;
      for (unsigned int c = 0; c < 3; ++c) matrix(place[c], j) = turned[c];
    }
    for (unsigned int j = 0; j < indices.size(); ++j) {
      const Eigen::Vector3d column(matrix(j, place[0]), matrix(j, place[1]), matrix(j, place[2]));
      const Eigen::Vector3d turned = frame.transpose() * column;
      for (unsigned int c = 0; c < 3; ++c) matrix(j, place[c]) = turned[c];
    }
  }
}

Unknowns LayerSpace::free_unknowns(Parity parity) const {
  Unknowns result;
  result.of_dof.assign(dofs.n_dofs(), -1);
  for (global_dof_index i = 0; i < dofs.n_dofs(); ++i) {
    const bool fixed_x = (on_plane[i] & 1) && (component[i] == 0) != parity.odd_x;
    const bool fixed_y = (on_plane[i] & 2) && (component[i] == 1) != parity.odd_y;
    if (!fixed_x && !fixed_y && !constraints.is_constrained(i)) result.of_dof[i] = result.count++;
  }
  return result;
}

SparseSymmetricMatrix LayerSpace::lower_triangle(const dealii::SparsityPattern& pattern,
                                                 const Unknowns& free) const {
  SparseSymmetricMatrix lower;
  lower.size = free.count;
  lower.column_begin.reserve(static_cast<std::size_t>(free.count) + 1);
  lower.column_begin.push_back(0);
  lower.row.reserve(pattern.n_nonzero_elements() / 2 + static_cast<std::size_t>(free.count));
  for (global_dof_index i = 0; i < dofs.n_dofs(); ++i) {
    if (free.of_dof[i] < 0) continue;
    // Row i of a symmetric matrix is its column i; deal.II puts the diagonal first, then ascends.
    for (auto entry = pattern.begin(i); entry != pattern.end(i); ++entry)
      if (const int row = free.of_dof[entry->column()]; row >= free.of_dof[i])
        lower.row.push_back(row);
    lower.column_begin.push_back(static_cast<int>(lower.row.size()));
  }
  lower.value.resize(lower.row.size());
  return lower;
}

void LayerSpace::copy_entries(const dealii::SparseMatrix<double>& stiffness, const Unknowns& free,
                              SparseSymmetricMatrix& lower) const {
  auto value = lower.value.begin();
  for (global_dof_index i = 0; i < dofs.n_dofs(); ++i) {
    if (free.of_dof[i] < 0) continue;
    for (auto entry = stiffness.begin(i); entry != stiffness.end(i); ++entry)
      if (free.of_dof[entry->column()] >= free.of_dof[i]) *value++ = entry->value();
  }
}

/// The node of each free unknown. Nodes that have one are numbered by their first.
std::vector<int> LayerSpace::nodes_of(const Unknowns& free) const {
  std::vector<int> number(dofs.n_dofs(), -1), result;
  int count = 0;
  for (global_dof_index i = 0; i < dofs.n_dofs(); ++i) {
    if (free.of_dof[i] < 0) continue;
    int& node = number[node_of[i]];
    if (node < 0) node = count++;
    result.push_back(node);
  }
  return result;
}

void LayerSpace::dissect(const SparseSymmetricMatrix& matrix, const Unknowns& free) {
  const std::vector<int> node = nodes_of(free);
  const std::vector<int> order = nested_dissection(quotient_graph(matrix, node));
  std::vector<int> rank(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    rank[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  // Nodes that this parity fixes come last: they are fixed in most others too.
  std::vector<int> node_rank(dofs.n_dofs(), static_cast<int>(order.size()));
  for (global_dof_index i = 0; i < dofs.n_dofs(); ++i)
    if (free.of_dof[i] >= 0)
      node_rank[node_of[i]] =
          rank[static_cast<std::size_t>(node[static_cast<std::size_t>(free.of_dof[i])])];
  dissection.resize(dofs.n_dofs());
  std::iota(dissection.begin(), dissection.end(), 0);
  std::stable_sort(dissection.begin(), dissection.end(), [&](int left, int right) {
    return node_rank[node_of[static_cast<std::size_t>(left)]] <
           node_rank[node_of[static_cast<std::size_t>(right)]];
  });
}

std::vector<int> LayerSpace::dissection_of(const Unknowns& free) const {
  std::vector<int> ordering;
  ordering.reserve(static_cast<std::size_t>(free.count));
  for (const int dof : dissection)
    if (const int unknown = free.of_dof[static_cast<std::size_t>(dof)]; unknown >= 0)
      ordering.push_back(unknown);
  return ordering;
}

}  // namespace softfinger::fem
