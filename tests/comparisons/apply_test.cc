// softfinger apply as a user sees it: what changes in the file, what does not, what is refused.
// That simulators read the result is tested in mujoco_apply_test.cc and sdformat_apply_test.cc.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

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
  expect_refusal("robot.urdf", with({}), "--output is missing");
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
  refuse("robot.urdf", {"--finger", "base", "--to", "gazebo"}, "allowed: tip");
  refuse("robot.urdf", {"--finger", "tip", "--to", "gazebo", "--plugin"}, "--to mujoco");
  refuse("nothing.xml", {"--finger", "tip", "--to", "mujoco"}, "nothing.xml");
  refuse("hand.xml", {"--finger", "tip_1", "--to", "mujoco", "--effective-mass-g", "nan"},
         "--effective-mass-g");
}

}  // namespace softfinger::tests
