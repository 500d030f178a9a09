#!/usr/bin/env bash
# Builds the fuzzers and runs them all, two at a time, for MINUTES in total. Prints a table; inputs that
# crash a reader, hang it or fill the memory are made small and kept in findings/, where the fast tests
# replay them from then on. Exit status: 0 nothing was found, 1 something was.
#
# usage: tests/fuzz/run.sh MINUTES
#
# SOFTFINGER_FUZZ_TARGETS="case_toml layer_msh": these only.
set -euo pipefail
minutes=${1:?usage: tests/fuzz/run.sh MINUTES}
cd "$(dirname "$0")/../.."

missing=()
command -v clang++ >/dev/null || missing+=(clang)
compgen -G "/usr/lib/llvm-*/lib/clang/*/lib/linux/libclang_rt.fuzzer-*" >/dev/null || missing+=(libclang-rt-dev)
if [ ${#missing[@]} -gt 0 ]; then
  echo "missing packages: ${missing[*]} (apt-get install ${missing[*]})" >&2
  exit 1
fi
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz

build=build/fuzz
corpus=$build/corpus
"$build/bin/fuzz_replay" --write-seeds "$build/seeds"
read -r -a targets <<<"${SOFTFINGER_FUZZ_TARGETS:-$(ls "$build/seeds" | tr '\n' ' ')}"

# target:dictionary:largest input. Enough for each kind of entry; longer inputs only cost time.
settings_of() {
  case $1 in
    case_toml) echo toml 4096 ;;
    scene_toml) echo toml 16384 ;;
    surface_*) echo mesh 4096 ;;
    layer_msh) echo msh 4096 ;;
    fem_problem | stored_result) echo json 8192 ;;
    *) echo none 8192 ;;
  esac
}

# Freed memory is kept only shortly: what is asked for counts, not what the sanitizer keeps.
export ASAN_OPTIONS=quarantine_size_mb=16:allocator_may_return_null=0
export UBSAN_OPTIONS=print_stacktrace=1
limits=(-timeout=1 -rss_limit_mb=1024 -malloc_limit_mb=1024)

run_target() { # target seconds
  local target=$1 seconds=$2 dictionary largest log
  read -r dictionary largest <<<"$(settings_of "$target")"
  log=$build/log/$target
  mkdir -p "$corpus/$target" "$build/artifacts/$target" "$build/log"
  rm -f "$build/artifacts/$target/"*
  local options=("${limits[@]}" -max_len="$largest" -max_total_time="$seconds" -print_final_stats=1
                 -artifact_prefix="$build/artifacts/$target/")
  if [ "$dictionary" != none ]; then options+=(-dict="tests/fuzz/dictionaries/$dictionary.dict"); fi
  # What it throws away in words on the way is of no interest.
  "$build/bin/fuzz_$target" "${options[@]}" "$corpus/$target" "$build/seeds/$target" >"$log" 2>&1 </dev/null || true
  local artifact
  for artifact in "$build/artifacts/$target/"*; do
    [ -e "$artifact" ] || continue
    # On a busy machine a second passes quickly: it has to be slow again.
    case $artifact in
      */timeout-* | */slow-unit-*)
        "$build/bin/fuzz_$target" "${limits[@]}" "$artifact" >/dev/null 2>&1 </dev/null && continue ;;
      */crash-*)
        "$build/bin/fuzz_$target" "${limits[@]}" -minimize_crash=1 -max_total_time=60 \
          -exact_artifact_path="$artifact.small" "$artifact" >/dev/null 2>&1 </dev/null || true
        [ -s "$artifact.small" ] && mv "$artifact.small" "$artifact" ;;
    esac
    mkdir -p "tests/fuzz/findings/$target"
    cp "$artifact" "tests/fuzz/findings/$target/"
    echo "$artifact" >>"$log.findings"
  done
}

seconds=$((minutes * 60 * 2 / ${#targets[@]}))
rm -f "$build"/log/*
for target in "${targets[@]}"; do
  run_target "$target" "$seconds" &
  while [ "$(jobs -pr | wc -l)" -ge 2 ]; do wait -n; done
done
wait

total=0 findings=0
printf '%-20s %14s %10s %9s\n' target executions per_s findings
for target in "${targets[@]}"; do
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/log/$target")
  per_second=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$build/log/$target")
  found=0
  if [ -e "$build/log/$target.findings" ]; then found=$(wc -l <"$build/log/$target.findings"); fi
  printf '%-20s %14s %10s %9s\n' "$target" "${executions:-?}" "${per_second:-?}" "$found"
  total=$((total + ${executions:-0})) findings=$((findings + found))
done
printf '%-20s %14s %10s %9s\n' all "$total" '' "$findings"
[ "$findings" -eq 0 ]
