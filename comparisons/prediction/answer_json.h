#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "comparisons/prediction/ask_model.h"
#include "comparisons/prediction/local_geometry.h"

/// Answers as JSON, for `predict`, `fit` and `compare`.
namespace softfinger::prediction {

/// An object by quantity, or null.
nlohmann::json to_json(const std::optional<QuantityErrors>& bound);

/// The contract's keys for one answer. Numbers that do not exist are null. With
/// `limit_surface_points` > 0, that many points all over the limit surface, in the contact frame (x
/// along the long axis): the exact surface for the equivalent exponent, or for the paper's torque
/// rule its friction ellipsoid. With the exact one also how far the friction ellipsoid is from it:
/// lowest and highest of worst_ellipsoid_deviation.
///
/// `tilt_limit_Nm`: the largest moments about the long and the short axis, see `tilt_limit`, with
/// the model's peak pressure. `rolling_stiffness_Nm_per_rad`: P R'', P R', the moments about where
/// the contact was, per angle by which curved bodies roll on each other.
nlohmann::json to_json(const ModelAnswer& answer, TorqueRule rule, int limit_surface_points);

/// Validity as data: check, value, limit, holds, message.
nlohmann::json to_json(const Validity& validity);

/// `softfinger fit`'s keys; a flat direction has radius null.
nlohmann::json to_json(const QuadricFit& fit);

/// The patch of report.json, or null when no body is a mesh.
nlohmann::json patch_to_json(const LocalGeometry& geometry);

/// The law that was fitted to a case's data and how well; null without data.
nlohmann::json to_json(const std::optional<PowerLawFit>& fit);

}  // namespace softfinger::prediction
