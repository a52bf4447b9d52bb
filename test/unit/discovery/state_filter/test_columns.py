"""Columns of a linear flight are derivatives of what the model does and of what is read."""

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight
import numpy as np
from numpy.typing import NDArray
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]
CHECKED = (
    'thrust_scale.factor', 'rotor_fault.lost_3', 'linear_drag.surge', 'quadratic_drag.heave',
    'vehicle.mass', 'cg_offset.y', 'munk_moment.lost', 'motor_lag', 'command_delay.delay',
    'battery_sag.sensitivity', 'helium_leak.rate', 'gyro_scale.z', 'range_offset.offset',
    'tracker_delay.delay', 'steady_wind.x', 'ground_effect.gain',
)  # fmt: skip


@pytest.fixture(scope='module')
def linear(gtmab: Known, clean: FlightSystem) -> LinearFlight:
    """The clean flight about the vehicle of the file."""
    return clean.linearize(gtmab[0], np.zeros(len(gtmab[1])))


def _differ(expected: NDArray[np.float64], column: NDArray[np.float64]) -> float:
    """Return how far a column is from the expected one, by its size."""
    known = np.isfinite(expected) & np.isfinite(column)
    off = np.linalg.norm((expected - column)[known])
    # What nothing changes is 0 but for rounding
    return float(off / max(np.linalg.norm(expected[known]), 1e-6))


@pytest.mark.parametrize('name', CHECKED)
def test_a_column_is_what_another_value_changes(
    gtmab: Known, clean: FlightSystem, linear: LinearFlight, name: str
) -> None:
    """A step leaves less of its defect, and a prediction takes what it gains from the reading."""
    k = [one.name for one in gtmab[1]].index(name)
    values = np.zeros(len(gtmab[1]))
    values[k] = 1e-3 * gtmab[1][k].typical or 1e-4
    if name == 'command_delay.delay':
        values[k] = 1e-3
    none = np.zeros(len(values), dtype=np.bool_)
    after = clean.linearize(gtmab[0], values, none)
    before = clean.linearize(gtmab[1][k].enable_effect(gtmab[0]), 0.0 * values, none)
    # Nothing is known outside the run
    ((begin, end),) = linear.runs
    inside = slice(begin, end - 1)
    moved = ((after.defect - before.defect) / values[k])[inside]
    assert _differ(moved, linear.moved[inside, :, k]) < 0.06
    read = ((before.left - after.left) / values[k])[inside, :6]
    assert _differ(read, linear.read_moved[inside, :6, k]) < 0.06
