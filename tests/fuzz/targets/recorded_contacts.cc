// Recorded contact problems, read and, where they are small, solved.

#include "comparisons/input/recorded_contacts.h"

#include <exception>

#include "softfinger/dynamics/step/contact_lcp_solver.h"
#include "softfinger/input/errors.h"
#include "tests/fuzz/target.h"

namespace softfinger::fuzz {
namespace {

bool read(std::string_view bytes) {
  try {
    const ContactLcp problem = input::parse_recorded_contacts(std::string(bytes), "fuzzed.txt");
    if (problem.contacts() > 4 || problem.vertices.cols() > 16) return true;
    ContactLcpSolver solver(problem.contacts(), int(problem.vertices.cols()));
    ContactSolution solution;
    const LcpResult result = solver.solve(problem, solution);
    const bool solved = result.status == LcpStatus::solved;
    if (solved && !(solution.impulse.allFinite() && solution.velocity.allFinite()))
      std::terminate();
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// Boxes that push against each other and the world: sizes and counts fit each other, the numbers
/// are any.
std::string random(std::mt19937& generator) {
  const auto below = [&](int end) { return int(generator() % unsigned(end)); };
  const auto number = [&] {
    constexpr const char* kNumbers[] = {"0", "1", "-1", "0.5", "-0.25", "1e-9", "1e9", "1e150"};
    return std::string(kNumbers[below(below(4) == 0 ? 8 : 5)]);
  };
  const auto numbers = [&](const char* key, int count, bool negative) {
    std::string line = std::string(key) + " " + std::to_string(count);
    for (int i = 0; i < count; ++i) {
      const std::string value = number();
      line += " " + (negative || value[0] != '-' ? value : value.substr(1));
    }
    return line + "\n";
  };
  const int contacts = 1 + below(3), vertices = below(9), bodies = 1 + below(3);
  const auto line = [](const char* key, int value) {
    return std::string(key) + " " + std::to_string(value) + "\n";
  };
  std::string text = "softlcp 1\n" + line("nc", contacts) + line("u", vertices) +
                     line("nb", bodies) + numbers("mu", contacts, false) +
                     numbers("en", contacts, false) + numbers("V", 3 * vertices, true) +
                     numbers("minv", 6 * bodies, false);
  const int entries = 1 + below(12 * contacts);
  text += line("J", entries + contacts);
  for (int i = 0; i < contacts + entries; ++i) {
    // Each contact's normal moves some body.
    const int row = i < contacts ? 4 * i : below(4 * contacts);
    text += std::to_string(row) + " " + std::to_string(below(6 * bodies)) + " " +
            (i < contacts ? "1" : number()) + "\n";
  }
  return text + numbers("q4", 4 * contacts, true);
}

std::vector<std::string> seeds() {
  // A box on a plane: one contact below its centre, that it falls on.
  return {
      "softlcp 1\nnote a box\nnc 1\nu 4\nnb 1\nmu 1 0.5\nen 1 0.01\nV 12 1 0 0 0 1 0 -1 0 0 0 "
      "-1 0\nminv 6 1 1 1 100 100 100\nJ 4\n0 2 1\n1 0 1\n2 1 1\n3 5 1\nq4 4 -0.1 0.2 0 3\n"};
}

}  // namespace

const Target recorded_contacts = {"recorded_contacts", read, seeds, random, true};

}  // namespace softfinger::fuzz
