// A target needs a source of its own before CMake compiles headers for it: tests/CMakeLists.txt.
