#include "comparisons/input/recorded_contacts.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "comparisons/system/files.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

/// Limits of a file. W is dense and takes 128 MB for this many contacts, its solution several times
/// as much. Everything else takes memory in proportion to the size of the file.
constexpr std::size_t kLargestFile = 64 << 20;  // bytes
constexpr int kMostRecordedContacts = 1000, kMostRecordedVertices = 1024,
              kMostRecordedBodies = 100000;

class Reader {
 public:
  Reader(const std::string& text, std::string file) : text_(text), file_(std::move(file)) {}

  ContactLcp read() {
    if (text_.size() > kLargestFile)
      throw InputError(file_, "size of the file", "",
                       fmt::format("at most {} MiB", kLargestFile >> 20));
    if (!next_line() || key_ != "softlcp" || word() != "1" || !word().empty())
      refuse("first line", line_text_, "\"softlcp 1\": no other version of the format is known");
    while (next_line()) {
      const std::string key(key_);
      if (key == "nc")
        contacts_ = once(key, integer(key, 1, kMostRecordedContacts));
      else if (key == "u")
        vertices_ = once(key, integer(key, 0, kMostRecordedVertices));
      else if (key == "nb")
        bodies_ = once(key, integer(key, 1, kMostRecordedBodies));
      else if (key == "J")
        jacobian_ = once(key, read_jacobian());
      else if (key == "mu" || key == "en" || key == "V" || key == "minv" || key == "q4")
        lists_[key] = once(key, numbers(key));
    }
    return assemble();
  }

 private:
  using SparseMatrix = Eigen::SparseMatrix<double>;

  [[noreturn]] void refuse(const std::string& key, std::string_view value,
                           const std::string& allowed) const {
    throw InputError(file_ + (line_ > 0 ? ":" + std::to_string(line_) : ""), key,
                     text::shortened(value), allowed);
  }

  /// Each key may be given once: arrays have already been sized by the first value.
  template <typename Value>
  Value once(const std::string& key, Value value) {
    require_end_of_line(key);
    if (!keys_.insert(key).second) refuse(key, "", "one line with this key");
    return value;
  }

  bool read_line() {
    if (at_ >= text_.size()) return false;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    rest_ = line_text_ = std::string_view(text_).substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    return true;
  }
  bool next_line() {
    while (read_line())
      if (key_ = word(); !key_.empty()) return true;
    line_ = 0;
    return false;
  }
  std::size_t bytes_left() const {
    return rest_.size() + text_.size() - std::min(at_, text_.size());
  }

  /// The next word of the line; empty if there is none.
  std::string_view word() {
    constexpr std::string_view kBlanks = " \t\r\v\f";
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
    const std::string_view found = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(found.size());
    return found;
  }
  double number(const std::string& key) {
    const std::string_view typed = word();
    if (typed.empty()) refuse(key, "", "more numbers than this line has");
    char* end = nullptr;
    const double value = std::strtod(typed.data(), &end);
    if (end != typed.data() + typed.size() || !std::isfinite(value))
      refuse(key, fmt::format("\"{}\"", text::shortened(typed)), "finite numbers");
    return value;
  }
  int integer(const std::string& key, int smallest, int largest) {
    const double value = number(key);
    if (!(value >= smallest && value <= largest && value == std::floor(value)))
      refuse(key, fmt::format("{}", value),
             fmt::format("a whole number from {} to {}", smallest, largest));
    return int(value);
  }
  /// The number of values that follow. It is refused if the rest of the file is too short for so
  /// many, so that a wrong number does not allocate memory.
  std::size_t count(const std::string& key, std::size_t bytes_each) {
    const std::size_t most = bytes_left() / bytes_each;
    const double value = number(key);
    if (!(value >= 0 && value <= double(most) && value == std::floor(value)))
      refuse(key, fmt::format("{}", value),
             fmt::format("a whole number, at most {} here: the file holds no more", most));
    return std::size_t(value);
  }
  std::vector<double> numbers(const std::string& key) {
    constexpr std::size_t kShortest = 2;  // " 1"
    std::vector<double> list(count(key, kShortest));
    for (double& value : list) value = number(key);
    return list;
  }
  void require_end_of_line(const std::string& key) {
    if (const std::string_view typed = word(); !typed.empty())
      refuse(key, fmt::format("\"{}\"", text::shortened(typed)),
             "as many numbers as the count says, and nothing behind them");
  }
  SparseMatrix read_jacobian() {
    if (contacts_ < 0 || bodies_ < 0) refuse("J", "", "nc and nb before it");
    constexpr std::size_t kShortest = 5;  // "0 0 1"
    const std::size_t entries = count("J", kShortest);
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(entries);
    for (std::size_t i = 0; i < entries; ++i) {
      require_end_of_line("J");
      if (!read_line()) refuse("J", std::to_string(i), "as many lines as said");
      const int row = integer("J row", 0, 4 * contacts_ - 1);
      const int column = integer("J column", 0, 6 * bodies_ - 1);
      triplets.emplace_back(row, column, number("J"));
    }
    SparseMatrix jacobian(4 * contacts_, 6 * bodies_);
    jacobian.setFromTriplets(triplets.begin(), triplets.end());
    if (std::size_t(jacobian.nonZeros()) != entries) refuse("J", "", "each row and column once");
    return jacobian;
  }

  Eigen::Map<const Eigen::VectorXd> list(const std::string& key, int size) const {
    require(key);
    const std::vector<double>& values = lists_.at(key);
    if (values.size() != std::size_t(size))
      refuse(key, fmt::format("{} values", values.size()), std::to_string(size));
    return {values.data(), size};
  }
  void require(const std::string& key) const {
    if (!keys_.count(key)) refuse(key, "", "a line with this key");
  }

  ContactLcp assemble() const {
    for (const char* key : {"nc", "u", "nb", "J"}) require(key);
    const Eigen::VectorXd inverse_masses = list("minv", 6 * bodies_);
    if (inverse_masses.minCoeff() < 0)
      refuse("minv", fmt::format("{}", inverse_masses.minCoeff()), "numbers >= 0");
    ContactLcp problem;
    problem.friction_coefficient = list("mu", contacts_);
    problem.eccentricity_m = list("en", contacts_);
    problem.free_velocity = list("q4", 4 * contacts_);
    problem.vertices =
        Eigen::Map<const Eigen::Matrix3Xd>(list("V", 3 * vertices_).data(), 3, vertices_);
    const SparseMatrix weighted = jacobian_ * inverse_masses.asDiagonal();
    problem.delassus = weighted * SparseMatrix(jacobian_.transpose());
    check(problem);
    return problem;
  }

  /// The solver checks the same, but its message could not name the file.
  void check(const ContactLcp& problem) const {
    for (int i = 0; i < contacts_; ++i) {
      const double mu = problem.friction_coefficient[i], arm_m = problem.eccentricity_m[i];
      if (mu < 0) refuse("mu", fmt::format("{}", mu), "numbers >= 0");
      if (arm_m < 0) refuse("en", fmt::format("{}", arm_m), "numbers >= 0");
      if (!(problem.delassus(4 * i, 4 * i) > 0))
        refuse("J", fmt::format("contact {} moves no body along its normal", i),
               "a body with minv > 0 in each contact");
    }
    if (!problem.delassus.allFinite()) refuse("J, minv", "", "products that are finite");
  }

  const std::string& text_;
  std::string file_;
  std::size_t at_ = 0;  ///< where the next line begins
  int line_ = 0, contacts_ = -1, vertices_ = -1, bodies_ = -1;
  std::string_view line_text_, rest_, key_;
  std::set<std::string> keys_;
  std::map<std::string, std::vector<double>> lists_;
  SparseMatrix jacobian_;
};

}  // namespace

ContactLcp parse_recorded_contacts(const std::string& text, const std::filesystem::path& file) {
  return Reader(text, file.string()).read();
}

ContactLcp read_recorded_contacts(const std::filesystem::path& file) {
  if (file == "-")
    return parse_recorded_contacts(system::read_standard_input(kLargestFile), "standard input");
  return parse_recorded_contacts(system::read_text_file(file, kLargestFile), file);
}

void write_recorded_contacts(const ContactLcp& problem, const Eigen::Matrix3Xd& vertices,
                             const std::string& note, const std::filesystem::path& path) {
  const int rows = 4 * problem.contacts(), bodies = (rows + 5) / 6;
  // W = P^T L D L^T P. For a semi-definite W, rounding can make entries of D slightly negative.
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
  system::write_file_atomically(path, text);
}

}  // namespace softfinger::input
