"""
Fit the response of the diodes to a turn: cosine exponent, gains and diffuse light.

A diode whose axis is at an angle a from the lamp reads

    M_i = g_i (S max(0, cos a)^p / d^2 + P + s1 cos a + s2 sin a + b1 cos 2a + b2 sin 2a)

with gains of mean 1. d is its distance from the lamp over that of the middle of the diodes: the
one that faces the lamp is nearer, which looks like a larger exponent. The diffuse light has a
pedestal P and two harmonics, as in the model by which the drone steers (`lta_vlc.reading_model`);
the diodes that look away from the lamp show them. Standard deviations are a jackknife over the
directions: model errors vary with direction, so that noise alone would underestimate them.
"""

from collections.abc import Sequence
import math
from typing import final, NamedTuple

from lta_studies.light.turntable.turntable import group_by_direction, TurntableReadings
from lta_vlc.diodes import DiodeArray
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]
BEGIN_AT = 1.2  # initial exponent of the fit
DIFFUSE = 5  # pedestal, and cosine and sine of its two harmonics
SHARED = 2 + DIFFUSE  # parameters besides the gains: exponent and strength as well
EXPONENTS = (0.1, 20.0)  # as the vehicle file allows


@final
class TurntableResponse(NamedTuple):
    """Fitted response with standard deviations."""

    # Exponent p
    exponent: float
    exponent_deviation: float
    # Gain of each diode; their mean is 1
    gains: tuple[float, ...]
    gain_deviations: tuple[float, ...]
    strength: float  # S, reading of a nominal diode that faces the lamp [counts]
    pedestal: float  # p relative to S
    misfit: float  # rms residual relative to S

    @property
    def gain_uncertainty(self) -> float:
        """Rms standard deviation of the fitted gains."""
        return math.sqrt(sum(each * each for each in self.gain_deviations) / len(self.gains))

    @property
    def gain_spread(self) -> float:
        """Standard deviation of the gains among the diodes."""
        return float(np.std(self.gains, ddof=1)) if len(self.gains) > 1 else 0.0


class TurnBasis(NamedTuple):
    """What the model is made of, as means over groups of blocks, for a level lamp."""

    # Cosine between the axis of each diode and the lamp, 0 if it looks away; and d, shape (n,
    # diodes)
    cosine: Array
    distance: Array
    diffuse: Array  # harmonics of the diffuse light at each diode, shape (DIFFUSE, n, diodes)

    def select(self, some: NDArray[np.bool_]) -> 'TurnBasis':
        """Return some of the groups."""
        return TurnBasis(self.cosine[some], self.distance[some], self.diffuse[:, some])


def build_basis(
    direction: Array, groups: Sequence[NDArray[np.intp]], diodes: DiodeArray, lamp: float
) -> TurnBasis:
    """Return the basis for directions of the lamp [rad], which is `lamp` m away."""
    axes, places = np.array(diodes.axes), np.array(diodes.places)
    # From each diode to the lamp, in units of its distance; shape (blocks, diodes, 3)
    ray = np.stack([np.cos(direction), np.sin(direction), np.zeros_like(direction)], axis=1)
    way = ray[:, None] - places / lamp
    distance = np.linalg.norm(way, axis=2)
    cosine = np.maximum(np.einsum('ij,nij->ni', axes, way) / distance, 0.0)
    apart = np.arctan2(axes[:, 1], axes[:, 0]) - direction[:, None]
    level = np.hypot(axes[:, 0], axes[:, 1])
    rows = (
        np.ones_like(apart), level * np.cos(apart), level * np.sin(apart),
        np.cos(2 * apart), np.sin(2 * apart),
    )  # fmt: skip
    cosine, distance, *diffuse = (
        np.stack([row[group].mean(axis=0) for group in groups])
        for row in (cosine, distance, *rows)
    )
    return TurnBasis(cosine, distance, np.stack(diffuse))


def fit_response(
    readings: TurntableReadings, diodes: DiodeArray, zero: float = 0.0, lamp: float = math.inf
) -> TurntableResponse:
    """
    Fit the response to the readings of a whole turn.

    `readings`: readings of a whole turn. `zero`: error of the table's zero [rad]. `lamp`: distance
    of the lamp from the middle of the diodes [m].
    """
    groups = [group for group in group_by_direction(readings.direction) if len(group)]
    basis = build_basis(readings.direction + zero, groups, diodes, lamp)
    # The median ignores single disturbed blocks.
    amplitude = np.stack([np.median(readings.amplitude[group], axis=0) for group in groups])
    best = _fit_parameters(basis, amplitude)
    # Row k leaves out direction k.
    keep = ~np.eye(len(groups), dtype=bool)
    others = np.array([_fit_parameters(basis.select(some), amplitude[some]) for some in keep])
    count = len(groups)
    about = others - others.mean(axis=0)
    # Jackknife variance: (n - 1) / n times the sum of squares
    deviation = np.sqrt((count - 1) / count * np.sum(about * about, axis=0))
    exponent, strength, pedestal = best[:3]
    left = _predict_amplitude(best, basis) - amplitude
    return TurntableResponse(
        float(exponent), float(deviation[0]), tuple(best[SHARED:].tolist()),
        tuple(deviation[SHARED:].tolist()), float(strength), float(pedestal / strength),
        float(math.sqrt(np.mean(left * left)) / strength),
    )  # fmt: skip


def _predict_amplitude(values: Array, basis: TurnBasis) -> Array:
    exponent, strength, gains = values[0], values[1], values[SHARED:]
    around = np.tensordot(values[2:SHARED], basis.diffuse, axes=1)
    direct = strength * np.power(basis.cosine, exponent) / basis.distance**2
    amplitude: Array = gains * (direct + around)
    return amplitude


def _fit_parameters(basis: TurnBasis, amplitude: Array) -> Array:
    """Return exponent, strength, diffuse light and gains, with the mean gain fixed to 1."""
    top = float(amplitude.max())
    scale = np.array([1.0, *(top,) * (SHARED - 1)])

    def expand_parameters(values: Array) -> Array:
        # The last gain follows from the mean of 1, as a common factor is part of the strength.
        last = amplitude.shape[1] - values[SHARED:].sum()
        return np.concatenate([scale * values[:SHARED], values[SHARED:], [last]])

    def residuals(values: Array) -> Array:
        # Scaled to order 1, so that the tolerances of the solver fit
        predicted = _predict_amplitude(expand_parameters(values), basis)
        return ((predicted - amplitude) / top).ravel()

    begin = np.zeros(SHARED + amplitude.shape[1] - 1)
    begin[:3], begin[SHARED:] = (BEGIN_AT, 1.0, 0.01), 1.0
    low, high = np.full(len(begin), -1.0), np.full(len(begin), 10.0)
    (low[0], high[0]), low[1:3], low[SHARED:] = EXPONENTS, 0.0, 0.0
    solution = least_squares(residuals, begin, bounds=(low, high))
    return expand_parameters(solution.x)
