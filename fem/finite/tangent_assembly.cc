#include "fem/finite/tangent_assembly.h"

#include <algorithm>
#include <map>

namespace softfinger::fem::finite {

using Eigen::Index;

TangentAssembly::TangentAssembly(const LayerSpace& space,
                                 const std::vector<std::vector<Dof>>& dofs_of_cells,
                                 Unknowns unknowns)
    : space_(space),
      dofs_of_cells_(dofs_of_cells),
      unknowns_(std::move(unknowns)),
      cells_(dofs_of_cells.size()) {
  for (std::size_t i = 0; i < cells_.size(); ++i) find_unknowns(dofs_of_cells_[i], cells_[i]);
  find_pattern();
  for (Cell& cell : cells_) find_entries(cell);
}

bool TangentAssembly::hangs(const std::vector<Dof>& dofs) const {
  return std::any_of(dofs.begin(), dofs.end(), [&](Dof dof) {
    const auto* masters = space_.constraints.get_constraint_entries(dof);
    return masters && !masters->empty();
  });
}

template <class Visit>
void TangentAssembly::for_each_master(Dof dof, const Visit& visit) const {
  if (const auto* masters = space_.constraints.get_constraint_entries(dof))
    for (const auto& [master, share] : *masters) visit(master, share);
  else
    visit(dof, 1.0);
}

void TangentAssembly::find_unknowns(const std::vector<Dof>& dofs, Cell& cell) const {
  std::map<int, std::array<int, 3>> frames;
  std::vector<std::pair<int, int>> found;
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    const auto own = static_cast<int>(i);
    if (const int node = space_.surface_node[dofs[i]]; node >= 0)
      frames[node][static_cast<std::size_t>(space_.component[dofs[i]])] = own;
    for_each_master(dofs[i], [&](Dof master, double) {
      const int node = space_.surface_node[master];
      if (master == dofs[i] || node < 0) {
        found.emplace_back(unknowns_.of_dof[master], own);
        return;
      }
      // A component of what hangs depends on all of a node's along its frame.
      for (const Dof dof : space_.node_dofs[static_cast<std::size_t>(node)])
        found.emplace_back(unknowns_.of_dof[dof], own);
    });
  }
  cell.frames.assign(frames.begin(), frames.end());
  std::sort(found.begin(), found.end());
  const bool is_plain = !hangs(dofs);
  for (const auto& [unknown, own] : found) {
    if (unknown < 0 || (!cell.unknowns.empty() && unknown == cell.unknowns.back())) continue;
    cell.unknowns.push_back(unknown);
    if (is_plain) cell.from.push_back(own);
  }
}

void TangentAssembly::find_pattern() {
  std::vector<std::vector<int>> cells_of(static_cast<std::size_t>(unknowns_.count));
  for (std::size_t i = 0; i < cells_.size(); ++i)
    for (const int unknown : cells_[i].unknowns)
      cells_of[static_cast<std::size_t>(unknown)].push_back(static_cast<int>(i));
  matrix_.size = unknowns_.count;
  matrix_.column_begin.push_back(0);
  std::vector<int> last_seen_by(cells_of.size(), -1);
  for (int column = 0; column < matrix_.size; ++column) {
    for (const int cell : cells_of[static_cast<std::size_t>(column)])
      for (const int row : cells_[static_cast<std::size_t>(cell)].unknowns) {
        int& seen_by = last_seen_by[static_cast<std::size_t>(row)];
        if (row < column || seen_by == column) continue;
        seen_by = column;
        matrix_.row.push_back(row);
      }
    std::sort(matrix_.row.begin() + matrix_.column_begin.back(), matrix_.row.end());
    matrix_.column_begin.push_back(static_cast<int>(matrix_.row.size()));
  }
  matrix_.row.shrink_to_fit();
  matrix_.value.resize(matrix_.row.size());
}

void TangentAssembly::find_entries(Cell& cell) const {
  for (std::size_t column = 0; column < cell.unknowns.size(); ++column) {
    auto at = static_cast<std::size_t>(
        matrix_.column_begin[static_cast<std::size_t>(cell.unknowns[column])]);
    for (std::size_t row = column; row < cell.unknowns.size(); ++row) {
      while (matrix_.row[at] != cell.unknowns[row]) ++at;
      cell.entries.push_back(static_cast<int>(at));
    }
  }
}

void TangentAssembly::start(std::vector<Eigen::Matrix3d> axes) {
  axes_ = std::move(axes);
  std::fill(matrix_.value.begin(), matrix_.value.end(), 0.0);
}

void TangentAssembly::turn_to_frames(const Cell& cell, Eigen::MatrixXd& of_element) const {
  for (const auto& [node, own] : cell.frames) {
    const Eigen::Matrix3d& axes = axes_[static_cast<std::size_t>(node)];
    of_element(own, Eigen::all) = (axes.transpose() * of_element(own, Eigen::all)).eval();
    of_element(Eigen::all, own) = (of_element(Eigen::all, own) * axes).eval();
  }
}

/// The cell's dofs by the unknowns that it has a share in, surface nodes along their frames.
Eigen::MatrixXd TangentAssembly::interpolation(std::size_t number) const {
  const std::vector<Dof>& dofs = dofs_of_cells_[number];
  const std::vector<int>& unknowns = cells_[number].unknowns;
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Zero(static_cast<Index>(dofs.size()), static_cast<Index>(unknowns.size()));
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    const auto add = [&](Dof dof, double share) {
      const int unknown = unknowns_.of_dof[dof];
      if (unknown < 0) return;
      const auto place = std::lower_bound(unknowns.begin(), unknowns.end(), unknown);
      result(static_cast<Index>(i), place - unknowns.begin()) += share;
    };
    for_each_master(dofs[i], [&](Dof master, double share) {
      const int node = space_.surface_node[master];
      if (master == dofs[i] || node < 0) {
        add(master, share);
        return;
      }
      for (std::size_t c = 0; c < 3; ++c)
        add(space_.node_dofs[static_cast<std::size_t>(node)][c],
            share * axes_[static_cast<std::size_t>(node)](space_.component[dofs[i]],
                                                          static_cast<Index>(c)));
    });
  }
  return result;
}

void TangentAssembly::add(std::size_t number, Eigen::MatrixXd of_element) {
  const Cell& cell = cells_[number];
  turn_to_frames(cell, of_element);
  const int* entry = cell.entries.data();
  double* value = matrix_.value.data();
  if (cell.from.size() == cell.unknowns.size()) {
    for (auto column = cell.from.begin(); column != cell.from.end(); ++column) {
      const double* of_column = &of_element(0, *column);
      for (auto row = column; row != cell.from.end(); ++row) value[*entry++] += of_column[*row];
    }
    return;
  }
  const Eigen::MatrixXd shares = interpolation(number);
  const Eigen::MatrixXd of_unknowns = shares.transpose() * (of_element * shares);
  for (Index column = 0; column < of_unknowns.cols(); ++column)
    for (Index row = column; row < of_unknowns.rows(); ++row)
      value[*entry++] += of_unknowns(row, column);
}

void TangentAssembly::add(const std::array<Dof, 3>& node, const Eigen::Matrix3d& of_node) {
  for (Index c = 0; c < 3; ++c)
    for (Index d = 0; d < 3; ++d) {
      const int row = unknowns_.of_dof[node[static_cast<std::size_t>(c)]],
                column = unknowns_.of_dof[node[static_cast<std::size_t>(d)]];
      if (column < 0 || row < column) continue;
      const auto begin = matrix_.row.begin(),
                 first = begin + matrix_.column_begin[static_cast<std::size_t>(column)],
                 last = begin + matrix_.column_begin[static_cast<std::size_t>(column) + 1];
      matrix_.value[static_cast<std::size_t>(std::lower_bound(first, last, row) - begin)] +=
          of_node(c, d);
    }
}

}  // namespace softfinger::fem::finite
