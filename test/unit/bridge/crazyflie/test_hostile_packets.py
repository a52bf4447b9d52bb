# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whatever a drone, or who speaks in its name, sends: it is counted, and no motor turns by it."""

import math

from hypothesis import given, settings
from hypothesis import strategies as st
from lta_bridge.crazyflie.bridge_core import BridgeCore, CrazyflieCommand, UNTOLD
from lta_bridge.crazyflie.device_clock import parse_ping_time
from lta_bridge.crazyflie.drone_operation import describe_health
from lta_bridge.crazyflie.duties_packet import unpack_duties
from lta_bridge.crazyflie.link import LogPacket
from lta_bridge.crazyflie.log_table import (
    block_size,
    find_packet_fault,
    LARGEST_PAYLOAD,
    LOG_BLOCKS,
    STAMPED,
)
from lta_bridge.crazyflie.messages import CrazyfliePowerModel, from_reading
from lta_bridge.crazyflie.safety import LOW_VOLTAGE_TIME, SafetyStage
from lta_bridge.crazyflie.safety import SafetyRequest as AskedBy
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_model.vehicle import load_vehicle
import pytest
from rclpy.serialization import serialize_message

from .bridged import FILE, Kept, NOTHING, TICK

VEHICLE = load_vehicle('gtmab')
CONSUMPTION = CrazyfliePowerModel.from_energy(VEHICLE.file.energy)
BEGIN = 10**18  # ns
GOOD = {
    'imu': {f'{s}.{a}': 0.0 for s in ('acc', 'gyro') for a in 'xyz'},
    'air': {'baro.pressure': 1013.25, 'range.zrange': 450},
    'attitude': {f'stateEstimate.{a}': 0.0 for a in ('roll', 'pitch', 'yaw')},
    'motors': {f'motor.m{n}': 0 for n in range(1, 5)}
    | {'supervisor.info': int(SupervisorBit.ARMED)},
    'power': {'pm.vbat': 4.0, 'pm.state': 0},
}
EXTREME = {  # of the types that the wire has
    'float': st.floats(width=32),
    'uint8_t': st.integers(0, 2**8 - 1),
    'int8_t': st.integers(-(2**7), 2**7 - 1),
    'uint16_t': st.integers(0, 2**16 - 1),
    'uint32_t': st.integers(0, 2**32 - 1),
}


class Flight:
    """A bridge by duties, and a clock of its own."""

    def __init__(self):
        self.kept, self.now = Kept(), BEGIN
        self.bridge = BridgeCore(self.kept, FILE, VEHICLE, 'motors', blind=True)

    def told(self, block, values, stamp_ms=None):
        ms = (self.now - BEGIN) // 1_000_000 if stamp_ms is None else stamp_ms
        return self.bridge.receive_packet(LogPacket(block, ms % 2**24, values, self.now))

    def tick(self, asked=NOTHING, spoilt=(), good=GOOD):
        self.now += TICK
        for block, values in good.items():
            self.told(block, values)
        for packet in spoilt:
            published(self.told(*packet), self.bridge)
        self.bridge.accept_command(CrazyflieCommand(self.now, duties=(0.1, 0.2, 0.3, 0.4)))
        self.bridge.tick(1e-9 * self.now, self.now, True, True, asked)

    @property
    def facts(self):
        seen = self.bridge.collect_safety_inputs(self.now, True, True)
        return {fact.task: fact for fact in describe_health(self.bridge, '', 0, 12, seen)}

    @property
    def duties(self):
        packets = [unpack_duties(data) for (data,) in self.kept.of('send_duties')]
        return [duty for packet in packets for duty in packet.duties]


def published(told, bridge):
    """Make the messages of a reading, as the node does, down to their bytes."""
    for message in from_reading(told, bridge, CONSUMPTION).values():
        assert serialize_message(message)


def flying():
    flight = Flight()
    flight.tick()
    flight.tick(AskedBy(arm=True))
    for _ in range(3):
        flight.tick()
    assert flight.bridge.state.stage is SafetyStage.FLYING
    return flight


def of_block(block):
    """Return any packet of a block: whole, with values of its types, or with others."""
    values = {name: EXTREME[kind] for name, kind in block.variables.items()}
    whole, other = st.fixed_dictionaries(values), st.dictionaries(st.text(max_size=3), st.floats())
    some = whole.map(lambda one: dict(list(one.items())[1:]))
    stamps = st.integers(0, 2**24 - 1)
    return st.tuples(st.just(block.name), st.one_of(whole, some, other), stamps)


hostile = st.one_of(*map(of_block, LOG_BLOCKS), st.tuples(st.text(), st.just({}), st.just(0)))


@given(st.lists(hostile, max_size=30))
@settings(max_examples=25)
def test_any_log_packets_are_survived_and_no_duty_leaves_its_range(packets):
    flight = flying()
    for packet in packets:
        flight.tick(spoilt=[packet])
    assert all(-1.0 <= duty <= 1.0 for duty in flight.duties)
    assert flight.facts['packets'].values['count'] == str(flight.bridge.malformed.count)
    # The drone is well again, or it has come down; it does not fly on by what nobody measured.
    for _ in range(600):
        flight.tick()
    assert flight.bridge.state.stage in (SafetyStage.FLYING, SafetyStage.DISARMED)


@given(hostile)
def test_what_is_no_measurement_is_left_out_and_counted(packet):
    flight = Flight()
    block, values, _ = packet
    told = flight.told(*packet)
    usable = block in GOOD and values.keys() == GOOD[block].keys()
    usable = usable and all(map(math.isfinite, values.values()))
    if not usable:
        assert told.reading is None
        assert flight.bridge.malformed.count == 1
        assert flight.facts['packets'].level > 0
    assert told.stamp_ns <= flight.now


def test_a_voltage_that_is_no_number_is_not_flown_with_for_long():
    flight = flying()
    began = flight.now
    bad = GOOD | {'power': {'pm.vbat': math.nan, 'pm.state': 0}}
    while flight.bridge.state.stage is SafetyStage.FLYING:
        flight.tick(good=bad)
    assert 1e-9 * (flight.now - began) < UNTOLD + LOW_VOLTAGE_TIME + 0.1
    assert 'the battery voltage is no longer reported' in flight.bridge.state.why
    assert flight.bridge.malformed.count > 100


@given(
    st.lists(st.one_of(st.floats(), st.floats(-2.0, 2.0)), max_size=6),
    st.integers(-(2**62), 2**62),
)
def test_any_command_is_clipped_or_counted(duties, stamp):
    flight = flying()
    before = flight.bridge.unasked.count
    flight.bridge.accept_command(CrazyflieCommand(stamp, duties=tuple(duties)))
    fits = len(duties) == 4 and all(map(math.isfinite, duties))
    assert flight.bridge.unasked.count - before == (not fits)
    flight.bridge.tick(1e-9 * flight.now, flight.now, True, True, AskedBy())
    assert all(-1.0 <= duty <= 1.0 for duty in flight.duties)


SIZES = {number: block_size(block) for number, block in enumerate(LOG_BLOCKS, start=1)}


@given(st.integers(0, 15), st.integers(0, 3), st.binary(max_size=64))
def test_any_packet_is_judged_in_words(port, channel, data):
    why = find_packet_fault(port, channel, data, SIZES)
    assert isinstance(why, str)
    if len(data) > LARGEST_PAYLOAD or port in (1, 3, 7, 10, 11, 12, 14):
        assert why


@given(st.sampled_from(sorted(SIZES)), st.integers(0, 26))
def test_a_log_packet_has_the_size_of_its_block_and_no_other(number, size):
    data = bytes([number]) + bytes(STAMPED - 1 + size)
    assert (find_packet_fault(5, 2, data, SIZES) == '') == (size == SIZES[number])
    assert (
        find_packet_fault(5, 2, bytes([99]) + data[1:], SIZES)
        == 'packet of log block 99, which was not requested'
    )
    assert find_packet_fault(5, 2, data, {}) == ''  # of an earlier connection


@pytest.mark.parametrize(
    ('port', 'fewest'),
    [
        (0, (0,)),  # console
        (2, (1, 2, 2, 1)),  # parameters
        (4, (1, 1, 1)),  # memory
        (5, (1, 3)),  # log: table of contents, settings
        (6, (None, 1)),  # localization: generic
        (8, (1,)),  # high-level commander
        (9, (1, 1)),  # supervisor
        (13, (1, 1, 0)),  # platform: command, version, app
        (15, (0, 0, 0, 0)),  # link
    ],
)
def test_a_drone_speaks_on_its_own_ports_and_says_enough(port, fewest):
    """crtp.h and the handlers of the firmware: what is shorter would end in cflib's log."""
    for channel in range(4):
        least = fewest[channel] if channel < len(fewest) else None
        for size in range(LARGEST_PAYLOAD + 2):
            fits = least is not None and least <= size <= 30
            if (port, channel) != (5, 2):
                assert (find_packet_fault(port, channel, bytes(size), SIZES) == '') == fits


@given(st.binary(max_size=31))
def test_any_echo_is_a_ping_or_none(data):
    sent = parse_ping_time(data)
    assert sent is None or len(data) == 9
