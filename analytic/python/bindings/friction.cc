#include "analytic/python/bindings/contacts.h"
#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/pressure/equivalent_exponent.h"

namespace softfinger::python {
namespace {

/// A vector (f_x, f_y, tau) for each row.
template <class Function>
Numbers wrenches(py::ssize_t count, const Function& wrench_of_row) {
  Numbers result({count, py::ssize_t(3)});
  double* out = result.mutable_data();
  const py::gil_scoped_release others_may_run;
  for (py::ssize_t i = 0; i < count; ++i) {
    const LimitWrench wrench = wrench_of_row(i);
    out[3 * i] = wrench.force_x_N;
    out[3 * i + 1] = wrench.force_y_N;
    out[3 * i + 2] = wrench.torque_Nm;
  }
  return result;
}

template <class Function>
Numbers scalars(py::ssize_t count, const Function& value_of_row) {
  Numbers result(count);
  double* out = result.mutable_data();
  const py::gil_scoped_release others_may_run;
  for (py::ssize_t i = 0; i < count; ++i) out[i] = value_of_row(i);
  return result;
}

Numbers listed(const std::vector<LimitWrench>& points) {
  return wrenches(py::ssize_t(points.size()),
                  [&](py::ssize_t i) { return points[std::size_t(i)]; });
}

LimitWrench wrench_at(const double* row) { return {row[0], row[1], row[2]}; }
Twist twist_at(const double* row) { return {row[0], row[1], row[2]}; }

void bind_limit_surface(py::module_& module) {
  py::class_<LimitSurface>(module, "LimitSurface")
      .def(py::init<double, double, double, double>())
      .def_property_readonly("eccentricity_m", &LimitSurface::eccentricity_m)
      .def("wrench_for_twist",
           [](const LimitSurface& surface, const Numbers& twists) {
             const double* twist = rows(twists, 3);
             return wrenches(twists.shape(0), [&](py::ssize_t i) {
               return surface.wrench_for_twist(twist_at(twist + 3 * i));
             });
           })
      .def("wrench_for_center_of_rotation",
           [](const LimitSurface& surface, const Numbers& centers) {
             const double* center = rows(centers, 2);
             return wrenches(centers.shape(0), [&](py::ssize_t i) {
               return surface.wrench_for_center_of_rotation(center[2 * i], center[2 * i + 1]);
             });
           })
      .def("support",
           [](const LimitSurface& surface, const Numbers& twists) {
             const double* twist = rows(twists, 3);
             return scalars(twists.shape(0), [&](py::ssize_t i) {
               return surface.support(twist_at(twist + 3 * i));
             });
           })
      .def("utilisation",
           [](const LimitSurface& surface, const Numbers& loads) {
             const double* load = rows(loads, 3);
             return scalars(loads.shape(0), [&](py::ssize_t i) {
               return surface.utilisation(wrench_at(load + 3 * i));
             });
           })
      .def("project",
           [](const LimitSurface& surface, const Numbers& loads) {
             const double* load = rows(loads, 3);
             return wrenches(loads.shape(0), [&](py::ssize_t i) {
               return surface.project(wrench_at(load + 3 * i));
             });
           })
      .def("sample",
           [](const LimitSurface& surface, int count) { return listed(surface.sample(count)); })
      .def("sample_section", [](const LimitSurface& surface, double direction_rad, int count) {
        return listed(surface.sample_section(direction_rad, count));
      });
}

Numbers ellipsoid_utilisation(const Numbers& max_force_N, const Numbers& eccentricity_m,
                              const Numbers& loads) {
  const double *force = max_force_N.data(), *arm = eccentricity_m.data(), *load = rows(loads, 3);
  return scalars(loads.shape(0), [&](py::ssize_t i) {
    return FrictionEllipsoid{force[i], arm[i]}.utilisation(load[3 * i], load[3 * i + 1],
                                                           load[3 * i + 2]);
  });
}

double exponent(double a_m, double b_m, double torque_arm_m) {
  Prediction prediction;
  prediction.has_answer = true;
  prediction.a_m = a_m;
  prediction.b_m = b_m;
  prediction.torque_arm_exact_m = torque_arm_m;
  return equivalent_exponent(prediction);
}

}  // namespace

void bind_friction(py::module_& module) {
  bind_limit_surface(module);
  module.def("ellipsoid_utilisation", &ellipsoid_utilisation);
  module.def("ellipsoid_section",
             [](double max_force_N, double eccentricity_m, double direction_rad, int count) {
               return listed(sample_section(FrictionEllipsoid{max_force_N, eccentricity_m},
                                            direction_rad, count));
             });
  module.def("equivalent_exponent", &exponent);
}

}  // namespace softfinger::python
