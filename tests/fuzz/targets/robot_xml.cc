// Models of robots: each finger of a file is given a contact, and what was written is read again.

#include <exception>

#include "comparisons/exporting/robot_file.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

using exporting::RobotContact;
using exporting::XmlFile;

RobotContact wanted_contact() {
  RobotContact wanted;
  wanted.contact = {0.8, 2, 1e-3, 2e-4, 1e4, {0.02, 0.01, 0}, "fuzzed"};
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

bool read(std::string_view bytes) {
  const std::string text(bytes);
  try {
    const XmlFile file(text, "fuzzed.xml");
    if (file.text() != text) std::terminate();
    format_of(file);
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
      "  <body name='finger'>\n    <geom name='tip' size='.01'/>\n    <geom size='.02'/>\n  "
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
