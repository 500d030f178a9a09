#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace softfinger::fem {

/// A value of a program's input together with the key that leads to it ("layer.thickness_m"). All
/// functions throw InputError naming that key where the value is not as they say.
class Entry {
 public:
  /// @param problem  name for messages
  Entry(const nlohmann::json& value, std::string key, std::string problem)
      : value_(&value), key_(std::move(key)), problem_(std::move(problem)) {}

  [[noreturn]] void refuse(const std::string& allowed) const;

  /// Returns nothing where the key is missing or null.
  std::optional<Entry> find(const char* key) const;
  Entry at(const char* key) const;
  std::vector<Entry> list(std::size_t fewest, std::size_t most) const;

  double number(double least, double largest, const char* allowed) const;
  double finite() const;
  double positive() const;
  int whole(int least, int largest) const;
  bool flag() const;
  std::string text() const;
  std::string choice(const std::vector<const char*>& choices) const;
  /// Null is a straight direction.
  double radius() const;
  Eigen::Vector3d vector() const;
  Eigen::Vector3d direction() const;
  std::string dump() const;
  std::string dump_without(const char* key) const;

 private:
  const nlohmann::json* value_;
  std::string key_, problem_;
};

}  // namespace softfinger::fem
