#include "comparisons/report/motion_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <variant>

#include "comparisons/report/hold.h"
#include "comparisons/report/surface_data.h"
#include "comparisons/simulation/triangulate.h"
#include "comparisons/text/base64.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/input/constants.h"

namespace softfinger::report {
namespace {

using simulation::Frame;
using simulation::RecordedContact;
using simulation::Recording;

// Together they keep the page below 3 MB: a pose takes 40 bytes in it, a contact 110, a triangle
// 16. 300 frames are a fluent motion.
constexpr std::size_t kFrames = 300, kPoses = 12000, kContacts = 6000, kTriangles = 32000;

void append(std::vector<float>& numbers, const Eigen::Vector3d& vector) {
  for (const double number : vector) numbers.push_back(static_cast<float>(number));
}

void append(std::vector<float>& numbers, const Eigen::Quaterniond& turn) {
  for (const double number : turn.coeffs()) numbers.push_back(static_cast<float>(number));
}

/// x, y, z, then the quaternion x, y, z, w, as three.js has it.
void append(std::vector<float>& numbers, const Eigen::Isometry3d& pose) {
  append(numbers, pose.translation());
  append(numbers, Eigen::Quaterniond(pose.linear()));
}

template <typename Number>
std::string encoded(const std::vector<Number>& numbers) {
  return text::base64(text::bytes_of(numbers));
}

/// Shares the triangles among the distinct meshes: what a small one leaves is for the larger ones.
std::size_t most_triangles_of_a_mesh(const Recording& recording) {
  std::set<const TriangleSurface*> meshes;
  for (const simulation::RecordedBody& body : recording.bodies)
    for (const input::Shape& shape : body.shapes)
      if (const auto* mesh = std::get_if<input::Mesh>(&shape.kind); mesh && mesh->surface)
        meshes.insert(mesh->surface.get());
  std::vector<std::size_t> counts;
  for (const TriangleSurface* mesh : meshes) counts.push_back(mesh->triangles.size());
  std::sort(counts.begin(), counts.end());
  std::size_t left = kTriangles;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const std::size_t share = left / (counts.size() - i);
    if (counts[i] > share) return share;
    left -= counts[i];
  }
  return kTriangles;
}

/// Bodies with their shapes; equal surfaces (five fingertips from one mesh) are kept once.
std::pair<Json, Json> bodies_and_geometries(const Recording& recording) {
  const double width_m = simulation::half_space_width_m(recording);
  const std::size_t most_triangles = most_triangles_of_a_mesh(recording);

  Json bodies = Json::array(), geometries = Json::array();
  std::map<std::string, std::size_t> known;
  for (const simulation::RecordedBody& body : recording.bodies) {
    Json shapes = Json::array();
    for (const input::Shape& shape : body.shapes) {
      const bool is_plane = std::holds_alternative<input::HalfSpace>(shape.kind);
      // The shape's pose is the page's business: it keeps equal surfaces equal.
      const TriangleSurface surface =
          simulation::triangulate({shape.kind, Eigen::Isometry3d::Identity()}, width_m);
      Json drawn = surface_json(split_at_edges(coarsened(surface, most_triangles)));
      const auto [entry, is_new] = known.emplace(drawn.dump(), geometries.size());
      if (is_new) geometries.push_back(std::move(drawn));
      std::vector<float> pose;
      append(pose, shape.pose);
      shapes.push_back(
          {{"geometry", entry->second}, {"pose", encoded(pose)}, {"half_space", is_plane}});
    }
    bodies.push_back({{"name", body.name}, {"movable", body.movable}, {"shapes", shapes}});
  }
  return {std::move(bodies), std::move(geometries)};
}

/// Sections of limit surfaces by the plane of the tangential force, as radii in the plane of
/// (f/(mu P), tau/(mu P e_n)), at equal angles from pure force to pure torque. The other quarters
/// mirror this one. They depend on b/a, n and the direction of the force only, and little: equal
/// ones after rounding to 0.02, 0.02 and 7.5 degrees are kept once.
class Sections {
 public:
  /// Index of the section; -1 for a point contact.
  int of(const RecordedContact& contact) {
    const double a_m = contact.semi_axis_a_m, b_m = contact.semi_axis_b_m;
    if (!(a_m > 0 && b_m > 0 && contact.eccentricity_m > 0)) return -1;
    const double aspect = std::max(1., std::round(50 * b_m / a_m)) / 50;
    const double exponent = std::round(50 * contact.pressure_exponent) / 50;
    const double direction =
        std::atan2(std::abs(contact.tangent_force_2_N), std::abs(contact.tangent_force_1_N));
    const double step_rad = kPi / 24;
    // A circle looks the same from everywhere.
    const double direction_rad = aspect < 1 ? step_rad * std::round(direction / step_rad) : 0;
    const auto [entry, is_new] = known_.emplace(std::tuple{aspect, exponent, direction_rad},
                                                static_cast<int>(known_.size()));
    if (is_new) {
      const LimitSurface surface(1, aspect, exponent, 1);
      const std::vector<LimitWrench> points =
          surface.sample_section(direction_rad, 4 * (kPoints - 1));
      for (int i = 0; i < kPoints; ++i)
        radii_.push_back(
            static_cast<float>(std::hypot(points[i].force_x_N, points[i].force_y_N,
                                          points[i].torque_Nm / surface.eccentricity_m())));
    }
    return entry->second;
  }

  Json json() const { return {{"points", kPoints}, {"radii", encoded(radii_)}}; }

 private:
  static constexpr int kPoints = 25;
  std::map<std::tuple<double, double, double>, int> known_;
  std::vector<float> radii_;
};

/// e_n of the exact limit surface over the one that was used.
double exact_eccentricity_ratio(const RecordedContact& contact) {
  return LimitSurface(contact.semi_axis_a_m, contact.semi_axis_b_m, contact.pressure_exponent, 1)
             .eccentricity_m() /
         contact.eccentricity_m;
}

}  // namespace

std::vector<ContactTrack> follow_contacts(const Recording& recording) {
  std::vector<ContactTrack> tracks;
  std::vector<Eigen::Vector3d> last_places_m;  // of each track, on body b
  std::map<std::pair<int, int>, std::vector<std::size_t>> tracks_of_pair;
  std::vector<Eigen::Vector3d> places_m;
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  for (std::size_t frame = 0; frame < recording.frames.size(); ++frame) {
    const std::vector<RecordedContact>& contacts = recording.frames[frame].contacts;
    places_m.clear();
    candidates.clear();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      places_m.push_back(recording.frames[frame].poses.at(contacts[i].b).inverse() *
                         contacts[i].point_m);
      for (const std::size_t track : tracks_of_pair[{contacts[i].a, contacts[i].b}])
        candidates.emplace_back((places_m[i] - last_places_m[track]).norm(), track, i);
    }
    std::sort(candidates.begin(), candidates.end());
    std::vector<bool> followed(contacts.size(), false);
    const auto follow = [&](std::size_t track, std::size_t i) {
      tracks[track].contacts[frame] = i;
      last_places_m[track] = places_m[i];
      followed[i] = true;
    };
    for (const auto& [distance_m, track, i] : candidates)
      if (!followed[i] && !tracks[track].contacts[frame]) follow(track, i);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (followed[i]) continue;
      std::vector<std::size_t>& of_pair = tracks_of_pair[{contacts[i].a, contacts[i].b}];
      ContactTrack track;
      track.a = contacts[i].a;
      track.b = contacts[i].b;
      track.ordinal = static_cast<int>(of_pair.size());
      track.contacts.resize(recording.frames.size());
      of_pair.push_back(tracks.size());
      tracks.push_back(std::move(track));
      last_places_m.emplace_back();
      follow(tracks.size() - 1, i);
    }
  }
  return tracks;
}

std::string track_name(const Recording& recording, const std::vector<ContactTrack>& tracks,
                       std::size_t track) {
  const ContactTrack& named = tracks.at(track);
  const bool is_single =
      std::count_if(tracks.begin(), tracks.end(), [&](const ContactTrack& other) {
        return other.a == named.a && other.b == named.b;
      }) == 1;
  return recording.bodies.at(named.a).name + " – " + recording.bodies.at(named.b).name +
         (is_single ? "" : " " + std::to_string(named.ordinal + 1));
}

std::vector<std::size_t> shown_frames(const Recording& recording) {
  const std::size_t count = recording.frames.size();
  for (std::size_t stride = 1;; ++stride) {
    std::vector<std::size_t> shown;
    std::size_t contacts = 0;
    for (std::size_t i = 0; i < count; ++i)
      if (i % stride == 0 || i + 1 == count) {
        shown.push_back(i);
        contacts += recording.frames[i].contacts.size();
      }
    // Two frames are shown whatever is in them.
    if (shown.size() <= 2 || (shown.size() <= kFrames && contacts <= kContacts &&
                              shown.size() * recording.bodies.size() <= kPoses))
      return shown;
  }
}

Json motion_data(const Recording& recording, const std::vector<ContactTrack>& tracks) {
  std::vector<float> times_s, poses, contacts;
  std::vector<std::uint32_t> contact_offsets = {0};
  Sections sections;
  std::vector<std::vector<Hold::State>> states;
  for (const ContactTrack& track : tracks) states.push_back(states_of(recording, track));
  for (const std::size_t shown : shown_frames(recording)) {
    const Frame& frame = recording.frames[shown];
    times_s.push_back(static_cast<float>(frame.time_s));
    for (std::size_t body = 0; body < recording.bodies.size(); ++body)
      append(poses, frame.poses.at(body));
    for (std::size_t track = 0; track < tracks.size(); ++track) {
      if (!tracks[track].contacts[shown]) continue;
      const RecordedContact& contact = frame.contacts[*tracks[track].contacts[shown]];
      // The order is that of `columns` below.
      contacts.push_back(static_cast<float>(track));
      append(contacts, contact.point_m);
      append(contacts, Eigen::Quaterniond(contact.axes));
      const int section = sections.of(contact);
      for (const double number :
           {contact.semi_axis_a_m, contact.semi_axis_b_m, contact.normal_force_N,
            contact.tangent_force_1_N, contact.tangent_force_2_N, contact.torque_Nm,
            contact.friction_coefficient, contact.eccentricity_m, contact.utilisation,
            contact.slides ? 1. : 0., states[track][shown] == Hold::State::slips ? 1. : 0.,
            static_cast<double>(section), section < 0 ? 1 : exact_eccentricity_ratio(contact)})
        contacts.push_back(static_cast<float>(number));
    }
    contact_offsets.push_back(static_cast<std::uint32_t>(contacts.size()));
  }
  const Json columns = {"track", "x",   "y",   "z",      "qx",    "qy",      "qz",
                        "qw",    "a",   "b",   "P",      "f1",    "f2",      "tau",
                        "mu",    "e_n", "use", "slides", "slips", "section", "exact_ratio"};
  Json drawn_tracks = Json::array();
  for (std::size_t track = 0; track < tracks.size(); ++track)
    drawn_tracks.push_back({{"a", tracks[track].a},
                            {"b", tracks[track].b},
                            {"name", track_name(recording, tracks, track)}});
  const Eigen::AlignedBox3d extent = simulation::extent_of(recording);
  auto [bodies, geometries] = bodies_and_geometries(recording);
  const auto corner = [&](const Eigen::Vector3d& point_m) {
    return std::vector<double>(point_m.begin(), point_m.end());
  };
  return {
      {"bodies", std::move(bodies)},
      {"geometries", std::move(geometries)},
      {"extent_m", extent.isEmpty() ? Json() : Json{corner(extent.min()), corner(extent.max())}},
      {"time_s", encoded(times_s)},
      {"poses", encoded(poses)},
      {"tracks", std::move(drawn_tracks)},
      {"columns", columns},
      {"contacts", encoded(contacts)},
      {"contact_offsets", encoded(contact_offsets)},
      {"sections", sections.json()}};
}

}  // namespace softfinger::report
