#include "comparisons/simulation/taxel_frames.h"

#include <fmt/format.h>

#include <algorithm>

#include "comparisons/simulation/contact_model.h"
#include "comparisons/text/csv.h"
#include "softfinger/input/errors.h"

namespace softfinger::simulation {
namespace {

/// Returns the model's answer for a recorded contact; nothing where it has no pressure (a rigid
/// point, or one without an ellipse).
std::optional<prediction::ModelAnswer> pressed_again(const RecordedContact& contact,
                                                     const input::Scene& scene) {
  if (!(contact.semi_axis_a_m > 0 && contact.normal_force_N > 0)) return std::nullopt;
  std::optional<ContactProblem> problem = soft_contact(scene, contact.a, contact.b, contact.radii);
  if (!problem) return std::nullopt;
  problem->load.normal_force_N = contact.normal_force_N;
  problem->finger_curvature = contact.finger_curvature;
  prediction::ModelAnswer answer;
  answer.model = find_pressure_model(contact.model);
  if (!answer.model) return std::nullopt;
  answer.problem = *problem;
  answer.prediction = answer.model->predict(*problem);
  if (!answer.prediction.has_answer) return std::nullopt;
  return answer;
}

}  // namespace

void check_taxels(const input::Scene& scene, const prediction::TaxelRequest& request) {
  if (!request.pitch_m)
    throw InputError("command line", "--taxels",
                     fmt::format("{},{}", request.columns, request.rows),
                     "NX,NY,PITCH_mm: an array in motion has one size");
  for (const auto& body : scene.bodies) {
    if (!body.relaxation.is_elastic())
      throw InputError(
          "command line", "--taxels", body.name,
          "a scene whose layers do not relax: the pressure of a layer that does is not "
          "that of its load alone");
    if (body.layer && !(request.depth_m >= 0 && request.depth_m <= body.layer->thickness_m))
      throw InputError("command line", "--taxels-depth", 1e3 * request.depth_m,
                       fmt::format("0 to the {:.6g} mm of {}'s layer",
                                   1e3 * body.layer->thickness_m, body.name));
  }
}

std::string taxels_csv(const Recording& recording, const input::Scene& scene,
                       const prediction::TaxelRequest& request, int every) {
  check_taxels(scene, request);
  std::string table = "time_s,body_a,body_b," + prediction::taxel_csv_header();
  for (std::size_t step = 0; step < recording.frames.size(); ++step) {
    if (step % std::size_t(every) != 0 && step + 1 != recording.frames.size()) continue;
    const Frame& frame = recording.frames[step];
    for (const RecordedContact& contact : frame.contacts) {
      const auto answer = pressed_again(contact, scene);
      if (!answer) continue;
      const std::string before = fmt::format(
          "{},{},{},", frame.time_s, text::csv_cell(recording.bodies[std::size_t(contact.a)].name),
          text::csv_cell(recording.bodies[std::size_t(contact.b)].name));
      const std::string rows = prediction::taxel_csv_rows(read_taxels(*answer, request));
      for (std::size_t begin = 0; begin < rows.size();) {
        const std::size_t end = rows.find('\n', begin) + 1;
        table += before + rows.substr(begin, end - begin);
        begin = end;
      }
    }
  }
  return table;
}

}  // namespace softfinger::simulation
