# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Recognise the tests of a laboratory from the motion and the commands of their logs.

A log may be several tests: a step in yaw whose command ends is a spin-down too. The names of the
files play no role.
"""

from collections.abc import Sequence
import math
from typing import Final, final, NamedTuple

from lta_config.errors import format_count
from lta_discovery.flights.measured_flight import GRID_PERIOD, MeasuredFlight, Stream
from lta_discovery.formatting import join_words
from lta_discovery.lab_tests.design import Kind
from lta_discovery.model.quaternions import rotation_matrix
from lta_model.effects.protocol import AXES
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOVED: Final = 0.1  # of the largest command of a kind (force, moment): an axis that is commanded
JUMP: Final = 0.2  # of the range of an axis; a change that counts
ZERO: Final = 0.02  # of the range of an axis; a command that is zero but for rounding
LEVELS: Final = 3  # most changes of a command that is stepped
SMALL: Final = 0.4  # of the largest command; a further axis below it may trim or hold the altitude
SWING_AMPLITUDE: Final = math.radians(4.0)  # rad; amplitude of a swing
SPUN: Final = math.radians(15.0)  # rad/s; yaw rate of a spin-down when it begins
SLOWED: Final = 0.8  # of that rate at the end
COASTED: Final = 4.0  # s without a command that make a spin-down
SMOOTH: Final = 13  # points of the grid, 0.5 s


@final
class RecognisedTest(NamedTuple):
    """A test in a log, and why it was recognised."""

    # As in `LabTest`
    kind: Kind
    axis: str
    evidence: str  # what shows it, in words
    size: float = 0.0  # of a step: the change of its command, with its sign [N], [N m]

    @property
    def title(self) -> str:
        """Name in words."""
        if self.kind in ('swing', 'step'):
            return f'{self.kind} in {self.axis}'
        return {'spin_down': 'spin-down', 'free_flight': 'free flight'}.get(self.kind, self.kind)


def recognise_tests(flight: MeasuredFlight, vehicle: Vehicle) -> tuple[RecognisedTest, ...]:
    """Return the tests in a flight; at least one."""
    orders = read_commanded_wrench(flight, vehicle)
    moved = _list_commanded_axes(orders)
    if not moved:
        return _recognise_free_motion(flight, 0)
    changes = {axis: _count_changes(orders.values[:, AXES.index(axis)]) for axis in moved}
    most = max(changes.values())
    if most > LEVELS:
        words = f'{format_count(most, "change")} of the commands of {join_words(moved)}'
        return (RecognisedTest('free_flight', '', words),)
    # A rotor off the axis pushes and turns: a step on both
    steps = [_describe_step(orders, axis) for axis in moved]
    return (*steps, *_recognise_coasting(flight, orders, moved))


def _describe_step(orders: Stream, axis: str) -> RecognisedTest:
    values = orders.values[:, AXES.index(axis)]
    change = values - _find_rest(values)
    size = float(change[np.argmax(np.abs(change))])
    unit = 'mN' if axis in AXES[:3] else 'mN m'
    words = f'a command in {axis} of {1e3 * size:.3g} {unit} that is held'
    return RecognisedTest('step', axis, words, size)


def _find_rest(values: Array) -> float:
    """
    Return the command from which a step starts.

    It is zero where zero is commanded at all, as a log may begin in a step. Else it is a trim: the
    command at both ends, or the smaller one of one sign.
    """
    span, first, last = float(np.ptp(values)), float(values[0]), float(values[-1])
    if np.abs(values).min() < ZERO * span:
        return 0.0
    return last if abs(last) < abs(first) - JUMP * span and first * last > 0.0 else first


def read_commanded_wrench(flight: MeasuredFlight, vehicle: Vehicle) -> Stream:
    """Return the commanded force and moment about the hull centre [N, N m]."""
    if flight.wrench is not None:
        return flight.wrench
    duties = flight.commands.values
    wrench = np.zeros((len(duties), len(AXES)))
    for rotor, duty in zip(vehicle.rotors, duties.T, strict=False):
        thrust = rotor.a * duty * np.abs(duty) + rotor.b * duty
        column = np.where(duty[:, None] < 0.0, rotor.reverse, rotor.column)
        wrench += thrust[:, None] * column
    return Stream(flight.commands.time, wrench)


def _list_commanded_axes(orders: Stream) -> list[str]:
    """Return the axes whose command changes enough; tilting moments follow from a push."""
    out: list[str] = []
    if not len(orders.values):
        return out
    for axes in (('surge', 'sway', 'heave'), ('yaw',)):
        columns = [AXES.index(axis) for axis in axes]
        largest = float(np.abs(orders.values[:, columns]).max(initial=0.0))
        spans = [float(np.ptp(orders.values[:, k])) for k in columns]
        widest = max(spans, default=0.0)
        for axis, span in zip(axes, spans, strict=True):
            if span > max(MOVED * largest, SMALL * widest, 1e-9):
                out.append(axis)
    # The moment of a pair of rotors that differ a little is no turn
    force = [axis for axis in out if axis != 'yaw']
    yaw = orders.values[:, AXES.index('yaw')]
    lever = 0.02  # m
    if force and np.ptp(yaw) < lever * np.ptp(orders.values[:, AXES.index(force[0])]):
        return force
    return out


def _count_changes(values: Array) -> int:
    """Return how often a command leaves the level of its last change by much."""
    span = float(np.ptp(values))
    level, count = float(values[0]), 0
    for value in values[1:]:
        if abs(value - level) > JUMP * span:
            count += 1
            level = float(value)
    return count


def _recognise_free_motion(flight: MeasuredFlight, begin: int) -> tuple[RecognisedTest, ...]:
    """Return the tests of a vehicle without changing commands, from a grid point on."""
    quaternion = flight.quaternion[begin:]
    valid = np.isfinite(quaternion).all(axis=1)
    if valid.sum() < 2 * SMOOTH:
        return (RecognisedTest('float', '', 'no command, and hardly a pose'),)
    rotation = rotation_matrix(quaternion[valid])
    # The map's vertical in the body frame shows the tilt, whatever the heading
    roll, pitch = rotation[:, 2, 1], -rotation[:, 2, 0]
    tilts = {'roll': _amplitude(roll), 'pitch': _amplitude(pitch)}
    axis = max(tilts, key=lambda name: tilts[name])
    tests = []
    if tilts[axis] > SWING_AMPLITUDE:
        words = f'no command; {axis} swings by {math.degrees(tilts[axis]):.0f} degrees'
        tests.append(RecognisedTest('swing', axis, words))
    first, last = _yaw_rates(quaternion[valid])
    if abs(first) > SPUN and abs(last) < SLOWED * abs(first):
        words = (
            f'no command; the yaw rate falls from {math.degrees(abs(first)):.0f} to '
            f'{math.degrees(abs(last)):.0f} degrees/s'
        )
        tests.append(RecognisedTest('spin_down', 'yaw', words))
    if not tests:
        height = flight.position[begin:, 2]
        way = float(np.nanmax(height) - np.nanmin(height))
        tests.append(RecognisedTest('float', '', f'no command; moves {way:.2g} m up or down'))
    return tuple(tests)


def _recognise_coasting(
    flight: MeasuredFlight, orders: Stream, moved: Sequence[str]
) -> tuple[RecognisedTest, ...]:
    """Return the spin-down after a step in yaw that ends."""
    if 'yaw' not in moved:
        return ()
    values = np.abs(orders.values[:, AXES.index('yaw')])
    last = int(np.flatnonzero(values >= MOVED * values.max())[-1])
    if last == len(values) - 1:
        return ()
    # A command holds until the next one
    begin = int(np.searchsorted(flight.time, orders.time[last + 1]))
    if (len(flight.time) - begin) * GRID_PERIOD < COASTED:
        return ()
    tests = _recognise_free_motion(flight, begin)
    return tuple(one for one in tests if one.kind == 'spin_down')


def _amplitude(tilt: Array) -> float:
    """Return half the range of a tilt about its slow drift [rad]."""
    # The first of 20 s, before a swing decays; outliers of the tracker are gone
    return 0.5 * float(np.ptp(np.percentile(tilt, (0.5, 99.5))))


def _yaw_rates(quaternion: Array) -> tuple[float, float]:
    """Return the mean yaw rate in the first and the last two seconds [rad/s]."""
    rotation = rotation_matrix(quaternion)
    heading = np.unwrap(np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0]))
    reach = min(round(2.0 / GRID_PERIOD), len(heading) // 2)
    rates = np.gradient(heading, GRID_PERIOD)
    return float(np.mean(rates[:reach])), float(np.mean(rates[-reach:]))
