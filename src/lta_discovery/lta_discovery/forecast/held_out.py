"""
How far predictions are off on flights that nothing was fitted to, model by model.

Every model gets the same help: where each piece begins, as the poses around its beginning say, and
the errors of the flight's own sensors and its lift (`own_variance`), most probable by the first
pieces of the flight, which are not scored. Nothing else of the flight is known to any of them.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

from lta_discovery.finding import Gap
from lta_discovery.fit.bounds import turned
from lta_discovery.fit.evidence import own_variance, Pieces
from lta_discovery.fit.fit import Joint
from lta_discovery.flights.measured import CHANNELS, PERIOD
from lta_discovery.forecast.gap import coasting, HORIZONS
from lta_discovery.model.nominal import Nominal
from lta_discovery.model.rotations import logarithm, product, reverse
from lta_discovery.replay.linear import Linear, Point, still
from lta_discovery.replay.linearise import Linearised
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import in_map, told
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEARNED: Final = 0.25  # of the pieces of a flight, by which its own errors are known
LEARNED_MOST: Final = 4  # pieces, of the same
DRAWS: Final = 2000  # of the bootstrap
_UNITS = (*['m'] * 3, *['rad'] * 3, *['rad/s'] * 3, *['m/s2'] * 3, 'm', 'Pa')
UNITS: Final = dict(zip(CHANNELS, _UNITS, strict=True))
WHOLE: Final = {'position': ('m', slice(0, 3)), 'attitude': ('rad', slice(3, 6))}


class Models(NamedTuple):
    """One flight under the vehicle file; tolerances fitted; and with the named effects."""

    before: Point
    tuned: Point
    after: Point


def learning(flight: Linearised) -> int:
    """Return how many pieces at the beginning of a flight tell of its own errors."""
    return min(LEARNED_MOST, int(LEARNED * len(flight.replay.first)))


def shown(flight: Linearised, nominal: Nominal, bare: Joint, full: Joint) -> Models:
    """
    Return a held-out flight under each model, with the errors that are its own.

    Parameters
    ----------
    flight : Linearised
        The flight.
    nominal : Nominal
        The vehicle as its file has it.
    bare, full : Joint
        Of other flights: without effects, and with those named.

    """
    zero, knobs = np.zeros_like(full.group.at), flight.knobs
    count, models = learning(flight), []
    columns = None
    for at, deviations in (
        (zero, bare.deviations),
        (bare.fitted.mean, bare.deviations),
        (full.fitted.mean, full.deviations),
    ):
        vehicle, values = turned(nominal, knobs, at)
        point = Point(vehicle, values, still(flight.replay.cut))
        if count:
            if columns is None:
                columns = flight.columns(point, slice(0, count))[0]
            own = _own(flight, point, columns, deviations, count)
            vehicle, values = turned(nominal, knobs, values + own)
            point = Point(vehicle, values, point.random)
        models.append(point)
    return Models(*models)


def _own(flight: Linearised, point: Point, columns: Array, deviations: Array, count: int) -> Array:
    """Return the errors of a flight's own that its first pieces make most probable."""
    grid = flight.forecast(point)[:, ::STEPS]
    left = flight.left(grid, point, flight.replay.rows(point.nominal))[:count]
    left /= flight.replay.flight.noise
    known = np.isfinite(left)
    table = np.concatenate([columns, left[..., None]], axis=-1)
    table[~known] = 0.0
    flat = table.reshape(count, -1, table.shape[-1])
    grams = np.swapaxes(flat, 1, 2) @ flat
    first = Point(point.nominal, point.values, point.random[:count])
    rows = known.sum(axis=(1, 2))
    reduced = Pieces(Linear((), grams, rows, first, left)).reduced(deviations)
    variance = own_variance(flight.knobs)
    own = np.flatnonzero(variance)
    inner = reduced.products[np.ix_(own, own)] + np.diag(1.0 / variance[own])
    out = np.zeros(len(variance))
    out[own] = np.linalg.solve(inner, reduced.products[own, -1])
    return out


def _off(flight: Linearised, point: Point, coast: bool = False) -> Array:
    """Return measured less predicted at each horizon, shape (S, H, 14); NaN where unknown."""
    rows, replay = flight.replay.rows(point.nominal), flight.replay
    if coast:
        grid = coasting(in_map(replay.cut.start, rows.acting), replay.cut.length)
        said = told(grid, flight.time, rows.acting, flight.places)
        turn = logarithm(product(reverse(said.quaternion), replay.flight.quaternion[flight.index]))
        way = replay.flight.position[flight.index] - said.position
        readings = replay.flight.readings[flight.index] - said.readings
        left = np.concatenate([way, turn, readings], axis=-1)
        left[~replay.cut.inside] = np.nan
        left[..., ~np.isfinite(replay.flight.noise)] = np.nan
    else:
        with np.errstate(over='ignore', invalid='ignore'):
            left = flight.left(flight.forecast(point)[:, ::STEPS], point, rows)
    at = [round(horizon / PERIOD) for horizon in HORIZONS]
    return left[learning(flight) :, [min(k, left.shape[1] - 1) for k in at]]


def shrinkage(before: Array, after: Array, rng: np.random.Generator) -> tuple[float, float]:
    """Return the 95 % interval of the shrinkage, by bootstrap over pieces."""
    picked = rng.integers(0, len(before), (DRAWS, len(before)))
    ratio = np.sqrt(after[picked].sum(axis=1) / np.maximum(before[picked].sum(axis=1), 1e-300))
    low, high = np.percentile(1.0 - ratio, (2.5, 97.5))
    return float(low), float(high)


def gaps(flights: Sequence[Linearised], models: Sequence[Models], seed: int) -> list[Gap]:
    """
    Return how far each model is off: position and attitude, then by channel, at each horizon.

    Parameters
    ----------
    flights : sequence of Linearised
        Those that are shown.
    models : sequence of Models
        Of each.
    seed : int
        Of the bootstrap.

    """
    kinds = ('before', 'tuned', 'after', 'coast')
    offs: dict[str, Array] = {
        kind: np.concatenate(
            [
                _off(flight, getattr(each, kind, each.before), kind == 'coast')
                for flight, each in zip(flights, models, strict=True)
            ]
        )
        for kind in kinds
    }
    noise = np.sqrt(np.mean([each.replay.flight.error**2 for each in flights], axis=0))
    rng, out = np.random.default_rng(seed), []
    which = {**WHOLE, **{c: (UNITS[c], slice(k, k + 1)) for k, c in enumerate(CHANNELS)}}
    for name, (unit, columns) in which.items():
        for h, horizon in enumerate(HORIZONS):
            square = {kind: np.sum(off[:, h, columns] ** 2, axis=-1) for kind, off in offs.items()}
            known = np.all([np.isfinite(each) for each in square.values()], axis=0)
            if not known.any():
                continue
            mean = {kind: float(np.sqrt(np.mean(each[known]))) for kind, each in square.items()}
            floor = float(np.sqrt(np.sum(noise[columns] ** 2)))
            out.append(
                Gap(
                    name, unit, horizon, **mean, noise_floor=floor,
                    shrink=1.0 - mean['after'] / mean['before'],
                    shrink_ci95=shrinkage(square['before'][known], square['after'][known], rng),
                    pieces=int(known.sum()),
                )
            )  # fmt: skip
    return out
