# The version stands in one place, project(VERSION) of the top-level CMakeLists.txt; the program and the
# installed package take it from there. Three files repeat it because no program writes them. This
# fails when one of them differs. Run by ctest:
#   cmake -D SOURCE_DIRECTORY=<checkout> -D PROJECT_VERSION=<x.y.z> -P version.cmake
cmake_minimum_required(VERSION 3.22)

# The first match of `pattern` in `file`, which has the version as its only group, is `expected`.
function(expect_version file pattern expected)
  file(READ ${SOURCE_DIRECTORY}/${file} text)
  if(NOT text MATCHES "${pattern}")
    message(FATAL_ERROR "${file} states no version")
  endif()
  if(NOT CMAKE_MATCH_1 STREQUAL expected)
    message(FATAL_ERROR "${file} says ${CMAKE_MATCH_1}, project(VERSION) ${expected}")
  endif()
endfunction()

string(REGEX MATCH "^[0-9]+[.][0-9]+" minor_version "${PROJECT_VERSION}")
expect_version(CITATION.cff "\nversion: ([^\n]*)" ${PROJECT_VERSION})
# The newest version is the first heading.
expect_version(.github/CHANGELOG.md "\n## ([^ \n]*)" ${PROJECT_VERSION})
expect_version(tests/packaging/consumer/CMakeLists.txt "find_package[(]softfinger ([^ )]*)"
               ${minor_version})
