#include "tests/comparisons/run_program.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

namespace softfinger::tests {
namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "softfinger-test-XXXXXX").string();
  path_ = mkdtemp(name.data());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

fs::path TemporaryFolder::write(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
  return path_ / name;
}

std::string file_text(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) result.push_back(line);
  return result;
}

pid_t start_softfinger(const Start& start, const std::vector<std::string>& arguments) {
  const fs::path out = start.folder / ".stdout", err = start.folder / ".stderr";
  const pid_t process = fork();
  if (process != 0) return process;
  if (chdir(start.folder.c_str()) != 0) _exit(120);
  setenv("SOFTFINGER_FEM_PROGRAM", SOFTFINGER_FAKE_FEM, 1);
  for (const auto& entry : start.environment) {
    const std::size_t equals = entry.find('=');
    setenv(entry.substr(0, equals).c_str(), entry.substr(equals + 1).c_str(), 1);
  }
  const std::string target = start.output_to.empty() ? out.string() : start.output_to;
  dup2(open(start.input.empty() ? "/dev/null" : start.input.c_str(), O_RDONLY), STDIN_FILENO);
  dup2(open(target.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), STDOUT_FILENO);
  dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), STDERR_FILENO);
  if (start.largest_file_bytes >= 0) {
    rlimit limit = {};
    limit.rlim_cur = limit.rlim_max = static_cast<rlim_t>(start.largest_file_bytes);
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  std::vector<char*> words = {const_cast<char*>(SOFTFINGER_PROGRAM)};
  for (const auto& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  execv(SOFTFINGER_PROGRAM, words.data());
  _exit(121);
}

ProgramRun wait_for(const Start& start, pid_t process) {
  int status = 0;
  waitpid(process, &status, 0);
  ProgramRun run;
  run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  run.out = file_text(start.folder / ".stdout");
  run.err = file_text(start.folder / ".stderr");
  return run;
}

ProgramRun run_softfinger(const Start& start, const std::vector<std::string>& arguments) {
  return wait_for(start, start_softfinger(start, arguments));
}

std::string case_text(const std::string& id, const std::string& load) {
  return "id = \"" + id +
         "\"\nquestion = \"?\"\n[geometry]\nrelative_radii_mm = [20.0, 10.0]\n[layer]\n"
         "thickness_mm = 2.0\nyoungs_modulus_kPa = 300.0\npoisson_ratio = 0.45\n[contact]\nload_N "
         "= " +
         load + "\nfriction_coefficient = 0.8\n";
}

}  // namespace softfinger::tests
