#!/usr/bin/env bash
# GIVEN an installation of this build in an empty folder, and the package sonopose_ros2
# WHEN colcon builds the package
# THEN it has the programs as its executables, and the relay knows every parameter of its parameter file.
set -euo pipefail
build=$1 source=$2 cmake=$3
if ! command -v colcon >/dev/null; then
  echo "skipped: no colcon (scripts/setup installs it)"
  exit 0
fi
. "$source/tests/install/installation.sh"
# Without the caller's ROS 2 paths, which would be searched too. Debian's ament packages need Debian's Python.
env -u AMENT_PREFIX_PATH -u COLCON_PREFIX_PATH COLCON_HOME="$work/colcon" PATH="$work/prefix/bin:$PATH" \
  colcon --log-base "$work/log" build --base-paths "$source/ros2" --build-base "$work/build" \
  --install-base "$work/install" --cmake-args -DPython3_EXECUTABLE=/usr/bin/python3 >"$work/colcon.log" 2>&1 || { cat "$work/colcon.log"; exit 1; }

package=$work/install/sonopose_ros2
for program in sonopose-bridge sonopose-fusion sonopose-ros2; do
  "$package/lib/sonopose_ros2/$program" --version
done
test -f "$package/share/ament_index/resource_index/packages/sonopose_ros2"
share=$package/share/sonopose_ros2
for launch_file in "$share"/launch/*.py; do
  python3 -c 'import sys; compile(open(sys.argv[1]).read(), sys.argv[1], "exec")' "$launch_file"
done
test -f "$share/rviz/sonopose.rviz"

. "$source/tests/install/reserve_domain.sh"
"$package/lib/sonopose_ros2/sonopose-ros2" --network loopback --ros-args -r __node:=sonopose -r __ns:=/ \
  --params-file "$share/config/relay.yaml" 2>"$work/relay.log" &
pids+=($!)
for _ in $(seq 1000); do
  grep -q "relaying as /sonopose" "$work/relay.log" && break
  sleep 0.1
done
cat "$work/relay.log"
grep -q "relaying as /sonopose" "$work/relay.log"
if grep -q "neither a setting nor an option" "$work/relay.log"; then exit 1; fi
