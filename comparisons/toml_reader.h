#pragma once

#define TOML_HEADER_ONLY 1
#define TOML_ENABLE_UNRELEASED_FEATURES 0
// Some files break what the parser asserts, and lets the compiler assume, of its own state ("[+",
// "a = [}"). The checks that follow there refuse them in words.
#include <toml++/impl/preprocessor.h>
#undef TOML_ASSERT
#undef TOML_ASSERT_ASSUME
#define TOML_ASSERT(condition) static_assert(true)
#define TOML_ASSERT_ASSUME(condition) static_assert(true)
#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

#include "softfinger/input/contact_problem.h"

/// Internal to the readers of case and scene files: the only headers that know TOML.
namespace softfinger {

/// What a file may hold; each message that refuses more states the limit.
constexpr std::size_t kLargestTomlFile = 16 << 20;  ///< bytes
constexpr int kDeepestNesting = 16;                 ///< brackets in brackets, parts of a dotted key
constexpr std::size_t kLongestText = 4096;          ///< bytes: a question, a path
constexpr std::size_t kLongestName = 100;           ///< bytes: of a body, a joint, a layer

constexpr double kMillimetre = 1e-3;
constexpr double kDegree = 3.14159265358979323846 / 180;

/// @throws InputError with the line and the parser's reason, also for tables that are nested too
/// deeply.
toml::table parse_toml(const std::string& text, const std::string& file);

/// A value as the user wrote it, on one line, the beginning of a long one.
std::string as_typed(const toml::node& node);

/// Reads values out of the tables and says precisely where one is wrong.
class TomlReader {
 public:
  explicit TomlReader(std::string file) : file_(std::move(file)) {}

  std::string where(const toml::node& node) const;
  [[noreturn]] void refuse(const toml::node& node, const std::string& field,
                           const std::string& allowed) const;
  [[noreturn]] void say(const toml::node& node, const std::string& sentence) const;
  void check_keys(const toml::table& table, const std::string& name,
                  const std::vector<std::string>& known) const;
  const toml::node& required(const toml::table& table, const std::string& name,
                             std::string_view key) const;
  const toml::table& required_table(const toml::table& parent, std::string_view key) const;

  /// The node as a list of at most `most` entries. @param allowed  what it should be, for messages
  const toml::array& list(const toml::node& node, const std::string& field, std::size_t most,
                          const std::string& allowed) const;
  /// A whole number of the range.
  int integer(const toml::node& node, const std::string& field, int least, int largest,
              const std::string& allowed) const;
  bool boolean(const toml::node& node, const std::string& field,
               const std::string& allowed = "true or false") const;
  /// Any number, NaN excepted; infinity only where it means something. Whole numbers up to 2^53,
  /// which are exact.
  double number(const toml::node& node, const std::string& field, const std::string& allowed,
                bool infinity_allowed = false) const;
  /// A number > 0, in SI. Checked after scaling, where a denormal may have become 0 or a huge value
  /// infinite.
  double positive(const toml::node& node, const std::string& field, double si_per_unit) const;
  std::string text(const toml::node& node, const std::string& field) const;
  /// What a thing is called: not empty, short, without control characters.
  std::string name(const toml::node& node, const std::string& field) const;
  std::string choice(const toml::node& node, const std::string& field,
                     const std::vector<std::string>& choices) const;
  std::vector<double> numbers(const toml::node& node, const std::string& field, std::size_t count,
                              const std::string& allowed, bool infinity_allowed = false) const;

  /// The text `id` of a file: it becomes the name of a folder of results.
  std::string id(const toml::table& root) const;
  /// thickness_mm, youngs_modulus_kPa, poisson_ratio.
  ElasticLayer elastic_layer(const toml::table& table, const std::string& name) const;

 private:
  std::string file_;
};

}  // namespace softfinger
