"""
Where and when the model of the vehicle file disagrees: by channel and by axis of force.

By channel it is the error of predictions over some seconds, by the noise of the channel; by axis
the force and moment that a fit without any effect leaves unexplained, by the floor. Each is told
once, of the flight where it is worst, with the condition under which it is largest; a change for
good comes beside it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_analysis.discovery.change_point import change
from lta_analysis.discovery.conditions import conditions_of, largest
from lta_analysis.discovery.evidence import FLOOR
from lta_analysis.discovery.finding import Place
from lta_analysis.discovery.fit import Fit
from lta_analysis.discovery.linear import KNOTS, Point
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.measured import CHANNELS
from lta_analysis.discovery.replay import STEPS
from lta_analysis.discovery.unexplained import knots_of
from lta_sim.effects.protocol import AXES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CLEAR: Final = 2.0  # times the noise, or floors: what is worth telling
MOST: Final = 12  # places that are told
AFTER: Final = 1.5  # times as much after a change as before, or the other way round
EVERY: Final = 25  # points of the grid for one value of a channel: a second


@final
@dataclass(frozen=True, slots=True)
class Seen:
    """
    One flight as the model of the vehicle file sees it.

    Attributes
    ----------
    name : str
        Of its bag.
    flight : Linearised
        The flight.
    before : Point
        The vehicle file.
    fit : Fit or None
        Its tolerances, fitted without any effect; None if that was not done.
    light : ndarray, shape (n,), or None
        Illuminance on the grid. [lx]

    """

    name: str
    flight: Linearised
    before: Point
    fit: Fit | None = None
    light: Array | None = None


@final
@dataclass(frozen=True, slots=True)
class Quantity:
    """
    One disagreement over time, in units of its noise.

    Attributes
    ----------
    name : str
        Channel or axis.
    values : ndarray, shape (n,)
        Root mean squares, or signed values.
    index : ndarray of int, shape (n,)
        Points of the grid, rising.
    block : int
        Values within which it remembers.

    """

    name: str
    values: Array
    index: NDArray[np.int64]
    block: int


def places(seen: Sequence[Seen], seed: int) -> tuple[Place, ...]:
    """
    Return where a model disagrees, the largest first.

    Parameters
    ----------
    seen : sequence of Seen
        Flights.
    seed : int
        Of what chance does.

    """
    worst: dict[str, tuple[float, Seen, Quantity]] = {}
    changes: list[Place] = []
    for one in seen:
        forces = _forces(one)
        changes += _changes(one, forces, seed)
        for quantity in (*_channels(one), *forces):
            size = _size(quantity.values)
            if size > worst.get(quantity.name, (CLEAR,))[0]:
                worst[quantity.name] = size, one, quantity
    found = [_place(one, quantity, seed) for _, one, quantity in worst.values()]
    return tuple(sorted([*changes, *found], key=lambda place: -place.ratio_to_noise)[:MOST])


def _size(values: Array) -> float:
    """Return the root mean square; 0 of nothing."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0


def _channels(one: Seen) -> list[Quantity]:
    """Return the errors of predictions by channel, second by second."""
    flight = one.flight
    rows = one.before.nominal.rows()
    still = Point(one.before.nominal, one.before.values, np.zeros_like(one.before.random))
    left = flight.left(flight.trajectory(still)[:, ::STEPS], still, rows)
    squares = (left / flight.replay.flight.noise) ** 2
    count = squares.shape[1] // EVERY * EVERY
    cut = squares[:, :count].reshape(len(squares), -1, EVERY, squares.shape[2])
    known = np.isfinite(cut).all(axis=2)
    means = np.where(np.isfinite(cut), cut, 0.0).mean(axis=2)
    index = flight.index[:, EVERY // 2 : count : EVERY]
    out = []
    block = max(1, cut.shape[1])
    for k, name in enumerate(CHANNELS):
        here = known[..., k]
        if here.sum() > 2 * block:
            out.append(Quantity(name, np.sqrt(means[..., k][here]), index[here], block))
    return out


def _forces(one: Seen) -> list[Quantity]:
    """Return the unexplained force and moment by axis, knot by knot."""
    if one.fit is None:
        return []
    length = one.flight.replay.cut.length
    at = np.rint(np.linspace(0, length - 1, KNOTS)).astype(np.int64)
    inside = one.flight.replay.cut.inside[:, at].reshape(-1)
    index = one.flight.index[:, at].reshape(-1)[inside]
    knots = knots_of(one.fit)[inside] / FLOOR
    return [Quantity(axis, knots[:, k], index, KNOTS) for k, axis in enumerate(AXES)]


def _place(one: Seen, quantity: Quantity, seed: int) -> Place:
    """Return where one disagreement is largest."""
    flight = one.flight.replay.flight
    known = {
        name: (values[quantity.index], unit)
        for name, (values, unit) in conditions_of(flight, one.light).items()
    }
    told = largest(quantity.values**2, known, quantity.block, seed)
    begin, end = _longest(told.holds, flight.time[quantity.index])
    ratio = _size(quantity.values[told.holds])
    return Place(one.name, quantity.name, begin, end, told.name, ratio)


def _longest(holds: NDArray[np.bool_], time: Array) -> tuple[float, float]:
    """Return when a condition holds for the longest time in one piece. [s]"""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], holds.astype(np.int8), [0]])))
    runs = edges.reshape(-1, 2)
    begin, end = max(runs.tolist(), key=lambda run: time[run[1] - 1] - time[run[0]])
    return float(time[begin]), float(time[end - 1])


def _changes(one: Seen, forces: Sequence[Quantity], seed: int) -> list[Place]:
    """Return what changed for good in a flight, on the axis where it did most."""
    if not forces:
        return []
    index = forces[0].index
    series = np.column_stack([each.values for each in forces])
    found = change(series, KNOTS, seed)
    if found is None:
        return []
    time = one.flight.replay.flight.time[index]
    sizes = np.array([
        [_size(series[: found.index, k]), _size(series[found.index :, k])]
        for k in range(series.shape[1])
    ])  # fmt: skip
    k = int(np.argmax(np.abs(np.log(sizes[:, 1] / sizes[:, 0])) * (sizes.max(axis=1) > CLEAR)))
    before, after = sizes[k]
    if max(before, after) < CLEAR or max(before, after) < AFTER * min(before, after):
        return []
    at = 0.5 * (time[found.index - 1] + time[found.index])
    if after > before:
        return [Place(one.name, AXES[k], at, float(time[-1]), f'after {at:.0f} s', float(after))]
    return [Place(one.name, AXES[k], float(time[0]), at, f'until {at:.0f} s', float(before))]
