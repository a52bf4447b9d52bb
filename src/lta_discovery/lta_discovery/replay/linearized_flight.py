"""Where a model stands, and a flight about it as products of columns."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_discovery.flights.windows import Windows
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.variational_equation import WIDTH
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

AXES: Final = 6
# Errors of a flight's sensors that no effect has: the pressure, and the scale of each force.
SENSORS: Final = ('pressure.offset', 'force.scale_x', 'force.scale_y', 'force.scale_z')


def count_unknowns(knots: int) -> int:
    """Return how many unknowns a piece has: state, latent wrench at its knots, pressure."""
    return WIDTH + AXES * knots + 1


def count_knots(count: int) -> int:
    """Return how many knots a piece with that many unknowns has; inverse of `count_unknowns`."""
    return (count - WIDTH - 1) // AXES


@final
@dataclass(frozen=True, slots=True)
class LinearizationPoint:
    """
    Where a model is linearised.

    Attributes
    ----------
    nominal : Nominal
        The vehicle, with all knobs where they stand.
    values : ndarray, shape (G,)
        How far each knob has been turned from the vehicle file; the last are those of SENSORS.
    random : ndarray, shape (S, R)
        The `count_unknowns` of each piece: state offsets, latent wrench at the knots axis by axis,
        and pressure.

    """

    nominal: NominalVehicle
    values: Array
    random: Array

    @property
    def knots(self) -> int:
        """Of a piece, on each axis."""
        return count_knots(self.random.shape[1])


@final
@dataclass(frozen=True, slots=True)
class LinearizedFlight:
    """
    A flight about a point.

    Attributes
    ----------
    names : tuple of str
        Of the knobs, and SENSORS.
    grams : ndarray, shape (S, N, N)
        Products of whitened columns: the `count_unknowns`, then the names, then the residual.
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
    point: LinearizationPoint
    residual: Array

    @property
    def knots(self) -> int:
        """Of a piece, on each axis."""
        return self.point.knots

    @property
    def unknown_count(self) -> int:
        """How many unknowns a piece has."""
        return int(self.point.random.shape[1])


def zero_unknowns(cut: Windows) -> Array:
    """Return the unknowns of pieces that begin where the poses say, with no latent wrench."""
    return np.zeros((len(cut.first), count_unknowns(cut.knots)))


def build_origin(
    nominal: NominalVehicle, knobs: Sequence[FreeParameter], cut: Windows
) -> LinearizationPoint:
    """Return the point at which nothing has been turned."""
    return LinearizationPoint(nominal, np.zeros(len(knobs) + len(SENSORS)), zero_unknowns(cut))


def hat_functions(span: int, knots: int) -> Array:
    """Return the share of each knot in the middle of each step, shape (span, knots)."""
    at = (np.arange(span) + 0.5) * (knots - 1) / span
    return np.maximum(0.0, 1.0 - np.abs(at[:, None] - np.arange(knots)))
