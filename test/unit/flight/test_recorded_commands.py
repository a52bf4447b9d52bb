"""Recorded commands, flown through a vehicle file."""

from pathlib import Path

from lta_config.errors import BadInput
from lta_flight.flight import SilentObserver
from lta_flight.recorded_commands import find_velocity, read_commands
from lta_flight.simulate import CommandRequest, simulate_once, SimulationRequest
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ..report_flight import SPEED  # noqa: TID252 - `test` is Python's own


def fly(folder: Path, *changes: str, commands: CommandRequest | None = None) -> str:
    order = SimulationRequest(
        'gtmab', 'lamp_room', 'bag', '', 3, changes, folder, record=True, commands=commands
    )
    return simulate_once(order, SilentObserver())[0].sentence


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


def test_a_recorded_file_that_is_gone_is_not_replaced_by_another(tmp_path: Path, call) -> None:
    fly(tmp_path / 'flight', 'scenario.goal.time_limit=1 s')
    moved = (tmp_path / 'flight').rename(tmp_path / 'moved')
    status, said = call('simulate', '--commands', str(moved), '--out', str(tmp_path / 'again'))
    assert status == 2
    assert 'is no longer there; choose one with --scenario' in said.err
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
