# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The bridge node between a graph and an emulated Crazyflie, over UDP and by unmodified cflib."""

from collections import Counter
from contextlib import ExitStack
import signal

from bench_body import BenchBody
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from domain import free_domain
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from lta_config.schema.crazyflie_file import load_crazyflie
from lta_config.topics import load_topic_table
from lta_control.messages import from_duties
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_graph.health import HealthLevel
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.publisher_conflict import COMMAND_TOPICS
from lta_graph.ros.qos import select_profile
from lta_graph.ros.stamps import from_stamp
from lta_model.vehicle import load_vehicle
import pytest
from rcl_interfaces.msg import Log
from rcl_interfaces.srv import GetParameters
from rclpy.duration import Duration
from std_srvs.srv import SetBool, Trigger
from waiting import PATIENCE

from .peer import Peer, running

TABLE = load_topic_table()
ROTORS = load_vehicle('gtmab').rotor_names
FILE = load_crazyflie('gtmab')
NODE = 'lta_bridge.nodes.crazyflie_bridge'
DUTIES = [0.1, 0.2, 0.3, 0.4]
ARM, STOP = 'crazyflie_bridge/arm', 'crazyflie_bridge/emergency_stop'


class Pair:
    """A drone and its bridge that tests share; a test that needs fresh ones gets new ones."""

    def __init__(self):
        self.after = ExitStack()
        self.drone = self.bridge = None

    def at_rest(self):
        """Return whether the bridge runs and the drone answers, disarmed and unlocked."""
        if self.drone is None or self.bridge.poll() is not None:
            return False
        supervisor = self.drone.firmware.supervisor
        return not (supervisor.armed or supervisor.is_locked or self.drone.down.silent)

    def renew(self, *words):
        self.after.close()
        self.drone = self.after.enter_context(CrazyflieServer(Firmware(BenchBody(), drift=30e-6)))
        # The peer of these tests is no controller
        allowed = ('-p', 'allow_other_commanders:=true')
        words = ('-p', f'uri:={self.drone.uri}', '-p', 'blind:=true', *allowed, *words)
        self.bridge = self.after.enter_context(running(NODE, *words))


@pytest.fixture(scope='module')
def domain_id():
    """Return one domain for all tests of this module, since most of them share a bridge."""
    with free_domain() as domain:
        yield domain


@pytest.fixture(scope='module')
def pair(domain_id):
    made = Pair()
    with made.after:
        yield made


@pytest.fixture
def drone(pair):
    if not pair.at_rest():
        pair.renew()
    return pair.drone


@pytest.fixture
def bridge(pair, drone):
    return pair.bridge


@pytest.fixture
def peer(domain_id):
    with Peer(domain_id) as peer:
        yield peer


def offer(node, name):
    """Return a publisher of a node on a topic of the table."""
    return node.create_publisher(
        find_message_type(TABLE[name]), name, select_profile(TABLE[name], lockstep=False)
    )


def commanding(peer, motors=None):
    """Return a function that sends one command, for `until`."""
    motors = motors or peer.publisher('motors')

    def send():
        motors.publish(from_duties(peer.node.get_clock().now().to_msg(), ROTORS, DUTIES))

    return send


def safety(facts):
    fact = facts.get('crazyflie_bridge: safety')
    return '' if fact is None else fact.message


def turning(drone):
    return drone.firmware.body.duties


def fly(peer, drone, motors=None):
    """Bring the motors to turn by arming and commanding."""
    heard = []
    peer.hear('battery', heard.append)
    peer.until(lambda: heard)
    send = commanding(peer, motors)
    assert turning(drone) == (0.0,) * 4
    peer.arm()

    def flown():
        send()
        return turning(drone) == pytest.approx(DUTIES, abs=1e-3)

    peer.until(flown)
    return send


def test_sensors_come_in_our_units_on_our_clock(peer, drone, bridge):
    late, seen = [], {}

    def on_imu(message):
        now = peer.node.get_clock().now().nanoseconds
        late.append(1e-6 * (now - from_stamp(message.header.stamp)))
        seen['imu'] = message

    peer.hear('imu', on_imu)
    for name in ('range', 'pressure', 'battery'):
        peer.hear(name, lambda message, name=name: seen.__setitem__(name, message))
    peer.until(lambda: len(late) > 100 and len(seen) == 4)
    assert seen['imu'].linear_acceleration.z == pytest.approx(9.80665)
    assert seen['range'].range == pytest.approx(0.45, abs=2e-3)  # 1 mm of noise
    assert seen['pressure'].fluid_pressure == pytest.approx(101325.0)
    assert seen['battery'].voltage == pytest.approx(4.0)
    # On our clock, not on the drone's. How late it is, is the machine's: see docs/hardware.md.
    assert 0.0 < min(late) < 1000.0
    values = drone.firmware.parameters.values
    assert {name: values[name] for name in FILE.expected} == {
        name: want.value for name, want in FILE.expected.items()
    }


def test_motors_turn_only_armed_and_ramp_down_when_commands_stop(peer, drone, bridge, hear):
    heard, logged = [], []
    peer.node.create_subscription(Log, '/rosout', logged.append, 100)
    peer.hear('battery', heard.append)
    peer.until(lambda: heard)
    send = commanding(peer)
    for _ in range(20):  # commands alone turn nothing
        send()
        peer.until(lambda: True)
    assert turning(drone) == (0.0,) * 4
    fly(peer, drone)
    peer.until(lambda: turning(drone) == (0.0,) * 4)
    hear(lambda facts: 'disarmed: the newest command' in safety(facts))
    assert not drone.firmware.supervisor.armed
    assert not drone.firmware.supervisor.is_locked
    # The landing is shorter than the time between two reports
    for level, words in (
        (Log.WARN, 'safety: landing: the newest command is '),
        (Log.INFO, 'safety: OK again, disarmed: the newest command is '),
    ):
        peer.until(
            lambda level=level, words=words: any(
                each.level == level and each.msg.startswith(words) for each in logged
            )
        )


def test_it_arms_once_the_nodes_hear_each_other(peer, drone, bridge):
    """A node beside it says that its light has found no reader yet, and there is one."""
    heard = []
    peer.hear('battery', heard.append)
    peer.hear('light/estimate', heard.append)
    beside = peer.publisher('/diagnostics')
    peer.until(lambda: heard)
    said = {'readers': '0', 'times': 0}

    def tell():
        said['times'] += 1
        links = [KeyValue(key='light/estimate', value=said['readers'])]
        status = DiagnosticStatus(name='demodulator: links', hardware_id='lta1', values=links)
        beside.publish(DiagnosticArray(status=[status]))

    peer.node.create_timer(0.05, tell)
    # A message is processed once it is acknowledged and a later service call is answered.
    peer.until(lambda: said['times'] and beside.wait_for_all_acked(Duration()))
    for _ in range(2):
        peer.ask(GetParameters, 'crazyflie_bridge/get_parameters', names=['uri'])
    client = peer.node.create_client(SetBool, ARM)
    peer.until(client.service_is_ready)
    armed = client.call_async(SetBool.Request(data=True))
    before = said['times']
    peer.until(lambda: said['times'] > before + 20)
    assert not armed.done()
    said['readers'] = '1'
    peer.until(armed.done)
    assert armed.result().success
    assert peer.ask(SetBool, ARM, data=False).success


def test_a_silent_drone_is_let_down_and_found_again(peer, drone, bridge, hear):
    fly(peer, drone)
    drone.down.silent = True
    hear(lambda facts: 'sent nothing' in safety(facts) or 'no link' in safety(facts))
    peer.until(lambda: turning(drone) == (0.0,) * 4)
    drone.down.silent = False
    fly(peer, drone)
    peer.until(lambda: not drone.firmware.supervisor.armed)  # for want of commands


def test_unknown_commanders_are_an_error_that_ends_the_flight(peer, pair, hear):
    """On any topic that moves the drone, by a stranger or a second controller, until they go."""
    pair.renew('-p', 'allow_other_commanders:=false')
    motors = offer(peer.beside('controller'), 'motors')
    send = fly(peer, pair.drone, motors)
    stranger, named = peer.beside('stranger'), []

    def status(facts, level, word):
        fact = facts.get('crazyflie_bridge: commanders')
        return fact is not None and fact.level == level and word in fact.message

    def landed(facts):
        send()
        return 'unknown nodes command the drone: /lta1/stranger (teleop/held)' in safety(facts)

    rivals = [(stranger, name) for name in reversed(COMMAND_TOPICS)]
    rivals.append((peer.beside('controller'), 'motors'))
    for node, name in rivals:
        rival = offer(node, name)
        who = f'/lta1/{node.get_name()} ({name})'
        hear(lambda facts, who=who: (send(), status(facts, HealthLevel.ERROR, who))[1])
        named.append(name)
        if len(named) == 1:
            hear(landed)
            peer.until(lambda: not any(turning(pair.drone)))
        refused = peer.ask(SetBool, ARM, data=True)
        assert not refused.success
        assert f'{who}: stop them, or allow them' in refused.message
        assert peer.ask(SetBool, ARM, data=False).success
        node.destroy_publisher(rival)
        hear(lambda facts: status(facts, HealthLevel.OK, 'only the nodes of the flight'))
    peer.arm()
    stop = peer.beside('bystander').create_client(Trigger, STOP)  # of anybody
    peer.until(stop.service_is_ready)
    stop.call_async(Trigger.Request())
    peer.until(lambda: pair.drone.firmware.supervisor.is_locked)


def test_simulated_time_is_refused_by_hardware(peer, bridge):
    answer = peer.set('crazyflie_bridge', 'use_sim_time', True)
    assert (answer.successful, 'wall clock' in answer.reason) == (False, True)
    assert peer.set('crazyflie_bridge', 'use_sim_time', False).successful
    assert bridge.poll() is None


def test_a_subscription_by_the_defaults_of_ros_gets_the_sensors(peer, bridge):
    heard = Counter()
    for name in ('imu', 'range', 'pressure'):
        kind = find_message_type(TABLE[name])
        peer.node.create_subscription(kind, name, lambda _, name=name: heard.update([name]), 10)
    peer.until(lambda: len(heard) == 3)


def test_leaving_in_flight_comes_down_and_disarms(peer, drone, bridge):
    fly(peer, drone)
    bridge.send_signal(signal.SIGINT)
    _, text = bridge.communicate(timeout=PATIENCE)
    assert bridge.returncode == 0, text
    assert turning(drone) == (0.0,) * 4
    assert not drone.firmware.supervisor.armed
    assert not drone.firmware.supervisor.is_locked


def test_an_emergency_stop_locks_and_is_not_flown_out_of(peer, drone, bridge):
    send = fly(peer, drone)
    assert peer.ask(Trigger, STOP).success
    peer.until(lambda: drone.firmware.supervisor.is_locked and not any(turning(drone)))
    send()
    assert turning(drone) == (0.0,) * 4
    refused = peer.ask(SetBool, ARM, data=True)
    assert not refused.success
    assert 'emergency stop' in refused.message


def test_while_it_lands_to_be_deactivated_an_emergency_stop_is_heeded_at_once(peer, drone, bridge):
    """The landing is a callback, until 1 s after the motors: a stop must not wait for its end."""
    fly(peer, drone)
    change = peer.node.create_client(ChangeState, 'crazyflie_bridge/change_state')
    peer.until(change.service_is_ready)
    wanted = Transition(id=Transition.TRANSITION_DEACTIVATE)
    deactivated = change.call_async(ChangeState.Request(transition=wanted))
    peer.until(lambda: turning(drone) != pytest.approx(DUTIES, abs=1e-3))  # the ramp has begun
    assert peer.ask(Trigger, STOP).success
    peer.until(lambda: drone.firmware.supervisor.is_locked)
    assert not deactivated.done()
    peer.until(deactivated.done)
    assert deactivated.result().success


@pytest.mark.long
def test_the_shutdown_transition_comes_down_and_disarms(peer, drone, bridge):
    fly(peer, drone)
    wanted = Transition(id=Transition.TRANSITION_ACTIVE_SHUTDOWN)
    assert peer.ask(ChangeState, 'crazyflie_bridge/change_state', transition=wanted).success
    assert turning(drone) == (0.0,) * 4
    assert not drone.firmware.supervisor.armed
    assert not drone.firmware.supervisor.is_locked
    bridge.send_signal(signal.SIGINT)  # after a shutdown no other test can use it
    bridge.communicate(timeout=PATIENCE)
