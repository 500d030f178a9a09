#include "comparisons/judgement/next_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <optional>
#include <vector>

#include "comparisons/input/mesh_file.h"
#include "comparisons/judgement/assessment.h"
#include "comparisons/judgement/pads.h"
#include "comparisons/judgement/reason.h"
#include "comparisons/prediction/flat_faces.h"
#include "comparisons/prediction/mesh_points.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/percent.h"
#include "softfinger/accuracy/default_model.h"

namespace softfinger::judgement {
namespace {

std::string quoted(const std::string& word) {
  const bool is_plain = word.find_first_not_of(
                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                            "0123456789_-./=,+") == std::string::npos;
  if (is_plain) return word;
  std::string text = "'";
  for (const char letter : word) text += letter == '\'' ? "'\\''" : std::string(1, letter);
  return text + "'";
}

/// The words that name the same contact in a command: the file, or a built-in case by its name, and
/// the values that were typed in place of the file's.
std::string as_typed(const input::Case& contact_case) {
  const auto known = system::builtin_case_files();
  std::error_code missing;
  std::string words = "CASE.toml (this contact in a file)";
  if (std::find(known.begin(), known.end(), contact_case.file) != known.end())
    words = contact_case.file.stem().string();
  else if (std::filesystem::exists(contact_case.file, missing))
    words = quoted(contact_case.file.string());
  else
    return words;
  for (const input::Setting& setting : contact_case.settings)
    words += " --set " + quoted(setting.key + "=" + setting.value);
  return words;
}

using Eigen::Vector3d;
using prediction::Demand;
using prediction::GeometryResolver;
using prediction::ModelAnswer;
using prediction::TorqueRule;

struct Usable {
  const PressureModel* model = nullptr;
  double worst = 0;  ///< the largest bound of what is demanded
};

/// The recommended model, if it is usable there.
std::optional<Usable> usable_model(const input::Case& contact_case,
                                   const prediction::LocalGeometry& geometry, double load_N,
                                   const Demand& demand) {
  const PressureModel& model =
      default_model(prediction::contact_problem(contact_case, geometry, load_N));
  const ModelAnswer answer = ask_model(model, contact_case, geometry, load_N, 0);
  if (!answer.prediction.has_answer) return std::nullopt;
  const prediction::Assessment found =
      assess_numbers(contact_case, geometry, answer, TorqueRule::exact, demand);
  if (!found.usable) return std::nullopt;
  return Usable{&model, worst_of(found.totals(), demand.quantities)};
}

/// The recommended model at another load or point of the case, if it is usable; none also where the
/// geometry is refused there.
std::optional<Usable> usable_model(const input::Case& contact_case,
                                   const GeometryResolver& resolver, double load_N,
                                   const Demand& demand) {
  try {
    return usable_model(contact_case, resolver.resolve(load_N), load_N, demand);
  } catch (const InputError&) {
  } catch (const ConvergenceError&) {
  }
  return std::nullopt;
}

std::string bound_text(const Usable& usable) {
  return fmt::format("by {} within {}", usable.model->card().name, text::percent(usable.worst));
}

/// "finger", "object": the body whose mesh is to be touched elsewhere; the finger's first.
const input::MeshBody* mesh_of(const input::Case& contact_case, const char** name) {
  const auto* pair = std::get_if<input::BodyPair>(&contact_case.geometry);
  if (!pair) return nullptr;
  *name = "finger";
  if (const auto* mesh = std::get_if<input::MeshBody>(&pair->finger)) return mesh;
  *name = "object";
  return std::get_if<input::MeshBody>(&pair->object);
}

/// @param mesh  a placed one, whose unit is known
std::string body_line(const char* name, const input::MeshBody& mesh, const Vector3d& point_m) {
  const input::NamedMesh named{mesh.typed, mesh.part, *mesh.metres_per_unit, mesh.is_own_unit};
  return fmt::format("{} = {{ {}, near_mm = {} }}", name, named.entries(),
                     prediction::in_millimetres(point_m));
}

/// The nearest point of the mesh at which a recommended model is usable, in words; "" if none was
/// found.
std::string nearest_point(const input::Case& contact_case, const GeometryResolver& resolver,
                          double load_N, const Demand& demand) {
  const char* name = nullptr;
  const input::MeshBody* mesh = mesh_of(contact_case, &name);
  if (!mesh) return "";
  const std::clock_t start = std::clock();
  input::MeshBody there;
  try {
    there = resolver.placed(*mesh);
  } catch (const InputError&) {
    return "";  // the typed point is not on the surface
  }
  const Vector3d centre = there.point_m;
  input::Case tried = contact_case;
  auto& pair = std::get<input::BodyPair>(tried.geometry);
  input::CaseBody& body = name == std::string("finger") ? pair.finger : pair.object;
  for (const Vector3d& point : prediction::points_around(resolver.surface(*mesh), centre)) {
    if (std::clock() - start > prediction::kLongestSearch) return "";
    input::MeshBody moved = *mesh;
    moved.along.reset();
    moved.normal.reset();
    moved.near_m = point;
    body = moved;
    const GeometryResolver elsewhere(tried, &resolver);
    if (const auto usable = usable_model(tried, elsewhere, load_N, demand))
      return fmt::format("press {:.2g} mm away, at the nearest point that is usable ({}): {}",
                         1e3 * (point - centre).norm(), bound_text(*usable),
                         body_line(name, there, point));
  }
  return "";
}

/// The best place of the whole finger at which a recommended model is usable, in words; "" if none
/// was found.
std::string best_place(const input::Case& contact_case, const GeometryResolver& resolver,
                       double load_N, const Demand& demand) {
  const char* name = nullptr;
  const input::MeshBody* mesh = mesh_of(contact_case, &name);
  if (!mesh || name != std::string("finger")) return "";
  Pressing pressing;
  pressing.layer = contact_case.layer;
  pressing.load_N = load_N;
  pressing.friction_coefficient = contact_case.shear_law.friction_coefficient;
  pressing.demand = demand;
  input::Case tried = contact_case;
  for (const Pad& pad :
       find_pads(resolver.surface(*mesh), input::MeshRole::finger, pressing, {}, true).best_first) {
    if (!pad.is_usable()) continue;
    input::MeshBody moved = *mesh;
    moved.along.reset();
    moved.normal.reset();
    moved.near_m = pad.point_m;
    std::get<input::BodyPair>(tried.geometry).finger = moved;
    const GeometryResolver elsewhere(tried, &resolver);
    if (const auto usable = usable_model(tried, elsewhere, load_N, demand))
      return fmt::format("press on another side, facing {:.2f}, {:.2f}, {:.2f} ({}): {}",
                         pad.normal.x(), pad.normal.y(), pad.normal.z(), bound_text(*usable),
                         body_line(name, elsewhere.placed(moved), pad.point_m));
  }
  return "";
}

/// A load that is usable, as near to the case's as three halvings of the gap between them find it;
/// "" if there is none within a factor of 256.
std::string other_load(const input::Case& contact_case, const GeometryResolver& resolver,
                       double load_N, const Demand& demand) {
  const auto at = [&](double other_N) {
    return usable_model(contact_case, resolver, other_N, demand);
  };
  const auto two_digits = [](double value) {
    const double step = std::pow(10, std::floor(std::log10(value)) - 1);
    return std::round(value / step) * step;
  };
  for (double factor = 2; factor <= 256; factor *= 2)
    for (const double tried_N : {load_N / factor, load_N * factor}) {
      if (!at(tried_N)) continue;
      double usable_N = tried_N, other_N = tried_N < load_N ? 2 * tried_N : tried_N / 2;
      for (int halving = 0; halving < 3; ++halving) {
        const double middle_N = std::sqrt(usable_N * other_N);
        (at(middle_N) ? usable_N : other_N) = middle_N;
      }
      double told_N = two_digits(usable_N);
      if (!at(told_N)) told_N = tried_N;
      return fmt::format("a {} load is usable, {:.4g} N {}", told_N < load_N ? "smaller" : "larger",
                         told_N, bound_text(*at(told_N)));
    }
  return "";
}

/// Whether the finite elements refuse it: there is no bone or core left to bond the layer to.
bool is_thicker_than_finger(const ContactProblem& problem) {
  constexpr double kMostOfRadius = 0.9;
  const SurfaceCurvature& finger = problem.finger_curvature;
  const double largest_per_m =
      0.5 * (finger.xx_per_m + finger.yy_per_m) +
      std::hypot(0.5 * (finger.xx_per_m - finger.yy_per_m), finger.xy_per_m);
  return problem.layer.thickness_m * largest_per_m >= kMostOfRadius;
}

/// Obstacle that no other point, load or model removes, and what to do about it.
std::optional<NextStep> structural(const input::Case& contact_case, const ModelAnswer* answer) {
  const std::string compare = "softfinger compare " + as_typed(contact_case);
  if (contact_case.object_layer.thickness_m > 0)
    return NextStep{"there are two layers, and errors are known for one",
                    "softfinger fem " + as_typed(contact_case) +
                        " presses both, flat and in linear theory, as --model layer_fft does; or "
                        "leave out a layer that hardly gives way"};
  if (is_stack(contact_case) && answer && !answer->model->knows_stacks())
    return NextStep{"the layer is a stack, and this model knows one material",
                    contact_case.sublayers.size() <= LayerStack::kMost
                        ? "stack_layer knows up to eight sublayers"
                        : compare + " presses the stack by finite elements"};
  if (!contact_case.fem_mesh.empty())
    return NextStep{"the layer is a mesh of its own, which no model knows",
                    "softfinger fem " + as_typed(contact_case) + " presses it"};
  if (contact_case.fem_finite && contact_case.fem_finite->material != "neo_hookean")
    return NextStep{"errors are known for neo-Hookean layers, and this one is " +
                        contact_case.fem_finite->material,
                    compare + ", or leave out [layer] material"};
  if (answer && is_thicker_than_finger(answer->problem))
    return NextStep{
        "the layer leaves no core in the finger, whose smallest radius it nearly reaches",
        "a thinner layer"};
  if (answer && answer->sampled)
    return NextStep{"the gap was sampled, and errors are known for the fitted quadric",
                    "leave out --gap sampled, or " + compare};
  return std::nullopt;
}

/// Advice where nothing that was tried helped.
std::string last_resort(const input::Case& contact_case) {
  const char* name = nullptr;
  if (mesh_of(contact_case, &name))
    return fmt::format(
        "if you know the radii: {} = {{ radii_mm = [9, 7] }} with your own in place "
        "of 9 and 7; or a finer scan",
        name);
  const bool has_finger = std::holds_alternative<input::BodyPair>(contact_case.geometry);
  return fmt::format("softfinger compare {} presses the {} by finite elements",
                     as_typed(contact_case), has_finger ? "finger itself" : "layer");
}

std::string with_alternative(const std::string& step, const input::Case& contact_case) {
  return step.empty() ? last_resort(contact_case) : step;
}

std::string reason_of(const prediction::LocalGeometry& geometry, const ModelAnswer& answer,
                      const Demand& demand) {
  const prediction::Assessment& found = *answer.assessment;
  if (!found.bound || !found.geometry || found.determined || !answer.prediction.has_answer)
    return reason_not_usable(answer, demand);
  constexpr double kCovered = 0.9;
  if (geometry.patch && geometry.patch->covered < kCovered)
    return "the mesh is narrower than the contact or ends beside it";
  return geometry_in_words(found, demand);
}

}  // namespace

NextStep next_step(const input::Case& contact_case, const GeometryResolver& resolver,
                   const ModelAnswer& answer, const Demand& demand) {
  if (const auto found = structural(contact_case, &answer)) return *found;
  const double load_N = answer.problem.load.normal_force_N;
  const prediction::LocalGeometry geometry = resolver.resolve(load_N);
  NextStep result;
  result.reason = reason_of(geometry, answer, demand);
  if (const auto other = usable_model(contact_case, geometry, load_N, demand))
    result.step = fmt::format("--model {} is usable, within {}", other->model->card().name,
                              text::percent(other->worst));
  // Another point does not help where the mesh leaves little open.
  if (result.step.empty() && !answer.assessment->determined) {
    result.step = nearest_point(contact_case, resolver, load_N, demand);
    if (result.step.empty()) result.step = best_place(contact_case, resolver, load_N, demand);
  }
  if (result.step.empty()) result.step = other_load(contact_case, resolver, load_N, demand);
  result.step = with_alternative(result.step, contact_case);
  return result;
}

NextStep next_step(const input::Case& contact_case, const GeometryResolver& resolver, double load_N,
                   const InputError& refusal, const Demand& demand) {
  NextStep result;
  result.reason = refusal.field() + (refusal.value().empty() ? "" : " = " + refusal.value());
  const char* name = nullptr;
  if (!mesh_of(contact_case, &name)) {
    result.step =
        "radii of the gap > 0 in both directions make an ellipse: softfinger predict --help, "
        "radii_mm";
    return result;
  }
  if (refusal.field() == "near_mm" || refusal.field() == "point_mm") {
    result.step = "softfinger mesh FILE lists points of its surface";
    return result;
  }
  result.step = nearest_point(contact_case, resolver, load_N, demand);
  if (result.step.empty()) result.step = best_place(contact_case, resolver, load_N, demand);
  if (result.step.empty()) result.step = other_load(contact_case, resolver, load_N, demand);
  result.step = with_alternative(result.step, contact_case);
  return result;
}

namespace {

/// The flat face on which the case's mesh is touched, if it is.
std::optional<prediction::FlatFace> flat_face_of(const input::Case& contact_case,
                                                 const GeometryResolver& resolver,
                                                 const char** name) {
  const input::MeshBody* mesh = mesh_of(contact_case, name);
  if (!mesh) return std::nullopt;
  try {
    const TriangleSurface& surface = resolver.surface(*mesh);
    const auto faces = prediction::flat_faces(surface);
    if (const prediction::FlatFace* face =
            prediction::face_at(surface, faces, resolver.placed(*mesh).point_m))
      return *face;
  } catch (const InputError&) {
  }
  return std::nullopt;
}

}  // namespace

prediction::LocalGeometry resolve_or_advise(const input::Case& contact_case,
                                            const GeometryResolver& resolver, double load_N,
                                            const Demand& demand) {
  try {
    return resolver.resolve(load_N);
  } catch (const InputError& refusal) {
    std::string step = next_step(contact_case, resolver, load_N, refusal, demand).step;
    // A flat face is what it is, whatever the fit of a quadric to it found.
    const char* name = nullptr;
    if (const auto face = flat_face_of(contact_case, resolver, &name)) {
      if (name == std::string("finger"))
        step += fmt::format(
            "; where all of it touches, a case with finger = {{ pad_mm = [{:.3g}, "
            "{:.3g}] }}",
            1e3 * face->length_m, 1e3 * face->width_m);
      throw InputError(
          refusal.where(),
          fmt::format("the {} there is {}, no ellipse", name, prediction::in_words(*face)), "",
          step);
    }
    throw InputError(refusal.where(), refusal.field(), refusal.value(),
                     refusal.allowed() + (refusal.allowed().empty() ? "" : "; ") + step);
  }
}

}  // namespace softfinger::judgement
