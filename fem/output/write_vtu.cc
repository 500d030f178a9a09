#include "fem/output/write_vtu.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/numerics/data_postprocessor.h>

#include <Eigen/Cholesky>

#include "fem/layer/layer_solution.h"
#include "fem/output/write_fields.h"

namespace softfinger::fem {
namespace {

using Cell = dealii::DoFHandler<dim>::active_cell_iterator;

/// Divergence of the displacement, projected on linear functions per element: the only volumetric
/// strain that the element feels. The pointwise one oscillates as nu -> 1/2.
struct ProjectedDivergence {
  std::vector<Eigen::Vector4d> coefficients;  ///< per active cell, of 1, x, y, z from its centre

  std::vector<dealii::Point<dim>> centers;

  ProjectedDivergence(const dealii::Mapping<dim>& mapping, const dealii::DoFHandler<dim>& dofs,
                      const dealii::Vector<double>& displacement)
      : coefficients(dofs.get_triangulation().n_active_cells()), centers(coefficients.size()) {
    const dealii::QGauss<dim> quadrature(3);
    dealii::FEValues<dim> values(
        mapping, dofs.get_fe(), quadrature,
        dealii::update_gradients | dealii::update_JxW_values | dealii::update_quadrature_points);
    const dealii::FEValuesExtractors::Vector vector(0);
    std::vector<double> divergence(quadrature.size());
    for (const auto& cell : dofs.active_cell_iterators()) {
      values.reinit(cell);
      centers[cell->active_cell_index()] = values.quadrature_point(quadrature.size() / 2);
      values[vector].get_function_divergences(displacement, divergence);
      Eigen::Matrix4d mass = Eigen::Matrix4d::Zero();
      Eigen::Vector4d moment = Eigen::Vector4d::Zero();
      for (unsigned int q = 0; q < quadrature.size(); ++q) {
        const Eigen::Vector4d linear = basis(values.quadrature_point(q), *cell);
        mass += values.JxW(q) * linear * linear.transpose();
        moment += values.JxW(q) * divergence[q] * linear;
      }
      coefficients[cell->active_cell_index()] = mass.llt().solve(moment);
    }
  }

  template <class CellAccessor>
  Eigen::Vector4d basis(const dealii::Point<dim>& point, const CellAccessor& cell) const {
    const auto offset = (point - centers[cell.active_cell_index()]) / cell.diameter();
    return {1, offset[0], offset[1], offset[2]};
  }
};

class Stress : public dealii::DataPostprocessorTensor<dim> {
 public:
  Stress(const ProjectedDivergence& divergence, double youngs_modulus_Pa,
         const std::vector<ElasticConstants>& sublayers)
      : DataPostprocessorTensor("stress_Pa",
                                dealii::update_gradients | dealii::update_quadrature_points),
        divergence_(divergence),
        youngs_modulus_Pa_(youngs_modulus_Pa),
        sublayers_(sublayers) {}

  void evaluate_vector_field(const dealii::DataPostprocessorInputs::Vector<dim>& inputs,
                             std::vector<dealii::Vector<double>>& stress) const override {
    const Cell cell = inputs.get_cell<dim>();
    const auto& coefficients = divergence_.coefficients[cell->active_cell_index()];
    const ElasticConstants& constants = sublayers_[cell->material_id()];
    const double nu = constants.poisson_ratio;
    const double shear_Pa = constants.youngs_ratio * youngs_modulus_Pa_ / 2 / (1 + nu);
    const double lame_Pa = shear_Pa * 2 * nu / (1 - 2 * nu);
    for (unsigned int p = 0; p < stress.size(); ++p) {
      const double volumetric =
          coefficients.dot(divergence_.basis(inputs.evaluation_points[p], *cell));
      const auto& gradient = inputs.solution_gradients[p];
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          stress[p][i * dim + j] =
              shear_Pa * (gradient[i][j] + gradient[j][i]) + (i == j ? lame_Pa * volumetric : 0.0);
    }
  }

 private:
  const ProjectedDivergence& divergence_;
  const double youngs_modulus_Pa_;
  const std::vector<ElasticConstants>& sublayers_;
};

void write_solution(const std::string& path, const LayerSolution& solution) {
  const LayerSpace& space = solution.space;
  const dealii::DoFHandler<dim>& dofs = space.dofs;
  const ProjectedDivergence divergence(*space.mapping, dofs, solution.displacement_m);
  const Stress stress(divergence, solution.youngs_modulus_Pa, solution.sublayers);
  LayerFields fields{space, solution.displacement_m, solution.contact_pressure_Pa, &stress};
  if (solution.sublayers.size() > 1) {
    fields.name_of_cells = "sublayer";
    fields.of_cells.reinit(dofs.get_triangulation().n_active_cells());
    for (const auto& cell : dofs.active_cell_iterators())
      fields.of_cells[cell->active_cell_index()] = cell->material_id();
  }
  write_fields(path, fields);
}

}  // namespace

void write_vtu(const std::string& path, const LayerModel& model, const Eigen::VectorXd& force,
               double thickness_m, double youngs_modulus_Pa) {
  model.with_solution(force, thickness_m, youngs_modulus_Pa,
                      [&](const LayerSolution& solution) { write_solution(path, solution); });
}

}  // namespace softfinger::fem
