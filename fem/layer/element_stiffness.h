#pragma once

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/lac/full_matrix.h>

#include <array>
#include <map>

#include "fem/layer/dimension.h"

namespace softfinger::fem {

/// Stiffness of one Q2 element with E = 1: 2 G eps:eps + lambda (P div u)², P the L2 projection on
/// linear functions of position (Q2/P1disc with the pressure condensed). Similar elements have it
/// in proportion to their size: computed once.
class ElementStiffness {
 public:
  /// @param element        three components of FE_Q(2)
  /// @param poisson_ratio  0 <= nu < 1/2
  /// @param bent           whether the layer is curved: no two elements are similar, each is
  ///                       integrated
  ElementStiffness(const dealii::Mapping<dim>& mapping, const dealii::FiniteElement<dim>& element,
                   double poisson_ratio, bool bent);

  /// @throws InputError for an element of no or negative volume
  dealii::FullMatrix<double> operator()(const dealii::DoFHandler<dim>::active_cell_iterator& cell);

 private:
  dealii::FullMatrix<double> integrate(const dealii::DoFHandler<dim>::active_cell_iterator& cell);

  const double shear_, lame_;
  const bool bent_;
  const dealii::QGauss<dim> quadrature_;
  dealii::FEValues<dim> values_;
  std::map<std::array<long, 3 * 7>, dealii::FullMatrix<double>> unit_size_;
};

}  // namespace softfinger::fem
