"""
A few knobs fitted to what is predicted seconds ahead, over many flights at once.

Where a model's own error is what counts and not the tracker's noise (smoothed data, long glides),
a likelihood over every reading is about the wrong thing: it rewards what follows the smoothing.
Here the error at each horizon counts alike, by how large it is for the vehicle file. Shared knobs
move together; lift, which differs from flight to flight, is each flight's own.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.fit.bounds import turned
from lta_discovery.forecast.ahead import Ahead, ahead
from lta_discovery.forecast.damped import bounded, next_damping, START, TRIES
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.replay.linear import Point, SENSORS
from lta_discovery.replay.linearise import Linearised
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PLACE: Final = 2.0  # how much more a place counts than an attitude
ALIKE: Final = 0.1  # of the readings that say something new: horizons of a piece go together
ROUNDS: Final = 4  # linearisations, at most
ROBUST: Final = 4.5  # usual sizes; a larger error at a horizon counts by its size, not its square
SETTLED: Final = 1e-3  # of the cost; a step that gains less is the last


@final
@dataclass(frozen=True, slots=True)
class Said:
    """
    What one flight says of the knobs about a point, its own lift eliminated.

    Attributes
    ----------
    products : ndarray, shape (K, K)
        Of the columns.
    pull : ndarray, shape (K,)
        Of the columns with what is left over.
    own : tuple of float, float, ndarray
        Information of the lift, its pull, and its products with the columns.
    cost : float
        What is left over, squared; beyond `ROBUST` by its size.

    """

    products: Array
    pull: Array
    own: tuple[float, float, Array]
    cost: float


@final
@dataclass(frozen=True, slots=True)
class Fitted:
    """
    Where the knobs stand.

    Attributes
    ----------
    values : ndarray, shape (G,)
        What flights share, from the vehicle file; 0 for what was not asked for.
    precision, pull : ndarray, shape (K, K) and (K,)
        Of those asked for, about `values`, from the flights alone.
    said : tuple of Said
        By flight.

    """

    values: Array
    precision: Array
    pull: Array
    said: tuple[Said, ...]


@final
class Foresight:
    """
    Flights of one vehicle, for what they say of forecasts.

    Parameters
    ----------
    nominal : Nominal
        The vehicle as its file has it.
    flights : sequence of Linearised
        In pieces longer than the last horizon, with the same knobs.
    lift : float
        Standard deviation of a flight's lift. [N]
    place : float
        How much more a place counts than an attitude.

    """

    def __init__(
        self,
        nominal: Nominal,
        flights: Sequence[Linearised],
        lift: float,
        place: float = PLACE,
    ) -> None:
        self.nominal, self.flights, self.lift = nominal, flights, lift
        self.knobs: list[Knob] = flights[0].knobs
        self._lift = next(k for k, knob in enumerate(self.knobs) if knob.name == 'net_lift.force')
        zero = np.zeros(len(self.knobs))
        first = [ahead(one, self.point(zero, 0.0, one)).left for one in flights]
        self.weights = _weights(np.concatenate(first), place)
        self._known = [int(np.isfinite(left).sum()) for left in first]

    def point(self, values: Array, lift: float, flight: Linearised) -> Point:
        """Return where a flight stands with shared values and a lift of its own."""
        own = values.copy()
        own[self._lift] += lift
        nominal, own = turned(self.nominal, self.knobs, own)
        none = np.zeros((len(flight.replay.first), 0))
        return Point(nominal, np.append(own, np.zeros(len(SENSORS))), none)

    def errors(self, values: Array, f: int, which: Sequence[int] = (), lift: float = 0.0) -> Ahead:
        """Return the errors ahead of one flight, and how they answer to some knobs and lift."""
        flight = self.flights[f]
        return ahead(flight, self.point(values, lift, flight), [*which, self._lift])

    def fit(
        self,
        which: Sequence[int],
        spread: Array,
        flights: Sequence[int],
        begin: Array | None = None,
        rounds: int = ROUNDS,
        told: bool = True,
    ) -> Fitted:
        """
        Fit some knobs to some flights.

        Parameters
        ----------
        which : sequence of int
            Of the knobs.
        spread : ndarray, shape (K,)
            Standard deviation beforehand of each, about the vehicle file.
        flights : sequence of int
            To be fitted to.
        begin : ndarray, shape (G,), optional
            Where to begin; the vehicle file by default.
        rounds : int
            Steps of Levenberg and Marquardt at most, each damped until it helps.
        told : bool
            Whether to say at the end what the flights say there; else what they said one step
            before.

        """
        picked = np.asarray(which, dtype=np.int64)
        values = np.zeros(len(self.knobs)) if begin is None else begin.copy()
        lifts = np.zeros(len(self.flights))
        wall, damping = np.diag(spread**-2.0), START
        for _ in range(rounds):
            said = {f: self._said(values, lifts, f, picked) for f in flights}
            inner = wall + np.sum([one.products for one in said.values()], axis=0)
            right = np.sum([one.pull for one in said.values()], axis=0) - wall @ values[picked]
            before = sum(one.cost for one in said.values()) + _strain(values[picked], spread)
            found = self._stepped(
                values, lifts, picked, spread, (inner, right), said, (before, damping)
            )
            if found is None:
                break
            values, lifts, after, damping = found
            if before - after < SETTLED * before:
                break
        if told or not rounds:
            said = {f: self._said(values, lifts, f, picked) for f in flights}
        return Fitted(
            values,
            np.sum([one.products for one in said.values()], axis=0),
            np.sum([one.pull for one in said.values()], axis=0),
            tuple(said.values()),
        )

    def without(
        self, fitted: Fitted, which: Sequence[int], spread: Array, flights: Sequence[int]
    ) -> Array:
        """Return the values that all but some flights say, one step away from a fit to all."""
        picked, out = np.asarray(which, dtype=np.int64), fitted.values.copy()
        gone = [one for f, one in enumerate(fitted.said) if f in set(flights)]
        inner = fitted.precision + np.diag(spread**-2.0)
        inner = inner - np.sum([one.products for one in gone], axis=0)
        # Where all of them rest, what these pulled is what the others pull the other way.
        right = -np.sum([one.pull for one in gone], axis=0)
        out[picked] = bounded(inner, right, out[picked], *self._bounds(picked))
        return out

    def _bounds(self, picked: NDArray[np.int64]) -> tuple[Array, Array]:
        """Return the least and the most of some knobs."""
        low, high = (
            np.array([getattr(self.knobs[k], side) for k in picked]) for side in ('low', 'high')
        )
        return low, high

    def size(self, values: Array, flights: Sequence[int]) -> float:
        """Return the root mean square of the errors ahead, each flight's lift fitted to it."""
        total, count = 0.0, 0
        for f in flights:
            seen = self.errors(values, f)
            good = np.isfinite(seen.left)
            left = (seen.left * self.weights)[good]
            column = (seen.columns[..., 0] * self.weights)[good]
            lift = ALIKE * float(column @ left) / (ALIKE * float(column @ column) + self.lift**-2)
            total += float(np.sum((left - lift * column) ** 2))
            count += self._known[f]
        return float(np.sqrt(total / max(count, 1)))

    def _stepped(
        self,
        values: Array,
        lifts: Array,
        picked: NDArray[np.int64],
        spread: Array,
        normal: tuple[Array, Array],
        said: dict[int, Said],
        began: tuple[float, float],
    ) -> tuple[Array, Array, float, float] | None:
        """Return a better point, its cost and the damping that led there, eased; None without."""
        inner, right = normal
        before, damping = began
        for _ in range(TRIES):
            there, own = values.copy(), lifts.copy()
            stiff = inner + damping * np.diag(np.diag(inner))
            there[picked] = bounded(stiff, right, values[picked], *self._bounds(picked))
            for f, one in said.items():
                information, pull, across = one.own
                own[f] += (pull - across @ (there - values)[picked]) / information
            try:
                cost = sum(self._cost(there, own, f) for f in said)
            except BadInput:
                cost = np.inf
            cost += _strain(there[picked], spread)
            if cost < before:
                return there, own, cost, next_damping(damping, True)
            damping = next_damping(damping, False)
        return None

    def _cost(self, values: Array, lifts: Array, f: int) -> float:
        """Return what is left over of a flight, squared."""
        flight = self.flights[f]
        with np.errstate(all='ignore'):
            left = ahead(flight, self.point(values, float(lifts[f]), flight)).left
        if np.isfinite(left).sum() < self._known[f]:
            return np.inf  # it ran away
        cost, _ = _counted(left * self.weights)
        return ALIKE * cost + float(lifts[f] / self.lift) ** 2

    def _said(self, values: Array, lifts: Array, f: int, picked: NDArray[np.int64]) -> Said:
        """Return what a flight says about a point."""
        seen = self.errors(values, f, picked.tolist(), float(lifts[f]))
        good = np.isfinite(seen.left)
        cost, share = _counted(seen.left * self.weights)
        weights = self.weights * np.sqrt(share)[..., None]
        left = np.where(good, seen.left * weights, 0.0).ravel()
        table = seen.columns * weights[..., None] * good[..., None]
        table = table.reshape(len(left), -1)
        a, b = table[:, :-1], table[:, -1]
        information = ALIKE * float(b @ b) + self.lift**-2.0
        pull = ALIKE * float(b @ left) - float(lifts[f]) / self.lift**2
        across = ALIKE * (b @ a)
        return Said(
            ALIKE * (a.T @ a) - np.outer(across, across) / information,
            ALIKE * (a.T @ left) - across * (pull / information),
            (information, pull, across),
            ALIKE * cost + float(lifts[f] / self.lift) ** 2,
        )


def _counted(left: Array) -> tuple[float, Array]:
    """Return what errors cost (Huber 1964), shape (S, H, 6), and the share of each that pulls."""
    size = np.sqrt(np.nansum(left**2, axis=-1) / left.shape[-1])
    share = ROBUST / np.maximum(size, ROBUST)
    cost = np.where(size > ROBUST, 2.0 * ROBUST * size - ROBUST**2, size**2)
    return left.shape[-1] * float(cost.sum()), share


def _weights(left: Array, more: float) -> Array:
    """Return one over the usual size of errors, shape (H, 6), from (n, H, 6)."""
    size = np.sqrt(np.nanmean(left**2, axis=0))
    place = np.sqrt(np.mean(size[:, :3] ** 2, axis=1, keepdims=True))
    turn = np.sqrt(np.mean(size[:, 3:] ** 2, axis=1, keepdims=True))
    return np.hstack([np.repeat(more / place, 3, axis=1), np.repeat(1.0 / turn, 3, axis=1)])


def _strain(values: Array, spread: Array) -> float:
    """Return how far knobs are from the vehicle file, squared."""
    return float(np.sum((values / spread) ** 2))
