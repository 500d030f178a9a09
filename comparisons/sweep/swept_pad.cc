#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>
#include <variant>

#include "comparisons/input/pad.h"
#include "comparisons/prediction/pad_answer.h"
#include "comparisons/sweep/cells.h"
#include "comparisons/sweep/swept_contact.h"
#include "softfinger/input/constants.h"
#include "softfinger/pads/pad_model.h"

namespace softfinger::sweep {
namespace {

using PadModels = std::vector<const PadModel*>;
using ShapePointer = std::shared_ptr<const PadShape>;

PadModels models_of_pad(const Sweep& sweep) {
  PadModels models;
  for (const std::string& name : sweep.models())
    for (const PadModel* model : prediction::pad_models_by_name(name))
      if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
  return models.empty() ? all_pad_models() : models;
}

/// The solved outlines of a sweep. To solve one takes ten milliseconds, to ask a model a
/// microsecond.
class Shapes {
 public:
  ShapePointer of(const ConvexOutline& outline) const {
    std::vector<double> key;
    for (const Eigen::Vector2d& vertex : outline.vertices_m())
      key.insert(key.end(), {vertex.x(), vertex.y()});
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = known_.find(key); found != known_.end()) return found->second;
    }
    auto shape = std::make_shared<const PadShape>(outline);
    const std::lock_guard lock(mutex_);
    constexpr std::size_t kMostKept = 64;  // of 1 MB each
    if (known_.size() >= kMostKept) known_.clear();
    known_.emplace(std::move(key), shape);
    return shape;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<std::vector<double>, ShapePointer> known_;
};

class PadAtPoint : public ContactAtPoint {
 public:
  PadAtPoint(const input::Case& contact_case, ShapePointer shape, const PadModels& models,
             const prediction::Demand& demand)
      : case_(contact_case),
        pair_(std::get<input::PadPair>(contact_case.geometry)),
        shape_(std::move(shape)),
        models_(models),
        demand_(demand) {}

  void append_answers(double load_N, std::string& text) override {
    const ConvexOutline& outline = pair_.contact;
    append_number(outline.area_m2(), text);
    append_number(outline.area_m2() / outline.perimeter_m() / case_.layer.thickness_m, text);
    for (const PadModel* model : models_) {
      const prediction::PadAnswer answer =
          prediction::ask_pad_model(*model, case_, *shape_, load_N, demand_, 0);
      const PadPrediction& p = answer.prediction;
      if (model == models_.front()) prediction::refuse_tipping(pair_, answer);
      for (const double value :
           {indentation_at_load_m(answer), p.normal_stiffness_N_per_m, p.peak_pressure_Pa,
            p.pressure_arm_m, p.eccentricity_m, answer.friction_ellipsoid().max_torque_Nm(),
            p.tilt_stiffness_Nm_per_rad[0], p.tilt_stiffness_Nm_per_rad[1], p.tilt_limit_Nm[0],
            p.tilt_limit_Nm[1]})
        append_number(p.has_answer ? value : kNaN, text);
      append_yes_or_no(answer.usable, text);
    }
  }

  std::string append_reference(const SweepFemJobs& fem, std::size_t job,
                               std::string& text) override {
    const auto finished = reference::finished_pad(fem.pads[job], fem.settings);
    if (!finished.elements) return "no finite-element result";
    const reference::PadElements& pad = *finished.elements;
    for (const double value :
         {pad.indentation_m, pad.normal_stiffness_N_per_m, pad.peak_pressure_Pa, pad.pressure_arm_m,
          pad.eccentricity_m, pad.max_torque_Nm, pad.tilt_stiffness_Nm_per_rad[0],
          pad.tilt_stiffness_Nm_per_rad[1], pad.tilt_limit_Nm[0].value_or(kNaN),
          pad.tilt_limit_Nm[1].value_or(kNaN)})
      append_number(value, text);
    const reference::PadElementErrors& error = pad.error;
    for (const auto& stated : {error.indentation, error.normal_stiffness, error.peak_pressure,
                               error.pressure_arm, error.max_torque, error.tilt_stiffness})
      append_number(stated.value_or(kNaN), text);
    constexpr double kLargestStrain = 0.1;  // of linear elasticity
    append_yes_or_no(
        reference::is_trusted(pad) && pad.indentation_m <= kLargestStrain * case_.layer.thickness_m,
        text);
    return "";
  }

  std::string without_job() const override {
    return reference::elements_refusal(case_).value_or("");
  }

  FemRequest fem_request(double load_N) override {
    // The elements know lift-off, but no model would stand beside them.
    prediction::refuse_tipping(
        pair_, prediction::ask_pad_model(*models_.front(), case_, *shape_, load_N, demand_, 0));
    return {reference::pad_problem(case_, load_N, case_.fem_level, 0),
            reference::expected_pad_s(case_)};
  }

 private:
  const input::Case& case_;
  const input::PadPair& pair_;
  ShapePointer shape_;
  const PadModels& models_;
  const prediction::Demand& demand_;
};

class SweptPad : public SweptContact {
 public:
  SweptPad(const Sweep& sweep, const prediction::Demand& demand)
      : demand_(demand), models_(models_of_pad(sweep)) {
    input::refuse_curved_pad(sweep.base(), "softfinger sweep");
    for (const PadModel* model : models_) cards_.push_back(&model->card());
    if (sweep.fem())
      if (const auto left_out = reference::elements_remark(sweep.base()))
        remarks_.push_back(*left_out);
  }

  const ContactColumns& columns() const override {
    static const ContactColumns names{
        {"area_m2", "shape_factor"},
        {"indentation_m", "normal_stiffness_N_per_m", "peak_pressure_Pa", "pressure_arm_m",
         "eccentricity_m", "max_torque_Nm", "tilt_stiffness_x_Nm_per_rad",
         "tilt_stiffness_y_Nm_per_rad", "tilt_limit_x_Nm", "tilt_limit_y_Nm"},
        {"indentation", "normal_stiffness", "peak_pressure", "pressure_arm", "max_torque",
         "tilt_stiffness"}};
    return names;
  }
  const std::vector<const ModelCard*>& models() const override { return cards_; }
  std::string recommended() const override { return std::string(cards_.front()->name); }
  std::vector<std::string> remarks() const override { return remarks_; }
  std::unique_ptr<ContactAtPoint> at(const input::Case& contact_case) const override {
    return std::make_unique<PadAtPoint>(
        contact_case, shapes_.of(prediction::bearing_outline(contact_case)), models_, demand_);
  }

 private:
  prediction::Demand demand_;
  PadModels models_;
  std::vector<const ModelCard*> cards_;
  std::vector<std::string> remarks_;
  Shapes shapes_;
};

}  // namespace

std::unique_ptr<const SweptContact> swept_pad(const Sweep& sweep,
                                              const prediction::Demand& demand) {
  return std::make_unique<SweptPad>(sweep, demand);
}

}  // namespace softfinger::sweep
