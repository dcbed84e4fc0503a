#!/usr/bin/env python3
"""Prints the position of each beacon once a second, from `sonopose-monitor --echo pose`.

It needs Python 3 and nothing else. The arguments are passed on to sonopose-monitor, such as --domain 5 or --beacon 7;
the program is taken from SONOPOSE_MONITOR, otherwise from PATH.
"""

import json
import os
import subprocess
import sys


def samples(topic, arguments):
    """The samples of a topic as dictionaries, with the field names of idl/sonopose.idl."""
    monitor = os.environ.get("SONOPOSE_MONITOR", "sonopose-monitor")
    try:
        process = subprocess.Popen([monitor, "--echo", topic, *arguments], stdout=subprocess.PIPE, text=True)
    except OSError as error:
        raise SystemExit(f"{monitor}: {error.strerror}; set SONOPOSE_MONITOR to its path") from error
    with process:
        for line in process.stdout:
            yield json.loads(line)
    if process.returncode != 0:
        raise SystemExit(f"{monitor} ended with {process.returncode}")


def main():
    printed = {}  # by address: the time of the pose that was printed last, ns
    for pose in samples("pose", sys.argv[1:]):
        address, time_ns = pose["address"], pose["time"]
        position = pose["position"]
        if None in position.values() or abs(time_ns - printed.get(address, 0)) < 1_000_000_000:
            continue
        printed[address] = time_ns
        print(f"beacon {address}: {position['x']:.3f} {position['y']:.3f} {position['z']:.3f} m", flush=True)


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, BrokenPipeError):
        sys.stderr.close()
