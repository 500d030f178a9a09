#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "comparisons/input/scene.h"
#include "comparisons/simulation/touching_point.h"
#include "softfinger/dynamics/step/time_stepper.h"
#include "softfinger/layer/stuck_stiffness.h"
#include "softfinger/pads/eccentric_load.h"

namespace softfinger::simulation {

/// Flat faces of which one is soft. The points that hold them apart stay, without friction, so that
/// the pressure's centre can lie anywhere in their polygon. Friction is one contact for each pair
/// of faces, at that centre and under the whole normal force, with the e_n of a pad of that
/// outline.
///
/// The centre is that of the last steps, and e_n belongs to it. In a step friction is therefore
/// that of a slightly older pressure; what it takes from the motion is never negative.
class SoftFaces {
 public:
  explicit SoftFaces(const input::Scene& scene) : scene_(scene) {}

  struct Face {
    double area_m2 = 0;
    double eccentricity_m = 0;
    Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< of pressure, in the world
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< as Contact::axes
    StuckStiffness stuck{};                              ///< along and about the axes
    double aspect = 1, size = 0;                         ///< see PreslidingContacts::add_face

   private:
    friend class SoftFaces;
    struct Outline;
    void move_centre(const Eigen::Vector2d& pressed_m);

    int across = -1;  ///< the finger's axis that the first one of `axes` follows; -1: none yet
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
    double height_m = 0;
    /// In the plane, from the origin: the centre after the last step, and that of e_n.
    std::optional<Eigen::Vector2d> last_centre_m, answered_at_m;
    Eigen::Vector2d last_way_m = Eigen::Vector2d::Zero();  ///< to the pressure's centre, last time
    double part_of_way = 1;                                ///< of it that was gone
    std::shared_ptr<const Outline> outline;
    bool is_here = false;
  };

  /// Finds the faces among the points, and adds the contacts of their friction.
  /// @param points  of which `contacts` are, in the same order
  void describe(const std::vector<TouchingPoint>& points, const Multibody& bodies,
                std::vector<Contact>& contacts);
  /// After a step that is done: where the pressures' centres are.
  void settle(const TimeStepper& stepper);
  /// The face that a contact of the last `describe` belongs to; null: a point of its own.
  const Face* face(const Contact& contact) const;

 private:
  bool describe(const std::vector<std::size_t>& group, const std::vector<TouchingPoint>& points,
                const Multibody& bodies, Face& face) const;

  const input::Scene& scene_;
  std::unordered_map<long, Face> faces_;  ///< by pair of shapes
};

}  // namespace softfinger::simulation
