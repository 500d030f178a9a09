# Fails when a file of the programs opens a file for writing by itself. All go through
# meshes/io/output_file.h, which replaces files as a whole, follows links and refuses inputs. Run by ctest:
#   cmake -D SOURCE_DIRECTORY=<checkout> -P one_writer.cmake
# With -D SELF_TEST=ON -D SCRATCH_DIRECTORY=<dir> it checks itself on files that break the rule.
cmake_minimum_required(VERSION 3.22)

# The writer itself, and the lock and the growing rows in a folder of results.
set(writers meshes/io/output_file.cc comparisons/system/files.cc)
set(ways "ofstream|[^a-z]fstream[ (]|fopen|freopen|fdopen|O_CREAT|O_TRUNC|[^a-z_]creat *[(]|mkstemp|mkostemp|[^a-z_]rename *[(]|copy_file|create_symlink|write_to_file|png_init_io|gzopen|mj_saveLastXML|mj_saveModel")

# One line for each place under `root`, as a list in `out`; the number of files read in `out_files`.
function(find_other_writers root out out_files)
  set(found "")
  set(patterns "")
  foreach(top analytic/softfinger analytic/python meshes fem comparisons)
    list(APPEND patterns ${root}/${top}/*.h ${root}/${top}/*.cc)
  endforeach()
  file(GLOB_RECURSE files RELATIVE ${root} ${patterns})
  foreach(file IN LISTS files)
    if(file IN_LIST writers)
      continue()
    endif()
    file(STRINGS ${root}/${file} lines REGEX "${ways}")
    foreach(line IN LISTS lines)
      if(NOT line MATCHES "^[ \t]*//")
        string(STRIP "${line}" line)
        list(APPEND found "${file}: ${line}")
      endif()
    endforeach()
  endforeach()
  list(LENGTH files count)
  set(${out} "${found}" PARENT_SCOPE)
  set(${out_files} ${count} PARENT_SCOPE)
endfunction()

if(SELF_TEST)
  file(REMOVE_RECURSE ${SCRATCH_DIRECTORY})
  set(expected 0)
  foreach(line "std::ofstream out(path)$<SEMICOLON>" "FILE* f = fopen(name, mode)$<SEMICOLON>"
               "int f = open(name, O_WRONLY | O_CREAT)$<SEMICOLON>" "std::rename(a, b)$<SEMICOLON>")
    string(REPLACE "$<SEMICOLON>" "" line "${line}")
    file(WRITE ${SCRATCH_DIRECTORY}/comparisons/commands/f${expected}.cc "${line}\n")
    math(EXPR expected "${expected} + 1")
  endforeach()
  file(WRITE ${SCRATCH_DIRECTORY}/meshes/io/output_file.cc "int f = open(name, O_CREAT)\n")
  file(WRITE ${SCRATCH_DIRECTORY}/fem/reader.cc
       "// no ofstream here\nstd::ifstream in(path)\nfile.rename_to(name)\n")
  find_other_writers(${SCRATCH_DIRECTORY} found files)
  list(LENGTH found count)
  if(NOT count EQUAL expected)
    message(FATAL_ERROR "found ${count} of ${expected} other writers: ${found}")
  endif()
  return()
endif()

find_other_writers(${SOURCE_DIRECTORY} found files)
if(found)
  list(JOIN found "\n  " text)
  message(FATAL_ERROR "files are written only by meshes/io/output_file.h (system::write_file_atomically, "
                      "meshes::write_whole_file), but also by:\n  ${text}")
endif()
if(files EQUAL 0)
  message(FATAL_ERROR "no source found under ${SOURCE_DIRECTORY}")
endif()
message(STATUS "${files} files, one writer")
