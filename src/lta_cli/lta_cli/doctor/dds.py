# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Check DDS: a message exchange between two processes, and the UDP ports of the domain."""

import json
import os
import socket
import subprocess
import sys
import time

from lta_bridge.hardware.check_result import HardwareCheck
from lta_graph.reach import RANGE_VARIABLE

DEADLINE = 10.0  # s for the whole check; starting and discovery usually take about 1 s
SLOW_EXCHANGE = 3.0  # s; discovery that takes this long makes a launch look stuck
PARTICIPANTS = 8  # a graph of seven nodes and one more
FIREWALL = (
    'Allow UDP between processes of this machine (firewall, container network) and check'
    " that the interface 'lo' is up."
)

FAULT = 'A ROS 2 test process could not start; fix the error in the line above.'


def domain_ports(domain: int) -> list[int]:
    """
    Return the unicast UDP ports of the participants of a domain on one machine.

    Port 7400 + 250 d is the discovery multicast port; 7410 + 250 d + 2 i and 7411 + 250 d + 2 i
    are the unicast ports of participant i (DDSI-RTPS 2.3, section 9.6.1.1).
    """
    # 7400 is the port base and 250 the domain gain of the specification
    base = 7400 + 250 * domain
    return [base + 10 + offset for offset in range(2 * PARTICIPANTS)]


def find_busy_ports(ports: list[int]) -> list[int]:
    """Return the ports that are in use."""
    busy = []
    for port in ports:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                # Binding fails if another process uses the port
                probe.bind(('', port))
            except OSError:
                busy.append(port)
    return busy


def find_free_domain() -> int:
    """Return an unused domain; above 101 the ports overlap Linux's ephemeral range."""
    return next(
        domain for domain in range(101, 0, -1) if not find_busy_ports(domain_ports(domain))
    )


def check_message_exchange() -> HardwareCheck:
    """Check that two processes discover each other and exchange messages, and time it."""
    if os.environ.get(RANGE_VARIABLE) == 'OFF':
        summary = f'{RANGE_VARIABLE} is OFF, so no process finds another'
        return HardwareCheck(
            'dds', 'fail', summary, f'Unset {RANGE_VARIABLE}, or set it to LOCALHOST.'
        )
    # A domain of its own, so that a running graph neither disturbs nor is disturbed
    environment = {**os.environ, 'ROS_DOMAIN_ID': str(find_free_domain())}
    # The processes end before the deadline, so that their message can be read
    # -P: no module is taken from the current folder
    command = [sys.executable, '-P', '-m', 'lta_graph.ros.echo', '--seconds', str(DEADLINE - 2.0)]
    began = time.monotonic()
    pipe = subprocess.PIPE
    answering = subprocess.Popen([*command, 'answer'], env=environment, stdout=pipe, stderr=pipe)
    asking = subprocess.Popen([*command, 'ask'], env=environment, stdout=pipe, stderr=pipe)
    try:
        output, errors = asking.communicate(timeout=DEADLINE)
    except subprocess.TimeoutExpired:
        output, errors = b'', b''
    finally:
        for process in (asking, answering):
            process.kill()
            # Collect the process, or it would stay as a zombie
            process.communicate()
    if asking.returncode != 0 or not output:
        # The last line of a traceback names the error
        lines = errors.decode(errors='replace').strip().splitlines()
        if lines:
            return HardwareCheck('dds', 'fail', lines[-1], FAULT)
        text = f'no DDS message from a second process within {DEADLINE - 2.0:g} s'
        return HardwareCheck('dds', 'fail', text, FIREWALL)
    times = json.loads(output)
    text = (
        f'two processes discovered each other in {times["discovery_s"]:.1f} s, round trip'
        f' {times["round_trip_s"] * 1e6:.0f} us (check took {time.monotonic() - began:.1f} s)'
    )
    # Works, but every start of a graph will be slow
    if times['discovery_s'] > SLOW_EXCHANGE:
        return HardwareCheck(
            'dds',
            'warn',
            text,
            'DDS discovery is slow; close other programs, and check the network for packet loss.',
        )
    return HardwareCheck('dds', 'ok', text)


def check_ports() -> HardwareCheck:
    """Check that no other graph uses the domain of a flight."""
    text = os.environ.get('ROS_DOMAIN_ID') or '0'
    if not text.isdecimal() or int(text) > 232:  # the ports of domain 233 exceed 65535
        summary = f'ROS_DOMAIN_ID is {text!r}'
        return HardwareCheck(
            'ports',
            'fail',
            summary,
            'Set ROS_DOMAIN_ID to a number from 0 to 101, or unset it.',
        )
    domain = int(text)
    busy = find_busy_ports(domain_ports(domain))
    if busy:
        summary = f'ROS domain {domain}: UDP port {", ".join(map(str, busy))} in use'
        remedy = 'Stop the other ROS 2 nodes, or choose another domain, such as ROS_DOMAIN_ID=7'
        return HardwareCheck('ports', 'warn', summary, f'{remedy}.')
    listened = domain_ports(domain)
    return HardwareCheck(
        'ports', 'ok', f'ROS domain {domain}: UDP ports {listened[0]} to {listened[-1]} are free'
    )
