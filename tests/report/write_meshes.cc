// write_meshes FOLDER: renders the page of an ellipsoid for the browser test, as the page itself
// and in frames in which mesh_reader.js uses it.
#include <iostream>
#include <string>

#include "comparisons/report/mesh_page.h"
#include "framed_page.h"
#include "sample_mesh.h"

int main(int argc, char** argv) try {
  using namespace softfinger::tests;
  if (argc != 2) {
    std::cerr << "usage: write_meshes FOLDER\n";
    return 2;
  }
  write_framed(argv[1], "ellipsoid",
               softfinger::report::mesh_page(sample_surface(), sample_mesh_page()),
               "mesh_reader.js");
  return 0;
} catch (const std::exception& error) {
  std::cerr << "write_meshes: " << error.what() << '\n';
  return 1;
}
