# Sourced by tests: reserves a test domain like TestDomain in tests/support and sets ROS_DOMAIN_ID to it.
for ROS_DOMAIN_ID in $(seq 100); do
  exec {lock}>>"${TMPDIR:-/tmp}/sonopose-test-domain-$ROS_DOMAIN_ID.lock"
  flock -n "$lock" && break
  exec {lock}>&-
done
export ROS_DOMAIN_ID
