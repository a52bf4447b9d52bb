"""
Locate where and when the model of the vehicle file disagrees, by channel and by axis of force.

For a channel, the disagreement is the prediction error from best-fitting initial states, by the
noise. For an axis it is the unexplained force or moment of a fit without effects, by the noise
floor. Each is reported once, for the worst flight, with the condition under which it is largest.
Permanent changes within a flight are reported separately.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

from lta_discovery.discrepancies.change_point import find_change_point
from lta_discovery.discrepancies.conditions import (
    find_largest_condition,
    list_condition_quantities,
)
from lta_discovery.finding import Discrepancy
from lta_discovery.fit.evidence import wrench_floor
from lta_discovery.fit.joint_fit import FlightFit
from lta_discovery.flights.measured_flight import CHANNELS
from lta_discovery.forecast.flight_prediction import best_start_residual
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint
from lta_discovery.unmodeled.unexplained_force import latent_at_knots
from lta_model.effects.protocol import AXES
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CLEAR: Final = 2.0  # times the noise or noise floor; smallest reported disagreement
ABOARD: Final = 10.0  # the same for an IMU, because of its scale error
IMU: Final = ('p', 'q', 'r', 'fx', 'fy', 'fz')
MOST: Final = 24  # most reported discrepancies
EVERY: Final = 25  # grid points per value of a channel: 1 s


@final
@dataclass(frozen=True, slots=True)
class BaselineFlight:
    """One flight under the model of the vehicle file."""

    name: str  # of its bag
    flight: FlightLinearizer
    before: LinearizationPoint  # the vehicle file
    # Its tolerances, fitted without any effect; None if that was not done
    fit: FlightFit | None = None
    light: Array | None = None  # illuminance on the grid, shape (n,) [lx]


@final
@dataclass(frozen=True, slots=True)
class DisagreementSeries:
    """One disagreement over time, in units of its noise."""

    name: str  # channel or axis
    values: Array  # root mean squares, or signed values, shape (n,)
    index: NDArray[np.int64]  # points of the grid, rising, shape (n,)
    block: int  # correlation length, in values


def find_discrepancies(flights: Sequence[BaselineFlight], seed: int) -> tuple[Discrepancy, ...]:
    """Return the discrepancies of a model, the largest first."""
    worst: dict[str, tuple[float, BaselineFlight, DisagreementSeries]] = {}
    changes: list[Discrepancy] = []
    for one in flights:
        forces = _force_series(one)
        changes += _find_changes(one, forces, seed)
        for quantity in (*_channel_series(one), *forces):
            size = _rms(quantity.values)
            clear = ABOARD if quantity.name in IMU else CLEAR
            if size > worst.get(quantity.name, (clear,))[0]:
                worst[quantity.name] = size, one, quantity
    discrepancies = [
        _locate_discrepancy(one, quantity, seed) for _, one, quantity in worst.values()
    ]
    return tuple(
        sorted([*changes, *discrepancies], key=lambda place: -place.ratio_to_noise)[:MOST]
    )


def _rms(values: Array) -> float:
    """Return the root mean square; 0 for an empty array."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0


def _channel_series(one: BaselineFlight) -> list[DisagreementSeries]:
    """Return the RMS prediction errors by channel, second by second."""
    flight = one.flight
    squares = best_start_residual(flight, one.before) ** 2
    count = squares.shape[1] // EVERY * EVERY
    # Mean squares over 1 s, without the incomplete last second
    cut = squares[:, :count].reshape(len(squares), -1, EVERY, squares.shape[2])
    valid = np.asarray(np.isfinite(cut).any(axis=2))
    total = np.where(np.isfinite(cut), cut, 0.0).sum(axis=2)
    means = total / np.maximum(np.isfinite(cut).sum(axis=2), 1)
    # Grid point in the middle of each second
    index = flight.index[:, EVERY // 2 : count : EVERY]
    out = []
    block = max(1, cut.shape[1])
    for k, name in enumerate(CHANNELS):
        here = valid[..., k]
        if here.sum() > 2 * block:
            out.append(DisagreementSeries(name, np.sqrt(means[..., k][here]), index[here], block))
    return out


def _force_series(one: BaselineFlight) -> list[DisagreementSeries]:
    """Return the unexplained force and moment by axis, knot by knot."""
    if one.fit is None:
        return []
    cut = one.flight.replay.cut
    at = np.rint(np.linspace(0, cut.length - 1, cut.knots)).astype(np.int64)
    inside = cut.inside[:, at].reshape(-1)
    index = one.flight.index[:, at].reshape(-1)[inside]
    knots = latent_at_knots(one.fit)[inside] / wrench_floor(one.before.nominal)
    return [DisagreementSeries(axis, knots[:, k], index, cut.knots) for k, axis in enumerate(AXES)]


def _locate_discrepancy(
    one: BaselineFlight, quantity: DisagreementSeries, seed: int
) -> Discrepancy:
    """Return the condition and the interval where one disagreement is largest."""
    flight = one.flight.replay.flight
    quantities = {
        name: (values[quantity.index], unit)
        for name, (values, unit) in list_condition_quantities(flight, one.light).items()
    }
    condition = find_largest_condition(quantity.values**2, quantities, quantity.block, seed)
    begin, end = _longest_interval(condition.holds, flight.time[quantity.index])
    ratio = _rms(quantity.values[condition.holds])
    return Discrepancy(one.name, quantity.name, begin, end, condition.name, ratio)


def _longest_interval(holds: NDArray[np.bool_], time: Array) -> tuple[float, float]:
    """Return the longest uninterrupted interval of a condition. [s]"""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], holds.astype(np.int8), [0]])))
    runs = edges.reshape(-1, 2)
    begin, end = max(runs.tolist(), key=lambda run: time[run[1] - 1] - time[run[0]])
    return float(time[begin]), float(time[end - 1])


def _find_changes(
    one: BaselineFlight, forces: Sequence[DisagreementSeries], seed: int
) -> list[Discrepancy]:
    """Return a permanent change within a flight, for the axis that disagrees most afterwards."""
    if one.fit is None:
        return []
    change = find_change_point(_complete_columns(one.fit, one.flight), one.flight.knobs, seed)
    if change is None:
        return []
    cut, time = one.flight.replay.cut, one.flight.replay.flight.time
    at, end = float(time[cut.first[change.piece]]), float(time[forces[0].index[-1]])
    # Report the axis that disagrees most after the change
    sizes = {each.name: _rms(each.values[time[each.index] >= at]) for each in forces}
    axis = max(sizes, key=lambda name: sizes[name])
    text = f'from about {at:.0f} s on, as if {change.knob} had changed'
    return [Discrepancy(one.name, axis, at, end, text, sizes[axis])]


def _complete_columns(this: FlightFit, flight: FlightLinearizer) -> FlightFit:
    """Return a fit with the columns of all candidates, including fixed ones."""
    first = this.linear.grams.shape[1] - len(this.linear.names) - 1
    sizes = this.linear.grams.sum(axis=0).diagonal()[first : first + len(flight.knobs)]
    candidates = np.array([knob.typical > 0.0 for knob in flight.knobs])
    if sizes[candidates].all():
        return this
    return replace(this, linear=flight.linearize(this.linear.point))
