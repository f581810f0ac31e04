# shellcheck shell=bash disable=SC2034  # the scripts that source this use them
# Sourced by run.sh and test.sh: where things are, and the build.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
jobs=$(nproc 2>/dev/null || echo 2)
program="$root/build/release/app/palpate"

# The demo scan, for the program and the tests.
find_demo_scan() {
  local file
  for file in "${PALPATE_DEMO_SCAN:-}" /usr/share/doc/invesalius-examples/examples/Cranium.inv3 \
    "$root/build/demo/Cranium.inv3"; do
    if [ -n "$file" ] && [ -f "$file" ]; then
      export PALPATE_DEMO_SCAN="$file"
      return 0
    fi
  done
  return 1
}

# build <preset> [cmake --build arguments]: configures once, builds with all processors.
build() {
  local preset=$1
  shift
  (cd "$root" && cmake --preset "$preset" >/dev/null && cmake --build --preset "$preset" -j "$jobs" "$@")
}
