#!/usr/bin/env bash
# Runs one small finite-element job end to end under valgrind: reads of what was never written, reads and
# writes beside what was allocated. The sanitized build has no finite elements, as deal.II comes without.
# Exit status: 0 clean; 1 valgrind reported something (its report is printed).
#
# usage: tests/fem/under_valgrind.sh [BUILD_FOLDER] [CASE [ARGUMENTS OF softfinger fem ...]]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "${1:-$here/../../build/release}" && pwd)
shift || true
if [ $# -eq 0 ]; then set -- hertz_circle --level 1; fi
command -v valgrind >/dev/null || { echo "valgrind is missing (apt-get install valgrind)" >&2; exit 1; }

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cat >"$scratch/softfinger-fem" <<END
#!/bin/sh
exec valgrind --error-exitcode=99 --leak-check=no --log-file="$scratch/report" \\
  --suppressions="$here/valgrind.supp" "$build/bin/softfinger-fem" "\$@"
END
chmod +x "$scratch/softfinger-fem"

# One thread: valgrind runs them in turn anyway.
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 DEAL_II_NUM_THREADS=1
# valgrind knows no AVX-512; OpenBLAS then must not choose its kernels by the processor alone.
export OPENBLAS_CORETYPE=Haswell
status=0
SOFTFINGER_FEM_PROGRAM="$scratch/softfinger-fem" "$build/bin/softfinger" fem "$@" || status=$?
tail -n 1 "$scratch/report" >&2
if [ "$status" -ne 0 ]; then
  cat "$scratch/report" >&2
  exit 1
fi
