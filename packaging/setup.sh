#!/bin/bash
# Installs the Debian packages that are missing and puts the demo scan where the program finds it.
# Safe to repeat. Called by run.sh and test.sh.
set -euo pipefail
export LC_ALL=C DEBIAN_FRONTEND=noninteractive

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(dirname "$here")

say() { printf 'setup: %s\n' "$*" >&2; }
die() { say "$*"; exit 4; }

command -v apt-get >/dev/null && command -v dpkg-query >/dev/null ||
  die "This script installs packages with apt and needs Debian 12. Elsewhere install what packaging/packages.txt lists."

# As root, or through sudo; the environment is given again because sudo drops it.
as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo env LC_ALL=C DEBIAN_FRONTEND=noninteractive "$@"
  else
    die "Packages are missing and there is no sudo. Run packaging/setup.sh once as root."
  fi
}

apt_get() { as_root apt-get -q -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300 "$@"; }

# '|| true' on greps: a line that is not there is an answer, not a failure.
wanted() { sed -e 's/#.*//' -e 's/[[:space:]]//g' "$here/packages.txt" | grep -v '^$'; }

is_installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null || true)" = installed ] ||
    [ "$(dpkg-query -W -f='${db:Status-Status}\n' "$1:*" 2>/dev/null | head -n 1 || true)" = installed ]
}

# No 'grep -q' behind a pipe: it stops reading early, and under pipefail the writer's SIGPIPE would
# now and then turn a yes into a no.
has_candidate() {
  local policy
  policy=$(apt-cache policy "$1" 2>/dev/null) || return 1
  [[ $policy =~ Candidate:\ [^\(] ]]
}

missing=()
while read -r package; do
  is_installed "$package" || missing+=("$package")
done < <(wanted)

if [ ${#missing[@]} -eq 0 ]; then
  say "every package is installed"
else
  for package in "${missing[@]}"; do
    if ! has_candidate "$package"; then
      say "reading the package lists"
      apt_get update >&2
      break
    fi
  done
  for package in "${missing[@]}"; do
    has_candidate "$package" ||
      die "Debian's lists do not have the package '$package'. This needs Debian 12 with its 'main' archive."
  done
  say "to install (${#missing[@]} packages and what they need): ${missing[*]}"
  # apt says the sizes before it asks; --assume-no answers for us. No lock, so no root, for this.
  apt-get -o Debug::NoLocking=1 --assume-no --no-install-recommends install "${missing[@]}" 2>/dev/null |
    grep -E '^(Need to get|After this operation)' >&2 || true
  apt_get install --yes --no-install-recommends "${missing[@]}" >&2 ||
    die "apt could not install the packages; its messages are above. Free space or restore the network, then run this again."
fi

# Minimal containers drop /usr/share/doc while unpacking, and with it the demo scan.
demo_in_debian=/usr/share/doc/invesalius-examples/examples/Cranium.inv3
demo_here="$root/build/demo/Cranium.inv3"
if [ ! -f "$demo_in_debian" ] && [ ! -f "$demo_here" ]; then
  say "the demo scan was dropped while unpacking; taking it from the package again"
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  has_candidate invesalius-examples || apt_get update >&2
  # apt downloads as the user _apt, who must be able to write here.
  chmod 755 "$work"
  if [ "$(id -u)" -eq 0 ]; then chown _apt "$work" 2>/dev/null || true; fi
  (cd "$work" && apt-get -q -o Acquire::Retries=3 download invesalius-examples >&2) ||
    die "The package invesalius-examples could not be downloaded again. Restore the network, then run this again."
  dpkg-deb -x "$work"/invesalius-examples_*.deb "$work/tree"
  mkdir -p "$root/build/demo"
  cp "$work/tree$demo_in_debian" "$demo_here.part"
  mv "$demo_here.part" "$demo_here"
fi
