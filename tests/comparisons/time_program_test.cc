// Rubber that relaxes, as users of `softfinger predict` and `softfinger export` see it.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
using nlohmann::json;

class TimeProgram : public testing::Test {
 protected:
  TemporaryFolder folder;
  Start start{folder.path(), {}, -1, ""};

  /// A fingertip of 2 mm of silicone that loses a fifth of its modulus.
  std::string case_with(const std::string& contact,
                        const std::string& layer =
                            "relaxation = [{ share = 0.15, time_s = 0.5 }, { share = 0.05, time_s "
                            "= 5 }]\n") {
    return folder
        .write("creep.toml",
               "[geometry]\nrelative_radii_mm = [20, 12]\n[layer]\nthickness_mm = 2\n"
               "youngs_modulus_kPa = 300\npoisson_ratio = 0.49\n" +
                   layer + "[contact]\nfriction_coefficient = 0.8\n" + contact + "\n")
        .string();
  }
  ProgramRun run(const std::vector<std::string>& arguments) {
    return run_softfinger(start, arguments);
  }
  json predicted(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "predict");
    arguments.insert(arguments.end(), {"--model", "bonded_layer", "--json"});
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out);
  }
  void expect_refusal(const std::vector<std::string>& arguments, const std::string& part) {
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 2) << result.out << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  }
};

const char* const kUpAndDown =
    "history = [{ time_s = 0, load_N = 0 }, { time_s = 0.5, load_N = 4 }, { time_s = 4, load_N = 4 "
    "}, { time_s = 5, load_N = 2 }]";

TEST_F(TimeProgram, WithoutATimeALoadIsAnsweredAtOnceAndHeldForLong) {
  const std::string creeps = case_with("load_N = 2");
  const json both = predicted({creeps});
  ASSERT_EQ(both["results"].size(), 2u);
  EXPECT_EQ(both["results"][0]["time_s"], 0);
  EXPECT_TRUE(both["results"][1]["time_s"].is_null());
  EXPECT_EQ(both["relaxation"].size(), 2u);
  EXPECT_TRUE(both["history"].is_null());
  const ProgramRun text = run({"predict", creeps});
  // The elastic answers of both moduli, by the program without relaxation.
  const std::string elastic = case_with("load_N = 2\npressing = \"frictionless\"", "");
  const json now = predicted({elastic})["results"][0];
  const json rest = predicted({elastic, "--set", "layer.youngs_modulus_kPa=240"})["results"][0];
  for (const char* key : {"a_m", "b_m", "indentation_m", "max_torque_Nm", "peak_pressure_Pa"}) {
    EXPECT_NEAR(both["results"][0][key].get<double>() / now[key].get<double>(), 1, 1e-9) << key;
    EXPECT_NEAR(both["results"][1][key].get<double>() / rest[key].get<double>(), 1, 1e-9) << key;
  }
  ASSERT_GE(lines(text.out).size(), 3u);
  EXPECT_EQ(lines(text.out)[0].rfind("2 N at once: torque ", 0), 0u) << text.out;
  EXPECT_EQ(lines(text.out)[1].rfind("2 N held for long: torque ", 0), 0u) << text.out;
  EXPECT_EQ(lines(text.out)[2].rfind("  against t = 0: torque +", 0), 0u) << text.out;
}

TEST_F(TimeProgram, AnswersAtATimeWithTheLoadThatTheElasticContactWouldNeed) {
  const json result = predicted({case_with("load_N = 2"), "--at-time", "3"})["results"][0];
  EXPECT_EQ(result["time_s"], 3);
  EXPECT_EQ(result["load_N"], 2);
  const double effective_N = result["effective_load_N"];
  EXPECT_GT(effective_N, 2.2);
  EXPECT_LT(effective_N, 2.5);
  const std::string elastic =
      case_with("load_N = " + std::to_string(effective_N) + "\npressing = \"frictionless\"", "");
  const json same = predicted({elastic})["results"][0];
  EXPECT_NEAR(result["a_m"].get<double>() / same["a_m"].get<double>(), 1, 1e-6);
  EXPECT_NEAR(result["normal_stiffness_N_per_m"].get<double>() /
                  same["normal_stiffness_N_per_m"].get<double>(),
              1, 1e-5);
  EXPECT_GT(result["change"]["area"].get<double>(), 0.05);
  EXPECT_EQ(result["change"]["load"].get<double>(), 0);
}

TEST_F(TimeProgram, AnswersAHistoryAtItsEndAndAtATimeOfIt) {
  const std::string history = case_with(kUpAndDown);
  const json end = predicted({history});
  EXPECT_EQ(end["results"][0]["time_s"], 5);
  EXPECT_EQ(end["results"][0]["load_N"], 2);
  EXPECT_EQ(end["history"].size(), 4u);
  const json before = predicted({history, "--at-time", "4"})["results"][0];
  EXPECT_EQ(before["load_N"], 4);
  EXPECT_GT(before["a_m"].get<double>(), end["results"][0]["a_m"].get<double>());
  const ProgramRun text = run({"predict", history});
  EXPECT_EQ(lines(text.out)[0].rfind("2 N at 5 s: torque ", 0), 0u) << text.out;
  EXPECT_NE(lines(text.out)[1].find("against rubber that has not relaxed"), std::string::npos);
  expect_refusal({"predict", history, "--at-time", "20"}, "the contact grows a second time");
  expect_refusal({"predict", history, "--at-time", "-2"}, "creep.toml:7: history: time = -2");
  expect_refusal({"predict", history, "--at-time", "0"}, "load at 0 s");
}

TEST_F(TimeProgram, AnApproachThatIsHeldLosesItsLoadAsTheModulusFalls) {
  const std::string held = case_with("history = [{ time_s = 0, approach_mm = 0.4 }]");
  const json start_of = predicted({held, "--at-time", "0"})["results"][0];
  const json later = predicted({held, "--at-time", "2"})["results"][0];
  const double left = 1 - 0.15 * (1 - std::exp(-4.)) - 0.05 * (1 - std::exp(-0.4));
  EXPECT_NEAR(start_of["indentation_m"].get<double>(), 4e-4, 1e-12);
  EXPECT_NEAR(later["load_N"].get<double>() / start_of["load_N"].get<double>(), left, 1e-9);
  EXPECT_NEAR(later["max_torque_Nm"].get<double>() / start_of["max_torque_Nm"].get<double>(), left,
              1e-9);
  EXPECT_EQ(later["a_m"], start_of["a_m"]);
}

TEST_F(TimeProgram, WritesCurvesAgainstTime) {
  for (const char* contact :
       {"load_N = [2, 5]", kUpAndDown, "history = [{ time_s = 1, approach_mm = 0.4 }]"}) {
    const std::string page = (folder.path() / "page.html").string();
    const ProgramRun made = run({"predict", case_with(contact), "--page", page});
    ASSERT_EQ(made.status, 0) << made.err;
    const std::string html = file_text(page);
    std::size_t charts = 0;
    for (std::size_t at = html.find("<svg"); at != std::string::npos;
         at = html.find("<svg", at + 1))
      ++charts;
    EXPECT_EQ(charts, contact[0] == 'l' ? 8u : 4u) << contact;
    for (const char* no_number : {"nan", "inf "})
      EXPECT_EQ(html.substr(0, html.find("provenance")).find(no_number), std::string::npos);
  }
}

TEST_F(TimeProgram, CalibratesSharesAndTimesFromForceAgainstTime) {
  std::mt19937 random(1);
  std::normal_distribution<double> scatter;
  std::string table = "# held at 0.4 mm\ntime_s,load_N\n";
  for (int i = 0; i < 50; ++i) {
    const double t = 0.05 * std::pow(1000, i / 49.);
    const double force_N =
        3 * (1 - 0.15 * (1 - std::exp(-t / 0.5)) - 0.05 * (1 - std::exp(-t / 5)));
    table +=
        std::to_string(t) + "," + std::to_string(force_N * (1 + 4e-4 * scatter(random))) + "\n";
  }
  const std::string data = folder.write("held.csv", table).string();
  const std::string elastic = case_with("load_N = 2", "");
  const ProgramRun made = run({"calibrate", data, elastic, "--json"});
  ASSERT_EQ(made.status, 0) << made.err;
  const json found = json::parse(made.out);
  ASSERT_EQ(found["relaxation"].size(), 2u) << made.out;
  const double shares[] = {0.15, 0.05}, times_s[] = {0.5, 5};
  for (std::size_t i = 0; i < 2; ++i) {
    const json& term = found["relaxation"][i];
    EXPECT_NEAR(term["share"].get<double>(), shares[i], 4 * term["share_std"].get<double>());
    EXPECT_LT(term["time_interval95_s"][0].get<double>(), 1.1 * times_s[i]);
    EXPECT_GT(term["time_interval95_s"][1].get<double>(), 0.9 * times_s[i]);
  }
  EXPECT_GE(found["cannot_tell"].size(), 3u);
  const std::string fitted = (folder.path() / "fitted.toml").string();
  const ProgramRun text = run({"calibrate", data, elastic, "--output", fitted});
  ASSERT_EQ(text.status, 0) << text.err;
  EXPECT_EQ(text.out.rfind("relaxation = [{ share = 0.1", 0), 0u) << text.out;
  EXPECT_EQ(predicted({fitted, "--at-time", "3"})["relaxation"].size(), 2u);

  expect_refusal({"calibrate", data, elastic, "--fit", "thickness"}, "--fit = thickness");
  const auto refused = [&](const std::string& bad, const std::string& part) {
    expect_refusal({"calibrate", folder.write("bad.csv", bad).string(), elastic}, part);
  };
  refused("time_s,load_N\n0,1\n", "number of forces = 1: allowed: at least 6");
  refused("time_s,load_N\n0,one\n", "bad.csv:2: load_N = \"one\"");
  refused("time_s,load\n0,1\n", "did you mean \"load_N\"");
  refused("time_s\n0\n", "no column = load_N");
  refused("time_s,load_N\n0,1,2\n", "number of cells = 3");
}

TEST_F(TimeProgram, ExportsForATime) {
  const std::string creeps = case_with("load_N = 2");
  const json later = predicted({creeps, "--at-time", "10"})["results"][0];
  const ProgramRun made = run(
      {"export", creeps, "--to", "mujoco", "--at-time", "10", "--model", "bonded_layer", "--json"});
  ASSERT_EQ(made.status, 0) << made.err;
  const json exported = json::parse(made.out);
  EXPECT_EQ(exported["time_s"], 10);
  EXPECT_EQ(exported["relaxation"].size(), 2u);
  EXPECT_NEAR(exported["eccentricity_m"].get<double>(), later["eccentricity_m"].get<double>(),
              1e-12);
  EXPECT_NEAR(exported["normal_stiffness_N_per_m"].get<double>() /
                  later["normal_stiffness_N_per_m"].get<double>(),
              1, 0.01);  // differences over 10 % of the load
  const ProgramRun at_once = run({"export", creeps, "--to", "mujoco"});
  EXPECT_EQ(lines(at_once.out)[0].rfind("2 N at once: ", 0), 0u) << at_once.out;
  EXPECT_NE(at_once.err.find("--at-time"), std::string::npos);
  expect_refusal(
      {"export", case_with("history = [{ time_s = 0, approach_mm = 0.4 }]"), "--to", "mujoco"},
      "history by approach_mm");
}

TEST_F(TimeProgram, CommandsThatDoNotKnowTimeRefuseItByName) {
  const std::string creeps = case_with("load_N = 2");
  for (const char* command : {"select", "compare"})
    expect_refusal({command, creeps},
                   std::string("softfinger ") + command + " does not know time yet");
  expect_refusal({"calibrate", "inked_fingertip.csv", creeps},
                 "softfinger calibrate does not know time yet");
  const std::string sweep =
      folder.write("sweep.toml", file_text(creeps) + "[sweep]\n\"layer.thickness_mm\" = [1, 2]\n")
          .string();
  expect_refusal({"sweep", sweep, "--output", "out"}, "softfinger sweep does not know time yet");
  const std::string elastic = case_with("load_N = 2", "");
  expect_refusal({"predict", elastic, "--at-time", "3"}, "nothing changes with time here");
  expect_refusal({"export", elastic, "--to", "mujoco", "--at-time", "3"},
                 "nothing changes with time here");
  const std::vector<std::string> pad = {
      "predict", "--pad-mm",        "22,37.5", "--thickness-mm", "3",  "--youngs-modulus-kPa",
      "600",     "--poisson-ratio", "0.49",    "--load",         "20", "--friction",
      "1"};
  std::vector<std::string> creeping = pad;
  creeping.insert(creeping.end(), {"--set", "layer.relaxation=[{ share = 0.1, time_s = 1 }]"});
  expect_refusal(creeping, "a flat pad takes no relaxation yet");
  std::vector<std::string> timed = pad;
  timed.insert(timed.end(), {"--at-time", "1"});
  expect_refusal(timed, "nothing changes with time here");
}

TEST_F(TimeProgram, LoadsWithDoubtsAreRefusedBesideRelaxation) {
  expect_refusal({"predict", case_with("load_N = { value = 2, std = 0.1 }")},
                 "a plain number beside relaxation or history");
  const json doubted = predicted(
      {case_with("load_N = 2"), "--set", "layer.youngs_modulus_kPa={ value = 300, factor = 2 }"});
  EXPECT_GT(doubted["results"][1]["input_doubt"]["max_torque"].get<double>(), 0.1);
}

}  // namespace softfinger::tests
