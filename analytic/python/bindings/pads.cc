#include <limits>

#include "analytic/python/bindings/contacts.h"
#include "softfinger/pads/pad_error.h"

namespace softfinger::python {
namespace {

PadShape polygon(const Numbers& points_m) {
  const double* point = rows(points_m, 2);
  std::vector<Eigen::Vector2d> vertices_m;
  for (py::ssize_t i = 0; i < points_m.shape(0); ++i)
    vertices_m.emplace_back(point[2 * i], point[2 * i + 1]);
  return PadShape(ConvexOutline::polygon(std::move(vertices_m)));
}

Numbers vertices_m(const PadShape& shape) {
  const auto& vertices = shape.outline().vertices_m();
  Numbers result({py::ssize_t(vertices.size()), py::ssize_t(2)});
  double* out = result.mutable_data();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    out[2 * i] = vertices[i].x();
    out[2 * i + 1] = vertices[i].y();
  }
  return result;
}

/// The fields of PadPrediction by their names, one row each, and `torque_bound`: infinite where it
/// is not known.
py::dict predict_pads(const PadShape& shape, const std::string& name, bool is_stuck,
                      const Numbers& normal_force_N, const Numbers& youngs_modulus_Pa,
                      const Numbers& poisson_ratio, const Numbers& thickness_m) {
  const PadModel* const model = find_pad_model(name);
  if (!model) throw py::key_error(name);
  const auto count = std::size_t(normal_force_N.shape(0));
  const PadPressing pressing = is_stuck ? PadPressing::stuck : PadPressing::frictionless;
  std::vector<PadPrediction> answers(count);
  std::vector<double> bounds(count, std::numeric_limits<double>::infinity());
  const PadBatch batch{count, normal_force_N.data(), youngs_modulus_Pa.data(), poisson_ratio.data(),
                       thickness_m.data()};
  {
    const py::gil_scoped_release others_may_run;
    model->predict_batch(shape, pressing, batch, answers.data());
    for (std::size_t i = 0; i < count; ++i) {
      PadProblem problem;
      problem.shape = &shape;
      problem.pressing = pressing;
      problem.load = {batch.normal_force_N[i], 1};
      problem.layer = {batch.thickness_m[i], batch.youngs_modulus_Pa[i], batch.poisson_ratio[i]};
      if (const auto bound = pad_error_bound(*model, problem)) bounds[i] = bound->max_torque;
    }
  }
  py::dict result;
  const auto row = [&](const char* field, const auto& value_of) {
    Numbers values{py::ssize_t(count)};
    double* out = values.mutable_data();
    for (std::size_t i = 0; i < count; ++i) out[i] = value_of(answers[i]);
    result[field] = values;
  };
  py::array_t<bool> has_answer{py::ssize_t(count)};
  bool* known = has_answer.mutable_data();
  for (std::size_t i = 0; i < count; ++i) known[i] = answers[i].has_answer;
  result["has_answer"] = has_answer;
  row("indentation_m", [](const PadPrediction& p) { return p.indentation_m; });
  row("normal_stiffness_N_per_m",
      [](const PadPrediction& p) { return p.normal_stiffness_N_per_m; });
  row("peak_pressure_Pa", [](const PadPrediction& p) { return p.peak_pressure_Pa; });
  row("pressure_arm_m", [](const PadPrediction& p) { return p.pressure_arm_m; });
  row("eccentricity_m", [](const PadPrediction& p) { return p.eccentricity_m; });
  row("tilt_stiffness_x_Nm_per_rad",
      [](const PadPrediction& p) { return p.tilt_stiffness_Nm_per_rad[0]; });
  row("tilt_stiffness_y_Nm_per_rad",
      [](const PadPrediction& p) { return p.tilt_stiffness_Nm_per_rad[1]; });
  row("tilt_limit_x_Nm", [](const PadPrediction& p) { return p.tilt_limit_Nm[0]; });
  row("tilt_limit_y_Nm", [](const PadPrediction& p) { return p.tilt_limit_Nm[1]; });
  row("torsional_stiffness_Nm_per_rad",
      [](const PadPrediction& p) { return p.torsional_stiffness_Nm_per_rad; });
  row("tangential_stiffness_x_N_per_m",
      [](const PadPrediction& p) { return p.tangential_stiffness_N_per_m[0]; });
  row("tangential_stiffness_y_N_per_m",
      [](const PadPrediction& p) { return p.tangential_stiffness_N_per_m[1]; });
  Numbers torque_bounds{py::ssize_t(count)};
  std::copy(bounds.begin(), bounds.end(), torque_bounds.mutable_data());
  result["torque_bound"] = torque_bounds;
  return result;
}

/// The torque's bound of nu = 0 and of all other nu, where it is known: it depends on the outline
/// alone. Asked of a thin layer that is hardly pressed.
std::array<double, 2> torque_bounds(const PadShape& shape) {
  const auto bound = [&](double poisson_ratio) {
    PadProblem problem;
    problem.shape = &shape;
    problem.layer = {shape.size_m() / 2, 1 / shape.outline().area_m2(), poisson_ratio};
    problem.load = {1e-6, 1};
    return pad_error_bound(*find_pad_model("pad_layer"), problem).value().max_torque;
  };
  return {bound(0), bound(0.3)};
}

}  // namespace

void bind_pads(py::module_& module) {
  py::class_<PadShape>(module, "PadShape")
      .def_static(
          "rectangle",
          [](double length_m, double width_m, double corner_radius_m) {
            return PadShape(ConvexOutline::rounded_rectangle(length_m, width_m, corner_radius_m));
          })
      .def_static("disc",
                  [](double diameter_m) { return PadShape(ConvexOutline::disc(diameter_m)); })
      .def_static("polygon", &polygon)
      .def_property_readonly("area_m2",
                             [](const PadShape& shape) { return shape.outline().area_m2(); })
      .def_property_readonly("vertices_m", &vertices_m)
      .def_property_readonly("size_m", &PadShape::size_m)
      .def_property_readonly("torque_bounds", &torque_bounds)
      .def("predict", &predict_pads);
}

}  // namespace softfinger::python
