"""Where a model stands, and a flight about it as products of columns."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_analysis.discovery.model.knobs import Knob
from lta_analysis.discovery.model.nominal import Nominal
from lta_analysis.discovery.replay.tangent import WIDTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

KNOTS: Final = 9
AXES: Final = 6
RANDOM: Final = WIDTH + AXES * KNOTS + 1  # the last is the pressure of the piece
# Errors of a flight's sensors that no effect has: the pressure, and the scale of each force.
SENSORS: Final = ('pressure.offset', 'force.scale_x', 'force.scale_y', 'force.scale_z')


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
    random : ndarray, shape (S, RANDOM)
        State offsets, knots and pressure of each piece.

    """

    nominal: Nominal
    values: Array
    random: Array


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
        Products of whitened columns: RANDOM, then the names, then the residual.
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


def origin(nominal: Nominal, knobs: Sequence[Knob], pieces: int) -> Point:
    """Return the point at which nothing has been turned."""
    return Point(nominal, np.zeros(len(knobs) + len(SENSORS)), np.zeros((pieces, RANDOM)))


def hats(span: int) -> Array:
    """Return the share of each knot in the middle of each step, shape (span, KNOTS)."""
    at = (np.arange(span) + 0.5) * (KNOTS - 1) / span
    return np.maximum(0.0, 1.0 - np.abs(at[:, None] - np.arange(KNOTS)))
