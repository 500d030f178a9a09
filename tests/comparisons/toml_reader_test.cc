// Limits of a TOML file's text, checked before its tables mean anything.
#include <gtest/gtest.h>

#include <string>

#include "comparisons/input/case.h"
#include "comparisons/input/scene.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

std::string repeated_text(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

std::string message(const std::string& text) {
  try {
    input::parse_case(text, "x.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_words(const std::string& text, const std::string& words) {
  EXPECT_NE(message(text).find(words), std::string::npos)
      << text.substr(0, 200) << "\n"
      << message(text).substr(0, 300) << "\ninstead of\n"
      << words;
}

}  // namespace

TEST(TomlReader, RefusesDeepNestingBeforeTheParserRecurses) {
  constexpr int kDeep = 300000;
  const std::string brackets = "x.toml:2: brackets in brackets: allowed: at most 16 levels";
  const std::string dots = "x.toml:2: dotted key: allowed: at most 16 parts";
  expect_words("\na = " + repeated_text("[", kDeep), brackets);
  expect_words("\na = " + repeated_text("{a=", kDeep), brackets);
  expect_words("\n" + repeated_text("[", kDeep), brackets);
  expect_words("\nid" + repeated_text(".a", kDeep) + " = 1", dots);
  expect_words("\nid" + repeated_text(" . \"a\"", kDeep) + " = 1", dots);
  expect_words("\n[layer" + repeated_text(".'a'", kDeep) + "]", dots);
  expect_words("\na = { b" + repeated_text(".a", kDeep) + " = 1 }", dots);
  const std::string scene = "id = 'x'\n[simulation" + repeated_text(".a", kDeep) + "]";
  EXPECT_THROW(input::parse_scene(scene, "x.toml"), InputError);
}

// Found by fuzzing: the parser asserts that these do not happen, or calls it unreachable, which
// ended debug and sanitized builds.
TEST(TomlReader, RefusesWhatTheParserDoesNotExpectOfItself) {
  for (const char* text : {"[+", "[+]", "[\r", "[[=]]", "x = [}", "x = [,]", "\"x\" = [} 2 = ",
                           "\xC2\xB2", "a\xC3\xA9 = 1", "[\xD0\xB6]", "a = 1 \xCE\xB1"})
    expect_words(text, "x.toml:1: not a TOML file: ");
  // No file that is wrong: the text goes on in the next line.
  expect_words("a = \"\"\" \\\n \xC3\xA9\"\"\"", "unknown key \"a\"");
}

TEST(TomlReader, SaysWhereRobotsFilesBelong) {
  expect_words(" \n<mujoco/>", "x.toml: not a TOML file: it begins as XML does");
  expect_words("<mujoco/>", ".xml, .mjcf, .urdf or .sdf");
}

// Found by fuzzing: the parser's own way of writing a table measures its numbers' widths, and not
// all of them fit the type that it takes for that.
TEST(TomlReader, NamesATableThatStandsWhereATextShould) {
  expect_words("id = { radius = -320.0, more = [1, { x = \"a\" }] }",
               "id = { more = [1, { x = \"a\" }], radius = -320 }");
}

TEST(TomlReader, TakesNestingUpToItsLimit) {
  expect_words("a = " + repeated_text("[", 16) + repeated_text("]", 16), "unknown key \"a\"");
  expect_words("a = " + repeated_text("[", 17) + repeated_text("]", 17), "at most 16 levels");
  expect_words("a" + repeated_text(".a", 15) + " = 1", "unknown key \"a\"");
  expect_words("a" + repeated_text(".a", 16) + " = 1", "at most 16 parts");
}

TEST(TomlReader, CountsNoBracketsInStringsAndComments) {
  const std::string deep = repeated_text("[{.", 40);
  const std::string three = R"(""")";
  for (const std::string& quoted :
       {"\"" + deep + "\"", R"("\")" + deep + R"(\\")", "'" + deep + "'", "'" + deep + "\\'",
        three + "\n\"" + deep + "\"\"\n\\" + three + deep + three + "\"\"",
        "'''\n''" + deep + "'''''"})
    expect_words("a = " + quoted + " # \"'" + deep + "\nb = 3 #" + deep, "unknown key \"a\"");
}

TEST(TomlReader, CountsTheBracketsBehindStringsAndComments) {
  const std::string after = "\nb = " + repeated_text("[", 17);
  for (const char* before : {"''", "\"\"", "''''''", R"("""""")", "'#'", "\"#\"", "'\\'", "1 # '"})
    expect_words("a = " + std::string(before) + after, "x.toml:2: brackets in brackets");
}

TEST(TomlReader, ShortensWhatItRepeats) {
  const std::string endless(1000000, 'x');
  for (const std::string& text :
       {endless + " = 1", "id = \"" + endless + "\"", "id = [\"" + endless + "\"]",
        "id = [" + repeated_text("1,", 1000000) + "]", "id = " + endless,
        "id = \"x\"\nquestion = \"" + endless + "\""}) {
    EXPECT_GT(message(text).size(), 0u);
    EXPECT_LT(message(text).size(), 600u);
  }
}

}  // namespace softfinger
