#pragma once

#include <Eigen/Core>

#include "softfinger/calibration/measurement.h"
#include "softfinger/calibration/parameter.h"
#include "softfinger/input/pressing_friction.h"
#include "softfinger/input/shear_law.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// Predictions of the measured quantities by a model, as functions of its parameters.
struct PredictedMeasurements {
  const PressureModel& model;
  const Measurements& measurements;
  ShearLaw::Kind shear_law = ShearLaw::Kind::coulomb;
  /// Friction while pressing, which a, b, area and indentation answer where the model knows it.
  PressingFriction pressing = PressingFriction::none;

  /// The contact with these parameters in place of its own.
  ContactProblem problem(std::size_t contact, const ParameterValues& values) const noexcept;

  /// Natural logarithms of the numbers, one for each measurement. Where the model has no answer,
  /// which a search must turn back from, that of an absurdly large number.
  ///
  /// @param log_slopes  if given, their derivatives with respect to each parameter, of its
  /// logarithm where ParameterRange says so: one row for each measurement, kParameters columns
  void evaluate(const ParameterValues& values, Eigen::VectorXd& log_values,
                Eigen::MatrixXd* log_slopes) const;

  /// ln(d/h) of the hardest pressed contact, with its derivatives as above: whether the layer is
  /// pressed within what the models know.
  double log_compression(const ParameterValues& values, Eigen::RowVectorXd* slopes) const;
};

}  // namespace softfinger
