#!/bin/bash
# From a fresh Debian 12 to the window with the demo head:
#
#   packaging/run.sh                    set up, build, open the desktop on the demo case
#   packaging/run.sh --headless         the same without a window: ten simulated seconds
#   packaging/run.sh -- ARGUMENTS...    set up, build, then 'palpate ARGUMENTS...'
#
# Safe to repeat: what is done is not done again. Exit codes: the program's (see README.md), or 4
# when the machine cannot do it.
set -euo pipefail
# shellcheck source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

say() { printf 'run: %s\n' "$*" >&2; }

headless=false
while [ $# -gt 0 ]; do
  case $1 in
    --headless) headless=true ;;
    --help | -h)
      sed -n '2,10s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
      exit 0
      ;;
    --)
      shift
      break
      ;;
    *)
      say "unknown argument '$1'; arguments for the program go behind '--'."
      exit 2
      ;;
  esac
  shift
done

"$root/packaging/setup.sh" || exit 4
say "building"
build release --target palpate >&2 || { say "The build failed; the compiler's messages are above."; exit 4; }

data=${XDG_DATA_HOME:-${HOME:-/root}/.local/share}
demo="$data/palpate/cases/demo-head"

# Imported and segmented beside its name and moved when whole, so that a stop leaves nothing half.
prepare_demo() {
  if [ -f "$demo/labels.mha" ]; then return 0; fi
  find_demo_scan || { say "The demo scan is not there; install invesalius-examples."; return 4; }
  say "preparing the demo case"
  (umask 077 && mkdir -p "$(dirname "$demo")")
  local part
  part=$(mktemp -d "$demo.part-XXXXXX")
  "$program" import "$PALPATE_DEMO_SCAN" --out "$part/case" >&2 &&
    "$program" segment "$part/case" --preset ct-bone --largest >&2 &&
    rm -rf "$demo" && mv "$part/case" "$demo"
  local code=$?
  rm -rf "$part"
  return $code
}
prepare_demo || exit $?

if $headless; then
  exec "$program" simulate "$demo" --headless "$@"
fi

# A command as first argument needs no window; options alone are the window's.
if [ $# -gt 0 ] && [[ $1 != -* ]]; then
  exec "$program" "$@"
fi
for argument in "$@"; do
  case $argument in
    --help | -h | --version) exec "$program" "$@" ;;
  esac
done

if [ -z "${DISPLAY:-}" ]; then
  if [ -n "${WAYLAND_DISPLAY:-}" ]; then
    say "There is a Wayland display, but the window needs XWayland (DISPLAY is not set)."
  else
    say "There is no display, so the window cannot open."
  fi
  say "The same simulation without a window:"
  say "  packaging/run.sh --headless"
  say "which is: $program simulate $demo --headless"
  exit 4
fi
for argument in "$@"; do
  case $argument in
    --case | --case=*) exec "$program" "$@" ;;
  esac
done
exec "$program" --case "$demo" "$@"
