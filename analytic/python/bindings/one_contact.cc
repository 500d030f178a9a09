#include <algorithm>
#include <array>

#include "analytic/python/bindings/contacts.h"

/// The call that a control loop makes: one contact, plain numbers. Turning each number into an
/// array, as arrays of contacts need it, would take a hundred times what the model takes.
namespace softfinger::python {
namespace {

constexpr std::array kNames{
    "normal_force_N",      "youngs_modulus_Pa", "poisson_ratio",        "thickness_m",
    "radius_major_m",      "radius_minor_m",    "friction_coefficient", "finger_xx_per_m",
    "finger_yy_per_m",     "finger_xy_per_m",   "object_thickness_m",   "object_youngs_modulus_Pa",
    "object_poisson_ratio"};

py::str interned(const char* text) {
  return py::reinterpret_steal<py::str>(PyUnicode_InternFromString(text));
}

/// Takes what is plain and usual and has an answer. For everything else it gives None, and leaves
/// refusals, warnings and arrays to softfinger/_contacts.py.
class OneContact {
 public:
  /// @param numbers  by name: the usual range, and whether the number has to be given (else it is
  /// 0)
  explicit OneContact(const py::dict& numbers) {
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      const py::tuple told = numbers[kNames[i]];
      numbers_[i] = {interned(kNames[i]), told[0].cast<double>(), told[1].cast<double>(),
                     told[2].cast<bool>()};
    }
  }

  /// The arrays of a call with this contact alone; other arguments are not looked at.
  std::optional<py::dict> numbers(const py::dict& arguments) const {
    Values values;
    Py_ssize_t known = 0;
    if (!read(arguments, values, known)) return std::nullopt;
    py::dict arrays;
    for (std::size_t i = 0; i < values.size(); ++i)
      arrays[numbers_[i].name] = Numbers(1, &values[i]);
    return arrays;
  }

  /// The fields of softfinger.Prediction, under Coulomb's law.
  py::object predict(const py::dict& arguments) const {
    Values values;
    Py_ssize_t known = 0;
    if (!read(arguments, values, known)) return py::none();
    const auto& [load_N, youngs_Pa, poisson, thickness_m, major_m, minor_m, friction, xx_per_m,
                 yy_per_m, xy_per_m, object_m, object_Pa, object_poisson] = values;
    ContactProblem problem;
    problem.radii = {major_m, minor_m, 0};
    problem.layer = {thickness_m, youngs_Pa, poisson};
    problem.load = {load_N, friction};
    problem.object_layer = {object_m, object_Pa, object_poisson};
    problem.finger_curvature = {xx_per_m, yy_per_m, xy_per_m};
    const PressureModel* model = asked(arguments, problem, known);
    // What is slow lets other threads run meanwhile, and an argument that is not known here has
    // its meaning elsewhere.
    if (!model || !model->card().hot_path || known != PyDict_GET_SIZE(arguments.ptr()))
      return py::none();
    const Prediction prediction = model->predict(problem);
    if (!prediction.has_answer) return py::none();
    const double force_N = friction * load_N;
    py::dict fields;
    const auto set = [&](const py::str& name, double value) { fields[name] = py::float_(value); };
    fields[model_] = py::str(model->card().name);
    fields[has_answer_] = py::bool_(true);
    set(a_m_, prediction.a_m);
    set(b_m_, prediction.b_m);
    set(indentation_m_, prediction.indentation_m);
    set(area_m2_, prediction.area_m2());
    set(peak_pressure_Pa_, prediction.peak_pressure_Pa);
    set(torque_arm_exact_m_, prediction.torque_arm_exact_m);
    set(torque_arm_paper_m_, prediction.torque_arm_paper_m);
    set(max_force_N_, force_N);
    set(max_torque_Nm_, force_N * prediction.torque_arm_exact_m);
    set(eccentricity_m_, prediction.torque_arm_exact_m);
    set(numbers_[0].name, load_N);
    fields[shear_law_] = coulomb_;
    set(numbers_[6].name, friction);
    set(shear_strength_Pa_, 0);
    return std::move(fields);
  }

 private:
  using Values = std::array<double, kNames.size()>;
  struct Number {
    py::str name;
    double low = 0, high = 0;
    bool is_required = true;
  };

  /// False where the argument is missing, unusual or no plain number.
  static bool read(const py::dict& arguments, const Number& number, double& value,
                   Py_ssize_t& known) {
    PyObject* given = PyDict_GetItemWithError(arguments.ptr(), number.name.ptr());
    value = 0;
    if (!given) return !number.is_required;
    ++known;
    if (PyFloat_Check(given)) {
      value = PyFloat_AS_DOUBLE(given);
    } else if (PyLong_CheckExact(given)) {
      value = PyLong_AsDouble(given);
      if (PyErr_Occurred()) {
        PyErr_Clear();
        return false;
      }
    } else {
      return false;
    }
    return (value >= number.low && value <= number.high) || (value == 0 && !number.is_required);
  }

  bool read(const py::dict& arguments, Values& values, Py_ssize_t& known) const {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!read(arguments, numbers_[i], values[i], known)) return false;
    const double major_m = values[4], minor_m = values[5], object_m = values[10],
                 object_Pa = values[11];
    return minor_m <= major_m && (object_m == 0 || object_Pa > 0);
  }

  /// The model asked for; null for an unknown one, and under another law than Coulomb's.
  const PressureModel* asked(const py::dict& arguments, const ContactProblem& problem,
                             Py_ssize_t& known) const {
    if (PyObject* law = PyDict_GetItemWithError(arguments.ptr(), shear_law_.ptr())) {
      ++known;
      if (!PyUnicode_Check(law) || PyUnicode_Compare(law, coulomb_.ptr()) != 0) return nullptr;
    }
    PyObject* name = PyDict_GetItemWithError(arguments.ptr(), model_.ptr());
    if (name) ++known;
    if (!name || name == Py_None) return &default_model(problem);
    if (!PyUnicode_Check(name)) return nullptr;
    Py_ssize_t length = 0;
    const char* text = PyUnicode_AsUTF8AndSize(name, &length);
    if (!text) PyErr_Clear();
    return text ? find_pressure_model({text, std::size_t(length)}) : nullptr;
  }

  std::array<Number, kNames.size()> numbers_;
  const py::str model_ = interned("model"), has_answer_ = interned("has_answer"),
                a_m_ = interned("a_m"), b_m_ = interned("b_m"),
                indentation_m_ = interned("indentation_m"), area_m2_ = interned("area_m2"),
                peak_pressure_Pa_ = interned("peak_pressure_Pa"),
                torque_arm_exact_m_ = interned("torque_arm_exact_m"),
                torque_arm_paper_m_ = interned("torque_arm_paper_m"),
                max_force_N_ = interned("max_force_N"), max_torque_Nm_ = interned("max_torque_Nm"),
                eccentricity_m_ = interned("eccentricity_m"), shear_law_ = interned("shear_law"),
                shear_strength_Pa_ = interned("shear_strength_Pa"), coulomb_ = interned("coulomb");
};

}  // namespace

void bind_one_contact(py::module_& module) {
  py::class_<OneContact>(module, "OneContact")
      .def(py::init<const py::dict&>())
      .def("numbers", &OneContact::numbers)
      .def("predict", &OneContact::predict);
}

}  // namespace softfinger::python
