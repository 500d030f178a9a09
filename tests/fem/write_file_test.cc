#include "fem/base/write_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {
namespace fs = std::filesystem;

TEST(WriteFile, MakesFoldersAndFollowsNoLinkThatSomeoneHasPutThere) {
  const fs::path folder =
      fs::temp_directory_path() / ("softfinger_write_file_" + std::to_string(getpid()));
  const fs::path victim = folder / "victim", path = folder / "vtu" / "a.vtu";
  fs::create_directories(path.parent_path());
  std::ofstream(victim) << "mine";
  fs::create_symlink(victim, path.string() + "." + std::to_string(getpid()) + ".partial");
  write_file(path, "VTU file", [](std::ostream& out) { out << "a result"; });
  EXPECT_EQ(fs::file_size(victim), 4u);
  EXPECT_EQ(fs::file_size(path), 8u);
  write_file(folder / "b" / "c" / "d", "VTU file", [](std::ostream& out) { out << 1; });
  EXPECT_EQ(fs::file_size(folder / "b" / "c" / "d"), 1u);
  EXPECT_THROW(write_file(victim / "e", "VTU file", [](std::ostream&) {}), InputError);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace softfinger::fem
