#!/usr/bin/env bash
# GIVEN the units of share/systemd and the programs of this build
# THEN systemd finds no mistake in them, and the exposure of each is at most 1.5.
# GIVEN a package that is installed first, or follows an earlier version
# THEN beacons that are plugged in already get what its udev rules say.
set -euo pipefail
build=$1 source=$2
udev=$(mktemp -d)
printf '#!/bin/sh\necho "$1" >>%s/calls\n' "$udev" >"$udev/udevadm"
chmod +x "$udev/udevadm"
ln -s /bin/true "$udev/deb-systemd-invoke"
for earlier in "" 0.2.0; do
  PATH="$udev:$PATH" sh "$source/debian/sonopose.postinst" configure "$earlier"
done
calls=$(paste -sd ' ' "$udev/calls")
rm -r "$udev"
[ "$calls" = "control trigger control trigger" ] || { echo "udevadm was called with: $calls"; exit 1; }
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
