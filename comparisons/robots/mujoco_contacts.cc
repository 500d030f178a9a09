#include "comparisons/robots/mujoco_contacts.h"

#include <algorithm>

namespace softfinger::robots {

MujocoContacts::MujocoContacts(const mjModel& model) : m_(model) {
  if (m_.opt.collision != mjCOL_DYNAMIC)
    for (int p = 0; p < m_.npair; ++p) {
      pairs_[std::minmax(m_.pair_geom1[p], m_.pair_geom2[p])] = p;
      geoms_in_pairs_.insert({m_.pair_geom1[p], m_.pair_geom2[p]});
    }
  for (int e = 0; e < m_.nexclude; ++e)
    excluded_.insert(
        std::minmax((m_.exclude_signature[e] >> 16) - 1, (m_.exclude_signature[e] & 0xffff) - 1));
}

bool MujocoContacts::are_disabled() const {
  return (m_.opt.disableflags & (mjDSBL_CONTACT | mjDSBL_CONSTRAINT)) != 0;
}

bool MujocoContacts::may_collide(int geom) const {
  return m_.geom_contype[geom] != 0 || m_.geom_conaffinity[geom] != 0 ||
         geoms_in_pairs_.count(geom) > 0;
}

/// A body and its parent pass through each other, but for those that stand still in the world.
bool MujocoContacts::bodies_collide(int body, int other) const {
  const int a = m_.body_weldid[body], b = m_.body_weldid[other];
  if (a == b || excluded_.count(std::minmax(body, other)) > 0) return false;
  if (a == 0 || b == 0 || (m_.opt.disableflags & mjDSBL_FILTERPARENT) != 0) return true;
  return m_.body_weldid[m_.body_parentid[a]] != b && m_.body_weldid[m_.body_parentid[b]] != a;
}

std::optional<double> MujocoContacts::friction_coefficient(int geom, int other) const {
  if (are_disabled()) return {};
  const auto of = [](int condim, double friction) { return condim == 1 ? 0. : friction; };
  if (const auto pair = pairs_.find(std::minmax(geom, other)); pair != pairs_.end())
    return of(m_.pair_dim[pair->second], m_.pair_friction[5 * pair->second]);
  if (m_.opt.collision == mjCOL_PAIR ||
      !bodies_collide(m_.geom_bodyid[geom], m_.geom_bodyid[other]) ||
      ((m_.geom_contype[geom] & m_.geom_conaffinity[other]) == 0 &&
       (m_.geom_contype[other] & m_.geom_conaffinity[geom]) == 0))
    return {};
  const auto own = [&](int g) { return of(m_.geom_condim[g], m_.geom_friction[3 * g]); };
  if (m_.geom_priority[geom] != m_.geom_priority[other])
    return own(m_.geom_priority[geom] > m_.geom_priority[other] ? geom : other);
  return of(std::max(m_.geom_condim[geom], m_.geom_condim[other]),
            std::max(m_.geom_friction[3 * geom], m_.geom_friction[3 * other]));
}

std::vector<std::vector<int>> MujocoContacts::groups(int body) const {
  std::vector<std::vector<int>> result;
  std::map<std::vector<std::optional<double>>, std::size_t> group_of;
  for (int g = m_.body_geomadr[body]; g < m_.body_geomadr[body] + m_.body_geomnum[body]; ++g) {
    if (!may_collide(g)) continue;
    std::vector<std::optional<double>> meets;
    for (int other = 0; other < m_.ngeom; ++other)
      if (m_.geom_bodyid[other] != body) meets.push_back(friction_coefficient(g, other));
    const auto [found, is_new] = group_of.emplace(std::move(meets), result.size());
    if (is_new) result.emplace_back();
    result[found->second].push_back(g);
  }
  return result;
}

}  // namespace softfinger::robots
