#include "comparisons/recorded_contacts.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <sstream>
#include <vector>

#include "comparisons/files.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

/// Problems beyond this are no contact problems but damaged files.
constexpr int kMostContacts = 2000, kMostVertices = 10000, kMostBodies = 100000;

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path)
      : path_(path.string()), text_(read_text_file(path)) {}

  ContactLcp read() {
    if (!next_line() || key_ != "softlcp" || integer("softlcp", 1, 1) != 1)
      refuse("first line", line_text_, "\"softlcp 1\"");
    while (next_line()) {
      if (key_ == "nc")
        contacts_ = integer("nc", 1, kMostContacts);
      else if (key_ == "u")
        vertices_ = integer("u", 0, kMostVertices);
      else if (key_ == "nb")
        bodies_ = integer("nb", 1, kMostBodies);
      else if (key_ == "J")
        read_jacobian();
      else if (key_ == "mu" || key_ == "en" || key_ == "V" || key_ == "minv" || key_ == "q4")
        lists_[key_] = numbers(key_);
    }
    return assemble();
  }

 private:
  [[noreturn]] void refuse(const std::string& key, const std::string& value,
                           const std::string& allowed) const {
    throw InputError(path_ + (line_ > 0 ? ":" + std::to_string(line_) : ""), key, value, allowed);
  }

  bool next_line() {
    while (std::getline(text_, line_text_)) {
      ++line_;
      values_ = std::istringstream(line_text_);
      if (values_ >> key_) return true;
    }
    line_ = 0;
    return false;
  }

  double number(const std::string& key) {
    std::string word;
    if (!(values_ >> word)) refuse(key, "", "more numbers than this line has");
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end != '\0' || !std::isfinite(value)) refuse(key, "\"" + word + "\"", "finite numbers");
    return value;
  }
  int integer(const std::string& key, int smallest, int largest) {
    const double value = number(key);
    if (!(value >= smallest && value <= largest && value == std::floor(value)))
      refuse(key, std::to_string(value),
             "a whole number from " + std::to_string(smallest) + " to " + std::to_string(largest));
    return int(value);
  }
  std::vector<double> numbers(const std::string& key) {
    std::vector<double> list(std::size_t(integer(key, 0, 10 * kMostBodies)));
    for (double& value : list) value = number(key);
    std::string word;
    if (values_ >> word) refuse(key, "\"" + word + "\"", "as many numbers as the count says");
    return list;
  }
  void read_jacobian() {
    if (contacts_ < 0 || bodies_ < 0) refuse("J", "", "nc and nb before it");
    const int count = integer("J", 0, 24 * contacts_ * bodies_);
    jacobian_.setZero(4 * contacts_, 6 * bodies_);
    for (int i = 0; i < count; ++i) {
      if (!std::getline(text_, line_text_)) refuse("J", std::to_string(i), "as many lines as said");
      ++line_;
      values_ = std::istringstream(line_text_);
      const int row = integer("J row", 0, 4 * contacts_ - 1);
      const int column = integer("J column", 0, 6 * bodies_ - 1);
      jacobian_(row, column) = number("J");
    }
  }

  Eigen::Map<const Eigen::VectorXd> list(const std::string& key, int size) const {
    const auto found = lists_.find(key);
    if (found == lists_.end()) refuse(key, "", "a line with this key");
    if (found->second.size() != std::size_t(size))
      refuse(key, std::to_string(found->second.size()) + " values", std::to_string(size));
    return {found->second.data(), size};
  }

  ContactLcp assemble() const {
    if (contacts_ < 0) refuse("nc", "", "a line with this key");
    if (vertices_ < 0) refuse("u", "", "a line with this key");
    if (bodies_ < 0) refuse("nb", "", "a line with this key");
    if (jacobian_.size() == 0) refuse("J", "", "a line with this key");
    const Eigen::VectorXd inverse_masses = list("minv", 6 * bodies_);
    if (inverse_masses.minCoeff() < 0)
      refuse("minv", std::to_string(inverse_masses.minCoeff()), "numbers >= 0");
    ContactLcp problem;
    problem.friction_coefficient = list("mu", contacts_);
    problem.eccentricity_m = list("en", contacts_);
    problem.free_velocity = list("q4", 4 * contacts_);
    problem.vertices =
        Eigen::Map<const Eigen::Matrix3Xd>(list("V", 3 * vertices_).data(), 3, vertices_);
    problem.delassus.noalias() = jacobian_ * inverse_masses.asDiagonal() * jacobian_.transpose();
    check(problem);
    return problem;
  }

  /// The solver checks as well, but it knows no file.
  void check(const ContactLcp& problem) const {
    for (int i = 0; i < contacts_; ++i) {
      const double mu = problem.friction_coefficient[i], arm_m = problem.eccentricity_m[i];
      if (mu < 0) refuse("mu", std::to_string(mu), "numbers >= 0");
      if (arm_m < 0) refuse("en", std::to_string(arm_m), "numbers >= 0");
      if (!(problem.delassus(4 * i, 4 * i) > 0))
        refuse("J", "contact " + std::to_string(i) + " moves no body along its normal",
               "a body with minv > 0 in each contact");
    }
    if (!problem.delassus.allFinite()) refuse("J, minv", "", "products that are finite");
  }

  std::string path_;
  std::istringstream text_;
  int line_ = 0, contacts_ = -1, vertices_ = -1, bodies_ = -1;
  std::string line_text_, key_;
  std::istringstream values_;
  std::map<std::string, std::vector<double>> lists_;
  Eigen::MatrixXd jacobian_;
};

}  // namespace

ContactLcp read_recorded_contacts(const std::filesystem::path& path) { return Reader(path).read(); }

void write_recorded_contacts(const ContactLcp& problem, const Eigen::Matrix3Xd& vertices,
                             const std::string& note, const std::filesystem::path& path) {
  const int rows = 4 * problem.contacts(), bodies = (rows + 5) / 6;
  // W = P^T L D L^T P; D of a semi-definite matrix may be a round-off below zero.
  const Eigen::LDLT<Eigen::MatrixXd> factor(problem.delassus);
  Eigen::MatrixXd jacobian = factor.matrixL();
  jacobian *= factor.vectorD().cwiseMax(0).cwiseSqrt().asDiagonal();
  jacobian = factor.transpositionsP().transpose() * jacobian;

  std::string text = fmt::format("softlcp 1\nnote {}\nnc {}\nu {}\nnb {}\n", note,
                                 problem.contacts(), vertices.cols(), bodies);
  const auto list = [&text](const char* key, const double* values, Eigen::Index count) {
    text += fmt::format("{} {}", key, count);
    for (Eigen::Index i = 0; i < count; ++i) text += fmt::format(" {:.17g}", values[i]);
    text += '\n';
  };
  list("mu", problem.friction_coefficient.data(), problem.friction_coefficient.size());
  list("en", problem.eccentricity_m.data(), problem.eccentricity_m.size());
  list("V", vertices.data(), vertices.size());
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(6 * bodies);
  list("minv", ones.data(), ones.size());
  std::string entries;
  int count = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < rows; ++column)
      if (jacobian(row, column) != 0) {
        entries += fmt::format("{} {} {:.17g}\n", row, column, jacobian(row, column));
        ++count;
      }
  text += fmt::format("J {}\n{}", count, entries);
  list("q4", problem.free_velocity.data(), problem.free_velocity.size());
  write_file_atomically(path, text);
}

}  // namespace softfinger
