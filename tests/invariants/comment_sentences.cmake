# Fails when a comment begins as a fragment ("Of the body.", "What is kept.", "The same in m."), which leaves
# its reader to guess the subject. Only the first line of a comment is checked. Run by ctest:
#   cmake -D SOURCE_DIRECTORY=<checkout> -P comment_sentences.cmake
# With -D SELF_TEST=ON -D SCRATCH_DIRECTORY=<dir> it checks itself on comments that break the rule.
cmake_minimum_required(VERSION 3.22)

set(openings "(Of|What|Where|The same|Its|How|By how|With derivatives)")
set(word_end "([^A-Za-z0-9_\n][^\n]*)?")
# A line that is no comment and, right below it, one that begins with a fragment (breaks are doubled).
set(block "\n[ \t]*([^/ \t\n][^\n]*|/[^/\n][^\n]*|/)?\n\n[ \t]*//[/!]?[ \t]*${openings}${word_end}\n")
# Code with such a comment behind it.
set(trailing "\n[ \t]*[^/ \t\n][^\n]*///?<[ \t]*${openings}${word_end}\n")

# One line for each fragment under `root`, as a list in `out`; the number of files read in `out_files`.
function(find_fragments root out out_files)
  set(found "")
  set(patterns "")
  foreach(top analytic meshes fem dynamics comparisons tests)
    list(APPEND patterns ${root}/${top}/*.h ${root}/${top}/*.cc)
  endforeach()
  file(GLOB_RECURSE files RELATIVE ${root} ${patterns})
  foreach(file IN LISTS files)
    # Most files have no such words at the beginning of any line of a comment.
    file(STRINGS ${root}/${file} candidates REGEX "//[/!]?<?[ \t]*${openings}([^A-Za-z0-9_]|$)")
    if(candidates STREQUAL "")
      continue()
    endif()
    file(READ ${root}/${file} text)
    # Semicolons and brackets would divide or join the elements of CMake's lists. Each line break is
    # doubled, because a match takes the one at either end.
    string(REGEX REPLACE "[][;\\\r]" " " text "\n\n${text}\n")
    string(REPLACE "\n" "\n\n" text "${text}")
    string(REGEX MATCHALL "${trailing}" matches "${text}")
    string(REGEX MATCHALL "${block}" blocks "${text}")
    foreach(match IN LISTS matches blocks)
      string(REGEX REPLACE "\n$" "" match "${match}")
      string(REGEX REPLACE ".*\n" "" match "${match}")
      string(STRIP "${match}" line)
      list(APPEND found "${file}: ${line}")
    endforeach()
  endforeach()
  list(LENGTH files count)
  set(${out} "${found}" PARENT_SCOPE)
  set(${out_files} ${count} PARENT_SCOPE)
endfunction()

if(SELF_TEST)
  file(REMOVE_RECURSE ${SCRATCH_DIRECTORY})
  file(WRITE ${SCRATCH_DIRECTORY}/fem/first_line.cc "// What a file begins with.\nint a = 0;\n")
  file(WRITE ${SCRATCH_DIRECTORY}/comparisons/commands/blocks.h
       "namespace a {\n/// Of the body [m]; in its own frame.\ndouble a;\n\n/// The same in mm.\ndouble b;\n"
       "  // Where it is known.\n  int c = 1 / 2;\n//How far.\nvoid f();\n/// With derivatives.\nvoid g();\n")
  file(WRITE ${SCRATCH_DIRECTORY}/tests/trailing.cc
       "int a = 0;  ///< What is kept.\nint b = 0;  ///< Its\nint c = b[0];  ///< By how much.\n")
  set(expected 9)
  file(WRITE ${SCRATCH_DIRECTORY}/analytic/sentences.h
       "/// The sameness of both.\nint a;\n/// Number of bodies.\n/// What is missing is 0.\nint b;  ///< of a\n"
       "int c;  ///< length in m\n        ///< Where it ends, a is 0.\n/// Offset.\n// Its unit is m.\nint d;\n")
  find_fragments(${SCRATCH_DIRECTORY} found files)
  list(LENGTH found count)
  if(NOT count EQUAL expected)
    list(JOIN found "\n  " text)
    message(FATAL_ERROR "found ${count} of ${expected} fragments:\n  ${text}")
  endif()
  return()
endif()

find_fragments(${SOURCE_DIRECTORY} found files)
if(found)
  list(JOIN found "\n  " text)
  message(FATAL_ERROR "comments that begin as fragments. Name the thing (\"Contact radius in m.\", \"Largest "
                      "slip of a contact.\") or begin with the verb (\"Returns ...\", \"Solves ...\"):\n  ${text}")
endif()
if(files EQUAL 0)
  message(FATAL_ERROR "no source found under ${SOURCE_DIRECTORY}")
endif()
message(STATUS "${files} files, no comment begins as a fragment")
