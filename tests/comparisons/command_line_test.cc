// Behaviour that all commands share: cases without a file, values in place of a file's, standard
// input, unknown words, quiet, colours, completion, manual, init, doctor.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "tests/comparisons/run_program.h"

namespace softfinger::tests {
namespace fs = std::filesystem;
using nlohmann::json;

class CommandLine : public testing::Test {
 protected:
  TemporaryFolder folder;
  Start start{folder.path(), {}, -1, "", ""};

  ProgramRun run(const std::vector<std::string>& arguments) {
    return run_softfinger(start, arguments);
  }

  json answer_of(const std::vector<std::string>& arguments) {
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.status == 0 ? json::parse(result.out) : json();
  }

  void expect_refusal(const std::vector<std::string>& arguments,
                      const std::vector<std::string>& words) {
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
    for (const std::string& word : words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << ": " << result.err;
  }

  std::vector<std::string> names_of_commands() {
    std::vector<std::string> names;
    const json pages = answer_of({"manual", "--json", "--output", "pages"});
    for (const auto& entry : fs::directory_iterator(folder.path() / "pages")) {
      const std::string stem = entry.path().stem().string();
      if (stem != "softfinger") names.push_back(stem.substr(stem.find('-') + 1));
    }
    return names;
  }
};

const std::vector<std::string> kNumbers = {
    "--radii-mm",      "20,10", "--thickness-mm", "2", "--youngs-modulus-kPa", "300",
    "--poisson-ratio", "0.45",  "--load",         "5", "--friction",           "0.8"};

std::vector<std::string> with_numbers(std::vector<std::string> words) {
  words.insert(words.end(), kNumbers.begin(), kNumbers.end());
  return words;
}

TEST_F(CommandLine, PredictsFromNumbersWhatItPredictsFromAFile) {
  const auto file = folder.write("case.toml", case_text("command_line", "[5]")).string();
  json typed = answer_of(with_numbers({"predict", "--json"}));
  json read = answer_of({"predict", file, "--json"});
  for (json* object : {&typed, &read})
    for (json& answer : (*object)["results"]) answer.erase("cost_ns");
  EXPECT_EQ(typed, read);
  EXPECT_EQ(answer_of(with_numbers({"select", "--tolerance", "0.1", "--json"}))["choices"].size(),
            1u);
  EXPECT_EQ(answer_of(with_numbers({"export", "--to", "mujoco", "--json"}))["load_N"], 5.0);
  EXPECT_EQ(answer_of(with_numbers({"fem", "--json"}))["results"].size(), 1u);
}

TEST_F(CommandLine, TakesOneRadiusForASphereAndSaysWhichFrictionItTook) {
  const std::vector<std::string> numbers = {
      "predict", "--radii-mm",      "15",  "--thickness-mm", "2",   "--youngs-modulus-kPa",
      "300",     "--poisson-ratio", ".45", "--load",         "1,2", "--model",
      "hertz",   "--json"};
  const ProgramRun result = run(numbers);
  ASSERT_EQ(result.status, 0) << result.err;
  const json predicted = json::parse(result.out);
  ASSERT_EQ(predicted["results"].size(), 2u);
  EXPECT_EQ(predicted["results"][0]["a_m"], predicted["results"][0]["b_m"]);
  EXPECT_EQ(predicted["friction_coefficient"], 1.0);
  EXPECT_EQ(answer_of({"predict", "--radii-mm", "15.", "--thickness-mm", "2",
                       "--youngs-modulus-kPa", "300", "--poisson-ratio", "0.45", "--load", "1,2.",
                       "--model", "hertz", "--json"})["results"][1]["a_m"],
            predicted["results"][1]["a_m"])
      << "numbers as other programs write them";
  EXPECT_NE(result.err.find("no --friction"), std::string::npos) << result.err;
}

TEST_F(CommandLine, RefusesNumbersByTheOptionThatTypedThem) {
  expect_refusal({"predict"}, {"CASE is missing", "--radii-mm"});
  expect_refusal({"predict", "--radii-mm", "20", "--load", "2"},
                 {"--thickness-mm, --youngs-modulus-kPa, --poisson-ratio are missing"});
  const auto refuse = [&](const std::string& flag, const std::string& value,
                          const std::vector<std::string>& words) {
    std::vector<std::string> arguments = with_numbers({"predict"});
    arguments[std::size_t(std::find(arguments.begin(), arguments.end(), flag) - arguments.begin()) +
              1] = value;
    expect_refusal(arguments, words);
  };
  refuse("--radii-mm", "20,0", {"--radii-mm 20,0", "finite numbers > 0"});
  refuse("--radii-mm", "20,10,5", {"--radii-mm = \"20,10,5\"", "R',R''"});
  refuse("--thickness-mm", "2mm", {"--thickness-mm = \"2mm\"", "a number > 0, in mm"});
  refuse("--youngs-modulus-kPa", "-1", {"--youngs-modulus-kPa -1", "> 0"});
  refuse("--poisson-ratio", "0.6", {"--poisson-ratio 0.6", "0 to 0.5"});
  refuse("--load", "nan", {"--load = \"nan\"", "> 0"});
  refuse("--friction", "[", {"--friction = \"[\""});
}

TEST_F(CommandLine, ReadsTheNumbersOfAllOptionsAlike) {
  const std::string kCase = "seed_thumb";
  const std::vector<std::vector<std::string>> commands = {
      {"predict", kCase, "--tolerance"},
      {"predict", kCase, "--limit-surface"},
      {"predict", kCase, "--load"},
      {"select", kCase, "--tolerance", "0.1", "--budget-us"},
      {"export", kCase, "--to", "mujoco", "--load"},
      {"export", kCase, "--to", "mujoco", "--load-range"},
      {"export", kCase, "--to", "mujoco", "--tolerance"},
      {"compare", kCase, "--fem-time-s"},
      {"compare", kCase, "--fem-memory-MB"},
      {"fem", kCase, "--approach-mm"},
      {"fem", kCase, "--level"},
      {"fem", kCase, "--twist-axis-mm"},
      {"sweep", "thickness_and_load", "--jobs"},
      {"area", "ink_print.png", "--mm-per-pixel"},
      {"mesh", "sphere.stl", "--near"},
      {"fit", "sphere.stl", "--point"},
      {"fit", "sphere.stl", "--point", "0,0,20", "--radius-mm"}};
  // Built-in meshes need gmsh.
  const bool has_meshes =
      std::filesystem::exists(std::filesystem::path(SOFTFINGER_SHARE) / "meshes" / "sphere.stl");
  for (const std::vector<std::string>& command : commands) {
    if (command[1] == "sphere.stl" && !has_meshes) continue;
    for (const std::string number : {"nan", "inf", "-inf", "0x10", "1'000", "1_000", "2N", "1e999",
                                     "1,,2", ",", "1 2", "++1"}) {
      std::vector<std::string> typed = command;
      const std::string option = typed.back();
      typed.back() += "=" + number;
      expect_refusal(typed, {option});
    }
  }
  // A comma is no decimal point, and blanks after it are none of the numbers.
  expect_refusal({"predict", kCase, "--tolerance", "0,1"}, {"--tolerance = \"0,1\"", "0.5"});
  EXPECT_EQ(run({"predict", kCase, "--load", "1, 2"}).status, 0);
  EXPECT_EQ(run({"predict", kCase, "--tolerance", "+.1"}).status, 0);
}

TEST_F(CommandLine, RefusesAValueThatIsTypedTwice) {
  expect_refusal({"predict", "seed_thumb", "--load", "2", "--set", "contact.load_N=5"},
                 {"--load 2 and --set contact.load_N=5"});
  expect_refusal(
      {"predict", "seed_thumb", "--set", "layer.thickness_mm=2", "--set", "layer.thickness_mm = 3"},
      {"--set layer.thickness_mm=2 and --set layer.thickness_mm = 3"});
  expect_refusal({"predict", "seed_thumb", "--set", "geometry.finger.radii_mm[0]=9", "--set",
                  "geometry.finger.radii_mm.0=8"},
                 {"one of them"});
  expect_refusal({"predict", "seed_thumb", "--set", "geometry.finger.unit=mm", "--set",
                  "geometry.finger={radii_mm=[9,8]}"},
                 {"both say what geometry.finger.unit is"});
  expect_refusal({"simulate", "pinch", "--set", "body[0].mass_g=6", "--set", "body[0].mass_g=7"},
                 {"one of them"});
}

TEST_F(CommandLine, SaysOfAMissingArgumentWhatItHasToBe) {
  expect_refusal({"export", "seed_thumb"}, {"softfinger export: --to is missing: mujoco, bullet",
                                            "softfinger export --help"});
  expect_refusal({"mesh"}, {"softfinger mesh: MESH is missing: file in STL, OBJ", "mesh --help"});
  expect_refusal({"predict"}, {"CASE is missing", "softfinger predict --help"});
  expect_refusal({"predict", "seed_thumb", "--limit-surface", "1"}, {"predict --help"});
}

TEST_F(CommandLine, UnderstandsWhatPeopleType) {
  EXPECT_EQ(run({"version"}).out, run({"--version"}).out);
  EXPECT_EQ(run({"version", "--quiet"}).out, run({"--version"}).out);
  EXPECT_NE(run({"version"}).out, "");
  const auto without_times = [](const std::string& text) {
    return std::regex_replace(text, std::regex(" +[0-9.]+(?=\n)"), "");
  };
  EXPECT_EQ(run({"export", "seed_thumb", "--to", "MuJoCo"}).out,
            run({"export", "seed_thumb", "--to", "mujoco"}).out);
  EXPECT_EQ(run({"export", "Seed_Thumb", "--to", "drake", "--models", "Hertz"}).out,
            run({"export", "seed_thumb", "--to", "drake", "--model", "hertz"}).out);
  EXPECT_EQ(without_times(run({"predict", "seed_thumb", "--models", "Hertz,winkler"}).out),
            without_times(run({"predict", "seed_thumb", "--model", "hertz,winkler"}).out));
  EXPECT_EQ(run({"select", "seed_thumb", "--tolerance", "0.5", "--model", "hertz"}).status, 0);
  EXPECT_NE(run({"select", "silicone_pad_2mm", "--tolerance", "1", "--models", "layer_fft"})
                .out.find("layer_fft within"),
            std::string::npos)
      << "a slow model that is named is asked";
  EXPECT_EQ(run({"explain", "HERTZ"}).out, run({"explain", "hertz"}).out);
  for (const auto& [command, hint] :
       {std::pair{"sweep", "[sweep] models"}, std::pair{"simulate", "[[contact]]"},
        std::pair{"compare", "predict, select, export"}}) {
    const ProgramRun refused = run({command, "x.toml", "--model", "hertz"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find(hint), std::string::npos) << refused.err;
  }
}

TEST_F(CommandLine, NamesACaseByItsFileWhereItHasNoId) {
  std::string text = case_text();
  text.erase(text.find("id = "), text.find('\n', text.find("id = ")) - text.find("id = "));
  const auto file = folder.write("my pad.v2.toml", text).string();
  EXPECT_EQ(answer_of({"predict", file, "--json"})["case"], "my_pad.v2");
  start.input = file;
  EXPECT_EQ(answer_of({"predict", "-", "--json"})["case"], "standard_input");
  std::string scene = file_text(fs::path(SOFTFINGER_SHARE) / "scenes" / "pinch.toml");
  scene.replace(scene.find("id = "), 4, "# id");
  EXPECT_EQ(answer_of({"simulate", folder.write("grip.toml", scene).string(), "--json", "--set",
                       "simulation.duration_s=0.01"})["scene"],
            "grip");
}

TEST_F(CommandLine, SaysWhichValuesAreUnusual) {
  const auto file = folder.write("case.toml", case_text()).string();
  const auto said = [&](const std::string& setting) {
    const ProgramRun result = run({"predict", file, "--model", "hertz", "--set", setting});
    EXPECT_EQ(result.status, 0) << result.err;
    return result.err;
  };
  EXPECT_EQ(said("contact.load_N=3").find("usual"), std::string::npos);
  EXPECT_NE(said("contact.friction_coefficient=1e6").find("usual is 0.01 to 10"),
            std::string::npos);
  EXPECT_NE(said("contact.friction_coefficient=1e-300").find("usual"), std::string::npos);
  EXPECT_NE(said("layer.thickness_mm=2000").find("usual is 0.01 to 100 mm"), std::string::npos);
  EXPECT_NE(said("layer.youngs_modulus_kPa=1e9").find("usual is 1 to 1e+06 kPa"),
            std::string::npos);
  const ProgramRun scene = run({"simulate", "pinch", "--set", "simulation.duration_s=0.01", "--set",
                                "body[0].velocity_mm_per_s=[1e30, 0, 0]"});
  EXPECT_TRUE(scene.status == 2 ||
              scene.err.find("usual is at most 100000 mm/s") != std::string::npos)
      << scene.err;
}

TEST_F(CommandLine, TakesNumbersWithoutADigitOnOneSideOfThePoint) {
  const auto numbers = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"predict", "--json"});
    return words;
  };
  json full =
      answer_of(numbers({"--radii-mm", "0.5,20.0", "--thickness-mm", "2.0", "--youngs-modulus-kPa",
                         "300", "--poisson-ratio", "0.49", "--load", "0.1"}));
  json bare =
      answer_of(numbers({"--radii-mm", ".5,20.", "--thickness-mm", "2.", "--youngs-modulus-kPa",
                         "300", "--poisson-ratio", ".49", "--load", ".1"}));
  for (json* object : {&full, &bare})
    for (json& answer : (*object)["results"]) answer.erase("cost_ns");
  EXPECT_EQ(full, bare);
}

TEST_F(CommandLine, ReplacesValuesOfEveryFile) {
  const auto file = folder.write("case.toml", case_text("example", "[1.0, 5.0]")).string();
  const auto other = [&] {
    std::string text = case_text("example", "[3]");
    text.replace(text.find("thickness_mm = 2.0"), 18, "thickness_mm = 3.5");
    text.replace(text.find("[20.0, 10.0]"), 12, "[25, 10.0]");
    return folder.write("other.toml", text).string();
  }();
  const std::vector<std::string> settings = {"--set", "layer.thickness_mm=3.5",
                                             "--set", "contact.load_N=3",
                                             "--set", "geometry.relative_radii_mm[0] = 25"};
  std::vector<std::string> arguments = {"predict", file, "--model", "hertz", "--json"};
  arguments.insert(arguments.end(), settings.begin(), settings.end());
  EXPECT_EQ(answer_of(arguments)["results"][0]["a_m"],
            answer_of({"predict", other, "--model", "hertz", "--json"})["results"][0]["a_m"]);
  // A table that the file does not have, and a text without quotes.
  EXPECT_EQ(
      run({"fem", file, "--set", "fem.kinematics=finite", "--set", "contact.load_N=1"}).status, 0);
  EXPECT_EQ(answer_of({"simulate", "pinch", "--json", "--set", "simulation.duration_s=0.01",
                       "--set", "body[0].mass_g=60"})["simulated_s"],
            0.01);
  EXPECT_EQ(answer_of({"sweep", "thickness_and_load", "--output", "out", "--json", "--set",
                       "sweep.\"layer.thickness_mm\"=[1, 2]", "--set",
                       "sweep.\"contact.load_N\"=[1]"})["rows"]
                    .get<int>() %
                2,
            0);
  const json compared = answer_of({"compare", file, "--output", "report", "--json", "--quick",
                                   "--set", "contact.load_N=[2.0]"});
  EXPECT_EQ(compared["cases"].size(), 1u);
  const std::string report = file_text(folder.path() / "report" / "report.json");
  // The report holds a case that gives the same numbers again.
  EXPECT_NE(json::parse(report).dump().find("# --set contact.load_N=[2.0]"), std::string::npos);
}

TEST_F(CommandLine, RefusesSettingsByTheirOwnWords) {
  const auto file = folder.write("case.toml", case_text()).string();
  const auto refuse = [&](const std::string& setting, const std::vector<std::string>& words) {
    std::vector<std::string> all = words;
    all.push_back("--set");
    expect_refusal({"predict", file, "--set", setting}, all);
  };
  refuse("layer.thickness_mm=-3", {"layer.thickness_mm=-3: thickness_mm = -3", "> 0"});
  refuse("layer.thickness_m=3", {"did you mean \"thickness_mm\""});
  refuse("layr.thickness_mm=3", {"did you mean \"layer\""});
  refuse("geometry.relative_radii_mm[2]=3", {"0 to 1"});
  refuse("contact.load_N.x=3", {"no entry"});
  refuse("layer=3", {"a table"});
  refuse("layer", {"KEY=VALUE"});
  refuse("=3", {"KEY=VALUE"});
  refuse("layer.thickness_mm=", {"KEY=VALUE"});
  refuse("layer.thickness_mm=3\nid=\"y\"", {"on one line"});
  refuse("layer.thickness_mm=[1", {"a number"});
  refuse("layer..thickness_mm=1", {"names with dots"});
  refuse("layer[=1", {"names with dots"});
  refuse("a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q=1", {"names with dots"});
}

TEST_F(CommandLine, ReadsStandardInput) {
  const auto file = folder.write("case.toml", case_text());
  const json read = answer_of({"predict", file.string(), "--model", "winkler", "--json"});
  start.input = file.string();
  const json piped = answer_of({"predict", "-", "--model", "winkler", "--json"});
  EXPECT_EQ(read["results"][0]["a_m"], piped["results"][0]["a_m"]);
  EXPECT_EQ(run({"select", "-", "--tolerance", "0.1"}).status, 0);
  EXPECT_EQ(run({"compare", "-", "--output", "report"}).status, 0);
  start.input = (fs::path(SOFTFINGER_SHARE) / "scenes" / "pinch.toml").string();
  EXPECT_EQ(answer_of({"simulate", "-", "--json"})["scene"], "pinch");
  EXPECT_EQ(answer_of({"select", "-", "--tolerance", "0.1", "--json"})["scene"], "pinch");
  expect_refusal({"simulate", "-", "--control"}, {"--control"});
  start.input = "";
  expect_refusal({"predict", "-"}, {"standard input", "[geometry]"});
  start.input = folder.write("wrong.toml", case_text() + "frictoin = 1\n").string();
  expect_refusal({"predict", "-"}, {"standard input:12", "friction_coefficient"});
}

TEST_F(CommandLine, NamesTheNearestOption) {
  expect_refusal({"predict", "seed_thumb", "--tolerence", "0.1"},
                 {"\"--tolerence\" of softfinger predict", "\"--tolerance\""});
  expect_refusal({"export", "seed_thumb", "--too=mujoco"}, {"\"--too\"", "\"--to\""});
  expect_refusal({"--quite", "predict"}, {"\"--quite\" of softfinger", "\"--quiet\""});
  expect_refusal({"mesh", "sphere", "--alon", "-y"}, {"\"--along\""});
  expect_refusal({"predict", "seed_thumb", "-x"}, {"\"-x\"", "-q"});
  EXPECT_EQ(run({"-V"}).out, run({"--version"}).out);
}

/// A case with an unusual value, of which there is a remark.
const std::vector<std::string> kRemarked = {"predict", "seed_thumb", "--set",
                                            "contact.friction_coefficient=100"};

TEST_F(CommandLine, SaysOnlyErrorsWhereQuietIsAskedFor) {
  EXPECT_NE(run(kRemarked).err, "");
  std::vector<std::string> quietly = kRemarked;
  quietly.push_back("--quiet");
  const ProgramRun quiet = run(quietly);
  EXPECT_EQ(quiet.err, "");
  EXPECT_NE(quiet.out, "");
  EXPECT_EQ(run({"-q", "fem", "hertz_circle"}).err, "");
  expect_refusal({"predict", "missing.toml", "-q"}, {"error: missing.toml"});
  start.environment = {"FAKE_FEM_EXIT=3"};
  EXPECT_NE(run({"-q", "fem", "hertz_circle"}).err.find("error: "), std::string::npos);
}

TEST_F(CommandLine, SaysWhereTheScansOwnErrorIsNotKnown) {
  const std::string unknown = "facets leave open is not known";
  EXPECT_EQ(run({"fem", "hertz_circle"}).out.find(unknown), std::string::npos);
  start.environment = {"FAKE_FEM_UNREAD_SCAN=1"};
  EXPECT_NE(run({"fem", "hertz_circle"}).out.find(unknown), std::string::npos);
}

TEST_F(CommandLine, ColoursOnlyWhereSomebodySeesThem) {
  const auto has_colour = [](const std::string& text) {
    return text.find('\x1b') != std::string::npos;
  };
  const ProgramRun plain = run(kRemarked);
  EXPECT_FALSE(has_colour(plain.out) || has_colour(plain.err));
  start.environment = {"CLICOLOR_FORCE=1"};
  const ProgramRun coloured = run(kRemarked);
  EXPECT_TRUE(has_colour(coloured.out) && has_colour(coloured.err));
  // The words are the same with and without colours.
  const std::regex codes("\x1b\\[[0-9;]*m");
  const auto without_times = [](const std::string& text) {
    return std::regex_replace(text, std::regex(" +[0-9.]+(?=\n)"), "");
  };
  EXPECT_EQ(without_times(std::regex_replace(coloured.out, codes, "")), without_times(plain.out));
  EXPECT_FALSE(has_colour(run({"predict", "seed_thumb", "--json"}).out));
  EXPECT_TRUE(has_colour(run({"predict", "missing.toml"}).err));
  start.environment = {"CLICOLOR_FORCE=1", "NO_COLOR=1"};
  EXPECT_FALSE(has_colour(run(kRemarked).out));
}

TEST_F(CommandLine, AnswersInJsonInEveryCommand) {
  const std::vector<std::string> commands = names_of_commands();
  EXPECT_GE(commands.size(), 17u);
  for (const std::string& command : commands)
    EXPECT_NE(run({command, "--help"}).out.find("--json"), std::string::npos) << command;
  EXPECT_EQ(answer_of({"explain", "hertz", "--json"})["models"][0]["model"], "hertz");
  EXPECT_EQ(answer_of({"explain", "yeoh", "--json"})["material"], "yeoh");
  EXPECT_EQ(answer_of({"completion", "bash", "--json"})["shell"], "bash");
}

TEST_F(CommandLine, CompletesInBash) {
  const auto script = folder.path() / "made" / "softfinger.bash";
  ASSERT_EQ(run({"completion", "bash", "--output", script.string()}).status, 0);
  const auto completed = [&](const std::string& words) {
    const std::string program = fs::path(SOFTFINGER_PROGRAM).parent_path().string();
    const auto out = folder.path() / "completed";
    const std::string command = "PATH=\"" + program + ":$PATH\" bash -c 'source \"" +
                                script.string() + "\"; COMP_WORDS=(softfinger " + words +
                                "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _softfinger; echo "
                                "\"${COMPREPLY[@]}\"' > \"" +
                                out.string() + "\"";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return file_text(out);
  };
  EXPECT_EQ(completed("pred"), "predict\n");
  EXPECT_EQ(completed("predict --tor"), "--torque-rule\n");
  EXPECT_EQ(completed("predict seed_thumb --torque-rule \"\""), "exact paper\n");
  EXPECT_EQ(completed("-q fem --lev"), "--level\n");
  EXPECT_EQ(completed("list me"), "meshes\n");
  EXPECT_EQ(completed("predict seed_thumb_"), "seed_thumb_silicone\n");
  EXPECT_EQ(completed("explain winkl"), "winkler\n");
  for (const std::string shell : {"zsh", "fish"}) {
    const std::string text = run({"completion", shell}).out;
    for (const std::string& command : names_of_commands())
      EXPECT_NE(text.find(command), std::string::npos) << shell << ": " << command;
    EXPECT_NE(text.find("torque-rule"), std::string::npos) << shell;
  }
  expect_refusal({"completion", "csh"}, {"SHELL"});
}

TEST_F(CommandLine, WritesManPagesOfWhatHelpSays) {
  const std::string page = run({"manual", "export"}).out;
  for (const char* part : {".TH softfinger\\-export 1", ".SH OPTIONS", "\\fB\\-\\-to\\fR",
                           ".SH EXAMPLES", "softfinger export silicone_pad_2mm \\-\\-to mujoco"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_NE(run({"manual"}).out.find("softfinger\\-predict"), std::string::npos);
  expect_refusal({"manual", "exprot"}, {"\"export\""});
  if (std::system("command -v groff > /dev/null 2>&1") != 0) return;
  // No page has a request or an escape that troff does not know.
  names_of_commands();
  const std::string check = "for page in \"" + (folder.path() / "pages").string() +
                            "\"/*.1; do groff -man -Tutf8 -ww -z \"$page\" || exit 1; done 2> \"" +
                            (folder.path() / "warnings").string() + "\"";
  EXPECT_EQ(std::system(check.c_str()), 0);
  EXPECT_EQ(file_text(folder.path() / "warnings"), "");
}

TEST_F(CommandLine, StartsACaseThatCanBePredicted) {
  const ProgramRun made = run({"init"});
  ASSERT_EQ(made.status, 0) << made.err;
  const json predicted = answer_of({"predict", "my_finger.toml", "--json"});
  EXPECT_EQ(predicted["case"], "my_finger");
  EXPECT_FALSE(predicted["results"].empty());
  expect_refusal({"init"}, {"my_finger.toml", "--force"});
  EXPECT_EQ(run({"init", "--force"}).status, 0);
  EXPECT_EQ(run({"init", "-"}).out, file_text(folder.path() / "my_finger.toml"));
  EXPECT_EQ(answer_of({"init", "-", "--json"})["text"],
            file_text(folder.path() / "my_finger.toml"));
  expect_refusal({"init", "x.toml", "--mesh", "no.stl"}, {"no.stl"});
  EXPECT_NE(run({"init", "-", "--material", "Dragon Skin 10"}).out.find("value = 147"),
            std::string::npos);
  EXPECT_NE(run({"init", "-", "--pad", "--material", "ecoflex 00-30"}).out.find("value = 51"),
            std::string::npos);
  expect_refusal({"init", "-", "--material", "Dragon Skim 10"}, {"did you mean", "Dragon Skin"});
  expect_refusal({"init", "x.toml", "--along", "+y"}, {"--mesh"});
  expect_refusal({"init", "x.toml", "--mesh", "no.stl", "--along", "up"}, {"+x, -x"});
  EXPECT_FALSE(fs::exists(folder.path() / "x.toml"));
}

TEST_F(CommandLine, DoctorSaysWhatIsThereAndWhatIsMissing) {
  start.environment = {"SOFTFINGER_FEM_PROGRAM=/nonexistent/softfinger-fem", "PATH=/nonexistent"};
  const json findings = answer_of({"doctor", "--json"})["findings"];
  const auto there = [&](const std::string& name) -> bool {
    for (const json& finding : findings)
      if (finding["name"] == name) return finding["there"];
    ADD_FAILURE() << name;
    return false;
  };
  EXPECT_TRUE(there("cases"));
  EXPECT_TRUE(there("error atlas"));
  EXPECT_FALSE(there("finite elements"));
  EXPECT_FALSE(there("mpirun"));
  start.environment.clear();
  const std::string text = run({"doctor"}).out;
  EXPECT_NE(text.find("ok       finite elements"), std::string::npos) << text;
}

TEST_F(CommandLine, RefusesAnOutputThatIsAnInput) {
  const std::string grid = [] {
    std::string text;
    for (int i = 0; i < 144; ++i)
      text += "v " + std::to_string(i % 12) + " " + std::to_string(i / 12) + " " +
              std::to_string(-0.02 * (i % 12) * (i % 12)) + "\n";
    for (int i = 0; i < 131; ++i)
      if (i % 12 != 11)
        text += "f " + std::to_string(i + 1) + " " + std::to_string(i + 2) + " " +
                std::to_string(i + 14) + " " + std::to_string(i + 13) + "\n";
    return text;
  }();
  folder.write("tip.obj", grid);
  folder.write("p.toml", case_text());
  folder.write("d.csv", "load_N,a_mm\n1,1.5\n2,1.9\n4,2.4\n");
  folder.write("hand.xml", "<mujoco><worldbody><geom name='tip' size='.01'/></worldbody></mujoco>");
  folder.write("s.toml", case_text() + "[sweep]\n\"layer.thickness_mm\" = [1, 2]\n");
  fs::create_symlink("tip.obj", folder.path() / "link");
  const auto files = [&] {
    std::map<std::string, std::string> texts;
    for (const auto& entry : fs::directory_iterator(folder.path()))
      if (entry.path().filename().string()[0] != '.')
        texts[entry.path().filename().string()] = file_text(entry.path());
    return texts;
  };
  const auto before = files();
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"mesh", "tip.obj", "--picture", "tip.obj"},
           {"mesh", "tip.obj", "--page", "link"},
           {"mesh", "link", "--page", "./tip.obj"},
           {"fit", "tip.obj", "--point", "5,5,0", "--page", "tip.obj"},
           {"calibrate", "d.csv", "p.toml", "-o", "d.csv"},
           {"calibrate", "d.csv", "p.toml", "--page", "d.csv"},
           {"calibrate", "d.csv", "p.toml", "-o", "p.toml"},
           {"calibrate", "d.csv", "p.toml", "-o", "x", "--page", "x"},
           {"predict", "p.toml", "--page", "p.toml"},
           {"sweep", "s.toml", "-o", "s.toml"},
           {"simulate", "hand.xml", "--write-scene", "hand.xml"},
           {"simulate", "hand.xml", "--write-scene", "tip.obj"}}) {
    SCOPED_TRACE(arguments[0] + " " + arguments[1] + " " + arguments.back());
    expect_refusal(arguments, {arguments[arguments.size() - 2]});
    EXPECT_EQ(files(), before);
  }
  start.input = (folder.path() / "p.toml").string();
  expect_refusal({"predict", "-", "--page", "p.toml"}, {"--page"});
  EXPECT_EQ(files(), before);
}

}  // namespace softfinger::tests
