# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Recorded commands, flown through a vehicle file."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from lta_config.errors import BadInput
from lta_config.parameter_override import parse_assignment
from lta_config.quantity import Quantity
from lta_flight.flight_spec import load_spec
from lta_flight.progress import FlightProgress
from lta_flight.recorded_commands import (
    fill_with_last,
    find_body_poses,
    find_velocity,
    read_commands,
)
from lta_flight.simulate import CommandRequest, simulate_once
from lta_model.effects import EFFECTS
from lta_model.measurement_chain import apply_chain, build_chains
from lta_model.state import VELOCITY
from lta_model.vehicle import load_vehicle, Vehicle
import numpy as np
import pytest
from rich.console import Console
from scipy.spatial.transform import Rotation

from ..report_flight import SPEED  # noqa: TID252 - `test` is Python's own


def fly(folder: Path, *changes: str, commands: CommandRequest | None = None) -> str:
    spec = load_spec('gtmab', 'lamp_room', 'bag', '')
    spec = spec.with_values(dict(map(parse_assignment, changes)))
    watcher = FlightProgress(Console(quiet=True))
    return simulate_once(spec, 3, folder, watcher, commands=commands)[0].sentence


@pytest.fixture(scope='module')
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp('recorded') / 'flight'
    fly(folder, 'scenario.goal.time_limit=6 s')
    return folder


def test_the_same_vehicle_repeats_the_flight(flight: Path, tmp_path: Path, call) -> None:
    # Duties and start are recorded as float64, so the integration is the same to the last bit
    said = fly(tmp_path / 'again', commands=CommandRequest(flight))
    assert '0 cm from the recording on average (RMS) and 0 cm at the end' in said
    status, output = call(
        'compare', str(flight), str(tmp_path / 'again'), '--align', 'none', '--topic',
        'ground_truth/odom', '--topic', 'motors', '--same', '--no-page', '--out',
        str(tmp_path / 'compared'),
    )  # fmt: skip
    assert status == 0, output.out


def test_a_heavier_vehicle_departs_as_its_weight_says(flight: Path, tmp_path: Path) -> None:
    # 0.5 g more weigh 4.9 mN; against 415 g and 343 g of air they give 6.5 mm/s2 downwards
    commands = read_commands(flight, load_vehicle('gtmab'), None, 3.0, 5.0)
    order = CommandRequest(flight, begin=3.0, end=5.0)
    said = fly(tmp_path / 'heavier', 'vehicle.trim.heaviness=2.5 g', commands=order)
    end = float(said.rpartition(' and ')[2].partition(' cm')[0])
    assert end == pytest.approx(0.5 * 0.65 * commands.duration**2, rel=0.35)


def test_a_part_begins_with_its_motion(flight: Path, tmp_path: Path) -> None:
    # The thrust at the begin is that of a steady command, which it is not exactly
    said = fly(tmp_path / 'part', commands=CommandRequest(flight, begin=4.0))
    assert float(said.rpartition(' and ')[2].partition(' cm')[0]) < 0.5


MAPPING = """
schema: 1
name: pushed
about: A vehicle that is held while forces are commanded.
format: csv
data: simulated
time: {column: t, unit: s}
topics:
  - topic: ground_truth/odom
    position: {columns: [x, y, z], unit: m}
    orientation: {quaternion: [qx, qy, qz, qw]}
  - topic: wrench_command
    force: {columns: [null, null, fz], unit: N}
"""


Held = Callable[..., Path]


@pytest.fixture
def held(tmp_path: Path, call: Callable[..., tuple[int, Any]]) -> Held:
    """Return a function that imports three seconds of a row after its time, and gives the bag."""

    def write(row: Callable[[float], str], head: str = 'fz', mapping: str = MAPPING) -> Path:
        rows = [f'{5.0 + k / 50.0},{row(k / 50.0)}' for k in range(151)]
        (tmp_path / 'held.csv').write_text('\n'.join([f't,x,y,z,qx,qy,qz,qw,{head}', *rows, '']))
        (tmp_path / 'pushed.yaml').write_text(mapping)
        words = ('--mapping', tmp_path / 'pushed.yaml', '--out', tmp_path / 'held')
        status, said = call('import', tmp_path / 'held.csv', *words)
        assert status == 0, said.err
        return tmp_path / 'held'

    return write


def test_commanded_forces_act_with_their_gain(tmp_path: Path, held: Held) -> None:
    """Half of 78.5 mN carries the 2 g of GT-MAB and lifts it with 19.6 mN; with air, 758 g."""
    gain, bag = 'vehicle.effects.wrench_gain.heave=0.5 1', held(lambda _: '0,0,1.5,0,0,0,1,0.0785')
    sentence = fly(tmp_path / 'flown', gain, commands=CommandRequest(bag))
    end = float(sentence.rpartition(' and ')[2].partition(' cm')[0])
    assert end == pytest.approx(100.0 * 0.5 * 0.0196 / 0.758 * 3.0**2, rel=0.08)


def test_an_unknown_command_is_the_one_before() -> None:
    nan = np.nan
    held = fill_with_last(np.array([[nan, 1.0], [2.0, nan], [nan, nan], [3.0, 4.0]]))
    np.testing.assert_array_equal(held, [[0.0, 1.0], [2.0, 1.0], [2.0, 1.0], [3.0, 4.0]])


def test_forces_far_beyond_the_weight_are_in_another_unit(held: Held) -> None:
    bag = held(lambda _: '0,0,1.5,0,0,0,1,78.5')
    with pytest.raises(BadInput, match=r"'wrench_command' reach 78.5 N or N m, .* right unit"):
        read_commands(bag, load_vehicle('gtmab'), None, 0.0, None)


def test_a_recorded_twist_of_markers_is_not_that_of_the_body(held: Held) -> None:
    """Markers turned by 90 degrees: what they report as ahead, is to the left."""
    part = '    velocity: {columns: [vx, fz, fz], unit: m/s, frame: body}\n  - topic: wrench'
    bag = held(
        lambda time: f'0,{0.2 * time},1.5,0,0,0.70710678,0.70710678,0.2,0',
        'vx,fz',
        MAPPING.replace('  - topic: wrench', part),
    )
    turn = {'marker_offset': {'yaw': read_quantity('90 deg')}}
    plain = load_vehicle('gtmab')
    turned = Vehicle(plain.file.model_copy(update={'effects': turn}))
    for vehicle, along in ((plain, (0.2, 0.0, 0.0)), (turned, (0.0, 0.2, 0.0))):
        read = read_commands(bag, vehicle, None, 0.0, None)
        assert read.motion[VELOCITY] == pytest.approx(along, abs=1e-6)


def read_quantity(text: str) -> Quantity:
    return Quantity.model_validate(text).model_copy(update={'source': 'test'})


def test_a_tracked_pose_is_that_of_the_body_times_the_frames_of_markers_and_tracker() -> None:
    numbers = {
        'marker_offset': {'x': '5 cm', 'y': '-2 cm', 'z': '-20 cm', 'yaw': '17 deg'},
        'tracker_misalignment': {'yaw': '11 deg', 'pitch': '3 deg', 'roll': '-2 deg'},
    }
    effects = {
        name: {key: read_quantity(value) for key, value in one.items()}
        for name, one in numbers.items()
    }
    plain = load_vehicle('gtmab')
    vehicle = Vehicle(plain.file.model_copy(update={'effects': effects}))
    chain = build_chains(vehicle.collect_effects(), EFFECTS)['pose']
    body = Rotation.from_rotvec([[0.1, -0.2, 1.0], [0.0, 0.1, -2.0]])
    places = np.array([[1.0, -2.0, 1.5], [0.3, 0.2, 0.7]])
    read = np.array([
        apply_chain(chain, (*place, *turn), 0.0)
        for place, turn in zip(places.tolist(), body.as_quat().tolist(), strict=True)
    ])  # fmt: skip
    centres, turns = find_body_poses(vehicle, read[:, :3], Rotation.from_quat(read[:, 3:]))
    np.testing.assert_allclose(centres, places, atol=1e-12)
    np.testing.assert_allclose((turns.inv() * body).magnitude(), 0.0, atol=1e-12)


def test_velocities_are_fitted_where_none_are_recorded() -> None:
    times = np.arange(40) / 100.0
    heading = Rotation.from_rotvec(np.outer(0.3 + 0.2 * times, (0.0, 0.0, 1.0)))
    track = np.outer(SPEED * times, (1.0, 0.0, 0.0))
    velocity, rates = find_velocity(np.full(6, np.nan), times, track, heading)
    assert velocity == pytest.approx((SPEED * np.cos(0.3), -SPEED * np.sin(0.3), 0.0), abs=1e-9)
    assert rates == pytest.approx((0.0, 0.0, 0.2), abs=1e-9)


def test_a_velocity_is_fitted_to_two_poses_that_are_far_apart() -> None:
    times, still = np.array([0.0, 0.6, 1.2]), Rotation.from_rotvec(np.zeros((3, 3)))
    track = np.outer(0.5 * times, (0.0, 1.0, 0.0))
    velocity, rates = find_velocity(np.full(6, np.nan), times, track, still)
    assert velocity == pytest.approx((0.0, 0.5, 0.0), abs=1e-9)
    assert rates == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_a_file_that_a_recording_names_is_not_opened(tmp_path: Path, call) -> None:
    fly(tmp_path / 'flight', 'scenario.goal.time_limit=1 s')
    moved = (tmp_path / 'flight').rename(tmp_path / 'moved')
    status, said = call('simulate', '--commands', str(moved), '--out', str(tmp_path / 'again'))
    assert status == 2
    assert 'because a recording names it; give it with --scenario' in said.err
    assert not (tmp_path / 'again').exists()


def test_a_recording_of_other_rotors_is_refused(flight: Path) -> None:
    with pytest.raises(BadInput, match='no commands for front, yaw, vertical of blimp2b'):
        read_commands(flight, load_vehicle('blimp2b'), None, 0.0, None)


def test_a_part_without_poses_is_refused(flight: Path, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match='less than 1 s'):
        fly(tmp_path / 'none', commands=CommandRequest(flight, begin=60.0))
    assert not (tmp_path / 'none').exists()


def test_options_of_a_recording_need_one(call) -> None:
    status, said = call('simulate', '--begin', '3')
    assert status == 2
    assert 'add --commands BAG' in said.err
