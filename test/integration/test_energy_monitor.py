# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The energy monitor as a process over DDS, fed as the simulator feeds it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from geometry_msgs.msg import Point, Pose, PoseWithCovariance
from lta_config.files import find_file
from lta_graph.health import HealthLevel
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.stamps import from_stamp, to_stamp
import pytest
from sensor_msgs.msg import BatteryState

from .peer import ended, Peer, start, TABLE

INPUTS = ('battery', 'panel', 'illuminance', 'odom', 'airspeed')
OUTPUTS = ('energy/battery', 'energy/status', 'energy/reserve')
RESTING = 3.84  # V; half full
RESISTANCE = 0.15  # ohm, of the shipped vehicle
GIVEN = 0.85 * (0.44 - 0.022)  # W, of its charger from 0.44 W of the panel
STEPS = 10  # messages of odom and of airspeed between two of the battery


class Vehicle(Peer):
    """The other side of the graph: publishes the meters and collects the answers."""

    def __init__(self, domain_id: int, *, lockstep: bool) -> None:
        super().__init__(domain_id, lockstep=lockstep)
        self.lockstep = lockstep
        self.answers: dict[str, list[Any]] = {name: [] for name in OUTPUTS}
        self._steps = 0
        for name, got in self.answers.items():
            self.hear(name, got.append)
        self.hear_facts()

    def connect(self) -> None:
        """Wait until whatever is sent is heard, and is answered."""
        for name in INPUTS:
            self.publisher(name)
        self.until(lambda: all(map(self.node.count_publishers, OUTPUTS)))

    def send(self, name: str, turn: int, **fields) -> None:
        message = find_message_type(TABLE[name])(**fields)
        message.header.frame_id = 'base_link'
        message.header.stamp = to_stamp(TABLE.start_ns + turn * TABLE[name].period_ns)
        self.publisher(name).publish(message)

    def turn(self, turn: int, current: float) -> None:
        """Publish one turn of all meters and wait for its three answers."""
        self.send('panel', turn, voltage=4.4, current=0.1)
        self.send('illuminance', turn, illuminance=40000.0)
        self.send('battery', turn, voltage=RESTING + RESISTANCE * current, current=current)
        self.move(turn)
        self.until(lambda: all(len(got) == turn + 1 for got in self.answers.values()))

    def move(self, turn: int) -> None:
        """Publish what the estimator says up to a turn of the meters: 3 m and 4 m from home."""
        for step in range(self._steps, STEPS * turn + 1):
            pose = PoseWithCovariance(pose=Pose(position=Point(x=3.0, y=4.0, z=0.5)))
            self.send('odom', step, pose=pose)
            self.send('airspeed', step)
        self._steps = STEPS * turn + 1

    def until_level(self, task: str, level: HealthLevel) -> str:
        """Wait until a task of the monitor is of a level, and return its words."""
        name = f'energy_monitor: {task}'
        self.until(lambda: name in self.facts and self.facts[name].level == level)
        return self.told(name)


@contextmanager
def graph(domain_id: int, mode: str, *arguments: str) -> Iterator[Vehicle]:
    """Run the node beside a vehicle; the node must leave in order when interrupted."""
    process = start('lta_energy.nodes.energy_monitor', '-p', f'time:={mode}', *arguments)
    with Vehicle(domain_id, lockstep=mode == 'lockstep') as vehicle:
        vehicle.connect()
        yield vehicle
    ended(process)


@pytest.fixture
def vehicle(mode: str, domain_id: int) -> Iterator[Vehicle]:
    with graph(domain_id, mode) as vehicle:
        yield vehicle


either_mode = pytest.mark.parametrize('mode', ['realtime', 'lockstep'])
# What these tests check does not depend on the mode: realtime is for the long run only.
mostly_lockstep = pytest.mark.parametrize(
    'mode', ['lockstep', pytest.param('realtime', marks=pytest.mark.long)]
)


def read_status(message: Any) -> dict[str, Any]:
    """Return the fields of an EnergyStatus."""
    return {name: getattr(message, name) for name in message.get_fields_and_field_types()}


@either_mode
def test_every_turn_is_answered_with_its_stamp_and_counted(vehicle: Vehicle) -> None:
    turns = 30
    for turn in range(turns):
        vehicle.turn(turn, -0.45)
    stamps = [TABLE.start_ns + turn * TABLE['battery'].period_ns for turn in range(turns)]
    for name in ('energy/battery', 'energy/status'):
        assert [from_stamp(item.header.stamp) for item in vehicle.answers[name]] == stamps
    assert [item.data for item in vehicle.answers['energy/reserve']] == [False] * turns

    cell = vehicle.answers['energy/battery'][-1]
    books = read_status(vehicle.answers['energy/status'][-1])
    deviation = books['state_of_charge_sigma']
    assert 0.0 < deviation < 0.1
    assert cell.percentage == pytest.approx(0.5, abs=2 * deviation)
    assert cell.charge == pytest.approx(0.25 * cell.percentage, rel=1e-6)
    assert cell.current == pytest.approx(-0.45)
    assert cell.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
    assert cell.power_supply_technology == BatteryState.POWER_SUPPLY_TECHNOLOGY_LIPO
    assert cell.temperature != cell.temperature
    assert cell.header.frame_id == 'base_link'

    volts = RESTING - RESISTANCE * 0.45
    assert books['power_in'] == pytest.approx(0.44)
    assert books['power_out'] == pytest.approx(GIVEN + 0.45 * volts)
    assert books['power_net'] == pytest.approx(-0.45 * volts)
    # In real time the first messages of the panel may be lost until DDS has matched both sides,
    # and the battery's may overtake one: half a period goes unseen.
    powers = [read_status(one)['power_in'] for one in vehicle.answers['energy/status']]
    begun = next(turn for turn, power in enumerate(powers) if power > 0.0)
    assert begun == 0 if vehicle.lockstep else begun < 10
    unseen = 1e-6 if vehicle.lockstep else 0.44 * 0.05 + 1e-6
    lit = 2.9 - 0.1 * begun
    assert books['harvested'] == pytest.approx(0.44 * lit, abs=unseen)
    assert books['consumed'] == pytest.approx(GIVEN * lit + 0.45 * volts * 2.9, abs=2 * unseen)
    assert books['illuminance'] == 40000.0
    # Half of the cell holds 900 C * 37.225 V / 20 = 1675.1 J; it rests at some 3.84 V.
    told, spread = books['time_to_empty'], books['time_to_empty_sigma']
    assert told == pytest.approx(1675.1 / (3.84 * 0.45), abs=2 * spread)
    assert books['home'] == pytest.approx(5.0)
    assert (books['meters_level'], books['meters_message']) == (0, 'readings are plausible')
    assert books['level'] == 0


def test_in_lockstep_an_answer_waits_for_every_meter(domain_id: int) -> None:
    with graph(domain_id, 'lockstep') as vehicle:
        vehicle.turn(0, -0.1)
        vehicle.send('battery', 1, voltage=3.8, current=-0.1)
        vehicle.send('panel', 1, voltage=4.4, current=0.1)
        vehicle.move(1)
        told = vehicle.until_level('inputs', HealthLevel.ERROR)
        assert 'waiting for messages on illuminance' in told
        assert len(vehicle.answers['energy/reserve']) == 1
        vehicle.send('illuminance', 1, illuminance=1.0)
        vehicle.until(lambda: len(vehicle.answers['energy/status']) == 2)


@mostly_lockstep
def test_the_reserve_can_be_moved_in_flight_but_not_out_of_range(vehicle: Vehicle) -> None:
    vehicle.turn(0, -0.05)
    assert vehicle.set('energy_monitor', 'reserve', 0.6).successful
    vehicle.turn(1, -0.05)
    assert [item.data for item in vehicle.answers['energy/reserve']] == [False, True]
    said = vehicle.until_level('battery', HealthLevel.WARN)
    assert said.startswith('energy reserve reached: ')
    assert 'reserve 60%, flight home' in said

    for name, value, word in (
        ('reserve', 1.5, 'reserve'),
        ('smoothing', -1.0, 'smoothing'),
        ('vehicle', 'other', 'read-only'),
    ):
        refusal = vehicle.set('energy_monitor', name, value)
        assert not refusal.successful
        assert word in refusal.reason
    vehicle.turn(2, -0.05)
    assert vehicle.answers['energy/reserve'][-1].data


def test_it_knows_the_cell_of_its_vehicle(domain_id: int, tmp_path: Path) -> None:
    """A file with half the capacity: the same current counts twice, and it says so."""
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    assert text.count('value: 250, unit: mA h') == 1
    path = tmp_path / 'small.yaml'
    path.write_text(text.replace('value: 250, unit: mA h', 'value: 125, unit: mA h'))
    with graph(domain_id, 'lockstep', '-p', f'vehicle:={path}') as vehicle:
        for turn in range(3):
            vehicle.turn(turn, -0.45)
        cell = vehicle.answers['energy/battery'][-1]
        assert cell.design_capacity == pytest.approx(0.125)
        assert cell.charge == pytest.approx(0.125 * cell.percentage, rel=1e-6)
