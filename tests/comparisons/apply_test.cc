// softfinger apply as a user sees it: what changes in the file, what does not, what is refused.
// That simulators read the result is tested in mujoco_apply_test.cc and sdformat_apply_test.cc.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "softfinger/input/constants.h"
#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace fs = std::filesystem;
using nlohmann::json;

class Apply : public testing::Test {
 protected:
  TemporaryFolder folder;
  Start start{folder.path(), {}, -1, "", ""};

  static constexpr const char* kUrdf =
      "<?xml version=\"1.0\"?>\r\n<robot name='r'>\r\n"
      "  <!-- <link name=\"tip\"/> in a comment -->\r\n"
      "  <link name=\"base\"/>\r\n"
      "  <link name=\"tip\">\r\n"
      "    <collision><geometry><sphere radius=\"0.01\"/></geometry></collision>\r\n"
      "  </link>\r\n"
      "  <joint name=\"j\" type=\"fixed\"><parent link=\"base\"/><child link=\"tip\"/></joint>\r\n"
      "</robot>\r\n";

  void SetUp() override {
    folder.write("hand.xml", file_text(SOFTFINGER_HAND));
    folder.write("robot.urdf", kUrdf);
  }
  ProgramRun apply(const std::string& model, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"apply", model, "silicone_pad_2mm"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_softfinger(start, arguments);
  }
  void expect_refusal(const std::string& model, const std::vector<std::string>& more,
                      const std::string& words) {
    const ProgramRun run = apply(model, more);
    EXPECT_EQ(run.status, 2) << run.out;
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(folder.path() / "out")) << words;
  }
  void expect_text_refused(const std::string& text, const std::string& words) {
    folder.write("bad.xml", text);
    expect_refusal("bad.xml", {"--finger", "tip", "--to", "mujoco", "-o", "out"}, words);
  }
};

TEST_F(Apply, ListsEachChangeAndKeepsEveryOtherByte) {
  const ProgramRun run =
      apply("hand.xml", {"--finger", "tip_1", "--to", "mujoco", "-o", "soft.xml", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json report = json::parse(run.out);
  EXPECT_EQ(report["format"], "MJCF");
  std::vector<std::string> names;
  for (const json& change : report["changes"]) {
    names.push_back(change["name"]);
    EXPECT_EQ(change["element"], "geom \"tip_1\"");
    EXPECT_GT(change["line"].get<int>(), 0);
    EXPECT_TRUE(change["before"].is_null());
    EXPECT_FALSE(change["effect"].get<std::string>().empty());
  }
  EXPECT_EQ(names, (std::vector<std::string>{"condim", "priority", "friction"}));

  // With the listed changes undone, the file is the one that was read.
  std::string text = file_text(folder.path() / "soft.xml");
  for (const json& change : report["changes"]) {
    const std::string added =
        " " + change["name"].get<std::string>() + "=\"" + change["after"].get<std::string>() + "\"";
    const std::size_t at = text.find(added, text.find("<geom name=\"tip_1\""));
    ASSERT_NE(at, std::string::npos) << added;
    text.erase(at, added.size());
  }
  EXPECT_EQ(text, file_text(SOFTFINGER_HAND));

  // The error over the loads is that of export.
  const json exported = json::parse(
      run_softfinger(start, {"export", "silicone_pad_2mm", "--to", "mujoco", "--json"}).out);
  EXPECT_EQ(report["loads"].size(), exported["loads"].size());
  for (std::size_t i = 0; i < report["loads"].size(); ++i)
    EXPECT_EQ(report["loads"][i]["relative_error"], exported["loads"][i]["relative_error"]);
}

TEST_F(Apply, ASecondTimeChangesNothing) {
  for (const std::string to : {"bullet", "drake", "gazebo"}) {
    ASSERT_EQ(apply("robot.urdf", {"--finger", "tip", "--to", to, "-o", "once"}).status, 0);
    const ProgramRun again =
        apply("once", {"--finger", "tip", "--to", to, "-o", "twice", "--json"});
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_TRUE(json::parse(again.out)["changes"].empty()) << again.out;
    EXPECT_EQ(file_text(folder.path() / "once"), file_text(folder.path() / "twice"));
    EXPECT_NE(
        file_text(folder.path() / "once").find("<!-- <link name=\"tip\"/> in a comment -->\r\n"),
        std::string::npos);
  }
}

TEST_F(Apply, WritesInPlaceOnlyWhenAsked) {
  const std::vector<std::string> finger = {"--finger", "tip", "--to", "bullet"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), finger.begin(), finger.end());
    return more;
  };
  const ProgramRun listed = apply("robot.urdf", with({}));
  EXPECT_EQ(listed.status, 0) << listed.err;
  EXPECT_NE(listed.out.find("Nothing is written"), std::string::npos) << listed.out;
  expect_refusal("robot.urdf", with({"-o", "./robot.urdf"}), "another file than MODEL");
  expect_refusal("robot.urdf", with({"-o", "out", "--in-place"}), "--in-place");
  EXPECT_EQ(file_text(folder.path() / "robot.urdf"), kUrdf);
  EXPECT_EQ(apply("robot.urdf", with({"--in-place"})).status, 0);
  EXPECT_NE(file_text(folder.path() / "robot.urdf").find("spinning_friction"), std::string::npos);
}

TEST_F(Apply, KeepsModesAndLinksOfAFileInPlace) {
  const fs::path robot = folder.path() / "robot.urdf", link = folder.path() / "link.urdf";
  const std::vector<std::string> in_place = {"--finger", "tip", "--to", "bullet", "--in-place"};
  const auto refused = [&](const char* name, const std::string& words) {
    const ProgramRun run = apply(name, in_place);
    EXPECT_EQ(run.status, 2) << run.out;
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
    EXPECT_EQ(file_text(robot), kUrdf);
  };
  fs::permissions(robot, fs::perms(0444));
  refused("robot.urdf", "read-only");
  fs::permissions(robot, fs::perms(0600));
  fs::create_hard_link(robot, folder.path() / "twin.urdf");
  refused("robot.urdf", "hard links");
  fs::remove(folder.path() / "twin.urdf");
  fs::create_symlink("robot.urdf", link);
  const ProgramRun run = apply("link.urdf", in_place);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_NE(file_text(robot).find("spinning_friction"), std::string::npos);
  EXPECT_EQ(fs::status(robot).permissions(), fs::perms(0600));
}

TEST_F(Apply, WritesToStandardOutputAndToDevices) {
  const std::vector<std::string> finger = {"--finger", "tip", "--to", "bullet", "-o"};
  const auto to = [&](const std::string& output) {
    std::vector<std::string> more = finger;
    more.push_back(output);
    return apply("robot.urdf", more);
  };
  ASSERT_EQ(to("out").status, 0);
  const ProgramRun shown = to("/dev/stdout");
  EXPECT_EQ(shown.status, 0) << shown.err;
  EXPECT_EQ(shown.out, file_text(folder.path() / "out")) << "the file and nothing else";
  EXPECT_NE(shown.err.find("spinning_friction"), std::string::npos) << "the report";
  EXPECT_EQ(to("/dev/null").status, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_TRUE(fs::is_symlink("/dev/stdout"));
  EXPECT_EQ(to("/dev/full").status, 2);
}

TEST_F(Apply, ReadsStandardInput) {
  folder.write("in", kUrdf);
  start.input = (folder.path() / "in").string();
  EXPECT_EQ(apply("-", {"--finger", "tip", "--to", "bullet", "-o", "out"}).status, 0);
  EXPECT_NE(file_text(folder.path() / "out").find("lateral_friction value=\"0.8\""),
            std::string::npos);
}

TEST_F(Apply, TakesPairsOptionsAndHigherPrioritiesOfMjcfAlong) {
  folder.write(
      "pair.xml",
      "<mujoco><option timestep='0.002' impratio='20'/><option cone=\"pyramidal\"/>"
      "<worldbody><geom name='floor' type='plane' size='1 1 1' priority='3'/>"
      "<body name='finger'><geom name='tip' size='.01' condim=\"6\"/><geom size='.02'/></body>"
      "</worldbody><contact><pair geom1='floor' geom2='tip'/></contact></mujoco>");
  ASSERT_EQ(apply("pair.xml", {"--finger", "finger", "--to", "mujoco", "-o", "out"}).status, 0);
  const std::string text = file_text(folder.path() / "out");
  const auto expect = [&](const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  };
  expect("<option timestep='0.002' impratio='20' noslip_iterations=\"5\"/>");
  expect("<option cone=\"elliptic\"/>");
  expect("<geom name='tip' size='.01' condim=\"6\" priority=\"4\" friction=\"0.8 0.0012");
  expect("<geom size='.02' condim=\"4\" priority=\"4\"");
  expect("<pair geom1='floor' geom2='tip' condim=\"4\" friction=\"0.8 0.8 0.0012");
}

TEST_F(Apply, LeavesOutGeomsThatTouchNothing) {
  const auto model = [&](const std::string& more = "") {
    folder.write(
        "seen.xml",
        "<mujoco><default><default class='hand'><default class='seen'><geom contype='0' "
        "conaffinity='0'/></default></default></default><worldbody><body name='finger' "
        "childclass='seen'><geom name='a' size='.01'/><geom name='b' size='.01' class='hand'/>"
        "</body><body name='shown'><geom name='c' size='.01' contype='0' conaffinity='0'/></body>"
        "</worldbody>" +
            more + "</mujoco>");
  };
  model();
  ASSERT_EQ(apply("seen.xml", {"--finger", "finger", "--to", "mujoco", "-o", "soft.xml"}).status,
            0);
  const std::string text = file_text(folder.path() / "soft.xml");
  EXPECT_NE(text.find("<geom name='a' size='.01'/>"), std::string::npos) << text;
  EXPECT_NE(text.find("<geom name='b' size='.01' class='hand' condim"), std::string::npos) << text;
  for (const char* finger : {"a", "shown"})
    expect_refusal("seen.xml", {"--finger", finger, "--to", "mujoco", "-o", "out"},
                   "contype and conaffinity are 0");
  // A pair makes it touch.
  model("<contact><pair geom1='a' geom2='c'/></contact>");
  EXPECT_EQ(apply("seen.xml", {"--finger", "a", "--to", "mujoco", "-o", "out"}).status, 0);
}

TEST_F(Apply, KeepsTheRollingFrictionThatAClassGives) {
  folder.write("class.xml",
               "<mujoco><default><default class='x'><geom condim='6' friction='1 .1 .2' "
               "priority='7'/><pair condim='6' friction='1 1 .1 .3 .4'/></default></default>"
               "<worldbody><geom name='floor' type='plane' size='1 1 .1'/><body name='f' "
               "childclass='x'><geom name='tip' size='.01'/></body></worldbody><contact>"
               "<pair class='x' geom1='floor' geom2='tip'/></contact></mujoco>");
  ASSERT_EQ(apply("class.xml", {"--finger", "tip", "--to", "mujoco", "-o", "out"}).status, 0);
  const std::string text = file_text(folder.path() / "out");
  const std::size_t tip = text.find("<geom name='tip'"), pair = text.find("<pair class");
  const auto element = [&](std::size_t at) { return text.substr(at, text.find('>', at) - at); };
  for (const std::size_t at : {tip, pair})
    EXPECT_EQ(element(at).find("condim"), std::string::npos) << element(at);
  EXPECT_NE(element(tip).find(" .2\""), std::string::npos) << element(tip);
  EXPECT_NE(element(pair).find(" .3 .4\""), std::string::npos) << element(pair);
  // The class itself may be the object's, too.
  EXPECT_NE(element(tip).find("priority=\"8\""), std::string::npos) << element(tip);
}

TEST_F(Apply, RefusesFlagsUnderWhichFrictionHasNoEffect) {
  const auto model = [](const std::string& option) {
    return "<mujoco>" + option +
           "<worldbody><geom name='floor' type='plane' size='1 1 .1'/><body name='f'>"
           "<geom name='tip' size='.01'/></body></worldbody></mujoco>";
  };
  for (const std::string flag :
       {"contact=\"disable\"", "constraint=\"disable\"", "override=\"enable\""})
    expect_text_refused(model("\n<option>\n<flag " + flag + "/></option>"),
                        "bad.xml:3: <flag " + flag + "/>");
  expect_text_refused(model("<option collision='predefined'/>"), "<pair>");
  // The last one counts.
  folder.write("on.xml", model("<option><flag contact='disable'/></option>"
                               "<option><flag contact='enable'/></option>"));
  EXPECT_EQ(apply("on.xml", {"--finger", "tip", "--to", "mujoco", "-o", "out"}).status, 0);
}

TEST_F(Apply, SaysWhatElseDecidesAboutTheContact) {
  const auto notes_of = [&](const std::string& root, const std::string& tip,
                            const std::string& rest) {
    folder.write("model.xml", "<mujoco>" + root +
                                  "<worldbody><geom name='floor' type='plane' size="
                                  "'1 1 .1'/><body name='f'><geom name='tip' size='.01' " +
                                  tip + "/></body></worldbody>" + rest + "</mujoco>");
    const ProgramRun run =
        apply("model.xml", {"--finger", "tip", "--to", "mujoco", "-o", "soft.xml", "--json"});
    EXPECT_EQ(run.status, 0) << run.err;
    const json report = json::parse(run.out);
    for (const json& change : report["changes"])
      if (change["name"] == "priority") {
        EXPECT_EQ(change["effect"] == "this geom's friction counts, not the object's",
                  root.empty());
      }
    // On standard error, too.
    for (const json& note : report["notes"])
      EXPECT_NE(run.err.find(note.get<std::string>()), std::string::npos) << run.err;
    return report["notes"];
  };
  EXPECT_EQ(notes_of("", "", ""), json::array());
  const auto has_one = [](const json& notes, const std::string& words) {
    ASSERT_EQ(notes.size(), 1u) << notes;
    EXPECT_NE(notes[0].get<std::string>().find(words), std::string::npos) << notes;
  };
  has_one(notes_of("<include file='floor.xml'/>", "", ""), "includes floor.xml, which is not read");
  has_one(notes_of("<asset><model file='box.xml'/></asset>", "", ""), "box.xml");
  has_one(notes_of("", "", "<contact><exclude body1='f' body2='world'/></contact>"),
          "\"f\" and \"world\" do not touch");
  has_one(notes_of("", "contype='2' conaffinity='4'", ""),
          "none fits its contype 2 and conaffinity 4");
  EXPECT_EQ(notes_of("", "contype='1' conaffinity='0'", ""), json::array());
}

TEST_F(Apply, ChangesThousandsOfGeomsOfOneBodyInOneLine) {
  constexpr int kGeoms = 8000;
  std::string text = "<mujoco><worldbody><body name='f' childclass='x'>";
  for (int i = 0; i < kGeoms; ++i) text += "<geom name='g" + std::to_string(i) + "' size='.01'/>";
  folder.write("many.xml", text +
                               "</body></worldbody><default><default class='x'/></default>"
                               "</mujoco>");
  const ProgramRun run = apply(
      "many.xml", {"--finger", "f", "--to", "mujoco", "--plugin", "-o", "soft.xml", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json report = json::parse(run.out);
  int frictions = 0;
  for (const json& change : report["changes"]) frictions += change["name"] == "friction";
  EXPECT_EQ(frictions, kGeoms);
}

TEST_F(Apply, SaysTheNamesThatTellCollisionsApart) {
  const auto model = [](const std::string& name) {
    return "<model name='" + name +
           "'><link name='l'><collision name='c'><geometry><sphere><radius>0.01</radius></sphere>"
           "</geometry></collision></link></model>";
  };
  folder.write("two.sdf",
               "<sdf version='1.9'><world name='w'>" + model("m") + model("n") + "</world></sdf>");
  for (const char* finger : {"l::c", "c"})
    expect_refusal("two.sdf", {"--finger", finger, "--to", "gazebo", "-o", "out"},
                   "2 have this name; name it m::l::c or n::l::c");
  EXPECT_EQ(apply("two.sdf", {"--finger", "n::l::c", "--to", "gazebo", "-o", "out"}).status, 0);
}

TEST_F(Apply, NeedsTheDepthOfAMeshForDrake) {
  std::string text = kUrdf;
  const std::string sphere = "<sphere radius=\"0.01\"/>";
  text.replace(text.find(sphere), sphere.size(), "<mesh filename=\"tip.stl\"/>");
  folder.write("robot.urdf", text);
  expect_refusal("robot.urdf", {"--finger", "tip", "--to", "drake", "-o", "out"}, "--depth-mm");
  const auto modulus_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = {"--finger", "tip", "--to", "drake", "-o", "made", "--json"};
    all.insert(all.end(), more.begin(), more.end());
    const json report = json::parse(apply("robot.urdf", all).out);
    for (const json& change : report["changes"])
      if (change["name"].get<std::string>().find("modulus") != std::string::npos)
        return std::stod(change["after"].get<std::string>());
    return 0.;
  };
  const double six_digits = 1e-5;
  const double of_mesh = modulus_of({"--depth-mm", "10"});
  folder.write("robot.urdf", kUrdf);
  EXPECT_NEAR(of_mesh / modulus_of({}), 1, six_digits) << "the sphere's radius is 10 mm";
}

TEST_F(Apply, RefusesHostileAndBrokenFilesInOneLine) {
  std::string bomb = "<!DOCTYPE m [<!ENTITY a \"aaaaaaaaaa\">";
  for (char letter = 'b'; letter < 'k'; ++letter)
    bomb += std::string("<!ENTITY ") + letter + " \"&" + char(letter - 1) + ";&" +
            char(letter - 1) + ";\">";
  expect_text_refused(bomb + "]><mujoco>&j;</mujoco>", "DOCTYPE");
  expect_text_refused("", "bad.xml");
  expect_text_refused("<mujoco>", "bad.xml:1");
  expect_text_refused("<mujoco>\n<worldbody>\n</mujoco>", "well-formed");
  expect_text_refused(std::string("<mujoco>\0</mujoco>", 18), "a byte of zero");
  expect_text_refused("<html/>", "<mujoco>, <robot> (URDF) or <sdf>");
  expect_text_refused("<mujoco/><mujoco/>", "bad.xml");
  expect_text_refused("<mujoco><worldbody/></mujoco>", "the file has none");
  expect_text_refused("<mujoco><include file='a.xml'/></mujoco>", "the file includes others");
  std::string deep = "<mujoco>";
  for (int i = 0; i < 100'000; ++i) deep += "<body>";
  expect_text_refused(deep, "depth");
  expect_text_refused("<mujoco>" + std::string(20'000'000, ' ') + "</mujoco>", "bad.xml");
  const std::string geom = "<body><geom name='tip'/></body>";
  expect_text_refused("<mujoco><worldbody>" + geom + geom + "</worldbody></mujoco>",
                      "2 have this name");
}

TEST_F(Apply, RefusesWhatFitsNeitherFileNorSimulator) {
  const std::vector<std::string> out = {"-o", "out"};
  const auto refuse = [&](const std::string& model, std::vector<std::string> more,
                          const std::string& words) {
    more.insert(more.end(), out.begin(), out.end());
    expect_refusal(model, more, words);
  };
  refuse("hand.xml", {"--finger", "tip_11", "--to", "mujoco"}, "did you mean \"tip_1\"?");
  refuse("hand.xml", {"--finger", "tip_1", "--to", "drake"}, "mujoco for MJCF");
  refuse("robot.urdf", {"--finger", "tip", "--to", "mujoco"}, "save the model as MJCF");
  refuse("robot.urdf", {"--finger", "tip", "--to", "physx"}, "export --to physx");
  refuse("robot.urdf", {"--finger", "tip", "--to", "gazbo"}, "did you mean \"gazebo\"?");
  refuse("robot.urdf", {"--finger", "base", "--to", "gazebo"},
         "robot.urdf:4: link \"base\" has no collision: allowed: one with a shape: tip");
  refuse("robot.urdf", {"--finger", "bass", "--to", "gazebo"}, "allowed: tip");
  refuse("robot.urdf", {"--finger", "tip", "--to", "gazebo", "--plugin"}, "--to mujoco");
  refuse("nothing.xml", {"--finger", "tip", "--to", "mujoco"}, "nothing.xml");
  refuse("hand.xml", {"--finger", "tip_1", "--to", "mujoco", "--effective-mass-g", "nan"},
         "--effective-mass-g");
}

/// A robot whose fingers have shapes of all kinds, hinges that close towards +x, and one jaw.
constexpr const char* kShapes =
    "<mujoco><compiler angle='radian'/><default><geom type='sphere' size='.008'/>"
    "<joint axis='0 1 0' range='-.2 1.6'/></default><worldbody>"
    "<geom name='floor' type='plane' size='1 1 1'/><body name='palm'>\n"
    "<body name='ball' pos='0 0 -.05'><joint name='j'/><geom name='ball_tip' pos='0 0 "
    "-.03'/></body>"
    "<body name='rod'><geom name='rod_tip' type='capsule' size='.007 .02'/></body>\n"
    "<body name='egg'><geom name='egg_tip' type='ellipsoid' size='.01 .008 .006' "
    "friction='1 .005 .0001'/></body>\n"
    "<body name='brick'><geom name='brick_tip' type='box' size='.01 .01 .005'/></body>\n"
    "<body name='can'><geom name='can_tip' type='cylinder' size='.01 .02'/></body>"
    "</body></worldbody></mujoco>";

ProgramRun apply_shapes(const Start& start, const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"apply",      "shapes.xml", "--to",   "mujoco",
                                        "--layer",    "2,300,0.45", "--load", "2",
                                        "--friction", "0.8",        "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_softfinger(start, arguments);
}

TEST_F(Apply, TakesTheRadiiOfTheFingersOwnShape) {
  folder.write("shapes.xml", kShapes);
  const auto expect_radii = [&](std::vector<std::string> more, double major_mm, double minor_mm) {
    more.insert(more.end(), {"--tolerance", "0.15"});
    const ProgramRun run = apply_shapes(start, more);
    ASSERT_EQ(run.status, 0) << run.err;
    const json finger = json::parse(run.out)["fingers"][0];
    const double round_off = 1e-9;
    EXPECT_NEAR(1e3 * finger["relative_radii_m"][0].get<double>(), major_mm, round_off) << finger;
    EXPECT_NEAR(1e3 * finger["relative_radii_m"][1].get<double>(), minor_mm, round_off) << finger;
    // A case with these radii on the finger has these numbers.
    folder.write("case.toml", "id = \"case\"\n[geometry]\nfinger = { radii_mm = [" +
                                  std::to_string(major_mm) + ", " + std::to_string(minor_mm) +
                                  "] }\nobject = { radii_mm = [inf, inf] }\n[layer]\n"
                                  "thickness_mm = 2\nyoungs_modulus_kPa = 300\npoisson_ratio = "
                                  "0.45\n[contact]\nload_N = 2\nfriction_coefficient = 0.8\n");
    if (std::find(more.begin(), more.end(), "--object-radius-mm") != more.end()) return;
    const json exported =
        json::parse(run_softfinger(start, {"export", "case.toml", "--to", "mujoco", "--tolerance",
                                           "0.15", "--json"})
                        .out);
    // Six decimals of the radii in mm.
    EXPECT_NEAR(finger["eccentricity_m"].get<double>() / exported["eccentricity_m"].get<double>(),
                1, 1e-5);
  };
  expect_radii({"--finger", "ball", "--pad", "-z"}, 8, 8);
  expect_radii({"--finger", "ball_tip"}, 8, 8);
  expect_radii({"--finger", "rod_tip", "--pad", "+z"}, 7, 7);
  expect_radii({"--finger", "egg_tip", "--pad", "+z"}, 100. / 6, 64. / 6);
  expect_radii({"--finger", "egg_tip", "--pad", "-x"}, 64. / 10, 36. / 10);
  expect_radii({"--finger", "egg_tip", "--pad", "egg_tip:0,8,0"}, 100. / 8, 36. / 8);
  // Against a ball of radius R: 1/(1/r + 1/R).
  expect_radii({"--finger", "ball_tip", "--object-radius-mm", "24"}, 6, 6);
  expect_radii({"--finger", "rod_tip", "--pad", "+x", "--object-radius-mm", "21"}, 21, 5.25);
}

TEST_F(Apply, WritesACaseOfEachFingersOwnShape) {
  folder.write("shapes.xml", kShapes);
  const ProgramRun run =
      apply_shapes(start, {"--finger", "ball", "--finger", "egg_tip", "--finger", "brick", "--pad",
                           "egg_tip:+z", "--pad", "brick:+z", "--write-cases", "cases"});
  EXPECT_NE(run.err.find("cases/egg_tip.toml"), std::string::npos) << run.err;
  const json report = json::parse(run.out);
  ASSERT_EQ(report["fingers"].size(), 3u);
  for (const json& finger : report["fingers"]) {
    const std::string name = "cases/" + finger["finger"].get<std::string>() + ".toml";
    const ProgramRun predicted = run_softfinger(start, {"predict", name, "--json"});
    ASSERT_LE(predicted.status, 1) << predicted.err;
    const json answers = json::parse(predicted.out);
    double torque_Nm = 0;
    for (const json& result : answers["results"])
      if (result["model"] == finger["pressure_model"]) torque_Nm = result["max_torque_Nm"];
    // Numbers are written so that they read back as they are.
    EXPECT_NEAR(torque_Nm / finger["max_torque_Nm"].get<double>(), 1, 1e-13) << name;
  }
  EXPECT_EQ(apply_shapes(start, {"--finger", "ball", "--write-cases", "cases", "--set",
                                 "layer.thickness_mm=3"})
                .status,
            2);
}

TEST_F(Apply, GivesEachFingerItsOwnNumbersInOneRun) {
  folder.write("shapes.xml", kShapes);
  const ProgramRun run = apply_shapes(
      start, {"--finger", "ball", "--finger", "egg_tip", "--pad", "egg_tip:+z", "-o", "soft.xml"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json report = json::parse(run.out);
  const std::string text = file_text(folder.path() / "soft.xml");
  ASSERT_EQ(report["fingers"].size(), 2u);
  for (const json& finger : report["fingers"]) {
    const double spin_m = 0.8 * finger["eccentricity_m"].get<double>();
    char friction[40];
    std::snprintf(friction, sizeof friction, "0.8 %.6g 0.0001", spin_m);
    EXPECT_NE(text.find(friction), std::string::npos) << friction << "\n" << text;
  }
  EXPECT_NE(report["fingers"][0]["eccentricity_m"], report["fingers"][1]["eccentricity_m"]);
  EXPECT_EQ(report["fingers"][0]["shape"], "a sphere of radius 8 mm");
  // The hinge about +y moves what hangs below it towards -x where it turns by a positive angle.
  EXPECT_EQ(report["fingers"][0]["pad"], "towards -x, where joint \"j\" closes");
  EXPECT_EQ(report["fingers"][0]["pad_is_guessed"], true);
  EXPECT_EQ(report["fingers"][1]["pad_is_guessed"], false);
  EXPECT_NE(run.err.find("ball: the pad is guessed towards -x"), std::string::npos) << run.err;
}

class ApplyPad : public Apply {
 protected:
  /// A pad of 22 x 37.5 mm as a box, the round end of a cylinder, and a mesh.
  void SetUp() override {
    folder.write("pads.xml",
                 "<mujoco><asset><mesh name='m' file='block.stl'/></asset><worldbody><body "
                 "name='jaw'>\n"
                 "<geom name='box' type='box' size='.011 .004 .01875' condim='6' pos='0 0 1'/>\n"
                 "<geom name='can' type='cylinder' size='.01 .02'/>\n"
                 "<geom name='block' type='mesh' mesh='m' pos='.2 0 0' axisangle='1 0 0 90'/>\n"
                 "</body></worldbody></mujoco>\n");
    folder.write("block.stl", block_text());
    folder.write("pad.urdf",
                 "<robot name='r'><link name='tip'><collision><geometry>"
                 "<box size='.022 .0375 .01'/></geometry></collision></link></robot>\n");
  }
  /// 22 x 37.5 x 10 mm
  static std::string block_text() {
    const double half_m[] = {0.011, 0.01875, 0.005};
    std::string text = "solid block\n";
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1., 1.})
        for (const double other : {-1., 1.}) {
          // The corners of a triangle, outward by the right hand.
          double corners[3][3];
          const double turn[3][2] = {
              {-1, -1}, {1, other > 0 ? -1. : 1.}, {other > 0 ? 1. : -1., 1}};
          for (int c = 0; c < 3; ++c) {
            const int at = side > 0 ? c : 2 - c;
            corners[c][axis] = side * half_m[axis];
            corners[c][(axis + 1) % 3] = turn[at][0] * half_m[(axis + 1) % 3];
            corners[c][(axis + 2) % 3] = turn[at][1] * half_m[(axis + 2) % 3];
          }
          text += "facet normal 0 0 0\nouter loop\n";
          for (const auto& corner : corners) {
            char line[100];
            std::snprintf(line, sizeof line, "vertex %g %g %g\n", corner[0], corner[1], corner[2]);
            text += line;
          }
          text += "endloop\nendfacet\n";
        }
    return text + "endsolid\n";
  }
  ProgramRun apply_pad(const std::string& model, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"apply",      model, "--layer", "3,800,0.49",
                                          "--friction", "0.9", "--load",  "20"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_softfinger(start, arguments);
  }
  json finger_of(const std::string& model, std::vector<std::string> more) {
    more.emplace_back("--json");
    const ProgramRun run = apply_pad(model, more);
    EXPECT_EQ(run.status, 0) << run.err;
    return json::parse(run.out)["fingers"][0];
  }
  double eccentricity_m(const std::vector<std::string>& pad) {
    std::vector<std::string> arguments = {
        "predict", "--thickness-mm", "3",  "--youngs-modulus-kPa", "800", "--poisson-ratio",
        "0.49",    "--load",         "20", "--friction",           "0.9", "--json"};
    arguments.insert(arguments.end(), pad.begin(), pad.end());
    return json::parse(run_softfinger(start, arguments).out)["results"][0]["eccentricity_m"];
  }
};

TEST_F(ApplyPad, HasTheNumbersOfTheFaceItself) {
  const double rectangle_m = eccentricity_m({"--pad-mm", "22,37.5"}),
               disc_m = eccentricity_m({"--pad-diameter-mm", "20"});
  const struct {
    std::string model, finger, pad, to;
    double expected_m, corner_m;
  } pads[] = {
      {"pads.xml", "box", "+y", "mujoco", rectangle_m, std::hypot(11e-3, 18.75e-3)},
      {"pads.xml", "block", "-y", "mujoco", rectangle_m, std::hypot(11e-3, 18.75e-3)},
      {"pads.xml", "block", "block:203,-5,2", "mujoco", rectangle_m, std::hypot(11e-3, 18.75e-3)},
      {"pads.xml", "can", "-z", "mujoco", disc_m, 10e-3},
      {"pad.urdf", "tip", "+z", "bullet", rectangle_m, std::hypot(11e-3, 18.75e-3)},
      {"pad.urdf", "tip", "+z", "gazebo", rectangle_m, std::hypot(11e-3, 18.75e-3)}};
  for (const auto& pad : pads) {
    SCOPED_TRACE(pad.finger + " to " + pad.to);
    const std::vector<std::string> words = {"--finger", pad.finger, "--pad",
                                            pad.pad,    "--to",     pad.to};
    const json finger = finger_of(pad.model, words);
    EXPECT_EQ(finger["contact"], "patch");
    EXPECT_TRUE(finger["relative_radii_m"].is_null());
    // A mesh has single precision.
    EXPECT_NEAR(finger["eccentricity_m"].get<double>() / pad.expected_m, 1, 1e-6);
    std::vector<std::string> with_json = words;
    with_json.emplace_back("--json");
    const ProgramRun run = apply_pad(pad.model, with_json);
    // Points at the corners carry the load there; a disc is a polygon of its area. Corners of this
    // rectangle hold up to 1.3685 times as much in ODE's friction pyramids.
    EXPECT_NEAR(json::parse(run.out)["worst_relative_error"].get<double>(),
                pad.corner_m / pad.expected_m * (pad.to == "gazebo" ? 1.3685 : 1) - 1, 0.01);
    EXPECT_NE(run.err.find("too much torque"), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(finger["corner_shape"].get<std::string>()), std::string::npos);
  }
}

TEST_F(ApplyPad, JoinsBoxesInOnePlane) {
  // Two boxes of 22 x 18.75 mm side by side; then with a gap as wide as one of them.
  const auto answer = [&](const char* finger, const char* height) {
    folder.write("two.xml",
                 "<mujoco><worldbody><body name='jaw'>"
                 "<geom name='low' type='box' size='.011 .004 .009375' pos='0 0 -.009375'/>"
                 "<geom name='high' type='box' size='.011 .004 .009375' pos='0 0 " +
                     std::string(height) + "'/></body></worldbody></mujoco>");
    return apply_pad("two.xml", {"--finger", finger, "--pad", "+y", "--to", "mujoco", "--json"});
  };
  const double rectangle_m = eccentricity_m({"--pad-mm", "22,37.5"}),
               half_m = eccentricity_m({"--pad-mm", "22,18.75"});
  const auto eccentricity_of = [](const ProgramRun& run) {
    return json::parse(run.out)["fingers"][0]["eccentricity_m"].get<double>();
  };
  const ProgramRun together = answer("jaw", ".009375");
  // Corners of joined boxes are places in the file, with their rounding.
  EXPECT_NEAR(eccentricity_of(together) / rectangle_m, 1, 1e-6);
  EXPECT_EQ(together.err.find("more of its shapes"), std::string::npos) << together.err;
  const json finger = json::parse(together.out)["fingers"][0];
  EXPECT_NE(finger["corner_shape"].get<std::string>().find("<geom type=\"box\""),
            std::string::npos);
  EXPECT_NEAR(finger["pad_in_body_m"][2].get<double>(), 0, 1e-12);
  EXPECT_NEAR(eccentricity_of(answer("low", ".009375")) / half_m, 1, 1e-6);
  const ProgramRun apart = answer("jaw", ".028125");
  EXPECT_NEAR(eccentricity_of(apart) / half_m, 1, 1e-6);
  EXPECT_NE(apart.err.find("1 more of its shapes"), std::string::npos) << apart.err;
}

TEST_F(ApplyPad, WritesNoTorsionalFriction) {
  ASSERT_EQ(
      apply_pad("pads.xml", {"--finger", "box", "--pad", "+y", "--to", "mujoco", "-o", "o.xml"})
          .status,
      0);
  const std::string text = file_text(folder.path() / "o.xml");
  EXPECT_NE(text.find("size='.011 .004 .01875' condim='3'"), std::string::npos) << text;
  EXPECT_NE(text.find("friction=\"0.9 0 "), std::string::npos) << text;
  ASSERT_EQ(
      apply_pad("pad.urdf", {"--finger", "tip", "--pad", "+z", "--to", "bullet", "-o", "o.urdf"})
          .status,
      0);
  EXPECT_NE(file_text(folder.path() / "o.urdf").find("<spinning_friction value=\"0\"/>"),
            std::string::npos);
}

TEST_F(ApplyPad, LosesTheRollingFrictionOfItsClass) {
  folder.write("pads.xml",
               "<mujoco><default><default class='foot'><geom condim='6' friction='1 .1 .02'/>"
               "</default></default><worldbody><body name='leg'><geom name='box' class='foot' "
               "type='box' size='.011 .004 .01875'/></body></worldbody></mujoco>");
  const ProgramRun run =
      apply_pad("pads.xml", {"--finger", "box", "--pad", "+y", "--to", "mujoco", "-o", "o.xml"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(file_text(folder.path() / "o.xml").find("condim=\"3\""), std::string::npos);
  EXPECT_NE(file_text(folder.path() / "o.xml").find("friction=\"0.9 0 0.0001\""),
            std::string::npos);
}

TEST_F(ApplyPad, ShrinksTheShapeUntilItsCornersHaveTheTorque) {
  const double e_m = eccentricity_m({"--pad-mm", "22,37.5"}),
               disc_m = eccentricity_m({"--pad-diameter-mm", "20"});
  const json finger = finger_of("pads.xml", {"--finger", "box", "--pad", "+y", "--to", "mujoco",
                                             "--shrink-pads", "-o", "o.xml"});
  double x_m = 0, y_m = 0, z_m = 0;
  const std::string text = file_text(folder.path() / "o.xml");
  ASSERT_EQ(std::sscanf(text.c_str() + text.find("size="), "size='%lf %lf %lf'", &x_m, &y_m, &z_m),
            3)
      << text;
  // Files have six digits.
  EXPECT_NEAR(std::hypot(x_m, z_m) / e_m, 1, 1e-5);
  EXPECT_NEAR(x_m / z_m, 22 / 37.5, 1e-5);
  EXPECT_EQ(y_m, 0.004) << "it is as thick as it was";
  ASSERT_EQ(apply_pad("pads.xml", {"--finger", "can", "--pad", "+z", "--to", "mujoco",
                                   "--shrink-pads", "-o", "o.xml"})
                .status,
            0);
  const std::string round = file_text(folder.path() / "o.xml");
  ASSERT_EQ(std::sscanf(round.c_str() + round.find("size=", round.find("can")), "size='%lf %lf'",
                        &x_m, &y_m),
            2);
  EXPECT_NEAR(x_m / disc_m, 1, 1e-5);
  EXPECT_EQ(y_m, 0.02);
  // URDF has whole lengths.
  ASSERT_EQ(apply_pad("pad.urdf", {"--finger", "tip", "--pad", "+z", "--to", "bullet",
                                   "--shrink-pads", "-o", "o.urdf"})
                .status,
            0);
  const std::string urdf = file_text(folder.path() / "o.urdf");
  ASSERT_EQ(std::sscanf(urdf.c_str() + urdf.find("size="), "size='%lf %lf %lf'", &x_m, &y_m, &z_m),
            3)
      << urdf;
  EXPECT_NEAR(std::hypot(x_m, y_m) / 2 / e_m, 1, 1e-5);
  EXPECT_EQ(z_m, 0.01);
  for (const std::vector<std::string>& refused : std::vector<std::vector<std::string>>{
           {"pads.xml", "--finger", "block", "--pad", "-y", "--to", "mujoco"},
           {"pads.xml", "--finger", "jaw", "--pad", "+y", "--to", "mujoco"},
           {"pad.urdf", "--finger", "tip", "--pad", "+z", "--to", "drake"}}) {
    std::vector<std::string> words(refused.begin() + 1, refused.end());
    words.emplace_back("--shrink-pads");
    const ProgramRun run = apply_pad(refused[0], words);
    EXPECT_EQ(run.status, 2) << run.out;
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
  }
}

TEST_F(ApplyPad, HasItsStiffnessInDrake) {
  const json finger =
      finger_of("pad.urdf", {"--finger", "tip", "--pad", "+z", "--to", "drake", "-o", "o.urdf"});
  const std::string text = file_text(folder.path() / "o.urdf"),
                    name = "hydroelastic_modulus value=\"";
  const double modulus_Pa = std::atof(text.c_str() + text.find(name) + name.size());
  // Pressure is modulus times depth over half the box's height, 5 mm, on the whole face.
  EXPECT_NEAR(
      modulus_Pa / 5e-3 * 22e-3 * 37.5e-3 / finger["normal_stiffness_N_per_m"].get<double>(), 1,
      1e-5);
}

TEST_F(Apply, RefusesPadsWithoutAnEllipse) {
  folder.write("shapes.xml", kShapes);
  const auto refuse = [&](const std::vector<std::string>& more, const std::string& words) {
    const ProgramRun run = apply_shapes(start, more);
    EXPECT_EQ(run.status, 2) << run.out;
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
  };
  refuse({"--finger", "rod", "--pad", "+x"}, "shapes.xml:2: the pad of \"rod\", the side of");
  refuse({"--finger", "rod", "--pad", "+x"}, "--object-radius-mm");
  refuse({"--finger", "brick", "--pad", "+z", "--object-radius-mm", "20"}, "no --object-radius-mm");
  refuse({"--finger", "brick", "--pad", "+z", "--plugin"}, "none for a flat pad");
  refuse({"--finger", "brick", "--pad", "+z", "--model", "bonded_layer"}, "none for a flat pad");
  refuse({"--finger", "can", "--pad", "+z", "--object-radius-mm", "20"}, "an end of the cylinder");
  refuse({"--finger", "can", "--pad", "+x"}, "along a line");
  refuse({"--finger", "floor"}, "a plane");
  refuse({"--finger", "egg"}, "on which side");
  refuse({"--finger", "egg", "--pad", "up"}, "--pad");
  refuse({"--finger", "egg", "--pad", "eg:+z"}, "did you mean \"egg\"?");
  refuse({"--finger", "egg", "--pad", "+z", "--pad", "-z"}, "one pad for each finger");
  refuse({"--finger", "egg", "--pad", "0,0,9"}, "3 mm away");
  refuse({"--finger", "ball", "--object-radius-mm", "0"}, "--object-radius-mm");
  refuse({"--finger", "ball", "--thickness-mm", "2"}, "the layer once");
  // A tilted plane touches the end 0.2 mm beside the side, and the contact is 3 mm long.
  refuse({"--finger", "rod", "--pad", "7,0,20.2"}, "reaches beyond an end of the capsule");
  for (const char* layer : {"2,300", "2,300,0.49,1", "2,300,0.6", "0,300,0.4", "a,b,c", "2,300,"})
    refuse({"--finger", "ball", "--layer", layer}, "--layer");
  EXPECT_EQ(run_softfinger(start, {"apply", "shapes.xml", "--finger", "ball", "--to", "mujoco"})
                    .err.find("CASE is missing: allowed: --layer") == std::string::npos,
            false);
}

/// The pad after `words` in a refusal, or in the reason of an answer that is not usable.
std::string proposed_pad(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words + "--pad ");
  if (at == std::string::npos) return "";
  const std::size_t begin = at + words.size() + 6;
  const std::size_t end = text.find_first_of(" ;\"\n", begin);
  std::string pad = text.substr(begin, end - begin);
  if (!pad.empty() && pad.back() == ',') pad.pop_back();
  return pad;
}

TEST_F(Apply, ARefusedPadNamesOneThatIsTaken) {
  folder.write("shapes.xml", kShapes);
  const auto taken = [&](const std::string& finger, const std::string& pad) {
    const ProgramRun run = apply_shapes(start, {"--finger", finger, "--pad", pad});
    EXPECT_EQ(run.status, 0) << run.err;
    return run.status == 0 ? json::parse(run.out)["fingers"][0] : json();
  };
  const ProgramRun line = apply_shapes(start, {"--finger", "rod", "--pad", "+x"});
  const std::string end = proposed_pad(line.err, "such as its end, ");
  EXPECT_EQ(end, "rod:0.0000,0.0000,27.0000") << line.err;
  const json tip = taken("rod", end);
  EXPECT_NEAR(tip["relative_radii_m"][0].get<double>(), 7e-3, 1e-12);
  // A joint that turns as far to both sides says nothing. The geom is tilted out of the joint.
  folder.write("shapes.xml",
               "<mujoco><worldbody><body name='leg'><joint axis='0 1 0' range='-60 60'/>"
               "<geom name='foot' pos='.01 0 -.05' type='capsule' size='.008 .01'/>"
               "<body name='ball'><geom size='.008'/></body></body></worldbody></mujoco>");
  const ProgramRun side = apply_shapes(start, {"--finger", "foot"});
  EXPECT_EQ(side.status, 2);
  EXPECT_EQ(proposed_pad(side.err, "allowed: "), "foot:-z") << side.err;
  taken("foot", "foot:-z");
  // A ball has no side to guess.
  const ProgramRun ball = apply_shapes(start, {"--finger", "ball"});
  ASSERT_EQ(ball.status, 0) << ball.err;
  EXPECT_EQ(json::parse(ball.out)["fingers"][0]["pad"], "towards +z, as all its sides are alike");
}

TEST_F(Apply, AMeshThatTouchesAlongALineNamesItsFlatEnd) {
  // Prisms, 10 mm in radius and 40 mm high. The sides of the coarse one are facets, and no pads.
  for (const int sides : {12, 64}) {
    std::string stl = "solid can\n";
    const auto corner = [&](int side, double z_m) {
      char text[100];
      const double angle = 2 * kPi * side / sides;
      std::snprintf(text, sizeof text, "vertex %.9g %.9g %g\n", 0.01 * std::cos(angle),
                    0.01 * std::sin(angle), z_m);
      return std::string(text);
    };
    const auto facet = [&](const std::string& one, const std::string& two,
                           const std::string& three) {
      stl += "facet normal 0 0 0\nouter loop\n" + one + two + three + "endloop\nendfacet\n";
    };
    for (int side = 0; side < sides; ++side) {
      const std::string low = corner(side, 0), next_low = corner(side + 1, 0),
                        high = corner(side, 0.04), next_high = corner(side + 1, 0.04);
      facet(low, next_low, next_high);
      facet(low, next_high, high);
      facet("vertex 0 0 0.04\n", high, next_high);
      facet("vertex 0 0 0\n", next_low, low);
    }
    folder.write("can.stl", stl + "endsolid\n");
    folder.write(
        "shapes.xml",
        "<mujoco><asset><mesh name='m' file='can.stl'/></asset><worldbody><body "
        "name='finger'><geom name='can' type='mesh' mesh='m'/></body></worldbody></mujoco>");
    const ProgramRun run = apply_shapes(start, {"--finger", "can", "--pad", "10,0,20"});
    EXPECT_NE(run.status, 0) << run.out;
    const std::string pad =
        proposed_pad(run.out + run.err, sides == 64 ? "or a flat side, 20 x 20 mm: "
                                                    : "or a flat side, 19.3 x 19.3 mm: ");
    ASSERT_FALSE(pad.empty()) << run.out << run.err;
    const ProgramRun taken = apply_shapes(start, {"--finger", "can", "--pad", pad});
    ASSERT_EQ(taken.status, 0) << taken.err;
    EXPECT_EQ(json::parse(taken.out)["fingers"][0]["contact"], "patch");
  }
}

TEST_F(Apply, ReadsATextWithAZeroAtItsEnd) {
  const std::string text = std::string(kUrdf) + '\0';
  folder.write("zero.urdf", text);
  ASSERT_EQ(apply("zero.urdf", {"--finger", "tip", "--to", "bullet", "-o", "out"}).status, 0);
  EXPECT_EQ(file_text(folder.path() / "out").back(), '\0') << "the rest keeps its bytes";
}

TEST_F(Apply, GuessesThatAPadFacesTheOtherFingers) {
  // Two jaws slide along y, and a third finger stands beside them on a hinge of two sides.
  folder.write(
      "shapes.xml",
      "<mujoco><compiler angle='radian'/><default><geom size='.01'/></default><worldbody>"
      "<body name='hand'><body name='left' pos='0 .05 0'><joint type='slide' axis='0 1 0' "
      "range='0 .04'/><geom name='left_tip'/></body><body name='right' pos='0 -.05 0' "
      "euler='0 0 3.14159265358979'><joint type='slide' axis='0 1 0' range='0 .04'/>"
      "<geom name='right_tip'/></body><body name='third' pos='.1 .05 0'><joint name='both' "
      "axis='0 1 0' range='-1 1'/><geom name='third_tip'/></body></body></worldbody>"
      "</mujoco>");
  const auto pads_of = [&](const std::vector<std::string>& more) {
    const ProgramRun run = apply_shapes(start, more);
    EXPECT_EQ(run.status, 0) << run.err;
    std::vector<std::string> pads;
    const json report = json::parse(run.out);
    for (const json& finger : report["fingers"]) pads.push_back(finger["pad"]);
    return pads;
  };
  using Pads = std::vector<std::string>;
  EXPECT_EQ(pads_of({"--finger", "left"}), Pads{"towards -y, which faces right"});
  // The other jaw is turned by half a turn: its own -y faces the first.
  EXPECT_EQ(pads_of({"--finger", "right"}), Pads{"towards -y, which faces left"});
  EXPECT_EQ(pads_of({"--finger", "left", "--finger", "third"}),
            (Pads{"towards +x, which faces third", "towards -x, which faces left"}));
  // Both jaws lie in the middle at [0, 0, 0]: as far along x as half along y.
  EXPECT_EQ(pads_of({"--finger", "third", "--finger", "left", "--finger", "right"})[0],
            "towards [-0.89, -0.45, 0.00], which faces left, right");
  // Unnamed ones count where no other finger is named.
  EXPECT_EQ(pads_of({"--finger", "third"}),
            Pads{"towards [-0.89, -0.45, 0.00], which faces left, right"});
}

TEST_F(Apply, PrintsTheLinesWhereMujocoReadsNoFriction) {
  const std::vector<std::string> arguments = {
      "apply",      "robot.urdf", "--finger", "tip",        "--pad", "+z",   "--layer",
      "2,300,0.45", "--load",     "2",        "--friction", "0.8",   "--to", "mujoco"};
  const ProgramRun run = run_softfinger(start, arguments);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out.rfind("2 N: torque", 0), 0u) << run.out;
  EXPECT_NE(run.out.find("radii of the gap 10 x 10 mm"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("friction=\"0.8 0.00"), std::string::npos) << run.out;
  std::vector<std::string> written = arguments;
  written.insert(written.end(), {"-o", "out"});
  const ProgramRun refused = run_softfinger(start, written);
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("save the model as MJCF first"), std::string::npos) << refused.err;
}

TEST_F(Apply, ChangesTheFileThatHoldsTheGeom) {
  const std::string finger =
      "<mujocoinclude>\n<body name='f'><include file='tip.xml'/></body></mujocoinclude>\n";
  const std::string tip = "<mujoco><geom name='tip' size='.008'/></mujoco>\n";
  const std::string main =
      "<mujoco><include file='common.xml'/><worldbody><geom name='floor' type='plane' size='1 1 1' "
      "priority='2'/><include file='parts/finger.xml'/></worldbody></mujoco>\n";
  const std::string common =
      "<mujoco><option cone='elliptic' impratio='10' "
      "noslip_iterations='5'/></mujoco>\n";
  const fs::path parts = folder.path() / "parts";
  fs::create_directory(parts);
  folder.write("main.xml", main);
  folder.write("common.xml", common);
  folder.write("parts/finger.xml", finger);
  folder.write("parts/tip.xml", tip);
  const std::vector<std::string> options = {"--finger", "tip", "--to", "mujoco"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), options.begin(), options.end());
    return more;
  };
  expect_refusal("main.xml", with({"-o", "out"}), "geom \"tip\" lies in parts/tip.xml");
  // A folder gets all files, of which one is different.
  const ProgramRun copied = apply("main.xml", with({"-o", "copy/", "--json"}));
  ASSERT_EQ(copied.status, 0) << copied.err;
  const json report = json::parse(copied.out);
  EXPECT_EQ(report["outputs"].size(), 4u);
  for (const json& change : report["changes"]) EXPECT_EQ(change["file"], "parts/tip.xml");
  EXPECT_EQ(report["changes"].size(), 3u) << "condim, priority, friction: the options are there";
  const fs::path copy = folder.path() / "copy";
  EXPECT_EQ(file_text(copy / "main.xml"), main);
  EXPECT_EQ(file_text(copy / "common.xml"), common);
  EXPECT_EQ(file_text(copy / "parts/finger.xml"), finger);
  const std::string changed = file_text(copy / "parts/tip.xml");
  EXPECT_EQ(changed.rfind("<mujoco><geom name='tip' size='.008' condim=\"4\" priority=\"3\" "
                          "friction=\"0.8 0.00",
                          0),
            0u)
      << changed;
  EXPECT_EQ(file_text(parts / "tip.xml"), tip) << "an input is not changed";
  // In place, the one that holds the geom.
  ASSERT_EQ(apply("main.xml", with({"--in-place"})).status, 0);
  EXPECT_EQ(file_text(parts / "tip.xml"), changed);
  EXPECT_EQ(file_text(folder.path() / "main.xml"), main);
  // The file of the body alone, whose root is no model.
  folder.write("parts/tip.xml", tip);
  const ProgramRun part = apply("parts/finger.xml", with({"--in-place"}));
  ASSERT_EQ(part.status, 0) << part.err;
  EXPECT_NE(part.err.find("a part of a model"), std::string::npos) << part.err;
  EXPECT_NE(file_text(parts / "tip.xml").find("friction=\"0.8"), std::string::npos);
  EXPECT_EQ(file_text(parts / "finger.xml"), finger) << "no <option> among bodies";
}

TEST_F(Apply, RefusesFilesThatIncludeEachOther) {
  folder.write("main.xml", "<mujoco>\n<include file='b.xml'/></mujoco>");
  folder.write("b.xml", "<mujoco>\n\n<include file='main.xml'/></mujoco>");
  const std::vector<std::string> options = {"--finger", "tip", "--to", "mujoco", "-o", "out"};
  expect_refusal("main.xml", options, "b.xml:3: file = \"main.xml\": allowed: each file once");
  folder.write("main.xml", "<mujoco><include file='b.xml'/><include file='./b.xml'/></mujoco>");
  folder.write("b.xml", "<mujoco/>");
  expect_refusal("main.xml", options, "each file once");
  folder.write("b.xml", "<mujoco");
  folder.write("main.xml", "<mujoco><include file='b.xml'/></mujoco>");
  expect_refusal("main.xml", options, "b.xml");
}

TEST_F(Apply, TakesTheMeshOfARobot) {
  // A ball of 8 mm as a mesh in mm, mirrored by its scale.
  std::string stl = "solid ball\n";
  constexpr int kRows = 60, kColumns = 120;
  const auto point = [](int row, int column) {
    const double a = M_PI * row / kRows, b = 2 * M_PI * column / kColumns;
    char line[100];
    std::snprintf(line, sizeof line, "vertex %.7f %.7f %.7f\n", 8 * std::sin(a) * std::cos(b),
                  8 * std::sin(a) * std::sin(b), 8 * std::cos(a) + 30);
    return std::string(line);
  };
  const auto facet = [&](const std::string& corners) {
    stl += "facet normal 0 0 0\nouter loop\n" + corners + "endloop\nendfacet\n";
  };
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const std::string a = point(row, column), b = point(row + 1, column),
                        c = point(row + 1, (column + 1) % kColumns),
                        d = point(row, (column + 1) % kColumns);
      if (row + 1 < kRows) facet(a + b + c);
      if (row > 0) facet(a + c + d);
    }
  fs::create_directory(folder.path() / "meshes");
  folder.write("meshes/ball.stl", stl + "endsolid ball\n");
  for (const char* scale : {".001 .001 .001", ".001 .001 -.001"}) {
    folder.write("robot.urdf",
                 "<robot name='r'><link name='tip'><collision><origin xyz='0 .1 0'/>"
                 "<geometry><mesh filename='package://r/meshes/ball.stl' scale='" +
                     std::string(scale) + "'/></geometry></collision></link></robot>");
    const ProgramRun run = run_softfinger(
        start, {"apply", "robot.urdf", "--finger", "tip", "--pad", "-y", "--layer", "2,300,0.45",
                "--load", "1", "--friction", "0.8", "--to", "bullet", "--force", "--json"});
    const json finger = json::parse(run.out)["fingers"][0];
    // Edges are 0.42 mm long: facets lie up to 6 um inside of the ball, and its lowest vertex half
    // an edge at most beside the pad.
    EXPECT_NEAR(1e3 * finger["relative_radii_m"][0].get<double>(), 8, 0.1) << run.err;
    EXPECT_NEAR(finger["pad_in_body_m"][1].get<double>(), 0.092, 2e-5);
    EXPECT_NEAR(finger["pad_in_body_m"][2].get<double>(), scale[10] == '-' ? -.03 : .03, 2e-4);
    run_softfinger(start, {"apply", "robot.urdf", "--finger", "tip", "--pad", "-y", "--layer",
                           "2,300,0.45", "--load", "1", "--friction", "0.8", "--to", "bullet",
                           "--force", "--write-cases", "cases"});
    const json predicted = json::parse(
        run_softfinger(start, {"predict", "cases/tip.toml", "--model", "fingertip_layer", "--json"})
            .out)["results"][0];
    // The farthest vertex stands for the side: up to half an edge from the pad that apply found.
    EXPECT_NEAR(predicted["max_torque_Nm"].get<double>() / finger["max_torque_Nm"].get<double>(), 1,
                5e-3);
  }
  fs::remove(folder.path() / "meshes/ball.stl");
  const ProgramRun missing =
      run_softfinger(start, {"apply", "robot.urdf", "--finger", "tip", "--pad", "-y", "--layer",
                             "2,300,0.45", "--load", "1", "--to", "bullet"});
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("--package-path DIR"), std::string::npos) << missing.err;
}

TEST_F(Apply, TakesTwentyThousandFingersInSeconds) {
  constexpr int kFingers = 20'000;
  std::string text = "<mujoco><worldbody>";
  std::vector<std::string> arguments = {"apply", "many.xml",   "--layer", "2,300,0.45", "--load",
                                        "2",     "--friction", "0.8",     "--pad",      "+z",
                                        "--to",  "mujoco",     "-o",      "soft.xml",   "--json"};
  for (int i = 0; i < kFingers; ++i) {
    const std::string number = std::to_string(i);
    text += "<body name='b" + number + "'><geom name='g" + number + "' size='.01' contype='" +
            number + "'/></body>";
    arguments.insert(arguments.end(), {"--finger", "g" + number});
  }
  folder.write("many.xml", text + "</worldbody></mujoco>");
  const ProgramRun run = run_softfinger(start, arguments);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(json::parse(run.out)["fingers"].size(), std::size_t(kFingers));
}

}  // namespace softfinger::tests
