# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A port of this machine that nobody uses: what stands fixed in a test meets other checkouts."""

import socket

TCP, UDP = socket.SOCK_STREAM, socket.SOCK_DGRAM


def free_port(kind: socket.SocketKind = TCP) -> int:
    """Return a port on which nobody listens."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(('127.0.0.1', 0))
        return int(probe.getsockname()[1])
