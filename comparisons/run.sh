#!/usr/bin/env bash
# The main job: installs what is missing, builds, runs the built-in suite, says where the report is.
#
# usage: comparisons/run.sh [--output DIR] [any other flag of `softfinger compare`]
#        comparisons/run.sh --analytic-only      builds without deal.II and gmsh and lists the predictions
#
# A finished finite-element result is kept: an interrupted run goes on where it was cut off.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/comparisons/prepare.sh"

if [ "${1:-}" = --analytic-only ]; then
  shift
  softfinger_prepare analytic run
  (cd "$root" && softfinger_configure --preset analytic-only -DSOFTFINGER_BUILD_TESTS=OFF >/dev/null && cmake --build --preset analytic-only --target softfinger)
  for case in "$root"/comparisons/cases/*.toml; do
    # Mesh cases need surfaces that gmsh makes.
    grep -q 'mesh *=' "$case" || "$root/build/analytic-only/bin/softfinger" predict "$case" "$@"
  done
  exit
fi

softfinger_prepare fem run
# The tests have needs of their own: tests/run.sh turns them on. What this job does not run (the
# verification of the finite elements, studies, tools) is not built either.
(cd "$root" && softfinger_configure --preset release -DSOFTFINGER_BUILD_TESTS=OFF >/dev/null && cmake --build --preset release --target softfinger softfinger-fem)
"$root/build/release/bin/softfinger" compare "$@"
