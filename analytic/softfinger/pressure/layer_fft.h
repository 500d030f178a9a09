#pragma once

#include "softfinger/fft/layer_contact.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// Answer of `layer_fft` for a gap that is not a quadric.
struct GapPrediction {
  /// Prediction as of any model, with the semi-axes of the ellipse that fits the contact's edge
  /// best, `a_m` along `contact.edge.axis_rad` from the gap's own x axis. `small_slope` measures
  /// the gap's slope at the edge.
  Prediction prediction;
  LayerContact contact;  ///< region, pressure, centre, in the gap's frame
};

/// The model `layer_fft` on any smooth gap, for instance a SampledGap. Layers and load are
/// `problem`'s; its radii are not used. Torque is taken about the centre of pressure.
/// @throws what solve_layer_contact throws
/// Cost: about 50 ms.
GapPrediction predict_layer_fft(const GapFunction& gap_m, const GapWindow& window,
                                const ContactProblem& problem);

}  // namespace softfinger
