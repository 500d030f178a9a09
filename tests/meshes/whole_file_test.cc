// Files appear whole or not at all, and nothing that others have put in the folder is touched.

#include "meshes/io/whole_file.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <stdexcept>

#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {
namespace fs = std::filesystem;

class WholeFile : public testing::Test {
 protected:
  WholeFile() {
    std::string name = (fs::temp_directory_path() / "softfinger-whole-XXXXXX").string();
    folder = mkdtemp(name.data());
  }
  ~WholeFile() override { fs::remove_all(folder); }

  /// The file that is being written, by its name in the folder.
  std::string unfinished() const {
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".tmp") return entry.path().filename().string();
    return "";
  }
  static std::string content(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

  fs::path folder;
};

TEST_F(WholeFile, AppearsWithTheModeOfAnOrdinaryFile) {
  const fs::path path = folder / "a";
  const std::string long_text(300'000, 'x');
  const mode_t before = umask(027);
  write_whole_file(path, [&](std::ostream& out) { out << long_text << std::flush << 7; });
  umask(before);
  EXPECT_EQ(content(path), long_text + "7");
  struct stat status {};
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

TEST_F(WholeFile, HasANameThatNobodyCanForeseeUntilItIsWhole) {
  std::set<std::string> names;
  for (int i = 0; i < 20; ++i)
    write_whole_file(folder / "a", [&](std::ostream&) { names.insert(unfinished()); });
  EXPECT_EQ(names.size(), 20u);
  EXPECT_EQ(names.count(""), 0u);
}

TEST_F(WholeFile, FollowsALinkAndReplacesWhatItNames) {
  fs::create_directory(folder / "far");
  std::ofstream(folder / "far" / "b") << "old";
  fs::create_symlink("far/b", folder / "link");
  fs::create_symlink("link", folder / "a");
  write_whole_file(folder / "a", [](std::ostream& out) { out << "new"; });
  EXPECT_EQ(content(folder / "far" / "b"), "new");
  EXPECT_TRUE(fs::is_symlink(folder / "a"));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
}

TEST_F(WholeFile, IsNotWrittenThroughALinkOfAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a link away";
  std::ofstream(folder / "victim") << "mine";
  fs::create_symlink(folder / "victim", folder / "a");
  ASSERT_EQ(lchown((folder / "a").c_str(), 12345, 12345), 0);
  EXPECT_THROW(write_whole_file(folder / "a", [](std::ostream& out) { out << "new"; }), InputError);
  EXPECT_EQ(content(folder / "victim"), "mine");
}

TEST_F(WholeFile, LeavesNothingWhenTheWritingFails) {
  EXPECT_THROW(
      write_whole_file(folder / "a", [](std::ostream&) { throw std::runtime_error("no"); }),
      InputError);
  EXPECT_THROW(
      write_whole_file(folder / "a", [](std::ostream& out) { out.setstate(std::ios::failbit); }),
      InputError);
  EXPECT_THROW(write_whole_file(folder / "none" / "a", [](std::ostream&) {}), InputError);
  EXPECT_THROW(write_whole_file(folder, [](std::ostream&) {}), InputError)
      << "a folder has this name";
  EXPECT_TRUE(fs::is_empty(folder));
  // A stream that swallows the failure of the disk.
  EXPECT_THROW(write_whole_file("/dev/full",
                                [](std::ostream& out) {
                                  out << std::string(1 << 17, 'x');
                                  out.clear();
                                }),
               InputError);
}

}  // namespace
}  // namespace softfinger::meshes
