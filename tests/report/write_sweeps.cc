// write_sweeps FOLDER: renders sample sweeps for the browser test, each in frames in which
// sweep_reader.js uses it.
#include <iostream>
#include <string>
#include <utility>

#include "comparisons/report/sweep_page.h"
#include "framed_page.h"
#include "sample_sweep.h"

int main(int argc, char** argv) try {
  using namespace softfinger::tests;
  if (argc != 2) {
    std::cerr << "usage: write_sweeps FOLDER\n";
    return 2;
  }
  const std::string folder = argv[1];
  for (const auto& [name, sweep] :
       {std::pair{"one_key", sweep_of_one_key()}, std::pair{"with_fem", sweep_with_fem()},
        std::pair{"one_key_fem", sweep_of_one_key_with_fem()},
        std::pair{"three_keys", sweep_of_three_keys()}, std::pair{"zipped", sweep_of_zipped_keys()},
        std::pair{"awkward", sweep_of_awkward_keys()}, std::pair{"random", sweep_at_random()},
        std::pair{"one_row", sweep_of_one_row()}, std::pair{"nothing", sweep_without_answers()}})
    write_framed(folder, name, softfinger::report::render_sweep(sweep), "sweep_reader.js");
  return 0;
} catch (const std::exception& error) {
  std::cerr << "write_sweeps: " << error.what() << '\n';
  return 1;
}
