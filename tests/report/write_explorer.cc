// write_explorer FOLDER: renders the page of `softfinger explore` for the browser test, as the page
// itself and in frames in which explorer_reader.js uses it.
#include <iostream>
#include <string>

#include "comparisons/report/explorer_page.h"
#include "framed_page.h"

int main(int argc, char** argv) try {
  using namespace softfinger::tests;
  if (argc != 2) {
    std::cerr << "usage: write_explorer FOLDER\n";
    return 2;
  }
  write_framed(argv[1], "explorer",
               softfinger::report::explorer_page("softfinger 0.0.0", "softfinger explore"),
               "explorer_reader.js");
  return 0;
} catch (const std::exception& error) {
  std::cerr << "write_explorer: " << error.what() << '\n';
  return 1;
}
