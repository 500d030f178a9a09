#!/usr/bin/env bash
# Breaks the code on purpose, one line at a time, and expects a fast test to fail: a change that no
# test notices is a test that is missing.
#
# usage: tests/mutations/run.sh [PART]           only files whose path contains PART
#        tests/mutations/run.sh --check [LIST]   only whether each mutation still applies: a fast test
#
# Run by hand without --check: each mutation is compiled and tested, which takes half a minute or so. It works on a
# clone of the last commit in build/mutations. mutations.txt holds four lines for each, and an empty
# one between them: the file, a text that is there once, what replaces it, and the test program that
# is to notice.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
if [ "${1:-}" = --check ]; then
  cd "$root"
  count=0 rotten=0
  while IFS= read -r file && IFS= read -r old && IFS= read -r new && IFS= read -r program; do
    IFS= read -r empty || empty=
    count=$((count + 1))
    # The text has to stand on one line, its mutation has to be another one, and the program has to be known to CMake.
    if [ -n "$empty" ] || [ "$old" = "$new" ] || [ "$(grep -cF -- "$old" "$file" 2>/dev/null)" != 1 ] ||
      ! grep -rqE "NAME $program( |$)" --include=CMakeLists.txt tests; then
      echo "does not apply: $file: $old"
      rotten=$((rotten + 1))
    fi
  done <"${2:-$here/mutations.txt}"
  echo "$((count - rotten)) of $count mutations apply"
  [ "$rotten" -eq 0 ] && [ "$count" -gt 0 ]
  exit
fi
case "${1:-}" in
  -*)
    sed -n 's/^# \{0,1\}//; 5,6p' "$0"
    [ "$1" = --help ] && exit 0
    echo "tests/mutations/run.sh: $1: allowed are --check, --help and a part of a path" >&2
    exit 2
    ;;
esac
part=${1:-}
work=$root/build/mutations

mkdir -p "$work"
[ -d "$work/tree" ] || git clone -q --local "$root" "$work/tree"
cd "$work/tree"
git fetch -q origin
git checkout -q -f "$(git -C "$root" rev-parse HEAD)"
# The clone's own list, which nobody edits meanwhile.
mutations=$work/mutations.txt
cp "$here/mutations.txt" "$mutations"
# One source is compiled anew for each, not the unit of many.
cmake --preset release -DSOFTFINGER_BUILD_TESTS=ON -DCMAKE_UNITY_BUILD=OFF >/dev/null

# A test that fails anyway would notice every mutation.
for program in $(awk -v part="$part" 'NR % 5 == 1 { file = $0 } NR % 5 == 4 && index(file, part)' "$mutations" | sort -u); do
  cmake --build --preset release --target "$program" >"$work/build.log" 2>&1 ||
    { echo "$program does not compile without unity builds: $work/build.log" >&2; exit 1; }
  "build/release/bin/$program" --gtest_brief=1 >"$work/test.log" ||
    { echo "$program fails without a mutation: $work/test.log" >&2; exit 1; }
done

count=0 noticed=0
left=()
while IFS= read -r file && IFS= read -r old && IFS= read -r new && IFS= read -r program; do
  IFS= read -r || true
  [[ $file == *"$part"* ]] || continue
  count=$((count + 1))
  if [ "$(grep -cF -- "$old" "$file")" != 1 ]; then
    outcome="is not there exactly once"
  else
    OLD=$old NEW=$new perl -0pi -e 's/\Q$ENV{OLD}\E/$ENV{NEW}/' "$file"
    if ! cmake --build --preset release --target "$program" >"$work/build.log" 2>&1; then
      outcome="does not compile"
    elif timeout 300 "build/release/bin/$program" --gtest_brief=1 >"$work/test.log" 2>&1; then
      outcome="survives"
    else
      outcome="noticed"
      noticed=$((noticed + 1))
    fi
    git checkout -q -- "$file"
  fi
  printf '%-10s %s: %s -> %s\n' "$outcome" "$file" "$old" "$new"
  [ "$outcome" = noticed ] || left+=("$file: $old -> $new ($outcome)")
done <"$mutations"

echo "$noticed of $count mutations were noticed"
[ ${#left[@]} -eq 0 ] || { printf '  %s\n' "${left[@]}"; exit 1; }
