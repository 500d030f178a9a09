#include "comparisons/reference/pad_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

#include "comparisons/reference/finished_results.h"
#include "comparisons/reference/reference_result.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::reference {
namespace {

using nlohmann::json;

json pair_json(const Eigen::Vector2d& pair) { return {pair.x(), pair.y()}; }

/// @param inset_m  by which the outline lies further inside
json shape_json(const input::FlatFigure& figure, double inset_m) {
  return std::visit(
      [&](const auto& shape) -> json {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, input::DiscFigure>) {
          return {{"shape", "disc"}, {"radius_m", shape.diameter_m / 2 - inset_m}};
        } else if constexpr (std::is_same_v<Shape, input::RectangleFigure>) {
          return {{"shape", "rectangle"},
                  {"lengths_m", {shape.length_m - 2 * inset_m, shape.width_m - 2 * inset_m}},
                  {"corner_radius_m", std::max(0.0, shape.corner_radius_m - inset_m)}};
        } else {
          const ConvexOutline typed = ConvexOutline::polygon(shape.points_m);
          const auto inner = inset_m > 0 ? typed.shrunk(inset_m) : typed;
          json points = json::array();
          if (inner)
            for (const Eigen::Vector2d& point : inner->vertices_m())
              points.push_back(pair_json(point));
          return {{"shape", "polygon"}, {"points_m", points}};
        }
      },
      figure);
}

/// Numbers of an object that have to be there and finite.
class Numbers {
 public:
  explicit Numbers(const json& object) : object_(object) {}

  double operator()(const char* key) { return checked(object_.value(key, json()), key); }
  /// For what others are divided by.
  double positive(const char* key) { return checked_positive(object_.value(key, json()), key); }
  std::array<double, 2> positive_pair(const char* key) {
    const json both = object_.value(key, json());
    if (!both.is_array() || both.size() != 2) return {checked({}, key), 0};
    return {checked_positive(both[0], key), checked_positive(both[1], key)};
  }
  std::array<std::optional<double>, 2> pair_or_none(const char* key) {
    std::array<std::optional<double>, 2> result;
    const json both = object_.value(key, json());
    if (both.is_array() && both.size() == 2)
      for (std::size_t i = 0; i < 2; ++i)
        if (!both[i].is_null()) result[i] = checked(both[i], key);
    return result;
  }
  std::vector<double> list(const char* key) {
    const json all = object_.value(key, json());
    std::vector<double> numbers;
    if (!all.is_array()) checked({}, key);
    for (const json& one : all) numbers.push_back(checked(one, key));
    return numbers;
  }
  const std::string& flaw() const { return flaw_; }

 private:
  double checked(const json& value, const char* key) {
    if (value.is_number() && std::isfinite(value.get<double>())) return value.get<double>();
    if (flaw_.empty()) flaw_ = std::string(key) + " is not a finite number";
    return 0;
  }
  double checked_positive(const json& value, const char* key) {
    const double number = checked(value, key);
    if (flaw_.empty() && !(number > 0)) flaw_ = std::string(key) + " is not positive";
    return number;
  }

  const json& object_;
  std::string flaw_;
};

json object_under(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_object() ? *found : json::object();
}

/// A number, or the largest of a pair.
std::optional<double> stated_error(const json& errors, const char* key) {
  const json value = errors.value(key, json());
  std::optional<double> largest;
  for (const json& one : value.is_array() ? value : json::array({value})) {
    if (!one.is_number() || !std::isfinite(one.get<double>())) return std::nullopt;
    largest = std::max(largest.value_or(0), one.get<double>());
  }
  return largest;
}

PadElementErrors errors_of(const json& stated, bool is_stuck) {
  return {stated_error(stated, "indentation"),
          stated_error(stated, "normal_stiffness"),
          stated_error(stated, "peak_pressure_inside"),
          stated_error(stated, "pressure_arm"),
          stated_error(stated, "max_torque"),
          stated_error(stated, is_stuck ? "tilt_stiffness_free_to_slide" : "tilt_stiffness")};
}

PadSolution solution_of(FemDocument given) {
  if (!given.failure.empty()) return {std::nullopt, given.failure, given.exit_status};
  ReadPadElements read = read_pad_elements(given.document);
  if (read.elements) return {std::move(read.elements), "", 0};
  return {std::nullopt, "softfinger-fem gave no result to believe: " + read.flaw, kNotConverged};
}

/// The block that is meshed. A roller's sleeve is cut where it no longer feels the contact, which
/// is nowhere wider than Hertz's on a half-space.
json block_json(const input::Case& contact_case, double load_N) {
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  if (!pair.is_roller) return shape_json(pair.finger.figure, pair.finger.edge_radius_m);
  const ElasticLayer& layer = contact_case.layer;
  auto sides = std::get<input::RectangleFigure>(pair.finger.figure);
  const double modulus_Pa =
      layer.youngs_modulus_Pa / (1 - layer.poisson_ratio * layer.poisson_ratio);
  const double hertz_m =
      std::sqrt(4 / kPi * load_N / sides.length_m * pair.curved->radius_y_m / modulus_Pa);
  constexpr double kBeyond = 4;  // thicknesses
  sides.width_m = std::min(sides.width_m, 2 * (hertz_m + kBeyond * layer.thickness_m));
  return shape_json(sides, 0);
}

std::string outcome_of(const PadSolution& solution) {
  if (!solution.elements) return "FEM failed: " + solution.failure;
  const PadElements& pad = *solution.elements;
  return fmt::format("{:.0f} unknowns, torque ±{}, {:.1f} s", pad.unknowns,
                     text::percent(pad.error.max_torque.value_or(kNaN)), pad.wall_s);
}

}  // namespace

ReadPadElements read_pad_elements(const json& document) {
  if (!document.is_object()) return {std::nullopt, "it is no object"};
  Numbers number(document);
  PadElements pad;
  const bool is_stuck = document.value("pressing", json()) == "stuck";
  pad.load_N = number.positive("load_N");
  pad.indentation_m = number.positive("indentation_m");
  pad.normal_stiffness_N_per_m = number.positive("normal_stiffness_N_per_m");
  pad.area_m2 = number.positive("area_m2");
  pad.peak_pressure_Pa = number.positive("peak_pressure_inside_Pa");
  pad.pressure_arm_m = number.positive("pressure_arm_m");
  pad.eccentricity_m = number.positive("eccentricity_m");
  pad.max_torque_Nm = number.positive("max_torque_Nm");
  pad.torsional_stiffness_Nm_per_rad = number("torsional_stiffness_Nm_per_rad");
  pad.lifted_share = number("lifted_share");
  pad.tilt_stiffness_Nm_per_rad = number.positive_pair(
      is_stuck ? "tilt_stiffness_free_to_slide_Nm_per_rad" : "tilt_stiffness_Nm_per_rad");
  pad.tilt_limit_Nm =
      number.pair_or_none(is_stuck ? "tilt_limit_free_to_slide_Nm" : "tilt_limit_Nm");
  // Under a curved object nothing sticks, so that nothing resists a shear.
  if (document.contains("contact_half_lengths_m"))
    pad.contact_half_lengths_m = number.positive_pair("contact_half_lengths_m");
  else
    pad.tangential_stiffness_N_per_m = number.positive_pair("shear_stiffness_N_per_m");
  pad.unknowns = number("unknowns");
  pad.wall_s = number("wall_s");
  pad.peak_memory_MB = number("peak_memory_MB");
  const json pressure = object_under(document, "pressure");
  Numbers sample(pressure);
  pad.pressure = {sample.list("x_m"), sample.list("y_m"), sample.list("pressure_Pa")};
  const std::size_t samples = pad.pressure.x_m.size();
  if (!number.flaw().empty()) return {std::nullopt, number.flaw()};
  if (!sample.flaw().empty()) return {std::nullopt, "pressure: " + sample.flaw()};
  if (pad.pressure.y_m.size() != samples || pad.pressure.pressure_Pa.size() != samples)
    return {std::nullopt, "pressure: places and pressures are not of the same number"};
  pad.error = errors_of(object_under(document, "error"), is_stuck);
  pad.document = document;
  return {std::move(pad), ""};
}

bool is_trusted(const PadElements& elements) {
  const auto is_within = [](const std::optional<double>& error) {
    return error && *error <= kTrustLimits.indentation_and_torque;
  };
  return is_within(elements.error.indentation) && is_within(elements.error.max_torque);
}

json to_json(const PadElements& pad, const input::Case& contact_case) {
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  json points = json::array(), limits = json::array();
  for (const Eigen::Vector2d& vertex : pair.contact.vertices_m())
    points.push_back(pair_json(vertex));
  for (const auto& limit : pad.tilt_limit_Nm) limits.push_back(limit ? json(*limit) : json());
  const bool is_curved = pair.curved.has_value();
  const bool is_line = is_curved && pair.curved->is_cylinder();
  json result = {
      {"load_N", pad.load_N},
      {"model", "fem"},
      {"contact", is_line ? "line" : "patch"},
      {"a_m", is_curved ? json(pad.contact_half_lengths_m[0]) : json()},
      {"b_m", is_curved ? json(pad.contact_half_lengths_m[1]) : json()},
      {"axis_rad", is_curved ? json(0) : json()},
      {"area_m2", pad.area_m2 * (1 - pad.lifted_share)},
      {"outline_m", points},
      {"geometry", is_curved ? "curved" : "flat"},
      {"kinematics", "linear"},
      {"pressing", pair.pressing == PadPressing::stuck ? "stuck" : "frictionless"},
      {"indentation_m", pad.indentation_m},
      {"normal_stiffness_N_per_m", pad.normal_stiffness_N_per_m},
      {"peak_pressure_Pa", pad.peak_pressure_Pa},
      {"pressure_arm_m", pad.pressure_arm_m},
      {"eccentricity_m", pad.eccentricity_m},
      {"max_force_N", contact_case.shear_law.friction_coefficient * pad.load_N},
      {"max_torque_Nm", pad.max_torque_Nm},
      {"tilt_limit_Nm", limits},
      {"tilt_stiffness_Nm_per_rad", pad.tilt_stiffness_Nm_per_rad},
      {"torsional_stiffness_Nm_per_rad",
       is_curved ? json() : json(pad.torsional_stiffness_Nm_per_rad)},
      {"tangential_stiffness_N_per_m",
       is_curved ? json::array({nullptr, nullptr}) : json(pad.tangential_stiffness_N_per_m)},
      {"lifted_share", pad.lifted_share},
      {"error", object_under(pad.document, "error")},
      {"unknowns", pad.unknowns},
      {"wall_s", pad.wall_s},
      {"peak_memory_MB", pad.peak_memory_MB}};
  if (const auto surface = pad.document.find("limit_surface"); surface != pad.document.end())
    result["limit_surface"] = *surface;
  return result;
}

json pad_problem(const input::Case& contact_case, double load_N, int level, int limit_surface) {
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  json face;
  // A face that covers the pad is a plane to it.
  if (pair.object.figure && pair.covered < 1)
    face = {{"outline", shape_json(*pair.object.figure, 0)},
            {"offset_m", pair_json(pair.offset_m)},
            {"angle_rad", pair.angle_rad}};
  json object;
  if (pair.curved) {
    const auto radius = [](double radius_m) {
      return std::isinf(radius_m) ? json() : json(radius_m);
    };
    object = {{"radii_m", {radius(pair.curved->radius_x_m), radius(pair.curved->radius_y_m)}},
              {"offset_m", pair_json(pair.offset_m)}};
  }
  return {{"name", contact_case.id},
          {"pad",
           {{"outline", block_json(contact_case, load_N)},
            {"edge_radius_m", pair.finger.edge_radius_m},
            {"thickness_m", contact_case.layer.thickness_m},
            {"youngs_modulus_Pa", contact_case.layer.youngs_modulus_Pa},
            {"poisson_ratio", contact_case.layer.poisson_ratio}}},
          {"face", face},
          {"object", object},
          {"pressing", pair.pressing == PadPressing::stuck ? "stuck" : "frictionless"},
          {"load_N", load_N},
          {"load_point_m", pair.load_at_m ? pair_json(*pair.load_at_m) : json()},
          {"friction_coefficient", contact_case.shear_law.friction_coefficient},
          {"friction", limit_surface > 0 ? json{{"limit_surface", limit_surface}} : json()},
          {"level", level}};
}

std::optional<std::string> elements_remark(const input::Case& contact_case) {
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  constexpr double kLeastFillet = 0.05;
  const double edge_m = pair.finger.edge_radius_m;
  if (!(edge_m > 0)) return {};
  if (pair.covered < 1)
    return "edge_radius_mm: beside a smaller face the elements' block has the outline of the flat "
           "face, without the fillet around it";
  if (edge_m <= kLeastFillet * contact_case.layer.thickness_m)
    return "edge_radius_mm: a fillet below a twentieth of the thickness is left out by the "
           "elements";
  return {};
}

std::optional<std::string> elements_refusal(const input::Case& contact_case) {
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  constexpr std::size_t kMostCorners = 12;
  constexpr double kInside = 0.05;  // of the thickness
  for (const input::FlatFigure* figure :
       {&pair.finger.figure, pair.object.figure ? &*pair.object.figure : nullptr})
    if (const auto* outline = figure ? std::get_if<input::OutlineFigure>(figure) : nullptr;
        outline && outline->points_m.size() > kMostCorners)
      return "the elements take outlines of at most 12 corners";
  if (pair.covered == 1) return std::nullopt;
  const auto inner = pair.pad.shrunk(kInside * contact_case.layer.thickness_m);
  const auto& corners = pair.contact.vertices_m();
  const bool is_inside = inner && std::all_of(corners.begin(), corners.end(),
                                              [&](const auto& at) { return inner->contains(at); });
  const auto has_sharp_sides = [](const input::FlatFigure& figure, double edge_radius_m) {
    const auto* rectangle = std::get_if<input::RectangleFigure>(&figure);
    return rectangle && rectangle->corner_radius_m <= edge_radius_m;
  };
  constexpr double kStraight = 1e-9;
  const bool crosses_straight = has_sharp_sides(pair.finger.figure, pair.finger.edge_radius_m) &&
                                has_sharp_sides(*pair.object.figure, 0) &&
                                std::abs(std::sin(2 * pair.angle_rad)) < kStraight;
  if (is_inside || crosses_straight) return std::nullopt;
  return "where a face's edge crosses the pad's outline, or comes nearer to it than a twentieth of "
         "the thickness, the elements take rectangles with parallel sides and sharp corners only";
}

double expected_pad_s(const input::Case& contact_case) {
  // Times of levels 1 to 3 are measured, but those of level 3 for polygons and smaller faces
  // guessed. A quarter is meshed where pad and face have two planes of symmetry.
  constexpr std::array<double, 3> kQuarter_s = {0.7, 2.3, 30}, kPolygon_s = {1.5, 5, 60},
                                  kSmallerFace_s = {2.3, 20, 200};
  const auto& pair = std::get<input::PadPair>(contact_case.geometry);
  const auto level = std::size_t(contact_case.fem_level - 1);
  const auto is_polygon = [](const input::FlatFigure& figure) {
    return std::holds_alternative<input::OutlineFigure>(figure);
  };
  const bool has_face = pair.object.figure && pair.covered < 1;
  const bool is_centred = pair.offset_m.isZero() && pair.angle_rad == 0;
  if (has_face && (!is_centred || is_polygon(*pair.object.figure))) return kSmallerFace_s[level];
  return is_polygon(pair.finger.figure) ? kPolygon_s[level] : kQuarter_s[level];
}

int run_pads(const std::string& program, const std::vector<FemDocuments>& batches, int parallel,
             const PadCallbacks& callbacks) {
  FemDocumentCallbacks of_documents;
  of_documents.on_line = callbacks.on_line;
  of_documents.on_answer = [&](FemIndex index, FemDocument given) {
    callbacks.on_solution(index, solution_of(std::move(given)));
  };
  return run_fem_documents(program, batches, parallel, of_documents);
}

ReadPadElements finished_pad(const PadJob& job, const FemJobOptions& options) {
  ReadPadElements read;
  FinishedDocument finished =
      read_finished_document(job.file, options.identity, job.problem, [&](const json& result) {
        read = read_pad_elements(result);
        return read.flaw;
      });
  if (finished.result.is_null()) return {std::nullopt, std::move(finished.flaw)};
  return read;
}

int run_pad_jobs(const std::vector<PadJob>& jobs, const FemJobOptions& options,
                 system::Progress& progress,
                 const std::function<void(const PadJob&, PadSolution)>& on_solution) {
  std::vector<FemDocuments> batches;
  std::vector<std::vector<const PadJob*>> jobs_of;  // per batch
  std::size_t done = 0;
  for (const PadJob& job : jobs) {
    ReadPadElements finished = finished_pad(job, options);
    if (finished.elements) {
      progress.say(fmt::format("[{}/{}] {}: reused", ++done, jobs.size(), job.title));
      on_solution(job, {std::move(finished.elements), "", 0});
      continue;
    }
    if (!finished.flaw.empty())
      progress.say(fmt::format("softfinger: {}: made again, it cannot be used: {}",
                               job.file.string(), finished.flaw));
    // It answers another problem, and must not be taken for this job's result.
    std::error_code ignored;
    std::filesystem::remove(job.file, ignored);
    if (batches.empty() || jobs_of.back().back()->group != job.group) {
      batches.push_back({{}, options.single_thread, options.limits});
      jobs_of.emplace_back();
    }
    batches.back().problems.push_back(job.problem);
    jobs_of.back().push_back(&job);
  }
  const auto job_at = [&](FemIndex index) -> const PadJob& {
    return *jobs_of[index.batch][index.problem];
  };
  PadCallbacks callbacks;
  callbacks.on_line = [&](FemIndex index, const std::string& line) {
    progress.show(fmt::format("[{}/{}] {}: {}", done, jobs.size(), job_at(index).title, line));
  };
  callbacks.on_solution = [&](FemIndex index, PadSolution solution) {
    const PadJob& job = job_at(index);
    if (solution.elements)
      write_finished_document(job.file, options.identity, job.problem, solution.elements->document);
    progress.say(
        fmt::format("[{}/{}] {}: {}", ++done, jobs.size(), job.title, outcome_of(solution)));
    on_solution(job, std::move(solution));
  };
  return run_pads(options.program, batches, options.parallel, callbacks);
}

}  // namespace softfinger::reference
