# Runs the C++ sample and compares what it prints with the text below it in README.md:
# `cmake -D README=.. -D PROGRAM=.. -P check_output.cmake`.
file(READ "${README}" text)
if(NOT text MATCHES "```cpp\n[^`]*```\n[^`]*```text\n([^`]*)```")
  message(FATAL_ERROR "${README}: no text that says what the C++ sample prints")
endif()
set(said "${CMAKE_MATCH_1}")
execute_process(COMMAND "${PROGRAM}" OUTPUT_VARIABLE printed RESULT_VARIABLE status)
if(NOT status EQUAL 0 OR NOT printed STREQUAL said)
  message(FATAL_ERROR "The sample of ${README} ends with ${status} and prints\n${printed}not\n${said}")
endif()
