// softfinger lint as a user sees it: which numbers of a robot's file are impossible, and the limits
// against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
using nlohmann::json;

class Lint : public testing::Test {
 protected:
  TemporaryFolder folder;
  Start start{folder.path(), {}, -1, "", ""};

  ProgramRun lint(const std::string& file, const std::string& text,
                  const std::vector<std::string>& more = {}) {
    folder.write(file, text);
    std::vector<std::string> arguments = {"lint", file};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_softfinger(start, arguments);
  }
  json results(const std::string& file, const std::string& text,
               std::vector<std::string> more = {}) {
    more.emplace_back("--json");
    const ProgramRun run = lint(file, text, more);
    EXPECT_EQ(run.err, "");
    const json report = json::parse(run.out);
    EXPECT_EQ(report["schema"], 2);
    EXPECT_EQ(report["numbers"], report["results"].size());
    EXPECT_EQ(run.status, report["impossible"] > 0 ? 1 : 0);
    return report["results"];
  }
  static std::string model(const std::string& geom, const std::string& rest = "") {
    return "<mujoco>\n" + rest + "<worldbody><body name='f'>\n<geom name='tip' " + geom +
           "/>\n</body></worldbody></mujoco>";
  }
};

TEST_F(Lint, StatesTheLeversOfPunchAndHertz) {
  const json all =
      results("a.xml", model("size='.008' condim='4' friction='0.8 .002 .0001'"), {"--load", "2"});
  ASSERT_EQ(all.size(), 3u);
  const json& spin = all[1];
  EXPECT_EQ(spin["name"], "friction[1]");
  EXPECT_EQ(spin["line"], 3);
  EXPECT_EQ(spin["verdict"], "possible");
  EXPECT_TRUE(spin["type"].is_null());
  // mu pi/4 R, and mu 3 pi/16 a with a^3 = 3 P R/(4 E*), E* = E/(1 - 1/4).
  const double a_m = std::cbrt(0.75 * 2 * 0.008 / (1e7 / 0.75));
  EXPECT_NEAR(spin["most"].get<double>(), 0.8 * M_PI / 4 * 0.008, 1e-12);
  EXPECT_NEAR(spin["least"].get<double>(), 0.8 * 3 * M_PI / 16 * a_m, 1e-12);
  // A softer pad has a larger circle.
  const json softer = results("a.xml", model("size='.008' condim='4' friction='0.8 .002 .0001'"),
                              {"--load", "2", "--youngs-modulus-kPa", "1250"});
  EXPECT_NEAR(softer[1]["least"].get<double>(), 2 * spin["least"].get<double>(), 1e-12);
}

TEST_F(Lint, RefusesALeverLongerThanTheGeom) {
  // A cube of 10 mm reaches half its diagonal, 7.07 mm.
  const auto verdict = [&](const std::string& friction) {
    return results("a.xml", model("type='box' size='.005 .005 .005' condim='4' friction='" +
                                  friction + "'"))[1];
  };
  EXPECT_EQ(verdict("1 .4 .0001")["verdict"], "impossible");
  EXPECT_NE(verdict("1 .4 .0001")["reason"].get<std::string>().find("a lever of 400 mm"),
            std::string::npos);
  EXPECT_EQ(verdict("1 .0072 .0001")["verdict"], "impossible");
  EXPECT_EQ(verdict("1 .0069 .0001")["verdict"], "doubtful") << "more than a rigid punch";
  EXPECT_EQ(verdict("1 .002 .0001")["verdict"], "possible");
  EXPECT_EQ(verdict("1 .00001 .0001")["verdict"], "doubtful") << "less than Hertz";
  // The lever is the torque over the friction force.
  EXPECT_EQ(verdict("0.5 .0036 .0001")["verdict"], "impossible");
  EXPECT_EQ(verdict("0 .001 .0001")["verdict"], "impossible");
  const ProgramRun run =
      lint("a.xml", model("type='box' size='.005 .005 .005' condim='4' friction='1 .4 .0001'"));
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(lines(run.out).front(), "1 of 3 numbers is impossible: a.xml:3: friction[1] = .4");
  EXPECT_NE(run.out.find("type: "), std::string::npos);
}

TEST_F(Lint, TakesAFlatFacesOwnOutline) {
  // Uniform pressure on 22 x 37.5 mm has a lever of 11.62 mm, a rigid punch some 3 pi/8 times that;
  // the circle of this area has 10.8 and 12.7 mm.
  const auto verdict = [&](const std::string& friction) {
    return results("a.xml", model("type='box' size='.011 .004 .01875' condim='4' friction='" +
                                  friction + "'"))[1];
  };
  EXPECT_NEAR(verdict("1 .0135 .0001")["most"].get<double>(), 3 * M_PI / 8 * 11.62e-3, 1e-5);
  EXPECT_EQ(verdict("1 .0135 .0001")["verdict"], "possible");
  EXPECT_EQ(verdict("1 .0140 .0001")["verdict"], "doubtful");
}

TEST_F(Lint, KnowsMujocosRanges) {
  const auto verdicts = [&](const std::string& attributes, const std::string& rest = "") {
    std::string text;
    for (const json& number : results("a.xml", model("size='.01' " + attributes, rest)))
      text += number["verdict"].get<std::string>().substr(0, 1);
    return text;
  };
  EXPECT_EQ(verdicts("solimp='.9 .95 .001 .5 2'"), "ppppp");
  EXPECT_EQ(verdicts("solimp='.9 1.5 -1 2 .5'"), "piiii");
  EXPECT_EQ(verdicts("solimp='0 1'"), "dd");
  EXPECT_EQ(verdicts("solref='.02 1'"), "pp");
  EXPECT_EQ(verdicts("solref='-1000 -10'"), "pp");
  EXPECT_EQ(verdicts("solref='-1000 1'"), "ii");
  EXPECT_EQ(verdicts("solref='0 0'"), "ip");
  EXPECT_EQ(verdicts("solref='.003 1'"), "dp") << "less than two steps of 2 ms";
  EXPECT_EQ(verdicts("solref='.003 1'", "<option timestep='.001'/>"), "pp");
  EXPECT_EQ(verdicts("friction='1e6'"), "i") << "an ODE value";
  EXPECT_EQ(verdicts("friction='-1'"), "i");
  EXPECT_EQ(verdicts("friction='x'"), "i");
  EXPECT_EQ(verdicts(""), "");
}

TEST_F(Lint, SaysThatACondimHasNoTorque) {
  const auto verdicts = [&](const std::string& attributes, const std::string& rest = "") {
    std::string text;
    for (const json& number : results("a.xml", model("size='.01' " + attributes, rest)))
      text += number["verdict"].get<std::string>().substr(0, 1);
    return text;
  };
  EXPECT_EQ(verdicts("friction='1 .003 .0001'"), "pip");
  EXPECT_EQ(verdicts("friction='1 .005 .0001'"), "ppp") << "MuJoCo's own numbers say nothing";
  EXPECT_EQ(verdicts("condim='4' friction='1 .003 .001'"), "ppi");
  EXPECT_EQ(verdicts("condim='6' friction='1 .003 .001'"), "ppp");
  // The larger condim of two geoms counts.
  EXPECT_EQ(verdicts("friction='1 .003 .0001'",
                     "<worldbody><geom name='o' size='.02' condim='4'/></worldbody>"),
            "ppp");
}

TEST_F(Lint, JudgesADefaultOnTheSmallestGeomThatTakesIt) {
  const std::string text =
      "<mujoco><default>\n<geom condim='4' friction='1 .01 .0001'/>\n<default class='big'>\n"
      "<geom friction='1 .012 .0001'/></default></default><worldbody><body>"
      "<geom name='a' size='.02'/><geom name='b' size='.008'/>"
      "<geom name='seen' size='.001' contype='0' conaffinity='0'/>"
      "<geom name='c' size='.02' class='big'/></body></worldbody></mujoco>";
  const json all = results("a.xml", text);
  ASSERT_EQ(all.size(), 6u);
  EXPECT_EQ(all[1]["line"], 2);
  EXPECT_EQ(all[1]["verdict"], "impossible");
  EXPECT_NE(all[1]["reason"].get<std::string>().find("geom \"b\""), std::string::npos);
  EXPECT_EQ(all[4]["line"], 4);
  EXPECT_EQ(all[4]["verdict"], "possible");
}

TEST_F(Lint, ReadsPairsAndIncludedFiles) {
  folder.write("tip.xml", "<mujoco>\n<geom name='tip' size='.01'/></mujoco>");
  const std::string text =
      "<mujoco><worldbody><geom name='floor' type='plane' size='1 1 1'/><body>"
      "<include file='tip.xml'/></body></worldbody><contact>\n<pair geom1='tip' geom2='floor' "
      "condim='4' friction='1 1 .25 .0001 .0001'/></contact></mujoco>";
  const json all = results("a.xml", text);
  ASSERT_EQ(all.size(), 5u);
  EXPECT_EQ(all[2]["verdict"], "impossible");
  EXPECT_NE(all[2]["reason"].get<std::string>().find("a lever of 250 mm"), std::string::npos);
  folder.write("tip.xml", "<mujoco>\n<geom name='tip' size='.01' friction='11'/></mujoco>");
  EXPECT_EQ(results("a.xml", text)[0]["file"], "tip.xml");
}

TEST_F(Lint, JudgesUrdfAndSdf) {
  const std::string urdf =
      "<robot name='r'><link name='tip'><collision><geometry><sphere radius='.01'/></geometry>"
      "</collision>\n<contact><lateral_friction value='1'/><spinning_friction value='.1'/>"
      "<rolling_friction value='.0001'/></contact></link>\n"
      "<gazebo reference='tip'><mu1>1000000.0</mu1><mu2 value='.8'/><kp>1e6</kp></gazebo></robot>";
  const json all = results("a.urdf", urdf);
  ASSERT_EQ(all.size(), 6u);
  EXPECT_EQ(all[0]["verdict"], "possible");
  EXPECT_EQ(all[1]["verdict"], "impossible") << "a lever of 100 mm on a ball of 10 mm";
  EXPECT_EQ(all[2]["verdict"], "possible");
  EXPECT_EQ(all[3]["verdict"], "impossible");
  EXPECT_EQ(all[3]["line"], 3);
  EXPECT_EQ(all[4]["verdict"], "possible");
  // 2 E* R of a rigid punch.
  EXPECT_EQ(all[5]["verdict"], "impossible");
  EXPECT_NEAR(all[5]["most"].get<double>(), 2 * 1e7 / 0.75 * 0.01, 1e-6);

  const std::string sdf =
      "<sdf version='1.9'><model name='m'><link name='l'><collision name='c'><geometry><sphere>"
      "<radius>.01</radius></sphere></geometry><surface><friction><ode><mu>1</mu></ode><torsional>"
      "<coefficient>1</coefficient><patch_radius>PATCH</patch_radius></torsional></friction>"
      "</surface></collision></link></model></sdf>";
  for (const auto& [patch, verdict] :
       {std::pair("0.005", "possible"), std::pair("0.1", "impossible"),
        std::pair("-1", "impossible")}) {
    std::string text = sdf;
    text.replace(text.find("PATCH"), 5, patch);
    EXPECT_EQ(results("a.sdf", text).back()["verdict"], verdict) << patch;
  }
}

TEST_F(Lint, RefusesWhatIsNoRobot) {
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& more,
                          const std::string& words) {
    const ProgramRun run = lint("a.xml", text, more);
    EXPECT_EQ(run.status, 2) << run.out;
    EXPECT_EQ(lines(run.err).size(), 1u) << run.err;
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
  };
  refuse("<html/>", {}, "<mujoco>, <robot> (URDF) or <sdf>");
  refuse("<mujoco", {}, "a.xml:1");
  refuse("<robot name='r'>\n<xacro:macro name='x'/></robot>", {}, "a.xml:2: <xacro:macro>");
  refuse(model("size='1'"), {"--load", "0"}, "--load");
  refuse(model("size='1'"), {"--youngs-modulus-kPa", "x"}, "--youngs-modulus-kPa");
  EXPECT_EQ(lint("a.xml", model("size='.01'")).out,
            "no number on friction or stiffness is typed in the file\n");
  EXPECT_EQ(lint("a.xml", model("size='.01' friction='.8'")).out,
            "none of 1 number is impossible\n");
}

}  // namespace softfinger::tests
