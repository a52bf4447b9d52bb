# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Unmodified cflib against the emulated Crazyflie, through the link and its keeper."""

from contextlib import nullcontext, suppress
import math
from random import Random
import re
import socket
import threading
import time
from types import SimpleNamespace

from bench_body import BenchBody
from lta_bridge.crazyflie import duties_packet
from lta_bridge.crazyflie.cflib_link import CflibLink
from lta_bridge.crazyflie.connection_manager import ConnectionManager, enforce_parameters
from lta_bridge.crazyflie.duties_packet import find_rotor_indices
from lta_bridge.crazyflie.link import LinkFailed, LinkLost, LogPacket, MalformedPacket
from lta_bridge.crazyflie.log_table import find_packet_fault, LOG_BLOCKS
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.schema.crazyflie_file import (
    ExpectedParameter,
    find_crazyflie,
    hash_airframe,
    load_crazyflie,
    REQUIRED,
)
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.parameters import APP, ARMING, AS_SOLD, select_build
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_model.vehicle import load_vehicle
import pytest
from waiting import PATIENCE, wait_until

# cflib logs to files and sockets that its daemon threads close when they please.
pytestmark = [
    pytest.mark.filterwarnings('ignore::pytest.PytestUnraisableExceptionWarning'),
    pytest.mark.usefixtures('prompt_cflib'),
]

NAMES = {block.name for block in LOG_BLOCKS}


def blocks_heard(link):
    heard = {}
    while set(heard) != NAMES:
        event = link.events.get(timeout=PATIENCE)
        if isinstance(event, LogPacket):
            heard[event.block] = event.values
    return heard


@pytest.mark.parametrize('protocol', [12, 11])
def test_cflib_connects_reads_arms_drives_and_stops(protocol, linked):
    with CrazyflieServer(Firmware(BenchBody(), protocol)) as server:
        link = linked(server)
        assert link.protocol == protocol
        assert blocks_heard(link)['imu']['acc.z'] == 1.0
        assert link.read_parameter('supervisor.landedTimeout') == 3000.0
        assert link.read_parameter('no.such') is None
        link.write_parameter('supervisor.landedTimeout', 60000, 2.0)
        assert server.firmware.parameters.values['supervisor.landedTimeout'] == 60000
        link.request_arming(True)
        wait_until(lambda: server.firmware.supervisor.armed, 'the arming')
        link.send_duties(duties_packet.pack_duties(1, (0.5, 0.25, 0.0, 0.0), 5000))
        body = server.firmware.body
        wait_until(lambda: body.duties[0] > 0.49, 'the duties', lambda: body.duties)
        link.send_emergency_stop()
        wait_until(lambda: server.firmware.supervisor.is_locked, 'the stop')
        assert body.duties == (0.0,) * 4
        link.close()


def test_what_lands_by_setpoint_and_hand_over_goes_on_when_the_link_is_closed(linked):
    """cflib parts with a thrust of zero: motors would stand at whatever height."""
    with CrazyflieServer(Firmware(BenchBody())) as server:
        link = linked(server)
        link.request_arming(True)
        commander = server.firmware.commander
        wait_until(lambda: server.firmware.supervisor.accepts_setpoints, 'the arming')
        link.send_hover_setpoint(0.3, 0.5, 1.2)
        wish = wait_until(lambda: commander.select_command(level=False).hover, 'the setpoint')
        assert wish == pytest.approx((0.3, 0.0, 0.5, 1.2), abs=1e-6)
        link.hand_over(land=True)
        wait_until(lambda: commander.select_command(level=False).land, 'the order to land')
        heard, receive = [], server.firmware.receive
        server.firmware.receive = lambda packet, now: heard.append(packet) or receive(packet, now)
        link.close()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as last:  # behind all that was sent
            last.sendto(b'\xfe\x07', ('127.0.0.1', int(server.uri.rpartition(':')[2])))
            wait_until(lambda: (15, 2, b'\x07') in heard, 'the last packet', lambda: heard)
        assert not [packet for packet in heard if packet.port in (3, 7)]
        assert commander.select_command(level=False).land


def test_no_thread_of_cflib_sends_while_its_link_is_being_closed(linked):
    """It would meet a socket that is gone, and end in a traceback."""
    with CrazyflieServer(Firmware(BenchBody())) as server:
        link = linked(server)
        drone, sent = link._drone, []
        shut = drone.link.close

        def close():
            drone.link.send_packet = sent.append
            drone.link_statistics.latency.ping()
            shut()

        drone.link.close = close
        link.close()
        assert sent == []


def test_a_driver_that_fails_in_the_middle_of_sending_ends_the_link_and_no_thread():
    """cflib then keeps its lock for ever: nothing more may be sent by this object."""
    with CrazyflieServer(Firmware(BenchBody())) as server:
        link = CflibLink(server.uri, LOG_BLOCKS, time.time_ns)
        keeper = ConnectionManager(link, load_crazyflie('gtmab').expected)
        wait_until(lambda: keeper.up, 'the link', lambda: keeper.why)

        def broken(packet):
            raise AttributeError('no driver')

        link._drone.link.send_packet = broken
        link.send_emergency_stop()
        link.send_emergency_stop()
        lost = next(event for event in iter(link.events.get, None) if isinstance(event, LinkLost))
        assert 'no driver' in lost.why
        keeper.reconnect(lost.why)
        wait_until(lambda: keeper.up, 'the link again', lambda: keeper.why)
        assert keeper.close(PATIENCE)


class Failing:
    """A link whose driver raises what it likes."""

    def __init__(self):
        self.closed = 0

    def open(self, deadline):
        raise OSError('[Errno 19] No such device')

    def close(self):
        self.closed += 1
        raise OSError('gone')


def test_a_keeper_outlives_whatever_a_driver_raises():
    link = Failing()
    keeper = ConnectionManager(link, {})
    wait_until(lambda: link.closed > 1, 'a second try')
    assert not keeper.up
    assert 'No such device' in keeper.why
    assert keeper.close(PATIENCE)


class Slow:
    """A link that takes its time to open."""

    def __init__(self):
        self.opening, self.may = threading.Event(), threading.Event()

    def open(self, deadline):
        self.opening.set()
        assert self.may.wait(PATIENCE)

    def parameter(self, name):
        raise AssertionError('the drone is not ours any more')

    def close(self):
        pass


def test_a_keeper_that_leaves_while_it_connects_writes_nothing_and_says_when_it_is_done():
    link, done = Slow(), threading.Event()
    keeper = ConnectionManager(link, load_crazyflie('gtmab').expected, done.set)
    assert link.opening.wait(PATIENCE)
    assert not keeper.close(0.0)
    assert not done.is_set()
    link.may.set()
    assert done.wait(PATIENCE)
    assert (keeper.up, keeper.why) == (False, 'connecting')


def test_an_old_firmware_is_refused_by_name():
    with CrazyflieServer(Firmware(BenchBody(), protocol=7)) as server:
        link = CflibLink(server.uri, LOG_BLOCKS, time.time_ns)
        with pytest.raises(
            LinkFailed, match='protocol version 7, but must have 9 or newer: update'
        ):
            link.open(PATIENCE)


def test_nobody_there_is_said_within_the_deadline():
    with CrazyflieServer(Firmware(BenchBody())) as server:
        server.down.silent = True
        link = CflibLink(server.uri, LOG_BLOCKS, time.time_ns)
        with pytest.raises(LinkFailed, match='no Crazyflie answered at udp'):
            link.open(0.5)


@pytest.mark.parametrize('code', [7, 12])
def test_a_block_that_is_refused_is_named(code):
    with CrazyflieServer(Firmware(BenchBody())) as server:
        server.firmware.log.refuse = code
        link = CflibLink(server.uri, LOG_BLOCKS, time.time_ns)
        with pytest.raises(LinkFailed, match='refused the log block imu'):
            link.open(PATIENCE)


def test_a_closed_port_is_told_and_the_keeper_finds_the_drone_again():
    server = CrazyflieServer(Firmware(BenchBody()))
    port = int(server.uri.rpartition(':')[2])
    link = CflibLink(server.uri, LOG_BLOCKS, time.time_ns)
    keeper = ConnectionManager(link, load_crazyflie('gtmab').expected)
    with server:
        wait_until(lambda: keeper.up, 'the link', lambda: keeper.why)
    wait_until(lambda: isinstance(link.events.get(timeout=PATIENCE), LinkLost), 'the loss')
    keeper.reconnect('gone')
    with CrazyflieServer(Firmware(BenchBody()), port):
        wait_until(lambda: keeper.up, 'the link again', lambda: keeper.why)
        assert keeper.close(PATIENCE)


def test_datagrams_that_are_lost_swapped_and_doubled_do_not_keep_it_away():
    """One in two hundred lost: of some 80 replies cflib needs all, and waits for ever for one."""
    with CrazyflieServer(Firmware(BenchBody())) as server:
        server.down.drop, server.down.double, server.down.jitter = 0.005, 0.02, 0.002
        link = CflibLink(server.uri, LOG_BLOCKS, time.time_ns)

        def opened():
            with suppress(LinkFailed):
                link.open(1.0)
                return True

        wait_until(opened, 'a try of which nothing is lost')
        assert blocks_heard(link)
        link.close()


@pytest.mark.parametrize(
    ('name', 'value', 'write', 'sentence'),
    [
        ('lta.new', 1, True, r'has no parameter lta.new \(why\)'),
        ('lta.app', 4, False, r'lta.app is 3, but must be 4 \(why\)'),
        ('firmware.revision0', 2, True, r'firmware\.revision0 of the firmware is read-only'),
    ],
)
def test_a_parameter_that_cannot_be_brought_to_its_value_is_refused(
    linked, name, value, write, sentence
):
    with CrazyflieServer(Firmware(BenchBody())) as server:
        link, wanted = linked(server), ExpectedParameter(value=value, write=write, why='why')
        with pytest.raises(LinkFailed, match=sentence):
            enforce_parameters(link, {name: wanted})
        link.close()


def test_on_the_arming_build_the_connection_brings_idle_thrust_to_nothing(linked):
    """The build's motors would turn at 10.7 % as soon as it is armed."""
    with CrazyflieServer(Firmware(BenchBody(), build=ARMING)) as server:
        link, firmware = linked(server), server.firmware
        link.request_arming(True)
        turning = pytest.approx((7000 / 65535,) * 4)
        wait_until(lambda: firmware.body.duties == turning, 'the idle thrust')
        link.request_arming(False)
        wait_until(lambda: firmware.body.duties == (0.0,) * 4, 'its end')
        enforce_parameters(link, load_crazyflie('multirotor').expected, compensated=True)
        assert firmware.parameters.values['powerDist.idleThrust'] == 0
        wait_until(
            lambda: link.request_arming(True) or firmware.supervisor.accepts_setpoints,
            'the arming',
        )
        assert firmware.body.duties == (0.0,) * 4
        link.close()


def test_what_every_drone_must_meet_is_written_to_it(linked):
    other = {'motorPowerSet.enable': 4, 'powerDist.idleThrust': 7000,
             'supervisor.landedTimeout': 60000, 'supervisor.tmblChckEn': 0}  # fmt: skip
    assert other.keys() == REQUIRED.keys()
    with CrazyflieServer(Firmware(BenchBody())) as server:
        server.firmware.parameters.values.update(other, **{'stabilizer.controller': 1})
        link = linked(server)
        enforce_parameters(link, load_crazyflie('gtmab').expected, compensated=False)
        values = server.firmware.parameters.values
        assert {name: values[name] for name in other} == {
            name: want.value for name, want in REQUIRED.items()
        }
        assert values['stabilizer.controller'] == 6
        link.close()


@pytest.mark.parametrize(
    ('build', 'version', 'sentence'),
    [
        (
            AS_SOLD,
            None,
            r'has no parameter lta\.app \(.*flash the current firmware/crazyflie',
        ),
        (APP, 1, r'lta\.app is 1, but must be 3 \(.*flash the current firmware/crazyflie'),
    ],
)
def test_without_the_present_app_a_blimp_is_refused_with_what_turns_motors_switched_off(
    build, version, sentence, linked
):
    """A bench that died may have left the override on; nothing else is written."""
    with CrazyflieServer(Firmware(BenchBody(), build=build)) as server:
        values = server.firmware.parameters.values
        values['supervisor.landedTimeout'] = 60000
        values['motorPowerSet.enable'], values['powerDist.idleThrust'] = 1, 7000
        if version is not None:
            values['lta.app'] = version
        link = linked(server)
        with pytest.raises(LinkFailed, match=sentence):
            enforce_parameters(link, load_crazyflie('gtmab').expected, compensated=False)
        assert values['supervisor.landedTimeout'] == 60000
        assert (values['motorPowerSet.enable'], values['powerDist.idleThrust']) == (0, 0)
        link.close()


@pytest.mark.parametrize(
    ('build', 'sentence'),
    [
        (APP, ''),
        (AS_SOLD, ''),  # has no vehicle to compare
        (APP._replace(airframe=0xABC), 'for another vehicle or wiring (00000abc)'),
        (APP._replace(airframe=0), 'built for no vehicle'),
    ],
)
def test_firmware_of_another_vehicle_is_refused_and_nothing_is_written(build, sentence, linked):
    airframe = hash_airframe(load_vehicle_file('gtmab'), load_crazyflie('gtmab'))
    with CrazyflieServer(Firmware(BenchBody(), build=build)) as server:
        values = server.firmware.parameters.values
        values['supervisor.landedTimeout'] = 60000
        link = linked(server)
        refused = (
            pytest.raises(LinkFailed, match=re.escape(sentence)) if sentence else nullcontext()
        )
        with refused:
            enforce_parameters(link, REQUIRED, airframe=airframe)
        assert values['supervisor.landedTimeout'] == (60000 if sentence else 3000)
        link.close()


@pytest.mark.parametrize(
    ('build', 'counted_on', 'sentence'),
    [
        (APP, False, ''),
        (APP._replace(compensated=True), True, ''),
        (AS_SOLD, True, ''),
        (AS_SOLD, None, ''),
        (AS_SOLD, False, 'not have the effect battery_compensation: flash the firmware of'),
        (
            APP._replace(compensated=True),
            False,
            'corrects motor duties for the battery voltage, but',
        ),
        (APP, True, 'has the effect battery_compensation: flash stock firmware, or remove'),
    ],
)
def test_firmware_and_vehicle_agree_on_the_correction_for_the_battery(
    build, counted_on, sentence, linked
):
    with CrazyflieServer(Firmware(BenchBody(), build=build)) as server:
        link = linked(server)
        with pytest.raises(LinkFailed, match=sentence) if sentence else nullcontext():
            enforce_parameters(link, {}, counted_on)
        link.close()


@pytest.mark.parametrize('name', ['gtmab', 'multirotor'])
def test_the_shipped_vehicles_and_the_builds_they_fly_with_agree(name):
    build = select_build(load_crazyflie(name).command)
    assert load_vehicle(name).battery_compensated == build.compensated


def file_with(tmp_path, parameter):
    text, path = find_file('crazyflie', 'gtmab').read_text(), tmp_path / 'gtmab.yaml'
    path.write_text(text.replace('parameters:', f'parameters:\n  {parameter}'))
    return str(path)


def test_a_file_that_sets_a_required_parameter_otherwise_is_one_sentence(tmp_path):
    mine = file_with(tmp_path, 'supervisor.landedTimeout: {value: 60000, write: true, why: mine}')
    with pytest.raises(BadInput) as refused:
        load_crazyflie(mine, 'gtmab')
    assert (
        'sets the firmware parameter supervisor.landedTimeout to 60000, but it must be 3000 on '
        'every drone (with a longer timeout, a landed drone stays armed unattended); remove that '
        'line'
    ) in str(refused.value)


def test_a_file_may_name_a_required_parameter_with_its_value(tmp_path):
    same = file_with(tmp_path, 'powerDist.idleThrust: {value: 0, write: false, why: mine}')
    assert load_crazyflie(same, 'gtmab').expected['powerDist.idleThrust'].write


def test_a_uri_that_cflib_knows_is_taken():
    for uri in (
        'radio://0/80/2M/E7E7E7E7E7', 'radio://0/80', 'radio://ABCDEF0123/80/250K/E7?rate_limit=100',
        'usb://0', 'udp://127.0.0.1:19850', 'tcp://drone:5000', 'serial://ttyACM0',
    ):  # fmt: skip
        CflibLink(uri, (), time.time_ns)


def test_every_shipped_file_is_wired_to_rotors_that_exist():
    for name in ('gtmab', 'multirotor'):
        assert (
            len(find_rotor_indices(load_crazyflie(name).motors, load_vehicle(name).rotor_names))
            == 4
        )
    with pytest.raises(
        BadInput, match='is for the vehicle multirotor, but gtmab is to fly; give the'
    ):
        load_crazyflie('multirotor', 'gtmab')
    with pytest.raises(
        BadInput, match='assigns motor m1 to the rotor up, which the vehicle does not have'
    ):
        find_rotor_indices({'m1': 'up'}, ['left'])


def test_a_vehicle_of_ones_own_has_its_crazyflie_file_beside_it(tmp_path):
    mine = tmp_path / 'my_blimp.yaml'
    mine.write_text('name: my_blimp')
    with pytest.raises(BadInput, match=r'my_blimp has no Crazyflie file.*create my_blimp\.crazyf'):
        find_crazyflie(str(mine), 'my_blimp')
    shipped = find_file('crazyflie', 'gtmab').read_text()
    (tmp_path / 'my_blimp.crazyflie.yaml').write_text(shipped)
    with pytest.raises(BadInput, match='is for the vehicle gtmab, but my_blimp is to fly'):
        find_crazyflie(str(mine), 'my_blimp')
    own = shipped.replace('vehicle: gtmab', 'vehicle: my_blimp')
    (tmp_path / 'my_blimp.crazyflie.yaml').write_text(own)
    assert find_crazyflie(str(mine), 'my_blimp').motors == load_crazyflie('gtmab').motors
    # A copy of a shipped vehicle elsewhere, by its name.
    assert find_crazyflie(str(mine), 'gtmab', 'gtmab') == load_crazyflie('gtmab')


TORN = (
    b'\x52', b'\x52\x63\0\0\0', b'\x52\x01\0\0\0\0', b'\x51\x06', b'\x00noise', b'\xf2',
    b'\x92\x8c',
)  # fmt: skip
LONG = tuple(b'\x52' + bytes([block]) + bytes(60) for block in range(1, 6))
WHOLE = {block.name: block.variables.keys() for block in LOG_BLOCKS}
BATCH = 20  # datagrams that any socket keeps


def wild(random):
    """Return any packet but one of parameters or of the log, by which a drone may end either."""
    header = random.choice([port for port in range(16) if port not in (2, 5)]) << 4
    return bytes([header | random.randrange(4)]) + random.randbytes(random.randrange(90))


def hear_out(link, count):
    """Await malformed packets on a link that goes on, and whose values are whole."""
    malformed = []

    def hear():
        event = link.events.get(timeout=PATIENCE)
        assert not isinstance(event, LinkLost)
        if isinstance(event, MalformedPacket):
            malformed.append(event)
        if isinstance(event, LogPacket):
            assert event.values.keys() == WHOLE[event.block]
            assert all(map(math.isfinite, event.values.values()))

    told = f'{count} malformed packets'
    wait_until(lambda: len(malformed) >= count, told, lambda: malformed, step=hear)


@pytest.mark.parametrize('seed', [1, 2])
def test_nonsense_from_the_drone_is_counted_and_heard_out(linked, seed):
    """Empty, torn, long and unknown packets; what cflib makes of a long one is not believed."""
    random = Random(seed)
    packets = [*TORN, *LONG, *(wild(random) for _ in range(120))]
    with CrazyflieServer(Firmware(BenchBody())) as server:
        link = linked(server)
        blocks_heard(link)
        for at in range(0, len(packets), BATCH):
            batch = packets[at : at + BATCH]
            left = sum(
                bool(find_packet_fault(one[0] >> 4, one[0] & 3, one[1:], {1: 24})) for one in batch
            )
            for one in batch:
                server.down.send(one, server.now)
            hear_out(link, left)
        assert blocks_heard(link)
        link.close()


def test_the_thread_of_a_keeper_keeps_no_process_alive():
    """Whoever leaves without closing leaves: a drone without commands comes down by itself."""
    link = SimpleNamespace(
        open=lambda deadline: None, close=lambda: None, parameter=lambda _: None
    )
    keeper = ConnectionManager(link, {})
    try:
        threads = [one for one in threading.enumerate() if one.name == 'crazyflie_link']
        assert threads
        assert all(one.daemon for one in threads)
    finally:
        assert keeper.close()


def test_an_emergency_stop_takes_an_override_off_whoever_put_it_on(linked):
    with CrazyflieServer(Firmware(BenchBody())) as server:
        link = linked(server)
        link.write_parameter('motorPowerSet.m1', 30000, 2.0)
        link.write_parameter('motorPowerSet.enable', 1, 2.0)
        body = server.firmware.body
        wait_until(lambda: body.duties[0] > 0.4, 'the duties', lambda: body.duties)
        link.send_emergency_stop()
        wait_until(lambda: body.duties == (0.0,) * 4, 'their end', lambda: body.duties)
        link.close()
