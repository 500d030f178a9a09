#include "comparisons/exporting/pad_contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace softfinger::exporting {
namespace {

double uniform_eccentricity_m(const ConvexOutline& outline) {
  return outline.radius_integral_m3(outline.centroid_m()) / outline.area_m2();
}

}  // namespace

std::array<double, 2> PadContact::tipping_half_lengths_m() const {
  const ConvexOutline& outline = shape->outline();
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
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  PadContact made;
  made.shape = std::make_unique<PadShape>(pair.contact);
  const PadModel& model = *find_pad_model("pad_layer");
  made.answer = prediction::ask_pad_model(model, contact_case, *made.shape, load_N, demand, 0);
  SoftContact& contact = made.contact;
  contact.friction_coefficient = made.answer.problem.load.friction_coefficient;
  contact.load_N = load_N;
  contact.eccentricity_m = made.answer.prediction.eccentricity_m;
  contact.indentation_m = made.answer.prediction.indentation_m;
  contact.normal_stiffness_N_per_m = made.answer.prediction.normal_stiffness_N_per_m;
  contact.origin = without_double_hyphens(
      fmt::format("{}, {}, {:g} N", contact_case.id, model.card().name, load_N));
  PadProblem centred = made.answer.problem;
  centred.load_at_m.reset();
  const Eigen::Vector2d extent_m = pair.contact.extent_m();
  contact.face =
      PadFace{extent_m.x(),
              extent_m.y(),
              contact_case.layer.thickness_m,
              model.predict(centred).eccentricity_m,
              uniform_eccentricity_m(pair.contact),
              uniform_eccentricity_m(ConvexOutline::rounded_rectangle(extent_m.x(), extent_m.y()))};
  return made;
}

}  // namespace softfinger::exporting
