// write_motions FOLDER: renders the sample motions for the browser test, each as the page itself
// and in frames in which motion_reader.js uses it.
#include <iostream>
#include <string>
#include <utility>

#include "comparisons/report/motion_page.h"
#include "framed_page.h"
#include "sample_motion.h"

int main(int argc, char** argv) try {
  using namespace softfinger::tests;
  if (argc != 2) {
    std::cerr << "usage: write_motions FOLDER\n";
    return 2;
  }
  const std::string folder = argv[1];
  softfinger::report::MotionPageOptions options;
  options.scene_text = "question = \"...\"\n\n[[body]]\nname = \"box\"\nshape = \"box\"\n";
  options.version = "0.0.0";
  options.command = "softfinger simulate box_in_pinch.toml --output motion";
  for (const auto& [name, recording] :
       {std::pair{"pinch", sample_motion()}, std::pair{"large", large_motion()},
        std::pair{"far", far_motion()}, std::pair{"without_contacts", motion_without_contacts()},
        std::pair{"one_frame", motion_of_one_frame()}, std::pair{"empty", empty_motion()}})
    write_framed(folder, name, softfinger::report::motion_page(recording, options),
                 "motion_reader.js");
  return 0;
} catch (const std::exception& error) {
  std::cerr << "write_motions: " << error.what() << '\n';
  return 1;
}
