# cmake -DINPUTS=name=file,... -DLICENCES=folder -DOUTPUT=file.cc -P embed.cmake
# Writes text files into a C++ source as raw string literals: portable, and quick to compile.
set(source "#include \"embedded.h\"\n\nnamespace softfinger::comparisons::embedded {\n")
string(REPLACE "," ";" inputs "${INPUTS}")

function(append_text name content)
  string(FIND "${content}" ")~embedded~\"" clash)
  if(NOT clash EQUAL -1)
    message(FATAL_ERROR "${name} contains the delimiter of the raw string")
  endif()
  set(source "${source}const std::string_view ${name} = R\"~embedded~(${content})~embedded~\";\n"
      PARENT_SCOPE)
endfunction()

foreach(input IN LISTS inputs)
  string(REGEX MATCH "^([^=]+)=(.*)$" matched "${input}")
  set(name ${CMAKE_MATCH_1})
  file(READ "${CMAKE_MATCH_2}" content)
  append_text(${name} "${content}")
endforeach()

# The minified files bundle many small packages. Packages under the same words share one copy.
file(GLOB files "${LICENCES}/*/LICENSE*" "${LICENCES}/@*/*/LICENSE*")
list(SORT files)
set(hashes "")
foreach(file IN LISTS files)
  file(RELATIVE_PATH package "${LICENCES}" "${file}")
  get_filename_component(package "${package}" DIRECTORY)
  # d3's command-line tools use the first four, the build esbuild: they are in no page. three.js is in
  # one page only, and its licence with it.
  if(package MATCHES "^(commander|iconv-lite|rw|safer-buffer|three|@?esbuild.*)$")
    continue()
  endif()
  file(SHA256 "${file}" hash)
  list(FIND hashes ${hash} known)
  if(known EQUAL -1)
    list(APPEND hashes ${hash})
    set(packages_${hash} "${package}")
    set(file_${hash} "${file}")
  else()
    string(APPEND packages_${hash} ", ${package}")
  endif()
endforeach()
set(licences "")
foreach(hash IN LISTS hashes)
  file(READ "${file_${hash}}" content)
  string(APPEND licences "${packages_${hash}}\n\n${content}\n\n")
endforeach()
append_text(licences "${licences}")

file(WRITE "${OUTPUT}" "${source}\n}  // namespace softfinger::comparisons::embedded\n")
