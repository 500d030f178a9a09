#include "fem/output/write_fields.h"

#include <deal.II/numerics/data_out.h>
#include <deal.II/numerics/data_postprocessor.h>

#include <vector>

#include "fem/base/write_file.h"

namespace softfinger::fem {
namespace {

/// The contact's pressure as a field of its own: the third component of the field that is given.
class ContactPressure : public dealii::DataPostprocessorScalar<dim> {
 public:
  ContactPressure() : DataPostprocessorScalar("contact_pressure_Pa", dealii::update_values) {}
  void evaluate_vector_field(const dealii::DataPostprocessorInputs::Vector<dim>& inputs,
                             std::vector<dealii::Vector<double>>& pressure) const override {
    for (unsigned int p = 0; p < pressure.size(); ++p)
      pressure[p][0] = inputs.solution_values[p][2];
  }
};

}  // namespace

void write_fields(const std::string& path, const LayerFields& fields) {
  const LayerSpace& space = fields.space;
  const ContactPressure contact_pressure;
  dealii::DataOut<dim> output;
  const std::vector<dealii::DataComponentInterpretation::DataComponentInterpretation> vector(
      dim, dealii::DataComponentInterpretation::component_is_part_of_vector);
  output.add_data_vector(space.dofs, fields.displacement_m,
                         std::vector<std::string>(dim, "displacement_m"), vector);
  if (fields.of_displacement)
    output.add_data_vector(space.dofs, fields.displacement_m, *fields.of_displacement);
  output.add_data_vector(space.dofs, fields.contact_pressure_Pa, contact_pressure);
  output.attach_triangulation(space.triangulation);
  if (!fields.name_of_cells.empty())
    output.add_data_vector(fields.of_cells, fields.name_of_cells,
                           dealii::DataOut<dim>::type_cell_data);
  // Two subdivisions: the quadratic element's own nodes.
  output.build_patches(*space.mapping, 2, dealii::DataOut<dim>::curved_inner_cells);
  write_file(path, "VTU file", [&](std::ostream& file) { output.write_vtu(file); });
}

}  // namespace softfinger::fem
