#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "fem/algebra/cholesky.h"
#include "fem/layer/layer_space.h"

namespace softfinger::fem::finite {

/// Adds matrices of elements up to that of the free unknowns, of surface nodes along their frames.
/// Where each entry goes is known from the first time on: general assembly looks it up in each row
/// and copies the free rows out of a matrix of all of them. Internal to `fem`, as LayerSpace is.
class TangentAssembly {
 public:
  using Dof = LayerSpace::Dof;

  /// @param space          outlives this
  /// @param dofs_of_cells  outlives this
  TangentAssembly(const LayerSpace& space, const std::vector<std::vector<Dof>>& dofs_of_cells,
                  Unknowns unknowns);

  const Unknowns& unknowns() const { return unknowns_; }
  /// The sum of the elements' tangents since `start`. The caller may change it.
  SparseSymmetricMatrix& matrix() { return matrix_; }

  /// Begins anew. @param axes  frames of the surface nodes
  void start(std::vector<Eigen::Matrix3d> axes);
  /// @param of_element  symmetric, by the cell's dofs; of surface nodes along the axes of space
  void add(std::size_t cell, Eigen::MatrixXd of_element);
  /// @param of_node  symmetric, by the components along the frame
  void add(const std::array<Dof, 3>& node, const Eigen::Matrix3d& of_node);

 private:
  struct Cell {
    std::vector<int> unknowns;  ///< that it has a share in, ascending
    std::vector<int> from;      ///< its own dof of each; of a cell that hangs empty
    std::vector<int> entries;   ///< in the matrix: of each column those from the diagonal on
    std::vector<std::pair<int, std::array<int, 3>>> frames;  ///< surface node, its own dofs
  };

  bool hangs(const std::vector<Dof>& dofs) const;
  /// Calls with each dof that this one is interpolated from, without regard to frames; with itself
  /// where it does not hang.
  template <class Visit>
  void for_each_master(Dof dof, const Visit& visit) const;
  void find_unknowns(const std::vector<Dof>& dofs, Cell& cell) const;
  void find_pattern();
  void find_entries(Cell& cell) const;
  void turn_to_frames(const Cell& cell, Eigen::MatrixXd& of_element) const;
  Eigen::MatrixXd interpolation(std::size_t number) const;

  const LayerSpace& space_;
  const std::vector<std::vector<Dof>>& dofs_of_cells_;
  const Unknowns unknowns_;
  std::vector<Cell> cells_;
  std::vector<Eigen::Matrix3d> axes_;
  SparseSymmetricMatrix matrix_;
};

}  // namespace softfinger::fem::finite
