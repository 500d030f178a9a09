// Writes the surfaces of the built-in mesh cases as STL files (millimetres) into a folder.

#include <cstdio>
#include <exception>
#include <filesystem>

#include "meshes/generation/surfaces.h"
#include "meshes/io/read_surface.h"

int main(int argc, char** argv) {
  using namespace softfinger::meshes;
  if (argc != 2) {
    std::fprintf(stderr, "usage: softfinger-surfaces FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    const FingertipPad pad;
    FingertipPad coarse = pad;
    coarse.edge_length_m = 2e-3;  // about 300 vertices: as coarse as robots' simulation meshes are
    write_stl_mm(fingertip_pad(pad), folder / "shadow_like_pad.stl");
    write_stl_mm(fingertip_pad(coarse), folder / "shadow_like_pad_coarse.stl");
    write_stl_mm(glass(25e-3, 35e-3, 100e-3, 2e-3), folder / "glass.stl");
    write_stl_mm(glass(30e-3, 30e-3, 100e-3, 2e-3), folder / "tumbler.stl");
    write_stl_mm(rounded_box(30e-3, 5e-3, 0.75e-3), folder / "rounded_box.stl");
    write_stl_mm(cylinder(15e-3, 60e-3, 0.75e-3), folder / "cylinder.stl");
    write_stl_mm(sphere(20e-3, 0.75e-3), folder / "sphere.stl");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "softfinger-surfaces: %s\n", error.what());
    return 2;
  }
  return 0;
}
