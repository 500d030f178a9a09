#pragma once

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <vector>

#include "softfinger/accuracy/default_model.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/pressure_model.h"

/// Conversions that several bindings share. The Python package checks ranges and broadcasts shapes
/// before it calls the bindings: all arrays here are one-dimensional, contiguous and of equal
/// length.
namespace softfinger::python {

namespace py = pybind11;

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// An array of `count` vectors with `width` numbers each.
inline const double* rows(const Numbers& array, py::ssize_t width) {
  if (array.ndim() != 2 || array.shape(1) != width)
    throw py::value_error("expected an array of shape (n, " + std::to_string(width) + ")");
  return array.data();
}

/// Contacts by the names of their numbers, as softfinger/_contacts.py makes them. Keeps the arrays
/// alive; may be read without the interpreter's lock.
class Contacts {
 public:
  explicit Contacts(const py::dict& numbers) : numbers_(numbers) {
    batch_.normal_force_N = column("normal_force_N");
    batch_.count = std::size_t(columns_.back().size());
    batch_.youngs_modulus_Pa = column("youngs_modulus_Pa");
    batch_.poisson_ratio = column("poisson_ratio");
    batch_.thickness_m = column("thickness_m");
    batch_.radius_major_m = column("radius_major_m");
    batch_.radius_minor_m = column("radius_minor_m");
    batch_.finger_xx_per_m = column("finger_xx_per_m");
    batch_.finger_yy_per_m = column("finger_yy_per_m");
    batch_.finger_xy_per_m = column("finger_xy_per_m");
    batch_.are_objects_spherical = py::cast<bool>(numbers["is_object_spherical"]);
    batch_.pressing_friction_coefficient = column("pressing_friction_coefficient");
    friction_coefficient_ = column("friction_coefficient");
    object_thickness_m_ = column("object_thickness_m");
    object_youngs_modulus_Pa_ = column("object_youngs_modulus_Pa");
    object_poisson_ratio_ = column("object_poisson_ratio");
    if (py::cast<std::string>(numbers["winkler_modulus"]) == "youngs")
      batch_.options.winkler_modulus = WinklerModulus::youngs;
    batch_.options.power_law = {py::cast<double>(numbers["power_law_coefficient"]),
                                py::cast<double>(numbers["power_law_exponent"]),
                                py::cast<double>(numbers["power_law_pressure_exponent"])};
  }

  std::size_t count() const { return batch_.count; }
  /// The contacts without the object's layers, and with friction while pressing alone.
  const ContactBatch& batch() const { return batch_; }
  bool have_object_layers() const {
    for (std::size_t i = 0; i < count(); ++i)
      if (object_thickness_m_[i] != 0) return true;
    return false;
  }
  /// The coefficient that acts while this contact is pressed.
  double pressing_friction_coefficient(std::size_t index) const {
    return batch_.pressing_friction_coefficient[index];
  }
  ContactProblem problem(std::size_t index) const {
    ContactProblem problem = batch_.problem(index);
    problem.load.friction_coefficient = friction_coefficient_[index];
    problem.object_layer = {object_thickness_m_[index], object_youngs_modulus_Pa_[index],
                            object_poisson_ratio_[index]};
    return problem;
  }

 private:
  const double* column(const char* name) {
    columns_.push_back(py::cast<Numbers>(numbers_[name]));
    return columns_.back().data();
  }

  py::dict numbers_;
  std::vector<Numbers> columns_;
  ContactBatch batch_;
  const double *friction_coefficient_, *object_thickness_m_, *object_youngs_modulus_Pa_,
      *object_poisson_ratio_;
};

/// The model with that name; the package in Python has looked it up before.
inline const PressureModel& model_named(const std::string& name) {
  const PressureModel* model = find_pressure_model(name);
  if (!model) throw py::key_error(name);
  return *model;
}

/// The model with that name for all contacts, or, without a name, the recommended one for each.
class AskedModel {
 public:
  explicit AskedModel(const std::optional<std::string>& name)
      : named_(name ? &model_named(*name) : nullptr) {}

  const PressureModel& of(const ContactProblem& problem) const {
    return named_ ? *named_ : default_model(problem);
  }
  /// Null: each contact has its own.
  const PressureModel* common() const { return named_; }

 private:
  const PressureModel* named_;
};

}  // namespace softfinger::python
