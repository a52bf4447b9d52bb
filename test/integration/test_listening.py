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

from lta_graph.health import find_role
from ports import free_port, UDP
import pytest
from waiting import PATIENCE

from .command import processes, ROOT

TABLES = ('udp', 'udp6', 'tcp', 'tcp6')
BOUND = ('07', '0A')  # states of /proc/net: UDP that is bound, TCP that listens
CHOSEN = ('ROS_AUTOMATIC_DISCOVERY_RANGE', 'FASTRTPS_DEFAULT_PROFILES_FILE')
VISITOR = """
import sys, time
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import GetParameters
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Imu
rclpy.init()
node = rclpy.create_node('visitor')
heard = set()
node.create_subscription(Imu, '/lta1/imu', lambda _: heard.add('imu'), qos_profile_sensor_data)
node.create_subscription(DiagnosticArray, '/diagnostics', lambda _: heard.add('health'), 10)
client = node.create_client(GetParameters, '/lta1/estimator/get_parameters')
client.wait_for_service(100.0)
answer = client.call_async(GetParameters.Request(names=['time']))
deadline = time.monotonic() + 100.0
while not (len(heard) == 2 and answer.done()) and time.monotonic() < deadline:
    rclpy.spin_once(node, timeout_sec=0.1)
print(*sorted(heard), answer.done() and answer.result().values[0].string_value)
"""
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


def is_loopback(address: str) -> bool:
    """Return whether only this machine reaches an address."""
    return ipaddress.ip_address(address).is_loopback


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


@pytest.mark.long  # the test below has the same of one node
def test_the_graph_listens_on_the_loopback_alone_and_plain_ros_finds_it(lta, hear, tmp_path):
    """Drone, light board, live view and nodes; then who has Fast DDS's own settings looks on."""
    ports = (
        f'port:={free_port(UDP)}',
        f'light_port:={tmp_path}/board',
        f'live_port:={free_port()}',
    )
    graph = lta.start('launch', 'emulated', *ports, 'record:=false', 'live:=true')
    nodes = {'crazyflie_bridge', 'teensy_bridge', 'estimator', 'demodulator', 'navigator', 'live'}
    hear(lambda facts: nodes <= {find_role(task.partition(':')[0]) for task in facts})
    found = {line: sockets(pid) for pid, line in processes(lta.mark).items()}
    assert sum(bool(addresses) for addresses in found.values()) > len(nodes)
    assert {line: told for line, told in found.items() if not all(map(is_loopback, told))} == {}
    assert [line for pid, line in processes(lta.mark).items() if shared(pid)] == []

    plain = {name: value for name, value in os.environ.items() if name not in CHOSEN}
    visitors = [
        subprocess.Popen(
            [sys.executable, '-c', VISITOR], env=plain | chosen, stdout=subprocess.PIPE, text=True
        )
        for chosen in ({}, {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'})
    ]
    told = [visitor.communicate(timeout=PATIENCE)[0].split() for visitor in visitors]
    assert told == [['health', 'imu', 'realtime']] * 2
    graph.interrupt()
    graph.end()


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


@pytest.mark.long  # test_reach.py has the same of the environment alone
def test_a_flight_that_the_network_reaches_says_so_once(lta, scenario, tmp_path):
    words = ('fly', '--no-page', '--processes', 'one', '--scenario', scenario(time_limit='1 s'))
    flight = lta.start(*words, '--out', tmp_path / 'out', ROS_AUTOMATIC_DISCOVERY_RANGE='SUBNET')
    assert flight.end() == 1
    assert flight.text.count('anyone on the network can command the drone') == 1
