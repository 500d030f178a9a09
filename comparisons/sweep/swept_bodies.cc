#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "comparisons/judgement/assessment.h"
#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/reference/full_reference.h"
#include "comparisons/reference/theory_limits.h"
#include "comparisons/sweep/cells.h"
#include "comparisons/sweep/swept_contact.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger::sweep {
namespace {

using Models = std::vector<const PressureModel*>;

Models models_of_bodies(const Sweep& sweep) {
  Models models;
  for (const std::string& name : sweep.models())
    for (const PressureModel* model : prediction::models_by_name(name))
      if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
  if (!models.empty()) return models;
  const input::Case& base = sweep.base();
  for (const PressureModel* model : prediction::models_by_name("all")) {
    if (model->card().is_empirical && !(base.options.power_law.radius_coefficient > 0)) continue;
    models.push_back(model);
  }
  return models;
}

/// Finite strain, contacts without symmetry and fine levels cost most.
double weight_of(const input::Case& contact_case, const RelativeRadii& radii) {
  const double level = std::pow(4., contact_case.fem_level);
  const bool whole = contact_case.fem_curved || !contact_case.fem_mesh.empty();
  return level * std::sqrt(radii.major_m / radii.minor_m) * (contact_case.fem_finite ? 8 : 1) *
         (whole ? 4 : 1);
}

class BodiesAtPoint : public ContactAtPoint {
 public:
  BodiesAtPoint(const input::Case& contact_case, const prediction::GeometryResolver& known,
                const Models& models, const prediction::Demand& demand)
      : case_(contact_case), resolver_(contact_case, &known), models_(models), demand_(demand) {}

  void append_answers(double load_N, std::string& text) override {
    geometry_ = resolver_.resolve(load_N);
    append_number(geometry_.radii.major_m, text);
    append_number(geometry_.radii.minor_m, text);
    for (const PressureModel* model : models_) {
      const prediction::ModelAnswer answer =
          prediction::ask_model(*model, case_, geometry_, load_N);
      const Prediction& prediction = answer.pressed();
      if (!prediction.has_answer) {
        text.append(6, ',');
        append_yes_or_no(false, text);
        continue;
      }
      const FrictionEllipsoid ellipsoid = answer.friction_ellipsoid(prediction::TorqueRule::exact);
      for (const double value :
           {prediction.a_m, prediction.b_m, prediction.indentation_m, prediction.peak_pressure_Pa,
            prediction.area_m2(), ellipsoid.max_torque_Nm()})
        append_number(value, text);
      append_yes_or_no(judgement::assess_numbers(case_, geometry_, answer,
                                                 prediction::TorqueRule::exact, demand_)
                           .usable,
                       text);
    }
  }

  std::string append_reference(const SweepFemJobs& fem, std::size_t job,
                               std::string& text) override {
    const auto finished = reference::finished_result(fem.jobs[job], fem.settings);
    if (!finished.result) return "no finite-element result";
    const reference::ReferenceResult& result = *finished.result;
    for (const double value :
         {result.a_m, result.b_m, result.indentation_m, result.peak_pressure_Pa,
          result.area_projected_m2, result.max_torque_Nm})
      append_number(value, text);
    const reference::ReferenceErrors& error = result.error;
    for (const auto& stated :
         {error.a, error.b, error.indentation, error.peak_pressure, error.area, error.max_torque})
      append_number(stated.value_or(NAN), text);
    const input::Case solved = reference::with_full_reference(case_, resolver_, {});
    append_yes_or_no(reference::theory_limits(solved, geometry_, result).holds(), text);
    return "";
  }

  FemRequest fem_request(double load_N) override {
    const input::Case solved = reference::with_full_reference(case_, resolver_, {});
    const prediction::LocalGeometry geometry = resolver_.resolve(load_N);
    return {reference::fem_problem(solved, geometry, load_N, solved.fem_level),
            weight_of(solved, geometry.radii)};
  }

 private:
  const input::Case& case_;
  prediction::GeometryResolver resolver_;
  const Models& models_;
  const prediction::Demand& demand_;
  prediction::LocalGeometry geometry_;  ///< of the last answers
};

class SweptBodies : public SweptContact {
 public:
  SweptBodies(const Sweep& sweep, const prediction::Demand& demand)
      : base_(sweep.base()), demand_(demand), models_(models_of_bodies(sweep)), geometry_(base_) {
    for (const PressureModel* model : models_) cards_.push_back(&model->card());
  }

  const ContactColumns& columns() const override {
    static const ContactColumns names{
        {"radius_major_m", "radius_minor_m"},
        {"a_m", "b_m", "indentation_m", "peak_pressure_Pa", "area_m2", "max_torque_Nm"},
        {"a", "b", "indentation", "peak_pressure", "area", "max_torque"}};
    return names;
  }
  const std::vector<const ModelCard*>& models() const override { return cards_; }
  std::string recommended() const override {
    try {
      const double load_N = base_.loads_N.front();
      return std::string(
          default_model(prediction::contact_problem(base_, geometry_.resolve(load_N), load_N))
              .card()
              .name);
    } catch (const InputError&) {  // the swept values can mend a case that has no contact itself
      return "";
    }
  }
  std::vector<std::string> remarks() const override { return geometry_.remarks(); }
  std::unique_ptr<ContactAtPoint> at(const input::Case& contact_case) const override {
    return std::make_unique<BodiesAtPoint>(contact_case, geometry_, models_, demand_);
  }

 private:
  const input::Case& base_;
  prediction::Demand demand_;
  Models models_;
  prediction::GeometryResolver geometry_;  ///< with the meshes that have been read
  std::vector<const ModelCard*> cards_;
};

}  // namespace

std::unique_ptr<const SweptContact> swept_bodies(const Sweep& sweep,
                                                 const prediction::Demand& demand) {
  return std::make_unique<SweptBodies>(sweep, demand);
}

}  // namespace softfinger::sweep
