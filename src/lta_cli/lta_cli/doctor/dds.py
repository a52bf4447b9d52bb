"""Can nodes talk: one conversation between two processes over DDS, and the ports of the domain."""

import json
import os
import socket
import subprocess
import sys
import time

from lta_bridge.hardware.check_result import HardwareCheck

DEADLINE = 10.0  # s for everything; two processes start and find each other in about 1 s
SLOW = 3.0  # s; discovery that takes this long makes a launch look stuck
PARTICIPANTS = 8  # a graph of seven nodes and one more
FIREWALL = (
    'Let UDP through between processes of this machine (firewall, container network) and see'
    " that the interface 'lo' is up."
)

FAULT = 'A process could not join the graph at all; its own sentence says what to mend.'


def domain_ports(domain: int) -> list[int]:
    """
    Return the UDP ports on which the participants of a domain listen, on one machine.

    7400 + 250 d is the multicast port of discovery, 7410 + 250 d + 2 i and 7411 + 250 d + 2 i
    the unicast ports of participant i (DDSI-RTPS 2.3, section 9.6.1.1).
    """
    base = 7400 + 250 * domain
    return [base + 10 + offset for offset in range(2 * PARTICIPANTS)]


def find_busy_ports(ports: list[int]) -> list[int]:
    """Return those ports that somebody listens on."""
    busy = []
    for port in ports:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(('', port))
            except OSError:
                busy.append(port)
    return busy


def find_free_domain() -> int:
    """Return a domain in which nobody listens (above 101 the ports meet Linux's own)."""
    return next(
        domain for domain in range(101, 0, -1) if not find_busy_ports(domain_ports(domain))
    )


def check_conversation() -> HardwareCheck:
    """Check that two processes find each other and exchange messages, and how fast."""
    environment = {**os.environ, 'ROS_DOMAIN_ID': str(find_free_domain())}
    command = [sys.executable, '-m', 'lta_graph.ros.echo', '--seconds', str(DEADLINE - 2.0)]
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
            process.communicate()
    if asking.returncode != 0 or not output:
        lines = errors.decode(errors='replace').strip().splitlines()
        if lines:
            return HardwareCheck('dds', 'fail', lines[-1], FAULT)
        found = f'no answer from another process within {DEADLINE - 2.0:g} s'
        return HardwareCheck('dds', 'fail', found, FIREWALL)
    times = json.loads(output)
    found = (
        f'two processes found each other in {times["discovery_s"]:.1f} s, round trip'
        f' {times["round_trip_s"] * 1e6:.0f} us ({time.monotonic() - began:.1f} s in all)'
    )
    if times['discovery_s'] > SLOW:
        return HardwareCheck(
            'dds', 'warn', found, 'Discovery is slow: the machine is busy or lossy.'
        )
    return HardwareCheck('dds', 'ok', found)


def check_ports() -> HardwareCheck:
    """Check that nobody else is in the domain that a flight would use."""
    text = os.environ.get('ROS_DOMAIN_ID') or '0'
    if not text.isdecimal() or int(text) > 232:
        found = f'ROS_DOMAIN_ID is {text!r}'
        return HardwareCheck(
            'ports', 'fail', found, 'Set it to a number from 0 to 101, or unset it.'
        )
    domain = int(text)
    busy = find_busy_ports(domain_ports(domain))
    if busy:
        found = f'domain {domain}: in use on UDP port {", ".join(map(str, busy))}'
        remedy = 'Another graph runs here; end it, or fly in a domain of your own: ROS_DOMAIN_ID=7'
        return HardwareCheck('ports', 'warn', found, f'{remedy}.')
    listened = domain_ports(domain)
    return HardwareCheck(
        'ports', 'ok', f'domain {domain}: UDP {listened[0]} to {listened[-1]} are free'
    )
