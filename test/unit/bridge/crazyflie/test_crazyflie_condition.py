# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the bridge says of its link and of its motors."""

from lta_bridge.crazyflie import readings
from lta_bridge.crazyflie.bridge_core import BridgeCore
from lta_bridge.crazyflie.drone_operation import describe_health
from lta_bridge.crazyflie.safety import SafetyInputs, SafetyStage, SafetyState
from lta_bridge.crazyflie.supervisor_word import SupervisorBit
from lta_config.schema.crazyflie_file import load_crazyflie
from lta_graph.health import HealthLevel
from lta_model.vehicle import load_vehicle

ARMED = SafetyInputs(True, True, 2, 0.0, 0.0, 4.0, 1.0, 1.0, 0.0)


def fact(task, bridge, why='', attempts=1, **changed):
    """Return a diagnostic of a bridge in normal operation, with these fields changed."""
    told = describe_health(bridge, why, attempts, 12, ARMED._replace(**changed))
    return {one.task: one for one in told}[task]


def test_what_is_said_of_the_link():
    """Half a second without a packet is silence; without a link the message gives the reason."""
    bridge = BridgeCore(None, load_crazyflie('gtmab'), load_vehicle('gtmab'))
    for silence, said in (
        (0.499, (HealthLevel.OK, 'connected')),
        (0.5, (HealthLevel.ERROR, 'no packets for 0.5 s')),
    ):
        told = fact('link', bridge, silence=silence)
        assert (told.level, told.message) == said
    gone = fact('link', bridge, 'nobody answers', 7, linked=False)
    assert (gone.level, gone.message) == (HealthLevel.ERROR, 'nobody answers')
    assert fact('link', bridge, 'connecting', 0, linked=False).level == HealthLevel.WARN
    bridge.add_round_trip(0.004)
    values = fact('link', bridge, attempts=7, silence=0.25).values
    assert values == {
        'protocol': '12', 'silence_s': '0.250', 'latency_s': '0.0040', 'one_way_s': '0.0020',
        'drift_ppm': '-0.0', 'clock_restarts': '0', 'packets': '0', 'attempts': '7',
    }  # fmt: skip


def test_what_is_said_of_the_motors():
    bridge = BridgeCore(None, load_crazyflie('gtmab'), load_vehicle('gtmab'))
    told = fact('safety', bridge)
    assert (told.level, told.message) == (HealthLevel.OK, 'disarmed: not armed yet')
    assert told.values == {'word': '2', 'command': 'motors', 'voltage': '4.00', 'motors': ''}
    bridge.motors = readings.MotorsReading((0.5, 0.25, 0.0, 1.0), 2)
    bridge.state = SafetyState(SafetyStage.FLYING, why='')
    told = fact('safety', bridge)
    assert (told.level, told.message) == (HealthLevel.OK, 'flying')
    assert told.values['motors'] == '0.50 0.25 0.00 1.00'
    for why, level in (
        ('the battery has only 3.10 V', HealthLevel.WARN),
        ('on request', HealthLevel.OK),
        ('deactivated', HealthLevel.OK),
    ):
        bridge.state = SafetyState(SafetyStage.LANDING, why=why)
        told = fact('safety', bridge)
        assert (told.level, told.message) == (level, f'landing: {why}')
    bridge.state = SafetyState(SafetyStage.DISARMED, why='it has tipped over')
    for bit in (SupervisorBit.TUMBLED, SupervisorBit.LOCKED, SupervisorBit.CRASHED):
        assert fact('safety', bridge, word=int(bit)).level == HealthLevel.ERROR
    bridge.state = SafetyState(SafetyStage.STOPPED, why='emergency stop')
    told = fact('safety', bridge)
    assert (told.level, told.message) == (HealthLevel.ERROR, 'stopped: emergency stop')
