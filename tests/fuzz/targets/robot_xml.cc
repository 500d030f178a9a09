// Models of robots: each finger of a file is given a contact, and what was written is read again.

#include <cmath>
#include <exception>

#include "comparisons/exporting/robot_file.h"
#include "comparisons/exporting/robot_lint.h"
#include "comparisons/exporting/shape_pad.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

using exporting::RobotContact;
using exporting::XmlFile;

RobotContact wanted_contact() {
  RobotContact wanted;
  wanted.contact.friction_coefficient = 0.8;
  wanted.contact.load_N = 2;
  wanted.contact.eccentricity_m = 1e-3;
  wanted.contact.indentation_m = 2e-4;
  wanted.contact.normal_stiffness_N_per_m = 1e4;
  wanted.contact.radii = {0.02, 0.01, 0};
  wanted.contact.origin = "fuzzed";
  wanted.torque_error = "torque";
  wanted.force_error = "force";
  return wanted;
}

/// All of a file's changes once, and none when they are there.
void apply_twice(const std::string& text, const std::string& finger,
                 const exporting::Simulator& simulator, const RobotContact& wanted) {
  std::string once;
  try {
    XmlFile file(text, "fuzzed.xml");
    exporting::apply_contact(file, {finger}, simulator, {wanted});
    once = file.text();
  } catch (const InputError&) {
    return;
  }
  try {
    XmlFile again(once, "written.xml");
    exporting::apply_contact(again, {finger}, simulator, {wanted});
  } catch (const InputError&) {
    std::terminate();  // what was written is not read
  }
}

/// The pads of a file's shapes, and the judgement of its numbers.
void judge(const XmlFile& file) {
  try {
    const exporting::RobotShapes shapes =
        read_shapes(file, exporting::format_of(file), exporting::Mjcf(file));
    for (const exporting::RobotShape& shape : shapes.shapes)
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
        const exporting::ShapePad towards = exporting::pad_towards(shape.kind, direction);
        const exporting::ShapePad near = exporting::pad_near(shape.kind, 0.01 * direction);
        if (std::isnan(towards.minor_radius_m) || std::isnan(near.minor_radius_m)) std::terminate();
      }
    for (const exporting::LintedNumber& number :
         exporting::lint(file, {}, [](const exporting::NamedMesh&) { return std::nullopt; }))
      if (number.verdict != exporting::LintVerdict::possible && number.reason.empty())
        std::terminate();
  } catch (const InputError&) {
  }
}

bool read(std::string_view bytes) {
  const std::string text(bytes);
  try {
    const XmlFile file(text, "fuzzed.xml");
    if (file.text() != text) std::terminate();
    format_of(file);
    judge(file);
  } catch (const InputError&) {
    return false;
  }
  for (const char* simulator : {"mujoco", "gazebo", "drake", "bullet"})
    for (const char* finger : {"tip", "finger"})
      apply_twice(text, finger, *exporting::find_simulator(simulator), wanted_contact());
  return true;
}

std::vector<std::string> seeds() {
  return {
      "<mujoco><option timestep='0.002'/><option cone=\"pyramidal\"/>\n<worldbody>\n"
      "  <body name='finger'>\n    <geom name='tip' size='.01' friction='1 .1 .2'/>\n    <geom "
      "size='.02'/>\n  "
      "</body>\n"
      "</worldbody><contact><pair geom1='floor' geom2='tip'/></contact></mujoco>\n",
      "<?xml version=\"1.0\"?>\n<robot name='r'><!-- a comment --><link name=\"tip\"><collision>"
      "<geometry><sphere radius=\"0.01\"/></geometry></collision>"
      "<contact><lateral_friction value=\"1\"/></contact></link>\n"
      "<gazebo reference='tip'><mu1 value='1'/><mu2/></gazebo></robot>\n",
      "<sdf version='1.9'><model name='m'><link name='finger'><collision name='tip'><geometry><box>"
      "<size>.01 .02 .03</size></box></geometry><surface><friction><ode><mu>1</mu></ode>"
      "</friction></surface></collision></link></model></sdf>\n"};
}

}  // namespace

const Target robot_xml = {"robot_xml", read, seeds, nullptr, true};

}  // namespace softfinger::fuzz
