# Writes the C++ sample of README.md as a program: `cmake -D README=.. -D SOURCE=.. -P sample.cmake`.
file(READ "${README}" text)
string(REPLACE ";" "\;" text "${text}")
if(NOT text MATCHES "```cpp\n([^`]*)```")
  message(FATAL_ERROR "${README}: no C++ sample")
endif()
set(sample "${CMAKE_MATCH_1}")
# Includes first, all else within main.
string(REGEX MATCHALL "#include [^\n]*\n" includes "${sample}")
string(REGEX REPLACE "#include [^\n]*\n" "" body "${sample}")
list(JOIN includes "" includes)
string(REPLACE "\;" ";" body "${body}")
file(WRITE "${SOURCE}" "${includes}\nint main() {\n${body}}\n")
