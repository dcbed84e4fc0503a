#!/usr/bin/env bash
# GIVEN an installation of this build, and cyclonedds-cxx
# WHEN examples/consumer is built with that, unchanged, and started
# THEN it receives poses of the installed programs.
set -euo pipefail
build=$1 source=$2 cmake=$3
binding=$(sed -n 's/^CycloneDDS-CXX_DIR:PATH=//p' "$build/CMakeCache.txt")
if [ ! -d "$binding" ]; then
  echo "skipped: CMake finds no CycloneDDS-CXX (configure with -DCMAKE_PREFIX_PATH=PREFIX of cyclonedds-cxx 0.10)"
  exit 0
fi
. "$source/tests/install/installation.sh"
"$cmake" -S "$source/examples/consumer" -B "$work/consumer" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" \
  -DCycloneDDS-CXX_DIR="$binding" -DSONOPOSE_DDS=cyclonedds-cxx
"$cmake" --build "$work/consumer"

. "$source/tests/install/reserve_domain.sh"
"$work/prefix/bin/sonopose-fusion" & pids+=($!)
"$work/prefix/bin/sonopose-bridge" & pids+=($!)
export CYCLONEDDS_URI=file://$work/prefix/share/sonopose/cyclonedds-loopback.xml
poses=$(timeout 200 "$work/consumer/sonopose_consumer" 50 | tee "$work/poses" | wc -l)
tail -n 1 "$work/poses"
[ "$poses" -ge 50 ]
