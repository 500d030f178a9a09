#include "comparisons/robots/mujoco_scene.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <ostream>
#include <set>

#include "comparisons/robots/mjcf_file.h"
#include "comparisons/robots/mujoco_contacts.h"
#include "comparisons/robots/named_files.h"
#include "comparisons/text/robot_mesh_title.h"
#include "meshes/io/whole_file.h"
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
  /// @param text  read in place of the file's own; empty: that
  explicit Model(const std::filesystem::path& file, const std::string& text = "") {
    char error[1000] = "";
    if (text.empty()) {
      model.reset(mj_loadXML(file.c_str(), nullptr, error, sizeof error));
    } else {
      const auto files = std::make_unique<mjVFS>();
      mj_defaultVFS(files.get());
      if (file.filename().string().size() >= mjMAXVFSNAME ||
          mj_makeEmptyFileVFS(files.get(), file.filename().c_str(), int(text.size())) != 0)
        throw InputError(file.string(), "the file's name", "",
                         fmt::format("at most {} bytes", mjMAXVFSNAME - 1));
      std::memcpy(files->filedata[0], text.data(), text.size());
      model.reset(mj_loadXML(file.c_str(), files.get(), error, sizeof error));
      mj_deleteVFS(files.get());
    }
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

/// Pipes are refused before they are opened.
MjcfFile read_checked(const std::filesystem::path& file) {
  refuse_named_pipes(file);
  return read_mjcf(file, schema_of_library());
}

/// The volume of a mesh as MuJoCo 3 has it where the file does not say how, "legacy": that of the
/// tetrahedra of the facets and the centre of mass, all with one sign. A model has its meshes with
/// the centre of mass at the origin.
double legacy_volume_m3(const mjModel& model, int mesh) {
  const float* vertices = model.mesh_vert + 3 * model.mesh_vertadr[mesh];
  const int* faces = model.mesh_face + 3 * model.mesh_faceadr[mesh];
  double volume_m3 = 0;
  for (int f = 0; f < model.mesh_facenum[mesh]; ++f) {
    Matrix3d corners;
    for (int k = 0; k < 3; ++k)
      corners.col(k) =
          Eigen::Map<const Eigen::Vector3f>(vertices + 3 * faces[3 * f + k]).cast<double>();
    volume_m3 += std::abs(corners.determinant()) / 6;
  }
  return volume_m3;
}

/// The library has another volume of a mesh than MuJoCo 3: where masses follow from
/// meshes, the file is read again with them.
Model load(const std::filesystem::path& file, const MjcfFile& mjcf) {
  Model first(file, mjcf.text);
  std::map<std::string, double> masses;
  for (const auto& [name, density_kg_per_m3] : mjcf.density_of_mesh_geom) {
    const int geom = mj_name2id(first.model.get(), mjOBJ_GEOM, name.c_str());
    if (geom < 0 || first.model->geom_dataid[geom] < 0) continue;
    masses[name] =
        density_kg_per_m3 * legacy_volume_m3(*first.model, first.model->geom_dataid[geom]);
  }
  return masses.empty() ? std::move(first) : Model(file, with_masses(mjcf.text, masses));
}

class Importer {
 public:
  Importer(const std::filesystem::path& file, const std::filesystem::path& meshes, std::string id,
           const std::vector<FingerLayer>& layers)
      : file_(file),
        meshes_(meshes),
        id_(std::move(id)),
        layers_(layers),
        mjcf_(read_checked(file)),
        loaded_(load(file, mjcf_)),
        m_(loaded_.model.get()),
        d_(loaded_.data.get()),
        contacts_(*m_) {
    result_.notes = mjcf_.notes;
    visual_geoms_ = mjcf_.visual_geoms;
    for (int b = 0; b < m_->nbody; ++b) names_.insert(body_name(b));
  }

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
    add_gravity_compensation();
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
  /// A name that no body has.
  std::string new_name(std::string name) {
    while (!names_.insert(name).second) name += "_";
    return name;
  }
  std::string joint_name(int j) const { return name(mjOBJ_JOINT, j, "joint"); }
  Isometry3d body_pose(int b) const { return pose(d_->xpos + 3 * b, d_->xquat + 4 * b); }
  bool moves(int b) const { return m_->body_weldid[b] != 0; }
  /// Whether the file's <flag> switches one of these off.
  bool is_off(int flags) const { return (m_->opt.disableflags & flags) != 0; }
  bool is_limited(int j) const {
    return m_->jnt_limited[j] && !is_off(mjDSBL_LIMIT | mjDSBL_CONSTRAINT);
  }

  /// Sets the starting position.
  void place() {
    mj_resetData(m_, d_);
    if (m_->nkey > 0) {
      mj_resetDataKeyframe(m_, d_, 0);
      note("bodies start where the keyframe {} puts them", in_quotes(name(mjOBJ_KEY, 0, "key")));
    }
    for (int j = 0; j < m_->njnt; ++j) {
      const int type = m_->jnt_type[j];
      if (!is_limited(j) || (type != mjJNT_HINGE && type != mjJNT_SLIDE)) continue;
      double& position = d_->qpos[m_->jnt_qposadr[j]];
      const double inside =
          std::clamp(position, double(m_->jnt_range[2 * j]),
                     std::max(double(m_->jnt_range[2 * j]), double(m_->jnt_range[2 * j + 1])));
      if (inside != position)
        note("joint {} starts at its limit, {:.6g}, not at {:.6g} beyond it",
             in_quotes(joint_name(j)), inside, position);
      position = inside;
    }
    start_.assign(d_->qpos, d_->qpos + m_->nq);
    start_velocity_.assign(d_->qvel, d_->qvel + m_->nv);
    place_again();
    for (int j = 0; j < m_->njnt; ++j)
      for (int i = 0; i < dofs(j) && m_->jnt_type[j] != mjJNT_FREE; ++i)
        joints_move_ |= d_->qvel[m_->jnt_dofadr[j] + i] != 0;
  }

  void place_again() {
    std::copy(start_.begin(), start_.end(), d_->qpos);
    std::copy(start_velocity_.begin(), start_velocity_.end(), d_->qvel);
    mj_kinematics(m_, d_);
    mj_comPos(m_, d_);
  }

  void add_simulation() {
    if (!(m_->opt.timestep > 0))
      throw InputError(file_.string(), "<option> timestep", fmt::format("{:g}", m_->opt.timestep),
                       "a time in s > 0");
    result_.text += fmt::format(
        "# From {} by softfinger simulate.\n"
        "id = {}\n\n[simulation]\ntime_step_ms = {}\nduration_s = 1\ngravity_m_per_s2 = {}\n\n",
        file_.filename().string(), in_quotes(id_), 1e3 * m_->opt.timestep,
        list(is_off(mjDSBL_GRAVITY) ? Vector3d(0, 0, 0) : vector(m_->opt.gravity)));
  }

  void add_layers() {
    std::vector<std::string> names;
    for (int b = 1; b < m_->nbody; ++b) names.push_back(body_name(b));
    result_.text += layer_tables(layers_, names);
  }

  /// A body, and for each of its joints but the last a massless one before it. A scene has one
  /// friction for two bodies: geoms that meet others differently are bodies of their own, fixed to
  /// the first.
  void add_body(int b) {
    const std::vector<std::vector<int>> groups = contacts_.groups(b);
    for (const std::vector<int>& group : groups) visual_geoms_ -= int(group.size());
    visual_geoms_ += m_->body_geomnum[b];
    if (b == 0 && groups.empty()) return;
    const int first = m_->body_jntadr[b], count = m_->body_jntnum[b];
    std::string parent =
        b == 0 || !moves(m_->body_parentid[b]) ? "world" : body_name(m_->body_parentid[b]);
    const Isometry3d at = body_pose(b);
    for (int i = 0; i < count; ++i) {
      const int j = first + i;
      std::string child = body_name(b);
      if (i + 1 < count) {
        child = new_name(child + fmt::format("_{}", i + 1));
        bodies_ += fmt::format("[[body]]\nname = {}\nmassless = true\n{}{}\n", in_quotes(child),
                               placed_lines(at), velocity_lines(b, i + 1, Vector3d::Zero()));
      }
      add_joint(j, parent, child);
      parent = child;
    }
    if (moves(b) && count == 0) fix(body_name(b), parent);
    const std::size_t parts = std::max<std::size_t>(1, groups.size());
    for (std::size_t i = 0; i < parts; ++i) {
      const std::string part =
          i == 0 ? body_name(b) : new_name(fmt::format("{}_geoms_{}", body_name(b), i + 1));
      bodies_ += fmt::format("[[body]]\nname = {}\n{}", in_quotes(part), placed_lines(at));
      if (moves(b))
        add_mass(b, 1. / double(parts));
      else
        bodies_ += "fixed = true\n";
      if (i == 0 && count > 0) bodies_ += velocity_lines(b, count, vector(m_->body_ipos + 3 * b));
      if (i > 0 && moves(b)) fix(part, body_name(b));
      bodies_ += layer_line(layers_, body_name(b));
      if (!groups.empty()) {
        parts_.push_back({part, b, groups[i].front()});
        bodies_ += fmt::format("shapes = [\n{}]\n", shapes_of(groups[i]));
      }
      bodies_ += "\n";
    }
    if (parts > 1)
      note("the geoms of body {} touch others in {} ways: it is {} bodies, fixed to each other",
           in_quotes(body_name(b)), parts, parts);
  }

  void fix(const std::string& child, const std::string& parent) {
    joints_ += fmt::format("[[joint]]\nname = {}\nkind = \"fixed\"\nparent = {}\nchild = {}\n\n",
                           in_quotes("fixed_" + child), in_quotes(parent), in_quotes(child));
  }

  /// @param share  of the body's mass: parts with one centre of mass add up to the body
  void add_mass(int b, double share) {
    if (!(m_->body_mass[b] > 0)) {
      bodies_ += "massless = true\n";
      return;
    }
    const Isometry3d at = pose(m_->body_ipos + 3 * b, m_->body_iquat + 4 * b);
    const Matrix3d inertia =
        at.linear() * vector(m_->body_inertia + 3 * b).asDiagonal() * at.linear().transpose();
    Isometry3d center = Isometry3d::Identity();
    center.translation() = at.translation();
    bodies_ += mass_lines(share * m_->body_mass[b], center, share * exact(b, inertia));
  }

  /// The matrix of the file, where the library has only rounded it.
  Matrix3d exact(int b, const Matrix3d& inertia) const {
    const char* own = mj_id2name(m_, mjOBJ_BODY, b);
    const auto found = mjcf_.full_inertia.find(own ? own : "");
    if (found == mjcf_.full_inertia.end()) return inertia;
    const auto& six = found->second;
    Matrix3d typed;
    typed << six[0], six[3], six[4], six[3], six[1], six[5], six[4], six[5], six[2];
    // Otherwise the library has changed it as the file's <compiler> says.
    constexpr double kRounding = 1e-6;
    const bool is_same =
        (typed - inertia).cwiseAbs().maxCoeff() <= kRounding * inertia.cwiseAbs().maxCoeff();
    return is_same ? typed : inertia;
  }

  int dofs(int j) const {
    const int type = m_->jnt_type[j];
    return type == mjJNT_FREE ? 6 : type == mjJNT_BALL ? 3 : 1;
  }

  /// The velocities of a body, or of the massless one that stands between its joints: what the
  /// first `joints` of them and the bodies before give it. A scene has them in the world's axes.
  /// @param at  the point, in the body's frame, whose velocity is the linear one
  std::string velocity_lines(int b, int joints, const Vector3d& at) const {
    std::vector<double> velocity(d_->qvel, d_->qvel + m_->nv);
    for (int j = m_->body_jntadr[b] + joints; j < m_->body_jntadr[b] + m_->body_jntnum[b]; ++j)
      std::fill_n(velocity.begin() + m_->jnt_dofadr[j], dofs(j), 0.);
    using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
    Rows linear(3, m_->nv), angular(3, m_->nv);
    const Vector3d point = body_pose(b) * at;
    mj_jac(m_, d_, linear.data(), angular.data(), point.data(), b);
    const Eigen::Map<const Eigen::VectorXd> speeds(velocity.data(), m_->nv);
    const Vector3d moves = linear * speeds, turns = angular * speeds;
    std::string lines;
    // A velocity that is not stated of a body on a joint follows from the others, so zeros are
    // stated.
    if (joints_move_ || !moves.isZero(0))
      lines += fmt::format("velocity_mm_per_s = {}\n", list(kMillimetres * moves));
    if (joints_move_ || !turns.isZero(0))
      lines += fmt::format("angular_velocity_deg_per_s = {}\n", list(kDegrees * turns));
    return lines;
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
      if (is_limited(j))
        note("the limit of the ball joint {} is left out", in_quotes(joint_name(j)));
      joints_ += "\n";
      return;
    }
    const double unit = turns ? kDegrees : kMillimetres;
    joints_ += fmt::format("axis = {}\nstart{} = {}\n", list(vector(d_->xaxis + 3 * j)),
                           turns ? "_deg" : "_mm", unit * d_->qpos[m_->jnt_qposadr[j]]);
    if (is_limited(j))
      joints_ += fmt::format("limits{} = [{}, {}]\n", turns ? "_deg" : "_mm",
                             unit * m_->jnt_range[2 * j], unit * m_->jnt_range[2 * j + 1]);
    const int dof = m_->jnt_dofadr[j];
    if (m_->dof_armature[dof] > 0)
      joints_ += fmt::format("{} = {}\n", turns ? "rotor_inertia_kg_mm2" : "rotor_mass_g",
                             (turns ? 1e6 : 1e3) * m_->dof_armature[dof]);
    add_leader(j);
    if (m_->dof_frictionloss[dof] > 0)
      joints_ +=
          fmt::format("dry_friction_{} = {}\n", turns ? "Nm" : "N", m_->dof_frictionloss[dof]);
    joints_ += "\n";
  }

  std::string shapes_of(const std::vector<int>& geoms) {
    std::string text;
    for (const int g : geoms) {
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
    std::string stl(text::kRobotMeshTitle);
    stl.resize(80, ' ');
    stl.append(reinterpret_cast<const char*>(&count), 4);
    const float* vertices = m_->mesh_vert + 3 * m_->mesh_vertadr[mesh];
    const int* faces = m_->mesh_face + 3 * m_->mesh_faceadr[mesh];
    for (std::uint32_t f = 0; f < count; ++f) {
      float triangle[12] = {0, 0, 0};  // the normal first, which readers compute anew
      for (int corner = 0; corner < 3; ++corner)
        std::copy_n(vertices + 3 * faces[3 * f + std::uint32_t(corner)], 3,
                    triangle + 3 + 3 * corner);
      stl.append(reinterpret_cast<const char*>(triangle), sizeof triangle);
      stl.append(2, '\0');
    }
    meshes::write_whole_file((meshes_ / file).string(), [&](std::ostream& out) { out << stl; });
    return file;
  }

  /// Whether an equality makes a joint move by a constant ratio with another one.
  bool is_follower(int e) const {
    if (!m_->eq_active[e] || m_->eq_type[e] != mjEQ_JOINT ||
        is_off(mjDSBL_EQUALITY | mjDSBL_CONSTRAINT))
      return false;
    const int joint = m_->eq_obj1id[e], leader = m_->eq_obj2id[e];
    const auto is_simple = [this](int j) {
      return j >= 0 && (m_->jnt_type[j] == mjJNT_HINGE || m_->jnt_type[j] == mjJNT_SLIDE);
    };
    const double* polynomial = m_->eq_data + mjNEQDATA * e;
    for (int other = 0; other < e; ++other)
      if (m_->eq_obj1id[other] == joint && is_follower(other)) return false;  // of that one only
    return is_simple(joint) && is_simple(leader) && joint != leader &&
           std::all_of(polynomial + 2, polynomial + 5, [](double higher) { return higher == 0; });
  }

  void add_leader(int j) {
    for (int e = 0; e < m_->neq; ++e) {
      if (!is_follower(e) || m_->eq_obj1id[e] != j) continue;
      const double ratio = m_->eq_data[mjNEQDATA * e + 1];
      joints_ +=
          fmt::format("follows = {}\nratio = {}\n", in_quotes(joint_name(m_->eq_obj2id[e])), ratio);
      note("joint {} follows joint {} from where both start, exactly", in_quotes(joint_name(j)),
           in_quotes(joint_name(m_->eq_obj2id[e])));
      return;
    }
  }

  void add_loops() {
    if (is_off(mjDSBL_EQUALITY | mjDSBL_CONSTRAINT)) return;
    for (int e = 0; e < m_->neq; ++e) {
      const std::string own = name(mjOBJ_EQUALITY, e, "equality");
      if (!m_->eq_active[e]) continue;
      const int type = m_->eq_type[e];
      if (type == mjEQ_JOINT && is_follower(e)) continue;
      if (type != mjEQ_CONNECT && type != mjEQ_WELD) {
        note("the equality {} is left out: only connect, weld and linear ones of joints are known",
             in_quotes(own));
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
    double most = 0;                               ///< of its actuators together
    int actuators = 0;
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
    if (++motor.actuators == 2)
      note("the actuators of joint {} are one motor with the sum of their limits",
           in_quotes(joint_name(j)));
    const double gear = m_->actuator_gear[6 * a];
    if (m_->actuator_biastype[a] == mjBIAS_AFFINE) {
      const double* bias = m_->actuator_biasprm + mjNBIAS * a;
      const bool has_ratio = bias[2] > 0 && bias[1] == -m_->actuator_gainprm[mjNGAIN * a];
      if (bias[0] != 0 || bias[1] > 0 || (bias[2] > 0 && !has_ratio))
        note("the actuator {} has a bias that is no spring or damper: that part is left out",
             in_quotes(own));
      const double stiffness = std::max(0., -bias[1]) * gear * gear;
      motor.stiffness += stiffness;
      motor.pulls += stiffness * d_->qpos[m_->jnt_qposadr[j]];
      motor.damping +=
          std::max(0., has_ratio ? damping_of_ratio(j, gear, bias) : -bias[2]) * gear * gear;
    }
    motor.most += std::abs(gear) * most_force(a, own);
  }

  /// MuJoCo 3 takes a positive number for the ratio of damping of an actuator with a stiffness: of
  /// the mass that its joint alone feels at the reference positions.
  double damping_of_ratio(int j, double gear, const double* bias) {
    if (masses_of_dofs_.empty()) {
      mj_resetData(m_, d_);
      mj_kinematics(m_, d_);
      mj_comPos(m_, d_);
      mj_crb(m_, d_);
      for (int dof = 0; dof < m_->nv; ++dof) masses_of_dofs_.push_back(d_->qM[m_->dof_Madr[dof]]);
      place_again();
    }
    const double mass = masses_of_dofs_[std::size_t(m_->jnt_dofadr[j])] / (gear * gear);
    return 2 * bias[2] * std::sqrt(-bias[1] * mass);
  }

  /// Largest force of an actuator: that of its force range, and for a pure motor at most the gain
  /// times the range of its control.
  double most_force(int a, const std::string& own) {
    double most = std::numeric_limits<double>::infinity();
    const auto limit = [&](const char* what, const double* range, double gain) {
      if (range[0] != -range[1])
        note("the {} range of actuator {} is taken to be its larger side both ways", what,
             in_quotes(own));
      most = std::min(most, gain * std::max(std::abs(range[0]), std::abs(range[1])));
    };
    if (m_->actuator_forcelimited[a]) limit("force", m_->actuator_forcerange + 2 * a, 1);
    if (m_->actuator_ctrllimited[a] && !is_off(mjDSBL_CLAMPCTRL)) {
      if (m_->actuator_biastype[a] == mjBIAS_NONE)
        limit("control", m_->actuator_ctrlrange + 2 * a,
              std::abs(m_->actuator_gainprm[mjNGAIN * a]));
      else
        note(
            "the control range of actuator {} is left out: positions and velocities that the scene "
            "gives its joint are not limited",
            in_quotes(own));
    }
    return most;
  }

  /// The limit of a joint's actuators together.
  void limit_by_joint(int j, JointMotor& motor) {
    const auto range = mjcf_.actuator_force_range.find(joint_name(j));
    if (range == mjcf_.actuator_force_range.end()) return;
    const auto [low, high] = range->second;
    if (low != -high)
      note("the actuators' force range of joint {} is taken to be its larger side both ways",
           in_quotes(joint_name(j)));
    motor.most = std::min(motor.most, std::max(std::abs(low), std::abs(high)));
  }

  void add_gravity_compensation() {
    const Vector3d gravity = vector(m_->opt.gravity);
    if (is_off(mjDSBL_GRAVITY) || gravity.isZero(0)) return;
    for (int b = 1; b < m_->nbody; ++b) {
      const char* own = mj_id2name(m_, mjOBJ_BODY, b);
      const auto found = mjcf_.gravity_compensation.find(own ? own : "");
      if (found == mjcf_.gravity_compensation.end() || !moves(b) || !(m_->body_mass[b] > 0))
        continue;
      const Vector3d lift = -found->second * m_->body_mass[b] * gravity;
      result_.text += fmt::format("[[force]]\nbody = {}\ntime_s = [0]\nforce_N = [{}]\n\n",
                                  in_quotes(body_name(b)), list(lift));
      note(
          "body {} has gravcomp {}: a [[force]] holds that part of its weight in the file's "
          "gravity",
          in_quotes(body_name(b)), found->second);
    }
  }

  void add_motors() {
    const bool has_actuators = m_->nu > 0 && !is_off(mjDSBL_ACTUATION);
    for (int a = 0; a < m_->nu && has_actuators; ++a) add_actuator(a);
    if (has_actuators)
      note(
          "actuators hold their joints where they start, or rest, until --control, a position or "
          "an "
          "effort in the scene moves them");
    for (int j = 0; j < m_->njnt; ++j) {
      const bool is_passive = !is_off(mjDSBL_PASSIVE);
      const double damping = is_passive ? m_->dof_damping[m_->jnt_dofadr[j]] : 0;
      const double stiffness = is_passive ? m_->jnt_stiffness[j] : 0;
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
      if (motor.actuators == 0)
        motor.most = std::numeric_limits<double>::infinity();
      else
        limit_by_joint(j, motor);
      if (std::isfinite(motor.most) && (damping > 0 || stiffness > 0))
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
    for (auto a = parts_.begin(); a != parts_.end(); ++a)
      for (auto b = a + 1; b != parts_.end(); ++b) {
        if (!moves(a->body) && !moves(b->body)) continue;
        if (++rules_ > kMostRules)
          refuse("pairs of bodies with shapes", fmt::format("at most {}", kMostRules));
        const bool hang_together = m_->body_weldid[a->body] == m_->body_weldid[b->body];
        const auto friction = contacts_.friction_coefficient(a->geom, b->geom);
        result_.text += fmt::format(
            "[[contact]]\nbodies = [{}, {}]\n{}\n\n", in_quotes(a->name), in_quotes(b->name),
            friction && !hang_together ? fmt::format("friction_coefficient = {}", *friction)
                                       : "collide = false");
      }
  }

  void note_what_is_off() {
    std::string off;
    for (const auto& [flag, what] :
         {std::pair(mjDSBL_CONSTRAINT, "contacts, limits and equalities"),
          std::pair(mjDSBL_CONTACT, "contacts"), std::pair(mjDSBL_GRAVITY, "gravity"),
          std::pair(mjDSBL_LIMIT, "limits"), std::pair(mjDSBL_EQUALITY, "equalities"),
          std::pair(mjDSBL_PASSIVE, "springs and dampers"),
          std::pair(mjDSBL_ACTUATION, "actuators")})
      if (is_off(flag)) off += (off.empty() ? "" : ", ") + std::string(what);
    if (!off.empty()) note("the file switches off, and so does the scene: {}", off);
  }

  void note_the_rest() {
    note_what_is_off();
    if (m_->opt.collision == mjCOL_PAIR) note("only the contact pairs of the file touch");
    for (int p = 0; p < m_->npair; ++p)
      if (m_->pair_friction[5 * p] != m_->pair_friction[5 * p + 1])
        note("the contact pair of {} and {} has the first of its friction coefficients both ways",
             in_quotes(name(mjOBJ_GEOM, m_->pair_geom1[p], "geom")),
             in_quotes(name(mjOBJ_GEOM, m_->pair_geom2[p], "geom")));
    if (visual_geoms_ > 0) note("{} geoms that collide with nothing are left out", visual_geoms_);
    if (!written_meshes_.empty())
      note("meshes collide as they are; MuJoCo takes their convex hulls");
    if (m_->ntendon > 0) note("{} tendons are left out", m_->ntendon);
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
  bool joints_move_ = false;  ///< at the start: a keyframe says so
  const std::vector<FingerLayer>& layers_;
  ImportedScene result_;
  MjcfFile mjcf_;
  Model loaded_;
  const mjModel* m_;
  mjData* d_;
  MujocoContacts contacts_;
  std::string bodies_, joints_;
  /// A body of the scene with shapes, and a geom that stands for all of them.
  struct Part {
    std::string name;
    int body = 0, geom = 0;
  };
  std::vector<Part> parts_;
  std::set<std::string> names_;  ///< of bodies
  std::set<int> written_meshes_;
  std::map<int, JointMotor> motors_;
  std::vector<double> start_, start_velocity_;
  std::vector<double> masses_of_dofs_;  ///< at the reference positions
  int visual_geoms_ = 0;
  std::size_t rules_ = 0;
};

}  // namespace

ImportedScene import_robot(const std::filesystem::path& file, const std::filesystem::path& meshes,
                           const std::string& id, const std::vector<FingerLayer>& layers) {
  return Importer(file, meshes, id, layers).run();
}

}  // namespace softfinger::robots
