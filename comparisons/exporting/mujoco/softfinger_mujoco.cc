#include "comparisons/exporting/mujoco/softfinger_mujoco.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "comparisons/exporting/mujoco/eccentricity_table.h"
#include "softfinger/input/contact_problem.h"

namespace {

using softfinger::ContactProblem;
using softfinger::exporting::EccentricityTable;

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

bool is_positive(double value) { return std::isfinite(value) && value > 0; }

/// @throws std::invalid_argument in words
ContactProblem read_problem(const std::string& geom, const mjtNum* data, int size) {
  const std::string where = std::string(kPrefix) + geom;
  if (size != 5 && size != 8)
    throw std::invalid_argument(where + ": " + std::to_string(size) +
                                " numbers: allowed: 5 (R' R'' h E nu) or 8 (and the finger's "
                                "curvatures xx yy xy)");
  ContactProblem problem;
  problem.radii = {data[0], data[1], 0};
  problem.layer = {data[2], data[3], data[4]};
  for (int i = 0; i < 4; ++i)
    if (!is_positive(data[i]))
      throw std::invalid_argument(where + ": number " + std::to_string(i + 1) +
                                  ": allowed: R', R'', h in m and E in Pa, all > 0");
  if (data[0] < data[1]) throw std::invalid_argument(where + ": R' < R'': allowed: R' >= R''");
  if (!(data[4] >= 0 && data[4] <= 0.5))
    throw std::invalid_argument(where + ": number 5: allowed: Poisson's ratio, 0 to 0.5");
  if (size == 8) {
    for (int i = 5; i < 8; ++i)
      if (!std::isfinite(data[i]))
        throw std::invalid_argument(where + ": number " + std::to_string(i + 1) +
                                    ": allowed: a finite curvature in 1/m");
    problem.finger_curvature = {data[5], data[6], data[7]};
  }
  return problem;
}

}  // namespace

struct softfinger_mujoco {
  const mjModel* model = nullptr;
  std::vector<std::unique_ptr<EccentricityTable>> table_of_geom;  ///< null: not listed
  std::mutex mutex;  ///< of the list of states, not of what they point to
  std::vector<std::unique_ptr<DataState>> states;

  const EccentricityTable* table(int geom) const {
    return geom >= 0 && geom < int(table_of_geom.size()) ? table_of_geom[std::size_t(geom)].get()
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

/// MuJoCo gives the rows of an elliptic cone R_j = R_1 mu²/friction_j², so that R goes with the
/// inverse square of the coefficient.
void set_torsion(const mjModel* model, mjData* data, mjContact& contact, double torsion_m) {
  torsion_m = std::max(torsion_m, double(mjMINMU));
  const mjtNum ratio = contact.friction[2] / torsion_m, square = ratio * ratio;
  contact.friction[2] = torsion_m;
  const int row = contact.efc_address + 3;
  const mjtNum before = data->efc_R[row];
  data->efc_R[row] = std::max(mjtNum(mjMINVAL), before * square);
  data->efc_D[row] = 1 / data->efc_R[row];
  data->efc_diagApprox[row] *= square;
  if (mjtNum* const diagonal = diagonal_of_AR(model, data, row))
    *diagonal += data->efc_R[row] - before;
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
    plugin->table_of_geom.resize(std::size_t(model->ngeom));
    bool is_any_listed = false;
    for (int i = 0; i < model->nnumeric; ++i) {
      const std::string geom = listed_geom(model, i);
      if (geom.empty()) continue;
      const int id = mj_name2id(model, mjOBJ_GEOM, geom.c_str());
      if (id < 0) throw std::invalid_argument(kPrefix + geom + ": the model has no such geom");
      if (model->geom_condim[id] < 4)
        throw std::invalid_argument(kPrefix + geom + ": condim = " +
                                    std::to_string(model->geom_condim[id]) + ": allowed: 4 or 6");
      auto table = std::make_unique<EccentricityTable>(
          read_problem(geom, model->numeric_data + model->numeric_adr[i], model->numeric_size[i]));
      if (!table->has_answer())
        throw std::invalid_argument(kPrefix + geom + ": fingertip_layer has no answer for it");
      plugin->table_of_geom[std::size_t(id)] = std::move(table);
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
    const EccentricityTable* const tables[] = {plugin->table(contact.geom1),
                                               plugin->table(contact.geom2)};
    if (!tables[0] && !tables[1]) continue;
    state.rows.push_back({contact.geom1, contact.geom2, contact.efc_address});
    for (const PairForce& force : state.forces) {
      if (force.geom1 != contact.geom1 || force.geom2 != contact.geom2) continue;
      // Between two fingers the larger counts, as of all of MuJoCo's coefficients.
      double eccentricity_m = 0;
      for (const EccentricityTable* table : tables)
        if (table) eccentricity_m = std::max(eccentricity_m, table->at(force.normal_N));
      set_torsion(model, data, contact, contact.friction[0] * eccentricity_m);
      break;
    }
  }
}

double softfinger_mujoco_eccentricity_m(const softfinger_mujoco* plugin, int geom, double load_N) {
  const EccentricityTable* const table = plugin->table(geom);
  return table ? table->at(load_N) : 0;
}
