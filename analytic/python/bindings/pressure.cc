#include <algorithm>

#include "analytic/python/bindings/contacts.h"
#include "softfinger/pressure/rubbed_prediction.h"
#include "softfinger/pressure/stack_models.h"

namespace softfinger::python {
namespace {

py::list models() {
  py::list cards;
  for (const PressureModel* model : all_pressure_models()) {
    const ModelCard& card = model->card();
    py::dict entry;
    entry["name"] = std::string(card.name);
    entry["title"] = std::string(card.title);
    entry["assumptions"] = std::string(card.assumptions);
    entry["equations"] = std::string(card.equations);
    entry["source"] = std::string(card.source);
    entry["validity"] = std::string(card.validity);
    entry["cost"] = std::string(card.cost);
    entry["is_fast"] = card.hot_path;
    entry["has_finite_strain"] = card.finite_strain;
    entry["knows_pressing_friction"] = knows_pressing_friction(*model);
    entry["is_for_several_layers"] = is_for_stacks(*model);
    cards.append(entry);
  }
  return cards;
}

/// Returns each contact's recommended model as an index into `models()`.
py::array_t<int> default_models(const py::dict& numbers) {
  const Contacts contacts(numbers);
  const auto& all = all_pressure_models();
  py::array_t<int> result{py::ssize_t(contacts.count())};
  int* place = result.mutable_data();
  for (std::size_t i = 0; i < contacts.count(); ++i)
    place[i] =
        int(std::find(all.begin(), all.end(), &default_model(contacts.problem(i))) - all.begin());
  return result;
}

/// Predicts one contact at a time: predict_batch handles one model and rigid objects only.
void predict_each(const AskedModel& model, const Contacts& contacts,
                  const PredictionBatch& answers) {
  for (std::size_t i = 0; i < contacts.count(); ++i) {
    const ContactProblem problem = contacts.problem(i);
    const PressureModel& one = model.of(problem);
    const Prediction answer = one.predict(problem);
    const Prediction pressed =
        as_pressed(one, answer, problem, contacts.pressing_friction_coefficient(i));
    answers.a_m[i] = pressed.a_m;
    answers.b_m[i] = pressed.b_m;
    answers.indentation_m[i] = pressed.indentation_m;
    answers.peak_pressure_Pa[i] = pressed.peak_pressure_Pa;
    answers.torque_arm_exact_m[i] = answer.torque_arm_exact_m;
    answers.torque_arm_paper_m[i] = answer.torque_arm_paper_m;
    answers.pressure_arm_m[i] = pressed.torque_arm_exact_m;
    answers.frictionless_a_m[i] = answer.a_m;
    answers.frictionless_b_m[i] = answer.b_m;
  }
}

py::dict predict(const std::optional<std::string>& name, const py::dict& numbers) {
  const AskedModel asked(name);
  const Contacts contacts(numbers);
  py::dict result;
  const auto output = [&](const char* quantity) {
    Numbers values(py::ssize_t(contacts.count()));
    result[quantity] = values;
    return values.mutable_data();
  };
  const PredictionBatch answers{output("a_m"),
                                output("b_m"),
                                output("indentation_m"),
                                output("peak_pressure_Pa"),
                                output("torque_arm_exact_m"),
                                output("torque_arm_paper_m"),
                                output("pressure_arm_m"),
                                output("frictionless_a_m"),
                                output("frictionless_b_m")};
  const py::gil_scoped_release others_may_run;
  const PressureModel* model = asked.common();
  if (!model || contacts.have_object_layers())
    predict_each(asked, contacts, answers);
  else
    predict_batch(*model, contacts.batch(), answers);
  return result;
}

/// Returns the validity checks of one contact: each assumption of the model and whether it holds.
py::list checks(const std::string& name, const py::dict& numbers) {
  const PressureModel& model = model_named(name);
  const Contacts contacts(numbers);
  const ContactProblem problem = contacts.problem(0);
  Prediction answer = model.predict(problem);
  const double mu = contacts.pressing_friction_coefficient(0);
  if (answer.has_answer && mu > 0 && !knows_pressing_friction(model))
    answer.validity.add(check_frictionless_pressing(model, answer, problem, mu));
  py::list result;
  for (const ValidityCheck& check : answer.validity)
    result.append(py::make_tuple(check.check, check.value, check.limit, check.holds(),
                                 check.holds_below, check.message));
  return result;
}

/// Returns the pressures at the points; none where the model has no answer.
std::optional<Numbers> pressure_Pa(const std::string& name, const py::dict& numbers,
                                   const Numbers& points_m) {
  const PressureModel& model = model_named(name);
  const Contacts contacts(numbers);
  const ContactProblem problem = contacts.problem(0);
  const double mu = contacts.pressing_friction_coefficient(0);
  const double* point = rows(points_m, 2);
  Numbers result(points_m.shape(0));
  double* pressure = result.mutable_data();
  const py::ssize_t count = points_m.shape(0);
  Prediction prediction;
  {
    const py::gil_scoped_release others_may_run;
    prediction = model.predict(problem);
    const Prediction pressed = as_pressed(model, prediction, problem, mu);
    const bool is_rubbed = mu > 0 && knows_pressing_friction(model);
    for (py::ssize_t i = 0; prediction.has_answer && i < count; ++i) {
      const double x_m = point[2 * i], y_m = point[2 * i + 1];
      pressure[i] = is_rubbed ? rubbed_pressure_Pa(model, problem, pressed, x_m, y_m)
                              : model.pressure_Pa(problem, prediction, x_m, y_m);
    }
  }
  return prediction.has_answer ? std::optional<Numbers>(result) : std::nullopt;
}

}  // namespace

void bind_pressure(py::module_& module) {
  module.def("models", &models);
  module.def("default_models", &default_models);
  module.def("predict", &predict);
  module.def("checks", &checks);
  module.def("pressure_Pa", &pressure_Pa);
}

}  // namespace softfinger::python
