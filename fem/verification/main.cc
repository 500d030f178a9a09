// softfinger-fem-verify: every check of the finite elements against what is known, as a table.
//   softfinger-fem-verify [--quick] [--write FILE] [GROUP...]
// GROUP: element, Hertz, layer, friction, invariance; default: all of them, in this order.
// Exit status: 0 when all checks pass, 1 otherwise, 2 for wrong arguments.
#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iostream>
#include <iterator>
#include <set>
#include <sstream>

#include "fem/base/write_file.h"
#include "fem/verification/groups.h"
#include "softfinger/input/errors.h"

namespace {

namespace fem = softfinger::fem;
using fem::verification::Checks;

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  char text[16];
  std::strftime(text, sizeof text, "%Y-%m-%d", std::gmtime(&now));
  return text;
}

/// Puts `table` between the two marks of a file.
void write_between_marks(const std::string& path, const std::string& table) {
  const std::string begin = "<!-- verification begins -->", end = "<!-- verification ends -->";
  std::ifstream file(path);
  std::string content(std::istreambuf_iterator<char>(file), {});
  const auto from = content.find(begin), to = content.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from)
    throw softfinger::InputError(path, "marks", "",
                                 "a file with the lines " + begin + " and " + end);
  content.replace(from + begin.size(), to - from - begin.size(), "\n" + table);
  fem::write_file(path, "verification table", [&](std::ostream& out) { out << content; });
}

struct Group {
  std::string name;
  Checks (*check)(bool quick);
};
/// Equilibrium is checked on all contacts before it: it comes last.
const Group groups[] = {{"element", fem::verification::check_element},
                        {"Hertz", fem::verification::check_hertz},
                        {"layer", fem::verification::check_layer},
                        {"friction", fem::verification::check_friction},
                        {"invariance", fem::verification::check_invariance}};

/// A group that ends with an error is a check that fails, and not the end of the others.
Checks run(const Group& group, bool quick) {
  const double start_s = cpu_s();
  Checks checks;
  try {
    checks = group.check(quick);
  } catch (const std::exception& error) {
    fem::verification::Check failed{group.name, "ran to its end", error.what(), 1, 0};
    checks.push_back(failed);
  }
  std::cerr << group.name << ": " << checks.size() << " checks, "
            << fem::verification::count_failures(checks) << " failed, " << cpu_s() - start_s
            << " CPU s" << std::endl;
  return checks;
}

}  // namespace

int main(int argument_count, char** arguments) {
  // As in softfinger-fem.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  bool quick = false;
  std::string path;
  std::set<std::string> chosen;
  for (int i = 1; i < argument_count; ++i) {
    const std::string argument = arguments[i];
    if (argument == "--quick") {
      quick = true;
    } else if (argument == "--write" && i + 1 < argument_count) {
      path = arguments[++i];
    } else if (std::any_of(std::begin(groups), std::end(groups),
                           [&](const Group& group) { return group.name == argument; })) {
      chosen.insert(argument);
    } else {
      std::cerr << "usage: softfinger-fem-verify [--quick] [--write FILE] [GROUP...], groups: "
                   "element, Hertz, layer, friction, invariance\n";
      return 2;
    }
  }
  Checks checks;
  const auto add = [&](const Checks& more) {
    checks.insert(checks.end(), more.begin(), more.end());
  };
  for (const Group& group : groups)
    if (chosen.empty() || chosen.count(group.name) > 0) add(run(group, quick));
  const Checks summary = fem::verification::check_stated_errors(checks);
  add(summary);

  using namespace fem::verification;
  const int failures = count_failures(checks);
  std::ostringstream report;
  print_table(checks, report);
  report << '\n';
  for (const Check& line : summary)
    report << "- " << line.quantity << ", " << line.name << ": " << line.measured << " (has to be "
           << (line.relation == Relation::at_least ? "at least " : "at most ") << line.expected
           << ")\n";
  report << "- " << checks.size() - static_cast<std::size_t>(failures) << " of " << checks.size()
         << " checks pass; " << today() << ", softfinger " SOFTFINGER_VERSION ", "
         << static_cast<long>(cpu_s() + 0.5) << " CPU s\n";
  std::cout << report.str() << std::flush;
  try {
    if (!path.empty()) write_between_marks(path, report.str());
  } catch (const softfinger::InputError& error) {
    std::cerr << "softfinger-fem-verify: error: " << error.what() << std::endl;
    return 2;
  }
  return failures == 0 ? 0 : 1;
}
