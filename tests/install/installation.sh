# Sourced by tests with $build and $cmake: installs the build in $work/prefix. At the end of the test, the processes of
# $pids are killed and $work is removed.
work=$(mktemp -d)
pids=()
cleanup() {
  [ ${#pids[@]} -eq 0 ] || kill -KILL "${pids[@]}" 2>/dev/null || true
  wait 2>/dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT

"$cmake" --install "$build" --prefix "$work/prefix" >/dev/null
