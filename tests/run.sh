#!/usr/bin/env bash
# Installs what is missing, builds and tests: everything in Release, then the fast tests again with
# address and undefined-behaviour sanitizers and assertions (without finite elements).
#
# usage: tests/run.sh [--fast | --analytic-only]
#        --fast            only the fast tests, in Release: run it before each commit
#        --analytic-only   only what needs neither deal.II nor gmsh
#
# Not run here, because of their time:
#   tests/fuzz/run.sh MINUTES          fuzzes the readers of files (clang)
#   tests/fem/under_valgrind.sh        one small finite-element job under valgrind
#   cmake --preset thread_sanitized && cmake --build --preset thread_sanitized && ctest --preset thread_sanitized
#                                      what uses threads, under the thread sanitizer
set -euo pipefail
cd "$(dirname "$0")/.."
. comparisons/prepare.sh

case "${1:-}" in
  "" | --fast | --analytic-only) ;;
  *)
    sed -n 's/^# \{0,1\}//; 2,8p' "$0"
    [ "$1" = --help ] && exit 0
    echo "tests/run.sh: $1: allowed are --fast, --analytic-only and --help" >&2
    exit 2
    ;;
esac

preset=release kind=fem
if [ "${1:-}" = --analytic-only ]; then preset=analytic-only kind=analytic; fi
softfinger_prepare "$kind" test
softfinger_use_ccache
# What each source costs the compiler is printed at the end, so that growth is seen.
export CMAKE_CXX_COMPILER_LAUNCHER="$PWD/tests/build_cost.py;measure${CMAKE_CXX_COMPILER_LAUNCHER:+;$CMAKE_CXX_COMPILER_LAUNCHER}"

softfinger_configure --preset "$preset" -DSOFTFINGER_BUILD_TESTS=ON
if [ "${1:-}" = --fast ]; then
  cmake --build --preset release --target fast_tests
  exec ctest --preset release -j "$(nproc)" -L fast
fi
cmake --build --preset "$preset"
ctest --preset "$preset" -j "$(nproc)" -LE browser
# A browser beside other jobs draws late, or stumbles over itself, once in some hundred runs: only pages that
# wait for no clock are drawn beside each other (tests/report/CMakeLists.txt).
ctest --preset "$preset" -j "$(nproc)" -L browser --repeat until-pass:2

# The preset builds what the fast tests need and no more; by the system's compiler (GCC), so that two are tried.
cmake --preset sanitized -DSOFTFINGER_BUILD_TESTS=ON
cmake --build --preset sanitized
ctest --preset sanitized -j "$(nproc)" -L fast
tests/build_cost.py report "build/$preset" build/sanitized
