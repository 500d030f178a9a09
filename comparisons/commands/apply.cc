#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/contact_choice.h"
#include "comparisons/commands/finger_shapes.h"
#include "comparisons/exporting/friction_pyramid.h"
#include "comparisons/exporting/included_files.h"
#include "comparisons/exporting/pad_contact.h"
#include "comparisons/exporting/robot_file.h"
#include "comparisons/exporting/robot_shapes.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/mesh_points.h"
#include "comparisons/system/files.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

namespace fs = std::filesystem;
using exporting::ContactCurve;
using exporting::Simulator;
using exporting::XmlChange;
using exporting::XmlFile;

/// Models of robots with their meshes apart are far smaller.
constexpr std::size_t kMostBytes = 20'000'000;

struct ApplyOptions {
  std::string model, to, output;
  std::vector<std::string> fingers;
  ContactChoice contact;
  ShapeChoice shape;
  double effective_mass_g = 0, depth_mm = 0;
  bool plugin = false, shrink_pads = false, in_place = false, json = false;

  bool is_standard_input() const { return model == "-"; }
};

/// The contact of a finger: of the case, which is one for all, or of its own shape.
struct FingerContact {
  std::string name;  ///< empty: all fingers
  std::unique_ptr<ShapedFinger> shaped;
  ContactCurve curve;
  exporting::RobotContact wanted;
  std::vector<double> torque_errors, force_errors;  ///< in the simulator, over the curve's loads
  std::string corner_shape;                         ///< of a flat pad, which should be the shape
};

/// "-31.6 to +43.0 % of the torque over 0.5 to 10 N", "the force is exact"
std::string range_of(const std::vector<double>& errors, const ContactCurve& curve, const char* of) {
  const auto [least, largest] = std::minmax_element(errors.begin(), errors.end());
  if (std::abs(*least) < 5e-4 && std::abs(*largest) < 5e-4)
    return fmt::format("the {} is exact", of);
  const auto percent = [](double error) { return std::abs(error) < 5e-4 ? 0.0 : 100 * error; };
  return fmt::format("{:+.1f} to {:+.1f} % of the {} over {:g} to {:g} N", percent(*least),
                     percent(*largest), of, curve.points.front().load_N,
                     curve.points.back().load_N);
}

/// The contact for the plugin, which knows one layer on a rigid object, and Coulomb's law.
ContactProblem plugin_problem(const ApplyOptions& options, const input::Case& contact_case,
                              double load_N) {
  if (!options.contact.model.empty())
    throw InputError("command line", "--model", options.contact.model,
                     "no --model beside --plugin, which follows the recommended one");
  const auto refuse = [&](const char* what, const char* allowed) {
    throw InputError(contact_case.id, std::string("--plugin with ") + what, "", allowed);
  };
  if (contact_case.shear_law.has_shear_strength()) refuse("a shear strength", "Coulomb's law");
  if (contact_case.object_layer.thickness_m > 0) refuse("an object_layer", "one layer");
  if (!contact_case.sublayers.empty()) refuse("several sublayers", "a homogeneous layer");
  return prediction::contact_problem(
      contact_case, prediction::GeometryResolver(contact_case).resolve(load_N), load_N);
}

/// Refuses what cannot be written. Without an output and --in-place nothing is.
/// @throws InputError
void check_output(const ApplyOptions& options) {
  const bool is_input = options.is_standard_input();
  if (options.in_place && (is_input || !options.output.empty()))
    throw InputError("command line", "--in-place", "", "a file, and no --output");
  std::error_code error;
  if (!options.output.empty() && !is_input && fs::equivalent(options.model, options.output, error))
    throw InputError("command line", "--output", options.output,
                     "another file than MODEL, or --in-place");
}

bool is_folder(const std::string& output) {
  std::error_code error;
  return !output.empty() && (output.back() == '/' || fs::is_directory(output, error));
}

using Files = std::vector<std::pair<fs::path, std::string>>;

/// The files to write: in place those that change, into a folder all of the model, else one.
/// @throws InputError where one file cannot hold the changes
Files files_to_write(const ApplyOptions& options, const XmlFile& model) {
  Files files;
  const std::vector<const XmlFile*> parts = model.files();
  if (options.in_place) {
    for (const XmlFile* part : parts)
      if (!part->changes().empty() || part == &model)
        files.emplace_back(part == &model ? fs::path(options.model) : fs::path(part->where()),
                           part->text());
    if (files.size() > 1 && model.changes().empty()) files.erase(files.begin());
    return files;
  }
  if (options.output.empty()) return files;
  if (!is_folder(options.output)) {
    for (const XmlFile* part : parts)
      if (part != &model && !part->changes().empty())
        throw InputError(
            "command line", "--output", options.output,
            "a folder for MODEL and all that it includes, or --in-place: " +
                part->changes().front().element + " lies in " + part->where() +
                fmt::format(":{}, which MODEL includes", part->changes().front().line));
    files.emplace_back(options.output, model.text());
    return files;
  }
  const fs::path folder = options.is_standard_input() ? "." : fs::path(options.model).parent_path();
  for (const XmlFile* part : parts) {
    const fs::path path = part == &model ? fs::path(options.model) : fs::path(part->where());
    const fs::path inside = part == &model
                                ? path.filename()
                                : path.lexically_normal().lexically_relative(
                                      folder.empty() ? fs::path(".") : folder.lexically_normal());
    if (inside.empty() || *inside.begin() == "..")
      throw InputError("command line", "--output", options.output,
                       "--in-place, or another place for " + path.string() +
                           ", which MODEL includes and which lies outside of its folder");
    files.emplace_back(fs::path(options.output) / inside, part->text());
  }
  return files;
}

void write(const ApplyOptions& options, const Files& files) {
  if (is_folder(options.output))
    for (const auto& [path, text] : files) system::make_writable_folder(path.parent_path());
  system::write_files_together(files);
}

/// A copy in another folder does not find meshes by relative paths.
bool leaves_files_behind(const XmlFile& file, const ApplyOptions& options) {
  if (options.is_standard_input() || options.in_place || options.output.empty()) return false;
  const fs::path output =
      is_folder(options.output) ? fs::path(options.output) / "model" : fs::path(options.output);
  std::error_code error;
  const auto folder = [](const fs::path& path) {
    return path.parent_path().empty() ? fs::path(".") : path.parent_path();
  };
  if (fs::equivalent(folder(options.model), folder(output), error)) return false;
  const auto is_relative = [](const std::string& path) {
    return !path.empty() && path.front() != '/' && path.find("://") == std::string::npos;
  };
  if (!is_folder(options.output) && file.files().size() > 1) return true;
  for (const exporting::XmlElement* element : file.elements()) {
    if (is_relative(element->value("file")) || is_relative(element->value("filename"))) return true;
    if (element->name == "uri" && is_relative(element->text)) return true;
  }
  return false;
}

nlohmann::json text_or_null(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

nlohmann::json numbers_or_null(const Eigen::Vector3d& vector) {
  nlohmann::json list = nlohmann::json::array();
  for (int i = 0; i < 3; ++i) list.push_back(text::finite_or_null(vector[i]));
  return list;
}

nlohmann::json to_json(const FingerContact& finger) {
  const ContactCurve& curve = finger.curve;
  const exporting::SoftContact& contact = finger.wanted.contact;
  nlohmann::json result = {
      {"finger", finger.name},
      {"usable", curve.nominal.assessment.usable},
      {"reason", text_or_null(curve.advice)},
      {"pressure_model", curve.model},
      {"contact", contact.face ? "patch" : "ellipse"},
      {"relative_radii_m",
       contact.face ? nlohmann::json() : nlohmann::json{curve.radii.major_m, curve.radii.minor_m}},
      {"corner_shape", text_or_null(finger.corner_shape)},
      {"max_torque_Nm", text::finite_or_null(curve.nominal.max_torque_Nm())},
      {"friction_coefficient", text::finite_or_null(contact.friction_coefficient)},
      {"eccentricity_m", text::finite_or_null(contact.eccentricity_m)},
      {"normal_stiffness_N_per_m", text::finite_or_null(curve.normal_stiffness_N_per_m)}};
  if (const ShapedFinger* shaped = finger.shaped.get()) {
    result["file"] = shaped->shape.element->file->where();
    result["line"] = shaped->shape.element->line;
    result["shape"] = shaped->shape_words;
    result["pad"] = shaped->pad_words;
    result["pad_is_guessed"] = shaped->is_guessed;
    result["pad_in_body_m"] = numbers_or_null(shaped->point_in_body_m);
  }
  return result;
}

nlohmann::json to_json(const ApplyOptions& options, const XmlFile& file, const Simulator& simulator,
                       const std::vector<FingerContact>& fingers, const Files& written,
                       const std::vector<std::string>& notes) {
  const ContactCurve& curve = fingers.front().curve;
  const exporting::SoftContact& contact = fingers.front().wanted.contact;
  const auto& errors = fingers.front().torque_errors;
  const auto& force_errors = fingers.front().force_errors;
  nlohmann::json changes = nlohmann::json::array(), loads = nlohmann::json::array(),
                 each = nlohmann::json::array(), outputs = nlohmann::json::array();
  for (const XmlFile* part : file.files())
    for (const XmlChange& change : part->changes())
      changes.push_back({{"file", part->where()},
                         {"line", change.line},
                         {"element", change.element},
                         {"name", change.name},
                         {"before", text_or_null(change.before)},
                         {"after", text_or_null(change.after)},
                         {"effect", change.effect}});
  double worst = 0;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const auto& point = curve.points[i];
    worst = std::max(worst, std::abs(errors[i]));
    loads.push_back({{"load_N", point.load_N},
                     {"max_torque_Nm", text::finite_or_null(point.max_torque_Nm())},
                     {"relative_error", text::finite_or_null(errors[i])},
                     {"force_relative_error", text::finite_or_null(force_errors[i])}});
  }
  for (const FingerContact& finger : fingers)
    if (!finger.name.empty()) each.push_back(to_json(finger));
  for (const auto& [path, text] : written) outputs.push_back(path.string());
  std::string reason;
  for (const FingerContact& finger : fingers)
    if (reason.empty()) reason = finger.curve.advice;
  return {{"model", options.model},
          {"usable", reason.empty()},
          {"reason", text_or_null(reason)},
          {"written", !written.empty()},
          {"format", exporting::name_of(format_of(file))},
          {"simulator", simulator.name},
          {"output", text_or_null(options.in_place ? options.model : options.output)},
          {"outputs", outputs},
          {"case", curve.case_id},
          {"fingers", each},
          {"pressure_model", curve.model},
          {"load_N", curve.nominal.load_N},
          {"load_range_N", {curve.points.front().load_N, curve.points.back().load_N}},
          {"friction_coefficient", text::finite_or_null(contact.friction_coefficient)},
          {"eccentricity_m", text::finite_or_null(contact.eccentricity_m)},
          {"normal_stiffness_N_per_m", text::finite_or_null(curve.normal_stiffness_N_per_m)},
          {"input_doubt", to_json(curve.nominal.inputs)},
          {"changes", changes},
          {"loads", loads},
          {"worst_relative_error", text::finite_or_null(worst)},
          {"notes", notes},
          {"traps", simulator.traps}};
}

/// The lines that begin an answer, one for each contact.
std::string answer_lines(const std::vector<FingerContact>& fingers) {
  std::string text;
  for (const FingerContact& finger : fingers)
    text += (fingers.size() > 1 ? finger.name + ": " : "") + answer_line(finger.curve);
  return text;
}

std::string radii_words(const RelativeRadii& radii) {
  return fmt::format("{:.4g} x {:.4g} mm", 1e3 * radii.major_m, 1e3 * radii.minor_m);
}

std::string shapes_text(const std::vector<FingerContact>& fingers) {
  std::string text;
  for (const FingerContact& finger : fingers)
    if (const ShapedFinger* shaped = finger.shaped.get())
      text += fmt::format("{}: {} ({}), pad {} mm, {}{}; {}; dP/dd {:.4g} N/mm\n", shaped->name,
                          shaped->shape_words, shaped->shape.element->where(),
                          prediction::in_millimetres(shaped->point_in_body_m), shaped->pad_words,
                          shaped->is_guessed ? " (guessed; --pad says another side)" : "",
                          finger.wanted.contact.face
                              ? std::string("flat")
                              : "radii of the gap " + radii_words(finger.curve.radii),
                          1e-3 * finger.curve.normal_stiffness_N_per_m);
  return text.empty() ? "" : text + "\n";
}

std::string to_text(const ApplyOptions& options, const XmlFile& file, const Simulator& simulator,
                    const std::vector<FingerContact>& fingers, const Files& files) {
  const ContactCurve& curve = fingers.front().curve;
  const bool is_shaped = fingers.front().shaped != nullptr;
  std::string text = fmt::format(
      "{} ({}) for {}{}\n\n", options.model, exporting::name_of(format_of(file)), simulator.title,
      is_shaped ? ""
                : fmt::format(", by the case {}; dP/dd {:.4g} N/mm", curve.case_id,
                              1e-3 * curve.normal_stiffness_N_per_m));
  text += shapes_text(fingers);
  const std::vector<const XmlFile*> parts = file.files();
  for (const XmlFile* part : parts) {
    if (part->changes().empty()) continue;
    if (parts.size() > 1) text += part->where() + "\n";
    for (const XmlChange& change : part->changes())
      text +=
          fmt::format("line {:<5} {}: {} {} -> {}{}\n", change.line, change.element, change.name,
                      change.before.empty() ? "-" : "\"" + text::shortened(change.before) + "\"",
                      change.after.empty() ? "-" : "\"" + change.after + "\"",
                      change.effect.empty() ? "" : "\n           " + change.effect);
  }
  if (!file.has_changes()) text += "Nothing had to be changed.\n";
  text += "\n";
  for (const auto trap : simulator.traps) text += fmt::format("- {}\n", trap);
  for (const auto& [path, content] : files) text += "Written: " + path.string() + "\n";
  if (files.empty()) text += "Nothing is written: --output FILE or --in-place does\n";
  return text + "The error: " + curve.nominal.assessment.evidence + "\n";
}

/// Whether the radii are those of MODEL's own shapes: no case is typed, and no radii.
bool takes_shapes(const ApplyOptions& options) {
  const CaseInput& typed = options.contact.typed_case;
  bool has_geometry = !typed.file.empty() || !typed.radii_mm.empty();
  for (const std::string& setting : typed.settings)
    has_geometry |= setting.rfind("geometry", 0) == 0;
  const bool has_layer = !options.shape.layer.empty() || !typed.thickness_mm.empty() ||
                         !typed.youngs_modulus_kPa.empty();
  const bool has_shape = !options.shape.pads.empty() || !options.shape.object_radius_mm.empty() ||
                         !options.shape.layer.empty() || !options.shape.cases.empty();
  if (has_geometry && has_shape)
    throw InputError("command line",
                     !options.shape.layer.empty()   ? "--layer"
                     : !options.shape.pads.empty()  ? "--pad"
                     : !options.shape.cases.empty() ? "--write-cases"
                                                    : "--object-radius-mm",
                     "", "neither CASE nor --radii-mm beside it: the radii are then MODEL's own");
  if (!has_geometry && !has_layer)
    throw InputError("command line", "CASE is missing", "",
                     "--layer THICKNESS_mm,E_kPa,NU with --load and --friction, by which the radii "
                     "are those of MODEL's own shapes; or a case file, the name of a built-in case "
                     "(softfinger list cases), \"-\", or --radii-mm and the other numbers; see "
                     "softfinger apply --help");
  return !has_geometry;
}

/// The contact of one case, as the simulator and the options want it.
FingerContact contact_of(const ApplyOptions& options, const Simulator& simulator,
                         const input::Case& contact_case, ContactCurve curve) {
  FingerContact finger;
  finger.curve = std::move(curve);
  exporting::RobotContact& wanted = finger.wanted;
  wanted.contact = soft_contact(finger.curve, simulator, options.contact.kind_of_fit());
  finger.torque_errors = relative_errors(simulator, wanted.contact, finger.curve);
  finger.force_errors = relative_force_errors(wanted.contact, finger.curve);
  wanted.torque_error = range_of(finger.torque_errors, finger.curve, "torque");
  wanted.force_error = range_of(finger.force_errors, finger.curve, "force");
  if (options.effective_mass_g > 0) wanted.effective_mass_kg = 1e-3 * options.effective_mass_g;
  if (options.depth_mm > 0) wanted.depth_m = 1e-3 * options.depth_mm;
  if (options.plugin)
    wanted.plugin = plugin_problem(options, contact_case, finger.curve.nominal.load_N);
  return finger;
}

/// The contact of a flat pad. The file's shape makes points at its own corners, unless the
/// simulator has a pressure.
/// @param parts  shapes of the finger
FingerContact pad_contact_of(const ApplyOptions& options, const Simulator& simulator,
                             exporting::RobotFormat format, const ShapedFinger& shaped,
                             std::size_t parts) {
  const auto refuse = [&](const char* option, const std::string& value, const char* allowed) {
    throw InputError("command line", option, value, allowed);
  };
  if (options.plugin) refuse("--plugin", "", "none for a flat pad: its e_n is one for all loads");
  if (!options.contact.model.empty())
    refuse("--model", options.contact.model, "none for a flat pad: pad_layer");
  const input::Case& pad_case = shaped.pad_case;
  const exporting::LoadRange loads = loads_of(pad_case, options.contact);
  const exporting::PadContact made =
      exporting::ask_pad_contact(pad_case, loads.nominal_N, options.contact.demand.demand());
  const exporting::PadFace& face = *made.contact.face;
  FingerContact finger;
  finger.curve = pad_curve(made, pad_case, loads);
  finger.wanted.contact = made.contact;
  const bool has_pressure = simulator.load_exponent > 0;
  // Points at corners, at the orientation that is worst for them.
  const bool in_pyramids = simulator.friction_is_pyramid;
  const exporting::PyramidTorque torque =
      in_pyramids ? exporting::corners_in_pyramids(face) : exporting::PyramidTorque();
  double error =
      has_pressure ? face.error_of_pressure() : (1 + face.error_of_points()) * torque.most - 1;
  const exporting::CornerShape corners = corner_shape(
      format, shaped.shape, *shaped.flat, in_pyramids ? exporting::face_in_pyramids(face) : face);
  if (options.shrink_pads) {
    if (has_pressure || corners.kind.empty() || parts != 1)
      throw InputError(shaped.shape.element->where(),
                       "--shrink-pads of \"" + text::shortened(shaped.name) + "\"", "",
                       has_pressure ? "none for " + std::string(simulator.title) +
                                          ", which has a pressure: export prints its box"
                       : parts != 1
                           ? "a --finger that is one box or cylinder"
                           : "a box or a cylinder; here it is another shape, " + corners.words);
    finger.wanted.corner_size = {corners.kind, corners.name, corners.value};
    error = torque.worst_error();
  }
  // Joined shapes have corners within the pad, too.
  const char* const up_to = shaped.flat->is_joined || in_pyramids ? "up to " : "";
  finger.torque_errors.assign(finger.curve.points.size(), error);
  finger.force_errors.assign(finger.curve.points.size(), 0);
  finger.wanted.torque_error =
      options.shrink_pads
          ? in_pyramids ? fmt::format("the torque is within ±{}", text::percent(error))
                        : std::string("the torque is exact")
          : fmt::format("{}{:+.0f} % of the torque, by {}", up_to, 100 * error,
                        has_pressure ? "the uniform pressure" : "the forces at its corners");
  finger.wanted.force_error = range_of(finger.force_errors, finger.curve, "force");
  if (in_pyramids) finger.wanted.force_error += " along the pyramid's directions, +41 % between";
  if (options.effective_mass_g > 0)
    finger.wanted.effective_mass_kg = 1e-3 * options.effective_mass_g;
  if (options.depth_mm > 0) finger.wanted.depth_m = 1e-3 * options.depth_mm;
  if (!has_pressure) finger.corner_shape = corners.words;
  if (shaped.flush > 0)
    remark(
        fmt::format("{}: {} more of its shapes end in the plane of the pad, which is {} alone: "
                    "together they touch over more, and hold more",
                    text::shortened(shaped.name), shaped.flush, shaped.shape_words));
  if (!has_pressure && !options.shrink_pads)
    remark(
        fmt::format("{}: flat: contact points at its own corners have {}{:.0f} % too much torque; "
                    "{} {}{}",
                    text::shortened(shaped.name), up_to, 100 * error,
                    in_pyramids ? "within ±" + text::percent(torque.worst_error()) + " is"
                                : std::string("exact is"),
                    corners.words, corners.kind.empty() ? "" : " (--shrink-pads)"));
  return finger;
}

std::vector<FingerContact> contacts_of(const ApplyOptions& options, const Simulator& simulator,
                                       const XmlFile& file, const exporting::Mjcf& mjcf) {
  std::vector<FingerContact> contacts;
  if (!takes_shapes(options)) {
    const input::Case contact_case = read_contact_case(options.contact);
    contacts.push_back(contact_of(options, simulator, contact_case,
                                  ask_contact_curve(contact_case, options.contact)));
    return contacts;
  }
  check_contact_choice(options.contact);
  const exporting::RobotFormat format = format_of(file);
  const exporting::RobotShapes shapes = read_shapes(file, format, mjcf);
  RobotMeshes meshes(options.is_standard_input() ? "" : options.model, format, shapes,
                     options.shape.package_paths);
  const std::vector<exporting::FingerParts> found = find_fingers(file, mjcf, options.fingers);
  auto fingers = shaped_fingers(shapes, found, options.shape, options.contact, meshes);
  if (options.contact.typed_case.friction.empty())
    remark("no --friction: a coefficient of 1 is taken, the torque is proportional to it");
  const auto with_flat_side = [&](const std::string& advice, const ShapedFinger& shaped,
                                  const exporting::FingerParts& parts) {
    if (advice.find("--pad") != std::string::npos) return advice;
    const std::string flat =
        flat_pad_in_words(shapes, parts, shaped, options.shape, options.contact, meshes);
    return flat.empty() ? advice : advice + "; " + flat;
  };
  // Fingers that are alike have one curve.
  std::map<std::pair<double, double>, ContactCurve> curves;
  for (std::size_t i = 0; i < fingers.size(); ++i) {
    std::unique_ptr<ShapedFinger>& shaped = fingers[i];
    const std::size_t parts = found[i].elements.size();
    if (shaped->is_guessed)
      remark(fmt::format("{}: the pad is guessed {}; --pad says another side",
                         text::shortened(shaped->name), shaped->pad_words));
    const auto add = [&](FingerContact finger) {
      finger.name = shaped->name;
      finger.shaped = std::move(shaped);
      contacts.push_back(std::move(finger));
    };
    if (shaped->is_surely_flat()) {
      add(pad_contact_of(options, simulator, format, *shaped, parts));
      continue;
    }
    const input::Case& contact_case = shaped->contact_case;
    const std::pair<double, double> radii =
        shaped->pad ? std::pair(shaped->pad->major_radius_m, shaped->pad->minor_radius_m)
                    : std::pair(0., 0.);
    auto known = shaped->pad ? curves.find(radii) : curves.end();
    if (known == curves.end()) {
      for (const std::string& line : contact_case.remarks) remark(line);
      try {
        known = curves.insert_or_assign(radii, ask_contact_curve(*shaped, options.contact)).first;
      } catch (const InputError& error) {
        if (!shaped->flat)
          throw InputError(error.where(), error.field(), error.value(),
                           with_flat_side(error.allowed(), *shaped, found[i]));
        add(pad_contact_of(options, simulator, format, *shaped, parts));
        continue;
      }
    }
    ContactCurve curve = known->second;
    if (!curve.nominal.assessment.usable && shaped->flat) {
      add(pad_contact_of(options, simulator, format, *shaped, parts));
      continue;
    }
    if (!curve.nominal.assessment.usable)
      curve.advice = with_flat_side(curve.advice, *shaped, found[i]);
    curve.case_id = contact_case.id;
    require_on_one_part(*shaped, curve);
    add(contact_of(options, simulator, contact_case, std::move(curve)));
  }
  return contacts;
}

bool all_usable(const std::vector<FingerContact>& fingers) {
  return std::all_of(fingers.begin(), fingers.end(), [](const FingerContact& finger) {
    return finger.curve.nominal.assessment.usable;
  });
}

std::string lines_of(const Simulator& simulator, const exporting::SoftContact& contact) {
  return (contact.face ? exporting::box_lines : exporting::point_lines)(simulator, contact).text;
}

/// Writes a case of each finger's own shape, usable or not: it can be looked at.
void write_cases(const ApplyOptions& options, const std::vector<FingerContact>& fingers) {
  if (options.shape.cases.empty()) return;
  for (const std::string& setting : options.contact.typed_case.settings)
    if (setting.rfind("contact.", 0) != 0)
      throw InputError("command line", "--set", setting,
                       "none but contact's keys beside --write-cases: the case file can be edited");
  const fs::path folder = options.shape.cases;
  system::make_writable_folder(folder);
  Files files;
  for (const FingerContact& finger : fingers) {
    const ShapedFinger& shaped = *finger.shaped;
    const bool is_flat = finger.wanted.contact.face.has_value();
    const std::string& name = (is_flat ? shaped.pad_case : shaped.contact_case).id;
    files.emplace_back(folder / (name + ".toml"), case_text(shaped, is_flat, name));
    if (!is_flat && !shaped.stl.empty()) files.emplace_back(folder / (name + ".stl"), shaped.stl);
  }
  system::write_files_together(files);
  for (const auto& [path, text] : files)
    if (path.extension() == ".toml") remark("written: " + path.string());
}

/// Prints the lines to type for a simulator that reads no friction from such a file.
int print_lines(const ApplyOptions& options, const Simulator& simulator, const XmlFile& file) {
  if (!options.output.empty() || options.in_place) require_reader(file, simulator);
  const std::vector<FingerContact> fingers =
      contacts_of(options, simulator, file, exporting::Mjcf(file));
  write_cases(options, fingers);
  const bool usable = all_usable(fingers);
  if (options.json) {
    nlohmann::json result = to_json(options, file, simulator, fingers, {}, {});
    for (std::size_t i = 0; i < fingers.size() && !fingers.front().name.empty(); ++i)
      result["fingers"][i]["lines"] =
          usable || options.contact.force
              ? nlohmann::json(lines_of(simulator, fingers[i].wanted.contact))
              : nlohmann::json();
    system::write_to_stdout(text::printed(result));
    return usable ? 0 : 1;
  }
  std::string text = answer_lines(fingers);
  if (usable || options.contact.force) {
    text += fmt::format(
        "{} reads no friction from {}: save the model as MJCF, and apply the same to that, or type "
        "there\n\n",
        simulator.title, exporting::name_of(format_of(file)));
    text += shapes_text(fingers);
    for (const FingerContact& finger : fingers)
      text += (finger.name.empty() ? "" : finger.name + "\n") +
              lines_of(simulator, finger.wanted.contact) + "\n";
    text += "Nothing is written.\n";
  } else {
    text += kHowToForce;
  }
  system::write_text_to_stdout(text);
  return usable ? 0 : 1;
}

std::unique_ptr<XmlFile> read_model(const ApplyOptions& options) {
  const auto read = [&](const fs::path& path) {
    return options.in_place ? system::read_file_to_rewrite(path, kMostBytes)
                            : system::read_text_file(path, kMostBytes);
  };
  if (options.is_standard_input())
    return exporting::read_with_included_files(system::read_standard_input(kMostBytes),
                                               "standard input", "", read);
  return exporting::read_with_included_files(read(options.model), options.model, options.model,
                                             read);
}

/// The written files must read back as a model in which nothing is left to change.
void require_settled(const ApplyOptions& options, const XmlFile& file, const Simulator& simulator,
                     const std::vector<exporting::RobotContact>& wanted) {
  std::map<std::string, std::string> texts;
  for (const XmlFile* part : file.files()) texts[part->where()] = part->text();
  const auto again = exporting::read_with_included_files(
      texts.at(file.where()), file.where(), options.is_standard_input() ? "" : options.model,
      [&](const fs::path& path) { return texts.at(path.string()); });
  apply_contact(*again, options.fingers, simulator, wanted);
  if (again->has_changes())
    throw InputError(options.model, "the changed file does not read back", "",
                     "elements that are written once");
}

int run_apply(const ApplyOptions& options) {
  const Simulator& simulator = simulator_by_name(options.to);
  check_output(options);
  const bool is_mujoco = simulator.name == "mujoco";
  if (!is_mujoco && (options.plugin || options.effective_mass_g > 0))
    throw InputError("command line", options.plugin ? "--plugin" : "--effective-mass-g", "",
                     "with --to mujoco");
  if (options.is_standard_input() && options.contact.typed_case.file == "-")
    throw InputError("command line", "CASE", "\"-\"",
                     "a file or a built-in case, as MODEL is standard input");
  const std::unique_ptr<XmlFile> model = read_model(options);
  XmlFile& file = *model;
  if (is_mujoco && format_of(file) != exporting::RobotFormat::mjcf)
    return print_lines(options, simulator, file);
  require_reader(file, simulator);
  const std::vector<FingerContact> fingers =
      contacts_of(options, simulator, file, exporting::Mjcf(file));
  write_cases(options, fingers);
  std::vector<exporting::RobotContact> wanted;
  for (const FingerContact& finger : fingers) wanted.push_back(finger.wanted);
  const std::vector<std::string> notes = apply_contact(file, options.fingers, simulator, wanted);
  require_settled(options, file, simulator, wanted);
  const bool usable = all_usable(fingers), allowed = usable || options.contact.force;
  const Files files = allowed ? files_to_write(options, file) : Files();
  if (!files.empty()) write(options, files);
  for (const std::string& note : notes) remark(options.model + ": " + note);
  if (!files.empty() && leaves_files_behind(file, options))
    remark(options.output +
           ": the file names others by relative paths, which do not lie in its folder");
  if (options.json)
    system::write_to_stdout(
        text::printed(to_json(options, file, simulator, fingers, files, notes)));
  else
    system::write_text_to_stdout(
        answer_lines(fingers) +
        (allowed ? to_text(options, file, simulator, fingers, files) : std::string(kHowToForce)));
  return usable ? 0 : 1;
}

}  // namespace

void add_apply(CLI::App& app, Action& action) {
  auto options = std::make_shared<ApplyOptions>();
  CLI::App* command = app.add_subcommand(
      "apply",
      "Writes a contact's friction into a copy of a robot's model: MJCF, URDF or SDF. Lists each "
      "change with its error over the loads; the rest of the file keeps its bytes");
  command
      ->add_option("MODEL", options->model, "MJCF, URDF or SDF file, or \"-\" for standard input")
      ->required();
  add_case(*command, options->contact.typed_case, true);
  command
      ->add_option("--finger", options->fingers,
                   "MJCF: a geom, or a body for all its geoms that touch others; URDF, SDF: a "
                   "collision, a link for all its collisions, LINK::COLLISION or "
                   "MODEL::LINK::COLLISION; may be repeated")
      ->required()
      ->allow_extra_args(false);
  command
      ->add_option(
          "--to", options->to,
          "mujoco for MJCF; gazebo (Classic, with ODE), drake (hydroelastic) or bullet for "
          "URDF and SDF")
      ->required();
  command->add_option("-o,--output", options->output,
                      "the file to write; a folder, such as copy/: MODEL and all files that it "
                      "includes; none: the changes are listed and nothing is written");
  command->add_flag("--in-place", options->in_place,
                    "write MODEL itself, and each file that it includes and that changes");
  add_shape_choice(*command, options->shape);
  add_contact_choice(*command, options->contact);
  command->add_flag("--plugin", options->plugin,
                    "MuJoCo: also list the geoms for libsoftfinger_mujoco, with which the torque "
                    "follows the load");
  command->add_flag("--shrink-pads", options->shrink_pads,
                    "flat pads that are a box or a cylinder: shrinks the shape, once, until the "
                    "forces at its corners have the pad's torque");
  command
      ->add_option(
          "--effective-mass-g", options->effective_mass_g,
          "MuJoCo: mass that the contact moves, in g (a free object between heavy fingers: "
          "its own), for a solref with the model's normal stiffness")
      ->check(CLI::Range(1e-3, 1e6));
  command
      ->add_option("--depth-mm", options->depth_mm,
                   "Drake: depth of the fingertip's innermost point in mm; default: that of its "
                   "shape; meshes need it")
      ->check(CLI::Range(1e-3, 1e4));
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "The contact is that of a case, or without one that of each finger's own shape in MODEL\n"
      "(sphere, capsule, cylinder, ellipsoid, box, mesh) at its pad: each finger has its own e_n, "
      "which\n"
      "is constant, and exact at the nominal load. A flat pad (a box's face, a cylinder's end, a "
      "flat of\n"
      "a mesh) gets no torsional friction: its corners' forces carry the torque, too much of it "
      "unless\n"
      "the shape is the one that is named (docs/flat_pads.md). A line on a plane is refused. "
      "MuJoCo reads no friction from URDF and SDF: the lines to type are printed.\n"
      "What MJCF includes is read, and changed where the geom stands: by --in-place, or in the "
      "copy\n"
      "of all files that an --output folder gets; one --output file cannot hold such a change.\n"
      "A DOCTYPE is refused, files are together at most 20 MB. Meshes are STL, OBJ,\n"
      "DAE, GLB, glTF, PLY or 3MF.\n"
      "Samples:\n"
      "  softfinger apply hand.xml silicone_pad_2mm --finger tip_1 --finger tip_2 --to mujoco -o "
      "soft.xml\n"
      "  softfinger apply hand.xml silicone_pad_2mm --finger tip_1 --to mujoco --plugin --output "
      "soft.xml --json\n"
      "  softfinger apply hand.xml --finger tip_1 --pad +z --layer 2,300,0.49 --friction 0.8 "
      "--load 2 "
      "--to mujoco");
  command->callback([options, &action] { action = [options] { return run_apply(*options); }; });
}

}  // namespace softfinger::commands
