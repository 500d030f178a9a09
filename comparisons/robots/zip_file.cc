#include "comparisons/robots/zip_file.h"

#include <zlib.h>

#include <cctype>
#include <string_view>
#include <utility>

#include "comparisons/robots/imported_scene.h"
#include "meshes/io/read_surface.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {
namespace {

// Signatures and sizes of APPNOTE.TXT, the description of the format.
constexpr std::uint64_t kEnd = 0x06054b50, kEnd64 = 0x06064b50, kEnd64Locator = 0x07064b50,
                        kDirectoryEntry = 0x02014b50, kLocalEntry = 0x04034b50;
constexpr std::uint64_t kEndSize = 22, kLocatorSize = 20, kDirectorySize = 46, kLocalSize = 30,
                        kLongestComment = 65535;
constexpr std::uint64_t kIn64Bits = 0xFFFFFFFF;

std::string small_letters(std::string name) {
  for (char& letter : name) letter = char(std::tolower(static_cast<unsigned char>(letter)));
  return name;
}

}  // namespace

ZipFile::ZipFile(std::string bytes, std::string path)
    : bytes_(std::move(bytes)), path_(std::move(path)) {
  read_directory();
}

void ZipFile::refuse(const std::string& value) const {
  throw InputError(path_, "file", value, "a whole ZIP archive, as 3MF is one");
}

std::uint64_t ZipFile::number(std::uint64_t at, int bytes) const {
  if (at > bytes_.size() || bytes_.size() - at < std::uint64_t(bytes)) refuse("truncated");
  std::uint64_t value = 0;
  for (int i = bytes; i-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes_[std::size_t(at) + std::size_t(i)]);
  return value;
}

void ZipFile::read_directory() {
  if (bytes_.size() < kEndSize) refuse("no archive, or a truncated one");
  std::uint64_t end = bytes_.size() - kEndSize;
  const std::uint64_t first = end > kLongestComment ? end - kLongestComment : 0;
  while (number(end, 4) != kEnd) {
    if (end == first) refuse("no archive, or a truncated one");
    --end;
  }
  std::uint64_t count = number(end + 10, 2), at = number(end + 16, 4);
  if (at == kIn64Bits && end >= kLocatorSize && number(end - kLocatorSize, 4) == kEnd64Locator) {
    const std::uint64_t end64 = number(end - kLocatorSize + 8, 8);
    if (number(end64, 4) != kEnd64) refuse("damaged");
    count = number(end64 + 32, 8);
    at = number(end64 + 48, 8);
  }
  for (; count > 0; --count) {
    if (number(at, 4) != kDirectoryEntry) refuse("damaged");
    Entry entry;
    entry.is_encrypted = number(at + 8, 2) & 1;
    entry.method = unsigned(number(at + 10, 2));
    entry.check = std::uint32_t(number(at + 16, 4));
    entry.packed = number(at + 20, 4);
    entry.size = number(at + 24, 4);
    entry.offset = number(at + 42, 4);
    const std::uint64_t name = number(at + 28, 2), extra = number(at + 30, 2),
                        comment = number(at + 32, 2);
    if (name > 0) number(at + kDirectorySize + name - 1, 1);
    entry.name = bytes_.substr(std::size_t(at + kDirectorySize), std::size_t(name));
    // Sizes of 64 bits stand in an extra field of their own, one for each that is missing.
    std::uint64_t field = at + kDirectorySize + name;
    for (const std::uint64_t fields_end = field + extra; field + 4 <= fields_end;) {
      const std::uint64_t kind = number(field, 2), size = number(field + 2, 2);
      std::uint64_t value = field + 4;
      field = value + size;
      if (kind != 1) continue;
      for (std::uint64_t* wide : {&entry.size, &entry.packed, &entry.offset})
        if (*wide == kIn64Bits && value + 8 <= field) {
          *wide = number(value, 8);
          value += 8;
        }
    }
    at += kDirectorySize + name + extra + comment;
    entries_.emplace(small_letters(entry.name), std::move(entry));
  }
}

std::optional<std::string> ZipFile::read(const std::string& name) {
  const auto found = entries_.find(small_letters(name));
  if (found == entries_.end()) return std::nullopt;
  const Entry& entry = found->second;
  const auto refuse_entry = [&](const std::string& value, const std::string& allowed) {
    throw InputError(path_, in_quotes(entry.name.substr(0, kLongestName)), value, allowed);
  };
  if (entry.is_encrypted) refuse_entry("encrypted", "a file without a password");
  constexpr unsigned kStored = 0, kDeflated = 8;
  if (entry.method != kStored && entry.method != kDeflated)
    refuse_entry("method " + std::to_string(entry.method), "stored or deflated");
  if (entry.size > meshes::kLargestSurface_bytes - unpacked_)
    refuse_entry(std::to_string(entry.size) + " bytes",
                 "at most " + std::to_string(meshes::kLargestSurface_bytes) + " bytes unpacked");
  if (number(entry.offset, 4) != kLocalEntry) refuse("damaged");
  const std::uint64_t begin =
      entry.offset + kLocalSize + number(entry.offset + 26, 2) + number(entry.offset + 28, 2);
  if (begin > bytes_.size() || entry.packed > bytes_.size() - begin) refuse("truncated");
  const std::string_view packed(bytes_.data() + begin, std::size_t(entry.packed));
  std::string content;
  if (entry.method == kStored) {
    content = packed;
  } else {
    // The size that is announced is only believed as far as it can be true: deflation packs at most
    // 1032 bytes into one.
    constexpr std::uint64_t kDensest = 1032;
    if (entry.size / kDensest > entry.packed + 1) refuse("damaged");
    content.resize(std::size_t(entry.size));
    z_stream stream{};
    constexpr int kRaw = -15;
    if (inflateInit2(&stream, kRaw) != Z_OK) refuse("damaged");
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = uInt(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(content.data());
    stream.avail_out = uInt(content.size());
    const int status = inflate(&stream, Z_FINISH);
    const bool is_whole = status == Z_STREAM_END && stream.avail_out == 0;
    inflateEnd(&stream);
    if (!is_whole) refuse("damaged");
  }
  if (content.size() != entry.size ||
      crc32(0, reinterpret_cast<const Bytef*>(content.data()), uInt(content.size())) != entry.check)
    refuse("damaged");
  unpacked_ += entry.size;
  return content;
}

}  // namespace softfinger::robots
