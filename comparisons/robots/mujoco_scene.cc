#include "comparisons/robots/mujoco_scene.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <set>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDegrees = 180 / kPi, kMillimetres = 1e3;
Vector3d vector(const mjtNum* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

Isometry3d pose(const mjtNum* position, const mjtNum* wxyz) {
  Isometry3d result = Isometry3d::Identity();
  result.translation() = vector(position);
  result.linear() =
      Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized().toRotationMatrix();
  return result;
}

/// The model of a file, and what the library said about it.
struct Model {
  explicit Model(const std::filesystem::path& file) {
    char error[1000] = "";
    model.reset(mj_loadXML(file.c_str(), nullptr, error, sizeof error));
    if (!model) {
      std::string reason = error;
      std::replace(reason.begin(), reason.end(), '\n', ' ');
      throw InputError(file.string(), "MuJoCo cannot read it: " + reason, "", "");
    }
    data.reset(mj_makeData(model.get()));
    if (!data) throw InputError(file.string(), "MuJoCo has no memory for it", "", "");
  }
  std::unique_ptr<mjModel, void (*)(mjModel*)> model{nullptr, mj_deleteModel};
  std::unique_ptr<mjData, void (*)(mjData*)> data{nullptr, mj_deleteData};
};

class Importer {
 public:
  Importer(const std::filesystem::path& file, const std::filesystem::path& meshes, std::string id,
           const std::vector<FingerLayer>& layers)
      : file_(file),
        meshes_(meshes),
        id_(std::move(id)),
        layers_(layers),
        loaded_(file),
        m_(loaded_.model.get()),
        d_(loaded_.data.get()) {}

  ImportedScene run() {
    if (std::size_t(m_->nbody) > kMostBodies)
      throw InputError(file_.string(), "bodies", std::to_string(m_->nbody),
                       fmt::format("at most {}", kMostBodies));
    place();
    add_simulation();
    add_layers();
    for (int b = 0; b < m_->nbody; ++b) add_body(b);
    result_.text += bodies_ + joints_;
    add_loops();
    add_motors();
    add_contacts();
    note_the_rest();
    return std::move(result_);
  }

 private:
  template <class... Arguments>
  void note(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    result_.notes.push_back(fmt::format(text, std::forward<Arguments>(arguments)...));
  }
  [[noreturn]] void refuse(const std::string& what, const std::string& allowed) const {
    throw InputError(file_.string(), what, "", allowed);
  }

  std::string name(int type, int index, const char* kind) const {
    const char* own = mj_id2name(m_, type, index);
    if (!own || !*own) return fmt::format("{}_{}", kind, index);
    const std::string text = own;
    if (!is_name(text))
      refuse(fmt::format("the name of {} {}", kind, index),
             fmt::format("1 to {} bytes without control characters", kLongestName));
    return text;
  }
  /// The world is a fixed body of the scene where it has shapes.
  std::string body_name(int b) const {
    if (b == 0) return "ground";
    const std::string own = name(mjOBJ_BODY, b, "body");
    return own == "world" || own == "ground" || own == "*" ? own + "_" : own;
  }
  std::string joint_name(int j) const { return name(mjOBJ_JOINT, j, "joint"); }
  Isometry3d body_pose(int b) const { return pose(d_->xpos + 3 * b, d_->xquat + 4 * b); }
  bool moves(int b) const { return m_->body_weldid[b] != 0; }

  /// Sets the starting position.
  void place() {
    mj_resetData(m_, d_);
    if (m_->nkey > 0) {
      mj_resetDataKeyframe(m_, d_, 0);
      note("bodies start where the keyframe {} puts them", in_quotes(name(mjOBJ_KEY, 0, "key")));
    }
    for (int j = 0; j < m_->njnt; ++j) {
      const int type = m_->jnt_type[j];
      if (!m_->jnt_limited[j] || (type != mjJNT_HINGE && type != mjJNT_SLIDE)) continue;
      double& position = d_->qpos[m_->jnt_qposadr[j]];
      const double inside =
          std::clamp(position, double(m_->jnt_range[2 * j]),
                     std::max(double(m_->jnt_range[2 * j]), double(m_->jnt_range[2 * j + 1])));
      if (inside != position)
        note("joint {} starts at its limit, {:.6g}, not at {:.6g} beyond it",
             in_quotes(joint_name(j)), inside, position);
      position = inside;
    }
    mj_kinematics(m_, d_);
  }

  void add_simulation() {
    result_.text += fmt::format(
        "# From {} by softfinger simulate.\n"
        "id = {}\n\n[simulation]\ntime_step_ms = {}\nduration_s = 1\ngravity_m_per_s2 = {}\n\n",
        file_.filename().string(), in_quotes(id_), 1e3 * m_->opt.timestep,
        list(vector(m_->opt.gravity)));
  }

  void add_layers() {
    std::vector<std::string> names;
    for (int b = 1; b < m_->nbody; ++b) names.push_back(body_name(b));
    result_.text += layer_tables(layers_, names);
  }

  /// A body, and for each of its joints but the last a massless one before it.
  void add_body(int b) {
    const std::string shapes = shapes_of(b);
    has_shapes_.push_back(!shapes.empty());
    if (b == 0 && shapes.empty()) return;
    const int first = m_->body_jntadr[b], count = m_->body_jntnum[b];
    std::string parent =
        b == 0 || !moves(m_->body_parentid[b]) ? "world" : body_name(m_->body_parentid[b]);
    const Isometry3d at = body_pose(b);
    for (int i = 0; i < count; ++i) {
      const int j = first + i;
      std::string child = body_name(b);
      if (i + 1 < count) {
        child += fmt::format("_{}", i + 1);
        bodies_ += fmt::format("[[body]]\nname = {}\nmassless = true\n{}\n", in_quotes(child),
                               placed_lines(at));
      }
      add_joint(j, parent, child);
      parent = child;
    }
    bodies_ += fmt::format("[[body]]\nname = {}\n{}", in_quotes(body_name(b)), placed_lines(at));
    if (!moves(b)) {
      bodies_ += "fixed = true\n";
    } else {
      add_mass(b);
      if (count == 0)
        joints_ += fmt::format(
            "[[joint]]\nname = {}\nkind = \"fixed\"\nparent = {}\nchild = {}\n\n",
            in_quotes("fixed_" + body_name(b)), in_quotes(parent), in_quotes(body_name(b)));
    }
    bodies_ += layer_line(layers_, body_name(b));
    bodies_ += shapes.empty() ? "\n" : fmt::format("shapes = [\n{}]\n\n", shapes);
  }

  void add_mass(int b) {
    if (!(m_->body_mass[b] > 0)) {
      bodies_ += "massless = true\n";
      return;
    }
    bodies_ += mass_lines(m_->body_mass[b], pose(m_->body_ipos + 3 * b, m_->body_iquat + 4 * b),
                          vector(m_->body_inertia + 3 * b).asDiagonal());
  }

  void add_joint(int j, const std::string& parent, const std::string& child) {
    const int type = m_->jnt_type[j];
    if (type == mjJNT_FREE) return;
    const bool turns = type == mjJNT_HINGE;
    joints_ += fmt::format("[[joint]]\nname = {}\nkind = \"{}\"\nparent = {}\nchild = {}\n",
                           in_quotes(joint_name(j)),
                           type == mjJNT_BALL ? "ball"
                           : turns            ? "revolute"
                                              : "prismatic",
                           in_quotes(parent), in_quotes(child));
    if (type != mjJNT_SLIDE)
      joints_ += fmt::format("anchor_mm = {}\n", list(kMillimetres * vector(d_->xanchor + 3 * j)));
    if (type == mjJNT_BALL) {
      if (m_->jnt_limited[j])
        note("the limit of the ball joint {} is left out", in_quotes(joint_name(j)));
      joints_ += "\n";
      return;
    }
    const double unit = turns ? kDegrees : kMillimetres;
    joints_ += fmt::format("axis = {}\nstart{} = {}\n", list(vector(d_->xaxis + 3 * j)),
                           turns ? "_deg" : "_mm", unit * d_->qpos[m_->jnt_qposadr[j]]);
    if (m_->jnt_limited[j])
      joints_ += fmt::format("limits{} = [{}, {}]\n", turns ? "_deg" : "_mm",
                             unit * m_->jnt_range[2 * j], unit * m_->jnt_range[2 * j + 1]);
    const int dof = m_->jnt_dofadr[j];
    if (m_->dof_armature[dof] > 0)
      joints_ += fmt::format("{} = {}\n", turns ? "rotor_inertia_kg_mm2" : "rotor_mass_g",
                             (turns ? 1e6 : 1e3) * m_->dof_armature[dof]);
    if (m_->dof_frictionloss[dof] > 0)
      note("the dry friction of joint {} is left out", in_quotes(joint_name(j)));
    joints_ += "\n";
  }

  bool collides(int geom) const {
    return m_->geom_contype[geom] != 0 || m_->geom_conaffinity[geom] != 0;
  }

  std::string shapes_of(int b) {
    std::string text;
    const int first = m_->body_geomadr[b];
    for (int g = first; g < first + m_->body_geomnum[b]; ++g) {
      if (!collides(g)) {
        ++visual_geoms_;
        continue;
      }
      const double* size = m_->geom_size + 3 * g;
      std::string shape;
      switch (m_->geom_type[g]) {
        case mjGEOM_PLANE:
          shape = "half_space = true";
          break;
        case mjGEOM_SPHERE:
          shape = fmt::format("sphere_radius_mm = {}", 1e3 * size[0]);
          break;
        case mjGEOM_CAPSULE:
          shape = fmt::format("capsule_radius_length_mm = [{}, {}]", 1e3 * size[0], 2e3 * size[1]);
          break;
        case mjGEOM_ELLIPSOID:
          shape = fmt::format("ellipsoid_semi_axes_mm = {}", list(1e3 * vector(size)));
          break;
        case mjGEOM_CYLINDER:
          shape = fmt::format("cylinder_radius_length_mm = [{}, {}]", 1e3 * size[0], 2e3 * size[1]);
          break;
        case mjGEOM_BOX:
          shape = fmt::format("box_size_mm = {}", list(2e3 * vector(size)));
          break;
        case mjGEOM_MESH:
          shape = fmt::format("mesh = {}, unit = \"m\"", in_quotes(mesh_file(m_->geom_dataid[g])));
          break;
        default:
          refuse("geom " + in_quotes(name(mjOBJ_GEOM, g, "geom")),
                 "a plane, sphere, capsule, ellipsoid, cylinder, box or mesh");
      }
      const std::string at = placed(pose(m_->geom_pos + 3 * g, m_->geom_quat + 4 * g));
      text += fmt::format("  {{ {}{}{} }},\n", shape, at.empty() ? "" : ", ", at);
    }
    return text;
  }

  /// Writes the mesh once, in the frame in which the model's geoms place it.
  std::string mesh_file(int mesh) {
    const std::string file = fmt::format("{}_mesh_{}.stl", id_, mesh);
    if (!written_meshes_.insert(mesh).second) return file;
    const auto count = std::uint32_t(m_->mesh_facenum[mesh]);
    std::ofstream out(meshes_ / file, std::ios::binary);
    const std::string header(80, ' ');
    out.write(header.data(), 80);
    out.write(reinterpret_cast<const char*>(&count), 4);
    const float* vertices = m_->mesh_vert + 3 * m_->mesh_vertadr[mesh];
    const int* faces = m_->mesh_face + 3 * m_->mesh_faceadr[mesh];
    for (std::uint32_t f = 0; f < count; ++f) {
      float triangle[12] = {0, 0, 0};  // the normal first, which readers compute anew
      for (int corner = 0; corner < 3; ++corner)
        std::copy_n(vertices + 3 * faces[3 * f + std::uint32_t(corner)], 3,
                    triangle + 3 + 3 * corner);
      out.write(reinterpret_cast<const char*>(triangle), sizeof triangle);
      out.write("\0\0", 2);
    }
    if (!out.flush()) throw InputError((meshes_ / file).string(), "cannot be written", "", "");
    return file;
  }

  void add_loops() {
    for (int e = 0; e < m_->neq; ++e) {
      const std::string own = name(mjOBJ_EQUALITY, e, "equality");
      if (!m_->eq_active[e]) continue;
      const int type = m_->eq_type[e];
      if (type != mjEQ_CONNECT && type != mjEQ_WELD) {
        note("the equality {} is left out: only connect and weld are known", in_quotes(own));
        continue;
      }
      const int a = m_->eq_obj1id[e], b = m_->eq_obj2id[e];
      if (!moves(a) && !moves(b)) continue;
      const auto end = [this](int body) { return moves(body) ? body_name(body) : "world"; };
      const Vector3d anchor = type == mjEQ_CONNECT
                                  ? body_pose(a) * vector(m_->eq_data + mjNEQDATA * e)
                                  : body_pose(b).translation();
      result_.text +=
          fmt::format("[[loop]]\nname = {}\nkind = \"{}\"\nbodies = [{}, {}]\nanchor_mm = {}\n\n",
                      in_quotes(own), type == mjEQ_CONNECT ? "ball" : "fixed", in_quotes(end(a)),
                      in_quotes(end(b)), list(kMillimetres * anchor));
      note("the equality {} holds what is together at the start, exactly", in_quotes(own));
    }
  }

  /// Actuators, springs and dampers of a joint become its motor.
  struct JointMotor {
    double stiffness = 0, damping = 0, pulls = 0;  ///< pulls: stiffness times target
    double most = std::numeric_limits<double>::infinity();
    bool is_there = false;
  };

  void add_actuator(int a) {
    const std::string own = name(mjOBJ_ACTUATOR, a, "actuator");
    const bool on_joint = m_->actuator_trntype[a] == mjTRN_JOINT;
    const int j = on_joint ? m_->actuator_trnid[2 * a] : -1;
    const bool is_simple =
        on_joint && (m_->jnt_type[j] == mjJNT_HINGE || m_->jnt_type[j] == mjJNT_SLIDE) &&
        m_->actuator_dyntype[a] == mjDYN_NONE && m_->actuator_gaintype[a] == mjGAIN_FIXED &&
        (m_->actuator_biastype[a] == mjBIAS_NONE || m_->actuator_biastype[a] == mjBIAS_AFFINE);
    if (!is_simple) {
      note(
          "the actuator {} is left out: only motor, position and velocity on a hinge or slide are "
          "known",
          in_quotes(own));
      return;
    }
    JointMotor& motor = motors_[j];
    motor.is_there = true;
    const double gear = m_->actuator_gear[6 * a];
    if (m_->actuator_biastype[a] == mjBIAS_AFFINE) {
      const double* bias = m_->actuator_biasprm + mjNBIAS * a;
      if (bias[0] != 0 || bias[1] > 0 || bias[2] > 0)
        note("the actuator {} has a bias that is no spring or damper: that part is left out",
             in_quotes(own));
      const double stiffness = std::max(0., -bias[1]) * gear * gear;
      motor.stiffness += stiffness;
      motor.pulls += stiffness * d_->qpos[m_->jnt_qposadr[j]];
      motor.damping += std::max(0., -bias[2]) * gear * gear;
    }
    if (m_->actuator_forcelimited[a]) {
      const double* range = m_->actuator_forcerange + 2 * a;
      if (range[0] != -range[1])
        note("the force range of actuator {} is taken to be its larger side both ways",
             in_quotes(own));
      motor.most = std::abs(gear) * std::max(std::abs(range[0]), std::abs(range[1]));
    }
  }

  void add_motors() {
    for (int a = 0; a < m_->nu; ++a) add_actuator(a);
    if (m_->nu > 0)
      note(
          "actuators hold their joints where they start, or rest, until --control, a position or "
          "an "
          "effort in the scene moves them");
    for (int j = 0; j < m_->njnt; ++j) {
      const double damping = m_->dof_damping[m_->jnt_dofadr[j]];
      const double stiffness = m_->jnt_stiffness[j];
      const int type = m_->jnt_type[j];
      if (type != mjJNT_HINGE && type != mjJNT_SLIDE) {
        if (damping > 0 || stiffness > 0)
          note("damping and stiffness of joint {} are left out: only hinges and slides have them",
               in_quotes(joint_name(j)));
        continue;
      }
      auto found = motors_.find(j);
      if (damping == 0 && stiffness == 0 && found == motors_.end()) continue;
      JointMotor& motor = motors_[j];
      if (motor.is_there && std::isfinite(motor.most) && (damping > 0 || stiffness > 0))
        note("damping and stiffness of joint {} share its actuator's force limit",
             in_quotes(joint_name(j)));
      motor.damping += damping;
      motor.stiffness += stiffness;
      motor.pulls += stiffness * m_->qpos_spring[m_->jnt_qposadr[j]];
      const bool turns = type == mjJNT_HINGE;
      std::string text = fmt::format("[[motor]]\njoint = {}\n", in_quotes(joint_name(j)));
      if (motor.stiffness > 0)
        text += fmt::format("stiffness_{} = {}\ntime_s = [0]\nposition_{} = [{}]\n",
                            turns ? "Nm_per_rad" : "N_per_m", motor.stiffness, turns ? "deg" : "mm",
                            (turns ? kDegrees : kMillimetres) * motor.pulls / motor.stiffness);
      if (motor.damping > 0)
        text += fmt::format("damping_{} = {}\n", turns ? "Nms_per_rad" : "Ns_per_m", motor.damping);
      if (std::isfinite(motor.most))
        text += fmt::format("max_effort_{} = {}\n", turns ? "Nm" : "N", motor.most);
      result_.text += text + "\n";
    }
  }

  /// Which bodies collide, and with which friction.
  void add_contacts() {
    std::set<std::pair<int, int>> excluded;
    for (int e = 0; e < m_->nexclude; ++e) {
      const int a = (m_->exclude_signature[e] >> 16) - 1,
                b = (m_->exclude_signature[e] & 0xffff) - 1;
      excluded.insert(std::minmax(a, b));
    }
    const auto friction_of = [this](int body) {
      double most = 0;
      const int first = m_->body_geomadr[body];
      for (int g = first; g < first + m_->body_geomnum[body]; ++g)
        if (collides(g)) most = std::max(most, double(m_->geom_friction[3 * g]));
      return most;
    };
    for (int a = 0; a < m_->nbody; ++a)
      for (int b = a + 1; b < m_->nbody; ++b) {
        if (!has_shapes_[std::size_t(a)] || !has_shapes_[std::size_t(b)]) continue;
        if (!moves(a) && !moves(b)) continue;
        // As MuJoCo does it: a body and its parent pass through each other.
        const bool are_parent_and_child =
            m_->body_weldid[m_->body_parentid[m_->body_weldid[b]]] == m_->body_weldid[a] &&
            moves(a);
        const bool collide = !excluded.count({a, b}) && !are_parent_and_child && masks_meet(a, b) &&
                             m_->body_weldid[a] != m_->body_weldid[b];
        if (++rules_ > kMostRules)
          refuse("pairs of bodies with shapes", fmt::format("at most {}", kMostRules));
        result_.text += fmt::format("[[contact]]\nbodies = [{}, {}]\n{}\n\n",
                                    in_quotes(body_name(a)), in_quotes(body_name(b)),
                                    collide ? fmt::format("friction_coefficient = {}",
                                                          std::max(friction_of(a), friction_of(b)))
                                            : "collide = false");
      }
  }

  bool masks_meet(int a, int b) const {
    for (int g = m_->body_geomadr[a]; g < m_->body_geomadr[a] + m_->body_geomnum[a]; ++g)
      for (int h = m_->body_geomadr[b]; h < m_->body_geomadr[b] + m_->body_geomnum[b]; ++h)
        if ((m_->geom_contype[g] & m_->geom_conaffinity[h]) != 0 ||
            (m_->geom_contype[h] & m_->geom_conaffinity[g]) != 0)
          return true;
    return false;
  }

  void note_the_rest() {
    if (visual_geoms_ > 0) note("{} geoms that collide with nothing are left out", visual_geoms_);
    if (!written_meshes_.empty())
      note("meshes collide as they are; MuJoCo takes their convex hulls");
    if (m_->ntendon > 0) note("{} tendons are left out", m_->ntendon);
    if (m_->npair > 0) note("{} contact pairs with settings of their own are left out", m_->npair);
    if (m_->nsensor > 0) note("{} sensors are left out", m_->nsensor);
    if (m_->opt.density > 0 || m_->opt.viscosity > 0) note("the medium's drag is left out");
    if (m_->nmocap > 0) note("mocap bodies stand still");
    if (rules_ > 0)
      note(
          "contacts are rigid points with Coulomb's friction, or soft where --finger-layer says "
          "so; "
          "MuJoCo's solref, solimp, torsional and rolling friction are left out");
  }

  const std::filesystem::path& file_;
  const std::filesystem::path& meshes_;
  std::string id_;
  const std::vector<FingerLayer>& layers_;
  Model loaded_;
  const mjModel* m_;
  mjData* d_;
  ImportedScene result_;
  std::string bodies_, joints_;
  std::vector<char> has_shapes_;
  std::set<int> written_meshes_;
  std::map<int, JointMotor> motors_;
  int visual_geoms_ = 0;
  std::size_t rules_ = 0;
};

}  // namespace

ImportedScene import_robot(const std::filesystem::path& file, const std::filesystem::path& meshes,
                           const std::string& id, const std::vector<FingerLayer>& layers) {
  return Importer(file, meshes, id, layers).run();
}

}  // namespace softfinger::robots
