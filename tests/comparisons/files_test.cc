#include "comparisons/system/files.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

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

TEST_F(Files, KeepTheirModeWhenTheyAreReplaced) {
  system::write_file_atomically(folder / "a", "old");
  ASSERT_EQ(chmod((folder / "a").c_str(), 0600), 0);
  system::write_file_atomically(folder / "a", "new");
  struct stat status {};
  ASSERT_EQ(stat((folder / "a").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0600u);
}

TEST_F(Files, AreNotReplacedWhereTheyAreReadOnlyOrHaveSeveralNames) {
  system::write_file_atomically(folder / "a", "old");
  ASSERT_EQ(chmod((folder / "a").c_str(), 0444), 0);  // root could write to it all the same
  EXPECT_THROW(system::write_file_atomically(folder / "a", "new"), InputError);
  ASSERT_EQ(chmod((folder / "a").c_str(), 0644), 0);
  fs::create_hard_link(folder / "a", folder / "b");
  EXPECT_THROW(system::write_file_atomically(folder / "b", "new"), InputError);
  EXPECT_EQ(system::read_text_file(folder / "a"), "old");
  EXPECT_EQ(fs::hard_link_count(folder / "a"), 2u);
}

TEST_F(Files, OfDevicesAndPipesAreWrittenTo) {
  system::write_file_atomically("/dev/null", "lost");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THROW(system::write_file_atomically("/dev/full", "lost"), InputError);
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  fs::create_symlink(pipe, folder / "link");
  system::write_files_together({{folder / "link", "through"}, {folder / "file", "x"}});
  char text[8] = "";
  EXPECT_EQ(read(reader, text, 7), 7);
  EXPECT_STREQ(text, "through");
  EXPECT_TRUE(fs::is_fifo(pipe));
  close(reader);
}

TEST_F(Files, ThatWereReadAreNoOutputs) {
  system::write_file_atomically(folder / "a", "precious");
  system::read_text_file(folder / "a");
  fs::create_symlink("a", folder / "link");
  for (const char* name : {"a", "link"})
    EXPECT_THROW(system::write_file_atomically(folder / name, "new"), InputError) << name;
  EXPECT_EQ(system::read_text_file(folder / "a"), "precious");
  system::write_file_atomically(folder / "own", "1");
  system::read_file_to_rewrite(folder / "own");
  system::write_file_atomically(folder / "own", "2");
}

TEST_F(Files, ThatWillBeWrittenAreNotRead) {
  system::write_file_atomically(folder / "a", "precious");
  fs::create_symlink("a", folder / "link");
  system::announce_output("--page", folder / "link");
  EXPECT_THROW(system::announce_output("--output", folder / "a"), InputError);
  try {
    system::read_text_file(folder / "a");
    FAIL() << "an output was read";
  } catch (const InputError& error) {
    EXPECT_EQ(error.field(), "--page");
  }
}

TEST_F(Files, ThatAKilledProcessLeftAreRemovedAndNoOthers) {
  const fs::path abandoned = folder / ".a.json.0123456789abcdef.softfinger.tmp";
  const fs::path in_use = folder / ".b.json.0123456789abcdef.softfinger.tmp";
  const fs::path of_others = folder / ".a.json.0123456789abcdef.tmp";
  for (const fs::path& path : {abandoned, in_use, of_others}) std::ofstream(path) << "half";
  const int lock = open(in_use.c_str(), O_RDONLY);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  system::write_file_atomically(folder / "c", "whole");
  EXPECT_FALSE(fs::exists(abandoned));
  EXPECT_TRUE(fs::exists(in_use));
  EXPECT_TRUE(fs::exists(of_others));
  close(lock);
}

TEST_F(Files, KeepTheOldContentOnAFullDisk) {
  system::write_file_atomically(folder / "a", "old");
  const auto former = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before = {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 1000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(system::write_file_atomically(folder / "a", std::string(5000, 'x')), InputError);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, former);
  EXPECT_EQ(system::read_text_file(folder / "a"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

TEST_F(Files, WithTheLongestNameAreWritten) {
  const fs::path path = folder / std::string(255, 'n');
  system::write_file_atomically(path, "x");
  EXPECT_EQ(system::read_text_file(path), "x");
}

}  // namespace softfinger
