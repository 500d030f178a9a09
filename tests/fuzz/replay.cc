// Reads what the fuzzers once found, and the seeds that they start from:
//   fuzz_replay FINDINGS             each file of FINDINGS/<target>/, and each target's seeds
//   fuzz_replay --write-seeds FOLDER the seeds, as FOLDER/<target>/<number>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/fuzz/target.h"

namespace {

namespace fs = std::filesystem;
namespace fuzz = softfinger::fuzz;

// Sanitizers and debugging cost a factor of ten to fifty.
#ifdef NDEBUG
constexpr double kLongest_s = 1;
#else
constexpr double kLongest_s = 30;
#endif

/// @returns the number of findings
int replay(const fuzz::Target& target, const std::string& name, const std::string& bytes,
           bool must_be_accepted) {
  // Should the program die, this is what it died of.
  std::printf("%s/%s\n", target.name, name.c_str());
  std::fflush(stdout);
  const auto start = std::chrono::steady_clock::now();
  int findings = 0;
  try {
    if (!target.read(bytes) && must_be_accepted) {
      std::printf("  a seed that is refused leads a fuzzer nowhere\n");
      ++findings;
    }
  } catch (const std::exception& error) {
    std::printf("  neither accepted nor refused in words: %s\n", error.what());
    ++findings;
  }
  const double elapsed_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (elapsed_s > kLongest_s) {
    std::printf("  took %.3g s, allowed: %.3g s\n", elapsed_s, kLongest_s);
    ++findings;
  }
  return findings;
}

int replay_all(const fs::path& findings_folder) {
  int findings = 0, inputs = 0;
  for (const fuzz::Target& target : fuzz::all_targets()) {
    int number = 0;
    for (const std::string& seed : target.seeds()) {
      findings += replay(target, "seed " + std::to_string(number++), seed, true);
      ++inputs;
    }
    const fs::path folder = findings_folder / target.name;
    if (!fs::is_directory(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(file),
                              std::istreambuf_iterator<char>()};
      findings += replay(target, entry.path().filename().string(), bytes, false);
      ++inputs;
    }
  }
  std::printf("%d inputs, %d findings\n", inputs, findings);
  return findings == 0 ? 0 : 1;
}

int write_seeds(const fs::path& folder) {
  for (const fuzz::Target& target : fuzz::all_targets()) {
    fs::create_directories(folder / target.name);
    int number = 0;
    for (const std::string& seed : target.seeds())
      std::ofstream(folder / target.name / std::to_string(number++), std::ios::binary) << seed;
  }
  return 0;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count == 3 && std::string(arguments[1]) == "--write-seeds")
    return write_seeds(arguments[2]);
  if (argument_count == 2) return replay_all(arguments[1]);
  std::fprintf(stderr, "usage: fuzz_replay FINDINGS | --write-seeds FOLDER\n");
  return 2;
}
