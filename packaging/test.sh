#!/bin/bash
# Every check, from a fresh Debian 12: set-up, format, includes, build, lint, sanitizers, tests.
#
#   packaging/test.sh              everything but asan; CTest's summary closes the output
#   packaging/test.sh STAGE...     only these: setup format includes build lint tsan asan test
#
# asan (address and undefined-behaviour sanitizers, about ten minutes more) runs on request.
# Tests labelled 'long' (full stability, soak, fuzzing, benchmarks) run on request:
#   ctest --test-dir build/release -L long
set -uo pipefail
# shellcheck source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root" || exit 4

failed=()
summary=()

say() { printf '\n== test: %s\n' "$*"; }

# stage <name>: runs stage_<name>, times it, remembers a failure.
stage() {
  local name=$1 start=$SECONDS
  say "$name"
  if "stage_$name"; then
    summary+=("$name: ok, $((SECONDS - start)) s")
  else
    summary+=("$name: FAILED, $((SECONDS - start)) s")
    failed+=("$name")
    return 1
  fi
}

sources() { find app core imaging ui tests datasets -name '*.h' -o -name '*.cpp' | LC_ALL=C sort; }

stage_setup() { packaging/setup.sh; }

stage_format() { sources | xargs -P "$jobs" -n 40 clang-format --dry-run -Werror; }

stage_includes() { python3 packaging/check_includes.py --self-test && python3 packaging/check_includes.py; }

stage_build() { build release; }

# clang-tidy over what carries the force and the record: all of core and app takes four times as
# long (packaging/test.sh with LINT='core app').
stage_lint() {
  local folders=(core/base core/geometry core/haptics core/dynamics core/simulation core/session)
  if [ -n "${LINT:-}" ]; then read -ra folders <<<"$LINT"; fi
  find "${folders[@]}" -name '*.cpp' | LC_ALL=C sort |
    xargs -P "$jobs" -n 2 clang-tidy -p build/release --quiet --warnings-as-errors='*' 2>/dev/null
}

# sanitized <preset> <rooms> [tests to leave out]: builds only the test programs of these rooms, and runs them.
sanitized() {
  local preset=$1 rooms=$2 room
  local targets=()
  for room in ${rooms//|/ }; do targets+=(--target "test_$room"); done
  build "$preset" "${targets[@]}" &&
    ctest --test-dir "build/$preset" -j "$jobs" --output-on-failure -LE long -R "^($rooms)\." \
      ${3:+-E "$3"}
}

# The two loops and everything that crosses between threads; not the long runs of a single thread.
stage_tsan() {
  TSAN_OPTIONS='halt_on_error=1 second_deadlock_stack=1' \
    sanitized tsan 'base|haptics|simulated_devices|phantom|simulation|session' 'Loose|Pace\.|Overload|LevelChange|Reach\.'
}

# Everything that reads files or does arithmetic on indices.
stage_asan() {
  ASAN_OPTIONS='strict_string_checks=1' UBSAN_OPTIONS='print_stacktrace=1' \
    LSAN_OPTIONS="suppressions=$root/packaging/lsan.supp" \
    sanitized asan 'base|geometry|voxels|collision|dynamics|scene|session|imaging|imaging_exchange|segment'
}

# A private display of a fixed size, so that golden pictures have one size everywhere.
stage_test() {
  LP_NUM_THREADS=2 xvfb-run -a -s '-screen 0 1600x1000x24 -noreset' \
    ctest --test-dir build/release -j "$jobs" --output-on-failure -LE long
}

stages=("$@")
[ $# -gt 0 ] || stages=(setup format includes build lint tsan test)
for name in "${stages[@]}"; do
  if ! declare -F "stage_$name" >/dev/null; then
    printf "test: unknown stage '%s'; the stages are setup format includes build lint tsan asan test.\n" "$name" >&2
    exit 2
  fi
done

for name in "${stages[@]}"; do
  # The tests come last, so that CTest's summary closes the output: the rest is told before.
  if [ "$name" = test ] && [ ${#summary[@]} -gt 0 ]; then
    printf '\n'
    printf '   %s\n' "${summary[@]}"
  fi
  find_demo_scan || true
  if ! stage "$name"; then
    # Without packages or a build the rest can only fail for the same reason.
    case $name in setup | build) break ;; esac
  fi
done
if [ ${#failed[@]} -gt 0 ]; then
  printf 'test: failed: %s\n' "${failed[*]}" >&2
  exit 1
fi
