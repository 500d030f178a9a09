# Fails when a source file is not as clang-format writes it with the checkout's .clang-format. Run by ctest:
#   cmake -D SOURCE_DIRECTORY=<checkout> -D CLANG_FORMAT=<program> -P formatting.cmake
# `clang-format -i FILE` mends a file.
cmake_minimum_required(VERSION 3.22)

if(NOT CLANG_FORMAT)
  message(STATUS "skipped: clang-format is not installed (Debian: clang-format)")
  return()
endif()
# Versions differ in how they break lines. The project's is the one of Debian 12.
set(expected_version 14)
execute_process(COMMAND ${CLANG_FORMAT} --version OUTPUT_VARIABLE version)
if(NOT version MATCHES "version ${expected_version}[.]")
  string(STRIP "${version}" version)
  message(STATUS "skipped: formatted by clang-format ${expected_version}, but this is '${version}'")
  return()
endif()

set(patterns "")
foreach(folder analytic meshes fem comparisons tests)
  list(APPEND patterns ${SOURCE_DIRECTORY}/${folder}/*.h ${SOURCE_DIRECTORY}/${folder}/*.cc)
endforeach()
file(GLOB_RECURSE files ${patterns})
list(LENGTH files count)
if(count EQUAL 0)
  message(FATAL_ERROR "no source found under ${SOURCE_DIRECTORY}")
endif()
execute_process(COMMAND ${CLANG_FORMAT} --dry-run -Werror ${files}
                RESULT_VARIABLE status ERROR_VARIABLE complaints)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "mend with `clang-format -i`:\n${complaints}")
endif()
message(STATUS "${count} files are formatted")
