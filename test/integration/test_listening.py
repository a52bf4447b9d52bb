# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Nothing of a graph listens outside this machine unless asked, and others on it still find it.

Nor does it use shared memory, where a node that is killed may hold a lock of all the others.
"""

from collections.abc import Iterator
import ipaddress
import os
from pathlib import Path
import subprocess
import sys

import pytest
from waiting import PATIENCE

from .command import ROOT

TABLES = ('udp', 'udp6', 'tcp', 'tcp6')
BOUND = ('07', '0A')  # states of /proc/net: UDP that is bound, TCP that listens
CHOSEN = ('ROS_AUTOMATIC_DISCOVERY_RANGE', 'FASTRTPS_DEFAULT_PROFILES_FILE')
LISTENER = """
import rclpy
rclpy.init()
node = rclpy.create_node('listener')
print('here', flush=True)
input()
"""


def addresses() -> Iterator[tuple[str, str]]:
    """Yield the inode of each socket that takes what comes, and its address."""
    for table in TABLES:
        for line in Path('/proc/net', table).read_text().splitlines()[1:]:
            _, local, _, state, *_, inode = line.split()[:10]
            if state in BOUND:
                yield inode, from_hex(local.partition(':')[0])


def from_hex(text: str) -> str:
    """Return an address as the kernel writes it, each four bytes in the machine's order."""
    words = [bytes.fromhex(text[i : i + 8])[::-1] for i in range(0, len(text), 8)]
    return str(ipaddress.ip_address(b''.join(words)))


def sockets(pid: int) -> set[str]:
    """Return the addresses that a process listens on."""
    links = (str(path.readlink()) for path in Path(f'/proc/{pid}/fd').iterdir())
    inodes = {link[len('socket:[') : -1] for link in links if link.startswith('socket:[')}
    return {address for inode, address in addresses() if inode in inodes}


def shared(pid: int) -> list[str]:
    """Return the files of Fast DDS's shared memory that a process has mapped."""
    mapped = Path(f'/proc/{pid}/maps').read_text().splitlines()
    return [line for line in mapped if '/dev/shm/' in line and 'fastrtps' in line]


def entered(**chosen: str) -> dict[str, str]:
    """Return the environment of the workspace, entered with nothing chosen but this."""
    given = {name: value for name, value in os.environ.items() if name not in CHOSEN}
    script = f'root={ROOT}; . tools/workspace.sh; env -0'
    done = subprocess.run(
        ['sh', '-c', script], cwd=ROOT, env=given | chosen, capture_output=True, check=True
    )
    return dict(item.split('=', 1) for item in done.stdout.decode().split('\0') if item)


@pytest.mark.parametrize(
    ('chosen', 'outside'),
    [
        ({}, False),
        ({'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_LOCALHOST_ONLY': '1'}, False),
        ({'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'}, True),
        ({'ROS_STATIC_PEERS': '192.0.2.7'}, True),
    ],
    ids=['as it comes', 'LOCALHOST', 'SUBNET', 'peers'],
)
@pytest.mark.usefixtures('domain_id')
def test_who_asks_for_the_network_gets_it(chosen, outside):
    words = [sys.executable, '-c', LISTENER]
    with subprocess.Popen(
        words, env=entered(**chosen), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as node:
        assert node.stdout.readline() == 'here\n'
        assert ('0.0.0.0' in sockets(node.pid)) == outside
        # For peers that are named ROS adds what it likes, shared memory where there is any.
        assert 'ROS_STATIC_PEERS' in chosen or shared(node.pid) == []
        node.communicate('\n', timeout=PATIENCE)
