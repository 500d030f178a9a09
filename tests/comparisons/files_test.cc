#include "comparisons/system/files.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "softfinger/input/errors.h"

namespace softfinger {
namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "softfinger-files-XXXXXX").string();
    folder = mkdtemp(name.data());
  }
  void TearDown() override { fs::remove_all(folder); }
  fs::path folder;
};

TEST_F(Files, ReplaceTheOldContentAndLeaveNothingElse) {
  system::write_file_atomically(folder / "a.json", "old");
  system::write_file_atomically(folder / "a.json", "new");
  EXPECT_EQ(system::read_text_file(folder / "a.json"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

TEST_F(Files, AppearTogetherOrNotAtAll) {
  const fs::path first = folder / "first", second = folder / "missing" / "second";
  EXPECT_THROW(system::write_files_together({{first, "one"}, {second, "two"}}), InputError);
  EXPECT_TRUE(fs::is_empty(folder));
  system::write_files_together({{first, "one"}, {folder / "second", "two"}});
  EXPECT_EQ(system::read_text_file(first) + system::read_text_file(folder / "second"), "onetwo");
}

TEST_F(Files, RefuseAFolderThatIsAFile) {
  system::write_file_atomically(folder / "file", "x");
  EXPECT_THROW(system::make_writable_folder(folder / "file" / "output"), InputError);
  EXPECT_THROW(system::make_writable_folder(folder / "file"), InputError);
  EXPECT_THROW(system::make_writable_folder("/proc/softfinger"), InputError);
  EXPECT_THROW(system::write_file_atomically(folder / "file" / "a", "x"), InputError);
}

TEST_F(Files, FollowNoLinkThatWaitsInTheFolder) {
  // The name that an earlier version used.
  const fs::path victim = folder / "victim", output = folder / "output";
  system::write_file_atomically(victim, "precious");
  fs::create_directory(output);
  fs::create_symlink(victim, output / (".a.json." + std::to_string(getpid()) + ".tmp"));
  fs::create_symlink(victim, output / (".softfinger." + std::to_string(getpid()) + ".probe"));
  system::write_file_atomically(output / "a.json", "new");
  system::make_writable_folder(output);
  EXPECT_EQ(system::read_text_file(victim), "precious");
  fs::create_symlink(victim, output / ".softfinger.lock");
  EXPECT_THROW(system::OutputFolder{output}, InputError);
  EXPECT_EQ(system::read_text_file(victim), "precious");
}

TEST_F(Files, OfAFolderInUseAreLeftAlone) {
  {
    const system::OutputFolder first(folder / "results");
    try {
      const system::OutputFolder second(folder / "results");
      FAIL() << "two runs in one folder";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("process " + std::to_string(getpid())),
                std::string::npos)
          << error.what();
    }
  }
  const system::OutputFolder third(folder / "results");
}

TEST_F(Files, AreReadUpToTheirLimitAndNoFurther) {
  const std::string content(1 << 20, 'x');
  system::write_file_atomically(folder / "full", content);
  EXPECT_EQ(system::read_text_file(folder / "full", 1 << 20), content);
  system::write_file_atomically(folder / "larger", content + "x");
  EXPECT_THROW(system::read_text_file(folder / "larger", 1 << 20), InputError);
}

TEST_F(Files, AreNeverWaitedFor) {
  const fs::path pipe = folder / "pipe.toml";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const fs::path& path : {pipe, fs::path("/dev/zero")})
    EXPECT_THROW(system::read_text_file(path), InputError) << path;
}

TEST_F(Files, NameTheFileThatCannotBeRead) {
  for (const fs::path& path : {folder / "missing.toml", folder}) {
    try {
      system::read_text_file(path);
      FAIL() << path;
    } catch (const InputError& error) {
      EXPECT_EQ(error.where(), path.string());
    }
  }
}

}  // namespace softfinger
