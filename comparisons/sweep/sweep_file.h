#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "comparisons/input/case.h"

/// A sweep file: a case and the table [sweep], which gives some of the case's numbers many values.
///
///   [sweep]
///   "layer.poisson_ratio" = [0.3, 0.45, 0.49]
///   "layer.thickness_mm" = { from = 0.5, to = 5, steps = 10, spacing = "log" }
///   "geometry.relative_radii_mm[0]" = { from = 5, to = 50, random = 100, seed = 7 }
///   zip = [["layer.thickness_mm", "layer.poisson_ratio"]]  # these two change together
///   models = ["bonded_layer", "hertz"]                     # default: all that take microseconds
///   fem = true                                             # also finite elements
///
/// Keys that are not zipped are combined with each other; the last one changes fastest.
namespace softfinger::sweep {

/// Limits of a sweep. Rows are written as they come; finite-element jobs and values are kept in
/// memory.
constexpr std::size_t kMostSweepRows = 100'000'000, kMostSweepFemJobs = 100'000,
                      kMostSweptValues = 1'000'000;

/// The text of a sweep file; "-": of standard input.
/// @throws InputError when it cannot be read or is larger than any such file
std::string read_sweep_text(const std::filesystem::path& file);

/// One number of the case and its values.
struct SweptKey {
  std::string key;  ///< as typed: "layer.thickness_mm"
  std::vector<double> values;
  bool log_spacing = false;  ///< for the axis of a picture
};

class Sweep {
 public:
  /// Reads a sweep file and checks the case with its own numbers and with the first, last, smallest
  /// and largest value of each key.
  /// @throws InputError(file:line)
  Sweep(const std::string& text, const std::filesystem::path& file,
        const input::Settings& settings = {});
  ~Sweep();
  Sweep(const Sweep&) = delete;
  Sweep& operator=(const Sweep&) = delete;

  /// The file's text with the settings' values.
  const std::string& text() const;
  const input::Case& base() const { return base_; }
  /// The axes in the order of the file.
  const std::vector<SweptKey>& keys() const { return keys_; }
  /// The names as [sweep] has them, or empty.
  const std::vector<std::string>& models() const { return models_; }
  bool fem() const { return fem_; }

  std::size_t points() const { return points_; }
  std::size_t rows() const { return points_ * base_.loads_N.size(); }
  /// The value of each key at a point, in the order of `keys`.
  void values_at(std::size_t point, std::vector<double>& values) const;

  /// Makes the cases of points without parsing the file again. Not safe to share between threads.
  class Cases {
   public:
    explicit Cases(const Sweep& sweep);
    ~Cases();
    /// @throws InputError for values that do not go together; its `where` is the file
    input::Case at(std::size_t point);

   private:
    struct Table;
    const Sweep& sweep_;
    std::unique_ptr<Table> table_;
    std::vector<double> values_;
  };

 private:
  struct File;
  std::unique_ptr<File> file_;
  input::Case base_;
  std::vector<SweptKey> keys_;
  std::vector<std::vector<std::size_t>> axes_;  ///< keys that change together
  std::vector<std::string> models_;
  bool fem_ = false;
  std::size_t points_ = 1;
};

}  // namespace softfinger::sweep
