#include <array>
#include <cmath>
#include <optional>

#include "analytic/python/bindings/contacts.h"
#include "softfinger/accuracy/pressing_error.h"
#include "softfinger/input/pressing_friction.h"
#include "softfinger/pressure/rubbed_prediction.h"

/// The calls that a control loop makes: one contact, plain numbers. Turning each number into an
/// array, as arrays of contacts need it, would take a hundred times what the model takes.
namespace softfinger::python {
namespace {

constexpr std::array kArguments{
    "normal_force_N",      "youngs_modulus_Pa", "poisson_ratio",        "thickness_m",
    "radius_major_m",      "radius_minor_m",    "friction_coefficient", "finger_xx_per_m",
    "finger_yy_per_m",     "finger_xy_per_m",   "object_thickness_m",   "object_youngs_modulus_Pa",
    "object_poisson_ratio"};
/// Attributes of softfinger.Prediction.
constexpr std::array kPredicted{"a_m",
                                "b_m",
                                "indentation_m",
                                "area_m2",
                                "peak_pressure_Pa",
                                "torque_arm_exact_m",
                                "torque_arm_paper_m",
                                "pressure_arm_m",
                                "frictionless_a_m",
                                "frictionless_b_m",
                                "max_force_N",
                                "max_torque_Nm",
                                "eccentricity_m",
                                "normal_force_N",
                                "friction_coefficient",
                                "shear_strength_Pa"};
/// Attributes of softfinger.Errors.
constexpr std::array kQuantities{"a", "b", "indentation", "area", "peak_pressure", "max_torque"};
/// Attributes of softfinger.ErrorBound; the causes are in the order of ErrorCause.
constexpr std::array kErrors{"bound",     "expected", "by_model",
                             "by_strain", "by_slope", "by_curvature"};

py::str interned(const char* text) {
  return py::reinterpret_steal<py::str>(PyUnicode_InternFromString(text));
}

template <std::size_t count>
std::array<py::str, count> interned(const std::array<const char*, count>& texts) {
  std::array<py::str, count> names;
  for (std::size_t i = 0; i < count; ++i) names[i] = interned(texts[i]);
  return names;
}

template <std::size_t count>
void add(const std::array<py::str, count>& names, const std::array<double, count>& values,
         const py::dict& fields) {
  for (std::size_t i = 0; i < count; ++i) fields[names[i]] = py::float_(values[i]);
}

/// Takes what is plain and usual and has an answer. For everything else it gives nothing (None),
/// and leaves refusals, warnings and arrays to softfinger/_contacts.py.
class OneContact {
 public:
  /// @param numbers  by argument: the usual range, and whether it has to be given (else it is 0)
  explicit OneContact(const py::dict& numbers) {
    for (std::size_t i = 0; i < kArguments.size(); ++i) {
      const py::tuple told = numbers[kArguments[i]];
      ranges_[i] = {told[0].cast<double>(), told[1].cast<double>(), told[2].cast<bool>()};
    }
  }

  /// The arrays of a call with this contact alone; other arguments are not looked at.
  std::optional<py::dict> numbers(const py::dict& arguments) const {
    Values values;
    if (!read(arguments, values)) return std::nullopt;
    py::dict arrays;
    for (std::size_t i = 0; i < values.size(); ++i) arrays[arguments_[i]] = Numbers(1, &values[i]);
    return arrays;
  }

  /// The fields of softfinger.Prediction, under Coulomb's law.
  std::optional<py::dict> predict(const py::dict& arguments) const {
    Py_ssize_t known = 0;
    if (PyObject* law = PyDict_GetItemWithError(arguments.ptr(), shear_law_.ptr())) {
      if (!PyUnicode_Check(law) || PyUnicode_Compare(law, coulomb_.ptr()) != 0) return std::nullopt;
      ++known;
    }
    const std::optional<Question> asked = question(arguments, known);
    if (!asked) return std::nullopt;
    const Prediction answer = asked->model->predict(asked->problem);
    if (!answer.has_answer) return std::nullopt;
    const bool is_rubbed =
        asked->pressing_friction_coefficient > 0 && knows_pressing_friction(*asked->model);
    const Prediction pressed = is_rubbed ? rubbed(*asked->model, answer, asked->problem,
                                                  asked->pressing_friction_coefficient)
                                         : answer;
    const ContactLoad& load = asked->problem.load;
    const double force_N = load.friction_coefficient * load.normal_force_N;
    py::dict fields;
    fields[model_] = py::str(asked->model->card().name);
    fields[has_answer_] = py::bool_(true);
    fields[shear_law_] = coulomb_;
    fields[pressing_] =
        pressings_[std::size_t(is_rubbed ? asked->pressing : PressingFriction::none)];
    add(predicted_,
        {pressed.a_m, pressed.b_m, pressed.indentation_m, pressed.area_m2(),
         pressed.peak_pressure_Pa, answer.torque_arm_exact_m, answer.torque_arm_paper_m,
         pressed.torque_arm_exact_m, answer.a_m, answer.b_m, force_N,
         force_N * answer.torque_arm_exact_m, answer.torque_arm_exact_m, load.normal_force_N,
         load.friction_coefficient, 0.},
        fields);
    return fields;
  }

  /// The fields of softfinger.ErrorBound, its errors as dicts, where the bound is known.
  std::optional<py::dict> error_bound(const py::dict& arguments) const {
    const std::optional<Question> asked = question(arguments, 0);
    // No bound is known of a measured law, which softfinger/_accuracy.py says in words.
    if (!asked || asked->model->card().is_empirical) return std::nullopt;
    const ErrorBound found = softfinger::error_bound(*asked->model, asked->problem,
                                                     asked->pressing_friction_coefficient);
    if (!found.known) return std::nullopt;
    py::dict fields;
    fields[model_] = py::str(asked->model->card().name);
    fields[known_] = py::bool_(true);
    fields[outside_] = py::str(found.outside);
    for (std::size_t i = 0; i < kErrors.size(); ++i) {
      py::dict errors;
      add(quantities_,
          i == 0   ? found.bound
          : i == 1 ? found.expected
                   : found.causes[i - 2],
          errors);
      fields[errors_[i]] = errors;
    }
    return fields;
  }

 private:
  using Values = std::array<double, kArguments.size()>;
  struct Range {
    double low = 0, high = 0;
    bool is_required = true;
  };
  struct Question {
    ContactProblem problem;
    const PressureModel* model = nullptr;
    PressingFriction pressing = PressingFriction::none;
    double pressing_friction_coefficient = 0;
  };

  /// A plain number; NaN for anything else.
  static double number(PyObject* given) {
    if (PyFloat_Check(given)) return PyFloat_AS_DOUBLE(given);
    if (!PyLong_CheckExact(given)) return std::nan("");
    const double value = PyLong_AsDouble(given);
    if (!PyErr_Occurred()) return value;
    PyErr_Clear();  // too large for a double
    return std::nan("");
  }

  /// Returns how many of the known arguments were given; nothing if a required one is missing or a
  /// value is outside the usual range.
  std::optional<Py_ssize_t> read(const py::dict& arguments, Values& values) const {
    Py_ssize_t count = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Range& range = ranges_[i];
      PyObject* given = PyDict_GetItemWithError(arguments.ptr(), arguments_[i].ptr());
      count += given ? 1 : 0;
      values[i] = given ? number(given) : 0;
      const bool is_usual = values[i] >= range.low && values[i] <= range.high;
      const bool is_default = !range.is_required && values[i] == 0;
      if (!is_default && !(given && is_usual)) return std::nullopt;
    }
    const double major_m = values[4], minor_m = values[5], object_m = values[10],
                 object_Pa = values[11];
    if (minor_m > major_m || (object_m > 0 && object_Pa == 0)) return std::nullopt;
    return count;
  }

  /// @param known  how many of the arguments the caller has looked at itself
  std::optional<Question> question(const py::dict& arguments, Py_ssize_t known) const {
    Values values;
    const std::optional<Py_ssize_t> count = read(arguments, values);
    if (!count) return std::nullopt;
    const auto& [load_N, youngs_Pa, poisson, thickness_m, major_m, minor_m, friction, xx_per_m,
                 yy_per_m, xy_per_m, object_m, object_Pa, object_poisson] = values;
    Question asked;
    asked.problem.radii = {major_m, minor_m, 0};
    asked.problem.layer = {thickness_m, youngs_Pa, poisson};
    asked.problem.load = {load_N, friction};
    asked.problem.object_layer = {object_m, object_Pa, object_poisson};
    asked.problem.finger_curvature = {xx_per_m, yy_per_m, xy_per_m};
    PyObject* pressing = PyDict_GetItemWithError(arguments.ptr(), pressing_.ptr());
    const std::optional<PressingFriction> told = pressing_of(pressing, asked.problem);
    if (!told) return std::nullopt;
    known += pressing ? 1 : 0;
    asked.pressing = *told;
    asked.pressing_friction_coefficient = pressing_friction_coefficient(*told, friction);
    PyObject* name = PyDict_GetItemWithError(arguments.ptr(), model_.ptr());
    asked.model = name && name != Py_None ? named(name) : &default_model(asked.problem);
    // An argument that is not known here has its meaning elsewhere, and a slow model lets other
    // threads run there.
    if (known + *count + (name ? 1 : 0) != PyDict_GET_SIZE(arguments.ptr()) || !asked.model ||
        !asked.model->card().hot_path)
      return std::nullopt;
    return asked;
  }

  /// Returns the friction while pressing that is meant, by the rules of softfinger/_contacts.py;
  /// nothing for what these refuse.
  std::optional<PressingFriction> pressing_of(PyObject* given,
                                              const ContactProblem& problem) const {
    PressingFriction told = PressingFriction::coulomb;
    if (given && given != Py_None) {
      std::size_t index = 0;
      while (index < pressings_.size() &&
             !(PyUnicode_Check(given) && PyUnicode_Compare(given, pressings_[index].ptr()) == 0))
        ++index;
      if (index == pressings_.size()) return std::nullopt;
      told = PressingFriction(index);
    }
    return problem.has_object_layer() ? PressingFriction::none : told;
  }

  static const PressureModel* named(PyObject* name) {
    if (!PyUnicode_Check(name)) return nullptr;
    Py_ssize_t length = 0;
    const char* text = PyUnicode_AsUTF8AndSize(name, &length);
    if (!text) PyErr_Clear();
    return text ? find_pressure_model({text, std::size_t(length)}) : nullptr;
  }

  std::array<Range, kArguments.size()> ranges_;
  const std::array<py::str, kArguments.size()> arguments_ = interned(kArguments);
  const std::array<py::str, kPredicted.size()> predicted_ = interned(kPredicted);
  const std::array<py::str, kQuantities.size()> quantities_ = interned(kQuantities);
  const std::array<py::str, kErrors.size()> errors_ = interned(kErrors);
  const py::str model_ = interned("model"), has_answer_ = interned("has_answer"),
                known_ = interned("known"), outside_ = interned("outside"),
                shear_law_ = interned("shear_law"), coulomb_ = interned("coulomb"),
                pressing_ = interned("pressing");
  const std::array<py::str, kPressingFrictionNames.size()> pressings_ =
      interned(kPressingFrictionNames);
};

}  // namespace

void bind_one_contact(py::module_& module) {
  py::class_<OneContact>(module, "OneContact")
      .def(py::init<const py::dict&>())
      .def("numbers", &OneContact::numbers)
      .def("predict", &OneContact::predict)
      .def("error_bound", &OneContact::error_bound);
}

}  // namespace softfinger::python
