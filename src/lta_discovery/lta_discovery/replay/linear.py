"""Where a model stands, and a flight about it as products of columns."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_discovery.flights.windows import Windows
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.replay.tangent import WIDTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

AXES: Final = 6
# Errors of a flight's sensors that no effect has: the pressure, and the scale of each force.
SENSORS: Final = ('pressure.offset', 'force.scale_x', 'force.scale_y', 'force.scale_z')


def unknowns(knots: int) -> int:
    """Return how many unknowns a piece has: state, latent wrench at its knots, pressure."""
    return WIDTH + AXES * knots + 1


def knots_among(count: int) -> int:
    """Return how many knots a piece with that many unknowns has; the inverse of `unknowns`."""
    return (count - WIDTH - 1) // AXES


@final
@dataclass(frozen=True, slots=True)
class Point:
    """
    Where a model is linearised.

    Attributes
    ----------
    nominal : Nominal
        The vehicle, with all knobs where they stand.
    values : ndarray, shape (G,)
        How far each knob has been turned from the vehicle file; the last are those of SENSORS.
    random : ndarray, shape (S, R)
        The `unknowns` of each piece: state offsets, latent wrench at the knots axis by axis, and
        pressure.

    """

    nominal: Nominal
    values: Array
    random: Array

    @property
    def knots(self) -> int:
        """Of a piece, on each axis."""
        return knots_among(self.random.shape[1])


@final
@dataclass(frozen=True, slots=True)
class Linear:
    """
    A flight about a point.

    Attributes
    ----------
    names : tuple of str
        Of the knobs, and SENSORS.
    grams : ndarray, shape (S, N, N)
        Products of whitened columns: the `unknowns`, then the names, then the residual.
    rows : ndarray of int, shape (S,)
        Readings that count.
    point : Point
        The point.
    residual : ndarray, shape (S, n, 14)
        Measured less predicted, in units of the noise; NaN where nothing was measured.

    """

    names: tuple[str, ...]
    grams: Array
    rows: NDArray[np.int64]
    point: Point
    residual: Array

    @property
    def knots(self) -> int:
        """Of a piece, on each axis."""
        return self.point.knots

    @property
    def random(self) -> int:
        """How many unknowns a piece has."""
        return int(self.point.random.shape[1])


def still(cut: Windows) -> Array:
    """Return the unknowns of pieces that begin where the poses say, with no latent wrench."""
    return np.zeros((len(cut.first), unknowns(cut.knots)))


def origin(nominal: Nominal, knobs: Sequence[Knob], cut: Windows) -> Point:
    """Return the point at which nothing has been turned."""
    return Point(nominal, np.zeros(len(knobs) + len(SENSORS)), still(cut))


def hats(span: int, knots: int) -> Array:
    """Return the share of each knot in the middle of each step, shape (span, knots)."""
    at = (np.arange(span) + 0.5) * (knots - 1) / span
    return np.maximum(0.0, 1.0 - np.abs(at[:, None] - np.arange(knots)))
