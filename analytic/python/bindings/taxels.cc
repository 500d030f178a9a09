#include "analytic/python/bindings/contacts.h"
#include "softfinger/pressure/rubbed_prediction.h"
#include "softfinger/taxels/taxel_array.h"

namespace softfinger::python {
namespace {

/// A row per row of taxels.
Numbers table(const Eigen::ArrayXXd& values) {
  Numbers result({py::ssize_t(values.rows()), py::ssize_t(values.cols())});
  Eigen::Map<Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      result.mutable_data(), values.rows(), values.cols()) = values;
  return result;
}

/// Readings of one contact; none where the model has no answer.
std::optional<py::dict> taxels(const std::string& name, const py::dict& numbers, int columns,
                               int rows, std::optional<double> pitch_m, double depth_m) {
  const PressureModel& model = model_named(name);
  const Contacts contacts(numbers);
  const ContactProblem problem = contacts.problem(0);
  // A solved pressure is known without friction alone.
  const bool may_be_rubbed = model.card().hot_path;
  taxels::ModelReadings read;
  Prediction prediction;
  {
    const py::gil_scoped_release others_may_run;
    prediction = model.predict(problem);
    if (may_be_rubbed)
      prediction =
          as_pressed(model, prediction, problem, contacts.pressing_friction_coefficient(0));
    if (prediction.has_answer)
      read = taxels::read_taxels(model, problem, prediction, columns, rows, pitch_m, depth_m);
  }
  if (!prediction.has_answer) return std::nullopt;
  const taxels::TaxelReadings& readings = read.readings;
  const taxels::TaxelGrid& grid = readings.grid;
  const double area_m2 = grid.pitch_m * grid.pitch_m;
  const taxels::ArrayMoments seen = moments_of(readings);
  Numbers x_m(columns), y_m(rows);
  for (int i = 0; i < columns; ++i) x_m.mutable_at(i) = grid.x_m(i);
  for (int i = 0; i < rows; ++i) y_m.mutable_at(i) = grid.y_m(i);
  py::dict result;
  result["x_m"] = x_m;
  result["y_m"] = y_m;
  result["pitch_m"] = grid.pitch_m;
  result["depth_m"] = readings.depth_m;
  result["force_N"] = table(readings.force_N);
  result["pressure_Pa"] = table(readings.pressure_Pa());
  result["shear_x_Pa"] = table(readings.shear_x_N / area_m2);
  result["shear_y_Pa"] = table(readings.shear_y_N / area_m2);
  result["displacement_m"] = table(readings.displacement_m);
  result["load_N"] = problem.load.normal_force_N;
  result["outside_N"] = readings.outside_N();
  result["shown_a_m"] = prediction.a_m * seen.spread_x_m / read.forces.spread_x_m;
  result["shown_b_m"] = prediction.b_m * seen.spread_y_m / read.forces.spread_y_m;
  result["shown_torque_arm_m"] = seen.arm_m;
  return result;
}

}  // namespace

void bind_taxels(py::module_& module) { module.def("taxels", &taxels); }

}  // namespace softfinger::python
