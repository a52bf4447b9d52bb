"""Forecasts of RGBlimp's flights: by a model, by coasting, by the other repeats of an input."""

from collections.abc import Sequence
from typing import Final, final, NamedTuple

from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.forecast.horizon_errors import HorizonErrors, HORIZONS
from lta_discovery.forecast.prediction_errors import extrapolate_coast
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_exponential,
    quaternion_logarithm,
    quaternion_product,
    rotate_vectors,
)
import numpy as np
from numpy.typing import NDArray
from rgblimp_flights import begun, Flight, REPEATS

Array = NDArray[np.float64]
LIFT: Final = 0.004  # N; by which the lift of a flight is off
STEADY: Final = 10.0  # s; pieces that begin later are in the spiral
AT: Final = np.rint(np.array(HORIZONS) / PERIOD).astype(np.int64)
SHOWN: Final = (HORIZONS.index(3.0), HORIZONS.index(5.0))
SIZE: Final = 0.05  # m for each second ahead: how much an early error says of the lift


@final
class Row(NamedTuple):
    """Errors of place [m] and attitude [rad] at 3 and 5 s: (4,) root mean squares, medians."""

    name: str
    parameters: str
    whole: tuple[Array, Array]
    transient: tuple[Array, Array]
    steady: tuple[Array, Array]


def online(seen: HorizonErrors, time: Array) -> Array:
    """Return errors after a lift that each piece takes from what is over when it begins."""
    left, column = seen.errors, seen.columns[..., 0]
    ends = time[:, None] + np.array(HORIZONS)
    out = left.copy()
    for k, now in enumerate(time):
        over = ends <= now + 1e-6
        size = (SIZE * np.broadcast_to(HORIZONS, over.shape)[over])[:, None]
        a, r = column[over][:, :3] / size, left[over][:, :3] / size
        out[k] -= column[k] * (np.sum(a * r) / (np.sum(a * a) + LIFT**-2.0))
    return out


def by_model(
    sight: ForecastFitter, values: Array, which: Sequence[int], known: list[Flight]
) -> dict:
    """Return the errors of scored pieces by flight; `sight` is about the scored pieces."""
    return {f: online(sight.compute_flight_errors(values, f), begun(known[f])) for f in which}


def _off(flight: Flight, position: Array, quaternion: Array) -> Array:
    """Return measured less predicted at the horizons."""
    at = flight.scored.replay.cut.first[:, None] + AT
    turn = quaternion_logarithm(
        quaternion_product(quaternion_conjugate(quaternion), flight.measured.quaternion[at])
    )
    return np.concatenate([flight.measured.position[at] - position, turn], axis=-1)


def by_coasting(flight: Flight) -> Array:
    """Return the errors of body velocity and rates that stay as they are."""
    cut = flight.scored.replay.cut
    states = extrapolate_coast(cut.start, cut.length)[:, AT]
    return _off(flight, states[..., :3], states[..., 3:7])


def by_repeats(known: list[Flight], f: int) -> Array:
    """
    Return the errors of what the other flights of the same input did from the most alike state.

    Their way and turn, seen along the heading there; the mean of them, each weighed by how alike
    it was. What the same vehicle does again, given the same command: no model does much better.
    """
    this = known[f]
    first = this.scored.replay.cut.first
    begin = f - f % REPEATS
    ways, turns, weights = [], [], []
    own = _alike(this)[first]
    for other in (known[k] for k in range(begin, begin + REPEATS) if k != f):
        position, quaternion = other.measured.position, other.measured.quaternion
        theirs = _alike(other)[: len(position) - AT[-1]]
        apart = np.sum((own[:, None] - theirs[None]) ** 2, axis=-1)
        start = np.argmin(apart, axis=1)
        at = start[:, None] + AT
        back = quaternion_conjugate(_heading(quaternion[start]))[:, None]
        way = position[at] - position[start][:, None]
        ways.append(rotate_vectors(np.repeat(back, len(AT), 1), way))
        turns.append(
            quaternion_product(quaternion_conjugate(quaternion[start])[:, None], quaternion[at])
        )
        weights.append(1.0 / (0.1 + apart[np.arange(len(first)), start]))
    share = (np.array(weights) / np.sum(weights, axis=0))[..., None, None]
    way = np.sum(share * np.array(ways), axis=0)
    # About one of them: half a turn to the left and half a turn to the right is not straight on.
    apart_by = [
        quaternion_logarithm(quaternion_product(quaternion_conjugate(turns[0]), each))
        for each in turns
    ]
    turn = quaternion_product(
        turns[0], quaternion_exponential(np.sum(share * np.array(apart_by), axis=0))
    )
    here = this.measured.quaternion[first]
    head = np.repeat(_heading(here)[:, None], len(AT), 1)
    position = this.measured.position[first][:, None] + rotate_vectors(head, way)
    return _off(this, position, quaternion_product(here[:, None], turn))


def _alike(flight: Flight) -> Array:
    """Return what tells states apart, by how much matters: motion in the body, and tilt."""
    position, quaternion = flight.measured.position, flight.measured.quaternion
    reach = round(0.2 / PERIOD)
    ahead = np.minimum(np.arange(len(position)) + reach, len(position) - 1)
    behind = np.maximum(np.arange(len(position)) - reach, 0)
    lasted = (PERIOD * (ahead - behind))[:, None]
    speed = rotate_vectors(
        quaternion_conjugate(quaternion), (position[ahead] - position[behind]) / lasted
    )
    rates = (
        quaternion_logarithm(
            quaternion_product(quaternion_conjugate(quaternion[behind]), quaternion[ahead])
        )
        / lasted
    )
    up = rotate_vectors(
        quaternion_conjugate(quaternion), np.broadcast_to([0.0, 0.0, 1.0], position.shape)
    )
    return np.hstack([speed, rates, up[:, :2]]) / 0.05


def _heading(quaternion: Array) -> Array:
    """Return the turns about the vertical."""
    x, y, z, w = np.moveaxis(quaternion, -1, 0)
    half = 0.5 * np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    zero = np.zeros_like(half)
    return np.stack([zero, zero, np.sin(half), np.cos(half)], axis=-1)


def row(name: str, parameters: str, lefts: Sequence[Array], times: Sequence[Array]) -> Row:
    """Return a row of the table from the errors of all pieces."""
    left, time = np.concatenate(list(lefts)), np.concatenate(list(times))
    place, turn = (np.linalg.norm(left[..., part], axis=-1) for part in (slice(3), slice(3, 6)))
    sizes = np.stack([size[:, k] for size in (place, turn) for k in SHOWN])

    def told(some: NDArray[np.bool_]) -> tuple[Array, Array]:
        chosen = sizes[:, some]
        return np.sqrt(np.nanmean(chosen**2, axis=1)), np.nanmedian(chosen, axis=1)

    late = time >= STEADY
    return Row(name, parameters, told(late | ~late), told(~late), told(late))
