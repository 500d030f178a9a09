#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace softfinger::robots {

/// Which geoms of a MuJoCo model collide, and with which friction.
///
/// As MuJoCo 2.2 has it (engine_collision_driver.c, mj_contactParam): contact pairs of the file
/// have their own settings; between other geoms the one of higher priority decides, of equal ones
/// the larger condim and friction. condim 1 is without friction.
class MujocoContacts {
 public:
  explicit MujocoContacts(const mjModel& model);

  /// Empty: they pass through each other.
  std::optional<double> friction_coefficient(int geom, int other) const;
  /// Whether anything could collide with the geom; others are there to be seen.
  bool may_collide(int geom) const;
  /// The geoms of a body that may collide. Those stay together that meet all geoms of other bodies
  /// alike.
  std::vector<std::vector<int>> groups(int body) const;
  bool are_disabled() const;

 private:
  bool bodies_collide(int body, int other) const;

  const mjModel& m_;
  std::map<std::pair<int, int>, int> pairs_;  ///< of the file, by their geoms
  std::set<int> geoms_in_pairs_;
  std::set<std::pair<int, int>> excluded_;  ///< bodies
};

}  // namespace softfinger::robots
