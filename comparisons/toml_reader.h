#pragma once

#define TOML_HEADER_ONLY 1
#define TOML_ENABLE_UNRELEASED_FEATURES 0
#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

#include "softfinger/input/contact_problem.h"

/// Internal to the readers of case and scene files: the only headers that know TOML.
namespace softfinger {

constexpr double kMillimetre = 1e-3;
constexpr double kDegree = 3.14159265358979323846 / 180;

/// @throws InputError with the line and the parser's reason.
toml::table parse_toml(const std::string& text, const std::string& file);

/// A value as the user wrote it, on one line.
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

  /// Any number, NaN excepted; infinity only where it means something.
  double number(const toml::node& node, const std::string& field, const std::string& allowed,
                bool infinity_allowed = false) const;
  /// A number > 0, in SI. Checked after scaling, where a denormal may have become 0 or a huge value
  /// infinite.
  double positive(const toml::node& node, const std::string& field, double si_per_unit) const;
  std::string text(const toml::node& node, const std::string& field) const;
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
