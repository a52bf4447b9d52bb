# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A ROS_DOMAIN_ID that no other test on this machine has, in whatever process it runs."""

from collections.abc import Iterator
from contextlib import contextmanager
import fcntl
import os
from pathlib import Path
import tempfile
from typing import TextIO

DOMAINS = range(20, 102)  # above 101 the ports meet Linux's ephemeral ones; low ones are people's


@contextmanager
def free_domain() -> Iterator[int]:
    """Yield a domain of one's own, set for this process and those that it starts."""
    before = dict(os.environ)
    for domain in DOMAINS:
        with _opened(Path(tempfile.gettempdir()) / f'lta-test-domain-{domain}') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            os.environ['ROS_DOMAIN_ID'] = str(domain)
            # Where the workspace (tools/workspace.sh) has not seen to it already.
            os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
            try:
                yield domain
            finally:
                for name in ('ROS_DOMAIN_ID', 'ROS_AUTOMATIC_DISCOVERY_RANGE'):
                    os.environ.pop(name)
                    os.environ |= {name: before[name]} if name in before else {}
            return
    raise RuntimeError('All DDS domains are in use by other tests; wait for them to end.')


def _opened(path: Path) -> TextIO:
    """Open a file to lock it: another user's may only be read, which is enough."""
    try:
        return path.open()
    except FileNotFoundError:
        return path.open('a')
