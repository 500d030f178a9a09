# Installs the analytic part of a finished build into an empty prefix and builds, links and runs a
# project outside the tree against it, which knows nothing but find_package(softfinger).
cmake_minimum_required(VERSION 3.22)

set(prefix ${SCRATCH_DIRECTORY}/prefix)
set(consumer_build ${SCRATCH_DIRECTORY}/consumer)
file(REMOVE_RECURSE ${SCRATCH_DIRECTORY})

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(status)
    message(FATAL_ERROR "${what} failed (${status}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run("installing" ${CMAKE_COMMAND} --install ${BUILD_DIRECTORY} --component analytic
    --prefix ${prefix})

# Nothing but headers, one library, the package files and the licence.
file(GLOB_RECURSE installed RELATIVE ${prefix} ${prefix}/*)
foreach(file IN LISTS installed)
  if(NOT file MATCHES "^include/softfinger/.*[.]h$|/libsoftfinger_(analytic|dynamics)[.]a$|/cmake/softfinger/|/libsoftfinger-dev/copyright$")
    message(FATAL_ERROR "unexpected file in the installation: ${file}")
  endif()
  # A package that names the build's own folders works on this machine only.
  if(file MATCHES "[.](h|cmake)$")
    file(READ ${prefix}/${file} text)
    string(FIND "${text}" "${BUILD_DIRECTORY}" position)
    if(NOT position EQUAL -1)
      message(FATAL_ERROR "${file} names the build folder")
    endif()
  endif()
endforeach()

run("configuring the consumer" ${CMAKE_COMMAND} -S ${CONSUMER_SOURCE} -B ${consumer_build}
    -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${CXX_COMPILER} -D CMAKE_BUILD_TYPE=${BUILD_TYPE}
    -D CMAKE_PREFIX_PATH=${prefix} -D Eigen3_DIR=${EIGEN3_DIRECTORY})
run("building the consumer" ${CMAKE_COMMAND} --build ${consumer_build})
run("running the consumer" ${consumer_build}/consumer)
message(STATUS "the consumer says: ${output}")

if(LDD)
  run("ldd" ${LDD} ${consumer_build}/consumer)
  if(output MATCHES "deal_II|deal[.]II|gmsh|cholmod|blas|not found")
    message(FATAL_ERROR "the analytic part drags in more than Eigen:\n${output}")
  endif()
endif()
