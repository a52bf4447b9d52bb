"""
Fit the response of the diodes to a turn: cosine exponent, gains and pedestal.

The model of diode i, whose axis is at an angle from the lamp, is

    M_i = g_i (S max(0, cos angle)^p + P)

with gains of mean 1. Standard deviations are a jackknife over the directions: model errors
(reflections, a bent axis) vary with direction, so that noise alone would underestimate them.
"""

import math
from typing import final, NamedTuple

from lta_studies.light.turntable.turntable import group_by_direction, TurntableReadings
from lta_vlc.diodes import DiodeArray
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]
BEGIN_AT = 1.2  # initial exponent of the fit
EXPONENTS = (0.1, 20.0)  # as the vehicle file allows


@final
class TurntableResponse(NamedTuple):
    """
    Fitted response with standard deviations.

    Attributes
    ----------
    exponent, exponent_deviation : float
        Exponent p.
    gains, gain_deviations : tuple of float
        Gain of each diode; their mean is 1.
    strength : float
        S, reading of a nominal diode that faces the lamp. [counts]
    pedestal : float
        P relative to S.
    misfit : float
        Rms residual relative to S.

    """

    exponent: float
    exponent_deviation: float
    gains: tuple[float, ...]
    gain_deviations: tuple[float, ...]
    strength: float
    pedestal: float
    misfit: float

    @property
    def gain_spread(self) -> float:
        """Standard deviation of the gains among the diodes."""
        return float(np.std(self.gains, ddof=1)) if len(self.gains) > 1 else 0.0


def incidence_cosines(direction: Array, diodes: DiodeArray) -> Array:
    """Return the cosine between each diode's axis and a level lamp, shape (n, diodes)."""
    axes = np.array(diodes.axes)
    cosine: Array = np.outer(np.cos(direction), axes[:, 0])
    cosine += np.outer(np.sin(direction), axes[:, 1])
    return np.maximum(cosine, 0.0)


def fit_response(
    readings: TurntableReadings, diodes: DiodeArray, zero: float = 0.0
) -> TurntableResponse:
    """
    Fit the response to the readings of a whole turn.

    Parameters
    ----------
    readings : TurntableReadings
        Readings of a whole turn.
    diodes : DiodeArray
        Provides the axes.
    zero : float
        Error of the table's zero. [rad]

    """
    groups = [group for group in group_by_direction(readings.direction) if len(group)]
    cosine = np.stack(
        [
            incidence_cosines(readings.direction[group] + zero, diodes).mean(axis=0)
            for group in groups
        ]
    )
    # The median ignores single disturbed blocks.
    amplitude = np.stack([np.median(readings.amplitude[group], axis=0) for group in groups])
    best = _fit_parameters(cosine, amplitude)
    # Row k leaves out direction k.
    keep = ~np.eye(len(groups), dtype=bool)
    others = np.array([_fit_parameters(cosine[some], amplitude[some]) for some in keep])
    count = len(groups)
    about = others - others.mean(axis=0)
    # Jackknife variance: (n - 1) / n times the sum of squares
    deviation = np.sqrt((count - 1) / count * np.sum(about * about, axis=0))
    exponent, strength, pedestal, gains = best[0], best[1], best[2], best[3:]
    left = _predict_amplitude(best, cosine) - amplitude
    return TurntableResponse(
        float(exponent), float(deviation[0]), tuple(gains.tolist()),
        tuple(deviation[3:].tolist()), float(strength), float(pedestal / strength),
        float(math.sqrt(np.mean(left * left)) / strength),
    )  # fmt: skip


def _predict_amplitude(values: Array, cosine: Array) -> Array:
    exponent, strength, pedestal, gains = values[0], values[1], values[2], values[3:]
    amplitude: Array = gains * (strength * np.power(cosine, exponent) + pedestal)
    return amplitude


def _fit_parameters(cosine: Array, amplitude: Array) -> Array:
    """Return exponent, strength, pedestal and gains, with the mean gain fixed to 1."""
    top = float(amplitude.max())

    def expand_parameters(values: Array) -> Array:
        # The last gain follows from the mean of 1, as a common factor is part of the strength.
        gains = np.append(values[3:], amplitude.shape[1] - values[3:].sum())
        return np.concatenate([values[:1], top * values[1:3], gains])

    def residuals(values: Array) -> Array:
        # Scaled to order 1, so that the tolerances of the solver fit
        over: Array = (_predict_amplitude(expand_parameters(values), cosine) - amplitude) / top
        return over.ravel()

    begin = np.concatenate([[BEGIN_AT, 1.0, 0.01], np.ones(amplitude.shape[1] - 1)])
    low = np.concatenate([[EXPONENTS[0], 0.0, 0.0], np.zeros(len(begin) - 3)])
    high = np.concatenate([[EXPONENTS[1], 10.0, 10.0], np.full(len(begin) - 3, np.inf)])
    found = least_squares(residuals, begin, bounds=(low, high))
    return expand_parameters(found.x)
