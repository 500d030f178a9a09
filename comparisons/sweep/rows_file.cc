#include "comparisons/sweep/rows_file.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <vector>

#include "softfinger/input/errors.h"
#include "softfinger/input/hash.h"

namespace softfinger::sweep {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kBuffer = 1 << 20;

/// Goes on with a hash of the file's bytes from one place to another, or to the end of the file.
/// @returns the place that was reached
std::uint64_t hash_on(const system::GrowingFile& file, std::uint64_t from, std::uint64_t to,
                      std::uint64_t& hash, std::vector<char>& buffer) {
  while (from < to) {
    const std::size_t count =
        file.read(from, buffer.data(), std::min<std::uint64_t>(buffer.size(), to - from));
    if (count == 0) break;
    hash = hash_of({buffer.data(), count}, hash);
    from += count;
  }
  return from;
}

}  // namespace

std::string RowsFile::Place::line() const {
  return std::to_string(points) + " " + std::to_string(bytes) + " " + hash_text(hash) + "\n";
}

RowsFile::RowsFile(const fs::path& folder, const std::string& header, const std::string& identity,
                   bool go_on)
    : finished_(folder / "results.csv"),
      check_name_(folder / "results.partial.check"),
      rows_(folder / "results.partial.csv"),
      checks_(check_name_) {
  if (go_on && resume(header, identity)) return;
  rows_.cut_to(0);
  checks_.cut_to(0);
  at_ = {0, 0, hash_of("")};
  checks_.append(identity + "\n");
  append(header, 0);
}

bool RowsFile::resume(const std::string& header, const std::string& identity) {
  const std::string text = checks_.read_all();
  std::size_t good_checks = identity.size() + 1;
  if (text.compare(0, good_checks, identity + "\n") != 0) return false;
  std::vector<char> buffer(kBuffer);
  Place reached{0, 0, hash_of("")};
  bool is_known = false;
  while (true) {
    const std::size_t end = text.find('\n', good_checks);
    if (end == std::string::npos) break;
    const std::string line = text.substr(good_checks, end + 1 - good_checks);
    Place next;
    if (!(std::istringstream(line) >> next.points >> next.bytes) || next.bytes < reached.bytes ||
        next.points < reached.points) {
      had_changed_rows_ = true;
      break;
    }
    next.hash = reached.hash;
    const bool is_there =
        hash_on(rows_, reached.bytes, next.bytes, next.hash, buffer) == next.bytes;
    // The first place is that after the header.
    if (!is_there || next.line() != line || (!is_known && next.bytes != header.size())) {
      had_changed_rows_ = true;
      break;
    }
    is_known = true;
    reached = next;
    good_checks = end + 1;
  }
  if (!is_known) return false;
  at_ = reached;
  rows_.cut_to(at_.bytes);
  checks_.cut_to(good_checks);
  return true;
}

void RowsFile::append(const std::string& text, std::size_t points) {
  rows_.append(text);
  at_ = {at_.points + points, at_.bytes + text.size(), hash_of(text, at_.hash)};
  checks_.append(at_.line());
}

std::string RowsFile::check() {
  rows_.sync();
  return at_.line();
}

void RowsFile::finish() {
  rows_.sync();
  rows_.rename_to(finished_);
  std::error_code ignored;
  fs::remove(check_name_, ignored);
}

bool RowsFile::is_whole(const fs::path& file, const std::string& check) {
  std::ifstream rows(file, std::ios::binary);
  if (!rows) return false;
  Place place;
  std::istringstream(check) >> place.points;
  place.hash = hash_of("");
  std::vector<char> buffer(kBuffer);
  while (rows.read(buffer.data(), std::streamsize(buffer.size())), rows.gcount() > 0) {
    const auto count = std::size_t(rows.gcount());
    place.hash = hash_of({buffer.data(), count}, place.hash);
    place.bytes += count;
  }
  return place.line() == check;
}

}  // namespace softfinger::sweep
