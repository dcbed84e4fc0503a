#!/bin/sh
# A simulated drone, its fusion, and the relay that sends its pose to PX4; until Ctrl-C. Arguments, such as --domain 5,
# are for all three. The programs are those in SONOPOSE_BIN, or on PATH.
set -e
PATH=${SONOPOSE_BIN:+$SONOPOSE_BIN:}$PATH
sonopose-bridge --source sim --scenario drone "$@" &
programs=$!
sonopose-fusion "$@" &
programs="$programs $!"
sonopose-ros2 --network loopback --px4 / "$@" &
programs="$programs $!"
trap 'kill $programs 2>/dev/null' EXIT
trap 'exit 0' INT TERM
wait
