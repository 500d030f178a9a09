# Fails when a file includes something that its folder must not know. Run by ctest:
#   cmake -D SOURCE_DIRECTORY=<checkout> -P include_directions.cmake
# With -D SELF_TEST=ON -D SCRATCH_DIRECTORY=<dir> it checks itself on a small tree with broken arrows.
#
# The arrows go one way, towards what is depended on:
#   input <- math <- friction, layer <- fft <- pressure <- calibration, pads, taxels, time;  input, math <- geometry;
#   all of these <- dynamics, and in it:  contacts <- facets <- exact <- step;  bodies <- step
#   accuracy knows the pressure models and the layer
#   input <- meshes <- fem, and in it:
#   base <- algebra <- problem <- layer <- contact <- friction <- output <- levels <- linear <- finite
#   <- pad <- program <- verification, studies
#   everything <- comparisons, and in it:
#   text <- system <- input <- prediction <- reference, simulation <- judgement <- exporting <- explorer;
#   judgement <- experiments, calibration
#   all of these <- report <- suite, sweep <- robots, commands, distributed
# The models are compared with the finite elements, which therefore never see one.
cmake_minimum_required(VERSION 3.22)

# may_include(folder pattern...): patterns of the headers that the files of a folder may include. The
# first folder that contains a file decides.
set(folders "")
macro(may_include folder)
  list(APPEND folders ${folder})
  string(REPLACE ";" "|" allowed_${folder} "${ARGN}")
endmacro()

# The standard library's headers have neither folder nor suffix; what ends in .h is named singly.
set(std "^[a-z_0-9]+$")
set(posix "^(sys/[a-z]+|unistd|fcntl|malloc|signal|time|dirent|dlfcn|poll|sched)[.]h$")
set(eigen "^Eigen/")
set(input "^softfinger/input/")

may_include(analytic/softfinger/input ${std} ${eigen} ${input})
may_include(analytic/softfinger/math ${std} ${eigen} ${input} "^softfinger/math/")
may_include(analytic/softfinger/geometry ${std} ${eigen} ${input} "^softfinger/(math|geometry)/")
may_include(analytic/softfinger/friction ${std} ${eigen} ${input} "^softfinger/(math|friction)/")
may_include(analytic/softfinger/layer ${std} ${eigen} ${input} "^softfinger/(math|layer)/")
may_include(analytic/softfinger/fft ${std} ${eigen} ${input} "^softfinger/(math|layer|fft)/")
may_include(analytic/softfinger/pressure ${std} ${eigen} ${input}
            "^softfinger/(math|friction|layer|fft|pressure)/")
may_include(analytic/softfinger/pads ${std} ${eigen} ${input}
            "^softfinger/(math|friction|layer|fft|pressure|pads)/")
may_include(analytic/softfinger/taxels ${std} ${eigen} ${input}
            "^softfinger/(math|layer|fft|pressure|taxels)/")
may_include(analytic/softfinger/time ${std} ${eigen} ${input} "^softfinger/(math|layer|pressure|time)/")
may_include(analytic/softfinger/calibration ${std} ${eigen} "^unsupported/Eigen/" ${input}
            "^softfinger/(math|friction|layer|fft|pressure|calibration)/")
may_include(analytic/softfinger/accuracy ${std} ${eigen} ${input}
            "^softfinger/(math|layer|pressure|accuracy)/")
# What lies below all rooms of the dynamics.
set(models "^softfinger/(math|geometry|friction|layer|fft|pressure|calibration|time)/")
macro(dynamics_room name)
  set(known ${ARGN})
  list(JOIN known "|" known)
  may_include(analytic/softfinger/dynamics/${name} ${std} ${eigen} ${input} ${models}
              "^softfinger/dynamics/(${known})/")
endmacro()
dynamics_room(bodies bodies)
dynamics_room(contacts contacts)
dynamics_room(facets contacts facets)
dynamics_room(exact contacts facets exact)
dynamics_room(step bodies contacts facets exact step)
# Nothing lies loose beside the rooms.
may_include(analytic/softfinger/dynamics ${std})
may_include(analytic/python ${std} ${eigen} "^softfinger/" "^pybind11/" "^analytic/python/bindings/")
may_include(analytic ${std} ${eigen} "^softfinger/")
may_include(meshes ${std} ${posix} ${eigen} ${input} "^meshes/" "^gmsh[.]h" "^nanoflann[.]hpp"
            "^unsupported/Eigen/BVH")
set(fem_rooms "")
# fem_room(NAME extra patterns...): a room of fem knows itself and those declared before it.
macro(fem_room name)
  list(APPEND fem_rooms ${name})
  list(JOIN fem_rooms "|" known)
  may_include(fem/${name} ${std} ${eigen} ${input} "^fem/(${known})/" ${ARGN})
endmacro()
set(dealii "^deal[.]II/")
# Only the program knows JSON, and the file that begins with a line of it.
may_include(fem/output/write_compliance.cc ${std} ${eigen} "^fem/(base|friction|output)/" "^nlohmann/")
fem_room(base ${posix} "^meshes/io/whole_file[.]h$" ${dealii} "^omp[.]h$")
fem_room(algebra "^(suitesparse/)?cholmod[.]h$")
fem_room(problem)
fem_room(layer ${dealii} "^meshes/(generation|scans)/")
fem_room(contact "^meshes/generation/")
fem_room(friction)
fem_room(output ${dealii})
fem_room(levels "^meshes/generation/")
fem_room(linear)
fem_room(finite ${dealii})
fem_room(pad ${dealii})
fem_room(program ${posix} "^meshes/" "^nlohmann/")
may_include(fem/verification ${std} ${posix} ${eigen} ${input} ${dealii} "^meshes/generation/"
            "^fem/(verification|${known})/")
may_include(fem/studies ${std} ${eigen} ${input} "^meshes/" "^fmt/" "^fem/(${known})/")
# Nothing lies loose in the root of fem: such a file may not know any room.
may_include(fem ${std} ${input})

set(library "^(nlohmann|fmt)/")
set(rooms "")
# room(NAME extra patterns...): a room knows itself, the rooms declared before it, and the libraries.
macro(room name)
  list(APPEND rooms ${name})
  list(JOIN rooms "|" known)
  may_include(comparisons/${name} ${std} ${posix} ${eigen} ${library} "^softfinger/"
              "^comparisons/(${known})/" ${ARGN})
endmacro()
room(text)
# The one writer of files serves the finite elements, too.
room(system "^meshes/io/(input_files|output_file)[.]h$")
room(input "^toml[+][+]/" "^png[.]h$" "^meshes/io/")
room(prediction "^meshes/")
room(reference "^meshes/io/input_files[.]h$")
room(simulation "^fcl/" "^meshes/" "^zlib[.]h$")
room(judgement)
room(exporting "^mujoco/" "^tinyxml2[.]h$")
room(explorer)
room(experiments)
room(calibration "^toml[+][+]/")
room(report "^png[.]h$")
room(suite)
room(sweep "^toml[+][+]/" "^meshes/io/input_files[.]h$")
room(robots "^mujoco/" "^sdf/" "^tinyxml2[.]h$" "^urdf_parser/" "^console_bridge/" "^assimp/" "^zlib[.]h$"
     "^meshes/io/")
room(commands "^CLI/" "^meshes/")
room(distributed "^CLI/" "^mpi[.]h$")
# An engine may include its simulator.
room(benchmark "^CLI/" "^mujoco/" "^bt[A-Za-z]+[.]h$")
may_include(comparisons/main.cc ${std} "^CLI/" "^softfinger/input/" "^comparisons/(system|text|commands)/")
# Nothing else lies loose in the root: such a file may not know any room.
may_include(comparisons ${std} "^softfinger/input/")

# One line per broken arrow under `root`, as a list in `out`; the number of files read in `out_files`.
function(find_broken_arrows root out out_files)
  set(broken "")
  set(patterns "")
  foreach(top analytic meshes fem comparisons)
    list(APPEND patterns ${root}/${top}/*.h ${root}/${top}/*.cc)
  endforeach()
  file(GLOB_RECURSE files RELATIVE ${root} ${patterns})
  foreach(file IN LISTS files)
    set(folder "")
    foreach(candidate IN LISTS folders)
      string(FIND "${file}/" "${candidate}/" position)
      if(position EQUAL 0)
        set(folder ${candidate})
        break()
      endif()
    endforeach()
    file(STRINGS ${root}/${file} lines REGEX "^[ \t]*#[ \t]*include")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^[^<\"]*[<\"]([^>\"]*)[>\"].*$" "\\1" header "${line}")
      if(NOT header MATCHES "${allowed_${folder}}")
        list(APPEND broken "${file} includes ${header}, which ${folder} must not know")
      endif()
    endforeach()
  endforeach()
  list(LENGTH files count)
  set(${out} "${broken}" PARENT_SCOPE)
  set(${out_files} ${count} PARENT_SCOPE)
endfunction()

if(SELF_TEST)
  # Each of these has one forbidden include and one allowed one.
  file(REMOVE_RECURSE ${SCRATCH_DIRECTORY})
  set(expected 0)
  foreach(pair
      "analytic/softfinger/input/a.h|softfinger/math/a.h"
      "analytic/softfinger/math/b.cc|softfinger/friction/b.h"
      "analytic/softfinger/geometry/c.cc|softfinger/pressure/c.h"
      "analytic/softfinger/friction/d.cc|softfinger/pressure/d.h"
      "analytic/softfinger/pressure/e.cc|softfinger/geometry/e.h"
      "analytic/softfinger/pressure/models/f.cc|nlohmann/json.hpp"
      "analytic/softfinger/pressure/g.cc|softfinger/pads/g.h"
      "analytic/softfinger/pressure/g.h|softfinger/time/g.h"
      "analytic/softfinger/taxels/g.cc|softfinger/pads/g.h"
      "analytic/softfinger/dynamics/facets/f.cc|softfinger/dynamics/exact/f.h"
      "analytic/softfinger/dynamics/contacts/f.h|softfinger/dynamics/facets/f.h"
      "analytic/softfinger/dynamics/bodies/f.h|softfinger/dynamics/step/f.h"
      "meshes/io/g.cc|softfinger/geometry/g.h"
      "analytic/softfinger/accuracy/g.cc|softfinger/calibration/g.h"
      "fem/levels/h.cc|softfinger/pressure/pressure_model.h"
      "fem/base/i.h|comparisons/case.h"
      "fem/levels/j.cc|nlohmann/json.hpp"
      "fem/base/j.cc|fem/algebra/cholesky.h"
      "fem/problem/j.h|fem/layer/layer_model.h"
      "fem/layer/j.cc|fem/output/write_vtu.h"
      "fem/friction/j.cc|fem/levels/error_model.h"
      "fem/linear/j.cc|fem/finite/finite_layer.h"
      "fem/finite/j.cc|fem/program/reference_solver.h"
      "fem/contact/j.cc|deal.II/grid/tria.h"
      "fem/j.cc|fem/base/threads.h"
      "comparisons/input/k.h|comparisons/prediction/k.h"
      "comparisons/judgement/atlas/l.cc|comparisons/report/l.h"
      "comparisons/report/m.cc|comparisons/commands/m.h"
      "comparisons/reference/n.cc|fem/n.h"
      "comparisons/n.cc|comparisons/input/n.h")
    string(REPLACE "|" ";" pair "${pair}")
    list(GET pair 0 file)
    list(GET pair 1 header)
    file(WRITE ${SCRATCH_DIRECTORY}/${file}
         "#include <vector>\n#include \"softfinger/input/errors.h\"\n#include \"${header}\"\n")
    math(EXPR expected "${expected} + 1")
  endforeach()
  file(WRITE ${SCRATCH_DIRECTORY}/fem/program/main.cc "#include <nlohmann/json.hpp>\n")
  find_broken_arrows(${SCRATCH_DIRECTORY} broken files)
  list(LENGTH broken found)
  if(NOT found EQUAL expected)
    message(FATAL_ERROR "found ${found} of ${expected} broken arrows: ${broken}")
  endif()
  return()
endif()

find_broken_arrows(${SOURCE_DIRECTORY} broken files)
if(broken)
  list(JOIN broken "\n  " text)
  message(FATAL_ERROR "an include points against the arrows:\n  ${text}")
endif()
if(files EQUAL 0)
  message(FATAL_ERROR "no source found under ${SOURCE_DIRECTORY}")
endif()
message(STATUS "${files} files, all includes follow the arrows")
