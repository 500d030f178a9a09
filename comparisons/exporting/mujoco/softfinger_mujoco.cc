#include "comparisons/exporting/mujoco/softfinger_mujoco.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "comparisons/exporting/mujoco/softfinger_torsion.h"

namespace {

static_assert(sizeof(mjtNum) == sizeof(double), "softfinger_torsion takes doubles");

struct Free {
  void operator()(softfinger_torsion* finger) const { softfinger_torsion_free(finger); }
};

constexpr const char* kPrefix = "softfinger:";

/// A contact point in the rows of its step's constraints.
struct NormalRow {
  int geom1 = 0, geom2 = 0, row = 0;
};

/// Normal force of a pair of geoms, over all its contact points.
struct PairForce {
  int geom1 = 0, geom2 = 0;
  double normal_N = 0;
};

/// State of one mjData that is kept from step to step.
struct DataState {
  const mjData* data = nullptr;
  double time_s = 0;
  std::vector<NormalRow> rows;  ///< of the last step; its forces are read at the next one
  std::vector<PairForce> forces;
};

/// "softfinger:GEOM" of the model's numeric field, or empty.
std::string listed_geom(const mjModel* model, int numeric) {
  const char* const name = mj_id2name(model, mjOBJ_NUMERIC, numeric);
  const std::string text = name ? name : "", prefix = kPrefix;
  return text.compare(0, prefix.size(), prefix) == 0 ? text.substr(prefix.size()) : "";
}

}  // namespace

struct softfinger_mujoco {
  const mjModel* model = nullptr;
  std::vector<std::unique_ptr<softfinger_torsion, Free>> finger_of_geom;  ///< null: not listed
  std::mutex mutex;  ///< of the list of states, not of what they point to
  std::vector<std::unique_ptr<DataState>> states;

  const softfinger_torsion* finger(int geom) const {
    return geom >= 0 && geom < int(finger_of_geom.size()) ? finger_of_geom[std::size_t(geom)].get()
                                                          : nullptr;
  }

  DataState& state_of(const mjData* data) {
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& state : states)
      if (state->data == data) return *state;
    states.push_back(std::make_unique<DataState>());
    states.back()->data = data;
    return *states.back();
  }
};

namespace {

/// The forces of the last solved step, which MuJoCo leaves in efc_force until it solves the next.
void read_forces(const mjModel* model, const mjData* data, DataState& state) {
  state.forces.clear();
  // After a reset, or in memory of another mjData that is no more, the rows mean nothing.
  const bool follows = std::abs(data->time - state.time_s) <= 2 * model->opt.timestep;
  if (!follows) return;
  for (const NormalRow& row : state.rows) {
    const auto same =
        std::find_if(state.forces.begin(), state.forces.end(), [&](const PairForce& force) {
          return force.geom1 == row.geom1 && force.geom2 == row.geom2;
        });
    PairForce& force = same != state.forces.end()
                           ? *same
                           : state.forces.emplace_back(PairForce{row.geom1, row.geom2, 0});
    force.normal_N += data->efc_force[row.row];
  }
}

/// The diagonal element of J M^-1 J^T + R, which only PGS and noslip use.
mjtNum* diagonal_of_AR(const mjModel* model, mjData* data, int row) {
  if (!mj_isDual(model)) return nullptr;
  if (!mj_isSparse(model)) return data->efc_AR + std::size_t(row) * std::size_t(data->nefc) + row;
  const int first = data->efc_AR_rowadr[row];
  for (int i = first; i < first + data->efc_AR_rownnz[row]; ++i)
    if (data->efc_AR_colind[i] == row) return data->efc_AR + i;
  return nullptr;
}

/// All installed plugins. A callback of MuJoCo has no argument that says whose it is.
std::vector<softfinger_mujoco*>& installed() {
  static std::vector<softfinger_mujoco*> plugins;
  return plugins;
}

mjfGeneric callback_before = nullptr;

void passive_callback(const mjModel* model, mjData* data) {
  if (callback_before) callback_before(model, data);
  for (softfinger_mujoco* plugin : installed())
    if (plugin->model == model) softfinger_mujoco_apply(plugin, model, data);
}

}  // namespace

softfinger_mujoco* softfinger_mujoco_create(const mjModel* model, char* error, int error_size) {
  try {
    auto plugin = std::make_unique<softfinger_mujoco>();
    plugin->model = model;
    plugin->finger_of_geom.resize(std::size_t(model->ngeom));
    bool is_any_listed = false;
    for (int i = 0; i < model->nnumeric; ++i) {
      const std::string geom = listed_geom(model, i);
      if (geom.empty()) continue;
      const int id = mj_name2id(model, mjOBJ_GEOM, geom.c_str());
      if (id < 0) throw std::invalid_argument(kPrefix + geom + ": the model has no such geom");
      if (model->geom_condim[id] < 4)
        throw std::invalid_argument(kPrefix + geom + ": condim = " +
                                    std::to_string(model->geom_condim[id]) + ": allowed: 4 or 6");
      std::array<char, 200> why{};
      softfinger_torsion* const finger =
          softfinger_torsion_create(model->numeric_data + model->numeric_adr[i],
                                    model->numeric_size[i], why.data(), int(why.size()));
      if (!finger) throw std::invalid_argument(kPrefix + geom + ": " + why.data());
      plugin->finger_of_geom[std::size_t(id)].reset(finger);
      is_any_listed = true;
    }
    if (!is_any_listed)
      throw std::invalid_argument("the model lists no geom: allowed: <custom><numeric name=\"" +
                                  std::string(kPrefix) + "GEOM\" .../></custom>");
    if (model->opt.cone != mjCONE_ELLIPTIC)
      throw std::invalid_argument("<option cone=\"pyramidal\">: allowed: \"elliptic\"");
    return plugin.release();
  } catch (const std::exception& problem) {
    if (error && error_size > 0)
      std::snprintf(error, std::size_t(error_size), "%s", problem.what());
    return nullptr;
  }
}

void softfinger_mujoco_free(softfinger_mujoco* plugin) {
  auto& plugins = installed();
  plugins.erase(std::remove(plugins.begin(), plugins.end(), plugin), plugins.end());
  if (plugins.empty() && mjcb_passive == passive_callback) {
    mjcb_passive = callback_before;
    callback_before = nullptr;
  }
  delete plugin;
}

void softfinger_mujoco_install(softfinger_mujoco* plugin) {
  auto& plugins = installed();
  if (std::find(plugins.begin(), plugins.end(), plugin) == plugins.end()) plugins.push_back(plugin);
  if (mjcb_passive == passive_callback) return;
  callback_before = mjcb_passive;
  mjcb_passive = passive_callback;
}

void softfinger_mujoco_apply(softfinger_mujoco* plugin, const mjModel* model, mjData* data) {
  DataState& state = plugin->state_of(data);
  read_forces(model, data, state);
  state.rows.clear();
  state.time_s = data->time;
  for (int i = 0; i < data->ncon; ++i) {
    mjContact& contact = data->contact[i];
    if (contact.efc_address < 0 || contact.dim < 4) continue;
    const softfinger_torsion* const first = plugin->finger(contact.geom1);
    const softfinger_torsion* const second = plugin->finger(contact.geom2);
    if (!first && !second) continue;
    state.rows.push_back({contact.geom1, contact.geom2, contact.efc_address});
    const int row = contact.efc_address + 3;
    for (const PairForce& force : state.forces)
      if (force.geom1 == contact.geom1 && force.geom2 == contact.geom2)
        softfinger_torsion_set(first, second, force.normal_N, contact.friction, data->efc_R + row,
                               data->efc_D + row, data->efc_diagApprox + row,
                               diagonal_of_AR(model, data, row));
  }
}

double softfinger_mujoco_eccentricity_m(const softfinger_mujoco* plugin, int geom, double load_N) {
  const softfinger_torsion* const finger = plugin->finger(geom);
  return finger ? softfinger_torsion_eccentricity_m(finger, load_N) : 0;
}
