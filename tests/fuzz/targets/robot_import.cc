// Robots' files for simulate: URDF as a scene, and MJCF as the MuJoCo library gets it.

#include <sys/mman.h>
#include <unistd.h>

#include <exception>
#include <string>

#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"
#if defined(SOFTFINGER_HAS_MUJOCO) && defined(SOFTFINGER_HAS_URDFDOM)
#include "comparisons/input/scene.h"
#include "comparisons/robots/mjcf_file.h"
#include "comparisons/robots/urdf_scene.h"
#endif

namespace softfinger::fuzz {
namespace {

#if defined(SOFTFINGER_HAS_MUJOCO) && defined(SOFTFINGER_HAS_URDFDOM)
/// The readers want a file's name: a file in memory has one.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : descriptor_(memfd_create("robot", 0)) {
    std::string_view rest = bytes;
    while (!rest.empty()) {
      const ssize_t written = write(descriptor_, rest.data(), rest.size());
      if (written <= 0) std::terminate();
      rest.remove_prefix(std::size_t(written));
    }
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

bool read(std::string_view bytes) {
  static const robots::MjcfSchema schema = robots::schema_of_library();
  const MemoryFile file(bytes);
  bool is_read = false;
  try {
    const robots::MjcfFile mjcf = robots::read_mjcf(file.path(), schema);
    if (!mjcf.text.empty()) {
      const MemoryFile filtered(mjcf.text);
      // The filter reads its own text again.
      if (robots::read_mjcf(filtered.path(), schema).text.empty()) std::terminate();
      is_read = true;
    }
  } catch (const InputError&) {
  }
  try {
    const robots::ImportedScene scene =
        robots::import_urdf(file.path(), "/proc/self/fd", "fuzzed", {});
    is_read = true;
    input::parse_scene(scene.text, "fuzzed.toml");
  } catch (const InputError&) {
  }
  return is_read;
}

std::vector<std::string> seeds() {
  return {
      "<robot name=\"r\"><link name=\"base\"/>\n<link name=\"tip\"><inertial><mass value=\"1\"/>"
      "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>\n"
      "<collision><origin xyz=\"0 0 1\" rpy=\"1 0 0\"/><geometry><box size=\"1 1 1\"/></geometry>"
      "</collision></link>\n<joint name=\"j\" type=\"revolute\"><parent link=\"base\"/>"
      "<child link=\"tip\"/><axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" "
      "velocity=\"1\"/><dynamics damping=\"0.1\" friction=\"0.2\"/></joint>\n"
      "<link name=\"b\"><visual><geometry><capsule radius=\".1\" length=\"1\"/></geometry></visual>"
      "</link><joint name=\"k\" type=\"prismatic\"><parent link=\"tip\"/><child link=\"b\"/>"
      "<limit lower=\"0\" upper=\"1\"/><mimic joint=\"j\" multiplier=\"2\"/></joint></robot>\n",
      "<robot name=\"r\"><link name=\"a\"><contact><lateral_friction value=\"1\"/></contact>"
      "<visual><geometry><mesh filename=\"package://p/a.dae\" scale=\"1 -1 1\"/></geometry>"
      "</visual></link>\n<gazebo reference=\"a\"><mu1>0.3</mu1></gazebo></robot>\n",
      "<mujoco><compiler angle='radian' eulerseq='XYZ'/>\n<default><joint range='0 1'/>"
      "<default class='c'><geom density='200'/></default></default>\n<worldbody>"
      "<frame pos='1 2 3' euler='1 0 0' childclass='c'><body name='a' gravcomp='1'>"
      "<joint name='j' actuatorfrcrange='-1 1'/><geom type='box' size='1 1 1' fromto='0 0 0 1 0 "
      "0'/>"
      "<site name='s' pos='1 0 0'/></body></frame></worldbody>\n<actuator><position joint='j' "
      "kp='2' "
      "dampratio='1'/></actuator><equality><connect site1='s' site2='s'/></equality>"
      "<keyframe><key qpos='0' ctrl='1'/></keyframe></mujoco>\n",
      "<mujoco><worldbody>\n<replicate count='12' sep='-' offset='.1 0 0' euler='0 0 30'>"
      "<body name='a'><joint name='j'/>\n<replicate count='2'><geom name='g' size='.1'/>"
      "</replicate></body></replicate></worldbody>\n<actuator><motor joint='k'/></actuator>"
      "</mujoco>\n"};
}
#else
bool read(std::string_view) { return false; }
std::vector<std::string> seeds() { return {}; }
#endif

}  // namespace

const Target robot_import = {"robot_import", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
