#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace softfinger::tests {

/// A folder of its own for one test, removed at its end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

struct ProgramRun {
  int status = -1;  ///< exit status, or -signal
  std::string out, err;
};

struct Start {
  std::filesystem::path folder;          ///< working directory; also takes the captured output
  std::vector<std::string> environment;  ///< "NAME=value"
  long largest_file_bytes = -1;          ///< like a disk that is full; -1: no limit
  std::string output_to;                 ///< instead of a captured standard output
  std::string input = "";                ///< file for standard input; empty: none
};

/// Starts the program under test; the fake finite elements are set unless the environment says
/// otherwise.
pid_t start_softfinger(const Start& start, const std::vector<std::string>& arguments);
ProgramRun wait_for(const Start& start, pid_t process);
ProgramRun run_softfinger(const Start& start, const std::vector<std::string>& arguments);

std::string file_text(const std::filesystem::path& path);

/// Lines of a text that are not empty.
std::vector<std::string> lines(const std::string& text);

/// A valid case.
std::string case_text(const std::string& id = "example", const std::string& load = "5.0");

}  // namespace softfinger::tests
