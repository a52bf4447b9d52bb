"""Columns are derivatives of what would be measured, and scale together as forces do."""

from dataclasses import replace

from lta_analysis.discovery.knobs import Knob
from lta_analysis.discovery.linear import origin, RANDOM
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.nominal import Nominal
from lta_analysis.discovery.replay import STEPS
from lta_config.constants import STANDARD_GRAVITY
import numpy as np
from numpy.typing import NDArray
import pytest

Known = tuple[Nominal, list[Knob]]
CHECKED = (
    'thrust_scale.factor', 'rotor_fault.lost_3', 'linear_drag.surge', 'quadratic_drag.heave',
    'vehicle.mass', 'cg_offset.y', 'munk_moment.lost', 'motor_lag', 'command_delay.delay',
    'battery_sag.sensitivity', 'helium_leak.rate', 'gyro_scale.z', 'range_offset.offset',
    'tracker_misalignment.pitch', 'tracker_delay.delay', 'steady_wind.x', 'ground_effect.gain',
)  # fmt: skip


@pytest.fixture(scope='module')
def columns(gtmab: Known, clean: Linearised) -> NDArray[np.float64]:
    """The whitened columns of the clean flight."""
    return clean.columns(origin(gtmab[0], gtmab[1], len(clean.replay.first)))[0]


def _left(
    flight: Linearised, nominal: Nominal, random: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return measured less predicted by the noise, flown with other parameters."""
    point = replace(origin(nominal, flight.knobs, len(random)), random=random)
    grid = flight.trajectory(point)[:, ::STEPS]
    return flight.left(grid, point, nominal.rows()) / flight.replay.flight.noise


def _differ(expected: NDArray[np.float64], column: NDArray[np.float64]) -> float:
    known = np.isfinite(expected)
    off = np.linalg.norm((expected - column)[known])
    return float(off / np.linalg.norm(column[known]))


@pytest.mark.parametrize('name', CHECKED)
def test_a_column_is_what_flying_with_the_knob_turned_changes(
    gtmab: Known, clean: Linearised, columns: NDArray[np.float64], name: str
) -> None:
    nominal, knobs = gtmab
    k = [knob.name for knob in knobs].index(name)
    still, step = np.zeros((len(clean.replay.first), RANDOM)), 1e-3 * knobs[k].typical or 1e-4
    if name == 'command_delay.delay':
        step = 1e-3
    before = _left(clean, knobs[k].ready(nominal), still)
    after = _left(clean, knobs[k].turned(nominal, step), still)
    assert _differ((before - after) / step, columns[..., RANDOM + k]) < 0.01


@pytest.mark.parametrize('k', [0, 4, 7, 11, 12, 24, 40, 55, 60, RANDOM - 1])
def test_states_knots_and_pressure_have_theirs(
    gtmab: Known, clean: Linearised, columns: NDArray[np.float64], k: int
) -> None:
    still = np.zeros((len(clean.replay.first), RANDOM))
    moved = still.copy()
    moved[:, k] = 1e-5
    change = (_left(clean, gtmab[0], still) - _left(clean, gtmab[0], moved)) / 1e-5
    assert _differ(change, columns[..., k]) < 0.01


def test_all_forces_and_inertias_scaled_together_move_nothing(
    gtmab: Known, clean: Linearised, columns: NDArray[np.float64]
) -> None:
    nominal, knobs = gtmab
    heaviness = (nominal.mass - nominal.displaced) * STANDARD_GRAVITY
    scaled = dict.fromkeys(
        (
            'thrust_scale.factor', 'strip_damping.all', 'vehicle.mass', 'vehicle.roll',
            'vehicle.pitch', 'vehicle.yaw',
        ),
        1.0,
    )  # fmt: skip
    scaled['net_lift.force'] = -heaviness
    for effect in ('added_mass', 'added_inertia', 'quadratic_drag', 'rotational_drag'):
        for parameter, value in nominal.given[effect].items():
            scaled[f'{effect}.{parameter}'] = value
    names = [knob.name for knob in knobs]
    total = sum(value * columns[..., RANDOM + names.index(name)] for name, value in scaled.items())
    known = np.isfinite(total)
    thrust = columns[..., RANDOM + names.index('thrust_scale.factor')]
    assert np.linalg.norm(total[known]) < 2e-4 * np.linalg.norm(thrust[known])
