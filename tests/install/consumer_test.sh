#!/usr/bin/env bash
# GIVEN an installation of this build in an empty folder
# WHEN the example consumer is configured with find_package(sonopose) alone, built and started
# THEN it receives poses from the installed bridge and fusion.
set -euo pipefail
build=$1 source=$2 cmake=$3
work=$(mktemp -d)
pids=()
cleanup() {
  [ ${#pids[@]} -eq 0 ] || kill -KILL "${pids[@]}" 2>/dev/null || true
  wait 2>/dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT

"$cmake" --install "$build" --prefix "$work/prefix" >/dev/null
flags=$(sed -n 's/^SONOPOSE_SANITIZE:STRING=//p' "$build/CMakeCache.txt")
"$cmake" -S "$source/examples/consumer" -B "$work/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" \
  ${flags:+-DCMAKE_CXX_FLAGS=-fsanitize=$flags} >/dev/null
"$cmake" --build "$work/build" >/dev/null

export ROS_DOMAIN_ID=$((200 + $$ % 30))
"$work/prefix/bin/sonopose-fusion" & pids+=($!)
"$work/prefix/bin/sonopose-bridge" & pids+=($!)
poses=$(timeout 60 "$work/build/sonopose_consumer" 50 | tee "$work/poses" | wc -l)
tail -n 1 "$work/poses"
[ "$poses" -ge 50 ]
