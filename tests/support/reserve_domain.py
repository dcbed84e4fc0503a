"""A DDS domain for a Python test."""

import fcntl
import os
import tempfile


def reserve_domain():
    """Reserves a test domain like TestDomain in tests/support; returns the lock and the domain."""
    for domain in range(1, 101):
        lock = open(os.path.join(tempfile.gettempdir(), f"sonopose-test-domain-{domain}.lock"), "a", encoding="utf-8")
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return lock, domain
        except BlockingIOError:
            lock.close()
    raise AssertionError("all test domains are taken")
