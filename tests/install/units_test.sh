#!/usr/bin/env bash
# GIVEN the units of share/systemd and the programs of this build
# THEN systemd finds no mistake in them, and the exposure of each is at most 1.5.
set -euo pipefail
build=$1 source=$2
command -v systemd-analyze >/dev/null || { echo "skipped: no systemd-analyze; apt-get install systemd installs it"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r "$source/share/systemd" "$work/units"
# Where they are, and without man pages.
sed -i -E -e "s#^(Exec[A-Za-z]+=)sonopose#\1$build/bin/sonopose#" -e '/^Documentation=/d' "$work"/units/*.service
for unit in "$work"/units/*.service; do
  case $unit in
    *sonopose-web*) [ -x "$build/bin/sonopose-web" ] || continue ;;
  esac
  said=$(systemd-analyze verify "$unit" 2>&1 | grep -F sonopose || true)
  [ -z "$said" ] || { echo "$said"; exit 1; }
  systemd-analyze security --offline=true --threshold=15 "$unit" >"$work/exposure" ||
    { grep -v '✓' "$work/exposure"; exit 1; }
  tail -n 1 "$work/exposure"
done
