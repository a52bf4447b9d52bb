"""Define linearization points, and flights linearized about them as products of columns."""

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
# Sensor errors without an effect: pressure offset, and the scale of each specific force.
SENSORS: Final = ('pressure.offset', 'force.scale_x', 'force.scale_y', 'force.scale_z')


def count_unknowns(knots: int) -> int:
    """Return the number of unknowns of a piece: state, latent wrench at its knots, pressure."""
    # The last one is the pressure offset of the piece
    return WIDTH + AXES * knots + 1


def count_knots(count: int) -> int:
    """Return the number of knots of a piece from its unknowns; inverse of `count_unknowns`."""
    return (count - WIDTH - 1) // AXES


@final
@dataclass(frozen=True, slots=True)
class LinearizationPoint:
    """A point to linearize about."""

    nominal: NominalVehicle  # the vehicle with all parameters applied
    values: Array  # parameters relative to the vehicle file, followed by SENSORS, shape (G,)
    # The `count_unknowns` of each piece: state offsets, latent wrench at the knots axis by axis,
    # and pressure, shape (S, R)
    random: Array

    @property
    def knots(self) -> int:
        """Number of knots of a piece, on each axis."""
        return count_knots(self.random.shape[1])


@final
@dataclass(frozen=True, slots=True)
class LinearizedFlight:
    """A flight, linearized about a point."""

    names: tuple[str, ...]  # of the parameters, and SENSORS
    # Products of whitened columns: the `count_unknowns`, then the names, then the residual, shape
    # (S, N, N)
    grams: Array
    rows: NDArray[np.int64]  # number of valid readings, shape (S,)
    point: LinearizationPoint
    # Measured minus predicted, in units of the noise; NaN where nothing was measured, shape (S, n,
    # 14)
    residual: Array

    @property
    def knots(self) -> int:
        """Number of knots of a piece, on each axis."""
        return self.point.knots

    @property
    def unknown_count(self) -> int:
        """Number of unknowns of a piece."""
        return int(self.point.random.shape[1])


def zero_unknowns(cut: Windows) -> Array:
    """Return unknowns of 0: initial states from the poses, no latent wrench."""
    return np.zeros((len(cut.first), count_unknowns(cut.knots)))


def unchanged_vehicle_point(
    nominal: NominalVehicle, knobs: Sequence[FreeParameter], cut: Windows
) -> LinearizationPoint:
    """Return the point of the unchanged vehicle."""
    return LinearizationPoint(nominal, np.zeros(len(knobs) + len(SENSORS)), zero_unknowns(cut))


def hat_functions(span: int, knots: int) -> Array:
    """Return the weight of each knot in the middle of each step, shape (span, knots)."""
    # Middle of each step in units of knot intervals
    at = (np.arange(span) + 0.5) * (knots - 1) / span
    # Linear interpolation between knots
    return np.maximum(0.0, 1.0 - np.abs(at[:, None] - np.arange(knots)))
