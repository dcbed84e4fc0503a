# Sourced by tests: sets ROS_DOMAIN_ID to a domain of its own, reserved as by TestDomain in tests/support.
for ROS_DOMAIN_ID in $(seq 100); do
  exec {lock}>>"${TMPDIR:-/tmp}/sonopose-test-domain-$ROS_DOMAIN_ID.lock"
  flock -n "$lock" && break
  exec {lock}>&-
done
export ROS_DOMAIN_ID
