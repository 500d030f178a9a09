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
  softfinger::report::PadStart start;
  start.case_name = "pad.toml";
  start.pair.finger.figure = softfinger::input::RectangleFigure{22e-3, 37.5e-3, 1e-3};
  start.layer = {3e-3, 800e3, 0.49};
  start.load = {20, 0.9};
  write_framed(argv[1], "pads",
               softfinger::report::explorer_page("softfinger 0.0.0", "softfinger explore", start),
               "explorer_pads_reader.js");
  return 0;
} catch (const std::exception& error) {
  std::cerr << "write_explorer: " << error.what() << '\n';
  return 1;
}
