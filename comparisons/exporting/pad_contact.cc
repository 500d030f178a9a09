#include "comparisons/exporting/pad_contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/exporting/soft_pad.h"

namespace softfinger::exporting {

std::array<double, 2> PadContact::tipping_half_lengths_m() const {
  const ConvexOutline& outline = answer.face;
  const Eigen::Vector2d half_m = outline.extent_m() / 2;
  const auto& vertices = outline.vertices_m();
  double scale = 1;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Eigen::Vector2d along = vertices[(i + 1) % vertices.size()] - vertices[i];
    const Eigen::Vector2d outward(along.y(), -along.x());
    const double reach = outward.cwiseAbs().dot(half_m);
    scale = std::min(scale, outward.dot(vertices[i] - outline.centroid_m()) / reach);
  }
  return {scale * half_m.x(), scale * half_m.y()};
}

std::array<double, 2> PadContact::lift_off_half_lengths_m() const {
  // A moment about y moves the load along x.
  const auto& limit_Nm = answer.prediction.tilt_limit_Nm;
  const double load_N = answer.problem.load.normal_force_N;
  return {limit_Nm[1] / load_N, limit_Nm[0] / load_N};
}

PadContact ask_pad_contact(const input::Case& contact_case, double load_N,
                           const prediction::Demand& demand) {
  PadContact made;
  made.shape = std::make_unique<PadShape>(prediction::bearing_outline(contact_case));
  const PadModel& model = *find_pad_model("pad_layer");
  made.answer = prediction::ask_pad_model(model, contact_case, *made.shape, load_N, demand, 0);
  made.contact = soft_pad(model, made.answer.problem, made.answer.prediction);
  made.contact.origin = without_double_hyphens(
      fmt::format("{}, {}, {:g} N", contact_case.id, model.card().name, load_N));
  return made;
}

ContactCurve pad_curve(const PadContact& made, const input::Case& contact_case,
                       const LoadRange& loads) {
  const prediction::PadAnswer& answer = made.answer;
  ContactCurve curve;
  curve.case_id = contact_case.id;
  curve.model = answer.model->card().name;
  curve.shear_law = contact_case.shear_law;
  curve.normal_stiffness_N_per_m = made.contact.normal_stiffness_N_per_m;
  LoadPoint& point = curve.nominal;
  point.friction_coefficient = made.contact.friction_coefficient;
  point.eccentricity_m = made.contact.eccentricity_m;
  point.a_m = made.contact.face->length_m / 2;
  point.b_m = made.contact.face->width_m / 2;
  prediction::Assessment& assessment = point.assessment;
  assessment.usable = assessment.determined = answer.usable;
  assessment.evidence = answer.evidence;
  if (answer.bound) {
    assessment.bound = assessment.geometry = prediction::QuantityErrors{};
    for (std::size_t q = 0; q < prediction::kQuantities; ++q)
      (*assessment.bound)[q] = answer.bound_of(prediction::Quantity(q));
  }
  if (!answer.usable) curve.advice = point.reason = answer.evidence;
  for (const double load_N : {loads.lowest_N, loads.nominal_N, loads.highest_N}) {
    curve.points.push_back(point);
    curve.points.back().load_N = load_N;
    curve.points.back().indentation_m = made.contact.indentation_m * load_N / loads.nominal_N;
  }
  curve.nominal = curve.points[1];
  return curve;
}

namespace {

std::string numbers(const Eigen::Vector3d& values) {
  return fmt::format("{:.6g} {:.6g} {:.6g}", values.x() + 0., values.y() + 0., values.z() + 0.);
}

}  // namespace

CornerShape corner_shape(RobotFormat format, const RobotShape& shape, const FlatEnd& end,
                         const PadFace& face) {
  const bool is_mjcf = format == RobotFormat::mjcf, is_urdf = format == RobotFormat::urdf;
  const double half = is_mjcf ? 1 : 2;
  const auto own = [&](const char* kind, const char* name, const std::string& value) {
    const char* const pattern =
        is_mjcf || is_urdf ? "{}=\"{}\" of the {}" : "<{0}>{1}</{0}> of the {2}";
    return CornerShape{fmt::format(fmt::runtime(pattern), name, value, kind), kind, name, value};
  };
  const auto [x_m, y_m] = face.corner_box_m();
  const auto* cylinder = std::get_if<input::Cylinder>(&shape.kind);
  const auto* box = std::get_if<input::Box>(&shape.kind);
  const std::string radius = fmt::format("{:.6g}", face.eccentricity_m);
  if (cylinder && is_mjcf)
    return own("cylinder", "size", fmt::format("{} {:.6g}", radius, cylinder->length_m / 2));
  if (cylinder) return own("cylinder", "radius", radius);
  // MJCF's `fromto` gives a box other axes than its size.
  if (box && !end.is_joined && !(is_mjcf && shape.element->attribute("fromto"))) {
    int axis = 0;
    end.in_shape.linear().col(2).cwiseAbs().maxCoeff(&axis);
    Eigen::Vector3d size_m = box->size_m / 2;
    size_m[(axis + 1) % 3] = x_m;
    size_m[(axis + 2) % 3] = y_m;
    return own("box", "size", numbers(half * size_m));
  }
  // A box as thick as the layer, its face where the pad's is.
  Eigen::Isometry3d in_body = shape.in_body * end.in_shape;
  in_body.translation() -= face.thickness_m / 2 * in_body.linear().col(2);
  const std::string size = numbers(half * Eigen::Vector3d(x_m, y_m, face.thickness_m / 2)),
                    at = numbers(in_body.translation());
  CornerShape other;
  if (is_mjcf) {
    const Eigen::Quaterniond turn(in_body.linear());
    other.words = fmt::format(R"(<geom type="box" size="{}" pos="{}" quat="{:.6g} {}"/>)", size, at,
                              turn.w(), numbers(turn.vec()));
    return other;
  }
  const Eigen::Vector3d angles = in_body.linear().eulerAngles(2, 1, 0).reverse();
  const char* const pattern =
      is_urdf ? R"(<origin xyz="{}" rpy="{}"/><geometry><box size="{}"/></geometry>)"
              : "<pose>{} {}</pose><geometry><box><size>{}</size></box></geometry>";
  other.words = fmt::format(fmt::runtime(pattern), at, numbers(angles), size);
  return other;
}

}  // namespace softfinger::exporting
