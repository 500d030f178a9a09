#include "analytic/python/bindings/contacts.h"
#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/friction/shear_surface.h"
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

/// Binds the methods that all limit surfaces share.
template <class Surface>
void bind_questions(py::class_<Surface>& type) {
  type.def_property_readonly("eccentricity_m", &Surface::eccentricity_m)
      .def("wrench_for_twist",
           [](const Surface& surface, const Numbers& twists) {
             const double* twist = rows(twists, 3);
             return wrenches(twists.shape(0), [&](py::ssize_t i) {
               return surface.wrench_for_twist(twist_at(twist + 3 * i));
             });
           })
      .def("support",
           [](const Surface& surface, const Numbers& twists) {
             const double* twist = rows(twists, 3);
             return scalars(twists.shape(0), [&](py::ssize_t i) {
               return surface.support(twist_at(twist + 3 * i));
             });
           })
      .def("utilisation",
           [](const Surface& surface, const Numbers& loads) {
             const double* load = rows(loads, 3);
             return scalars(loads.shape(0), [&](py::ssize_t i) {
               return surface.utilisation(wrench_at(load + 3 * i));
             });
           })
      .def("project",
           [](const Surface& surface, const Numbers& loads) {
             const double* load = rows(loads, 3);
             return wrenches(loads.shape(0), [&](py::ssize_t i) {
               return surface.project(wrench_at(load + 3 * i));
             });
           })
      .def("sample",
           [](const Surface& surface, int count) { return listed(surface.sample(count)); })
      .def("sample_section", [](const Surface& surface, double direction_rad, int count) {
        return listed(surface.sample_section(direction_rad, count));
      });
}

ShearLaw shear_law(int kind, double friction_coefficient, double shear_strength_Pa) {
  return {ShearLaw::Kind(kind), friction_coefficient, shear_strength_Pa};
}

void bind_surfaces(py::module_& module) {
  py::class_<LimitSurface> coulomb(module, "LimitSurface");
  coulomb.def(py::init<double, double, double, double>())
      .def("wrench_for_center_of_rotation",
           [](const LimitSurface& surface, const Numbers& centers) {
             const double* center = rows(centers, 2);
             return wrenches(centers.shape(0), [&](py::ssize_t i) {
               return surface.wrench_for_center_of_rotation(center[2 * i], center[2 * i + 1]);
             });
           });
  bind_questions(coulomb);
  py::class_<ShearSurface> any_law(module, "ShearSurface");
  any_law
      .def(py::init([](int kind, double a_m, double b_m, double exponent, double load_N,
                       double friction_coefficient, double shear_strength_Pa) {
        return ShearSurface(shear_law(kind, friction_coefficient, shear_strength_Pa),
                            PressedEllipse{a_m, b_m, exponent, load_N});
      }))
      .def_property_readonly("max_force_N", &ShearSurface::max_force_N);
  bind_questions(any_law);
}

/// Largest forces and, over them, torques of contacts under one law.
py::tuple friction_ellipsoids(int kind, const Numbers& a_m, const Numbers& b_m,
                              const Numbers& exponent, const Numbers& load_N,
                              const Numbers& friction_coefficient,
                              const Numbers& shear_strength_Pa) {
  const py::ssize_t count = a_m.size();
  Numbers force(count), arm(count);
  double *force_N = force.mutable_data(), *arm_m = arm.mutable_data();
  const double *a = a_m.data(), *b = b_m.data(), *n = exponent.data(), *load = load_N.data(),
               *mu = friction_coefficient.data(), *tau = shear_strength_Pa.data();
  {
    const py::gil_scoped_release others_may_run;
    for (py::ssize_t i = 0; i < count; ++i) {
      const FrictionEllipsoid found =
          friction_ellipsoid(shear_law(kind, mu[i], tau[i]), {a[i], b[i], n[i], load[i]});
      force_N[i] = found.max_force_N;
      arm_m[i] = found.eccentricity_m;
    }
  }
  return py::make_tuple(force, arm);
}

Numbers ellipsoid_utilisation(const Numbers& max_force_N, const Numbers& eccentricity_m,
                              const Numbers& loads) {
  const double *force = max_force_N.data(), *arm = eccentricity_m.data(), *load = rows(loads, 3);
  return scalars(loads.shape(0), [&](py::ssize_t i) {
    return FrictionEllipsoid{force[i], arm[i]}.utilisation(load[3 * i], load[3 * i + 1],
                                                           load[3 * i + 2]);
  });
}

/// Equivalent pressure exponents n of the contacts; 1/2 for a contact without an answer (a_m = 0).
Numbers exponents(const Numbers& a_m, const Numbers& b_m, const Numbers& torque_arm_m) {
  const double *a = a_m.data(), *b = b_m.data(), *arm = torque_arm_m.data();
  return scalars(a_m.size(), [&](py::ssize_t i) {
    Prediction prediction;
    prediction.has_answer = a[i] > 0;
    prediction.a_m = a[i];
    prediction.b_m = b[i];
    prediction.torque_arm_exact_m = arm[i];
    return prediction.has_answer ? equivalent_exponent(prediction) : 0.5;
  });
}

}  // namespace

void bind_friction(py::module_& module) {
  bind_surfaces(module);
  module.def("ellipsoid_utilisation", &ellipsoid_utilisation);
  module.def("ellipsoid_section",
             [](double max_force_N, double eccentricity_m, double direction_rad, int count) {
               return listed(sample_section(FrictionEllipsoid{max_force_N, eccentricity_m},
                                            direction_rad, count));
             });
  module.def("friction_ellipsoids", &friction_ellipsoids);
  module.def("equivalent_exponents", &exponents);
}

}  // namespace softfinger::python
