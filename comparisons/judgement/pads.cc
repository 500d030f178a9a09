#include "comparisons/judgement/pads.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "comparisons/judgement/assessment.h"
#include "comparisons/judgement/reason.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/mesh_points.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::judgement {
namespace {

using Eigen::Vector3d;
using input::MeshRole;
using prediction::FlatFace;
using prediction::LocalGeometry;
using prediction::TorqueRule;

/// The surface within a distance of a point, and whether that is all of it.
struct NearPart {
  std::shared_ptr<const TriangleSurface> surface;
  bool is_all = false;
};

NearPart part_of(const TriangleSurface& surface, const std::vector<double>& distances_m,
                 double radius_m) {
  TriangleSurface part;
  std::vector<int> numbers(surface.vertices_m.size(), -1);
  for (const std::array<int, 3>& triangle : surface.triangles) {
    const auto is_near = [&](int corner) { return distances_m[std::size_t(corner)] <= radius_m; };
    if (std::none_of(triangle.begin(), triangle.end(), is_near)) continue;
    std::array<int, 3> kept = triangle;
    for (int& corner : kept) {
      int& number = numbers[std::size_t(corner)];
      if (number < 0) {
        number = int(part.vertices_m.size());
        part.vertices_m.push_back(surface.vertices_m[std::size_t(corner)]);
      }
      corner = number;
    }
    part.triangles.push_back(kept);
  }
  const bool is_all = part.triangles.size() == surface.triangles.size();
  return {std::make_shared<const TriangleSurface>(std::move(part)), is_all};
}

input::Case case_of(const Pressing& pressing, MeshRole role, const input::CaseBody& touched) {
  input::Case contact;
  contact.id = "pad";
  contact.geometry_where = "mesh";
  contact.layer = pressing.layer;
  contact.loads_N = {pressing.load_N};
  contact.shear_law.friction_coefficient = pressing.friction_coefficient;
  input::BodyPair pair;
  if (role == MeshRole::finger) {
    pair.finger = touched;
    pair.object = input::QuadricBody{kInfinity, kInfinity};
  } else {
    pair.finger = input::QuadricBody{pressing.ball_radius_m, pressing.ball_radius_m};
    pair.object = touched;
  }
  contact.geometry = pair;
  return contact;
}

void assess_place(Pad& pad, const input::Case& contact, const LocalGeometry& geometry,
                  const Pressing& pressing) {
  const PressureModel& model =
      default_model(prediction::contact_problem(contact, geometry, pressing.load_N));
  prediction::ModelAnswer answer = ask_model(model, contact, geometry, pressing.load_N);
  if (geometry.patch) prediction::propagate_radii_uncertainty(geometry.patch->relative, answer);
  answer.assessment = assess_numbers(contact, geometry, answer, TorqueRule::exact, pressing.demand);
  const double worst = worst_of(answer.assessment->totals(), pressing.demand.quantities);
  pad.worst = std::isfinite(worst) ? worst : kInfinity;
  if (!answer.assessment->usable) pad.reason = reason_not_usable(answer, pressing.demand);
  pad.answer = std::move(answer);
}

/// Presses a place of a curved part.
void press(Pad& pad, const TriangleSurface& surface, MeshRole role, const Pressing& pressing,
           const std::optional<Vector3d>& normal) {
  constexpr std::size_t kVertices = 400;
  std::vector<double> distances_m;
  distances_m.reserve(surface.vertices_m.size());
  for (const Vector3d& vertex : surface.vertices_m)
    distances_m.push_back((vertex - pad.point_m).norm());
  std::vector<double> sorted = distances_m;
  const auto nth = sorted.begin() + std::ptrdiff_t(std::min(kVertices, sorted.size() - 1));
  std::nth_element(sorted.begin(), nth, sorted.end());
  double radius_m = *nth;
  constexpr int kMostParts = 4;
  for (int attempt = 0; attempt < kMostParts; ++attempt) {
    const NearPart part = part_of(surface, distances_m, radius_m);
    input::MeshBody mesh;
    mesh.where = "mesh";
    mesh.metres_per_unit = 1e-3;
    mesh.point_m = pad.point_m;
    mesh.normal = normal;
    const input::Case contact = case_of(pressing, role, mesh);
    const prediction::GeometryResolver resolver(contact, part.surface);
    const LocalGeometry geometry = resolver.resolve(pressing.load_N);
    // A region of 1.25 times the radius is looked at, too.
    constexpr double kWithin = 1.5, kLarger = 2.5;
    const double region_m = std::sqrt(geometry.patch->region_area_m2 / kPi);
    if (!part.is_all && attempt + 1 < kMostParts && kWithin * region_m > radius_m) {
      radius_m = kLarger * region_m;
      continue;
    }
    pad.fit = role == MeshRole::finger ? geometry.patch->finger_fit : geometry.patch->object_fit;
    pad.normal = pad.fit->normal;
    assess_place(pad, contact, geometry, pressing);
    return;
  }
}

/// An object's flat face, pressed by the ball.
void press_face(Pad& pad, const Pressing& pressing) {
  const input::Case contact =
      case_of(pressing, MeshRole::object, input::QuadricBody{kInfinity, kInfinity});
  const prediction::GeometryResolver resolver(contact);
  assess_place(pad, contact, resolver.resolve(pressing.load_N), pressing);
  if (pad.is_usable() && !(pad.answer->prediction.a_m <= pad.face->room_m)) {
    pad.answer->assessment->usable = false;
    pad.reason = "the face is narrower than the contact";
  }
}

std::string kind_of(const Pad& pad, MeshRole role, double width_m) {
  if (pad.face)
    return pad.face->is_ring()                                  ? "rim"
           : role == MeshRole::object && pad.face->is_outermost ? "base"
                                                                : "flat";
  const bool is_object = role == MeshRole::object;
  const char* const edge = is_object ? "rim" : "edge";
  if (!pad.fit) return edge;
  constexpr double kSharp = 0.06, kLong = 3;
  // The smaller one first; negative where the surface is hollow.
  const auto& radii_m = pad.fit->principal.radii_m;
  const double along_per_m = 1 / radii_m[0], across_per_m = 1 / radii_m[1];
  if (pad.fit->surface_kind == SurfaceKind::sharp_edge || across_per_m * kSharp * width_m > 1)
    return edge;
  if (-along_per_m > std::abs(across_per_m)) return "hollow";
  if (kLong * along_per_m < -across_per_m) return "saddle";
  if (kLong * along_per_m < across_per_m) return is_object ? "wall" : "barrel";
  return "dome";
}

/// A place on the surface, with the side that it faces.
struct Spot {
  Vector3d point, normal;
};

/// Spots spread over the surface by area.
std::vector<Spot> spread(const TriangleSurface& surface, double area_m2, std::size_t count) {
  std::vector<Spot> spots;
  double passed = 0;
  for (const std::array<int, 3>& triangle : surface.triangles) {
    const auto corner = [&](std::size_t c) -> const Vector3d& {
      return surface.vertices_m[std::size_t(triangle[c])];
    };
    const Vector3d across = (corner(1) - corner(0)).cross(corner(2) - corner(0)) / 2;
    const double area = across.norm();
    passed += area;
    while (spots.size() < count &&
           passed * double(count) > area_m2 * (double(spots.size()) + 0.5)) {
      // An even sequence over the triangle (M. Roberts, The unreasonable effectiveness of
      // quasirandom sequences, 2018).
      const double n = double(spots.size());
      double u = std::fmod(0.5 + 0.7548776662466927 * n, 1.0),
             v = std::fmod(0.5 + 0.5698402909980532 * n, 1.0);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      spots.push_back(
          {corner(0) + u * (corner(1) - corner(0)) + v * (corner(2) - corner(0)), across / area});
    }
  }
  return spots;
}

}  // namespace

std::string in_words(const Pressing& pressing, MeshRole role) {
  return fmt::format(
      "{:g} N {}, layer of {:g} mm, {:g} kPa, nu {:g}, friction {:g}", pressing.load_N,
      role == MeshRole::finger ? "on a plane"
                               : fmt::format("by a ball of {:g} mm", 1e3 * pressing.ball_radius_m),
      1e3 * pressing.layer.thickness_m, 1e-3 * pressing.layer.youngs_modulus_Pa,
      pressing.layer.poisson_ratio, pressing.friction_coefficient);
}

const FlatFace* Pads::pad_face() const {
  if (faces.empty() || faces.front().is_ring()) return nullptr;
  double flat_m2 = 0;
  for (const FlatFace& face : faces) flat_m2 += face.area_m2;
  // A round tip has a flat face, too, where it is mounted.
  constexpr double kShare = 0.4, kLeastShare = 0.05;
  const bool has_round = std::any_of(best_first.begin(), best_first.end(),
                                     [](const Pad& pad) { return !pad.face && pad.is_usable(); });
  const bool is_pad =
      has_round ? flat_m2 >= kShare * area_m2 : faces.front().area_m2 >= kLeastShare * area_m2;
  return is_pad ? &faces.front() : nullptr;
}

Pads find_pads(const TriangleSurface& surface, MeshRole role, const Pressing& pressing,
               const std::vector<PadPlace>& named, bool everywhere) {
  const std::clock_t start = std::clock();
  Pads pads;
  const prediction::SurfaceFacts facts = prediction::facts_of(surface);
  pads.area_m2 = facts.area_m2;
  pads.faces = prediction::flat_faces(surface);
  Vector3d sizes = facts.largest_m - facts.least_m;
  std::sort(sizes.begin(), sizes.end());
  const double width_m = sizes[1];

  std::vector<PadPlace> places = named;
  if (everywhere) {
    constexpr std::size_t kMostFaces = 6;
    std::vector<const FlatFace*> known;
    for (const PadPlace& place : named)
      known.push_back(prediction::face_at(surface, pads.faces, place.point_m));
    for (const FlatFace& face : pads.faces)
      if (std::find(known.begin(), known.end(), &face) == known.end() &&
          places.size() < named.size() + kMostFaces)
        places.push_back({"", face.middle_m, face.normal});
    // Each next one is the spot farthest from all before it, where the side that it faces counts
    // as a distance, too: both sides of a thin body are looked at.
    constexpr std::size_t kSpots = 1500, kMore = 40;
    const double turn_m = 0.25 * width_m;
    const std::vector<Spot> spots = spread(surface, facts.area_m2, kSpots);
    std::vector<double> nearest(spots.size(), kInfinity);
    const auto take_away = [&](const Vector3d& point, const std::optional<Vector3d>& normal) {
      for (std::size_t i = 0; i < spots.size(); ++i)
        nearest[i] = std::min(
            nearest[i],
            (spots[i].point - point).squaredNorm() +
                (normal ? turn_m * turn_m * (spots[i].normal - *normal).squaredNorm() : 0));
    };
    for (const PadPlace& place : places) take_away(place.point_m, place.normal);
    for (std::size_t more = 0; more < kMore && !spots.empty(); ++more) {
      const auto farthest = std::max_element(nearest.begin(), nearest.end());
      if (!(*farthest > 0)) break;
      const Spot& spot = spots[std::size_t(farthest - nearest.begin())];
      // One place of a face is as good as another.
      if (!prediction::face_at(surface, pads.faces, spot.point))
        places.push_back({"", spot.point, spot.normal});
      take_away(spot.point, spot.normal);
    }
  }

  for (const PadPlace& place : places) {
    if (std::clock() - start > prediction::kLongestSearch) {
      pads.is_complete = false;
      break;
    }
    Pad pad;
    pad.name = place.name;
    pad.point_m = place.point_m;
    pad.normal = place.normal.value_or(Vector3d::Zero());
    pad.worst = kInfinity;
    if (const FlatFace* face = prediction::face_at(surface, pads.faces, place.point_m)) {
      pad.face = *face;
      pad.normal = face->normal;
    }
    try {
      if (!pad.face)
        press(pad, surface, role, pressing, place.normal);
      else if (role == MeshRole::object)
        press_face(pad, pressing);
      else
        pad.reason = prediction::in_words(*pad.face);
    } catch (const InputError& error) {
      pad.reason = error.field() + (error.value().empty() ? "" : " = " + error.value());
    } catch (const ConvergenceError& error) {
      pad.reason = error.what();
    }
    pad.kind = kind_of(pad, role, width_m);
    pads.usable += pad.is_usable();
    pads.best_first.push_back(std::move(pad));
  }
  // Bounds that differ by less than 1 % are the same: then a place with a name is better.
  const auto order = [](const Pad& pad) {
    constexpr double kSame = 0.01;
    const double worst = std::isfinite(pad.worst) ? std::ceil(pad.worst / kSame) : kInfinity;
    return std::tuple(!pad.is_usable(), !pad.face, pad.face ? -pad.face->area_m2 : 0.0, worst,
                      pad.name.empty(), pad.worst);
  };
  const auto usable_order = [](const Pad& pad) {
    constexpr double kSame = 0.01;
    return std::tuple(std::ceil(pad.worst / kSame), pad.name.empty(), pad.worst);
  };
  std::stable_sort(pads.best_first.begin(), pads.best_first.end(),
                   [&](const Pad& one, const Pad& other) {
                     if (one.is_usable() && other.is_usable())
                       return usable_order(one) < usable_order(other);
                     return order(one) < order(other);
                   });
  if (const FlatFace* face = role == MeshRole::finger && everywhere ? pads.pad_face() : nullptr) {
    const auto pad = std::find_if(
        pads.best_first.begin(), pads.best_first.end(),
        [&](const Pad& one) { return one.face && one.face->middle_m == face->middle_m; });
    if (pad != pads.best_first.end()) std::rotate(pads.best_first.begin(), pad, pad + 1);
  }
  std::map<std::string, int> numbers;
  for (Pad& pad : pads.best_first)
    if (pad.name.empty()) pad.name = fmt::format("{} {}", pad.kind, ++numbers[pad.kind]);
  return pads;
}

}  // namespace softfinger::judgement
